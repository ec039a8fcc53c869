//! A packing of balls in a vessel: to a porosity, to a stress, or as a lattice.
//!
//! **To a porosity**, by radius expansion:
//! 1. Number and radii by [`super::sizes`]; balls placed at half size without overlap ([`super::cloud`]).
//! 2. Full size at once (m = 2), then the rest state without friction ([`super::relax`]): all stresses come from the
//!    overlaps, and the walls being fixed the stress is isotropic up to the noise of the packing (reported).
//! 3. Floaters (fewer than 3 contacts in the plane, 4 in the solid): each is enlarged in small steps and everything rescaled
//!    to the porosity (where the radii give way) and relaxed, round after round, until their share is at most the one
//!    allowed or the rounds are spent (reported).
//!
//! **To a stress**: [`super::compress`]. Where the number gives way, balls are taken out or put in until the radii at the
//! stress are the stated ones, to half a ball's volume or 5·10⁻⁴.
//!
//! At the end balls are renumbered along a Morton curve, so that neighbours in space are neighbours in memory.
//!
//! Above a porosity of about 0.16 discs do not jam (spheres 0.36) and there is nothing to bond; that is an error, and so is
//! a porosity that forces overlaps beyond half a radius.
//!
//! Lengths in metres. Source: doi:10.3390/ma14071627, section 2.2; Potyondy & Cundall 2004,
//! doi:10.1016/j.ijrmms.2004.09.011, section 2.

use super::cloud::{scale_to_porosity, scatter};
use super::compress::{Compressed, Floaters, StressTarget};
use super::fabric::{Fabric, held};
use super::heap::{Heap, Still};
use super::lattice::Lattice;
use super::region::Region;
use super::relax::Until;
use super::sizes::{GivesWay, Sizes};
use crate::Watch;
use crate::space::{D2, Space, Tuple, Vector};
use math::random::Stream;
use math::text::{Amount, Number};
use serde::{Deserialize, Serialize};

/// How a packing is made.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Packing {
    /// To a ball porosity.
    Porosity {
        /// Radii and number.
        sizes: Sizes,
        /// Ball porosity: 1 − Σ V(R) / Ω, overlaps counted twice.
        porosity: f64,
        /// Largest share of balls with too few contacts that is left alone.
        floaters: f64,
    },
    /// To a mean stress.
    Stress {
        /// Radii and number.
        sizes: Sizes,
        /// Stress, and how it is reached.
        target: StressTarget,
    },
    /// A regular lattice.
    Lattice {
        /// Kind.
        lattice: Lattice,
        /// Radius of all balls (m); it gives way to the height.
        radius: f64,
    },
}

/// A packing at rest, with all that happened on the way.
#[derive(Clone, Debug)]
pub struct Packed<S: Space = D2> {
    /// The balls in their vessel.
    pub heap: Heap<S>,
    /// Factor on the stated radii.
    pub radius_factor: f64,
    /// Rounds of treating floaters.
    pub floater_rounds: usize,
    /// Largest factor by which a floater was enlarged.
    pub floater_growth: f64,
    /// Floaters taken out.
    pub deleted: usize,
    /// Iterations of the relaxations in total.
    pub iterations: usize,
    /// Mean unbalanced force over mean contact force at the end.
    pub unbalanced: f64,
    /// Contact modulus that stresses of the packing refer to (Pa), where there is one.
    pub modulus: Option<f64>,
}

/// Why there is no packing.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PackingError {
    /// A number outside its range.
    #[error("packing: {name} is {found:#}; it must be {expected}")]
    Value {
        /// Which number.
        name: &'static str,
        /// What was given.
        found: Amount,
        /// What it must be.
        expected: &'static str,
    },
    /// Lists that do not go together.
    #[error("packing: {name}: {problem}")]
    List {
        /// Which list.
        name: &'static str,
        /// What is wrong.
        problem: &'static str,
    },
    /// Too few balls.
    #[error(
        "packing: a mean radius of {} gives {count} balls in the specimen; at least 30 are needed, reduce it",
        Amount(*.mean_radius, "m")
    )]
    Few {
        /// Mean radius asked for (m).
        mean_radius: f64,
        /// Balls that it makes.
        count: usize,
    },
    /// Too many balls.
    #[error(
        "packing: a mean radius of {} gives {count:.2e} balls in the specimen, which would take about {} GB of memory and \
         {} h to pack; at most {MOST_BALLS:e} are packed, enlarge the radius",
        Amount(*.mean_radius, "m"), Number(*.gigabytes), Number(*.hours)
    )]
    Many {
        /// Mean radius asked for (m).
        mean_radius: f64,
        /// Balls that it makes.
        count: f64,
        /// Memory of the packing (GB).
        gigabytes: f64,
        /// Time to pack on one core (h).
        hours: f64,
    },
    /// Balls too large for the vessel.
    #[error(
        "packing: the largest ball has a diameter of {} and the specimen is {} across; at most half of that fits, \
         reduce the radius or the ratio of radii",
        Amount(*.diameter, "m"), Amount(*.narrowest, "m")
    )]
    Large {
        /// Largest diameter (m).
        diameter: f64,
        /// Smallest extent of the specimen (m).
        narrowest: f64,
    },
    /// A lattice of the other space.
    #[error("packing: the lattice `{lattice:?}` has {wanted} dimensions and the outline {found}")]
    Dimension {
        /// Kind of lattice.
        lattice: Lattice,
        /// Its dimensions.
        wanted: usize,
        /// Those of the outline.
        found: usize,
    },
    /// Not jammed.
    #[error(
        "packing: porosity {porosity} is out of reach from above: the balls have {coordination:.2} contacts each and \
         hold no stress (discs jam near 0.16, spheres near 0.36); reduce it"
    )]
    Loose {
        /// Porosity asked for.
        porosity: f64,
        /// Contacts per ball × 2 reached.
        coordination: f64,
    },
    /// Overlaps beyond half a radius.
    #[error(
        "packing: overlaps reach {overlap:.2} of a radius at porosity {porosity:.4} (0.5 is the limit); raise the porosity or lower the stress"
    )]
    Dense {
        /// Porosity asked for or reached.
        porosity: f64,
        /// Largest overlap over the smaller radius.
        overlap: f64,
    },
    /// A ball left the vessel.
    #[error(
        "packing: ball {ball} was squeezed out of the vessel; raise the porosity of the cloud, or lower the stress"
    )]
    Escaped {
        /// Its index.
        ball: usize,
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
    /// The stress was not reached.
    #[error(
        "packing: the stress is {} after {scalings} scalings of the radii, not {}; widen the tolerance",
        Amount(*.reached, "Pa"), Amount(*.target, "Pa")
    )]
    Unsettled {
        /// Stress asked for (Pa).
        target: f64,
        /// Stress reached (Pa).
        reached: f64,
        /// Scalings spent.
        scalings: usize,
    },
}

impl PackingError {
    /// Whether packing came to this, which no look at the settings could foresee: another seed may come to something else.
    pub fn is_outcome(&self) -> bool {
        match self {
            Self::Loose { .. }
            | Self::Dense { .. }
            | Self::Escaped { .. }
            | Self::Restless { .. }
            | Self::Unsettled { .. } => true,
            Self::Value { .. }
            | Self::List { .. }
            | Self::Few { .. }
            | Self::Many { .. }
            | Self::Large { .. }
            | Self::Dimension { .. }
            | Self::Stopped => false,
        }
    }
}

/// Most balls that are packed.
pub const MOST_BALLS: f64 = 5e6;
/// Mean unbalanced force over the mean contact force that counts as rest at a fixed porosity.
pub(super) const REST: f64 = 1e-3;
pub(super) const AT_REST: Until = Until { unbalanced: REST, slack: 0.0, iterations: 40_000, margin: 0.5 };
const MOST_ROUNDS: usize = 30;
/// Factor on a floater's radius in one round.
const GROWTH: f64 = 1.02;
/// Relative deviation of the radii at the stress from the stated ones that is left when the number gives way.
const NEAR_STATED: f64 = 5e-4;
const MOST_RECOUNTS: usize = 6;
/// Shares of their radius through which balls grow that are put into a packing.
pub(super) const INSERTION: [f64; 5] = [0.2, 0.4, 0.6, 0.8, 1.0];

impl Packing {
    /// Uniform radii with a mean that gives way to the porosity; no floaters are left.
    pub fn uniform(porosity: f64, mean_radius: f64, ratio: f64) -> Self {
        Self::Porosity { sizes: Sizes::uniform(mean_radius, ratio), porosity, floaters: 0.0 }
    }

    /// Packs `region`, which must be one of this space; the same stream gives the same packing. `watch` is asked in every
    /// iteration.
    ///
    /// # Errors
    /// The first of: a fault of the settings, stopped by `watch`, no equilibrium, a porosity or stress out of reach.
    pub fn pack<S: Space>(
        &self,
        region: &Region,
        stream: &mut Stream,
        watch: &dyn Fn() -> Watch,
    ) -> Result<Packed<S>, PackingError> {
        if let Some(fault) = self.faults::<S>(region).into_iter().next() {
            return Err(fault);
        }
        let packed = match self {
            Self::Porosity { sizes, porosity, floaters } => {
                let mut packed = to_porosity::<S>(sizes, *porosity, region, stream, watch);
                hold_floaters(&mut packed, *porosity, *floaters, sizes.gives_way, watch);
                if watch() == Watch::Stop {
                    return Err(PackingError::Stopped);
                }
                judge(&packed, *porosity)?;
                packed
            }
            Self::Stress { sizes, target } => to_stress::<S>(sizes, target, region, stream, watch)?,
            Self::Lattice { lattice, radius } => as_lattice::<S>(*lattice, *radius, region),
        };
        if let Some(ball) = packed.heap.centres.iter().position(|&x| region.depth::<S>(x) < 0.0) {
            return Err(PackingError::Escaped { ball });
        }
        let overlap = Fabric::of(&packed.heap).largest_overlap;
        if overlap > 0.5 {
            return Err(PackingError::Dense { porosity: 1.0 - packed.heap.ball_volume() / region.volume(), overlap });
        }
        Ok(Packed { heap: renumbered(&packed.heap), ..packed })
    }
}

/// The cloud grown to its porosity, at rest if it could be found.
fn to_porosity<S: Space>(
    sizes: &Sizes,
    porosity: f64,
    region: &Region,
    stream: &mut Stream,
    watch: &dyn Fn() -> Watch,
) -> Packed<S> {
    let (mut heap, radius_factor) = cloud(sizes, porosity, region, stream);
    let first = heap.relax(AT_REST, watch);
    Packed { radius_factor, iterations: first.iterations, unbalanced: first.unbalanced, ..Packed::of(heap) }
}

/// Balls of full size at the positions of the cloud, and the factor on their stated radii.
fn cloud<S: Space>(sizes: &Sizes, porosity: f64, region: &Region, stream: &mut Stream) -> (Heap<S>, f64) {
    let volume = region.volume();
    let mut radii = sizes.draw::<S>(sizes.count::<S>(volume, porosity) as usize, stream);
    let factor = match sizes.gives_way {
        GivesWay::Radius => scale_to_porosity::<S>(&mut radii, volume, porosity),
        GivesWay::Number => 1.0,
    };
    let centres = scatter::<S>(&radii, region, stream);
    (renumbered(&Heap { region: *region, centres, radii, still: Still::default() }), factor)
}

/// Enlarges floaters until few enough are left; a round that finds no rest is undone and ends it.
pub(super) fn hold_floaters<S: Space>(
    packed: &mut Packed<S>,
    porosity: f64,
    share: f64,
    gives_way: GivesWay,
    watch: &dyn Fn() -> Watch,
) {
    let (still, count) = (packed.heap.still.pebbles, packed.heap.radii.len());
    let mut growth = vec![1.0_f64; count];
    while packed.floater_rounds < MOST_ROUNDS && packed.unbalanced < REST {
        let contacts = packed.heap.contact_counts();
        let floats = |&i: &usize| contacts[i] < held::<S>();
        if (still..count).filter(floats).count() as f64 <= share * (count - still) as f64 {
            break;
        }
        let mut next = packed.clone();
        for i in (still..count).filter(floats) {
            next.heap.radii[i] *= GROWTH;
            growth[i] *= GROWTH;
        }
        if gives_way == GivesWay::Radius {
            let volume = next.heap.room();
            next.radius_factor *= scale_to_porosity::<S>(&mut next.heap.radii[still..], volume, porosity);
        }
        let rest = next.heap.relax(AT_REST, watch);
        packed.iterations += rest.iterations;
        if rest.unbalanced >= REST {
            break;
        }
        let iterations = packed.iterations;
        *packed = Packed { iterations, unbalanced: rest.unbalanced, floater_rounds: packed.floater_rounds + 1, ..next };
        packed.floater_growth = growth.iter().copied().fold(1.0, f64::max);
    }
}

pub(super) fn judge<S: Space>(packed: &Packed<S>, porosity: f64) -> Result<(), PackingError> {
    let coordination = Fabric::of(&packed.heap).coordination;
    if packed.unbalanced >= REST {
        return Err(PackingError::Restless { iterations: packed.iterations, unbalanced: packed.unbalanced });
    }
    if coordination < f64::from(held::<S>()) {
        return Err(PackingError::Loose { porosity, coordination });
    }
    Ok(())
}

/// A packing at its stress. Where the number gives way, the share of the radii's factor that is not 1 becomes a number of
/// balls, round after round.
fn to_stress<S: Space>(
    sizes: &Sizes,
    target: &StressTarget,
    region: &Region,
    stream: &mut Stream,
    watch: &dyn Fn() -> Watch,
) -> Result<Packed<S>, PackingError> {
    let (mut heap, factor) = cloud(sizes, target.cloud_porosity, region, stream);
    let mut all = Compressed { factor, ..Compressed::default() };
    let kept = StressTarget { floaters: Floaters::Keep, ..*target };
    let by_number = sizes.gives_way == GivesWay::Number;
    // Floaters carry nothing: the number is found with them, and they are treated when it is nearly right.
    for (target, recounts) in [(&kept, if by_number { MOST_RECOUNTS } else { 0 }), (target, 1 + MOST_RECOUNTS / 2)] {
        for _ in 0..recounts {
            let next = target.compress(&mut heap, watch)?;
            all = all.and(next);
            let count = heap.radii.len();
            let volume = (1..=S::DIMENSION).fold(1.0, |power, _| power * all.factor);
            let wanted = (count as f64 * volume).round() as usize;
            if !by_number || wanted == count || (all.factor - 1.0).abs() <= NEAR_STATED {
                break;
            }
            heap.scale(1.0 / all.factor);
            all.factor = 1.0;
            recount(&mut heap, sizes, wanted, stream, watch);
        }
    }
    Ok(Packed {
        radius_factor: all.factor,
        floater_rounds: all.rounds,
        floater_growth: all.growth,
        deleted: all.deleted,
        iterations: all.iterations,
        unbalanced: all.unbalanced,
        modulus: Some(target.modulus),
        ..Packed::of(heap)
    })
}

/// Takes random balls out, or puts some of the law at random positions, until there are `wanted`. New balls grow in steps,
/// so that none is squeezed through its neighbours or a wall.
fn recount<S: Space>(heap: &mut Heap<S>, sizes: &Sizes, wanted: usize, stream: &mut Stream, watch: &dyn Fn() -> Watch) {
    let count = heap.radii.len();
    if wanted < count {
        let mut order: Vec<usize> = (0..count).collect();
        stream.shuffle(&mut order);
        order.truncate(wanted);
        order.sort_unstable();
        *heap = heap.chosen(&order);
        return;
    }
    let more = sizes.draw::<S>(wanted - count, stream);
    heap.centres.extend(scatter::<S>(&more, &heap.region, stream));
    heap.radii.extend(&more);
    for share in INSERTION {
        for (radius, full) in heap.radii[count..].iter_mut().zip(&more) {
            *radius = share * full;
        }
        heap.relax(AT_REST, watch);
    }
}

fn as_lattice<S: Space>(lattice: Lattice, radius: f64, region: &Region) -> Packed<S> {
    let fitted = lattice.fitted_radius(radius, region.edges()[1]);
    Packed { radius_factor: fitted / radius, ..Packed::of(lattice.fill::<S>(region, radius)) }
}

impl<S: Space> Packed<S> {
    /// A heap to which nothing happened.
    pub(super) fn of(heap: Heap<S>) -> Self {
        Self {
            heap,
            radius_factor: 1.0,
            floater_rounds: 0,
            floater_growth: 1.0,
            deleted: 0,
            iterations: 0,
            unbalanced: 0.0,
            modulus: None,
        }
    }
}

/// The balls in the order of a Morton curve over 1024 cells along each axis of the vessel.
pub(super) fn renumbered<S: Space>(heap: &Heap<S>) -> Heap<S> {
    let edges = heap.region.edges();
    let cell = |x: f64, length: f64| ((x / length + 0.5).clamp(0.0, 0.999_999) * 1024.0) as u32;
    let code =
        |c: &Vector<S>| (0..S::DIMENSION).fold(0, |code, k| code | spread(cell(c.at(k), edges[k]), S::DIMENSION) << k);
    let mut order: Vec<usize> = (0..heap.radii.len()).collect();
    order[heap.still.pebbles..].sort_by_key(|&i| code(&heap.centres[i]));
    heap.chosen(&order)
}

/// The ten low bits of `x`, each followed by zeros for the other axes.
fn spread(x: u32, dimension: usize) -> u32 {
    (0..10).fold(0, |code, bit| code | ((x >> bit) & 1) << (dimension * bit))
}

mod faults;

#[cfg(test)]
mod tests;
