//! Tables of how well the optimisers do: `cargo bench --bench optimisers -- [standard|su2021|surrogate]`.
//!
//! `tests/reference/optim/optimisers.py` prints the table of the standard functions for scipy, in the same form.

use misfit::{Denominator, Form};
use optim::search::{Knowledge, Limits, Method, Run, Search, minimise};
use optim::{Problem, annealing, cma_es, constraint, differential, genetic, misfit, surrogate};
use std::time::Instant;

#[path = "../benchmark.rs"]
mod benchmark;

use benchmark::METHODS;

fn main() {
    let wanted: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with('-')).collect();
    let table = |name: &str| wanted.is_empty() || wanted.iter().any(|w| w == name);
    if table("standard") {
        standard_functions();
    }
    if table("su2021") {
        published_surfaces();
    }
    if table("surrogate") {
        stand_in();
    }
}

fn method(name: &str) -> Method {
    match name {
        "genetic" => Method::Genetic(genetic::Settings::default()),
        "annealing" => Method::Annealing(annealing::Settings::default()),
        "differential" => Method::Differential(differential::Settings::default()),
        "cma-es" => Method::CmaEs(cma_es::Settings::default()),
        _ => Method::Surrogate(surrogate::Settings::default()),
    }
}

/// Seeds per cell, and the value that counts as solved.
const REPEATS: u64 = 20;
const SOLVED: f64 = 1e-6;

fn standard_functions() {
    println!("successes of {REPEATS} (value ≤ {SOLVED:e}) and median evaluations to it");
    println!(
        "{:12} {:>3} {:>7} {}",
        "function",
        "d",
        "budget",
        METHODS[..4].iter().map(|m| format!("{m:>20}")).collect::<String>()
    );
    for function in &benchmark::STANDARD {
        for (dimension, budget) in [(7, 20_000), (20, 100_000)] {
            print!("{:12} {dimension:3} {budget:7} ", function.name);
            for name in &METHODS[..4] {
                let problem = benchmark::standard(function, dimension);
                let limits = Limits { evaluations: Some(budget), misfit: Some(SOLVED), polish: *name != "cma-es" };
                let mut used = Vec::new();
                for seed in 0..REPEATS {
                    let model = |x: &[f64]| Some(vec![1.0 + (function.value)(x)]);
                    let (_, state) = minimise(&problem, &method(name), &limits, seed, model);
                    if state.best.is_some_and(|best| best.misfit <= SOLVED) {
                        used.push(state.evaluations);
                    }
                }
                used.sort_unstable();
                let median = used.get(used.len() / 2).map_or("-".into(), ToString::to_string);
                print!("{:>12} {median:>7}", used.len());
            }
            println!();
        }
    }
}

fn published_surfaces() {
    println!("\nSu et al. 2021, Table 12, eq. 19: misfit and evaluations for each target set; longest time of a set");
    let mut methods: Vec<(&str, Method)> = METHODS.iter().map(|name| (*name, method(name))).collect();
    methods.push(("genetic su2021", Method::Genetic(genetic::Settings::su2021())));
    for (name, method) in methods {
        print!("{name:16}");
        let mut slowest = 0.0_f64;
        for set in 0..5 {
            let problem = benchmark::su2021(set, Form::Sum, Denominator::Computed);
            let surrogate = name == "surrogate";
            let limits = if name == "genetic su2021" {
                Limits::default()
            } else {
                Limits { evaluations: Some(if surrogate { 60 } else { 200_000 }), misfit: Some(1e-4), polish: false }
            };
            let clock = Instant::now();
            let (_, state) = minimise(&problem, &method, &limits, 1, |x| Some(benchmark::surfaces(x)));
            slowest = slowest.max(clock.elapsed().as_secs_f64());
            let best = state.best.map_or(f64::INFINITY, |best| best.misfit);
            print!("  {best:.1e} {:>7}", state.evaluations);
        }
        println!("  {slowest:.2} s");
    }
}

fn stand_in() {
    println!("\nsurrogate on the noisy stand-in: evaluations until the recommended point is within 2 % of the truth");
    println!(
        "on all three outputs (first / for good), true error in % at 20 and 30; median and 90th percentile of 100"
    );
    for (earlier, budget) in [(0, 40), (50, 24)] {
        for batch in [1, 4] {
            let reps: usize = std::env::var("REPS").map_or(100, |v| v.parse().expect("n"));
            let clock = Instant::now();
            let results: Vec<[f64; 4]> =
                (0..reps).map(|i| calibrate(i % 5, i as u64, earlier, budget, batch)).collect();
            let column = |k: usize| {
                let mut values: Vec<f64> = results.iter().map(|r| r[k]).collect();
                values.sort_by(f64::total_cmp);
                format!("{:.1}/{:.1}", values[reps / 2 - 1].midpoint(values[reps / 2]), values[reps * 9 / 10 - 1])
            };
            let time = clock.elapsed().as_secs_f64() / results.len() as f64;
            println!(
                "earlier {earlier:3} batch {batch}  first {:>10}  for good {:>10}  error@20 {:>9}  @30 {:>9}  {time:.2} s",
                column(0),
                column(1),
                column(2),
                column(3)
            );
        }
    }
}

/// [first, for good, error at 20, error at 30] of one calibration.
fn calibrate(set: usize, seed: u64, earlier: usize, budget: usize, batch: usize) -> [f64; 4] {
    let problem = benchmark::su2021(set, Form::Sum, Denominator::Target);
    let mut noise = math::random::Stream::new(seed, "bench noise", 0);
    let earlier: Vec<Run> = (0..earlier)
        .map(|_| {
            let point = problem.domain.natural(&problem.domain.sample(&mut noise));
            let responses = Some(benchmark::noisy(&point, &mut noise));
            Run { point, responses }
        })
        .collect();
    let settings = surrogate::Settings { batch, tolerance: 0.0, ..Default::default() };
    let limits = Limits { evaluations: Some(budget), ..Default::default() };
    let mut search =
        Search::new(&problem, &Method::Surrogate(settings), &limits, seed, &Knowledge { earlier, trend: None });
    let (mut first, mut last_bad, mut at) = (f64::INFINITY, 0.0, [f64::NAN; 2]);
    loop {
        let state = search.state();
        let n = state.evaluations as f64;
        let error = state.recommended.map_or(1.0, |r| benchmark::true_error(&problem.domain.natural(&r.point), set));
        if error <= 0.02 {
            first = f64::min(first, n)
        } else {
            last_bad = n
        }
        for (at, limit) in at.iter_mut().zip([20.0, 30.0]) {
            if n <= limit {
                *at = 100.0 * error;
            }
        }
        if search.stop().is_some() {
            return [first, last_bad + 1.0, at[0], at[1]];
        }
        let asked = search.ask();
        let answers: Vec<_> = asked.iter().map(|x| Some(benchmark::noisy(x, &mut noise))).collect();
        search.tell(&answers);
    }
}
