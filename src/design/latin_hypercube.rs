//! Latin hypercube samples (McKay, Beckman & Conover 1979, *Technometrics* 21, 239,
//! doi:10.1080/00401706.1979.10489755): the range of every factor is cut into n equal strata and each stratum holds one
//! of the n points.
//!
//! `maximin` spreads the points by exchanging two values of one factor under simulated annealing (Morris & Mitchell
//! 1995, *J. Stat. Plan. Inference* 43, 381, doi:10.1016/0378-3758(94)00035-T): it minimises φ = (Σ d⁻⁴⁰)^(1/40) over
//! the distances d of all pairs, measured in strata, which for so high a power pushes the smallest distance up. The
//! the best sample is used.

use super::coding::Factor;
use super::error::Fault;
use super::sobol::{check_runs, position};
use super::table::{PointType, Points};
use super::{Design, Stream, is_default};
use math::elementary::{exp, ln};
use serde::{Deserialize, Serialize};

/// How the strata are combined.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Criterion {
    /// Spread out.
    #[default]
    Maximin,
    /// At random.
    Random,
}

/// Where a point lies in its stratum.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Position {
    /// In the middle.
    #[default]
    Centre,
    /// Anywhere.
    Random,
}

/// Options of a Latin hypercube.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LatinHypercube {
    /// Number of points.
    pub runs: usize,
    /// How the strata are combined.
    #[serde(default, skip_serializing_if = "is_default")]
    pub criterion: Criterion,
    /// Where a point lies in its stratum.
    #[serde(default, skip_serializing_if = "is_default")]
    pub position: Position,
}

/// Beyond this many points the table of distances is too large to search.
const MOST_SPREAD: usize = 2000;

impl Design for LatinHypercube {
    const NAME: &'static str = "latin-hypercube";

    fn faults(&self, _: &[Factor]) -> Vec<Fault> {
        let mut faults: Vec<Fault> = check_runs(self.runs, 2).into_iter().collect();
        if self.criterion == Criterion::Maximin && self.runs > MOST_SPREAD {
            faults.push(Fault::BadOption {
                option: "criterion".into(),
                found: format!("maximin for {} points", self.runs),
                wanted: format!("it spreads at most {MOST_SPREAD} points; say `random`, or use a Sobol sample"),
            });
        }
        faults
    }

    fn size(&self, _: &[Factor]) -> (usize, usize) {
        (self.runs, 0)
    }

    fn draws(&self) -> bool {
        true
    }

    fn points(&self, factors: &[Factor], stream: &mut Stream) -> Result<Points, Vec<Fault>> {
        let faults = self.faults(factors);
        if !faults.is_empty() {
            return Err(faults);
        }
        let (n, k) = (self.runs, factors.len());
        let mut columns: Vec<Vec<usize>> = (0..k).map(|_| permutation(n, stream)).collect();
        if self.criterion == Criterion::Maximin && n > 2 && k > 1 {
            columns = Spread::new(columns).anneal(stream);
        }
        let mut within = || match self.position {
            Position::Centre => 0.5,
            Position::Random => stream.uniform(),
        };
        let mut rows = Vec::with_capacity(n);
        for run in 0..n {
            let positions =
                factors.iter().zip(&columns).map(|(f, c)| position(f, (c[run] as f64 + within()) / n as f64));
            rows.push((positions.collect(), PointType::Sample));
        }
        let how = match self.criterion {
            Criterion::Maximin => "maximin",
            Criterion::Random => "random",
        };
        Ok(Points {
            rows,
            centre: 0,
            construction: format!("Latin hypercube, {n} points, {how}"),
            source: match self.criterion {
                Criterion::Maximin => {
                    "Morris & Mitchell 1995, J. Stat. Plan. Inference 43, 381, doi:10.1016/0378-3758(94)00035-T".into()
                }
                Criterion::Random => {
                    "McKay, Beckman & Conover 1979, Technometrics 21, 239, doi:10.1080/00401706.1979.10489755".into()
                }
            },
        })
    }
}

fn permutation(n: usize, stream: &mut Stream) -> Vec<usize> {
    let mut items: Vec<usize> = (0..n).collect();
    stream.shuffle(&mut items);
    items
}

/// A sample under improvement: strata by factor, squared distances of all pairs, and Σ d⁻⁴⁰.
struct Spread {
    columns: Vec<Vec<usize>>,
    squares: Vec<f64>,
    n: usize,
}

/// d⁻⁴⁰ from d².
fn crowding(square: f64) -> f64 {
    let inverse = 1.0 / square;
    let fourth = inverse * inverse * inverse * inverse;
    let sixteenth = fourth * fourth * fourth * fourth;
    sixteenth * fourth
}

impl Spread {
    fn new(columns: Vec<Vec<usize>>) -> Self {
        let n = columns[0].len();
        let square = |i: usize| {
            let gap = |c: &Vec<usize>| c[i / n].abs_diff(c[i % n]) as f64;
            columns.iter().map(|c| gap(c) * gap(c)).sum()
        };
        let squares = (0..n * n).map(square).collect();
        Self { columns, squares, n }
    }

    fn total(&self) -> f64 {
        (0..self.n).flat_map(|i| (0..i).map(move |j| (i, j))).map(|(i, j)| crowding(self.squares[i * self.n + j])).sum()
    }

    /// Squared distances from runs `a` and `b` to run `j` after exchanging their values of `column`.
    fn exchanged(&self, column: usize, a: usize, b: usize, j: usize) -> (f64, f64) {
        let c = &self.columns[column];
        let gap = |x: usize| c[x].abs_diff(c[j]) as f64;
        let shift = gap(b) * gap(b) - gap(a) * gap(a);
        (self.squares[a * self.n + j] + shift, self.squares[b * self.n + j] - shift)
    }

    /// Change of Σ d⁻⁴⁰ by that exchange.
    fn change(&self, column: usize, a: usize, b: usize) -> f64 {
        let mut change = 0.0;
        for j in (0..self.n).filter(|&j| j != a && j != b) {
            let (from_a, from_b) = self.exchanged(column, a, b, j);
            change += crowding(from_a) - crowding(self.squares[a * self.n + j]);
            change += crowding(from_b) - crowding(self.squares[b * self.n + j]);
        }
        change
    }

    fn exchange(&mut self, column: usize, a: usize, b: usize) {
        for j in (0..self.n).filter(|&j| j != a && j != b) {
            let (from_a, from_b) = self.exchanged(column, a, b, j);
            for (i, square) in [(a, from_a), (b, from_b)] {
                self.squares[i * self.n + j] = square;
                self.squares[j * self.n + i] = square;
            }
        }
        self.columns[column].swap(a, b);
    }

    /// Simulated annealing on φ = (Σ d⁻⁴⁰)^(1/40), whose relative change is ln(Σ'/Σ)/40: [`CYCLES`] times from hot to
    /// cold.
    fn anneal(mut self, stream: &mut Stream) -> Vec<Vec<usize>> {
        let (n, k) = (self.n, self.columns.len());
        let tries = (100 * n * k).max(20_000).min((20_000_000 / n).max(1));
        let cooling = exp(ln(COLD / HOT) / tries as f64);
        let mut best = (f64::INFINITY, self.columns.clone());
        for _ in 0..CYCLES {
            let (mut now, mut heat) = (self.total(), HOT);
            let mut exact = now;
            for _ in 0..tries {
                let (column, a) = (stream.below(k), stream.below(n));
                let b = (a + 1 + stream.below(n - 1)) % n;
                let next = now + self.change(column, a, b);
                let worse = if next > 0.0 { ln(next / now) / 40.0 } else { 0.0 };
                if worse <= 0.0 || stream.uniform() < exp(-worse / heat) {
                    self.exchange(column, a, b);
                    now = next;
                    // a sum of changes loses the digits of what was large before
                    if now < 0.01 * exact || now > 100.0 * exact {
                        now = self.total();
                        exact = now;
                    }
                    if now < best.0 * (1.0 - 1e-9) {
                        best = (now, self.columns.clone());
                    }
                }
                heat *= cooling;
            }
        }
        best.1
    }
}

/// Times the annealing is run from hot to cold.
const CYCLES: usize = 10;
/// Relative rise of φ that is accepted one time in e at first …
const HOT: f64 = 0.05;
/// … and at last.
const COLD: f64 = 0.0005;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{DesignTable, Layout, Method, build};

    fn sample(runs: usize, k: usize, criterion: Criterion, position: Position, seed: u64) -> DesignTable {
        let factors: Vec<Factor> = (0..k).map(|i| Factor::range(&format!("x{i}"), "", 0.0, runs as f64)).collect();
        let method = Method::LatinHypercube(LatinHypercube { runs, criterion, position });
        build(&method, &factors, Layout::default(), seed).unwrap()
    }

    fn least_square(t: &DesignTable) -> f64 {
        let square = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(x, y)| (x - y) * (x - y)).sum::<f64>();
        let pairs = (0..t.runs()).flat_map(|i| (0..i).map(move |j| (i, j)));
        pairs.map(|(i, j)| square(&t.natural[i], &t.natural[j])).fold(f64::INFINITY, f64::min)
    }

    #[test]
    fn every_stratum_of_every_factor_holds_one_point() {
        for (criterion, position) in [(Criterion::Maximin, Position::Centre), (Criterion::Random, Position::Random)] {
            let t = sample(17, 5, criterion, position, 3);
            for j in 0..5 {
                let mut strata: Vec<usize> = t.natural.iter().map(|r| r[j] as usize).collect();
                strata.sort_unstable();
                assert_eq!(strata, (0..17).collect::<Vec<_>>());
            }
        }
    }

    /// Largest possible smallest squared distance, in strata, over all samples in two dimensions: found by trying them
    /// all in `tests/reference/design/generate.py`.
    #[test]
    fn small_samples_reach_the_optimum() {
        for (n, optimum) in [(4, 5.0), (5, 5.0), (6, 5.0), (7, 8.0), (8, 8.0), (9, 10.0)] {
            let found = least_square(&sample(n, 2, Criterion::Maximin, Position::Centre, 1));
            assert!((found - optimum).abs() < 1e-9, "{n} points: {found}");
        }
    }

    #[test]
    fn maximin_spreads_more_than_chance_and_the_seed_decides() {
        let spread = least_square(&sample(40, 6, Criterion::Maximin, Position::Centre, 1));
        let by_chance = (1..20).map(|s| least_square(&sample(40, 6, Criterion::Random, Position::Centre, s)));
        let best = by_chance.fold(0.0, f64::max);
        assert!(spread > 1.5 * best, "{spread} against {best}");
        let t = |seed| sample(12, 3, Criterion::Maximin, Position::Random, seed).natural;
        assert_eq!(t(5), t(5));
        assert_ne!(t(5), t(6));
    }

    #[test]
    fn senseless_sizes_are_refused() {
        let factors = [Factor::range("a", "", 0.0, 1.0)];
        let error = |runs| {
            let method = Method::LatinHypercube(LatinHypercube {
                runs,
                criterion: Criterion::Maximin,
                position: Position::Centre,
            });
            build(&method, &factors, Layout::default(), 1).unwrap_err().to_string()
        };
        assert!(error(1).contains("`runs` is 1; a sample has 2 to"));
        assert!(error(5000).contains("say `random`, or use a Sobol sample"));
    }
}
