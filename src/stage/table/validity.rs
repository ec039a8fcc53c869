//! The treatment of runs that are not valid in printed tables: shown and marked, left out, or refused, with a note.

use super::{Params, chosen, chosen_rows, find, named};
use crate::artifact::results::Results;
use crate::artifact::validity::{Statement, faults, of_runs};
use crate::artifact::{Artifact, ArtifactKind, Table};
use crate::stage::StageError;
use crate::stage::invalid::Invalid;
use figure::column::Column;

/// The column that marks runs that are not valid, where the table would not show it.
const MARK: &str = "validity";

/// The columns of one input, and the statements on its runs; no columns where its only run is left out.
///
/// # Errors
/// There is no such table or column, or a run is refused because it is not valid.
pub(super) fn printed(artifact: &Artifact, params: &Params) -> Result<(Vec<Column>, Vec<Statement>), StageError> {
    let table = find(artifact, params.table.as_deref())?;
    let (columns, mut said) = judged(artifact, table, params)?;
    said.extend(params.pivot.as_ref().and_then(|pivot| pivot.unplaced(table)));
    Ok((columns, said))
}

fn judged(artifact: &Artifact, table: &Table, params: &Params) -> Result<(Vec<Column>, Vec<Statement>), StageError> {
    if artifact.is(ArtifactKind::RUN) {
        let (shown, said) = params.invalid.of_run(artifact, "the run")?;
        let columns = if shown { chosen(table, params, &|_| true)? } else { Vec::new() };
        return Ok((columns, said.into_iter().map(Statement::from).collect()));
    }
    let runs = Results::table(artifact).ok().filter(|runs| std::ptr::eq(*runs, table));
    let Some(runs) = runs.filter(|_| artifact.is(ArtifactKind::RESULTS)) else {
        return Ok((chosen(table, params, &|_| true)?, faults(artifact)));
    };
    let judged = params.invalid.judge(runs)?;
    let mut columns = chosen(table, params, &|row| !judged.leaves_out(row))?;
    let said = of_runs(runs, judged.verdict());
    let marked = params.invalid == Invalid::Keep && judged.sentence().is_some() && params.pivot.is_none();
    if marked && columns.iter().all(|column| column.key != MARK) {
        columns.extend(named(table, &[MARK.to_owned()], params, &chosen_rows(table, params, &|_| true)?)?);
    }
    Ok((columns, said.into_iter().map(Statement::from).collect()))
}
