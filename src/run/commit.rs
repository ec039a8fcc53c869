//! The git commit that a workflow stands in, for the record of a run; never part of a key.

use std::path::Path;
use std::process::{Command, Stdio};

/// The commit of the repository that holds a folder, with `-dirty` behind it when files that it knows were changed since.
/// Empty without a repository, without a commit, or without git.
pub fn commit(folder: &Path) -> String {
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    // Where there is no repository, as in most folders of results, git need not be started.
    let inside = std::path::absolute(folder).is_ok_and(|path| path.ancestors().any(|path| path.join(".git").exists()));
    if !inside {
        return String::new();
    }
    let mut git = Command::new("git");
    git.args(["--no-optional-locks", "-C"]).arg(folder);
    git.args(["describe", "--always", "--dirty", "--abbrev=40", "--exclude=*"]);
    match git.stdin(Stdio::null()).stderr(Stdio::null()).output() {
        Ok(output) if output.status.success() => String::from_utf8_lossy(&output.stdout).trim().to_owned(),
        Ok(_) | Err(_) => String::new(),
    }
}
