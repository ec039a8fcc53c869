//! Uniaxial compression between two platens.
//!
//! Two rigid platens approach each other, each at `platen_speed`; their contacts have the mortar's modulus and
//! stiffness ratio and the platens' own friction (0 by default). The specimen starts free of force with the velocity
//! field of uniform axial shortening, v_y = −2 v y / H, so that no shock runs through it at the start.
//!
//! ```text
//! stress       = mean of both platen forces / W            (compression positive, initial width, unit thickness)
//! axial strain = approach of the platens / H
//! lateral      = side gauges over the middle half of the height, extension positive
//! ```
//!
//! Peak, moduli, Poisson's ratios, crack stresses: [`super::curve`]. Stop rule, cracks, snapshots: [`super::loading`].
//!
//! # Whether it is quasi-static
//! Judged by the strain per step (about 3·10⁻⁸ is the limit) and by platen speed over wave speed (10⁻⁵), the wave speed
//! being √(E/ρ) with the *measured* modulus afterwards and √(E_c/ρ), which is lower, before the run. The inertial number
//! ε̇ d √(ρ/σ) is reported as well but is far too lax here. The certain check is half the speed.
//!
//! Source: Su et al. 2021, doi:10.3390/ma14071627, section 2.1; Potyondy & Cundall 2004,
//! doi:10.1016/j.ijrmms.2004.09.011.

use super::curve::{Macro, Sample, evaluate};
use super::gauge::Gauges;
use super::loading::{Rule, Run, drive};
use super::material::{Material, PLATEN};
use super::rig::{Machine, mount, set_velocities};
use crate::dem::genesis::specimen::Specimen;
use crate::dem::{D2, Engine, Faults, Motion, Wall, Watch};
use serde::{Deserialize, Serialize};

/// Settings of the test.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Compression {
    /// Speed of each platen (m/s).
    pub platen_speed: f64,
    /// Friction of the platens.
    pub platen_friction: f64,
    /// Damping, masses, time step.
    pub machine: Machine,
    /// Sampling and stopping.
    pub rule: Rule,
}

impl Default for Compression {
    /// 0.02 m/s each, no friction: the published test.
    fn default() -> Self {
        Self { platen_speed: 0.02, platen_friction: 0.0, machine: Machine::default(), rule: Rule::default() }
    }
}

/// The record of a compression test.
#[derive(Clone, Debug)]
pub struct CompressionRecord {
    /// Samples, cracks, snapshots, failure.
    pub run: Run,
    /// Peak, moduli, Poisson's ratios.
    pub values: Macro,
    /// Numbers by which the run is judged.
    pub judgement: Judgement,
}

/// Numbers by which a run is judged.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Judgement {
    /// First time step (s).
    pub time_step: f64,
    /// Steps made.
    pub steps: u64,
    /// Strain rate (1/s).
    pub strain_rate: f64,
    /// Strain in one step.
    pub strain_per_step: f64,
    /// Platen speed over √(E/ρ).
    pub speed_ratio: f64,
    /// ε̇ d √(ρ/σ) at the peak, d the mean diameter.
    pub inertial_number: f64,
    /// 2 bonds / ball at the start.
    pub coordination: f64,
    /// Side gauges.
    pub gauges: usize,
    /// Difference of the two platen forces over their mean, at the peak.
    pub platen_imbalance: f64,
}

/// A test that runs but may not be quasi-static.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum LoadingWarning {
    /// Too much strain in a step.
    #[error(
        "strain per step is {found:.1e}, above 3e-8: the strength will be rate-dependent; lower the platen speed below {remedy:.3} m/s"
    )]
    StrainPerStep {
        /// Strain in one step.
        found: f64,
        /// Platen speed that meets the limit (m/s).
        remedy: f64,
    },
    /// Platens too fast.
    #[error(
        "platen speed over wave speed is {found:.1e}, above 1e-5: the strength will be rate-dependent; lower the platen speed below {remedy:.3} m/s"
    )]
    PlatenSpeed {
        /// Platen speed over wave speed.
        found: f64,
        /// Platen speed that meets the limit (m/s).
        remedy: f64,
    },
}

/// Strain per step above which strength depends on the rate.
pub const STRAIN_PER_STEP_LIMIT: f64 = 3e-8;
/// Platen speed over wave speed above which strength depends on the rate.
pub const SPEED_RATIO_LIMIT: f64 = 1e-5;

impl Compression {
    /// Mounts the specimen and runs the test to its end.
    ///
    /// # Errors
    /// All faults of the input that the engine finds.
    pub fn run(
        &self,
        specimen: &Specimen,
        material: &Material,
        seed: u64,
        watch: &mut dyn FnMut(&Sample) -> Watch,
    ) -> Result<CompressionRecord, Faults> {
        let [width, height] = specimen.region.extent();
        let mut engine = self.mount(specimen, material, seed)?;
        let rate = 2.0 * self.platen_speed / height;
        set_velocities(&mut engine, |x| [0.0, -rate * x[1]]);
        let gauges = Gauges::new(height, &specimen.centres, &specimen.radii);
        let bonds = engine.bond_count();
        let measure = |engine: &Engine<D2>| {
            let approach = height - (engine.wall_point(1)[1] - engine.wall_point(0)[1]);
            let [bottom, top] = [0, 1].map(|w| engine.wall_force(w)[1].abs());
            [approach / height, gauges.strain(|i| engine.position(i)[0]), 0.5 * (bottom + top) / width]
        };
        let run = drive(&mut engine, rate, &self.rule, measure, watch);
        let values = evaluate(&run.samples);
        let [bottom, top] = [0, 1].map(|w| engine.wall_force(w)[1].abs());
        let density = specimen.density;
        let diameter = 2.0 * specimen.mean_radius();
        let judgement = Judgement {
            time_step: run.time_step,
            steps: run.steps,
            strain_rate: rate,
            strain_per_step: rate * run.time_step,
            speed_ratio: self.platen_speed * (density / values.modulus_tangent).sqrt(),
            inertial_number: rate * diameter * (density / values.strength).sqrt(),
            coordination: 2.0 * bonds as f64 / specimen.radii.len() as f64,
            gauges: gauges.count(),
            platen_imbalance: 2.0 * (bottom - top).abs() / (bottom + top),
        };
        Ok(CompressionRecord { run, values, judgement })
    }

    /// What should be known before the test is run: it costs a mounting, not a run.
    ///
    /// # Errors
    /// All faults of the input that the engine finds.
    pub fn warnings(&self, specimen: &Specimen, material: &Material) -> Result<Vec<LoadingWarning>, Faults> {
        let engine = self.mount(specimen, material, 0)?;
        let [_, height] = specimen.region.extent();
        let wave_speed = (material.mortar.modulus / specimen.density).sqrt();
        Ok(rate_warnings(self.platen_speed, height, engine.time_step(), wave_speed))
    }

    fn mount(&self, specimen: &Specimen, material: &Material, seed: u64) -> Result<Engine<D2>, Faults> {
        let [_, height] = specimen.region.extent();
        let platen = |side: f64| Wall {
            point: [0.0, 0.5 * side * height],
            normal: [0.0, -side],
            motion: Motion::Velocity([0.0, -side * self.platen_speed]),
            group: PLATEN,
        };
        let walls = vec![platen(-1.0), platen(1.0)];
        mount(specimen, material, walls, self.platen_friction, &self.machine, seed)
    }
}

/// Warnings for platens at `speed` each (m/s), `height` apart (m).
pub fn rate_warnings(speed: f64, height: f64, time_step: f64, wave_speed: f64) -> Vec<LoadingWarning> {
    let mut warnings = Vec::new();
    let found = 2.0 * speed / height * time_step;
    if found > STRAIN_PER_STEP_LIMIT {
        warnings.push(LoadingWarning::StrainPerStep { found, remedy: speed * STRAIN_PER_STEP_LIMIT / found });
    }
    let found = speed / wave_speed;
    if found > SPEED_RATIO_LIMIT {
        warnings.push(LoadingWarning::PlatenSpeed { found, remedy: speed * SPEED_RATIO_LIMIT / found });
    }
    warnings
}
