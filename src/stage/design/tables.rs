//! The artifact of a design.

use super::valid::Broken;
use crate::artifact::design::{Design, DesignReport, DesignRows};
use crate::artifact::{Artifact, Table};
use design::{DesignTable, Report};

/// As [`artifact`], with the rows of the `whole` table that were left out and the rules that they break.
pub(super) fn shortened(table: &DesignTable, report: &Report, whole: &DesignTable, broken: &[Broken]) -> Artifact {
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
    Design { left_out: Some(left), ..stored(table, report) }.to_artifact()
}

/// The storable form.
pub(super) fn artifact(table: &DesignTable, report: &Report) -> Artifact {
    stored(table, report).to_artifact()
}

fn stored(table: &DesignTable, report: &Report) -> Design {
    Design { design: design(table), coded: coded(table), report: lines(table, report), left_out: None }
}

fn counted(numbers: impl IntoIterator<Item = usize>) -> Vec<i64> {
    numbers.into_iter().map(|n| n as i64).collect()
}

fn design(table: &DesignTable) -> Table {
    let rows = DesignRows {
        run: counted(1..=table.runs()),
        standard_order: counted(table.standard_order.clone()),
        replicate: table.replicate().into_iter().map(|n| n as i64).collect(),
        point_type: table.point_type.iter().map(|p| p.word().to_owned()).collect(),
    };
    let mut found = Table { about: table.construction.clone(), ..rows.to_table() };
    for (j, factor) in table.factors.iter().enumerate() {
        let values = table.natural.iter().map(|row| row[j]).collect();
        found = found.reals_column(&factor.name, &factor.unit, "", values);
    }
    found
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
