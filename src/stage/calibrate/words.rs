//! The result of a calibration as sentences for a reader.

use crate::artifact::Artifact;
use crate::artifact::calibration::{Determination, Parameters, Solution};
use crate::stage::notes::short;

/// For every target set, which parameters the targets determine, with their intervals, and which they leave free.
pub fn parameters_in_words(solution: &Artifact) -> Vec<String> {
    Solution::from_artifact(solution).map_or_else(|_| Vec::new(), |solution| in_words(&solution.parameters))
}

/// One parameter of a set.
struct Parameter<'a> {
    set: i64,
    name: &'a str,
    unit: &'a str,
    known: Determination,
    value: f64,
    ends: [f64; 2],
}

fn in_words(found: &Parameters) -> Vec<String> {
    let parameter = |i: usize| Parameter {
        set: found.set[i],
        name: &found.factor[i],
        unit: &found.unit[i],
        known: found.known[i],
        value: found.value[i],
        ends: [found.low[i], found.high[i]],
    };
    let all: Vec<Parameter<'_>> = (0..found.set.len()).map(parameter).collect();
    let several = all.last().is_some_and(|last| last.set > 1);
    let sentence = |set: i64| {
        let own: Vec<&Parameter<'_>> = all.iter().filter(|one| one.set == set).collect();
        let whose = if several { format!("set {set}: ") } else { String::new() };
        format!("{whose}{}", of_set(&own))
    };
    let count = all.last().map_or(0, |last| last.set);
    (1..=count).map(sentence).collect()
}

/// "determined: σ_c = 20 MPa (19 … 21); free: mu".
fn of_set(parameters: &[&Parameter<'_>]) -> String {
    let list = |known: Determination, with_ends: bool| {
        let own = parameters.iter().filter(|one| one.known == known);
        let texts: Vec<String> = own.map(|one| if with_ends { one.in_words() } else { one.name.to_owned() }).collect();
        (!texts.is_empty()).then(|| format!("{}: {}", known.word(), texts.join(", ")))
    };
    let parts = [
        list(Determination::Determined, true),
        list(Determination::Partly, true),
        list(Determination::Free, false),
        list(Determination::Unknown, false),
    ];
    parts.into_iter().flatten().collect::<Vec<_>>().join("; ")
}

impl Parameter<'_> {
    fn in_words(&self) -> String {
        let unit = if self.unit.is_empty() { String::new() } else { format!(" {}", self.unit) };
        let [low, high] = self.ends.map(short);
        format!("{} = {}{unit} ({low} … {high})", self.name, short(self.value))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_known_of_each_parameter_is_one_sentence_a_set() {
        let nan = f64::NAN;
        let text = |words: [&str; 4]| words.map(str::to_owned).to_vec();
        let found = Parameters {
            set: vec![1, 1, 1, 2],
            factor: text(["sigma_c", "Ec", "mu", "mu"]),
            unit: text(["MPa", "GPa", "", ""]),
            value: vec![20.0, 31.25, 0.5, 0.5],
            low: vec![19.123_45, 20.0, 0.1, nan],
            high: vec![21.0, 35.0, 1.0, nan],
            known: Determination::ALL.to_vec(),
            ..Parameters::default()
        };
        assert_eq!(
            in_words(&found),
            [
                "set 1: determined: sigma_c = 20 MPa (19.12 … 21); partly determined: Ec = 31.25 GPa (20 … 35); free: mu",
                "set 2: unknown: mu",
            ]
        );
    }
}
