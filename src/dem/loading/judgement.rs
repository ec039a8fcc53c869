//! Numbers by which a run is judged, and the warning that follows from them.
//!
//! A test is quasi-static when halving the speed changes its strength by less than its scatter. The cheap sign of that is
//! the quasi-static number: how many times a wave runs through the height while the piece is strained to where its bonds
//! can be expected to fail. It is free of size, modulus and strength, which a speed, a strain rate or a strain in a step is
//! not. At 43 transits half the speed moved the strength of concrete by at most 2 %, at about 20 by 3 to 7 %; the bound
//! is 30. The inertial number ε̇ d √(ρ/σ) is reported too but is far too lax here.

use super::drive::Run;
use super::piece::Piece;
use super::rig::Scales;
use super::settings::Schedule;
use super::validity::{Check, Reason};
use crate::measure::unbalanced_ratio;
use crate::{Engine, Space};
use serde::{Deserialize, Serialize};

/// Numbers by which a run is judged.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Judgement {
    /// First time step (s).
    pub time_step: f64,
    /// Steps made.
    pub steps: u64,
    /// Speed of each platen or grip (m/s).
    pub speed: f64,
    /// Strain rate (1/s).
    pub strain_rate: f64,
    /// Strain in one step.
    pub strain_per_step: f64,
    /// Speed of each platen or grip over the wave speed √(E*/ρ), which is below that of the specimen.
    pub speed_ratio: f64,
    /// Wave transits of the height within the reference strain: the quasi-static number.
    pub transits: f64,
    /// ε̇ d √(ρ/σ) at the peak, d the mean diameter.
    pub inertial_number: f64,
    /// 2 bonds / ball at the start.
    pub coordination: f64,
    /// Mean unbalanced force over mean contact force at the end.
    pub unbalanced: f64,
    /// Side gauges.
    pub gauges: usize,
    /// Mean diameters across the narrowest extent.
    pub particles_across: f64,
}

/// A test that runs but may not be quasi-static: too few wave transits before its bonds can be expected to fail.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error(
    "{found:.1} wave transits before failure, below {LEAST_TRANSITS}: the strength depends on the rate; lower the speed of the platens to {remedy:.3} m/s"
)]
pub struct LoadingWarning {
    /// Wave transits within the reference strain.
    pub found: f64,
    /// Speed that meets the bound (m/s).
    pub remedy: f64,
}

impl LoadingWarning {
    /// The warning for platens of `speed` (m/s), if the wave transits are too few.
    pub(super) fn of(speed: f64, transits: f64) -> Option<Self> {
        (transits < LEAST_TRANSITS).then_some(Self { found: transits, remedy: speed * transits / LEAST_TRANSITS })
    }
}

/// Wave transits within the reference strain below which strength depends on the rate.
pub const LEAST_TRANSITS: f64 = 30.0;
/// Particles across below which results mean little.
const LEAST_ACROSS: f64 = 10.0;

impl Judgement {
    /// Judges a run of a piece with `bonds` bonds at the start; `strength` is its peak stress (Pa).
    pub(super) fn of<S: Space>(
        engine: &Engine<S>,
        run: &Run<S>,
        piece: &Piece<S>,
        (scales, schedule): (&Scales, &Schedule),
        (bonds, gauges): (usize, usize),
        strength: f64,
    ) -> Self {
        Self {
            time_step: run.time_step,
            steps: run.steps,
            speed: schedule.speed,
            strain_rate: schedule.rate,
            strain_per_step: schedule.rate * run.time_step,
            speed_ratio: schedule.speed / scales.wave_speed(),
            transits: schedule.transits,
            inertial_number: schedule.rate * 2.0 * piece.mean_radius() * (scales.density / strength).sqrt(),
            coordination: 2.0 * bonds as f64 / piece.radii.len() as f64,
            unbalanced: unbalanced_ratio(engine),
            gauges,
            particles_across: piece.particles_across(),
        }
    }

    /// The warning of a test that was too fast.
    pub fn warning(&self) -> Option<LoadingWarning> {
        LoadingWarning::of(self.speed, self.transits)
    }

    /// Cautions on the run, which do not make it invalid.
    pub(super) fn checks(&self) -> Vec<Check> {
        vec![
            Check::at_least(Reason::Transits, self.transits, LEAST_TRANSITS),
            Check::at_least(Reason::FewParticles, self.particles_across, LEAST_ACROSS),
        ]
    }
}
