use super::*;
use crate::stage::Complaint;
use crate::unit::parse_any;
use dem::parameter::Parameter as Micro;

fn material(text: &str) -> Material {
    toml::from_str::<MaterialTable>(text).unwrap().0
}

fn measure(text: &str) -> Measure {
    let (value, dimension) = parse_any(text).unwrap();
    Measure::of(value, dimension)
}

fn made(text: &str, groups: &[&str]) -> Result<dem::loading::material::Material, Vec<Complaint>> {
    let material = material(text);
    let groups: Vec<String> = groups.iter().map(|&name| name.to_owned()).collect();
    let values = material.resolve_alone();
    let bonding = Bonding::default();
    material.contacts(&values, Need { name: Some("m"), groups: &groups, bonding: &bonding })
}

fn faults_of(text: &str, groups: &[&str]) -> Vec<String> {
    made(text, groups).unwrap_err().into_iter().map(|fault| fault.message).collect()
}

const ROCK: &str = "rock = { Ec = '20 GPa', kn_ks = 2.5, sigma_c = '10 MPa', tau_c = '15 MPa', mu = 0.5 }\n";

#[test]
fn a_material_of_one_group_is_one_line_and_fits_whatever_its_name() {
    let made = made(ROCK, &["mortar"]).unwrap();
    assert_eq!(made.groups, ["rock"]);
    assert_eq!(made.contacts["rock"].values[&Micro::TensileStrength], 10e6);
    assert_eq!(made.faults(), []);
}

#[test]
fn contacts_that_the_specimen_cannot_have_are_not_asked_for() {
    let text = format!("{ROCK}stone = {{ Ec = '1 GPa' }}\ninterface = {{ between = ['rock', 'stone'] }}");
    assert_eq!(made(&text, &["rock"]).unwrap(), made(ROCK, &["rock"]).unwrap());
    let lacks = faults_of(&text, &["rock", "stone"]);
    assert!(lacks.iter().any(|t| t.starts_with("contact `stone` lacks `sigma_c`")), "{lacks:?}");
    assert!(lacks.iter().any(|t| t.starts_with("contact `interface` lacks `Ec`")), "{lacks:?}");
    let absent = faults_of(ROCK, &["rock", "stone"]);
    assert_eq!(absent, ["the specimen has particles of group `stone`, and the material has no such group"]);
}

#[test]
fn a_pair_is_an_entry_by_its_name_or_by_between_or_follows_the_rule() {
    let two = "a = { Ec = '20 GPa', kn_ks = 2, sigma_c = '10 MPa', tau_c = '40 MPa', mu = 0.5 }\n\
        b = { Ec = '40 GPa', kn_ks = 1, sigma_c = '30 MPa', tau_c = '20 MPa', mu = 1, radius_multiplier = 0.5 }\n";
    let of = |more: &str| {
        let made = made(&format!("{more}\n{two}"), &["a", "b"]).unwrap();
        let (name, contact) = made.contact(1, 0).unwrap();
        let value = |parameter| contact.values.get(&parameter).copied();
        let radius = value(Micro::RadiusMultiplier);
        (name.to_owned(), value(Micro::Modulus).unwrap(), value(Micro::ShearStrength).unwrap(), radius)
    };
    let values = "{ Ec = '1 GPa', kn_ks = 1, sigma_c = '1 MPa', tau_c = '1 MPa', mu = 1 }";
    let spelt = |more: &str| (more.to_owned(), 1e9, 1e6, None);
    assert_eq!(of(&format!("a-b = {values}")), spelt("a-b"));
    assert_eq!(of(&format!("b-a = {values}")), spelt("b-a"));
    let between = values.replace('{', "{ between = ['b', 'a'],");
    assert_eq!(of(&format!("joint = {between}")), spelt("joint"));
    assert_eq!(of("pairs = 'weaker'"), ("a-b".to_owned(), 20e9, 20e6, Some(0.5)));
    assert_eq!(of("pairs = 'mean'"), ("a-b".to_owned(), 30e9, 30e6, Some(0.75)));
    assert_eq!(faults_of(two, &["a", "b"]), ["contacts of `a` and `b` have no values"]);
    let twice = faults_of(&format!("a-b = {values}\njoint = {between}\n{two}"), &["a", "b"]);
    assert_eq!(twice, ["`a-b` and `joint` both hold the contacts of `a` and `b`"]);
}

#[test]
fn no_rule_joins_what_differs_in_kind() {
    let unbonded = "b = { Ec = '40 GPa', kn_ks = 1, mu = 1, bond = 'none' }\n";
    let with = |rule: &str| made(&format!("pairs = '{rule}'\n{ROCK}{unbonded}"), &["rock", "b"]);
    assert_eq!(with("weaker").unwrap().contact(0, 1).unwrap().1.bond, BondKind::None);
    assert!(with("mean").unwrap_err()[0].message.contains("differ in their bond"));
    let direct = "b = { kn = '1e7 N/m', ks = '1e7 N/m', mu = 1, bond = 'none' }\n";
    let fault = faults_of(&format!("pairs = 'weaker'\n{ROCK}{direct}"), &["rock", "b"]);
    assert!(fault[0].contains("differ in `Ec`"), "{fault:?}");
}

#[test]
fn a_deviation_is_a_stress_or_a_share_of_the_mean_each_strength_its_own() {
    let text =
        ROCK.replace(" }", ", sigma_c_deviation = '2.5 MPa', tau_c_deviation = '20 %', distribution = 'weibull' }");
    let interaction = made(&text, &["rock"]).unwrap().contacts["rock"].interaction(dem::Convention::Present);
    let dem::Bond::Parallel(bond) = interaction.bond else { panic!("{interaction:?}") };
    assert_eq!((bond.scatter.tensile, bond.scatter.shear), (0.25, 0.2));
    assert_eq!(bond.scatter.distribution, Distribution::Weibull);
}

#[test]
fn units_and_keys_are_those_of_the_declaration() {
    let with = |value: &str| faults_of(&ROCK.replace("mu = 0.5", value), &["rock"])[0].clone();
    assert_eq!(with("mu = '0.5 m'"), "`rock.mu` is a pure number and has no unit");
    assert_eq!(with("mu = 0.5, pb_Ec = '1 m'"), "`rock.pb_Ec` is measured in Pa, not in m");
    assert_eq!(with("mu = 0.5, pb_Ec = 5"), "`rock.pb_Ec` needs a unit, found the number 5");
    assert_eq!(with("mu = 0.5, mue = 5"), "`mue` is not a microparameter");
}

#[test]
fn formulas_name_values_of_the_entry_then_factors_then_other_entries() {
    let text =
        "a = { sigma_c = '30 MPa', tau_c = 'sigma_c / s', Ec = '1000 * tau_c', mu = 0.5 }\nb-c = { Ec = 'a_Ec / 2' }";
    let material = material(text);
    let factor = |name: &str| match name {
        "s" => Some(Measure::number(0.5)),
        "sigma_c" => Some(measure("1 GPa")),
        _ => None,
    };
    let (values, faults) = material.resolve(&Values::new(), &factor);
    assert_eq!(faults, []);
    let value = |path: &str| values[path].value;
    assert_eq!((value("a.tau_c"), value("a.Ec"), value("b-c.Ec")), (60e6, 60e9, 30e9));
    let set = Values::from([(
        "a.sigma_c".to_owned(),
        Parameter { value: 10e6, dimension: measure("1 Pa").dimension.unwrap() },
    )]);
    assert_eq!(material.resolve(&set, &factor).0["b-c.Ec"].value, 10e9);
    let (values, faults) = material.resolve(&Values::new(), &|_| None);
    assert_eq!(values.len(), 2);
    assert_eq!(faults[0].factor.as_deref(), Some("s"));
}

#[test]
fn formulas_that_cannot_be_are_told() {
    let why = |text: &str| material(text).resolve(&Values::new(), &|_| None).1[0].why.clone();
    assert_eq!(
        why("a = { Ec = 'mu + 2 * kn', mu = 1, kn = '1 N/m' }"),
        "`mu + 2 * kn`: a pure number and kg s^-2 cannot be added or compared"
    );
    let circle = why("a = { Ec = 'tau_c', tau_c = '2 * sigma_c', sigma_c = 'Ec' }");
    assert_eq!(circle, "the formulas need one another in a circle: a.Ec → a.tau_c → a.sigma_c → a.Ec");
    let error = toml::from_str::<MaterialTable>("a = { Ec = '16 GPaa' }").unwrap_err().to_string();
    assert!(error.contains("`GPaa` is not a unit"), "{error}");
}
