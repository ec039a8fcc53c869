//! Workers on other machines: what goes to them, what comes back, and how a scheduler is asked for them.
//!
//! # How a campaign runs on a cluster
//! `flow run … --executor slurm` is the submitter. It decides what is to be computed as ever, writes the tasks whose inputs
//! are known into a list in the store ([`line`], [`Queue`](crate::store::Queue)), and asks the scheduler for an array of
//! equal jobs ([`script`], [`scheduler`]), each of which is a worker: `flow work`. A worker takes tasks until none is
//! left ([`slices`]), stores each result as any other flow does, and writes down what it does ([`said`]). There is no
//! server and no port; the store is the truth, and it is all that submitter and workers share.
//!
//! # Decisions, and why
//! * **Workers pull.** One job per task costs a second of the scheduler each; a fixed chunk per job waits for the slowest.
//! * **The lists of a queue grow, and workers linger.** A calibration asks for twenty runs, sees them, and asks for twenty
//!   more: workers that wait for the next list for a moment spare each of its generations the wait for a place.
//! * **A task is begun once.** Its marker in the queue can be made once, also where locks do not reach other nodes, and
//!   nobody reads what others did before beginning. Tasks that a lost worker had begun are not taken over by the other
//!   workers: what has used up the memory of one would use up theirs. The submitter sends each of them again, alone, once,
//!   with twice the memory; what then fails is named with its row.
//! * **The state that the scheduler tells is a poor witness**: a memory kill and a dead node look alike, and a database of
//!   ended jobs may not be there. So it is asked for one thing only, which jobs are still there, and at most once a minute.
//!   That a worker is gone shows sooner where locks reach all nodes: the lock of its report is free.
//! * **No clock of another machine is compared.** Workers count the time that they are given from their own start.
//! * **Nothing of the site is in a key.** Where a task ran changes nothing in its result.

pub mod line;
pub mod post;
pub mod said;
pub mod scheduler;
pub mod script;
pub mod site;
pub mod slices;

pub use line::Line;
pub use post::{News, Post};
pub use said::{Cause, Said};
pub use scheduler::Scheduler;
pub use site::Site;
