//! What is asked of a remote, wherever it is.

use super::RemoteError;

pub(super) const SEGMENTS: &str = "segments";
pub(super) const MARKER: &str = "flow.remote";
pub(super) const TEXT: &str = "flow remote 1\nflow keeps pushed results in this folder and made this file with it.\n";

/// What is asked of a remote. Nothing in it is ever replaced.
pub(super) trait Remote: Send + Sync {
    /// Names of all files in `segments/`.
    fn list(&self) -> Result<Vec<String>, RemoteError>;
    /// A file of at most `most` bytes; none when there is none, an empty one when it is larger or no plain file.
    fn read(&self, folder: &str, name: &str, most: u64) -> Result<Option<Vec<u8>>, RemoteError>;
    /// Writes a file; whether none of this name was there.
    fn write(&self, folder: &str, name: &str, bytes: &[u8]) -> Result<bool, RemoteError>;
    /// How many files may be on their way at once.
    fn at_once(&self) -> usize;
}
