//! Plackett–Burman designs: N = 8, 12, … 48 runs for up to N − 1 two-level factors (Plackett & Burman 1946,
//! *Biometrika* 33, 305, doi:10.1093/biomet/33.4.305). Resolution III: main effects are clear of one another and,
//! unless N is a power of two, each is *partly* aliased with every two-factor interaction that does not contain it
//! (±1/3 at 12 runs). Folding over (Box & Wilson 1951) adds the mirror image of every run and clears main effects of
//! two-factor interactions. The constructions are listed in [`super::hadamard`].

use super::coding::{Factor, check_two_level};
use super::error::Fault;
use super::hadamard::two_level;
use super::table::{PointType, Points};
use super::{Design, Stream, is_default};
use serde::{Deserialize, Serialize};

/// Options of a Plackett–Burman design.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct PlackettBurman {
    /// Runs of the table before folding, a multiple of 4 from 8 to 48; the smallest that holds the factors if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub runs: Option<usize>,
    /// Add the mirror image of every run.
    #[serde(skip_serializing_if = "is_default")]
    pub fold: bool,
    /// Number of centre points added.
    #[serde(skip_serializing_if = "is_default")]
    pub centre_points: usize,
}

impl Design for PlackettBurman {
    const NAME: &'static str = "plackett-burman";

    fn points(&self, factors: &[Factor], _: &mut Stream) -> Result<Points, Vec<Fault>> {
        let design = "a Plackett–Burman design";
        let mut faults = check_two_level(factors, design);
        let least = (factors.len() / 4 + 1) * 4;
        let runs = self.runs.unwrap_or(least.max(8));
        let table = two_level(runs).filter(|_| runs >= 8);
        if self.runs.is_some() && table.is_none() {
            faults.push(Fault::BadOption {
                option: "runs".into(),
                found: runs.to_string(),
                wanted: "Plackett–Burman tables here have 8, 12, 16, 20, 24, 28, 32, 36, 40, 44 or 48 runs".into(),
            });
        } else if factors.len() >= runs || table.is_none() {
            let remedy = if least <= 48 { format!("use `runs = {least}`") } else { "47 factors is the most".into() };
            faults.push(Fault::NoConstruction {
                design: design.into(),
                found: format!("{} factors do not fit {} runs", factors.len(), runs.min(48)),
                remedy,
            });
        }
        let (Some(table), true) = (table, faults.is_empty()) else { return Err(faults) };
        let row = |sign: i8| move |r: &Vec<i8>| r.iter().take(factors.len()).map(|&x| f64::from(sign * x)).collect();
        let mut rows: Vec<Vec<f64>> = table.rows.iter().map(row(1)).collect();
        if self.fold {
            rows.extend(table.rows.iter().map(row(-1)));
        }
        let folded = if self.fold { ", folded over" } else { "" };
        Ok(Points {
            rows: Points::coded(&rows, PointType::Cube),
            centre: self.centre_points,
            construction: format!("Plackett–Burman, {runs} runs ({}){folded}", table.how),
            source: "Plackett & Burman 1946, Biometrika 33, 305, doi:10.1093/biomet/33.4.305".into(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Layout, Method, build};

    fn factors(n: usize) -> Vec<Factor> {
        (0..n).map(|i| Factor::range(&format!("x{}", i + 1), "", -1.0, 1.0)).collect()
    }

    fn rows(design: PlackettBurman, n: usize) -> Vec<Vec<f64>> {
        build(&Method::PlackettBurman(design), &factors(n), Layout::default(), 1).unwrap().coded
    }

    /// The 12-run table as printed (Plackett & Burman 1946; Montgomery, *Design and Analysis of Experiments*, table
    /// 8.23).
    #[test]
    fn twelve_runs_are_the_printed_matrix() {
        let printed = [
            "++-+++---+-",
            "-++-+++---+",
            "+-++-+++---",
            "-+-++-+++--",
            "--+-++-+++-",
            "---+-++-+++",
            "+---+-++-++",
            "++---+-++-+",
            "+++---+-++-",
            "-+++---+-++",
            "+-+++---+-+",
            "-----------",
        ];
        let text = |row: &Vec<f64>| row.iter().map(|&x| if x > 0.0 { '+' } else { '-' }).collect::<String>();
        assert_eq!(rows(PlackettBurman::default(), 11).iter().map(text).collect::<Vec<_>>(), printed);
    }

    #[test]
    fn the_smallest_table_is_chosen() {
        let runs = |n| rows(PlackettBurman::default(), n).len();
        assert_eq!([2, 7, 8, 11, 12, 23, 24, 27, 39, 47].map(runs), [8, 8, 12, 12, 16, 24, 28, 28, 40, 48]);
    }

    #[test]
    fn folding_and_centre_points_add_runs() {
        let t = rows(PlackettBurman { runs: Some(12), fold: true, centre_points: 3 }, 5);
        assert_eq!(t.len(), 27);
        assert!((0..12).all(|i| (0..5).all(|j| t[i][j] == -t[12 + i][j])));
        assert_eq!(t[26], [0.0; 5]);
    }

    #[test]
    fn what_does_not_fit_is_refused_with_the_remedy() {
        let error = |design, n| {
            build(&Method::PlackettBurman(design), &factors(n), Layout::default(), 1).unwrap_err().to_string()
        };
        assert!(error(PlackettBurman::default(), 48).contains("47 factors is the most"));
        assert!(error(PlackettBurman { runs: Some(12), ..Default::default() }, 12).contains("use `runs = 16`"));
        assert!(error(PlackettBurman { runs: Some(14), ..Default::default() }, 3).contains("`runs` is 14"));
        let mut three = factors(3);
        three[1] = Factor::levels("Ec", "GPa", &[10.0, 20.0, 30.0]);
        let text = build(&Method::PlackettBurman(PlackettBurman::default()), &three, Layout::default(), 1);
        assert!(text.unwrap_err().to_string().contains("`Ec` has 3 levels"));
    }
}
