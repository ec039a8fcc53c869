//! The artifact of a design.

use super::super::StageError;
use super::valid::Broken;
use crate::artifact::design::{Design, DesignReport, DesignRows};
use crate::artifact::{Artifact, Table};
use design::{DesignTable, Report};
use std::collections::BTreeMap;

/// Names of the levels of categories, by factor.
type Names = BTreeMap<String, Vec<String>>;

/// The artifact of a design, with the rows of the `whole` table that were left out and the rules that they break.
pub(super) fn shortened(
    table: &DesignTable,
    report: &Report,
    names: &Names,
    (whole, broken): (&DesignTable, &[Broken]),
) -> Result<Artifact, StageError> {
    let mut left = Table { about: "rows left out, with the rules that they break".to_owned(), columns: Vec::new() }
        .ints_column(
            "standard_order",
            "place in the order of the construction",
            counted(broken.iter().map(|b| whole.standard_order[b.row])),
        )
        .texts_column("rule", "", broken.iter().map(|b| b.rule.clone()).collect())
        .reals_column("left_side", "", "of the rule, in `left_side_unit`", broken.iter().map(|b| b.value).collect())
        .texts_column("left_side_unit", "", broken.iter().map(|b| b.unit.clone()).collect());
    for (j, factor) in whole.factors.iter().enumerate() {
        left =
            left.reals_column(&factor.name, &factor.unit, "", broken.iter().map(|b| whole.natural[b.row][j]).collect());
    }
    Ok(Design { left_out: Some(left), ..stored(table, report, names)? }.to_artifact())
}

/// What is stored of a design.
pub(super) fn stored(table: &DesignTable, report: &Report, names: &Names) -> Result<Design, StageError> {
    let design = design(table, names)?;
    Ok(Design { design, coded: coded(table), report: lines(table, report), left_out: None })
}

fn counted(numbers: impl IntoIterator<Item = usize>) -> Vec<i64> {
    numbers.into_iter().map(|n| n as i64).collect()
}

fn design(table: &DesignTable, names: &Names) -> Result<Table, StageError> {
    let rows = DesignRows {
        run: counted(1..=table.runs()),
        standard_order: counted(table.standard_order.clone()),
        replicate: table.replicate().into_iter().map(|n| n as i64).collect(),
        point_type: table.point_type.iter().map(|p| p.word().to_owned()).collect(),
    };
    let mut found = Table { about: table.construction.clone(), ..rows.to_table() };
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

fn lines(table: &DesignTable, report: &Report) -> DesignReport {
    let lines = report.lines(table);
    let texts = |pick: &dyn Fn(&design::report::Line) -> String| lines.iter().map(pick).collect();
    DesignReport {
        section: texts(&|l| l.section.to_owned()),
        subject: texts(&|l| l.subject.clone()),
        quantity: texts(&|l| l.quantity.clone()),
        value: lines.iter().map(|l| l.value).collect(),
        text: texts(&|l| l.text.clone()),
    }
}
