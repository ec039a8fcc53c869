//! Commands that read write nothing into a store of another owner or one that cannot be written, and make none. A store of the
//! user's own takes what they find, such as the answer of a calibration.

use super::space::{Space, told};
use std::collections::BTreeMap;
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

const CAMPAIGN: &str = include_str!("campaign.toml");

/// Commands that read, with the exit code on a complete campaign and on an empty store.
const READING: [(&[&str], i32, i32); 11] = [
    (&["plan", "w.toml"], 0, 0),
    (&["show", "w.toml"], 0, 0),
    (&["show", "w.toml", "table", "--csv"], 0, 2),
    (&["show", "w.toml", "effects", "--json"], 0, 2),
    (&["report", "w.toml", "-o", "page.html"], 0, 1),
    (&["graph", "w.toml", "--format", "svg"], 0, 0),
    (&["export", "w.toml"], 0, 1),
    (&["diff", "w.toml", "w.toml"], 0, 0),
    (&["diff", "w.toml", "#7"], 2, 2),
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

/// Gives the files of a folder to another user where the system allows that, or takes away the right to write into it.
fn take_away(folder: &Path) {
    let paths: Vec<PathBuf> = state(folder).into_keys().collect();
    if paths.iter().any(|path| std::os::unix::fs::chown(path, Some(65_534), None).is_err()) {
        allow(folder, 0o555);
    }
}

fn allow(folder: &Path, mode: u32) {
    std::fs::set_permissions(folder, std::fs::Permissions::from_mode(mode)).expect("changing permissions");
}

#[test]
fn a_store_of_another_owner_stays_as_it_is() {
    let space = Space::new();
    space.write("w.toml", CAMPAIGN);
    space.run(&[]);
    let store = space.path("store");
    take_away(&store);
    let before = state(&store);
    assert!(before.len() > 30, "{}", before.len());
    for (command, code, _) in READING {
        let output = space.flow(command);
        assert_eq!(output.status.code(), Some(code), "{command:?}: {}", told(&output));
        assert_eq!(state(&store), before, "{command:?}");
    }
    allow(&store, 0o755);
}

#[test]
fn a_store_of_the_users_own_takes_the_answer_of_a_calibration() {
    let space = Space::new();
    space.write("w.toml", CAMPAIGN);
    space.run(&[]);
    let calibrate = ["calibrate", "w.toml", "--target", "y=17 MPa"];
    let objects = || space.objects().len();
    let before = objects();
    let first = space.stdout(&calibrate);
    assert_eq!(objects(), before + 1);
    assert_eq!(space.stdout(&calibrate), first);
    assert_eq!(objects(), before + 1);
}

#[test]
fn a_run_that_no_store_has_is_refused_plainly() {
    let space = Space::new();
    space.write("w.toml", CAMPAIGN);
    let output = space.flow(&["diff", "w.toml", "#7"]);
    let said = told(&output);
    assert!(said.contains("error: there is no recorded run #7; the store `store` has none"), "{said}");
    assert_eq!(output.status.code(), Some(2));
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
