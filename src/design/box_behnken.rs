//! Box–Behnken designs for 3 to 7 factors (Box & Behnken 1960, *Technometrics* 2, 455,
//! doi:10.1080/00401706.1960.10489912).
//!
//! Every block of an incomplete block design names the factors that run through ±1 together while the others stay at 0;
//! centre points are added. No point lies at a corner of the cube, and three levels suffice for a second-order surface.
//!
//! | factors | blocks | edge runs | centre points as published |
//! |---|---|---|---|
//! | 3, 4, 5 | all pairs | 12, 24, 40 | 3, 3, 6 |
//! | 6 | 6 triples | 48 | 6 |
//! | 7 | 7 triples (the projective plane of order 2) | 56 | 6 |

use super::coding::{Factor, check_surface};
use super::error::Fault;
use super::table::{PointType, Points};
use super::{Design, Stream};
use serde::{Deserialize, Serialize};

/// Options of a Box–Behnken design.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct BoxBehnken {
    /// Number of centre points; the published number if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub centre_points: Option<usize>,
}

/// Blocks and centre points by number of factors.
type Published = (usize, &'static [&'static [usize]], usize);

const PUBLISHED: [Published; 5] = [
    (3, &[&[0, 1], &[0, 2], &[1, 2]], 3),
    (4, &[&[0, 1], &[2, 3], &[0, 3], &[1, 2], &[0, 2], &[1, 3]], 3),
    (5, &[&[0, 1], &[2, 3], &[1, 4], &[0, 2], &[3, 4], &[1, 2], &[0, 3], &[2, 4], &[0, 4], &[1, 3]], 6),
    (6, &[&[0, 1, 3], &[1, 2, 4], &[2, 3, 5], &[0, 3, 4], &[1, 4, 5], &[0, 2, 5]], 6),
    (7, &[&[3, 4, 5], &[0, 5, 6], &[1, 4, 6], &[0, 1, 3], &[2, 3, 6], &[0, 2, 4], &[1, 2, 5]], 6),
];

impl Design for BoxBehnken {
    const NAME: &'static str = "box-behnken";

    fn points(&self, factors: &[Factor], _: &mut Stream) -> Result<Points, Vec<Fault>> {
        let design = "a Box–Behnken design";
        let mut faults = check_surface(factors, design);
        let k = factors.len();
        let published = PUBLISHED.iter().find(|(n, _, _)| *n == k);
        if published.is_none() {
            faults.push(Fault::NoConstruction {
                design: design.into(),
                found: format!("{k} factors"),
                remedy: "blocks are published for 3 to 7 factors; use a central composite design".into(),
            });
        }
        let (Some((_, blocks, centre)), true) = (published, faults.is_empty()) else { return Err(faults) };
        let mut rows = Vec::new();
        for block in *blocks {
            for run in 0..1_usize << block.len() {
                let mut row = vec![0.0; k];
                for (bit, &i) in block.iter().enumerate() {
                    row[i] = if run >> bit & 1 == 1 { 1.0 } else { -1.0 };
                }
                rows.push(row);
            }
        }
        let edges = rows.len();
        let centre = self.centre_points.unwrap_or(*centre);
        Ok(Points {
            rows: Points::coded(&rows, PointType::Edge),
            centre,
            construction: format!("Box–Behnken, {edges} edge runs and {centre} centre points"),
            source: "Box & Behnken 1960, Technometrics 2, 455, doi:10.1080/00401706.1960.10489912".into(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{DesignTable, Layout, Method, build};

    fn table(k: usize, centre_points: Option<usize>) -> DesignTable {
        let factors: Vec<Factor> = (0..k).map(|i| Factor::range(&format!("x{i}"), "", -1.0, 1.0)).collect();
        build(&Method::BoxBehnken(BoxBehnken { centre_points }), &factors, Layout::default(), 1).unwrap()
    }

    /// Box & Behnken 1960.
    #[test]
    fn three_factors_are_the_printed_matrix() {
        let printed =
            ["--0", "+-0", "-+0", "++0", "-0-", "+0-", "-0+", "+0+", "0--", "0+-", "0-+", "0++", "000", "000", "000"];
        let text = |r: &Vec<f64>| r.iter().map(|&x| ["-", "0", "+"][(x + 1.0) as usize]).collect::<String>();
        assert_eq!(table(3, None).coded.iter().map(text).collect::<Vec<_>>(), printed);
    }

    #[test]
    fn run_counts_are_those_published_and_points_are_distinct() {
        for (k, edges, runs) in [(3, 12, 15), (4, 24, 27), (5, 40, 46), (6, 48, 54), (7, 56, 62)] {
            let t = table(k, None);
            assert_eq!((t.runs(), t.point_type.iter().filter(|p| **p == PointType::Edge).count()), (runs, edges));
            assert!(t.replicate()[..edges].iter().all(|&r| r == 1));
            // every factor is varied equally often and every pair of factors is orthogonal
            for a in 0..k {
                let varied = t.coded.iter().filter(|r| r[a] != 0.0).count();
                assert_eq!(varied * k, edges * if k < 6 { 2 } else { 3 });
                assert!((0..a).all(|b| t.coded.iter().map(|r| r[a] * r[b]).sum::<f64>() == 0.0));
            }
        }
        // six and seven factors take triples: every pair of factors meets in at least one block
        for k in [6, 7] {
            let t = table(k, Some(0));
            let meet = |a: usize, b: usize| t.coded.iter().any(|r| r[a] != 0.0 && r[b] != 0.0);
            assert!((0..k).all(|a| (0..a).all(|b| meet(a, b))));
        }
    }

    #[test]
    fn what_is_not_published_is_refused() {
        let factors: Vec<Factor> = (0..8).map(|i| Factor::range(&format!("x{i}"), "", -1.0, 1.0)).collect();
        let error = |f: &[Factor]| {
            build(&Method::BoxBehnken(BoxBehnken::default()), f, Layout::default(), 1).unwrap_err().to_string()
        };
        assert!(error(&factors).contains("8 factors; blocks are published for 3 to 7"));
        let uneven = [factors[0].clone(), factors[1].clone(), Factor::levels("mu", "", &[0.1, 1.0, 1.5])];
        assert!(error(&uneven).contains("`mu` has the middle level 1, but the centre of 0.1 to 1.5 is 0.8"));
    }
}
