//! Uniaxial compression between two platens.
//!
//! Two rigid platens approach each other, each at the speed v; their contacts have the mortar's modulus and
//! stiffness ratio and the platens' own friction (0 by default). The specimen starts free of force with the velocity
//! field of uniform axial shortening, v_y = −2 v y / H, so that no shock runs through it at the start.
//!
//! ```text
//! stress       = mean of both platen forces / W            (compression positive, initial width, unit thickness)
//! axial strain = approach of the platens / H
//! lateral      = side gauges over the middle half of the height, extension positive
//! ```
//!
//! Peak, moduli, Poisson's ratios, crack stresses: [`super::curve`]. Stop rule, cracks, snapshots: [`super::drive`].
//!
//! Whether it is quasi-static: [`super::judgement`].
//!
//! Source: Su et al. 2021, doi:10.3390/ma14071627, section 2.1; Potyondy & Cundall 2004,
//! doi:10.1016/j.ijrmms.2004.09.011.

use super::curve::{Macro, Sample, evaluate};
use super::drive::{Loading, Run, TestError, TestRecord, drive};
use super::gauge::Gauges;
use super::judgement::{Judgement, LoadingWarning, rate_warnings};
use super::material::{Material, PLATEN};
use super::rig::{mount, set_velocities};
use crate::genesis::region::Region;
use crate::genesis::specimen::Specimen;
use crate::measure::unbalanced_ratio;
use crate::{D2, Engine, Faults, Motion, Wall, Watch};

pub(super) fn run(
    test: &Loading,
    specimen: &Specimen,
    material: &Material,
    seed: u64,
    watch: &mut dyn FnMut(&Sample) -> Watch,
) -> Result<TestRecord, TestError> {
    let Region::Rectangle { width, height } = specimen.region else {
        return Err(TestError::Outline { test: "uniaxial", wanted: "rectangle", remedy: "width and height" });
    };
    let mut engine = between_platens(test, specimen, material, seed)?;
    let rate = 2.0 * test.speed / height;
    set_velocities(&mut engine, |x| [0.0, -rate * x[1]])?;
    let gauges = Gauges::new(height, &specimen.centres, &specimen.radii);
    let bonds = engine.bond_count();
    let measure = |engine: &Engine<D2>| {
        let [approach, force] = platens(engine, height);
        [approach / height, gauges.strain(|i| engine.position(i)[0]), force / width]
    };
    let run = drive(&mut engine, rate, &test.rule, measure, watch);
    let values = evaluate(&run.samples);
    let judgement =
        Judgement { gauges: gauges.count(), ..judge(test, specimen, material, &engine, &run, &values, bonds) };
    Ok(TestRecord { run, values, judgement, checks: Vec::new() })
}

/// The specimen between two platens that approach each other along y.
pub(super) fn between_platens(
    test: &Loading,
    specimen: &Specimen,
    material: &Material,
    seed: u64,
) -> Result<Engine<D2>, Faults> {
    let [_, height] = specimen.region.extent();
    let platen = |side: f64| Wall {
        point: [0.0, 0.5 * side * height],
        normal: [0.0, -side],
        motion: Motion::Velocity([0.0, -side * test.speed]),
        group: PLATEN,
    };
    let walls = vec![platen(-1.0), platen(1.0)];
    mount(specimen, material, walls, test.platen_friction, &test.machine, seed)
}

/// Approach of the platens (m) and mean of their forces (N per metre of thickness).
pub(super) fn platens(engine: &Engine<D2>, height: f64) -> [f64; 2] {
    let approach = height - (engine.wall_point(1)[1] - engine.wall_point(0)[1]);
    let [bottom, top] = [0, 1].map(|w| engine.wall_force(w)[1].abs());
    [approach, 0.5 * (bottom + top)]
}

/// The numbers by which any of the tests is judged, gauges aside.
pub(super) fn judge(
    test: &Loading,
    specimen: &Specimen,
    material: &Material,
    engine: &Engine<D2>,
    run: &Run,
    values: &Macro,
    bonds: usize,
) -> Judgement {
    let [_, height] = specimen.region.extent();
    let rate = 2.0 * test.speed / height;
    let density = specimen.density;
    Judgement {
        time_step: run.time_step,
        steps: run.steps,
        strain_rate: rate,
        strain_per_step: rate * run.time_step,
        speed_ratio: test.speed * (density / material.modulus::<D2>(specimen.mean_radius())).sqrt(),
        inertial_number: rate * 2.0 * specimen.mean_radius() * (density / values.strength).sqrt(),
        coordination: 2.0 * bonds as f64 / specimen.radii.len() as f64,
        unbalanced: unbalanced_ratio(engine),
        gauges: 0,
    }
}

/// What should be known before the test is run: it costs a mounting, not a run.
///
/// # Errors
/// All faults of the input that the engine finds.
pub fn warnings(test: &Loading, specimen: &Specimen, material: &Material) -> Result<Vec<LoadingWarning>, Faults> {
    let engine = between_platens(test, specimen, material, 0)?;
    let [_, height] = specimen.region.extent();
    let strain_per_step = 2.0 * test.speed / height * engine.time_step();
    let speed_ratio = test.speed * (specimen.density / material.modulus::<D2>(specimen.mean_radius())).sqrt();
    Ok(rate_warnings(test.speed, strain_per_step, speed_ratio))
}
