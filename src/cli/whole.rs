//! How far the whole campaign is: tasks that ended of those that are known or expected, and the time that is left.

use crate::report::duration;
use crate::run::TaskCount;
use crate::stage::forecast::{Forecast, TaskForecast};
use std::collections::BTreeMap;

/// The stages of a campaign and how far each is.
#[derive(Default)]
pub(super) struct Whole {
    stages: BTreeMap<String, Part>,
}

/// One stage.
#[derive(Default)]
struct Part {
    /// Tasks that it is expected to ask for.
    expected: usize,
    /// Tasks that it asked for, and those of them that ended.
    total: usize,
    ended: usize,
    closed: bool,
    /// Seconds of one of its tasks, from earlier runs or as measured in this one.
    seconds: Option<f64>,
}

impl Part {
    /// Tasks, known or expected.
    fn tasks(&self) -> usize {
        if self.closed { self.total } else { self.total.max(self.expected) }
    }

    fn left(&self) -> usize {
        if self.closed { 0 } else { self.tasks() - self.ended }
    }
}

impl Whole {
    /// Adds the stages that are ahead with the tasks that they are expected to ask for.
    pub(super) fn look_ahead<'a>(&mut self, forecasts: impl IntoIterator<Item = (&'a str, Forecast)>) {
        for (name, forecast) in forecasts {
            self.part(name).expected = forecast.tasks.map_or(0, TaskForecast::count);
        }
    }

    fn part(&mut self, stage: &str) -> &mut Part {
        self.stages.entry(stage.to_owned()).or_default()
    }

    /// Records the progress of a stage; `seconds`: of one of its tasks.
    pub(super) fn note(&mut self, stage: &str, count: TaskCount, seconds: Option<f64>) {
        let part = self.part(stage);
        (part.total, part.ended) = (count.total, count.ended());
        part.seconds = seconds.or(part.seconds);
    }

    /// The tasks of a stage that ended, and all that it asked for.
    pub(super) fn counts(&self, stage: &str) -> [usize; 2] {
        self.stages.get(stage).map_or([0; 2], |part| [part.ended, part.total])
    }

    /// A stage has ended.
    pub(super) fn close(&mut self, stage: &str, count: TaskCount) {
        self.note(stage, count, None);
        self.part(stage).closed = true;
    }

    /// Fills in the durations of earlier runs where this one has measured none.
    pub(super) fn expect(&mut self, seconds: impl Fn(&str) -> Option<f64>) {
        for (name, part) in &mut self.stages {
            part.seconds = part.seconds.or_else(|| seconds(name));
        }
    }

    /// In a few words, for `workers` tasks at a time; nothing of a campaign of one stage.
    pub(super) fn in_words(&self, workers: usize) -> Option<String> {
        if self.stages.len() < 2 {
            return None;
        }
        let sum = |of: fn(&Part) -> usize| self.stages.values().map(of).sum::<usize>();
        let (ended, tasks) = (sum(|part| part.ended), sum(Part::tasks));
        let left = self.stages.values().filter(|part| part.left() > 0);
        let timed = left.clone().filter_map(|part| Some(part.seconds? * part.left() as f64)).sum::<f64>();
        // A single task, as of a table or a figure, takes no time that counts.
        let untimed = left.filter(|part| part.left() > 1 && part.seconds.is_none()).count();
        let time = duration(timed / workers as f64);
        Some(match (timed > 0.0, untimed) {
            (true, 0) => format!("campaign {ended}/{tasks}, {time} left"),
            (true, _) => format!("campaign {ended}/{tasks}, more than {time} left"),
            (false, _) => format!("campaign {ended}/{tasks}"),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn count(total: usize, ran: usize) -> TaskCount {
        TaskCount { total, ran, ..TaskCount::default() }
    }

    fn runs(tasks: usize) -> Forecast {
        Forecast { tasks: Some(TaskForecast::Exactly(tasks)), ..Forecast::ONE }
    }

    #[test]
    fn the_rest_counts_stages_that_have_not_begun() {
        let mut whole = Whole::default();
        whole.note("runs", count(10, 3), None);
        assert_eq!(whole.in_words(2), None, "nothing is known of other stages");
        whole.look_ahead([("runs", runs(10)), ("more", runs(5)), ("table", Forecast::ONE)]);
        assert_eq!(whole.in_words(2).unwrap(), "campaign 3/16");
        whole.note("runs", count(10, 4), Some(3.0));
        assert_eq!(whole.in_words(2).unwrap(), "campaign 4/16, more than 9.0 s left");
        whole.expect(|_| Some(2.0));
        // 6 × 3 s, 5 × 2 s and 1 × 2 s by two workers
        assert_eq!(whole.in_words(2).unwrap(), "campaign 4/16, 15 s left");
        whole.close("runs", count(10, 10));
        whole.close("more", count(3, 3));
        whole.close("table", count(1, 1));
        assert_eq!(whole.in_words(2).unwrap(), "campaign 14/14");
        // What is in the store does not run again, whether its stage has begun or not.
        let mut stored = Whole::default();
        stored.note("runs", TaskCount { total: 10, cached: 8, ..TaskCount::default() }, None);
        stored.close("more", TaskCount { total: 5, cached: 5, ..TaskCount::default() });
        stored.look_ahead([("runs", runs(10)), ("more", runs(5))]);
        stored.expect(|_| Some(2.0));
        assert_eq!(stored.in_words(2).unwrap(), "campaign 13/15, 2.0 s left");
        let mut alone = Whole::default();
        alone.look_ahead([("one", Forecast::ONE)]);
        assert_eq!(alone.in_words(1), None);
    }
}
