//! How a response, and the words on the validity of a run, are read from what a program left.

use super::folder::{Folder, is_plain, shown};
use crate::stage::sheet::Sheet;
use crate::stage::{Complaint, Context, rows};
use regex::Regex;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::Value;

/// Where a response stands: in a column of a CSV file, at a pointer of a JSON file, or at a pattern of a text file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Read {
    /// The file in the run's folder; `stdout` and `stderr` hold what the program printed.
    file: String,
    /// Column of a CSV file with a first line of names; the last row counts.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    column: Option<String>,
    /// Pointer into a JSON file, such as `/result/UCS`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pointer: Option<String>,
    /// Regular expression whose first group is the number; the last match counts.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pattern: Option<String>,
    /// Unit of the number; none for a pure number.
    #[serde(default)]
    unit: String,
}

/// Where a text stands: the words after which a run is not valid, or is to be read with caution.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ReadText {
    /// The file in the run's folder; `stdout` and `stderr` hold what the program printed.
    file: String,
    /// Column of a CSV file with a first line of names; the last row counts. An empty cell is no reason.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    column: Option<String>,
    /// Pointer into a JSON file, such as `/checks/failed`, to a text or a list of texts. Empty ones and `null` are no reason.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pointer: Option<String>,
    /// Regular expression whose first group is the reason; every match counts, and there is no reason without one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pattern: Option<String>,
}

/// A file and one of the ways to find something in it.
struct Place<'a> {
    file: &'a str,
    column: Option<&'a str>,
    pointer: Option<&'a str>,
    pattern: Option<&'a str>,
}

impl Place<'_> {
    /// What is wrong with it; `at` is its path in the stage, `what` is what the pattern's group holds.
    fn check(&self, at: &str, name: &str, what: &str, example: &str) -> Vec<Complaint> {
        let key = |key: &str| format!("{at}.{key}");
        let mut found = Vec::new();
        if !is_plain(self.file) {
            let message = format!("`{}` must be a plain name inside the run's folder", self.file);
            let hint = "leave out `..` and a leading `/`: what lies outside is in no key; list it in `files`";
            found.push(Complaint::new(&key("file"), message).hint(hint));
        }
        let ways = [self.column, self.pointer, self.pattern].iter().filter(|way| way.is_some()).count();
        if ways != 1 {
            let hint = "give one of `column` (CSV), `pointer` (JSON), `pattern` (text)";
            found.push(Complaint::new(at, format!("{ways} ways to read `{name}`, not one")).hint(hint));
        }
        match self.pattern.map(Regex::new) {
            Some(Err(e)) => found.push(Complaint::new(&key("pattern"), e.to_string())),
            Some(Ok(regex)) if regex.captures_len() != 2 => {
                let message = format!("the pattern needs exactly one group: the {what}");
                found.push(Complaint::new(&key("pattern"), message).hint(format!("pattern = '{example}'")));
            }
            Some(Ok(_)) | None => {}
        }
        found
    }
}

impl Read {
    pub(super) fn unit(&self) -> &str {
        &self.unit
    }

    fn place(&self) -> Place<'_> {
        let Self { file, column, pointer, pattern, .. } = self;
        Place { file, column: column.as_deref(), pointer: pointer.as_deref(), pattern: pattern.as_deref() }
    }

    pub(super) fn check(&self, name: &str, context: &Context) -> Vec<Complaint> {
        let at = format!("read.{name}");
        let mut found = self.place().check(&at, name, "number", r"UCS = (\S+)");
        found.extend(rows::check_response(&format!("{at}.unit"), name, &self.unit, context));
        found
    }

    /// The number, in the unit of this response.
    pub(super) fn value(&self, folder: &Folder) -> Result<f64, String> {
        let text = folder.text(&self.file)?;
        let number = if let Some(column) = &self.column {
            from_csv(&text, column)
        } else if let Some(pointer) = &self.pointer {
            from_json(&text, pointer)
        } else {
            from_text(&text, self.pattern.as_deref().unwrap_or_default())
        };
        let number = number.map_err(|why| format!("`{}`: {why}", self.file))?;
        let value = number_of(number.trim()).ok_or_else(|| format!("`{}`: `{number}` is not a number", self.file))?;
        if value.is_finite() { Ok(value) } else { Err(format!("`{}`: `{number}` is not a finite number", self.file)) }
    }
}

/// A number as programs print it: Fortran writes powers of ten with a `D`.
fn number_of(text: &str) -> Option<f64> {
    let fortran = || {
        let (digits, power) = text.split_once(['d', 'D'])?;
        let numeric = |text: &str| text.bytes().all(|b| b.is_ascii_digit() || b"+-.".contains(&b));
        if numeric(digits) && numeric(power) { format!("{digits}e{power}").parse().ok() } else { None }
    };
    text.parse().ok().or_else(fortran)
}

impl ReadText {
    pub(super) fn check(&self, key: &str) -> Vec<Complaint> {
        let Self { file, column, pointer, pattern } = self;
        let place = Place { file, column: column.as_deref(), pointer: pointer.as_deref(), pattern: pattern.as_deref() };
        place.check(key, key, "reason", "not valid: (.+)")
    }

    /// The reasons, joined; empty when there is none.
    pub(super) fn reason(&self, folder: &Folder) -> Result<String, String> {
        let text = folder.text(&self.file)?;
        let found = if let Some(column) = &self.column {
            from_csv(&text, column).map(|cell| vec![cell])
        } else if let Some(pointer) = &self.pointer {
            reasons_from_json(&text, pointer)
        } else {
            all_matches(&text, self.pattern.as_deref().unwrap_or_default())
        };
        let mut reasons: Vec<String> = Vec::new();
        for reason in found.map_err(|why| format!("`{}`: {why}", self.file))? {
            let reason = shown(reason.trim());
            if !reason.is_empty() && !reasons.contains(&reason) {
                reasons.push(reason);
            }
        }
        Ok(reasons.join(", "))
    }
}

/// The text, or the texts of the list, that the pointer leads to.
fn reasons_from_json(text: &str, pointer: &str) -> Result<Vec<String>, String> {
    let value: Value = serde_json::from_str(text).map_err(|e| e.to_string())?;
    let word = |value: &Value| value.as_str().map(str::to_owned);
    let found = value.pointer(pointer).ok_or_else(|| format!("nothing at `{pointer}`"))?;
    let reasons = match found {
        Value::Null => Some(Vec::new()),
        Value::String(reason) => Some(vec![reason.clone()]),
        Value::Array(reasons) => reasons.iter().map(word).collect(),
        Value::Bool(_) | Value::Number(_) | Value::Object(_) => None,
    };
    reasons.ok_or_else(|| format!("`{pointer}` is `{found}`, neither a text, nor a list of texts, nor null"))
}

/// The group of every match.
fn all_matches(text: &str, pattern: &str) -> Result<Vec<String>, String> {
    let regex = Regex::new(pattern).map_err(|e| e.to_string())?;
    Ok(regex.captures_iter(text).filter_map(|all| Some(all.get(1)?.as_str().to_owned())).collect())
}

fn from_csv(text: &str, column: &str) -> Result<String, String> {
    let sheet = Sheet::read(text.as_bytes()).map_err(|e| e.to_string())?;
    let place =
        sheet.place(column).ok_or_else(|| format!("no column `{column}`; it has {}", sheet.heads.join(", ")))?;
    if sheet.heads.iter().filter(|head| *head == column).count() > 1 {
        return Err(format!("two columns are called `{column}`"));
    }
    sheet.columns[place].last().cloned().ok_or_else(|| "no rows".to_owned())
}

fn from_json(text: &str, pointer: &str) -> Result<String, String> {
    let value: Value = serde_json::from_str(text).map_err(|e| e.to_string())?;
    match value.pointer(pointer) {
        Some(Value::Number(number)) => Ok(number.to_string()),
        Some(other) => Err(format!("`{pointer}` is `{other}`, not a number")),
        None => Err(format!("nothing at `{pointer}`")),
    }
}

fn from_text(text: &str, pattern: &str) -> Result<String, String> {
    let regex = Regex::new(pattern).map_err(|e| e.to_string())?;
    // A pattern such as `(.*)` matches the empty end of the text too.
    let found =
        regex.captures_iter(text).filter_map(|all| Some(all.get(1)?.as_str())).filter(|group| !group.is_empty());
    found.last().map(str::to_owned).ok_or_else(|| format!("nothing matches `{pattern}`"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_found_in_each_form() {
        assert_eq!(from_csv("a, UCS\n1, 2\n3, 4.5\n", "UCS"), Ok("4.5".to_owned()));
        assert_eq!(from_json(r#"{"r": [1, {"UCS": 3e7}]}"#, "/r/1/UCS"), Ok("30000000.0".to_owned()));
        assert_eq!(from_text("UCS = 1\nUCS = 2\n", r"UCS = (\S+)"), Ok("2".to_owned()));
        assert_eq!(from_text("35.5\n", "(.*)"), Ok("35.5".to_owned()));
    }

    #[test]
    fn powers_of_fortran_are_numbers() {
        for (text, value) in
            [("1.5D+03", Some(1500.0)), ("-2d-1", Some(-0.2)), ("1d", None), ("d5", None), ("*****", None)]
        {
            assert_eq!(number_of(text), value, "{text}");
        }
    }

    #[test]
    fn reasons_are_texts_and_nothing_else() {
        let json = |text: &str| reasons_from_json(text, "/v");
        let words = |list: &[&str]| Ok(list.iter().map(|&word| word.to_owned()).collect::<Vec<_>>());
        assert_eq!(json(r#"{"v": null}"#), words(&[]));
        assert_eq!(json(r#"{"v": "rotation"}"#), words(&["rotation"]));
        assert_eq!(json(r#"{"v": ["rotation", ""]}"#), words(&["rotation", ""]));
        for (text, told) in [(r#"{"v": false}"#, "`false`"), (r#"{"v": [1]}"#, "`[1]`"), ("{}", "nothing at")] {
            assert!(json(text).unwrap_err().contains(told), "{text}");
        }
        assert_eq!(all_matches("not valid: a\nfine\nnot valid: b\n", "not valid: (.+)"), words(&["a", "b"]));
        assert_eq!(all_matches("fine\n", "not valid: (.+)"), words(&[]));
    }

    #[test]
    fn what_is_missing_is_named() {
        assert_eq!(from_csv("a,b\n1,2\n", "UCS"), Err("no column `UCS`; it has a, b".to_owned()));
        assert_eq!(from_csv("UCS\n", "UCS"), Err("no rows".to_owned()));
        assert!(from_json("garbage", "/x").is_err());
        assert_eq!(from_json("{}", "/x"), Err("nothing at `/x`".to_owned()));
        assert!(from_text("silence", "UCS = (.*)").unwrap_err().contains("nothing matches"));
    }
}
