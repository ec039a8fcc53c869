//! How the words on the validity of a run are read from what a program left.

use super::folder::{Folder, is_plain, shown};
use super::json;
use super::read::from_csv;
use crate::stage::Complaint;
use regex::Regex;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::Value;

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

impl ReadText {
    /// What is wrong with it, as the value of the stage's `key`.
    pub(super) fn check(&self, key: &str) -> Vec<Complaint> {
        let at = |own: &str| format!("{key}.{own}");
        let mut found = Vec::new();
        if !is_plain(&self.file) {
            let message = format!("`{}` must be a plain name inside the run's folder", self.file);
            let hint = "leave out `..` and a leading `/`: what lies outside is in no key; list it in `files`";
            found.push(Complaint::new(&at("file"), message).hint(hint));
        }
        let ways = [&self.column, &self.pointer, &self.pattern].iter().filter(|way| way.is_some()).count();
        if ways != 1 {
            let hint = "give one of `column` (CSV), `pointer` (JSON), `pattern` (text)";
            found.push(Complaint::new(key, format!("{ways} ways to read `{key}`, not one")).hint(hint));
        }
        match self.pattern.as_deref().map(Regex::new) {
            Some(Err(e)) => found.push(Complaint::new(&at("pattern"), e.to_string())),
            Some(Ok(regex)) if regex.captures_len() != 2 => {
                let message = "the pattern needs exactly one group: the reason";
                found.push(Complaint::new(&at("pattern"), message).hint("pattern = 'not valid: (.+)'"));
            }
            Some(Ok(_)) | None => {}
        }
        found
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

/// The text, or the texts of the list, that the pointer leads to.
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
