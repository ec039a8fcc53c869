use super::*;
use crate::artifact::{Group, Node, Table as Data};
use crate::stage::material::MaterialTable;
use serde_json::Value;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

fn anova(kind: ArtifactKind, f: [f64; 3]) -> Arc<Artifact> {
    let words = |w: [&str; 3]| w.map(String::from).to_vec();
    let table = Data::default()
        .texts_column("response", "", words(["UCS", "UCS", "E"]))
        .texts_column("source", "", words(["Ec", "error", "Ec"]))
        .ints_column("df", "", vec![2, 36, 2])
        .reals_column("F", "", "", f.to_vec());
    let name = kind.main_table().unwrap();
    Arc::new(Artifact::of(kind, Group::new().with(name, Node::Table(table))))
}

fn run(params: Value, inputs: &[(&str, Arc<Artifact>)]) -> Result<Artifact, Failure> {
    let inputs: Vec<(String, Arc<Artifact>)> = inputs.iter().map(|(n, a)| ((*n).to_owned(), a.clone())).collect();
    let (stop, say) = (AtomicBool::new(false), |_: crate::stage::Progress| ());
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
    print(&job)
}

fn text(artifact: &Artifact, name: &str) -> String {
    match artifact.root.get(name) {
        Some(Node::Text(text)) => text.clone(),
        _ => panic!("no text {name}"),
    }
}

#[test]
fn rows_and_columns_are_chosen_and_heads_have_symbols() {
    let params = json!({
        "columns": ["source", "F"], "only": { "response": "UCS" }, "digits": 3, "symbols": { "F": "F_{2,36}" },
    });
    let made = run(params, &[("of", anova(ArtifactKind::ANOVA, [3003.4242, f64::NAN, 1.0]))]).unwrap();
    assert_eq!(text(&made, "csv"), "source,F\nEc,3003.4242\nerror,\n");
    assert_eq!(text(&made, "markdown"), "| source | $F_{2,36}$ |\n| :-- | --: |\n| Ec | 3003 |\n| error | – |\n");
    assert!(text(&made, "latex").contains("source & $F_{2,36}$ \\\\\n\\midrule\nEc & 3003 \\\\\nerror & -- \\\\"));
    assert_eq!(made.table("table").unwrap().shown("F").unwrap().0[0], 3003.4242);
}

#[test]
fn published_values_stand_beside_ours_with_the_deviation() {
    let params = json!({ "by": ["response", "source"], "digits": 4 });
    let ours = anova(ArtifactKind::ANOVA, [110.0, 2.0, 50.0]);
    let made =
        run(params, &[("of", ours), ("compare", anova(ArtifactKind::RESULTS, [100.0, f64::NAN, 50.0]))]).unwrap();
    let table = made.table("table").unwrap();
    assert_eq!(table.shown("F published").unwrap().0[..1], [100.0]);
    let deviation = table.shown("F deviation").unwrap().0;
    assert!((deviation[0] - 10.0).abs() < 1e-9 && deviation[1].is_nan() && deviation[2] == 0.0);
    let markdown = text(&made, "markdown");
    assert!(markdown.contains("| UCS | Ec | 2 | 2 | 0.0 | 110 | 100 | 10.0 |"), "{markdown}");
}

#[test]
fn several_stages_are_stacked() {
    let params = json!({ "columns": ["source"], "digits": 4, "stages": ["a", "b"] });
    let one = anova(ArtifactKind::ANOVA, [1.0; 3]);
    let made = run(params, &[("of", one.clone()), ("of", one)]).unwrap();
    assert_eq!(text(&made, "csv").lines().nth(4), Some("b,Ec"));
}

#[test]
fn what_is_missing_is_named() {
    let said = |params: Value| match run(params, &[("of", anova(ArtifactKind::ANOVA, [1.0; 3]))]) {
        Err(Failure::Failed(error)) => format!("{} ({})", error.message, error.hint.unwrap_or_default()),
        other => panic!("{other:?}"),
    };
    assert_eq!(
        said(json!({ "columns": ["f"], "digits": 4 })),
        "the table has no column `f` (it has response, source, df, F)"
    );
    assert_eq!(said(json!({ "table": "x", "digits": 4 })), "the artifact `anova` holds no table `x` (it holds anova)");
}

fn given(text: &str) -> Option<Given> {
    struct Nothing;
    impl crate::stage::Library for Nothing {
        fn load(&self, _: &crate::artifact::ContentHash) -> Result<Arc<Artifact>, StageError> {
            Err(StageError::new("nothing is there"))
        }
        fn outcome(&self, _: &Task) -> Option<crate::stage::Outcome> {
            None
        }
        fn file(&self, _: &str, _: &str) -> Result<crate::stage::FileInput, StageError> {
            Err(StageError::new("no file"))
        }
    }
    let mut context = Context::default();
    let factor = |sets: &str, unit: &str, levels: &[f64]| crate::stage::Factor {
        sets: vec![sets.into()],
        unit: unit.into(),
        levels: levels.to_vec(),
        ..Default::default()
    };
    context.factors.insert("Ec".into(), factor("mortar.Ec", "GPa", &[30.0, 10.0, 20.0]));
    context.factors.insert("mu".into(), factor("mortar.mu", "", &[0.5, 1.5]));
    let trial: MaterialTable = toml::from_str("mortar = { Ec = '16 GPa', mu = 0.5 }").unwrap();
    context.materials.insert("trial".into(), trial.0);
    let stage: super::Table = toml::from_str(text).unwrap();
    assert_eq!(stage.check(&context), []);
    stage.given(&Known { name: "table", context: &context, inputs: Vec::new(), library: &Nothing }).unwrap()
}

#[test]
fn factors_and_materials_of_the_workflow_are_listed() {
    let table = given("list = 'factors'").unwrap().table();
    assert_eq!((table.shown("low").unwrap().0, table.shown("high").unwrap().0), (vec![10.0, 0.5], vec![30.0, 1.5]));
    assert_eq!(table.shown("level_1").unwrap().0, [30.0, 0.5]);
    assert!(table.shown("level_3").unwrap().0[1].is_nan());
    let table = given("list = 'materials'\nmaterials = ['trial']").unwrap().table();
    assert_eq!(table.shown("trial").unwrap().0, [16.0, 0.5]);
    assert_eq!(given("of = 'anova'"), None);
}

#[test]
fn settings_without_effect_on_a_list_are_told() {
    let said = |text: &str| {
        let stage: super::Table = toml::from_str(text).unwrap();
        stage.check(&Context::default()).into_iter().map(|c| c.message).collect::<Vec<_>>().join("; ")
    };
    assert_eq!(said("caption = 'x'"), "no stage is named");
    assert_eq!(said("list = 'factors'\nof = 'a'"), "`of` has no effect on this list");
    assert_eq!(said("of = 'a'\nmaterials = ['b']"), "`materials` has no effect here; there is no [material.b]");
    assert_eq!(said("list = 'aggregate'\nof = 'a'"), "the list needs the bounds of the classes, increasing");
    assert_eq!(said("of = 'a'\npublished = 'x.csv'"), "`by` is needed to match the rows of the two tables");
}

#[test]
fn responses_in_rows_are_told_in_the_units_of_the_workflow() {
    let words = |w: [&str; 4]| w.map(String::from).to_vec();
    let of = |values: [f64; 4]| {
        let table = Data::default()
            .texts_column("response", "", words(["UCS", "E", "nu", "sigma_ci"]))
            .reals_column("value", "", "", values.to_vec())
            .texts_column("unit", "", words(["Pa", "Pa", "", "Pa"]));
        Arc::new(Artifact::of(
            ArtifactKind::RUN,
            Group::new().with("failure", Node::Text(String::new())).with("responses", Node::Table(table)),
        ))
    };
    let params = json!({ "by": ["response"], "digits": 4, "units": { "UCS": "MPa", "E": "GPa", "nu": "" } });
    let theirs = of([32.23e6, 28.37e9, 0.197, f64::NAN]);
    let made = run(params, &[("of", of([25e6, 30e9, 0.2, 13.07e6])), ("compare", theirs)]).unwrap();
    let rows: Vec<String> = text(&made, "csv").lines().map(str::to_owned).collect();
    assert!(rows[1].starts_with("UCS,25,32.23,-22.4"), "{rows:?}");
    assert!(rows[2].starts_with("E,30,28.37,5.7"), "{rows:?}");
    assert!(rows[3].starts_with("nu,0.2,0.197,1.5"), "{rows:?}");
    let ends: Vec<&str> = rows[1..].iter().map(|row| row.rsplit(',').next().unwrap()).collect();
    assert_eq!(ends, ["MPa", "GPa", "", "MPa"]);
    assert!(rows[4].starts_with("sigma_ci,13.07,"), "{rows:?}");
}

#[test]
fn quantities_in_rows_are_told_as_people_read_them() {
    let words = |w: [&str; 3]| w.map(String::from).to_vec();
    let table = Data::default()
        .texts_column("quantity", "", words(["mean radius", "width", "discs"]))
        .reals_column("value", "", "", vec![0.485_400_01e-3, 0.1, 24.0])
        .texts_column("unit", "", words(["m", "m", ""]));
    let specimen = Arc::new(Artifact::of(ArtifactKind::SPECIMEN, Group::new().with("quality", Node::Table(table))));
    let made = run(json!({ "digits": 4, "units": {} }), &[("of", specimen)]).unwrap();
    let rows: Vec<String> = text(&made, "markdown").lines().map(str::to_owned).collect();
    let ends = ["| mean radius | 0.4854 | mm |", "| width | 0.1000 | m |", "| discs | 24 | – |"];
    assert!(ends.iter().zip(&rows[rows.len() - 3..]).all(|(end, row)| row == end), "{rows:?}");
}

/// A table in kPa beside one in MPa: 31000 kPa are 31 MPa, and rows are matched whatever the unit of their levels.
#[test]
fn values_in_another_unit_are_converted() {
    let runs = |n: &str, factor: f64, unit: &str, scale: f64| {
        let levels = [0.01, 0.02].iter().map(|level| level * factor).collect();
        let values = [31.0, 32.0].iter().map(|value| value * scale).collect();
        let table = Data::default().reals_column("w", n, "", levels).reals_column("UCS", unit, "", values);
        Arc::new(Artifact::of(ArtifactKind::RESULTS, Group::new().with("runs", Node::Table(table))))
    };
    let params = json!({ "by": ["w"], "digits": 4 });
    let ours = runs("", 1.0, "MPa", 1.0);
    let made = run(params.clone(), &[("of", ours.clone()), ("compare", runs("%", 100.0, "kPa", 1000.0))]).unwrap();
    let table = made.table("table").unwrap();
    assert_eq!(table.numbers("UCS published", "MPa").unwrap(), [31.0, 32.0]);
    assert_eq!(table.numbers("UCS deviation", "%").unwrap(), [0.0, 0.0]);
    let error = run(params, &[("of", ours), ("compare", runs("", 1.0, "mm", 1.0))]).unwrap_err().to_string();
    assert!(error.contains("column `UCS` is in `mm` and cannot be read in `MPa`"), "{error}");
}

/// Two radii and two ratios, one of the four cells twice, one without a row and one without a value.
#[test]
fn a_column_is_spread_over_two_others() {
    let table = Data::default()
        .reals_column("R_min", "mm", "", vec![0.4, 0.1, 0.1, 0.4])
        .ints_column("ratio", "", vec![2, 10, 10, 10])
        .reals_column("estimate", "MPa", "", vec![0.75, 2.0, 4.0, f64::NAN])
        .texts_column("term", "", vec!["a".into(); 4]);
    let groups = Arc::new(Artifact::of(ArtifactKind::GROUPS, Group::new().with("groups", Node::Table(table))));
    let spread = |value: &str| {
        let pivot = json!({ "down": "R_min", "across": "ratio", "value": value });
        let symbols = json!({ "ratio": r"\rho" });
        run(json!({ "pivot": pivot, "digits": 3, "symbols": symbols }), &[("of", groups.clone())])
    };
    let made = spread("estimate").unwrap();
    assert_eq!(text(&made, "csv"), "R_min [mm],ratio 2 [MPa],ratio 10 [MPa]\n0.1,,3\n0.4,0.75,\n");
    let markdown = text(&made, "markdown");
    assert!(markdown.starts_with(r"| R\_min / mm | $\rho = 2$ / MPa | $\rho = 10$ / MPa |"), "{markdown}");
    assert!(!markdown.contains("in no cell"));
    let table = Data::default()
        .reals_column("R_min", "m", "", vec![1e-4, f64::NAN, 4e-4])
        .ints_column("ratio", "", vec![2, 2, 2])
        .reals_column("estimate", "MPa", "", vec![1.0, 2.0, 3.0]);
    let lacking = Arc::new(Artifact::of(ArtifactKind::GROUPS, Group::new().with("groups", Node::Table(table))));
    let pivot = json!({ "down": "R_min", "across": "ratio", "value": "estimate" });
    let made = run(json!({ "pivot": pivot, "digits": 3 }), &[("of", lacking)]).unwrap();
    let note = r"1 of 3 rows have no R\_min or no ratio, so they are in no cell.";
    assert!(text(&made, "markdown").contains(note), "{}", text(&made, "markdown"));
    let Err(Failure::Failed(error)) = spread("term") else { panic!("words in cells") };
    assert_eq!(error.message, "`pivot` names `term`, which holds words");
}

#[test]
fn columns_beside_a_pivot_are_a_complaint() {
    let table: Table =
        toml::from_str("of = 'K'\ncolumns = ['a']\npivot = { down = 'a', across = 'b', value = 'c' }").unwrap();
    let messages: Vec<String> = table.check(&Context::default()).into_iter().map(|c| c.message).collect();
    assert_eq!(messages, ["`columns` has no effect with `pivot`"]);
}
