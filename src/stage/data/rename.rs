//! `rename = { "w/z" = "wc" }`: columns whose names in the file no workflow can use.

use super::super::StageError;
use super::super::sheet::Sheet;
use super::cells::name_and_unit;
use std::collections::BTreeMap;

/// Columns that a message lists at most.
const MOST_LISTED: usize = 30;

/// Gives the columns of a sheet their new names. `renames` goes from the name in the file, with or without its unit, to the
/// new one, which may bring a unit where the file has none. Every other unit stays.
///
/// # Errors
/// The file has no such column, several, or a unit of its own beside a new one; the new name is empty.
pub(super) fn rename(sheet: &mut Sheet, renames: &BTreeMap<String, String>) -> Result<(), StageError> {
    let mut heads = sheet.heads.clone();
    for (old, new) in renames {
        let index = index_of(old, &sheet.heads)?;
        heads[index] = renamed(&sheet.heads[index], new)?;
    }
    sheet.heads = heads;
    Ok(())
}

/// The column with this head, or else with this name.
fn index_of(old: &str, heads: &[String]) -> Result<usize, StageError> {
    if let Some(index) = heads.iter().position(|head| head == old) {
        return Ok(index);
    }
    let names: Vec<&str> =
        heads.iter().map(|head| name_and_unit(head).map_or(head.as_str(), |(name, _)| name)).collect();
    let mut found = (0..names.len()).filter(|index| names[*index] == old);
    match (found.next(), found.next()) {
        (Some(index), None) => Ok(index),
        (Some(_), Some(_)) => Err(StageError::new(format!("rename: several columns are called `{old}`"))
            .hint("write the whole head of one of them, with its unit")),
        (None, _) => {
            let mut listed =
                names.iter().take(MOST_LISTED).map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", ");
            if names.len() > MOST_LISTED {
                listed += &format!(", … ({} in all)", names.len());
            }
            Err(StageError::new(format!("rename: no column is called `{old}`")).hint(format!("the file has {listed}")))
        }
    }
}

/// The new head of a column.
fn renamed(head: &str, new: &str) -> Result<String, StageError> {
    let ((old, unit), (name, own)) = (name_and_unit(head)?, name_and_unit(new)?);
    if name.trim().is_empty() {
        return Err(StageError::new(format!("rename: the new name of `{old}` is empty")));
    }
    match (unit, own) {
        ("", _) => Ok(new.to_owned()),
        (unit, "") => Ok(format!("{name} [{unit}]")),
        (unit, own) => {
            Err(StageError::new(format!("rename: `{old}` has the unit `{unit}` in the file, and `{own}` here"))
                .hint(format!("leave out the unit: \"{name}\"")))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn heads(heads: &[&str], renames: &[(&str, &str)]) -> Result<Vec<String>, StageError> {
        let heads: Vec<String> = heads.iter().map(|&head| head.to_owned()).collect();
        let mut sheet = Sheet { columns: vec![Vec::new(); heads.len()], heads };
        let renames = renames.iter().map(|&(old, new)| (old.to_owned(), new.to_owned())).collect();
        rename(&mut sheet, &renames).map(|()| sheet.heads)
    }

    #[test]
    fn names_change_and_units_stay() {
        let file = ["w/z", "Festigkeit (MPa)", "E-Modul/GPa", "Zeit"];
        let asked = [("w/z", "wc"), ("Festigkeit", "UCS"), ("E-Modul/GPa", "E"), ("Zeit", "age [d]")];
        assert_eq!(heads(&file, &asked).unwrap(), ["wc", "UCS [MPa]", "E [GPa]", "age [d]"]);
        // two columns may change names with each other
        assert_eq!(heads(&["a [m]", "b [s]"], &[("a", "b"), ("b", "a")]).unwrap(), ["b [m]", "a [s]"]);
    }

    #[test]
    fn faults_name_the_column() {
        let file = ["w/z", "UCS [MPa]", "UCS [kPa]"];
        let fault = |old: &str, new: &str| heads(&file, &[(old, new)]).unwrap_err();
        let unknown = fault("w/y", "wc");
        assert!(unknown.message.contains("no column is called `w/y`"), "{}", unknown.message);
        assert!(unknown.hint.unwrap().starts_with("the file has `w/z`, `UCS`"));
        assert!(fault("UCS", "q").message.contains("several columns"));
        assert!(fault("UCS [MPa]", "q [GPa]").message.contains("`MPa` in the file, and `GPa` here"));
        assert!(fault("w/z", " ").message.contains("is empty"));
    }
}
