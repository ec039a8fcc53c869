//! What a person sees while a campaign runs: a live table on a terminal, plain lines elsewhere.

use super::output::{on_screen, width, wrapped};
use super::whole::Whole;
use crate::report::duration;
use crate::run::{Event, StageReport, StageStatus, TaskCount, Watch};
use crate::stage::forecast::Forecast;
use indicatif::{MultiProgress, ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::collections::hash_map::Entry;
use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::io::IsTerminal;
use std::sync::{Mutex, MutexGuard, OnceLock, PoisonError};
use std::time::{Duration, Instant};

/// Shortest time between two plain lines of one stage.
const PAUSE: Duration = Duration::from_secs(5);

/// A terminal with fewer columns has no room for bars.
const NARROW: usize = 72;

/// Reports failures at once, stages when they end, and the progress of each now and then.
pub(super) struct Progress<'a> {
    screen: Option<MultiProgress>,
    stages: Mutex<HashMap<String, Live>>,
    /// How far all stages together are, and its line on a terminal.
    whole: Mutex<Whole>,
    line: Option<ProgressBar>,
    /// Computed when the first task starts, as neither is needed where all results are cached.
    ahead: OnceLock<Ahead<'a>>,
    look_ahead: Box<dyn Fn() -> Ahead<'a> + Sync + 'a>,
    workers: usize,
}

/// What is expected of a campaign.
pub(super) struct Ahead<'a> {
    /// The forecasts of its stages.
    pub forecasts: Vec<(&'a str, Forecast)>,
    /// Mean seconds of a task by stage, from earlier runs.
    pub seconds: HashMap<String, f64>,
}

/// A stage at work.
struct Live {
    started: Instant,
    reported: Instant,
    /// Tasks that ended since, other than from the store.
    ended: usize,
    /// When the tasks that run were started, by row; several tasks may belong to one row.
    running: HashMap<Option<usize>, Vec<Instant>>,
    /// Tasks of which it is known how long they took, and their seconds.
    timed: (usize, f64),
    /// Tasks that failed; each failure was reported with its reason.
    failed: usize,
    /// Progress in the words of the stage; empty for stages that do not decide by outcomes.
    note: String,
    /// Warnings without their numbers, with the rows that gave them.
    warned: BTreeMap<String, BTreeSet<Option<usize>>>,
    bar: Option<ProgressBar>,
}

impl Live {
    fn new(bar: Option<ProgressBar>) -> Self {
        let now = Instant::now();
        let (running, note, warned) = (HashMap::new(), String::new(), BTreeMap::new());
        Self { started: now, reported: now, ended: 0, running, timed: (0, 0.0), failed: 0, note, warned, bar }
    }

    /// Counts a task that ended. Returns the mean seconds of those that ran here.
    fn count_ended(&mut self, row: Option<usize>, failed: usize) -> Option<f64> {
        (self.ended, self.failed) = (self.ended + 1, failed);
        if let Entry::Occupied(mut running) = self.running.entry(row) {
            if let Some(begun) = running.get_mut().pop() {
                self.timed = (self.timed.0 + 1, self.timed.1 + begun.elapsed().as_secs_f64());
            }
            if running.get().is_empty() {
                running.remove();
            }
        }
        (self.timed.0 > 0).then(|| self.timed.1 / self.timed.0 as f64)
    }
}

impl<'a> Progress<'a> {
    /// The progress of a campaign that `workers` tasks at a time compute.
    pub(super) fn new(look_ahead: impl Fn() -> Ahead<'a> + Sync + 'a, workers: usize) -> Self {
        let screen = std::io::stderr().is_terminal().then(|| {
            let target = ProgressDrawTarget::stderr_with_hz(8);
            MultiProgress::with_draw_target(target)
        });
        let line = screen.as_ref().map(|screen| {
            let line = screen.add(ProgressBar::new(0));
            line.set_style(ProgressStyle::with_template("{wide_msg}").unwrap_or_else(|_| ProgressStyle::default_bar()));
            line
        });
        let (stages, whole) = (Mutex::default(), Mutex::default());
        Self { screen, stages, whole, line, ahead: OnceLock::new(), look_ahead: Box::new(look_ahead), workers }
    }

    fn ahead(&self) -> &Ahead<'a> {
        self.ahead.get_or_init(|| {
            let ahead = (self.look_ahead)();
            self.whole(|whole| whole.look_ahead(ahead.forecasts.iter().copied()));
            ahead
        })
    }

    fn stages(&self) -> MutexGuard<'_, HashMap<String, Live>> {
        self.stages.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn say(&self, line: &str) {
        match &self.screen {
            // Its `suspend` panics when the terminal has gone.
            Some(screen) => drop(screen.println(wrapped(&on_screen(line), width(&std::io::stderr())))),
            None => err!("{line}"),
        }
    }

    fn bar(&self, stage: &str) -> Option<ProgressBar> {
        let screen = self.screen.as_ref()?;
        let bar = match &self.line {
            Some(line) => screen.insert_before(line, ProgressBar::new(0)),
            None => screen.add(ProgressBar::new(0)),
        };
        let narrow = width(&std::io::stderr()).is_some_and(|width| width < NARROW);
        let bar_of = if narrow { "" } else { " {bar:10.cyan/dim}" };
        let style = ProgressStyle::with_template(&format!("{{prefix:16}}{bar_of} {{pos:>5}}/{{len:5}} {{wide_msg}}"));
        bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
        bar.set_prefix(stage.to_owned());
        Some(bar)
    }

    fn started(&self, stage: &str) {
        let mut stages = self.stages();
        if !stages.contains_key(stage) {
            let bar = self.bar(stage);
            if let Some(bar) = &bar {
                let [ended, total] = self.counts().counts(stage);
                bar.set_length(total as u64);
                bar.set_position(ended as u64);
            }
            stages.insert(stage.to_owned(), Live::new(bar));
        }
    }

    /// A warning stays on the screen: of each kind the first of a stage, as rows differ in its numbers only. The others are
    /// counted when the stage ends.
    fn warn(&self, stage: &str, row: Option<usize>, words: &str) {
        let first = self.stages().get_mut(stage).is_some_and(|live| {
            let rows = live.warned.entry(kind_of(words)).or_default();
            let first = rows.is_empty();
            rows.insert(row);
            first
        });
        if first {
            self.say(&format!("warning: {}: {words}", task_name(stage, row)));
        }
    }

    fn counts(&self) -> MutexGuard<'_, Whole> {
        self.whole.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// How far the campaign is, shown on its line where there is one.
    fn whole(&self, change: impl FnOnce(&mut Whole)) -> Option<String> {
        let mut whole = self.counts();
        change(&mut whole);
        let words = whole.in_words(self.workers);
        if let (Some(line), Some(words)) = (&self.line, &words) {
            line.set_message(words.clone());
        }
        words
    }

    fn asked(&self, stage: &str, count: TaskCount, note: &str) {
        self.started(stage);
        self.whole(|whole| whole.note(stage, count, None));
        if let Some(live) = self.stages().get_mut(stage) {
            note.clone_into(&mut live.note);
            if let Some(bar) = &live.bar {
                bar.set_length(count.total as u64);
                bar.set_position(count.ended() as u64);
                bar.set_message(format!("{} cached; {note}", count.cached));
            }
        }
    }

    fn ended(&self, stage: &str, row: Option<usize>, count: TaskCount) {
        let mut stages = self.stages();
        let Some(live) = stages.get_mut(stage) else { return };
        let measured = live.count_ended(row, count.failed);
        let elapsed = live.started.elapsed().as_secs_f64();
        let left = count.total - count.ended();
        let earlier = &self.ahead().seconds;
        let expected = earlier.get(stage).map(|s| s / self.workers as f64);
        let words = self.whole(|whole| {
            whole.note(stage, count, measured);
            whole.expect(|name| earlier.get(name).copied());
        });
        let pace = pace(live.ended, left, elapsed, expected);
        let message = match live.note.as_str() {
            "" => pace,
            note => format!("{} cached; {note}; {pace}", count.cached),
        };
        if let Some(bar) = &live.bar {
            bar.set_length(count.total as u64);
            bar.set_position(count.ended() as u64);
            bar.set_message(message);
        } else if live.reported.elapsed() >= PAUSE && left > 0 {
            live.reported = Instant::now();
            let whole = words.map_or_else(String::new, |words| format!("; {words}"));
            err!("{stage:16} {:>5}/{:<5} {message}{whole}", count.ended(), count.total);
        }
    }

    fn closed(&self, report: &StageReport) {
        self.whole(|whole| whole.close(&report.name, report.tasks));
        let live = self.stages().remove(&report.name);
        if let Some(bar) = live.as_ref().and_then(|live| live.bar.as_ref()) {
            bar.finish_and_clear();
        }
        let name = &report.name;
        for (kind, rows) in live.iter().flat_map(|live| &live.warned).filter(|(_, rows)| rows.len() > 1) {
            let more = rows.len() - 1;
            let rows = if more == 1 { "row" } else { "rows" };
            self.say(&format!("warning: {name}: {more} more {rows} with this warning: {kind}"));
        }
        match &report.status {
            StageStatus::Failed(why) => match live.map_or(0, |live| live.failed) {
                0 => self.say(&format!("error: stage `{name}`: {why}")),
                failed => self.say(&format!("{name:16} failed: {failed} of {} tasks", report.tasks.total)),
            },
            StageStatus::Skipped(cause) => self.say(&format!("{name:16} skipped, because `{cause}` failed")),
            StageStatus::Done(_) => {
                let time =
                    if report.tasks.ran > 0 { format!(" in {}", duration(report.seconds)) } else { String::new() };
                let note = live.filter(|live| !live.note.is_empty()).map(|live| format!("; {}", live.note));
                let (ran, cached) = (report.tasks.ran, report.tasks.cached);
                self.say(&format!("{name:16} done: {ran} ran{time}, {cached} cached{}", note.unwrap_or_default()));
            }
            StageStatus::Open => {}
        }
    }
}

impl Watch for Progress<'_> {
    fn event(&self, event: Event<'_>) {
        match event {
            Event::Started { stage, row } => {
                self.ahead();
                self.started(stage);
                if let Some(live) = self.stages().get_mut(stage) {
                    live.running.entry(row).or_default().push(Instant::now());
                }
            }
            Event::Progress { stage, row, progress } if progress.warning => self.warn(stage, row, &progress.note),
            Event::Progress { stage, row, progress } => {
                if let Some(bar) = self.stages().get(stage).and_then(|live| live.bar.as_ref()) {
                    let row = row.map_or_else(String::new, |row| format!("[{}] ", row + 1));
                    let part = progress.fraction.map_or_else(String::new, |part| format!("{:.0} % ", 100.0 * part));
                    bar.set_message(on_screen(&format!("{row}{part}{}", progress.note)));
                }
            }
            Event::Counted { stage, count, is_done } => {
                // Nothing is said yet: where all is cached, it is over at once.
                let mut whole = self.counts();
                if is_done { whole.close(stage, count) } else { whole.note(stage, count, None) }
            }
            Event::Asked { stage, count, note } => self.asked(stage, count, note),
            Event::Ended { stage, row, count, failure } => {
                if let Some(why) = failure {
                    self.say(&format!("error: {}: {why}", task_name(stage, row)));
                }
                self.ended(stage, row, count);
            }
            Event::Word { text } => self.say(&format!("cluster: {text}")),
            Event::Stage { report } => self.closed(report),
        }
    }
}

/// What a warning is about: its words up to the first number; where a number stands among the first two words, its first
/// clause without the numbers.
fn kind_of(words: &str) -> String {
    let end = words.find(|c: char| c.is_ascii_digit()).unwrap_or(words.len());
    let kind = words[..end].trim_end_matches([' ', ':', '(', '-', '~']).trim_end_matches(" is");
    if kind.contains(' ') || end == words.len() {
        return kind.to_owned();
    }
    let clause = words.split([':', ';']).next().unwrap_or_default();
    let parts = clause.split(' ').map(|word| if word.contains(|c: char| c.is_ascii_digit()) { "…" } else { word });
    parts.collect::<Vec<_>>().join(" ")
}

/// A stage or one row of it, as `flow show` takes it.
pub(super) fn task_name(stage: &str, row: Option<usize>) -> String {
    row.map_or_else(|| stage.to_owned(), |row| format!("{stage}[{}]", row + 1))
}

/// Expected rest, elapsed time and rate: what matters most stands first, because a narrow terminal cuts the end off.
fn pace(ended: usize, left: usize, elapsed: f64, expected: Option<f64>) -> String {
    let measured = elapsed / ended as f64;
    // An earlier campaign gives a better estimate than a few tasks.
    let each = expected.filter(|_| ended < 5).unwrap_or(measured);
    let rate = if measured < 1.0 { format!("{:.0}/s", 1.0 / measured) } else { format!("{} each", duration(measured)) };
    format!("{} left, {} elapsed, {rate}", duration(each * left as f64), duration(elapsed))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn warnings_are_of_one_kind_when_they_differ_in_numbers_only() {
        assert_eq!(kind_of("not valid: rotation: 0.031 rad is above 0.018 rad"), "not valid: rotation");
        assert_eq!(kind_of("strain per step is 4.1e-8, above 3e-8"), "strain per step");
        assert_eq!(kind_of("no number"), "no number");
        assert_eq!(kind_of("2 of 27 polygons hold no ball: drop the class"), "… of … polygons hold no ball");
        assert_eq!(kind_of("only 1938 balls; the peak is stable from 2000 on"), "only … balls");
    }

    #[test]
    fn a_task_that_ended_takes_no_room() {
        let mut live = Live::new(None);
        let row = Some(3);
        live.running.insert(row, vec![Instant::now(); 2]);
        assert!(live.count_ended(row, 0).is_some() && live.running.len() == 1, "another task of the row still runs");
        live.count_ended(row, 0);
        live.count_ended(Some(4), 0);
        assert_eq!((live.running.len(), live.timed.0, live.ended), (0, 2, 3));
    }

    #[test]
    fn the_rest_is_expected_from_earlier_runs_until_this_one_has_told_enough() {
        assert_eq!(pace(1, 10, 1.0, Some(4.0)), "40 s left, 1.0 s elapsed, 1.0 s each");
        assert_eq!(pace(5, 10, 5.0, Some(4.0)), "10 s left, 5.0 s elapsed, 1.0 s each");
    }
}
