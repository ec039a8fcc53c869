//! Predictions of fitted models at chosen points, and the paths of steepest ascent and descent from the centre.

use super::super::columns::Rows;
use super::super::notes::Notes;
use super::super::{Complaint, Context};
use super::Fitting;
use crate::artifact::surfaces::{Paths, Predictions};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use stats::canonical::steepest_path;
use stats::model::Prediction;
use stats::regression::Regression;
use std::collections::BTreeMap;

/// Points of prediction, and the coverage of the intervals.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Predict {
    /// Points as values of factors in their units; a response is predicted at points with all factors of its model.
    pub at: Vec<BTreeMap<String, f64>>,
    /// Coverage of confidence and prediction intervals.
    #[serde(default = "confidence")]
    pub confidence: f64,
}

fn confidence() -> f64 {
    0.95
}

/// Complaints about unknown factors and impossible coverages.
pub(in super::super) fn check_predict(predict: Option<&Predict>, context: &Context) -> Vec<Complaint> {
    let Some(predict) = predict else { return Vec::new() };
    let factors: Vec<String> = predict.at.iter().flat_map(|point| point.keys().cloned()).collect();
    let mut found = super::super::columns::check_names(context, &factors, &[]);
    found.extend(super::super::columns::check_probability("confidence", predict.confidence));
    for complaint in &mut found {
        complaint.path.insert(0, "predict".to_owned());
    }
    found
}

/// Predicts every response at every point with all its factors.
fn asked(found: &[(&Fitting, Regression)], predict: &Predict) -> Vec<(String, usize, Prediction)> {
    let ask = |(fitting, regression): &'_ (&Fitting, Regression), number: usize| {
        let point: Option<Vec<f64>> = regression
            .model
            .axes
            .iter()
            .map(|axis| fitting.columns.value_at(&axis.name, &predict.at[number]))
            .collect();
        Some((fitting.response.clone(), number, regression.model.predict(&point?, predict.confidence)))
    };
    found.iter().flat_map(|own| (0..predict.at.len()).filter_map(move |number| ask(own, number))).collect()
}

/// In which way a prediction extrapolates; empty when it does not.
fn beyond((_, _, p): &(String, usize, Prediction)) -> String {
    match (p.outside.is_empty(), p.far) {
        (false, _) => format!("{} outside the domain", p.outside.join(", ")),
        (true, true) => "farther out than any run".to_owned(),
        (true, false) => String::new(),
    }
}

/// Notes on predictions that extrapolate.
pub(super) fn extrapolations(found: &[(&Fitting, Regression)], predict: &Predict, notes: &mut Notes) {
    for own in asked(found, predict).iter().filter(|own| !beyond(own).is_empty()) {
        notes.add(&own.0, format!("prediction {} extrapolates: {}", own.1 + 1, beyond(own)));
    }
}

/// One row per response and point.
pub(super) fn prediction_table(found: &[(&Fitting, Regression)], predict: &Predict) -> Predictions {
    let all = asked(found, predict);
    let rows = Rows(&all);
    Predictions {
        response: rows.texts(|(response, ..)| response.as_str()),
        point: rows.ints(|(_, number, _)| number + 1),
        value: rows.reals(|(_, _, p)| Some(p.value)),
        std_error: rows.reals(|(_, _, p)| p.std_error),
        confidence_low: rows.reals(|(_, _, p)| Some(p.confidence?.0)),
        confidence_high: rows.reals(|(_, _, p)| Some(p.confidence?.1)),
        prediction_low: rows.reals(|(_, _, p)| Some(p.prediction?.0)),
        prediction_high: rows.reals(|(_, _, p)| Some(p.prediction?.1)),
        leverage: rows.reals(|(_, _, p)| Some(p.leverage)),
        extrapolation: rows.texts(beyond),
    }
}

/// Radii of the steepest paths, in coded units.
const RADII: [f64; 7] = [0.0, 0.25, 0.5, 0.75, 1.0, 1.25, 1.5];

/// The paths of steepest ascent and descent from the centre, factor by factor.
pub(super) fn path_table(found: &[(&Fitting, Regression)]) -> Paths {
    let ways = |(fitting, regression): &(&Fitting, Regression)| {
        let way = |up: bool| {
            let points = steepest_path(&regression.model, up, &RADII).unwrap_or_default();
            let axes: Vec<String> = regression.model.axes.iter().map(|axis| axis.name.clone()).collect();
            let response = fitting.response.clone();
            points.into_iter().flat_map(move |point| {
                let (response, names) = (response.clone(), axes.clone());
                names.into_iter().enumerate().map(move |(i, factor)| (response.clone(), up, factor, i, point.clone()))
            })
        };
        way(true).chain(way(false)).collect::<Vec<_>>()
    };
    let all: Vec<_> = found.iter().flat_map(ways).collect();
    let rows = Rows(&all);
    Paths {
        response: rows.texts(|(response, ..)| response.as_str()),
        way: rows.texts(|(_, up, ..)| if *up { "up" } else { "down" }),
        radius: rows.reals(|(.., point)| Some(point.radius)),
        value: rows.reals(|(.., point)| Some(point.value)),
        factor: rows.texts(|(_, _, factor, ..)| factor.as_str()),
        natural: rows.reals(|(_, _, _, i, point)| Some(point.natural[*i])),
        coded: rows.reals(|(_, _, _, i, point)| Some(point.coded[*i])),
    }
}
