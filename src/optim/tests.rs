//! What every optimiser owes its user, tried on all of them.

use super::benchmark::{self, METHODS};
use super::constraint::{Domain, Linear};
use super::misfit::{Denominator, Form};
use super::search::{Knowledge, Limits, Method, Next, Run, Search, minimise, next};
use super::{Error, Problem, Stop, annealing, cma_es, differential, genetic, surrogate};
use math::random::Stream;

fn methods() -> Vec<Method> {
    vec![
        Method::Genetic(genetic::Settings::default()),
        Method::Genetic(genetic::Settings { mutation: genetic::Mutation::Gaussian, ..Default::default() }),
        Method::Annealing(annealing::Settings::default()),
        Method::Annealing(annealing::Settings { chains: Some(3), ..annealing::Settings::wang2017() }),
        Method::Differential(differential::Settings::default()),
        Method::Differential(differential::Settings { preset: differential::Preset::Jde, ..Default::default() }),
        Method::Differential(differential::Settings::rcc2020()),
        Method::CmaEs(cma_es::Settings::default()),
        Method::Surrogate(surrogate::Settings::default()),
    ]
}

/// The five methods at their defaults.
fn defaults() -> Vec<Method> {
    methods().into_iter().enumerate().filter(|(i, _)| [0, 2, 4, 7, 8].contains(i)).map(|(_, m)| m).collect()
}

fn budget(evaluations: usize) -> Limits {
    Limits { evaluations: Some(evaluations), ..Default::default() }
}

fn is_surrogate(method: &Method) -> bool {
    matches!(method, Method::Surrogate(_))
}

/// Su et al. 2021, section 6.3: the global minimum of each of the five target sets is 0.
#[test]
fn every_method_solves_the_published_target_sets() {
    for (name, method) in METHODS.iter().zip(defaults()) {
        for set in 0..5 {
            let problem = benchmark::su2021(set, Form::Sum, Denominator::Computed);
            let evaluations = if is_surrogate(&method) { 60 } else { 40_000 };
            let limits = Limits { evaluations: Some(evaluations), misfit: Some(1e-3), polish: false };
            let (stop, state) = minimise(&problem, &method, &limits, 1, |x| Some(benchmark::surfaces(x)));
            assert_eq!(stop, Stop::Reached, "{name}, set {}: {state:?}", set + 1);
        }
    }
}

#[test]
fn the_published_genetic_algorithm_ends_by_its_own_rule_at_the_minimum() {
    for set in 0..5 {
        let problem = benchmark::su2021(set, Form::Sum, Denominator::Computed);
        let method = Method::Genetic(genetic::Settings::su2021());
        let (stop, state) = minimise(&problem, &method, &Limits::default(), 7, |x| Some(benchmark::surfaces(x)));
        assert!(matches!(stop, Stop::Stalled | Stop::Iterations), "{stop}");
        assert!(state.best.as_ref().is_some_and(|best| best.misfit <= 1e-3), "{state:?}");
    }
}

/// The whole table, against scipy: `cargo bench --bench optimisers -- standard`.
#[test]
fn standard_functions_are_solved() {
    for function in &benchmark::STANDARD {
        for (name, method) in METHODS.iter().zip(defaults()).take(4) {
            if function.name == "rastrigin" && matches!(*name, "genetic" | "cma-es") {
                continue;
            }
            let problem = benchmark::standard(function, 5);
            let limits = Limits { evaluations: Some(30_000), misfit: Some(1e-6), polish: true };
            let (stop, state) = minimise(&problem, &method, &limits, 3, |x| Some(vec![1.0 + (function.value)(x)]));
            assert_eq!(stop, Stop::Reached, "{name} on {}: {:?}", function.name, state.best);
        }
    }
}

/// Killed anywhere, also within a batch, a search replayed from its history goes on as if nothing had happened.
#[test]
fn replay_from_any_history_asks_the_same() {
    let problem = benchmark::su2021(1, Form::Maximum, Denominator::Target);
    for method in methods() {
        let mut noise = Stream::new(1, "noise", 0);
        let mut search = Search::new(&problem, &method, &budget(70), 5, &Knowledge::default());
        let mut history = Vec::new();
        while search.stop().is_none() {
            let asked = search.ask();
            let fails = |i: usize| (history.len() + i) % 9 == 4;
            let answer = |(i, x): (usize, &Vec<f64>)| (!fails(i)).then(|| benchmark::noisy(x, &mut noise));
            let answers: Vec<_> = asked.iter().enumerate().map(answer).collect();
            search.tell(&answers);
            history.extend(asked.into_iter().zip(answers).map(|(point, responses)| Run { point, responses }));
        }
        for kept in [0, 1, 13, history.len() - 1] {
            let again = next(&problem, &method, &budget(70), 5, &Knowledge::default(), &history[..kept]);
            let Ok(Next::Ask(points)) = again else { panic!("{again:?}") };
            let wanted: Vec<_> = history[kept..].iter().take(points.len()).map(|run| run.point.clone()).collect();
            assert_eq!(points, wanted, "{method:?} after {kept}");
        }
        let end = next(&problem, &method, &budget(70), 5, &Knowledge::default(), &history);
        let Ok(Next::Stop(stop, state)) = end else { panic!("{end:?}") };
        // As texts, because an interval that is unknown is NaN, which equals nothing.
        let (told, wanted) = ((Some(stop), state), (search.stop(), search.state()));
        assert_eq!(format!("{told:?}"), format!("{wanted:?}"));
        let other = next(&problem, &method, &budget(70), 6, &Knowledge::default(), &history);
        assert!(matches!(other, Err(Error::ForeignHistory { index: 0, .. })), "{method:?}");
    }
}

/// First point asked for after some generations; a change of these values changes every calibration.
#[test]
fn trajectories_are_pinned() {
    let problem = benchmark::su2021(0, Form::Sum, Denominator::Target);
    let mut seen = Vec::new();
    for method in defaults() {
        let evaluations = if is_surrogate(&method) { 20 } else { 700 };
        let (_, state) = minimise(&problem, &method, &budget(evaluations), 11, |x| Some(benchmark::surfaces(x)));
        let recommended = state.recommended.expect("a recommendation");
        seen.push(
            blake3::hash(&recommended.point.iter().flat_map(|u| u.to_le_bytes()).collect::<Vec<_>>()).to_hex()[..8]
                .to_owned(),
        );
    }
    assert_eq!(seen, TRAJECTORIES);
}
const TRAJECTORIES: [&str; 5] = ["56a75042", "de03ab75", "80af84bb", "6c5ad5c1", "43c39ef2"];

/// The published presets, with runs that fail: 500 evaluations each, the first population around a guess.
#[test]
fn trajectories_of_the_presets_are_pinned() {
    let free = benchmark::su2021(0, Form::Maximum, Denominator::Target);
    let guess = Problem { start: Some(vec![0.4; 7]), ..free.clone() };
    let cases = [
        (Method::Annealing(annealing::Settings::wang2017()), &free),
        (Method::Annealing(annealing::Settings::wang2017()), &guess),
        (Method::Differential(differential::Settings::rcc2020()), &free),
        (Method::Differential(differential::Settings::rcc2020()), &guess),
    ];
    let mut seen = Vec::new();
    for (method, problem) in cases {
        let (mut count, mut bytes) = (0, Vec::new());
        let (stop, state) = minimise(problem, &method, &budget(500), 11, |x| {
            count += 1;
            bytes.extend(x.iter().flat_map(|x| x.to_le_bytes()));
            (count % 7 != 3).then(|| benchmark::surfaces(x))
        });
        assert_eq!((stop, state.evaluations, state.failed), (Stop::Evaluations, 500, 72), "{method:?}");
        seen.push(blake3::hash(&bytes).to_hex()[..8].to_owned());
    }
    assert_eq!(seen, PRESETS);
}
const PRESETS: [&str; 4] = ["bd36669b", "6f796359", "44e6a987", "d7fd918a"];

/// A first guess is the first point that is tried, whatever the method, or the middle of what is tried first.
#[test]
fn every_method_begins_at_a_first_guess() {
    let guess = vec![0.3, 0.6, 0.5, 0.4, 0.5, 0.35, 0.65];
    let problem = Problem { start: Some(guess.clone()), ..benchmark::su2021(0, Form::Sum, Denominator::Target) };
    for method in methods() {
        // The steps of the evolution strategy are normal around its guess.
        let narrow = Method::CmaEs(cma_es::Settings { step: 1e-14, ..Default::default() });
        let method = if matches!(method, Method::CmaEs(_)) { narrow } else { method };
        let mut search = Search::new(&problem, &method, &budget(500), 3, &Knowledge::default());
        let asked: Vec<Vec<f64>> = search.ask().iter().map(|x| problem.domain.unit(x)).collect();
        let mean = |j: usize| asked.iter().map(|u| u[j]).sum::<f64>() / asked.len() as f64;
        for (j, wanted) in guess.iter().enumerate() {
            let found = if is_surrogate(&method) { mean(j) } else { asked[0][j] };
            assert!((found - wanted).abs() < 1e-12, "{method:?}: {found}");
        }
    }
}

/// Seven orders of magnitude: by equal differences the answer lies at a ten-thousandth of the range.
#[test]
fn every_method_searches_orders_of_magnitude_by_logarithms() {
    use super::constraint::Factor;
    use super::misfit::{Misfit, Target};
    let factors = ["kn", "sigma"].map(|name| Factor::log(name, 1e2, 1e9)).to_vec();
    let targets = vec![Target::exactly("E", 3e4, 1.0), Target::exactly("UCS", 2e4, 1.0)];
    let misfit = Misfit::new(targets, Form::Sum, Denominator::Target).expect("targets");
    let problem = Problem { domain: Domain::new(factors, &[]).expect("a box"), misfit, start: None };
    for (name, method) in METHODS.iter().zip(defaults()) {
        let limits = Limits { misfit: Some(0.01), ..budget(if is_surrogate(&method) { 60 } else { 3000 }) };
        let (stop, state) = minimise(&problem, &method, &limits, 2, |x| {
            assert!(x.iter().all(|x| (1e2..=1e9).contains(x)), "{x:?}");
            Some(vec![0.3 * x[0], 1.2 * (x[0] * x[1]).sqrt()])
        });
        assert_eq!(stop, Stop::Reached, "{name}: {:?}", state.best);
    }
}

#[test]
fn no_method_leaves_the_box_or_breaks_a_constraint() {
    let free = benchmark::su2021(2, Form::Sum, Denominator::Target);
    let terms = [("sigma_c".to_owned(), 1.0), ("tau_c".to_owned(), -2.0)].into_iter().collect();
    let ratio = Linear { terms, at_most: -5.0 };
    let terms = [("Ec".to_owned(), 1.0), ("Ecj".to_owned(), 1.0)].into_iter().collect();
    let sum = Linear { terms, at_most: 30.0 };
    let domain = Domain::new(free.domain.factors().to_vec(), &[ratio, sum]).expect("feasible");
    let problem = Problem { domain, misfit: free.misfit, start: None };
    for method in methods() {
        let evaluations = if is_surrogate(&method) { 24 } else { 600 };
        let (_, state) = minimise(&problem, &method, &budget(evaluations), 3, |x| {
            problem.domain.check(x).unwrap_or_else(|e| panic!("{method:?}: {e}"));
            Some(benchmark::surfaces(x))
        });
        assert!(state.best.is_some());
    }
}

#[test]
fn a_model_that_always_fails_ends_the_search() {
    let problem = benchmark::su2021(0, Form::Sum, Denominator::Target);
    for method in methods() {
        let (stop, state) = minimise(&problem, &method, &budget(2000), 3, |_| None);
        assert_eq!(stop, Stop::AllFailed, "{method:?}");
        assert_eq!((state.best, state.failed), (None, state.evaluations));
    }
}

/// Wang & Cao's settings, read from the method's own numbers: 100 moves a chain, a stop at 10 %.
#[test]
fn published_presets_are_those_of_their_papers() {
    assert_eq!(genetic::Settings::su2021().population(7), 300);
    assert_eq!((genetic::Settings::default().population(5), genetic::Settings::default().population(6)), (50, 200));
    assert_eq!(annealing::Settings::wang2017().published_misfit(), Some(0.1));
    let problem = benchmark::su2021(3, Form::Maximum, Denominator::Target);
    let method = Method::Annealing(annealing::Settings::wang2017());
    let limits = Limits { misfit: Some(0.1), ..budget(20_000) };
    let (stop, _) = minimise(&problem, &method, &limits, 1, |x| Some(benchmark::surfaces(x)));
    assert_eq!(stop, Stop::Reached);
    // 24 individuals and 30 generations.
    let method = Method::Differential(differential::Settings::rcc2020());
    let (stop, state) = minimise(&problem, &method, &Limits::default(), 1, |x| Some(benchmark::surfaces(x)));
    assert_eq!((stop, state.evaluations), (Stop::Iterations, 24 * 31));
}

/// The stand-in for the simulation, scatter 4, 4 and 2.5 %: the full table is `cargo bench --bench optimisers`.
#[test]
fn the_surrogate_calibrates_through_scatter() {
    let mut errors = Vec::new();
    for set in 0..5 {
        errors.push(calibrated(set, 0, 28));
    }
    errors.sort_by(f64::total_cmp);
    assert!(errors[2] <= 0.02 && errors[4] <= 0.04, "{errors:?}");
    assert!(calibrated(1, 50, 12) <= 0.02);
}

/// True error of the recommended point after a number of runs, some of which fail.
fn calibrated(set: usize, earlier: usize, runs: usize) -> f64 {
    let problem = benchmark::su2021(set, Form::Sum, Denominator::Target);
    let mut noise = Stream::new(set as u64, "test noise", 0);
    let known = |_| {
        let point = problem.domain.natural(&problem.domain.sample(&mut noise));
        let responses = Some(benchmark::noisy(&point, &mut noise));
        Run { point, responses }
    };
    let knowledge = Knowledge { earlier: (0..earlier).map(known).collect(), trend: None };
    let settings = surrogate::Settings { tolerance: 0.0, ..Default::default() };
    let method = Method::Surrogate(settings);
    let mut search = Search::new(&problem, &method, &budget(runs), set as u64, &knowledge);
    let mut noise = Stream::new(set as u64, "own noise", 0);
    while search.stop().is_none() {
        let answers: Vec<_> = search.ask().iter().map(|x| Some(benchmark::noisy(x, &mut noise))).collect();
        search.tell(&answers);
    }
    let recommended = search.state().recommended.expect("a recommendation");
    assert!(recommended.responses.iter().all(|y| y.low < y.mean && y.mean < y.high));
    benchmark::true_error(&problem.domain.natural(&recommended.point), set)
}

/// Where a corner of the box always fails the surrogate learns to stay out of it.
#[test]
fn failed_runs_tell_the_surrogate_where_not_to_go() {
    let problem = benchmark::su2021(1, Form::Sum, Denominator::Target);
    let mut failed = Vec::new();
    let method = Method::Surrogate(surrogate::Settings { tolerance: 0.0, ..Default::default() });
    let (_, state) = minimise(&problem, &method, &budget(40), 2, |x| {
        let fails = x[3] > 20.0;
        failed.push(fails);
        (!fails).then(|| benchmark::surfaces(x))
    });
    let late = failed[24..].iter().filter(|f| **f).count();
    assert!(late <= 4, "{failed:?}");
    let point = problem.domain.natural(&state.recommended.expect("a recommendation").point);
    assert!(point[3] <= 21.0 && benchmark::true_error(&point, 1) < 0.02, "{point:?}");
}

/// Surfaces that are 10 % off are put right by a few runs.
#[test]
fn a_belief_is_corrected_by_runs() {
    let problem = benchmark::su2021(4, Form::Sum, Denominator::Target);
    let belief = |x: &[f64]| Some(benchmark::surfaces(x).iter().zip([1.1, 0.92, 1.05]).map(|(y, f)| y * f).collect());
    let knowledge = Knowledge { earlier: Vec::new(), trend: Some(std::sync::Arc::new(belief)) };
    let method = Method::Surrogate(surrogate::Settings { tolerance: 0.0, ..Default::default() });
    let mut search = Search::new(&problem, &method, &budget(12), 1, &knowledge);
    let start = search.state().recommended.expect("the belief's own").point;
    assert!(benchmark::true_error(&problem.domain.natural(&start), 4) > 0.05);
    let mut noise = Stream::new(1, "belief noise", 0);
    while search.stop().is_none() {
        let answers: Vec<_> = search.ask().iter().map(|x| Some(benchmark::noisy(x, &mut noise))).collect();
        search.tell(&answers);
    }
    let end = search.state().recommended.expect("a recommendation").point;
    let error = benchmark::true_error(&problem.domain.natural(&end), 4);
    assert!(error < 0.03, "{error}");
}
