//! Output: results to standard output and files, everything else to standard error.
//!
//! A write may fail: the reader has gone (`| head`), the disk is full, the terminal is closed. Messages on standard error
//! are then lost, and the campaign goes on, because its results matter more than its messages. A result that cannot be
//! written ends the command, silently when the reader has gone.
//!
//! Names and texts of workflows, files and programs may hold what steers a terminal. A message, and a line on a terminal,
//! shows it as a sign; a result that another program reads stays as it is.

use std::fmt::Display;
use std::io::{ErrorKind, IsTerminal, Write};

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
    print_raw(&on_screen(text));
}

/// As [`print_err`], for a text with colours of ours, whose foreign parts are clean.
pub(in crate::cli) fn print_raw(text: &str) {
    let mut err = std::io::stderr().lock();
    // A failure cannot be reported anywhere.
    let _ = err.write_all(text.as_bytes()).and_then(|()| err.flush());
}

/// Writes one line; a reader that has gone away (`| head`) ends the command quietly.
pub(in crate::cli) fn line(text: impl Display) {
    let text = format!("{text}\n");
    write(&if std::io::stdout().is_terminal() { on_screen(&text) } else { text });
}

/// A text whose characters that steer a terminal are shown as signs; lines and tabulators stay.
pub(in crate::cli) fn on_screen(text: &str) -> String {
    text.chars().map(|c| if steers(c) && !matches!(c, '\n' | '\t') { '\u{fffd}' } else { c }).collect()
}

/// Characters that steer the terminal, or change what is read: control characters, and those without width that turn the
/// direction of the text around or hide in it.
pub(in crate::cli) fn steers(c: char) -> bool {
    c.is_control()
        || matches!(c, '\u{200b}' | '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2060}'..='\u{206f}' | '\u{feff}')
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_steers_a_terminal_is_shown_as_a_sign() {
        assert_eq!(
            on_screen("a\u{1b}]0;title\u{7}b\r\n\tσ\u{202e}"),
            "a\u{fffd}]0;title\u{fffd}b\u{fffd}\n\tσ\u{fffd}"
        );
    }
}
