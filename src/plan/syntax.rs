//! From bytes to a tree of values with locations: TOML, and nothing about workflows.
//!
//! The limits keep every file, whatever it holds, within a second and the stack: [`LARGEST`] bytes, [`DEEPEST`] levels.

use super::fault::Fault;
use super::node::{Entry, Node, Sources, Span, Table, Value, shortened};
use crate::unit::vanishes;
use std::fs::File;
use std::io::Read;
use std::ops::Range;
use std::os::unix::fs::FileTypeExt;
use std::path::Path;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// The largest workflow file, in bytes.
pub(super) const LARGEST: usize = 1 << 20;

/// The largest text of which every fault of syntax is reported; of a larger one only the first, because going on behind a
/// fault costs the TOML reader far more than reading.
const LARGEST_FAULTY: usize = 1 << 15;

/// The deepest table or list.
const DEEPEST: usize = 32;

/// What to do about it.
const NOT_DEEP: &str = "no table or list of a workflow is nested deeper than 32 levels";

/// Most faults that are reported of one text.
const MOST_FAULTS: usize = 20;

/// Reads a workflow file.
pub(super) fn read_file(path: &Path) -> Result<String, Vec<Fault>> {
    let name = path.display();
    let unread = |e: std::io::Error| {
        let fault = Fault::new(format!("{name}: cannot be read: {e}"));
        vec![match e.kind() {
            std::io::ErrorKind::NotFound => fault.hint("`flow new NAME` writes a workflow to start from"),
            std::io::ErrorKind::IsADirectory => fault.hint("name the workflow file in this folder"),
            _ => fault,
        }]
    };
    // Opening a pipe that nobody writes to would wait for ever; a pipe that is handed over is what `/dev/stdin` is.
    if std::fs::metadata(path)
        .is_ok_and(|meta| meta.file_type().is_fifo() && !path.starts_with("/dev") && !path.starts_with("/proc"))
    {
        return Err(vec![Fault::new(format!("{name}: is a pipe, not a workflow file"))]);
    }
    let mut bytes = Vec::new();
    File::open(path).and_then(|file| file.take(LARGEST as u64 + 1).read_to_end(&mut bytes)).map_err(unread)?;
    if bytes.len() > LARGEST {
        let message = format!("{name}: the file is larger than {} MiB, which no workflow is", LARGEST >> 20);
        let hint = "keep tables in CSV files and name them with `kind = \"data\"`";
        return Err(vec![Fault::new(message).hint(hint)]);
    }
    String::from_utf8(bytes).map_err(|e| {
        let at = e.utf8_error().valid_up_to();
        let line = e.as_bytes()[..at].iter().filter(|&&byte| byte == b'\n').count() + 1;
        let message = format!("{name}: not a text file: byte {at}, in line {line}, is not UTF-8");
        vec![Fault::new(message).hint("a workflow is TOML text in UTF-8")]
    })
}

/// The tree of the source with this index. With faults of syntax there may be no tree; a tree with other faults has a
/// hole where each is.
pub(super) fn tree(sources: &Sources, index: u32) -> (Option<Node>, Vec<Fault>) {
    let text = &sources.0[index as usize].text;
    if text.len() > LARGEST {
        return (None, vec![Fault::new(format!("the workflow is larger than {} MiB", LARGEST >> 20))]);
    }
    let read = on_a_large_stack(|| {
        let (root, errors) = match DeTable::parse(text) {
            Ok(root) => (root, Vec::new()),
            Err(_) if text.len() <= LARGEST_FAULTY => DeTable::parse_recoverable(text),
            Err(first) => return (None, syntax_faults(sources, index, &[first])),
        };
        let whole = errors.iter().all(|error| error.message() == DUPLICATE);
        let mut convert = Convert { sources, index, faults: syntax_faults(sources, index, &errors) };
        let span = convert.span(root.span());
        let value = Value::Table(convert.table(root.into_inner(), 0));
        (whole.then_some(Node { span, value }), convert.faults)
    });
    read.unwrap_or_else(|error| {
        let fault = Fault::new(format!("no thread can be started: {error}"));
        let hint = "end other programs, or raise the limits on processes and memory (`ulimit -u`, `ulimit -v`)";
        (None, vec![fault.hint(hint)])
    })
}

/// Keys nested to the reader's own limit take more stack to walk and to drop than a thread may have.
fn on_a_large_stack<T: Send>(work: impl FnOnce() -> T + Send) -> std::io::Result<T> {
    const STACK: usize = 32 << 20;
    std::thread::scope(|scope| {
        let thread = std::thread::Builder::new().stack_size(STACK).spawn_scoped(scope, work)?;
        Ok(thread.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)))
    })
}

/// What the TOML reader says of a key that stands twice; its tree is complete all the same.
const DUPLICATE: &str = "duplicate key";

fn syntax_faults(sources: &Sources, index: u32, errors: &[toml::de::Error]) -> Vec<Fault> {
    let text = &sources.0[index as usize].text;
    let mut faults = Vec::new();
    let mut last = None;
    let mut doubled = None;
    for error in errors {
        let end = text.len()..text.len();
        // Of a dotted key the reader does not say where it stands.
        let deep = || deepest_key(text).filter(|_| error.message().contains("recurs"));
        let span = span(sources, index, error.span().or_else(deep).unwrap_or(end));
        let (start, end) = (span.start as usize, span.end as usize);
        // Every key of a duplicate table would be reported again.
        let inside = |header: usize| header <= start && !text[header..start].contains("\n[");
        if last.replace(start) == Some(start) || error.message() == DUPLICATE && doubled.is_some_and(inside) {
            continue;
        }
        if faults.len() == MOST_FAULTS {
            faults.push(Fault::new("… and more faults of this sort"));
            break;
        }
        let fault = match error.message() {
            DUPLICATE => {
                let line = text[..start].rfind('\n').map_or(0, |at| at + 1);
                let header = text[line..].starts_with('[');
                doubled = header.then_some(start);
                let label = if header { "give it another name" } else { "remove one of them" };
                Fault::new(format!("`{}` stands here a second time", shortened(&text[start..end]))).label(label)
            }
            message if message.contains("recurs") => Fault::new("nested too deeply").hint(NOT_DEEP),
            message => comma_in_number(text, start).unwrap_or_else(|| Fault::new(message)),
        };
        faults.push(fault.at(sources.location(span)));
    }
    faults
}

/// The fault of a number with a decimal comma at this byte.
fn comma_in_number(text: &str, at: usize) -> Option<Fault> {
    let is_digit = |c: char| c.is_ascii_digit();
    let (before, after) = (text.get(..at)?, text.get(at..)?.strip_prefix(',')?);
    let begin = before.trim_end_matches(is_digit).len();
    let end = after.len() - after.trim_start_matches(is_digit).len();
    let number = (begin < at && end > 0).then(|| &text[begin..=at + end])?;
    let hint = format!("write {}", number.replacen(',', ".", 1));
    Some(Fault::new(format!("`{number}` has a decimal comma")).hint(hint))
}

/// The first dotted key of more parts than the TOML reader takes.
fn deepest_key(text: &str) -> Option<Range<usize>> {
    const PARTS: usize = 80;
    let name = |part: &str| {
        let part = part.trim();
        let quoted =
            ['"', '\''].iter().any(|&quote| part.len() > 1 && part.starts_with(quote) && part.ends_with(quote));
        let plain = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '-';
        quoted || !part.is_empty() && part.chars().all(plain)
    };
    let mut start = 0;
    for piece in text.split(['=', '{', '}', ',', '[', ']', '#', '\n']) {
        if piece.split('.').count() >= PARTS && piece.split('.').all(name) {
            let start = start + piece.len() - piece.trim_start().len();
            return Some(start..start + piece.trim().len());
        }
        start += piece.len() + 1;
    }
    None
}

/// A single value, as in `--set path=value`; `offset` is where it begins in its source.
pub(super) fn value(sources: &Sources, index: u32, offset: usize) -> Result<Node, Vec<Fault>> {
    let text = sources.0[index as usize].text[offset..].trim_end();
    let parsed = DeValue::parse(text).map_err(|e| vec![Fault::new(e.message())])?;
    let mut convert = Convert { sources, index, faults: Vec::new() };
    let mut node = convert.node(parsed, 0);
    shift(&mut node, offset as u32);
    if convert.faults.is_empty() { Ok(node) } else { Err(convert.faults) }
}

fn shift(node: &mut Node, offset: u32) {
    let moved = |span: &mut Span| (span.start, span.end) = (span.start + offset, span.end + offset);
    moved(&mut node.span);
    match &mut node.value {
        Value::List(list) => list.iter_mut().for_each(|node| shift(node, offset)),
        Value::Table(table) => table.0.values_mut().for_each(|entry| {
            moved(&mut entry.key);
            shift(&mut entry.node, offset);
        }),
        Value::Text(_)
        | Value::Int(_)
        | Value::Real(_)
        | Value::Flag(_)
        | Value::Date(_)
        | Value::Hole
        | Value::Probe => {}
    }
}

/// A span inside the text and on its character boundaries, whatever the TOML reader gives.
fn span(sources: &Sources, index: u32, range: Range<usize>) -> Span {
    let text = &sources.0[index as usize].text;
    let end = text.floor_char_boundary(range.end.min(text.len()));
    let start = text.floor_char_boundary(range.start.min(end));
    Span { source: index, start: start as u32, end: end as u32 }
}

struct Convert<'a> {
    sources: &'a Sources,
    index: u32,
    faults: Vec<Fault>,
}

impl Convert<'_> {
    fn span(&self, range: Range<usize>) -> Span {
        span(self.sources, self.index, range)
    }

    fn table(&mut self, table: DeTable<'_>, depth: usize) -> Table {
        let entry = |(key, value): (Spanned<_>, _)| {
            let key_span = self.span(key.span());
            (std::borrow::Cow::into_owned(key.into_inner()), Entry { key: key_span, node: self.node(value, depth + 1) })
        };
        Table(table.into_iter().map(entry).collect())
    }

    fn node(&mut self, value: Spanned<DeValue<'_>>, depth: usize) -> Node {
        let span = self.span(value.span());
        let value = match value.into_inner() {
            DeValue::Array(_) | DeValue::Table(_) if depth > DEEPEST => self.hole(span, "nested too deeply".to_owned()),
            DeValue::String(text) => Value::Text(text.into_owned()),
            DeValue::Boolean(flag) => Value::Flag(flag),
            DeValue::Datetime(date) => Value::Date(date.to_string()),
            DeValue::Array(list) => Value::List(list.into_iter().map(|item| self.node(item, depth + 1)).collect()),
            DeValue::Table(table) => Value::Table(self.table(table, depth)),
            DeValue::Integer(whole) => match i64::from_str_radix(whole.as_str(), whole.radix()) {
                Ok(whole) => Value::Int(whole),
                Err(_) => self.hole(span, format!("`{whole}` is too large for a whole number")),
            },
            DeValue::Float(real) => match real.as_str().parse::<f64>() {
                Ok(number) if vanishes(real.as_str(), number) => {
                    self.hole(span, format!("`{real}` is too small: it would be 0"))
                }
                Ok(number) if number.is_finite() => Value::Real(number),
                _ => self.hole(span, format!("`{real}` is not a finite number")),
            },
        };
        Node { span, value }
    }

    fn hole(&mut self, span: Span, message: String) -> Value {
        if self.faults.len() < MOST_FAULTS {
            self.faults.push(Fault::new(message).at(self.sources.location(span)));
        }
        Value::Hole
    }
}
