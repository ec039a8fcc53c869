//! Summaries of the runs of earlier campaigns, so that a design with one new row does not read ten thousand old runs.
//!
//! A run is a function of its point, its replicate, and of parameters that all rows share. While the shared part is
//! unchanged, the runner knows the key and the result of an old row without making its task, and a [`RunSummary`]: all
//! that the gathered table needs of a run. Summaries only save work: the table is the same with them and without them.

use super::StageError;
use crate::artifact::run::{Outcome, Run};
use crate::artifact::{Artifact, ContentHash, Group, Key, Node, Table, Values};
use std::borrow::Cow;

/// A run of an earlier campaign.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CachedRun<'a> {
    /// Key of its task.
    pub key: Key,
    /// Its result.
    pub content: ContentHash,
    /// Its summary.
    pub summary: RunSummary<'a>,
}

/// The cached runs among the inputs of a gathering task.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CachedRuns {
    /// Of each run: its index among the inputs, design row, key of its task, and result.
    pub runs: Vec<(usize, usize, Key, ContentHash)>,
    /// Their summaries, in the same order.
    pub summaries: RunSummaries,
}

impl CachedRuns {
    /// An empty list with room for `count` runs.
    pub fn with_room(count: usize) -> Self {
        Self { runs: Vec::with_capacity(count), summaries: RunSummaries::with_room(count) }
    }

    /// Adds the run at an index among the inputs.
    pub fn push(&mut self, index: usize, row: usize, cached: CachedRun<'_>) {
        self.runs.push((index, row, cached.key, cached.content));
        self.summaries.push(cached.summary);
    }
}

/// Failure, validity and cautions of a run, as its [`Outcome`] has them.
type Verdict = (String, Option<String>, String);

/// Failure and validity of a run, and name, unit and value of each response.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RunSummary<'a> {
    verdict: &'a Verdict,
    names: &'a [(String, String)],
    values: &'a [f64],
}

impl<'a> RunSummary<'a> {
    /// The summary of a run.
    pub(super) fn responses(&self) -> Outcome<'a> {
        let found = self.names.iter().zip(self.values);
        let (failure, validity, cautions) = self.verdict;
        Outcome {
            failure,
            validity: validity.as_deref().map(Cow::Borrowed),
            cautions: Cow::Borrowed(cautions),
            responses: found.map(|((name, unit), value)| (name.as_str(), *value, unit.as_str())).collect(),
        }
    }
}

/// Summaries of many runs. Runs of one simulator share a few verdicts and names of responses, so each is stored once.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RunSummaries {
    verdicts: Vec<Verdict>,
    /// Names and units of the responses that some run has.
    shapes: Vec<Vec<(String, String)>>,
    /// Of each run: verdict, shape, and where its values begin.
    runs: Vec<[u32; 3]>,
    values: Vec<f64>,
}

impl RunSummaries {
    /// An empty list with room for `count` runs.
    pub fn with_room(count: usize) -> Self {
        Self { runs: Vec::with_capacity(count), ..Self::default() }
    }

    /// Number of runs.
    pub fn len(&self) -> usize {
        self.runs.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.runs.is_empty()
    }

    /// Adds a run.
    pub fn push(&mut self, summary: RunSummary<'_>) {
        let verdict = index_of(&mut self.verdicts, |known| known == summary.verdict, || summary.verdict.clone());
        let shape = index_of(&mut self.shapes, |known| known == summary.names, || summary.names.to_vec());
        self.runs.push([verdict, shape, self.values.len() as u32]);
        self.values.extend_from_slice(summary.values);
    }

    /// Adds the run of an artifact; false when it holds no responses.
    pub fn push_run(&mut self, run: &Artifact) -> bool {
        let Ok(Outcome { failure, validity, cautions, responses }) = Run::outcome(run) else { return false };
        let names: Vec<_> = responses.iter().map(|(name, _, unit)| ((*name).to_owned(), (*unit).to_owned())).collect();
        let values: Vec<f64> = responses.iter().map(|(_, value, _)| *value).collect();
        let verdict = (failure.to_owned(), validity.map(Cow::into_owned), cautions.into_owned());
        self.push(RunSummary { verdict: &verdict, names: &names, values: &values });
        true
    }

    /// One run.
    pub fn get(&self, run: usize) -> Option<RunSummary<'_>> {
        let [verdict, shape, first] = self.runs.get(run)?.map(|number| number as usize);
        let (verdict, names) = (self.verdicts.get(verdict)?, self.shapes.get(shape)?);
        Some(RunSummary { verdict, names, values: self.values.get(first..first + names.len())? })
    }

    /// The input `cached` of a job, with the index of each run among the inputs.
    pub fn artifact(&self, indices: &[usize]) -> Artifact {
        let indices = indices.iter().map(|index| *index as i64).collect();
        let indices = Table::default().ints_column("index", "", indices);
        let summaries = Node::Bytes(self.to_bytes());
        Artifact::new("cached", 1, Group::new().with("indices", Node::Table(indices)).with("summaries", summaries))
    }

    /// Reads what [`RunSummaries::artifact`] wrote: indices among the inputs, and the summaries.
    ///
    /// # Errors
    /// The artifact is another one.
    pub fn of_artifact(cached: &Artifact) -> Result<(&[i64], Self), StageError> {
        let indices = cached.table("indices").and_then(|table| table.column("index")).map(|column| &column.values);
        match (indices, cached.root.get("summaries")) {
            (Some(Values::Ints(indices)), Some(Node::Bytes(bytes))) => {
                let summaries = Self::from_bytes(bytes).filter(|summaries| summaries.len() == indices.len());
                Ok((indices, summaries.ok_or_else(|| StageError::new("the cached runs cannot be read"))?))
            }
            _ => Err(StageError::new("the cached runs hold no indices or no summaries")),
        }
    }

    /// Length, texts as JSON, three numbers for each run, values; little-endian.
    pub fn to_bytes(&self) -> Vec<u8> {
        let texts = serde_json::to_vec(&(&self.verdicts, &self.shapes)).unwrap_or_else(|e| panic!("BUG: texts: {e}"));
        let mut bytes = Vec::with_capacity(16 + texts.len() + 12 * self.runs.len() + 8 * self.values.len());
        bytes.extend_from_slice(&(texts.len() as u64).to_le_bytes());
        bytes.extend_from_slice(&(self.runs.len() as u64).to_le_bytes());
        bytes.extend_from_slice(&texts);
        self.runs.iter().flatten().for_each(|number| bytes.extend_from_slice(&number.to_le_bytes()));
        self.values.iter().for_each(|value| bytes.extend_from_slice(&value.to_bits().to_le_bytes()));
        bytes
    }

    /// Reads what [`RunSummaries::to_bytes`] wrote.
    pub fn from_bytes(bytes: &[u8]) -> Option<Self> {
        let mut rest = bytes;
        let mut take = |length: usize| {
            let (taken, left) = rest.split_at_checked(length)?;
            rest = left;
            Some(taken)
        };
        let mut number = || take(8)?.first_chunk().map(|number| u64::from_le_bytes(*number) as usize);
        let (texts, runs) = (number()?, number()?);
        let (verdicts, shapes) = serde_json::from_slice(take(texts)?).ok()?;
        let runs = take(runs.checked_mul(12)?)?.as_chunks::<4>().0.as_chunks::<3>().0;
        let runs = runs.iter().map(|run| run.map(u32::from_le_bytes)).collect();
        let (values, []) = rest.as_chunks::<8>() else { return None };
        let values = values.iter().map(|value| f64::from_bits(u64::from_le_bytes(*value))).collect();
        Some(Self { verdicts, shapes, runs, values })
    }
}

/// Index of the value in the list, to which it is added when it is new. The search begins at the last value.
fn index_of<T>(list: &mut Vec<T>, is: impl Fn(&T) -> bool, make: impl FnOnce() -> T) -> u32 {
    let found = list.iter().rposition(is).unwrap_or_else(|| {
        list.push(make());
        list.len() - 1
    });
    found as u32
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::artifact::ArtifactKind;
    use crate::artifact::run::Responses;

    fn run(failure: &str, responses: &[(&str, f64, &str)]) -> Artifact {
        Run::plain(failure, Responses::of(responses)).to_artifact()
    }

    #[test]
    fn briefs_hold_what_gathering_sees_and_survive_the_disk() {
        let runs = [
            run("", &[("UCS", 3e7, "Pa"), ("E", 2e10, "Pa")]),
            run("no peak", &[]),
            run("", &[("UCS", -0.0, "Pa"), ("E", f64::INFINITY, "Pa")]),
            run("", &[("E", 1.5, "GPa")]),
            Run { validity: Some("rotation".to_owned()), ..Run::plain("", Responses::of(&[("E", 2.5, "GPa")])) }
                .to_artifact(),
        ];
        let mut summaries = RunSummaries::default();
        assert!(runs.iter().all(|run| summaries.push_run(run)));
        assert!(!summaries.push_run(&Artifact::of(ArtifactKind::RUN, Group::new())));
        let bytes = summaries.to_bytes();
        let back = RunSummaries::from_bytes(&bytes).unwrap();
        assert_eq!((back.len(), back.shapes.len(), back.verdicts.len()), (5, 3, 3));
        for (number, run) in runs.iter().enumerate() {
            assert_eq!(back.get(number).unwrap().responses(), Run::outcome(run).unwrap());
        }
        assert_eq!(back.get(5), None);
        assert!((0..bytes.len()).all(|end| RunSummaries::from_bytes(&bytes[..end]).is_none_or(|cut| cut != back)));
    }
}
