//! Analysis of variance and a second-order surface of a large table: `cargo bench --bench statistics`.
//!
//! 100,000 rows and 20 three-level factors: 41 and 231 coefficients. The least of several times is printed.

use math::random::Stream;
use stats::anova::{Settings, anova};
use stats::regression::{self, regress};
use stats::sample::{Factor, Response, Sample};
use stats::terms::Term;
use std::time::Instant;

fn table(rows: usize, factors: usize) -> Sample {
    let mut stream = Stream::new(1, "bench", 0);
    let column = |k: usize, stream: &mut Stream| {
        let values = (0..rows).map(|_| 10.0 * (1.0 + stream.below(3) as f64)).collect();
        Factor::new(&format!("x{k}"), values)
    };
    let factors: Vec<Factor> = (0..factors).map(|k| column(k, &mut stream)).collect();
    let y = (0..rows).map(|i| factors.iter().map(|f| f.values[i]).sum::<f64>() + stream.normal()).collect();
    Sample { factors, responses: vec![Response::new("y", y)], weights: None }
}

fn least<T>(times: usize, mut work: impl FnMut() -> T) -> f64 {
    let mut best = f64::INFINITY;
    for _ in 0..times {
        let start = Instant::now();
        std::hint::black_box(work());
        best = best.min(start.elapsed().as_secs_f64());
    }
    best
}

fn main() {
    let large = table(100_000, 20);
    let names: Vec<String> = large.factors.iter().map(|f| f.name.clone()).collect();
    let terms = Term::second_order(&names);
    println!(
        "anova, 100000 x 20: {:.3} s",
        least(5, || anova(&large, &Settings::default()).map_err(|e| panic!("{e}")))
    );
    let surface = || regress(&large, "y", &terms, &regression::Settings::default()).map_err(|e| panic!("{e}"));
    println!("surface, 100000 x 20, {} terms: {:.3} s", terms.len(), least(5, surface));
    let small = table(64, 13);
    println!("anova, 64 x 13: {:.4} s", least(5, || anova(&small, &Settings::default()).map_err(|e| panic!("{e}"))));
}
