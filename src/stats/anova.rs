//! Analysis of variance of designed experiments, balanced or not.
//!
//! Factors are categories (their levels), coded by sum-to-zero contrasts. Sums of squares of a term:
//! * type I: what it adds to the terms listed before it;
//! * type II: what it adds to all terms that do not contain it;
//! * type III: what it adds to all other terms (marginal means compared with equal weights).
//!
//! In a balanced design the three agree. Each is read off one orthogonal reduction with the term's columns last, as a sum
//! of squares, never as a difference of residual sums. `F = (SS/df)/(SSE/df_E)` with the residual, or the pure error of
//! replicates, below. Contribution: `η² = SS/SST`, `ω² = (SS − df·MSE)/(SST + MSE)`.
//!
//! Empty columns of an orthogonal table are factors like the others or, left out, part of the error. Weak terms may be
//! pooled into the error by name or by their p.
//!
//! Sources: Montgomery, Design and Analysis of Experiments, 9th ed., chapters 3, 5 and 15; Searle, Linear Models for
//! Unbalanced Data, 1987 (types); Olejnik and Algina 2003, doi:10.1037/1082-989X.8.4.434 (ω²).

use super::columns::{Column, Matrix, Part};
use super::diagnostics::{Residual, residuals};
use super::error::{Fault, Faults};
use super::fit::{Fit, PureError, Solution, in_pairs, ratio, squares_about_mean};
use super::number::{Real, Twofold};
use super::range::level_faults;
use super::sample::{Sample, Usable};
use math::distribution::f_upper;
use serde::{Deserialize, Serialize};

mod terms;
use terms::{Layout, chosen_terms};

/// Which sums of squares.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
pub enum Squares {
    /// In the order of the terms.
    I,
    /// After all terms that do not contain it.
    II,
    /// After all other terms.
    #[default]
    III,
}

/// Which scatter F divides by.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Error {
    /// What the model leaves over.
    #[default]
    Residual,
    /// The scatter of replicated runs.
    PureError,
}

/// Which two-way interactions are in the model.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Interactions {
    /// None.
    #[default]
    None,
    /// The named pairs; one that cannot be estimated is an error.
    Named(Vec<(String, String)>),
    /// Every pair that the rows can tell from the terms before it, as long as one degree of freedom is left.
    Estimable,
}

/// Settings of an analysis.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// Type of the sums of squares.
    pub squares: Squares,
    /// What F divides by.
    pub error: Error,
    /// Interactions in the model.
    pub interactions: Interactions,
    /// Factors that are left out and so counted as error: empty columns, weak factors.
    pub as_error: Vec<String>,
    /// Terms whose p exceeds this in the full model are pooled into the error, all at once.
    pub pool_above: Option<f64>,
    /// Level and word, any order; the smallest level that p does not exceed gives the word.
    pub significance: Vec<(f64, String)>,
    /// Level of the outlier test, after Bonferroni's correction.
    pub outlier_alpha: f64,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            squares: Squares::III,
            error: Error::Residual,
            interactions: Interactions::None,
            as_error: Vec::new(),
            pool_above: None,
            significance: vec![(0.01, "Highly significant".into()), (0.05, "Significant".into())],
            outlier_alpha: 0.05,
        }
    }
}

/// One line of the table of variance.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Line {
    /// A factor, `a*b`, `residual` or `total`.
    pub source: String,
    /// Degrees of freedom.
    pub df: usize,
    /// Sum of squares.
    pub ss: f64,
    /// Mean square.
    pub ms: Option<f64>,
    /// Ratio to the mean square of the error.
    pub f: Option<f64>,
    /// Its tail probability.
    pub p: Option<f64>,
    /// The word of the smallest level that `p` does not exceed, or `-`; empty without a test.
    pub significance: String,
    /// Share of the total sum of squares.
    pub eta2: Option<f64>,
    /// The same without what chance alone would give.
    pub omega2: Option<f64>,
}

/// The analysis of one response.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Anova {
    /// The response.
    pub response: String,
    /// Terms in order, then `residual`, then `total`.
    pub lines: Vec<Line>,
    /// Quality of the fit.
    pub fit: Fit,
    /// Every usable row.
    pub residuals: Vec<Residual>,
    /// Terms pooled into the error.
    pub pooled: Vec<String>,
    /// Interactions that the rows cannot tell apart, where all estimable ones were requested.
    pub not_estimable: Vec<String>,
}

impl Anova {
    /// Standard deviation of the F of a line when every response is rounded to multiples of `step`.
    ///
    /// Rounding errors are uniform with variance `step²/12`, and the gradient of F by the responses has the squared
    /// length `4F²(1/SS + 1/SSE)`, for the parts of the response in a term and in the residual are orthogonal.
    pub fn f_rounding(&self, line: &Line, step: f64) -> Option<f64> {
        let error = self.lines.iter().find(|l| l.source == "residual").filter(|l| l.ss > 0.0 && line.ss > 0.0)?;
        Some(line.f? * 2.0 * (1.0 / line.ss + 1.0 / error.ss).sqrt() * step / 12.0_f64.sqrt())
    }
}

/// Analyses every response.
///
/// # Errors
/// All faults of the table and the model: one-level factors, constant responses, too few rows, aliased terms, no
/// degrees of freedom for the error.
pub fn anova(sample: &Sample, settings: &Settings) -> Result<Vec<Anova>, Faults> {
    sample.check()?;
    Faults::none_in(settings_faults(sample, settings))?;
    let mut faults = Vec::new();
    let mut analyses = Vec::new();
    for (index, response) in sample.responses.iter().enumerate() {
        let job = Job { sample, settings, usable: &sample.usable(index), response: &response.name };
        match job.run(index) {
            Ok(analysis) => analyses.push(analysis),
            Err(found) => faults.extend(found),
        }
    }
    Faults::none_in(faults)?;
    Ok(analyses)
}

fn settings_faults(sample: &Sample, settings: &Settings) -> Vec<Fault> {
    let mut faults: Vec<Fault> = settings.as_error.iter().filter_map(|name| sample.factor(name).err()).collect();
    if let Interactions::Named(pairs) = &settings.interactions {
        faults.extend(pairs.iter().flat_map(|(a, b)| [a, b]).filter_map(|name| sample.factor(name).err()));
        let same = pairs.iter().filter(|(a, b)| a == b);
        faults.extend(same.map(|(a, b)| Fault::Model { problem: format!("has the interaction `{a}*{b}`") }));
    }
    let levels = settings.significance.iter().map(|(level, _)| ("significance level", *level));
    let levels = levels.chain(settings.pool_above.map(|p| ("pooling level", p)));
    for (what, value) in levels.chain([("outlier level", settings.outlier_alpha)]) {
        if !(value > 0.0 && value < 1.0) {
            faults.push(Fault::Probability { what, value });
        }
    }
    faults
}

/// One response to be analysed.
struct Job<'a> {
    sample: &'a Sample,
    settings: &'a Settings,
    usable: &'a Usable,
    response: &'a str,
}

impl Job<'_> {
    fn run(&self, index: usize) -> Result<Anova, Vec<Fault>> {
        let mut faults = level_faults(self.sample, self.usable, self.response);
        faults.extend(self.sample.check_response(index, self.usable, 2));
        if !faults.is_empty() {
            return Err(faults);
        }
        let (layout, not_estimable) = chosen_terms(self.sample, self.usable, self.settings);
        let first = self.fit(&layout)?;
        let mut analysis = match self.settings.pool_above {
            None => first,
            Some(limit) => {
                let weak = |line: &&Line| line.p.is_some_and(|p| p > limit);
                let pooled: Vec<String> = first.lines.iter().filter(weak).map(|l| l.source.clone()).collect();
                let mut again = self.fit(&layout.without(&pooled))?;
                again.pooled = pooled;
                again
            }
        };
        analysis.not_estimable = not_estimable;
        Ok(analysis)
    }

    fn fit(&self, layout: &Layout) -> Result<Anova, Vec<Fault>> {
        let (rows, columns) = (self.usable.rows.len(), layout.columns.len());
        let (response, missing) = (self.response.to_string(), self.usable.missing);
        if rows < columns {
            return Err(vec![Fault::TooFewRows { response, rows, missing, terms: columns }]);
        }
        if in_pairs(self.usable, columns) { self.fit_in::<Twofold>(layout) } else { self.fit_in::<f64>(layout) }
    }

    fn fit_in<T: Real>(&self, layout: &Layout) -> Result<Anova, Vec<Fault>> {
        let matrix = Matrix::new(self.sample, self.usable, layout.columns.clone(), &layout.levels);
        let solution = Solution::<T>::of(&matrix, self.response, |column| layout.name_of(column))?;
        let pure = PureError::<T>::of(self.sample, self.usable, &layout.factors());
        let (error, df_error) = match self.settings.error {
            Error::Residual => (solution.residual_squares(), solution.df_residual()),
            Error::PureError => (pure.squares, pure.df),
        };
        if df_error == 0 {
            let response = self.response.to_string();
            return Err(vec![match self.settings.error {
                Error::Residual => Fault::NoErrorLeft { response, rows: solution.rows, terms: solution.terms() },
                Error::PureError => Fault::NoReplicates { response },
            }]);
        }
        let total = solution.total_squares();
        let mut lines: Vec<Line> = (0..layout.terms.len())
            .map(|term| {
                let squares = term_squares(&solution, layout, term, self.settings.squares);
                let squares = if solution.is_something(squares) { squares } else { T::zero() };
                self.line(layout.label(term), squares, layout.df(term), (error, df_error), total)
            })
            .collect();
        lines.push(bare("residual", solution.residual_squares(), solution.df_residual(), true));
        lines.push(bare("total", total, solution.rows - 1, false));
        let alpha = self.settings.outlier_alpha;
        let (rows, press) = residuals(&matrix, &solution, &self.usable.rows, &self.usable.values, alpha);
        let about_mean = (!solution.constant).then(|| squares_about_mean(self.sample, self.usable));
        let fit = Fit::of(&solution, self.response, self.usable.missing, press, pure, about_mean);
        let response = self.response.to_string();
        Ok(Anova { response, lines, fit, residuals: rows, pooled: vec![], not_estimable: vec![] })
    }

    fn line<T: Real>(&self, source: String, ss: T, df: usize, (error, df_error): (T, usize), total: T) -> Line {
        let f = ratio(ss, df, error, df_error);
        let p = f.map(|f| f_upper(f, df as f64, df_error as f64));
        let ms_error = error / T::from(df_error as f64);
        Line {
            source,
            df,
            ss: ss.value(),
            ms: Some((ss / T::from(df as f64)).value()),
            f,
            p,
            significance: self.word(p),
            eta2: Some((ss / total).value()),
            omega2: Some(((ss - T::from(df as f64) * ms_error) / (total + ms_error)).value()),
        }
    }

    fn word(&self, p: Option<f64>) -> String {
        if p.is_none() {
            return String::new();
        }
        let reached = self.settings.significance.iter().filter(|(level, _)| p.is_some_and(|p| p <= *level));
        let strictest = reached.reduce(|a, b| if b.0 < a.0 { b } else { a });
        strictest.map_or_else(|| "-".into(), |(_, word)| word.clone())
    }
}

/// `residual` and `total`.
fn bare<T: Real>(source: &str, ss: T, df: usize, has_mean: bool) -> Line {
    Line {
        source: source.into(),
        df,
        ss: ss.value(),
        ms: has_mean.then(|| (ss / T::from(df as f64)).value()).filter(|ms| ms.is_finite()),
        f: None,
        p: None,
        significance: String::new(),
        eta2: None,
        omega2: None,
    }
}

/// Sum of squares of one term.
fn term_squares<T: Real>(solution: &Solution<T>, layout: &Layout, term: usize, kind: Squares) -> T {
    let own = layout.range(term);
    if kind == Squares::I {
        return solution.squares(own.start, own.end);
    }
    let before = |other: &usize| *other != term && (kind == Squares::III || !layout.contains(*other, term));
    let mut columns = vec![0];
    columns.extend((0..layout.terms.len()).filter(before).flat_map(|other| layout.range(other)));
    let from = columns.len();
    columns.extend(own);
    solution.with_terms(&columns).squares(from, columns.len())
}
