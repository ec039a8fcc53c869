//! The artifact of a design.

use super::super::StageError;
use super::valid::Broken;
use crate::artifact::{Artifact, ArtifactKind, Group, Node, Table};
use design::{DesignTable, Report};
use std::collections::BTreeMap;

/// Names of the levels of categories, by factor.
type Names = BTreeMap<String, Vec<String>>;

/// As [`artifact`], with the rows of the `whole` table that were left out and the rules that they break.
pub(super) fn shortened(
    table: &DesignTable,
    report: &Report,
    names: &Names,
    (whole, broken): (&DesignTable, &[Broken]),
) -> Result<Artifact, StageError> {
    let mut made = artifact(table, report, names)?;
    let mut left = Table { about: "rows left out, with the rules that they break".to_owned(), columns: Vec::new() }
        .ints_column(
            "standard_order",
            "place in the order of the construction",
            counted(broken.iter().map(|b| whole.standard_order[b.row])),
        )
        .texts_column("rule", "", broken.iter().map(|b| b.rule.clone()).collect())
        .reals_column("left_side", "", "of the rule, in SI units", broken.iter().map(|b| b.value).collect());
    for (j, factor) in whole.factors.iter().enumerate() {
        left =
            left.reals_column(&factor.name, &factor.unit, "", broken.iter().map(|b| whole.natural[b.row][j]).collect());
    }
    made.root.put("left_out", Node::Table(left));
    Ok(made)
}

/// The tables `design`, `coded` and `report`.
pub(super) fn artifact(table: &DesignTable, report: &Report, names: &Names) -> Result<Artifact, StageError> {
    let root = Group::new()
        .with("design", Node::Table(design(table, names)?))
        .with("coded", Node::Table(coded(table)))
        .with("report", Node::Table(lines(table, report)));
    Ok(Artifact::of(ArtifactKind::DESIGN, root))
}

fn counted(numbers: impl IntoIterator<Item = usize>) -> Vec<i64> {
    numbers.into_iter().map(|n| n as i64).collect()
}

fn design(table: &DesignTable, names: &Names) -> Result<Table, StageError> {
    let replicate = table.replicate().into_iter().map(|n| n as i64).collect();
    let types = table.point_type.iter().map(|p| p.word().to_owned()).collect();
    let mut found = Table { about: table.construction.clone(), columns: Vec::new() }
        .ints_column("run", "order of the runs", counted(1..=table.runs()))
        .ints_column("standard_order", "place in the order of the construction", counted(table.standard_order.clone()))
        .ints_column("replicate", "which of the equal rows it is", replicate)
        .texts_column("point_type", "centre, cube, axial, edge, grid, sample or given", types);
    for (j, factor) in table.factors.iter().enumerate() {
        let values = table.natural.iter().map(|row| row[j]).collect();
        if let Some(names) = names.get(&factor.name) {
            let name = |row: &Vec<f64>| names.get(row[j] as usize).filter(|_| row[j].fract() == 0.0).cloned();
            let all: Option<Vec<String>> = table.natural.iter().map(name).collect();
            let message = || format!("the design sets `{}` between its levels, which are names", factor.name);
            let hint = "leave out centre points, or take a factorial or orthogonal design";
            found = found.texts_column(&factor.name, "", all.ok_or_else(|| StageError::new(message()).hint(hint))?);
            continue;
        }
        found = found.reals_column(&factor.name, &factor.unit, "", values);
    }
    Ok(found)
}

fn coded(table: &DesignTable) -> Table {
    let about = "-1 and +1 are the ends of the range".to_owned();
    let mut found = Table { about, columns: Vec::new() }.ints_column("run", "", counted(1..=table.runs()));
    for (j, factor) in table.factors.iter().enumerate() {
        found = found.reals_column(&factor.name, "", "", table.coded.iter().map(|row| row[j]).collect());
    }
    found
}

fn lines(table: &DesignTable, report: &Report) -> Table {
    let lines = report.lines(table);
    let texts = |pick: &dyn Fn(&design::report::Line) -> String| lines.iter().map(pick).collect();
    Table { about: "what the design can tell, judged by its rows".to_owned(), columns: Vec::new() }
        .texts_column("section", "", texts(&|l| l.section.to_owned()))
        .texts_column("subject", "factor, term or model", texts(&|l| l.subject.clone()))
        .texts_column("quantity", "", texts(&|l| l.quantity.clone()))
        .reals_column("value", "", "missing where words say it", lines.iter().map(|l| l.value).collect())
        .texts_column("text", "", texts(&|l| l.text.clone()))
}
