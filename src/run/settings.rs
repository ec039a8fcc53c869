//! How a campaign is run.

use crate::cluster::Site;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

/// How a campaign is run.
#[derive(Clone, Debug)]
pub struct RunSettings {
    /// Cores that all tasks together may use.
    pub jobs: usize,
    /// Go on with what does not depend on a failed task.
    pub keep_going: bool,
    /// Decide only: start nothing.
    pub dry: bool,
    /// Stages that are wanted, with all they need; all stages when empty.
    pub targets: Vec<String>,
    /// Stages whose tasks are computed although their results are stored.
    pub again: Vec<String>,
    /// Complete unchanged stages from their memos; without it every task is looked up.
    pub memos: bool,
    /// The cluster whose workers compute what takes long; none when all is computed here.
    pub cluster: Option<Cluster>,
}

/// A cluster, for one run.
#[derive(Clone, Debug)]
pub struct Cluster {
    /// What is known of it.
    pub site: Site,
    /// Set before the run is stopped when its workers are to go on.
    pub leave: Arc<AtomicBool>,
}
