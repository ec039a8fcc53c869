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

/// A surrogate over 1,500 runs takes minutes, and looks at nothing meanwhile.
#[test]
fn a_fit_that_takes_minutes_ends_when_it_is_told() {
    let space = Space::new();
    space.write(
        "w.toml",
        "[workflow]\nseed = 1\n[factor]\na = { sets = 'm.a', range = [1, 3] }\nb = { sets = 'm.b', range = [10, 30] }\n\
         [response]\ny = { unit = 'MPa' }\n[material.base]\nm = { a = 1, b = 10 }\n[stage.lhs]\nkind = 'design'\n\
         method = 'latin-hypercube'\nruns = 1500\nfactors = ['a', 'b']\n[stage.sim]\nkind = 'formula'\ndesign = 'lhs'\n\
         material = 'base'\nresponses.y = { value = '3*a + b*b/100', unit = 'MPa', scatter = 0.01 }\n[stage.found]\n\
         kind = 'calibrate'\nsimulator = 'sim'\nmethod = 'surrogate'\nlearn_from = ['sim']\nfactors = ['a', 'b']\n\
         evaluations = 200\ntargets = [{ y = '9 MPa' }]\n",
    );
    space.run(&["sim"]);
    let mut run = space.start(&["run", "w.toml", "--jobs", "1"]);
    std::thread::sleep(Duration::from_secs(3));
    assert!(run.try_wait().expect("a child").is_none(), "the run ended before the interrupt");
    kill_process(Pid::from_child(&run), Signal::INT).expect("sending a signal");
    let ended = (0..3000).any(|_| {
        std::thread::sleep(Duration::from_millis(10));
        run.try_wait().expect("a child").is_some()
    });
    let _ = run.kill();
    let output = run.wait_with_output().expect("the end of the run");
    assert!(ended && output.status.code() == Some(130), "{}", told(&output));
}
