//! The chance to see an effect of a given size.
//!
//! A hypothesis on d₁ coefficients is tested by F on d₁ and d₂ degrees of freedom at level α. If it is false, F follows
//! the non-central distribution with λ = (effect in units of its standard error)², and the power is P(F' > F_α). The
//! distribution is its Poisson mixture (Johnson, Kotz & Balakrishnan 1995, *Continuous Univariate Distributions 2*):
//!
//! P(F' > f) = Σ_j e^(−λ/2)(λ/2)^j / j! · I_(1−x)(d₂/2, d₁/2 + j), x = d₁f / (d₁f + d₂),
//!
//! each term of which is a central F tail. The *effect* is the change of the mean response from −1 to +1 of a factor
//! (twice its coefficient; for squares and products likewise twice theirs). For a factor of s levels as classes (d₁ = s
//! − 1) it is the difference between any two of its levels, the others being such that the power is least: λ = effect²
//! / (σ² var(τ̂_a − τ̂_b)) for the worst pair (a, b).

use super::model::{Kind, Model, ModelReport};
use math::distribution::f_upper;
use math::elementary::{exp, ln};
use serde::{Deserialize, Serialize};

/// Effect, noise and level of the power.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Question {
    /// Size of the effect, in the unit of the response.
    pub effect: f64,
    /// Standard deviation of one run, same unit.
    pub noise: f64,
    /// Level of the test.
    pub alpha: f64,
}

impl Default for Question {
    /// An effect of two standard deviations at 0.05.
    fn default() -> Self {
        Self { effect: 2.0, noise: 1.0, alpha: 0.05 }
    }
}

/// Power for one term or factor.
#[derive(Clone, Debug, PartialEq)]
pub struct Power {
    /// Term, or factor for classes.
    pub term: String,
    /// Degrees of freedom of the hypothesis.
    pub df: usize,
    /// Non-centrality of an effect of one standard deviation.
    pub unit_noncentrality: f64,
    /// The chance to see the effect.
    pub power: f64,
    /// The effect, in standard deviations, that is seen with power 0.8.
    pub detectable: f64,
}

/// P(F' > f) for the non-central F distribution on `df1`, `df2` degrees of freedom and non-centrality `lambda`.
pub fn noncentral_f_upper(f: f64, df1: f64, df2: f64, lambda: f64) -> f64 {
    if lambda <= 0.0 {
        return f_upper(f, df1, df2);
    }
    let half = 0.5 * lambda;
    let weight = |j: f64| exp(j * ln(half) - half - libm::lgamma(j + 1.0));
    let tail = |j: f64| f_upper(f * df1 / (df1 + 2.0 * j), df1 + 2.0 * j, df2);
    let middle = half.floor();
    let mut sum = 0.0;
    let mut j = middle;
    while j >= 0.0 && weight(j) > 1e-18 {
        sum += weight(j) * tail(j);
        j -= 1.0;
    }
    j = middle + 1.0;
    while weight(j) > 1e-18 {
        sum += weight(j) * tail(j);
        j += 1.0;
    }
    sum.min(1.0)
}

/// The f with P(F > f) = `alpha`.
pub fn f_critical(alpha: f64, df1: f64, df2: f64) -> f64 {
    let (mut low, mut high) = (0.0, 1.0);
    while f_upper(high, df1, df2) > alpha && high < 1e300 {
        (low, high) = (high, 2.0 * high);
    }
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if f_upper(middle, df1, df2) > alpha { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

/// Beyond this non-centrality the mixture has too many terms, and the numerator of F' is as good as constant.
const LARGE: f64 = 1e5;

fn power(df1: f64, df2: f64, lambda: f64, critical: f64) -> f64 {
    if lambda <= LARGE {
        return noncentral_f_upper(critical, df1, df2, lambda);
    }
    // F' = ((λ + d₁) / d₁) / (χ² / d₂), and F on (∞, d₂) is d₂ / χ²
    f_upper(critical * df1 / (lambda + df1), 1e9, df2)
}

/// Power of every term of an estimable model (of every factor for [`Kind::Levels`]).
pub(super) fn powers(model: &Model, report: &ModelReport, question: Question) -> Vec<Power> {
    let df2 = report.residual_df as f64;
    let mut found: Vec<(String, usize, f64)> = Vec::new();
    if model.kind == Kind::Levels {
        let factors = model.factor.iter().flatten().max().map_or(0, |f| f + 1);
        for f in 0..factors {
            let terms: Vec<usize> = (0..model.terms.len()).filter(|&t| model.factor[t] == Some(f)).collect();
            if let Some(&first) = terms.first() {
                let name = model.terms[first].rsplit_once('[').map_or("", |(name, _)| name);
                found.push((name.to_string(), terms.len(), 1.0 / worst_variance(model, &terms)));
            }
        }
    } else {
        for t in 1..model.terms.len() {
            // the effect is twice the coefficient
            found.push((model.terms[t].clone(), 1, 0.25 / model.covariance(t, t)));
        }
    }
    let size = question.effect / question.noise;
    let mut tests: Vec<(usize, f64, f64)> = Vec::new();
    let answer = |(term, df, unit): (String, usize, f64)| {
        let df1 = df as f64;
        let known = tests.iter().find(|(of, _, _)| *of == df).copied();
        let (_, critical, seen) = known.unwrap_or_else(|| {
            let critical = f_critical(question.alpha, df1, df2);
            let test = (df, critical, needed(df1, df2, critical));
            tests.push(test);
            test
        });
        let power = power(df1, df2, unit * size * size, critical);
        Power { term, df, unit_noncentrality: unit, power, detectable: (seen / unit).sqrt() }
    };
    found.into_iter().map(answer).collect()
}

/// Largest variance of the difference of two levels, in σ²; the first level has no term of its own.
fn worst_variance(model: &Model, terms: &[usize]) -> f64 {
    let against_first = terms.iter().map(|&a| model.covariance(a, a));
    let pairs = terms.iter().enumerate().flat_map(|(i, &a)| terms[..i].iter().map(move |&b| (a, b)));
    let between = pairs.map(|(a, b)| model.covariance(a, a) + model.covariance(b, b) - 2.0 * model.covariance(a, b));
    against_first.chain(between).fold(0.0, f64::max)
}

/// The non-centrality that has power 0.8.
fn needed(df1: f64, df2: f64, critical: f64) -> f64 {
    let enough = |lambda: f64| power(df1, df2, lambda, critical) >= 0.8;
    let (mut low, mut high) = (0.0, 1.0);
    while !enough(high) && high < 1e300 {
        (low, high) = (high, 2.0 * high);
    }
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if enough(middle) { high = middle } else { low = middle }
    }
    high
}
