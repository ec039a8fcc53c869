//! What a reader should be warned of before a result is used: what artifacts say themselves, and what their statistics
//! show by the rules of the field.

use super::paper::Part;
use crate::artifact::{Artifact, Node, Table, Values};

/// Adjusted and predicted R² of a sound model differ by less than this (a rule of thumb of designed experiments).
const GAP: f64 = 0.2;
/// Coefficients with a larger variance inflation factor share most of what they say (Marquardt 1970,
/// doi:10.2307/1267205).
const INFLATION: f64 = 10.0;
/// Level of significance of the lack of fit.
const LEVEL: f64 = 0.05;

/// What a table says that a reader must not miss.
type Rule = fn(&Table) -> Vec<String>;

/// The warnings of a stage.
pub(super) fn warnings(part: &Part) -> Vec<String> {
    let Some(artifact) = part.artifact() else { return Vec::new() };
    let mut found = own(artifact);
    if let Some(Node::Text(why)) = artifact.root.get("failure")
        && !why.is_empty()
    {
        found.push(format!("the run failed: {why}"));
    }
    let rules: [(&str, Rule); 6] = [
        ("runs", failures),
        ("fit", fits),
        ("residuals", flags),
        ("coefficients", inflation),
        ("prediction", reach),
        ("summary", outside),
    ];
    for (name, rule) in rules {
        found.extend(artifact.table(name).into_iter().flat_map(rule));
    }
    found
}

/// Texts that the stage left as warnings.
fn own(artifact: &Artifact) -> Vec<String> {
    artifact.root.get("warnings").and_then(Node::texts).unwrap_or_default().to_vec()
}

fn texts<'a>(table: &'a Table, name: &str) -> &'a [String] {
    match table.column(name).map(|column| &column.values) {
        Some(Values::Texts(texts)) => texts,
        _ => &[],
    }
}

/// Responses with a number, where it is known.
fn by_response<'a>(table: &'a Table, name: &str) -> Vec<(&'a str, f64)> {
    let values = table.numbers(name, "").unwrap_or_default();
    let pairs = texts(table, "response").iter().map(String::as_str).zip(values);
    pairs.filter(|(_, value)| value.is_finite()).collect()
}

fn failures(table: &Table) -> Vec<String> {
    let mut reasons: Vec<(&str, usize)> = Vec::new();
    let all = texts(table, "failure");
    for why in all.iter().filter(|why| !why.is_empty()) {
        match reasons.iter_mut().find(|(known, _)| known == why) {
            Some((_, count)) => *count += 1,
            None => reasons.push((why, 1)),
        }
    }
    let count: usize = reasons.iter().map(|(_, count)| count).sum();
    let told: Vec<String> = reasons.iter().map(|(why, count)| format!("{why} ({count})")).collect();
    if count == 0 {
        Vec::new()
    } else {
        vec![format!("{count} of {} runs have no result: {}", all.len(), told.join("; "))]
    }
}

fn fits(table: &Table) -> Vec<String> {
    let mut found = Vec::new();
    for (response, missing) in by_response(table, "missing").into_iter().filter(|(_, missing)| *missing > 0.0) {
        found.push(format!("{response}: {missing} runs are missing from the fit"));
    }
    for (response, p) in by_response(table, "lack_of_fit_p").into_iter().filter(|(_, p)| *p < LEVEL) {
        found.push(format!(
            "{response}: the lack of fit is significant (p = {p:.2e}): the model leaves out what the runs show"
        ));
    }
    let predicted = by_response(table, "r2_predicted");
    for (response, adjusted) in by_response(table, "r2_adjusted") {
        let Some((_, predicted)) = predicted.iter().find(|(name, _)| *name == response) else { continue };
        if adjusted - predicted > GAP {
            found.push(format!(
                "{response}: predicted R² ({predicted:.3}) is far below adjusted R² ({adjusted:.3}): few runs carry the model"
            ));
        }
    }
    let lost =
        texts(table, "response").iter().zip(texts(table, "not_estimable")).filter(|(_, terms)| !terms.is_empty());
    found.extend(lost.map(|(response, terms)| format!("{response}: cannot be estimated: {terms}")));
    found
}

fn flags(table: &Table) -> Vec<String> {
    let rows: Vec<String> = match table.column("row").map(|column| &column.values) {
        Some(Values::Texts(rows)) => rows.clone(),
        Some(Values::Ints(rows)) => rows.iter().map(i64::to_string).collect(),
        Some(Values::Reals(_)) | None => Vec::new(),
    };
    let flagged =
        texts(table, "response").iter().zip(rows).zip(texts(table, "flag")).filter(|(_, flag)| !flag.is_empty());
    let told: Vec<String> = flagged.map(|((response, row), flag)| format!("{response}, row {row} ({flag})")).collect();
    if told.is_empty() { Vec::new() } else { vec![format!("suspicious runs, kept in the fit: {}", told.join("; "))] }
}

fn inflation(table: &Table) -> Vec<String> {
    // In natural units a square is close to its factor; only first-order models are judged by this.
    let terms = texts(table, "term");
    if terms.iter().any(|term| term.contains(['^', '*'])) {
        return Vec::new();
    }
    let rows = by_response(table, "vif").into_iter().zip(terms).filter(|((_, vif), _)| *vif > INFLATION);
    rows.map(|((response, vif), term)| {
        format!("{response}: {term} is nearly a mixture of others (variance inflation {vif:.0})")
    })
    .collect()
}

fn reach(table: &Table) -> Vec<String> {
    let sets = table.ints("set").unwrap_or_default();
    let rows = texts(table, "response").iter().zip(texts(table, "reach")).enumerate();
    let out = rows.filter(|(_, (_, reach))| reach.starts_with("out of reach"));
    out.map(|(i, (response, reach))| format!("set {}: the target of {response} is {reach}", sets.get(i).unwrap_or(&0)))
        .collect()
}

fn outside(table: &Table) -> Vec<String> {
    let sets = table.ints("set").unwrap_or_default();
    let rows = texts(table, "response").iter().zip(texts(table, "target_inside")).enumerate();
    let out = rows.filter(|(_, (_, inside))| *inside == "no");
    let told: Vec<String> =
        out.map(|(i, (response, _))| format!("{response} of set {}", sets.get(i).unwrap_or(&0))).collect();
    if told.is_empty() {
        Vec::new()
    } else {
        vec![format!("targets outside the 95 % interval of the mean: {}", told.join(", "))]
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
            let table =
                Table::default().texts_column("response", "", words(&["E"])).ints_column("missing", "", vec![missing]);
            let table = table.reals_column("r2_adjusted", "", "", vec![0.9]).reals_column(
                "r2_predicted",
                "",
                "",
                vec![predicted],
            );
            fits(&table.reals_column("lack_of_fit_p", "", "", vec![p])).len()
        };
        assert_eq!([fit(0.2, 0.8, 0), fit(f64::NAN, f64::NAN, 0)], [0, 0]);
        assert_eq!([fit(0.01, 0.8, 0), fit(0.2, 0.5, 0), fit(0.01, 0.5, 3)], [1, 1, 3]);
    }

    #[test]
    fn failures_flags_and_targets_are_counted_by_name() {
        let runs = Table::default().texts_column("failure", "", words(&["", "no peak", "no peak", "lost"]));
        assert_eq!(failures(&runs), ["3 of 4 runs have no result: no peak (2); lost (1)"]);
        let residuals = Table::default()
            .texts_column("response", "", words(&["E", "E"]))
            .ints_column("row", "", vec![4, 26])
            .texts_column("flag", "", words(&["", "outlier"]));
        assert_eq!(flags(&residuals), ["suspicious runs, kept in the fit: E, row 26 (outlier)"]);
        let summary = Table::default()
            .ints_column("set", "", vec![1, 2])
            .texts_column("response", "", words(&["E", "nu"]))
            .texts_column("target_inside", "", words(&["no", "yes"]));
        assert_eq!(outside(&summary), ["targets outside the 95 % interval of the mean: E of set 1"]);
    }
}
