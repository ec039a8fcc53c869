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
             [stage.line]\nkind = \"regression\"\ntable = \"labor\"\nterms.fc = [\"wz\"]\n"
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
