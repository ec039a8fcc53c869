//! `kind = "anova"`: analysis of variance of every response.
//!
//! The result has the tables `anova` (`response,source,df,ss,ms,f,p,significance,eta2,omega2`; sources are the factors,
//! then interactions, `residual`, `total`), `fit`, and `residuals`, in which runs that the model cannot explain are
//! flagged; `notes` lists what to look at. With `published` the table holds the printed F values beside the computed ones.

use super::beside::Beside;
use super::columns::{Columns, Rows, Wanted, check_names, check_probability, refused_without, runs};
use super::fitted::{fit_table, residual_table};
use super::given::check_given;
use super::invalid::Invalid;
use super::notes::{Notes, short};
use super::published::{Computed, beside, prints};
use super::reads::Reads;
use super::{Class, Complaint, Context, Failure, Job, Kind, Known, Port, Stage, StageError, Step, Task, Work};
use crate::artifact::statistics::{Anova as Stored, Fits, Variances};
use crate::artifact::validity::NotValid;
use crate::artifact::{Accepts, Artifact, ArtifactKind};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::json;
use stats::anova::{Anova as Analysis, Error, Interactions, Line, Settings, Squares, anova};
use std::collections::BTreeMap;

/// Settings of an `anova` stage.
#[derive(Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Anova {
    /// The stage whose runs are analysed.
    pub table: String,
    /// Factors to analyse; by default all of the table.
    #[serde(default)]
    pub factors: Vec<String>,
    /// Responses to analyse; by default all that the table has.
    #[serde(default)]
    pub responses: Vec<String>,
    /// Factors that are counted as error: empty columns, weak factors.
    #[serde(default)]
    pub as_error: Vec<String>,
    /// Factors that set nothing: they are analysed like the others, and a significant one gets a note, because the
    /// model then lacks interactions or the table has an error.
    #[serde(default)]
    pub empty: Vec<String>,
    /// Terms whose p exceeds this are pooled into the error.
    pub pool_above: Option<f64>,
    /// Two-way interactions: `"none"`, `"estimable"`, or a list of pairs.
    #[serde(default)]
    pub interactions: Pairs,
    /// Sums of squares of type I, II or III.
    #[serde(default, rename = "type")]
    pub squares: Squares,
    /// Denominator of F: `"residual"`, or `"pure-error"` of replicated runs.
    #[serde(default)]
    pub error: Error,
    /// A p up to this is significant.
    #[serde(default = "alpha")]
    pub alpha: f64,
    /// A p up to this, and up to `alpha`, is highly significant.
    #[serde(default = "alpha_high")]
    pub alpha_high: f64,
    /// Words for significant and highly significant.
    #[serde(default = "words")]
    pub words: [String; 2],
    /// Level of the outlier test on the studentized residuals, over all rows together.
    #[serde(default = "alpha")]
    pub outlier_alpha: f64,
    /// Column with the number of replicates of which each row is the mean.
    pub weights: Option<String>,
    /// What to do with runs that are not valid.
    #[serde(default, skip_serializing_if = "Invalid::is_default")]
    pub invalid: Invalid,
    /// Step to which a response of the table is rounded; adds the effect of rounding on F.
    #[serde(default)]
    pub rounding: BTreeMap<String, f64>,
    /// CSV beside the workflow with printed F values: `response,source,f` and, optionally, `note`.
    pub published: Option<String>,
}

/// Which interactions are in the model.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum Pairs {
    /// None, or all that can be estimated.
    Word(PairWord),
    /// Named pairs of factors.
    List(Vec<(String, String)>),
}

/// A word for a choice of interactions.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum PairWord {
    /// Main effects alone.
    None,
    /// Every pair that the runs can separate from the terms before it.
    Estimable,
}

impl Default for Pairs {
    fn default() -> Self {
        Self::Word(PairWord::None)
    }
}

fn alpha() -> f64 {
    0.05
}

fn alpha_high() -> f64 {
    0.01
}

fn words() -> [String; 2] {
    ["Significant".to_owned(), "Highly significant".to_owned()]
}

#[derive(Serialize, Deserialize)]
struct Params {
    columns: Columns,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    as_error: Vec<String>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    empty: Vec<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pool_above: Option<f64>,
    #[serde(default, skip_serializing_if = "is_default")]
    interactions: Pairs,
    #[serde(default, skip_serializing_if = "is_default")]
    squares: Squares,
    #[serde(default, skip_serializing_if = "is_default")]
    error: Error,
    alpha: f64,
    alpha_high: f64,
    words: [String; 2],
    outlier_alpha: f64,
    #[serde(default, skip_serializing_if = "is_default")]
    rounding: BTreeMap<String, f64>,
}

fn is_default<T: Default + PartialEq>(value: &T) -> bool {
    *value == T::default()
}

impl Anova {
    fn params(&self, columns: Columns) -> Params {
        Params {
            columns,
            as_error: self.as_error.clone(),
            empty: self.empty.clone(),
            pool_above: self.pool_above,
            interactions: self.interactions.clone(),
            squares: self.squares,
            error: self.error,
            alpha: self.alpha,
            alpha_high: self.alpha_high,
            words: self.words.clone(),
            outlier_alpha: self.outlier_alpha,
            rounding: self.rounding.clone(),
        }
    }
}

impl Stage for Anova {
    fn inputs(&self) -> Vec<Port> {
        vec![Port { key: "table", stages: vec![self.table.clone()], accepts: Accepts::Only(&[ArtifactKind::RESULTS]) }]
    }

    fn gives(&self) -> ArtifactKind {
        ArtifactKind::ANOVA
    }

    fn check(&self, context: &Context) -> Vec<Complaint> {
        let mut found = check_names(context, &self.factors, &self.responses);
        found.extend(check_given(context, "responses", &[&self.table], &self.responses));
        let rounded: Vec<String> = self.rounding.keys().cloned().collect();
        let retitled = |key: &'static str| move |c: Complaint| Complaint { path: vec![key.to_owned()], ..c };
        found.extend(check_names(context, &self.as_error, &[]).into_iter().map(retitled("as_error")));
        found.extend(check_names(context, &self.empty, &[]).into_iter().map(retitled("empty")));
        found.extend(check_names(context, &[], &rounded).into_iter().map(retitled("rounding")));
        if let Pairs::List(pairs) = &self.interactions {
            let names: Vec<String> = pairs.iter().flat_map(|(a, b)| [a.clone(), b.clone()]).collect();
            found.extend(check_names(context, &names, &[]).into_iter().map(retitled("interactions")));
            for (a, _) in pairs.iter().filter(|(a, b)| a == b) {
                let complaint = Complaint::new("interactions", format!("`{a}` is paired with itself"));
                found.push(complaint.hint("name two factors, as in [[\"Ec\", \"mu\"]]"));
            }
        }
        let levels = [("alpha", self.alpha), ("alpha_high", self.alpha_high), ("outlier_alpha", self.outlier_alpha)];
        let levels = levels.into_iter().chain(self.pool_above.map(|p| ("pool_above", p)));
        found.extend(levels.filter_map(|(key, value)| check_probability(key, value)));
        found
    }

    fn reads(&self) -> Vec<Reads> {
        vec![
            Reads::of("factors", &self.table, &self.factors),
            Reads::of("responses", &self.table, &self.responses),
            Reads::of("weights", &self.table, &self.weights),
        ]
    }

    fn beside(&self, _context: &Context, found: &mut Beside) {
        found.optional("published", self.published.as_ref());
    }

    fn next(&self, known: &Known) -> Result<Step, StageError> {
        let input = known.one("table")?;
        let artifact = known.load(input)?;
        let wanted = Wanted {
            factors: &self.factors,
            responses: &self.responses,
            weights: self.weights.as_deref(),
            levels: true,
            scales: false,
            invalid: self.invalid,
        };
        let columns = Columns::of(runs(&artifact)?, known.context, wanted)?;
        let mut task = Task::new("anova", json!(self.params(columns))).input("table", input.content);
        if let Some(path) = &self.published {
            task.files.push(known.library.file("published", path)?);
        }
        Ok(Step::Finish(task))
    }
}

impl Kind for Anova {
    const NAME: &'static str = "anova";
    const ABOUT: &'static str = "analysis of variance: sums of squares, F, p and contribution of every factor";
    const GIVES: &'static [ArtifactKind] = &[ArtifactKind::ANOVA];
    const CLASS: Class = Class::Statistics;
    // 4: what all responses have in common costs no digits. 3: runs that are not valid are left out. 2: notes; what rounding leaves of an exact fit is no error
    const WORKS: &'static [Work] = &[Work { name: "anova", version: 4, run: analyse }];
}

fn settings(params: &Params) -> Settings {
    let [significant, highly] = params.words.clone();
    Settings {
        squares: params.squares,
        error: params.error,
        interactions: match &params.interactions {
            Pairs::Word(PairWord::None) => Interactions::None,
            Pairs::Word(PairWord::Estimable) => Interactions::Estimable,
            Pairs::List(pairs) => Interactions::Named(pairs.clone()),
        },
        as_error: params.as_error.clone(),
        pool_above: params.pool_above,
        significance: vec![(params.alpha_high.min(params.alpha), highly), (params.alpha, significant)],
        outlier_alpha: params.outlier_alpha,
    }
}

fn analyse(job: &Job) -> Result<Artifact, Failure> {
    let params: Params = job.params()?;
    let runs = runs(job.input("table")?)?;
    let (sample, not_valid) = (params.columns.sample(runs)?, params.columns.not_valid(runs)?);
    let analyses = anova(&sample, &settings(&params)).map_err(|faults| refused_without(faults, &not_valid))?;
    let lines: Vec<(&Analysis, &Line)> = analyses.iter().flat_map(|a| a.lines.iter().map(move |l| (a, l))).collect();
    let rounding = |(a, line): &(&Analysis, &Line)| a.f_rounding(line, *params.rounding.get(&a.response)?);
    let mut table = variance_table(&lines);
    if !params.rounding.is_empty() {
        table.f_rounding = Some(Rows(&lines).reals(rounding));
    }
    let remark = |line: &Line| {
        let significant = line.p.is_some_and(|p| p <= params.alpha) && params.empty.contains(&line.source);
        if significant {
            "an empty column is significant: the model lacks interactions or the table has an error"
        } else {
            ""
        }
    };
    match prints(job, "source", "f")? {
        Some(prints) => {
            let computed: Vec<Computed> = lines
                .iter()
                .map(|own| Computed {
                    response: &own.0.response,
                    line: &own.1.source,
                    value: own.1.f,
                    rounding: rounding(own).unwrap_or(0.0),
                    remark: remark(own.1),
                })
                .collect();
            let (published, remark) = beside(&prints, &computed);
            (table.published, table.remark) = (Some(published), Some(remark));
        }
        None if params.empty.is_empty() => {}
        None => table.remark = Some(Rows(&lines).texts(|(_, line)| remark(line))),
    }
    let residuals = analyses.iter().map(|a| (a.response.as_str(), a.residuals.as_slice()));
    let fits: Vec<_> = analyses.iter().map(|a| &a.fit).collect();
    let about = Rows(&analyses);
    let fit = Fits {
        pooled: Some(about.texts(|a| a.pooled.join(" "))),
        not_estimable: Some(about.texts(|a| a.not_estimable.join(" "))),
        ..fit_table(&fits)
    };
    let (notes, residuals) = (notes(&analyses, &params, &not_valid).table(), residual_table(residuals));
    Ok(Stored { anova: table, fit, notes, residuals, not_valid: not_valid.some() }.to_artifact())
}

/// Notes on what a reader must know first.
fn notes<'a>(analyses: &[Analysis], params: &Params, not_valid: &'a NotValid) -> Notes<'a> {
    let mut notes = Notes::of(not_valid);
    for analysis in analyses {
        let response = analysis.response.as_str();
        for line in analysis.lines.iter().filter(|line| params.empty.contains(&line.source)) {
            if let (Some(f), Some(p)) = (line.f, line.p.filter(|p| *p <= params.alpha)) {
                let found =
                    format!("the empty column `{}` is significant (F = {}, p = {})", line.source, short(f), short(p));
                notes.add(response, format!("{found}: the model lacks interactions or the table has an error"));
            }
        }
        notes.fit(&analysis.fit);
        notes.residuals(response, &analysis.residuals);
        if !analysis.pooled.is_empty() {
            notes.add(response, format!("pooled into the error: {}", analysis.pooled.join(", ")));
        }
        if !analysis.not_estimable.is_empty() {
            notes.add(
                response,
                format!("not told apart by the runs, so left out: {}", analysis.not_estimable.join(", ")),
            );
        }
    }
    notes
}

fn variance_table(lines: &[(&Analysis, &Line)]) -> Variances {
    let rows = Rows(lines);
    Variances {
        response: rows.texts(|(a, _)| a.response.as_str()),
        source: rows.texts(|(_, l)| l.source.as_str()),
        df: rows.ints(|(_, l)| l.df),
        ss: rows.reals(|(_, l)| Some(l.ss)),
        ms: rows.reals(|(_, l)| l.ms),
        f: rows.reals(|(_, l)| l.f),
        p: rows.reals(|(_, l)| l.p),
        significance: rows.texts(|(_, l)| l.significance.as_str()),
        eta2: rows.reals(|(_, l)| l.eta2),
        omega2: rows.reals(|(_, l)| l.omega2),
        f_rounding: None,
        published: None,
        remark: None,
    }
}
