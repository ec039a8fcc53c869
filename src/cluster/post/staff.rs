//! Submissions: how many workers are missing, and what happens when the scheduler refuses.

use super::{Post, Round};
use crate::cluster::scheduler::Scheduler;
use crate::cluster::script::{Order, script};
use crate::cluster::site::Site;
use std::path::Path;
use std::time::{Duration, Instant};

/// Pause after a refusal, while some workers are there.
const REFUSED: Duration = Duration::from_secs(60);
/// Largest number of submissions in a row that may end without a finished task.
const MOST_IDLE: usize = 3;

impl Post {
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
}
