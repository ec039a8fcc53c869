//! Commands that read write nothing into a store: neither into one that is there, nor in place of one that is not.

use super::space::{Space, told};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

const CAMPAIGN: &str = include_str!("campaign.toml");

/// Commands that read, with the exit code on a complete campaign and on an empty store.
const READING: [(&[&str], i32, i32); 10] = [
    (&["plan", "w.toml"], 0, 0),
    (&["show", "w.toml"], 0, 0),
    (&["show", "w.toml", "table", "--csv"], 0, 2),
    (&["show", "w.toml", "effects", "--json"], 0, 2),
    (&["report", "w.toml", "-o", "page.html"], 0, 1),
    (&["graph", "w.toml", "--format", "svg"], 0, 0),
    (&["export", "w.toml"], 0, 1),
    (&["diff", "w.toml", "w.toml"], 0, 0),
    (&["calibrate", "w.toml", "--target", "y=17 MPa"], 0, 2),
    (&["calibrate", "w.toml", "--page", "calibrator.html"], 0, 2),
];

/// Names, sizes and times of change of all that lies in a folder.
fn state(folder: &Path) -> BTreeMap<PathBuf, (u64, SystemTime)> {
    let mut found = BTreeMap::new();
    let mut open = vec![folder.to_owned()];
    while let Some(path) = open.pop() {
        let data = std::fs::symlink_metadata(&path).expect("a file of the store");
        found.insert(path.clone(), (data.len(), data.modified().expect("a time")));
        if data.is_dir() {
            open.extend(std::fs::read_dir(&path).expect("a folder").map(|entry| entry.expect("an entry").path()));
        }
    }
    found
}

#[test]
fn what_is_there_stays_as_it_is() {
    let space = Space::new();
    space.write("w.toml", CAMPAIGN);
    space.run(&[]);
    let before = state(&space.path("store"));
    assert!(before.len() > 30, "{}", before.len());
    for (command, code, _) in READING {
        let output = space.flow(command);
        assert_eq!(output.status.code(), Some(code), "{command:?}: {}", told(&output));
        assert_eq!(state(&space.path("store")), before, "{command:?}");
    }
    // A command that writes shows that the state would tell.
    space.run(&["--set", "stage.anova.alpha=0.01"]);
    assert_ne!(state(&space.path("store")), before);
}

#[test]
fn no_store_is_made_to_be_read() {
    let space = Space::new();
    space.write("w.toml", CAMPAIGN);
    for (command, _, code) in READING {
        let output = space.flow(command);
        assert_eq!(output.status.code(), Some(code), "{command:?}: {}", told(&output));
        assert!(!space.path("store").exists(), "{command:?}");
    }
}
