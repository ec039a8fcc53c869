//! Report on a table of runs, from its rows alone: balance, orthogonality, aliases, models, power, spread.
//!
//! * [`mod@balance`]: how often each level occurs; proportional frequencies (n_ab N = n_a n_b for every pair of levels of
//!   two factors, which makes their main effects uncorrelated: Addelman 1962, doi:10.1080/00401706.1962.10489985);
//!   strength
//! * [`model`]: rank of the models one may want, the aliased terms, variance inflation
//! * [`alias`]: what each main effect would pick up from interactions and squares that are left out of the model
//! * [`power`]: the chance to see an effect of a given size
//! * [`mod@spread`]: distances and discrepancy of a sample
//!
//! Coded units throughout ([`super::coding`]).

pub mod alias;
pub mod balance;
pub mod model;
pub mod power;
pub mod spread;
#[cfg(test)]
mod tests;

use super::table::{DesignTable, PointType};
use alias::{Alias, aliases};
use balance::{Balance, balance};
use model::{Kind, Model, ModelReport};
use power::{Power, Question, powers};
use spread::{Spread, spread};

/// All reports on the rows of a design.
#[derive(Clone, Debug, PartialEq)]
pub struct Report {
    /// Number of runs.
    pub runs: usize,
    /// Number of different rows; the rest are replicates.
    pub distinct: usize,
    /// Levels, correlations, strength.
    pub balance: Balance,
    /// The models one may want, simplest first.
    pub models: Vec<ModelReport>,
    /// Aliases of the first-order model, by main effect; none when they were too many to compute.
    pub aliases: Option<Vec<Alias>>,
    /// The model the power is computed for: the richest that can be estimated with degrees of freedom left.
    pub power_model: Option<Kind>,
    /// Power by term, or by factor for [`Kind::Levels`].
    pub power: Vec<Power>,
    /// Distances and discrepancy, of samples only.
    pub spread: Option<Spread>,
}

/// A line of the report as a table.
#[derive(Clone, Debug, PartialEq)]
pub struct Line {
    /// `design`, `balance`, `correlation`, `model`, `alias`, `power`, `spread`.
    pub section: &'static str,
    /// Factor, term or model.
    pub subject: String,
    /// What is measured.
    pub quantity: String,
    /// Its value; NaN where there is none.
    pub value: f64,
    /// In words, where they say more.
    pub text: String,
}

/// Judges a design.
pub fn report(table: &DesignTable, question: Question) -> Report {
    let balance = balance(table);
    let kinds = [Kind::Main, Kind::Levels, Kind::Interactions, Kind::SecondOrder];
    let models: Vec<(Model, ModelReport)> = kinds
        .into_iter()
        .filter(|kind| kind.applies(table))
        .map(|kind| {
            let model = Model::new(kind, table);
            let report = model.report();
            (model, report)
        })
        .collect();
    // products of slopes without squares describe nothing when a factor has a third level
    let preference = [Kind::SecondOrder, Kind::Levels, Kind::Interactions, Kind::Main];
    let usable = |kind: &Kind| models.iter().find(|(_, r)| r.kind == *kind && r.estimable() && r.residual_df > 0);
    let richest = preference.iter().find_map(usable);
    Report {
        runs: table.runs(),
        distinct: table.replicate().iter().filter(|r| **r == 1).count(),
        balance,
        aliases: models.iter().find(|(model, _)| model.kind == Kind::Main).and_then(|(main, _)| aliases(table, main)),
        power_model: richest.map(|(_, r)| r.kind),
        power: richest.map(|(m, r)| powers(m, r, question)).unwrap_or_default(),
        spread: table.point_type.contains(&PointType::Sample).then(|| spread(table)),
        models: models.into_iter().map(|(_, r)| r).collect(),
    }
}

/// At most this many terms are named in a line of words.
const NAMED: usize = 12;
/// Most aliases of one main effect that are listed, the largest first.
const ALIASES: usize = 8;

/// Rounds to twelve decimals: beyond them is the rounding of the sums, and 1 should read as 1.
fn tidy(x: f64) -> f64 {
    let rounded = (x * 1e12).round() / 1e12;
    if x.abs() < 1e3 { rounded + 0.0 } else { x }
}

/// `a, b, c … (9 in all)`.
fn named(names: &[String]) -> String {
    if names.len() <= NAMED {
        names.join(", ")
    } else {
        format!("{} … ({} in all)", names[..NAMED].join(", "), names.len())
    }
}

impl Report {
    /// The report as lines, in a fixed order.
    pub fn lines(&self, table: &DesignTable) -> Vec<Line> {
        let mut lines = Vec::new();
        let mut line = |section, subject: &str, quantity: &str, value: f64, text: String| {
            lines.push(Line { section, subject: subject.into(), quantity: quantity.into(), value, text });
        };
        line("design", "", "construction", f64::NAN, table.construction.clone());
        line("design", "", "source", f64::NAN, table.source.clone());
        line("design", "", "runs", self.runs as f64, String::new());
        line("design", "", "distinct rows", self.distinct as f64, String::new());
        let b = &self.balance;
        for f in b.factors.iter().filter(|f| f.counts.len() <= NAMED) {
            for (value, count) in &f.counts {
                line("balance", &f.factor, &format!("runs at {value}"), *count as f64, String::new());
            }
        }
        let pair = b.worst.as_ref().map(|(x, y)| format!("{x}, {y}")).unwrap_or_default();
        line("orthogonality", "", "largest |correlation|", b.largest_correlation, pair);
        let words = match (&b.disproportional, b.disproportional_pairs) {
            (_, None) => "not asked of a sample".into(),
            (None, Some(_)) => "every pair of factors".into(),
            (Some((x, y)), Some(n)) => format!("not {n} pairs, such as {x}, {y}"),
        };
        let pairs = b.disproportional_pairs.map_or(f64::NAN, |n| n as f64);
        line("orthogonality", "", "pairs without proportional frequencies", pairs, words);
        let words = match b.strength {
            None => "not asked of a sample",
            Some(0) => "the levels of some factor are not met equally often",
            Some(1) => "levels are met equally often, pairs of them are not",
            Some(_) => "so many factors together are a full factorial, equally often",
        };
        line("orthogonality", "", "strength", b.strength.map_or(f64::NAN, |s| s as f64), words.into());
        for m in &self.models {
            m.lines(&mut line);
        }
        self.alias_lines(&mut line);
        if let Some(kind) = self.power_model {
            for p in &self.power {
                line("power", &p.term, "power", p.power, format!("in the model {}", kind.words()));
                line(
                    "power",
                    &p.term,
                    "effect seen with power 0.8, in standard deviations",
                    p.detectable,
                    String::new(),
                );
            }
        } else {
            line("power", "", "power", f64::NAN, "no model leaves degrees of freedom for the noise".into());
        }
        if let Some(s) = &self.spread {
            line("spread", "", "smallest distance", s.smallest_distance, "in the unit cube".into());
            line("spread", "", "centred L2 discrepancy", s.discrepancy, String::new());
        }
        lines
    }

    fn alias_lines(&self, line: &mut impl FnMut(&'static str, &str, &str, f64, String)) {
        let Some(aliases) = &self.aliases else {
            line("alias", "", "aliases of main effects", f64::NAN, "too many to compute".into());
            return;
        };
        for group in aliases.chunk_by(|a, b| a.main == b.main) {
            for a in group.iter().take(ALIASES) {
                line("alias", &a.main, &a.with, a.coefficient, String::new());
            }
            if let Some(rest) = group.len().checked_sub(ALIASES + 1) {
                line("alias", &group[0].main, "further aliases, none larger", (rest + 1) as f64, String::new());
            }
        }
        if aliases.is_empty() {
            let words = "no main effect shares anything with a square or a two-factor interaction";
            line("alias", "", "aliases of main effects", 0.0, words.into());
        }
    }
}
