//! A task as a line of JSON for a worker: all that decides its result, and where its inputs are.
//!
//! The task text alone is not enough: it has no paths of files and no time limits, and names inputs by content only.
//! Parameters are written as the digits of their bytes, so that no number is rounded.

use crate::artifact::Key;
use crate::plan::key::task_text;
use crate::stage::{FileInput, Packed, Source, Task, work};
use crate::store::Located;
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// A task in a list.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Line {
    /// Its key, as the submitter computed it.
    pub key: String,
    /// Its stage, for people.
    pub stage: String,
    /// Its design row, for people.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub row: Option<usize>,
    /// Seconds that 19 of 20 such tasks took less than, where that is known.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub seconds: Option<f64>,
    work: String,
    params: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    seed: Option<u64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    limit: Option<f64>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    inputs: Vec<(String, String)>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    files: Vec<(String, PathBuf, String)>,
}

/// A task as a worker runs it.
pub struct Errand {
    /// The task; its inputs are contents.
    pub task: Task,
    /// Where its inputs are.
    pub inputs: Vec<(String, Located)>,
    /// Its text.
    pub text: String,
    /// Its key.
    pub key: Key,
}

impl Line {
    /// The line of a task whose inputs are at these locations.
    pub fn new(task: &Task, key: &Key, stage: &str, inputs: &[Located], seconds: Option<f64>) -> Self {
        let absolute = |path: &PathBuf| std::path::absolute(path).unwrap_or_else(|_| path.clone());
        let hex = |digest: &[u8; 32]| blake3::Hash::from_bytes(*digest).to_hex().to_string();
        Self {
            key: key.to_string(),
            stage: stage.to_owned(),
            row: task.row,
            seconds,
            work: task.work.to_owned(),
            params: task.params.to_hex(),
            seed: task.seed,
            limit: task.time_limit,
            inputs: task.inputs.iter().zip(inputs).map(|((name, _), at)| (name.to_string(), at.to_text())).collect(),
            files: task.files.iter().map(|file| (file.name.clone(), absolute(&file.path), hex(&file.digest))).collect(),
        }
    }

    /// The text of the line in a list.
    pub fn to_text(&self) -> String {
        serde_json::to_string(self).unwrap_or_else(|error| panic!("BUG: a task that is no JSON: {error}"))
    }

    /// The task of this line.
    ///
    /// # Errors
    /// The program of the submitter is another one: it gives this task another key.
    pub fn errand(&self) -> Result<Errand, String> {
        let unread = |what: &str| format!("the task's {what} cannot be read; {OTHER}");
        let known = work(&self.work).ok_or_else(|| format!("there is no work `{}`; {OTHER}", self.work))?;
        let located = |(name, at): &(String, String)| Some((name.clone(), Located::from_text(at)?));
        let inputs: Vec<(String, Located)> =
            self.inputs.iter().map(located).collect::<Option<_>>().ok_or_else(|| unread("inputs"))?;
        let file = |(name, path, digest): &(String, PathBuf, String)| {
            let digest = *blake3::Hash::from_hex(digest).ok()?.as_bytes();
            Some(FileInput { name: name.clone(), path: path.clone(), digest })
        };
        let source = |(name, at): &(String, Located)| (name.clone().into(), Source::Content(at.object.content));
        let task = Task {
            work: known.name,
            params: Packed::from_hex(&self.params).ok_or_else(|| unread("parameters"))?,
            seed: self.seed,
            inputs: inputs.iter().map(source).collect(),
            files: self.files.iter().map(file).collect::<Option<_>>().ok_or_else(|| unread("files"))?,
            row: self.row,
            time_limit: self.limit,
            at_once: None,
            cached: None,
        };
        let contents: Vec<_> = inputs.iter().map(|(_, at)| at.object.content).collect();
        let text = task_text(&task, &contents);
        let key = Key::of(&text);
        if key.to_string() != self.key {
            return Err(format!("this program gives the task another key; {OTHER}"));
        }
        Ok(Errand { task, inputs, text, key })
    }
}

const OTHER: &str = "the worker is another version of flow than the submitter: see `flow` in the site file, and let both \
                     be the same program";

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    /// Numbers of all sizes: a reader of text that rounds carelessly misses the last bit of some.
    fn hard() -> Vec<f64> {
        (1..400).map(|k| 0.013 * f64::from(k) / 7.0 * 10f64.powi(k % 40 - 20)).chain([0.013, 0.1 + 0.7]).collect()
    }

    fn task() -> Task {
        let params = json!({ "a": 0.1 + 0.2, "b": -0.0, "c": [1, 2.5e300], "hard": hard(), "run": ["sh", "-c", "echo \"x\n\""] });
        let mut task = Task::new("command", params).seed(u64::MAX).row(6);
        task.files = vec![FileInput { name: "t".to_owned(), path: "in.txt".into(), digest: [3; 32] }];
        task.time_limit = Some(0.1);
        task
    }

    fn line(task: &Task) -> Line {
        Line::new(task, &Key::of(&task_text(task, &[])), "rows", &[], Some(1.5))
    }

    #[test]
    fn a_task_comes_back_with_its_key_from_one_line_of_text() {
        let (task, line) = (task(), line(&task()));
        let text = line.to_text();
        assert!(!text.contains('\n'));
        let back: Line = serde_json::from_str(&text).unwrap();
        let errand = back.errand().unwrap();
        assert_eq!((&errand.task.params, errand.task.seed), (&task.params, task.seed));
        assert_eq!((errand.task.row, errand.task.time_limit), (Some(6), Some(0.1)));
        assert!(errand.task.files[0].path.is_absolute(), "workers stand elsewhere");
        assert_eq!(errand.key.to_string(), line.key);
    }

    #[test]
    fn a_worker_that_is_another_program_refuses() {
        let mut other = line(&task());
        other.key = "0".repeat(64);
        assert!(other.errand().err().unwrap().contains("another key; the worker is another version of flow"));
        let mut other = line(&task());
        other.work = "simulate_gpu".to_owned();
        assert!(other.errand().err().unwrap().contains("no work `simulate_gpu`"));
        let mut other = line(&task());
        other.params = "ff".to_owned();
        assert!(other.errand().err().unwrap().contains("parameters cannot be read"));
    }
}
