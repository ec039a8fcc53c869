//! Records of campaigns: what ran, when, on which machine and by which version, for `flow diff` and for a person who reads
//! the file.
//!
//! Each campaign leaves one JSON file `runs/N.json`, numbered in the order in which they ended, with the user's mark in it.

use super::disk::Disk;
use super::folder::{Folder, Strange};
use super::mark::{self, Mark};
use super::{Origin, StoreError};
use serde::{Deserialize, Serialize};

/// Folder of the records.
pub(super) const FOLDER: &str = "runs";
/// The largest record of a campaign, bytes.
const MOST: u64 = 1 << 28;

/// One run of a workflow.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Campaign {
    /// Number in this store, from 1; assigned when the campaign is recorded.
    #[serde(skip)]
    pub number: u64,
    /// The path of the workflow file, as the user typed it.
    pub workflow: String,
    /// The profile, `""` for none.
    pub profile: String,
    /// Overrides by path, as they were typed.
    pub set: Vec<String>,
    /// Start, milliseconds since 1970 UTC.
    pub started: i64,
    /// Duration, seconds.
    pub seconds: f64,
    /// Machine, version and commit.
    pub origin: Origin,
    /// Its stages in the order of the workflow.
    pub stages: Vec<StageRun>,
    /// The mark of the user who recorded it, taken over all other fields.
    #[serde(default)]
    pub mark: String,
    /// Whether this user recorded it and nothing was changed since.
    #[serde(skip)]
    pub own: bool,
}

/// The outcome of a stage in one run.
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

/// Numbers of the recorded campaigns, in order.
pub(super) fn numbers(disk: &Disk) -> Result<Vec<u64>, StoreError> {
    let Some(folder) = disk.find_folder(FOLDER)? else { return Ok(Vec::new()) };
    let mut numbers: Vec<u64> = Vec::new();
    let listed = folder.list(|name, _| numbers.extend(number(name)));
    listed.map_err(|error| disk.fail("list", &disk.root.join(FOLDER), error))?;
    numbers.sort_unstable();
    Ok(numbers)
}

fn number(name: &str) -> Option<u64> {
    name.strip_suffix(".json")?.parse().ok()
}

/// Whether a file among the records is one that flow wrote.
pub(super) fn is_ours(folder: &Folder, name: &str) -> bool {
    number(name).is_some() && folder.begins_with(name, b"{\n  \"workflow\": ")
}

/// Records a campaign under the next free number, which is returned.
pub(super) fn record(disk: &Disk, mark: &Mark, campaign: &Campaign) -> Result<u64, StoreError> {
    let bare = Campaign { mark: String::new(), ..campaign.clone() };
    let text = serde_json::to_string_pretty(&bare).unwrap_or_else(|error| panic!("BUG: a run record: {error}"));
    let mut number = numbers(disk)?.last().map_or(1, |last| last.saturating_add(1));
    loop {
        let marked = with_mark(&text, "", &marked(mark, number, &text));
        if disk.write_new(FOLDER, &format!("{number}.json"), marked.as_bytes(), false)? {
            return Ok(number);
        }
        number += 1;
    }
}

/// The mark over the text of a campaign without one, and its number.
fn marked(mark: &Mark, number: u64, text: &str) -> String {
    mark.note(&number.to_le_bytes(), text.as_bytes()).iter().map(|byte| format!("{byte:02x}")).collect()
}

/// The text with another mark. Numbers do not come back to the last digit from every reader, so the text itself is marked.
fn with_mark(text: &str, old: &str, new: &str) -> String {
    let field = |mark: &str| format!("\n  \"mark\": \"{mark}\"\n}}");
    text.strip_suffix(&field(old)).map_or_else(String::new, |body| body.to_owned() + &field(new))
}

/// The campaign with this number; `None` when there is none or its file cannot be read.
pub(super) fn read(disk: &Disk, mark: &Mark, number: u64) -> Result<Option<Campaign>, StoreError> {
    let name = format!("{number}.json");
    let bytes = match disk.folder(FOLDER).and_then(|folder| folder.read(&name, MOST)) {
        Ok(bytes) => bytes,
        Err(error) if Strange::is(&error) => return Ok(None),
        Err(error) if disk.lacks(&error) => return Ok(None),
        Err(error) => return Err(disk.fail("read", &disk.path(FOLDER, &name), error)),
    };
    let Ok(campaign) = serde_json::from_slice::<Campaign>(&bytes) else { return Ok(None) };
    let text = String::from_utf8_lossy(&bytes);
    let marked = marked(mark, number, &with_mark(&text, &campaign.mark, ""));
    let own = mark::same(campaign.mark.as_bytes(), marked.as_bytes());
    Ok(Some(Campaign { number, own, ..campaign }))
}
