//! What the store adds to a task, by hand: `cargo bench --bench store [-- TASKS]`.
//!
//! Minima of several rounds, as wall time and as processor time of the thread, which a busy machine disturbs less.

use flow::artifact::{Artifact, Group, Key, Node, Table};
use flow::store::{Claim, Memo, Store, Timing};
use std::time::{Instant, SystemTime};

fn result(value: f64) -> Artifact {
    let table = Table::default().reals_column("x", "", "", vec![value]).reals_column("y", "Pa", "", vec![2.0 * value]);
    Artifact::new("run", 1, Group::new().with("responses", Node::Table(table)))
}

fn text(task: usize) -> String {
    let input = "input = 0123456789abcdef0123456789abcdef0123456789abcdef0123456789abcdef\n";
    format!("work = command 1\nparameters = {{\"command\": [\"sh\", \"-c\", \"echo\"], \"x\": {task}}}\n{input}{input}")
}

/// Processor time of this thread, seconds; 0 where the system does not say.
fn processor() -> f64 {
    let stat = std::fs::read_to_string("/proc/thread-self/schedstat").unwrap_or_default();
    stat.split(' ').next().and_then(|ns| ns.parse::<f64>().ok()).unwrap_or(0.0) * 1e-9
}

fn report(what: &str, per: usize, rounds: usize, mut round: impl FnMut() -> Box<dyn FnOnce()>) {
    let (mut wall, mut cpu) = (f64::INFINITY, f64::INFINITY);
    for _ in 0..rounds {
        let work = round();
        let (start, before) = (Instant::now(), processor());
        work();
        wall = wall.min(start.elapsed().as_secs_f64());
        cpu = cpu.min(processor() - before);
    }
    let (scale, unit) = if per == 1 { (1e3, "ms") } else { (1e6 / per as f64, "µs each") };
    println!("{what:45} {:8.2} wall {:8.2} cpu {unit}", wall * scale, cpu * scale);
}

fn main() {
    let tasks: usize = std::env::args().filter_map(|argument| argument.parse().ok()).next().unwrap_or(10_000);
    let folder = tempfile::tempdir().expect("a temporary folder");
    let timing = Timing { started: SystemTime::now(), seconds: 0.0 };
    let mut number = 0;
    let root = folder.path().join("1");
    report("claimed and stored", tasks, 2, || {
        number += 1;
        let store = Store::open(&folder.path().join(number.to_string())).expect("a store");
        Box::new(move || {
            for task in 0..tasks {
                let Ok(Claim::Mine(claim)) = store.claim(&Key::of(&text(task))) else { panic!("not mine") };
                store.finish(claim, text(task), result(task as f64), &timing).expect("a record");
            }
        })
    });
    let keys: Vec<Key> = (0..tasks).map(|task| Key::of(&text(task))).collect();
    let open = || Store::open(&root).expect("a store");
    report("opened and journal read", 1, 7, || {
        let (root, key) = (root.clone(), Key::of("nothing"));
        Box::new(move || assert_eq!(Store::open(&root).expect("a store").find(&key).expect("readable"), None))
    });
    report("found", tasks, 7, || {
        let (store, keys) = (open(), keys.clone());
        store.records().expect("readable");
        Box::new(move || assert!(keys.iter().all(|key| store.find(key).expect("readable").is_some())))
    });
    let records = open().records().expect("readable");
    let objects = records.iter().map(|record| record.object()).collect();
    let memo = Memo { objects, ..Memo::default() };
    open().keep_memo(&keys[0], &memo).expect("kept");
    report("opened, memo read, all objects seen", 1, 7, || {
        let (root, key) = (root.clone(), keys[0]);
        Box::new(move || {
            let store = Store::open(&root).expect("a store");
            let memo = store.memo(&key).expect("readable").expect("a memo");
            assert!(store.has_all(&memo.objects).expect("readable"));
        })
    });
    report("read", tasks, 3, || {
        let (store, records) = (open(), records.clone());
        Box::new(move || records.iter().for_each(|record| drop(store.get(&record.content).expect("an artifact"))))
    });
}
