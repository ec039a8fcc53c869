//! Columns that stages read from the tables of others: one that no table can have is refused before anything runs.
//!
//! The columns of a data file are known when the file is read by `check`; those of a simulator with a design are the factors
//! of the design, its responses, and the program's own.

use super::derived::factors_of_formula;
use super::{Complaint, Context, Named, OWN_COLUMNS};
use std::collections::BTreeMap;

/// Columns that a stage names under one key.
#[derive(Debug, PartialEq, Eq)]
pub struct Reads {
    /// Path of the key below the table of the stage.
    pub path: String,
    /// The stages whose tables are read.
    pub stages: Vec<String>,
    /// Names of columns, or formulas of them.
    pub columns: Vec<String>,
}

impl Reads {
    /// These columns of one table.
    pub(super) fn of<'a>(path: &str, stage: &str, columns: impl IntoIterator<Item = &'a String>) -> Self {
        let columns = columns.into_iter().cloned().collect();
        Self { path: path.to_owned(), stages: vec![stage.to_owned()], columns }
    }

    /// Complaints about columns that none of the tables has, where the columns of all are known.
    pub fn missing(&self, known: &BTreeMap<String, Vec<String>>) -> Vec<Complaint> {
        let tables = self.stages.iter().map(|stage| Some((stage, known.get(stage)?)));
        let Some(tables) = tables.collect::<Option<Vec<_>>>().filter(|all| !all.is_empty()) else {
            return Vec::new();
        };
        let there = |name: &String| tables.iter().any(|(_, columns)| columns.contains(name));
        let parts = |name: &String| match there(name) {
            true => Vec::new(),
            false => factors_of_formula(name).unwrap_or_else(|| vec![name.clone()]),
        };
        let mut lost: Vec<String> = self.columns.iter().flat_map(parts).filter(|name| !there(name)).collect();
        lost.sort();
        lost.dedup();
        let complaint = |column: String| {
            let whose = tables.iter().map(|(stage, _)| format!("`{stage}`")).collect::<Vec<_>>().join(" or ");
            let has = tables.iter().map(|(stage, columns)| format!("`{stage}` has {}", listed(columns)));
            let alike = tables.iter().find_map(|(_, columns)| look_alike(&column, columns));
            let renamed = tables.iter().find_map(|(stage, columns)| renamed(&column, stage, columns));
            let hint = alike.into_iter().chain(has).chain(renamed).collect::<Vec<_>>().join("; ");
            Complaint::new(&self.path, format!("`{column}` is no column of {whose}"))
                .missing(Named::Column, &column)
                .among(tables.iter().flat_map(|(_, columns)| *columns))
                .hint(hint)
        };
        lost.into_iter().map(complaint).collect()
    }
}

/// Names of columns, as many as a person reads.
fn listed(columns: &[String]) -> String {
    const MOST: usize = 20;
    // The program's own columns help nobody to find the right name.
    let names: Vec<&str> = columns.iter().map(String::as_str).filter(|name| !OWN_COLUMNS.contains(name)).collect();
    let more = names.len().saturating_sub(MOST);
    let names = names[..names.len() - more].join(", ");
    if more > 0 { format!("{names} and {more} more") } else { names }
}

/// Says which column looks like this name and is another: letters of another script stand in it, or marks without width.
fn look_alike(name: &str, columns: &[String]) -> Option<String> {
    let strange = |column: &&String| {
        let visible: Vec<char> = column.chars().filter(|c| !is_without_width(*c)).collect();
        let same = |(own, other): (char, &char)| own == *other || !other.is_ascii();
        visible.len() == name.chars().count() && name.chars().zip(&visible).all(same)
    };
    let column = columns.iter().find(strange)?;
    let letters: Vec<String> =
        column.chars().filter(|c| !c.is_ascii()).map(|c| format!("U+{:04X}", u32::from(c))).collect();
    Some(format!("the file has `{column}`, which holds {} and only looks the same", letters.join(", ")))
}

/// How a column gets this name whose own differs from it in signs that no name here can have: `w/z` for `wz`.
fn renamed(name: &str, stage: &str, columns: &[String]) -> Option<String> {
    let letters = |text: &str| text.chars().filter(|c| c.is_alphanumeric()).collect::<String>().to_lowercase();
    let other = |column: &&String| *column != name && !is_name(column) && letters(column) == letters(name);
    let column = columns.iter().find(other)?;
    Some(format!("a column of `{stage}` gets another name by `rename = {{ {column:?} = {name:?} }}`"))
}

/// Whether a column can be a factor or a response by its own name.
fn is_name(column: &str) -> bool {
    column.chars().all(|c| c.is_ascii_alphanumeric() || c == '_' || c == '-')
}

/// Marks that nobody sees.
fn is_without_width(c: char) -> bool {
    matches!(c, '\u{ad}' | '\u{200b}'..='\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2060}'..='\u{2069}' | '\u{feff}')
}

/// The columns of the runs of a simulator with this design, where its responses are known.
pub fn of_simulator(simulator: &str, design: &str, context: &Context) -> Option<Vec<String>> {
    let responses = context.sketches.get(simulator)?.responses.as_ref()?;
    let factors = context.sketches.get(design)?.factors.as_ref()?;
    let own = OWN_COLUMNS.iter().map(|&name| name.to_owned());
    Some(factors.iter().chain(responses).cloned().chain(own).collect())
}

/// The complaint about a table without any factor, or without any response, in which nothing can be analysed.
pub fn nothing_to_analyse(port: &str, stage: &str, columns: &[String], context: &Context) -> Option<Complaint> {
    let lacks = |declared: &dyn Fn(&String) -> bool| !columns.iter().any(declared);
    let section = match () {
        () if lacks(&|name| context.factors.contains_key(name)) => "factor",
        () if lacks(&|name| context.responses.contains_key(name)) => "response",
        () => return None,
    };
    let complaint = Complaint::new(port, format!("no column of `{stage}` is a [{section}]"));
    let mut declared = context.factors.keys().chain(context.responses.keys()).filter(|name| !columns.contains(name));
    let hint = declared.find_map(|name| look_alike(name, columns));
    let hint = hint.unwrap_or_else(|| format!("declare one, such as [{section}.NAME]"));
    Some(complaint.hint(format!("{hint}; `{stage}` has {}", listed(columns))))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn known() -> BTreeMap<String, Vec<String>> {
        let columns = |names: &[&str]| names.iter().map(|&name| name.to_owned()).collect();
        let many = (0..30).map(|number| format!("c{number}")).collect();
        [
            ("cores".to_owned(), columns(&["sample", "Ec", "UCS", "w/c"])),
            ("logs".to_owned(), columns(&["depth"])),
            ("wide".to_owned(), many),
        ]
        .into()
    }

    fn said(stages: &[&str], columns: &[&str]) -> Vec<String> {
        let all = |names: &[&str]| names.iter().map(|&name| name.to_owned()).collect();
        let reads = Reads { path: "x".to_owned(), stages: all(stages), columns: all(columns) };
        let text = |own: Complaint| format!("{}; {}", own.message, own.hint.unwrap_or_default());
        reads.missing(&known()).into_iter().map(text).collect()
    }

    #[test]
    fn a_column_that_no_table_has_is_named_with_those_that_there_are() {
        assert_eq!(said(&["cores"], &["Ec", "UCS"]), [""; 0]);
        assert_eq!(said(&["cores"], &["UCT"]), ["`UCT` is no column of `cores`; `cores` has sample, Ec, UCS, w/c"]);
        let both = "`UCT` is no column of `cores` or `logs`; `cores` has sample, Ec, UCS, w/c; `logs` has depth";
        assert_eq!(said(&["cores", "logs"], &["UCT", "depth"]), [both]);
        assert!(said(&["wide"], &["x"])[0].ends_with(", c19 and 10 more"));
    }

    #[test]
    fn a_column_whose_name_no_workflow_can_use_is_renamed() {
        let wanted = "; a column of `cores` gets another name by `rename = { \"w/c\" = \"wc\" }`";
        assert!(said(&["cores"], &["wc"])[0].ends_with(wanted));
    }

    #[test]
    fn a_table_that_is_not_known_may_have_any_column() {
        assert_eq!(said(&["cores", "runs"], &["UCT"]), [""; 0]);
        assert_eq!(said(&[], &["UCT"]), [""; 0]);
    }

    #[test]
    fn a_column_that_only_looks_the_same_is_told_by_its_letters() {
        let columns = |name: &str| vec!["a".to_owned(), name.to_owned()];
        let said = |name: &str, column: &str| look_alike(name, &columns(column));
        let cyrillic = "the file has `у`, which holds U+0443 and only looks the same";
        assert_eq!(said("y", "у").as_deref(), Some(cyrillic));
        assert!(said("UCS", "UCS\u{200b}").is_some_and(|words| words.contains("U+200B")));
        assert!(said("UCS", "U\u{ad}СS").is_some_and(|words| words.contains("U+00AD, U+0421")));
        assert_eq!([said("UCS", "UCT"), said("UCS", "UC"), said("y", "x")], [None, None, None]);
    }

    #[test]
    fn of_a_formula_its_factors_are_columns_unless_a_column_has_its_name() {
        assert_eq!(said(&["cores"], &["w/c", "ln(Ec)", "UCS^2"]), [""; 0]);
        assert_eq!(said(&["cores"], &["Ec/Em"]), ["`Em` is no column of `cores`; `cores` has sample, Ec, UCS, w/c"]);
    }
}
