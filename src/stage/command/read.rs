//! How a response is read from the files of a program.

use super::folder::{Folder, is_plain};
use super::json;
use super::number::{Number, number};
use crate::stage::sheet::Sheet;
use crate::stage::{Complaint, Context, rows};
use regex_lite::Regex;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::Value;

/// Where a response is: in a column of a CSV file, at a pointer of a JSON file, or at a pattern of a text file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Read {
    /// The file in the run's folder; `stdout` and `stderr` hold the output of the program.
    file: String,
    /// Column of a CSV file with a first line of names.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    column: Option<String>,
    /// Pointer into a JSON file, such as `/result/UCS`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pointer: Option<String>,
    /// Regular expression whose first group is the number.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pattern: Option<String>,
    /// Which row of the column, or which match of the pattern, is taken.
    #[serde(default, skip_serializing_if = "Take::is_default")]
    take: Take,
    /// Unit of the number; none for a pure number.
    #[serde(default)]
    unit: String,
}

/// Which of several numbers is the response.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub(super) enum Take {
    /// The last, such as the number that a program prints at the end of a run.
    #[default]
    Last,
    /// The first.
    First,
    /// The smallest.
    Minimum,
    /// The largest, such as the peak of a history of stress.
    Maximum,
    /// The mean of all.
    Mean,
}

impl Take {
    fn is_default(&self) -> bool {
        *self == Self::default()
    }

    /// The number among these texts, in their order; there is at least one. Missing values are skipped unless the first or the
    /// last is taken.
    fn of(self, texts: &[String]) -> Result<Number, String> {
        let read = |text: &String| number(text).map_err(|why| format!("`{text}` {why}"));
        let ends = match self {
            Self::Last => texts.last(),
            Self::First => texts.first(),
            Self::Minimum | Self::Maximum | Self::Mean => None,
        };
        if let Some(text) = ends {
            return read(text);
        }
        let mut found = Vec::with_capacity(texts.len());
        for text in texts {
            if let Number::Finite(value) = read(text)? {
                found.push(value);
            }
        }
        let count = found.len() as f64;
        let value = match self {
            Self::Minimum => found.into_iter().reduce(f64::min),
            Self::Mean => found.into_iter().reduce(|a, b| a + b).map(|sum| sum / count),
            Self::Maximum | Self::Last | Self::First => found.into_iter().reduce(f64::max),
        };
        Ok(value.map_or(Number::Missing, Number::Finite))
    }
}

/// The file of a value, and the ways to read it: a column, a pointer and a pattern, of which one must be set.
pub(super) struct Source<'a> {
    pub file: &'a str,
    pub ways: [&'a Option<String>; 3],
}

impl Source<'_> {
    /// The faults of the table at `path`, which reads `name`; `group` is the meaning of the pattern's group, with an
    /// example of a pattern.
    pub(super) fn check(&self, path: &str, name: &str, group: (&str, &str)) -> Vec<Complaint> {
        let at = |key: &str| format!("{path}.{key}");
        let mut found = Vec::new();
        if !is_plain(self.file) {
            let message = format!("`{}` must be a plain name inside the run's folder", self.file);
            let hint = "leave out `..` and a leading `/`; a file outside is in no key: list it in `files`";
            found.push(Complaint::new(&at("file"), message).hint(hint));
        }
        let ways = self.ways.iter().filter(|way| way.is_some()).count();
        if ways != 1 {
            let hint = "give one of `column` (CSV), `pointer` (JSON), `pattern` (text)";
            found.push(Complaint::new(path, format!("{ways} ways to read `{name}`, not one")).hint(hint));
        }
        let [.., pattern] = self.ways;
        match pattern.as_deref().map(Regex::new) {
            Some(Err(e)) => found.push(Complaint::new(&at("pattern"), e.to_string())),
            Some(Ok(regex)) if regex.captures_len() != 2 => {
                let message = format!("the pattern needs exactly one group: {}", group.0);
                found.push(Complaint::new(&at("pattern"), message).hint(group.1));
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

    pub(super) fn check(&self, name: &str, context: &Context) -> Vec<Complaint> {
        let at = |key: &str| format!("read.{name}.{key}");
        let source = Source { file: &self.file, ways: [&self.column, &self.pointer, &self.pattern] };
        let mut found = source.check(&at(""), name, ("the number", r"pattern = 'UCS = (\S+)'"));
        found.extend(rows::check_response(&at("unit"), name, &self.unit, context));
        if self.pointer.is_some() && !self.take.is_default() {
            let message = "a pointer names one number, so there is nothing to choose from";
            found.push(Complaint::new(&at("take"), message).hint("leave `take` out, or read a column or a pattern"));
        }
        found
    }

    /// The number, in the unit of this response, or why it has no value although the program ended well.
    ///
    /// # Errors
    /// The fault of the file or the number.
    pub(super) fn value(&self, folder: &Folder) -> Result<Result<f64, String>, String> {
        let text = folder.text(&self.file)?;
        let found = if let Some(column) = &self.column {
            from_csv(&text, column).and_then(|texts| self.take.of(&texts))
        } else if let Some(pointer) = &self.pointer {
            from_json(&text, pointer)
        } else {
            from_text(&text, self.pattern.as_deref().unwrap_or_default()).and_then(|texts| self.take.of(&texts))
        };
        match found.map_err(|why| format!("`{}`: {why}", self.file))? {
            Number::Finite(value) => Ok(Ok(value)),
            Number::Missing => Ok(Err(format!("the program left no value for it in `{}`", self.file))),
        }
    }
}

/// The cells of a column; there is at least one.
pub(super) fn from_csv(text: &str, column: &str) -> Result<Vec<String>, String> {
    let sheet = Sheet::read(text.as_bytes()).map_err(|e| e.to_string())?;
    let place =
        sheet.place(column).ok_or_else(|| format!("no column `{column}`; it has {}", sheet.heads.join(", ")))?;
    if sheet.heads.iter().filter(|head| *head == column).count() > 1 {
        return Err(format!("two columns are called `{column}`"));
    }
    if sheet.rows() == 0 { Err("no rows".to_owned()) } else { Ok(sheet.columns[place].clone()) }
}

/// The number at a pointer; `null` is a missing value.
fn from_json(text: &str, pointer: &str) -> Result<Number, String> {
    let value = json::parse(text)?;
    match value.pointer(pointer) {
        Some(Value::Number(found)) => {
            let found = found.to_string();
            number(&found).map_err(|why| format!("`{found}` {why}"))
        }
        Some(Value::Null) => Ok(Number::Missing),
        Some(Value::String(word)) => number(word).map_err(|why| format!("`{pointer}`: `{word}` {why}")),
        Some(other) => Err(format!("`{pointer}` is `{other}`, not a number")),
        None => Err(format!("nothing at `{pointer}`")),
    }
}

/// The numbers that a pattern finds; there is at least one.
fn from_text(text: &str, pattern: &str) -> Result<Vec<String>, String> {
    let regex = Regex::new(pattern).map_err(|e| e.to_string())?;
    // A pattern such as `(.*)` matches the empty end of the text too.
    let groups = regex.captures_iter(text).filter_map(|all| Some(all.get(1)?.as_str()));
    let found: Vec<String> = groups.filter(|group| !group.is_empty()).map(str::to_owned).collect();
    if found.is_empty() { Err(format!("nothing matches `{pattern}`")) } else { Ok(found) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn csv(text: &str, take: Take) -> Result<Number, String> {
        from_csv(text, "UCS").and_then(|texts| take.of(&texts))
    }

    fn text(text: &str, pattern: &str) -> Result<Number, String> {
        from_text(text, pattern).and_then(|texts| Take::Last.of(&texts))
    }

    #[test]
    fn numbers_are_found_in_each_form() {
        assert_eq!(csv("a, UCS\n1, 2\n3, 4.5\n", Take::Last), Ok(Number::Finite(4.5)));
        assert_eq!(from_json(r#"{"r": [1, {"UCS": 3e7}]}"#, "/r/1/UCS"), Ok(Number::Finite(3e7)));
        assert_eq!(text("UCS = 1\nUCS = 2\n", r"UCS = (\S+)"), Ok(Number::Finite(2.0)));
        assert_eq!(text("UCS = 1.0D+03 \n", r"UCS = (\S+)"), Ok(Number::Finite(1000.0)));
        assert_eq!(text("35.5\n", "(.*)"), Ok(Number::Finite(35.5)));
    }

    #[test]
    fn a_history_gives_its_ends_its_extremes_and_its_mean() {
        let history = "t,UCS\n1,2.0\n2,NaN\n3,8.0d0\n4,5.0\n";
        let of = |take| csv(history, take);
        assert_eq!(of(Take::First), Ok(Number::Finite(2.0)));
        assert_eq!(of(Take::Last), Ok(Number::Finite(5.0)));
        assert_eq!(of(Take::Minimum), Ok(Number::Finite(2.0)));
        assert_eq!(of(Take::Maximum), Ok(Number::Finite(8.0)));
        assert_eq!(of(Take::Mean), Ok(Number::Finite(5.0)));
        assert_eq!(csv("UCS\nNaN\n\"\"\n", Take::Maximum).unwrap_err(), "`` is not a number");
        assert_eq!(csv("UCS\nNaN\n", Take::Maximum), Ok(Number::Missing));
    }

    #[test]
    fn a_nan_in_json_costs_only_its_own_value() {
        let json =
            r#"{"nu": NaN, "E": 3e9, "note \"NaN": "NaN \\", "s": [-Infinity, NaN], "none": null, "D": "1.5D2"}"#;
        assert_eq!(from_json(json, "/nu"), Ok(Number::Missing));
        assert_eq!(from_json(json, "/none"), Ok(Number::Missing));
        assert_eq!(from_json(json, "/E"), Ok(Number::Finite(3e9)));
        assert_eq!(from_json(json, "/D"), Ok(Number::Finite(150.0)));
        assert_eq!(from_json(json, "/s/1"), Ok(Number::Missing));
        assert!(from_json(json, "/s/0").unwrap_err().contains("`-Infinity` is not a finite number"));
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
