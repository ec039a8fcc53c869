use super::*;
use crate::artifact::run::Responses;
use crate::artifact::{ArtifactKind, Group, Node};
use crate::stage::Factor;
use crate::stage::material::MaterialTable;

fn context() -> Context {
    let mut context = Context::default();
    context
        .factors
        .insert("Ec".into(), Factor { sets: vec!["mortar.Ec".into()], unit: "GPa".into(), ..Factor::default() });
    context.factors.insert("null".into(), Factor::default());
    context
}

fn design(moduli: &[f64]) -> Artifact {
    let types = moduli.iter().map(|_| "cube".to_owned()).collect();
    let table = Table::default().texts_column("point_type", "", types).reals_column("Ec", "GPa", "", moduli.to_vec());
    Artifact::of(ArtifactKind::DESIGN, Group::new().with("design", Node::Table(table)))
}

#[test]
fn equal_rows_are_replicates_by_occurrence() {
    let design = design(&[10.0, 20.0, 10.0]);
    let found = DesignRows::of(&design, &context()).unwrap();
    assert_eq!([0, 1, 2].map(|row| found.replicate(row)), [1, 1, 2]);
    assert_eq!(found.point(2), Point::from([("Ec".to_owned(), 10.0)]));
}

#[test]
fn rows_are_told_apart_by_point_and_replicate() {
    let rows = |moduli: &[f64]| DesignRows::of(&design(moduli), &context()).unwrap();
    let found = rows(&[10.0, 20.0, 10.0, -0.0]);
    for (a, b) in [(0, 1), (0, 2), (1, 2), (0, 3)] {
        assert_ne!(found.name(a), found.name(b));
    }
    assert_eq!(found.name(3), rows(&[0.0]).name(0));
    let back = DesignRows::from_parts(found.factors().to_vec(), found.words().to_vec());
    assert_eq!(back.as_ref(), Some(&found));
    assert_eq!(DesignRows::from_parts(found.factors().to_vec(), found.words()[1..].to_vec()), None);
}

#[test]
fn a_point_sets_parameters_in_si_units() {
    let base: MaterialTable = toml::from_str("mortar = { Ec = '1 Pa', mu = 0.5 }").unwrap();
    let point = Point::from([("Ec".to_owned(), 16.0), ("null".to_owned(), 2.0)]);
    let set = apply(&base.0, &point, &context()).unwrap();
    assert_eq!(set.into_values().map(|found| found.value).collect::<Vec<_>>(), [1.6e10, 0.5]);
    let error = apply(&Material::default(), &point, &context()).unwrap_err();
    assert!(error.message.contains("mortar.Ec"));
}

#[test]
fn gathering_converts_units_and_keeps_failures() {
    let run =
        |ucs: f64, failure: &str| Arc::new(Run::plain(failure, Responses::of(&[("UCS", ucs, "Pa")])).to_artifact());
    let inputs = vec![
        ("design".to_owned(), Arc::new(design(&[10.0, 20.0]))),
        ("run".to_owned(), run(3e7, "")),
        ("run".to_owned(), run(1e6, "no peak")),
    ];
    let params = json!({ "factors": ["Ec"], "units": { "UCS": "MPa" } });
    let (stop, say) = (std::sync::atomic::AtomicBool::new(false), |_: crate::stage::Progress| ());
    let job = Job {
        params: &params,
        seed: None,
        inputs: &inputs,
        files: &[],
        threads: &|| 1,
        time_limit: None,
        say: &say,
        stop: &stop,
    };
    let results = gathered(&job).unwrap();
    let strengths = results.table("runs").unwrap().shown("UCS").unwrap().0;
    assert!((strengths[0] - 30.0).abs() < 1e-12 && strengths[1].is_nan());
}
