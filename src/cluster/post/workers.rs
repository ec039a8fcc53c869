//! What the reports of its workers, and the scheduler, say about a queue.

use super::{LISTED_AFTER, News, Post, Reports};
use crate::cluster::message::Message;
use crate::cluster::scheduler::Alive;
use crate::cluster::script;
use crate::store::StoreError;
use std::collections::BTreeSet;
use std::time::{Duration, Instant};

/// A worker, by its report.
pub(super) struct Seen {
    from: u64,
    round: usize,
    index: usize,
    machine: String,
    pub(super) begun: BTreeSet<usize>,
    pub(super) ended: bool,
    /// Whether a free lock proves that it has ended: its lock was seen held, or locks of its machine are visible here.
    locked: bool,
    heard: Instant,
}

impl Post {
    /// Reads new messages of the workers.
    ///
    /// # Errors
    /// The store cannot be read.
    pub fn read(&mut self) -> Result<Reports, StoreError> {
        let (mut news, mut words) = (Vec::new(), Vec::new());
        for name in self.queue.reports()? {
            if self.workers.get(&name).is_some_and(|worker| worker.ended) {
                continue;
            }
            let from = self.workers.get(&name).map_or(0, |worker| worker.from);
            let (text, length, held) = self.queue.news(&name, from)?;
            for message in text.lines().filter_map(Message::read) {
                self.heard(&name, message, &mut news, &mut words);
            }
            let Some(worker) = self.workers.get_mut(&name) else { continue };
            worker.from += length;
            if length > 0 {
                worker.heard = Instant::now();
            }
            self.reach |= held && worker.machine != self.machine;
            worker.locked |= held || self.reach || worker.machine == self.machine;
            // Its lock is free, so it was lost. Its last messages may become visible late.
            if worker.locked && !held && !worker.ended && worker.heard.elapsed() > Duration::from_millis(1500) {
                self.lose(&name, &mut news, &mut words);
            }
        }
        Ok(Reports { news, words })
    }

    fn heard(&mut self, name: &str, message: Message, news: &mut Vec<(usize, News)>, words: &mut Vec<String>) {
        if let Message::Started { round, index, machine, .. } = &message {
            if let Some(round) = round.checked_sub(1).and_then(|round| self.rounds.get_mut(round)) {
                round.started.insert(*index);
            }
            self.workers.entry(name.to_owned()).or_insert_with(|| Seen {
                from: 0,
                round: *round,
                index: *index,
                machine: machine.clone(),
                begun: BTreeSet::new(),
                ended: false,
                locked: false,
                heard: Instant::now(),
            });
            return;
        }
        let Some(worker) = self.workers.get_mut(name) else { return };
        match &message {
            Message::Begun { task } => drop(worker.begun.insert(*task)),
            Message::Ended { fault } => {
                worker.ended = true;
                let (round, index) = (worker.round, worker.index);
                if let Some(fault) = fault {
                    words.push(format!("worker on {}: {fault}", worker.machine));
                    self.fault = Some(format!("worker on {}: {fault}", worker.machine));
                }
                // A worker ends when nothing runs, so what it has said of these was lost: its disk may have been full.
                let begun = std::mem::take(&mut worker.begun);
                self.gone(round, index);
                let open = begun.into_iter().filter(|task| self.is_open(*task));
                news.extend(open.map(|task| (task, News::Message(Message::Elsewhere { task }))));
                return;
            }
            Message::Done { task, .. } | Message::Failed { task, .. } => {
                worker.begun.remove(task);
                self.idle_rounds = 0;
            }
            Message::Stopped { task, .. } | Message::Elsewhere { task } | Message::Lost { task, .. } => {
                worker.begun.remove(task);
            }
            Message::Stands { .. } | Message::Started { .. } => {}
        }
        if let Some(task) = message.task().filter(|task| self.is_open(*task)) {
            news.push((task, News::Message(message)));
        }
    }

    fn gone(&mut self, round: usize, index: usize) {
        if let Some(round) = round.checked_sub(1).and_then(|round| self.rounds.get_mut(round)) {
            round.gone.insert(index);
        }
    }

    /// A worker was lost: it ended without a message.
    fn lose(&mut self, name: &str, news: &mut Vec<(usize, News)>, words: &mut Vec<String>) {
        let Some(worker) = self.workers.get_mut(name) else { return };
        worker.ended = true;
        let begun = std::mem::take(&mut worker.begun);
        let (round, index, machine) = (worker.round, worker.index, worker.machine.clone());
        let words_of_it = self.last_words(round, &index.to_string());
        let tasks = match begun.len() {
            0 => "it had begun nothing".to_owned(),
            1 => "its task is tried again, alone".to_owned(),
            many => format!("its {many} tasks are tried again, each alone"),
        };
        words.push(format!("the worker on {machine} is gone; {tasks}"));
        self.gone(round, index);
        self.fault = Some(format!("the worker on {machine} is gone ({words_of_it})"));
        news.extend(
            begun
                .into_iter()
                .filter(|task| self.is_open(*task))
                .map(|task| (task, News::Gone { machine: machine.clone(), words: words_of_it.clone() })),
        );
    }

    fn last_words(&self, round: usize, index: &str) -> String {
        let log = script::log_name(round, index);
        let words_of_it =
            self.queue.last_words(&log).map_or_else(|| "no output".to_owned(), |line| format!("`{line}`"));
        format!("{words_of_it} in {}", self.queue.path().join(log).display())
    }

    /// Compares with the jobs that the scheduler lists: news of the tasks of lost workers, and messages.
    pub fn apply(&mut self, alive: &Alive) -> Reports {
        let (mut news, mut words) = (Vec::new(), Vec::new());
        for number in 0..self.rounds.len() {
            let round = &self.rounds[number];
            if round.since.elapsed() < LISTED_AFTER {
                continue;
            }
            let there = alive.jobs.get(&round.job);
            let is_there = |index: &usize| match there {
                None => false,
                Some(None) => true,
                Some(Some(indices)) => indices.contains(index),
            };
            let missing: Vec<usize> =
                (0..round.workers).filter(|index| !round.gone.contains(index) && !is_there(index)).collect();
            let never: Vec<usize> = missing.iter().copied().filter(|index| !round.started.contains(index)).collect();
            if let Some(first) = never.first() {
                let words_of_it = self.last_words(number + 1, &first.to_string());
                words.push(format!(
                    "{} of {} workers ended before they began: {words_of_it}",
                    never.len(),
                    round.workers
                ));
                self.fault = Some(words_of_it);
            }
            never.iter().for_each(|index| self.gone(number + 1, *index));
            // A worker whose lock is held is alive whatever the scheduler lists, and so is one that has just written a message.
            let lost: Vec<String> = self
                .workers
                .iter()
                .filter(|(_, worker)| worker.round == number + 1 && missing.contains(&worker.index))
                .filter(|(_, worker)| !worker.ended && !worker.locked && worker.heard.elapsed() > LISTED_AFTER)
                .map(|(name, _)| name.clone())
                .collect();
            lost.iter().for_each(|name| self.lose(name, &mut news, &mut words));
        }
        Reports { news, words }
    }
}
