//! What the laws of a material are called in PFC, and which other codes have them.
//!
//! Names are those of the public manuals of PFC 6 to 9 ("Linear Model", "Linear Contact Bond Model", "Linear Parallel Bond
//! Model", "Flat-Joint Model", "Smooth-Joint Model": methods and properties). Angles are in degrees there.

use crate::artifact::Table;
use dem::loading::fissure::Fissures;
use dem::loading::material::{BondKind, Contact, Material};
use dem::parameter::Parameter;

/// A row: group or set, contact model, keyword, value, unit.
type Row = (String, &'static str, &'static str, f64, &'static str);

/// The contact model of a bond.
fn model(bond: BondKind) -> &'static str {
    match bond {
        BondKind::None => "linear",
        BondKind::Contact => "linearcbond",
        BondKind::Parallel => "linearpbond",
        BondKind::FlatJoint => "flatjoint",
    }
}

/// Method or property for a microparameter of a contact with this bond, and its unit; nothing where PFC has none: shares and
/// scatter are drawn contact by contact there as here.
fn keyword(parameter: Parameter, bond: BondKind, dimension: usize) -> Option<(&'static str, &'static str)> {
    let flat = bond == BondKind::FlatJoint;
    Some(match parameter {
        Parameter::Modulus => ("method deformability emod", "Pa"),
        Parameter::Ratio => ("method deformability kratio", ""),
        Parameter::Kn => ("kn", "N/m"),
        Parameter::Ks => ("ks", "N/m"),
        Parameter::Friction if flat => ("fj_fric", ""),
        Parameter::Friction => ("fric", ""),
        Parameter::BondModulus => ("method pb_deformability emod", "Pa"),
        Parameter::BondRatio => ("method pb_deformability kratio", ""),
        Parameter::BondKn => ("pb_kn", "Pa/m"),
        Parameter::BondKs => ("pb_ks", "Pa/m"),
        Parameter::TensileStrength => (strength(bond, ["method cb_strength tensile", "pb_ten", "fj_ten"]), "Pa"),
        Parameter::ShearStrength => (strength(bond, ["method cb_strength shear", "pb_coh", "fj_coh"]), "Pa"),
        Parameter::FrictionAngle => (if flat { "fj_fa" } else { "pb_fa" }, "deg"),
        Parameter::RadiusMultiplier => (if flat { "fj_rmul" } else { "pb_rmul" }, ""),
        Parameter::MomentFactor => ("pb_mcf", ""),
        Parameter::Elements if dimension == 2 => ("fj_nr", ""),
        Parameter::Elements => ("fj_nal", ""),
        Parameter::Rings if dimension == 2 => return None,
        Parameter::Rings => ("fj_nr", ""),
        Parameter::TensileDeviation | Parameter::ShearDeviation => return None,
        Parameter::Gapped | Parameter::Slit | Parameter::InitialGap => return None,
    })
}

fn strength(bond: BondKind, [point, cement, flat]: [&'static str; 3]) -> &'static str {
    match bond {
        BondKind::Contact => point,
        BondKind::FlatJoint => flat,
        BondKind::Parallel | BondKind::None => cement,
    }
}

/// The rows of the contacts of a group or pair.
fn contact_rows(name: &str, contact: &Contact, dimension: usize) -> Vec<Row> {
    let value = |parameter: Parameter| {
        let one = parameter.declaration();
        let acts = one.laws.iter().any(|law| contact.bond.laws().contains(law));
        contact.values.get(&parameter).copied().or((acts && !one.default.is_nan()).then_some(one.default))
    };
    let row = |&parameter: &Parameter| {
        let (word, unit) = keyword(parameter, contact.bond, dimension)?;
        let mut value = value(parameter)?;
        if parameter == Parameter::Elements && dimension == 2 {
            // In the plane the rings multiply the segments.
            value *= contact.values.get(&Parameter::Rings).copied().unwrap_or(1.0);
        }
        let value = if unit == "deg" { value.to_degrees() } else { value };
        Some((name.to_owned(), model(contact.bond), word, value, unit))
    };
    Parameter::ALL.iter().filter_map(row).collect()
}

/// The rows of a set of fissures.
fn fissure_rows(set: usize, fissures: &Fissures) -> Vec<Row> {
    // Without stiffnesses of their own those of the contacts: E* over the sum of the radii.
    let [kn, ks] = fissures.stiffness.unwrap_or([f64::NAN; 2]);
    let [tension, cohesion, angle] = fissures.bond.unwrap_or([0.0; 3]);
    let state = if fissures.bond.is_some() { 3.0 } else { 0.0 };
    let all = [
        ("sj_kn", kn, "Pa/m"),
        ("sj_ks", ks, "Pa/m"),
        ("sj_fric", fissures.friction, ""),
        ("sj_da", fissures.dilation.to_degrees(), "deg"),
        ("sj_ten", tension, "Pa"),
        ("sj_coh", cohesion, "Pa"),
        ("sj_fa", angle.to_degrees(), "deg"),
        ("sj_rmul", 1.0, ""),
        ("sj_state", state, ""),
    ];
    all.into_iter()
        .map(|(word, value, unit)| (format!("fissures {}", set + 1), "smoothjoint", word, value, unit))
        .collect()
}

/// The contact models and their methods and properties in PFC.
pub(super) fn properties(material: &Material, dimension: usize) -> Table {
    let mut rows: Vec<Row> =
        material.contacts.iter().flat_map(|(name, contact)| contact_rows(name, contact, dimension)).collect();
    rows.extend(material.fissures.iter().enumerate().flat_map(|(set, fissures)| fissure_rows(set, fissures)));
    let texts = |pick: fn(&Row) -> String| rows.iter().map(pick).collect::<Vec<String>>();
    Table::default()
        .texts_column("group", "contact group, or set of fissures", texts(|row| row.0.clone()))
        .texts_column("model", "contact model of PFC", texts(|row| row.1.to_owned()))
        .texts_column("keyword", "its method or property", texts(|row| row.2.to_owned()))
        .reals_column("value", "", "in the unit beside it", rows.iter().map(|row| row.3).collect())
        .texts_column("unit", "of the value", texts(|row| row.4.to_owned()))
}

/// What codes do not have, of the laws of a material: sentences for whoever takes the lists to one of them.
pub fn cautions(material: &Material) -> Vec<String> {
    let flat = material.contacts.values().any(|contact| contact.bond == BondKind::FlatJoint);
    let mut found = Vec::new();
    if flat {
        found.push(
            "flat joints: PFC has them (`flatjoint`, see the file pfc.csv); YADE and LAMMPS have no law whose interface breaks \
             in parts, so a parallel bond in its place is another material"
                .to_owned(),
        );
    }
    if !material.fissures.is_empty() {
        found.push(
            "smooth joints: PFC has them (`smoothjoint`, see the files fissures.csv and pfc.csv), and so has YADE (JCFpm, \
             `smoothJoint`); LAMMPS has none, there the contacts of a fissure are rough"
                .to_owned(),
        );
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rows(bond: BondKind, dimension: usize) -> Vec<(&'static str, f64)> {
        let mut contact = Contact::bonded("rock", 50e9, 2.0, [10e6, 90e6], 0.5);
        contact.bond = bond;
        contact.values.insert(Parameter::FrictionAngle, std::f64::consts::FRAC_PI_6);
        if bond == BondKind::FlatJoint {
            contact.values.extend([(Parameter::Elements, 6.0), (Parameter::Rings, 2.0), (Parameter::Slit, 0.1)]);
        }
        contact_rows("rock", &contact, dimension).into_iter().map(|row| (row.2, row.3)).collect()
    }

    #[test]
    fn flat_joints_have_their_names_in_the_plane_and_in_space() {
        let has = |rows: &[(&str, f64)], word: &str, value: f64| {
            let found = rows.iter().find(|row| row.0 == word).unwrap_or_else(|| panic!("no {word}"));
            assert!((found.1 - value).abs() < 1e-9 * value, "{word} {found:?}");
        };
        let plane = rows(BondKind::FlatJoint, 2);
        for (word, value) in [
            ("method deformability emod", 50e9),
            ("fj_fric", 0.5),
            ("fj_ten", 10e6),
            ("fj_coh", 90e6),
            ("fj_fa", 30.0),
            ("fj_rmul", 1.0),
            ("fj_nr", 12.0),
        ] {
            has(&plane, word, value);
        }
        assert!(plane.iter().all(|row| row.0 != "fj_nal" && !row.0.starts_with("pb_")));
        let space = rows(BondKind::FlatJoint, 3);
        has(&space, "fj_nr", 2.0);
        has(&space, "fj_nal", 6.0);
        has(&rows(BondKind::Parallel, 2), "pb_fa", 30.0);
    }

    #[test]
    fn only_joints_are_cautioned_about() {
        let material = |bond| {
            let contact = Contact { bond, ..Contact::bonded("rock", 50e9, 2.0, [10e6, 90e6], 0.5) };
            Material::of_one(contact)
        };
        assert_eq!(cautions(&material(BondKind::Parallel)), [""; 0]);
        let fissures = Fissures {
            list: vec![],
            network: None,
            stiffness: None,
            friction: 0.3,
            dilation: 0.1,
            bond: Some([1e6, 2e6, 0.5]),
        };
        let rock = Material { fissures: vec![fissures], ..material(BondKind::FlatJoint) };
        assert_eq!(cautions(&rock).len(), 2);
        let table = properties(&rock, 2);
        let words = table.texts("keyword").unwrap();
        let value = |word: &str| table.numbers("value", "").unwrap()[words.iter().position(|own| own == word).unwrap()];
        assert_eq!((value("sj_fric"), value("sj_ten"), value("sj_state")), (0.3, 1e6, 3.0));
        assert!((value("sj_da") - 0.1_f64.to_degrees()).abs() < 1e-12);
    }
}
