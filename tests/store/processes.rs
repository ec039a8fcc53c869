//! Many processes on one store, killed and not. The processes are this test binary, started again.

use crate::{objects, open, run};
use std::collections::HashMap;
use std::fs::OpenOptions;
use std::io::Write;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::Duration;

const TASKS: u64 = 120;

/// What a started process does: tasks `0..TASKS`, with a line in a log for each one it computes.
#[test]
fn worker_process() {
    let Ok(root) = std::env::var("FLOW_TEST_STORE") else { return };
    let mut log = OpenOptions::new().append(true).create(true).open(std::env::var("FLOW_TEST_LOG").unwrap()).unwrap();
    let log = std::cell::RefCell::new(&mut log);
    run(&open(Path::new(&root)), TASKS, |number| log.borrow_mut().write_all(format!("{number}\n").as_bytes()).unwrap());
}

fn start(root: &Path, log: &Path) -> Child {
    Command::new(std::env::current_exe().unwrap())
        .args(["--exact", "processes::worker_process", "--test-threads=1"])
        .env("FLOW_TEST_STORE", root)
        .env("FLOW_TEST_LOG", log)
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap()
}

/// How often each task was computed.
fn computed(log: &Path) -> HashMap<u64, usize> {
    let mut counts = HashMap::new();
    for line in std::fs::read_to_string(log).unwrap_or_default().lines() {
        *counts.entry(line.parse().unwrap()).or_default() += 1;
    }
    counts
}

fn undisturbed() -> Vec<(std::path::PathBuf, Vec<u8>)> {
    let folder = tempfile::tempdir().unwrap();
    // In another order than the workers, so that the order cannot matter.
    let store = open(folder.path());
    (0..TASKS).rev().for_each(|number| drop(crate::put(&store, number)));
    objects(folder.path())
}

#[test]
fn eight_processes_compute_each_task_once() {
    for count in [2, 8] {
        let folder = tempfile::tempdir().unwrap();
        let (root, log) = (folder.path().join("store"), folder.path().join("log"));
        std::fs::create_dir(&root).unwrap();
        let workers: Vec<Child> = (0..count).map(|_| start(&root, &log)).collect();
        for mut worker in workers {
            assert!(worker.wait().unwrap().success());
        }
        let computed = computed(&log);
        assert_eq!(computed.len(), TASKS as usize);
        assert!(computed.values().all(|&times| times == 1), "{computed:?}");
        assert_eq!(objects(&root), undisturbed());
    }
}

#[test]
fn a_store_survives_two_hundred_kills() {
    let folder = tempfile::tempdir().unwrap();
    let expected = undisturbed();
    // The moments come from a fixed sequence, and from the machine: each run of this test tries others.
    let mut moment: u64 = 0x9e37_79b9_7f4a_7c15;
    let mut kills = 0;
    for number in 0.. {
        let (root, log) = (folder.path().join(format!("store{number}")), folder.path().join(format!("log{number}")));
        std::fs::create_dir(&root).unwrap();
        let before = kills;
        while kills < 200 {
            moment = moment.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            if !killed_while_working(&root, &log, Duration::from_micros((moment >> 33) % 1_500)) {
                break;
            }
            kills += 1;
            // Nothing that is found is wrong, at any moment.
            let store = open(&root);
            for record in store.records().unwrap() {
                store.get(&record.content).unwrap();
            }
        }
        assert!(start(&root, &log).wait().unwrap().success());
        let repeated: usize = computed(&log).values().map(|times| times - 1).sum();
        assert!(repeated <= kills - before, "{repeated} tasks were repeated after {} kills", kills - before);
        assert_whole(&root, &expected);
        if kills == 200 {
            break;
        }
    }
}

/// Starts a process and kills it `after` its first task; false when it had ended by then.
fn killed_while_working(root: &Path, log: &Path, after: Duration) -> bool {
    let mut worker = start(root, log);
    let length = || std::fs::metadata(log).map_or(0, |data| data.len());
    let before = length();
    while length() == before && worker.try_wait().unwrap().is_none() {
        std::thread::sleep(Duration::from_micros(100));
    }
    std::thread::sleep(after);
    if let Some(status) = worker.try_wait().unwrap() {
        assert!(status.success());
        return false;
    }
    worker.kill().unwrap();
    worker.wait().unwrap();
    true
}

/// The store holds the files of an undisturbed run, all of them sound.
fn assert_whole(root: &Path, expected: &[(std::path::PathBuf, Vec<u8>)]) {
    let mut files = objects(root);
    files.retain(|(name, _)| !name.to_string_lossy().starts_with(".writing-"));
    assert!(files == expected, "other files than those of an undisturbed run");
    let verdict = open(root).verify().unwrap();
    assert_eq!(verdict.sound.files, TASKS);
    assert!(verdict.damages.is_empty() && verdict.missing.is_empty() && verdict.contradictions.is_empty());
    assert!(verdict.adopted.is_empty());
}
