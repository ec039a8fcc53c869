//! The treatment of runs that are not valid in a figure, and the footnote on them.

use super::super::StageError;
use super::super::invalid::{Invalid, note, sentence};
use super::source::Sources;
use super::{Figure, Params, Show, lost};
use crate::artifact::results::Results;
use crate::artifact::validity::{Statement, Verdict, faults, of_runs};
use crate::artifact::{Artifact, ArtifactKind};

impl Figure {
    /// The default: a figure of a table of runs treats them as statistics do, a figure of one run draws it.
    pub(super) fn choice(&self) -> Invalid {
        self.invalid.unwrap_or(if self.show.needs().runs { Invalid::LeaveOut } else { Invalid::Keep })
    }
}

/// The sentences below the picture, as labels.
///
/// # Errors
/// A run is not valid and refused.
pub(super) fn sentences(params: &Params, sources: &Sources) -> Result<Vec<String>, StageError> {
    let mut found = params.notes.clone();
    // For curves the setting was applied when the runs were chosen.
    let all = sources.of.iter().chain(&sources.compare).filter(|_| params.show != Show::Curves);
    for (index, source) in all.enumerate() {
        for said in of_source(params, source.0)? {
            found.push(note(params.series.get(index).map_or("", String::as_str), &said, &params.symbols));
        }
    }
    found.extend(lost::sentences(params, sources)?.iter().map(|said| sentence("", said)));
    let mut sentences: Vec<String> = Vec::new();
    for said in found {
        if !sentences.contains(&said) {
            sentences.push(said);
        }
    }
    Ok(sentences)
}

fn of_source(params: &Params, artifact: &Artifact) -> Result<Vec<Statement>, StageError> {
    if artifact.is(ArtifactKind::RESULTS) {
        let runs = Results::table(artifact)?;
        let judged = params.invalid.judge(runs)?;
        let verdict = if params.show.needs().runs { judged.verdict() } else { Verdict::NotValid };
        return Ok(of_runs(runs, verdict).into_iter().map(Statement::from).collect());
    }
    if artifact.is(ArtifactKind::RUN) && params.invalid == Invalid::Refuse {
        params.invalid.of_run(artifact, "the run")?;
    }
    Ok(faults(artifact))
}
