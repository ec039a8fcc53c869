use super::*;
use crate::stage::Factor;

fn context() -> Context {
    let mut context = Context::default();
    context.factors.insert("Ec".into(), Factor { sets: "mortar.Ec".into(), unit: "GPa".into(), ..Factor::default() });
    context.factors.insert("null".into(), Factor::default());
    context
}

fn design(moduli: &[f64]) -> Artifact {
    let types = moduli.iter().map(|_| "cube".to_owned()).collect();
    let table = Table::default().texts_column("point_type", "", types).reals_column("Ec", "GPa", "", moduli.to_vec());
    Artifact::new("design", 1, Group::new().with("design", Node::Table(table)))
}

#[test]
fn equal_rows_are_replicates_by_occurrence() {
    let design = design(&[10.0, 20.0, 10.0]);
    let found: Vec<Row> = rows(&design, &context()).unwrap().collect();
    assert_eq!(found.iter().map(|row| row.replicate).collect::<Vec<_>>(), [1, 1, 2]);
    assert_eq!(found[2], Row { index: 2, point: Point::from([("Ec".to_owned(), 10.0)]), replicate: 2 });
}

#[test]
fn a_point_sets_parameters_in_si_units() {
    let base = BTreeMap::from([("mortar.Ec".to_owned(), 1.0), ("mortar.mu".to_owned(), 0.5)]);
    let point = Point::from([("Ec".to_owned(), 16.0), ("null".to_owned(), 2.0)]);
    let set = apply(&base, &point, &context()).unwrap();
    assert_eq!(set.into_values().collect::<Vec<_>>(), [1.6e10, 0.5]);
    let error = apply(&BTreeMap::new(), &point, &context()).unwrap_err();
    assert!(error.message.contains("mortar.Ec"));
}

#[test]
fn gathering_converts_units_and_keeps_failures() {
    let run = |ucs: f64, failure: &str| {
        let group = Group::new()
            .with("failure", Node::Text(failure.to_owned()))
            .with("responses", Node::Table(response_table(&[("UCS", ucs, "Pa")])));
        Arc::new(Artifact::new("run", 1, group))
    };
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
        threads: 1,
        time_limit: None,
        say: &say,
        stop: &stop,
    };
    let results = gathered(&job).unwrap();
    let strengths = results.table("runs").unwrap().reals("UCS").unwrap();
    assert!((strengths[0] - 30.0).abs() < 1e-12 && strengths[1].is_nan());
}
