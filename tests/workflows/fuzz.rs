//! The parser under mutated workflows and garbage: no panic, and every fault points into its text.
//!
//! The inputs are a function of their number alone. `FLOW_FUZZ=1000000 cargo test --release --test workflows fuzz` runs as
//! many as it says; a failure names the number, and `FLOW_FUZZ_ONLY=number` runs and shows just that one.

use super::corpus::files;
use super::properties::workflow as read;
use flow::plan::{Overrides, schema};
use math::random::Stream;
use std::fs;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicU64, Ordering};

const IN_EVERY_TEST_RUN: u64 = 1_000;

/// Pieces that mean something to TOML or to a workflow.
const PIECES: &[&str] = &[
    "[",
    "]",
    "[[",
    "]]",
    "{",
    "}",
    "=",
    ".",
    ",",
    "\"",
    "'",
    "\"\"\"",
    "'''",
    "#",
    "\n",
    "\r\n",
    "\t",
    " ",
    "\\",
    "\\u0000",
    "\u{0}",
    "\u{feff}",
    "σ",
    "\u{202e}",
    "\u{1f600}",
    "nan",
    "-inf",
    "1e999",
    "-0",
    "0x",
    "9223372036854775808",
    "1e-400",
    "1979-05-27T07:32:00Z",
    "true",
    "[workflow]",
    "[stage.a]",
    "[profile.quick.stage.a]",
    "[factor.x]",
    "[response.y]",
    "[material.m]",
    "kind = ",
    "seed = ",
    "levels = ",
    "range = ",
    "sets = ",
    "unit = ",
    "design = ",
    "method = ",
    "\"GPa\"",
    "\"16 GPa\"",
    "\"1 m^127*m^127\"",
    "\"5e308 km\"",
    "\"a\"",
    "[1, 2, 3]",
    "{ value = \"x^x^x\" }",
    "{}",
    "[]",
    "a.b.c",
    "1_0",
];

fn pick<'a, T: ?Sized>(random: &mut Stream, from: &[&'a T]) -> &'a T {
    from[random.below(from.len())]
}

/// A location between characters.
fn location(random: &mut Stream, text: &str) -> usize {
    text.floor_char_boundary(random.below(text.len() + 1))
}

/// Every keyword of the schema, so that kinds, keys and words of all stages occur.
fn words(schema: &serde_json::Value, found: &mut Vec<String>) {
    match schema {
        serde_json::Value::String(word) if word.len() < 30 => found.push(format!("\"{word}\"")),
        serde_json::Value::Array(list) => list.iter().for_each(|item| words(item, found)),
        serde_json::Value::Object(map) => map.iter().for_each(|(name, value)| {
            found.push(name.clone());
            words(value, found);
        }),
        _ => {}
    }
}

struct Inputs {
    corpus: Vec<String>,
    words: Vec<String>,
}

impl Inputs {
    fn new() -> Self {
        let mut folders =
            ["workflows", "tests/good", "tests/bad", "tests/bad/beyond-schema"].map(str::to_owned).to_vec();
        let cases = fs::read_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/cases")).unwrap();
        folders.extend(cases.map(|case| format!("tests/cases/{}", case.unwrap().file_name().display())));
        folders.sort();
        let corpus = folders.iter().flat_map(|folder| files(folder)).map(|path| fs::read_to_string(path).unwrap());
        let mut found = Vec::new();
        words(&schema::schema(), &mut found);
        found.sort();
        found.dedup();
        Self { corpus: corpus.collect(), words: found }
    }

    /// Input `number`: a text and what is laid over it.
    fn input(&self, number: u64) -> (String, Overrides) {
        let mut random = Stream::new(number, "fuzz", 0);
        let mut text = match random.below(10) {
            0 => (0..random.below(60)).map(|_| self.piece(&mut random) + " ").collect(),
            1 => (0..random.below(200)).map(|_| char::from(random.below(128) as u8)).collect(),
            _ => self.corpus[random.below(self.corpus.len())].clone(),
        };
        for _ in 0..random.below(6) {
            self.mutate(&mut random, &mut text);
        }
        let profile = (random.below(4) == 0).then(|| pick(&mut random, &["quick", "other", "", "σ\n"]).to_owned());
        let some = if random.below(4) == 0 { random.below(3) } else { 0 };
        let set = |random: &mut Stream| {
            let path =
                pick(random, &["stage.a.file", "workflow.seed", "factor.Ec.levels", "a b", "", "stage.\"a.b\".c"]);
            format!("{path}{}{}", pick(random, &["=", "", "=="]), self.piece(random))
        };
        let sets = (0..some).map(|_| set(&mut random)).collect();
        (text, Overrides { profile, sets })
    }

    fn piece(&self, random: &mut Stream) -> String {
        if random.below(2) == 0 {
            pick(random, PIECES).to_owned()
        } else {
            self.words[random.below(self.words.len())].clone()
        }
    }

    fn mutate(&self, random: &mut Stream, text: &mut String) {
        let (a, b) = (location(random, text), location(random, text));
        let (from, to) = (a.min(b), a.max(b));
        let near = text.floor_char_boundary(text.len().min(from + random.below(12)));
        match random.below(8) {
            0 => text.insert_str(a, &self.piece(random)),
            1 => text.replace_range(from..near, &self.piece(random)),
            2 => text.replace_range(from..near, ""),
            3 => text.replace_range(from..to, ""),
            4 => {
                let copied = text[from..to].to_owned();
                text.insert_str(location(random, text), &copied);
            }
            5 => {
                let other = &self.corpus[random.below(self.corpus.len())];
                let cut = location(random, other);
                text.replace_range(from.., &other[cut..]);
            }
            6 => {
                let mut lines: Vec<&str> = text.lines().collect();
                if !lines.is_empty() {
                    let (i, j) = (random.below(lines.len()), random.below(lines.len()));
                    lines.swap(i, j);
                }
                *text = lines.join("\n");
            }
            _ => text.insert_str(a, &pick(random, PIECES).repeat(random.below(200))),
        }
    }
}

#[test]
fn fuzz() {
    let number = |name: &str| std::env::var(name).ok().map(|text| text.parse::<u64>().unwrap());
    let inputs = Inputs::new();
    if let Some(only) = number("FLOW_FUZZ_ONLY") {
        let (text, overrides) = inputs.input(only);
        println!("{text}\n{overrides:?}");
        return read(&text, &overrides);
    }
    let count = number("FLOW_FUZZ").unwrap_or(IN_EVERY_TEST_RUN);
    let next = AtomicU64::new(0);
    let worker = || {
        loop {
            let number = next.fetch_add(1, Ordering::Relaxed);
            if number >= count {
                return;
            }
            let (text, overrides) = inputs.input(number);
            if catch_unwind(AssertUnwindSafe(|| read(&text, &overrides))).is_err() {
                next.store(count, Ordering::Relaxed);
                panic!("input {number}: see it with FLOW_FUZZ_ONLY={number}");
            }
        }
    };
    std::thread::scope(|scope| {
        let threads = std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
        (0..threads).for_each(|_| drop(scope.spawn(worker)));
    });
}
