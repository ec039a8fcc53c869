//! `--to particles`: a specimen as plain lists that any code can read, and for a run its microparameters too. CSV, SI
//! units in the heads, indices of balls and clumps from 0; the specimen as it stands before loading, free of force.
//!
//! | file | a row for each |
//! |---|---|
//! | `NAME.particles.csv` | ball (in the plane a disc): centre, radius, group, clump, and the density of single balls; the mass of pebbles is that of their clump |
//! | `NAME.clumps.csv` | rigid clump: mass, inertia (in the plane per metre of thickness) and centre of mass |
//! | `NAME.groups.csv` | contact group: microparameters of its spring and bond (of a run) |
//! | `NAME.contacts.csv` | contact: its balls, group, gap, and whether it is bonded (of a run); its joint, the state and strengths drawn for it (of a run with flat or smooth joints) |
//! | `NAME.fissures.csv` | fissure of a run: set, middle, normal, size |
//! | `NAME.pfc.csv` | method or property of a contact model of PFC (of a run) |
//! | `NAME.columns.csv` | column of these files: unit and meaning |

use super::bodies::{Contact, contacts};
use super::joints::Joints;
use super::pfc;
use super::{File, csv_text};
use crate::artifact::Table;
use crate::artifact::run::Fissures as Laid;
use dem::genesis::clump::Clump;
use dem::genesis::specimen::Specimen;
use dem::loading::fissure::Fissure;
use dem::loading::material::{BondKind, Contact as Values, Material};
use dem::parameter::{Parameter, Quantity};
use dem::space::Tuple;
use dem::{Space, Vector};
use math::elementary::atan2;
use ndarray::Array2;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};
use std::collections::BTreeMap;

/// Parameters of a run by their paths in its task, as they stand there.
pub type Parameters = BTreeMap<String, String>;

/// What is known of a run on a specimen: its parameters and its seed.
#[derive(Clone, Debug, Default)]
pub struct Setting {
    /// Its parameters.
    pub parameters: Parameters,
    /// Its seed.
    pub seed: u64,
    /// The fissures that it laid, those of files and networks among them.
    pub fissures: Option<Laid>,
}

impl Setting {
    /// Its microparameters.
    ///
    /// # Errors
    /// They cannot be read.
    pub fn material(&self) -> Result<Material, String> {
        let mut material = material(&self.parameters)?;
        let Some(laid) = &self.fissures else { return Ok(material) };
        for (set, fissures) in material.fissures.iter_mut().enumerate() {
            let rows = (0..laid.set.len()).filter(|&row| laid.set[row] == set + 1);
            (fissures.list, fissures.network) = (rows.map(|row| fissure(laid, row)).collect(), None);
        }
        Ok(material)
    }
}

/// What the files say of groups: their names, and for a run the values of their contacts and its joints.
struct Named {
    groups: Vec<String>,
    material: Option<Material>,
    joints: Option<Joints>,
}

impl Named {
    fn of<S: Space>(specimen: &Specimen<S>, setting: Option<&Setting>) -> Result<Self, String> {
        let material = setting.map(Setting::material).transpose()?;
        let joints = match (&material, setting) {
            (Some(material), Some(setting)) => Joints::of(specimen, material, setting.seed)?,
            (None, _) | (_, None) => None,
        };
        let own = material.as_ref().map(|material| material.groups.clone());
        Ok(Self { groups: own.unwrap_or_else(|| specimen.group_names.clone()), material, joints })
    }

    fn group(&self, number: usize) -> String {
        self.groups.get(number).cloned().unwrap_or_default()
    }

    /// The name of the contacts of two groups, and whether they are bonded.
    fn contact(&self, [a, b]: [usize; 2]) -> (String, bool) {
        let found = self.material.as_ref().and_then(|material| material.contact(a, b));
        match found {
            Some((name, contact)) => (name.to_owned(), contact.bond != BondKind::None),
            None if a == b => (self.group(a), false),
            None => (format!("{}-{}", self.group(a), self.group(b)), false),
        }
    }
}

/// A fissure as it was laid.
fn fissure(laid: &Laid, row: usize) -> Fissure {
    let of = |all: &Array2<f64>| -> [f64; 3] { std::array::from_fn(|k| all.get([row, k]).copied().unwrap_or(0.0)) };
    let ([x, y, z], size) = (of(&laid.normal), laid.size[row]);
    // In the plane the dip turns through all quadrants and has no azimuth.
    let (dip, direction) =
        if laid.normal.ncols() == 2 { (atan2(x, y), 0.0) } else { (atan2((x * x + z * z).sqrt(), y), atan2(z, x)) };
    Fissure { centre: of(&laid.position), dip, direction, length: size.is_finite().then_some(size) }
}

/// The microparameters of a run from the parameters of its task.
fn material(parameters: &Parameters) -> Result<Material, String> {
    let mut root = Value::Null;
    for (path, text) in parameters {
        let Some(path) = path.strip_prefix("material.") else { continue };
        let value: Value =
            serde_json::from_str(text).map_err(|e| format!("the parameter `{path}` cannot be read: {e}"))?;
        let place = place(&mut root, path).ok_or_else(|| format!("the parameter `{path}` lies below a value"))?;
        *place = value;
    }
    Material::deserialize(&root).map_err(|e| format!("the run's material cannot be read: {e}"))
}

/// The place of a path such as `fissures[0].friction` in a tree of tables and lists, which grows towards it.
fn place<'v>(root: &'v mut Value, path: &str) -> Option<&'v mut Value> {
    let mut place = root;
    for step in path.split('.') {
        let (name, indices) = step.split_once('[').unwrap_or((step, ""));
        if place.is_null() {
            *place = Value::Object(Map::new());
        }
        place = place.as_object_mut()?.entry(name).or_insert(Value::Null);
        for index in indices.split(['[', ']']).filter(|index| !index.is_empty()) {
            let index: usize = index.parse().ok()?;
            if place.is_null() {
                *place = Value::Array(Vec::new());
            }
            let list = place.as_array_mut()?;
            // Indices of a task text rise without gaps.
            if index == list.len() {
                list.push(Value::Null);
            }
            place = list.get_mut(index)?;
        }
    }
    Some(place)
}

/// The files; without the setting of a run, those of the specimen alone.
///
/// # Errors
/// The parameters of the run cannot be read.
pub fn files<S: Space>(name: &str, specimen: &Specimen<S>, setting: Option<&Setting>) -> Result<Vec<File>, String> {
    let named = Named::of(specimen, setting)?;
    let margin = named.material.as_ref().map_or(0.0, |material| material.gap) * specimen.mean_radius();
    let contacts = contacts(specimen, margin);
    let mut tables = vec![("particles", particles(specimen, &named)), ("clumps", clumps(specimen))];
    if let Some(material) = &named.material {
        tables.push(("groups", groups(material)));
        tables.push(("pfc", pfc::properties(material, S::DIMENSION)));
        tables.extend(named.joints.as_ref().and_then(|joints| Some(("fissures", joints.fissures(S::DIMENSION)?))));
    }
    tables.push(("contacts", contact_table(&contacts, &named)));
    tables.push(("columns", columns(&tables)));
    Ok(tables.iter().map(|(what, table)| (format!("{name}.{what}.csv"), csv_text(table).into_bytes())).collect())
}

fn numbered(about: &str, count: usize) -> Table {
    let numbers = (0..count).map(|i| i as i64).collect();
    Table::default().ints_column("id", about, numbers)
}

fn particles<S: Space>(specimen: &Specimen<S>, named: &Named) -> Table {
    let clump = specimen.clump_of_balls();
    let density = |clump: &Option<usize>| if clump.is_some() { f64::NAN } else { specimen.density };
    let table = numbered("index of the ball", clump.len());
    positions::<S>(table, "centre, from the middle of the specimen,", &specimen.centres)
        .reals_column("radius", "m", "radius", specimen.radii.clone())
        .texts_column(
            "group",
            "group of the ball",
            specimen.groups.iter().map(|group| named.group(usize::from(group.0))).collect(),
        )
        .ints_column("clump", "its clump, -1 for none", clump.iter().map(|c| c.map_or(-1, |c| c as i64)).collect())
        .reals_column(
            "density",
            "kg/m^3",
            "of balls that are no pebbles; empty for pebbles",
            clump.iter().map(density).collect(),
        )
}

/// Adds the coordinates x, y and, in space, z; the load acts along y.
fn positions<S: Space>(table: Table, about: &str, points: &[Vector<S>]) -> Table {
    let names = ["x", "y", "z"].into_iter().take(S::DIMENSION).enumerate();
    names.fold(table, |table, (axis, name)| {
        let about = format!("{about} {} the load", if axis == 1 { "along" } else { "across" });
        table.reals_column(name, "m", &about, points.iter().map(|point| point.at(axis)).collect())
    })
}

fn clumps<S: Space>(specimen: &Specimen<S>) -> Table {
    let clumps = &specimen.clumps;
    let centres: Vec<Vector<S>> = clumps.iter().map(|clump| clump.centre).collect();
    let table = numbered("index of the clump", clumps.len()).ints_column(
        "pebbles",
        "balls in it",
        clumps.iter().map(|clump| clump.pebbles.len() as i64).collect(),
    );
    let table = positions::<S>(table, "centre of mass,", &centres);
    let of = |pick: &dyn Fn(&Clump<S>) -> f64| clumps.iter().map(pick).collect::<Vec<f64>>();
    if S::DIMENSION == 2 {
        return table.reals_column("mass", "kg/m", "per metre of thickness", of(&|clump| clump.mass)).reals_column(
            "inertia",
            "kg*m",
            "about the centre of mass, per metre of thickness",
            of(&|clump| clump.inertia[2][2]),
        );
    }
    let table = table.reals_column("mass", "kg", "of the clump", of(&|clump| clump.mass));
    INERTIA.into_iter().fold(table, |table, (name, [i, j])| {
        let about = "component of the inertia about the centre of mass, in the axes of the specimen";
        table.reals_column(name, "kg*m^2", about, of(&|clump| clump.inertia[i][j]))
    })
}

/// The six components of an inertia.
const INERTIA: [(&str, [usize; 2]); 6] =
    [("Ixx", [0, 0]), ("Iyy", [1, 1]), ("Izz", [2, 2]), ("Ixy", [0, 1]), ("Ixz", [0, 2]), ("Iyz", [1, 2])];

fn contact_table(contacts: &[Contact], named: &Named) -> Table {
    let whole = |pick: fn(&Contact) -> usize| contacts.iter().map(|c| pick(c) as i64).collect::<Vec<i64>>();
    let table = Table::default()
        .ints_column("first", "ball", whole(|c| c.ends[0]))
        .ints_column("second", "ball", whole(|c| c.ends[1]))
        .texts_column("group", "contact group", contacts.iter().map(|c| named.contact(c.groups).0).collect())
        .reals_column(
            "gap",
            "m",
            "distance of the surfaces, negative where they overlap",
            contacts.iter().map(|c| c.gap).collect(),
        );
    if named.material.is_none() {
        return table;
    }
    let joint = |c: &Contact| named.joints.as_ref().and_then(|joints| joints.bonded(c.ends));
    let bonded = |c: &Contact| i64::from(joint(c).unwrap_or_else(|| named.contact(c.groups).1));
    let table =
        table.ints_column("bonded", "1 where a bond is put at the start", contacts.iter().map(bonded).collect());
    let ends: Vec<[usize; 2]> = contacts.iter().map(|c| c.ends).collect();
    named.joints.iter().fold(table, |table, joints| joints.columns(table, &ends))
}

/// A row for each contact of the material, a column for each microparameter that one of them has.
fn groups(material: &Material) -> Table {
    let all: Vec<(&String, &Values)> = material.contacts.iter().collect();
    let texts =
        |pick: &dyn Fn(&Values) -> String| all.iter().map(|(_, contact)| pick(contact)).collect::<Vec<String>>();
    let mut table = Table::default()
        .texts_column("group", "contact", all.iter().map(|(name, _)| (*name).clone()).collect())
        .texts_column("first", "group of one ball", texts(&|contact| contact.between[0].clone()))
        .texts_column("second", "group of the other", texts(&|contact| contact.between[1].clone()))
        .texts_column("bond", "kind of the bond, or none", texts(&|contact| word(contact.bond)));
    for parameter in Parameter::ALL {
        let one = parameter.declaration();
        let value = |contact: &Values| {
            let acts = one.laws.iter().any(|law| contact.bond.laws().contains(law));
            contact.values.get(parameter).copied().unwrap_or(if acts { one.default } else { f64::NAN })
        };
        let values: Vec<f64> = all.iter().map(|(_, contact)| value(contact)).collect();
        if values.iter().any(|value| !value.is_nan()) {
            let (unit, about) = match one.quantity {
                Quantity::Deviation => ("", format!("{}, over its mean", one.meaning)),
                quantity => (quantity.unit(), one.meaning.to_owned()),
            };
            table = table.reals_column(one.key, unit, &about, values);
        }
    }
    table
        .texts_column("distribution", "of the strengths", texts(&|contact| word(contact.distribution)))
        .reals_column(
            "gap",
            "",
            "bonds form at gaps up to this share of the mean radius",
            vec![material.gap; all.len()],
        )
        .texts_column("convention", "how a modulus becomes a stiffness", vec![word(material.convention); all.len()])
}

/// The word for an alternative in the workflow.
fn word(value: impl Serialize) -> String {
    serde_json::to_value(value).ok().and_then(|value| value.as_str().map(str::to_owned)).unwrap_or_default()
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
