//! Files of results: where they may be written, and how.

use super::Exit;
use crate::plan::Workflow;
use serde_json::Value;
use std::collections::HashSet;
use std::fs;
use std::io::{Read, Write};
use std::path::{Path, PathBuf};

/// How a page begins.
const PAGE: &[u8] = b"<!DOCTYPE html>";

/// Writes files of results, and none in the place of a file that the workflow reads.
pub(super) struct Files {
    /// The workflow, and the files that it names.
    reads: HashSet<PathBuf>,
}

impl Files {
    /// Those of a workflow.
    pub(super) fn of(workflow: &Workflow) -> Self {
        let folder = workflow.path.parent().unwrap_or(Path::new(""));
        let mut reads: HashSet<PathBuf> = fs::canonicalize(&workflow.path).into_iter().collect();
        let mut open: Vec<Value> = workflow.stages.iter().map(|stage| stage.stage.settings()).collect();
        while let Some(value) = open.pop() {
            match value {
                Value::String(text) if !text.is_empty() => reads.extend(fs::canonicalize(folder.join(text))),
                Value::Array(list) => open.extend(list),
                Value::Object(map) => open.extend(map.into_iter().map(|(_, value)| value)),
                _ => {}
            }
        }
        Self { reads }
    }

    /// Writes a file. What the workflow reads is not replaced, and what is no page is not replaced by a page.
    pub(super) fn put(&self, path: &Path, bytes: &[u8]) -> Result<(), Exit> {
        let refused = |why: &str| {
            err!("error: {}: {why}\n  it was left as it is; give another name", path.display());
            Exit::BadInput
        };
        if fs::canonicalize(path).is_ok_and(|there| self.reads.contains(&there)) {
            return Err(refused("the workflow reads this file"));
        }
        let there = fs::symlink_metadata(path).is_ok_and(|meta| meta.is_file() && meta.len() > 0);
        if bytes.starts_with(PAGE) && there && !begins_with(path, PAGE) {
            return Err(refused("this file is there already, and is no page"));
        }
        replace(path, bytes).map_err(|e| {
            err!("error: {}: {e}", path.display());
            Exit::System
        })
    }
}

fn begins_with(path: &Path, head: &[u8]) -> bool {
    let mut found = vec![0; head.len()];
    fs::File::open(path).and_then(|mut file| file.read_exact(&mut found)).is_ok() && found == head
}

/// Writes a file so that a reader sees the old or the new one, never a part. What is no plain file, such as a pipe, is
/// written to as it stands.
fn replace(path: &Path, bytes: &[u8]) -> std::io::Result<()> {
    if fs::symlink_metadata(path).is_ok_and(|found| !found.is_file()) {
        return fs::write(path, bytes);
    }
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let mut builder = tempfile::Builder::new();
    // As any other program's files: the user's mask decides who may read them.
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    let mut file = builder.tempfile_in(folder)?;
    file.write_all(bytes)?;
    file.persist(path)?;
    Ok(())
}
