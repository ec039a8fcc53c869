//! A dense packing of discs in a vessel, by radius expansion to a ball porosity.
//!
//! 1. N of eq. (4), uniform radii, one factor on all radii so that the ball porosity is the target ([`super::cloud`]:
//!    N stands, the mean radius gives way), balls placed at half size without overlap.
//! 2. Full size at once (m = 2), then the rest state without friction ([`super::relax`]): all stresses come from the
//!    overlaps, and the walls being fixed the stress is isotropic up to the noise of the packing (reported).
//! 3. Floaters (fewer than 3 contacts): each is enlarged in small steps and everything rescaled to the porosity and
//!    relaxed, round after round, until their share is at most the one allowed or the rounds are spent (reported).
//! 4. Balls renumbered along a Morton curve, so that neighbours in space are neighbours in memory.
//!
//! Above a porosity of about 0.16 discs do not jam and there is nothing to bond; that is an error, and so is a
//! porosity that forces overlaps beyond half a radius.
//!
//! Lengths in metres. Source: doi:10.3390/ma14071627, section 2.2; Potyondy & Cundall 2004,
//! doi:10.1016/j.ijrmms.2004.09.011, section 2.

use super::cloud::{ball_count, scale_to_porosity, scatter, uniform_radii};
use super::fabric::{Fabric, HELD, contact_counts};
use super::region::{Point, Region};
use super::relax::Heap;
use crate::Watch;
use math::random::Stream;
use serde::{Deserialize, Serialize};

/// Settings of a packing.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Packing {
    /// Ball porosity: 1 − Σ π R² / area, overlaps counted twice.
    pub porosity: f64,
    /// Mean radius (m) in eq. (4); the mean radius of the packing comes out smaller.
    pub mean_radius: f64,
    /// R_max / R_min.
    pub ratio: f64,
    /// Largest share of balls with fewer than 3 contacts that is left alone.
    pub floaters: f64,
}

/// A packing at rest, with all that happened on the way.
#[derive(Clone, Debug)]
pub struct Packed {
    /// The balls in their vessel.
    pub heap: Heap,
    /// Factor on the stated mean radius.
    pub radius_factor: f64,
    /// Rounds of enlarging floaters.
    pub floater_rounds: usize,
    /// Largest factor by which a floater was enlarged.
    pub floater_growth: f64,
    /// Iterations of the relaxations in total.
    pub iterations: usize,
    /// Mean unbalanced force over mean contact force at the end.
    pub unbalanced: f64,
}

/// Why there is no packing.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PackingError {
    /// A number outside its range.
    #[error("packing: {name} is {found}; it must be {expected}")]
    Value {
        /// Which number.
        name: &'static str,
        /// What was given.
        found: f64,
        /// What it must be.
        expected: &'static str,
    },
    /// Too few balls.
    #[error(
        "packing: mean radius {mean_radius} m gives {count} balls in the specimen; at least 30 are needed, reduce it"
    )]
    Few {
        /// Mean radius asked for (m).
        mean_radius: f64,
        /// Balls of eq. (4).
        count: usize,
    },
    /// Not jammed.
    #[error(
        "packing: porosity {porosity} is out of reach from above: the balls have {coordination:.2} contacts each and \
         hold no stress (discs jam near 0.16); reduce it"
    )]
    Loose {
        /// Porosity asked for.
        porosity: f64,
        /// Contacts per ball × 2 reached.
        coordination: f64,
    },
    /// Overlaps beyond half a radius.
    #[error(
        "packing: porosity {porosity} is out of reach from below: overlaps reach {overlap:.2} of a radius (0.5 is the limit); raise it"
    )]
    Dense {
        /// Porosity asked for.
        porosity: f64,
        /// Largest overlap over the smaller radius.
        overlap: f64,
    },
    /// Stopped by the watcher before its end.
    #[error("packing: stopped before its end")]
    Stopped,
    /// No equilibrium.
    #[error(
        "packing: no equilibrium in {iterations} iterations (unbalanced force {unbalanced:.1e} of a contact force)"
    )]
    Restless {
        /// Iterations spent.
        iterations: usize,
        /// Mean unbalanced force over the mean contact force.
        unbalanced: f64,
    },
}

/// Mean unbalanced force over the mean contact force that counts as rest.
const REST: f64 = 1e-3;
const MOST_ITERATIONS: usize = 40_000;
const MOST_ROUNDS: usize = 30;
/// Factor on a floater's radius in one round.
const GROWTH: f64 = 1.02;

impl Packing {
    /// All that is wrong with the settings for a specimen of this outline.
    pub fn faults(&self, region: &Region) -> Vec<PackingError> {
        let mut faults = Vec::new();
        let mut need = |ok: bool, name, found, expected| {
            if !ok {
                faults.push(PackingError::Value { name, found, expected });
            }
        };
        need(self.porosity > 0.0 && self.porosity < 0.3, "porosity", self.porosity, "between 0 and 0.3");
        need(self.mean_radius > 0.0, "mean_radius", self.mean_radius, "a positive length");
        need(
            (1.0..=10.0).contains(&self.ratio),
            "radius ratio",
            self.ratio,
            "between 1 and 10 (largest over smallest)",
        );
        need((0.0..=1.0).contains(&self.floaters), "floaters", self.floaters, "a share between 0 and 1");
        let narrowest = region.narrowest();
        need(narrowest > 0.0 && narrowest.is_finite(), "specimen extent", narrowest, "a positive length");
        let count = ball_count(region.area(), self.porosity, self.mean_radius);
        if faults.is_empty() && count < 30 {
            faults.push(PackingError::Few { mean_radius: self.mean_radius, count });
        }
        faults
    }

    /// Packs `region`; the same stream gives the same packing. `watch` is asked in every iteration.
    ///
    /// # Errors
    /// The first of: a fault of the settings, stopped by `watch`, no equilibrium, a porosity out of reach.
    pub fn pack(
        &self,
        region: &Region,
        stream: &mut Stream,
        watch: &dyn Fn() -> Watch,
    ) -> Result<Packed, PackingError> {
        if let Some(fault) = self.faults(region).into_iter().next() {
            return Err(fault);
        }
        let area = region.area();
        let count = ball_count(area, self.porosity, self.mean_radius);
        let mut radii = uniform_radii(count, self.mean_radius, self.ratio, stream);
        let radius_factor = scale_to_porosity(&mut radii, area, self.porosity);
        let centres = scatter(&radii, region, stream);
        let mut heap = renumbered(Heap { region: *region, centres, radii });
        let first = heap.relax(REST, MOST_ITERATIONS, watch);
        let mut packed = Packed {
            heap,
            radius_factor,
            floater_rounds: 0,
            floater_growth: 1.0,
            iterations: first.iterations,
            unbalanced: first.unbalanced,
        };
        self.hold_floaters(&mut packed, watch);
        if watch() == Watch::Stop {
            return Err(PackingError::Stopped);
        }
        packed.heap = renumbered(packed.heap);
        self.judge(packed)
    }

    /// Enlarges floaters until few enough are left; a round that finds no rest is undone and ends it.
    fn hold_floaters(&self, packed: &mut Packed, watch: &dyn Fn() -> Watch) {
        let count = packed.heap.radii.len();
        let mut growth = vec![1.0_f64; count];
        while packed.floater_rounds < MOST_ROUNDS && packed.unbalanced < REST {
            let contacts = contact_counts(&packed.heap);
            let floaters = contacts.iter().filter(|&&n| n < HELD).count();
            if floaters as f64 <= self.floaters * count as f64 {
                break;
            }
            let mut next = packed.clone();
            for i in (0..count).filter(|&i| contacts[i] < HELD) {
                next.heap.radii[i] *= GROWTH;
                growth[i] *= GROWTH;
            }
            let area = next.heap.region.area();
            next.radius_factor *= scale_to_porosity(&mut next.heap.radii, area, self.porosity);
            let rest = next.heap.relax(REST, MOST_ITERATIONS, watch);
            packed.iterations += rest.iterations;
            if rest.unbalanced >= REST {
                break;
            }
            let iterations = packed.iterations;
            *packed =
                Packed { iterations, unbalanced: rest.unbalanced, floater_rounds: packed.floater_rounds + 1, ..next };
            packed.floater_growth = growth.iter().copied().fold(1.0, f64::max);
        }
    }

    fn judge(&self, packed: Packed) -> Result<Packed, PackingError> {
        let fabric = Fabric::of(&packed.heap);
        let (coordination, overlap) = (fabric.coordination, fabric.largest_overlap);
        if packed.unbalanced >= REST {
            return Err(PackingError::Restless { iterations: packed.iterations, unbalanced: packed.unbalanced });
        }
        if coordination < 3.0 {
            return Err(PackingError::Loose { porosity: self.porosity, coordination });
        }
        if overlap > 0.5 {
            return Err(PackingError::Dense { porosity: self.porosity, overlap });
        }
        Ok(packed)
    }
}

/// The balls in the order of a Morton curve over 1024 × 1024 cells.
fn renumbered(heap: Heap) -> Heap {
    let [width, height] = heap.region.extent();
    let cell = |x: f64, length: f64| ((x / length + 0.5).clamp(0.0, 0.999_999) * 1024.0) as u32;
    let code = |c: &Point| spread(cell(c[0], width)) | spread(cell(c[1], height)) << 1;
    let mut order: Vec<usize> = (0..heap.radii.len()).collect();
    order.sort_by_key(|&i| code(&heap.centres[i]));
    Heap {
        region: heap.region,
        centres: order.iter().map(|&i| heap.centres[i]).collect(),
        radii: order.iter().map(|&i| heap.radii[i]).collect(),
    }
}

/// The ten low bits of `x`, each followed by a zero bit.
fn spread(x: u32) -> u32 {
    (0..10).fold(0, |code, bit| code | ((x >> bit) & 1) << (2 * bit))
}

#[cfg(test)]
mod tests {
    use super::super::cloud::ball_area;
    use super::*;

    const GO_ON: &dyn Fn() -> Watch = &|| Watch::Continue;
    const SMALL: Packing = Packing { porosity: 0.12, mean_radius: 2e-3, ratio: 2.5, floaters: 0.0 };
    const SPECIMEN: Region = Region::Rectangle { width: 0.1, height: 0.2 };

    fn pack(seed: u64) -> Packed {
        SMALL.pack(&SPECIMEN, &mut Stream::new(seed, "packing", 0), GO_ON).unwrap()
    }

    /// Isostatic frictionless discs have coordination 4; the study with another code had 4.55 at this porosity.
    #[test]
    fn a_dense_packing_is_at_rest_and_held() {
        let packed = pack(1);
        assert!((1.0 - ball_area(&packed.heap.radii) / 0.02 - 0.12).abs() < 1e-12);
        let contacts = contact_counts(&packed.heap);
        assert!(contacts.iter().all(|&n| n >= 3), "{} floaters", contacts.iter().filter(|&&n| n < 3).count());
        let mean = Fabric::of(&packed.heap).coordination;
        assert!((4.4..4.7).contains(&mean), "{mean}");
        assert!(packed.unbalanced < 1e-3 && Fabric::of(&packed.heap).largest_overlap < 0.35);
        assert!((0.95..0.98).contains(&packed.radius_factor), "{}", packed.radius_factor);
    }

    #[test]
    fn a_seed_gives_its_packing_and_another_seed_another() {
        assert_eq!(pack(1).heap.centres, pack(1).heap.centres);
        assert_ne!(pack(1).heap.centres, pack(2).heap.centres);
    }

    /// Stopped in its first iteration, in a later one, and after the last: never a packing that is another one.
    #[test]
    fn a_packing_that_is_stopped_is_none() {
        for after in [0, 100] {
            let asked = std::cell::Cell::new(0);
            let watch = || {
                asked.set(asked.get() + 1);
                if asked.get() > after { Watch::Stop } else { Watch::Continue }
            };
            let error = SMALL.pack(&SPECIMEN, &mut Stream::new(1, "packing", 0), &watch).unwrap_err();
            assert_eq!(error, PackingError::Stopped);
            assert!(asked.get() < after + 10, "{}", asked.get());
        }
    }

    #[test]
    fn a_disc_is_packed_by_the_same_code() {
        let region = Region::Disc { diameter: 0.1 };
        let packed = SMALL.pack(&region, &mut Stream::new(1, "packing", 0), GO_ON).unwrap();
        assert!(packed.heap.centres.iter().all(|&c| region.depth(c) > 0.0));
        assert_eq!(packed.heap.centres.len(), ball_count(region.area(), 0.12, 2e-3));
    }

    #[test]
    fn a_porosity_out_of_reach_says_on_which_side() {
        let loose = Packing { porosity: 0.25, ..SMALL };
        let error = loose.pack(&SPECIMEN, &mut Stream::new(1, "packing", 0), GO_ON).unwrap_err();
        assert!(matches!(error, PackingError::Loose { porosity: 0.25, .. }), "{error}");
        let dense = Packing { porosity: 0.001, mean_radius: 3e-3, ratio: 10.0, ..SMALL };
        let error = dense.pack(&SPECIMEN, &mut Stream::new(1, "packing", 0), GO_ON).unwrap_err();
        assert!(matches!(error, PackingError::Dense { .. }), "{error}");
    }

    #[test]
    fn faults_of_the_settings_are_named_at_once() {
        let bad = Packing { porosity: 0.5, mean_radius: -1.0, ratio: 0.5, floaters: 2.0 };
        assert_eq!(bad.faults(&SPECIMEN).len(), 4);
        let few = Packing { mean_radius: 0.02, ..SMALL };
        assert!(
            matches!(few.faults(&SPECIMEN)[..], [PackingError::Few { count: 14, .. }]),
            "{:?}",
            few.faults(&SPECIMEN)
        );
    }
}
