//! Ctrl-C, a request to end and the end of the terminal: finished tasks stay stored, and a second run continues.

use crate::space::{Space, told};
use rustix::process::{Pid, Signal, kill_process};
use std::process::{Child, Command, Stdio};
use std::time::Duration;

/// A quick stage, and one that waits until a file `go` is there.
fn space() -> Space {
    let space = Space::new();
    let [begun, go] = ["begun", "go"].map(|name| space.path(name).display().to_string());
    let waits = format!("touch '{begun}'; while [ ! -e '{go}' ]; do sleep 0.02; done; echo 2");
    let stage = |name: &str, script: &str| {
        format!(
            "[stage.{name}]\nkind = \"command\"\nrun = [\"sh\", \"-c\", \"{script}\"]\nread.y = {{ file = \"stdout\", pattern = '(\\d+)' }}\n"
        )
    };
    space.write("w.toml", &format!("[workflow]\nseed = 1\n{}{}", stage("quick", "echo 1"), stage("slow", &waits)));
    space
}

/// Waits until the slow stage has begun, then sends the signal.
fn interrupt(space: &Space, run: &Child, signal: Signal) {
    while !space.path("begun").exists() {
        std::thread::sleep(Duration::from_millis(10));
    }
    kill_process(Pid::from_child(run), signal).expect("sending a signal");
}

#[test]
fn a_run_that_is_told_to_end_keeps_what_is_finished() {
    let mut signals = vec![Signal::INT, Signal::TERM];
    // Where these tests themselves run under `nohup`, so does what they start.
    signals.extend((!hangup_is_ignored()).then_some(Signal::HUP));
    for signal in signals {
        let space = space();
        let run = space.start(&["run", "w.toml", "--jobs", "1"]);
        interrupt(&space, &run, signal);
        let output = run.wait_with_output().expect("the end of the run");
        assert_eq!(output.status.code(), Some(130), "{signal:?}: {}", told(&output));
        assert!(told(&output).contains("interrupted; run again to continue"), "{}", told(&output));
        space.write("go", "");
        space.run(&[]).expect(&[("slow", 1)]);
    }
}

fn hangup_is_ignored() -> bool {
    let status = std::fs::read_to_string("/proc/self/status").unwrap();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:")).unwrap();
    u64::from_str_radix(mask.trim(), 16).unwrap() & 1 == 1
}

/// As `nohup` starts it.
#[test]
fn where_the_end_of_the_terminal_is_ignored_it_ends_nothing() {
    let space = space();
    let script = "trap '' HUP; exec \"$0\" run w.toml --jobs 1";
    let mut run = Command::new("sh");
    run.args(["-c", script, env!("CARGO_BIN_EXE_flow")]).current_dir(space.path(""));
    let run = run.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("starting flow");
    interrupt(&space, &run, Signal::HUP);
    std::thread::sleep(Duration::from_millis(100));
    space.write("go", "");
    let output = run.wait_with_output().expect("the end of the run");
    assert!(output.status.success(), "{}", told(&output));
    space.run(&[]).expect(&[]);
}
