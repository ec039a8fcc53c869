use super::*;
use crate::{D2, D3};

fn rock() -> Contact {
    Contact::bonded("rock", 20e9, 2.5, [10e6, 15e6], 0.5)
}

fn with(bond: BondKind, values: &[(Parameter, f64)]) -> Contact {
    Contact { bond, values: values.iter().copied().collect(), ..rock() }
}

fn sentences(contact: &Contact) -> Vec<String> {
    contact.faults("rock").iter().map(ToString::to_string).collect()
}

#[test]
fn a_bonded_contact_needs_its_spring_friction_and_strengths_and_nothing_else() {
    assert_eq!(sentences(&rock()), [""; 0]);
    let keys = |contact: &Contact| contact.missing().iter().map(|p| p.key()).collect::<Vec<_>>();
    assert_eq!(keys(&with(BondKind::Parallel, &[])), ["Ec", "kn_ks", "mu", "sigma_c", "tau_c"]);
    assert_eq!(keys(&with(BondKind::None, &[])), ["Ec", "kn_ks", "mu"]);
    let direct = [(Parameter::Kn, 1e7), (Parameter::Friction, 0.5)];
    assert_eq!(keys(&with(BondKind::None, &direct)), ["ks"]);
    assert_eq!(keys(&with(BondKind::Parallel, &direct)), ["ks", "pb_kn", "pb_ks", "sigma_c", "tau_c"]);
}

#[test]
fn what_has_no_effect_is_a_fault() {
    let mut contact = rock();
    contact.bond = BondKind::Contact;
    contact.values.insert(Parameter::RadiusMultiplier, 0.5);
    contact.values.insert(Parameter::Kn, 1e7);
    contact.values.insert(Parameter::Friction, -1.0);
    let sentences = sentences(&contact);
    assert!(
        sentences.iter().any(|t| t == "`radius_multiplier` has no effect on contact `rock`, which has a contact bond")
    );
    assert!(sentences.iter().any(|t| t == "`kn` of contact `rock` has no effect beside `Ec`"), "{sentences:?}");
    assert!(sentences.iter().any(|t| t == "`mu` of contact `rock` is -1; it must be 0 or more"), "{sentences:?}");
}

/// Contact between equal discs: k_n = E* (2 r t)/(2 r) = E* t; spheres: (π/2) E* R.
#[test]
fn a_direct_stiffness_has_the_modulus_that_gives_it() {
    let direct = |kn| Material::of_one(with(BondKind::None, &[(Parameter::Kn, kn), (Parameter::Ks, 1e9)]));
    assert_eq!(direct(20e9).modulus::<D2>(1e-3), 20e9);
    let expected = 20e9 * 1e-3 * std::f64::consts::FRAC_PI_2;
    assert!((direct(expected).modulus::<D3>(1e-3) / 20e9 - 1.0).abs() < 1e-15);
    assert_eq!(Material::of_one(rock()).modulus::<D3>(1e-3), 20e9);
}

/// RCC, Math. Probl. Eng. 2020, 6686609: k̄_n = 12 GPa/22.5 mm = 5.33e11 Pa/m, and k̄_n/k̄_s = 2.564.
#[test]
fn the_cement_takes_its_own_stiffness_or_that_of_the_spring() {
    let cement = |contact: &Contact| match contact.interaction(Convention::Present).bond {
        Bond::Parallel(bond) => bond,
        bond => panic!("{bond:?}"),
    };
    let radii = [11.25e-3; 2];
    let mut modulus = rock();
    modulus.values.extend([(Parameter::BondModulus, 12e9), (Parameter::BondRatio, 2.564)]);
    let mut direct = rock();
    direct.values.extend([(Parameter::BondKn, 12e9 / 22.5e-3), (Parameter::BondKs, 12e9 / 22.5e-3 / 2.564)]);
    let (a, b) = (cement(&modulus), cement(&direct));
    assert!((a.normal::<D3>(radii) / b.normal::<D3>(radii) - 1.0).abs() < 1e-15);
    assert!((a.stiffness.shear_share() / b.stiffness.shear_share() - 1.0).abs() < 1e-15);
    let own = cement(&rock());
    assert_eq!(own.stiffness, BondStiffness::Modulus { modulus: 20e9, ratio: 2.5 });
}

#[test]
fn a_platen_has_the_spring_of_the_first_group() {
    let stone = Contact { between: ["stone".into(), "stone".into()], bond: BondKind::None, ..rock() };
    let pair = Contact { between: ["stone".into(), "rock".into()], ..rock() };
    let mut material = Material::of_one(rock());
    material.groups.push("stone".into());
    material.contacts.extend([("stone".to_owned(), stone), ("interface".to_owned(), pair)]);
    let table = material.table(0.1);
    assert_eq!(material.contact(1, 0).map(|(name, _)| name), Some("interface"));
    let order: Vec<Option<usize>> =
        [(0, 0), (0, 1), (1, 1)].iter().map(|&(a, b)| table.class(Group(a), Group(b))).collect();
    assert_eq!(order, [Some(0), Some(1), Some(2)]);
    for group in [Group(0), Group(1)] {
        let platen = table.get(PLATEN, group).unwrap();
        assert_eq!((platen.linear.friction, platen.bond), (0.1, Bond::None));
        assert_eq!(platen.linear.stiffness, rock().stiffness(Convention::Present));
    }
}
