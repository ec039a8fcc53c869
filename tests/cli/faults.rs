//! Faults that a campaign must survive.

use crate::space::{Space, told};

const CAMPAIGN: &str = r#"
[workflow]
seed = 1
[stage.first]
kind = "command"
run = ["sh", "-c", "echo 1"]
read.y = { file = "stdout", pattern = '(\d+)' }
"#;

#[test]
fn a_damaged_object_is_set_aside_told_and_computed_again() {
    let space = Space::new();
    space.write("w.toml", CAMPAIGN);
    let first = space.run(&[]);
    let path = space.objects().remove(0);
    for damage in ["", "nonsense"] {
        std::fs::write(&path, damage).expect("damaging an object");
        let shown = space.flow(&["show", "w.toml", "first"]);
        assert!(!shown.status.success(), "{}", told(&shown));
        let again = space.run(&[]);
        again.expect(&[("first", 1)]);
        assert_eq!(again.objects, first.objects);
    }
}

#[test]
fn a_folder_that_is_no_store_is_told_with_exit_code_3() {
    let space = Space::new();
    space.write("w.toml", CAMPAIGN);
    space.write("store", "a file");
    let output = space.flow(&["run", "w.toml"]);
    assert_eq!(output.status.code(), Some(3), "{}", told(&output));
}

/// Rows by a formula on a design of three levels.
fn fan_out(levels: &str, value: &str) -> String {
    format!(
        r#"
[workflow]
seed = 1
[factor]
a = {{ sets = "mortar.a", levels = {levels} }}
[response]
y = {{ unit = "MPa" }}
[material.base]
mortar = {{ a = 1 }}
[stage.grid]
kind = "design"
method = "full-factorial"
factors = ["a"]
[stage.rows]
kind = "formula"
design = "grid"
material = "base"
responses.y = {{ value = "{value}", unit = "Pa" }}
"#
    )
}

/// The file of the object whose task names this work.
fn object_of(space: &Space, work: &str) -> std::path::PathBuf {
    let line = format!("work {work} ");
    let holds = |path: &std::path::PathBuf| {
        let bytes = std::fs::read(path).expect("an object");
        bytes.windows(line.len()).any(|window| window == line.as_bytes())
    };
    space.objects().into_iter().find(holds).expect("an object of this work")
}

#[test]
fn a_result_that_a_stage_must_see_is_computed_again_in_the_same_run() {
    let space = Space::new();
    space.write("w.toml", &fan_out("[1, 2, 3]", "3*a"));
    let first = space.run(&[]);
    std::fs::write(object_of(&space, "design"), "nonsense").expect("damaging an object");
    space.write("w.toml", &fan_out("[1, 2, 3]", "4*a"));
    let again = space.run(&[]);
    again.expect(&[("grid", 1), ("rows", 4)]);
    assert_eq!(again.objects[0], first.objects[0]);
    assert!(space.stdout(&["store", "verify"]).contains("are sound"));
}

#[test]
fn a_task_input_that_is_lost_is_computed_again_in_the_same_run() {
    let space = Space::new();
    space.write("w.toml", &fan_out("[1, 2, 3]", "3*a"));
    space.run(&[]);
    std::fs::write(object_of(&space, "formula"), "").expect("damaging an object");
    // Another unit of the table: only gathering is new, and it reads all runs.
    space.write("w.toml", &fan_out("[1, 2, 3]", "3*a").replace("y = { unit = \"MPa\" }", "y = { unit = \"kPa\" }"));
    space.run(&[]).expect(&[("rows", 2)]);
}

#[test]
fn remembered_runs_give_the_table_that_all_runs_give() {
    let (space, fresh) = (Space::new(), Space::new());
    let changed = fan_out("[1, 2.5, 3, 4]", "if_large");
    let formula = "1/max(0, a - 2)"; // No value at a = 1 and 2: these runs fail.
    let changed = changed.replace("if_large", formula);
    space.write("w.toml", &fan_out("[1, 2, 3, 4]", formula));
    space.run(&[]);
    space.write("w.toml", &changed);
    fresh.write("w.toml", &changed);
    let (ran, all) = (space.run(&[]), fresh.run(&[]));
    ran.expect(&[("grid", 1), ("rows", 2)]);
    assert_eq!(ran.objects, all.objects);
    let files =
        |space: &Space| space.objects().iter().map(|p| p.file_name().map(ToOwned::to_owned)).collect::<Vec<_>>();
    assert!(files(&fresh).iter().all(|name| files(&space).contains(name)));
}

/// Everything a command says on standard error.
fn complaint(space: &Space, arguments: &[&str], code: i32) -> String {
    let started = std::time::Instant::now();
    let output = space.flow(arguments);
    assert_eq!(output.status.code(), Some(code), "{arguments:?}: {}", told(&output));
    // Far above what it takes, and far below what reading all of a hostile input would.
    assert!(started.elapsed().as_secs() < 20, "{arguments:?}");
    String::from_utf8_lossy(&output.stderr).into_owned()
}

#[test]
fn hostile_files_are_refused_with_place_and_remedy() {
    let space = Space::new();
    let design = |unit: &str, levels: &str, options: &str| {
        format!(
            "[workflow]\nseed = 1\n[factor]\na = {{ sets = \"m.E\", unit = \"{unit}\", levels = {levels} }}\n\
             [material.base]\nm = {{ E = \"20 GPa\" }}\n[stage.d]\nkind = \"design\"\nfactors = [\"a\"]\n{options}\n"
        )
    };
    let deep = format!("[workflow]\nseed = 1\nx = {}{}\n", "[".repeat(100_000), "]".repeat(100_000));
    let cases: &[(&str, &str, &[&str])] = &[
        ("empty", "", &["w.toml: the file is empty", "[workflow]"]),
        ("deep", &deep, &["nested too deeply", "w.toml:3:", "32 levels"]),
        (
            "cycle",
            "[workflow]\nseed = 1\n[stage.a]\nkind = \"table\"\nof = \"b\"\n[stage.b]\nkind = \"table\"\nof = \"a\"\n",
            &["in a circle: a → b → a", "w.toml:5:6", "^^^"],
        ),
        (
            "duplicate",
            "[workflow]\nseed = 1\n[stage.a]\nkind = \"data\"\nfile = \"a\"\n[stage.a]\nkind = \"data\"\n",
            &["`a` stands here a second time", "w.toml:6:8", "give it another name"],
        ),
        (
            "unit",
            &design("widget", "[1, 2]", "method = \"full-factorial\""),
            &["`widget` is not a unit", "w.toml:4:", "1 fault;"],
        ),
        (
            "kind of unit",
            &design("kg", "[1, 2]", "method = \"full-factorial\""),
            &["factor `a` is in kg, and `m.E`, which it sets, is not", "w.toml:4:", "[material.base]"],
        ),
        (
            "parameter",
            &design("GPa", "[1, 2]", "method = \"full-factorial\"").replace("m.E", "m.F"),
            &["no material and no stage has `m.F`, which factor `a` sets", "w.toml:4:", "`m.E`"],
        ),
        (
            "NaN",
            &design("GPa", "[1, nan]", "method = \"full-factorial\""),
            &["`nan` is not a finite number", "w.toml:4:", "1 fault;"],
        ),
        ("no levels", &design("GPa", "[]", "method = \"full-factorial\""), &["neither levels nor a range", "1 fault;"]),
        ("no rows", &design("GPa", "[1, 2]", "method = \"sobol\"\nruns = 0"), &["`runs` is 0", "w.toml:11:8"]),
        (
            "no given rows",
            &design("GPa", "[1, 2]", "method = \"given\"\nrows = []"),
            &["`rows` is empty", "at least one row"],
        ),
        (
            "many rows",
            &design("GPa", "[1, 2]", "method = \"sobol\"\nruns = 10000000"),
            &["`runs` is 10000000", "w.toml:11:8", "1 to 1048576"],
        ),
        (
            "many replicates",
            &design("GPa", "[1, 2]", "method = \"full-factorial\"\nreplicates = 10000000"),
            &["`replicates` is 10000000", "w.toml:11:14", "at most 1048576"],
        ),
    ];
    for (name, text, wanted) in cases {
        space.write("w.toml", text);
        let found = complaint(&space, &["check", "w.toml"], 2);
        let lacking: Vec<_> = wanted.iter().filter(|part| !found.contains(**part)).collect();
        assert!(lacking.is_empty(), "{name}: {lacking:?} not in\n{found}");
        assert_eq!(complaint(&space, &["run", "w.toml"], 2), found, "{name}");
    }
    std::fs::write(space.path("w.toml"), [b"[workflow]\nseed".as_slice(), &[0xff; 1000]].concat()).expect("a file");
    assert!(complaint(&space, &["check", "w.toml"], 2).contains("byte 15, in line 2, is not UTF-8"));
    space.write("w.toml", &"# a remark that goes on and on\n".repeat(50 << 20 >> 5));
    assert!(complaint(&space, &["check", "w.toml"], 2).contains("larger than 1 MiB"));
    assert!(!space.path("store").exists(), "nothing was run");
}

#[test]
fn a_table_of_ten_million_rows_is_refused() {
    let space = Space::new();
    space.write("w.toml", "[workflow]\nseed = 1\n[stage.d]\nkind = \"data\"\nfile = \"rows.csv\"\n");
    space.write("rows.csv", &format!("a\n{}", "1\n".repeat(10_000_000)));
    assert!(complaint(&space, &["run", "w.toml"], 1).contains("more than 1048576 rows"));
}

#[test]
fn slips_on_the_command_line_are_told_with_what_is_there() {
    let space = Space::new();
    space.write("w.toml", &fan_out("[1, 2, 3]", "3*a"));
    space.write("file", "");
    std::fs::create_dir(space.path("folder")).expect("a folder");
    let cases: &[(&[&str], i32, &str)] = &[
        (&["run", "folder"], 2, "name the workflow file in this folder"),
        (&["run", "nothing.toml"], 2, "`flow new NAME` writes a workflow to start from"),
        (&["run", "w.toml", "--store", "file"], 3, "file is not a store: it is not a folder"),
        (&["run", "w.toml", "--store", "file/deeper"], 3, "a part of the path is a file"),
        (&["run", "w.toml", "row"], 2, "no stage `row`; did you mean `rows`?"),
        (&["run", "w.toml", "--profile", "quick"], 2, "there is no profile `quick`"),
        (&["run", "w.toml", "--set", "stage.rows.desing=1"], 2, "did you mean `design`?"),
        (&["run", "w.toml", "--set", "stage.none.design=1"], 2, "known stages: `grid`, `rows`"),
        (&["run", "w.toml", "--set", "workflow.seed=x"], 2, "found the text \"x\""),
        (&["run", "w.toml", "--set", "seed"], 2, "`seed` has no `=`"),
        (&["diff", "#7", "w.toml"], 2, "no recorded run #7"),
        (&["diff", "7", "w.toml"], 2, "the recorded run 7 is written '#7'"),
        (&["run", "w.toml", "--jobs", "0"], 2, "a whole number of 1 or more"),
        (&["run", "w.toml", "--executor", "pbs"], 2, "[possible values: threads, slurm]"),
    ];
    for (arguments, code, wanted) in cases {
        let found = complaint(&space, arguments, *code);
        assert!(found.contains(wanted), "{arguments:?}: {found}");
    }
    assert!(space.stdout(&["show", "w.toml"]).lines().all(|line| line.contains("no result yet (open)")));
    space.run(&[]);
    assert!(complaint(&space, &["show", "w.toml", "rows[4]"], 2).contains("`rows` has 3 rows"));
    let list = space.stdout(&["show", "w.toml"]);
    let words: Vec<Vec<&str>> = list.lines().map(|line| line.split_whitespace().collect()).collect();
    assert_eq!(
        words,
        [vec!["grid", "design", "coded,", "design,", "report"], vec!["rows", "formula", "runs"]],
        "{list}"
    );
    let whole = complaint(&space, &["show", "w.toml", "grid[1]"], 2);
    assert!(whole.contains("`grid` is one result and has no rows; see flow show w.toml grid"), "{whole}");
}

/// The command that the summary of a failed run ends with, typed into a shell.
#[test]
fn the_summary_of_a_failure_gives_the_very_command_that_runs_it_again() {
    let space = Space::new();
    let workflow = fan_out("[1, 2, 3]", "3*a") + "[profile.'a few']\nfactor.a.levels = [1, 2]\n";
    space.write("it's.toml", &workflow.replace("3*a", "1/max(0, a - 1)"));
    space.write("bad.toml", &format!("{workflow}[stage.shell]\nkind = \"command\"\nrun = [\"sh\", \"-c\", \"exit 3\"]\nread.y = {{ file = \"y\", pattern = '(.)', unit = \"MPa\" }}\n"));
    let options =
        ["--profile", "a few", "--set", "stage.shell.run=[\"sh\", \"-c\", \"exit 4 # it's\"]", "--store", "my store"];
    let output = space.flow(&[&["run", "bad.toml", "--keep-going"], &options[..]].concat());
    assert_eq!(output.status.code(), Some(1), "{}", told(&output));
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    let again = said.lines().find_map(|line| line.trim().strip_prefix("again: flow ")).expect("a command").to_owned();
    assert_eq!(
        again,
        "run bad.toml shell --profile 'a few' --set 'stage.shell.run=[\"sh\", \"-c\", \"exit 4 # it'\\''s\"]' --store 'my store'"
    );
    let shell = std::process::Command::new("sh")
        .args(["-c", &format!("\"$0\" {again}"), env!("CARGO_BIN_EXE_flow")])
        .current_dir(space.path("."))
        .output()
        .expect("a shell");
    assert!(String::from_utf8_lossy(&shell.stderr).contains("again: flow "), "{}", told(&shell));
}

#[test]
fn the_record_of_a_run_names_the_commit_of_the_workflow() {
    let space = Space::new();
    let git = |arguments: &[&str]| {
        let mut git = std::process::Command::new("git");
        git.args(["-c", "user.name=a", "-c", "user.email=a@b.c"]).args(arguments).current_dir(space.path("."));
        git.output().is_ok_and(|output| output.status.success())
    };
    let told = |number: &str| {
        let output = space.flow(&["diff", number, number]);
        String::from_utf8_lossy(&output.stderr).into_owned()
    };
    space.write("w.toml", CAMPAIGN);
    let plain = space.run(&[]);
    assert!(!told("#1").contains("commit"), "{}", told("#1"));
    if !git(&["init", "-q"]) {
        return; // A machine without git.
    }
    assert!(git(&["add", "w.toml"]) && git(&["commit", "-q", "-m", "a campaign"]));
    let set = |y: &str| format!("stage.first.run=[\"echo\", \"{y}\"]");
    space.run(&["--set", &set("2")]);
    let commit = told("#2");
    let hash = commit.rsplit("git commit ").next().unwrap_or_default().trim();
    assert!(hash.len() == 40 && hash.bytes().all(|byte| byte.is_ascii_hexdigit()), "{commit}");
    space.write("w.toml", &format!("{CAMPAIGN}# a remark\n"));
    space.run(&["--set", &set("3")]);
    assert!(told("#3").contains(&format!("{hash}-dirty")), "{}", told("#3"));
    // It is no part of any key.
    let again = space.run(&[]);
    again.expect(&[]);
    assert_eq!(again.objects, plain.objects);
}

#[test]
fn quiet_leaves_results_and_errors_only() {
    let space = Space::new();
    space.write("w.toml", &fan_out("[1, 2, 3]", "3*a"));
    let silent = |arguments: &[&str]| {
        let output = space.flow(arguments);
        assert!(output.status.success() && output.stderr.is_empty(), "{arguments:?}: {}", told(&output));
        output.stdout.is_empty()
    };
    for silence in
        [&["check", "w.toml", "--quiet"][..], &["run", "w.toml", "--quiet"], &["report", "w.toml", "--quiet"]]
    {
        assert!(silent(silence), "{silence:?}");
    }
    assert!(silent(&["export", "w.toml", "--quiet"]));
    for result in
        [&["show", "w.toml", "rows", "--quiet"][..], &["plan", "w.toml", "--quiet"], &["graph", "w.toml", "--quiet"]]
    {
        assert!(!silent(result), "{result:?}");
    }
    assert!(!silent(&["diff", "#1", "w.toml", "--quiet"]) && !silent(&["store", "du", "--quiet"]));
}

#[test]
fn a_run_ends_with_what_a_reader_must_not_miss() {
    let space = Space::new();
    space.write("w.toml", &fan_out("[1, 2, 3]", "1/max(0, a - 1)"));
    let said = |output: &std::process::Output| String::from_utf8_lossy(&output.stderr).into_owned();
    let first = said(&space.flow(&["run", "w.toml"]));
    assert!(first.contains("note: rows: 1 of 3 runs gave no result: `y` is inf (1)"), "{first}");
    assert!(!said(&space.flow(&["run", "w.toml"])).contains("note:"), "nothing ran, so nothing is new");
}

#[test]
fn warnings_stay_on_the_screen_before_the_long_work_and_are_shown_with_the_result() {
    let space = Space::new();
    space.write("w.toml", include_str!("small.toml"));
    let output = space.flow(&["run", "w.toml", "trial"]);
    let found = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success(), "{found}");
    let place = |part: &str| found.find(part).unwrap_or_else(|| panic!("no `{part}` in\n{found}"));
    assert!(place("warning: specimen: only ") < place("specimen         done"));
    assert!(place("warning: trial: 15.8 wave transits before failure, below 30") < place("trial            done"));
    assert!(
        space.stdout(&["show", "w.toml", "trial"]).contains("warning: 15.8 wave transits before failure, below 30")
    );
    let coarse = ["--set", "stage.specimen.mean_radius=3 mm"];
    let output = space.flow(&[&["run", "w.toml", "specimen"], &coarse[..]].concat());
    let found = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(found.contains("warning: specimen: only 6."), "{found}");
    assert!(found.contains("particles across the specimen; below 10 results are meaningless"), "{found}");
    assert!(space.stdout(&[&["show", "w.toml", "specimen"], &coarse[..]].concat()).contains("warning: only 6."));
}

#[test]
fn of_stages_that_nobody_asked_for_nothing_is_said() {
    let space = Space::new();
    space.write("w.toml", &CAMPAIGN.replace("echo 1", "exit 1"));
    let more = "[stage.{}]\nkind = \"table\"\nof = \"first\"\n";
    let text = std::fs::read_to_string(space.path("w.toml")).expect("the workflow");
    space.write("w.toml", &(text + &more.replace("{}", "wanted") + &more.replace("{}", "other")));
    let found = complaint(&space, &["run", "w.toml", "wanted"], 1);
    assert!(found.contains("wanted           skipped, because `first` failed"), "{found}");
    assert!(!found.contains("other"), "{found}");
}
