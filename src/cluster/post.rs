//! One queue as its submitter sees it: the tasks in its lists, its workers, and their reports.

use super::lists::{Draft, Lists};
use super::message::Message;
use super::scheduler::Scheduler;
use super::site::{Needs, Site};
use crate::artifact::Key;
use crate::store::{LookedAfter, Queue, Store, StoreError};
use serde::{Deserialize, Serialize};
use std::collections::{BTreeSet, HashMap};
use std::time::{Duration, Instant};
use workers::Seen;

mod staff;
mod workers;

/// A task of the queue; its line is in a list.
struct Entry {
    key: Key,
    open: bool,
}

/// News of a task.
#[derive(Clone, Debug, PartialEq)]
pub enum News {
    /// A message of a worker.
    Message(Message),
    /// The worker that had begun it is gone.
    Gone {
        /// Its machine.
        machine: String,
        /// Where its output is, and the last line of that.
        words: String,
    },
}

/// News of a queue.
#[derive(Default)]
pub struct Reports {
    /// News of tasks, by their numbers.
    pub news: Vec<(usize, News)>,
    /// Messages about workers.
    pub words: Vec<String>,
}

/// One submission.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Round {
    job: String,
    workers: usize,
    #[serde(skip)]
    started: BTreeSet<usize>,
    /// Workers of it that no longer exist, whether or not they had started.
    #[serde(skip)]
    gone: BTreeSet<usize>,
    #[serde(skip, default = "Instant::now")]
    since: Instant,
}

/// A queue that this process serves.
pub struct Post {
    /// The queue.
    pub queue: Queue,
    /// The needs of its tasks.
    pub needs: Needs,
    /// The tasks from number `before` on; those before it have all ended.
    entries: Vec<Entry>,
    before: usize,
    /// Tasks that have not ended.
    open: usize,
    lists: Lists,
    rounds: Vec<Round>,
    workers: HashMap<String, Seen>,
    lock: Option<LookedAfter>,
    /// This machine.
    machine: String,
    /// Whether a lock that another machine holds has been seen.
    reach: bool,
    /// When the scheduler last refused a submission.
    refused: Option<Instant>,
    /// Submissions in a row that ended without a finished task.
    idle_rounds: usize,
    counted: usize,
    /// The fault of the last worker that ended with one, or that was lost.
    pub fault: Option<String>,
}

/// Ending of the names of queues whose workers take one task each.
const ALONE: &str = "-alone";
/// Jobs submitted more recently than this may not be listed yet.
const LISTED_AFTER: Duration = Duration::from_secs(10);

impl Post {
    /// A new queue.
    ///
    /// # Errors
    /// The store cannot be written.
    pub fn open(store: &Store, name: &str, needs: Needs) -> Result<Self, StoreError> {
        let name = if needs.alone { format!("{name}{ALONE}") } else { name.to_owned() };
        Ok(Self::of(store.make_queue(&name)?, needs, store))
    }

    fn of(queue: Queue, needs: Needs, store: &Store) -> Self {
        let lock = queue.look_after();
        Self {
            queue,
            needs,
            entries: Vec::new(),
            before: 0,
            open: 0,
            lists: Lists::default(),
            rounds: Vec::new(),
            workers: HashMap::new(),
            lock,
            machine: store.origin().machine.clone(),
            reach: false,
            refused: None,
            idle_rounds: 0,
            counted: 0,
            fault: None,
        }
    }

    /// Takes over a queue whose submitter has ended, when some of its jobs still exist.
    ///
    /// # Errors
    /// The store cannot be read, or the scheduler does not answer.
    pub fn adopt(store: &Store, name: &str, site: &Site, scheduler: &dyn Scheduler) -> Result<Option<Self>, String> {
        let queue = store.queue(name, None);
        if queue.is_closed() {
            return Ok(None);
        }
        let mut post = Self::of(queue, site.needs(""), store);
        if post.lock.is_none() {
            return Ok(None);
        }
        let words = |error: StoreError| error.to_string();
        let mut stage = None;
        while let Some(tasks) = post.lists.read(&post.queue).map_err(words)? {
            for task in tasks {
                let Ok(line) = post.lists.line(&post.queue, task) else { return Ok(None) };
                let Some(key) = Key::from_hex(&line.key) else { return Ok(None) };
                post.enter([key]);
                stage.get_or_insert(line.stage);
            }
        }
        while let Some(text) = post.queue.round(post.rounds.len() + 1).map_err(words)? {
            let Ok(round) = serde_json::from_str(&text) else { return Ok(None) };
            post.rounds.push(round);
        }
        if let Some(stage) = stage {
            let needs = site.needs(&stage);
            post.needs = if name.ends_with(ALONE) { needs.again() } else { needs };
        }
        let alive = scheduler.alive(post.queue.name(), &post.jobs())?;
        // The submitter may have ended before it noted the number of a job.
        for (job, indices) in alive.jobs.iter().filter(|(job, _)| !post.jobs().contains(job)).collect::<Vec<_>>() {
            let workers = indices.as_ref().and_then(|indices| indices.iter().max()).map_or(1, |last| last + 1);
            post.note(Round::new(job.clone(), workers)).map_err(words)?;
        }
        post.rounds.iter_mut().for_each(|round| round.since -= 2 * LISTED_AFTER);
        let _ = post.apply(&alive);
        if post.active() == 0 {
            let _ = post.queue.close();
            return Ok(None);
        }
        Ok(Some(post))
    }

    fn enter(&mut self, keys: impl IntoIterator<Item = Key>) {
        for key in keys {
            self.entries.push(Entry { key, open: true });
            self.open += 1;
        }
    }

    /// Lists tasks, by their keys and lines; returns the number of the first one.
    ///
    /// # Errors
    /// The store cannot be written.
    pub fn list(&mut self, keys: impl IntoIterator<Item = Key>, list: &Draft) -> Result<usize, StoreError> {
        let first = self.before + self.entries.len();
        self.lists.write(&self.queue, list)?;
        self.enter(keys);
        Ok(first)
    }

    /// Keys of the tasks by their numbers, as long as some have not ended.
    pub fn keys(&self) -> impl Iterator<Item = Key> {
        self.entries.iter().map(|entry| entry.key)
    }

    /// Key of a task, as long as tasks that were listed with it have not all ended.
    pub fn key(&self, task: usize) -> Option<Key> {
        self.entry(task).map(|entry| entry.key)
    }

    fn entry(&self, task: usize) -> Option<&Entry> {
        self.entries.get(task.checked_sub(self.before)?)
    }

    /// The text of the line that lists a task.
    ///
    /// # Errors
    /// The store cannot be read.
    pub fn line(&mut self, task: usize) -> Result<String, StoreError> {
        self.lists.text(&self.queue, task).map(str::to_owned)
    }

    fn is_open(&self, task: usize) -> bool {
        self.entry(task).is_some_and(|entry| entry.open)
    }

    /// Numbers of the jobs.
    pub fn jobs(&self) -> Vec<String> {
        self.rounds.iter().map(|round| round.job.clone()).collect()
    }

    /// Tasks that have not ended.
    pub fn left(&self) -> usize {
        self.open
    }

    /// Workers that run or wait.
    pub fn active(&self) -> usize {
        self.rounds.iter().map(|round| round.workers.saturating_sub(round.gone.len())).sum()
    }

    /// Workers that run.
    pub fn at_work(&self) -> usize {
        self.workers.values().filter(|worker| !worker.ended).count()
    }

    /// Whether a running worker has begun a task that has not ended.
    pub fn is_busy(&self) -> bool {
        self.workers.values().any(|worker| !worker.ended && !worker.begun.is_empty())
    }

    /// Marks a task as ended.
    pub fn over(&mut self, task: usize) {
        if self.is_open(task) {
            self.entries[task - self.before].open = false;
            self.open -= 1;
        }
        if self.open == 0 {
            self.before += self.entries.len();
            self.entries = Vec::new();
        }
    }

    fn note(&mut self, round: Round) -> Result<(), StoreError> {
        let text = serde_json::to_string(&round).unwrap_or_default();
        self.queue.put_round(self.rounds.len() + 1, &text)?;
        self.rounds.push(round);
        Ok(())
    }
}

impl Round {
    fn new(job: String, workers: usize) -> Self {
        Self { job, workers, started: BTreeSet::new(), gone: BTreeSet::new(), since: Instant::now() }
    }
}

#[cfg(test)]
mod tests;
