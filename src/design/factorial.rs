//! Full factorial: every combination of the levels of every factor (Fisher 1935, *The Design of Experiments*; Yates
//! 1937).
//!
//! Standard order is that of Yates: the first factor changes fastest. A factor given by a range is set to its two ends.
//! Centre points may be added; they are at the middle of every range.

use super::coding::{Factor, check_surface};
use super::error::Fault;
use super::table::{MOST_RUNS, PointType, Points, Position};
use super::{Design, Stream, is_default};
use serde::{Deserialize, Serialize};

/// Options of a full factorial.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct FullFactorial {
    /// Number of centre points added to the combinations.
    #[serde(skip_serializing_if = "is_default")]
    pub centre_points: usize,
}

impl Design for FullFactorial {
    const NAME: &'static str = "full-factorial";

    fn points(&self, factors: &[Factor], _: &mut Stream) -> Result<Points, Vec<Fault>> {
        let faults = self.faults(factors);
        if !faults.is_empty() {
            return Err(faults);
        }
        let counts: Vec<usize> = factors.iter().map(Factor::level_count).collect();
        let runs: usize = counts.iter().product();
        let kind = if counts.iter().all(|&n| n == 2) { PointType::Cube } else { PointType::Grid };
        let row = |run: usize| {
            let mut rest = run;
            let position = |n: &usize| {
                let level = rest % n;
                rest /= n;
                Position::Level(level)
            };
            (counts.iter().map(position).collect(), kind)
        };
        let shape: Vec<String> = counts.iter().map(ToString::to_string).collect();
        Ok(Points {
            rows: (0..runs).map(row).collect(),
            centre: self.centre_points,
            construction: format!("full factorial, {} = {runs} combinations", shape.join(" × ")),
            source: "Fisher 1935, The Design of Experiments".into(),
        })
    }

    fn size(&self, factors: &[Factor]) -> (usize, usize) {
        (factors.iter().map(Factor::level_count).product(), self.centre_points)
    }

    fn faults(&self, factors: &[Factor]) -> Vec<Fault> {
        let mut faults = if self.centre_points > 0 { check_surface(factors, "a centre point") } else { vec![] };
        let mut counts = factors.iter().map(Factor::level_count);
        if counts.try_fold(1_usize, |runs, n| runs.checked_mul(n).filter(|&r| r <= MOST_RUNS)).is_none() {
            faults.push(Fault::NoConstruction {
                design: "full factorial".into(),
                found: format!("the combinations of {} factors are more than {MOST_RUNS}", factors.len()),
                remedy: "use fewer factors or levels, or an orthogonal, fractional or sampled design".into(),
            });
        }
        faults
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Layout, Method, build};

    #[test]
    fn the_matrix_of_2_by_3_is_in_yates_order() {
        let factors = [Factor::range("a", "", 0.0, 4.0), Factor::levels("b", "m", &[1.0, 2.5, 4.0])];
        let t = build(&Method::FullFactorial(FullFactorial::default()), &factors, Layout::default(), 1).unwrap();
        assert_eq!(t.natural, [[0.0, 1.0], [4.0, 1.0], [0.0, 2.5], [4.0, 2.5], [0.0, 4.0], [4.0, 4.0]]);
        assert_eq!(t.coded, [[-1.0, -1.0], [1.0, -1.0], [-1.0, 0.0], [1.0, 0.0], [-1.0, 1.0], [1.0, 1.0]]);
        assert_eq!((t.point_type[0], t.standard_order.as_slice()), (PointType::Grid, [1, 2, 3, 4, 5, 6].as_slice()));
    }

    #[test]
    fn centre_points_stand_at_the_middle_and_are_replicates() {
        let factors = [Factor::range("a", "", 0.0, 4.0), Factor::range("b", "", -1.0, 0.0)];
        let t =
            build(&Method::FullFactorial(FullFactorial { centre_points: 2 }), &factors, Layout::default(), 1).unwrap();
        assert_eq!((t.runs(), t.natural[4].as_slice()), (6, [2.0, -0.5].as_slice()));
        assert_eq!(t.replicate(), [1, 1, 1, 1, 1, 2]);
    }

    #[test]
    fn too_many_combinations_are_refused() {
        let factors: Vec<Factor> = (0..21).map(|i| Factor::range(&format!("x{i}"), "", 0.0, 1.0)).collect();
        let error = build(&Method::FullFactorial(FullFactorial::default()), &factors, Layout::default(), 1);
        assert!(error.unwrap_err().to_string().contains("21 factors are more than 1048576"));
    }
}
