//! The record of a test as it is stored: kind `run`.

use super::super::rows::response_table;
use crate::artifact::{Array, Artifact, Group, Node, Table, Values};
use crate::dem::genesis::specimen::Specimen;
use crate::dem::measure::Mode;
use crate::dem::test::curve::thinned;
use crate::dem::test::loading::{CrackEvent, CrackGroup};
use crate::dem::test::snapshot::Snapshot;
use crate::dem::test::uniaxial::{CompressionRecord, rate_warnings};

/// Points of the stored curve.
const CURVE_POINTS: usize = 400;

/// The storable form of a record.
pub(super) fn artifact(record: &CompressionRecord, specimen: &Specimen) -> Artifact {
    let values = &record.values;
    let responses = [
        ("UCS", values.strength, "Pa"),
        ("E", values.modulus_tangent, "Pa"),
        ("nu", values.poisson_secant, ""),
        ("E_secant", values.modulus_secant, "Pa"),
        ("nu_tangent", values.poisson_tangent, ""),
        ("peak_strain", values.peak_strain, ""),
        ("sigma_ci", values.crack_initiation, "Pa"),
        ("sigma_cd", values.crack_damage, "Pa"),
    ];
    let failure = record.run.failure.map_or_else(String::new, |failure| failure.to_string());
    let root = Group::new()
        .with("failure", Node::Text(failure))
        .with("warnings", Node::Array(texts(warnings(record, specimen))))
        .with("responses", Node::Table(response_table(&responses)))
        .with("judgement", Node::Table(judgement(record)))
        .with("curve", Node::Table(curve(record)))
        .with("cracks", Node::Table(cracks(&record.run.cracks)))
        .with("snapshots", Node::Group(snapshots(&record.run.snapshots)));
    Artifact::new("run", 1, root)
}

fn warnings(record: &CompressionRecord, specimen: &Specimen) -> Vec<String> {
    let judgement = &record.judgement;
    let height = specimen.region.extent()[1];
    let speed = 0.5 * judgement.strain_rate * height;
    let warnings = rate_warnings(speed, height, judgement.time_step, speed / judgement.speed_ratio);
    warnings.iter().map(ToString::to_string).collect()
}

fn texts(texts: Vec<String>) -> Array {
    Array { shape: vec![texts.len()], unit: String::new(), about: String::new(), values: Values::Texts(texts) }
}

fn table(about: &str) -> Table {
    Table { about: about.to_owned(), columns: Vec::new() }
}

fn judgement(record: &CompressionRecord) -> Table {
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
        ("difference of the platen forces / mean", j.platen_imbalance, ""),
    ];
    table("numbers by which the run is judged")
        .texts_column("quantity", "", rows.iter().map(|row| row.0.to_owned()).collect())
        .reals_column("value", "", "in the unit beside it", rows.iter().map(|row| row.1).collect())
        .texts_column("unit", "", rows.iter().map(|row| row.2.to_owned()).collect())
}

fn curve(record: &CompressionRecord) -> Table {
    let samples = thinned(&record.run.samples, CURVE_POINTS);
    let of = |pick: fn(&crate::dem::test::curve::Sample) -> f64| samples.iter().map(pick).collect::<Vec<f64>>();
    table("stress and strains at even axial strains")
        .reals_column("axial_strain", "", "shortening positive", of(|s| s.axial))
        .reals_column("stress", "Pa", "compression positive", of(|s| s.stress))
        .reals_column("lateral_strain", "", "extension positive", of(|s| s.lateral))
        .reals_column("volumetric_strain", "", "contraction positive", of(|s| s.axial - s.lateral))
        .ints_column("cracks", "broken bonds so far", samples.iter().map(|s| s.cracks as i64).collect())
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
    let discs = snapshots.first().map_or(0, |s| s.centres.len());
    let centres = Array {
        shape: vec![snapshots.len(), discs, 2],
        unit: "m".to_owned(),
        about: "centres of the discs in each state".to_owned(),
        values: Values::Reals(snapshots.iter().flat_map(|s| s.centres.as_flattened().iter().copied()).collect()),
    };
    Group::new().with("states", Node::Table(states)).with("centres", Node::Array(centres))
}
