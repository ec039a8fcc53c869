//! The inputs of a figure, with errors that name the missing table or column and the existing ones.

use super::super::{Job, StageError, artifact_kind};
use crate::artifact::{Artifact, ArtifactKind, Table, Values};
use std::sync::Arc;

/// The inputs of a figure by port.
pub(super) struct Sources<'a> {
    pub of: Vec<Source<'a>>,
    pub compare: Vec<Source<'a>>,
}

/// One input.
#[derive(Clone, Copy)]
pub(super) struct Source<'a>(pub &'a Artifact);

/// One table of an input.
#[derive(Clone, Copy)]
pub(super) struct Rows<'a> {
    pub table: &'a Table,
}

impl<'a> Sources<'a> {
    pub(super) fn new(job: &'a Job) -> Self {
        let pick = |port: &str| {
            let named = job.inputs.iter().filter(|(name, _)| name == port);
            named.map(|(_, artifact): &(String, Arc<Artifact>)| Source(artifact)).collect()
        };
        Self { of: pick("of"), compare: pick("compare") }
    }

    pub(super) fn first(&self) -> Result<Source<'a>, StageError> {
        self.of.first().copied().ok_or_else(|| StageError::new("`of` names no stage"))
    }
}

impl<'a> Source<'a> {
    /// The main table of its kind.
    pub(super) fn main(self) -> Result<Rows<'a>, StageError> {
        let name = artifact_kind(self.0).and_then(ArtifactKind::main_table);
        let found = name.and_then(|name| self.0.table(name)).map(|table| Rows { table });
        found.ok_or_else(|| StageError::new(format!("the artifact `{}` holds no table to draw", self.0.kind)))
    }
}

/// Names in an artifact, in the order of their first occurrence: those of columns, and the cells of its columns `factor`,
/// `source` and `term` in the rows of the response.
pub(super) fn words(artifact: &Artifact, response: Option<&str>) -> Vec<String> {
    let mut found: Vec<String> = Vec::new();
    for (_, table) in artifact.tables() {
        found.extend(table.columns.iter().map(|column| column.name.clone()));
        let texts = |name: &str| match table.column(name).map(|column| &column.values) {
            Some(Values::Texts(texts)) => Some(texts),
            Some(_) | None => None,
        };
        let mine = |i: usize| texts("response").is_none_or(|r| response.is_none_or(|wanted| r[i] == wanted));
        for column in ["factor", "source", "term"] {
            let rows = texts(column).into_iter().flatten().enumerate().filter(|(i, _)| mine(*i));
            let parts = rows.flat_map(|(_, text)| text.split('*').map(|part| part.split('^').next().unwrap_or(part)));
            found.extend(parts.map(|part| part.trim().to_owned()));
        }
    }
    found
}

impl Rows<'_> {
    pub(super) fn has(self, column: &str) -> bool {
        self.table.column(column).is_some()
    }

    pub(super) fn len(self) -> usize {
        self.table.rows()
    }

    /// The numbers of a column in the unit of the figure.
    pub(super) fn reals(self, column: &str, unit: &str) -> Result<Vec<f64>, StageError> {
        Ok(self.table.numbers(column, unit)?)
    }
}

/// Indices of the rows of the response of the figure.
pub(super) fn rows_of(responses: &[String], wanted: &str) -> Result<Vec<usize>, StageError> {
    let rows: Vec<usize> = (0..responses.len()).filter(|&row| responses[row] == wanted).collect();
    if rows.is_empty() {
        let mut there = responses.to_vec();
        there.sort();
        there.dedup();
        let message = format!("the analysis has no response `{wanted}`");
        return Err(StageError::new(message).hint(format!("it has {}", there.join(", "))));
    }
    Ok(rows)
}

/// The values at the given rows.
pub(super) fn pick<T: Clone>(values: &[T], rows: &[usize]) -> Vec<T> {
    rows.iter().filter_map(|&i| values.get(i).cloned()).collect()
}
