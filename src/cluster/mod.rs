//! Workers on other machines: the tasks that they get, the messages that they send, and the scheduler that starts them.
//!
//! # How a campaign runs on a cluster
//! `flow run … --executor slurm` is the submitter. It decides what is to be computed as every run does, writes the tasks whose
//! inputs are known into a list in the store ([`mod@line`], [`Queue`](crate::store::Queue)), and asks the scheduler for an array of
//! equal jobs ([`script`], [`scheduler`]), each of which is a worker: `flow work`. A worker takes tasks until none is
//! left ([`slices`]), stores each result as any other flow does, and reports what it does ([`message`]). There is no
//! server and no port: the store is all that submitter and workers share.
//!
//! # Decisions, and why
//! * **Workers pull.** One job per task costs a second of the scheduler each; a fixed chunk per job waits for the slowest.
//! * **The lists of a queue grow, and workers linger.** A calibration asks for twenty runs, sees them, and asks for twenty
//!   more: workers that wait a moment for the next list spare each generation the wait in the scheduler's queue.
//! * **Lines of tasks stay in the lists** ([`lists`]): the submitter knows a task by its key, a worker by its number, and both read
//!   the line of a task when they need it, one list at a time. So 100,000 tasks take no more memory than a run here.
//! * **A task is begun once.** Its marker in the queue can be made only once, even where locks do not reach other nodes, and
//!   no worker reads the reports of others before it begins a task. Tasks that a lost worker had begun are not taken over by the other
//!   workers: what has used up the memory of one would use up theirs. The submitter sends each of them again, alone, once,
//!   with twice the memory; what then fails is named with its row.
//! * **The job states of a scheduler are poor evidence**: a memory kill and a dead node look alike, and there may be no
//!   database of ended jobs. So flow asks one thing only, which jobs exist, and at most once a minute. Where locks reach all
//!   nodes, a lost worker is noticed sooner, because the lock of its report is free.
//! * **Clocks of two machines are never compared.** Workers count their time from their own start.
//! * **Nothing of the site is in a key.** A result does not depend on where its task ran.

pub mod line;
pub mod lists;
pub mod message;
pub mod post;
pub mod scheduler;
pub mod script;
pub mod site;
pub mod slices;

pub use line::Line;
pub use message::{Cause, Message};
pub use post::{News, Post};
pub use scheduler::Scheduler;
pub use site::Site;
