//! Sobol sequences (Sobol 1967, doi:10.1016/0041-5553(67)90144-9) with the direction numbers of Joe & Kuo 2008, *SIAM
//! J. Sci. Comput.* 30, 2635, doi:10.1137/070709359 (their set 6), for up to 64 factors; points in Gray-code order
//! (Antonov & Saleev 1979, doi:10.1016/0041-5553(79)90085-5).
//!
//! *First point.* Unscrambled, point 1 is the origin: every factor at its low end. It belongs to the sequence and is
//! included (dropping it spoils the balance of the first 2^m points: Owen 2020, arXiv:2008.08051); `skip` leaves out points
//! from the start. *Scrambling* (the default) multiplies the digits by random lower triangular matrices and adds a
//! random shift (Matoušek 1998, doi:10.1006/jcom.1998.0489); balance is preserved and no point lies on the boundary by rule.
//! Runs should be a power of two: then every factor's range is cut into as many equal parts with one point each.

mod directions;

use super::coding::{Domain, Factor};
use super::error::Fault;
use super::table::{MOST_RUNS, PointType, Points, Position};
use super::{Design, Stream, is_default};
use directions::DIRECTIONS;
use serde::{Deserialize, Serialize};

/// Options of a Sobol sample.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Sobol {
    /// Number of points, preferably a power of two.
    pub runs: usize,
    /// Scramble by the seed.
    #[serde(default = "yes", skip_serializing_if = "is_yes")]
    pub scramble: bool,
    /// Points left out from the start of the sequence.
    #[serde(default, skip_serializing_if = "is_default")]
    pub skip: usize,
}

fn yes() -> bool {
    true
}

fn is_yes(value: &bool) -> bool {
    *value
}

const BITS: usize = 32;

/// The 32 direction numbers of dimension `d` (from 0), the most significant digit first.
fn direction_numbers(d: usize) -> [u32; BITS] {
    let mut v = [0; BITS];
    let Some((polynomial, initial)) = d.checked_sub(1).map(|i| DIRECTIONS[i]) else {
        return std::array::from_fn(|i| 1 << (BITS - 1 - i));
    };
    let degree = initial.len();
    for i in 0..BITS {
        v[i] = if i < degree {
            initial[i] << (BITS - 1 - i)
        } else {
            // v_i = v_{i−s} ⊕ v_{i−s} / 2^s ⊕ the terms of the primitive polynomial between
            let between = (1..degree).filter(|k| polynomial >> (degree - k) & 1 == 1).map(|k| v[i - k]);
            between.fold(v[i - degree] ^ v[i - degree] >> degree, |sum, term| sum ^ term)
        };
    }
    v
}

/// Multiplies the digits by a random lower triangular matrix with ones on its diagonal.
fn scrambled(v: [u32; BITS], stream: &mut Stream) -> [u32; BITS] {
    let row = |i: usize, random: u64| {
        let diagonal = 1_u32 << (BITS - 1 - i);
        // digits more significant than the i-th
        let above = !(diagonal | (diagonal - 1));
        diagonal | (random as u32 & above)
    };
    let rows: [u32; BITS] = std::array::from_fn(|i| row(i, stream.bits()));
    v.map(|number| (0..BITS).fold(0, |new, i| new << 1 | (rows[i] & number).count_ones() & 1))
}

/// Points `skip` … `skip + runs − 1` of the sequence in [0, 1)^k.
fn sequence(k: usize, runs: usize, skip: usize, mut scramble: Option<&mut Stream>) -> Vec<Vec<f64>> {
    let mut start = vec![0_u32; k];
    let mut numbers = Vec::with_capacity(k);
    for (d, x) in start.iter_mut().enumerate() {
        let mut v = direction_numbers(d);
        if let Some(stream) = scramble.as_deref_mut() {
            v = scrambled(v, stream);
            *x = stream.bits() as u32;
        }
        let gray = skip ^ skip >> 1;
        for (_, number) in v.iter().enumerate().filter(|(i, _)| gray >> i & 1 == 1) {
            *x ^= number;
        }
        numbers.push(v);
    }
    let mut rows = Vec::with_capacity(runs);
    for n in skip..skip + runs {
        rows.push(start.iter().map(|&x| f64::from(x) / (1_u64 << BITS) as f64).collect());
        let digit = (n + 1).trailing_zeros() as usize;
        start.iter_mut().zip(&numbers).for_each(|(x, v)| *x ^= v[digit.min(BITS - 1)]);
    }
    rows
}

/// The position of a factor at the fraction `u` of its range: a level where it has levels.
pub(super) fn position(factor: &Factor, u: f64) -> Position {
    match &factor.domain {
        Domain::Levels(levels) => Position::Level(((u * levels.len() as f64) as usize).min(levels.len() - 1)),
        Domain::Range { .. } => Position::Coded(2.0 * u - 1.0),
    }
}

/// Faults of a number of points.
pub(super) fn check_runs(runs: usize, least: usize) -> Option<Fault> {
    (!(least..=MOST_RUNS).contains(&runs)).then(|| Fault::BadOption {
        option: "runs".into(),
        found: runs.to_string(),
        wanted: format!("a sample has {least} to {MOST_RUNS} points"),
    })
}

impl Design for Sobol {
    const NAME: &'static str = "sobol";

    fn faults(&self, factors: &[Factor]) -> Vec<Fault> {
        let mut faults: Vec<Fault> = check_runs(self.runs, 1).into_iter().collect();
        if self.skip > MOST_RUNS {
            let wanted = format!("at most {MOST_RUNS} points can be left out");
            faults.push(Fault::BadOption { option: "skip".into(), found: self.skip.to_string(), wanted });
        }
        if factors.len() > DIRECTIONS.len() + 1 {
            faults.push(Fault::NoConstruction {
                design: "a Sobol sample".into(),
                found: format!("{} factors", factors.len()),
                remedy: format!("direction numbers are here for {}; use a Latin hypercube", DIRECTIONS.len() + 1),
            });
        }
        faults
    }

    fn size(&self, _: &[Factor]) -> (usize, usize) {
        (self.runs, 0)
    }

    fn draws(&self) -> bool {
        self.scramble
    }

    fn points(&self, factors: &[Factor], stream: &mut Stream) -> Result<Points, Vec<Fault>> {
        let faults = self.faults(factors);
        if !faults.is_empty() {
            return Err(faults);
        }
        let points = sequence(factors.len(), self.runs, self.skip, self.scramble.then_some(stream));
        let row = |p: &Vec<f64>| (p.iter().zip(factors).map(|(&u, f)| position(f, u)).collect(), PointType::Sample);
        let how = if self.scramble { "scrambled" } else { "unscrambled" };
        let skipped = if self.skip > 0 { format!(", the first {} left out", self.skip) } else { String::new() };
        Ok(Points {
            rows: points.iter().map(row).collect(),
            centre: 0,
            construction: format!("Sobol sequence, {} points, {how}{skipped}", self.runs),
            source: "Joe & Kuo 2008, SIAM J. Sci. Comput. 30, 2635, doi:10.1137/070709359".into(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Layout, Method, build};

    /// Written by `tests/reference/design/generate.py` with scipy's `qmc.Sobol`.
    #[test]
    fn values_are_those_of_scipy() {
        let reference = include_str!("../../tests/reference/design/sobol.csv");
        let rows = sequence(64, 1024, 0, None);
        let mut compared = 0;
        for line in reference.lines().filter(|l| !l.starts_with('#')) {
            let cells: Vec<f64> = line.split(',').map(|c| c.parse().unwrap()).collect();
            assert_eq!(rows[cells[0] as usize], cells[1..], "point {}", cells[0]);
            compared += 1;
        }
        assert_eq!(compared, 24);
    }

    #[test]
    fn skipping_leaves_the_rest_unchanged() {
        assert_eq!(sequence(5, 32, 0, None)[13..], sequence(5, 19, 13, None));
        let mut a = Stream::new(4, "s", 0);
        let mut b = Stream::new(4, "s", 0);
        assert_eq!(sequence(5, 32, 0, Some(&mut a))[7..], sequence(5, 25, 7, Some(&mut b)));
    }

    #[test]
    fn every_dimension_fills_every_interval_once_scrambled_or_not() {
        let mut stream = Stream::new(1, "test", 0);
        for rows in [sequence(64, 256, 0, None), sequence(64, 256, 0, Some(&mut stream))] {
            for d in 0..64 {
                let mut cells: Vec<usize> = rows.iter().map(|r| (r[d] * 256.0) as usize).collect();
                cells.sort_unstable();
                assert_eq!(cells, (0..256).collect::<Vec<_>>(), "dimension {d}");
            }
        }
    }

    #[test]
    fn seeds_differ_and_levels_are_filled_evenly() {
        let factors = [Factor::range("a", "", 10.0, 30.0), Factor::levels("b", "", &[1.0, 2.0, 4.0, 8.0])];
        let table = |seed| {
            build(&Method::Sobol(Sobol { runs: 16, scramble: true, skip: 0 }), &factors, Layout::default(), seed)
                .unwrap()
        };
        assert_eq!(table(1), table(1));
        assert_ne!(table(1).natural, table(2).natural);
        for level in [1.0, 2.0, 4.0, 8.0] {
            assert_eq!(table(1).natural.iter().filter(|r| r[1] == level).count(), 4);
        }
        assert!(table(3).natural.iter().all(|r| (10.0..30.0).contains(&r[0])));
    }

    #[test]
    fn sizes_that_make_no_sense_are_refused() {
        let factors: Vec<Factor> = (0..65).map(|i| Factor::range(&format!("x{i}"), "", 0.0, 1.0)).collect();
        let sobol = Sobol { runs: 0, scramble: false, skip: usize::MAX };
        let text = build(&Method::Sobol(sobol), &factors, Layout::default(), 1).unwrap_err().to_string();
        assert!(text.contains("`runs` is 0") && text.contains("65 factors") && text.contains("`skip`"), "{text}");
    }
}
