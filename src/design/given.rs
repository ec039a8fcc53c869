//! A design whose rows are given, from a file or a published table: nothing is constructed, everything is checked.

use super::coding::{Domain, Factor};
use super::error::Fault;
use super::table::{PointType, Points, Position};
use super::{Design, Stream, is_default};
use serde::{Deserialize, Serialize};

/// Rows of natural values, or of numbers of levels, one a factor.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Given {
    /// The rows, in the factors' order and units.
    pub rows: Vec<Vec<f64>>,
    /// Where they come from.
    #[serde(default, skip_serializing_if = "is_default")]
    pub source: String,
    /// The rows hold numbers of the factors' levels, from 1, as published tables do.
    #[serde(default, skip_serializing_if = "is_default")]
    pub by_level: bool,
}

/// What to do with a number that is that of no level.
const BY_LEVEL: &str =
    "declare the level, correct the row, or leave `by_level` out and write values instead of numbers of levels";

/// Index of the level numbered `number`, among `count`.
fn level(number: f64, count: usize) -> Option<usize> {
    (0..count).find(|&i| (i + 1) as f64 == number)
}

impl Given {
    /// Faults of one row, numbered from 1.
    fn row_faults(&self, row: usize, values: &[f64], factors: &[Factor]) -> Vec<Fault> {
        if values.len() != factors.len() {
            let wanted = format!("a row needs one value for each of the {} factors", factors.len());
            return vec![Fault::BadRow { row, found: format!("{} values", values.len()), wanted }];
        }
        let wrong = |(value, factor): (&f64, &Factor)| {
            let wanted = match &factor.domain {
                _ if !value.is_finite() => "a design needs a finite number in every cell".to_string(),
                Domain::Levels(levels) if self.by_level => {
                    if level(*value, levels.len()).is_some() {
                        return None;
                    }
                    format!("its levels are numbered 1 to {}: {BY_LEVEL}", levels.len())
                }
                Domain::Range { .. } if self.by_level => format!("it has a range and no levels: {BY_LEVEL}"),
                Domain::Levels(levels) if !levels.contains(value) => {
                    let levels: Vec<String> = levels.iter().map(ToString::to_string).collect();
                    format!("its levels are {}; declare the level or correct the row", levels.join(", "))
                }
                Domain::Range { low, high } if !(*low..=*high).contains(value) => {
                    format!("its range is {low} to {high}; widen it or correct the row")
                }
                _ => return None,
            };
            Some(Fault::BadRow { row, found: format!("`{}` is {value}", factor.name), wanted })
        };
        values.iter().zip(factors).filter_map(wrong).collect()
    }
}

impl Design for Given {
    const NAME: &'static str = "given";

    fn points(&self, factors: &[Factor], _: &mut Stream) -> Result<Points, Vec<Fault>> {
        let mut faults: Vec<Fault> =
            self.rows.iter().enumerate().flat_map(|(i, row)| self.row_faults(i + 1, row, factors)).collect();
        if self.rows.is_empty() {
            let wanted = "give at least one row".to_string();
            faults.push(Fault::BadOption { option: "rows".into(), found: "empty".into(), wanted });
        }
        if !faults.is_empty() {
            return Err(faults);
        }
        let position = |(&x, f): (&f64, &Factor)| match level(x, f.level_count()) {
            Some(level) if self.by_level => Position::Level(level),
            _ => Position::Natural(x),
        };
        let row = |row: &Vec<f64>| (row.iter().zip(factors).map(position).collect(), PointType::Given);
        Ok(Points {
            rows: self.rows.iter().map(row).collect(),
            centre: 0,
            construction: format!("{} given rows", self.rows.len()),
            source: self.source.clone(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Layout, Method, build};

    #[test]
    fn rows_keep_their_values_and_bad_cells_are_all_named() {
        let factors = [Factor::levels("Ec", "GPa", &[10.0, 20.0]), Factor::range("mu", "", 0.5, 1.5)];
        let design = |rows: &[&[f64]]| {
            let rows = rows.iter().map(|r| r.to_vec()).collect();
            build(&Method::Given(Given { rows, ..Default::default() }), &factors, Layout::default(), 1)
        };
        let t = design(&[&[10.0, 0.7], &[20.0, 1.5], &[10.0, 0.7]]).unwrap();
        assert_eq!((t.natural[0].as_slice(), t.coded[1].as_slice()), ([10.0, 0.7].as_slice(), [1.0, 1.0].as_slice()));
        assert_eq!(t.replicate(), [1, 1, 2]);
        let text = design(&[&[15.0, 0.7], &[20.0, f64::NAN], &[10.0], &[10.0, 2.0]]).unwrap_err().to_string();
        for part in
            ["row 1: `Ec` is 15; its levels are 10, 20", "row 2: `mu` is NaN", "row 3: 1 values", "row 4: `mu` is 2"]
        {
            assert!(text.contains(part), "{part} not in {text}");
        }
        let numbers = |rows: Vec<Vec<f64>>, factors: &[Factor]| {
            let given = Given { rows, by_level: true, ..Default::default() };
            build(&Method::Given(given), factors, Layout::default(), 1)
        };
        let levels = [factors[0].clone(), Factor::levels("mu", "", &[1.5, 0.5])];
        assert_eq!(numbers(vec![vec![2.0, 1.0], vec![1.0, 2.0]], &levels).unwrap().natural, [[20.0, 1.5], [10.0, 0.5]]);
        let text = numbers(vec![vec![3.0, 1.5]], &levels).unwrap_err().to_string();
        assert!(
            text.contains("`Ec` is 3; its levels are numbered 1 to 2") && text.contains("`mu` is 1.5; its"),
            "{text}"
        );
        assert!(numbers(vec![vec![1.0, 1.0]], &factors).unwrap_err().to_string().contains("`mu` is 1; it has a range"));
        assert!(design(&[]).unwrap_err().to_string().contains("`rows` is empty"));
    }
}
