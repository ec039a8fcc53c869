//! Output: results to standard output and files, everything else to standard error.
//!
//! A write may fail: the reader has gone (`| head`), the disk is full, the terminal is closed. Messages on standard error
//! are then lost, and the campaign goes on, because its results matter more than its messages. A result that cannot be
//! written ends the command, silently when the reader has gone.
//!
//! Names and texts of workflows, files and programs may hold what steers a terminal. A message, and a line on a terminal,
//! shows it as a sign; a result that another program reads stays as it is. Lines longer than the terminal is wide go on below,
//! between words.

use std::fmt::Display;
use std::io::{ErrorKind, IsTerminal, Write};
use std::os::fd::AsFd;

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
    print_raw(&wrapped(&on_screen(text), width(&std::io::stderr())));
}

/// As [`print_err`], for a text with colours of ours, whose foreign parts are clean.
pub(in crate::cli) fn print_raw(text: &str) {
    let mut err = std::io::stderr().lock();
    // A failure cannot be reported anywhere.
    let _ = err.write_all(text.as_bytes()).and_then(|()| err.flush());
}

/// Writes one line; a reader that has gone away (`| head`) ends the command quietly.
pub(in crate::cli) fn line(text: impl Display) {
    lines(&format!("{text}\n"));
}

/// Writes lines for people.
pub(in crate::cli) fn lines(text: &str) {
    let out = std::io::stdout();
    if out.is_terminal() { write(&wrapped(&on_screen(text), width(&out))) } else { write(text) }
}

/// How many characters a line of the terminal holds; `None` where no person reads, or nothing is known.
pub(in crate::cli) fn width(of: &(impl AsFd + IsTerminal)) -> Option<usize> {
    let size = of.is_terminal().then(|| rustix::termios::tcgetwinsize(of).ok()).flatten()?;
    (size.ws_col >= NARROWEST).then_some(usize::from(size.ws_col))
}

/// A terminal that reports fewer columns than these does not know its width.
const NARROWEST: u16 = 20;

/// Lines that fit the width, broken between words; what goes on is set in. Columns that are set by blanks stay where they are
/// in the first of them.
pub(in crate::cli) fn wrapped(text: &str, width: Option<usize>) -> String {
    let Some(width) = width else { return text.to_owned() };
    let mut out = String::with_capacity(text.len());
    for line in text.split_inclusive('\n') {
        let (body, end) = line.strip_suffix('\n').map_or((line, ""), |body| (body, "\n"));
        let indent = body.len() - body.trim_start_matches(' ').len();
        let (mut rest, mut room) = (body, width);
        while let Some((over, _)) = rest.char_indices().nth(room) {
            // The blank that a line ends at may be the first one beyond it.
            let upto = over + rest[over..].chars().next().filter(|c| *c == ' ').map_or(0, char::len_utf8);
            let Some(cut) = rest[..upto].rfind(' ').filter(|cut| !rest[..*cut].trim().is_empty()) else { break };
            out += rest[..cut].trim_end();
            out += "\n";
            out += &" ".repeat(indent + FURTHER);
            rest = rest[cut..].trim_start();
            room = width.saturating_sub(indent + FURTHER).max(usize::from(NARROWEST));
        }
        out += rest;
        out += end;
    }
    out
}

/// How much further in what goes on is set.
const FURTHER: usize = 2;

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
    fn long_lines_go_on_between_words() {
        let wrap = |text| wrapped(text, Some(20));
        assert_eq!(wrap("one two three four five\nsix\n"), "one two three four\n  five\nsix\n");
        assert_eq!(wrap("exactly twenty chars and"), "exactly twenty chars\n  and");
        assert_eq!(wrap("    error: something that is long"), "    error: something\n      that is long");
        // A word that is too long stays whole.
        assert_eq!(wrap("https://example.org/a/b/c/d end"), "https://example.org/a/b/c/d end");
        assert_eq!(wrap("a https://example.org/a/b/c/d"), "a\n  https://example.org/a/b/c/d");
        assert_eq!(wrapped("one two three four five", None), "one two three four five");
        assert_eq!(wrap("σσσσσσσσσσ σσσσσσσσσ σ"), "σσσσσσσσσσ σσσσσσσσσ\n  σ");
    }

    #[test]
    fn what_steers_a_terminal_is_shown_as_a_sign() {
        assert_eq!(
            on_screen("a\u{1b}]0;title\u{7}b\r\n\tσ\u{202e}"),
            "a\u{fffd}]0;title\u{fffd}b\u{fffd}\n\tσ\u{fffd}"
        );
    }
}
