//! Verdicts on made-up tables.

use super::*;
use crate::artifact::notes::NoteTable;
use crate::artifact::statistics::{Anova, Fits, Residuals, Variances};
use crate::artifact::surfaces::{Coefficients, Domains, Paths, PrincipalAxes, Selections, Stationary, Surfaces};
use crate::artifact::{ContentHash, Group, Node};
use crate::report::{Cost, Outcome, State};
use crate::stage::{Class, Response};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::sync::Arc;

fn part(name: &str, kind: &str, class: Class, inputs: &[usize], settings: Value, artifact: Artifact) -> Part {
    let content = artifact.content_hash();
    Part {
        title: None,
        name: name.to_owned(),
        kind: kind.to_owned(),
        class,
        about: String::new(),
        inputs: inputs.iter().map(|&input| ("of".to_owned(), input)).collect(),
        settings,
        state: State::Done { content: ContentHash(content.0), artifact: Arc::new(artifact) },
        cost: Cost::default(),
        outcome: Outcome::default(),
    }
}

/// A campaign of one result and the table that prints it beside published values.
fn paper(made: Artifact, kind: &str, settings: Value, printed: Table) -> Paper {
    let printed = Artifact::of(ArtifactKind::TABLE, Group::new().with("table", Node::Table(printed)));
    let mut context = Context::default();
    context.responses.insert("UCS".to_owned(), Response::default());
    Paper {
        title: String::new(),
        about: String::new(),
        file: String::new(),
        text: String::new(),
        profile: None,
        sets: Vec::new(),
        store: String::new(),
        context,
        parts: vec![
            part("made", kind, Class::Statistics, &[], settings, made),
            part("printed", "table", Class::Presentation, &[0], json!({}), printed),
        ],
        runs: Vec::new(),
    }
}

fn findings(paper: &Paper) -> Vec<(Verdict, String)> {
    let compared = Compared::of(paper, &paper.parts[1]).unwrap();
    compared.findings().into_iter().map(|found| (found.verdict, found.words.into_string())).collect()
}

fn words(all: &[&str]) -> Vec<String> {
    all.iter().map(|&word| word.to_owned()).collect()
}

#[test]
fn factors_are_judged_by_those_that_either_side_calls_significant() {
    // F on 2 and 10 degrees of freedom is significant at 5 % from 4.103 on (tables of F).
    let source = words(&["a", "b", "c", "d", "residual"]);
    let f = vec![40.0, 4.2, 1.0, 0.2, f64::NAN];
    let anova = Variances {
        response: words(&["UCS"; 5]),
        source: source.clone(),
        df: vec![2, 2, 2, 2, 10],
        ss: vec![1.0; 5],
        ms: vec![1.0; 5],
        p: vec![0.0; 5],
        significance: words(&[""; 5]),
        eta2: vec![0.0; 5],
        omega2: vec![0.0; 5],
        f: f.clone(),
        ..Variances::default()
    };
    let (fit, notes, residuals) = (Fits::default(), NoteTable::default(), Residuals::default());
    let made = Anova { anova, fit, notes, residuals, not_valid: None }.to_artifact();
    let printed = Table::default()
        .texts_column("response", "", words(&["UCS"; 5]))
        .texts_column("source", "", source)
        .reals_column("f", "", "", f)
        .reals_column("f published", "", "", vec![30.0, 4.0, 4.2, 2.0, f64::NAN])
        .reals_column("f deviation", "%", "", vec![33.0, 5.0, -76.0, -90.0, f64::NAN]);
    let paper = paper(made, "anova", json!({ "alpha": 0.05 }), printed);
    let found = findings(&paper);
    assert_eq!(found.len(), 1);
    assert_eq!(found[0].0, Verdict::InPart);
    assert_eq!(
        found[0].1,
        "both sides call a (F 40.0, published 30.0) significant; only the computed runs b (F 4.2, published 4.0); \
         only the published ones c (F 1.0, published 4.2)"
    );
    let cells = judgements(&paper, &paper.parts[1]).unwrap().cells;
    let said: Vec<&str> = cells.iter().map(|cell| cell.as_ref().map_or("", |cell| cell.judged.word)).collect();
    assert_eq!(said, ["both", "only here", "only published", "neither", ""]);
}

#[test]
fn estimates_are_judged_by_the_errors_of_two_fits() {
    // t of 10 degrees of freedom is 2.2281 at 95 %, so with s = 1 two estimates differ by less than 3.151.
    let coefficients = Coefficients {
        response: words(&["UCS"; 3]),
        term: words(&["const", "a", "b"]),
        estimate: vec![10.0, 1.0, -2.0],
        std_error: vec![1.0; 3],
        t: vec![0.0; 3],
        p: vec![0.0; 3],
        vif: vec![1.0; 3],
        ..Coefficients::default()
    };
    let one = || vec![0.0];
    let fit = Fits {
        response: words(&["UCS"]),
        n: vec![13],
        missing: vec![0],
        df_residual: vec![10],
        df_pure_error: vec![0],
        s: one(),
        r2: one(),
        r2_adjusted: one(),
        r2_predicted: one(),
        press: one(),
        f: one(),
        p: one(),
        lack_of_fit_f: one(),
        lack_of_fit_p: one(),
        ..Fits::default()
    };
    let made = Surfaces {
        coefficients,
        fit,
        coded: Coefficients::default(),
        residuals: Residuals::default(),
        stationary: Stationary::default(),
        axes: PrincipalAxes::default(),
        path: Paths::default(),
        domain: Domains::default(),
        selection: Selections::default(),
        notes: NoteTable::default(),
        models: BTreeMap::new(),
        with_constant: None,
        predictions: None,
        not_valid: None,
    };
    let made = made.to_artifact();
    let printed = |published: Vec<f64>| {
        Table::default()
            .texts_column("response", "", words(&["UCS"; 3]))
            .texts_column("term", "", words(&["const", "a", "b"]))
            .reals_column("estimate", "", "", vec![10.0, 1.0, -2.0])
            .reals_column("estimate published", "", "", published)
            .reals_column("estimate deviation", "%", "", vec![0.0; 3])
            .texts_column("note", "", words(&["a misprint", "", ""]))
    };
    let close = paper(made.clone(), "rsm", json!({}), printed(vec![13.1, -2.1, 1.1]));
    let wanted = "all 3 estimates lie within the errors of two such fits";
    assert_eq!(findings(&close), [(Verdict::Agrees, wanted.to_owned())]);
    let far = paper(made, "rsm", json!({}), printed(vec![-13.0, 1.0, -2.0]));
    let found = findings(&far);
    assert_eq!(found[0].0, Verdict::InPart);
    assert!(
        found[0].1.contains("2 of 3 estimates")
            && found[0].1.contains("the constant (10.0 ± 1.0, published −13.0; a misprint)"),
        "{}",
        found[0].1
    );
    let cells = judgements(&far, &far.parts[1]).unwrap().cells;
    assert_eq!(cells[0].as_ref().and_then(|cell| cell.number.as_deref()), Some("23.0"));
}

#[test]
fn responses_are_judged_by_ratio_and_rank() {
    let judge = |ours: &[f64], theirs: &[f64]| {
        let (verdict, words) = responses::judge(ours, theirs).unwrap();
        (verdict, words.into_string())
    };
    let theirs = [10.0, 20.0, 30.0, 40.0, 50.0];
    let scaled = |by: [f64; 5]| theirs.iter().zip(by).map(|(value, by)| value * by).collect::<Vec<f64>>();
    let (verdict, words) = judge(&scaled([1.02, 0.99, 1.01, 0.97, 1.01]), &theirs);
    assert_eq!(verdict, Verdict::Agrees);
    assert!(words.contains("no difference beyond the scatter") && words.contains("in the same order"), "{words}");
    let (verdict, words) = judge(&scaled([0.81, 0.8, 0.79, 0.8, 0.8]), &theirs);
    assert_eq!(verdict, Verdict::InPart);
    assert!(words.starts_with("20.0 % lower (5 pairs, ratio 0.800"), "{words}");
    let (verdict, words) = judge(&[50.0, 41.0, 33.0, 12.0, 7.0].map(|v| 2.0 * v), &theirs);
    assert_eq!(verdict, Verdict::Differs, "{words}");
    assert!(words.contains("in another order (rank correlation −1.000)"), "{words}");
    assert_eq!(judge(&[9.0], &[10.0]).0, Verdict::Open);
}

#[test]
fn what_the_workflow_states_is_equal_or_not() {
    let made = Artifact::of(ArtifactKind::SPECIMEN, Group::new());
    let printed = Table::default()
        .texts_column("factor", "", words(&["Ec", "mu"]))
        .reals_column("level_1", "", "", vec![10.0, 0.5])
        .reals_column("level_1 published", "", "", vec![10.0, 0.1])
        .reals_column("level_1 deviation", "%", "", vec![0.0, 400.0]);
    let mut paper = paper(made, "specimen", json!({}), printed);
    paper.parts[1].settings = json!({ "list": "factors" });
    let (verdict, words) = findings(&paper).remove(0);
    assert_eq!(verdict, Verdict::InPart);
    assert_eq!(words, "1 of 2 values are as published; others are level_1 of mu 0.5000 (published 0.1000)");
}
