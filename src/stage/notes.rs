//! The table `notes` of every stage of statistics: what a reader must know before an analysis is trusted.
//!
//! A note says in words what the other tables hold as numbers; no note changes an analysis.

use crate::artifact::notes::NoteTable;
use crate::artifact::validity::NotValid;
use stats::diagnostics::Residual;
use stats::fit::Fit;
use stats::model::Axis;
use stats::regression::Coefficient;

/// Notes with their responses, in order.
#[derive(Default)]
pub(super) struct Notes<'a> {
    notes: Vec<(String, String)>,
    /// Runs that are not valid.
    not_valid: Option<&'a NotValid>,
}

/// Lack of fit up to this p gets a note.
const LACK_OF_FIT: f64 = 0.05;
/// Largest difference between adjusted and predicted R² without a note.
const R2_GAP: f64 = 0.2;
/// A coefficient with a larger variance inflation is hardly separable from the others (Marquardt 1970,
/// doi:10.1080/00401706.1970.10488699).
const INFLATION: f64 = 10.0;
/// Most rows that are listed one by one.
const ROWS: usize = 8;

impl<'a> Notes<'a> {
    /// New notes, which begin with the runs that are not valid.
    pub(super) fn of(not_valid: &'a NotValid) -> Self {
        let mut notes = Self { notes: Vec::new(), not_valid: Some(not_valid) };
        not_valid.sentences().into_iter().for_each(|(response, said)| notes.add(response, said));
        notes
    }

    /// Adds a note.
    pub(super) fn add(&mut self, response: &str, note: impl Into<String>) {
        self.notes.push((response.to_owned(), note.into()));
    }

    /// A note on runs without a value, besides those that were left out.
    pub(super) fn missing(&mut self, response: &str, used: usize, missing: usize) {
        let left_out = self.not_valid.map_or(0, |list| list.left_out(response));
        let (all, without) = (used + missing, missing - left_out.min(missing));
        if without > 0 {
            let have = if without == 1 { "has" } else { "have" };
            self.add(response, format!("{without} of {all} runs {have} no value; the analysis is of {used}"));
        }
    }

    /// Factors with a single value, from which only a fit through the origin takes a slope; `whose` names the group.
    pub(super) fn one_level(&mut self, response: &str, whose: &str, axes: &[Axis]) {
        for axis in axes.iter().filter(|axis| axis.low == axis.high) {
            let (name, value) = (&axis.name, short(axis.low));
            self.add(
                response,
                format!(
                    "{whose}`{name}` is {value} in every run: the slope takes the response as proportional to it, which \
                     one level cannot show"
                ),
            );
        }
    }

    /// Notes on the quality of a fit.
    pub(super) fn fit(&mut self, fit: &Fit) {
        let response = fit.response.as_str();
        self.missing(response, fit.n, fit.missing);
        if fit.df_residual == 0 {
            self.add(response, "as many coefficients as runs: no standard errors, tests or intervals");
            return;
        }
        if fit.s == Some(0.0) {
            self.add(response, "the model meets every run to the last digit: there is no error to test against");
            return;
        }
        if fit.df_pure_error > 0 && fit.ss_pure_error == 0.0 {
            self.add(response, "replicates agree to the last digit: no pure error to hold the lack of fit against");
        }
        if let (Some(f), Some(p)) = (fit.lack_of_fit_f, fit.lack_of_fit_p.filter(|p| *p <= LACK_OF_FIT)) {
            let numbers = format!("F = {}, p = {}", short(f), short(p));
            self.add(
                response,
                format!("lack of fit ({numbers}): runs lie farther from the model than replicates scatter"),
            );
        }
        match (fit.r2_adjusted, fit.r2_predicted) {
            (Some(adjusted), Some(predicted)) if adjusted - predicted > R2_GAP => {
                let (predicted, adjusted) = (short(predicted), short(adjusted));
                self.add(
                    response,
                    format!("predicted R2 ({predicted}) is far below adjusted R2 ({adjusted}): too many terms for these runs"),
                );
            }
            (_, None) => self.add(response, "a run with leverage 1 is met whatever it says, so R2 cannot be predicted"),
            _ => {}
        }
    }

    /// Notes on rows that a model does not explain, or that have a strong influence on it.
    pub(super) fn residuals(&mut self, response: &str, rows: &[Residual]) {
        let flagged: Vec<&Residual> = rows.iter().filter(|r| r.outlier || r.influential).collect();
        for r in flagged.iter().take(ROWS) {
            let what = match (r.outlier, r.influential) {
                (true, true) => "an outlier that bends the model",
                (true, false) => "an outlier",
                (false, _) => "it alone bends the model",
            };
            let studentized = r.studentized.map_or(String::new(), |t| format!(", studentized residual {}", short(t)));
            let (observed, fitted) = (short(r.observed), short(r.fitted));
            self.add(response, format!("row {}: {observed} where the model says {fitted}{studentized}: {what}", r.row));
        }
        if flagged.len() > ROWS {
            self.add(response, format!("and {} more rows that `residuals` flags", flagged.len() - ROWS));
        }
    }

    /// Notes on coefficients that the runs hardly separate from others.
    pub(super) fn inflation(&mut self, response: &str, coefficients: &[Coefficient]) {
        let inflated = |c: &&Coefficient| c.vif.is_some_and(|vif| vif > INFLATION);
        for c in coefficients.iter().filter(inflated) {
            let vif = short(c.vif.unwrap_or(f64::NAN));
            self.add(response, format!("`{}` is hard to tell from other terms: variance inflation {vif}", c.term));
        }
    }

    /// The table.
    pub(super) fn table(self) -> NoteTable {
        let (response, note) = self.notes.into_iter().unzip();
        NoteTable { response, note }
    }
}

/// A number with four significant digits.
pub(super) fn short(value: f64) -> String {
    let scientific = format!("{value:.3e}");
    let rounded: f64 = scientific.parse().unwrap_or(value);
    match rounded.abs() {
        0.0 => "0".to_owned(),
        size if (1e-4..1e7).contains(&size) || !size.is_finite() => rounded.to_string(),
        _ => format!("{rounded:e}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        let all = [0.0, 31.32574, -9.318911, 7.04352e-40, 123456.0, 0.012, 2.5e9, f64::INFINITY];
        assert_eq!(all.map(short), ["0", "31.33", "-9.319", "7.044e-40", "123500", "0.012", "2.5e9", "inf"]);
    }
}
