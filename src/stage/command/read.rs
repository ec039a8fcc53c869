//! How a response is read from what a program left.

use super::folder::{Folder, is_plain};
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

impl Read {
    pub(super) fn unit(&self) -> &str {
        &self.unit
    }

    pub(super) fn check(&self, name: &str, context: &Context) -> Vec<Complaint> {
        let at = |key: &str| format!("read.{name}.{key}");
        let mut found = Vec::new();
        if !is_plain(&self.file) {
            let message = format!("`{}` must be a plain name inside the run's folder", self.file);
            let hint = "leave out `..` and a leading `/`: what lies outside is in no key; list it in `files`";
            found.push(Complaint::new(&at("file"), message).hint(hint));
        }
        let ways = [&self.column, &self.pointer, &self.pattern].iter().filter(|way| way.is_some()).count();
        if ways != 1 {
            let hint = "give one of `column` (CSV), `pointer` (JSON), `pattern` (text)";
            found.push(Complaint::new(&at(""), format!("{ways} ways to read `{name}`, not one")).hint(hint));
        }
        found.extend(rows::check_response(&at("unit"), name, &self.unit, context));
        match self.pattern.as_deref().map(Regex::new) {
            Some(Err(e)) => found.push(Complaint::new(&at("pattern"), e.to_string())),
            Some(Ok(regex)) if regex.captures_len() != 2 => {
                let message = "the pattern needs exactly one group: the number";
                found.push(Complaint::new(&at("pattern"), message).hint(r"pattern = 'UCS = (\S+)'"));
            }
            Some(Ok(_)) | None => {}
        }
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
        let value: f64 = number.trim().parse().map_err(|_| format!("`{}`: `{number}` is not a number", self.file))?;
        if value.is_finite() { Ok(value) } else { Err(format!("`{}`: `{number}` is not a finite number", self.file)) }
    }
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
    fn what_is_missing_is_named() {
        assert_eq!(from_csv("a,b\n1,2\n", "UCS"), Err("no column `UCS`; it has a, b".to_owned()));
        assert_eq!(from_csv("UCS\n", "UCS"), Err("no rows".to_owned()));
        assert!(from_json("garbage", "/x").is_err());
        assert_eq!(from_json("{}", "/x"), Err("nothing at `/x`".to_owned()));
        assert!(from_text("silence", "UCS = (.*)").unwrap_err().contains("nothing matches"));
    }
}
