//! What goes wrong on a cluster besides workers that die: no scheduler, a full disk, wrong clocks.

use super::{Cluster, told};
use std::process::Command;

#[test]
fn a_machine_without_the_scheduler_is_told_at_once_what_is_missing() {
    let cluster = Cluster::new(3, "", "workers = 2");
    let run = |more: &[&str], path: &str| {
        let mut command = cluster.command(more);
        command.env("PATH", path).output().expect("running flow")
    };
    let nothing = cluster.0.path("").join("nothing").display().to_string();
    let output = run(&[], &nothing);
    let said = told(&output);
    assert_eq!(output.status.code(), Some(2), "{said}");
    assert!(said.contains("needs `sbatch`, `squeue`, `scancel`, which this machine has not"), "{said}");
    assert!(said.contains("run it on a login node"), "{said}");
    assert!(!cluster.0.path("store").exists(), "before anything was run");
    // Without a submission nothing is needed.
    assert!(run(&["--dry-run"], &nothing).status.success());
    let bin = cluster.0.path("bin").display().to_string();
    std::fs::remove_file(cluster.0.path("bin/scancel")).unwrap();
    assert!(told(&run(&[], &bin)).contains("needs `scancel`, which"));
}

#[test]
fn a_campaign_that_sends_nothing_says_so() {
    let cluster = Cluster::new(2, "", "workers = 2\n[stage.rows]\nhere = true");
    let output = cluster.run(&[]);
    let said = told(&output);
    assert!(output.status.success() && cluster.calls("sbatch") == 0, "{said}");
    assert!(said.contains("no workers were asked for"), "{said}");
}

/// Whether a command line succeeds; mounting needs root, outside of most containers.
fn works(line: &str) -> bool {
    Command::new("sh").args(["-c", line]).output().is_ok_and(|output| output.status.success())
}

#[test]
fn a_full_shared_disk_ends_the_run_with_a_word_and_the_same_command_goes_on() {
    let cluster = Cluster::new(30, "head -c 30000 /dev/urandom | od -An -tx1 >more", "workers = 2");
    let root = cluster.0.path("store").display().to_string();
    std::fs::create_dir(&root).unwrap();
    if !works(&format!("mount -t tmpfs -o size=200k tmpfs {root}")) {
        return eprintln!("no mounts here: not tried");
    }
    let outcome = std::panic::catch_unwind(|| {
        let output = cluster.run(&[]);
        let said = told(&output);
        assert!(!output.status.success(), "{said}");
        assert!(said.contains("the disk is full") && said.contains("flow store gc"), "{said}");
        assert!(works(&format!("mount -o remount,size=64m {root}")));
        let output = cluster.run(&[]);
        assert!(output.status.success(), "{}", told(&output));
        let mut computed = cluster.computed();
        computed.dedup();
        assert_eq!(computed, (1..=30).collect::<Vec<_>>());
    });
    assert!(works(&format!("umount -l {root}")));
    outcome.unwrap();
}

#[test]
fn clocks_of_nodes_that_differ_by_hours_change_nothing() {
    let library = "/usr/lib/x86_64-linux-gnu/faketime/libfaketime.so.1";
    if !std::path::Path::new(library).is_file() {
        assert!(std::env::var("FLOW_TEST_READERS").is_err(), "faketime is not installed: .ci/install");
        return;
    }
    // Each worker has its own clock: the first is three hours late, the second three hours early.
    let site = format!(
        "workers = 2\ntime = \"10 min\"\nsetup = [\"export LD_PRELOAD={library} DONT_FAKE_MONOTONIC=1\", \
         \"if [ $SLURM_ARRAY_TASK_ID = 0 ]; then export FAKETIME=-3h; else export FAKETIME=+3h; fi\"]"
    );
    let cluster = Cluster::new(12, "sleep 0.2", &site);
    let output = cluster.run(&[]);
    assert!(output.status.success(), "{}", told(&output));
    assert_eq!(cluster.computed(), (1..=12).collect::<Vec<_>>());
    let again = cluster.run(&[]);
    assert!(again.status.success() && cluster.computed().len() == 12, "{}", told(&again));
}

#[test]
fn what_another_campaign_finishes_meanwhile_is_not_computed_again() {
    let cluster = Cluster::new(2, "echo $a >>begun; while [ ! -e DIR/go ]; do sleep 0.02; done", "workers = 2");
    let lines = std::fs::read_to_string(cluster.0.path("task.sh")).unwrap();
    let root = cluster.0.path("").display().to_string();
    cluster.0.write("task.sh", &lines.replace("DIR", &root).replace("begun", &format!("{root}/begun")));
    let mut here = cluster.0.command(&["run", "w.toml", "--jobs", "2", "--quiet"]).spawn().unwrap();
    let begun = || std::fs::read_to_string(cluster.0.path("begun")).is_ok_and(|text| text.lines().count() == 2);
    cluster.until("the other campaign has begun both tasks", begun);
    let far = cluster.start();
    // Each worker finds that somebody else computes its task.
    let elsewhere = || {
        let reports = super::queue(&cluster.0).and_then(|queue| std::fs::read_dir(queue).ok());
        let texts = reports.into_iter().flatten().filter_map(|entry| std::fs::read_to_string(entry.ok()?.path()).ok());
        texts.map(|text| text.matches("\"elsewhere\"").count()).sum::<usize>() == 2
    };
    cluster.until("the workers have looked", elsewhere);
    // The submitter reads reports twice a second at least.
    std::thread::sleep(std::time::Duration::from_millis(1500));
    cluster.0.write("go", "");
    assert!(here.wait().unwrap().success());
    let output = far.wait_with_output().unwrap();
    let said = told(&output);
    assert!(output.status.success(), "{said}");
    assert_eq!(cluster.computed(), [1, 2], "{said}");
    assert_eq!(cluster.calls("sbatch"), 1, "{said}");
}
