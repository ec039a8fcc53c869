//! Records of campaigns: what ran, when, where and by what, for `flow diff` and for a person who reads the file.
//!
//! Each campaign leaves one JSON file `runs/N.json`, numbered in the order in which they ended.

use super::disk::Disk;
use super::{Origin, StoreError};
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// One run of a workflow.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Campaign {
    /// Number in this store, from 1; given when it is recorded.
    #[serde(skip)]
    pub number: u64,
    /// The workflow file, as it was named.
    pub workflow: String,
    /// The profile, `""` for none.
    pub profile: String,
    /// Overrides by path, as they were typed.
    pub set: Vec<String>,
    /// Start, milliseconds since 1970 UTC.
    pub started: i64,
    /// Duration, seconds.
    pub seconds: f64,
    /// Where and by what it ran.
    pub origin: Origin,
    /// Its stages in the order of the workflow.
    pub stages: Vec<StageRun>,
}

/// What became of a stage in one run.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct StageRun {
    /// Name in the workflow.
    pub name: String,
    /// Kind.
    pub kind: String,
    /// Its settings in canonical form, for the comparison of two runs.
    pub settings: serde_json::Value,
    /// Names of its input stages.
    pub inputs: Vec<String>,
    /// `done`, `cached`, `failed`, `skipped`, …
    pub state: String,
    /// Number of its tasks.
    pub tasks: u64,
    /// Tasks that ran.
    pub ran: u64,
    /// Tasks that were in the store.
    pub cached: u64,
    /// Tasks that failed.
    pub failed: u64,
    /// Time of its tasks together, seconds.
    pub seconds: f64,
    /// Content hash of its result.
    pub object: Option<String>,
    /// Key of its memo.
    #[serde(default)]
    pub memo: Option<String>,
}

fn folder(disk: &Disk) -> PathBuf {
    disk.root.join("runs")
}

/// Numbers of the recorded campaigns, in order.
pub(super) fn numbers(disk: &Disk) -> Result<Vec<u64>, StoreError> {
    let folder = folder(disk);
    let entries = match std::fs::read_dir(&folder) {
        Ok(entries) => entries,
        Err(error) if error.kind() == std::io::ErrorKind::NotFound && disk.root.is_dir() => return Ok(Vec::new()),
        Err(error) => return Err(disk.fail("list", &folder, error)),
    };
    let number = |name: &str| name.strip_suffix(".json")?.parse().ok();
    let mut numbers: Vec<u64> = entries.flatten().filter_map(|entry| number(entry.file_name().to_str()?)).collect();
    numbers.sort_unstable();
    Ok(numbers)
}

/// Records a campaign under the next free number, which is returned.
pub(super) fn record(disk: &Disk, campaign: &Campaign) -> Result<u64, StoreError> {
    let folder = folder(disk);
    disk.make_dir(&folder)?;
    let text = serde_json::to_string_pretty(campaign).unwrap_or_else(|error| panic!("BUG: a run record: {error}"));
    let mut number = numbers(disk)?.last().map_or(1, |last| last + 1);
    while !disk.write_new(&folder.join(format!("{number}.json")), text.as_bytes(), false)? {
        number += 1;
    }
    Ok(number)
}

/// The campaign with this number; nothing when there is none or its file is not readable.
pub(super) fn read(disk: &Disk, number: u64) -> Result<Option<Campaign>, StoreError> {
    let bytes = disk.read(&folder(disk).join(format!("{number}.json")))?;
    let campaign = bytes.and_then(|bytes| serde_json::from_slice::<Campaign>(&bytes).ok());
    Ok(campaign.map(|campaign| Campaign { number, ..campaign }))
}
