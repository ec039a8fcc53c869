//! Inputs that went wrong once, each with the value that is right: `tests/cases/NAME`.

use crate::space::{Space, told};
use rustix::process::{Pid, Signal, kill_process};
use std::path::{Path, PathBuf};
use std::process::Stdio;
use std::time::Duration;

/// A space with the files of a case.
fn case(name: &str) -> Space {
    let space = Space::new();
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/cases").join(name);
    for entry in std::fs::read_dir(&folder).unwrap_or_else(|e| panic!("{}: {e}", folder.display())).flatten() {
        let text = std::fs::read_to_string(entry.path()).expect("a text file");
        space.write(entry.file_name().to_str().expect("a plain name"), &text);
    }
    space
}

/// What `flow check` says of a workflow that it refuses.
fn refused(space: &Space, workflow: &str) -> String {
    let output = space.flow(&["check", workflow]);
    assert_eq!(output.status.code(), Some(2), "{}", told(&output));
    told(&output)
}

/// A table of a stage as lines of CSV.
fn table(space: &Space, stage: &str, table: &str) -> Vec<Vec<String>> {
    let text = space.stdout(&["show", "w.toml", stage, "--csv", "--quiet", "--table", table]);
    text.lines().map(|line| line.split(',').map(str::to_owned).collect()).collect()
}

fn number(text: &str) -> f64 {
    text.parse().unwrap_or_else(|_| panic!("`{text}` is no number"))
}

#[test]
fn fracture_toughness_is_converted_by_the_root_of_the_length() {
    let space = case("unit-fractional-power");
    space.run(&[]);
    let lines = table(&space, "line", "coefficients");
    let place = lines[0].iter().position(|head| head == "estimate").expect("estimates");
    let root = 1000_f64.sqrt();
    for (line, expected) in lines[1..].iter().zip([0.516_666_666_666_666_7 * root, 0.5 * root]) {
        assert!((number(&line[place]) / expected - 1.0).abs() < 1e-12, "{lines:?}");
    }
    for unit in ["m^x", "MPa^", "m^300"] {
        let set = format!("response.KIC.unit={unit}");
        assert_eq!(space.flow(&["check", "w.toml", "--set", &set]).status.code(), Some(2), "{unit}");
    }
}

/// F and p of all six rows by statsmodels: 0.407, 0.558.
#[test]
fn rows_that_begin_with_a_hash_count() {
    let space = case("csv-hash-rows");
    space.run(&[]);
    let lines = table(&space, "an", "anova");
    let at = |head: &str| lines[0].iter().position(|own| own == head).expect("a column");
    assert!((number(&lines[1][at("f")]) - 0.407_331_975_560).abs() < 1e-9, "{lines:?}");
    assert!((number(&lines[1][at("p")]) - 0.558_035).abs() < 1e-6, "{lines:?}");
}

#[test]
fn formulas_mean_what_mathematics_means() {
    for (name, value) in [("power-tower", 512.0), ("nested-min-max", 1.0)] {
        let space = case(name);
        space.run(&[]);
        assert_eq!(number(&table(&space, "s", "runs")[1][1]), value, "{name}");
    }
}

#[test]
fn a_log_in_another_encoding_is_read_and_shown() {
    let space = case("output-not-utf8");
    let output = space.flow(&["run", "w.toml", "--keep-going"]);
    assert_eq!(output.status.code(), Some(1), "{}", told(&output));
    assert!(told(&output).contains(r"Lizenz ung\xFCltig: Fehler 17"), "{}", told(&output));
    assert_eq!(number(&table(&space, "good", "responses")[1][1]), 35.5);
}

#[test]
fn what_can_be_known_is_refused_before_anything_runs() {
    let units = refused(&case("check-misses-unit"), "w.toml");
    assert_eq!(units.matches("`y` comes in `kN` and cannot be shown in `MPa`").count(), 2, "{units}");
    let space = case("check-panic-nan-target");
    let place = refused(&space, "w.toml");
    assert!(place.contains("w.toml:56:18") && place.contains("`nan` is not a finite number"), "{place}");
    for target in ["inf", "-nan", "1e400", "\"nan MPa\"", "\"1e400\"", "[nan]"] {
        let set = format!("stage.calibrate.targets=[{{ y = {target} }}]");
        assert_eq!(space.flow(&["check", "w.toml", "--set", &set]).status.code(), Some(2), "{target}");
    }
    let runs = refused(&case("centre-points"), "w.toml");
    assert!(runs.contains("4294967310 runs"), "{runs}");
    let specimens = refused(&case("verify-replicates"), "w.toml");
    assert!(specimens.contains("4294967296 specimens"), "{specimens}");
}

#[test]
fn a_name_is_one_column() {
    let space = case("response-named-as-factor");
    assert!(refused(&space, "w.toml").contains("`E` is a factor and a response"));
    assert!(refused(&space, "simulate.toml").contains("`nu` is a factor and a response"));
    assert!(refused(&space, "failure.toml").contains("column that flow writes"));
    let text = std::fs::read_to_string(space.path("failure.toml")).expect("the workflow");
    for name in ["replicate", "validity", "Failure"] {
        space.write("other.toml", &text.replace("failure", name));
        assert!(refused(&space, "other.toml").contains("column that flow writes"), "{name}");
    }
}

#[test]
fn a_program_outside_the_key_is_remarked_on_and_can_be_run_again() {
    let space = case("engine-outside");
    let program = space.path("eng.py").display().to_string();
    let text = std::fs::read_to_string(space.path("w.toml")).expect("the workflow");
    space.write("w.toml", &text.replace("eng.py\"]", &format!("{program}\"]")).replace("python3", "cat"));
    let checked = space.flow(&["check", "w.toml"]);
    assert!(checked.status.success() && told(&checked).contains("outside the key"), "{}", told(&checked));
    space.write("eng.py", "y = 4.5");
    let value = |space: &Space| number(&table(space, "outside", "responses")[1][1]);
    space.run(&[]);
    assert_eq!(value(&space), 4.5);
    space.write("eng.py", "y = 7.5");
    space.run(&[]).expect(&[]);
    space.run(&["--again", "outside"]).expect(&[("outside", 1)]);
    assert_eq!(value(&space), 7.5);
    space.run(&[]).expect(&[]);
    assert_eq!(value(&space), 7.5);
    assert_eq!(space.flow(&["run", "w.toml", "--again", "other"]).status.code(), Some(2));
}

#[test]
fn a_campaign_goes_on_when_nobody_can_read_what_is_said_of_it() {
    let full = || Stdio::from(std::fs::OpenOptions::new().write(true).open("/dev/full").expect("/dev/full"));
    let space = case("stderr-gone");
    let status = space.command(&["run", "w.toml"]).stderr(full()).stdout(Stdio::null()).status().expect("flow");
    assert!(status.success(), "{status}");
    space.run(&[]).expect(&[]);
    // Faults that nobody reads are faults.
    let status = space.command(&["check", "none.toml"]).stderr(full()).stdout(full()).status().expect("flow");
    assert_eq!(status.code(), Some(2));
    // A result that cannot be written is no success.
    let status = space.command(&["show", "w.toml", "anova"]).stderr(full()).stdout(full()).status().expect("flow");
    assert_eq!(status.code(), Some(3));
    // A reader that has gone ends the command without a word.
    let mut child = space.start(&["show", "w.toml", "cmd", "--csv", "--table", "runs"]);
    drop(child.stdout.take());
    assert!(child.wait().expect("flow").code() == Some(0));
}

#[test]
fn text_stays_text_in_printed_tables() {
    let space = case("latex-dollar");
    space.run(&[]);
    space.stdout(&["export", "w.toml", "tab", "--quiet"]);
    let tex = std::fs::read_to_string(space.path("export/tab.tex")).expect("the table");
    assert!(tex.contains(r"\caption{Costs in \$ \& 100 \% \textbackslash{}input\{/etc/hostname\}}"), "{tex}");
    assert!(tex.contains(r"5 \$ \& \textbackslash{}input\{/etc/hostname\} 100\% \#1 & 1"), "{tex}");
    assert!(tex.contains(r"a \$x\$ b \& c & 2") && tex.contains(r"two \$ signs \& \$ & 3"), "{tex}");
}

#[test]
fn names_are_drawn_as_they_are() {
    let space = case("name-as-tex");
    space.run(&[]);
    space.stdout(&["export", "w.toml", "--quiet"]);
    let drawn = std::fs::read_to_string(space.path("export/me.svg")).expect("the figure");
    assert!(drawn.contains("bond_gap_max") && drawn.contains("kn_ks"), "{drawn}");
    let tex = std::fs::read_to_string(space.path("export/t2.tex")).expect("the table");
    assert!(tex.contains(r"bond\_gap\_max"), "{tex}");
}

/// Twenty thousand columns: what takes a second column by column takes an hour pair by pair.
#[test]
fn a_wide_table_comes_back_whole() {
    let space = case("wide-csv");
    let count = 20_000;
    let line = |cell: &dyn Fn(usize) -> String| (0..count).map(cell).collect::<Vec<_>>().join(",");
    let file = [line(&|i| format!("c{i}")), line(&|i| i.to_string()), line(&|_| "2".to_owned())].join("\n") + "\n";
    space.write("rows.csv", &file);
    space.run(&[]);
    assert_eq!(space.stdout(&["show", "w.toml", "d", "--csv", "--quiet"]), file);
    assert!(space.stdout(&["show", "w.toml", "d", "--quiet"]).contains("19800 more columns"));
}

/// The folders of runs below a folder.
fn folders(below: &Path) -> Vec<PathBuf> {
    std::fs::read_dir(below).expect("a folder").flatten().map(|entry| entry.path()).collect()
}

#[test]
fn what_a_killed_campaign_left_is_ended_removed_and_told() {
    let space = case("orphan-after-kill");
    std::fs::create_dir(space.path("scratch")).expect("a folder");
    // Campaigns of other tests, which run at the same time, sweep as well: one of some tries goes undisturbed.
    let undisturbed = (0..10).any(|_| {
        let mut run = space.command(&["run", "w.toml", "--quiet"]);
        let mut child = run.env("TMPDIR", space.path("scratch")).spawn().expect("flow");
        while folders(&space.path("scratch")).is_empty() {
            std::thread::sleep(Duration::from_millis(10));
        }
        std::thread::sleep(Duration::from_millis(300));
        child.kill().expect("killing flow");
        child.wait().expect("flow");
        let dry = told(&space.flow(&["store", "gc", "w.toml"]));
        let left = folders(&space.path("scratch")).len();
        let swept = told(&space.flow(&["store", "gc", "w.toml", "--yes"]));
        assert_eq!(folders(&space.path("scratch")), Vec::<PathBuf>::new());
        dry.contains("would end what") && left == 1 && swept.contains("a campaign that was killed left")
    });
    assert!(undisturbed, "a dry run says what it would end and removes nothing; a sweep removes it and says so");
}

#[test]
fn a_file_that_is_no_plain_file_is_refused_and_not_waited_for() {
    let space = case("csv-hash-rows");
    std::fs::remove_file(space.path("d.csv")).expect("removing");
    assert!(refused(&space, "w.toml").contains("there is no such file"));
    let made = std::process::Command::new("mkfifo").arg(space.path("d.csv")).status().expect("mkfifo");
    assert!(made.success());
    assert!(refused(&space, "w.toml").contains("a pipe or a device"));
    assert_eq!(space.flow(&["run", "w.toml", "an"]).status.code(), Some(1));
    let made = std::process::Command::new("mkfifo").arg(space.path("pipe.toml")).status().expect("mkfifo");
    assert!(made.success());
    assert!(refused(&space, "pipe.toml").contains("is a pipe"));
}

/// A formula that scatters by 10 % about 12: the interval has a width, and holds the truth.
#[test]
fn a_noisy_simulator_gives_an_interval_with_a_width() {
    let space = case("zero-width-interval");
    let output = space.flow(&["run", "w.toml"]);
    assert!(output.status.success(), "{}", told(&output));
    let rows = table(&space, "one", "prediction");
    let at = |name: &str| {
        let place = rows[0].iter().position(|own| own == name).unwrap_or_else(|| panic!("no `{name}`: {rows:?}"));
        number(&rows[1][place])
    };
    // The scatter of a run is 1.2; of the mean of many it is less.
    assert!(at("high") - at("low") > 0.05, "{rows:?}");
    assert!(at("low") < 12.0 && 12.0 < at("high"), "{rows:?}");
    assert!((at("scatter") - 1.2).abs() < 0.2, "{rows:?}");
}

/// A run without a peak says so wherever its numbers are, and has none, as the failed row of a table has none.
#[test]
fn a_single_run_without_a_result_says_so_everywhere() {
    let space = case("single-run-failure");
    let failure = "no peak up to a strain of 2e-9: the largest stress is 0 Pa";
    let output = space.flow(&["run", "w.toml"]);
    assert!(told(&output).contains(&format!("note: none: the run gave no result: {failure}")), "{}", told(&output));
    let shown = space.flow(&["show", "w.toml", "none"]);
    assert!(told(&shown).contains(&format!("warning: none: the run gave no result: {failure}")), "{}", told(&shown));
    let rows = table(&space, "none", "responses");
    assert_eq!(rows[0], ["response", "value", "unit", "failure", "cautions"], "{rows:?}");
    assert!(rows.iter().any(|row| row[..3] == ["UCS", "", "MPa"] && row[3].contains(failure)), "{rows:?}");
    space.stdout(&["export", "w.toml", "none", "--quiet"]);
    let csv = std::fs::read_to_string(space.path("export/none.responses.csv")).expect("the responses");
    assert!(csv.contains("UCS,,MPa,\"no peak") && !csv.contains("UCS,0"), "{csv}");
    space.stdout(&["report", "w.toml", "-o", "page.html"]);
    let page = std::fs::read_to_string(space.path("page.html")).expect("the page");
    assert!(page.contains(failure), "the report lacks the failure");
}

/// One sample of this test takes longer than anybody waits: Ctrl-C ends it all the same, and its bound on steps would.
#[test]
fn a_test_that_hardly_moves_is_refused_or_ends_when_it_is_told() {
    let space = case("ctrl-c-ignored");
    let output = space.flow(&["run", "w.toml"]);
    assert_eq!(output.status.code(), Some(1), "{}", told(&output));
    assert!(told(&output).contains("steps of 2.1e-7 s, above max_steps = 2.0e7"), "{}", told(&output));
    let slow = ["--set", "stage.run.max_steps=1000000000", "--set", "stage.run.platen_speed=\"0.5 um/s\""];
    let mut run = space.start(&[&["run", "w.toml", "--jobs", "1"], &slow[..]].concat());
    // Long enough to be within the first sample, which takes millions of steps.
    std::thread::sleep(Duration::from_millis(1500));
    assert!(run.try_wait().expect("a child").is_none(), "the run ended before the interrupt");
    kill_process(Pid::from_child(&run), Signal::INT).expect("sending a signal");
    for _ in 0..6000 {
        if run.try_wait().expect("a child").is_some() {
            break;
        }
        std::thread::sleep(Duration::from_millis(10));
    }
    let ended = run.try_wait().expect("a child").is_some();
    let _ = run.kill();
    let output = run.wait_with_output().expect("the end of the run");
    assert!(ended && output.status.code() == Some(130), "{}", told(&output));
}

/// The seating stress scales with the strength that can be expected.
#[test]
fn a_weak_mortar_has_its_tensile_strength() {
    let space = case("weak-tension");
    space.run(&[]);
    for stage in ["t", "t2"] {
        let rows = table(&space, stage, "responses");
        let row = rows.iter().find(|row| row[0] == "sigma_t").expect("a strength");
        assert!(row[2] == "MPa" && (number(&row[1]) - 0.347).abs() < 0.0005, "{rows:?}");
    }
}

/// By hand: the means over p are 1.25, 2.2 and 3.25, those over E2 1.96667 and 2.5, the mean of all 2.23333.
#[test]
fn levels_are_equal_in_every_unit() {
    let space = case("level-after-conversion");
    space.run(&[]);
    let rows = table(&space, "an", "anova");
    let at = |head: &str| rows[0].iter().position(|own| own == head).expect("a column");
    for (row, source, squares) in [(1, "p", 2.0 * 2.001_666_666_666), (2, "E2", 1.5 * 0.533_333_333_333_f64.powi(2))] {
        assert_eq!(rows[row][at("source")], source);
        assert!((number(&rows[row][at("ss")]) - squares).abs() < 1e-9, "{rows:?}");
    }
}

#[test]
fn every_reader_of_a_column_converts_it() {
    let space = case("table-ignores-unit");
    space.run(&[]);
    for stage in ["t", "t2"] {
        let rows = table(&space, stage, "table");
        assert_eq!(rows[0], ["n", "UCS [MPa]", "UCS published [MPa]", "UCS deviation [%]"]);
        for (row, value) in rows[1..].iter().zip([31.0, 32.0, 33.0]) {
            assert_eq!([&row[1], &row[2], &row[3]].map(|cell| number(cell)), [value, value, 0.0], "{rows:?}");
        }
    }
    for row in &table(&space, "cmp", "pairs")[1..] {
        assert_eq!(number(row.last().expect("a ratio")), 1.0);
    }
    space.stdout(&["run", "figures.toml", "--quiet"]);
    let points = space.stdout(&["show", "figures.toml", "pts", "--table", "data", "--csv", "--quiet"]);
    assert!(points.starts_with("Ec [GPa],s [MPa],") && points.contains("\n12,12,"), "{points}");
}

#[test]
fn a_specimen_that_cannot_be_is_refused_with_its_numbers() {
    let discs = refused(&case("unbounded-discs"), "w.toml");
    assert!(discs.contains("a mean radius of 1 nm gives 1.40e15 balls") && discs.contains("GB"), "{discs}");
    let none = refused(&case("zero-aggregate"), "w.toml");
    assert!(none.contains("every size class rounds to no particle at all"), "{none}");
}

/// Numbers of any magnitude: what the labels have in common stands in the title, in the contour lines too.
#[test]
fn labels_of_ticks_are_short_and_whole() {
    let space = case("tick-overlap");
    let output = space.flow(&["run", "w.toml"]);
    assert!(output.status.success() && !told(&output).contains("warning:"), "{}", told(&output));
    space.stdout(&["export", "w.toml", "--quiet"]);
    let drawn = |name: &str| std::fs::read_to_string(space.path(&format!("export/{name}.svg"))).expect("a figure");
    let labels = |svg: &str| svg.matches("aria-label=\"").count();
    for (name, common) in [("me", "near / MPa (+100000)"), ("co", "+100000.2"), ("obs", "neg (×10⁹)")] {
        let svg = drawn(name);
        assert!(svg.contains(common) && labels(&svg) > 5, "{name}: {svg}");
        let long = |label: &&str| label.chars().filter(char::is_ascii_digit).count() > 7;
        let all = svg.split("aria-label=\"").skip(1).filter_map(|rest| rest.split('"').next());
        assert_eq!(all.filter(|label| !label.contains('(')).find(long), None, "{name}");
    }
}
