//! `flow work`: one worker of a cluster, started by a job.

use super::Exit;
use super::common::{Common, system, workers};
use super::run::interruption;
use crate::cluster::script::SECRET;
use crate::run::{Worker, program};
use crate::stage::command::leftover;
use clap::Args;

/// Take tasks from a queue of a cluster.
#[derive(Args)]
pub(super) struct Work {
    #[command(flatten)]
    common: Common,
    /// Name of the queue in the store.
    queue: String,
    /// Which submission of the queue this worker belongs to, from 1.
    #[arg(long, value_name = "N", default_value = "1")]
    round: usize,
    /// Which worker of that submission it is.
    #[arg(long, value_name = "N", default_value = "0")]
    index: usize,
    /// How many workers were submitted.
    #[arg(long, value_name = "N", default_value = "1")]
    of: usize,
    /// Cores that it may use.
    #[arg(long, value_name = "N", default_value = "1", value_parser = workers)]
    cpus: usize,
    /// Longest life of the worker, seconds.
    #[arg(long, value_name = "S")]
    seconds: Option<f64>,
    /// How long an idle worker waits for new tasks, seconds.
    #[arg(long, value_name = "S", default_value = "0")]
    linger: f64,
    /// Take one task only.
    #[arg(long)]
    alone: bool,
}

impl Work {
    pub(super) fn go(self) -> Exit {
        self.work().unwrap_or_else(|exit| exit)
    }

    fn work(&self) -> Result<Exit, Exit> {
        let secret = std::env::var(SECRET).ok();
        let secret = secret.and_then(|digits| Some(*blake3::Hash::from_hex(digits).ok()?.as_bytes()));
        let store = self.common.open()?;
        let queue = store.queue(&self.queue, secret);
        if queue.is_closed() {
            err!("nothing to do: the queue {} is closed or gone", self.queue);
            return Ok(Exit::Done);
        }
        let stop = interruption(None);
        leftover::sweep().iter().for_each(|line| err!("warning: {line}"));
        let Self { round, index, of, cpus, seconds, linger, alone, .. } = *self;
        let worker = Worker { round, index, of, cpus, seconds, linger, alone };
        let origin = store.origin();
        err!("worker {index} of round {round} on {}: flow {}, program {}", origin.machine, origin.version, program());
        match worker.work(&store, &queue, &stop) {
            Ok(worked) => {
                let time = if worked.out_of_time { "; its time was over" } else { "" };
                err!("{} tasks done, {} failed{time}", worked.done, worked.failed);
                Ok(Exit::Done)
            }
            Err(why) => Err(system(&std::io::Error::other(why))),
        }
    }
}
