//! A periodic cell: space repeats along its edges. For verification: lattices and packings without walls.
//!
//! A contact across a face is one with the image of its second end, shifted by a lattice vector s and moving by L s
//! relative to it; L is the prescribed velocity gradient (du/dt = L x), by which the edges move as da/dt = L a. Bodies are
//! not brought back when they leave the cell: they may go half an edge beyond it.

use crate::space::{Space, Tuple, Vector};

/// A periodic cell as the caller describes it: a box along the axes at the start.
#[derive(Clone, Copy, Debug)]
pub struct Cell<S: Space> {
    /// Lowest corner, m.
    pub low: Vector<S>,
    /// Lengths of its edges, m; at least six times the largest radius.
    pub edges: Vector<S>,
    /// Velocity gradient L, 1/s: row, velocity; column, coordinate. In the plane the third row and column are not read.
    pub rate: [[f64; 3]; 3],
}

/// The image of a body: where it is relative to the body, and how fast it moves relative to it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Image<S: Space> {
    pub(crate) shift: Vector<S>,
    pub(crate) velocity: Vector<S>,
}

/// A cell in motion.
#[derive(Clone, Debug)]
pub(crate) struct MovingCell<S: Space> {
    pub(crate) low: Vector<S>,
    /// Edges now; as many as the space has dimensions.
    pub(crate) edges: [Vector<S>; 3],
    /// Edges when the contacts were listed.
    pub(crate) origin: [Vector<S>; 3],
    pub(crate) rate: [[f64; 3]; 3],
}

/// Steps along the three edges of an image: digits in base 3 of its number, 2 for one step back. Image 0 is the body.
fn steps(image: u8) -> [f64; 3] {
    let digit = |k: u32| [0.0, 1.0, -1.0][usize::from(image) / 3_usize.pow(k) % 3];
    [digit(0), digit(1), digit(2)]
}

/// Numbers of all images, the body itself left out.
fn images<S: Space>() -> std::ops::Range<u8> {
    1..if S::DIMENSION == 2 { 9 } else { 27 }
}

impl<S: Space> MovingCell<S> {
    /// A cell at rest.
    pub(crate) fn new(cell: &Cell<S>) -> Self {
        let edge = |m: usize| {
            let length = if m < S::DIMENSION { cell.edges.at(m) } else { 0.0 };
            Vector::<S>::build(|k| if k == m { length } else { 0.0 })
        };
        let edges = [edge(0), edge(1), edge(2)];
        Self { low: cell.low, edges, origin: edges, rate: [[0.0; 3]; 3] }
    }

    /// L x.
    pub(crate) fn carried(&self, x: Vector<S>) -> Vector<S> {
        Vector::<S>::build(|a| (0..S::DIMENSION).map(|b| self.rate[a][b] * x.at(b)).sum())
    }

    fn shift(edges: &[Vector<S>; 3], image: u8) -> Vector<S> {
        let along = |sum: Vector<S>, (edge, n): (&Vector<S>, f64)| sum.plus(edge.times(n));
        edges.iter().zip(steps(image)).fold(Vector::<S>::zero(), along)
    }

    /// An image now.
    pub(crate) fn image(&self, image: u8) -> Image<S> {
        let shift = Self::shift(&self.edges, image);
        Image { shift, velocity: self.carried(shift) }
    }

    /// One step.
    pub(crate) fn advance(&mut self, dt: f64) {
        self.edges = self.edges.map(|edge| edge.plus(self.carried(edge).times(dt)));
    }

    /// Largest speed of an image relative to its body, m/s.
    pub(crate) fn speed(&self) -> f64 {
        images::<S>().map(|image| self.image(image).velocity.norm()).fold(0.0, f64::max)
    }

    /// Largest way of an image relative to its body since the contacts were listed, m.
    pub(crate) fn travelled(&self) -> f64 {
        let way = |image| Self::shift(&self.edges, image).minus(Self::shift(&self.origin, image)).norm();
        images::<S>().map(way).fold(0.0, f64::max)
    }

    /// Images of the bodies at `positions` that come nearer than `reach` to any of them: body, image, position.
    pub(crate) fn images_near(&self, positions: &[Vector<S>], reach: f64) -> Vec<(usize, u8, Vector<S>)> {
        let corner = |far: fn(f64, f64) -> f64, start: f64| {
            Vector::<S>::build(|k| positions.iter().map(|x| x.at(k)).fold(start, far))
        };
        let (low, high) = (corner(f64::min, f64::INFINITY), corner(f64::max, f64::NEG_INFINITY));
        let mut found = Vec::new();
        for image in images::<S>() {
            let shift = self.image(image).shift;
            for (p, x) in positions.iter().enumerate() {
                let y = x.plus(shift);
                if (0..S::DIMENSION).all(|k| y.at(k) > low.at(k) - reach && y.at(k) < high.at(k) + reach) {
                    found.push((p, image, y));
                }
            }
        }
        found
    }

    /// Whether a point is within half an edge of the cell.
    pub(crate) fn holds(&self, x: Vector<S>) -> bool {
        (0..S::DIMENSION).all(|k| {
            let sides = self.edges.map(|edge| edge.at(k));
            let (below, above): (f64, f64) =
                (sides.map(|s| s.min(0.0)).iter().sum(), sides.map(|s| s.max(0.0)).iter().sum());
            let room = 0.5 * (above - below);
            let from = x.at(k) - self.low.at(k);
            from >= below - room && from <= above + room
        })
    }

    /// Volume (area in the plane), m³ (m²).
    pub(crate) fn volume(&self) -> f64 {
        let [a, b, c] = self.edges;
        if S::DIMENSION == 2 {
            return a.at(0) * b.at(1) - a.at(1) * b.at(0);
        }
        a.at(0) * (b.at(1) * c.at(2) - b.at(2) * c.at(1)) - a.at(1) * (b.at(0) * c.at(2) - b.at(2) * c.at(0))
            + a.at(2) * (b.at(0) * c.at(1) - b.at(1) * c.at(0))
    }
}
