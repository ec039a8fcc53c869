use super::*;

fn faults(text: &str) -> Vec<String> {
    match parse("w.toml", text, &Overrides::default()) {
        Ok(_) => Vec::new(),
        Err(faults) => faults
            .iter()
            .map(|f| {
                let more = |x: &Option<String>| x.as_ref().map(|x| format!(" | {x}")).unwrap_or_default();
                format!("{f}{}{}", more(&f.label), more(&f.hint))
            })
            .collect(),
    }
}

const GOOD: &str = r#"
[workflow]
seed = 3
[factor.Ec]
sets = "mortar.Ec"
unit = "GPa"
levels = [10, 20, 30]
[stage.runs]
kind = "data"
file = "runs.csv"
[stage.more]
kind = "data"
file = "more.csv"
[profile.quick.stage.runs]
file = "few.csv"
"#;

#[test]
fn a_good_workflow_is_read() {
    let workflow = parse("a/w.toml", GOOD, &Overrides::default()).unwrap();
    assert_eq!((workflow.name.as_str(), workflow.context.seed), ("w", 3));
    assert_eq!(workflow.context.factors["Ec"].range, Some([10.0, 30.0]));
    let names: Vec<&str> = workflow.stages.iter().map(|stage| stage.name.as_str()).collect();
    assert_eq!(names, ["runs", "more"]);
}

#[test]
fn all_faults_are_told_at_once() {
    let text = "x = 1\n[workflow]\nsed = 1\n[stage.b]\nfil = 3\nkind = \"data\"\n[stage.c]\nkind = \"dta\"";
    let expected = [
        "w.toml:1:1: unknown key `x` | known tables: `workflow`, `factor`, `response`, `material`, `stage`, `profile`",
        "w.toml:2:1: missing key `seed` | `seed` is needed here",
        "w.toml:3:1: unknown key `sed` | did you mean `seed`? | known keys: `title`, `about`, `seed`",
        "w.toml:4:1: missing key `file` | `file` is needed here",
        "w.toml:5:1: unknown key `fil` | did you mean `file`? | known keys: `file`",
    ];
    let found = faults(text);
    assert_eq!(found[..5], expected);
    assert!(found[5].starts_with("w.toml:8:8: there is no kind of stage `dta` | did you mean `data`?"), "{}", found[5]);
}
