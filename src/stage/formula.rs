//! `kind = "formula"`: a stand-in simulator whose responses are formulas of the factors, with or without scatter.
//!
//! It costs microseconds, so a campaign's design, analysis and calibration can be tried before a simulation is paid for,
//! and methods can be compared on known truths. A formula names factors (in their units) and parameters of the material by
//! path with `_` for the dot (`mortar_Ec`, SI); it knows `+ - * / ^`, `abs sqrt exp ln log10 sin cos tan atan tanh min max`.
//! Scatter is relative, normal, and a function of seed, point and replicate.

use super::rows::{self, GATHER};
use super::{Class, Complaint, Context, Failure, Job, Kind, Known, Point, Port, Stage, StageError, Step, Task, Work};
use crate::artifact::{Accepts, Artifact, ArtifactKind, Group, Node};
use crate::unit::Unit;
use exmex::{BinOp, Express, FlatEx, MakeOperators, MatchLiteral, Operator, literal_matcher_from_pattern};
use math::elementary;
use math::random::Stream;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};
use std::collections::BTreeMap;

/// Settings of a `formula` stage.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Formula {
    /// The design whose rows are run; once, at the material, when not given.
    pub design: Option<String>,
    /// The `[material.NAME]` that rows vary.
    pub material: Option<String>,
    /// Responses by name.
    pub responses: BTreeMap<String, Response>,
}

/// One response.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Response {
    /// The formula, such as `1.083*sigma_c + 0.919*tau_c`.
    value: String,
    /// Unit of its value; none for a pure number.
    #[serde(default)]
    unit: String,
    /// Standard deviation of the relative scatter, such as 0.04.
    #[serde(default)]
    scatter: f64,
}

#[derive(Serialize, Deserialize)]
struct Params {
    responses: BTreeMap<String, Response>,
    values: BTreeMap<String, f64>,
    replicate: u64,
}

/// Operators whose results have the same bits everywhere.
#[derive(Clone, Debug)]
struct Operators;

impl MakeOperators<f64> for Operators {
    fn make<'a>() -> Vec<Operator<'a, f64>> {
        let binary = |apply: fn(f64, f64) -> f64, prio, is_commutative| BinOp { apply, prio, is_commutative };
        vec![
            Operator::make_bin("^", binary(elementary::pow, 4, false)),
            Operator::make_bin("*", binary(|a, b| a * b, 2, true)),
            Operator::make_bin("/", binary(|a, b| a / b, 3, false)),
            Operator::make_bin_unary("+", binary(|a, b| a + b, 0, true), |a| a),
            Operator::make_bin_unary("-", binary(|a, b| a - b, 1, false), |a| -a),
            Operator::make_bin("min", binary(f64::min, 0, true)),
            Operator::make_bin("max", binary(f64::max, 0, true)),
            Operator::make_unary("abs", f64::abs),
            Operator::make_unary("sqrt", f64::sqrt),
            Operator::make_unary("exp", elementary::exp),
            Operator::make_unary("ln", elementary::ln),
            Operator::make_unary("log10", elementary::log10),
            Operator::make_unary("sin", elementary::sin),
            Operator::make_unary("cos", elementary::cos),
            Operator::make_unary("tan", elementary::tan),
            Operator::make_unary("atan", elementary::atan),
            Operator::make_unary("tanh", elementary::tanh),
        ]
    }
}

literal_matcher_from_pattern!(Number, r"^(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?");

/// A formula that was read.
pub(super) struct Parsed(FlatEx<f64, Operators, Number>);

impl Parsed {
    /// The names that it uses, in the order in which [`Self::value`] takes their values.
    pub(super) fn names(&self) -> &[String] {
        self.0.var_names()
    }

    /// Its value.
    pub(super) fn value(&self, values: &[f64]) -> Result<f64, String> {
        self.0.eval(values).map_err(|e| e.to_string())
    }
}

/// Reads a formula, or says what is wrong with it.
pub(super) fn parse(text: &str) -> Result<Parsed, String> {
    if let Some(place) = ambiguous_power(text) {
        return Err(format!("`{text}`: a minus before a power at `{}`; write -(a^2) or (-a)^2", &text[place..]));
    }
    FlatEx::parse(text).map(Parsed).map_err(|e| format!("`{text}` is not a formula: {e}"))
}

/// Place of a sign that stands directly before a power: mathematics reads `-a^2` as −(a²), the library as (−a)².
fn ambiguous_power(text: &str) -> Option<usize> {
    let mut before = None;
    for (place, c) in text.char_indices().filter(|(_, c)| !c.is_whitespace()) {
        let sign = c == '-' && before.is_none_or(|b| "(,+-*/^".contains(b));
        // The exponent of a number, as in 1e-3, is no sign.
        if sign && after_operand(text[place + 1..].trim_start()).trim_start().starts_with('^') {
            return Some(place);
        }
        before = Some(c);
    }
    None
}

/// What follows the first name, number, call or bracket of a formula.
fn after_operand(text: &str) -> &str {
    let name = text.find(|c: char| !(c.is_alphanumeric() || c == '_' || c == '.')).unwrap_or(text.len());
    let rest = &text[name..];
    if !rest.starts_with('(') {
        return rest;
    }
    let mut depth = 0;
    for (place, c) in rest.char_indices() {
        depth += i32::from(c == '(') - i32::from(c == ')');
        if depth == 0 {
            return &rest[place + 1..];
        }
    }
    ""
}

impl Stage for Formula {
    fn inputs(&self) -> Vec<Port> {
        let design = |name: &String| Port {
            key: "design",
            stages: vec![name.clone()],
            accepts: Accepts::Only(&[ArtifactKind::DESIGN]),
        };
        self.design.iter().map(design).collect()
    }

    fn gives(&self) -> ArtifactKind {
        if self.design.is_some() { ArtifactKind::RESULTS } else { ArtifactKind::RUN }
    }

    fn check(&self, context: &Context) -> Vec<Complaint> {
        let mut found = rows::check_units(context);
        found.extend(rows::check_material(self.material.as_ref(), context));
        let names = self.known_names(context);
        for (name, response) in &self.responses {
            let at = |key: &str| format!("responses.{name}.{key}");
            match parse(&response.value) {
                Err(why) => found.push(Complaint::new(&at("value"), why)),
                Ok(formula) => {
                    for unknown in formula.names().iter().filter(|var| !names.contains(var)) {
                        let hint = format!("known are {}", names.join(", "));
                        found.push(Complaint::new(&at("value"), format!("`{unknown}` is not a value")).hint(hint));
                    }
                }
            }
            if let Err(e) = Unit::parse(&response.unit) {
                found.push(Complaint::new(&at("unit"), e.to_string()));
            }
            if !(response.scatter >= 0.0) {
                found.push(Complaint::new(&at("scatter"), "the scatter must be 0 or more"));
            }
        }
        found
    }

    fn settings(&self) -> Value {
        json!({ "design": self.design, "material": self.material, "responses": self.responses })
    }

    fn next(&self, known: &Known) -> Result<Step, StageError> {
        rows::fan_out(self, known)
    }

    fn sample(&self, known: &Known, point: &Point, number: u64) -> Result<Task, StageError> {
        let values = rows::values(self.material.as_ref(), point, known.context)?;
        let mut values: BTreeMap<String, f64> =
            values.into_iter().map(|(path, value)| (path.replace('.', "_"), value)).collect();
        for (response, name) in self.named() {
            // a factor that sets nothing else still stands where a formula names it
            match point.get(&name) {
                Some(value) => drop(values.insert(name, *value)),
                None if values.contains_key(&name) => {}
                None => return Err(unset(&response, &name)),
            }
        }
        let params = Params { responses: self.responses.clone(), values, replicate: number };
        Ok(Task::new("formula", json!(params)).seed(known.context.seed))
    }
}

impl Formula {
    /// Responses and the names that their formulas use.
    fn named(&self) -> Vec<(String, String)> {
        let of = |(name, response): (&String, &Response)| {
            let vars = parse(&response.value).map(|formula| formula.names().to_vec()).unwrap_or_default();
            vars.into_iter().map(|var| (name.clone(), var)).collect::<Vec<_>>()
        };
        self.responses.iter().flat_map(of).collect()
    }

    /// Every name that a formula may use.
    fn known_names(&self, context: &Context) -> Vec<String> {
        let material = self.material.as_ref().and_then(|name| context.materials.get(name));
        let paths = material.into_iter().flat_map(|material| material.keys().map(|path| path.replace('.', "_")));
        context.factors.keys().cloned().chain(paths).collect()
    }
}

impl Kind for Formula {
    const NAME: &'static str = "formula";
    const ABOUT: &'static str = "a stand-in simulator given by formulas of the factors";
    const GIVES: &'static [ArtifactKind] = &[ArtifactKind::RESULTS, ArtifactKind::RUN];
    const CLASS: Class = Class::Simulation;
    const WORKS: &'static [Work] = &[Work { name: "formula", version: 1, run: evaluate }, GATHER];
}

fn evaluate(job: &Job) -> Result<Artifact, Failure> {
    let params: Params = job.params()?;
    let mut stream = Stream::new(job.seed.unwrap_or(0), &point_text(&params), params.replicate);
    let mut responses = Vec::new();
    for (name, response) in &params.responses {
        let formula = parse(&response.value).map_err(StageError::new)?;
        let values = formula.names().iter().map(|var| params.values.get(var).copied().ok_or_else(|| unset(name, var)));
        let value = formula.value(&values.collect::<Result<Vec<_>, _>>()?).map_err(StageError::new)?;
        responses.push((name.as_str(), value * (1.0 + response.scatter * stream.normal()), response.unit.as_str()));
    }
    let undefined = responses.iter().find(|(_, value, _)| !value.is_finite());
    let failure = undefined.map_or_else(String::new, |(name, value, _)| format!("`{name}` is {value}"));
    let root = Group::new()
        .with("failure", Node::Text(failure))
        .with("responses", Node::Table(rows::response_table(&responses)));
    Ok(Artifact::of(ArtifactKind::RUN, root))
}

/// The fault of a formula that names what a run does not have.
fn unset(response: &str, name: &str) -> StageError {
    StageError::new(format!("response `{response}` needs `{name}`, which neither the design nor the material sets"))
        .hint("name it as a factor of the design, or give a material that holds it")
}

/// The point as text: what the scatter of a run depends on, besides seed and replicate.
fn point_text(params: &Params) -> String {
    params.values.iter().map(|(name, value)| format!("{name}={value};")).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn formulas_are_read_as_they_are_written() {
        for (text, value) in [
            ("2*a/1e2 - 3", 2.0 * 5.0 / 1e2 - 3.0),
            ("-(a^2) + 1.5E+1", -25.0 + 15.0),
            ("(-a)^2 - a^2 * 1e-1", 25.0 - 2.5),
            ("sqrt(abs(-16)) + max(1, a)", 4.0 + 5.0),
            ("a - 1 - 1", 3.0),
            ("a / 5 / 2", 0.5),
            ("10 - a + 1", 6.0),
        ] {
            assert_eq!(
                parse(text).unwrap().value(&[5.0][..parse(text).unwrap().names().len()]).unwrap(),
                value,
                "{text}"
            );
        }
        assert!(parse("a +* 2").is_err());
        for unclear in ["-a^2", "3 * -sqrt(a)^2", "-(a + (1))^2 + 1", "max(-a^2, 1)"] {
            assert!(parse(unclear).err().unwrap().contains("a minus before a power"), "{unclear}");
        }
    }
}
