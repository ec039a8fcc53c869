//! Tables of how well the optimisers do: `cargo bench --bench optimisers -- [standard|su2021|surrogate]`.
//!
//! `tests/reference/optim/optimisers.py` prints the table of the standard functions for scipy, in the same form.

use benchmark::METHODS;
use flow::math;
use flow::optim::search::{Knowledge, Limits, Method, Run, Search, minimise};
use flow::optim::{Problem, annealing, cma_es, constraint, differential, genetic, misfit, surrogate};
use misfit::{Denominator, Form};
use std::time::Instant;

#[path = "../../src/optim/benchmark.rs"]
mod benchmark;

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

/// Calibrations per line, twenty seeds of each of the five target sets.
const CALIBRATIONS: usize = 100;

fn stand_in() {
    println!(
        "\nsurrogate on the noisy stand-in, median/90th percentile of {CALIBRATIONS}: runs until the recommended point"
    );
    println!(
        "is within 2 % of the truth on all outputs, first and for good; true error in % after 20 and 30 runs, and"
    );
    println!("where it ends by itself (last line of a group), with the number of runs there");
    for (earlier, budget) in [(0, 40), (50, 24)] {
        for (batch, tolerance) in [(1, 0.0), (2, 0.0), (4, 0.0), (4, 0.02)] {
            let settings = surrogate::Settings { batch, tolerance, ..Default::default() };
            let budget = if tolerance > 0.0 { 60 } else { budget };
            let clock = Instant::now();
            let one = |i: usize| calibrate(i % 5, i as u64, earlier, budget, &settings);
            let results: Vec<[f64; 6]> = (0..CALIBRATIONS).map(one).collect();
            let time = clock.elapsed().as_secs_f64() / CALIBRATIONS as f64;
            print!("earlier {earlier:2} batch {batch} ");
            for (k, name) in ["first", "for good", "error@20", "error@30", "runs", "error"].iter().enumerate() {
                let mut values: Vec<f64> = results.iter().map(|r| r[k]).collect();
                values.sort_by(f64::total_cmp);
                let median = values[CALIBRATIONS / 2 - 1].midpoint(values[CALIBRATIONS / 2]);
                print!(" {name} {:>9}", format!("{median:.1}/{:.1}", values[CALIBRATIONS * 9 / 10 - 1]));
            }
            println!("  {time:.2} s");
        }
    }
}

/// Runs to the first and to the lasting 2 %, errors after 20 and 30 runs, runs and error at the end.
fn calibrate(set: usize, seed: u64, earlier: usize, budget: usize, settings: &surrogate::Settings) -> [f64; 6] {
    let problem = benchmark::su2021(set, Form::Sum, Denominator::Target);
    let mut noise = math::random::Stream::new(seed, "bench noise", 0);
    let known = |_| {
        let point = problem.domain.natural(&problem.domain.sample(&mut noise));
        let responses = Some(benchmark::noisy(&point, &mut noise));
        Run { point, responses }
    };
    let knowledge = Knowledge { earlier: (0..earlier).map(known).collect(), trend: None };
    let limits = Limits { evaluations: Some(budget), ..Default::default() };
    let mut search = Search::new(&problem, &Method::Surrogate(settings.clone()), &limits, seed, &knowledge);
    let (mut first, mut last_bad, mut at) = (f64::INFINITY, -1.0, [f64::NAN; 2]);
    loop {
        let state = search.state();
        let n = state.evaluations as f64;
        let error = state.recommended.map_or(1.0, |r| benchmark::true_error(&problem.domain.natural(&r.point), set));
        if error <= 0.02 {
            first = f64::min(first, n);
        } else {
            last_bad = n;
        }
        for (at, limit) in at.iter_mut().zip([20.0, 30.0]) {
            if n <= limit {
                *at = 100.0 * error;
            }
        }
        if search.stop().is_some() {
            return [first, last_bad + 1.0, at[0], at[1], n, 100.0 * error];
        }
        let asked = search.ask();
        let answers: Vec<_> = asked.iter().map(|x| Some(benchmark::noisy(x, &mut noise))).collect();
        search.tell(&answers);
    }
}
