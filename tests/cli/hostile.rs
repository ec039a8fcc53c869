//! Hostile situations that were thought up afresh, by kind: what each showed stays mended.

use crate::space::{Space, told};
use std::os::unix::process::ExitStatusExt;
use std::process::{Command, Stdio};

/// A table of two columns read by one stage of statistics.
fn data(csv: &str, stage: &str) -> Space {
    let space = Space::new();
    space.write("d.csv", csv);
    space.write(
        "w.toml",
        &format!(
            "[workflow]\nseed = 1\n[factor]\na = {{ levels = [1, 2] }}\n[response]\ny = {{}}\n\
             [stage.d]\nkind = \"data\"\nfile = \"d.csv\"\n[stage.s]\n{stage}\n"
        ),
    );
    space
}

const ANOVA: &str = "kind = \"anova\"\ntable = \"d\"\nfactors = [\"a\"]";

/// Squares that overflow or vanish gave sums of squares of zero without a word.
#[test]
fn responses_whose_squares_no_number_holds_are_refused() {
    for (scale, words) in [("e300", "values of the size 3e300"), ("e-300", "values of the size 2e-300")] {
        let space = data(&format!("a,y\n1,1{scale}\n2,2{scale}\n1,3{scale}\n2,1{scale}\n"), ANOVA);
        let output = space.flow(&["run", "w.toml"]);
        assert_eq!(output.status.code(), Some(1), "{}", told(&output));
        assert!(told(&output).contains(words) && told(&output).contains("another unit"), "{}", told(&output));
    }
    // Far from zero is no fault.
    let space = data("a,y\n1,1e12\n2,1.000001e12\n1,1.000002e12\n2,1.000004e12\n", ANOVA);
    assert!(space.flow(&["run", "w.toml"]).status.success());
}

#[test]
fn numbers_of_any_size_are_short_in_messages_and_come_back_from_tables() {
    let space = data("a,y\n1e-300,1\n3e300,2\n", ANOVA);
    let said = told(&space.flow(&["run", "w.toml"]));
    assert!(said.contains("`a` is 1e-300, which is none of its levels 1, 2;"), "{said}");
    assert_eq!(space.stdout(&["show", "w.toml", "d", "--csv", "--quiet"]), "a,y\n1e-300,1\n3e300,2\n");
}

#[test]
fn what_a_plot_cannot_draw_stands_below_it() {
    let xy = "kind = \"figure\"\nshow = \"xy\"\nof = \"d\"\nx = \"a\"\ny = \"y\"\nfit = \"line\"";
    let space = data("a,y\n1,1\n1,2\n1,\n", xy);
    space.run(&[]);
    let json = space.stdout(&["show", "w.toml", "s", "--json"]);
    for words in ["1 of 3 rows has no number in a or y.", "The 2 points support no line"] {
        assert!(json.contains(words), "{words}: {json}");
    }
    let log = xy.replace("fit = \"line\"", "log = [\"x\"]");
    let space = data("a,y\n-1,1\n1,2\n10,4\n0,5\n", &log);
    space.run(&[]);
    let json = space.stdout(&["show", "w.toml", "s", "--json"]);
    assert!(json.contains("2 of 4 values of a are not above zero and not on the logarithmic axis."), "{json}");
}

#[test]
fn a_comparison_says_what_it_is_not_of() {
    let space = data("a,y\n1,3\n2,4\n3,5\n", "kind = \"agreement\"\nof = \"d\"\ncompare = \"e\"");
    let text = std::fs::read_to_string(space.path("w.toml")).expect("the workflow");
    space.write(
        "w.toml",
        &text
            .replace("levels = [1, 2]", "range = [1, 3]")
            .replace("[stage.s]", "[stage.e]\nkind = \"data\"\nfile = \"e.csv\"\n[stage.s]"),
    );
    space.write("e.csv", "a,y\n1,3\n2,0\n");
    space.run(&[]);
    let notes = space.stdout(&["show", "w.toml", "s", "--table", "notes", "--csv"]);
    assert!(notes.contains("1 of 3 rows of `d` has no partner in the other table"), "{notes}");
    assert!(notes.contains("1 of 2 pairs of `d` has a reference of 0, and so no ratio"), "{notes}");
}

#[test]
fn faults_of_a_table_are_found_by_check() {
    for (csv, words) in [
        ("a,y\n1,2\n2\n", "line 3 has 1 cell where the first line has 2"),
        ("a,a\n1,2\n", "every column needs a name of its own"),
        ("a,y [kg]\n1,2\n", "column `y` is in `kg` and `y` of the workflow in no unit"),
        ("a,y\n1,\0\n", "line 2 holds the character NUL, which no text has"),
        ("a\0,\0y\0\n", "is it UTF-16 without a mark at its start?"),
        ("a,y\n1,2\n,\n", "line 3 has no value in any cell"),
        ("a,y\n1,2\n2,broken\n", "row 2: `y` is `broken`, which is no number"),
        ("a,y\n1,3±0.2\n2,4\n", "row 1: `y` is `3±0.2`, which is no number"),
        ("a,y\n1,2\na,y\n2,3\n", "row 2: `a` is `a`, and the levels of [factor.a] are numbers"),
        ("a,y\n1,2\n1-Mar,3\n2,4\n", "row 2: `a` is `1-Mar`, and the levels of [factor.a] are numbers"),
    ] {
        let space = data(csv, ANOVA);
        let output = space.flow(&["check", "w.toml"]);
        assert_eq!(output.status.code(), Some(2), "{csv:?}: {}", told(&output));
        assert!(told(&output).contains(words), "{csv:?}: {}", told(&output));
    }
}

/// A word among the numbers of a factor was one more level: a line `mean` below a table took part in the analysis.
#[test]
fn a_word_is_no_level_of_a_factor_of_numbers() {
    let space = data("a,y\n1,2\n2,3\n1,4\n2,6\nmean,4\n", ANOVA);
    let output = space.flow(&["run", "w.toml", "s"]);
    assert_eq!(output.status.code(), Some(1), "{}", told(&output));
    let words = "row 5: `a` is `mean`, and the levels of [factor.a] are numbers";
    assert!(told(&output).contains(words), "{}", told(&output));
    let text = std::fs::read_to_string(space.path("w.toml")).expect("the workflow");
    space.write("w.toml", &text.replace("levels = [1, 2]", "levels = [\"1\", \"2\", \"mean\"]"));
    space.run(&[]);
}

/// They were one more group, or lost without a word.
#[test]
fn runs_without_a_value_to_group_by_are_counted() {
    let fit = "kind = \"regression\"\ntable = \"d\"\nterms.y = [\"a\"]\nby = [\"g\"]";
    for (first, second) in [("rock", "soil"), ("1", "2")] {
        let groups = [first, first, first, second, second, second, "", "NA"];
        let rows = groups.iter().enumerate().map(|(i, group)| format!("{},{},{group}\n", i + 1, (i * i) % 5));
        let space = data(&format!("a,y,g\n{}", rows.collect::<String>()), fit);
        let text = std::fs::read_to_string(space.path("w.toml")).expect("the workflow");
        space.write("w.toml", &text.replace("levels = [1, 2]", "range = [0, 9]"));
        space.run(&[]);
        let notes = space.stdout(&["show", "w.toml", "s", "--table", "notes", "--csv"]);
        assert!(notes.contains("2 of 8 runs have no `g`, so they are in no group"), "{notes}");
        let groups = space.stdout(&["show", "w.toml", "s", "--table", "groups", "--csv"]);
        assert_eq!(groups.lines().count(), 5, "two terms of two groups: {groups}");
    }
}

/// They were taken for 0.
#[test]
fn numbers_too_small_for_the_machine_are_refused() {
    let space = program("run = [\"echo\", \"1e-400\"]\nread.y = { file = \"stdout\", pattern = '(.*)' }");
    let said = told(&space.flow(&["run", "w.toml"]));
    assert!(said.contains("`1e-400` is too small for a number of the machine: it would be 0"), "{said}");
    let space = data("a,y\n1,2\n", ANOVA);
    let text = std::fs::read_to_string(space.path("w.toml")).expect("the workflow");
    space.write("w.toml", &text.replace("levels = [1, 2]", "levels = [1e-400, 1]"));
    let said = told(&space.flow(&["check", "w.toml"]));
    assert!(said.contains("`1e-400` is too small: it would be 0"), "{said}");
    let space =
        program("run = [\"true\"]\ntime_limit = \"1e-400 s\"\nread.y = { file = \"stdout\", pattern = '(.*)' }");
    let said = told(&space.flow(&["check", "w.toml"]));
    assert!(said.contains("`1e-400 s` is not a finite number, or too small for one"), "{said}");
}

#[test]
fn names_that_would_be_two_things_are_refused() {
    for (factor, words) in [
        ("residual = { levels = [1, 2] }", "factor `residual` has the name of a line that analyses write"),
        ("const = { levels = [1, 2] }", "factor `const` has the name of a line"),
        ("a = { levels = [\"x\", \"x \"] }", "level `x ` is empty, or begins or ends with a blank"),
        ("a = { levels = [\"\", \"x\"] }", "level `` is empty"),
    ] {
        let space = Space::new();
        space.write(
            "w.toml",
            &format!("[workflow]\nseed = 1\n[factor]\n{factor}\n[stage.t]\nkind = \"table\"\nlist = \"factors\"\n"),
        );
        let output = space.flow(&["check", "w.toml"]);
        assert_eq!(output.status.code(), Some(2), "{factor}: {}", told(&output));
        assert!(told(&output).contains(words), "{factor}: {}", told(&output));
    }
}

/// A program in a run of its own.
fn program(more: &str) -> Space {
    let space = Space::new();
    space.write("f.txt", "x");
    space.write(
        "w.toml",
        &format!("[workflow]\nseed = 1\n[response]\ny = {{}}\n[stage.c]\nkind = \"command\"\n{more}\n"),
    );
    space
}

#[test]
fn what_a_program_cannot_be_given_is_refused_before_it_runs() {
    let read = "run = [\"true\"]\nread.y = { file = \"stdout\", pattern = '(.*)' }\n";
    let long = format!("files = {{ \"{}\" = \"f.txt\" }}", "x".repeat(300));
    for (more, words) in [
        ("files = { \"d\" = \"f.txt\", \"d/x\" = \"f.txt\" }", "`d` is a file, and the folder in which `d/x` lies"),
        ("files = { \"a\\u0000b\" = \"f.txt\" }", "must be a plain name inside the run's folder"),
        (long.as_str(), "must be a plain name inside the run's folder"),
        ("files = { \"stdout/x\" = \"f.txt\" }", "is where the run's own output goes"),
        ("environment = { FLOW_RUN_FOLDER = \"/tmp\" }", "`FLOW_RUN_FOLDER` is set by flow"),
    ] {
        let output = program(&format!("{read}{more}")).flow(&["check", "w.toml"]);
        assert_eq!(output.status.code(), Some(2), "{more}: {}", told(&output));
        assert!(told(&output).contains(words), "{more}: {}", told(&output));
    }
}

#[test]
fn numbers_of_fortran_are_read() {
    let space = program("run = [\"echo\", \"y= 1.5D+03\"]\nread.y = { file = \"stdout\", pattern = 'y= (\\S+)' }");
    space.run(&[]);
    assert_eq!(
        space.stdout(&["show", "w.toml", "c", "--table", "responses", "--csv", "--quiet"]),
        "response,value,unit\ny,1500,\n"
    );
}

/// `yes` would fill the disk.
#[test]
fn a_program_that_prints_without_end_is_ended_with_a_reason() {
    let space = program("run = [\"yes\"]\nread.y = { file = \"stdout\", pattern = '(.*)' }");
    let output = space.flow(&["run", "w.toml"]);
    assert_eq!(output.status.code(), Some(1), "{}", told(&output));
    assert!(told(&output).contains("wrote more than 1 GiB to stdout and was ended"), "{}", told(&output));
}

/// A limit on the size of files ends a program by a signal unless it minds.
#[test]
fn a_limit_on_the_size_of_files_is_an_error_that_is_told() {
    let space = data(&format!("a,y\n{}", "1,2\n2,3\n1,3\n2,5\n".repeat(2000)), ANOVA);
    let script = "ulimit -f 8; exec \"$0\" run w.toml";
    let mut run = Command::new("sh");
    run.args(["-c", script, env!("CARGO_BIN_EXE_flow")]).current_dir(space.path(""));
    let output = run.stdout(Stdio::piped()).stderr(Stdio::piped()).output().expect("flow");
    assert_eq!(output.status.signal(), None, "{}", told(&output));
    assert!(
        !output.status.success() && told(&output).contains("larger than the limit on the size of files"),
        "{}",
        told(&output)
    );
    space.run(&[]);
}

#[test]
fn a_store_that_is_not_there_is_not_sound() {
    let space = Space::new();
    for command in ["verify", "ls", "du"] {
        let output = space.flow(&["store", command, "--store", "nowhere"]);
        assert_eq!(output.status.code(), Some(3), "{}", told(&output));
        assert!(told(&output).contains("there is no store at nowhere"), "{}", told(&output));
    }
    assert!(!space.path("nowhere").exists());
}

/// Characters that turn the direction of a text around hide what it says.
#[test]
fn cells_do_not_steer_the_terminal() {
    let space = data("a,y,name\n1,2,\u{202e}abc\n2,3,\u{1b}[31mred\n", "kind = \"table\"\nof = \"d\"");
    space.run(&[]);
    let shown = space.stdout(&["show", "w.toml", "d"]);
    assert!(!shown.contains(['\u{202e}', '\u{1b}']) && shown.contains("abc"), "{shown:?}");
}

#[test]
fn a_stone_is_not_turned_inside_out_by_its_unit() {
    let space = Space::new();
    space.write("s.stl", "solid s\nendsolid s\n");
    for unit in ["-1 mm", "0 mm", "1e300 mm"] {
        let stage =
            format!("[workflow]\nseed = 1\n[stage.s]\nkind = \"shapes\"\nstl = [\"s.stl\"]\nunit = \"{unit}\"\n");
        space.write("w.toml", &stage);
        let output = space.flow(&["check", "w.toml"]);
        assert_eq!(output.status.code(), Some(2), "{unit}: {}", told(&output));
        assert!(told(&output).contains("no length that a stone could be measured in"), "{unit}: {}", told(&output));
    }
}

/// A process that leaves its group, its session, its folder and its environment is ended with its run all the same.
#[test]
fn nothing_that_a_program_starts_outlives_its_run() {
    let hides =
        "(cd / && exec env -i setsid sh -c 'echo $$ > \"$0\"; exec sleep 600' \"$OLDPWD/../pid\") & sleep 0.2; echo 1";
    let space = Space::new();
    let pid = space.path("pid").display().to_string();
    let script = hides.replace("\"$OLDPWD/../pid\"", &format!("'{pid}'"));
    space.write("run.sh", &script);
    space.write(
        "w.toml",
        "[workflow]\nseed = 1\n[response]\ny = {}\n[stage.c]\nkind = \"command\"\nrun = [\"sh\", \"run.sh\"]\n\
         files = { \"run.sh\" = \"run.sh\" }\nread.y = { file = \"stdout\", pattern = '(\\d+)' }\n",
    );
    space.run(&[]);
    let number = std::fs::read_to_string(space.path("pid")).expect("the process has begun");
    let program = std::fs::read(format!("/proc/{}/cmdline", number.trim())).unwrap_or_default();
    assert!(!program.starts_with(b"sleep\x00600"), "{number} is alive");
}

/// After `kill -9` of the campaign nobody is its parent, and it has hidden itself as well as it can: the next run finds it.
#[test]
fn what_a_killed_campaign_left_in_hiding_is_found_by_the_next_run() {
    let hides = "env -i setsid -f sh -c 'cd /; exec >/dev/null 2>&1; echo $$ > PID; exec sleep 600'; sleep 600\n";
    let space = program(
        "run = [\"sh\", \"run.sh\"]\nfiles = { \"run.sh\" = \"run.sh\" }\nread.y = { file = \"stdout\", pattern = '(.*)' }",
    );
    let pid = space.path("pid");
    space.write("run.sh", &hides.replace("PID", &pid.display().to_string()));
    // Campaigns of other tests, which run at the same time, sweep as well: one of some tries goes undisturbed.
    let undisturbed = (0..10).any(|_| {
        let _ = std::fs::remove_file(&pid);
        let mut child = space.command(&["run", "w.toml", "--quiet"]).stderr(Stdio::null()).spawn().expect("flow");
        let written = || std::fs::read_to_string(&pid).unwrap_or_default();
        while !written().ends_with('\n') {
            assert!(child.try_wait().expect("flow").is_none(), "flow ended before its program began");
            std::thread::sleep(std::time::Duration::from_millis(10));
        }
        let hidden = std::path::PathBuf::from(format!("/proc/{}", written().trim()));
        while std::fs::read(hidden.join("cmdline")).is_ok_and(|words| !words.starts_with(b"sleep")) {
            std::thread::sleep(std::time::Duration::from_millis(10));
        }
        child.kill().expect("killing flow");
        child.wait().expect("flow");
        let alive = || std::fs::read(hidden.join("cmdline")).is_ok_and(|words| words.starts_with(b"sleep"));
        let lives = alive();
        let said = told(&space.flow(&["store", "gc", "w.toml", "--yes"]));
        assert!(!alive(), "{} lives on: {said}", hidden.display());
        lives && ["left 2 processes", "left 3 processes"].iter().any(|words| said.contains(words))
    });
    assert!(undisturbed, "it lives after the kill, and the next command ends it and says so");
}

#[test]
fn a_program_that_cannot_be_started_says_what_helps() {
    let long = format!("run = [\"echo\", \"{}\"]", "x".repeat(200_000));
    let read = "read.y = { file = \"stdout\", pattern = '(.*)' }";
    for (run, words) in [
        (long.as_str(), "give long texts in a file"),
        ("run = [\"/tmp\"]", "is it a program, and may you run it?"),
        ("run = [\"no-such-program\"]", "is it installed and on the PATH?"),
    ] {
        let output = program(&format!("{run}\n{read}")).flow(&["run", "w.toml"]);
        assert!(told(&output).contains(words), "{words}: {}", told(&output));
    }
}

#[test]
fn outputs_do_not_replace_what_is_not_theirs() {
    let space = Space::new();
    let campaign = include_str!("campaign.toml");
    space.write("w.toml", &format!("{campaign}\n[stage.rows]\nkind = \"data\"\nfile = \"rows.runs.csv\"\n"));
    space.write("rows.runs.csv", "a,y\n1,2\n");
    space.write("notes.txt", "mine");
    space.run(&[]);
    let before = std::fs::read(space.path("w.toml")).expect("the workflow");
    for (command, words) in [
        ("report w.toml -o w.toml", "the workflow reads this file"),
        ("calibrate w.toml --page w.toml", "the workflow reads this file"),
        ("export w.toml rows --folder .", "the workflow reads this file"),
        ("report w.toml -o notes.txt", "is no page"),
    ] {
        let output = space.flow(&command.split(' ').collect::<Vec<_>>());
        assert_eq!(output.status.code(), Some(2), "{command}: {}", told(&output));
        assert!(told(&output).contains(words), "{command}: {}", told(&output));
    }
    assert_eq!(std::fs::read(space.path("w.toml")).expect("the workflow"), before);
    assert_eq!(std::fs::read(space.path("rows.runs.csv")).expect("the table"), b"a,y\n1,2\n");
    assert_eq!(std::fs::read(space.path("notes.txt")).expect("the notes"), b"mine");
    // A page takes the place of a page.
    space.stdout(&["report", "w.toml"]);
    space.stdout(&["report", "w.toml"]);
}

/// Names of files and texts of workflows may hold what moves the cursor or renames the window.
#[test]
fn messages_do_not_steer_the_terminal() {
    let space = Space::new();
    let name = "w\u{1b}]0;x\u{7}.toml";
    space.write(name, "[workflow]\nsed = 1\ntitle = \"a\u{202e}b\"\n");
    let args = ["check", name];
    for colour in ["never", "always"] {
        let said = space.flow(&[&args[..], &["--color", colour]].concat()).stderr;
        let said = String::from_utf8(said).expect("text");
        assert!(
            said.contains("seed") && !said.contains("\u{1b}]") && !said.contains(['\u{7}', '\u{202e}']),
            "{said:?}"
        );
    }
    let output = space.flow(&["check", "\u{1b}[2Jnone.toml"]);
    assert!(!told(&output).contains('\u{1b}'), "{}", told(&output));
    space.write("w.toml", include_str!("campaign.toml"));
    let output = space.flow(&["show", "w.toml", "ta\u{1b}[2Jble"]);
    assert!(!told(&output).contains('\u{1b}'), "{}", told(&output));
}

/// The kernel's log calls itself a plain, empty file, and has its reader wait for the next line.
#[test]
fn a_file_of_the_system_that_waits_is_refused() {
    let space = data("a,y\n1,2\n", ANOVA);
    std::fs::remove_file(space.path("d.csv")).expect("removing");
    std::os::unix::fs::symlink("/proc/kmsg", space.path("d.csv")).expect("a link");
    assert!(!space.flow(&["run", "w.toml", "d"]).status.success());
}

#[test]
fn a_table_of_more_columns_than_anybody_reads_is_refused() {
    let heads: Vec<String> = (0..40_000).map(|column| format!("c{column}")).collect();
    let space = data(&format!("{}\n", heads.join(",")), ANOVA);
    let said = told(&space.flow(&["check", "w.toml"]));
    assert!(said.contains("the first line has 40000 cells; at most 32768 columns are read"), "{said}");
}

/// The length of the axis was infinite, and the points were drawn somewhere.
#[test]
fn what_no_axis_can_show_is_refused() {
    let figure = "kind = \"figure\"\nshow = \"xy\"\nof = \"d\"\nx = \"a\"\ny = \"y\"";
    let space = data("a,y\n1,1e308\n2,-1e308\n", figure);
    let output = space.flow(&["run", "w.toml"]);
    assert_eq!(output.status.code(), Some(1), "{}", told(&output));
    let words = "column `y` has values of the size 1e308, which no axis can show";
    assert!(told(&output).contains(words), "{}", told(&output));
}

#[test]
fn a_marker_of_a_remote_that_flow_did_not_write_is_told() {
    let space = Space::new();
    std::fs::create_dir(space.path("remote")).expect("a folder");
    let marker = space.path("remote/flow.remote");
    let made = Command::new("mkfifo").arg(&marker).status().expect("mkfifo");
    assert!(made.success());
    let said = || told(&space.flow(&["store", "pull", "remote", "--unsigned"]));
    assert!(said().contains("its file `flow.remote` is not the one that flow writes"), "{}", said());
    std::fs::remove_file(&marker).expect("removing a pipe");
    space.write("remote/flow.remote", "flow remote 2\n");
    assert!(said().contains("a newer flow made it"), "{}", said());
}

/// A stack that no memory holds has the system refuse every thread, also to root, whom a limit of processes does not bind.
#[test]
fn where_no_thread_can_be_started_it_is_said() {
    let space = data("a,y\n1,2\n2,3\n1,4\n2,6\n", ANOVA);
    let starved = |arguments: &[&str]| {
        let output = space.command(arguments).env("RUST_MIN_STACK", "1000000000000000").output().expect("running flow");
        let said = told(&output);
        assert!(!said.contains("panicked"), "{arguments:?}: {said}");
        (output.status.code(), said)
    };
    for arguments in [&["run", "w.toml"][..], &["plan", "w.toml"], &["show", "w.toml"], &["report", "w.toml"]] {
        let (code, said) = starved(arguments);
        assert!(code == Some(3) && said.contains("error: the system grants no"), "{arguments:?}: {said}");
    }
    space.run(&[]);
    // Neither needs a thread of its own.
    let (code, said) = starved(&["store", "verify"]);
    assert!(code == Some(0) && said.contains("2 results are sound"), "{said}");
    assert_eq!(starved(&["check", "w.toml"]).0, Some(0));
}
