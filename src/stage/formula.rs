//! `kind = "formula"`: a simulator whose responses are formulas of the factors, with or without scatter.
//!
//! It costs microseconds, so a campaign's design, analysis and calibration can be tried before simulations are run, and
//! methods can be compared on known truths. A formula names factors (in their units) and parameters of the material by path
//! with `_` for the dot (`mortar_Ec`, SI). Its operators and functions are `+ - * / ^`,
//! `abs sqrt exp ln log10 sin cos tan atan tanh min max`; `expression/read.rs` documents the grammar. Scatter is relative,
//! normal, and a function of seed, point and replicate.

use super::forecast::{Ahead, Forecast, TaskForecast};
use super::rows::{self, GATHER};
use super::{
    Class, Complaint, Context, Failure, Job, Kind, Known, Named, Point, Port, Sketch, Stage, StageError, Step, Task,
    Work,
};
use crate::artifact::run::{Responses, Run};
use crate::artifact::{Accepts, Artifact, ArtifactKind};
use crate::expression::{Expression, Measure};
use math::random::Stream;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::json;
use std::collections::BTreeMap;

/// Settings of a `formula` stage.
#[derive(Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Formula {
    /// The design whose rows are run; without it there is one run, at the material's values.
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
            match Expression::parse(&response.value) {
                Err(why) => found.push(Complaint::new(&at("value"), why)),
                Ok(formula) => {
                    for unknown in formula.names().iter().filter(|name| !names.contains(name)) {
                        let hint = format!("known are {}", names.join(", "));
                        let complaint = Complaint::new(&at("value"), format!("`{unknown}` is not a value"));
                        found.push(complaint.missing(Named::Factor, unknown).hint(hint));
                    }
                }
            }
            found.extend(rows::check_response(&at("unit"), name, &response.unit, context));
            if !(response.scatter >= 0.0) {
                found.push(Complaint::new(&at("scatter"), "the scatter must be 0 or more"));
            }
        }
        found
    }

    fn sketch(&self) -> Sketch {
        let responses = Some(self.responses.keys().cloned().collect());
        Sketch { material: self.material.clone(), responses, varies: true, ..Sketch::default() }
    }

    fn forecast(&self, ahead: &Ahead) -> Forecast {
        Forecast::of_design(ahead, |_, _| TaskForecast::Exactly(0))
    }

    fn next(&self, known: &Known) -> Result<Step, StageError> {
        rows::fan_out(self, known)
    }

    fn sample(&self, known: &Known, point: &Point, number: u64) -> Result<Task, StageError> {
        let values = rows::values(self.material.as_ref(), point, known.context)?;
        let mut values: BTreeMap<String, f64> =
            values.into_iter().map(|(path, value)| (path.replace(['.', '-'], "_"), value)).collect();
        for (response, name) in self.named() {
            // formulas can name a factor that sets nothing
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
            let vars = Expression::parse(&response.value).map(|formula| formula.names().to_vec()).unwrap_or_default();
            vars.into_iter().map(|var| (name.clone(), var)).collect::<Vec<_>>()
        };
        self.responses.iter().flat_map(of).collect()
    }

    /// Every name that a formula may use.
    fn known_names(&self, context: &Context) -> Vec<String> {
        let material = self.material.as_ref().and_then(|name| context.materials.get(name));
        let paths =
            material.into_iter().flat_map(|material| material.paths().map(|path| path.replace(['.', '-'], "_")));
        context.factors.keys().cloned().chain(paths).collect()
    }
}

impl Kind for Formula {
    const NAME: &'static str = "formula";
    const ABOUT: &'static str = "a stand-in simulator given by formulas of the factors";
    const GIVES: &'static [ArtifactKind] = &[ArtifactKind::RESULTS, ArtifactKind::RUN];
    const CLASS: Class = Class::Simulation;
    // 2: powers from the right, products from the left, smallest and largest of any number of values
    const WORKS: &'static [Work] = &[Work { name: "formula", version: 2, run: evaluate }, GATHER];
}

fn evaluate(job: &Job) -> Result<Artifact, Failure> {
    let params: Params = job.params()?;
    let mut stream = Stream::new(job.seed.unwrap_or(0), &point_text(&params), params.replicate);
    let mut responses = Vec::new();
    for (name, response) in &params.responses {
        let formula = Expression::parse(&response.value).map_err(StageError::new)?;
        let value = |var: &String| {
            let value = params.values.get(var).copied().ok_or_else(|| unset(name, var));
            value.map(Measure::number)
        };
        let values = formula.names().iter().map(value).collect::<Result<Vec<_>, _>>()?;
        let value = formula.eval(&values).map_err(StageError::new)?.value;
        responses.push((name.as_str(), value * (1.0 + response.scatter * stream.normal()), response.unit.as_str()));
    }
    let undefined = responses.iter().find(|(_, value, _)| !value.is_finite());
    let failure = undefined.map_or_else(String::new, |(name, value, _)| format!("`{name}` is {value}"));
    Ok(Run::plain(&failure, Responses::of(&responses)).to_artifact())
}

/// The fault of a formula with a name that has no value in a run.
fn unset(response: &str, name: &str) -> StageError {
    StageError::new(format!("response `{response}` needs `{name}`, which neither the design nor the material sets"))
        .hint("name it as a factor of the design, or give a material that holds it")
}

/// The point as text, from which the scatter of a run is drawn together with seed and replicate.
fn point_text(params: &Params) -> String {
    params.values.iter().map(|(name, value)| format!("{name}={value};")).collect()
}
