//! `kind = "regression"`: linear models of one table, one per response, or one per response and group of rows.
//!
//! A term is a product of powers of factors, or holds a formula of factors such as `scn/(1+ratio)`. A factor whose values
//! are names enters by dummy coding. With `through_origin` no model has a constant: R² is then a fraction of the squares
//! about zero, and the result also holds R² about the mean and the same terms with a constant. With `by` the result is an
//! artifact `groups` ([`grouped`]).
//!
//! The result is an artifact `surfaces`: tables `coefficients` (natural units), `coded`, `fit`, `residuals`,
//! `stationary`, `axes`, `path`, `domain`, `selection`, `predictions` if `predict` is set, `notes`, and the models for
//! prediction.

mod grouped;

use super::beside::Beside;
use super::columns::{Columns, Wanted, check_names, check_probability, runs};
use super::fitted::{self, Fitting, Params, Predict, check_predict, fit, with_constant};
use super::given::check_given;
use super::invalid::Invalid;
use super::reads::Reads;
use super::{Class, Complaint, Context, Kind, Known, Port, Stage, StageError, Step, Task, Work};
use crate::artifact::{Accepts, ArtifactKind};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::json;
use stats::selection::Direction;
use stats::terms::Term;
use std::collections::BTreeMap;

/// Settings of a `regression` stage.
#[derive(Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Regression {
    /// The stage whose runs are fitted.
    pub table: String,
    /// Terms per response, such as `UCS = ["sigma_c", "tau_c"]` or `["Ec", "Ec^2", "Ec*mu"]`; the constant is in
    /// every model. Without this table: every response of the runs on all their factors, first order.
    #[serde(default)]
    #[schemars(with = "BTreeMap<String, Vec<String>>")]
    pub terms: BTreeMap<String, Vec<Term>>,
    /// Columns of the table by which rows are grouped: one fit for every group of rows with equal values.
    #[serde(default)]
    pub by: Vec<String>,
    /// Whether to leave the constant out of every model.
    #[serde(default)]
    pub through_origin: bool,
    /// Coverage of the intervals of coefficients by groups, 0.95 by default.
    pub confidence: Option<f64>,
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

pub(super) fn outlier_alpha() -> f64 {
    0.05
}

/// Complaints about the levels of selection and outlier test.
pub(super) fn check_levels(select: Option<Direction>, select_alpha: Option<f64>, outlier: f64) -> Vec<Complaint> {
    let without = select.is_none() && select_alpha.is_some();
    let idle = without.then(|| {
        Complaint::new("select_alpha", "`select_alpha` has no effect without `select`").hint("select = \"backward\"")
    });
    let level = select_alpha.and_then(|alpha| check_probability("select_alpha", alpha));
    idle.into_iter().chain(level).chain(check_probability("outlier_alpha", outlier)).collect()
}

/// Complaints about a term that a model lists twice, at `path`.
pub(super) fn check_doubled(terms: &[Term], path: &[String]) -> Vec<Complaint> {
    let doubled = (0..terms.len()).filter(|&i| terms[..i].iter().any(|other| other.same(&terms[i])));
    let complaint = |i: usize| {
        let message = format!("the model has `{}` twice", terms[i]);
        Complaint { path: path.to_vec(), ..Complaint::new("", message) }.hint("list each term once")
    };
    doubled.map(complaint).collect()
}

/// The factors that a list of terms names, each once.
pub(super) fn factors_of(terms: &[Term]) -> Vec<String> {
    let mut names: Vec<String> = terms.iter().flat_map(Term::factors).map(str::to_owned).collect();
    names.sort();
    names.dedup();
    names
}

impl Stage for Regression {
    fn inputs(&self) -> Vec<Port> {
        let accepts = Accepts::Only(&[ArtifactKind::RESULTS, ArtifactKind::GROUPS]);
        vec![Port { key: "table", stages: vec![self.table.clone()], accepts }]
    }

    fn gives(&self) -> ArtifactKind {
        if self.by.is_empty() { ArtifactKind::SURFACES } else { ArtifactKind::GROUPS }
    }

    fn check(&self, context: &Context) -> Vec<Complaint> {
        let mut found = Vec::new();
        for (response, terms) in &self.terms {
            let own = check_names(context, &factors_of(terms), std::slice::from_ref(response));
            let path = vec!["terms".to_owned(), response.clone()];
            found.extend(check_doubled(terms, &path));
            found.extend(own.into_iter().map(|c| Complaint { path: path.clone(), ..c }));
            found.extend(check_given(context, &format!("terms.{response}"), &[&self.table], [response]));
        }
        found.extend(check_predict(self.predict.as_ref(), context));
        found.extend(self.check_groups());
        found.extend(check_levels(self.select, self.select_alpha, self.outlier_alpha));
        found
    }

    fn reads(&self) -> Vec<Reads> {
        let terms = self.terms.iter().map(|(response, terms)| {
            let factors = factors_of(terms);
            Reads::of(&format!("terms.{response}"), &self.table, factors.iter().chain([response]))
        });
        let others = [Reads::of("by", &self.table, &self.by), Reads::of("weights", &self.table, &self.weights)];
        terms.chain(others).collect()
    }

    fn beside(&self, _context: &Context, found: &mut Beside) {
        found.optional("published", self.published.as_ref());
    }

    fn next(&self, known: &Known) -> Result<Step, StageError> {
        let input = known.one("table")?;
        let artifact = known.load(input)?;
        let table = runs(&artifact)?;
        let one = |response: &str, terms: Option<&Vec<Term>>| {
            let factors = terms.map(|terms| factors_of(terms)).unwrap_or_default();
            let responses = [response.to_owned()];
            let weights = self.weights.as_deref();
            let wanted = Wanted {
                factors: &factors,
                responses: &responses,
                weights,
                invalid: self.invalid,
                ..Wanted::default()
            };
            let columns = Columns::of(table, known.context, wanted)?;
            let terms = terms.map_or_else(|| Term::first_order(&columns.factor_names()), |terms| with_constant(terms));
            let constant = |term: &Term| term.degree() == 0;
            let terms = terms.into_iter().filter(|term| !(self.through_origin && constant(term))).collect();
            Ok(Fitting { response: response.to_owned(), input: "table".to_owned(), columns, terms })
        };
        let fittings: Result<Vec<Fitting>, StageError> = if self.terms.is_empty() {
            let all = Columns::of(table, known.context, Wanted { invalid: self.invalid, ..Wanted::default() })?;
            all.response_names().iter().map(|response| one(response, None)).collect()
        } else {
            self.terms.iter().map(|(response, terms)| one(response, Some(terms))).collect()
        };
        if !self.by.is_empty() {
            return Ok(Step::Finish(self.grouped(fittings?).input("table", input.content)));
        }
        let params = Params {
            through_origin: self.through_origin,
            fittings: fittings?,
            select: self.select,
            select_alpha: self.select.map(|_| self.select_alpha.unwrap_or(fitted::SELECT_ALPHA)),
            outlier_alpha: self.outlier_alpha,
            predict: self.predict.clone(),
        };
        let mut task = Task::new("fit", json!(params)).input("table", input.content);
        if let Some(path) = &self.published {
            task.files.push(known.library.file("published", path)?);
        }
        Ok(Step::Finish(task))
    }
}

impl Regression {
    fn check_groups(&self) -> Vec<Complaint> {
        let idle = |key: &str| {
            Complaint::new(key, format!("`{key}` has no effect with `by`")).hint(format!("leave out `{key}`"))
        };
        let mut found: Vec<Complaint> = Vec::new();
        if self.by.is_empty() {
            let without = self.confidence.is_some();
            let message = "`confidence` has no effect without `by`";
            found.extend(without.then(|| Complaint::new("confidence", message).hint("by = [\"a column\"]")));
        } else {
            found.extend(self.select.is_some().then(|| idle("select")));
            found.extend(self.predict.is_some().then(|| idle("predict")));
            found.extend(self.published.is_some().then(|| idle("published")));
        }
        let twice = self.by.iter().enumerate().filter(|(i, name)| self.by[..*i].contains(name));
        let complaint = |name| Complaint::new("by", format!("`{name}` is named twice")).hint("name each column once");
        found.extend(twice.map(|(_, name)| complaint(name)));
        found.extend(self.confidence.and_then(|level| check_probability("confidence", level)));
        found
    }

    fn grouped(&self, fittings: Vec<Fitting>) -> Task {
        let params = grouped::Params {
            fittings,
            by: self.by.clone(),
            through_origin: self.through_origin,
            outlier_alpha: self.outlier_alpha,
            confidence: self.confidence.unwrap_or(0.95),
        };
        Task::new("groups", json!(params))
    }
}

impl Kind for Regression {
    const NAME: &'static str = "regression";
    const ABOUT: &'static str = "linear regression of responses on factors, from one table";
    const GIVES: &'static [ArtifactKind] = &[ArtifactKind::SURFACES, ArtifactKind::GROUPS];
    const CLASS: Class = Class::Statistics;
    // Groups 5: runs without a value to group by are counted, and in no group. 4: what all responses have in common costs no digits; one level through the origin. Groups 3: a group without a fit says how many of its runs are missing. 3, of groups 2: runs that are not valid are left out. 2: notes; what rounding leaves of an exact fit is no error
    const WORKS: &'static [Work] =
        &[Work { name: "fit", version: 4, run: fit }, Work { name: "groups", version: 5, run: grouped::fit }];
}
