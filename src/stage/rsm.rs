//! `kind = "rsm"`: second-order response surfaces, each response from its own table or all from one.
//!
//! A factor with `scale = "log"` enters by its logarithm: −1, 0 and +1 in coded units are the levels of a design on that
//! scale, and coefficients are per unit of ln(value in the factor's unit).
//!
//! The result is an artifact `surfaces`, as in [`super::regression`].

use super::beside::Beside;
use super::columns::{Columns, Wanted, check_names, runs};
use super::fitted::{self, Fitting, Params, Predict, check_predict, with_constant};
use super::given::check_given;
use super::invalid::Invalid;
use super::reads::Reads;
use super::regression::{check_doubled, check_levels, factors_of, outlier_alpha};
use super::{Class, Complaint, Context, Kind, Known, Port, Sketch, Stage, StageError, Step, Task, Work};
use crate::artifact::{Accepts, ArtifactKind};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};
use stats::selection::Direction;
use stats::terms::Term;
use std::collections::BTreeMap;

/// Settings of an `rsm` stage.
#[derive(Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Rsm {
    /// The stages whose runs are fitted: one for each response, in the same order, or one for all.
    pub tables: Vec<String>,
    /// The responses.
    pub responses: Vec<String>,
    /// Terms of a response; by default the full second order in the factors that its table varies.
    #[serde(default)]
    #[schemars(with = "BTreeMap<String, Vec<String>>")]
    pub terms: BTreeMap<String, Vec<Term>>,
    /// Choose terms by significance, with hierarchy.
    pub select: Option<Direction>,
    /// Level of the selection, 0.05 by default.
    pub select_alpha: Option<f64>,
    /// Level of the outlier test on the studentized residuals, over all rows together.
    #[serde(default = "outlier_alpha")]
    pub outlier_alpha: f64,
    /// Column with the number of replicates of which each row is the mean.
    pub weights: Option<String>,
    /// What to do with runs that are not valid.
    #[serde(default, skip_serializing_if = "Invalid::is_default")]
    pub invalid: Invalid,
    /// Points of prediction.
    pub predict: Option<Predict>,
    /// CSV beside the workflow with printed coefficients: `response,term,estimate` and, optionally, `note`; the term `r2` is
    /// compared with the fit.
    pub published: Option<String>,
}

impl Stage for Rsm {
    fn inputs(&self) -> Vec<Port> {
        vec![Port { key: "tables", stages: self.tables.clone(), accepts: Accepts::Only(&[ArtifactKind::RESULTS]) }]
    }

    fn gives(&self) -> ArtifactKind {
        ArtifactKind::SURFACES
    }

    fn sketch(&self) -> Sketch {
        Sketch { responses: Some(self.responses.clone()), ..Sketch::default() }
    }

    fn check(&self, context: &Context) -> Vec<Complaint> {
        let mut found = check_names(context, &[], &self.responses);
        if self.responses.is_empty() {
            found.push(Complaint::new("responses", "no response is named").hint("responses = [\"UCS\"]"));
        }
        if self.tables.len() != 1 && self.tables.len() != self.responses.len() {
            let counted = |n: usize, what: &str| format!("{n} {what}{}", if n == 1 { "" } else { "s" });
            let (tables, responses) = (self.tables.len(), self.responses.len());
            let message = format!("{} for {}", counted(tables, "table"), counted(responses, "response"));
            found.push(
                Complaint::new("tables", message).hint("one table per response in the same order, or one for all"),
            );
        }
        for (i, response) in self.responses.iter().enumerate() {
            let table = self.tables.get(i).or(self.tables.last().filter(|_| self.tables.len() == 1));
            let table: Vec<&String> = table.into_iter().collect();
            found.extend(check_given(context, "responses", &table, [response]));
            if self.responses[..i].contains(response) {
                found.push(Complaint::new("responses", format!("`{response}` is listed twice")));
            }
        }
        for (response, terms) in &self.terms {
            let path = vec!["terms".to_owned(), response.clone()];
            let own = check_names(context, &factors_of(terms), &[]);
            found.extend(own.into_iter().map(|c| Complaint { path: path.clone(), ..c }));
            found.extend(check_doubled(terms, &path));
            if !self.responses.contains(response) {
                let message = format!("`{response}` is none of the stage's responses, so its terms have no effect");
                found.push(Complaint { path, ..Complaint::new("", message) });
            }
        }
        found.extend(check_predict(self.predict.as_ref(), context));
        found.extend(check_levels(self.select, self.select_alpha, self.outlier_alpha));
        found
    }

    fn reads(&self) -> Vec<Reads> {
        let mut all = Vec::new();
        for (i, response) in self.responses.iter().enumerate() {
            let Some(table) = self.tables.get(i).or(self.tables.last()) else { continue };
            all.push(Reads::of("responses", table, [response]));
            all.push(Reads::of("weights", table, &self.weights));
            let factors = self.terms.get(response).map(|terms| factors_of(terms)).unwrap_or_default();
            all.push(Reads::of(&format!("terms.{response}"), table, &factors));
        }
        all
    }

    fn beside(&self, _context: &Context, found: &mut Beside) {
        found.optional("published", self.published.as_ref());
    }

    fn next(&self, known: &Known) -> Result<Step, StageError> {
        let inputs: Vec<_> = known.port("tables").collect();
        let mut fittings = Vec::new();
        let mut task = Task::new("fit", Value::Null);
        for (i, response) in self.responses.iter().enumerate() {
            let input = inputs.get(i.min(inputs.len().saturating_sub(1)));
            let input = input.ok_or_else(|| StageError::new("`tables` names no stage"))?;
            let artifact = known.load(input)?;
            fittings.push(self.fitting(response, runs(&artifact)?, known.context)?);
            task = task.input(response.clone(), input.content);
        }
        let params = Params {
            through_origin: false,
            fittings,
            select: self.select,
            select_alpha: self.select.map(|_| self.select_alpha.unwrap_or(fitted::SELECT_ALPHA)),
            outlier_alpha: self.outlier_alpha,
            predict: self.predict.clone(),
        };
        task.params = json!(params).into();
        if let Some(path) = &self.published {
            task.files.push(known.library.file("published", path)?);
        }
        Ok(Step::Finish(task))
    }
}

impl Rsm {
    /// The model of one response: its own terms, or the second order in the factors that its table varies.
    fn fitting(
        &self,
        response: &str,
        table: &crate::artifact::Table,
        context: &Context,
    ) -> Result<Fitting, StageError> {
        let own = self.terms.get(response);
        let factors = own.map(|terms| factors_of(terms)).unwrap_or_default();
        let responses = [response.to_owned()];
        let weights = self.weights.as_deref();
        let wanted = Wanted {
            factors: &factors,
            responses: &responses,
            weights,
            scales: true,
            invalid: self.invalid,
            ..Wanted::default()
        };
        let columns = Columns::of(table, context, wanted)?;
        let varied = |name: &String| {
            let values = table.shown(name).unwrap_or_default().0;
            values.iter().any(|v| *v != values[0])
        };
        let terms = match own {
            Some(terms) => with_constant(terms),
            None => Term::second_order(&columns.factor_names().into_iter().filter(varied).collect::<Vec<_>>()),
        };
        Ok(Fitting { response: response.to_owned(), input: response.to_owned(), columns, terms })
    }
}

impl Kind for Rsm {
    const NAME: &'static str = "rsm";
    const ABOUT: &'static str = "second-order response surfaces with canonical analysis";
    const GIVES: &'static [ArtifactKind] = &[ArtifactKind::SURFACES];
    const CLASS: Class = Class::Statistics;
    const WORKS: &'static [Work] = &[];
}
