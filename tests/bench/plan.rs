//! Speed of the plan: `cargo bench --bench plan`. Prints the least of many repeats.

use flow::artifact::ContentHash;
use flow::plan::key::{key, task_text};
use flow::plan::{Overrides, parse};
use flow::stage::Task;
use serde_json::json;
use std::fmt::Write;
use std::hint::black_box;
use std::time::{Duration, Instant};

fn main() {
    let levels: Vec<String> = (0..10_000).map(|i| format!("{:.3}", 1.0 + f64::from(i) * 1e-3)).collect();
    let text = format!(
        "[workflow]\nseed = 1\n[factor.Ec]\nunit = \"GPa\"\nlevels = [{}]\n[stage.runs]\nkind = \"data\"\nfile = \"a.csv\"\n",
        levels.join(", ")
    );
    report("check a workflow with 10,000 levels", 50, || parse("w.toml", &text, &Overrides::default()).is_ok());

    let mut many = String::from("[workflow]\nseed = 1\n");
    for i in 0..10_000 {
        writeln!(many, "[stage.s{i}]\nkind = \"data\"\nfile = \"{i}.csv\"").unwrap_or_else(|e| panic!("{e}"));
    }
    report("check a workflow with 10,000 stages", 20, || parse("w.toml", &many, &Overrides::default()).is_ok());

    let root = ContentHash([7; 32]);
    let trivial = |i: u32| Task::new("data", json!({ "value": i })).input("root", root);
    let campaign = |i: u32| {
        let level = f64::from(i) * 1e7;
        let params = json!({
            "mortar": { "Ec": 1.6e10 + level, "kn_ks": 2.5, "sigma_c": 3.4e7, "tau_c": 3.1e7 + level, "mu": 0.5 },
            "aggregate": { "Ec": 5.5e10, "kn_ks": 1.8, "mu": 0.45 },
            "interface": { "Ec": 1.1e10, "sigma_c": 1.9e7, "tau_c": 2.2e7, "mu": 0.3 },
            "test": { "kind": "uniaxial", "speed": 0.02, "stop": 0.7 },
        });
        Task::new("data", params).seed(u64::from(i)).input("specimen", root)
    };
    let tasks: [(&str, Vec<Task>); 2] = [
        ("10,000 keys of trivial tasks", (0..10_000).map(trivial).collect()),
        ("10,000 keys of tasks with 15 parameters", (0..10_000).map(campaign).collect()),
    ];
    for (name, tasks) in &tasks {
        report(name, 30, || tasks.iter().map(|task| key(&task_text(task, &[root]))[0]).fold(0, u8::wrapping_add));
    }
    let gather = (0..10_000).fold(Task::new("data", json!({})), |task, _| task.input("run", root));
    let contents = vec![root; 10_000];
    report("key of a task with 10,000 inputs", 50, || key(&task_text(&gather, &contents)));
}

fn report<T>(name: &str, repeats: usize, mut work: impl FnMut() -> T) {
    let mut least = Duration::MAX;
    for _ in 0..repeats {
        let start = Instant::now();
        black_box(work());
        least = least.min(start.elapsed());
    }
    println!("{name:<45} {:8.3} ms", least.as_secs_f64() * 1e3);
}
