//! Converts the record of a test to its artifact, a [`Run`].

use super::config::Params;
use super::laid::Laid;
use crate::artifact::Artifact;
use crate::artifact::run::{Checks, CrackMode, Cracks, Curve, Energies, Forces, Interfaces, Quantities, Responses};
use crate::artifact::run::{Run, States};
use dem::loading::crack::CrackEvent;
use dem::loading::curve::thinned;
use dem::loading::kind::TestKind;
use dem::loading::material::Material;
use dem::loading::pace::Pace;
use dem::loading::record::TestRecord;
use dem::loading::snapshot::Snapshot;
use dem::measure::{Energy, Link, Mode};
use dem::space::Tuple;
use dem::{Space, Vector};
use ndarray::{Array2, Array3};
use std::collections::BTreeMap;

/// Number of points of the stored curve.
const CURVE_POINTS: usize = 400;

/// The artifact of a record.
pub(super) fn artifact<S: Space>(record: &TestRecord<S>, params: &Params, laid: Option<&Laid>) -> Artifact {
    let Params { material, test, .. } = params;
    let snapshots = &record.run.snapshots;
    let run = Run {
        failure: record.run.failure.map_or_else(String::new, |failure| failure.to_string()),
        validity: Some(record.validity()),
        cautions: None,
        warnings: Some(warnings(record, laid)),
        responses: Responses::of(&responses(record, test.kind)),
        judgement: Some(judgement(record, laid)),
        checks: Some(checks(record)),
        curve: Some(curve(record, test.pace)),
        energies: Some(energies(&record.run.energies)),
        cracks: Some(cracks(&record.run.cracks, material)),
        interfaces: params.interfaces().then(|| interfaces(&record.run.cracks)),
        fissures: laid.map(|laid| laid.table.clone()),
        states: Some(states(snapshots)),
        state_centres: Some(centres(snapshots)),
        forces: test.rule.forces.then(|| forces(snapshots)),
    };
    run.to_artifact()
}

fn responses<S: Space>(record: &TestRecord<S>, kind: TestKind) -> Vec<(&'static str, f64, &'static str)> {
    kind.responses().iter().map(|response| (response.name, (response.read)(&record.values), response.unit)).collect()
}

/// Sentences on the rate of loading, on fissures without effect, and on why the run is not valid.
fn warnings<S: Space>(record: &TestRecord<S>, laid: Option<&Laid>) -> Vec<String> {
    let rate = record.judgement.warning().into_iter().map(|warning| warning.to_string());
    let idle = laid.and_then(Laid::idle);
    rate.chain(idle).chain(record.invalid().map(|check| format!("{}{check}", Run::NOT_VALID))).collect()
}

/// A column with one value of every item.
fn each<T, V>(items: &[T], pick: impl Fn(&T) -> V) -> Vec<V> {
    items.iter().map(pick).collect()
}

fn checks<S: Space>(record: &TestRecord<S>) -> Checks {
    let checks = &record.checks;
    Checks {
        check: each(checks, |check| check.reason.name().to_owned()),
        value: each(checks, |check| check.value),
        bound: each(checks, |check| check.bound),
        unit: each(checks, |check| check.reason.unit().to_owned()),
        met: each(checks, |check| check.met),
        decisive: each(checks, |check| check.reason.invalidates()),
        meaning: each(checks, |check| check.reason.about().to_owned()),
        remedy: each(checks, |check| check.reason.remedy().to_owned()),
    }
}

fn judgement<S: Space>(record: &TestRecord<S>, laid: Option<&Laid>) -> Quantities {
    let j = &record.judgement;
    let mut all = vec![
        ("time step", j.time_step, "s"),
        ("steps", j.steps as f64, ""),
        ("platen speed", j.speed, "m/s"),
        ("strain rate", j.strain_rate, "1/s"),
        ("strain per step", j.strain_per_step, ""),
        ("platen speed / wave speed", j.speed_ratio, ""),
        ("wave transits within the reference strain", j.transits, ""),
        ("inertial number at the peak", j.inertial_number, ""),
        ("coordination (2 bonds / disc)", j.coordination, ""),
        ("discs across", j.particles_across, ""),
        ("side gauges", j.gauges as f64, ""),
        ("unbalanced force / contact force at the end", j.unbalanced, ""),
    ];
    all.extend(laid.into_iter().flat_map(Laid::quantities));
    Quantities::of(&all)
}

fn curve<S: Space>(record: &TestRecord<S>, pace: Pace) -> Curve {
    let samples = thinned(&record.run.samples, CURVE_POINTS);
    Curve {
        axial_strain: each(&samples, |s| s.axial),
        stress: each(&samples, |s| s.stress),
        lateral_strain: each(&samples, |s| s.lateral),
        volumetric_strain: each(&samples, |s| s.axial - s.lateral),
        cracks: each(&samples, |s| s.cracks),
        speed: (pace == Pace::Adaptive).then(|| each(&samples, |s| s.speed)),
    }
}

fn energies(energies: &[(f64, Energy)]) -> Energies {
    let of = |pick: fn(&Energy) -> f64| each(energies, |(_, energy)| pick(energy));
    Energies {
        axial_strain: each(energies, |(strain, _)| *strain),
        boundary: of(|e| e.boundary),
        kinetic: of(|e| e.kinetic),
        spring: of(|e| e.spring),
        bond: of(|e| e.bond),
        broken: of(|e| e.broken),
        slip: of(|e| e.slip),
        damping: of(|e| e.damping),
    }
}

fn cracks<S: Space>(cracks: &[CrackEvent<S>], material: &Material) -> Cracks {
    let mode = |crack: &CrackEvent<S>| match crack.mode {
        Mode::Tension => CrackMode::Tension,
        Mode::Shear => CrackMode::Shear,
    };
    let group = |crack: &CrackEvent<S>| {
        let [a, b] = crack.groups;
        material.contact(a, b).map_or_else(String::new, |(name, _)| name.to_owned())
    };
    Cracks {
        axial_strain: each(cracks, |crack| crack.strain),
        mode: each(cracks, mode),
        group: each(cracks, group),
        position: rows(cracks, |crack| crack.position),
        normal: rows(cracks, |crack| crack.normal),
        size: each(cracks, |crack| crack.size),
    }
}

/// The interfaces of the cracks, and how much of each is broken from each crack on.
fn interfaces<S: Space>(cracks: &[CrackEvent<S>]) -> Interfaces {
    let mut broken: BTreeMap<[usize; 2], usize> = BTreeMap::new();
    let damage = |crack: &CrackEvent<S>| {
        let count = broken.entry(crack.balls).or_default();
        *count += 1;
        *count as f64 / f64::from(crack.elements)
    };
    Interfaces {
        first: each(cracks, |crack| crack.balls[0]),
        second: each(cracks, |crack| crack.balls[1]),
        element: each(cracks, |crack| crack.element as usize),
        elements: each(cracks, |crack| crack.elements as usize),
        contact: rows(cracks, |crack| crack.contact),
        damage: cracks.iter().map(damage).collect(),
    }
}

/// Columns with a vector of every crack.
fn rows<S: Space>(cracks: &[CrackEvent<S>], pick: impl Fn(&CrackEvent<S>) -> Vector<S>) -> Array2<f64> {
    Array2::from_shape_fn((cracks.len(), S::DIMENSION), |(crack, axis)| pick(&cracks[crack]).at(axis))
}

fn states<S: Space>(snapshots: &[Snapshot<S>]) -> States {
    States {
        axial_strain: each(snapshots, |s| s.strain),
        stress: each(snapshots, |s| s.stress),
        cracks: each(snapshots, |s| s.cracks),
    }
}

/// Centres of the discs in each state.
fn centres<S: Space>(snapshots: &[Snapshot<S>]) -> Array3<f64> {
    let discs = snapshots.first().map_or(0, |s| s.state.centres.len());
    Array3::from_shape_fn((snapshots.len(), discs, S::DIMENSION), |(state, disc, axis)| {
        snapshots[state].state.centres[disc].at(axis)
    })
}

/// Forces in single precision (their low bytes are zero and take no room in the file): seven digits are plenty, and at
/// 48,000 contacts and four states the table takes about 2 MB instead of 4.
fn forces<S: Space>(snapshots: &[Snapshot<S>]) -> Forces {
    let all: Vec<(usize, &Link)> =
        snapshots.iter().enumerate().flat_map(|(k, s)| s.state.forces.iter().map(move |link| (k, link))).collect();
    Forces {
        state: each(&all, |(state, _)| *state),
        first: each(&all, |(_, link)| link.ends[0]),
        second: each(&all, |(_, link)| link.ends[1]),
        normal_force: each(&all, |(_, link)| f64::from(link.normal as f32)),
        shear_force: each(&all, |(_, link)| f64::from(link.shear as f32)),
        bonded: each(&all, |(_, link)| link.bonded),
    }
}
