//! The record of a test as it is stored: kind `run`.

use super::super::rows::response_table;
use crate::artifact::{Array, Artifact, ArtifactKind, Group, Node, Table, Values};
use dem::loading::crack::{CrackEvent, CrackGroup};
use dem::loading::curve::{Sample, thinned};
use dem::loading::kind::TestKind;
use dem::loading::record::TestRecord;
use dem::loading::settings::Loading;
use dem::loading::snapshot::Snapshot;
use dem::loading::validity::Check;
use dem::measure::{Energy, Link, Mode};
use dem::space::Tuple;
use dem::{Space, Vector};

/// Names of the coordinates of a crack, and of its normal.
const AXES: [&str; 3] = ["x", "y", "z"];
const NORMALS: [&str; 3] = ["normal_x", "normal_y", "normal_z"];

/// Points of the stored curve.
const CURVE_POINTS: usize = 400;

/// The storable form of a record.
pub(super) fn artifact<S: Space>(record: &TestRecord<S>, test: &Loading) -> Artifact {
    let failure = record.run.failure.map_or_else(String::new, |failure| failure.to_string());
    let mut root = Group::new()
        .with("failure", Node::Text(failure))
        .with("validity", Node::Text(record.validity()))
        .with("warnings", Node::Array(texts(warnings(record))))
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

fn responses<S: Space>(record: &TestRecord<S>, kind: TestKind) -> Vec<(&'static str, f64, &'static str)> {
    kind.responses().iter().map(|response| (response.name, (response.read)(&record.values), response.unit)).collect()
}

/// Warnings on the rate of loading, and why the run is not valid.
fn warnings<S: Space>(record: &TestRecord<S>) -> Vec<String> {
    let rate = record.judgement.warnings().into_iter().map(|warning| warning.to_string());
    rate.chain(record.invalid().map(|check| format!("not valid: {check}"))).collect()
}

fn checks<S: Space>(record: &TestRecord<S>) -> Table {
    let checks = &record.checks;
    let words = |pick: fn(&Check) -> &'static str| checks.iter().map(|check| pick(check).to_owned()).collect();
    let flag = |pick: fn(&Check) -> bool| checks.iter().map(|check| i64::from(pick(check))).collect();
    table("whether the specimen failed as the test supposes, and at rest enough")
        .texts_column("check", "", words(|check| check.reason.name()))
        .reals_column("value", "", "in the unit beside it", checks.iter().map(|check| check.value).collect())
        .reals_column("bound", "", "in the unit beside it", checks.iter().map(|check| check.bound).collect())
        .texts_column("unit", "", words(|check| check.reason.unit()))
        .ints_column("met", "1 when on the right side of the bound", flag(|check| check.met))
        .ints_column(
            "decisive",
            "1 when the run is not valid unless it is met",
            flag(|check| check.reason.invalidates()),
        )
        .texts_column("meaning", "what the value is", words(|check| check.reason.about()))
        .texts_column("remedy", "what to do when it is not met", words(|check| check.reason.remedy()))
}

fn texts(texts: Vec<String>) -> Array {
    Array { shape: vec![texts.len()], unit: String::new(), about: String::new(), values: Values::Texts(texts) }
}

fn table(about: &str) -> Table {
    Table { about: about.to_owned(), columns: Vec::new() }
}

fn judgement<S: Space>(record: &TestRecord<S>) -> Table {
    let j = &record.judgement;
    let rows = [
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
    table("numbers by which the run is judged")
        .texts_column("quantity", "", rows.iter().map(|row| row.0.to_owned()).collect())
        .reals_column("value", "", "in the unit beside it", rows.iter().map(|row| row.1).collect())
        .texts_column("unit", "", rows.iter().map(|row| row.2.to_owned()).collect())
}

fn curve<S: Space>(record: &TestRecord<S>) -> Table {
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

fn cracks<S: Space>(cracks: &[CrackEvent<S>]) -> Table {
    let of = |pick: fn(&CrackEvent<S>) -> f64| cracks.iter().map(pick).collect::<Vec<f64>>();
    let words = |pick: fn(&CrackEvent<S>) -> &'static str| cracks.iter().map(|c| pick(c).to_owned()).collect();
    let axis = |pick: fn(&CrackEvent<S>) -> Vector<S>, k: usize| {
        cracks.iter().map(|crack| pick(crack).at(k)).collect::<Vec<f64>>()
    };
    let mut found = table("broken bonds in the order of breaking")
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
        );
    for (k, name) in AXES.iter().enumerate().take(S::DIMENSION) {
        found = found.reals_column(name, "m", "contact point", axis(|c| c.position, k));
    }
    for (k, name) in NORMALS.iter().enumerate().take(S::DIMENSION) {
        let about = "normal of the contact; the crack lies across it";
        found = found.reals_column(name, "", about, axis(|c| c.normal, k));
    }
    found.reals_column("size", "m", "length of the crack", of(|c| c.size))
}

fn snapshots<S: Space>(snapshots: &[Snapshot<S>]) -> Group {
    let of = |pick: fn(&Snapshot<S>) -> f64| snapshots.iter().map(pick).collect::<Vec<f64>>();
    let states = table("states kept")
        .reals_column("axial_strain", "", "", of(|s| s.strain))
        .reals_column("stress", "Pa", "", of(|s| s.stress))
        .ints_column("cracks", "broken bonds so far", snapshots.iter().map(|s| s.cracks as i64).collect());
    let discs = snapshots.first().map_or(0, |s| s.state.centres.len());
    let centres = Array {
        shape: vec![snapshots.len(), discs, S::DIMENSION],
        unit: "m".to_owned(),
        about: "centres of the discs in each state".to_owned(),
        values: Values::Reals(snapshots.iter().flat_map(coordinates).collect()),
    };
    Group::new().with("states", Node::Table(states)).with("centres", Node::Array(centres))
}

/// Coordinates of all centres, one after the other.
fn coordinates<S: Space>(snapshot: &Snapshot<S>) -> Vec<f64> {
    snapshot.state.centres.iter().flat_map(|x| (0..S::DIMENSION).map(|k| x.at(k))).collect()
}

/// Forces in single precision (their low bytes are zero and take no room in the file): seven digits are plenty, and at
/// 48,000 contacts and four states the table takes about 2 MB instead of 4.
fn forces<S: Space>(snapshots: &[Snapshot<S>]) -> Table {
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
