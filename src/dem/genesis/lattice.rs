//! Regular lattices as specimens: for teaching, and for tests against closed forms.
//!
//! Distance of neighbours l = 2 R. The rows (or layers) lie across the axis of loading y; the lattice is centred.
//!
//! | lattice | dimension | repeat over l | sites in it | contacts of a ball |
//! |---|---|---|---|---|
//! | square | 2 | 1 × 1 | 1 | 4 |
//! | hexagonal | 2 | 1 × √3 | 2 | 6 |
//! | simple cubic | 3 | 1 × 1 × 1 | 1 | 6 |
//! | body-centred cubic | 3 | (2/√3)³ | 2 | 8 |
//! | face-centred cubic | 3 | (√2)³ | 4 | 12 |
//!
//! **The radius gives way to the height**: of all radii whose rows just fill the height between two platens, it is the one
//! nearest to the one asked for. Across, there are as many balls as fit, in the middle. Neighbours overlap by 10⁻⁹ of the
//! radius, so that rounding leaves no contact open.

use super::heap::{Heap, Still};
use super::region::Region;
use crate::space::{Space, Tuple, Vector};
use serde::{Deserialize, Serialize};

/// Kind of lattice.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Lattice {
    /// Rows above one another.
    Square,
    /// Densest packing of discs, rows across the load.
    Hexagonal,
    /// Cubes of spheres.
    SimpleCubic,
    /// A sphere in the middle of each cube.
    BodyCentred,
    /// A sphere in the middle of each face: densest packing of spheres.
    FaceCentred,
}

/// Overlap of neighbours over their distance.
const OVERLAP: f64 = 1e-9;

impl Lattice {
    /// Number of dimensions.
    pub fn dimension(self) -> usize {
        match self {
            Self::Square | Self::Hexagonal => 2,
            Self::SimpleCubic | Self::BodyCentred | Self::FaceCentred => 3,
        }
    }

    /// Edges of one repeat over l, and the sites in it over its edges.
    fn repeat(self) -> ([f64; 3], &'static [[f64; 3]]) {
        const HALF: f64 = 0.5;
        match self {
            Self::Square | Self::SimpleCubic => ([1.0; 3], &[[0.0; 3]]),
            Self::Hexagonal => ([1.0, 3.0_f64.sqrt(), 1.0], &[[0.0; 3], [HALF, HALF, 0.0]]),
            Self::BodyCentred => ([2.0 / 3.0_f64.sqrt(); 3], &[[0.0; 3], [HALF; 3]]),
            Self::FaceCentred => {
                ([2.0_f64.sqrt(); 3], &[[0.0; 3], [0.0, HALF, HALF], [HALF, 0.0, HALF], [HALF, HALF, 0.0]])
            }
        }
    }

    /// Distance of rows along the load over l.
    fn row(self) -> f64 {
        let ([_, y, _], sites) = self.repeat();
        if sites.len() > 1 { 0.5 * y } else { y }
    }

    /// The radius nearest to `radius` with which a whole number of rows fills `height` (m).
    pub fn fitted_radius(self, radius: f64, height: f64) -> f64 {
        let gaps = (height / (2.0 * radius) - 1.0) / self.row();
        let of = |rows: f64| 0.5 * height / (1.0 + rows.max(0.0) * self.row());
        let (fewer, more) = (of(gaps.floor()), of(gaps.ceil()));
        if (fewer - radius).abs() < (more - radius).abs() { fewer } else { more }
    }

    /// About how many balls of `radius` (m) the region holds.
    pub fn count<S: Space>(self, region: &Region, radius: f64) -> f64 {
        let (repeat, sites) = self.repeat();
        let cell: f64 = (0..S::DIMENSION).map(|k| 2.0 * radius * repeat[k]).product();
        sites.len() as f64 * region.volume() / cell
    }

    /// The lattice of the balls that lie in `region`.
    pub fn fill<S: Space>(self, region: &Region, radius: f64) -> Heap<S> {
        let edges = region.edges();
        let radius = self.fitted_radius(radius, edges[1]);
        let (repeat, sites) = self.repeat();
        let edge = repeat.map(|r| 2.0 * radius * r);
        // From the first row on the lower platen; across, whole distances from the middle of what fits.
        let start: [f64; 3] = std::array::from_fn(|k| match k {
            1 => radius - 0.5 * edges[1],
            _ => -0.5 * self.filled(edges[k] - 2.0 * radius, edge[k]),
        });
        let inside = |x: Vector<S>| region.depth::<S>(x) >= radius * (1.0 - 1e-6);
        let counts: [usize; 3] =
            std::array::from_fn(|k| if k < S::DIMENSION { (edges[k] / edge[k]) as usize + 2 } else { 1 });
        let mut centres = Vec::new();
        for z in 0..counts[2] {
            for y in 0..counts[1] {
                for x in 0..counts[0] {
                    let cell = [x, y, z];
                    let at = |site: &[f64; 3]| Vector::<S>::build(|k| start[k] + edge[k] * (cell[k] as f64 + site[k]));
                    centres.extend(sites.iter().map(at).filter(|&x| inside(x)));
                }
            }
        }
        let radii = vec![radius * (1.0 + OVERLAP); centres.len()];
        Heap { region: *region, centres, radii, still: Still::default() }
    }

    /// Largest whole number of half repeats (whole ones where there is one site) in `room`.
    fn filled(self, room: f64, edge: f64) -> f64 {
        let step = if self.repeat().1.len() > 1 { 0.5 * edge } else { edge };
        step * (room / step * (1.0 + 1e-9)).floor().max(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::super::fabric::Fabric;
    use super::*;
    use crate::{D2, D3};

    /// Balls inside have the contacts of the table; top and bottom rows touch the platens.
    #[test]
    fn neighbours_are_those_of_the_lattice() {
        fn check<S: Space>(lattice: Lattice, region: Region, wanted: u32) {
            let heap = lattice.fill::<S>(&region, 0.5);
            let radius = heap.radii[0];
            let deep = |x: &Vector<S>| region.depth::<S>(*x) > 2.5 * radius;
            let counts = heap.contact_counts();
            let inner: Vec<u32> = heap.centres.iter().zip(&counts).filter(|(x, _)| deep(x)).map(|(_, &n)| n).collect();
            assert!(!inner.is_empty() && inner.iter().all(|&n| n == wanted), "{lattice:?} {inner:?}");
            let height = region.edges()[1];
            let ends = heap.centres.iter().fold([0.0_f64; 2], |[low, high], x| [low.min(x.at(1)), high.max(x.at(1))]);
            for end in ends {
                assert!((end.abs() + radius - 0.5 * height).abs() < 1e-6, "{lattice:?} {end} {radius}");
            }
            assert!((0.9..1.1).contains(&(radius / 0.5)));
            assert!(Fabric::of(&heap).largest_overlap < 1e-6);
        }
        let rectangle = Region::Rectangle { width: 9.3, height: 12.0 };
        let solid = Region::Box { width: 8.2, height: 9.0, depth: 7.9 };
        check::<D2>(Lattice::Square, rectangle, 4);
        check::<D2>(Lattice::Hexagonal, rectangle, 6);
        check::<D3>(Lattice::SimpleCubic, solid, 6);
        check::<D3>(Lattice::BodyCentred, solid, 8);
        check::<D3>(Lattice::FaceCentred, solid, 12);
    }

    #[test]
    fn the_count_is_about_what_is_placed() {
        let region = Region::Box { width: 20.0, height: 20.0, depth: 20.0 };
        let expected = Lattice::FaceCentred.count::<D3>(&region, 0.5);
        let placed = Lattice::FaceCentred.fill::<D3>(&region, 0.5).radii.len() as f64;
        assert!((placed / expected - 1.0).abs() < 0.2, "{placed} {expected}");
    }
}
