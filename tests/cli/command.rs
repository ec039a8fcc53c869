//! External programs as a stage: what they need, what they leave, and every way they go wrong.

use crate::space::{Space, told};

/// A workflow with one external program, given by its lines of shell.
fn space(script: &str, more: &str) -> Space {
    let space = Space::new();
    space.write("engine.sh", script);
    space.write(
        "w.toml",
        &format!(
            r#"
[workflow]
seed = 7
[material.base]
mortar = {{ Ec = "20 GPa", mu = 0.5 }}
[response]
UCS = {{ unit = "MPa" }}
[stage.trial]
kind = "command"
run = ["sh", "engine.sh"]
material = "base"
templates = {{ "engine.sh" = "engine.sh" }}
{more}
read.UCS = {{ file = "out.csv", column = "UCS", unit = "Pa" }}
"#
        ),
    );
    space
}

#[test]
fn a_program_gets_its_parameters_and_its_table_is_read() {
    let space = space("printf 'UCS\\n{{mortar.Ec}}\\n' > out.csv", "");
    space.run(&[]).expect(&[("trial", 1)]);
    let table = space.stdout(&["show", "w.toml", "trial", "--csv", "--table", "responses"]);
    assert_eq!(table, "response,value,unit\nUCS,20000,MPa\n");
    space.run(&[]).expect(&[]);
}

#[test]
fn a_changed_template_parameter_or_command_runs_again_and_a_changed_limit_does_not() {
    let space = space("printf 'UCS\\n{{mortar.Ec}}\\n' > out.csv", "time_limit = \"20 s\"");
    space.run(&[]).expect(&[("trial", 1)]);
    space.run(&["--set", "stage.trial.time_limit=30 s"]).expect(&[]);
    space.run(&["--set", "material.base.mortar.Ec=21 GPa"]).expect(&[("trial", 1)]);
    space.run(&["--set", "stage.trial.environment.LEVEL=\"2\""]).expect(&[("trial", 1)]);
    space.write("engine.sh", "printf 'UCS\\n1\\n' > out.csv # {{seed}}");
    space.run(&[]).expect(&[("trial", 1)]);
}

#[test]
fn each_way_to_fail_is_told_and_not_kept() {
    for (script, more, message) in [
        ("echo broken beam >&2; exit 3", "", "exit status: 3"),
        ("exit 3", "", "it printed nothing"),
        ("sleep 60", "time_limit = \"0.2 s\"", "longer than its limit of 0.2 s"),
        ("echo nothing", "", "the program left no file `out.csv`"),
        ("echo '{' > out.csv", "", "no column `UCS`"),
        ("printf 'UCS\\nmany\\n' > out.csv", "", "`many` is not a number"),
        ("printf 'UCS\\nNaN\\n' > out.csv", "", "`UCS` is missing: the program left no value for it in `out.csv`"),
        ("printf 'UCS\\ninf\\n' > out.csv", "", "not a finite number"),
        ("printf 'UCS\\n*****\\n' > out.csv", "", "the program's field is too narrow"),
        ("head -c 100 /dev/urandom > out.csv", "", "out.csv"),
    ] {
        let space = space(script, more);
        let output = space.flow(&["run", "w.toml"]);
        assert_eq!(output.status.code(), Some(1), "{script}: {}", told(&output));
        assert!(told(&output).contains(message), "{script}: wanted `{message}` in {}", told(&output));
        assert!(told(&output).contains("again: flow run w.toml trial"), "{}", told(&output));
        assert!(space.objects().is_empty(), "{script}: a failed run was kept");
    }
}

#[test]
fn a_template_that_names_what_no_run_has_is_refused_before_anything_runs() {
    let space = space("echo {{mortar.E}}", "");
    let output = space.flow(&["check", "w.toml"]);
    assert_eq!(output.status.code(), Some(2), "{}", told(&output));
    assert!(told(&output).contains("line 1: `mortar.E` is not a value of this run"), "{}", told(&output));
}

#[test]
fn a_recorded_failure_is_a_result_with_its_reason() {
    let space = space("exit 3", "on_failure = \"record\"");
    space.run(&[]).expect(&[("trial", 1)]);
    space.run(&[]).expect(&[]);
    let shown = space.stdout(&["show", "w.toml", "trial"]);
    assert!(shown.contains("exit status: 3"), "{shown}");
}

#[test]
fn what_the_program_started_ends_with_it() {
    let space = space("sleep 300 & echo $! > pid; sleep 300", "time_limit = \"0.3 s\"");
    let started = std::time::Instant::now();
    let output = space.flow(&["run", "w.toml"]);
    assert_eq!(output.status.code(), Some(1));
    assert!(started.elapsed().as_secs() < 60, "the run waited for what its program left behind");
}

#[test]
fn a_value_in_the_command_itself_is_refused_before_anything_runs() {
    let space = space("true", "");
    let output = space.flow(&["check", "w.toml", "--set", "stage.trial.run=[\"sh\", \"{{mortar.Ec}}\"]"]);
    assert_eq!(output.status.code(), Some(2), "{}", told(&output));
    assert!(told(&output).contains("`{{mortar.Ec}}` is filled in templates, not in `run`"), "{}", told(&output));
    let kept = space.flow(&["check", "w.toml", "--set", "stage.trial.run=[\"awk\", \"{{print}} {{ $1 }}\"]"]);
    assert!(kept.status.success(), "{}", told(&kept));
}

#[test]
fn a_stage_with_failed_rows_is_told_once_when_its_last_row_has_ended() {
    let space = space("exit 3", "");
    let head = "[workflow]\nseed = 7\n[factor.a]\nsets = \"mortar.mu\"\nlevels = [1, 2, 3, 4]\n[material.m]\nmortar = { mu = 1 }\n[response]\nUCS = { unit = \"MPa\" }\n";
    let design = "[stage.d]\nkind = \"design\"\nmethod = \"full-factorial\"\nfactors = [\"a\"]\n";
    let rows =
        "[stage.trial]\nkind = \"command\"\nmaterial = \"m\"\ndesign = \"d\"\nrun = [\"sh\", \"-c\", \"exit 3\"]\n";
    let read = "read.UCS = { file = \"out.csv\", column = \"UCS\", unit = \"Pa\" }\n";
    let after = "[stage.after]\nkind = \"table\"\nof = \"trial\"\n";
    space.write("w.toml", &[head, design, rows, read, after].concat());
    let output = space.flow(&["run", "w.toml", "--keep-going", "--jobs", "1"]);
    let found = told(&output);
    let at: Vec<usize> = found.match_indices("trial            failed: ").map(|(place, _)| place).collect();
    assert_eq!(at.len(), 1, "{found}");
    assert!(found[at[0]..].starts_with("trial            failed: 4 of 5 tasks"), "{found}");
    assert!(found.find("after            skipped").is_some_and(|after| after > at[0]), "{found}");
    assert!(found.rfind("error: trial[4]").is_some_and(|row| row < at[0]), "{found}");
    assert_eq!(found.matches("again: ").count(), 1, "{found}");
}

/// A design of three rows, each with two replicates, for a program given by its lines of shell.
fn rows(script: &str, stage: &str) -> Space {
    let space = Space::new();
    space.write("engine.sh", script);
    let head = "[workflow]\nseed = 7\n[factor.Ec]\nsets = \"rock.Ec\"\nunit = \"GPa\"\nlevels = [1, 2, 3]\n";
    let material = "[material.m]\nrock = { Ec = \"1 GPa\" }\n[response]\nUCS = { unit = \"MPa\" }\nnu = {}\n";
    let design = "[stage.d]\nkind = \"design\"\nmethod = \"full-factorial\"\nfactors = [\"Ec\"]\nreplicates = 2\n";
    let runs = "[stage.runs]\nkind = \"command\"\nmaterial = \"m\"\ndesign = \"d\"\nrun = [\"sh\", \"engine.sh\"]\n\
                templates = { \"engine.sh\" = \"engine.sh\" }\n";
    space.write("w.toml", &[head, material, design, runs, stage].concat());
    space
}

/// A column of the runs.
fn column(space: &Space, name: &str) -> Vec<String> {
    let table = space.stdout(&["show", "w.toml", "runs", "--csv", "--table", "runs"]);
    let mut lines = table.lines().map(|line| line.split(',').map(str::to_owned).collect::<Vec<_>>());
    let heads = lines.next().unwrap_or_default();
    let index = heads.iter().position(|head| head.split(' ').next() == Some(name)).expect("the column");
    lines.map(|cells| cells[index].clone()).collect()
}

#[test]
fn every_run_has_a_seed_of_its_own_that_stays() {
    let script = "printf 'UCS = {{seed}}\\nnu = {{replicate}}\\n'";
    let stage = "read.UCS = { file = \"stdout\", pattern = 'UCS = (.*)', unit = \"MPa\" }\n\
                 read.nu = { file = \"stdout\", pattern = 'nu = (.*)' }\n";
    let space = rows(script, stage);
    space.run(&[]);
    let seeds = column(&space, "UCS");
    let different: std::collections::BTreeSet<&String> = seeds.iter().collect();
    assert_eq!((seeds.len(), different.len()), (6, 6), "{seeds:?}");
    assert_eq!(column(&space, "nu").iter().filter(|number| *number == "1").count(), 3);
    space.run(&["--again", "runs"]).expect(&[("runs", 7)]);
    assert_eq!(column(&space, "UCS"), seeds);
}

#[test]
fn several_numbers_are_read_of_one_file_and_a_missing_one_costs_only_itself() {
    // A history whose peak is the strength, and a Poisson's ratio that the second material has none of.
    let script = "printf 'strain,stress\\n0.001,{{Ec}}.0D+00\\n0.002,{{Ec}}.5D+00\\n0.003,1.0D-01\\n' > history.csv\n\
                  if [ {{Ec}} = 2 ]; then nu=NaN; else nu=0.2{{Ec}}; fi\n\
                  printf '{\"nu\": %s, \"other\": NaN}' $nu > result.json";
    let stage = "read.UCS = { file = \"history.csv\", column = \"stress\", take = \"maximum\", unit = \"MPa\" }\n\
                 read.nu = { file = \"result.json\", pointer = \"/nu\" }\n";
    let space = rows(script, stage);
    let output = space.flow(&["run", "w.toml"]);
    assert!(output.status.success(), "{}", told(&output));
    assert!(told(&output).contains("`nu` is missing: the program left no value for it in `result.json`"));
    assert_eq!(column(&space, "UCS"), ["1.5", "2.5", "3.5", "1.5", "2.5", "3.5"]);
    assert_eq!(column(&space, "nu"), ["0.21", "", "0.23", "0.21", "", "0.23"]);
    assert!(column(&space, "failure").iter().all(String::is_empty));
}

#[test]
fn a_bound_on_runs_at_once_holds_and_all_of_them_end() {
    // Every run writes down how many go on with it, in a folder that all share.
    let space = Space::new();
    let shared = space.path("running").display().to_string();
    let script = format!(
        "mkdir -p {shared}; touch {shared}/$$; ls {shared} | wc -l > count; sleep 0.2; rm {shared}/$$; \
         printf 'UCS = %s\\n' $(cat count)"
    );
    let stage = "read.UCS = { file = \"stdout\", pattern = 'UCS = (.*)', unit = \"MPa\" }\nat_once = 1\n";
    let bounded = rows(&script, stage);
    bounded.run(&["--jobs", "4"]);
    assert_eq!(column(&bounded, "UCS"), ["1"; 6]);
    // The bound is in no key.
    bounded.run(&["--set", "stage.runs.at_once=2"]).expect(&[]);
    let output = bounded.flow(&["check", "w.toml", "--set", "stage.runs.at_once=0"]);
    assert_eq!(output.status.code(), Some(2), "{}", told(&output));
}
