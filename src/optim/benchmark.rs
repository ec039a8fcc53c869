//! Problems with known answers: standard functions, and a stand-in for the simulation.

use super::Problem;
use super::constraint::{Domain, Factor};
use super::misfit::{Denominator, Form, Misfit, Target};
use math::elementary::{cos, exp};
use math::random::Stream;

/// The names of the methods, in the order of the tables.
pub(crate) const METHODS: [&str; 5] = ["genetic", "annealing", "differential", "cma-es", "surrogate"];

/// A standard function: name, range of every coordinate, value (0 at the minimum).
pub(crate) struct Standard {
    pub(crate) name: &'static str,
    pub(crate) range: (f64, f64),
    pub(crate) value: fn(&[f64]) -> f64,
}

/// The four functions of the comparison.
pub(crate) const STANDARD: [Standard; 4] = [
    Standard { name: "sphere", range: (-5.12, 5.12), value: sphere },
    Standard { name: "rosenbrock", range: (-2.048, 2.048), value: rosenbrock },
    Standard { name: "rastrigin", range: (-5.12, 5.12), value: rastrigin },
    Standard { name: "ackley", range: (-32.768, 32.768), value: ackley },
];

fn sphere(x: &[f64]) -> f64 {
    x.iter().map(|x| x * x).sum()
}

fn rosenbrock(x: &[f64]) -> f64 {
    x.windows(2).map(|w| 100.0 * (w[1] - w[0] * w[0]).powi(2) + (1.0 - w[0]).powi(2)).sum()
}

fn rastrigin(x: &[f64]) -> f64 {
    x.iter().map(|x| x * x + 10.0 - 10.0 * cos(std::f64::consts::TAU * x)).sum()
}

fn ackley(x: &[f64]) -> f64 {
    let n = x.len() as f64;
    let square = x.iter().map(|x| x * x).sum::<f64>() / n;
    let wave = x.iter().map(|x| cos(std::f64::consts::TAU * x)).sum::<f64>() / n;
    20.0 - 20.0 * exp(-0.2 * square.sqrt()) + std::f64::consts::E - exp(wave)
}

/// A box of equal ranges around no particular centre, and one response whose misfit is the value itself.
pub(crate) fn standard(function: &Standard, dimension: usize) -> Problem {
    let (low, high) = function.range;
    let factor = |i: usize| Factor::linear(&format!("x{i}"), low, high);
    let domain = Domain::new((0..dimension).map(factor).collect(), &[]).expect("a box");
    // |y + 1 − 1| / 1 = y: the target must not be zero.
    let target = Target::exactly("value", 1.0, 1.0);
    let misfit = Misfit::new(vec![target], Form::Sum, Denominator::Target).expect("a target");
    Problem { domain, misfit, start: None }
}

/// The five target sets of Su et al. 2021, section 6.3: peak strength MPa, modulus GPa, Poisson's ratio.
pub(crate) const TARGETS: [[f64; 3]; 5] =
    [[59.67, 32.68, 0.201], [42.67, 26.78, 0.209], [36.54, 25.66, 0.218], [47.67, 21.54, 0.222], [43.60, 24.67, 0.222]];

/// Scatter of a single run of the stand-in: Su et al. 2021, Table 15.
pub(crate) const SCATTER: [f64; 3] = [0.04, 0.04, 0.025];

/// The calibration problem of Su et al. 2021, eq. 18, for one of their target sets.
pub(crate) fn su2021(set: usize, form: Form, denominator: Denominator) -> Problem {
    let ranges = [
        ("Ec", 10.0, 30.0),
        ("kn_ks", 1.0, 4.0),
        ("sigma_c", 10.0, 30.0),
        ("tau_c", 10.0, 30.0),
        ("mu", 0.5, 1.5),
        ("Ecj", 5.0, 15.0),
        ("kn_ks_j", 1.0, 4.0),
    ];
    let factor = |(name, low, high): (&str, f64, f64)| Factor::linear(name, low, high);
    let targets = ["UCS", "E", "nu"].iter().zip(TARGETS[set]);
    let targets = targets.map(|(name, value)| Target::exactly(name, value, 1.0)).collect();
    Problem {
        domain: Domain::new(ranges.map(factor).to_vec(), &[]).expect("a box"),
        misfit: Misfit::new(targets, form, denominator).expect("targets"),
        start: None,
    }
}

/// Their second-order surfaces, Table 12.
pub(crate) fn surfaces(x: &[f64]) -> Vec<f64> {
    let [ec, k, s, t, mu, ej, kj] = x else { panic!("seven factors") };
    let ucs = -0.48 + 1.083 * s + 0.919 * t - 0.03138 * s * s - 0.03018 * t * t + 0.06602 * s * t;
    let e = 0.30 + 1.998 * ec - 3.647 * k + 4.71 * mu + 0.715 * ej - 0.396 * kj - 0.00771 * ec * ec + 0.7972 * k * k
        - 1.959 * mu * mu
        - 0.03420 * ej * ej
        + 0.0129 * kj * kj
        - 0.1492 * ec * k
        + 0.0491 * ec * mu
        + 0.02473 * ec * ej
        - 0.0286 * ec * kj
        - 0.388 * k * mu
        - 0.0611 * k * ej
        + 0.064 * k * kj
        + 0.010 * mu * ej
        + 0.155 * mu * kj
        + 0.0158 * ej * kj;
    let nu = 0.1499 - 0.00726 * ec + 0.1378 * k - 0.1582 * mu - 0.0057 * kj + 0.000134 * ec * ec - 0.01383 * k * k
        + 0.0555 * mu * mu
        + 0.00217 * kj * kj
        + 0.000133 * ec * k
        + 0.00005 * ec * mu
        + 0.000200 * ec * kj
        + 0.00733 * k * mu
        - 0.00122 * k * kj
        + 0.00067 * mu * kj;
    vec![ucs, e, nu]
}

/// One noisy run of the stand-in.
pub(crate) fn noisy(x: &[f64], random: &mut Stream) -> Vec<f64> {
    surfaces(x).into_iter().zip(SCATTER).map(|(y, cv)| y * (1.0 + cv * random.normal())).collect()
}

/// Largest relative deviation of the noise-free responses from the targets.
pub(crate) fn true_error(x: &[f64], set: usize) -> f64 {
    surfaces(x).iter().zip(TARGETS[set]).map(|(y, t)| (y / t - 1.0).abs()).fold(0.0, f64::max)
}
