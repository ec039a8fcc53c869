//! How the texts on the validity of a run are read from the files of a program.

use super::folder::{Folder, shown};
use super::json;
use super::read::{Source, from_csv};
use crate::stage::Complaint;
use regex_lite::Regex;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::Value;

/// Where a text is that says why a run is not valid, or needs caution.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ReadText {
    /// The file in the run's folder; `stdout` and `stderr` hold the output of the program.
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

impl ReadText {
    /// Its faults, as the value of the stage's `key`.
    pub(super) fn check(&self, key: &str) -> Vec<Complaint> {
        let source = Source { file: &self.file, ways: [&self.column, &self.pointer, &self.pattern] };
        source.check(key, key, ("the reason", "pattern = 'not valid: (.+)'"))
    }

    /// The reasons, joined; empty when there is none.
    pub(super) fn reason(&self, folder: &Folder) -> Result<String, String> {
        let text = folder.text(&self.file)?;
        let found = if let Some(column) = &self.column {
            from_csv(&text, column).map(|mut cells| cells.split_off(cells.len().saturating_sub(1)))
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

/// The text, or the texts of the list, at the pointer.
fn reasons_from_json(text: &str, pointer: &str) -> Result<Vec<String>, String> {
    let value = json::parse(text)?;
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reasons_are_texts_and_nothing_else() {
        let json = |text: &str| reasons_from_json(text, "/v");
        let words = |list: &[&str]| Ok(list.iter().map(|&word| word.to_owned()).collect::<Vec<_>>());
        assert_eq!(json(r#"{"v": null}"#), words(&[]));
        assert_eq!(json(r#"{"v": "rotation"}"#), words(&["rotation"]));
        assert_eq!(json(r#"{"v": ["rotation", ""]}"#), words(&["rotation", ""]));
        assert_eq!(json(r#"{"E": NaN, "v": "rotation"}"#), words(&["rotation"]));
        for (text, told) in [(r#"{"v": false}"#, "`false`"), (r#"{"v": [1]}"#, "`[1]`"), ("{}", "nothing at")] {
            assert!(json(text).unwrap_err().contains(told), "{text}");
        }
        assert_eq!(all_matches("not valid: a\nfine\nnot valid: b\n", "not valid: (.+)"), words(&["a", "b"]));
        assert_eq!(all_matches("fine\n", "not valid: (.+)"), words(&[]));
    }
}
