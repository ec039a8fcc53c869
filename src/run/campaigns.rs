//! The campaign record that each run leaves, and what earlier records give: reasons of reruns, and durations.

use super::{Report, StageReport, StageStatus, TaskReport, remembered};
use crate::plan::Workflow;
use crate::plan::why::{Reason, why};
use crate::store::{Campaign, StageRun, Store, StoreError};
use std::collections::HashMap;
use std::time::{SystemTime, UNIX_EPOCH};

/// Writes the record of a campaign into the store.
///
/// # Errors
/// The store cannot be written.
pub fn record(
    workflow: &Workflow,
    sets: &[String],
    report: &Report,
    started: SystemTime,
    store: &Store,
) -> Result<u64, StoreError> {
    let since = started.duration_since(UNIX_EPOCH).unwrap_or_default();
    let campaign = Campaign {
        workflow: workflow.path.display().to_string(),
        profile: workflow.profile.clone().unwrap_or_default(),
        set: sets.to_vec(),
        started: since.as_millis() as i64,
        seconds: started.elapsed().unwrap_or_default().as_secs_f64(),
        origin: store.origin().clone(),
        stages: report.stages.iter().map(|stage| stage_run(workflow, stage)).collect(),
        ..Campaign::default()
    };
    store.record_campaign(&campaign)
}

fn stage_run(workflow: &Workflow, report: &StageReport) -> StageRun {
    let Some(index) = workflow.position(&report.name) else { panic!("BUG: a report of no stage") };
    let node = &workflow.stages[index];
    let object = match &report.status {
        StageStatus::Done(content) => Some(content.to_string()),
        StageStatus::Open | StageStatus::Failed(_) | StageStatus::Skipped(_) => None,
    };
    StageRun {
        name: report.name.clone(),
        kind: report.kind.to_owned(),
        settings: node.stage.settings(),
        inputs: node.inputs.iter().map(|&(_, input)| workflow.stages[input].name.clone()).collect(),
        state: report.status.word().to_owned(),
        tasks: report.tasks.total as u64,
        ran: report.tasks.ran as u64,
        cached: report.tasks.cached as u64,
        failed: report.tasks.failed as u64,
        seconds: report.seconds,
        object,
        memo: report.memo.map(|key| key.to_string()),
    }
}

/// The last campaigns of the same workflow, by stage.
pub struct Past<'a> {
    store: &'a Store,
    /// By stage: key of the last memo.
    memos: HashMap<String, crate::artifact::Key>,
}

impl<'a> Past<'a> {
    /// Looks through the last recorded runs of this workflow file.
    ///
    /// # Errors
    /// The store cannot be read.
    pub fn of(workflow: &Workflow, store: &'a Store) -> Result<Self, StoreError> {
        let path = workflow.path.display().to_string();
        let mut memos = HashMap::new();
        for number in store.campaigns()?.into_iter().rev().take(LOOK_BACK) {
            let Some(campaign) = store.campaign(number)?.filter(|campaign| campaign.own && campaign.workflow == path)
            else {
                continue;
            };
            for stage in campaign.stages.iter().filter(|stage| stage.object.is_some()) {
                let key = stage.memo.as_deref().and_then(crate::artifact::Key::from_hex);
                if let Some(key) = key {
                    memos.entry(stage.name.clone()).or_insert(key);
                }
            }
        }
        Ok(Self { store, memos })
    }

    /// Why the open tasks of a stage have no result: each with how many tasks it concerns.
    pub fn reasons(&self, stage: &str, tasks: &[&TaskReport]) -> Vec<(Reason, usize)> {
        let old = self.memos.get(stage).and_then(|key| remembered(self.store, key)).unwrap_or_default();
        let mut found: Vec<(Reason, usize)> = Vec::new();
        for text in tasks.iter().filter_map(|task| Some((task.row, task.text.as_deref()?))) {
            for reason in self.why(&old, text) {
                match found.iter_mut().find(|(known, _)| *known == reason) {
                    Some((_, count)) => *count += 1,
                    None => found.push((reason, 1)),
                }
            }
        }
        found
    }

    /// Compares with the earlier task of the same row and work that is most like it.
    fn why(&self, old: &[(Option<usize>, crate::artifact::Key)], (row, new): (Option<usize>, &str)) -> Vec<Reason> {
        let same_row = old.iter().filter(|(r, _)| *r == row).take(LOOK_BACK);
        let texts = same_row.filter_map(|(_, key)| self.store.task_text(&self.store.find(key).ok()??).ok());
        let work = |text: &str| text.lines().nth(1).and_then(|line| line.split(' ').nth(1)).map(str::to_owned);
        let like = texts.filter(|text| work(text) == work(new)).map(|text| why(&text, new));
        like.min_by_key(Vec::len).unwrap_or_else(|| vec![Reason::New])
    }

    /// Seconds that 19 of 20 tasks of a stage took less than, from what was recorded.
    pub fn most_seconds(&self, stage: &str) -> Option<f64> {
        let old = remembered(self.store, self.memos.get(stage)?)?;
        let mut seconds: Vec<f64> = old.iter().filter_map(|(_, key)| self.store.seconds(key).ok()?).collect();
        seconds.sort_by(f64::total_cmp);
        seconds.get((seconds.len() * 19).div_ceil(20).checked_sub(1)?).copied()
    }

    /// What the tasks of each row of a stage took together, from what was recorded.
    pub(super) fn row_seconds(&self, stage: &str) -> Option<RowSeconds> {
        let old = remembered(self.store, self.memos.get(stage)?)?;
        let mut rows: HashMap<Option<usize>, f64> = HashMap::new();
        for (row, key) in &old {
            *rows.entry(*row).or_default() += self.store.seconds(key).ok()?.unwrap_or(0.0);
        }
        let designed: Vec<f64> = rows.iter().filter_map(|(row, seconds)| row.is_some().then_some(*seconds)).collect();
        let mean = designed.iter().sum::<f64>() / designed.len().max(1) as f64;
        Some(RowSeconds { rows, mean })
    }

    /// Mean duration of a task of a stage, seconds, from what was recorded.
    pub fn seconds(&self, stage: &str) -> Option<f64> {
        let old = remembered(self.store, self.memos.get(stage)?)?;
        let seconds = old.iter().filter_map(|(_, key)| self.store.seconds(key).ok()?);
        let (sum, count) = seconds.fold((0.0, 0_u32), |(sum, count), seconds| (sum + seconds, count + 1));
        (count > 0).then(|| sum / f64::from(count))
    }
}

/// Seconds that the tasks of the rows of a stage took.
pub(super) struct RowSeconds {
    rows: HashMap<Option<usize>, f64>,
    mean: f64,
}

impl RowSeconds {
    /// Seconds of a row; their mean for a new one.
    pub(super) fn of(&self, row: Option<usize>) -> f64 {
        self.rows.get(&row).copied().unwrap_or(self.mean)
    }
}

/// Number of earlier campaigns, or of tasks of one row, that are compared.
const LOOK_BACK: usize = 20;
