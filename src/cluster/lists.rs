//! The lists of a queue, of which one is in memory at a time: the lines take much more room than what is known of the tasks.
//!
//! Tasks are numbered through all lists, from 0.

use super::line::Line;
use crate::store::{Queue, StoreError};
use std::ops::Range;

/// A submitter puts at most so many tasks into a list.
const MOST_LINES: usize = 10_000;
/// A list with more bytes than this is full.
const MOST_BYTES: usize = 2 << 20;

/// The lines of a list that is being made.
#[derive(Default)]
pub struct Draft {
    text: String,
    count: usize,
}

impl Draft {
    /// Adds the line of a task.
    pub fn add(&mut self, line: &str) {
        self.text.push_str(line);
        self.text.push('\n');
        self.count += 1;
    }

    /// Whether the list is to be written.
    pub fn is_full(&self) -> bool {
        self.count >= MOST_LINES || self.text.len() >= MOST_BYTES
    }
}

/// The lists that were written or read so far.
#[derive(Default)]
pub struct Lists {
    /// For each list, the number of the first task after it.
    ends: Vec<usize>,
    /// The list that was read last, and its index.
    open: Option<(usize, Text)>,
}

/// A list in memory.
struct Text {
    text: String,
    /// Where its lines end.
    ends: Vec<usize>,
}

impl Text {
    fn new(text: String) -> Self {
        let ends = text.bytes().enumerate().filter(|(_, byte)| *byte == b'\n').map(|(at, _)| at).collect();
        Self { text, ends }
    }

    fn line(&self, number: usize) -> Option<&str> {
        let start = number.checked_sub(1).map_or(Some(0), |before| Some(self.ends.get(before)? + 1))?;
        self.text.get(start..*self.ends.get(number)?)
    }
}

impl Lists {
    /// Number of lists.
    pub fn count(&self) -> usize {
        self.ends.len()
    }

    /// Number of tasks in them.
    pub fn tasks(&self) -> usize {
        self.ends.last().copied().unwrap_or(0)
    }

    /// Writes the next list.
    ///
    /// # Errors
    /// The store cannot be written.
    pub fn write(&mut self, queue: &Queue, list: &Draft) -> Result<(), StoreError> {
        queue.put_list(self.count() + 1, &list.text)?;
        self.ends.push(self.tasks() + list.count);
        Ok(())
    }

    /// Reads the next list; the numbers of its tasks, or none when there is none yet.
    ///
    /// # Errors
    /// The store cannot be read, or the list was not written by the submitter.
    pub fn read(&mut self, queue: &Queue) -> Result<Option<Range<usize>>, StoreError> {
        let Some(text) = queue.list(self.count() + 1)?.map(Text::new) else { return Ok(None) };
        let first = self.tasks();
        self.ends.push(first + text.ends.len());
        self.open = Some((self.count() - 1, text));
        Ok(Some(first..self.tasks()))
    }

    /// The text of a task.
    ///
    /// # Errors
    /// The list is gone or has changed, or the store cannot be read.
    pub fn text(&mut self, queue: &Queue, task: usize) -> Result<&str, StoreError> {
        let list = self.ends.partition_point(|end| *end <= task);
        let first = list.checked_sub(1).map_or(0, |before| self.ends[before]);
        if self.open.as_ref().is_none_or(|(open, _)| *open != list) {
            let text = queue.list(list + 1)?.ok_or_else(|| queue.lacks(list + 1))?;
            self.open = Some((list, Text::new(text)));
        }
        let line = self.open.as_ref().and_then(|(_, text)| text.line(task - first));
        line.ok_or_else(|| queue.lacks(list + 1))
    }

    /// A task.
    ///
    /// # Errors
    /// As [`Lists::text`], or another version of flow wrote the list; in words.
    pub fn line(&mut self, queue: &Queue, task: usize) -> Result<Line, String> {
        let text = self.text(queue, task).map_err(|error| error.to_string())?;
        serde_json::from_str(text).map_err(|error| {
            format!("a list cannot be read ({error}): the worker is another version of flow than the submitter")
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::store::{Mark, Store};

    #[test]
    fn a_list_is_full_by_its_lines_or_by_its_bytes() {
        let full = |line: &str| {
            let mut draft = Draft::default();
            while !draft.is_full() {
                draft.add(line);
            }
            draft.count
        };
        assert_eq!((full("short"), full(&"x".repeat(MOST_BYTES / 4))), (MOST_LINES, 4));
    }

    #[test]
    fn a_task_of_any_list_is_found_by_its_number() {
        let folder = tempfile::tempdir().unwrap();
        let store = Store::open_as(&folder.path().join("store"), Mark::of(&[1; 32])).unwrap();
        let queue = store.make_queue("q-1").unwrap();
        let mut written = Lists::default();
        let lines = |tasks: Range<usize>| {
            let mut draft = Draft::default();
            tasks.for_each(|task| draft.add(&format!("line {task}")));
            draft
        };
        for tasks in [0..3, 3..4, 4..9] {
            written.write(&queue, &lines(tasks)).unwrap();
        }
        let mut read = Lists::default();
        let ranges: Vec<_> = std::iter::from_fn(|| read.read(&queue).unwrap()).collect();
        assert_eq!(ranges, [0..3, 3..4, 4..9]);
        for lists in [&mut written, &mut read] {
            for task in [8, 0, 3, 2, 4, 8, 7] {
                assert_eq!(lists.text(&queue, task).unwrap(), format!("line {task}"));
            }
            assert_eq!((lists.count(), lists.tasks()), (3, 9));
            let error = lists.text(&queue, 9).unwrap_err().to_string();
            assert!(error.contains("could not read") && error.contains("tasks-0004.jsonl"), "{error}");
            let error = lists.line(&queue, 1).unwrap_err();
            assert!(error.contains("another version of flow than the submitter"), "{error}");
        }
        std::fs::write(queue.path().join("tasks-0002.jsonl"), "other").unwrap();
        assert!(written.text(&queue, 3).unwrap_err().to_string().contains("not the list that was submitted"));
    }
}
