//! The files that stages look at while they decide.

use crate::plan::Workflow;
use crate::stage::beside::read;
use std::path::{Path, PathBuf};

/// Files that were looked at, with their digests.
pub(super) type Files = Vec<(String, String)>;

/// Where a file named by the workflow lies.
pub(super) fn path_of(workflow: &Workflow, path: &str) -> PathBuf {
    workflow.path.parent().unwrap_or(Path::new("")).join(path)
}

/// Whether all these files are as they were.
pub(super) fn unchanged(workflow: &Workflow, files: &Files) -> bool {
    files.iter().all(|(path, digest)| {
        let path = path_of(workflow, path);
        read(&path).is_ok_and(|bytes| blake3::hash(&bytes).to_hex().as_str() == digest)
    })
}
