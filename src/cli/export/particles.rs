//! `--to particles`: a specimen as plain lists that any code can read, and for a run its microparameters too. CSV, SI
//! units in the heads, numbers of discs and clumps from 0; the specimen as it stands before loading, free of force.
//!
//! | file | a row for each |
//! |---|---|
//! | `NAME.particles.csv` | disc: place, radius, group, clump, and the density of mortar; the mass of pebbles is that of their clump |
//! | `NAME.clumps.csv` | rigid clump: mass and moment of inertia per metre of thickness, centre of mass |
//! | `NAME.groups.csv` | contact group: microparameters of its spring and bond (of a run) |
//! | `NAME.contacts.csv` | contact: its discs, group, gap, and whether it is bonded (of a run) |
//! | `NAME.columns.csv` | column of these files: unit and meaning |

use super::File;
use super::bodies::{Contact, GROUPS, contacts};
use crate::artifact::Table;
use crate::cli::show::csv_text;
use dem::genesis::specimen::Specimen;
use std::collections::BTreeMap;

/// Parameters of a run by their paths in its task, as they stand there.
pub(super) type Parameters = BTreeMap<String, String>;

/// Columns of the groups: name, unit, meaning, the parameter's name in a task.
const MICRO: [(&str, &str, &str, &str); 5] = [
    ("Ec", "Pa", "modulus of spring and bond", "modulus"),
    ("kn_ks", "", "normal over shear stiffness of spring and bond", "stiffness_ratio"),
    ("sigma_c", "Pa", "tensile strength of the bond", "tensile_strength"),
    ("tau_c", "Pa", "shear strength of the bond", "shear_strength"),
    ("mu", "", "friction", "friction"),
];

/// The same for what all bonds have in common.
const BONDING: [(&str, &str, &str, &str); 5] = [
    ("bond_gap", "", "bonds form at gaps up to this share of the mean radius", "gap"),
    ("bond_radius", "", "radius of the bond over the smaller radius", "radius_multiplier"),
    ("moment_factor", "", "share of the moment in the bond's stresses", "moment_factor"),
    ("friction_angle", "rad", "of the bond", "friction_angle"),
    ("deviation", "", "standard deviation of the strengths over their mean", "deviation"),
];

/// The files; without parameters, those of the specimen alone.
pub(super) fn files(name: &str, specimen: &Specimen, parameters: Option<&Parameters>) -> Result<Vec<File>, String> {
    let gap = parameters.map(|p| number(p, "bonding", "gap")).transpose()?;
    let margin = gap.unwrap_or(0.0) * specimen.mean_radius();
    let contacts = contacts(specimen, margin);
    let mut tables = vec![("particles", particles(specimen)), ("clumps", clumps(specimen))];
    if let Some(parameters) = parameters {
        tables.push(("groups", groups(parameters)?));
    }
    tables.push(("contacts", contact_table(&contacts, parameters.is_some())));
    tables.push(("columns", columns(&tables)));
    Ok(tables.iter().map(|(what, table)| (format!("{name}.{what}.csv"), csv_text(table).into_bytes())).collect())
}

fn numbered(about: &str, count: usize) -> Table {
    let numbers = (0..count).map(|i| i as i64).collect();
    Table::default().ints_column("id", about, numbers)
}

fn particles(specimen: &Specimen) -> Table {
    let clump = specimen.clump_of_balls();
    let group = |clump: &Option<usize>| if clump.is_some() { "aggregate" } else { "mortar" }.to_owned();
    let density = |clump: &Option<usize>| if clump.is_some() { f64::NAN } else { specimen.density };
    numbered("number of the disc", clump.len())
        .reals_column("x", "m", "centre, across the load, from the middle of the specimen", axis(&specimen.centres, 0))
        .reals_column("y", "m", "centre, along the load, from the middle of the specimen", axis(&specimen.centres, 1))
        .reals_column("radius", "m", "radius", specimen.radii.clone())
        .texts_column("group", "mortar, or aggregate for pebbles of a clump", clump.iter().map(group).collect())
        .ints_column("clump", "its clump, -1 for none", clump.iter().map(|c| c.map_or(-1, |c| c as i64)).collect())
        .reals_column("density", "kg/m^3", "of mortar; empty for pebbles", clump.iter().map(density).collect())
}

fn axis(points: &[[f64; 2]], axis: usize) -> Vec<f64> {
    points.iter().map(|point| point[axis]).collect()
}

fn clumps(specimen: &Specimen) -> Table {
    let clumps = &specimen.clumps;
    let centres: Vec<[f64; 2]> = clumps.iter().map(|clump| clump.centre).collect();
    numbered("number of the clump", clumps.len())
        .ints_column("pebbles", "discs in it", clumps.iter().map(|clump| clump.pebbles.len() as i64).collect())
        .reals_column("x", "m", "centre of mass", axis(&centres, 0))
        .reals_column("y", "m", "centre of mass", axis(&centres, 1))
        .reals_column("mass", "kg/m", "per metre of thickness", clumps.iter().map(|clump| clump.mass).collect())
        .reals_column(
            "inertia",
            "kg*m",
            "about the centre of mass, per metre of thickness",
            clumps.iter().map(|clump| clump.inertia[2][2]).collect(),
        )
}

fn contact_table(contacts: &[Contact], of_run: bool) -> Table {
    let whole = |pick: fn(&Contact) -> usize| contacts.iter().map(|c| pick(c) as i64).collect::<Vec<i64>>();
    let table = Table::default()
        .ints_column("first", "disc", whole(|c| c.ends[0]))
        .ints_column("second", "disc", whole(|c| c.ends[1]))
        .texts_column("group", "contact group", contacts.iter().map(|c| GROUPS[c.group].to_owned()).collect())
        .reals_column(
            "gap",
            "m",
            "distance of the surfaces, negative where they overlap",
            contacts.iter().map(|c| c.gap).collect(),
        );
    if !of_run {
        return table;
    }
    table.ints_column("bonded", "1 where a bond is put at the start", whole(|c| usize::from(c.group < 2)))
}

/// A number of the run's parameters.
fn number(parameters: &Parameters, group: &str, name: &str) -> Result<f64, String> {
    let path = format!("material.{group}.{name}");
    let text = parameters.get(&path).ok_or_else(|| format!("the run has no parameter `{path}`"))?;
    text.parse().map_err(|_| format!("the parameter `{path}` is no number: {text}"))
}

fn groups(parameters: &Parameters) -> Result<Table, String> {
    let word = |name: &str| {
        let text = parameters.get(&format!("material.bonding.{name}"));
        text.map(|text| text.trim_matches('"').to_owned()).ok_or_else(|| format!("the run has no `bonding.{name}`"))
    };
    let (kind, convention) = (word("kind")?, word("convention")?);
    let bonds = GROUPS.map(|group| if group == "aggregate" { "none".to_owned() } else { kind.clone() });
    let mut table = Table::default()
        .texts_column("group", "contact group", GROUPS.map(str::to_owned).to_vec())
        .texts_column("first", "group of one disc", ["mortar", "mortar", "aggregate"].map(str::to_owned).to_vec())
        .texts_column("second", "group of the other", ["mortar", "aggregate", "aggregate"].map(str::to_owned).to_vec())
        .texts_column("bond", "parallel, contact or none", bonds.to_vec());
    for (name, unit, about, path) in MICRO {
        let value = |group: &str| {
            let lacks = group == "aggregate" && path.ends_with("strength");
            if lacks { Ok(f64::NAN) } else { number(parameters, group, path) }
        };
        let values = GROUPS.iter().map(|group| value(group)).collect::<Result<Vec<f64>, String>>()?;
        table = table.reals_column(name, unit, about, values);
    }
    for (name, unit, about, path) in BONDING {
        let value = number(parameters, "bonding", path)?;
        table = table.reals_column(name, unit, about, vec![value, value, f64::NAN]);
    }
    Ok(table.texts_column("convention", "how a modulus becomes a stiffness", vec![convention; GROUPS.len()]))
}

/// What the columns of the files mean.
fn columns(tables: &[(&'static str, Table)]) -> Table {
    let all = tables.iter().flat_map(|(file, table)| table.columns.iter().map(move |column| (*file, column)));
    let all: Vec<_> = all.collect();
    let texts = |pick: &dyn Fn(usize) -> String| (0..all.len()).map(pick).collect::<Vec<String>>();
    Table::default()
        .texts_column("file", "", texts(&|i| all[i].0.to_owned()))
        .texts_column("column", "", texts(&|i| all[i].1.name.clone()))
        .texts_column("unit", "", texts(&|i| all[i].1.unit.clone()))
        .texts_column("meaning", "", texts(&|i| all[i].1.about.clone()))
}
