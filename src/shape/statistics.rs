//! Shape measures of a stone and the classes of Zingg.
//!
//! | measure | definition |
//! |---|---|
//! | length L ≥ intermediate I ≥ short S | extents along the principal axes of inertia |
//! | elongation | I / L |
//! | flatness | S / I |
//! | sphericity (Wadell 1932) | surface of the ball of equal volume over the stone's surface |
//! | angularity | share of the integral of mean curvature ½ Σ l θ that lies in edges sharper than 30°: 0 for a smooth stone, 1 for a polyhedron |
//! | convexity | share of edges' length that is not concave by more than 5° |
//!
//! Zingg (1935) divides them at two thirds: equant (both above), disc (flat), rod (elongated), blade (both).

use super::mesh::Mesh;
use super::moments::Moments;
use super::vector::{dot, minus};
use math::elementary::cbrt;
use std::f64::consts::PI;

/// Bound between Zingg's classes.
pub const ZINGG: f64 = 2.0 / 3.0;

/// Class of Zingg.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Zingg {
    /// I/L and S/I above two thirds.
    Equant,
    /// I/L above, S/I below.
    Disc,
    /// I/L below, S/I above.
    Rod,
    /// Both below.
    Blade,
}

impl Zingg {
    /// Of elongation I/L and flatness S/I.
    pub fn of(elongation: f64, flatness: f64) -> Self {
        match (elongation > ZINGG, flatness > ZINGG) {
            (true, true) => Self::Equant,
            (true, false) => Self::Disc,
            (false, true) => Self::Rod,
            (false, false) => Self::Blade,
        }
    }

    /// Name of the class.
    pub fn name(self) -> &'static str {
        match self {
            Self::Equant => "equant",
            Self::Disc => "disc",
            Self::Rod => "rod",
            Self::Blade => "blade",
        }
    }
}

/// Measures of a stone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measures {
    /// Length, intermediate and short extent.
    pub extents: [f64; 3],
    /// Volume, centre, inertia.
    pub moments: Moments,
    /// Area of the surface.
    pub surface: f64,
    /// I / L.
    pub elongation: f64,
    /// S / I.
    pub flatness: f64,
    /// Wadell's sphericity.
    pub sphericity: f64,
    /// Share of the curvature that lies in sharp edges.
    pub angularity: f64,
    /// Share of the edges' length that is not concave.
    pub convexity: f64,
    /// Class of Zingg.
    pub zingg: Zingg,
}

impl Measures {
    /// The measures of a solid.
    pub fn of(solid: &Mesh) -> Self {
        let moments = Moments::of(solid);
        let (_, axes) = moments.principal();
        let mut extents = axes.map(|axis| {
            let along = solid.vertices().iter().map(|&v| dot(minus(v, moments.centre), axis));
            let (low, high) = along.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(x), h.max(x)));
            high - low
        });
        extents.sort_by(|a, b| b.total_cmp(a));
        let surface = solid.surface();
        let (elongation, flatness) = (extents[1] / extents[0], extents[2] / extents[1]);
        let edges = solid.edges();
        let curved = |least: f64| {
            let sharp = edges.iter().filter(|edge| edge.turn.abs() >= least);
            sharp.map(|edge| edge.length * edge.turn.abs()).sum::<f64>()
        };
        let length = |pick: &dyn Fn(f64) -> bool| {
            edges.iter().filter(|edge| pick(edge.turn)).map(|edge| edge.length).sum::<f64>()
        };
        Self {
            extents,
            moments,
            surface,
            elongation,
            flatness,
            sphericity: cbrt(36.0 * PI * moments.volume * moments.volume) / surface,
            angularity: curved(PI / 6.0) / curved(0.0),
            convexity: length(&|turn| turn > -PI / 36.0) / length(&|_| true),
            zingg: Zingg::of(elongation, flatness),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::mesh::samples::{cuboid, ellipsoid};
    use super::*;

    /// A cube has the sphericity (π/6)^⅓ = 0.806 and all its curvature in edges; a ball has 1 and none.
    #[test]
    fn cube_and_ball_have_their_closed_forms() {
        let cube = Measures::of(&cuboid([2.0; 3]));
        assert!((cube.sphericity - 0.805_995_977).abs() < 1e-8, "{}", cube.sphericity);
        assert!((cube.angularity - 1.0).abs() < 1e-12 && cube.convexity == 1.0);
        let ball = Measures::of(&ellipsoid([1.0; 3], 64));
        assert!((ball.sphericity - 1.0).abs() < 1e-3 && ball.angularity < 1e-12, "{ball:?}");
        assert_eq!(ball.zingg, Zingg::Equant);
    }

    #[test]
    fn boxes_fall_into_the_classes_of_zingg() {
        for (size, zingg) in [
            ([1.0, 0.9, 0.8], Zingg::Equant),
            ([1.0, 0.9, 0.3], Zingg::Disc),
            ([0.5, 0.45, 1.0], Zingg::Rod),
            ([0.2, 0.5, 1.0], Zingg::Blade),
        ] {
            let found = Measures::of(&cuboid(size));
            let mut sorted = size;
            sorted.sort_by(|a, b| b.total_cmp(a));
            assert_eq!(found.zingg, zingg);
            for (extent, expected) in found.extents.into_iter().zip(sorted) {
                assert!((extent - expected).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn a_dent_is_concave() {
        let mut dented = cuboid([1.0; 3]);
        // The corner pushed in to near the opposite one's side.
        dented.vertices[7] = [0.4; 3];
        assert!(Measures::of(&dented).convexity < 1.0);
    }
}
