//! Mortar: balls packed to a porosity between stones that stand still.
//!
//! 1. The balls are counted for the room Ω' = Ω − V_stones at the ball porosity n (or are as many as stated) and scattered at
//!    half size, beside the stones and one another ([`super::cloud`]): none starts inside a stone.
//! 2. They grow to full size in steps, at rest after each ([`super::relax`]), so that none is pushed through a stone. A stone
//!    is rigid however small its pebbles are. The radii give way by one factor so that Σ V(R) = (1 − n) Ω'.
//! 3. A ball that is caught between stones, balls and walls, with an overlap above [`CAUGHT`] of its radius, is put elsewhere, where
//!    it grows in steps again; after some rounds the last ones are taken out, at most [`MOST_TAKEN`] of all.
//! 4. Floaters are treated as in any packing to a porosity; then 3 again.
//!
//! A **coarse twin** has mortar of radii `coarsen` times larger, `coarsen`³ times fewer.

use super::cloud::{scale_to_porosity, scatter_where};
use super::fabric::Fabric;
use super::heap::{Heap, Still};
use super::packing::{AT_REST, INSERTION, Packed, PackingError, REST, hold_floaters, judge, renumbered};
use super::region::Region;
use super::relax::Until;
use super::sizes::Sizes;
use super::stones::Stone;
use crate::{D3, Watch};
use math::random::Stream;

/// Overlap over a ball's radius beyond which it is caught: above it contacts are no longer small (the quality report warns there).
const CAUGHT: f64 = 0.35;
/// Rounds of putting caught balls elsewhere.
const ROUNDS: usize = 8;
/// Largest share of the balls that may be taken out because they are caught wherever they are put.
const MOST_TAKEN: f64 = 0.02;
/// Shares of the full radius through which the balls grow.
const GROWTH: [f64; 8] = [0.6, 0.7, 0.78, 0.85, 0.9, 0.94, 0.97, 0.985];
/// Rest between two steps of growth: enough that no ball is pressed through another.
const BETWEEN: Until = Until { unbalanced: 0.05, slack: 0.0, iterations: 1000, margin: 0.5 };

/// What is packed between stones.
pub(super) struct Mortar<'a> {
    /// Radii, before coarsening.
    pub(super) sizes: &'a Sizes,
    /// Ball porosity of the room between the stones.
    pub(super) porosity: f64,
    /// Largest share of balls with too few contacts that is left alone.
    pub(super) floaters: f64,
    /// Number of balls before coarsening; it follows from the porosity when not given.
    pub(super) balls: Option<usize>,
    /// Factor on the radii.
    pub(super) coarsen: f64,
}

impl Mortar<'_> {
    /// The mortar at rest around the stones, whose pebbles come first, stone by stone.
    ///
    /// # Errors
    /// Stopped by `watch`, no equilibrium, a porosity out of reach, overlaps too deep.
    pub(super) fn pack(
        &self,
        stones: &[Stone],
        region: &Region,
        stream: &mut Stream,
        watch: &dyn Fn() -> Watch,
    ) -> Result<Packed<D3>, PackingError> {
        let (mut heap, radius_factor) = self.cloud(stones, region, stream);
        let still = heap.still.pebbles;
        let full = heap.free().to_vec();
        let mut iterations = 0;
        for share in GROWTH {
            heap.radii[still..].iter_mut().zip(&full).for_each(|(radius, full)| *radius = share * full);
            iterations += heap.relax(BETWEEN, watch).iterations;
        }
        heap.radii[still..].copy_from_slice(&full);
        let mut packed = Packed { radius_factor, iterations, ..Packed::of(heap) };
        self.settle(&mut packed, stones, stream, watch)?;
        hold_floaters(&mut packed, self.porosity, self.floaters, self.sizes.gives_way, watch);
        self.settle(&mut packed, stones, stream, watch)?;
        judge(&packed, self.porosity)?;
        let overlap = Fabric::of(&packed.heap).largest_overlap;
        if overlap > 0.5 {
            return Err(PackingError::Dense { porosity: self.porosity, overlap });
        }
        Ok(Packed { heap: renumbered(&packed.heap), ..packed })
    }

    /// Balls of half size beside the stones, renumbered, with their full radii; and the factor on the stated radii.
    fn cloud(&self, stones: &[Stone], region: &Region, stream: &mut Stream) -> (Heap<D3>, f64) {
        let still = Still {
            pebbles: stones.iter().map(|stone| stone.radii.len()).sum(),
            volume: stones.iter().map(|stone| stone.volume).sum(),
        };
        let room = region.volume() - still.volume;
        let cube = self.coarsen * self.coarsen * self.coarsen;
        let stated = self.balls.map_or_else(|| self.sizes.count::<D3>(room, self.porosity), |balls| balls as f64);
        let mut radii = self.sizes.draw::<D3>((stated / cube).round().max(1.0) as usize, stream);
        radii.iter_mut().for_each(|radius| *radius *= self.coarsen);
        let factor = scale_to_porosity::<D3>(&mut radii, room, self.porosity);
        let beside = |place, radius| stones.iter().all(|stone| stone.clear_of_ball(place, radius));
        let places = scatter_where::<D3>(&radii, region, &beside, stream);
        let mut centres: Vec<[f64; 3]> = stones.iter().flat_map(|stone| stone.centres.iter().copied()).collect();
        let mut all: Vec<f64> = stones.iter().flat_map(|stone| stone.radii.iter().copied()).collect();
        centres.extend(places);
        all.extend(radii);
        (renumbered(&Heap::<D3> { region: *region, centres, radii: all, still }), factor)
    }

    /// Brings the balls to rest, and those that are caught to other places.
    fn settle(
        &self,
        packed: &mut Packed<D3>,
        stones: &[Stone],
        stream: &mut Stream,
        watch: &dyn Fn() -> Watch,
    ) -> Result<(), PackingError> {
        let beside = |place, radius: f64| stones.iter().all(|stone| stone.clear_of_ball(place, radius));
        for round in 0.. {
            let rest = packed.heap.relax(AT_REST, watch);
            packed.iterations += rest.iterations;
            packed.unbalanced = rest.unbalanced;
            if watch() == Watch::Stop {
                return Err(PackingError::Stopped);
            }
            if rest.unbalanced >= REST {
                return Err(PackingError::Restless { iterations: packed.iterations, unbalanced: rest.unbalanced });
            }
            let caught = caught(&packed.heap);
            if caught.is_empty() {
                break;
            }
            let heap = &mut packed.heap;
            if round >= ROUNDS {
                packed.deleted += caught.len();
                if packed.deleted as f64 > MOST_TAKEN * heap.free().len() as f64 {
                    let overlap = Fabric::of(heap).largest_overlap;
                    return Err(PackingError::Dense { porosity: self.porosity, overlap });
                }
                let stay: Vec<usize> = (0..heap.radii.len()).filter(|i| caught.binary_search(i).is_err()).collect();
                *heap = heap.chosen(&stay);
                continue;
            }
            let full: Vec<f64> = caught.iter().map(|&i| heap.radii[i]).collect();
            // Twice the radii: at full size beside the stones, among the balls as it comes.
            let doubled: Vec<f64> = full.iter().map(|radius| 2.0 * radius).collect();
            let places = scatter_where::<D3>(&doubled, &heap.region, &beside, stream);
            caught.iter().zip(places).for_each(|(&i, place)| heap.centres[i] = place);
            for share in INSERTION {
                caught.iter().zip(&full).for_each(|(&i, full)| heap.radii[i] = share * full);
                packed.iterations += heap.relax(BETWEEN, watch).iterations;
            }
        }
        Ok(())
    }
}

/// Balls that are caught in places too small for them, or outside the vessel, in order.
fn caught(heap: &Heap<D3>) -> Vec<usize> {
    let still = heap.still.pebbles;
    let outside = |&i: &usize| heap.region.depth::<D3>(heap.centres[i]) < 0.0;
    let mut caught: Vec<usize> = (still..heap.radii.len()).filter(outside).collect();
    heap.overlaps(|overlap| {
        if heap.relative(&overlap) > CAUGHT {
            // Of two balls the smaller finds a place more easily.
            let smaller = |&ball: &usize| overlap.first < still || heap.radii[ball] < heap.radii[overlap.first];
            caught.push(overlap.second.filter(smaller).unwrap_or(overlap.first));
        }
    });
    caught.sort_unstable();
    caught.dedup();
    caught
}
