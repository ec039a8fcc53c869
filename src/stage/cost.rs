//! How long a simulation takes before any has run, for `flow plan`: a rough estimate, right within a factor of three.
//!
//! A run costs balls × steps × the time of one ball in one step. A wave of speed c runs through a ball of radius R̄ in about two
//! steps, so with the strain ε_r of a test at failure and the speed v of each platen
//!
//! | speed given as | steps |
//! |---|---|
//! | speed v | ε_r H / (2 v Δt), Δt = R̄/(2 c) |
//! | strain rate ε̇ | ε_r / (ε̇ Δt) |
//! | transits N | N H / (c Δt) = 2 N H/R̄ |
//!
//! with ε_r c = 3.4 m/s, as for concretes and rocks (ε_r = 1.2·10⁻³, c = 2,800 m/s). The times of a ball were measured on one
//! core: c30 at 2,188 discs takes 1.9 s.

use dem::Masses;
use dem::genesis::packing::Packing;
use dem::genesis::region::Region;
use dem::loading::pace::Pace;
use dem::loading::speed::Speed;
use dem::{D2, D3};

/// A specimen as far as its settings tell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bulk {
    /// Balls.
    pub balls: f64,
    /// Height over mean radius.
    pub slenderness: f64,
    /// Height (m).
    pub height: f64,
    /// Whether it is in space.
    pub solid: bool,
}

/// ε_r c (m/s).
const FAILURE_SPEED: f64 = 3.4;
/// Seconds of a ball in a step, in the plane and in space.
const STEP: [f64; 2] = [36e-9, 140e-9];
/// Seconds that a ball takes to be packed.
const PACKING: [f64; 2] = [80e-6, 600e-6];
/// Steps with real masses over those with masses of one critical step.
const REAL_MASSES: f64 = 1.7;
/// Steps of a test that adapts over those at its slow speed.
const ADAPTIVE: f64 = 0.35;

/// Ball porosity of what is packed to a stress, in the plane and in space.
const POROSITY: [f64; 2] = [0.16, 0.36];

impl Bulk {
    /// A region that is packed so; none of a lattice, which takes no time.
    pub fn of(region: &Region, packing: &Packing) -> Option<Self> {
        let solid = region.dimension() == 3;
        let (sizes, porosity) = match packing {
            Packing::Porosity { sizes, porosity, .. } => (sizes, *porosity),
            Packing::Stress { sizes, .. } => (sizes, POROSITY[usize::from(solid)]),
            Packing::Lattice { .. } => return None,
        };
        let height = region.edges()[1];
        let (balls, radius) = match solid {
            false => (sizes.count::<D2>(region.volume(), porosity), sizes.mean_radius::<D2>()),
            true => (sizes.count::<D3>(region.volume(), porosity), sizes.mean_radius::<D3>()),
        };
        Some(Self { balls, slenderness: height / radius, height, solid })
    }

    /// Seconds of making it.
    pub fn packing(&self) -> f64 {
        self.balls * PACKING[usize::from(self.solid)]
    }

    /// Seconds of a test on it.
    pub fn test(&self, speed: Speed, pace: Pace, masses: Masses) -> f64 {
        let steps = match speed {
            Speed::Each(speed) => FAILURE_SPEED * self.slenderness / speed,
            Speed::StrainRate(rate) => 2.0 * FAILURE_SPEED * self.slenderness / (rate * self.height),
            Speed::Transits(transits) => 2.0 * transits * self.slenderness,
        };
        let paced = if pace == Pace::Adaptive { ADAPTIVE } else { 1.0 };
        let moved = if masses == Masses::Real { REAL_MASSES } else { 1.0 };
        self.balls * steps * paced * moved * STEP[usize::from(self.solid)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use dem::genesis::sizes::Sizes;

    /// c30 with discs of 1.6 mm was measured at 1.9 s with 0.02 m/s, 1.3 s with half of that where it adapts, its packing
    /// at 0.2 s; 22,409 discs have the same shape.
    #[test]
    fn estimates_are_right_within_a_factor_of_three() {
        let region = Region::Rectangle { width: 0.1, height: 0.2 };
        let packing = |mean| Packing::Porosity { sizes: Sizes::uniform(mean, 2.5), porosity: 0.12, floaters: 0.0 };
        let bulk = Bulk::of(&region, &packing(1.6e-3)).unwrap();
        assert_eq!((bulk.balls, bulk.solid), (2188.0, false));
        let near = |found: f64, measured: f64| assert!((measured / 3.0..3.0 * measured).contains(&found), "{found}");
        near(bulk.test(Speed::Each(0.02), Pace::Fixed, Masses::EqualStep), 1.9);
        near(bulk.test(Speed::Each(0.01), Pace::Adaptive, Masses::EqualStep), 1.3);
        near(bulk.packing(), 0.2);
        // Twice as fast is half as long; a strain rate of 2 v/H is the speed v.
        let each = |speed| bulk.test(Speed::Each(speed), Pace::Fixed, Masses::Real);
        assert!((each(0.02) / each(0.04) - 2.0).abs() < 1e-12);
        let rate = bulk.test(Speed::StrainRate(0.2), Pace::Fixed, Masses::Real);
        assert!((rate / each(0.02) - 1.0).abs() < 1e-12, "{rate}");
        assert_eq!(Bulk::of(&region, &packing(0.5e-3)).unwrap().balls, 22_409.0);
    }
}
