//! The treatment of runs that are not valid: one setting for every kind that takes runs, and the module that applies it.
//!
//! A run is not valid when it does not meet a decisive check: a Brazilian disc that turned, a confining stress that was not
//! held. It has numbers, but they are not those of the intended test. Statistics, fits and calibrations leave such runs out
//! and state how many of how many, and why; printed tables show and mark them.

use super::StageError;
use crate::artifact::results::Results;
use crate::artifact::run::{Outcome, Run};
use crate::artifact::validity::{NotValid, Statement, Tally, Treated, Verdict};
use crate::artifact::{Artifact, Table};
use figure::text::plain_text;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// What to do with runs that are not valid.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Invalid {
    /// Leave them out; the stage states how many of how many, and why.
    #[default]
    LeaveOut,
    /// Use them like the others; the stage states how many they are.
    Keep,
    /// Let the stage fail.
    Refuse,
}

/// The runs of a table to which the setting was applied.
pub(super) struct Judged<'a> {
    all: usize,
    treated: Treated,
    /// Rows from 0, in ascending order, and why each is not valid.
    invalid: Vec<(usize, &'a str)>,
}

impl Invalid {
    /// Whether it is the default of statistics.
    pub(super) fn is_default(&self) -> bool {
        *self == Self::default()
    }

    /// Applies the setting to a table of runs.
    ///
    /// # Errors
    /// The setting is to refuse, and a run is not valid.
    pub(super) fn judge(self, runs: &Table) -> Result<Judged<'_>, StageError> {
        let (all, invalid) = (runs.rows(), Results::invalid(runs));
        let treated = match self {
            Self::LeaveOut => Treated::LeftOut,
            Self::Keep => Treated::Kept,
            Self::Refuse => {
                return match Tally::of(all, invalid.iter().map(|(_, why)| *why)).sentence(Verdict::NotValid) {
                    Some(said) => Err(refused(&said)),
                    None => Ok(Judged { all, treated: Treated::LeftOut, invalid }),
                };
            }
        };
        Ok(Judged { all, treated, invalid })
    }

    /// Whether to draw a single run, and the statement on it.
    ///
    /// # Errors
    /// It is not valid and refused.
    pub(super) fn of_run(self, run: &Artifact, name: &str) -> Result<(bool, Option<String>), StageError> {
        let outcome = Run::outcome(run)?;
        let Some(why) = outcome.invalid() else {
            let Outcome { failure, .. } = outcome;
            return Ok((true, (!failure.is_empty()).then(|| format!("{name} gave no result: {failure}"))));
        };
        match self {
            Self::LeaveOut => Ok((false, Some(format!("{name} is not valid and was left out: {why}")))),
            Self::Keep => Ok((true, Some(format!("{name} is not valid and was kept: {why}")))),
            Self::Refuse => Err(refused(&format!("{name} is not valid: {why}"))),
        }
    }
}

/// A sentence behind the names that it is about, or one that begins with a capital.
pub(super) fn sentence(about: &str, words: &str) -> String {
    if !about.is_empty() {
        return format!("{about}: {words}.");
    }
    let mut letters = words.chars();
    let first = letters.next().map(|first| first.to_uppercase().to_string()).unwrap_or_default();
    format!("{first}{}.", letters.as_str())
}

/// The responses of a statement as a label: their symbols, or names where they have none.
fn responses_of(said: &Statement, symbols: &BTreeMap<String, String>) -> String {
    let label = |name: &String| symbols.get(name).map_or_else(|| plain_text(name), |symbol| format!("${symbol}$"));
    said.responses.iter().map(label).collect::<Vec<_>>().join(", ")
}

/// A note on results, as a label: `whose` is the stage or series, empty where there is one; the words are those of runs and
/// programs, and no markup.
pub(super) fn note(whose: &str, said: &Statement, symbols: &BTreeMap<String, String>) -> String {
    let names = [plain_text(whose), responses_of(said, symbols)];
    let about: Vec<&str> = names.iter().map(String::as_str).filter(|name| !name.is_empty()).collect();
    sentence(&about.join(": "), &plain_text(&said.words))
}

/// The error about runs that are refused.
pub(super) fn refused(said: &str) -> StageError {
    StageError::new(said)
        .hint("mend the test, or say `invalid = \"leave-out\"` or `invalid = \"keep\"` in the stage that refuses them")
}

impl Judged<'_> {
    /// Whether the run at this row, from 0, is left out.
    pub(super) fn leaves_out(&self, row: usize) -> bool {
        self.treated == Treated::LeftOut && self.invalid.binary_search_by_key(&row, |(own, _)| *own).is_ok()
    }

    /// The statement on runs that are not valid.
    pub(super) fn verdict(&self) -> Verdict {
        Verdict::Treated(self.treated)
    }

    /// How many of how many runs are not valid, why, and whether they are used; `None` when all are valid.
    pub(super) fn sentence(&self) -> Option<String> {
        Tally::of(self.all, self.invalid.iter().map(|(_, why)| *why)).sentence(self.verdict())
    }

    /// The runs that are not valid and gave a value of the response.
    pub(super) fn listed(&self, response: &str, values: &[f64]) -> NotValid {
        let mut list = NotValid::default();
        for (row, why) in self.invalid.iter().filter(|(row, _)| values.get(*row).is_some_and(|v| !v.is_nan())) {
            list.response.push(response.to_owned());
            list.row.push(*row as i64 + 1);
            list.runs.push(self.all as i64);
            list.reason.push((*why).to_owned());
            list.treated.push(self.treated);
        }
        list
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn runs() -> Table {
        let texts = |texts: [&str; 4]| texts.map(String::from).to_vec();
        Table::default()
            .reals_column("UCS", "MPa", "", vec![1.0, 2.0, f64::NAN, 4.0])
            .texts_column("failure", "", texts(["", "", "no peak", ""]))
            .texts_column("validity", "", texts(["", "rotation", "no peak", "at grip"]))
    }

    #[test]
    fn the_choice_is_applied_to_runs_that_gave_a_result() {
        let table = runs();
        let left = Invalid::LeaveOut.judge(&table).unwrap();
        assert_eq!([0, 1, 2, 3].map(|row| left.leaves_out(row)), [false, true, false, true]);
        assert_eq!(left.sentence().unwrap(), "2 of 4 runs are not valid and were left out: rotation (1); at grip (1)");
        let kept = Invalid::Keep.judge(&table).unwrap();
        assert!((0..4).all(|row| !kept.leaves_out(row)));
        assert_eq!(kept.sentence().unwrap(), "2 of 4 runs are not valid and were kept: rotation (1); at grip (1)");
        let refused = Invalid::Refuse.judge(&table).err().unwrap();
        assert_eq!(refused.message, "2 of 4 runs are not valid: rotation (1); at grip (1)");
        assert!(Invalid::Refuse.judge(&Table::default()).unwrap().sentence().is_none());
    }

    #[test]
    fn a_sentence_begins_with_a_capital_or_with_the_symbols_that_it_is_about() {
        assert_eq!(sentence("", "2 of 4 runs"), "2 of 4 runs.");
        assert_eq!(sentence("", "the run is not valid"), "The run is not valid.");
        let said = Statement { responses: vec!["sigma_t".into(), "nu".into()], words: "1 of 4 runs".into() };
        let symbols = BTreeMap::from([("sigma_t".to_owned(), r"\sigma_t".to_owned())]);
        let about = responses_of(&said, &symbols);
        assert_eq!(sentence(&about, &said.words), r"$\sigma_t$, nu: 1 of 4 runs.");
        assert_eq!(said.to_string(), "sigma_t, nu: 1 of 4 runs");
    }

    #[test]
    fn a_run_without_the_response_is_not_listed_among_those_that_are_left_out_for_it() {
        let table = runs();
        let list = Invalid::LeaveOut.judge(&table).unwrap().listed("UCS", &[1.0, f64::NAN, f64::NAN, 4.0]);
        assert_eq!((list.left_out("UCS"), list.row, list.runs), (1, vec![4], vec![4]));
    }
}
