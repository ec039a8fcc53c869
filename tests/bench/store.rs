//! What the store adds to a task, by hand: `cargo bench --bench store [-- TASKS]`. Minima of several rounds.

use flow::artifact::{Artifact, Group, Key, Node, Table};
use flow::store::{Claim, Store, Timing};
use std::time::{Instant, SystemTime};

fn small(value: f64) -> Artifact {
    let table = Table::default().reals_column("x", "", "", vec![value]).reals_column("y", "Pa", "", vec![2.0 * value]);
    Artifact::new("run", 1, Group::new().with("responses", Node::Table(table)))
}

fn text(task: usize) -> String {
    format!(
        "work = command 1\nparameters = {{\"command\": [\"sh\", \"-c\", \"echo\"], \"x\": {task}}}\nseed = 1\n{}",
        "input = 0123456789abcdef0123456789abcdef0123456789abcdef0123456789abcdef\n".repeat(3)
    )
}

fn least(rounds: usize, mut round: impl FnMut() -> f64) -> f64 {
    (0..rounds).map(|_| round()).fold(f64::INFINITY, f64::min)
}

fn timed(work: impl FnOnce()) -> f64 {
    let start = Instant::now();
    work();
    start.elapsed().as_secs_f64()
}

fn main() {
    let tasks: usize = std::env::args().filter_map(|a| a.parse().ok()).next().unwrap_or(10_000);
    let folder = tempfile::tempdir().expect("a temporary folder");
    let timing = Timing { started: SystemTime::now(), seconds: 0.0 };
    let mut number = 0;
    let cold = least(2, || {
        number += 1;
        let store = Store::open(&folder.path().join(number.to_string())).expect("a store");
        timed(|| {
            std::thread::scope(|scope| {
                for thread in 0..2 {
                    let store = &store;
                    scope.spawn(move || {
                        for task in (thread..tasks).step_by(2) {
                            let key = Key::of(&text(task));
                            let Claim::Mine(_guard) = store.claim(&key).expect("a claim") else { panic!("claimed") };
                            store.put(&text(task), small(task as f64), &timing).expect("a record");
                        }
                    });
                }
            });
        })
    });
    println!("{tasks} tasks claimed and stored by 2 threads: {:.1} µs each", cold / tasks as f64 * 1e6);
    let root = folder.path().join("1");
    let keys: Vec<Key> = (0..tasks).map(|task| Key::of(&text(task))).collect();
    let load = least(5, || timed(|| drop(Store::open(&root).expect("a store").find(&keys[0]))));
    println!("opened and journal read: {:.2} ms", load * 1e3);
    let find = least(5, || {
        let store = Store::open(&root).expect("a store");
        store.find(&keys[0]).expect("a record");
        timed(|| keys.iter().for_each(|key| assert!(store.find(key).expect("a record").is_some())))
    });
    println!("found: {:.2} µs each", find / tasks as f64 * 1e6);
    let get = least(3, || {
        let store = Store::open(&root).expect("a store");
        let contents: Vec<_> = keys.iter().map(|key| store.find(key).expect("ok").expect("a record").content).collect();
        timed(|| contents.iter().for_each(|content| drop(store.get(content).expect("an artifact"))))
    });
    println!("read: {:.1} µs each", get / tasks as f64 * 1e6);
    let mut count = 0;
    let list = least(5, || {
        timed(|| {
            for shard in std::fs::read_dir(root.join("objects")).unwrap().flatten() {
                for f in std::fs::read_dir(shard.path()).unwrap().flatten() {
                    count += f.file_name().len();
                }
            }
        })
    });
    println!("list {:.2} ms", list * 1e3);
}
