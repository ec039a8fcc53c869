//! One queue as its submitter sees it: the tasks in its lists, its workers, and their reports.

use super::line::Line;
use super::message::Message;
use super::scheduler::{Alive, Scheduler};
use super::script::{self, Order, script};
use super::site::{Needs, Site};
use crate::artifact::Key;
use crate::store::{LookedAfter, Queue, Store, StoreError};
use serde::{Deserialize, Serialize};
use std::collections::{BTreeSet, HashMap};
use std::path::Path;
use std::time::{Duration, Instant};

/// A task of the queue.
pub struct Entry {
    /// Its key.
    pub key: Key,
    /// The line that lists it.
    pub line: Line,
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

/// A worker, by its report.
struct Seen {
    from: u64,
    round: usize,
    index: usize,
    machine: String,
    begun: BTreeSet<usize>,
    ended: bool,
    /// Whether a free lock proves that it has ended: its lock was seen held, or locks of its machine are visible here.
    locked: bool,
    heard: Instant,
}

/// A queue that this process serves.
pub struct Post {
    /// The queue.
    pub queue: Queue,
    /// The needs of its tasks.
    pub needs: Needs,
    /// Its tasks.
    pub entries: Vec<Entry>,
    lists: usize,
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
/// Pause after a refusal, while some workers are there.
const REFUSED: Duration = Duration::from_secs(60);
/// Largest number of submissions in a row that may end without a finished task.
const MOST_IDLE: usize = 3;

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
            lists: 0,
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
        while let Some(text) = post.queue.list(post.lists + 1).map_err(words)? {
            post.lists += 1;
            let lines = text.lines().map(|line| serde_json::from_str(line).ok());
            let Some(lines) = lines.collect::<Option<Vec<Line>>>() else { return Ok(None) };
            post.enter(lines);
        }
        while let Some(text) = post.queue.round(post.rounds.len() + 1).map_err(words)? {
            let Ok(round) = serde_json::from_str(&text) else { return Ok(None) };
            post.rounds.push(round);
        }
        if let Some(entry) = post.entries.first() {
            let needs = site.needs(&entry.line.stage);
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

    fn enter(&mut self, lines: Vec<Line>) {
        for line in lines {
            if let Some(key) = Key::from_hex(&line.key) {
                self.entries.push(Entry { key, line, open: true });
            }
        }
    }

    /// Lists tasks; their numbers are those of the entries from then on.
    ///
    /// # Errors
    /// The store cannot be written.
    pub fn list(&mut self, lines: Vec<Line>) -> Result<(), StoreError> {
        let text: Vec<String> = lines.iter().map(Line::to_text).collect();
        self.queue.put_list(self.lists + 1, &(text.join("\n") + "\n"))?;
        self.lists += 1;
        self.enter(lines);
        Ok(())
    }

    /// Numbers of the jobs.
    pub fn jobs(&self) -> Vec<String> {
        self.rounds.iter().map(|round| round.job.clone()).collect()
    }

    /// Tasks that have not ended.
    pub fn left(&self) -> usize {
        self.entries.iter().filter(|entry| entry.open).count()
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
        self.entries[task].open = false;
    }

    /// Requests the missing workers; returns messages for the person watching.
    ///
    /// # Errors
    /// No worker can be had, or the workers end without doing anything.
    pub fn staff(
        &mut self,
        site: &Site,
        store: &Path,
        program: &Path,
        scheduler: &dyn Scheduler,
    ) -> Result<Vec<String>, String> {
        let begun: usize = self.workers.values().filter(|worker| !worker.ended).map(|worker| worker.begun.len()).sum();
        let (open, active) = (self.left(), self.active());
        let each = if self.needs.alone { 1 } else { self.needs.cpus };
        let want = self.needs.workers.min(open.div_ceil(each));
        let paused = self.refused.is_some_and(|when| when.elapsed() < REFUSED);
        if open <= begun || active >= want || (paused && active > 0) {
            return Ok(Vec::new());
        }
        self.count_idle()?;
        let mut workers = want - active;
        loop {
            match self.submit(site, store, program, scheduler, workers) {
                Ok(job) => {
                    let plural = |count: usize| if count == 1 { "" } else { "s" };
                    let (many, more) = (plural(workers), plural(open));
                    return Ok(vec![format!("job {job}: {workers} worker{many} for {open} task{more}")]);
                }
                // A limit on jobs may leave room for fewer.
                Err(_) if workers > 1 => workers /= 2,
                Err(why) => {
                    self.refused = Some(Instant::now());
                    if active == 0 {
                        let hint =
                            "see the limits of your account, and partition, memory, time and workers in the site file";
                        return Err(format!("no job was accepted: {why} ({hint})"));
                    }
                    return Ok(vec![format!("no more jobs now ({why}); {active} workers go on")]);
                }
            }
        }
    }

    fn count_idle(&mut self) -> Result<(), String> {
        let ended = |round: &&Round| round.gone.len() >= round.workers;
        let ended = self.rounds.iter().filter(ended).count();
        self.idle_rounds += ended - self.counted.min(ended);
        self.counted = ended;
        if self.idle_rounds < MOST_IDLE {
            return Ok(());
        }
        let fault = self.fault.clone().unwrap_or_else(|| "they left no message".to_owned());
        Err(format!("the workers of {} submissions ended and finished no task: {fault}", self.idle_rounds))
    }

    fn submit(
        &mut self,
        site: &Site,
        store: &Path,
        program: &Path,
        scheduler: &dyn Scheduler,
        workers: usize,
    ) -> Result<String, String> {
        let (folder, secret, round) = (self.queue.path(), self.queue.secret(), self.rounds.len() + 1);
        let queue = self.queue.name().to_owned();
        let order = Order {
            site,
            needs: &self.needs,
            queue: &queue,
            folder: &folder,
            store,
            program,
            secret: &secret,
            round,
            workers,
        };
        self.queue.put_script(round, &script(&order)).map_err(|error| error.to_string())?;
        let job = scheduler.submit(&order)?;
        self.note(Round::new(job.clone(), workers)).map_err(|error| error.to_string())?;
        Ok(job)
    }

    fn note(&mut self, round: Round) -> Result<(), StoreError> {
        let text = serde_json::to_string(&round).unwrap_or_default();
        self.queue.put_round(self.rounds.len() + 1, &text)?;
        self.rounds.push(round);
        Ok(())
    }

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
                self.gone(round, index);
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
        if let Some(task) = message.task().filter(|task| self.entries.get(*task).is_some_and(|entry| entry.open)) {
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
                .filter(|task| self.entries.get(*task).is_some_and(|entry| entry.open))
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

impl Round {
    fn new(job: String, workers: usize) -> Self {
        Self { job, workers, started: BTreeSet::new(), gone: BTreeSet::new(), since: Instant::now() }
    }
}
