//! The start of proportional corrections: the slope K of the response on the factor, known from an earlier analysis.
//!
//! A table of slopes has a column for each held factor that K depends on and one for K, like the table of a regression by groups.
//! K at the held values of a set is interpolated: linearly along every held factor where the table is a full grid of
//! their values, and clamped to the grid's edge outside. The first value of the factor is then target / K, or
//! target / (K c) where the slope is that on c times the factor, with c from `regressor`.

use super::params::SetParam;
use crate::artifact::{Artifact, Table};
use crate::expression::{Expression, Measure};
use crate::stage::StageError;
use crate::unit::Dimension;
use optim::proportional;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Settings of the proportional corrections.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Slope {
    /// Number of runs of a set: the first one, and corrected ones; 2 by default. With more their slopes are averaged.
    pub runs: Option<usize>,
    /// The slope itself, response over factor in their units.
    pub slope: Option<f64>,
    /// The stage whose table holds slopes by held factors.
    pub slopes: Option<String>,
    /// Name of that table; `runs` by default.
    pub table: Option<String>,
    /// The column of slopes; `slope` by default.
    pub column: Option<String>,
    /// The quantity that the slope multiplies: a formula of the factor and of held factors in their units that is proportional
    /// to the factor, such as `sigma_cn / (1 + ratio)`; by default the factor itself.
    pub regressor: Option<String>,
}

impl Slope {
    /// The optimiser's settings.
    pub(super) fn method(&self) -> proportional::Settings {
        let usual = proportional::Settings::default();
        proportional::Settings { runs: self.runs.unwrap_or(usual.runs) }
    }

    /// Faults of the settings by themselves.
    pub(super) fn faults(&self) -> Vec<String> {
        let mut found = Vec::new();
        found.extend(self.regressor.as_ref().and_then(|text| Expression::parse(text).err()));
        if self.regressor.is_some() && self.slope.is_none() && self.slopes.is_none() {
            found.push("`regressor` has no effect without `slope` or `slopes`".to_owned());
        }
        if self.slope.is_some() && self.slopes.is_some() {
            found.push("either `slope` or `slopes`, not both".to_owned());
        }
        if self.slope.is_some_and(|slope| !(slope.is_finite() && slope != 0.0)) {
            found.push("`slope` must be a finite number other than 0".to_owned());
        }
        for (key, given) in [("table", self.table.is_some()), ("column", self.column.is_some())] {
            if given && self.slopes.is_none() {
                found.push(format!("`{key}` has no effect without `slopes`"));
            }
        }
        found
    }

    /// The quantity that the slope multiplies when the factor is 1, at the held values of a set.
    fn of_one(&self, factor: &str, held: &BTreeMap<String, f64>) -> Result<f64, StageError> {
        let Some(text) = &self.regressor else { return Ok(1.0) };
        let fail = |why: String| StageError::new(format!("`regressor`: {why}"));
        let formula = Expression::parse(text).map_err(fail)?;
        let at = |one: f64| {
            let value = |name: &String| {
                let value = if name == factor { Some(one) } else { held.get(name).copied() };
                let known = || fail(format!("`{name}` is neither the factor `{factor}` nor held"));
                Ok(Measure::of(value.ok_or_else(known)?, Dimension::NONE))
            };
            let values = formula.names().iter().map(value).collect::<Result<Vec<_>, StageError>>()?;
            formula.eval(&values).map(|measure| measure.value).map_err(fail)
        };
        let (one, two) = (at(1.0)?, at(2.0)?);
        if (two - 2.0 * one).abs() > 1e-9 * two.abs() {
            return Err(fail(format!("`{text}` is not proportional to `{factor}`")));
        }
        Ok(one)
    }

    /// The first value of the factor of a set; `None` when no slope is known.
    pub(super) fn first(
        &self,
        slopes: Option<&Artifact>,
        set: &SetParam,
        factor: &str,
    ) -> Result<Option<f64>, StageError> {
        let Some(target) = set.targets.first().and_then(|target| target.low.or(target.high)) else { return Ok(None) };
        let slope = match (self.slope, slopes) {
            (Some(slope), _) => slope,
            (None, Some(artifact)) => self.interpolated(artifact, &set.held)?,
            (None, None) => return Ok(None),
        };
        let slope = slope * self.of_one(factor, &set.held)?;
        let first = target / slope;
        if first.is_finite() {
            Ok(Some(first))
        } else {
            Err(StageError::new(format!("the slope {slope} leads to no first value")))
        }
    }

    fn interpolated(&self, artifact: &Artifact, held: &BTreeMap<String, f64>) -> Result<f64, StageError> {
        let name = self.table.as_deref().unwrap_or("runs");
        let table = artifact.table(name).ok_or_else(|| {
            StageError::new(format!("`slopes`: there is no table `{name}`")).hint("name it with `proportional.table`")
        })?;
        let column = self.column.as_deref().unwrap_or("slope");
        let slopes = numbers(table, column)?;
        let by: Vec<&String> = held.keys().filter(|name| table.column(name).is_some()).collect();
        let axis = |name: &&String| Ok((numbers(table, name)?, held[*name]));
        let axes: Vec<(Vec<f64>, f64)> = by.iter().map(axis).collect::<Result<_, StageError>>()?;
        if axes.is_empty() && slopes.len() != 1 {
            let held: Vec<&str> = held.keys().map(String::as_str).collect();
            let hint = format!("the columns are {}; held are {}", columns(table), held.join(", "));
            return Err(StageError::new(format!("table `{name}` holds slopes by no held factor")).hint(hint));
        }
        on_grid(&axes, &slopes).map_err(|corner| {
            let named = |(name, at): (&&String, &f64)| format!("{name} {at}");
            let at = |values: &[f64]| by.iter().zip(values).map(named).collect::<Vec<_>>().join(", ");
            let wanted: Vec<f64> = axes.iter().map(|(_, at)| *at).collect();
            let message = format!("table `{name}` has not one slope at {}, next to {}", at(&corner), at(&wanted));
            StageError::new(message).hint(
                "every combination of levels around the held values needs one; runs that are not valid and were left out \
                 leave gaps: `invalid = \"keep\"` in the stage of the slopes, or levels that stay valid",
            )
        })
    }
}

fn columns(table: &Table) -> String {
    table.columns.iter().map(|column| column.name.as_str()).collect::<Vec<_>>().join(", ")
}

fn numbers(table: &Table, name: &str) -> Result<Vec<f64>, StageError> {
    table.shown(name).map(|(values, _)| values).map_err(|_| {
        StageError::new(format!("`slopes`: there is no column of numbers `{name}`"))
            .hint(format!("the columns are {}", columns(table)))
    })
}

/// Interpolates at a point among rows that hold a full grid of their coordinates: each axis is the coordinate of every row
/// and that of the point. The error is a corner of the point's cell that has no row, or several rows that differ.
fn on_grid(axes: &[(Vec<f64>, f64)], values: &[f64]) -> Result<f64, Vec<f64>> {
    let cells: Option<Vec<_>> = axes.iter().map(|(rows, at)| cell(rows, *at)).collect();
    let cells = cells.ok_or_else(|| axes.iter().map(|(_, at)| *at).collect::<Vec<_>>())?;
    let mut sum = 0.0;
    for corner in 0..1_usize << cells.len() {
        let upper = |k: usize| corner >> k & 1 == 1;
        let share = |k: usize| if upper(k) { cells[k].2 } else { 1.0 - cells[k].2 };
        let weight: f64 = (0..cells.len()).map(share).product();
        if weight == 0.0 {
            continue;
        }
        let at = |k: usize| if upper(k) { cells[k].1 } else { cells[k].0 };
        let stands = |row: &usize| axes.iter().enumerate().all(|(k, (rows, _))| rows[*row] == at(k));
        let mut found = (0..values.len()).filter(stands).map(|row| values[row]).filter(|value| value.is_finite());
        match found.next() {
            Some(value) if !found.any(|other| other != value) => sum += weight * value,
            Some(_) | None => return Err((0..cells.len()).map(at).collect()),
        }
    }
    Ok(sum)
}

/// The neighbouring grid coordinates of a value, and its fraction between them.
fn cell(rows: &[f64], at: f64) -> Option<(f64, f64, f64)> {
    let below = rows.iter().copied().filter(|row| *row <= at).reduce(f64::max);
    let above = rows.iter().copied().filter(|row| *row >= at).reduce(f64::min);
    let (low, high) = (below.or(above)?, above.or(below)?);
    Some((low, high, if high > low { (at - low) / (high - low) } else { 0.0 }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::artifact::{ArtifactKind, Group, Node};

    fn sweep() -> Artifact {
        let table = Table::default()
            .reals_column("R_min", "mm", "", vec![0.1, 0.1, 0.2, 0.2])
            .reals_column("ratio", "", "", vec![1.0, 2.0, 1.0, 2.0])
            .reals_column("slope", "", "", vec![0.6, 0.8, 0.7, 1.1]);
        Artifact::of(ArtifactKind::RESULTS, Group::new().with("runs", Node::Table(table)))
    }

    fn at(r_min: f64, ratio: f64) -> Result<Option<f64>, StageError> {
        first(&sweep(), r_min, ratio)
    }

    fn first(sweep: &Artifact, r_min: f64, ratio: f64) -> Result<Option<f64>, StageError> {
        let target = serde_json::json!({ "response": "s", "unit": "MPa", "low": 9.0, "high": 9.0, "weight": 1.0 });
        let held = [("R_min".to_owned(), r_min), ("ratio".to_owned(), ratio)].into();
        let targets = vec![serde_json::from_value(target).unwrap()];
        Slope::default().first(Some(sweep), &SetParam { targets, held, start: None, seed: None }, "s")
    }

    /// Bilinear within the grid, clamped outside it.
    #[test]
    fn slopes_are_interpolated_at_the_held_values() {
        for ((r_min, ratio), slope) in [
            ((0.1, 2.0), 0.8),
            ((0.15, 1.0), 0.65),
            ((0.15, 1.5), 0.8),
            ((0.125, 1.25), 0.75 * (0.75 * 0.6 + 0.25 * 0.8) + 0.25 * (0.75 * 0.7 + 0.25 * 1.1)),
            ((0.3, 2.5), 1.1),
        ] {
            let first = at(r_min, ratio).unwrap().unwrap();
            assert!((first - 9.0 / slope).abs() < 1e-9, "{r_min}, {ratio}: {first}");
        }
    }

    #[test]
    fn a_gap_in_the_grid_is_named_where_a_held_value_needs_it() {
        let gap = Table::default()
            .reals_column("R_min", "mm", "", vec![0.1, 0.1, 0.2, 0.2])
            .reals_column("ratio", "", "", vec![1.0, 2.0, 1.0, 2.0])
            .reals_column("slope", "", "", vec![0.6, 0.8, 0.7, f64::NAN]);
        let sweep = Artifact::of(ArtifactKind::RESULTS, Group::new().with("runs", Node::Table(gap)));
        assert!(first(&sweep, 0.1, 1.5).is_ok(), "no corner of it is missing");
        let error = first(&sweep, 0.15, 1.5).unwrap_err().message;
        assert_eq!(error, "table `runs` has not one slope at R_min 0.2, ratio 2, next to R_min 0.15, ratio 1.5");
    }

    #[test]
    fn a_slope_itself_needs_no_table_and_a_missing_column_is_named() {
        let target = serde_json::json!({ "response": "s", "unit": "MPa", "low": 9.0, "high": 9.0, "weight": 1.0 });
        let targets = vec![serde_json::from_value(target).unwrap()];
        let set = SetParam { targets, held: BTreeMap::new(), start: None, seed: None };
        let own = Slope { slope: Some(0.3), ..Slope::default() };
        assert_eq!(own.first(None, &set, "s").unwrap(), Some(30.0));
        assert_eq!(Slope::default().first(None, &set, "s").unwrap(), None);
        let other = Slope { column: Some("K".into()), ..Slope::default() };
        let error = other.first(Some(&sweep()), &set, "s").unwrap_err();
        assert_eq!(error.hint.as_deref(), Some("the columns are R_min, ratio, slope"));
    }

    /// The published first values: 9.08 MPa at R_max/R_min = 1.5 with K′ = 0.8033 on σ_cn / (1 + ratio) is 28.26 MPa.
    #[test]
    fn a_regressor_is_what_the_slope_multiplies() {
        let target = serde_json::json!({ "response": "s", "unit": "MPa", "low": 9.08, "high": 9.08, "weight": 1.0 });
        let targets = vec![serde_json::from_value(target).unwrap()];
        let set = SetParam { targets, held: [("ratio".to_owned(), 1.5)].into(), start: None, seed: None };
        let slope =
            |regressor: &str| Slope { slope: Some(0.8033), regressor: Some(regressor.into()), ..Slope::default() };
        let first = slope("sigma_cn / (1 + ratio)").first(None, &set, "sigma_cn").unwrap().unwrap();
        assert!((first - 28.26).abs() < 0.005, "{first}");
        let why = |regressor: &str| slope(regressor).first(None, &set, "sigma_cn").unwrap_err().message;
        assert!(why("sigma_cn + ratio").contains("not proportional"), "{}", why("sigma_cn + ratio"));
        assert!(why("sigma_cn / R_min").contains("`R_min` is neither"), "{}", why("sigma_cn / R_min"));
    }
}
