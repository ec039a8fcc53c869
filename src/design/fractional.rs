//! Regular fractions 2^(k−p) of the two-level factorial, by generators (Box & Hunter 1961, *Technometrics* 3, 311 and
//! 449, doi:10.1080/00401706.1961.10489951).
//!
//! k − p basic factors run through all combinations in Yates order; each of the other p is the product of some of them,
//! `E = ABCD`. The generators' words (ABCDE) and their products are the *defining relation* I = …; its shortest word is
//! the *resolution*: III mixes main effects with two-factor interactions, IV two-factor interactions with one another,
//! V leaves both clear. Without generators the design is the one of minimum aberration (Fries & Hunter 1980,
//! doi:10.1080/00401706.1980.10486210) listed by Chen, Sun & Wu 1993, *Int. Stat. Rev.* 61, 131, doi:10.2307/1403599.

mod catalogue;
mod generator;
#[cfg(test)]
mod tests;

use super::coding::{Factor, check_two_level};
use super::error::Fault;
use super::table::{PointType, Points};
use super::{Design, Stream, is_default};
use generator::{Word, parse};
use serde::{Deserialize, Serialize};

/// Options of a fractional factorial: set one of `generators`, `resolution` and `runs`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct FractionalFactorial {
    /// One a generated factor: `"E=ABCD"` with letters by position (A, B, … without I), or `"mu=Ec*kn_ks"`; `"E=-ABCD"`
    /// takes the other half.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub generators: Vec<String>,
    /// The least resolution (3, 4, 5 …); the smallest published fraction that has it is taken.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub resolution: Option<usize>,
    /// Number of runs, a power of two; the published fraction of that size is taken.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub runs: Option<usize>,
    /// Number of centre points added.
    #[serde(skip_serializing_if = "is_default")]
    pub centre_points: usize,
}

/// The defining relation of a fraction.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Relation {
    /// Every word, shortest first: sign and the factors in it, by index.
    pub words: Vec<(i8, Vec<usize>)>,
    /// Number of words of each length, from length 0.
    pub lengths: Vec<usize>,
}

impl Relation {
    /// Length of the shortest word; none for a full factorial.
    pub fn resolution(&self) -> Option<usize> {
        self.lengths.iter().position(|&n| n > 0)
    }

    /// `I = A*B*C = …`, by factor names; long relations are cut after `most` words.
    pub fn text(&self, factors: &[Factor], most: usize) -> String {
        let word = |(sign, members): &(i8, Vec<usize>)| {
            let names: Vec<&str> = members.iter().map(|&i| factors[i].name.as_str()).collect();
            format!("{}{}", if *sign < 0 { "-" } else { "" }, names.join("*"))
        };
        let mut parts = vec!["I".to_string()];
        parts.extend(self.words.iter().take(most).map(word));
        if self.words.len() > most {
            parts.push(format!("… ({} words)", self.words.len()));
        }
        parts.join(" = ")
    }
}

/// More generated factors than this would make a relation too long to list.
const MOST_GENERATORS: usize = 20;
/// More basic factors than this make too long a table.
const MOST_BASIC: usize = 20;

impl FractionalFactorial {
    /// The generators, parsed or from the catalogue, and all faults of the options.
    fn words(&self, factors: &[Factor]) -> Result<Vec<Word>, Vec<Fault>> {
        let stated = usize::from(!self.generators.is_empty())
            + usize::from(self.resolution.is_some())
            + usize::from(self.runs.is_some());
        if stated != 1 {
            return Err(vec![Fault::BadOption {
                option: "generators, resolution, runs".into(),
                found: format!("said {stated} times in all"),
                wanted: "a fractional factorial needs exactly one of the three".into(),
            }]);
        }
        if !self.generators.is_empty() {
            return parse(&self.generators, factors);
        }
        catalogue::find(factors.len(), self.runs, self.resolution).map_err(|fault| vec![fault])
    }

    /// The defining relation for these factors.
    ///
    /// # Errors
    /// All faults of the options and generators.
    pub fn relation(&self, factors: &[Factor]) -> Result<Relation, Vec<Fault>> {
        let words = self.words(factors)?;
        if words.len() > MOST_GENERATORS || factors.len() - words.len() > MOST_BASIC {
            return Err(vec![Fault::NoConstruction {
                design: "fractional factorial".into(),
                found: format!("{} generators for {} factors", words.len(), factors.len()),
                remedy: format!("give at most {MOST_GENERATORS} generators and {MOST_BASIC} basic factors"),
            }]);
        }
        Ok(relation(&words, factors.len()))
    }
}

/// All products of the words.
fn relation(words: &[Word], factors: usize) -> Relation {
    let product = |choice: u32| {
        let chosen = words.iter().enumerate().filter(|(i, _)| choice >> i & 1 == 1);
        chosen.fold((1_i8, 0_u64), |(sign, mask), (_, w)| (sign * w.sign, mask ^ w.mask()))
    };
    let members = |mask: u64| (0..factors).filter(move |i| mask >> i & 1 == 1).collect::<Vec<_>>();
    let mut all: Vec<(i8, Vec<usize>)> = (1..1_u32 << words.len()).map(product).map(|(s, m)| (s, members(m))).collect();
    all.sort_by(|a, b| (a.1.len(), &a.1).cmp(&(b.1.len(), &b.1)));
    let mut lengths = vec![0; factors + 1];
    for (_, word) in &all {
        lengths[word.len()] += 1;
    }
    Relation { words: all, lengths }
}

/// ±1 rows of the fraction in Yates order of the basic factors.
fn rows(words: &[Word], factors: usize) -> Vec<Vec<f64>> {
    let basic: Vec<usize> = (0..factors).filter(|i| words.iter().all(|w| w.target != *i)).collect();
    let row = |run: usize| {
        let mut row = vec![0.0; factors];
        for (bit, &i) in basic.iter().enumerate() {
            row[i] = if run >> bit & 1 == 1 { 1.0 } else { -1.0 };
        }
        for word in words {
            row[word.target] = word.factors.iter().map(|&i| row[i]).product::<f64>() * f64::from(word.sign);
        }
        row
    };
    (0..1_usize << basic.len()).map(row).collect()
}

/// The cube part of a central composite design: the full factorial, or the smallest listed fraction of resolution ≥ 5.
pub(super) fn cube(factors: usize, fraction: bool) -> Result<Vec<Vec<f64>>, Fault> {
    let words = if fraction { catalogue::find(factors, None, Some(5))? } else { vec![] };
    Ok(rows(&words, factors))
}

impl Design for FractionalFactorial {
    const NAME: &'static str = "fractional-factorial";

    fn points(&self, factors: &[Factor], _: &mut Stream) -> Result<Points, Vec<Fault>> {
        let mut faults = check_two_level(factors, "a fractional factorial");
        let relation = self.relation(factors).map_err(|more| faults.extend(more)).ok();
        let words = relation.as_ref().and_then(|_| self.words(factors).ok()).unwrap_or_default();
        if let Some((sign, word)) = relation.iter().flat_map(|r| &r.words).find(|(_, w)| w.len() < 3) {
            let names: Vec<&str> = word.iter().map(|&i| factors[i].name.as_str()).collect();
            let sign = if *sign < 0 { "-" } else { "" };
            faults.push(Fault::BadOption {
                option: "generators".into(),
                found: format!("such that I = {sign}{}", names.join("*")),
                wanted: "main effects would be one and the same; choose generators of resolution III at least".into(),
            });
        }
        let (Some(relation), true) = (relation, faults.is_empty()) else { return Err(faults) };
        let rows = rows(&words, factors.len());
        let (runs, k, p) = (rows.len(), factors.len(), words.len());
        let resolution = relation.resolution().map_or("full".into(), |r| format!("resolution {r}"));
        Ok(Points {
            rows: Points::coded(&rows, PointType::Cube),
            centre: self.centre_points,
            construction: format!("2^({k}-{p}) fraction, {runs} runs, {resolution}; {}", relation.text(factors, 15)),
            source: if self.generators.is_empty() {
                "Chen, Sun & Wu 1993, Int. Stat. Rev. 61, 131, doi:10.2307/1403599".into()
            } else {
                "Box & Hunter 1961, Technometrics 3, 311, doi:10.1080/00401706.1961.10489951".into()
            },
        })
    }
}
