//! A measured stress–strain curve as a target: its ordinates at chosen strains.
//!
//! The ordinates are compared at the strains of `at`, or at `points` strains that divide the rising branch of the measured
//! curve, from its first strain above zero stress to its peak, into equal parts. Each is a target of its own, relative to
//! the measured stress (or to the greatest, with `denominator = "largest"`); with weights of one over their number the
//! misfit `sum` is the mean relative error of the curve.

use super::goal::Wanted;
use super::params::{ORDINATE, TargetParam};
use crate::artifact::results::Results;
use crate::artifact::run::Run;
use crate::artifact::{Artifact, ArtifactKind, Table};
use crate::stage::StageError;
use crate::stage::figure::Names;
use crate::unit::Conversion;
use optim::misfit::{Form, ordinates};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A curve to follow.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Curve {
    /// Axial strains of the curve, shortening positive.
    pub strain: Vec<f64>,
    /// Axial stress at each, compression positive, such as `"12.5 MPa"`.
    pub stress: Vec<Wanted>,
    /// The stage that gives the curve instead: of kind `data`, or a single simulation; several stages give one curve for each
    /// target set.
    pub of: Names,
    /// Names of its columns of strain and stress.
    pub columns: Option<[String; 2]>,
    /// Strains at which curves are compared; by default those of a curve that is written in the workflow.
    pub at: Vec<f64>,
    /// Number of points on the rising branch of the measured curve, in place of `at`.
    pub points: Option<usize>,
    /// Weights of the points relative to each other.
    pub weights: Weights,
    /// Weight of the whole curve relative to other targets; 1 by default.
    pub weight: Option<f64>,
}

/// Weights of the points of a curve.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Weights {
    /// Equal weights.
    #[default]
    Equal,
    /// Weights proportional to the measured stress, so that first points near zero have little weight.
    Stress,
}

/// Default number of points on the rising branch.
const POINTS: usize = 20;
/// The unit of stresses in the history.
const STRESS: &str = "MPa";

/// Measured strains and stresses (MPa).
struct Measured {
    strain: Vec<f64>,
    stress: Vec<f64>,
}

impl Curve {
    /// Faults of the settings by themselves.
    pub(super) fn faults(&self) -> Vec<String> {
        let mut found = Vec::new();
        let (strains, stresses) = (self.strain.len(), self.stress.len());
        if strains != stresses {
            found.push(format!("{strains} strains but {stresses} stresses"));
        }
        match (strains + stresses > 0, !self.of.is_empty()) {
            (true, true) => found.push("either `of` or `strain` and `stress`, not both".to_owned()),
            (false, false) => found.push("no curve is given: name a data stage with `of`".to_owned()),
            (true, false) | (false, true) => {}
        }
        if !self.at.is_empty() && self.points.is_some() {
            found.push("either `at` or `points`, not both".to_owned());
        }
        if self.points == Some(0) {
            found.push("`points` must be at least 1".to_owned());
        }
        if self.columns.is_some() && self.of.is_empty() {
            found.push("`columns` has no effect without `of`".to_owned());
        }
        if self.at.iter().chain(&self.strain).any(|strain| !strain.is_finite()) {
            found.push("a strain is not a finite number".to_owned());
        }
        for stress in &self.stress {
            found.extend(stress.value_in(STRESS).err().map(|fault| format!("stress: {fault}")));
        }
        found
    }

    /// The targets of one set: an ordinate each. `of` is the data that holds the curve of this set, if it is not inline.
    pub(super) fn targets(&self, of: Option<&Artifact>, form: Form) -> Result<Vec<TargetParam>, StageError> {
        let measured = match of {
            Some(data) => self.read(data)?,
            None => self.inline()?,
        };
        let strains = self.strains(&measured)?;
        let stresses = ordinates(&measured.strain, &measured.stress, &strains).map_err(|fault| {
            StageError::new(format!("curve: {fault}")).hint("`at` lies within the measured strains")
        })?;
        let total: f64 = stresses.iter().sum();
        let weight = |stress: f64| {
            let share = match self.weights {
                Weights::Equal => 1.0 / strains.len() as f64,
                Weights::Stress => stress / total,
            };
            // The greatest deviation does not depend on the number of points.
            let share = if form == Form::Maximum { share * strains.len() as f64 } else { share };
            share * self.weight.unwrap_or(1.0)
        };
        let target = |(&strain, &stress): (&f64, &f64)| TargetParam {
            response: format!("{ORDINATE}{strain}"),
            unit: STRESS.to_owned(),
            low: Some(stress),
            high: Some(stress),
            weight: weight(stress),
            tolerance: None,
            strain: Some(strain),
        };
        Ok(strains.iter().zip(&stresses).map(target).collect())
    }

    fn inline(&self) -> Result<Measured, StageError> {
        let stress = self.stress.iter().map(|stress| stress.value_in(STRESS)).collect::<Result<_, _>>();
        Ok(Measured { strain: self.strain.clone(), stress: stress.map_err(StageError::new)? })
    }

    /// The curve of a data stage, ordered by strain, without rows that lack a number; or that of a run.
    fn read(&self, data: &Artifact) -> Result<Measured, StageError> {
        if data.is(ArtifactKind::RUN) {
            return self.of_run(data);
        }
        let table = Results::table(data)?;
        let [strain, stress] = self.columns.clone().unwrap_or_else(|| ["strain".to_owned(), "stress".to_owned()]);
        let (strain, stress) = (column(table, &strain, "")?, column(table, &stress, STRESS)?);
        let mut rows: Vec<(f64, f64)> = strain.into_iter().zip(stress).collect();
        rows.retain(|(strain, stress)| strain.is_finite() && stress.is_finite());
        rows.sort_by(|a, b| a.0.total_cmp(&b.0));
        if rows.is_empty() {
            return Err(StageError::new("curve: the data hold no point with both strain and stress"));
        }
        let (strain, stress) = rows.into_iter().unzip();
        Ok(Measured { strain, stress })
    }

    /// The curve of a single simulation.
    fn of_run(&self, run: &Artifact) -> Result<Measured, StageError> {
        if self.columns.is_some() {
            return Err(
                StageError::new("curve: `columns` has no effect on the curve of a simulation").hint("leave it out")
            );
        }
        let run = Run::from_artifact(run)?;
        if !run.failure.is_empty() {
            return Err(StageError::new(format!("curve: the simulation gave no result: {}", run.failure)));
        }
        let curve = run.curve.filter(|curve| !curve.axial_strain.is_empty());
        let curve = curve.ok_or_else(|| StageError::new("curve: the simulation stores no stress–strain curve"))?;
        let unit = Conversion::between("Pa", STRESS).map_err(|fault| StageError::new(fault.to_string()))?;
        let stress = curve.stress.iter().map(|&stress| unit.of(stress)).collect();
        Ok(Measured { strain: curve.axial_strain, stress })
    }

    /// Strains at which curves are compared.
    fn strains(&self, measured: &Measured) -> Result<Vec<f64>, StageError> {
        if !self.at.is_empty() {
            return Ok(self.at.clone());
        }
        if self.of.is_empty() && self.points.is_none() {
            return Ok(measured.strain.clone());
        }
        let points = measured.strain.iter().zip(&measured.stress);
        let peak =
            points.clone().fold((f64::NAN, f64::NEG_INFINITY), |peak, (&e, &s)| if s > peak.1 { (e, s) } else { peak });
        let first = points.clone().take_while(|(_, stress)| **stress <= 0.0).map(|(strain, _)| *strain).last();
        let first = first.unwrap_or_else(|| measured.strain[0].min(0.0));
        if !(peak.1 > 0.0 && peak.0 > first) {
            return Err(StageError::new("curve: the stress never rises above zero").hint("compression is positive"));
        }
        // The strain is the name of a point, so it is rounded to a few digits.
        let count = self.points.unwrap_or(POINTS);
        let start = measured.strain[0].max(first);
        let at = |k: usize| start + (peak.0 - start) * k as f64 / count as f64;
        let rounded = |strain: f64| format!("{strain:.5e}").parse::<f64>().unwrap_or(strain);
        Ok((1..=count).map(|k| if k == count { peak.0 } else { rounded(at(k)) }).collect())
    }
}

/// A column of numbers in a unit.
fn column(table: &Table, name: &str, unit: &str) -> Result<Vec<f64>, StageError> {
    let names: Vec<&str> = table.columns.iter().map(|column| column.name.as_str()).collect();
    let missing = || {
        let known = format!("the columns are {}; name them with `columns`", names.join(", "));
        StageError::new(format!("curve: the data have no column of numbers `{name}`")).hint(known)
    };
    let found = table.column(name).ok_or_else(missing)?;
    found.numbers(unit).map_err(|fault| StageError::new(format!("curve: column `{name}`: {fault}")))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::artifact::{Group, Node, run};

    fn measured() -> Artifact {
        let table = Table::default().reals_column("strain", "%", "", vec![0.0, 0.1, 0.2, f64::NAN, 0.4]).reals_column(
            "stress",
            "kPa",
            "",
            vec![0.0, 400.0, 600.0, 1.0, 100.0],
        );
        Artifact::of(ArtifactKind::RESULTS, Group::new().with("runs", Node::Table(table)))
    }

    fn points(targets: &[TargetParam]) -> Vec<(f64, f64, f64)> {
        targets.iter().map(|t| (t.strain.unwrap(), t.low.unwrap(), t.weight)).collect()
    }

    #[test]
    fn the_rising_branch_is_divided_evenly_and_read_in_si() {
        let curve = Curve { of: Names::One("measured".into()), points: Some(4), ..Curve::default() };
        let found = points(&curve.targets(Some(&measured()), Form::Sum).unwrap());
        let wanted = [(0.0005, 0.2, 0.25), (0.001, 0.4, 0.25), (0.0015, 0.5, 0.25), (0.002, 0.6, 0.25)];
        let near = |(a, b): (&(f64, f64, f64), &(f64, f64, f64))| {
            (a.0 - b.0).abs() < 1e-9 && (a.1 - b.1).abs() < 1e-9 && (a.2 - b.2).abs() < 1e-12
        };
        assert!(found.len() == 4 && found.iter().zip(&wanted).all(near), "{found:?}");
    }

    #[test]
    fn a_simulation_is_followed_by_its_curve() {
        let curve = run::Curve {
            axial_strain: vec![0.0, 0.001, 0.002, 0.003],
            stress: vec![0.0, 4e5, 6e5, 3e5],
            lateral_strain: vec![0.0; 4],
            volumetric_strain: vec![0.0; 4],
            cracks: vec![0; 4],
            speed: None,
        };
        let plain = Run::plain("", run::Responses::of(&[]));
        let truth = Run { curve: Some(curve), ..plain.clone() }.to_artifact();
        let curve = Curve { of: Names::One("truth".into()), points: Some(2), ..Curve::default() };
        let found = points(&curve.targets(Some(&truth), Form::Sum).unwrap());
        assert!((found[0].1 - 0.4).abs() < 1e-12 && (found[1].1 - 0.6).abs() < 1e-12, "{found:?}");
        let none = curve.targets(Some(&plain.to_artifact()), Form::Sum).unwrap_err();
        assert_eq!(none.message, "curve: the simulation stores no stress–strain curve");
        let named = Curve { columns: Some(["e".into(), "s".into()]), ..curve };
        assert!(named.targets(Some(&truth), Form::Sum).unwrap_err().message.contains("`columns` has no effect"));
    }

    #[test]
    fn given_strains_and_weights_by_stress_are_taken() {
        let curve = Curve {
            of: Names::One("measured".into()),
            at: vec![0.001, 0.002],
            weights: Weights::Stress,
            ..Curve::default()
        };
        let found = points(&curve.targets(Some(&measured()), Form::Sum).unwrap());
        assert!((found[0].2 - 0.4).abs() < 1e-12 && (found[1].2 - 0.6).abs() < 1e-12, "{found:?}");
        let beyond = Curve { at: vec![0.005], ..curve };
        assert!(beyond.targets(Some(&measured()), Form::Sum).unwrap_err().message.contains("strains from 0 to 0.004"));
    }

    #[test]
    fn faults_say_what_is_missing() {
        assert_eq!(Curve::default().faults(), ["no curve is given: name a data stage with `of`"]);
        let curve = Curve { of: Names::One("m".into()), strain: vec![0.1], ..Curve::default() };
        assert_eq!(curve.faults(), ["1 strains but 0 stresses", "either `of` or `strain` and `stress`, not both"]);
        let named = Curve { of: Names::One("m".into()), columns: Some(["e".into(), "s".into()]), ..Curve::default() };
        let error = named.targets(Some(&measured()), Form::Sum).unwrap_err();
        assert_eq!(error.hint.as_deref(), Some("the columns are strain, stress; name them with `columns`"));
    }
}
