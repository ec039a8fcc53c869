//! The record of a test as it is stored: kind `run`.

use super::super::rows::response_table;
use crate::artifact::{Array, Artifact, ArtifactKind, Group, Node, Table, Values};
use dem::loading::crack::{CrackEvent, CrackGroup};
use dem::loading::curve::{Sample, thinned};
use dem::loading::drive::{Loading, TestKind, TestRecord};
use dem::loading::snapshot::Snapshot;
use dem::measure::{Energy, Link, Mode};

/// Points of the stored curve.
const CURVE_POINTS: usize = 400;

/// The storable form of a record.
pub(super) fn artifact(record: &TestRecord, test: &Loading) -> Artifact {
    let failure = record.run.failure.map_or_else(String::new, |failure| failure.to_string());
    let mut root = Group::new()
        .with("failure", Node::Text(failure))
        .with("warnings", Node::Array(texts(warnings(record, test))))
        .with("responses", Node::Table(response_table(&responses(record, test.kind))))
        .with("judgement", Node::Table(judgement(record)))
        .with("checks", Node::Table(checks(record)))
        .with("curve", Node::Table(curve(record)))
        .with("energies", Node::Table(energies(&record.run.energies)))
        .with("cracks", Node::Table(cracks(&record.run.cracks)))
        .with("snapshots", Node::Group(snapshots(&record.run.snapshots)));
    if test.rule.forces {
        root.put("forces", Node::Table(forces(&record.run.snapshots)));
    }
    Artifact::of(ArtifactKind::RUN, root)
}

fn responses(record: &TestRecord, kind: TestKind) -> Vec<(&'static str, f64, &'static str)> {
    let values = &record.values;
    let strength = match kind {
        TestKind::Uniaxial => ("UCS", values.strength, "Pa"),
        TestKind::Brazilian | TestKind::Tension => ("sigma_t", values.strength, "Pa"),
    };
    let mut responses =
        vec![strength, ("peak_strain", values.peak_strain, ""), ("sigma_ci", values.crack_initiation, "Pa")];
    if kind != TestKind::Brazilian {
        responses.extend([
            ("E", values.modulus_tangent, "Pa"),
            ("nu", values.poisson_secant, ""),
            ("E_secant", values.modulus_secant, "Pa"),
            ("nu_tangent", values.poisson_tangent, ""),
        ]);
    }
    if kind == TestKind::Uniaxial {
        responses.push(("sigma_cd", values.crack_damage, "Pa"));
    }
    responses
}

/// Warnings on the rate of loading, and checks that are not met.
fn warnings(record: &TestRecord, test: &Loading) -> Vec<String> {
    let rate = record.judgement.warnings(test.speed).into_iter().map(|warning| warning.to_string());
    rate.chain(unmet(record)).collect()
}

/// Checks that are not met.
pub(super) fn unmet(record: &TestRecord) -> impl Iterator<Item = String> + '_ {
    let unmet = record.checks.iter().filter(|check| !check.met);
    unmet.map(|c| format!("{} is {:.3}, the bound is {:.3}: the result is not valid", c.name, c.value, c.bound))
}

fn checks(record: &TestRecord) -> Table {
    let checks = &record.checks;
    table("whether the specimen failed as the test supposes")
        .texts_column("check", "", checks.iter().map(|check| check.name.to_owned()).collect())
        .reals_column("value", "", "", checks.iter().map(|check| check.value).collect())
        .reals_column("bound", "", "", checks.iter().map(|check| check.bound).collect())
        .ints_column("met", "1 when within the bound", checks.iter().map(|check| i64::from(check.met)).collect())
}

fn texts(texts: Vec<String>) -> Array {
    Array { shape: vec![texts.len()], unit: String::new(), about: String::new(), values: Values::Texts(texts) }
}

fn table(about: &str) -> Table {
    Table { about: about.to_owned(), columns: Vec::new() }
}

fn judgement(record: &TestRecord) -> Table {
    let j = &record.judgement;
    let rows = [
        ("time step", j.time_step, "s"),
        ("steps", j.steps as f64, ""),
        ("strain rate", j.strain_rate, "1/s"),
        ("strain per step", j.strain_per_step, ""),
        ("platen speed / wave speed", j.speed_ratio, ""),
        ("inertial number at the peak", j.inertial_number, ""),
        ("coordination (2 bonds / disc)", j.coordination, ""),
        ("side gauges", j.gauges as f64, ""),
        ("unbalanced force / contact force at the end", j.unbalanced, ""),
    ];
    table("numbers by which the run is judged")
        .texts_column("quantity", "", rows.iter().map(|row| row.0.to_owned()).collect())
        .reals_column("value", "", "in the unit beside it", rows.iter().map(|row| row.1).collect())
        .texts_column("unit", "", rows.iter().map(|row| row.2.to_owned()).collect())
}

fn curve(record: &TestRecord) -> Table {
    let samples = thinned(&record.run.samples, CURVE_POINTS);
    let of = |pick: fn(&Sample) -> f64| samples.iter().map(pick).collect::<Vec<f64>>();
    table("stress and strains at even axial strains")
        .reals_column("axial_strain", "", "shortening positive", of(|s| s.axial))
        .reals_column("stress", "Pa", "compression positive", of(|s| s.stress))
        .reals_column("lateral_strain", "", "extension positive", of(|s| s.lateral))
        .reals_column("volumetric_strain", "", "contraction positive", of(|s| s.axial - s.lateral))
        .ints_column("cracks", "broken bonds so far", samples.iter().map(|s| s.cracks as i64).collect())
}

fn energies(energies: &[(f64, Energy)]) -> Table {
    let of = |pick: fn(&Energy) -> f64| energies.iter().map(|(_, energy)| pick(energy)).collect::<Vec<f64>>();
    table("energies per metre of thickness since the start of loading")
        .reals_column("axial_strain", "", "", energies.iter().map(|(strain, _)| *strain).collect())
        .reals_column("boundary", "J", "given by platens or grips", of(|e| e.boundary))
        .reals_column("kinetic", "J", "with the masses that move the bodies", of(|e| e.kinetic))
        .reals_column("spring", "J", "stored in linear springs", of(|e| e.spring))
        .reals_column("bond", "J", "stored in bonds", of(|e| e.bond))
        .reals_column("broken", "J", "lost with the bonds that broke", of(|e| e.broken))
        .reals_column("slip", "J", "spent by friction", of(|e| e.slip))
        .reals_column("damping", "J", "spent by local damping", of(|e| e.damping))
}

fn cracks(cracks: &[CrackEvent]) -> Table {
    let of = |pick: fn(&CrackEvent) -> f64| cracks.iter().map(pick).collect::<Vec<f64>>();
    let words = |pick: fn(&CrackEvent) -> &'static str| cracks.iter().map(|c| pick(c).to_owned()).collect();
    table("broken bonds in the order of breaking")
        .reals_column("axial_strain", "", "of the specimen when it broke", of(|c| c.strain))
        .texts_column(
            "mode",
            "tension or shear",
            words(|c| match c.mode {
                Mode::Tension => "tension",
                Mode::Shear => "shear",
            }),
        )
        .texts_column(
            "group",
            "mortar or interface",
            words(|c| match c.group {
                CrackGroup::Mortar => "mortar",
                CrackGroup::Interface => "interface",
            }),
        )
        .reals_column("x", "m", "place", of(|c| c.position[0]))
        .reals_column("y", "m", "place", of(|c| c.position[1]))
        .reals_column("normal_x", "", "normal of the contact; the crack lies across it", of(|c| c.normal[0]))
        .reals_column("normal_y", "", "normal of the contact; the crack lies across it", of(|c| c.normal[1]))
        .reals_column("size", "m", "length of the crack", of(|c| c.size))
}

fn snapshots(snapshots: &[Snapshot]) -> Group {
    let of = |pick: fn(&Snapshot) -> f64| snapshots.iter().map(pick).collect::<Vec<f64>>();
    let states = table("states kept")
        .reals_column("axial_strain", "", "", of(|s| s.strain))
        .reals_column("stress", "Pa", "", of(|s| s.stress))
        .ints_column("cracks", "broken bonds so far", snapshots.iter().map(|s| s.cracks as i64).collect());
    let discs = snapshots.first().map_or(0, |s| s.state.centres.len());
    let centres = Array {
        shape: vec![snapshots.len(), discs, 2],
        unit: "m".to_owned(),
        about: "centres of the discs in each state".to_owned(),
        values: Values::Reals(snapshots.iter().flat_map(|s| s.state.centres.as_flattened().iter().copied()).collect()),
    };
    Group::new().with("states", Node::Table(states)).with("centres", Node::Array(centres))
}

/// Forces in single precision (their low bytes are zero and take no room in the file): seven digits are plenty, and at
/// 48,000 contacts and four states the table takes about 2 MB instead of 4.
fn forces(snapshots: &[Snapshot]) -> Table {
    let all: Vec<(usize, &Link)> =
        snapshots.iter().enumerate().flat_map(|(k, s)| s.state.forces.iter().map(move |link| (k, link))).collect();
    let single =
        |pick: fn(&Link) -> f64| all.iter().map(|(_, link)| f64::from(pick(link) as f32)).collect::<Vec<f64>>();
    let whole = |pick: fn(&(usize, &Link)) -> usize| all.iter().map(|row| pick(row) as i64).collect::<Vec<i64>>();
    table("forces between discs in each state kept, per metre of thickness; single precision")
        .ints_column("state", "row of snapshots/states, from 0", whole(|(state, _)| *state))
        .ints_column("first", "disc, from 0", whole(|(_, link)| link.ends[0]))
        .ints_column("second", "disc, from 0", whole(|(_, link)| link.ends[1]))
        .reals_column("normal_force", "N", "compression positive", single(|link| link.normal))
        .reals_column("shear_force", "N", "size", single(|link| link.shear))
        .ints_column("bonded", "1 while a bond holds the two", whole(|(_, link)| usize::from(link.bonded)))
}
