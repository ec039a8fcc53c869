//! One store on several nodes, emulated by two mounts of one folder (bindfs): locks that reach both, locks of each node
//! alone, and a node that sees what the other did ten seconds late. Passed over with a word where nothing can be mounted.

use crate::space::{Space, told};
use std::path::{Path, PathBuf};
use std::process::{Child, Command};

const TASKS: usize = 12;

/// Tasks of 0.4 s that leave a line outside of the store when they are computed.
fn workflow(log: &Path) -> String {
    let levels: Vec<String> = (1..=TASKS).map(|level| level.to_string()).collect();
    format!(
        r#"
[workflow]
seed = 1
[factor]
a = {{ sets = "m.a", levels = [{}] }}
[response]
y = {{}}
[material.base]
m = {{ a = 1 }}
[stage.grid]
kind = "design"
method = "full-factorial"
factors = ["a"]
[stage.rows]
kind = "command"
design = "grid"
material = "base"
run = ["sh", "-c", "sleep 0.4; cat in >> {}; echo v=$(cat in)"]
templates = {{ "in" = "in.txt" }}
read.y = {{ file = "stdout", pattern = 'v=(\d+)' }}
"#,
        levels.join(", "),
        log.display()
    )
}

/// A mount that is taken off when the test ends, however it ends.
struct Mount(PathBuf);

impl Drop for Mount {
    fn drop(&mut self) {
        let _ = Command::new("umount").arg("-l").arg(&self.0).status();
    }
}

/// Mounts a folder once more; none where that is not possible.
fn mount(folder: &Path, at: &Path, options: &[&str]) -> Option<Mount> {
    std::fs::create_dir_all(at).expect("a folder");
    let mounted = Command::new("bindfs").args(options).arg(folder).arg(at).output();
    match mounted {
        Ok(output) if output.status.success() => Some(Mount(at.to_owned())),
        other => {
            eprintln!("passed over: bindfs cannot mount here ({other:?})");
            None
        }
    }
}

/// Two runs on two nodes, started together; how often tasks were computed.
fn computed(options: &[&str]) -> Option<usize> {
    let space = Space::new();
    let shared = space.path("shared");
    std::fs::create_dir_all(&shared).expect("a folder");
    // A store that is there already, as on a cluster: the nodes differ in when they see what is new.
    space.write("in.txt", "{{a}}\n");
    let log = space.path("log");
    space.write("w.toml", &workflow(&log));
    let mounts: Vec<Mount> =
        ["node1", "node2"].iter().map(|node| mount(&shared, &space.path(node), options)).collect::<Option<_>>()?;
    let start = |mount: &Mount| -> Child {
        let store = mount.0.join("store").display().to_string();
        space.start(&["run", "w.toml", "--quiet", "--json", "--jobs", "2", "--store", &store])
    };
    let runs: Vec<Child> = mounts.iter().map(start).collect();
    let mut objects = Vec::new();
    for run in runs {
        let output = run.wait_with_output().expect("the end of a run");
        assert!(output.status.success(), "{options:?}: {}", told(&output));
        objects.push(crate::space::Ran::read(&output).objects);
    }
    assert_eq!(objects[0], objects[1], "{options:?}");
    drop(mounts);
    let store = shared.join("store").display().to_string();
    let said = space.stdout(&["store", "verify", "--store", &store]);
    assert!(said.contains(&format!("{} results are sound", TASKS + 2)), "{options:?}: {said}");
    Some(std::fs::read_to_string(log).expect("a log").lines().count())
}

#[test]
fn nodes_with_common_locks_compute_each_task_once() {
    if let Some(computed) = computed(&["--enable-lock-forwarding", "--multithreaded"]) {
        assert_eq!(computed, TASKS);
    }
}

#[test]
fn nodes_with_locks_of_their_own_do_not_fail_and_repeat_only_what_is_in_flight() {
    if let Some(computed) = computed(&["-o", "attr_timeout=0,entry_timeout=0"]) {
        assert!((TASKS..=TASKS + 4).contains(&computed), "{computed} of {TASKS}");
    }
}

#[test]
fn nodes_that_see_late_do_not_fail() {
    let late = "attr_timeout=10,entry_timeout=10,negative_timeout=10";
    if let Some(computed) = computed(&["--enable-lock-forwarding", "--multithreaded", "-o", late]) {
        assert!((TASKS..=2 * TASKS).contains(&computed), "{computed} of {TASKS}");
    }
}
