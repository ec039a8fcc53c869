//! Which edit runs what again: each line of the README's table.

use crate::space::{Ran, Space};

const CAMPAIGN: &str = include_str!("campaign.toml");

/// The campaign, run once.
fn space() -> (Space, Ran) {
    let space = Space::new();
    space.write("w.toml", CAMPAIGN);
    let first = space.run(&[]);
    first.expect(&[
        ("grid", 1),
        ("table", 10),
        ("range", 1),
        ("anova", 1),
        ("faces", 1),
        ("ccd", 3),
        ("surfaces", 1),
        ("calibrate", 1),
        ("verify", 4),
        ("effects", 1),
        ("means", 1),
    ]);
    (space, first)
}

fn edited(from: &str, to: &str) -> String {
    assert!(CAMPAIGN.contains(from), "the campaign has no `{from}`");
    CAMPAIGN.replace(from, to)
}

#[test]
fn a_comment_or_the_order_of_stages_is_nothing() {
    let (space, first) = space();
    space.run(&[]).expect(&[]);
    space.write("w.toml", &edited("[workflow]", "# a remark\n\n[workflow]   # another"));
    let again = space.run(&[]);
    again.expect(&[]);
    assert_eq!(again.objects, first.objects);
    let (head, tail) = CAMPAIGN.split_once("[stage.means]").expect("the last stage");
    let (before, after) = head.split_once("[stage.grid]").expect("the first stage");
    space.write("w.toml", &format!("{before}[stage.means]{tail}\n[stage.grid]{after}"));
    space.run(&[]).expect(&[]);
}

#[test]
fn the_name_of_a_stage_is_nothing() {
    let (space, _) = space();
    space.write("w.toml", &CAMPAIGN.replace("\"surfaces\"", "\"models\"").replace("stage.surfaces", "stage.models"));
    space.run(&[]).expect(&[]);
}

#[test]
fn the_style_of_a_figure_draws_that_figure() {
    let (space, _) = space();
    space.write("w.toml", &edited("show = \"main-effects\"", "show = \"main-effects\"\nwidth = \"double\""));
    space.run(&[]).expect(&[("effects", 1)]);
}

#[test]
fn a_symbol_draws_the_figures_and_prints_the_tables_that_show_it() {
    let (space, _) = space();
    space.write("w.toml", &edited("symbol = 'a'", "symbol = '\\alpha'"));
    space.run(&[]).expect(&[("effects", 1), ("means", 1)]);
}

#[test]
fn a_target_calibrates_and_verifies() {
    let (space, _) = space();
    space.write("w.toml", &edited("16 MPa", "17 MPa"));
    space.run(&[]).expect(&[("calibrate", 1), ("verify", 4)]);
}

#[test]
fn one_level_runs_what_has_it_and_what_follows() {
    let (space, _) = space();
    // 3 of the 9 rows of the grid have it; the composite design lies on the ends and middle of the range.
    space.write("w.toml", &edited("levels = [10, 20, 30]", "levels = [10, 21, 30]"));
    space.run(&[]).expect(&[("grid", 1), ("table", 4), ("range", 1), ("anova", 1), ("effects", 1), ("means", 1)]);
}

#[test]
fn words_and_levels_of_significance_run_the_anova_and_what_reads_it() {
    let (space, _) = space();
    space.run(&["--set", "stage.anova.words=[\"*\", \"**\"]"]).expect(&[("anova", 1), ("means", 1)]);
    // No p lies between the two levels: the same words, so the table is as it was.
    space.run(&["--set", "stage.anova.alpha=0.04"]).expect(&[("anova", 1)]);
}

#[test]
fn adding_a_level_runs_only_the_new_rows() {
    let (space, _) = space();
    space.write("w.toml", &edited("levels = [1, 2, 3]", "levels = [1, 2, 3, 4]"));
    // The range grows with the levels, so the composite design moves: its centre is another, 6 of its rows are new.
    space.run(&[]).expect(&[
        ("grid", 1),
        ("table", 4),
        ("range", 1),
        ("anova", 1),
        ("faces", 1),
        ("ccd", 6),
        ("surfaces", 1),
        ("calibrate", 1),
        ("verify", 4),
        ("effects", 1),
        ("means", 1),
    ]);
}

#[test]
fn an_equal_result_stops_the_wave() {
    let (space, first) = space();
    space.write("w.toml", &edited("3*a + b*b/100 + 7", "7 + 3*a + b*b/100"));
    // Other formulas, equal values: the runs are computed (9 rows, 2 more replicates of the centre, 3 of the solution), and
    // nothing that gathers or reads them.
    let ran = space.run(&[]);
    ran.expect(&[("table", 9), ("ccd", 2), ("verify", 3)]);
    assert_eq!(ran.objects, first.objects);
}

#[test]
fn the_density_of_the_discs_runs_everything_from_the_specimen() {
    const SMALL: &str = include_str!("small.toml");
    let space = Space::new();
    space.write("w.toml", SMALL);
    let first = space.run(&[]);
    let (density, other) = ("density = \"2000 kg/m^3\"", "density = \"2100 kg/m^3\"");
    assert!(SMALL.contains(density));
    space.write("w.toml", &SMALL.replace(density, other));
    // Two fresh specimens, a test on each, and their summary; what rests on formulas, or on sizes alone, is as it was.
    let again = space.run(&[]);
    again.expect(&[("specimen", 1), ("trial", 1), ("verify", 5), ("chains", 1)]);
    let changed: Vec<&str> =
        first.objects.iter().zip(&again.objects).filter(|(a, b)| a != b).map(|(a, _)| a.0.as_str()).collect();
    assert_eq!(changed, ["specimen", "trial", "verify", "chains"]);
}

#[test]
fn a_value_changed_back_costs_nothing() {
    let (space, first) = space();
    space.run(&["--set", "stage.calibrate.evaluations=500"]).expect(&[("calibrate", 1), ("verify", 4)]);
    let back = space.run(&[]);
    back.expect(&[]);
    assert_eq!(back.objects, first.objects);
}

#[test]
fn two_empty_stores_and_any_number_of_workers_give_the_same_objects_byte_for_byte() {
    let bytes = |jobs: &str| {
        let space = Space::new();
        space.write("w.toml", CAMPAIGN);
        space.run(&["--jobs", jobs]);
        let files = space.objects();
        assert!(files.len() > 20);
        let name = |path: &std::path::Path| path.file_name().map(std::ffi::OsStr::to_owned);
        files.iter().map(|path| (name(path), std::fs::read(path).expect("an object"))).collect::<Vec<_>>()
    };
    assert_eq!(bytes("1"), bytes("8"));
}

#[test]
fn plan_says_what_run_does() {
    let (space, _) = space();
    space.write("w.toml", &edited("16 MPa", "17 MPa"));
    let plan = space.stdout(&["plan", "w.toml"]);
    assert!(plan.contains("calibrate") && plan.contains("1 to run"), "{plan}");
    assert!(plan.contains("16 → 17"), "the reason is the old and new target: {plan}");
    space.run(&[]).expect(&[("calibrate", 1), ("verify", 4)]);
    assert!(!space.stdout(&["plan", "w.toml"]).contains("to run"));
}

#[test]
fn gc_keeps_what_the_workflow_reaches_and_asks_first() {
    let (space, _) = space();
    space.run(&["--set", "stage.calibrate.evaluations=500"]);
    let before = space.objects().len();
    space.stdout(&["store", "gc", "w.toml"]);
    assert_eq!(space.objects().len(), before, "a dry run removes nothing");
    let said = space.stdout(&["store", "gc", "w.toml", "--yes"]);
    let gone = before - space.objects().len();
    assert!(gone > 0 && said.contains(&format!("removed {gone} results")), "{said}");
    let memos = |word: &str| said.lines().any(|line| line.starts_with("removed") && line.contains(word));
    assert!(memos("memos"), "{said}");
    space.run(&[]).expect(&[]);
    assert!(space.stdout(&["store", "verify"]).contains("are sound"));
}

#[test]
fn runs_are_compared() {
    let (space, _) = space();
    space.run(&["--set", "stage.anova.alpha=0.2"]);
    let diff = space.stdout(&["diff", "#1", "#2"]);
    assert!(diff.contains("alpha"), "{diff}");
    assert_eq!(space.stdout(&["diff", "#1", "w.toml"]).trim(), "no difference");
}
