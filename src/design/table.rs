//! The finished table of runs.

use super::coding::{Coding, Factor};
use super::error::Fault;
use math::occurrence::occurrences;
use math::random::Stream;
use serde::{Deserialize, Serialize};
use std::borrow::Cow;

/// What a run is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum PointType {
    /// Centre of the region: curvature and pure error.
    Centre,
    /// Corner of the cube: every factor at −1 or +1.
    Cube,
    /// On an axis, at ±α.
    Axial,
    /// Middle of an edge (or face) of the cube, as in Box–Behnken designs.
    Edge,
    /// A combination of levels of a factorial or orthogonal table.
    Grid,
    /// A point of a space-filling sample.
    Sample,
    /// A row that was given.
    Given,
}

impl PointType {
    /// The word in tables and files.
    pub fn word(self) -> &'static str {
        match self {
            Self::Centre => "centre",
            Self::Cube => "cube",
            Self::Axial => "axial",
            Self::Edge => "edge",
            Self::Grid => "grid",
            Self::Sample => "sample",
            Self::Given => "given",
        }
    }
}

/// Position of a factor in one run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Position {
    /// At its level of this index, from 0.
    Level(usize),
    /// At this coded value.
    Coded(f64),
    /// At this natural value.
    Natural(f64),
}

/// The runs of a design in standard order, before they are given their natural values.
#[derive(Clone, Debug, PartialEq)]
pub struct Points {
    /// One row a run but for those at the centre: the position of every factor, and the type of the point.
    pub rows: Vec<(Vec<Position>, PointType)>,
    /// How many runs at the centre follow them. It may come from a file, so nothing is allocated for it before
    /// [`Layout`] has judged it.
    pub centre: usize,
    /// What was built, in one line.
    pub construction: String,
    /// Who published it: author, year, DOI.
    pub source: String,
}

impl Points {
    /// Rows of coded values, all of one type.
    pub(super) fn coded(rows: &[Vec<f64>], point_type: PointType) -> Vec<(Vec<Position>, PointType)> {
        rows.iter().map(|row| (row.iter().map(|&x| Position::Coded(x)).collect(), point_type)).collect()
    }

    /// Number of runs.
    pub fn runs(&self) -> usize {
        self.rows.len().saturating_add(self.centre)
    }

    /// Positions and type of a run.
    fn run(&self, index: usize, factors: usize) -> (Cow<'_, [Position]>, PointType) {
        match self.rows.get(index) {
            Some((positions, point_type)) => (positions.into(), *point_type),
            None => (vec![Position::Coded(0.0); factors].into(), PointType::Centre),
        }
    }
}

/// Order of the runs in the table.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Order {
    /// The order of the construction.
    #[default]
    Standard,
    /// Shuffled by the seed.
    Random,
}

/// A design: its factors and runs.
#[derive(Clone, Debug, PartialEq)]
pub struct DesignTable {
    /// The factors, in column order.
    pub factors: Vec<Factor>,
    /// Coded value of each factor (column) in each run (row).
    pub coded: Vec<Vec<f64>>,
    /// Natural value, in the factor's unit, of each factor (column) in each run (row).
    pub natural: Vec<Vec<f64>>,
    /// What each run is for.
    pub point_type: Vec<PointType>,
    /// Position of each run in the standard order, from 1.
    pub standard_order: Vec<usize>,
    /// What was built, in one line.
    pub construction: String,
    /// Who published it: author, year, DOI.
    pub source: String,
}

impl DesignTable {
    /// Number of runs.
    pub fn runs(&self) -> usize {
        self.coded.len()
    }

    /// Which occurrence of its row each run is, from 1: equal rows are replicates.
    pub fn replicate(&self) -> Vec<u64> {
        let words: Vec<u64> = self.natural.iter().flatten().map(|x| x.to_bits()).collect();
        occurrences(&words, self.factors.len(), self.runs())
    }

    /// Gives the points their values, repeats them and puts them in order.
    pub(super) fn lay_out(
        factors: &[Factor],
        points: &Points,
        layout: Layout,
        stream: &mut Stream,
    ) -> Result<Self, Vec<Fault>> {
        let once = points.runs();
        if let Some(fault) = layout.fault(points.rows.len(), points.centre) {
            return Err(vec![fault]);
        }
        let mut order: Vec<usize> = (0..once * layout.replicates).collect();
        if layout.order == Order::Random {
            stream.shuffle(&mut order);
        }
        let codings: Vec<(&Factor, Coding)> = factors.iter().map(|factor| (factor, factor.coding())).collect();
        let mut types = Vec::with_capacity(order.len());
        let (mut coded, mut natural) = (Vec::with_capacity(order.len()), Vec::with_capacity(order.len()));
        for i in &order {
            let (positions, point_type) = points.run(i % once, codings.len());
            let row = positions.iter().zip(&codings);
            types.push(point_type);
            let (mut codes, mut values) = (Vec::with_capacity(codings.len()), Vec::with_capacity(codings.len()));
            for (code, value) in row.map(|(position, (factor, coding))| position.values(factor, coding)) {
                codes.push(code);
                values.push(value);
            }
            coded.push(codes);
            natural.push(values);
        }
        Ok(Self {
            factors: factors.to_vec(),
            coded,
            natural,
            point_type: types,
            standard_order: order.iter().map(|i| i + 1).collect(),
            construction: points.construction.clone(),
            source: points.source.clone(),
        })
    }
}

impl Position {
    /// Coded and natural value.
    fn values(self, factor: &Factor, coding: &Coding) -> (f64, f64) {
        match self {
            Self::Level(i) => (coding.coded(factor.level(i)), factor.level(i)),
            Self::Coded(x) => (x, factor.natural(x)),
            Self::Natural(x) => (coding.coded(x), x),
        }
    }
}

/// A table longer than this is a slip of the pen.
pub const MOST_RUNS: usize = 1 << 20;

/// How the runs of any design are repeated and ordered.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Layout {
    /// How often the whole design is run.
    pub replicates: usize,
    /// Order of the runs.
    pub order: Order,
}

impl Layout {
    /// Faults of a design of `rows` runs and `centre` more at its centre, laid out so.
    pub(super) fn fault(self, rows: usize, centre: usize) -> Option<Fault> {
        let bad = |option: &str, found: usize, wanted: &str| Fault::BadOption {
            option: option.into(),
            found: found.to_string(),
            wanted: wanted.into(),
        };
        let once = rows as u128 + centre as u128;
        let all = once * self.replicates as u128;
        let most = format!("the table would have {all} runs, and has at most {MOST_RUNS}");
        match self.replicates {
            0 => Some(bad("replicates", 0, "it must be at least 1")),
            _ if rows > MOST_RUNS => Some(bad("rows", rows, &most)),
            _ if once > MOST_RUNS as u128 => Some(bad("centre_points", centre, &most)),
            n if all > MOST_RUNS as u128 => Some(bad("replicates", n, &most)),
            _ => None,
        }
    }
}

impl Default for Layout {
    fn default() -> Self {
        Self { replicates: 1, order: Order::Standard }
    }
}
