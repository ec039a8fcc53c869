//! Units, formulas and tables under mutated texts: no panic, and what is read means the same when it is read again.
//!
//! Inputs are a function of their number alone; `fuzz/` runs the same properties with coverage as its guide.
//! `FLOW_FUZZ=1000000 cargo test --release --test workflows texts` runs as many of each as it says; a failure names the number, and `FLOW_FUZZ_ONLY=number` runs and shows just
//! that one. What a run by hand finds goes into `tests/workflows/corpus`.

use super::properties::{formula, table, unit};
use math::random::Stream;
use std::panic::{AssertUnwindSafe, catch_unwind};

const IN_EVERY_TEST_RUN: u64 = 5_000;

const PIECES: &[&str] = &[
    "^",
    "*",
    "/",
    "(",
    ")",
    " ",
    "\u{3000}",
    "m",
    "Pa",
    "GPa",
    "µ",
    "°",
    "%",
    "√",
    "²",
    "⁻",
    "1",
    "0.5",
    "-",
    "1e400",
    "nan",
    "inf",
    "max(",
    "min(",
    "sqrt(",
    ",",
    "x",
    "sigma_c",
    "+",
    "1e-3",
    ".",
    "#",
    "\n",
    "\r\n",
    "\"",
    "\"\"",
    ";",
    "\t",
    "[",
    "]",
    "[GPa]",
    "\u{feff}",
    "\u{0}",
    "é",
    "\u{1f600}",
    "99999999999999999999",
];

fn mutated(corpus: &[&str], random: &mut Stream) -> String {
    let place = |random: &mut Stream, text: &str| text.floor_char_boundary(random.below(text.len() + 1));
    let mut text = corpus[random.below(corpus.len())].to_owned();
    for _ in 0..random.below(6) {
        let (a, b) = (place(random, &text), place(random, &text));
        let (from, to) = (a.min(b), a.max(b));
        let piece = PIECES[random.below(PIECES.len())];
        match random.below(6) {
            0 => text.insert_str(a, piece),
            1 => text.replace_range(from..to, piece),
            2 => text.replace_range(from..to, ""),
            3 => text.insert_str(a, &piece.repeat(random.below(100))),
            4 => {
                let copied = text[from..to].to_owned();
                text.insert_str(b, &copied);
            }
            _ => {
                let other = corpus[random.below(corpus.len())];
                text.replace_range(from.., &other[place(random, other)..]);
            }
        }
    }
    text
}

/// Reads the texts of a corpus, and as many mutated ones as were asked for.
fn fuzz(name: &str, corpus: &[&str], read: fn(&str)) {
    let number = |name: &str| std::env::var(name).ok().map(|text| text.parse::<u64>().unwrap());
    let only = number("FLOW_FUZZ_ONLY");
    let numbers = only.map_or(0..number("FLOW_FUZZ").unwrap_or(IN_EVERY_TEST_RUN), |only| only..only + 1);
    corpus.iter().for_each(|text| read(text));
    for number in numbers {
        let text = mutated(corpus, &mut Stream::new(number, name, 0));
        if catch_unwind(AssertUnwindSafe(|| read(&text))).is_err() {
            panic!("{name}, input {number}: {text:?}; see it alone with FLOW_FUZZ_ONLY={number}");
        }
    }
}

#[test]
fn units() {
    fuzz("unit", &include_str!("corpus/units.txt").lines().collect::<Vec<_>>(), unit);
}

#[test]
fn formulas() {
    fuzz("formula", &include_str!("corpus/formulas.txt").lines().collect::<Vec<_>>(), formula);
}

#[test]
fn tables() {
    fuzz("table", &include_str!("corpus/tables.txt").split("=====\n").collect::<Vec<_>>(), table);
}
