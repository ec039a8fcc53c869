//! Numbers by which a run is judged, and the warnings that follow from them.
//!
//! A test is quasi-static when halving the speed changes its strength by less than its scatter. Cheap signs of that are the
//! strain per step (about 3·10⁻⁸ is the limit) and the platen speed over the wave speed √(E*/ρ) (10⁻⁵). The inertial
//! number ε̇ d √(ρ/σ) is reported too but is far too lax here.

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

/// A test that runs but may not be quasi-static.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum LoadingWarning {
    /// Too much strain in a step.
    #[error(
        "strain per step is {found:.1e}, above 3e-8: the strength depends on the rate; lower the speed to {remedy:.3} m/s"
    )]
    StrainPerStep {
        /// Strain in one step.
        found: f64,
        /// Speed that meets the limit (m/s).
        remedy: f64,
    },
    /// Platens too fast.
    #[error(
        "platen speed over wave speed is {found:.1e}, above 1e-5: the strength depends on the rate; lower the speed to {remedy:.3} m/s"
    )]
    Speed {
        /// Speed over wave speed.
        found: f64,
        /// Speed that meets the limit (m/s).
        remedy: f64,
    },
}

/// Strain per step above which strength depends on the rate.
const STRAIN_PER_STEP_LIMIT: f64 = 3e-8;
/// Platen speed over wave speed above which strength depends on the rate.
const SPEED_RATIO_LIMIT: f64 = 1e-5;
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
        let rate = 2.0 * schedule.speed / piece.outline.height();
        Self {
            time_step: run.time_step,
            steps: run.steps,
            speed: schedule.speed,
            strain_rate: rate,
            strain_per_step: rate * run.time_step,
            speed_ratio: schedule.speed / scales.wave_speed(),
            transits: 0.5 * scales.strain() * scales.wave_speed() / schedule.speed,
            inertial_number: rate * 2.0 * piece.mean_radius() * (scales.density / strength).sqrt(),
            coordination: 2.0 * bonds as f64 / piece.radii.len() as f64,
            unbalanced: unbalanced_ratio(engine),
            gauges,
            particles_across: piece.particles_across(),
        }
    }

    /// The warnings of a test.
    pub fn warnings(&self) -> Vec<LoadingWarning> {
        rate_warnings(self.speed, self.strain_per_step, self.speed_ratio)
    }

    /// Cautions on the run, which do not make it invalid.
    pub(super) fn checks(&self) -> Vec<Check> {
        vec![
            Check::at_most(Reason::StrainPerStep, self.strain_per_step, STRAIN_PER_STEP_LIMIT),
            Check::at_most(Reason::PlatenSpeed, self.speed_ratio, SPEED_RATIO_LIMIT),
            Check::at_least(Reason::FewParticles, self.particles_across, LEAST_ACROSS),
        ]
    }
}

/// Warnings for a speed (m/s), given the strain in a step and the speed over the wave speed.
pub fn rate_warnings(speed: f64, strain_per_step: f64, speed_ratio: f64) -> Vec<LoadingWarning> {
    let mut warnings = Vec::new();
    if strain_per_step > STRAIN_PER_STEP_LIMIT {
        let remedy = speed * STRAIN_PER_STEP_LIMIT / strain_per_step;
        warnings.push(LoadingWarning::StrainPerStep { found: strain_per_step, remedy });
    }
    if speed_ratio > SPEED_RATIO_LIMIT {
        warnings.push(LoadingWarning::Speed { found: speed_ratio, remedy: speed * SPEED_RATIO_LIMIT / speed_ratio });
    }
    warnings
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn warnings_name_the_speed_that_would_do() {
        assert!(rate_warnings(0.02, 2e-8, 6e-6).is_empty());
        let found = rate_warnings(0.08, 6e-8, 2e-5);
        let [LoadingWarning::StrainPerStep { remedy: a, .. }, LoadingWarning::Speed { remedy: b, .. }] = found[..]
        else {
            panic!("{found:?}");
        };
        assert!((a - 0.04).abs() < 1e-12 && (b - 0.04).abs() < 1e-12);
    }
}
