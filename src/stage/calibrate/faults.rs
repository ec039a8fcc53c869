//! Faults in the settings of a calibration, found before anything runs.

use super::config::{Calibrate, MethodName};
use super::start::NoStart;
use crate::stage::given::check_given;
use crate::stage::{Complaint, Context, Named, known_are};
use optim::Error;
use std::collections::BTreeMap;

impl Calibrate {
    /// Every fault of the settings.
    pub(super) fn faults(&self, context: &Context) -> Vec<Complaint> {
        let mut found = self.unknown_names(context);
        found.extend(self.ineffective());
        found.extend(self.contradictions());
        if self.surfaces.is_none() && self.simulators().is_empty() {
            let complaint = Complaint::new("", "neither `surfaces` nor `simulator` is given");
            found.push(complaint.hint("name a stage of kind rsm, or one of kind simulate or command"));
        }
        if self.targets.is_empty() && self.curve.is_none() {
            let complaint = Complaint::new("", "no targets are given");
            found.push(complaint.hint("targets = [{ UCS = \"30 MPa\", E = \"30 GPa\", nu = 0.2 }]"));
        }
        if let Some(curve) = &self.curve {
            found.extend(curve.faults().into_iter().map(|fault| Complaint::new("curve", fault)));
        }
        if let Some(slope) = &self.proportional {
            found.extend(slope.faults().into_iter().map(|fault| Complaint::new("proportional", fault)));
        }
        let counts = [
            ("specimens", self.specimens.unwrap_or(1), 1, 1_000_000),
            ("solutions", self.solutions.map_or(0, |count| count as u64), 0, 100_000),
            ("evaluations", self.evaluations.map_or(1, |count| count as u64), 1, 10_000_000),
        ];
        for (key, count, least, most) in counts.into_iter().filter(|(_, n, least, most)| n < least || n > most) {
            found.push(Complaint::new(key, format!("`{key}` is {count}; a number from {least} to {most} is needed")));
        }
        if !found.is_empty() {
            return found;
        }
        for (i, set) in self.targets.iter().enumerate() {
            match self.set(context, set).map(|targets| self.started(context, &targets)) {
                Err(message) => found.push(Complaint::new("targets", format!("set {}: {message}", i + 1))),
                Ok(Err(NoStart { factor, why })) => {
                    found.push(Complaint::new(&format!("start.{factor}"), format!("set {}: {why}", i + 1)));
                }
                Ok(Ok(_)) => {}
            }
        }
        if found.is_empty() {
            match self.params(context, &[]) {
                Ok(params) => {
                    let complaint = |fault: &Error| Complaint::new(self.key_of(fault), fault.to_string());
                    // The points of a curve that is read from a stage are not known yet.
                    let unread = self.curve.as_ref().is_some_and(|curve| !curve.of.is_empty());
                    let known = |fault: &&Error| !(unread && **fault == Error::Nothing { what: "target" });
                    found.extend(params.faults().iter().filter(known).map(complaint));
                }
                Err(error) => found.push(Complaint { hint: error.hint, ..Complaint::new("", error.message) }),
            }
        }
        found
    }

    /// Settings that contradict each other.
    fn contradictions(&self) -> Vec<Complaint> {
        let mut found = Vec::new();
        for (key, length) in self.uneven() {
            let message = format!("there are {length} entries for {} target sets", self.count());
            found.push(Complaint::new(key, message).hint("give one for all sets, or one for each"));
        }
        let (coarse, simulators) = (self.coarse.list(), self.simulators());
        if !coarse.is_empty() && coarse.len() != simulators.len() {
            let message = format!("{} coarse stages for {} simulators", coarse.len(), simulators.len());
            found
                .push(Complaint::new("coarse", message).hint("name a coarse twin for every simulator, in their order"));
        }
        for name in coarse.iter().filter(|name| simulators.contains(name)) {
            found.push(Complaint::new("coarse", format!("`{name}` is the simulator itself")));
        }
        if (1..simulators.len()).any(|i| simulators[..i].contains(&simulators[i])) {
            found.push(Complaint::new("simulators", "a stage is named twice"));
        }
        for name in self.held.iter().flat_map(BTreeMap::keys).filter(|name| self.factors.contains(name)) {
            found.push(Complaint::new("held", format!("`{name}` is calibrated and cannot be held")));
        }
        if (1..self.seeds.len()).any(|i| self.seeds[..i].contains(&self.seeds[i])) {
            found.push(Complaint::new("seeds", "a seed is given twice"));
        }
        if self.tolerance.is_some_and(|tolerance| !(tolerance >= 0.0 && tolerance.is_finite())) {
            found.push(Complaint::new("tolerance", "it must be 0 or more"));
        }
        if self.method_name() == MethodName::Proportional {
            let responses = self.targets.iter().all(|set| set.len() == 1);
            if self.factors.len() != 1 || !responses || self.curve.is_some() {
                let message = "proportional corrections are of one factor, to one response per set";
                found.push(Complaint::new("method", message).hint("hold the other factors: `held`"));
            }
        }
        found
    }

    /// The key that a fault of the problem is about; empty where the workflow's factors decide.
    fn key_of(&self, fault: &Error) -> &'static str {
        match fault {
            Error::Nothing { what: "factor" } | Error::Twice { .. } => "factors",
            Error::EmptyRange { factor, .. } if self.ranges.contains_key(factor) => "ranges",
            Error::NoLogarithm { factor, .. } if self.ranges.contains_key(factor) => "ranges",
            Error::EmptyBand { .. } => "targets",
            Error::NotLogarithmic { .. } | Error::Contradiction { .. } | Error::UnknownFactor { .. } => "constraints",
            Error::ZeroTarget { .. } if self.curve.is_none() => "targets",
            Error::Weight { response, .. } if self.weights.contains_key(response) => "weights",
            Error::Outside { .. } if self.preference.is_empty() => "start",
            Error::Outside { .. } => "preference",
            Error::Nothing { .. }
            | Error::EmptyRange { .. }
            | Error::NoLogarithm { .. }
            | Error::NotFinite { .. }
            | Error::ZeroTarget { .. }
            | Error::Weight { .. }
            | Error::Setting { .. }
            | Error::ForeignHistory { .. }
            | Error::CurveTooShort { .. } => "",
        }
    }

    /// Names that the workflow does not declare, or that are none of the calibrated factors.
    fn unknown_names(&self, context: &Context) -> Vec<Complaint> {
        let mut found = Vec::new();
        let mut unknown = |path: String, (named, what): (Named, &str), name: &String, known: Vec<&String>| {
            if !known.contains(&name) {
                let complaint = Complaint::new(&path, format!("unknown {what} `{name}`")).missing(named, name);
                found.push(complaint.hint(known_are(known, what)));
            }
        };
        for name in &self.factors {
            unknown("factors".to_owned(), (Named::Factor, "factor"), name, context.factors.keys().collect());
        }
        for name in self.targets.iter().flat_map(BTreeMap::keys) {
            unknown("targets".to_owned(), (Named::Response, "response"), name, context.responses.keys().collect());
        }
        let simulators = self.simulators();
        let givers: Vec<&String> =
            if simulators.is_empty() { self.surfaces.iter().collect() } else { simulators.iter().collect() };
        let mut lacking = Vec::new();
        for name in self.targets.iter().flat_map(BTreeMap::keys) {
            let own: Vec<&String> = self.from.get(name).map_or(givers.clone(), |stage| vec![stage]);
            for complaint in check_given(context, "targets", &own, [name]) {
                if !lacking.contains(&complaint) {
                    lacking.push(complaint);
                }
            }
        }
        for (key, names) in [("weights", self.weights.keys().collect::<Vec<_>>()), ("from", self.from.keys().collect())]
        {
            for name in names {
                unknown(key.to_owned(), (Named::Response, "response"), name, context.responses.keys().collect());
            }
        }
        for name in self.from.values() {
            unknown("from".to_owned(), (Named::Stage, "simulator"), name, simulators.iter().collect());
        }
        for name in self.held.iter().flat_map(BTreeMap::keys) {
            unknown("held".to_owned(), (Named::Factor, "factor"), name, context.factors.keys().collect());
        }
        for (key, names) in [
            ("ranges", self.ranges.keys().collect::<Vec<_>>()),
            ("scales", self.scales.keys().collect()),
            ("start", self.start.keys().collect()),
            ("preference", self.preference.keys().collect()),
            ("constraints", self.constraints.iter().flat_map(|c| c.terms.keys()).collect()),
        ] {
            for name in names {
                unknown(key.to_owned(), (Named::Factor, "calibrated factor"), name, self.factors.iter().collect());
            }
        }
        if let Some(material) = &self.material {
            unknown("material".to_owned(), (Named::Material, "material"), material, context.materials.keys().collect());
        }
        found.extend(lacking);
        found
    }

    /// Settings without effect beside the others.
    fn ineffective(&self) -> Vec<Complaint> {
        let method = self.method_name();
        let name = json_name(method);
        let tables = [
            ("genetic", self.genetic.is_some(), MethodName::Genetic),
            ("annealing", self.annealing.is_some(), MethodName::Annealing),
            ("differential", self.differential.is_some(), MethodName::Differential),
            ("cma_es", self.cma_es.is_some(), MethodName::CmaEs),
            ("surrogate", self.surrogate.is_some(), MethodName::Surrogate),
            ("proportional", self.proportional.is_some(), MethodName::Proportional),
        ];
        let others = tables.into_iter().filter(|(_, given, own)| *given && *own != method);
        let others = others.map(|(key, ..)| (key, format!("`{key}` has no effect with method `{name}`")));
        let simulated = !self.simulators().is_empty();
        let rules = [
            ("coarse", !self.coarse.is_empty() && !simulated, "it is the twin of a simulator; name that too"),
            ("full_runs", self.full_runs.is_some() && self.coarse.is_empty(), "it is used with `coarse` only"),
            ("from", !self.from.is_empty() && self.simulators().len() < 2, "there is no choice of simulators"),
            (
                "learn_from",
                !self.learn_from.is_empty() && !self.held.is_empty(),
                "runs are learned from only where nothing is held",
            ),
            (
                "learn_from",
                !self.learn_from.is_empty() && !self.coarse.is_empty(),
                "with coarse simulators these are what is learned from",
            ),
            ("learn_from", !self.learn_from.is_empty() && method != MethodName::Surrogate, "only the surrogate learns"),
            ("learn_from", !self.learn_from.is_empty() && !simulated, "runs are learned from only with a simulator"),
            ("material", self.material.is_some() && self.learn_from.is_empty(), "it is used with `learn_from` only"),
            ("specimens", self.specimens.is_some() && !simulated, "it is used with a simulator only"),
            ("curve", self.curve.is_some() && !simulated, "surfaces give no curve; name a simulator"),
            ("curve", self.curve.is_some() && self.surfaces.is_some(), "surfaces give no curve; leave them out"),
            ("polish", self.polish && simulated, "descents need a model without scatter; it is for surfaces only"),
            (
                "surfaces",
                self.surfaces.is_some() && simulated && method != MethodName::Surrogate,
                "with a simulator only the surrogate uses surfaces",
            ),
        ];
        let rules = rules.into_iter().filter(|rule| rule.1).map(|(key, _, why)| (key, why.to_owned()));
        others.chain(rules).map(|(key, message)| Complaint::new(key, message)).collect()
    }
}

/// The method's name as a workflow writes it.
fn json_name(method: MethodName) -> String {
    match serde_json::to_value(method) {
        Ok(serde_json::Value::String(name)) => name,
        other => panic!("BUG: a method's name is a text, not {other:?}"),
    }
}
