//! Uniaxial compression between two platens, of a rectangle, a box or a standing cylinder.
//!
//! The piece starts free of force with the velocity field of uniform axial shortening, v_y = −2 v y / H, so that no shock
//! runs through it at the start.
//!
//! ```text
//! stress       = mean of both platen forces / A            (compression positive, initial section A; W · 1 m in the plane)
//! axial strain = approach of the platens / H
//! lateral      = side gauges over the middle half of the height, extension positive
//! ```
//!
//! Peak, moduli, Poisson's ratios, crack stresses: [`super::curve`]. Stop rule, cracks, snapshots: [`super::drive`].
//! Whether it is quasi-static: [`super::judgement`].
//!
//! Source: Su et al. 2021, doi:10.3390/ma14071627, section 2.1; Potyondy & Cundall 2004,
//! doi:10.1016/j.ijrmms.2004.09.011.

use super::curve::evaluate;
use super::drive::{Reading, drive};
use super::gauge::Gauges;
use super::judgement::Judgement;
use super::material::Material;
use super::piece::Piece;
use super::platens::{balance, between_platens};
use super::record::{TestRecord, Watcher};
use super::rig::set_velocities;
use super::settings::{Loading, TestError};
use crate::space::Tuple;
use crate::{Engine, Space, Vector};

pub(super) fn run<S: Space>(
    test: &Loading,
    piece: &Piece<S>,
    material: &Material,
    seed: u64,
    watch: Watcher<'_>,
) -> Result<TestRecord<S>, TestError> {
    let (mut mounted, platens) = between_platens(test, piece, material, seed)?;
    let (height, section) = (piece.outline.height(), piece.outline.section());
    let engine = &mut mounted.engine;
    let schedule = test.schedule(&mounted.scales, &piece.outline, engine.time_step())?;
    platens.approach(engine, schedule.speed)?;
    set_velocities(engine, |x| Vector::<S>::build(|k| if k == 1 { -schedule.rate * x.at(1) } else { 0.0 }))?;
    let gauges = Gauges::new::<S>(height, &piece.centres, &piece.radii);
    let mut measure = |engine: &Engine<S>| {
        let [force, asymmetry] = balance(platens.forces(engine));
        Reading {
            axial: platens.approached(engine) / height,
            lateral: gauges.strain::<S>(|i| engine.position(i)),
            stress: force / section,
            confinement: 0.0,
            asymmetry,
        }
    };
    let run = drive(engine, &schedule, &test.rule, &mut measure, watch);
    let values = evaluate(&run.samples);
    let counts = (mounted.bonds, gauges.count());
    let judgement = Judgement::of(engine, &run, piece, (&mounted.scales, &schedule), counts, values.strength);
    Ok(TestRecord::new(run, values, judgement, Vec::new()))
}
