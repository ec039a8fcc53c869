//! A table as a laboratory hands it over: titles above the names, decimal commas, words for missing values.

use crate::space::{Space, told};

const TABLE: &str = "Baustofflabor Musterstadt, Prüfbericht 117\nPrüfdatum: 12.03.2024\n\n\
    Probe;Zement;w/z;Druckfestigkeit [N/mm²]\n\
    P1;CEM I;0,45;48,2\nP2;CEM I;0,55;39,1\nP3;CEM I;0,65;30,7\nP4;CEM III;0,45;44,8\nP5;CEM III;0,55;k. A.\n";

fn laboratory(missing: &str) -> Space {
    let space = Space::new();
    space.write("labor.csv", TABLE);
    space.write(
        "w.toml",
        &format!(
            "[workflow]\nseed = 1\n[factor]\nwz = {{ range = [0.45, 0.65] }}\n[response]\nfc = {{ unit = \"MPa\" }}\n\
             [stage.labor]\nkind = \"data\"\nfile = \"labor.csv\"\n{missing}\
             rename = {{ \"w/z\" = \"wz\", Druckfestigkeit = \"fc\" }}\n\
             [stage.line]\nkind = \"regression\"\ntitle = \"Festigkeit über w/z\"\ntable = \"labor\"\nterms.fc = [\"wz\"]\n"
        ),
    );
    space
}

#[test]
fn a_table_below_titles_is_read_and_its_main_table_is_the_one_in_csv() {
    let space = laboratory("missing = [\"k. A.\"]\n");
    space.run(&[]);
    let output = space.flow(&["show", "w.toml", "labor", "--csv"]);
    let csv = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(csv.starts_with("Probe,Zement,wz,fc [N/mm²]\nP1,CEM I,0.45,48.2\n"), "{csv}");
    assert_eq!(csv.lines().count(), 6);
    assert!(
        told(&output).contains("this is the table `runs`; --table shows another of notes, runs"),
        "{}",
        told(&output)
    );
    let list = space.stdout(&["show", "w.toml"]);
    assert!(list.lines().any(|line| line.starts_with("line ") && line.ends_with("(Festigkeit über w/z)")), "{list}");
    space.flow(&["report", "w.toml"]);
    let page = std::fs::read_to_string(space.path("report.html")).unwrap();
    assert!(
        page.contains(">Festigkeit über w/z </") || page.contains(">Festigkeit über w/z <span class=\"kind\""),
        "no title"
    );
    let notes = space.stdout(&["show", "w.toml", "labor", "--table", "notes", "--csv"]);
    assert!(notes.contains("names of the columns in line 4, below titles"), "{notes}");
}

#[test]
fn a_word_among_numbers_is_found_by_check_with_its_row_and_the_key_that_allows_it() {
    let space = laboratory("");
    let output = space.flow(&["check", "w.toml"]);
    assert_eq!(output.status.code(), Some(2));
    let said = told(&output);
    assert!(said.contains("row 5: `fc` [N/mm²] is `k. A.`, which is no number"), "{said}");
    assert!(said.contains("say `missing = [\"k. A.\"]` if it stands for no value"), "{said}");
}

/// Slips of people who know other programs, each with the help that ends it.
#[test]
fn slips_in_a_workflow_of_data_are_told_with_the_right_word() {
    let space = laboratory("missing = [\"k. A.\"]\n");
    let text = std::fs::read_to_string(space.path("w.toml")).unwrap();
    let figure = "[stage.fig]\nkind = \"figure\"\nshow = \"box\"\nof = \"labor\"\ny = \"fc\"\n";
    let cases = [
        (text.replace("\"w/z\" = \"wz\", ", ""), "by `rename = { \"w/z\" = \"wz\" }`"),
        (text.replace("terms.fc = [\"wz\"]", "terms.fc = [\"wzz\"]"), "did you mean `wz`?"),
        (text.replace("wz = {", "\"w/z\" = {"), "a column of a file gets such a name by `rename` of its `data` stage"),
        (format!("{text}{}", figure.replace("\"box\"", "\"boxplot\"")), "did you mean `box`?"),
        (
            format!("{text}{figure}names = {{ fcc = \"strength\" }}\n"),
            "`fcc` is no response, factor, column or stage of this",
        ),
        (text.replace("title = \"Festigkeit über w/z\"", "title = 5"), "wanted a title in quotes, found the number 5"),
    ];
    for (workflow, words) in cases {
        space.write("w.toml", &workflow);
        let output = space.flow(&["check", "w.toml"]);
        assert_eq!(output.status.code(), Some(2), "{words}");
        assert!(told(&output).contains(words), "{words}: {}", told(&output));
    }
}

/// What lies outside of the limits of an axis is counted; a `where` that no row meets says what there is.
#[test]
fn figures_say_what_they_leave_out() {
    let space = laboratory("missing = [\"k. A.\"]\n");
    let text = std::fs::read_to_string(space.path("w.toml")).unwrap();
    let figure = "[stage.fig]\nkind = \"figure\"\nshow = \"xy\"\nof = \"labor\"\nx = \"wz\"\ny = \"fc\"\n";
    space.write("w.toml", &format!("{text}{figure}y_limits = [35, 60]\n"));
    space.run(&[]);
    space.flow(&["report", "w.toml"]);
    let page = std::fs::read_to_string(space.path("report.html")).unwrap();
    assert!(page.contains("1 of 4 values of fc lies outside of the axis"), "no count");
    for (added, words) in [
        ("y_limits = [60, 35]\n", "the limits must rise: 60 is not below 35"),
        ("log = [\"y\"]\ny_limits = [0, 60]\n", "a logarithmic axis has no 0"),
    ] {
        space.write("w.toml", &format!("{text}{figure}{added}"));
        assert!(told(&space.flow(&["check", "w.toml"])).contains(words), "{words}");
    }
    space.write("w.toml", &format!("{text}{figure}where = {{ Zement = \"CEM V\" }}\n"));
    let said = told(&space.flow(&["run", "w.toml"]));
    assert!(said.contains("no row has the values that `where` asks for: Zement = CEM V"), "{said}");
    assert!(said.contains("`Zement` has CEM I, CEM III"), "{said}");
    space.write("w.toml", &format!("{text}{}", figure.replace("\"labor\"", "\"labor[1]\"")));
    let said = told(&space.flow(&["check", "w.toml"]));
    assert!(said.contains("the rows of `labor` are not stages of their own"), "{said}");
}
