//! What a person sees while a campaign runs: plain lines on standard error.

use crate::run::{Event, StageStatus, Watch};

/// One line per stage that ended and per failure.
pub(super) struct Lines {
    quiet: bool,
}

impl Lines {
    pub(super) fn new(quiet: bool) -> Self {
        Self { quiet }
    }
}

impl Watch for Lines {
    fn event(&self, event: Event<'_>) {
        match event {
            Event::Ended { stage, row, failure: Some(why), .. } => {
                let row = row.map_or_else(String::new, |row| format!("[{}]", row + 1));
                eprintln!("error: {stage}{row}: {why}");
            }
            Event::Ended { stage, count, failure: None, .. } if !self.quiet => {
                eprintln!("{stage:16} {} of {}", count.ran + count.cached, count.total);
            }
            Event::Stage { report } => match &report.status {
                StageStatus::Failed(why) => eprintln!("error: stage `{}` failed: {why}", report.name),
                StageStatus::Skipped(cause) if !self.quiet => {
                    eprintln!("{:16} skipped, because `{cause}` failed", report.name);
                }
                StageStatus::Done(_) if !self.quiet => {
                    eprintln!("{:16} done: {} ran, {} cached", report.name, report.tasks.ran, report.tasks.cached);
                }
                StageStatus::Open | StageStatus::Done(_) | StageStatus::Skipped(_) => {}
            },
            Event::Started { .. } | Event::Said { .. } | Event::Ended { .. } => {}
        }
    }
}
