//! A worker takes tasks from the lists of a queue until none is left, and reports what it does.
//!
//! It opens no journal: the lists say which tasks are open and where their inputs are, and the marker of a task says whether
//! a worker has begun it. Its output goes to the log of its job; the submitter reads the report only.

use super::{panicked, stages, task};
use crate::artifact::Artifact;
use crate::cluster::lists::Lists;
use crate::cluster::slices::{Patience, Slices};
use crate::cluster::{Cause, Line, Message};
use crate::exec::{Share, Threads, with_threads};
use crate::stage::{Failure, Progress};
use crate::store::{Queue, ReportFile, Store, StoreError};
use std::collections::HashMap;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

/// Settings with which a worker starts.
pub struct Worker {
    /// Which submission of the queue it belongs to, from 1.
    pub round: usize,
    /// Which worker of that submission it is, from 0.
    pub index: usize,
    /// How many workers were submitted.
    pub of: usize,
    /// Cores that it may use.
    pub cpus: usize,
    /// How long it may live, seconds.
    pub seconds: Option<f64>,
    /// How long it waits for more when it has nothing to do, seconds.
    pub linger: f64,
    /// Whether it takes one task only.
    pub alone: bool,
}

/// The outcome of a worker.
#[derive(Debug, Default, PartialEq, Eq)]
pub struct Worked {
    /// Tasks whose results it stored.
    pub done: usize,
    /// Tasks that failed.
    pub failed: usize,
    /// Whether it ended because too little of its time was left.
    pub out_of_time: bool,
}

/// Pause between two looks for new lists.
const LOOK_EACH: Duration = Duration::from_millis(200);
/// Pause between two reports of where a task stands.
const STANDS_EACH: Duration = Duration::from_secs(5);
/// Part of a worker's life that is left for ending it, and the most that is.
const ENDING: (f64, f64) = (0.05, 60.0);
/// A task that begins within this first part of a worker's life counts as having had all of it.
const FRESH: f64 = 0.1;

/// First digits of the digest of this program.
pub fn program() -> String {
    let bytes = std::env::current_exe().and_then(std::fs::read).unwrap_or_default();
    blake3::hash(&bytes).to_hex()[..16].to_owned()
}

impl Worker {
    /// Works until nothing is left, the time is over, or `stop` is set.
    ///
    /// # Errors
    /// The store cannot be read or written, or the lists are not for this program; the report says it too.
    pub fn work(&self, store: &Store, queue: &Queue, stop: &AtomicBool) -> Result<Worked, String> {
        let machine = store.origin().machine.clone();
        let plain: String = machine.chars().filter(char::is_ascii_alphanumeric).take(24).collect();
        let name = format!("{:04}-{:04}-{plain}-{}", self.round, self.index, std::process::id());
        let report = Mutex::new(queue.report(&name).map_err(|error| error.to_string())?);
        let send = |message: &Message| tell(&report, message).map_err(|error| error.to_string());
        send(&Message::Started { round: self.round, index: self.index, machine, program: program() })?;
        let ending = AtomicBool::new(false);
        let (answers, inbox) = channel();
        let worked = with_threads(self.cpus, |pool| {
            Loop {
                worker: self,
                started: Instant::now(),
                store,
                queue,
                stop,
                ending: &ending,
                report: &report,
                pool,
                answers,
                lists: Lists::default(),
                slices: Slices::new(self.index, self.of),
                running: HashMap::new(),
                lasted: HashMap::new(),
                begun: 0,
                patience: Patience::default(),
                worked: Worked::default(),
            }
            .go(&inbox)
        });
        let worked =
            worked.unwrap_or_else(|error| Err(format!("the system grants no {} threads ({error})", self.cpus)));
        // Without room for this line the lock of the report says that the worker is gone.
        let _ = send(&Message::Ended { fault: worked.as_ref().err().cloned() });
        worked
    }
}

fn tell(report: &Mutex<ReportFile>, message: &Message) -> Result<(), StoreError> {
    report.lock().unwrap_or_else(PoisonError::into_inner).say(&message.to_text())
}

struct Answer {
    task: usize,
    message: Message,
    /// A fault of the store or of this program, after which no task is begun.
    fault: Option<String>,
}

struct Loop<'pool, 'env> {
    worker: &'env Worker,
    started: Instant,
    store: &'env Store,
    queue: &'env Queue,
    /// The scheduler, or a person, has asked the worker to end.
    stop: &'env AtomicBool,
    /// Tasks are to end.
    ending: &'env AtomicBool,
    report: &'env Mutex<ReportFile>,
    pool: Threads<'pool, 'env>,
    answers: Sender<Answer>,
    lists: Lists,
    slices: Slices,
    /// Running tasks: when in the life of the worker each began, seconds, and its stage.
    running: HashMap<usize, (f64, String)>,
    /// By stage: the longest duration of a task so far, seconds.
    lasted: HashMap<String, f64>,
    begun: usize,
    patience: Patience,
    worked: Worked,
}

impl Loop<'_, '_> {
    fn go(mut self, inbox: &Receiver<Answer>) -> Result<Worked, String> {
        let (mut idle, mut looked, mut fault) = (Instant::now(), None::<Instant>, None);
        let mut closed = false;
        loop {
            if fault.is_none() && looked.is_none_or(|when| when.elapsed() > LOOK_EACH) {
                fault = self.look().err();
                closed = self.queue.is_closed();
                looked = Some(Instant::now());
            }
            let over = self.left() <= 0.0;
            let ends = closed || over || fault.is_some() || self.stop.load(Ordering::Relaxed);
            if over || self.stop.load(Ordering::Relaxed) {
                self.worked.out_of_time |= over;
                self.ending.store(true, Ordering::Relaxed);
            }
            if !ends && let Err(error) = self.begin() {
                fault = Some(error);
            }
            if !self.running.is_empty() {
                idle = Instant::now();
            } else if ends
                || fault.is_some()
                || self.worked.out_of_time
                || (self.worker.alone && self.begun > 0)
                || idle.elapsed().as_secs_f64() >= self.worker.linger
            {
                break;
            }
            if let Ok(answer) = inbox.recv_timeout(LOOK_EACH / 2) {
                let error = self.take(answer).err();
                fault = fault.or(error);
            }
        }
        fault.map_or(Ok(self.worked), Err)
    }

    /// Reads new lists.
    fn look(&mut self) -> Result<(), String> {
        let first = self.lists.tasks();
        while let Some(tasks) = self.lists.read(self.queue).map_err(|error| error.to_string())? {
            self.slices.add(tasks);
        }
        // Workers of a later round skip the tasks that are begun.
        if first < self.lists.tasks() { self.forget_begun().map(drop) } else { Ok(()) }
    }

    /// Forgets what others have begun; returns how many tasks that are.
    fn forget_begun(&mut self) -> Result<usize, String> {
        let begun = self.queue.begun().map_err(|error| error.to_string())?;
        Ok(self.slices.forget(&begun.into_iter().collect()))
    }

    /// Seconds that are left for tasks.
    fn left(&self) -> f64 {
        let Some(seconds) = self.worker.seconds else { return f64::INFINITY };
        seconds - (ENDING.0 * seconds).min(ENDING.1) - self.started.elapsed().as_secs_f64()
    }

    /// Begins tasks as long as there are threads and time for them.
    fn begin(&mut self) -> Result<(), String> {
        let most = if self.worker.alone { 1 } else { self.pool.count() };
        while self.running.len() < most && !(self.worker.alone && self.begun > 0) {
            let Some(task) = self.slices.take() else { return Ok(()) };
            let line = self.lists.line(self.queue, task)?;
            // The first task of a worker has as much time as any worker can give it.
            let expected = line.seconds.into_iter().chain(self.lasted.get(&line.stage).copied()).fold(0.0, f64::max);
            if self.begun > 0 && expected > self.left() {
                self.slices.put_back(task);
                self.worked.out_of_time = true;
                return Ok(());
            }
            if !self.queue.begin(task).map_err(|error| error.to_string())? {
                if self.patience.miss() {
                    let found = self.forget_begun()?;
                    self.patience.looked(found);
                }
                continue;
            }
            self.patience = Patience::default();
            tell(self.report, &Message::Begun { task }).map_err(|error| error.to_string())?;
            self.begun += 1;
            self.running.insert(task, (self.started.elapsed().as_secs_f64(), line.stage.clone()));
            self.give(task, line);
        }
        Ok(())
    }

    fn give(&self, task: usize, line: Line) {
        let (store, report, ending, answers) = (self.store, self.report, self.ending, self.answers.clone());
        let last_report = Mutex::new(None::<Instant>);
        self.pool.give(move |share| {
            let say = |progress: Progress| {
                let mut last = last_report.lock().unwrap_or_else(PoisonError::into_inner);
                if progress.warning || last.is_none_or(|when| when.elapsed() > STANDS_EACH) {
                    *last = Some(Instant::now());
                    let Progress { fraction, note, warning } = progress;
                    // A report that cannot be written shows at the end of the task.
                    let _ = tell(report, &Message::Stands { task, fraction, note, warning });
                }
            };
            let done = catch_unwind(AssertUnwindSafe(|| execute(task, &line, store, share, &say, ending)));
            let (message, fault) = done.unwrap_or_else(|panic| (failed(task, panicked(&*panic)), None));
            // The loop may be gone only when it panicked; then nobody waits for this answer.
            let _ = answers.send(Answer { task, message, fault });
        });
    }

    fn take(&mut self, Answer { task, mut message, fault }: Answer) -> Result<(), String> {
        let (since, stage) = self.running.remove(&task).unwrap_or_default();
        match &mut message {
            Message::Done { seconds, .. } => {
                self.worked.done += 1;
                let longest = self.lasted.entry(stage).or_default();
                *longest = longest.max(*seconds);
            }
            Message::Failed { .. } => self.worked.failed += 1,
            Message::Stopped { cause: cause @ Cause::Time, .. } => {
                *cause = match self.worker.seconds {
                    _ if self.stop.load(Ordering::Relaxed) => Cause::Signal,
                    Some(seconds) if since < FRESH * seconds => Cause::WholeTime,
                    _ => Cause::Time,
                };
            }
            _ => {}
        }
        let send = tell(self.report, &message).map_err(|error| error.to_string());
        match fault {
            Some(fault) => Err(fault),
            None => send,
        }
    }
}

fn failed(task: usize, failure: Failure) -> Message {
    match failure {
        Failure::Stopped => Message::Stopped { task, cause: Cause::Time },
        Failure::Failed(error) => Message::Failed { task, why: stages::in_words(error) },
    }
}

/// Computes and stores one task; what to report, and what is wrong with the store or this program.
fn execute(
    task: usize,
    line: &Line,
    store: &Store,
    share: &Share,
    say: &(dyn Fn(Progress) + Sync),
    ending: &AtomicBool,
) -> (Message, Option<String>) {
    let stopped = Message::Stopped { task, cause: Cause::Store };
    let errand = match line.errand() {
        Ok(errand) => errand,
        Err(why) => return (stopped, Some(why)),
    };
    let mut inputs: Vec<(String, Arc<Artifact>)> = Vec::new();
    for (name, located) in &errand.inputs {
        match store.get_located(located) {
            Ok(artifact) => inputs.push((name.clone(), artifact)),
            Err(error) if error.is_missing() => {
                let input = located.object.content.to_string();
                return (Message::Lost { task, input, why: error.to_string() }, None);
            }
            Err(error) => return (stopped, Some(error.to_string())),
        }
    }
    let claim = match store.claim_unseen(&errand.key) {
        Ok(Some(claim)) => claim,
        Ok(None) => return (Message::Elsewhere { task }, None),
        Err(error) => return (stopped, Some(error.to_string())),
    };
    match task::compute(&errand.task, &inputs, share, say, ending) {
        Ok((artifact, timing)) => match store.finish(claim, errand.text, artifact, &timing) {
            Ok(_) => (Message::Done { task, seconds: timing.seconds }, None),
            Err(error @ StoreError::Unstorable(_)) => (Message::Failed { task, why: error.to_string() }, None),
            Err(error) => (stopped, Some(error.to_string())),
        },
        Err(failure) => (failed(task, failure), None),
    }
}
