use super::*;

use crate::artifact::calibration::{
    Alternatives, Answer, Effort, Evaluations, Parameters, Prediction, Solution, Solved, Summary, Verification,
    VerifiedRuns,
};
use crate::artifact::notes::NoteTable;
use crate::artifact::range::{LevelValues, Levels, Range, Ranges};
use crate::artifact::run::{CrackMode, Cracks, Curve, Forces, Responses, Run, States};
use crate::artifact::specimen::Specimen;
use crate::artifact::statistics::{Anova, Effects, Fits, Limits, Residuals, Screening, Variances};
use crate::artifact::surfaces::{Coefficients, Domains, Paths, PrincipalAxes, Selections, Stationary, Surfaces};
use crate::artifact::{ContentHash, Group, Node, Numbered, Values};
use crate::stage::{Factor, FileInput, Input, Library, Outcome, Response};
use ndarray::{Array2, Array3};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

mod samples;
mod space;

use samples::*;

fn words<const N: usize>(values: [&str; N]) -> Vec<String> {
    values.map(String::from).to_vec()
}

fn artifact(kind: &str, tables: Vec<(&str, Table)>) -> Artifact {
    let root = tables.into_iter().fold(Group::new(), |group, (name, table)| group.with(name, Node::Table(table)));
    Artifact::new(kind, 1, root)
}

fn table() -> Table {
    Table::default()
}

fn context() -> Context {
    let mut context = Context::default();
    let mut add = |name: &str, sets: &str, symbol: &str, levels: &[f64]| {
        let factor =
            Factor { sets: vec![sets.into()], symbol: symbol.into(), levels: levels.to_vec(), ..Factor::default() };
        context.factors.insert(name.into(), factor);
    };
    add("Ec", "mortar.Ec", "E_c", &[10.0, 20.0]);
    add("mu", "mortar.mu", r"\mu", &[0.5, 1.0, 1.5]);
    add("null", "", "", &[1.0, 2.0, 3.0]);
    context.factors.get_mut("Ec").unwrap().unit = "GPa".into();
    context.responses.insert("UCS".into(), Response { unit: "MPa".into(), symbol: r"\sigma_u".into() });
    context
}

/// A library of the artifacts themselves: an input's content is its place in the list.
struct Shelf(Vec<Arc<Artifact>>);

impl Library for Shelf {
    fn load(&self, content: &ContentHash) -> Result<Arc<Artifact>, StageError> {
        Ok(self.0[usize::from(content.0[0])].clone())
    }
    fn outcome(&self, _: &Task) -> Option<Outcome> {
        None
    }
    fn file(&self, name: &str, _: &str) -> Result<FileInput, StageError> {
        Err(StageError::new(name))
    }
}

fn settings(text: &str) -> Figure {
    toml::from_str(text).unwrap()
}

/// The task that the stage asks for, given its inputs port by port.
fn task_of(figure: &Figure, context: &Context, from: &[Artifact], compare: &[Artifact]) -> Task {
    let all: Vec<Arc<Artifact>> = from.iter().chain(compare).map(|a| Arc::new(a.clone())).collect();
    let shelf = Shelf(all);
    let input = |i: usize| Input {
        key: if i < from.len() { "of" } else { "compare" },
        stage: "s",
        content: ContentHash([i as u8; 32]),
        vary: Box::new(|_, _| Ok(None)),
        replicate: Box::new(|_| None),
        sample: Box::new(|_, _| Err(StageError::new("none"))),
    };
    let known = Known { name: "figure", context, inputs: (0..shelf.0.len()).map(input).collect(), library: &shelf };
    match figure.next(&known).unwrap() {
        Step::Finish(task) => task,
        Step::Ask(..) => panic!("a figure asks for nothing"),
    }
}

fn made(text: &str, from: &[Artifact], compare: &[Artifact]) -> Result<Artifact, Failure> {
    // A small page: the pixels of the PNG are most of the work.
    let figure = settings(&format!("{text}\nwidth = '45 mm'"));
    assert_eq!(figure.check(&context()), [], "{text}");
    let task = task_of(&figure, &context(), from, compare);
    let inputs: Vec<(String, Arc<Artifact>)> = (from.iter().map(|a| ("of".to_owned(), Arc::new(a.clone()))))
        .chain(compare.iter().map(|a| ("compare".to_owned(), Arc::new(a.clone()))))
        .collect();
    let (stop, say) = (AtomicBool::new(false), |_: crate::stage::Progress| ());
    draw(&Job {
        params: &task.params.value(),
        seed: None,
        inputs: &inputs,
        files: &[],
        threads: &|| 1,
        time_limit: None,
        say: &say,
        stop: &stop,
    })
}

fn text(artifact: &Artifact, name: &str) -> String {
    match artifact.root.get(name) {
        Some(Node::Text(text)) => text.clone(),
        _ => panic!("no text {name}"),
    }
}

#[test]
fn every_figure_is_drawn_from_what_its_stages_give() {
    type Case<'a> = (&'a str, &'a str, Vec<Artifact>, Vec<Artifact>);
    let cases: Vec<Case> = vec![
        ("stress-strain", "", vec![run()], vec![]),
        ("cracks", "compare = 'b'", vec![run()], vec![specimen()]),
        ("damage", "compare = 'b'", vec![jointed()], vec![specimen()]),
        ("envelope", "", vec![strength_envelope()], vec![]),
        ("crack-rose", "", vec![run()], vec![]),
        ("force-chains", "compare = 'b'", vec![run()], vec![specimen()]),
        ("snapshots", "compare = 'b'", vec![run()], vec![row_of_discs()]),
        ("specimen", "", vec![specimen()], vec![]),
        ("main-effects", "response = 'UCS'\ncompare = 'b'", vec![range_analysis()], vec![range_analysis()]),
        ("range", "response = 'UCS'", vec![range_analysis()], vec![]),
        ("points", "factors = ['Ec', 'mu']", vec![results(0.0)], vec![]),
        ("agreement", "response = 'UCS'\ncompare = 'b'", vec![results(0.0)], vec![results(1.0)]),
        ("contour", "response = 'UCS'\nfactors = ['Ec', 'mu']\ncompare = 'b'", vec![surfaces()], vec![results(0.0)]),
        ("surface", "response = 'UCS'\nfactors = ['Ec', 'mu']", vec![surfaces()], vec![]),
        ("residuals", "response = 'UCS'", vec![surfaces()], vec![]),
        ("observed-predicted", "response = 'UCS'", vec![surfaces()], vec![]),
        ("pareto", "response = 'UCS'", vec![screening()], vec![]),
        ("pareto", "response = 'UCS'", vec![anova()], vec![]),
        ("half-normal", "response = 'UCS'", vec![screening()], vec![]),
        ("normal", "response = 'UCS'", vec![screening()], vec![]),
        ("convergence", "", vec![solution()], vec![]),
        ("solutions", "", vec![solution()], vec![]),
        ("verification", "", vec![verification()], vec![]),
    ];
    for (show, more, from, compare) in cases {
        let picture = made(&format!("show = '{show}'\nof = 'a'\n{more}"), &from, &compare);
        let picture = picture.unwrap_or_else(|e| panic!("{show}: {e}"));
        assert!(text(&picture, "svg").starts_with("<svg") && !text(&picture, "title").is_empty(), "{show}");
        let starts = |name: &str, with: &[u8]| match picture.root.get(name) {
            Some(Node::Bytes(bytes)) => bytes.starts_with(with),
            _ => false,
        };
        assert!(starts("pdf", b"%PDF-") && starts("png", b"\x89PNG"), "{show}");
        assert!(picture.table("data").unwrap().rows() > 0, "{show}");
        assert_eq!(picture.root.get("moving").is_some(), show == "snapshots", "{show}");
    }
}

#[test]
fn the_numbers_are_those_of_the_inputs() {
    let ranges = made("show = 'range'\nof = 'a'\nresponse = 'UCS'", &[range_analysis()], &[]).unwrap();
    let data = ranges.table("data").unwrap();
    assert_eq!(data.shown("value").unwrap().0, [10.0, 2.0]);
    assert_eq!(data.shown("empty column").unwrap().0, [0.5, 0.5]);

    let means = made("show = 'main-effects'\nof = 'a'\nresponse = 'UCS'", &[range_analysis()], &[]).unwrap();
    assert_eq!(means.table("data").unwrap().shown("mean").unwrap().0, [30.0, 40.0, 34.0, 35.0, 36.0, 34.5, 35.0, 34.6]);

    for (show, sizes, quantiles) in
        [("normal", [9.0, -3.0, 0.4], [0.97, -0.97, 0.0]), ("half-normal", [9.0, 3.0, 0.4], [1.38, 0.67, 0.21])]
    {
        let plot = made(&format!("show = '{show}'\nof = 'a'\nresponse = 'UCS'"), &[screening()], &[]).unwrap();
        let data = plot.table("data").unwrap();
        let name = data.columns[1].name.clone();
        assert_eq!(
            (data.shown(&name).unwrap().0, data.shown("quantile").unwrap().0),
            (sizes.to_vec(), quantiles.to_vec()),
            "{show}"
        );
    }

    let pairs = "show = 'agreement'\nof = 'a'\nresponse = 'UCS'\ncompare = 'b'";
    let agreement = made(pairs, &[results(1.0)], &[results(0.0)]).unwrap();
    let data = agreement.table("data").unwrap();
    let (x, y) = (data.shown("published").unwrap().0, data.shown("computed").unwrap().0);
    assert_eq!(x.len(), 6);
    assert!(x.iter().zip(&y).all(|(x, y)| y - x == 1.0));

    // Of the forces, those of the state with the largest stress: the odd ones, where its discs are.
    let chains = made("show = 'force-chains'\nof = 'a'", &[run()], &[]).unwrap();
    let data = chains.table("data").unwrap();
    assert_eq!(data.shown("normal_force").unwrap().0[..3], [-0.3, -0.1, 0.1]);
    let first = ["x1", "x2", "y1"].map(|name| data.shown(name).unwrap().0[0].round());
    assert_eq!(first, [-14.0, -13.0, 10.0]);

    let contour = "show = 'contour'\nof = 'a'\nresponse = 'UCS'\nfactors = ['mu', 'Ec']";
    let field = made(contour, &[surfaces()], &[]).unwrap();
    let data = field.table("data").unwrap();
    let z = data.shown("UCS").unwrap().0;
    // At mu = 0.4, Ec = 8: 1 + 16 − 1.2 + 1.6.
    assert!((z[0] - 17.4).abs() < 1e-12, "{}", z[0]);
}

#[test]
fn only_what_is_drawn_decides_the_picture() {
    let figure = settings("show = 'main-effects'\nof = 'a'\nresponse = 'UCS'\nfactors = ['Ec']");
    let task = |context: &Context| task_of(&figure, context, &[range_analysis()], &[]).params;
    let before = task(&context());
    let mut other = context();
    other.factors.get_mut("mu").unwrap().symbol = r"\mu_m".into();
    other.seed = 7;
    assert_eq!(task(&other), before);
    other.factors.get_mut("Ec").unwrap().symbol = "E_m".into();
    assert_ne!(task(&other), before);
}

#[test]
fn faults_of_the_settings_are_told_before_anything_runs() {
    let message_of = |text: &str| {
        let found = settings(text).check(&context());
        found.into_iter().map(|c| c.message).collect::<Vec<_>>().join("; ")
    };
    assert_eq!(
        message_of("show = 'range'\nof = 'a'\nresponse = 'UCS'\nband = 0.1"),
        "`band` has no effect on a figure that shows `range`"
    );
    assert_eq!(message_of("show = 'range'\nof = 'a'"), "`response` names 0, but `range` shows 1");
    assert_eq!(
        message_of("show = 'specimen'\nof = 'a'\nresponse = 'UCS'"),
        "`response` has no effect on a figure that shows `specimen`"
    );
    assert_eq!(
        message_of("show = 'contour'\nof = 'a'\nresponse = 'x'\nfactors = ['Ec', 'y']"),
        "there is no [response.x]; there is no [factor.y]"
    );
    assert_eq!(
        message_of("show = 'agreement'\nof = ['a', 'b']\nresponse = 'UCS'\ncompare = 'c'"),
        "`of` names 2 stages and `compare` 1; they are compared in pairs"
    );
    let width = toml::from_str::<Figure>("show = 'specimen'\nof = 'a'\nwidth = 'tripple'").unwrap_err().to_string();
    assert!(width.contains("wanted \"single\", \"double\" or a length"), "{width}");
    assert!(message_of("show = 'specimen'\nof = 'a'\nwidth = '9 mm'").contains("9 mm is no width"));
    assert!(message_of("show = 'specimen'\nof = 'a'\nnames = { UCS = '$\\\\sgma$' }").contains("unknown command"));
}

#[test]
fn what_an_input_lacks_is_named() {
    let message_of = |text: &str, from: Artifact| match made(text, &[from], &[]) {
        Err(Failure::Failed(e)) => format!("{} ({})", e.message, e.hint.unwrap_or_default()),
        other => panic!("{other:?}"),
    };
    let residuals = "show = 'residuals'\nof = 'a'\nresponse = 'UCS'";
    let empty = Artifact::of(Anova::KIND, Group::new());
    assert_eq!(message_of(residuals, empty), "anova.anova: wanted table, found nothing ()");
    let contour = "show = 'contour'\nof = 'a'\nresponse = 'UCS'\nfactors = ['Ec', 'null']";
    assert_eq!(
        message_of(contour, surfaces()),
        "the surface of `UCS` does not depend on `null` (it depends on Ec, mu)"
    );
}

/// A sweep: five strengths, two ratios, three packings each.
fn sweep() -> Artifact {
    let rows: Vec<(f64, f64, f64)> = [1.0, 4.0]
        .into_iter()
        .flat_map(|ratio| [1.0, 5.0, 15.0, 20.0, 30.0].map(|s| (ratio, s)))
        .flat_map(|(ratio, s)| [-1.0, 0.0, 1.0].map(|packing| (ratio, s, packing)))
        .collect();
    let pick = |f: fn(&(f64, f64, f64)) -> f64| rows.iter().map(f).collect::<Vec<f64>>();
    let runs = table()
        .reals_column("Ec", "GPa", "", pick(|r| r.1))
        .reals_column("mu", "", "", pick(|r| r.0))
        .reals_column("UCS", "MPa", "", pick(|r| r.1 / (1.0 + r.0) * (1.0 + 0.02 * r.2)))
        .texts_column("cement", "", rows.iter().map(|r| if r.2 > 0.0 { "slag" } else { "OPC" }.to_owned()).collect())
        .reals_column("stiffness", "Pa", "", pick(|r| 1e9 * r.1));
    artifact("results", vec![("runs", runs)])
}

#[test]
fn plots_of_own_columns_hold_the_numbers_of_the_table() {
    let numbers = |picture: &Artifact, name: &str| picture.table("data").unwrap().shown(name).unwrap().0;
    let text = "show = 'xy'\nof = 'a'\nx = 'Ec'\ny = 'UCS'\nby = 'mu'\nfit = 'through-origin'\nbars = 'deviation'";
    let xy = made(text, &[sweep()], &[]).unwrap();
    // Means of the three packings, bars of one deviation: 2 % of the mean.
    let (y, low) = (numbers(&xy, "UCS"), numbers(&xy, "low"));
    assert!((y[0] - 0.5).abs() < 1e-12 && (low[0] - 0.49).abs() < 1e-12, "{} {}", y[0], low[0]);
    let kinds = |p: &Artifact| match &p.table("data").unwrap().column("kind").unwrap().values {
        Values::Texts(kinds) => kinds.clone(),
        other => panic!("{other:?}"),
    };
    assert_eq!(kinds(&xy).iter().filter(|k| *k == "point").count(), 10);
    // The lines start at the origin and have the slopes 1/2 and 1/5.
    let lines: Vec<usize> = (0..y.len()).filter(|&i| kinds(&xy)[i] == "line").collect();
    let x = numbers(&xy, "Ec");
    assert_eq!((x[lines[0]], y[lines[0]]), (0.0, 0.0));
    let end = lines[lines.len() - 1];
    assert!((y[end] / x[end] - 0.2).abs() < 1e-3, "{}", y[end] / x[end]);

    let heat = made("show = 'heat-map'\nof = 'a'\nx = 'Ec'\ny = 'mu'\nvalue = 'UCS'", &[sweep()], &[]).unwrap();
    assert_eq!((numbers(&heat, "UCS").len(), numbers(&heat, "mu")[0], numbers(&heat, "Ec")[1]), (10, 1.0, 5.0));
    assert!((numbers(&heat, "scatter")[0] - 0.01).abs() < 1e-12);

    let boxes = made("show = 'box'\nof = 'a'\ny = 'UCS'\nby = 'cement'", &[sweep()], &[]).unwrap();
    assert_eq!(boxes.table("data").unwrap().shown("n").unwrap().0, [20.0, 10.0]);
    let bins = made("show = 'histogram'\nof = 'a'\nx = 'stiffness'\nbins = 5", &[sweep()], &[]).unwrap();
    assert_eq!(numbers(&bins, "count").iter().sum::<f64>(), 30.0);
    // Pascals are shown in the unit of the field.
    assert_eq!(bins.table("data").unwrap().column("stiffness_to").unwrap().unit, "GPa");

    let curves = made("show = 'curves'\nof = ['a', 'b']", &[run(), run()], &[]).unwrap();
    // Two equal runs under one name: their mean is the curve itself, without scatter.
    let mean: Vec<usize> = (0..kinds(&curves).len()).filter(|&i| kinds(&curves)[i] == "line").collect();
    let (low, high) = (numbers(&curves, "low"), numbers(&curves, "high"));
    assert!(mean.len() > 100 && mean.iter().all(|&i| low[i] == high[i]), "{}", mean.len());
    assert_eq!(curves.table("data").unwrap().column("stress").unwrap().unit, "MPa");
    assert_eq!(numbers(&curves, "axial_strain")[1], 5e-3);
}

#[test]
fn plots_say_what_they_lack() {
    let message_of =
        |text: &str| settings(text).check(&context()).into_iter().map(|c| c.message).collect::<Vec<_>>().join("; ");
    assert_eq!(message_of("show = 'xy'\nof = 'a'\nx = 'Ec'"), "`xy` needs `y`, the name of a column");
    assert_eq!(
        message_of("show = 'histogram'\nof = 'a'\nx = 'Ec'\nby = 'mu'\nfit = 'line'"),
        "`by` has no effect on a figure that shows `histogram`; `fit` has no effect on a figure that shows `histogram`"
    );
    assert_eq!(
        message_of("show = 'range'\nof = 'a'\nresponse = 'UCS'\nx = 'Ec'"),
        "`x` has no effect on a figure that shows `range`"
    );
    assert!(message_of("show = 'xy'\nof = 'a'\nx = 'Ec'\ny = 'UCS'\nconfidence = 0.9").contains("without `fit`"));
    let fails = |text: &str| match made(text, &[sweep()], &[]) {
        Err(Failure::Failed(e)) => e.message,
        other => panic!("{other:?}"),
    };
    assert_eq!(fails("show = 'xy'\nof = 'a'\nx = 'Ec'\ny = 'UCT'"), "the table has no column `UCT`");
    assert!(fails("show = 'xy'\nof = 'a'\nx = 'cement'\ny = 'UCS'").contains("holds words"));
    assert!(fails("show = 'box'\nof = 'a'\ny = 'UCS'\nwhere = { cement = 'gypsum' }").contains("no row"));
}
