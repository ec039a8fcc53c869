//! Warnings before a result is used: those that artifacts hold, and those that follow from their statistics by the rules
//! of the field.

use super::paper::Part;
use crate::artifact::calibration::{Answer, Prediction, Solution, Summary, Verification};
use crate::artifact::groups::{GroupResiduals, Groups};
use crate::artifact::statistics::{Anova, Fits, Residuals, Screening};
use crate::artifact::surfaces::{Coefficients, Surfaces};
use crate::artifact::validity::sentences;
use crate::artifact::{Artifact, Wanted};

/// Adjusted and predicted R² of a sound model differ by less than this (a rule of thumb of designed experiments).
const GAP: f64 = 0.2;
/// Coefficients with a larger variance inflation factor share most of what they say (Marquardt 1970,
/// doi:10.2307/1267205).
const INFLATION: f64 = 10.0;
/// Level of significance of the lack of fit.
const LEVEL: f64 = 0.05;

/// The warnings of a stage.
pub(super) fn warnings(part: &Part) -> Vec<String> {
    let Some(artifact) = part.artifact() else { return Vec::new() };
    let mut found = sentences(artifact);
    found.extend(part.outcome.warnings.iter().map(counted));
    // A result of another version gives no warnings here; the section that shows its tables reports it.
    found.extend(judged(artifact).unwrap_or_default());
    found
}

/// A warning of tasks, with the number of those that have it.
fn counted((text, count): &(String, usize)) -> String {
    if *count == 1 { text.clone() } else { format!("{text} ({count} tasks)") }
}

/// Targets of a stage that are not met: out of reach of a calibration, or outside the interval of a verification.
pub(super) fn unmet(part: &Part) -> [usize; 2] {
    let Some(artifact) = part.artifact() else { return [0, 0] };
    let prediction = Solution::from_artifact(artifact).map(|found| found.prediction).ok();
    let out = |found: Prediction| (0..found.reach.len()).filter(|&row| found.out_of_reach(row)).count();
    let inside = Verification::from_artifact(artifact).map(|found| found.summary.target_inside).unwrap_or_default();
    [prediction.map_or(0, out), inside.iter().filter(|answer| **answer == Answer::No).count()]
}

/// Warnings from the numbers of a result.
fn judged(artifact: &Artifact) -> Result<Vec<String>, Wanted> {
    let mut found = Vec::new();
    if artifact.is(Anova::KIND) {
        let Anova { fit, residuals, .. } = Anova::from_artifact(artifact)?;
        found.extend(fits(&fit).into_iter().chain(flags(&residuals)));
    } else if artifact.is(Screening::KIND) {
        let Screening { fit, residuals, .. } = Screening::from_artifact(artifact)?;
        found.extend(fits(&fit).into_iter().chain(flags(&residuals)));
    } else if artifact.is(Surfaces::KIND) {
        let Surfaces { fit, residuals, coefficients, .. } = Surfaces::from_artifact(artifact)?;
        found.extend(fits(&fit).into_iter().chain(flags(&residuals)).chain(inflation(&coefficients)));
    } else if artifact.is(Groups::KIND) {
        let GroupResiduals { response, row, flag, .. } = Groups::residuals(artifact)?;
        found.extend(flags(&Residuals { response, row, flag, ..Residuals::default() }));
    } else if artifact.is(Solution::KIND) {
        found.extend(reach(&Solution::from_artifact(artifact)?.prediction));
    } else if artifact.is(Verification::KIND) {
        found.extend(outside(&Verification::from_artifact(artifact)?.summary));
    }
    Ok(found)
}

/// The values that are numbers, with the responses that they belong to.
fn by_response<'a>(responses: &'a [String], values: &[f64]) -> Vec<(&'a str, f64)> {
    let pairs = responses.iter().map(String::as_str).zip(values.iter().copied());
    pairs.filter(|(_, value)| value.is_finite()).collect()
}

fn fits(fit: &Fits) -> Vec<String> {
    let mut found = Vec::new();
    for (response, missing) in fit.response.iter().zip(&fit.missing).filter(|(_, missing)| **missing > 0) {
        let rows = if *missing == 1 { "row has no value and is" } else { "rows have no value and are" };
        found.push(format!("{response}: {missing} {rows} not in the fit"));
    }
    for (response, p) in by_response(&fit.response, &fit.lack_of_fit_p).into_iter().filter(|(_, p)| *p < LEVEL) {
        found.push(format!(
            "{response}: the lack of fit is significant (p = {p:.2e}): the model leaves out what the runs show"
        ));
    }
    let both = fit.response.iter().zip(&fit.r2_adjusted).zip(&fit.r2_predicted);
    for ((response, adjusted), predicted) in both.filter(|((_, adjusted), predicted)| **adjusted - **predicted > GAP) {
        found.push(format!(
            "{response}: predicted R² ({predicted:.3}) is far below adjusted R² ({adjusted:.3}): few runs carry the model"
        ));
    }
    let lost = fit.not_estimable.iter().flatten();
    let lost = fit.response.iter().zip(lost).filter(|(_, terms)| !terms.is_empty());
    found.extend(lost.map(|(response, terms)| format!("{response}: cannot be estimated: {terms}")));
    found
}

fn flags(residuals: &Residuals) -> Vec<String> {
    let all = residuals.response.iter().zip(&residuals.row).zip(&residuals.flag);
    let flagged = all.filter(|(_, flag)| !flag.is_empty());
    let words: Vec<String> = flagged.map(|((response, row), flag)| format!("{response}, row {row} ({flag})")).collect();
    if words.is_empty() { Vec::new() } else { vec![format!("suspicious runs, kept in the fit: {}", words.join("; "))] }
}

fn inflation(coefficients: &Coefficients) -> Vec<String> {
    // In natural units a square is close to its factor; only first-order models are judged by this.
    if coefficients.term.iter().any(|term| term.contains(['^', '*'])) {
        return Vec::new();
    }
    let all = coefficients.response.iter().zip(&coefficients.term).zip(&coefficients.vif);
    let rows = all.filter(|(_, vif)| vif.is_finite() && **vif > INFLATION);
    rows.map(|((response, term), vif)| {
        format!("{response}: {term} is nearly a mixture of others (variance inflation {vif:.0})")
    })
    .collect()
}

fn reach(prediction: &Prediction) -> Vec<String> {
    let out = (0..prediction.set.len()).filter(|&row| prediction.out_of_reach(row));
    let words = |row: usize| {
        let (set, response, reach) = (prediction.set[row], &prediction.response[row], &prediction.reach[row]);
        format!("set {set}: the target of {response} is {reach}")
    };
    out.map(words).collect()
}

fn outside(summary: &Summary) -> Vec<String> {
    let rows = summary.set.iter().zip(&summary.response).zip(&summary.target_inside);
    let out = rows.filter(|(_, inside)| **inside == Answer::No);
    let words: Vec<String> = out.map(|((set, response), _)| format!("{response} of set {set}")).collect();
    if words.is_empty() {
        Vec::new()
    } else {
        vec![format!("targets outside the 95 % interval of the mean: {}", words.join(", "))]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn words(values: &[&str]) -> Vec<String> {
        values.iter().map(|&word| word.to_owned()).collect()
    }

    #[test]
    fn a_fit_is_judged_by_lack_of_fit_prediction_and_missing_runs() {
        let fit = |p: f64, predicted: f64, missing: i64| {
            let fit = Fits {
                response: words(&["E"]),
                missing: vec![missing],
                r2_adjusted: vec![0.9],
                r2_predicted: vec![predicted],
                lack_of_fit_p: vec![p],
                ..Fits::default()
            };
            fits(&fit).len()
        };
        assert_eq!([fit(0.2, 0.8, 0), fit(f64::NAN, f64::NAN, 0)], [0, 0]);
        assert_eq!([fit(0.01, 0.8, 0), fit(0.2, 0.5, 0), fit(0.01, 0.5, 3)], [1, 1, 3]);
    }

    #[test]
    fn flags_and_targets_are_counted_by_name() {
        let (response, row, flag) = (words(&["E", "E"]), vec![4, 26], words(&["", "outlier"]));
        let residuals = Residuals { response, row, flag, ..Residuals::default() };
        assert_eq!(flags(&residuals), ["suspicious runs, kept in the fit: E, row 26 (outlier)"]);
        let (response, target_inside) = (words(&["E", "nu"]), vec![Answer::No, Answer::Yes]);
        let summary = Summary { set: vec![1, 2], response, target_inside, ..Summary::default() };
        assert_eq!(outside(&summary), ["targets outside the 95 % interval of the mean: E of set 1"]);
    }
}
