//! Disks that are full, read-only, forbidden or gone.

use crate::{found, open, put, result, text, timing};
use flow::artifact::Key;
use flow::store::{Store, StoreError};
use std::fs;
use std::path::Path;
use std::process::Command;

/// What a started process does: one large result into the store, and one lookup; it prints what it met.
#[test]
fn prober_process() {
    let Ok(root) = std::env::var("FLOW_TEST_PROBE") else { return };
    let store = match Store::open(Path::new(&root)) {
        Ok(store) => store,
        Err(error) => return println!("PROBE open: {error}"),
    };
    println!("PROBE found: {}", store.find(&Key::of(&text(1))).unwrap().is_some());
    println!(
        "PROBE got: {:?}",
        store.get(&result(1).content_hash()).map(|artifact| artifact.content_hash() == result(1).content_hash())
    );
    for number in [1999, 1998, 1997] {
        match store.put(&text(number), result(number), &timing()) {
            Ok(_) => println!("PROBE stored"),
            Err(error) => println!("PROBE {error}"),
        }
    }
    match store.claim(&Key::of(&text(1999))) {
        Ok(_) => println!("PROBE claimed"),
        Err(error) => println!("PROBE claim: {error}"),
    }
}

/// Runs the prober on a store through a shell line in which `"$0" "$@"` starts it.
fn probe(shell: &str, root: &Path) -> String {
    let output = Command::new("sh")
        .args(["-c", shell])
        .arg(std::env::current_exe().unwrap())
        .args(["--exact", "disk::prober_process", "--nocapture", "--test-threads=1"])
        .env("FLOW_TEST_PROBE", root)
        .output()
        .unwrap();
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(output.status.success(), "{text}{}", String::from_utf8_lossy(&output.stderr));
    text
}

/// No leftover under a temporary name, and everything that has a name is sound.
fn assert_sound(root: &Path) {
    let verdict = open(root).verify().unwrap();
    assert!(verdict.damages.is_empty() && verdict.missing.is_empty() && verdict.lost_records == 0, "{verdict:?}");
    assert_eq!(open(root).usage().unwrap().temporary.files, 0);
}

#[test]
fn a_file_that_may_not_grow_is_an_error_and_leaves_nothing_behind() {
    let folder = tempfile::tempdir().unwrap();
    put(&open(folder.path()), 1);
    // A limit of 4 kB per file stands for a disk that fills up in the middle of a file.
    let said = probe("trap '' XFSZ; ulimit -f 8; exec \"$0\" \"$@\"", folder.path());
    assert!(said.contains("PROBE found: true") && said.contains("PROBE got: Ok(true)"), "{said}");
    assert!(said.contains("the limit on the size of files") && said.contains("ulimit -f"), "{said}");
    assert_sound(folder.path());
}

/// Whether file systems can be mounted here (as root, outside of most containers).
fn mounted(line: &str) -> bool {
    Command::new("sh").args(["-c", line]).output().is_ok_and(|output| output.status.success())
}

#[test]
fn a_full_disk_is_an_error_and_the_next_run_goes_on() {
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path().display();
    if !mounted(&format!("mount -t tmpfs -o size=256k tmpfs {root}")) {
        return eprintln!("no mounts here: only the limit on a file's size was tried");
    }
    let outcome = std::panic::catch_unwind(|| {
        let store = open(folder.path());
        let mut stored = Vec::new();
        let error = loop {
            let number = stored.len() as u64;
            match store.put(&text(number), result(number), &timing()) {
                Ok((record, _)) => stored.push(record),
                Err(error) => break error,
            }
            assert!(stored.len() < 1000, "the disk never filled up");
        };
        assert!(matches!(error, StoreError::Full { .. }), "{error}");
        drop(store);
        assert_sound(folder.path());
        let store = open(folder.path());
        for (number, record) in stored.iter().enumerate() {
            assert_eq!(found(&store, number as u64).as_ref(), Some(record));
        }
        // Room is made, and the very same store takes results again.
        assert!(mounted(&format!("mount -o remount,size=64m {root}")));
        put(&store, stored.len() as u64);
        assert_sound(folder.path());
    });
    assert!(mounted(&format!("umount -l {root}")));
    outcome.unwrap();
}

#[test]
fn a_read_only_disk_can_be_read() {
    let folder = tempfile::tempdir().unwrap();
    put(&open(folder.path()), 1);
    let root = folder.path().display();
    if !mounted(&format!("mount --bind {root} {root} && mount -o remount,ro,bind {root}")) {
        return eprintln!("no mounts here: not tried");
    }
    let said = std::panic::catch_unwind(|| probe("exec \"$0\" \"$@\"", folder.path()));
    assert!(mounted(&format!("umount -l {root}")));
    let said = said.unwrap();
    assert!(said.contains("PROBE found: true") && said.contains("PROBE got: Ok(true)"), "{said}");
    assert!(said.contains("PROBE the store is read-only") && said.contains("--store"), "{said}");
    assert!(said.contains("PROBE claim: the store is read-only"), "{said}");
}

#[test]
fn a_damaged_object_on_a_read_only_disk_is_still_noticed() {
    let folder = tempfile::tempdir().unwrap();
    let store = open(folder.path());
    let path = store.path(&put(&store, 1).object());
    fs::remove_file(&path).unwrap();
    fs::write(&path, b"rubbish").unwrap();
    drop(store);
    let root = folder.path().display();
    if !mounted(&format!("mount --bind {root} {root} && mount -o remount,ro,bind {root}")) {
        return eprintln!("no mounts here: not tried");
    }
    let said = std::panic::catch_unwind(|| probe("exec \"$0\" \"$@\"", folder.path()));
    assert!(mounted(&format!("umount -l {root}")));
    let said = said.unwrap();
    assert!(said.contains("aside: Stays") && said.contains("instead of"), "{said}");
}

#[cfg(unix)]
#[test]
fn a_forbidden_folder_is_an_error_that_says_so() {
    use std::os::unix::fs::PermissionsExt;
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path().join("store");
    put(&open(&root), 1);
    // Root may do everything, so the prober is somebody else; its program has to be where that somebody can read it.
    let program = folder.path().join("prober");
    fs::copy(std::env::current_exe().unwrap(), &program).unwrap();
    fs::set_permissions(folder.path(), PermissionsExt::from_mode(0o755)).unwrap();
    let lock = |mode| {
        Command::new("chmod").args(["-R", mode]).arg(&root).status().unwrap();
    };
    lock("a-w,a+rX");
    let is_root = fs::write(root.join("probe"), b"").is_ok();
    let mut command = Command::new(&program);
    command.args(["--exact", "disk::prober_process", "--nocapture", "--test-threads=1"]).env("FLOW_TEST_PROBE", &root);
    if is_root {
        use std::os::unix::process::CommandExt;
        command.uid(65_534).current_dir("/");
    }
    let output = command.output();
    lock("u+w");
    let said = String::from_utf8_lossy(&output.unwrap().stdout).into_owned();
    assert!(said.contains("PROBE found: true") && said.contains("PROBE got: Ok(true)"), "{said}");
    assert!(said.contains("PROBE no permission to") && said.contains(&root.display().to_string()), "{said}");
}

#[test]
fn a_store_that_vanishes_is_not_made_anew() {
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path().join("store");
    let store = open(&root);
    put(&store, 1);
    fs::rename(&root, folder.path().join("elsewhere")).unwrap();
    let vanished = |error: StoreError| assert!(matches!(error, StoreError::Vanished { .. }), "{error}");
    vanished(store.put(&text(2), result(2), &timing()).unwrap_err());
    vanished(store.claim(&Key::of(&text(3))).unwrap_err());
    vanished(Store::verify(&store).unwrap_err());
    assert!(!root.exists());
    fs::rename(folder.path().join("elsewhere"), &root).unwrap();
    put(&store, 2);
    assert!(found(&open(&root), 1).is_some() && found(&open(&root), 2).is_some());
}

#[test]
fn a_path_that_is_no_folder_is_an_error() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("file");
    fs::write(&file, b"").unwrap();
    for path in [file.clone(), file.join("below")] {
        let error = Store::open(&path).err().expect("no store").to_string();
        assert!(error.contains("is not a store") && error.contains("--store"), "{error}");
    }
}
