//! Linear regression and second-order response surfaces, in natural and coded units.
//!
//! A model is a list of polynomial [`Term`]s. When the list is hierarchical (with a term it holds all that divide it),
//! the fit is made in coded units `u = (x − centre)/half`, in which factors with far-apart units do not spoil each
//! other, and the natural coefficients follow exactly by expanding the products: `b = S bᵤ`, with standard errors
//! from the rows of `S R⁻¹`. A model that is not hierarchical depends on the origin of its factors; it is fitted in
//! natural units alone.
//!
//! A factor with a logarithmic [`Scale`] enters by ln x everywhere: in coded units, whose −1 and +1 are the logarithms of its
//! ends, and in natural coefficients, which are per unit of ln x. A constant and `x` are then `y = a + b ln x`.
//!
//! A factor whose levels are names enters by dummy coding, one term per level but the first ([`super::categories`]).
//!
//! Variance inflation of a coefficient: the squared norm of its row of `R⁻¹` times the squared norm of its column about
//! the mean (about zero in a model without constant).
//!
//! Source: Myers, Montgomery and Anderson-Cook, Response Surface Methodology, 4th ed., 2016, chapters 2 and 6.

use super::categories::spread;
use super::columns::{Column, Matrix, Part};
use super::diagnostics::{Residual, residuals};
use super::error::{Fault, Faults};
use super::fit::{Estimate, Fit, PureError, Solution, in_pairs, squares_about_mean};
use super::model::{Axis, Model};
use super::number::{Real, Twofold};
use super::sample::{Sample, Usable};
use super::selection::{Selection, Step, select};
use super::terms::Term;
use math::scale::Scale;
use serde::{Deserialize, Serialize};

/// Settings of a regression.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// Level of the outlier test, after Bonferroni's correction.
    pub outlier_alpha: f64,
    /// How terms are chosen; `None` takes them all.
    pub selection: Option<Selection>,
}

impl Default for Settings {
    fn default() -> Self {
        Self { outlier_alpha: 0.05, selection: None }
    }
}

/// One coefficient of a fitted model.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Coefficient {
    /// Its term.
    pub term: String,
    /// The estimate, in units of the response per unit of the term.
    pub estimate: f64,
    /// Its standard error; `None` without residual degrees of freedom.
    pub std_error: Option<f64>,
    /// Estimate over standard error.
    pub t: Option<f64>,
    /// Two-sided tail probability of `t`.
    pub p: Option<f64>,
    /// Variance inflation factor; `None` for the constant.
    pub vif: Option<f64>,
}

/// A fitted polynomial.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Regression {
    /// Coefficients in natural units.
    pub natural: Vec<Coefficient>,
    /// Coefficients in coded units; empty when the model is not hierarchical.
    pub coded: Vec<Coefficient>,
    /// Quality of the fit.
    pub fit: Fit,
    /// Every usable row.
    pub residuals: Vec<Residual>,
    /// What predicts.
    pub model: Model,
    /// The steps of term selection, in order.
    pub steps: Vec<Step>,
}

/// Fits `terms` to one response.
///
/// # Errors
/// All faults of the table and the model: unknown names, too few rows, a constant response or factor, aliased terms.
pub fn regress(sample: &Sample, response: &str, terms: &[Term], settings: &Settings) -> Result<Regression, Faults> {
    sample.check()?;
    let index = sample.response(response)?;
    let unknown = check_terms(sample, terms);
    Faults::none_in(unknown)?;
    let (natural, terms) = spread(sample, terms)?;
    let (scaled, terms) = (on_scales(&natural, &terms), terms.as_slice());
    let (sample, natural) = (scaled.as_ref().unwrap_or(&natural), &natural);
    let usable = sample.usable(index);
    let mut faults = without_logarithm(natural, &usable, terms);
    faults.extend(flat_factors(natural, &usable, terms));
    faults.extend(sample.check_response(index, &usable, terms.len()));
    if !(settings.outlier_alpha > 0.0 && settings.outlier_alpha < 1.0) {
        faults.push(Fault::Probability { what: "outlier level", value: settings.outlier_alpha });
    }
    if let Some(selection) = &settings.selection {
        faults.extend(selection.check());
    }
    Faults::none_in(faults)?;
    let job = Job { sample, natural, usable: &usable, response, settings };
    let fitted = if in_pairs(&usable, terms.len()) { job.fit::<Twofold>(terms) } else { job.fit::<f64>(terms) };
    fitted.map_err(Faults)
}

/// Unknown factors, doubled terms, an empty model.
fn check_terms(sample: &Sample, terms: &[Term]) -> Vec<Fault> {
    let mut faults = Vec::new();
    let mut unknown: Vec<&str> = Vec::new();
    for name in terms.iter().flat_map(Term::factors) {
        if let Err(fault) = sample.factor(name)
            && !unknown.contains(&name)
        {
            unknown.push(name);
            faults.push(fault);
        }
    }
    if terms.is_empty() {
        faults.push(Fault::Model { problem: "has no terms".into() });
    }
    for (i, term) in terms.iter().enumerate() {
        if terms[..i].iter().any(|other| other.same(term)) {
            faults.push(Fault::Model { problem: format!("has `{term}` twice") });
        }
    }
    faults
}

/// The table with logarithms in index of the values of factors that a model takes so; `None` when it has none.
fn on_scales(sample: &Sample, terms: &[Term]) -> Option<Sample> {
    let logs: Vec<usize> =
        used_factors(sample, terms).into_iter().filter(|&f| sample.factors[f].scale == Scale::Log).collect();
    let mut scaled = (!logs.is_empty()).then(|| sample.clone())?;
    for factor in logs {
        scaled.factors[factor].values.iter_mut().for_each(|value| *value = Scale::Log.of(*value));
    }
    Some(scaled)
}

/// Values that have no logarithm where a model takes it.
fn without_logarithm(sample: &Sample, usable: &Usable, terms: &[Term]) -> Vec<Fault> {
    let first = |&f: &usize| {
        let factor = &sample.factors[f];
        let bad = |row: &&usize| factor.scale == Scale::Log && !(factor.values[**row] > 0.0);
        let row = *usable.rows.iter().find(bad)?;
        Some(Fault::NotPositive { factor: factor.name.clone(), row: row + 1, value: factor.values[row] })
    };
    used_factors(sample, terms).iter().filter_map(first).collect()
}

/// Factors of the model that never change in the usable rows. Through the origin one level gives a slope: what is
/// proportional needs no second one, and two such factors are aliased.
fn flat_factors(sample: &Sample, usable: &Usable, terms: &[Term]) -> Vec<Fault> {
    if terms.iter().all(|term| term.degree() > 0) {
        return Vec::new();
    }
    let flat = |&f: &usize| {
        let factor = &sample.factors[f];
        let mut values = usable.rows.iter().map(|&row| factor.values[row]);
        let first = values.next()?;
        values
            .all(|v| v == first)
            .then(|| Fault::OneLevel { factor: factor.name.clone(), value: factor.level_text(first) })
    };
    used_factors(sample, terms).iter().filter_map(flat).collect()
}

/// The factors that occur in the terms, in the order of the table.
fn used_factors(sample: &Sample, terms: &[Term]) -> Vec<usize> {
    let used = |f: &usize| terms.iter().any(|t| t.power_of(&sample.factors[*f].name) > 0);
    (0..sample.factors.len()).filter(used).collect()
}

/// Whether every term comes with all that divide it.
pub(crate) fn is_hierarchical(terms: &[Term]) -> bool {
    terms.iter().flat_map(Term::parents).all(|parent| terms.iter().any(|t| t.same(&parent)))
}

/// The constant first; the reduction relies on it.
fn constant_first(terms: &[Term]) -> Vec<Term> {
    let (constant, rest): (Vec<Term>, Vec<Term>) = terms.iter().cloned().partition(|t| t.degree() == 0);
    constant.into_iter().chain(rest).collect()
}

/// One response to be fitted.
struct Job<'a> {
    /// The table with logarithms where a factor has such a scale.
    sample: &'a Sample,
    /// The table as it was given.
    natural: &'a Sample,
    usable: &'a Usable,
    response: &'a str,
    settings: &'a Settings,
}

impl Job<'_> {
    fn fit<T: Real>(&self, terms: &[Term]) -> Result<Regression, Vec<Fault>> {
        let mut terms = constant_first(terms);
        let used = used_factors(self.sample, &terms);
        let coded = is_hierarchical(&terms);
        let axes: Vec<Axis> = used.iter().map(|&f| self.axis(f, coded)).collect();
        let columns = terms.iter().map(|t| column(t, &used, &axes)).collect();
        let mut matrix = Matrix::new(self.sample, self.usable, columns, &[]);
        let mut solution = Solution::<T>::of(&matrix, self.response, |i| terms[i].to_string())?;
        let mut steps = Vec::new();
        if let Some(selection) = &self.settings.selection {
            let chosen;
            (chosen, steps) = select(&solution, &terms, selection);
            solution = solution.with_terms(&chosen);
            terms = chosen.iter().map(|&i| terms[i].clone()).collect();
            matrix.columns = chosen.iter().map(|&i| std::mem::take(&mut matrix.columns[i])).collect();
        }
        let alpha = self.settings.outlier_alpha;
        let (rows, press) = residuals(&matrix, &solution, &self.usable.rows, &self.usable.values, alpha);
        let pure = PureError::of(self.sample, self.usable, &used_factors(self.sample, &terms));
        let about_mean = (!solution.constant).then(|| squares_about_mean(self.sample, self.usable));
        let fit = Fit::of(&solution, self.response, self.usable.missing, press, pure, about_mean);
        let model = Model::new(&solution, &axes, &terms, &rows);
        let own = own_coefficients(&solution, &terms);
        let (natural, coded) =
            if coded { (natural_coefficients(&solution, &axes, &terms), own) } else { (own, vec![]) };
        Ok(Regression { natural, coded, fit, residuals: rows, model, steps })
    }

    /// The coding of a factor and the range in which it was seen.
    fn axis(&self, factor: usize, coded: bool) -> Axis {
        let factor = &self.natural.factors[factor];
        let seen = self.usable.rows.iter().map(|&row| factor.values[row]);
        let low = seen.clone().fold(f64::INFINITY, f64::min);
        let high = seen.fold(f64::NEG_INFINITY, f64::max);
        let scale = factor.scale;
        let (minus, plus) = factor.coding.unwrap_or((low, high));
        let (minus, plus) = (scale.of(minus), scale.of(plus));
        let (centre, half) = if coded { (0.5 * (minus + plus), 0.5 * (plus - minus)) } else { (0.0, 1.0) };
        Axis { name: factor.name.clone(), scale, centre, half, low, high }
    }
}

/// The product column of a term on coded axes.
fn column(term: &Term, used: &[usize], axes: &[Axis]) -> Column {
    let part = |(axis, &factor): (&Axis, &usize)| {
        let power = term.power_of(&axis.name);
        (power > 0).then_some(Part::Power { factor, power, centre: axis.centre, half: axis.half })
    };
    axes.iter().zip(used).filter_map(part).collect()
}

/// Coefficients in the units of the fit.
fn own_coefficients<T: Real>(solution: &Solution<T>, terms: &[Term]) -> Vec<Coefficient> {
    let about = usize::from(solution.constant);
    let vif = |i: usize| {
        let inflation = solution.relative_error(i) * solution.triangle.column_norm(i, about);
        (terms[i].degree() > 0).then(|| (inflation * inflation).value())
    };
    (0..terms.len()).map(|i| with_term(&terms[i], solution.coefficient(i), vif(i))).collect()
}

fn with_term(term: &Term, e: Estimate, vif: Option<f64>) -> Coefficient {
    Coefficient { term: term.to_string(), estimate: e.estimate, std_error: e.std_error, t: e.t, p: e.p, vif }
}

/// Coefficients in natural units of a fit in coded units.
fn natural_coefficients<T: Real>(solution: &Solution<T>, axes: &[Axis], terms: &[Term]) -> Vec<Coefficient> {
    let count = terms.len();
    let to_natural: Vec<Vec<(usize, T)>> = terms.iter().map(|t| expand(t, axes, terms, Axis::of_coded)).collect();
    let mut estimates = vec![T::zero(); count];
    let mut errors = vec![T::zero(); count * count];
    for (j, shares) in to_natural.iter().enumerate() {
        for &(i, share) in shares {
            estimates[i] = estimates[i] + share * solution.coefficients[j];
            let row = &solution.inverse[j * count..(j + 1) * count];
            T::add_multiple(&mut errors[i * count..(i + 1) * count], share, row);
        }
    }
    let about = usize::from(solution.constant);
    let natural = |i: usize| {
        let row = &errors[i * count..(i + 1) * count];
        let relative = T::dot(row, row).sqrt();
        let estimate = Estimate::new(estimates[i], solution.deviation().map(|s| s * relative), solution.df_residual());
        let vif = (terms[i].degree() > 0).then(|| {
            let inflation = relative * natural_norm(solution, axes, terms, i, about);
            (inflation * inflation).value()
        });
        with_term(&terms[i], estimate, vif)
    };
    (0..count).map(natural).collect()
}

/// Norm about the mean of the column of a term in natural units, from the triangle in coded units.
fn natural_norm<T: Real>(solution: &Solution<T>, axes: &[Axis], terms: &[Term], i: usize, about: usize) -> T {
    let shares = expand::<T>(&terms[i], axes, terms, Axis::of_natural);
    let square = (about..terms.len()).fold(T::zero(), |sum, row| {
        let of_row = |s, &(j, share): &(usize, T)| if j >= row { s + share * solution.triangle.at(row, j) } else { s };
        let entry = shares.iter().fold(T::zero(), of_row);
        sum + entry * entry
    });
    square.sqrt()
}

/// A term after a linear substitution on every axis, as shares of the model's terms. `line` gives the constant and the
/// slope of the substitution on an axis.
fn expand<T: Real>(term: &Term, axes: &[Axis], terms: &[Term], line: fn(&Axis) -> (T, T)) -> Vec<(usize, T)> {
    let mut products = vec![(Vec::<u32>::new(), T::from(1.0))];
    for axis in axes {
        let (constant, slope) = line(axis);
        let powers = binomial(term.power_of(&axis.name), constant, slope);
        let grow = |(done, share): &(Vec<u32>, T)| {
            let longer = |(k, &factor): (usize, &T)| {
                let mut all = done.clone();
                all.push(k as u32);
                (all, *share * factor)
            };
            powers.iter().enumerate().map(longer).collect::<Vec<_>>()
        };
        products = products.iter().flat_map(grow).collect();
    }
    let index = |powers: &[u32]| {
        let fits = |t: &Term| axes.iter().zip(powers).all(|(axis, &power)| t.power_of(&axis.name) == power);
        terms.iter().position(fits).unwrap_or_else(|| panic!("BUG: a hierarchical model lacks a divisor of `{term}`"))
    };
    products.iter().map(|(powers, share)| (index(powers), *share)).collect()
}

/// Coefficients of `(constant + slope·x)^power`, from the constant up.
fn binomial<T: Real>(power: u32, constant: T, slope: T) -> Vec<T> {
    let mut coefficients = vec![T::from(1.0)];
    for _ in 0..power {
        let mut next = vec![T::zero(); coefficients.len() + 1];
        for (k, &c) in coefficients.iter().enumerate() {
            next[k] = next[k] + c * constant;
            next[k + 1] = next[k + 1] + c * slope;
        }
        coefficients = next;
    }
    coefficients
}
