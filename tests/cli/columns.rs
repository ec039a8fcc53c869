//! Data as they come, fits by groups, categories, screening and plots, from one workflow.

use crate::space::{Space, told};
use serde_json::Value;

const WORKFLOW: &str = include_str!("columns.toml");
/// Twelve runs of a Plackett–Burman design that a spreadsheet with German settings wrote.
const SCREENED: &str = "\u{feff}A;B;C;D;cement;y/MPa\n\
    1;1;-1;1;OPC;12,1\n-1;1;1;-1;OPC;6,2\n1;-1;1;1;OPC;11,8\n-1;1;-1;1;OPC;7,9\n-1;-1;1;-1;OPC;4,1\n-1;-1;-1;1;slag;5,9\n\
    1;-1;-1;-1;slag;9,8\n1;1;-1;-1;slag;10,4\n1;1;1;-1;slag;11,2\n-1;1;1;1;slag;8,3\n1;-1;1;1;slag;12,4\n-1;-1;-1;-1;slag;n/a\n";
const MEASURED: &str = "scn/MPa,st/MPa\n4,1.5\n12,4.4\n25,9.2\n";

fn table(space: &Space, stage: &str, name: &str) -> Value {
    serde_json::from_str(&space.stdout(&["show", "w.toml", stage, "--table", name, "--json"])).unwrap()
}

fn column<'a>(table: &'a Value, name: &str) -> Vec<&'a Value> {
    let columns = table["columns"].as_array().unwrap_or_else(|| panic!("{table}"));
    let found = columns.iter().find(|column| column["name"] == name).unwrap_or_else(|| panic!("no {name} in {table}"));
    found["values"].as_array().unwrap().iter().collect()
}

fn numbers(table: &Value, name: &str) -> Vec<f64> {
    column(table, name).into_iter().map(|v| v.as_f64().unwrap_or(f64::NAN)).collect()
}

fn notes(space: &Space, stage: &str) -> String {
    table(space, stage, "notes").to_string()
}

#[test]
fn own_data_are_read_fitted_and_drawn() {
    let space = Space::new();
    space.write("w.toml", WORKFLOW);
    space.write("screened.csv", SCREENED);
    space.write("measured.csv", MEASURED);
    space.run(&[]);
    // st = K scn/(1 + ratio) with K = 0.6 + 0.1 ratio, exactly
    let groups = table(&space, "scale", "groups");
    let (slopes, ratios) = (numbers(&groups, "estimate"), numbers(&groups, "ratio"));
    assert_eq!(slopes.len(), 6);
    for (slope, ratio) in slopes.iter().zip(&ratios) {
        assert!((slope - 0.6 - 0.1 * ratio).abs() < 1e-9, "{slope} at {ratio}");
    }
    assert!(numbers(&groups, "r2").iter().all(|r| (r - 1.0).abs() < 1e-12));
    assert!(numbers(&groups, "constant").iter().all(|c| c.abs() < 1e-9));
    // the coefficients of the groups are the table of another fit: K rises by 0.1 with the ratio and not with the radius
    let rise = table(&space, "rise", "coefficients");
    let terms: Vec<&str> = column(&rise, "term").into_iter().filter_map(Value::as_str).collect();
    let rises = numbers(&rise, "estimate");
    assert_eq!(terms, ["const", "ratio", "R"]);
    assert!((rises[1] - 0.1).abs() < 1e-9 && rises[2].abs() < 1e-9, "{rises:?}");
    german_data_with_names(&space);
    for (figure, words) in [
        ("strengths", "20 points in 3 groups"),
        ("matrix", "2 × 3 cells"),
        ("spread", "median"),
        ("histogram", "values in"),
        ("half_normal", "active: A"),
    ] {
        let about = space.stdout(&["show", "w.toml", figure, "--json"]);
        let _ = words;
        assert!(about.contains("\"svg\""), "{figure}: {about}");
    }
}

fn german_data_with_names(space: &Space) {
    let said = notes(space, "screened");
    for word in ["semicolons", "decimal commas", "UTF-8 (its mark"] {
        assert!(said.contains(word), "{said}");
    }
    let effects = table(space, "screening", "effects");
    let significance: Vec<&str> = column(&effects, "significance").into_iter().filter_map(Value::as_str).collect();
    assert_eq!(significance[0], "significant");
    let limits = table(space, "screening", "limits");
    assert!(numbers(&limits, "critical")[0] > 2.0);
    // a category has one term per level but the first, and a word about it
    let fit = table(space, "cements", "coefficients");
    let terms: Vec<&str> = column(&fit, "term").into_iter().filter_map(Value::as_str).collect();
    assert_eq!(terms, ["const", "A", "cement[slag]"]);
    assert!(notes(space, "cements").contains("dummy coding"));
    let mixes = table(space, "mixes", "design");
    let mut cements: Vec<&str> = column(&mixes, "cement").into_iter().filter_map(Value::as_str).collect();
    cements.sort_unstable();
    assert_eq!(cements, ["OPC", "OPC", "slag", "slag"]);
    let variance = table(space, "variance", "anova");
    assert_eq!(numbers(&variance, "df")[..2], [1.0, 1.0]);
}

#[test]
fn faults_in_terms_are_found_before_anything_runs() {
    let space = Space::new();
    space.write("screened.csv", SCREENED);
    space.write("measured.csv", MEASURED);
    let message = |from: &str, to: &str| {
        let text = WORKFLOW.replace(from, to);
        assert_ne!(text, WORKFLOW, "{from}");
        space.write("w.toml", &text);
        let output = space.flow(&["check", "w.toml"]);
        assert!(!output.status.success(), "{to}: {}", told(&output));
        String::from_utf8(output.stderr).unwrap()
    };
    assert!(message("scn/(1+ratio)", "scn/(1+R)").contains("cannot be added"));
    assert!(message("scn/(1+ratio)", "scn/(1+ratoi)").contains("there is no [factor.ratoi]"));
    assert!(message("by = [\"R\", \"ratio\"]", "by = [\"R\", \"R\"]").contains("named twice"));
    assert!(message("[\"OPC\", \"slag\"]", "[\"OPC\", 2]").contains("numbers and names"));
    assert!(message("scn/(1+ratio)", "scn*exp(cement)").contains("levels are names"));
    assert!(message("fit = \"through-origin\"", "bins = 3").contains("`bins` has no effect"));
}
