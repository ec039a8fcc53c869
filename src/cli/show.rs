//! `flow show`: a result as a table.

use super::Exit;
use super::common::Campaign;
use super::progress::Silent;
use crate::artifact::{Table, Values};
use crate::run::{Settings, StageStatus, run};
use clap::Args;
use std::sync::atomic::AtomicBool;

/// Show a result as a table.
#[derive(Args)]
pub(super) struct Show {
    #[command(flatten)]
    campaign: Campaign,
    /// The stage.
    stage: String,
    /// One table of it; all when not given.
    #[arg(long, value_name = "NAME")]
    table: Option<String>,
    /// As CSV, with units in the first line.
    #[arg(long)]
    csv: bool,
}

impl Show {
    pub(super) fn go(self) -> Exit {
        self.print().unwrap_or_else(|exit| exit)
    }

    fn print(&self) -> Result<Exit, Exit> {
        let workflow = self.campaign.load(std::slice::from_ref(&self.stage))?;
        let store = self.campaign.open()?;
        let settings =
            Settings { jobs: 0, keep_going: true, dry: true, targets: vec![self.stage.clone()], memos: true };
        let report = run(&workflow, &store, &settings, &Silent, &AtomicBool::new(false));
        let Some(StageStatus::Done(content)) =
            report.stages.iter().find(|stage| stage.name == self.stage).map(|stage| &stage.status)
        else {
            eprintln!("error: `{}` has no result yet; run it first", self.stage);
            return Err(Exit::BadInput);
        };
        let artifact = store.get(content).map_err(|e| {
            eprintln!("error: {e}");
            Exit::System
        })?;
        let tables = artifact.tables();
        let chosen: Vec<_> =
            tables.iter().filter(|(name, _)| self.table.as_ref().is_none_or(|wanted| wanted == name)).collect();
        if chosen.is_empty() {
            let known: Vec<&str> = tables.iter().map(|(name, _)| name.as_str()).collect();
            eprintln!("error: `{}` has no such table; it has {}", self.stage, known.join(", "));
            return Err(Exit::BadInput);
        }
        for (name, table) in chosen {
            if self.csv { print!("{}", csv_text(table)) } else { println!("{name}\n{}", text(table)) }
        }
        Ok(Exit::Done)
    }
}

fn cells(values: &Values) -> Vec<String> {
    match values {
        Values::Reals(values) => {
            values.iter().map(|v| if v.is_nan() { String::new() } else { v.to_string() }).collect()
        }
        Values::Ints(values) => values.iter().map(i64::to_string).collect(),
        Values::Texts(values) => values.clone(),
    }
}

fn text(table: &Table) -> comfy_table::Table {
    let mut shown = comfy_table::Table::new();
    shown.load_style(comfy_table::presets::UTF8_BORDERS_ONLY);
    let head = |column: &crate::artifact::Column| match column.unit.as_str() {
        "" => column.name.clone(),
        unit => format!("{} [{unit}]", column.name),
    };
    shown.set_header(table.columns.iter().map(head));
    let columns: Vec<Vec<String>> = table.columns.iter().map(|column| cells(&column.values)).collect();
    for row in 0..table.rows() {
        shown.add_row(columns.iter().map(|column| &column[row]));
    }
    shown
}

fn csv_text(table: &Table) -> String {
    let columns: Vec<Vec<String>> = table.columns.iter().map(|column| cells(&column.values)).collect();
    let mut out = csv::Writer::from_writer(Vec::new());
    let head = table.columns.iter().map(|column| match column.unit.as_str() {
        "" => column.name.clone(),
        unit => format!("{} [{unit}]", column.name),
    });
    let written = out.write_record(head).and_then(|()| {
        (0..table.rows()).try_for_each(|row| out.write_record(columns.iter().map(|column| &column[row])))
    });
    match (written, out.into_inner()) {
        (Ok(()), Ok(bytes)) => String::from_utf8_lossy(&bytes).into_owned(),
        (Err(_), _) | (_, Err(_)) => panic!("BUG: writing a table to memory failed"),
    }
}
