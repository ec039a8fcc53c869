//! The run loop: from a checked workflow to results in the store.
//!
//! One thread decides, workers compute. The deciding thread keeps three things:
//!
//! * the [`board`]: every task known so far, as a graph that grows; equal tasks are one node;
//! * the [`stages`]: where each stage of the workflow stands;
//! * the [`queue`]: nodes whose inputs are known and whose result is not in the store.
//!
//! The loop repeats: ask each stage that can go on for its next step; put its tasks on the board; settle every node
//! whose inputs are known by looking its key up in the store; start what is ready; wait for one answer. `plan` is the
//! same loop that starts nothing, so it cannot disagree with `run`.

mod audit;
mod board;
mod campaigns;
mod commit;
mod elsewhere;
mod event;
mod far;
mod files;
mod forecast;
mod hand;
mod library;
mod licences;
mod memo;
#[cfg(test)]
mod pins;
mod queue;
mod report;
mod run_memo;
mod settings;
mod stages;
mod streamed;
mod task;
mod worker;

pub use audit::{Audited, audit};
pub use board::{TaskCount, TaskReport, TaskState};
pub use campaigns::{Past, record};
pub use commit::commit;
pub use event::{Event, Silent, Watch};
pub use forecast::{forecasts, forecasts_of};
pub use memo::remembered;
pub use report::{Report, Unreadable};
pub use settings::{Cluster, RunSettings};
pub use stages::{StageReport, StageStatus};
pub use worker::{Worked, Worker, program};

use crate::artifact::{ContentHash, Key};
use crate::exec::{Threads, with_threads};
use crate::plan::Workflow;
use crate::stage::{Failure, Progress, StageError};
use crate::store::{Store, StoreError};
use board::{Board, NodeId};
use campaigns::RowSeconds;
use elsewhere::Elsewhere;
use far::Far;
use licences::Licences;
use queue::Queue;
use stages::Stages;
use std::any::Any;
use std::cell::OnceCell;
use std::collections::{HashMap, HashSet};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use streamed::Streamed;

/// Runs what is missing of `workflow`, or only decides when the settings say so.
pub fn run(workflow: &Workflow, store: &Store, settings: &RunSettings, watch: &dyn Watch, stop: &AtomicBool) -> Report {
    let (answers, inbox) = channel();
    let jobs = if settings.dry { 1 } else { settings.jobs };
    let ran = with_threads(jobs, |pool| {
        let cluster = settings.cluster.as_ref().filter(|_| !settings.dry);
        let (far, refused) = hand::cluster(store, cluster, watch);
        let run = Loop {
            workflow,
            store,
            settings,
            watch,
            stop,
            pool,
            answers,
            board: Board::default(),
            stages: Stages::new(workflow, &settings.targets, settings.memos),
            ready: Queue::default(),
            running: 0,
            elsewhere: Elsewhere::default(),
            licences: Licences::default(),
            far,
            past: OnceCell::new(),
            row_seconds: HashMap::new(),
            most_seconds: HashMap::new(),
            refused,
            streamed: Streamed::default(),
            failed: false,
            untold: Vec::new(),
            fatal: None,
            ended: HashMap::new(),
            lost: HashSet::new(),
            again: false,
        };
        run.go(&inbox)
    });
    ran.unwrap_or_else(|error| Report {
        stages: Vec::new(),
        interrupted: false,
        broken: Some(format!("the system grants no {jobs} threads ({error}); try fewer with `--jobs`")),
        board: Board::default(),
        states: Stages::new(workflow, &settings.targets, false),
    })
}

/// A broken invariant of this program, as the failure of the task that met it.
fn panicked(panic: &(dyn Any + Send)) -> Failure {
    let message = panic.downcast_ref::<String>().map(String::as_str).or_else(|| panic.downcast_ref::<&str>().copied());
    let text = format!("internal error: {}", message.unwrap_or("a panic without words"));
    StageError::new(text).hint("please report it with the workflow and what was printed above").into()
}

/// Decides what is done of `workflow` and what is left, by the decisions of [`run`], and starts nothing. `targets` are the
/// stages that are wanted, all when empty; without `memos` every task is looked up.
///
/// # Errors
/// The store cannot be read: nobody knows what is in it, which is not the same as nothing.
pub fn decide(workflow: &Workflow, store: &Store, targets: &[String], memos: bool) -> Result<Report, Unreadable> {
    let settings = RunSettings {
        jobs: 0,
        keep_going: true,
        dry: true,
        targets: targets.to_vec(),
        again: Vec::new(),
        memos,
        cluster: None,
    };
    let report = run(workflow, store, &settings, &Silent, &AtomicBool::new(false));
    // A result that nobody can see is not one that is missing.
    let all = report.stages.iter().all(|stage| matches!(stage.status, StageStatus::Done(_)));
    let seen = if all { Ok(()) } else { store.check_folders() };
    match (&report.broken, seen) {
        (Some(why), _) => Err(Unreadable(why.clone())),
        (None, Err(error)) => Err(Unreadable(error.to_string())),
        (None, Ok(())) => Ok(report),
    }
}

/// What a worker sends back.
struct Answer {
    node: NodeId,
    result: Result<task::Outcome, Failure>,
}

struct Loop<'pool, 'env> {
    workflow: &'env Workflow,
    store: &'env Store,
    settings: &'env RunSettings,
    watch: &'env dyn Watch,
    stop: &'env AtomicBool,
    pool: Threads<'pool, 'env>,
    answers: Sender<Answer>,
    board: Board,
    stages: Stages,
    /// Nodes to start.
    ready: Queue,
    running: usize,
    /// Tasks that other processes compute.
    elsewhere: Elsewhere,
    /// Programs that may only run so often at once.
    licences: Licences,
    /// Tasks that workers on other machines compute.
    far: Option<Far<'env>>,
    /// Earlier runs, read when something is to be started: long tasks go first, a worker learns how long one may take.
    past: OnceCell<Option<Past<'env>>>,
    /// By stage: seconds that the tasks of each row took in earlier runs.
    row_seconds: HashMap<usize, Option<RowSeconds>>,
    /// By stage: seconds that nearly all of its tasks took less than, in earlier runs.
    most_seconds: HashMap<String, Option<f64>>,
    /// Why the cluster cannot be used any more; then nothing more is started.
    refused: Option<String>,
    /// Summaries of the runs that were computed.
    streamed: Streamed,
    failed: bool,
    /// Stages that have failed while other tasks of theirs may still end, and those left out because of them.
    untold: Vec<usize>,
    /// The store cannot be read: nothing more is started.
    fatal: Option<StoreError>,
    /// Tasks that were run before all was decided anew, and why those failed that did; the board knows the later ones.
    ended: HashMap<Key, Option<String>>,
    /// Results that could not be read.
    lost: HashSet<ContentHash>,
    /// A result is gone, so all is decided anew as soon as nothing runs.
    again: bool,
}

impl Loop<'_, '_> {
    fn go(mut self, inbox: &Receiver<Answer>) -> Report {
        loop {
            while !self.again && self.advance() {}
            self.start();
            if self.running == 0 && self.far_rests() && (self.again || self.ends() || self.elsewhere.is_empty()) {
                if !self.again {
                    break;
                }
                self.decide_anew();
                continue;
            }
            self.wait(inbox);
        }
        self.tell_without_result(true);
        self.leave();
        let interrupted = self.stop.load(Ordering::Relaxed);
        let broken = self.fatal.map(|error| error.to_string()).or(self.refused);
        let stages = self.stages.reports(self.workflow, &self.board);
        Report { stages, interrupted, broken, board: self.board, states: self.stages }
    }

    /// Waits for an answer, or for another process to let go of a task.
    fn wait(&mut self, inbox: &Receiver<Answer>) {
        let pauses = [
            (!self.elsewhere.is_empty()).then(|| self.elsewhere.pause()),
            self.far.as_ref().filter(|far| !far.is_idle()).map(Far::pause),
        ];
        let answer = match pauses.into_iter().flatten().min() {
            None => inbox.recv().map_err(|_| RecvTimeoutError::Disconnected),
            Some(pause) => inbox.recv_timeout(pause),
        };
        match answer {
            Ok(answer) => self.take(answer),
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => panic!("BUG: the run loop lost its own inbox"),
        }
        self.listen();
        let over = self.elsewhere.over();
        self.let_go(over);
        if let Some((node, holder)) = self.elsewhere.first().filter(|_| self.running == 0) {
            let (stage, row) = (&self.workflow.stages[self.board.stage(node)].name, self.board.row(node));
            let progress = Progress::note(format!("waits for {holder}"));
            self.watch.event(Event::Progress { stage, row, progress: &progress });
        }
    }

    /// Whether nothing more is started.
    fn ends(&self) -> bool {
        let ended = self.stop.load(Ordering::Relaxed) || self.fatal.is_some() || self.refused.is_some();
        self.settings.dry || ended || (self.failed && !self.settings.keep_going)
    }

    /// Asks each stage that can go on for its next step; returns whether any took one.
    fn advance(&mut self) -> bool {
        let mut moved = false;
        for index in self.stages.due(self.workflow, &self.board) {
            moved = true;
            if self.stages.recall(self.workflow, index, self.store) {
                self.counted(index, true);
                continue;
            }
            match self.stages.step(self.workflow, index, self.store, &mut self.board) {
                Ok((new, stands)) => {
                    new.into_iter().for_each(|node| self.settle(node));
                    self.counted(index, false);
                    if let Some(note) = stands.filter(|_| !self.settings.dry) {
                        let (stage, count) = (&self.workflow.stages[index].name, self.board.count(index));
                        self.watch.event(Event::Asked { stage, count, note: &note });
                    }
                }
                Err(lost) => match self.recompute(*lost) {
                    Ok(()) => return false,
                    Err(error) => self.stages.fail(index, error),
                },
            }
        }
        let keeps = (!self.settings.dry).then_some(self.store);
        for report in self.stages.close(self.workflow, &self.board, keeps, &mut self.streamed) {
            moved = true;
            self.failed |= matches!(report.status, StageStatus::Failed(_));
            let without_result = matches!(report.status, StageStatus::Failed(_) | StageStatus::Skipped(_));
            match self.workflow.position(&report.name) {
                _ if self.settings.dry => {}
                Some(index) if without_result => self.untold.push(index),
                _ => self.watch.event(Event::Stage { report: &report }),
            }
        }
        self.tell_without_result(false);
        moved
    }

    /// Reports how many tasks of a stage are known and in the store.
    fn counted(&self, index: usize, is_done: bool) {
        if !self.settings.dry {
            let (stage, count) = (&self.workflow.stages[index].name, self.stages.count(index, &self.board));
            self.watch.event(Event::Counted { stage, count, is_done });
        }
    }

    /// Reports failed stages once all their tasks have ended, so that every failure is counted, and then the stages that were
    /// skipped because of them.
    fn tell_without_result(&mut self, last: bool) {
        let (workflow, stages, board, watch) = (self.workflow, &self.stages, &self.board, self.watch);
        let mut waiting: Vec<String> = Vec::new();
        self.untold.retain(|&index| {
            let report = stages.report(workflow, index, board);
            let early = match &report.status {
                StageStatus::Skipped(cause) => waiting.contains(cause),
                _ => report.tasks.ended() < report.tasks.total,
            };
            let waits = early && !last;
            match waits {
                true => waiting.push(report.name),
                false => watch.event(Event::Stage { report: &report }),
            }
            waits
        });
    }

    /// Decides about a node whose inputs may be known, and about all that follow from it.
    fn settle(&mut self, first: NodeId) {
        let mut open = vec![first];
        while let Some(node) = open.pop() {
            let Some(key) = self.board.key(node) else { continue };
            let before = self.ended.get(&key).map(|why| why.as_deref());
            let ended = before.or_else(|| self.board.ended(&key)).map(|why| why.map(str::to_owned));
            if let Some(Some(why)) = ended {
                self.board.failed(node, &why);
                continue;
            }
            if ended.is_none() && self.forced(node) {
                self.ready.put(node);
                continue;
            }
            match self.store.find(&key) {
                Ok(Some(record)) => open.extend(self.board.done(node, record.content, ended.is_none())),
                Ok(None) => self.ready.put(node),
                Err(error) => {
                    self.fatal.get_or_insert(error);
                }
            }
        }
    }

    /// Whether a task is computed in this run, whatever is stored.
    fn forced(&self, node: NodeId) -> bool {
        let stage = &self.workflow.stages[self.board.stage(node)].name;
        self.settings.again.contains(stage)
    }

    fn start(&mut self) {
        if self.again || self.ends() {
            return;
        }
        self.hand_over();
        self.rank();
        while self.running < self.pool.count() {
            let Some(node) = self.elsewhere.next(&mut self.ready) else { return };
            if !self.licences.admits(node, self.board.task(node).at_once.as_deref()) {
                continue;
            }
            let again = self.forced(node);
            match task::Order::new(&mut self.board, node, self.store, &mut self.streamed, again) {
                Ok(order) => self.give(order),
                Err(lost) => match self.recompute(*lost) {
                    Ok(()) => return,
                    Err(error) => self.take(Answer { node, result: Err(error.into()) }),
                },
            }
        }
    }

    /// A result that was in the store cannot be read: what is damaged was set aside, so its task counts as not done when
    /// all is decided anew. Not when that was tried, or when the store itself cannot be read.
    fn recompute(&mut self, lost: task::Lost) -> Result<(), StageError> {
        if !lost.error.is_missing() || !self.lost.insert(lost.content) {
            let hint = "`flow store verify` says what is damaged; see that the store can be read and written";
            let error = StageError::new(lost.error.to_string()).hint(hint);
            // Who only asks what there is takes a failed stage for one without results.
            if self.settings.dry && !lost.error.is_missing() {
                self.fatal.get_or_insert(lost.error);
            }
            return Err(error);
        }
        self.again = true;
        Ok(())
    }

    /// Begins anew without memos, which may speak of what is gone. What was computed is in the store.
    fn decide_anew(&mut self) {
        self.again = false;
        self.untold.clear();
        self.ready = Queue::default();
        self.elsewhere.clear();
        self.licences.clear();
        let board = std::mem::take(&mut self.board);
        self.ended.extend(board.all_ended());
        self.stages = Stages::new(self.workflow, &self.settings.targets, false);
    }

    fn give(&mut self, order: task::Order) {
        let node = order.node;
        let (store, watch, stop, answers) = (self.store, self.watch, self.stop, self.answers.clone());
        let stage = self.workflow.stages[self.board.stage(node)].name.as_str();
        let row = self.board.row(node);
        self.board.started(node);
        self.running += 1;
        self.pool.give(move |share| {
            let begins = || watch.event(Event::Started { stage, row });
            let say = |progress: Progress| watch.event(Event::Progress { stage, row, progress: &progress });
            // What panics is our own fault, but no reason to leave the loop waiting or to end the other tasks.
            let result = catch_unwind(AssertUnwindSafe(|| order.execute(store, share, &say, stop, &begins)));
            let result = result.unwrap_or_else(|panic| Err(panicked(&*panic)));
            // The loop may be gone only when it panicked; then nobody waits for this answer.
            let _ = answers.send(Answer { node, result });
        });
    }

    fn take(&mut self, answer: Answer) {
        let node = answer.node;
        if self.board.is_running(node) {
            self.running -= 1;
        }
        let free = self.licences.release(node, self.board.task(node).at_once.as_deref());
        free.into_iter().for_each(|node| self.ready.put(node));
        let failure = match answer.result {
            Ok(task::Outcome::Elsewhere(waiting)) => {
                self.board.stopped(node);
                self.elsewhere.put(node, waiting);
                return;
            }
            Ok(task::Outcome::Finished(finished)) => {
                self.board.took(node, finished.seconds);
                if let Some(summary) = &finished.summary {
                    self.streamed.put(finished.content, summary);
                }
                for next in self.board.done(node, finished.content, finished.shared) {
                    self.settle(next);
                }
                None
            }
            Err(Failure::Stopped) => {
                self.board.stopped(node);
                return;
            }
            Err(Failure::Failed(error)) => {
                self.failed = true;
                let text = stages::in_words(error);
                self.board.failed(node, &text);
                Some(text)
            }
        };
        let stage = self.board.stage(node);
        self.watch.event(Event::Ended {
            stage: &self.workflow.stages[stage].name,
            row: self.board.row(node),
            count: self.board.count(stage),
            failure: failure.as_deref(),
        });
    }
}

#[cfg(test)]
mod tests;
