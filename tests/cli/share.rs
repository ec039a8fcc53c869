//! A campaign that one group pushes and another one pulls.

use crate::space::{Space, told};
use std::process::Command;

const WORKFLOW: &str = r#"
[workflow]
seed = 1
[factor]
a = { sets = "m.a", levels = [1, 2, 3] }
[response]
y = {}
[material.base]
m = { a = 1 }
[stage.grid]
kind = "design"
method = "full-factorial"
factors = ["a"]
[stage.rows]
kind = "command"
design = "grid"
material = "base"
run = ["sh", "-c", "echo x >>LOG; echo v=$(cat in)$(cat OUTSIDE)"]
templates = { "in" = "in.txt" }
read.y = { file = "stdout", pattern = 'v=(\d+)' }
"#;

#[test]
fn a_pulled_campaign_is_read_without_a_run_and_audited() {
    let space = Space::new();
    let path = |name: &str| space.path(name).display().to_string();
    space.write("in.txt", "{{a}}\n");
    space.write("outside", "0");
    space.write("w.toml", &WORKFLOW.replace("LOG", &path("log")).replace("OUTSIDE", &path("outside")));
    let made = Command::new("ssh-keygen").args(["-q", "-t", "ed25519", "-N", "", "-f", &path("key")]).status();
    assert!(made.expect("OpenSSH").success());
    let public = std::fs::read_to_string(space.path("key.pub")).unwrap();
    space.run(&["--store", "ours"]);
    let pushed = space.stdout(&["store", "push", "remote", "--sign", "key", "--store", "ours"]);
    assert!(pushed.contains("5 results pushed, 0 were there"), "{pushed}");
    // Nobody is trusted unasked.
    let refused = space.flow(&["store", "pull", "remote", "--store", "theirs"]);
    assert_eq!(refused.status.code(), Some(2), "{}", told(&refused));
    assert!(told(&refused).contains("there is no file allowed_signers"), "{}", told(&refused));
    // What no program could look at is no matter of who signed it.
    space.write("allowed_signers", "");
    let blind = space.command(&["store", "pull", "remote", "--store", "theirs"]).env("PATH", "/nowhere").output();
    let blind = told(&blind.expect("running flow"));
    assert!(blind.contains("`ssh-keygen` of OpenSSH cannot be run"), "{blind}");
    space.write("allowed_signers", &format!("ann@lab namespaces=\"flow-store\" {public}"));
    let pulled = space.stdout(&["store", "pull", "remote", "--store", "theirs"]);
    assert!(pulled.contains("5 results pulled, 0 were here, 0 refused\n  5 signed by ann@lab"), "{pulled}");
    let runs = || std::fs::read_to_string(space.path("log")).unwrap().lines().count();
    assert_eq!(runs(), 3);
    space.run(&["--store", "theirs"]).expect(&[]);
    assert!(space.stdout(&["show", "w.toml", "rows[2]", "--store", "theirs"]).contains("20"));
    space.stdout(&["report", "w.toml", "--store", "theirs"]);
    assert_eq!(runs(), 3, "nothing of it was computed");
    let audited = space.stdout(&["store", "audit", "w.toml", "--sample", "2", "--store", "theirs"]);
    assert_eq!(audited.matches("computed again, equal to the last bit").count(), 2, "{audited}");
    assert_eq!(runs(), 5);
    // What a task gives has changed: the audit finds it.
    space.write("outside", "7");
    let audit = space.flow(&["store", "audit", "w.toml", "--store", "theirs"]);
    assert_eq!(audit.status.code(), Some(1));
    assert!(told(&audit).contains("rows[1]: computed again, and DIFFERENT"), "{}", told(&audit));
}

#[test]
fn other_targets_are_answered_from_a_pulled_campaign_as_from_the_own_one() {
    let space = Space::new();
    space.write("w.toml", include_str!("campaign.toml"));
    space.run(&["surfaces", "--store", "ours"]);
    space.stdout(&["store", "push", "remote", "--unsigned", "--store", "ours"]);
    space.stdout(&["store", "pull", "remote", "--unsigned", "--store", "theirs"]);
    let planned = space.stdout(&["plan", "w.toml", "surfaces", "--json", "--store", "theirs"]);
    let planned: serde_json::Value = serde_json::from_str(&planned).expect("a JSON document");
    let stages = planned["stages"].as_array().expect("a list");
    assert!(!stages.is_empty() && stages.iter().all(|stage| stage["state"] == "done"), "{planned}");
    let answer = |store| space.stdout(&["calibrate", "w.toml", "--json", "--target", "y=18.5 MPa", "--store", store]);
    assert_eq!(answer("theirs"), answer("ours"));
}
