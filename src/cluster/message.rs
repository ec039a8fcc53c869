//! The messages that a worker writes into its report, one line of JSON each.

use serde::{Deserialize, Serialize};

/// One line of a report. Tasks are numbered through all lists of a queue, from 0.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "message", rename_all = "kebab-case")]
pub enum Message {
    /// The worker has started.
    Started {
        /// Which submission of the queue it belongs to.
        round: usize,
        /// Which worker of that submission it is.
        index: usize,
        /// Its machine.
        machine: String,
        /// Digest of its program.
        program: String,
    },
    /// It has begun a task.
    Begun {
        /// The task.
        task: usize,
    },
    /// A task reports its progress.
    Stands {
        /// The task.
        task: usize,
        /// Part done, 0 to 1.
        #[serde(skip_serializing_if = "Option::is_none")]
        fraction: Option<f64>,
        /// A few words.
        note: String,
        /// Whether the words are a warning.
        #[serde(default)]
        warning: bool,
    },
    /// The result of a task is stored.
    Done {
        /// The task.
        task: usize,
        /// How long it took, seconds.
        seconds: f64,
    },
    /// A task failed.
    Failed {
        /// The task.
        task: usize,
        /// Why, in words.
        why: String,
    },
    /// A task was ended before its end. It can be begun again.
    Stopped {
        /// The task.
        task: usize,
        /// Why.
        cause: Cause,
    },
    /// A process outside of the queue computes the task.
    Elsewhere {
        /// The task.
        task: usize,
    },
    /// An input of a task could not be read.
    Lost {
        /// The task.
        task: usize,
        /// Content of the input.
        input: String,
        /// Why.
        why: String,
    },
    /// The worker has ended in order.
    Ended {
        /// What was wrong with its machine or the store; nothing when all was well.
        #[serde(skip_serializing_if = "Option::is_none")]
        fault: Option<String>,
    },
}

/// Why a worker ended a task before its end.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Cause {
    /// The worker's time was over.
    Time,
    /// The worker's time was over, and the task had nearly all of it: another worker would not finish it either.
    WholeTime,
    /// The scheduler has ended the worker.
    Signal,
    /// The store could not be written.
    Store,
}

impl Message {
    /// The line of a report. Of words that are too long for one, such as what a program has printed, the middle is left out.
    pub fn to_text(&self) -> String {
        let text = |message: &Self| {
            serde_json::to_string(message).unwrap_or_else(|error| panic!("BUG: a report that is no JSON: {error}"))
        };
        let whole = text(self);
        if whole.len() <= MOST_TEXT {
            return whole;
        }
        let mut short = self.clone();
        if let Self::Stands { note: words, .. }
        | Self::Failed { why: words, .. }
        | Self::Lost { why: words, .. }
        | Self::Ended { fault: Some(words) } = &mut short
        {
            *words = shortened(words);
        }
        text(&short)
    }

    /// The task that it is about.
    pub fn task(&self) -> Option<usize> {
        match self {
            Self::Begun { task }
            | Self::Stands { task, .. }
            | Self::Done { task, .. }
            | Self::Failed { task, .. }
            | Self::Stopped { task, .. }
            | Self::Elsewhere { task }
            | Self::Lost { task, .. } => Some(*task),
            Self::Started { .. } | Self::Ended { .. } => None,
        }
    }

    /// Reads a line; `None` when it is no message.
    pub fn read(line: &str) -> Option<Self> {
        serde_json::from_str(line).ok()
    }
}

/// The longest line, bytes; readers take a line of [`crate::store::MOST_NEWS`].
const MOST_TEXT: usize = 1 << 19;
/// Characters that are left at each end of words that are too long. One character takes at most six bytes of JSON.
const LEFT: usize = 1 << 15;

/// Words without their middle.
fn shortened(words: &str) -> String {
    let count = words.chars().count();
    if count <= 2 * LEFT {
        return words.to_owned();
    }
    let (start, end): (String, String) =
        (words.chars().take(LEFT).collect(), words.chars().skip(count - LEFT).collect());
    format!("{start} … ({} characters are left out here) … {end}", count - 2 * LEFT)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_that_are_too_long_for_a_line_keep_their_ends_and_say_what_is_missing() {
        for middle in ["x", "\0", "ε"] {
            let why = format!("first{}last", middle.repeat(600_000));
            let line = Message::Failed { task: 7, why }.to_text();
            assert!(line.len() <= MOST_TEXT && (line.len() as u64) < crate::store::MOST_NEWS, "{}", line.len());
            let Some(Message::Failed { task: 7, why }) = Message::read(&line) else { panic!("{middle:?}") };
            assert!(why.starts_with("first") && why.ends_with("last"));
            assert!(why.contains("(534473 characters are left out here)"), "{}", &why[LEFT..LEFT + 80]);
        }
    }

    #[test]
    fn reports_read_as_they_were_written_and_nonsense_says_nothing() {
        for message in [
            Message::Started { round: 1, index: 2, machine: "n1".to_owned(), program: "ab".to_owned() },
            Message::Stands { task: 3, fraction: Some(0.5), note: "ε \"1\"\n".to_owned(), warning: false },
            Message::Stopped { task: 3, cause: Cause::WholeTime },
            Message::Ended { fault: None },
        ] {
            assert!(!message.to_text().contains('\n'));
            assert_eq!(Message::read(&message.to_text()), Some(message));
        }
        assert_eq!(Message::read("{\"message\":\"begun\"}"), None);
        assert_eq!(Message::read("\0\0\0"), None);
    }
}
