//! A calibration that is killed goes on by replay: the same trajectory to the last bit, wherever it stood and with any number of jobs.

use crate::space::Space;
use std::time::Duration;

/// One search by a method, with a simulator that scatters and now and then fails.
fn campaign(method: &str) -> String {
    format!(
        r#"
[workflow]
seed = 3
[factor]
a = {{ range = [1, 100], scale = "log" }}
b = {{ range = [0.5, 5] }}
[response]
y = {{}}
z = {{}}
[stage.points]
kind = "design"
method = "latin-hypercube"
runs = 4
factors = ["a", "b"]
[stage.model]
kind = "formula"
design = "points"
responses.y = {{ value = "a*b^0.5/max(0, b - 0.7)*max(0, b - 0.7)", scatter = 0.02 }}
responses.z = {{ value = "a/b", scatter = 0.02 }}
[stage.search]
kind = "calibrate"
simulator = "model"
{method}
factors = ["a", "b"]
targets = [{{ y = 30, z = 12 }}, {{ y = 8, z = 3 }}]
stop_at = 1e-9
"#
    )
}

const METHODS: [&str; 4] = [
    "method = \"annealing\"\nannealing = { preset = \"wang2017\" }\nevaluations = 150",
    "method = \"differential\"\nevaluations = 150",
    "method = \"cma-es\"\nevaluations = 150",
    "evaluations = 24",
];

#[test]
fn a_killed_calibration_ends_where_an_undisturbed_one_does() {
    for method in METHODS {
        let whole = Space::new();
        whole.write("w.toml", &campaign(method));
        let wanted = whole.run(&["--jobs", "1"]);
        let all: u64 = wanted.ran.iter().map(|(_, tasks)| tasks).sum();

        let killed = Space::new();
        killed.write("w.toml", &campaign(method));
        let mut kills = 0;
        for pause in [20, 45, 70, 30, 100, 60] {
            let mut child = killed.start(&["run", "w.toml", "--quiet", "--jobs", "2"]);
            std::thread::sleep(Duration::from_millis(pause));
            if child.try_wait().expect("the state of a run").is_some() {
                break;
            }
            child.kill().expect("killing a run");
            child.wait().expect("the end of a killed run");
            kills += 1;
        }
        let stored = killed.objects().len() as u64;
        let last = killed.run(&["--jobs", "2"]);
        assert!(kills > 0, "{method}: it was over before it could be killed");
        assert_eq!(last.objects, wanted.objects, "{method}: another trajectory");
        let ran: u64 = last.ran.iter().map(|(_, tasks)| tasks).sum();
        assert!(ran <= all && ran + stored >= all, "{method}: {ran} of {all} ran, {stored} were stored");
    }
}
