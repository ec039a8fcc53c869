//! The origin of results: machine, version, commit.

use serde::{Deserialize, Serialize};

/// Machine, version and commit that computed a result; recorded with it, and never part of a key or a result.
#[derive(Clone, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub struct Origin {
    /// Name of the machine.
    pub machine: String,
    /// Version of flow.
    pub version: String,
    /// Git commit of the folder of the workflow, followed by `-dirty` when files were changed since; `""` when unknown.
    pub commit: String,
}

/// Longest of the texts, bytes: together they fit the head of a journal segment.
const LONGEST: usize = 100;

impl Origin {
    /// This machine and this version, with no commit.
    pub fn here() -> Self {
        Self { machine: Self::machine(), version: env!("CARGO_PKG_VERSION").to_owned(), commit: String::new() }
    }

    /// Whether anything is known of it: a result whose record was lost is found again by its object, which does not say.
    pub fn is_known(&self) -> bool {
        !(self.machine.is_empty() && self.version.is_empty())
    }

    /// Name of this machine.
    pub(super) fn machine() -> String {
        let machine = ["/proc/sys/kernel/hostname", "/etc/hostname"].iter().find_map(|file| {
            let name = std::fs::read_to_string(file).ok()?.trim().to_owned();
            (!name.is_empty()).then_some(name)
        });
        machine.or_else(|| std::env::var("HOSTNAME").ok()).unwrap_or_else(|| "unknown".to_owned())
    }

    /// The origin with every text cut to what the journal can hold.
    pub(super) fn shortened(&self) -> Self {
        let short = |text: &str| {
            let plain = text.chars().filter(|c| c.is_ascii_graphic() && !matches!(c, '"' | '\\')).take(LONGEST);
            plain.collect::<String>()
        };
        Self { machine: short(&self.machine), version: short(&self.version), commit: short(&self.commit) }
    }
}
