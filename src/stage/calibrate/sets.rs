//! The target sets of a calibration: the targets of each, and the factors that are held at a value.

use super::config::Calibrate;
use super::goal::Goal;
use super::params::{SetParam, TargetParam};
use super::start::NoStart;
use crate::artifact::Artifact;
use crate::stage::{Context, StageError};
use std::collections::BTreeMap;
use std::sync::Arc;

impl Calibrate {
    /// Number of target sets, before each is repeated for every seed: the length of the longest list with an entry for each
    /// set.
    pub(super) fn count(&self) -> usize {
        let curves = self.curve.as_ref().map_or(0, |curve| curve.of.list().len());
        self.targets.len().max(self.held.len()).max(curves).max(1)
    }

    /// The lists whose number of entries is neither one nor that of the sets.
    pub(super) fn uneven(&self) -> Vec<(&'static str, usize)> {
        let curves = self.curve.as_ref().map_or(0, |curve| curve.of.list().len());
        let lists = [("targets", self.targets.len()), ("held", self.held.len()), ("curve", curves)];
        lists.into_iter().filter(|&(_, length)| length > 1 && length != self.count()).collect()
    }

    /// All sets, each repeated for every seed.
    pub(super) fn sets(&self, context: &Context, measured: &[Arc<Artifact>]) -> Result<Vec<SetParam>, StageError> {
        let mut sets = Vec::new();
        for i in 0..self.count() {
            let nothing = BTreeMap::new();
            let mut targets =
                self.set(context, of_set(&self.targets, i).unwrap_or(&nothing)).map_err(StageError::new)?;
            if let Some(curve) = &self.curve {
                let own = of_set(measured, i).map(|artifact| &**artifact);
                if own.is_some() || curve.of.is_empty() {
                    targets.extend(curve.targets(own, self.form())?);
                }
            }
            let no_start = |fault: NoStart| StageError::new(format!("start of `{}`: {}", fault.factor, fault.why));
            let start = self.started(context, &targets).map_err(no_start)?;
            let held = of_set(&self.held, i).cloned().unwrap_or_default();
            let seeds: Vec<Option<u64>> = self.seeds.iter().copied().map(Some).collect();
            for seed in if seeds.is_empty() { vec![None] } else { seeds } {
                sets.push(SetParam { targets: targets.clone(), held: held.clone(), start: start.clone(), seed });
            }
        }
        Ok(sets)
    }

    /// The targets of one set without its curve.
    pub(super) fn set(&self, context: &Context, listed: &BTreeMap<String, Goal>) -> Result<Vec<TargetParam>, String> {
        let target = |(response, goal): (&String, &Goal)| {
            let unit = context.responses.get(response).map_or("", |r| r.unit.as_str());
            let goal = goal.table();
            let [low, high] = goal.ends(unit).map_err(|e| format!("target of `{response}`: {e}"))?;
            let weight = goal.weight.or(self.weights.get(response).copied()).unwrap_or(1.0);
            let (response, unit, tolerance) = (response.clone(), unit.to_owned(), goal.tolerance);
            Ok(TargetParam { response, unit, low, high, weight, tolerance, strain: None })
        };
        listed.iter().map(target).collect()
    }
}

/// The entry of set `i` in a list of one for all sets, or of one for each.
fn of_set<T>(list: &[T], i: usize) -> Option<&T> {
    if list.len() == 1 { list.first() } else { list.get(i) }
}
