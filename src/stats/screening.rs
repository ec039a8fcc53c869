//! Screening of two-level designs, with or without replicates: which few effects exceed the noise.
//!
//! The effect of a term is twice its coefficient in ±1 units: the mean response at the high level minus that at the low
//! one. Without replicates the noise is judged from the effects themselves, most of which are assumed to be zero:
//! Lenth's pseudo standard error is `PSE = 1.5 · median{|e| : |e| < 2.5 s₀}` with `s₀ = 1.5 · median |e|`; with
//! `d = m/3` for `m` effects, the margin of error is `ME = t(1 − α/2; d) · PSE` and the simultaneous one
//! `SME = t(γ; d) · PSE`, `γ = (1 + (1 − α)^(1/m))/2`.
//!
//! With degrees of freedom for the error (centre points, replicates, fewer terms than runs) the standardised effect is
//! `t = e/SE(e)`; it is active at the level α when `|t|` exceeds the critical value `t(1 − α/2; ν)`.
//!
//! Plot positions of the i-th smallest of m: normal `Φ⁻¹((i − ½)/m)`, half-normal `Φ⁻¹(½ + ½(i − ½)/m)`.
//!
//! Sources: Lenth 1989, doi:10.1080/00401706.1989.10488595; Daniel 1959, doi:10.1080/00401706.1959.10489866.

use super::error::{Fault, Faults};
use super::regression::{self, Regression, regress};
use super::sample::Sample;
use super::terms::Term;
use math::distribution::{normal_quantile, t_for_coverage, t_for_tail};
use math::elementary::{exp, ln_1p};
use serde::{Deserialize, Serialize};

/// One effect.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Effect {
    /// The term.
    pub term: String,
    /// Mean response at the high level minus that at the low one.
    pub effect: f64,
    /// Its coefficient in ±1 units: half of the effect.
    pub coefficient: f64,
    /// Standard error of the effect, where the design leaves degrees of freedom for it.
    pub std_error: Option<f64>,
    /// Two-sided tail probability with that standard error.
    pub p: Option<f64>,
    /// Standardised effect: the effect over its standard error.
    pub standardized: Option<f64>,
    /// The standardised effect exceeds the critical value; `None` without a standard error.
    pub significant: Option<bool>,
    /// Effect over Lenth's pseudo standard error.
    pub lenth_t: Option<f64>,
    /// 1 for the largest in size: the order of a Pareto chart.
    pub rank: usize,
    /// Share of the sum of squared effects.
    pub share: f64,
    /// Share of this effect and all larger ones.
    pub cumulative: f64,
    /// Abscissa in the normal plot.
    pub normal: f64,
    /// Abscissa in the half-normal plot.
    pub half_normal: f64,
    /// Beyond the margin of error.
    pub beyond_margin: bool,
    /// Beyond the simultaneous margin of error.
    pub beyond_simultaneous: bool,
}

/// The screening of one response.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Screening {
    /// The response.
    pub response: String,
    /// Effects in the order of the terms.
    pub effects: Vec<Effect>,
    /// Lenth's pseudo standard error; `None` with fewer than three effects or when most effects are zero.
    pub pse: Option<f64>,
    /// Margin of error.
    pub margin: Option<f64>,
    /// Simultaneous margin of error.
    pub simultaneous: Option<f64>,
    /// Critical value of the standardised effects; `None` without degrees of freedom for the error.
    pub critical: Option<f64>,
    /// The fit in ±1 units that the effects come from.
    pub regression: Regression,
}

/// Effects of `terms` (the constant is added when it is missing) on one response, judged at level `alpha`.
///
/// # Errors
/// All faults of the table and the model; factors of the terms must have two levels.
pub fn screen(sample: &Sample, response: &str, terms: &[Term], alpha: f64) -> Result<Screening, Faults> {
    if !(alpha > 0.0 && alpha < 1.0) {
        return Err(Fault::Probability { what: "screening level", value: alpha }.into());
    }
    Faults::none_in(two_levels(sample, terms))?;
    let mut model = vec![Term::constant()];
    model.extend(terms.iter().filter(|t| t.degree() > 0).cloned());
    let fitted = regress(&in_signs(sample), response, &model, &regression::Settings::default())?;
    let size: Vec<f64> = fitted.natural[1..].iter().map(|c| 2.0 * c.estimate.abs()).collect();
    let largest = fitted.residuals.iter().fold(0.0, |most: f64, r| most.max(r.observed.abs()));
    let pse = pseudo_error(&size, ROUNDING * largest);
    let m = size.len() as f64;
    let freedom = m / 3.0;
    let margin = pse.map(|pse| pse * t_for_coverage(1.0 - alpha, freedom));
    let all_below = exp(ln_1p(-alpha) / m);
    let simultaneous = pse.map(|pse| pse * t_for_tail(1.0 - all_below, freedom));
    let freedom_of_error = fitted.fit.df_residual;
    let critical = (freedom_of_error > 0).then(|| t_for_coverage(1.0 - alpha, freedom_of_error as f64));
    let effects = (0..size.len()).map(|i| {
        let own = &fitted.natural[i + 1];
        let rank = (size.iter().filter(|s| **s < size[i]).count() + size[..i].iter().filter(|s| **s == size[i]).count())
            as f64;
        let signed = |c: &regression::Coefficient| c.estimate < own.estimate;
        let below = fitted.natural[1..].iter().filter(|c| signed(c)).count()
            + fitted.natural[1..=i].iter().filter(|c| c.estimate == own.estimate).count();
        let squares = |least: f64| size.iter().filter(|s| **s >= least).fold(0.0, |sum, s| sum + s * s);
        Effect {
            term: own.term.clone(),
            effect: 2.0 * own.estimate,
            coefficient: own.estimate,
            std_error: own.std_error.map(|e| 2.0 * e),
            p: own.p,
            standardized: own.t,
            significant: own.t.zip(critical).map(|(t, limit)| t.abs() > limit),
            lenth_t: pse.map(|pse| 2.0 * own.estimate / pse),
            rank: size.len() - rank as usize,
            share: size[i] * size[i] / squares(0.0),
            cumulative: squares(size[i]) / squares(0.0),
            normal: normal_quantile((below as f64 + 0.5) / m),
            half_normal: normal_quantile(0.5 + 0.5 * (rank + 0.5) / m),
            beyond_margin: margin.is_some_and(|limit| size[i] > limit),
            beyond_simultaneous: simultaneous.is_some_and(|limit| size[i] > limit),
        }
    });
    Ok(Screening {
        response: response.into(),
        effects: effects.collect(),
        pse,
        margin,
        simultaneous,
        critical,
        regression: fitted,
    })
}

/// Factors of the terms that do not have exactly two levels.
fn two_levels(sample: &Sample, terms: &[Term]) -> Vec<Fault> {
    let used = |f: &&super::sample::Factor| terms.iter().any(|t| t.power_of(&f.name) > 0);
    let fault = |f: &super::sample::Factor| {
        let levels = f.all_levels().len();
        (levels != 2).then(|| Fault::NotTwoLevels { factor: f.name.clone(), levels })
    };
    sample.factors.iter().filter(used).filter_map(fault).collect()
}

/// The same table with every two-level factor as −1 and +1.
fn in_signs(sample: &Sample) -> Sample {
    let mut signs = sample.clone();
    for factor in &mut signs.factors {
        if let [low, _] = factor.all_levels()[..] {
            factor.values.iter_mut().for_each(|v| *v = if *v == low { -1.0 } else { 1.0 });
            factor.levels = vec![-1.0, 1.0];
            factor.coding = None;
            factor.labels = Vec::new();
        }
    }
    signs
}

/// Effects smaller than this share of the largest response are rounding errors of zero.
const ROUNDING: f64 = 1e-15;

/// Lenth's pseudo standard error of absolute effects, those up to `nothing` taken as zero.
fn pseudo_error(sizes: &[f64], nothing: f64) -> Option<f64> {
    if sizes.len() < 3 {
        return None;
    }
    let first = 1.5 * median(sizes.to_vec());
    let rest: Vec<f64> = sizes.iter().copied().filter(|s| *s < 2.5 * first).collect();
    (first > nothing).then(|| 1.5 * median(rest))
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    let half = values.len() / 2;
    if values.len() % 2 == 1 { values[half] } else { 0.5 * (values[half - 1] + values[half]) }
}
