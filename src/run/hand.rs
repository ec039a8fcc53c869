//! The part of the run loop that hands tasks over to workers on other machines and acts on their news.

use super::board::NodeId;
use super::far::{Far, Heard, Leave};
use super::{Answer, Cluster, Event, Loop, Watch, task};
use crate::artifact::{ContentHash, Key};
use crate::cluster::Line;
use crate::stage::rows::GATHER;
use crate::stage::{Failure, StageError, is_far};
use crate::store::{Claim, Store, StoreError};
use std::sync::atomic::Ordering;

/// The cluster of a run, with what an earlier submitter has left there, or why nothing can be begun.
pub(super) fn cluster<'a>(
    store: &'a Store,
    cluster: Option<&'a Cluster>,
    watch: &dyn Watch,
) -> (Option<Far<'a>>, Option<String>) {
    let Some(cluster) = cluster else { return (None, None) };
    let (far, words, adopted) = Far::new(store, &cluster.site);
    words.iter().for_each(|text| watch.event(Event::Word { text }));
    (Some(far), adopted.err())
}

impl Loop<'_, '_> {
    /// Hands tasks that take long over to the workers on other machines.
    pub(super) fn hand_over(&mut self) {
        let Some(far) = &mut self.far else { return };
        let goes = |node: &NodeId| {
            let stage = &self.workflow.stages[self.board.stage(*node)].name;
            let task = self.board.task(*node);
            // A gathering task needs a summary of each run, which is here.
            // Workers do not know of one another, so they could not keep a bound on a program's runs.
            task.work != GATHER.name && task.at_once.is_none() && far.takes(stage, is_far(task.work))
        };
        let nodes: Vec<NodeId> = self.ready.iter().filter(goes).collect();
        for node in nodes {
            self.ready.remove(node);
            let Some(key) = self.board.key_of(node) else {
                panic!("BUG: a task was ready before its inputs were known")
            };
            // By another node of this key, or in a queue of an earlier run.
            let is_listed = self.far.as_ref().is_some_and(|far| far.has(&key));
            self.board.hand_over(node);
            if is_listed {
                continue;
            }
            if let Err(lost) = self.hand(node, key)
                && let Err(error) = self.recompute(*lost)
            {
                self.take(Answer { node, result: Err(error.into()) });
            }
        }
        match self.far.as_mut().map(Far::send) {
            None => {}
            Some(Ok(words)) => words.iter().for_each(|text| self.watch.event(Event::Word { text })),
            Some(Err(why)) => {
                self.refused.get_or_insert(why);
            }
        }
    }

    fn hand(&mut self, node: NodeId, key: Key) -> Result<(), Box<task::Lost>> {
        let stage = &self.workflow.stages[self.board.stage(node)].name;
        let contents = self.board.inputs(node).unwrap_or_default();
        let locate = |content: &ContentHash| {
            self.store.locate(content).map_err(|error| Box::new(task::Lost { content: *content, error }))
        };
        let inputs = contents.iter().map(locate).collect::<Result<Vec<_>, _>>()?;
        if !self.most_seconds.contains_key(stage) {
            let read = self.past().and_then(|past| past.most_seconds(stage));
            self.most_seconds.insert(stage.clone(), read);
        }
        let seconds = self.most_seconds[stage];
        let line = Line::new(self.board.task(node), &key, stage, &inputs, seconds);
        let put = self.far.as_mut().map(|far| far.put(stage, key, &line));
        if let Some(Err(error)) = put {
            self.refused.get_or_insert(error.to_string());
        }
        Ok(())
    }

    /// Whether no result is expected from workers on other machines.
    pub(super) fn far_rests(&mut self) -> bool {
        let at_once = self.stop.load(Ordering::Relaxed) || self.fatal.is_some() || self.refused.is_some();
        let ends = self.ends();
        let Some(far) = &mut self.far else { return true };
        if ends && !at_once {
            // A task failed: what is begun is finished, as here.
            far.drain();
        }
        at_once || far.is_idle()
    }

    /// Reads what the workers on other machines report.
    pub(super) fn listen(&mut self) {
        let Some(far) = &mut self.far else { return };
        let heard = match far.hear() {
            Ok(heard) => heard,
            Err(error) => {
                self.fatal.get_or_insert(error);
                return;
            }
        };
        if heard.iter().any(|heard| matches!(heard, Heard::Done(..) | Heard::Open(_)))
            && let Err(error) = self.store.refresh()
        {
            self.fatal.get_or_insert(error);
            return;
        }
        heard.into_iter().for_each(|heard| self.hears(heard));
    }

    fn hears(&mut self, heard: Heard) {
        let stage_and_row = |key: &Key, run: &Self| {
            let node = run.board.away(key)?;
            Some((run.workflow.stages[run.board.stage(node)].name.as_str(), run.board.row(node)))
        };
        match heard {
            Heard::Word(text) => self.watch.event(Event::Word { text: &text }),
            Heard::Begun(key) => {
                if let Some((stage, row)) = stage_and_row(&key, self) {
                    self.watch.event(Event::Started { stage, row });
                }
            }
            Heard::Stands(key, progress) => {
                if let Some((stage, row)) = stage_and_row(&key, self) {
                    self.watch.event(Event::Progress { stage, row, progress: &progress });
                }
            }
            Heard::Done(key, seconds) => match self.store.find(&key) {
                Ok(Some(record)) => {
                    let finished = task::Finished { content: record.content, shared: false, seconds, summary: None };
                    self.is_over(&key, Ok(task::Outcome::Finished(finished)));
                }
                // It is not seen yet.
                Ok(None) => {}
                Err(error) => {
                    self.fatal.get_or_insert(error);
                }
            },
            Heard::Failed(key, why) => self.is_over(&key, Err(StageError::new(why).into())),
            Heard::Open(key) => {
                self.far.iter_mut().for_each(|far| far.forget(&key));
                while let Some(node) = self.board.take_back(&key) {
                    self.decide_again(node, &key);
                }
            }
            Heard::Lost(content, why) => {
                let error = StoreError::Missing { content };
                if self.recompute(task::Lost { content, error }).is_err() {
                    self.refused.get_or_insert(why);
                }
            }
        }
    }

    /// Other processes on the same store have let go of these tasks, finished or not.
    pub(super) fn let_go(&mut self, nodes: Vec<NodeId>) {
        for node in nodes {
            match (&self.far, self.board.key_of(node)) {
                // Workers do not look into the journals, so they would compute again what is finished.
                (Some(_), Some(key)) => self.decide_again(node, &key),
                // What is finished is found when it is started.
                _ => self.ready.put(node),
            }
        }
    }

    /// Decides about a task that somebody else may have finished meanwhile, or may compute now.
    fn decide_again(&mut self, node: NodeId, key: &Key) {
        match self.store.claim(key) {
            Ok(Claim::Theirs(waiting)) => self.elsewhere.put(node, waiting),
            Ok(Claim::Done(record)) if !self.forced(node) => {
                let content = record.content;
                let finished = task::Finished { content, shared: true, seconds: 0.0, summary: None };
                self.take(Answer { node, result: Ok(task::Outcome::Finished(finished)) });
            }
            Ok(Claim::Mine(_) | Claim::Done(_)) => self.settle(node),
            Err(error) => {
                self.fatal.get_or_insert(error);
            }
        }
    }

    /// A task that was handed over has ended.
    fn is_over(&mut self, key: &Key, result: Result<task::Outcome, Failure>) {
        self.far.iter_mut().for_each(|far| far.forget(key));
        if let Some(node) = self.board.take_back(key) {
            self.take(Answer { node, result });
        }
        // What others with the same key wait for is known now.
        while let Some(node) = self.board.take_back(key) {
            self.settle(node);
        }
    }

    /// Ends with the workers on other machines.
    pub(super) fn leave(&mut self) {
        let working = self.stop.load(Ordering::Relaxed)
            && self.settings.cluster.as_ref().is_some_and(|cluster| cluster.leave.load(Ordering::Relaxed));
        let Some(far) = &mut self.far else { return };
        let computed = (0..self.workflow.stages.len()).any(|stage| self.board.count(stage).ran > 0);
        if far.is_unused() && computed && !working {
            let text = "no workers were asked for: what was computed took moments, here (`here = false` below \
                        `[stage.NAME]` of the site file sends a stage all the same)";
            self.watch.event(Event::Word { text });
        }
        let words = far.end(if working { Leave::Working } else { Leave::Cancel });
        words.iter().for_each(|text| self.watch.event(Event::Word { text }));
    }
}
