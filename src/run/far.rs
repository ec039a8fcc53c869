//! Tasks that workers on other machines compute, as the run loop sees them: by key, whichever queue they are in.

use crate::artifact::{ContentHash, FirstBytes, Key};
use crate::cluster::lists::Draft;
use crate::cluster::post::Reports;
use crate::cluster::scheduler::{self, Alive};
use crate::cluster::site::Needs;
use crate::cluster::{Cause, Line, Message, News, Post, Scheduler, Site};
use crate::stage::Progress;
use crate::store::{Store, StoreError};
use std::collections::HashMap;
use std::hash::BuildHasherDefault;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, TryRecvError, channel};
use std::time::{Duration, Instant};

/// News from the workers.
pub(super) enum Heard {
    /// A worker has begun a task.
    Begun(Key),
    /// A task says where it stands.
    Stands(Key, Progress),
    /// A task is finished; how long it took, seconds.
    Done(Key, f64),
    /// A task failed.
    Failed(Key, String),
    /// A process outside of the queues computes a task, or it is to be decided about again.
    Open(Key),
    /// An input of a task cannot be read.
    Lost(ContentHash, String),
    /// Words for the person watching.
    Word(String),
}

/// A task that was handed over, and where it stands. There may be a million of them.
#[derive(Clone, Copy)]
struct Handed {
    /// The post that lists it, [`DRAFT`] while no list with it is written.
    post: u32,
    task: u32,
    tries: Tries,
}

/// No post yet.
const DRAFT: u32 = u32::MAX;

impl Handed {
    /// The post that lists it, and its number there.
    fn listed(&self) -> Option<(usize, usize)> {
        (self.post != DRAFT).then_some((self.post as usize, self.task as usize))
    }
}

/// How often a worker that had begun a task was lost without a message, and how often the scheduler ended it.
#[derive(Clone, Copy, Default)]
struct Tries {
    gone: u8,
    ended: u8,
}

/// Tasks to be listed for workers with equal needs.
struct Fresh {
    needs: Needs,
    tasks: Vec<Key>,
    list: Draft,
}

/// What happens to the workers when the run ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Leave {
    /// They are cancelled.
    Cancel,
    /// They go on.
    Working,
}

/// The cluster.
pub(super) struct Far<'a> {
    store: &'a Store,
    site: &'a Site,
    scheduler: Arc<dyn Scheduler>,
    program: PathBuf,
    session: String,
    posts: Vec<Post>,
    /// Every task that a post lists, or that a draft of a list has, and that has not ended.
    handed: HashMap<Key, Handed, BuildHasherDefault<FirstBytes>>,
    /// Tasks with results that a worker reported (with its seconds) at this time and that are not visible in the store yet.
    reported: HashMap<Key, (f64, Instant)>,
    /// Tasks to be listed.
    fresh: Vec<Fresh>,
    asked: Option<Receiver<(usize, Result<Alive, String>)>>,
    asked_at: Instant,
    waiting: Option<String>,
    quiet: Duration,
    draining: bool,
}

/// Shortest time between two questions to the scheduler.
const ASK_EACH: Duration = Duration::from_secs(60);
/// Longest wait for a reported result on a file system that shows new files late.
const LATE: Duration = Duration::from_secs(30);
/// Shortest and longest pause between two looks at the reports.
const PAUSE: (Duration, Duration) = (Duration::from_millis(20), Duration::from_millis(500));
/// A task fails when the scheduler has ended its worker this many times.
const MOST_ENDED: u8 = 5;

impl<'a> Far<'a> {
    /// A cluster with the workers that an earlier submitter left; also returns a message on these, or an error when they
    /// cannot be found out.
    pub(super) fn new(store: &'a Store, site: &'a Site) -> (Self, Vec<String>, Result<(), String>) {
        let now = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH).unwrap_or_default();
        let mut far = Self {
            store,
            site,
            scheduler: scheduler::of(site).into(),
            program: std::env::current_exe().unwrap_or_else(|_| "flow".into()),
            session: format!("{}-{:x}", now.as_secs(), std::process::id()),
            posts: Vec::new(),
            handed: HashMap::default(),
            reported: HashMap::new(),
            fresh: Vec::new(),
            asked: None,
            asked_at: Instant::now(),
            waiting: None,
            quiet: PAUSE.0,
            draining: false,
        };
        let mut words = Vec::new();
        let adopted = far.adopt(&mut words);
        (far, words, adopted)
    }

    fn adopt(&mut self, words: &mut Vec<String>) -> Result<(), String> {
        for name in self.store.queues().map_err(|error| error.to_string())? {
            let adopted = Post::adopt(self.store, &name, self.site, &*self.scheduler);
            let adopted = adopted.map_err(|why| format!("jobs of an earlier run may be there, and {why}"))?;
            if let Some(post) = adopted {
                words.push(format!(
                    "takes over {} workers of an earlier run (job {})",
                    post.active(),
                    post.jobs().join(", ")
                ));
                self.take_over(post);
            }
        }
        Ok(())
    }

    fn take_over(&mut self, post: Post) {
        let (post_number, keys) = (self.posts.len() as u32, post.keys().collect::<Vec<_>>());
        self.posts.push(post);
        for (key, task) in keys.into_iter().zip(0..) {
            let handed = Handed { post: post_number, task, tries: Tries::default() };
            // A task is listed again when its worker was stopped or lost: nobody takes it from the earlier line any more.
            if let Some((post, task)) = self.handed.insert(key, handed).and_then(|before| before.listed()) {
                self.posts[post].over(task);
            }
        }
    }

    /// Whether tasks of this stage go to the workers; `far` says whether their work does as a rule.
    pub(super) fn takes(&self, stage: &str, far: bool) -> bool {
        self.site.sends(stage, far)
    }

    /// Whether workers were never asked for.
    pub(super) fn is_unused(&self) -> bool {
        self.posts.is_empty()
    }

    /// Whether a task was handed over already, and no news of its end has come.
    pub(super) fn has(&self, key: &Key) -> bool {
        self.handed.contains_key(key)
    }

    /// Whether no result is expected from the workers.
    pub(super) fn is_idle(&self) -> bool {
        match self.draining {
            true => !self.posts.iter().any(Post::is_busy),
            false => self.handed.is_empty(),
        }
    }

    /// Hands a task over; it is listed when there are enough for a list, or at the next [`Far::send`].
    ///
    /// # Errors
    /// The store cannot be written.
    pub(super) fn put(&mut self, stage: &str, key: Key, line: &Line) -> Result<(), StoreError> {
        self.collect(self.site.needs(stage), key, Tries::default(), &line.to_text())
    }

    fn collect(&mut self, needs: Needs, key: Key, tries: Tries, line: &str) -> Result<(), StoreError> {
        let number = match self.fresh.iter().position(|fresh| fresh.needs == needs) {
            Some(number) => number,
            None => {
                self.fresh.push(Fresh { needs, tasks: Vec::new(), list: Draft::default() });
                self.fresh.len() - 1
            }
        };
        let fresh = &mut self.fresh[number];
        fresh.tasks.push(key);
        self.handed.insert(key, Handed { post: DRAFT, task: 0, tries });
        fresh.list.add(line);
        if !fresh.list.is_full() {
            return Ok(());
        }
        let full = self.fresh.swap_remove(number);
        self.list(full)
    }

    /// Writes a list.
    fn list(&mut self, fresh: Fresh) -> Result<(), StoreError> {
        let known = self.posts.iter().position(|post| post.needs == fresh.needs);
        let number = match known {
            Some(number) => number,
            None => {
                let name = format!("{}-{}", self.session, self.posts.len() + 1);
                self.posts.push(Post::open(self.store, &name, fresh.needs)?);
                self.posts.len() - 1
            }
        };
        let first = self.posts[number].list(fresh.tasks.iter().copied(), &fresh.list)?;
        for (key, task) in fresh.tasks.into_iter().zip(first..) {
            let before = self.handed.get_mut(&key).map(|handed| {
                let before = handed.listed();
                (handed.post, handed.task) = (number as u32, task as u32);
                before
            });
            match before {
                Some(None) => {}
                Some(Some((post, earlier))) => self.posts[post].over(earlier),
                // The run decided about it again before it was listed.
                None => self.posts[number].over(task),
            }
        }
        Ok(())
    }

    /// Stops handing over: workers finish the tasks that they have begun.
    pub(super) fn drain(&mut self) {
        if !std::mem::replace(&mut self.draining, true) {
            self.posts.iter().for_each(|post| drop(post.queue.close()));
        }
    }

    /// Lists the tasks that were handed over and requests the missing workers; returns messages for the person watching.
    ///
    /// # Errors
    /// The store cannot be written, or no worker can be had.
    pub(super) fn send(&mut self) -> Result<Vec<String>, String> {
        if self.draining {
            return Ok(Vec::new());
        }
        while let Some(fresh) = self.fresh.pop() {
            self.list(fresh).map_err(|error| error.to_string())?;
        }
        let mut messages = Vec::new();
        let store = std::path::absolute(self.store.root()).unwrap_or_else(|_| self.store.root().to_owned());
        for post in &mut self.posts {
            messages.extend(post.staff(self.site, &store, &self.program, &*self.scheduler)?);
        }
        Ok(messages)
    }

    /// How long to wait before the next look.
    pub(super) fn pause(&self) -> Duration {
        self.quiet
    }

    /// News since the last call.
    ///
    /// # Errors
    /// The store cannot be read.
    pub(super) fn hear(&mut self) -> Result<Vec<Heard>, StoreError> {
        let mut heard = Vec::new();
        for number in 0..self.posts.len() {
            let Reports { news, words } = self.posts[number].read()?;
            heard.extend(words.into_iter().map(Heard::Word));
            self.sort(number, news, &mut heard)?;
        }
        self.ask(&mut heard)?;
        self.settle_late(&mut heard);
        self.quiet = if heard.is_empty() { (self.quiet * 2).min(PAUSE.1) } else { PAUSE.0 };
        Ok(heard)
    }

    fn sort(&mut self, number: usize, news: Vec<(usize, News)>, heard: &mut Vec<Heard>) -> Result<(), StoreError> {
        for (task, news) in news {
            // What is said of a task twice may come after the last one of its post has ended.
            let Some(key) = self.posts[number].key(task) else { continue };
            // A task that was listed again is another task of another post by now.
            let is_it = |handed: &Handed| handed.listed() == Some((number, task));
            if !self.handed.get(&key).is_some_and(is_it) {
                continue;
            }
            match news {
                News::Message(Message::Begun { .. }) => heard.push(Heard::Begun(key)),
                News::Message(Message::Stands { fraction, note, warning, .. }) => {
                    heard.push(Heard::Stands(key, Progress { fraction, note, warning }));
                }
                News::Message(Message::Done { seconds, .. }) => {
                    self.reported.insert(key, (seconds, Instant::now()));
                    heard.push(Heard::Done(key, seconds));
                }
                News::Message(Message::Failed { why, .. }) => heard.push(Heard::Failed(key, why)),
                News::Message(Message::Stopped { cause, .. }) => self.stopped(key, cause, heard)?,
                News::Message(Message::Elsewhere { .. }) => heard.push(Heard::Open(key)),
                News::Message(Message::Lost { input, why, .. }) => match ContentHash::from_hex(&input) {
                    Some(input) => {
                        heard.push(Heard::Open(key));
                        heard.push(Heard::Lost(input, why));
                    }
                    None => heard.push(Heard::Failed(key, why)),
                },
                News::Gone { machine, words } => self.lost(key, (&machine, &words), heard)?,
                News::Message(Message::Started { .. } | Message::Ended { .. }) => {}
            }
        }
        Ok(())
    }

    /// A worker ended a task before its end.
    fn stopped(&mut self, key: Key, cause: Cause, heard: &mut Vec<Heard>) -> Result<(), StoreError> {
        let Some(handed) = self.handed.get(&key).copied() else { return Ok(()) };
        let Some((post, _)) = handed.listed() else { return Ok(()) };
        let needs = &self.posts[post].needs;
        match cause {
            Cause::Time | Cause::Store => return self.list_again(key, handed.tries, Needs::clone),
            Cause::WholeTime => {
                let time = needs.time.map_or(0.0, |time| time.get());
                heard.push(Heard::Failed(
                    key,
                    format!(
                        "it was not finished in the whole time of a worker, {time} s (give the workers more `time` in \
                         the site file)"
                    ),
                ));
            }
            Cause::Signal if handed.tries.ended + 1 < MOST_ENDED => {
                let tries = Tries { ended: handed.tries.ended + 1, ..handed.tries };
                let again = |needs: &Needs| if needs.alone { needs.clone() } else { needs.again() };
                return self.list_again(key, tries, again);
            }
            Cause::Signal => heard.push(Heard::Failed(
                key,
                format!("the scheduler ended its worker {MOST_ENDED} times{}", memory(needs)),
            )),
        }
        Ok(())
    }

    /// A task whose worker is gone is tried once more, alone on a worker.
    fn lost(&mut self, key: Key, at: (&str, &str), heard: &mut Vec<Heard>) -> Result<(), StoreError> {
        let Some(handed) = self.handed.get(&key).copied() else { return Ok(()) };
        let Some((post, _)) = handed.listed() else { return Ok(()) };
        if handed.tries.gone > 0 {
            let (machine, words) = at;
            let memory = memory(&self.posts[post].needs);
            heard.push(Heard::Failed(
                key,
                format!("its worker on {machine} ended without a word, the second time alone{memory}: {words}"),
            ));
            return Ok(());
        }
        self.list_again(key, Tries { gone: 1, ..handed.tries }, Needs::again)
    }

    /// Takes a task out of its queue and lists it again, for workers with the needs that `needs` makes of the old ones.
    fn list_again(&mut self, key: Key, tries: Tries, needs: impl Fn(&Needs) -> Needs) -> Result<(), StoreError> {
        let Some((post, task)) = self.handed.get(&key).and_then(Handed::listed) else { return Ok(()) };
        let post = &mut self.posts[post];
        let line = post.line(task)?;
        post.over(task);
        let needs = needs(&post.needs);
        self.collect(needs, key, tries, &line)
    }

    /// Asks the scheduler at most once a minute which jobs exist, and reads its answer when there is one.
    fn ask(&mut self, heard: &mut Vec<Heard>) -> Result<(), StoreError> {
        if let Some(inbox) = &self.asked {
            match inbox.try_recv() {
                Ok((number, alive)) => {
                    self.asked = None;
                    // No answer says nothing about the jobs.
                    if let Ok(alive) = alive {
                        self.compare(number, alive, heard)?;
                    }
                }
                Err(TryRecvError::Disconnected) => self.asked = None,
                Err(TryRecvError::Empty) => {}
            }
            return Ok(());
        }
        // One question for one queue at a time, so that there is one a minute whatever the number of queues.
        let wanted: Vec<usize> = (0..self.posts.len()).filter(|&number| self.posts[number].active() > 0).collect();
        if wanted.is_empty() || self.asked_at.elapsed() < ASK_EACH {
            return Ok(());
        }
        let turn = self.asked_at.elapsed().as_nanos() as usize % wanted.len();
        let number = wanted[turn];
        self.asked_at = Instant::now();
        let (answers, inbox) = channel();
        let (scheduler, post) = (Arc::clone(&self.scheduler), &self.posts[number]);
        let (queue, jobs) = (post.queue.name().to_owned(), post.jobs());
        let asking = std::thread::Builder::new().spawn(move || {
            // Nobody waits for it when the run has ended.
            let _ = answers.send((number, scheduler.alive(&queue, &jobs)));
        });
        match asking {
            Ok(_) => self.asked = Some(inbox),
            Err(error) => heard.push(Heard::Word(format!(
                "the scheduler cannot be asked which jobs exist ({error}); it is asked again in a minute"
            ))),
        }
        Ok(())
    }

    /// Compares a queue with the jobs that exist.
    fn compare(&mut self, number: usize, alive: Alive, heard: &mut Vec<Heard>) -> Result<(), StoreError> {
        let Reports { news, words } = self.posts[number].apply(&alive);
        heard.extend(words.into_iter().map(Heard::Word));
        self.sort(number, news, heard)?;
        let waiting = alive.waiting.map(|(count, why)| format!("{count} workers wait for a free node ({why})"));
        if waiting.is_some() && waiting != self.waiting {
            heard.extend(waiting.clone().map(Heard::Word));
            self.waiting = waiting;
        }
        Ok(())
    }

    /// Looks again for results that were reported but are not visible; after a while their tasks are computed again.
    fn settle_late(&mut self, heard: &mut Vec<Heard>) {
        for (key, (seconds, since)) in &self.reported {
            match since.elapsed() {
                elapsed if elapsed > LATE => heard.push(Heard::Open(*key)),
                elapsed if elapsed > PAUSE.1 => heard.push(Heard::Done(*key, *seconds)),
                _ => {}
            }
        }
    }

    /// Forgets a task that has ended, or about which the run decides again.
    pub(super) fn forget(&mut self, key: &Key) {
        self.reported.remove(key);
        if let Some((post, task)) = self.handed.remove(key).and_then(|handed| handed.listed()) {
            self.posts[post].over(task);
        }
        // A map does not become smaller by itself, and what is gathered next needs the room.
        if self.handed.is_empty() {
            self.handed = HashMap::default();
        }
    }

    /// Ends the work with the cluster; returns messages on what happens to the workers.
    pub(super) fn end(&mut self, leave: Leave) -> Vec<String> {
        if leave == Leave::Working {
            let workers: usize = self.posts.iter().map(Post::active).sum();
            return match workers {
                0 => Vec::new(),
                _ => vec![format!("{workers} workers go on without this process; the same command takes them over")],
            };
        }
        let mut words = Vec::new();
        for post in &self.posts {
            let _ = post.queue.close();
            if post.active() > 0
                && let Err(why) = self.scheduler.cancel(post.queue.name(), &post.jobs())
            {
                words.push(format!(
                    "job {} could not be cancelled ({why}); its workers end by themselves",
                    post.jobs().join(", ")
                ));
            }
        }
        words
    }
}

fn memory(needs: &Needs) -> String {
    match needs.memory {
        Some(memory) => format!(" with {memory} (most likely it needs more: `memory` in the site file)"),
        None => " (most likely it needs more memory: `memory` in the site file)".to_owned(),
    }
}

#[cfg(test)]
mod tests;
