//! Output: results to standard output and files, everything else to standard error.
//!
//! A write may fail: the reader has gone (`| head`), the disk is full, the terminal is closed. Messages on standard error
//! are then lost, and the campaign goes on, because its results matter more than its messages. A result that cannot be
//! written ends the command, silently when the reader has gone.

use std::fmt::Display;
use std::io::{ErrorKind, Write};
use std::path::Path;

/// Prints one line of a result: `println!` that ends quietly when nobody reads any more.
macro_rules! out {
    ($($text:tt)*) => { $crate::cli::output::line(format_args!($($text)*)) };
}

/// Prints one line on standard error: `eprintln!` that does not mind when nobody can read it.
macro_rules! err {
    ($($text:tt)*) => { $crate::cli::output::print_err(&format!("{}\n", format_args!($($text)*))) };
}

/// Writes to standard error, if it can be written to.
pub(in crate::cli) fn print_err(text: &str) {
    let mut err = std::io::stderr().lock();
    // A failure cannot be reported anywhere.
    let _ = err.write_all(text.as_bytes()).and_then(|()| err.flush());
}

/// Writes one line; a reader that has gone away (`| head`) ends the command quietly.
pub(in crate::cli) fn line(text: impl Display) {
    write(&format!("{text}\n"));
}

/// Writes text as it is.
pub(super) fn write(text: &str) {
    let mut out = std::io::stdout().lock();
    if let Err(error) = out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        if error.kind() != ErrorKind::BrokenPipe {
            err!("error: cannot write the result: {error}");
        }
        let exit = if error.kind() == ErrorKind::BrokenPipe { super::Exit::Done } else { super::Exit::System };
        std::process::exit(exit as i32);
    }
}

/// Writes a file so that a reader sees the old or the new one, never a part. What is no plain file, such as a pipe, is
/// written to as it stands.
pub(super) fn replace(path: &Path, bytes: &[u8]) -> std::io::Result<()> {
    if std::fs::symlink_metadata(path).is_ok_and(|found| !found.is_file()) {
        return std::fs::write(path, bytes);
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
