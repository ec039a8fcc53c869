//! `workflows/su2021-published.toml` from nothing: the printed tables of Su et al. 2021 come out, each value judged.
#![allow(clippy::unwrap_used)]

use std::path::Path;
use std::process::Command;

fn flow(store: &Path, arguments: &[&str]) -> String {
    let mut command = Command::new(env!("CARGO_BIN_EXE_flow"));
    let output = command.args(arguments).arg("--store").arg(store).output().unwrap();
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

/// The rows of a table as shown, cell by cell under its heads.
struct Shown {
    heads: Vec<String>,
    rows: Vec<Vec<String>>,
}

impl Shown {
    fn of(store: &Path, workflow: &str, stage: &str, table: &str) -> Self {
        let text = flow(store, &["show", workflow, stage, "--table", table, "--csv"]);
        let mut reader = csv::Reader::from_reader(text.as_bytes());
        let heads = reader.headers().unwrap().iter().map(String::from).collect();
        let rows = reader.records().map(|row| row.unwrap().iter().map(String::from).collect()).collect();
        Self { heads, rows }
    }

    fn cell<'a>(&self, row: &'a [String], head: &str) -> &'a str {
        &row[self.heads.iter().position(|h| h == head).unwrap_or_else(|| panic!("no `{head}` in {:?}", self.heads))]
    }

    /// `response line` of the rows with a printed value that the computed one does not meet, and how many are printed.
    fn off(&self, line: &str) -> (Vec<String>, usize) {
        let printed: Vec<_> = self.rows.iter().filter(|row| !self.cell(row, "published").is_empty()).collect();
        let differs = printed.iter().filter(|row| self.cell(row, "remark").starts_with("differs"));
        let name = |row: &&&Vec<String>| format!("{} {}", self.cell(row, "response"), self.cell(row, line));
        (differs.map(|row| name(&row)).collect(), printed.len())
    }
}

#[test]
fn tables_7_8_and_12_come_out_of_tables_6_9_10_and_11() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let workflow = root.join("workflows/su2021-published.toml");
    let workflow = workflow.to_str().unwrap();
    let store = tempfile::tempdir().unwrap();
    let store = store.path();
    flow(store, &["run", workflow, "--quiet"]);

    let table_7 = Shown::of(store, workflow, "anova", "anova");
    assert_eq!(table_7.heads[..8], ["response", "source", "df", "ss", "ms", "f", "p", "significance"]);
    assert_eq!(table_7.off("source"), (vec![], 39));
    let empty = table_7.rows.iter().find(|row| row[0] == "E" && row[1] == "null").unwrap();
    assert!(table_7.cell(empty, "remark").starts_with("an empty column is significant"));

    let table_8 = Shown::of(store, workflow, "regression", "coefficients");
    assert_eq!(table_8.heads[..6], ["response", "term", "estimate", "std_error", "t", "p"]);
    let misprints = ["E kn_ks_j", "UCS const", "UCS sigma_c", "nu const"].map(String::from).to_vec();
    assert_eq!(table_8.off("term"), (misprints, 14));

    let table_12 = Shown::of(store, workflow, "rsm", "coefficients");
    assert_eq!(table_12.off("term"), (vec![], 42));
    let fit = Shown::of(store, workflow, "rsm", "fit");
    assert_eq!(fit.off("response"), (vec![], 3));

    let flagged = |stage| {
        let table = Shown::of(store, workflow, stage, "residuals");
        let outliers = table.rows.iter().filter(|row| table.cell(row, "flag").contains("outlier"));
        outliers.map(|row| format!("{} {}", table.cell(row, "response"), table.cell(row, "row"))).collect::<Vec<_>>()
    };
    assert_eq!(flagged("anova"), ["nu 14"]);
    assert_eq!(flagged("rsm"), ["E 12", "nu 14"]);
    let range = Shown::of(store, workflow, "range", "range");
    assert_eq!(range.heads[..7], ["response", "factor", "level_1", "level_2", "level_3", "range", "rank"]);
}
