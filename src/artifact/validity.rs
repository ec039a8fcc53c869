//! Runs that gave no result, that are not valid, or that are to be read with caution: how many of how many, and why.
//!
//! The sentences are made here for all that print them: the end of `flow run`, `flow show`, notes of the statistics,
//! printed tables, figures and the report.

use super::results::Results;
use super::run::Run;
use super::{Artifact, ArtifactKind, Field, Node, Table};
use std::fmt;

crate::words! {
    /// What a stage did with a run that is not valid.
    pub enum Treated {
        /// It was left out of the analysis.
        LeftOut = "left out",
        /// It was used like the others.
        Kept = "kept",
    }
}

crate::table! {
    /// runs that are not valid, and what became of them
    pub struct NotValid {
        /// the response whose value it gave
        pub response: Vec<String>, "";
        /// row of the table of runs, from 1
        pub row: Vec<i64>, "";
        /// runs in that table
        pub runs: Vec<i64>, "";
        /// the checks that the run does not meet
        pub reason: Vec<String>, "";
        /// left out, or kept
        pub treated: Vec<Treated>, "";
    }
}

/// A statement on some runs of a table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// They gave no result.
    NoResult,
    /// They are not valid.
    NotValid,
    /// They are not valid, and a stage treated them so.
    Treated(Treated),
    /// They are valid, and a check says that they should be looked at.
    Caution,
}

impl Verdict {
    fn words(self, one: bool) -> String {
        let (is, was) = if one { ("is", "was") } else { ("are", "were") };
        match self {
            Self::NoResult => "gave no result".to_owned(),
            Self::NotValid => format!("{is} not valid"),
            Self::Treated(treated) => format!("{is} not valid and {was} {}", treated.word()),
            Self::Caution => format!("{is} to be read with caution"),
        }
    }
}

/// How many runs of how many, and why.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Tally<'a> {
    all: usize,
    reasons: Vec<Reason<'a>>,
}

/// Reasons that differ in their numbers alone, and how many runs have them.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Reason<'a> {
    /// The words of the first.
    first: &'a str,
    /// Which of its [`pieces`] are numbers that others have otherwise.
    differ: Vec<usize>,
    count: usize,
}

/// Most reasons that are written out.
const WRITTEN: usize = 5;

/// The pieces of a text: numbers, and what stands between them.
fn pieces(text: &str) -> impl Iterator<Item = (bool, &str)> {
    let numeric = |c: char| c.is_ascii_digit();
    let mut rest = text;
    std::iter::from_fn(move || {
        let first = rest.chars().next()?;
        let number = numeric(first);
        // A point or a power of ten belongs to the number when digits follow it.
        let within = |at: usize, c: char| match c {
            '.' => rest[at + 1..].starts_with(numeric),
            'e' => rest[at + 1..].trim_start_matches(['-', '+']).starts_with(numeric),
            '-' | '+' => rest[..at].ends_with('e') && rest[at + 1..].starts_with(numeric),
            c => numeric(c),
        };
        let end = rest.char_indices().find(|(at, c)| if number { !within(*at, *c) } else { numeric(*c) });
        let (piece, behind) = rest.split_at(end.map_or(rest.len(), |(at, _)| at));
        rest = behind;
        Some((number, piece))
    })
}

/// Whether two texts differ in nothing but numbers.
fn alike(a: &str, b: &str) -> bool {
    let words = |text| pieces(text).map(|(number, piece)| if number { "" } else { piece });
    a == b || words(a).eq(words(b))
}

impl Reason<'_> {
    /// The words, with a gap where numbers differ.
    fn words(&self) -> String {
        let all = pieces(self.first).enumerate();
        all.map(|(place, (_, piece))| if self.differ.contains(&place) { "…" } else { piece }).collect()
    }

    /// Counts another run whose reason differs in nothing but numbers.
    fn meet(&mut self, why: &str) {
        self.count += 1;
        let both = pieces(self.first).zip(pieces(why)).enumerate();
        let new = both.filter(|(place, ((_, own), (_, other)))| own != other && !self.differ.contains(place));
        let new: Vec<usize> = new.map(|(place, _)| place).collect();
        self.differ.extend(new);
    }
}

impl<'a> Tally<'a> {
    /// Counts the reasons of `all` runs; an empty one is none. They stand in the order in which they are first met.
    pub fn of(all: usize, found: impl IntoIterator<Item = &'a str>) -> Self {
        let mut reasons: Vec<Reason> = Vec::new();
        for why in found.into_iter().filter(|why| !why.is_empty()) {
            match reasons.iter_mut().find(|known| alike(known.first, why)) {
                Some(known) => known.meet(why),
                None => reasons.push(Reason { first: why, differ: Vec::new(), count: 1 }),
            }
        }
        Self { all, reasons }
    }

    /// Number of runs with a reason.
    pub fn count(&self) -> usize {
        self.reasons.iter().map(|reason| reason.count).sum()
    }

    /// The reasons in words, each with the number of those that have it; numbers in which they differ are left out.
    pub fn reasons(&self) -> Vec<(String, usize)> {
        self.reasons.iter().map(|reason| (reason.words(), reason.count)).collect()
    }

    /// `3 of 40 evaluations gave no result: not valid: rotation (3)`; nothing where none has a reason.
    pub fn of_evaluations(&self, what: &str) -> Option<String> {
        (self.count() > 0).then(|| format!("{} of {} evaluations {what}: {}", self.count(), self.all, self.why()))
    }

    fn why(&self) -> String {
        let (written, others) = self.reasons.split_at(self.reasons.len().min(WRITTEN));
        let words = written.iter().map(|reason| format!("{} ({})", reason.words(), reason.count));
        let count: usize = others.iter().map(|reason| reason.count).sum();
        let more = match others.len() {
            0 => None,
            1 => Some(format!("another reason ({count})")),
            kinds => Some(format!("{kinds} other reasons ({count})")),
        };
        words.chain(more).collect::<Vec<_>>().join("; ")
    }

    /// `3 of 24 runs gave no result: no peak (2); escape (1)`; nothing where no run has a reason.
    pub fn sentence(&self, verdict: Verdict) -> Option<String> {
        let (count, all) = (self.count(), self.all);
        let words = verdict.words(count == 1);
        match (count, all) {
            (0, _) => None,
            (1, 1) => Some(format!("the only run {words}: {}", self.reasons[0].first)),
            _ => Some(format!("{count} of {all} runs {words}: {}", self.why())),
        }
    }
}

impl NotValid {
    /// Adds another list below this one.
    pub fn append(&mut self, other: Self) {
        self.response.extend(other.response);
        self.row.extend(other.row);
        self.runs.extend(other.runs);
        self.reason.extend(other.reason);
        self.treated.extend(other.treated);
    }

    /// Number of runs of a response that were left out.
    pub fn left_out(&self, response: &str) -> usize {
        let pairs = self.response.iter().zip(&self.treated);
        pairs.filter(|(own, treated)| *own == response && **treated == Treated::LeftOut).count()
    }

    /// Whether the value that the run at this row, from 0, gave of a response was left out.
    pub fn leaves_out(&self, response: &str, row: usize) -> bool {
        let all = self.response.iter().zip(&self.row).zip(&self.treated);
        all.into_iter()
            .any(|((own, at), treated)| own == response && *at == row as i64 + 1 && *treated == Treated::LeftOut)
    }

    /// Itself, unless no run is not valid.
    pub fn some(self) -> Option<Self> {
        (!self.row.is_empty()).then_some(self)
    }

    /// One sentence per response, in the order of the list.
    pub fn sentences(&self) -> Vec<(&str, String)> {
        let mut found: Vec<(&str, String)> = Vec::new();
        for (i, response) in self.response.iter().enumerate() {
            if found.iter().any(|(known, _)| known == response) {
                continue;
            }
            let own = (i..self.response.len()).filter(|&j| self.response[j] == *response);
            let tally = Tally::of(self.runs[i] as usize, own.map(|j| self.reason[j].as_str()));
            found.extend(tally.sentence(Verdict::Treated(self.treated[i])).map(|said| (response.as_str(), said)));
        }
        found
    }

    /// The sentences. Equal ones are one, with all their responses in front.
    pub fn grouped_sentences(&self) -> Vec<String> {
        self.statements().iter().map(Statement::to_string).collect()
    }

    /// The same, with the responses apart.
    fn statements(&self) -> Vec<Statement> {
        let mut groups: Vec<Statement> = Vec::new();
        for (response, words) in self.sentences() {
            match groups.iter_mut().find(|known| known.words == words) {
                Some(known) => known.responses.push(response.to_owned()),
                None => groups.push(Statement { responses: vec![response.to_owned()], words }),
            }
        }
        groups
    }
}

/// A statement on runs, and the responses that it is about; none where it is about the runs as a whole.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Statement {
    /// Names of responses.
    pub responses: Vec<String>,
    /// The sentence.
    pub words: String,
}

impl From<String> for Statement {
    fn from(words: String) -> Self {
        Self { responses: Vec::new(), words }
    }
}

impl fmt::Display for Statement {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let colon = if self.responses.is_empty() { "" } else { ": " };
        write!(out, "{}{colon}{}", self.responses.join(", "), self.words)
    }
}

/// The statements on the runs of an artifact, or on those that it was made from, to be shown wherever its numbers are.
pub fn sentences(artifact: &Artifact) -> Vec<String> {
    let mut found: Vec<String> = faults(artifact).iter().map(Statement::to_string).collect();
    if artifact.is(ArtifactKind::RUN) && found.is_empty() {
        let outcome = Run::outcome(artifact).ok().filter(|outcome| !outcome.cautions.is_empty());
        found.extend(outcome.map(|outcome| format!("the run is to be read with caution: {}", outcome.cautions)));
    } else if artifact.is(ArtifactKind::RESULTS) {
        found.extend(Results::table(artifact).ok().and_then(cautions));
    }
    found
}

/// The part of it that nobody may miss who sees a number or a picture: runs without a result and runs that are not valid.
pub fn faults(artifact: &Artifact) -> Vec<Statement> {
    if artifact.is(ArtifactKind::RUN) {
        return of_run(artifact).into_iter().map(Statement::from).collect();
    }
    let runs = [ArtifactKind::RESULTS, ArtifactKind::VERIFICATION].iter().any(|kind| artifact.is(*kind));
    let runs = if runs { Results::table(artifact).ok() } else { None };
    if artifact.is(ArtifactKind::RESULTS) {
        let said = runs.map(|runs| of_runs(runs, Verdict::NotValid)).unwrap_or_default();
        return said.into_iter().map(Statement::from).collect();
    }
    // A list of another version says nothing here; whoever shows the tables tells.
    let list = <Option<NotValid> as Field>::take(&artifact.root, NOT_VALID, "").ok().flatten();
    let failed = runs.and_then(|runs| failures(runs).sentence(Verdict::NoResult));
    failed.map(Statement::from).into_iter().chain(list.iter().flat_map(NotValid::statements)).collect()
}

/// Name of the list of runs that are not valid in artifacts that were made from runs.
const NOT_VALID: &str = "not_valid";

/// The runs of a table without a result, and those that are not valid, on which `verdict` is the statement.
pub fn of_runs(runs: &Table, verdict: Verdict) -> Vec<String> {
    let invalid = Results::invalid(runs);
    let invalid = Tally::of(runs.rows(), invalid.iter().map(|(_, why)| *why)).sentence(verdict);
    failures(runs).sentence(Verdict::NoResult).into_iter().chain(invalid).collect()
}

/// The valid runs of a table that should be looked at.
fn cautions(runs: &Table) -> Option<String> {
    let (invalid, failures) = (Results::invalid(runs), Results::failures(runs));
    let worked = |row: usize| failures.get(row).is_none_or(String::is_empty);
    let valid = |row: usize| worked(row) && invalid.iter().all(|(bad, _)| *bad != row);
    let all = Results::cautions(runs).iter().enumerate().filter(|(row, _)| valid(*row));
    Tally::of(runs.rows(), all.map(|(_, why)| why.as_str())).sentence(Verdict::Caution)
}

fn failures(runs: &Table) -> Tally<'_> {
    Tally::of(runs.rows(), Results::failures(runs).iter().map(String::as_str))
}

/// The statements on a single run.
fn of_run(artifact: &Artifact) -> Option<String> {
    let text = |name: &str| match artifact.root.get(name) {
        Some(Node::Text(text)) if !text.is_empty() => Some(text.as_str()),
        Some(_) | None => None,
    };
    let failure = text("failure").map(|why| format!("the run gave no result: {why}"));
    failure.or_else(|| text("validity").map(|why| format!("the run is not valid: {why}")))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::artifact::results::Verdicts;
    use crate::artifact::run::Responses;

    fn words(words: &[&str]) -> Vec<String> {
        words.iter().map(|&word| word.to_owned()).collect()
    }

    #[test]
    fn a_sentence_counts_by_reason_and_speaks_of_one_run_as_of_one() {
        let say = |all, found: &[&str], verdict| Tally::of(all, found.iter().copied()).sentence(verdict);
        let (left, kept) = (Verdict::Treated(Treated::LeftOut), Verdict::Treated(Treated::Kept));
        assert_eq!(say(24, &["", ""], left), None);
        assert_eq!(
            say(24, &["rotation", "", "at grip", "rotation"], left).unwrap(),
            "3 of 24 runs are not valid and were left out: rotation (2); at grip (1)"
        );
        assert_eq!(say(24, &["rotation"], kept).unwrap(), "1 of 24 runs is not valid and was kept: rotation (1)");
        assert_eq!(say(1, &["no peak"], Verdict::NoResult).unwrap(), "the only run gave no result: no peak");
        assert_eq!(say(1, &["slow"], Verdict::Caution).unwrap(), "the only run is to be read with caution: slow");
    }

    #[test]
    fn reasons_that_differ_in_numbers_are_one_and_many_reasons_are_counted() {
        let say = |all, found: &[&str]| Tally::of(all, found.iter().copied()).sentence(Verdict::NoResult).unwrap();
        let stress = |number: &str| format!("no peak up to a strain of 2e-9: the largest stress is {number} MPa");
        let found = [stress("34.5"), stress("1.2e-3"), stress("7")];
        assert_eq!(
            say(9, &found.each_ref().map(String::as_str)),
            "3 of 9 runs gave no result: no peak up to a strain of 2e-9: the largest stress is … MPa (3)"
        );
        assert_eq!(say(9, &["at 3", "at 3"]), "2 of 9 runs gave no result: at 3 (2)");
        assert_eq!(say(9, &["at 3", "on 3"]), "2 of 9 runs gave no result: at 3 (1); on 3 (1)");
        let many: Vec<String> = ('a'..='z').map(String::from).collect();
        let many: Vec<&str> = many.iter().map(String::as_str).collect();
        assert_eq!(
            say(40, &many),
            "26 of 40 runs gave no result: a (1); b (1); c (1); d (1); e (1); 21 other reasons (21)"
        );
        assert_eq!(
            say(40, &many[..6]),
            "6 of 40 runs gave no result: a (1); b (1); c (1); d (1); e (1); another reason (1)"
        );
        let whole = |text| pieces(text).map(|(_, piece)| piece).collect::<String>();
        for text in ["", "1", "1.", "1e", "1e+", "-1.5e-7x", "é1e5é", "e5.", "1..2", "1e5e6", "１"] {
            assert_eq!(whole(text), text);
        }
    }

    #[test]
    fn a_run_that_failed_is_not_counted_again_as_one_that_is_not_valid() {
        let verdicts = Verdicts {
            failures: words(&["", "no peak", "", ""]),
            checked: Some((words(&["rotation", "no peak", "", ""]), words(&["few", "", "few", ""]))),
        };
        let runs = Table::default().reals_column("UCS", "MPa", "", vec![1.0, f64::NAN, 2.0, 3.0]);
        let artifact = Results::of(runs, verdicts).to_artifact();
        assert_eq!(
            sentences(&artifact),
            [
                "1 of 4 runs gave no result: no peak (1)",
                "1 of 4 runs is not valid: rotation (1)",
                "1 of 4 runs is to be read with caution: few (1)"
            ]
        );
    }

    #[test]
    fn a_single_run_says_what_many_say() {
        let run = |failure: &str, validity: &str| {
            let validity = Some(validity.to_owned());
            sentences(&Run { validity, ..Run::plain(failure, Responses::default()) }.to_artifact())
        };
        assert_eq!(run("no peak", "no peak: 1"), ["the run gave no result: no peak"]);
        assert_eq!(run("", "rotation: 1 is above 0"), ["the run is not valid: rotation: 1 is above 0"]);
        assert!(run("", "").is_empty());
    }

    #[test]
    fn a_list_says_equal_sentences_once() {
        let list = NotValid {
            response: words(&["E", "UCS", "UCS"]),
            row: vec![2, 2, 3],
            runs: vec![4; 3],
            reason: words(&["a", "a", "b"]),
            treated: vec![Treated::LeftOut; 3],
        };
        assert_eq!(
            list.grouped_sentences(),
            [
                "E: 1 of 4 runs is not valid and was left out: a (1)",
                "UCS: 2 of 4 runs are not valid and were left out: a (1); b (1)"
            ]
        );
        assert_eq!([list.left_out("E"), list.left_out("UCS"), list.left_out("nu")], [1, 2, 0]);
        let both = NotValid {
            response: words(&["E", "UCS"]),
            row: vec![2, 2],
            runs: vec![4; 2],
            reason: words(&["a", "a"]),
            treated: vec![Treated::Kept; 2],
        };
        assert_eq!(both.grouped_sentences(), ["E, UCS: 1 of 4 runs is not valid and was kept: a (1)"]);
    }
}
