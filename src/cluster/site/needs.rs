//! What a worker is given: tasks with equal needs share a queue.

use crate::unit::Time;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// An amount of memory in megabytes (10⁶ bytes), written with its unit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize, JsonSchema)]
#[serde(try_from = "String", into = "String")]
#[schemars(with = "String")]
pub struct Memory(pub u64);

impl TryFrom<String> for Memory {
    type Error = String;
    fn try_from(text: String) -> Result<Self, String> {
        let wrong = || format!("`{text}` is no amount of memory; write a number and MB, GB or TB, such as \"2 GB\"");
        let (number, unit) = text.trim().split_at(text.trim().find(|c: char| c.is_alphabetic()).ok_or_else(wrong)?);
        let factor = match unit {
            "MB" => 1.0,
            "GB" => 1e3,
            "TB" => 1e6,
            _ => return Err(wrong()),
        };
        let megabytes = number.trim().parse::<f64>().map_err(|_| wrong())? * factor;
        if !(1.0..1e9).contains(&megabytes) {
            return Err(wrong());
        }
        Ok(Self(megabytes.ceil() as u64))
    }
}

impl From<Memory> for String {
    fn from(memory: Memory) -> Self {
        memory.to_string()
    }
}

impl std::fmt::Display for Memory {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self.0 {
            megabytes if megabytes % 1000 == 0 => write!(f, "{} GB", megabytes / 1000),
            megabytes => write!(f, "{megabytes} MB"),
        }
    }
}

/// What one sort of workers is given: tasks with equal needs share a queue.
#[derive(Clone, Debug, PartialEq)]
pub struct Needs {
    /// Partition.
    pub partition: Option<String>,
    /// Most workers at once.
    pub workers: usize,
    /// Cores of a worker.
    pub cpus: usize,
    /// Memory of a worker.
    pub memory: Option<Memory>,
    /// Longest life of a worker.
    pub time: Option<Time>,
    /// More options of `sbatch`.
    pub options: Vec<String>,
    /// Whether a worker takes one task only: one that a lost worker had begun.
    pub alone: bool,
}

impl Needs {
    /// The same for a task that is tried again: alone, with twice the memory where that is known.
    pub fn again(&self) -> Self {
        Self { alone: true, memory: self.memory.map(|memory| Memory(2 * memory.0)), ..self.clone() }
    }
}
