//! `kind = "screening"`: effects of a two-level design, judged by Lenth's limits where no replicates estimate the noise.
//!
//! The result has the tables `effects` (one row per response and term, with the coordinates of normal, half-normal and
//! Pareto plots), `limits` (pseudo standard error and margins, critical value of the standardised effects), `fit`,
//! `residuals` and `notes` (active effects, and what a reader must know).

use super::columns::{Columns, Rows, Wanted, check_names, check_probability, refused_without, runs};
use super::fitted::{fit_table, residual_table};
use super::given::check_given;
use super::invalid::Invalid;
use super::notes::Notes;
use super::reads::Reads;
use super::regression::{check_doubled, factors_of};
use super::{Class, Complaint, Context, Failure, Job, Kind, Known, Port, Stage, StageError, Step, Task, Work};
use crate::artifact::statistics::{Effects, Limits, Screening as Stored};
use crate::artifact::validity::NotValid;
use crate::artifact::{Accepts, Artifact, ArtifactKind};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::json;
use stats::screening::{Effect, Screening as Found, screen};
use stats::terms::Term;

/// Settings of a `screening` stage.
#[derive(Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Screening {
    /// The stage whose runs are analysed.
    pub table: String,
    /// Responses to analyse; by default all that the table has.
    #[serde(default)]
    pub responses: Vec<String>,
    /// Terms whose effects are estimated, such as `["A", "B", "A*B"]`; by default the main effects.
    #[serde(default)]
    #[schemars(with = "Vec<String>")]
    pub terms: Vec<Term>,
    /// Level of the margins of error.
    #[serde(default = "alpha")]
    pub alpha: f64,
    /// Column with the number of replicates of which each row is the mean.
    pub weights: Option<String>,
    /// What to do with runs that are not valid.
    #[serde(default, skip_serializing_if = "Invalid::is_default")]
    pub invalid: Invalid,
}

fn alpha() -> f64 {
    0.05
}

#[derive(Serialize, Deserialize)]
struct Params {
    columns: Columns,
    terms: Vec<Term>,
    alpha: f64,
}

impl Stage for Screening {
    fn inputs(&self) -> Vec<Port> {
        vec![Port { key: "table", stages: vec![self.table.clone()], accepts: Accepts::Only(&[ArtifactKind::RESULTS]) }]
    }

    fn gives(&self) -> ArtifactKind {
        ArtifactKind::SCREENING
    }

    fn check(&self, context: &Context) -> Vec<Complaint> {
        let mut found = check_names(context, &[], &self.responses);
        found.extend(check_given(context, "responses", &[&self.table], &self.responses));
        let terms = check_names(context, &factors_of(&self.terms), &[]);
        found.extend(check_doubled(&self.terms, &["terms".to_owned()]));
        found.extend(terms.into_iter().map(|c| Complaint { path: vec!["terms".to_owned()], ..c }));
        found.extend(check_probability("alpha", self.alpha));
        found
    }

    fn reads(&self) -> Vec<Reads> {
        vec![
            Reads::of("terms", &self.table, &factors_of(&self.terms)),
            Reads::of("responses", &self.table, &self.responses),
            Reads::of("weights", &self.table, &self.weights),
        ]
    }

    fn next(&self, known: &Known) -> Result<Step, StageError> {
        let input = known.one("table")?;
        let artifact = known.load(input)?;
        let factors = factors_of(&self.terms);
        let wanted = Wanted {
            factors: &factors,
            responses: &self.responses,
            weights: self.weights.as_deref(),
            levels: false,
            scales: false,
            invalid: self.invalid,
        };
        let columns = Columns::of(runs(&artifact)?, known.context, wanted)?;
        let terms = if self.terms.is_empty() { Term::first_order(&columns.factor_names()) } else { self.terms.clone() };
        let params = Params { columns, terms, alpha: self.alpha };
        Ok(Step::Finish(Task::new("screening", json!(params)).input("table", input.content)))
    }
}

impl Kind for Screening {
    const NAME: &'static str = "screening";
    const ABOUT: &'static str = "effects of a two-level design with Lenth's limits";
    const GIVES: &'static [ArtifactKind] = &[ArtifactKind::SCREENING];
    const CLASS: Class = Class::Statistics;
    // 5: what all responses have in common costs no digits. 4: runs that are not valid are left out. 3: standardised effects with their critical value. 2: notes; what rounding leaves of an exact fit is no error
    const WORKS: &'static [Work] = &[Work { name: "screening", version: 5, run: analyse }];
}

fn analyse(job: &Job) -> Result<Artifact, Failure> {
    let params: Params = job.params()?;
    let table = runs(job.input("table")?)?;
    let (sample, not_valid) = (params.columns.sample(table)?, params.columns.not_valid(table)?);
    let responses = params.columns.response_names();
    let one = |response: &String| {
        screen(&sample, response, &params.terms, params.alpha).map_err(|faults| refused_without(faults, &not_valid))
    };
    let found = responses.iter().map(one).collect::<Result<Vec<Found>, StageError>>()?;
    let residuals = found.iter().map(|s| (s.response.as_str(), s.regression.residuals.as_slice()));
    let fits: Vec<_> = found.iter().map(|s| &s.regression.fit).collect();
    let screening = Stored {
        effects: effect_table(&found),
        limits: limit_table(&found),
        fit: fit_table(&fits),
        notes: notes(&found, &not_valid).table(),
        residuals: residual_table(residuals),
        not_valid: not_valid.some(),
    };
    Ok(screening.to_artifact())
}

/// Notes on active effects, and on what a reader must know.
fn notes<'a>(found: &[Found], not_valid: &'a NotValid) -> Notes<'a> {
    let mut notes = Notes::of(not_valid);
    for screened in found {
        let response = screened.response.as_str();
        let named = |picked: &dyn Fn(&&Effect) -> bool| {
            screened.effects.iter().filter(picked).map(|e| e.term.as_str()).collect::<Vec<_>>().join(", ")
        };
        let sure = named(&|e| e.beyond_simultaneous);
        let likely = named(&|e| e.beyond_margin && !e.beyond_simultaneous);
        for (terms, limit) in [(sure, "both margins: real"), (likely, "the margin of error only: perhaps real")] {
            if !terms.is_empty() {
                notes.add(response, format!("{terms}: beyond {limit}"));
            }
        }
        match screened.pse {
            None => notes.add(response, "Lenth's limits need three effects, most of them other than zero"),
            Some(_) if screened.effects.iter().all(|e| !e.beyond_margin) => {
                notes.add(response, "no effect is beyond Lenth's margin of error: few must matter for it to tell");
            }
            Some(_) => {}
        }
        let active = named(&|e| e.significant == Some(true));
        if !active.is_empty() {
            notes.add(response, format!("{active}: standardised effect beyond the critical value"));
        }
        let fit = &screened.regression.fit;
        if fit.df_residual > 0 {
            notes.fit(fit);
        } else {
            notes.missing(response, fit.n, fit.missing);
        }
        notes.residuals(response, &screened.regression.residuals);
    }
    notes
}

fn effect_table(found: &[Found]) -> Effects {
    let all: Vec<(&str, &Effect)> =
        found.iter().flat_map(|s| s.effects.iter().map(|e| (s.response.as_str(), e))).collect();
    let rows = Rows(&all);
    let verdict = |(_, e): &(&str, &Effect)| match (e.beyond_margin, e.beyond_simultaneous) {
        (true, true) => "beyond both margins",
        (true, false) => "beyond the margin of error",
        (false, _) => "",
    };
    let significance = |(_, e): &(&str, &Effect)| match e.significant {
        Some(true) => "significant",
        Some(false) => "-",
        None => "",
    };
    Effects {
        response: rows.texts(|(response, _)| *response),
        term: rows.texts(|(_, e)| e.term.as_str()),
        effect: rows.reals(|(_, e)| Some(e.effect)),
        std_error: rows.reals(|(_, e)| e.std_error),
        standardized: rows.reals(|(_, e)| e.standardized),
        p: rows.reals(|(_, e)| e.p),
        lenth_t: rows.reals(|(_, e)| e.lenth_t),
        rank: rows.ints(|(_, e)| e.rank),
        share: rows.reals(|(_, e)| Some(e.share)),
        cumulative: rows.reals(|(_, e)| Some(e.cumulative)),
        normal: rows.reals(|(_, e)| Some(e.normal)),
        half_normal: rows.reals(|(_, e)| Some(e.half_normal)),
        verdict: rows.texts(verdict),
        significance: rows.texts(significance),
    }
}

fn limit_table(found: &[Found]) -> Limits {
    let rows = Rows(found);
    Limits {
        response: rows.texts(|s| s.response.as_str()),
        pse: rows.reals(|s| s.pse),
        margin: rows.reals(|s| s.margin),
        simultaneous: rows.reals(|s| s.simultaneous),
        critical: rows.reals(|s| s.critical),
    }
}
