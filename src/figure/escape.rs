//! Escaping: one function per format, which makes text from a file, a log or a name stay text there.
//!
//! * [`xml`]: SVG, contents and attributes in double quotes
//! * [`latex`]: LaTeX outside of mathematics; [`latex_markup`] passes mathematics between dollar signs if it is harmless;
//!   [`latex_label`] for `\\label`
//! * [`markdown`], [`markdown_markup`]: CommonMark with pipe tables
//! * [`csv`]: RFC 4180
//!
//! **Formulas in spreadsheets.** A program that opens a CSV file may take a cell that begins with `=`, `+`, `-` or `@` for
//! a formula. [`csv`] writes such a cell as it is: the file is data for programs, and a specimen called `-3` must come
//! back as `-3` when the table is read again. Whoever opens tables of others in a spreadsheet imports the columns as
//! text.
//!
//! Pages (HTML) are escaped by their own writer, graphs (DOT, Mermaid) and shell commands where they are written.

use super::text;

/// Characters that no document holds: control characters but for white space.
fn is_control(c: char) -> bool {
    c.is_control() && !matches!(c, '\t' | '\n' | '\r') || matches!(c, '\u{fffe}' | '\u{ffff}')
}

/// For the contents and attributes of XML. Characters that XML 1.0 cannot hold become U+FFFD.
pub fn xml(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out += "&amp;",
            '<' => out += "&lt;",
            '>' => out += "&gt;",
            '"' => out += "&quot;",
            c if is_control(c) => out.push('\u{fffd}'),
            c => out.push(c),
        }
    }
    out
}

/// For LaTeX outside of mathematics. Lines become one, because an empty line would end a cell.
pub fn latex(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    let mut last = ' ';
    for c in text.chars() {
        match c {
            '%' | '&' | '#' | '_' | '{' | '}' | '$' => {
                out.push('\\');
                out.push(c);
            }
            '\\' => out += "\\textbackslash{}",
            '^' => out += "\\textasciicircum{}",
            '~' => out += "\\textasciitilde{}",
            '<' => out += "\\textless{}",
            '>' => out += "\\textgreater{}",
            '|' => out += "\\textbar{}",
            // Behind the end of a row they would be its options; two of the others would be one sign.
            '[' | ']' | '*' => out += &format!("{{{c}}}"),
            '-' | '`' | '\'' | ',' if last == c => out += &format!("{{}}{c}"),
            '`' if matches!(last, '?' | '!') => out += "{}`",
            '"' => out += "{\"}",
            c if c.is_whitespace() || c.is_control() => out.push(' '),
            c => out.push(c),
        }
        last = c;
    }
    out
}

/// For a caption or note in LaTeX: [`latex`], but for mathematics between dollar signs.
pub fn latex_markup(text: &str) -> String {
    pieces(text).iter().map(|piece| if piece.0 { format!("${}$", piece.1) } else { latex(piece.1) }).collect()
}

/// For `\\label`: letters, digits and `:._-`; everything else becomes `-`.
pub fn latex_label(text: &str) -> String {
    text.chars().map(|c| if c.is_ascii_alphanumeric() || ":._-".contains(c) { c } else { '-' }).collect()
}

/// For CommonMark and its pipe tables. Lines become one.
pub fn markdown(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    let mut rest = text.chars().peekable();
    while let Some(c) = rest.next() {
        match c {
            '\\' | '`' | '*' | '_' | '{' | '}' | '[' | ']' | '<' | '>' | '#' | '|' | '~' | '$' | '!' => {
                out.push('\\');
                out.push(c);
            }
            // It begins the name of a character.
            '&' if rest.peek().is_some_and(|next| next.is_alphanumeric() || *next == '\\' || *next == '#') => {
                out += "\\&"
            }
            c if c.is_whitespace() || c.is_control() => out.push(' '),
            c => out.push(c),
        }
    }
    out
}

/// For a caption or note in Markdown: [`markdown`], but for mathematics between dollar signs.
pub fn markdown_markup(text: &str) -> String {
    pieces(text).iter().map(|piece| if piece.0 { format!("${}$", piece.1) } else { markdown(piece.1) }).collect()
}

/// For a cell of a CSV file. See the head of this file on formulas in spreadsheets.
pub fn csv(cell: &str) -> String {
    let quoted = cell.contains([',', '"', '\n', '\r']) || cell.starts_with('#') || cell.trim() != cell;
    if quoted { format!("\"{}\"", cell.replace('"', "\"\"")) } else { cell.into() }
}

/// Whether a text may stand between dollar signs: every command in it is known, every brace has its partner, and nothing
/// in it means something else to LaTeX than to a figure.
pub fn is_mathematics(inner: &str) -> bool {
    let mut escaped = false;
    let harmful = inner.chars().any(|c| {
        let found = !escaped && "$%&#~\"`".contains(c) || c.is_control();
        escaped = c == '\\' && !escaped;
        found
    });
    !harmful && !inner.trim().is_empty() && text::check(&format!("${inner}$")).is_ok()
}

/// Mathematics (true) and text of a caption. As in Pandoc, the first dollar sign stands before a character that is no
/// blank, the second behind one, and not before a digit: "$5 and $6" is text.
fn pieces(text: &str) -> Vec<(bool, &str)> {
    let mut pieces = Vec::new();
    let (mut begin, mut from) = (0, 0);
    while let Some(open) = text[from..].find('$').map(|at| from + at) {
        let close = text[open + 1..].find('$').map(|at| open + 1 + at);
        let inner = close.map_or("", |close| &text[open + 1..close]);
        let behind = close.and_then(|close| text[close + 1..].chars().next());
        let tight = !inner.starts_with(char::is_whitespace) && !inner.ends_with(char::is_whitespace);
        if tight && !behind.is_some_and(|c| c.is_ascii_digit()) && is_mathematics(inner) {
            pieces.extend([(false, &text[begin..open]), (true, inner)]);
            begin = open + inner.len() + 2;
            from = begin;
        } else {
            from = open + 1;
        }
    }
    pieces.push((false, &text[begin..]));
    pieces
}

#[cfg(test)]
mod tests;
