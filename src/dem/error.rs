//! What can be wrong with a model, and why a run can fail.

use super::particle::Group;
use math::text::Amount;

/// One fault of the input. All faults of a model are reported together.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Fault {
    /// A number of a particle is out of range.
    #[error("particle {particle}: {quantity} is {value:#}, wanted {wanted}")]
    Particle {
        /// Index in the caller's list.
        particle: usize,
        /// What it is.
        quantity: &'static str,
        /// What was found.
        value: Amount,
        /// What is allowed.
        wanted: &'static str,
    },
    /// A number of a clump is out of range.
    #[error("clump {clump}: {quantity} is {value:#}, wanted {wanted}")]
    Clump {
        /// Index in the caller's list.
        clump: usize,
        /// What it is.
        quantity: &'static str,
        /// What was found.
        value: Amount,
        /// What is allowed.
        wanted: &'static str,
    },
    /// A pebble does not exist, belongs to two clumps, or cannot do what is asked of a ball.
    #[error("clump {clump}: pebble {pebble} {problem}")]
    Pebble {
        /// Index in the caller's list.
        clump: usize,
        /// Index of the particle.
        pebble: usize,
        /// What is wrong.
        problem: &'static str,
    },
    /// A number of a wall is out of range.
    #[error("wall {wall}: {quantity} is {value:#}, wanted {wanted}")]
    Wall {
        /// Index in the caller's list.
        wall: usize,
        /// What it is.
        quantity: &'static str,
        /// What was found.
        value: Amount,
        /// What is allowed.
        wanted: &'static str,
    },
    /// A call names a particle or wall that is not there.
    #[error("{what} {index} does not exist: there are {count}, counted from 0")]
    Missing {
        /// `particle` or `wall`.
        what: &'static str,
        /// The index asked for.
        index: usize,
        /// How many there are.
        count: usize,
    },
    /// A call names a removed wall.
    #[error("wall {wall} was removed")]
    Removed {
        /// Index in the caller's list.
        wall: usize,
    },
    /// A number of the contact table is out of range.
    #[error("contact of groups {} and {}: {quantity} is {value:#}, wanted {wanted}", a.0, b.0)]
    Interaction {
        /// First group.
        a: Group,
        /// Second group.
        b: Group,
        /// What it is.
        quantity: &'static str,
        /// What was found.
        value: Amount,
        /// What is allowed.
        wanted: &'static str,
    },
    /// Two groups can meet and the contact table has nothing for them.
    #[error("groups {} and {} can meet and the contact table has no entry for them", a.0, b.0)]
    NoInteraction {
        /// First group.
        a: Group,
        /// Second group.
        b: Group,
    },
    /// A setting is out of range.
    #[error("{quantity} is {value:#}, wanted {wanted}")]
    Setting {
        /// What it is.
        quantity: &'static str,
        /// What was found.
        value: Amount,
        /// What is allowed.
        wanted: &'static str,
    },
    /// Two particles start too deep in one another.
    #[error(
        "particles {a} and {b} start with an overlap of {overlap:.3} of the smaller radius (of the ball's, at a clump)"
    )]
    Overlap {
        /// One, by its index in the caller's list.
        a: usize,
        /// The other.
        b: usize,
        /// Overlap over the smaller radius, or over the ball's at a pebble of a clump.
        overlap: f64,
    },
    /// A particle starts too deep in a wall.
    #[error("particle {particle} starts with an overlap of {overlap:.3} of its radius in wall {wall}")]
    InWall {
        /// Index in the caller's list.
        wall: usize,
        /// Index in the caller's list.
        particle: usize,
        /// Overlap over the radius.
        overlap: f64,
    },
}

/// All faults of a model.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{}", .0.iter().map(ToString::to_string).collect::<Vec<_>>().join("; "))]
pub struct Faults(pub Vec<Fault>);

/// Why a run ended badly: data, not a crash.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum Failure {
    /// A body left the bounds (or went further than half an edge out of a periodic cell).
    #[error("particle {particle} left the bounds at step {step}")]
    Escape {
        /// Index in the caller's list.
        particle: usize,
        /// Step.
        step: u64,
    },
    /// A body moved further in one step than contacts can be found.
    #[error(
        "particle {particle} moved {} in step {step}, more than the {} within which contacts are found: unstable",
        Amount(*.travel, "m"), Amount(*.limit, "m")
    )]
    Instability {
        /// Index in the caller's list.
        particle: usize,
        /// Step.
        step: u64,
        /// Travel in one step, m.
        travel: f64,
        /// Largest allowed travel, m.
        limit: f64,
    },
    /// A position or velocity is not a number.
    #[error("particle {particle} has a position or velocity that is not finite at step {step}")]
    NotFinite {
        /// Index in the caller's list.
        particle: usize,
        /// Step.
        step: u64,
    },
}
