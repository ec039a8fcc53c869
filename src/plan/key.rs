//! The task text, and the key that is its hash.
//!
//! A task text holds all that decides a task's result, one fact per line, readable for people:
//!
//! ```text
//! flow task 1
//! work simulate 3
//! seed 42
//! param mortar.Ec 2e10
//! param speed 0.02
//! file table 8f14…
//! input specimen 91ab…
//! ```
//!
//! Parameters are flattened and in the order of their names; a name that is not of letters, digits, `_` and `-` is quoted. A
//! list of plain values stands in one line, `[10, 20, 30]`. Numbers have the fewest digits that read back to the same
//! number, equal numbers have one form (`1` and `1.0`, `-0` and `0`), and a parameter that is null is left out: an
//! option at its default reruns nothing. There is no text for NaN or an infinity, because [`serde_json::Value`] has none.
//! What is not in the text is not in the key: names of stages, rows, paths, threads.

use crate::artifact::ContentHash;
use crate::stage::{Task, work};
use serde_json::{Map, Number, Value};
use std::fmt::Write;

/// First line of every task text; the number rises when the form of the text changes.
pub const HEAD: &str = "flow task 1";

/// The text of a task whose inputs have the given contents, in the order of [`Task::inputs`].
pub fn task_text(task: &Task, inputs: &[ContentHash]) -> String {
    assert_eq!(task.inputs.len(), inputs.len(), "BUG: {} is given the contents of other inputs", task.work);
    let mut text = text_without_inputs(task, inputs.len());
    for ((name, _), content) in task.inputs.iter().zip(inputs) {
        hash_line(&mut text, "input", name, &content.0);
    }
    text
}

/// The text of a task up to its inputs, with room for so many.
pub fn text_without_inputs(task: &Task, room: usize) -> String {
    let version = work(task.work).map_or(0, |work| work.version);
    let mut text = String::with_capacity(256 + 96 * (room + task.files.len()));
    write(&mut text, format_args!("{HEAD}\nwork {} {version}\n", task.work));
    if let Some(seed) = task.seed {
        write(&mut text, format_args!("seed {seed}\n"));
    }
    params(&mut text, &mut String::with_capacity(64), &task.params.value());
    for file in &task.files {
        hash_line(&mut text, "file", &file.name, &file.digest);
    }
    text
}

/// The key: blake3 of the text.
pub fn key(text: &str) -> [u8; 32] {
    *blake3::hash(text.as_bytes()).as_bytes()
}

/// One line for each value below `path`.
fn params(text: &mut String, path: &mut String, value: &Value) {
    let length = path.len();
    match value {
        Value::Null => {}
        Value::Object(map) if !empty(map) => {
            for (name, value) in map {
                if length > 0 {
                    path.push('.');
                }
                push_name(path, name);
                params(text, path, value);
                path.truncate(length);
            }
        }
        Value::Array(list) if list.iter().any(|item| item.is_object() || item.is_array()) => {
            for (i, item) in list.iter().enumerate() {
                write(path, format_args!("[{i}]"));
                if item.is_null() {
                    param(text, path, item)
                } else {
                    params(text, path, item)
                }
                path.truncate(length);
            }
        }
        Value::Object(_) if length == 0 => {}
        Value::Object(_) | Value::Array(_) | Value::Bool(_) | Value::Number(_) | Value::String(_) => {
            param(text, path, value);
        }
    }
}

/// Without values: a table of nulls is like one without entries.
fn empty(map: &Map<String, Value>) -> bool {
    map.values().all(Value::is_null)
}

fn param(text: &mut String, path: &str, value: &Value) {
    text.push_str("param ");
    text.push_str(path);
    text.push(' ');
    push_value(text, value);
    text.push('\n');
}

fn hash_line(text: &mut String, what: &str, name: &str, hash: &[u8; 32]) {
    text.push_str(what);
    text.push(' ');
    push_name(text, name);
    text.push(' ');
    push_hex(text, hash);
    text.push('\n');
}

/// The hexadecimal digits of a hash, as blake3 gives them but faster: a task may have a hundred thousand inputs.
fn push_hex(text: &mut String, hash: &[u8; 32]) {
    let mut digits = [0; 64];
    for (pair, byte) in digits.as_chunks_mut::<2>().0.iter_mut().zip(hash) {
        *pair = [byte >> 4, byte & 15];
    }
    digits.iter_mut().for_each(|digit| *digit += if *digit < 10 { b'0' } else { b'a' - 10 });
    text.push_str(str::from_utf8(&digits).unwrap_or_default());
}

/// A name as it is when it is bare, else as a JSON text, so that no two paths have one form.
fn push_name(text: &mut String, name: &str) {
    let bare = |b: u8| b.is_ascii_alphanumeric() || b == b'_' || b == b'-';
    if !name.is_empty() && name.bytes().all(bare) { text.push_str(name) } else { push_text(text, name) }
}

fn push_text(text: &mut String, value: &str) {
    write(text, format_args!("{}", Value::from(value)));
}

fn push_value(text: &mut String, value: &Value) {
    match value {
        Value::Null => text.push_str("null"),
        Value::Bool(flag) => text.push_str(if *flag { "true" } else { "false" }),
        Value::Number(number) => push_number(text, number),
        Value::String(value) => push_text(text, value),
        Value::Array(list) => {
            text.push('[');
            for (i, item) in list.iter().enumerate() {
                text.push_str(if i > 0 { ", " } else { "" });
                push_value(text, item);
            }
            text.push(']');
        }
        Value::Object(map) => {
            assert!(empty(map), "BUG: a table with values has a line for each");
            text.push_str("{}");
        }
    }
}

/// Equal numbers have one form, whether they were whole by type or by value.
fn push_number(text: &mut String, number: &Number) {
    let exact = |real: f64| match (number.as_u64(), number.as_i64()) {
        (Some(whole), _) => real as u64 == whole && real < 18_446_744_073_709_551_616.0,
        (None, Some(whole)) => real as i64 == whole,
        (None, None) => true,
    };
    match number.as_f64() {
        Some(real) if exact(real) => push_real(text, real),
        _ => write(text, format_args!("{number}")),
    }
}

/// The fewest digits that read back to the same number; with an exponent when it is far from 1.
fn push_real(text: &mut String, real: f64) {
    let size = real.abs();
    if size < 1e7 && real.trunc() == real {
        // As below, but much faster for a whole number.
        write(text, format_args!("{}", real as i64));
    } else if (1e-4..1e7).contains(&size) {
        write(text, format_args!("{real}"));
    } else {
        write(text, format_args!("{real:e}"));
    }
}

fn write(text: &mut String, arguments: std::fmt::Arguments<'_>) {
    text.write_fmt(arguments).unwrap_or_else(|_| panic!("BUG: a text takes any character"));
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    /// The text of a task, whatever the version of `data` is by now.
    fn timeless(task: &Task, inputs: &[ContentHash]) -> String {
        let version = crate::stage::work("data").unwrap().version;
        task_text(task, inputs).replacen(&format!("work data {version}\n"), "work data 2\n", 1)
    }

    fn text(params: Value) -> String {
        timeless(&Task::new("data", params), &[])
    }

    #[test]
    fn every_fact_is_a_line() {
        let mut task = Task::new("data", json!({"test": {"speed": 0.02}, "mortar": {"Ec": 2e10}})).seed(42);
        task = task.input("specimen", ContentHash([1; 32])).row(7);
        let expected = format!(
            "flow task 1\nwork data 2\nseed 42\nparam mortar.Ec 2e10\nparam test.speed 0.02\ninput specimen {}\n",
            "01".repeat(32)
        );
        assert_eq!(timeless(&task, &[ContentHash([1; 32])]), expected);
    }

    /// Written down once; a change of this key reruns every campaign.
    #[test]
    fn the_key_is_pinned() {
        let key = key(&text(json!({"a": [1, 2.5], "b": {"c": "d e", "f": true}})));
        assert_eq!(blake3::Hash::from_bytes(key).to_hex().as_str(), PINNED);
    }
    const PINNED: &str = "a2af1a4c2a0070c6f5a5d4e09ecfee9842dd2e8e586909ad98f339ffadb17de7";

    #[test]
    fn equal_numbers_have_one_form_and_others_have_others() {
        for (a, b) in [(json!(1), json!(1.0)), (json!(0.0), json!(-0.0)), (json!(20_000_000_000_u64), json!(2e10))] {
            assert_eq!(text(json!({ "x": a })), text(json!({ "x": b })));
        }
        let line = |value: Value| text(json!({ "x": value })).lines().last().unwrap_or_default().to_owned();
        assert_eq!(line(json!(u64::MAX)), "param x 18446744073709551615");
        assert_eq!(line(json!(9_007_199_254_740_993_u64)), "param x 9007199254740993");
        assert_eq!(line(json!(i64::MIN)), line(json!(i64::MIN as f64)));
        assert_eq!(line(json!(0.1 + 0.2)), "param x 0.30000000000000004");
        assert_eq!(line(json!(1.6e10)), "param x 1.6e10");
        assert_eq!(line(json!(-1e-7)), "param x -1e-7");
    }
}
