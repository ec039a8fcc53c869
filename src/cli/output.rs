//! Standard output, for results.

use std::fmt::Display;
use std::io::{ErrorKind, Write};

/// Prints one line of a result: `println!` that ends quietly when nobody reads any more.
macro_rules! out {
    ($($text:tt)*) => { $crate::cli::output::line(format_args!($($text)*)) };
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
            eprintln!("error: cannot write the result: {error}");
        }
        let exit = if error.kind() == ErrorKind::BrokenPipe { super::Exit::Done } else { super::Exit::System };
        std::process::exit(exit as i32);
    }
}
