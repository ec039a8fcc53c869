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
fn all_faults_are_reported_at_once() {
    let text = "x = 1\n[workflow]\nsed = 1\n[stage.b]\nfil = 3\nkind = \"data\"\n[stage.c]\nkind = \"dta\"";
    let expected = [
        "w.toml:1:1: unknown key `x` | known tables: `workflow`, `factor`, `response`, `material`, `stage`, `profile`",
        "w.toml:2:1: missing key `seed` | `seed` is needed here",
        "w.toml:3:1: unknown key `sed` | did you mean `seed`? | known keys: `title`, `about`, `seed`",
        "w.toml:4:1: missing key `file` | `file` is needed here",
        "w.toml:5:1: unknown key `fil` | did you mean `file`? | known keys: `file`, `delimiter`, `decimal`, `encoding`, `missing`, `sheet`, `first_line`, `rename`",
    ];
    let found = faults(text);
    assert_eq!(found[..5], expected);
    assert!(found[5].starts_with("w.toml:8:8: there is no kind of stage `dta` | did you mean `data`?"), "{}", found[5]);
}

fn settings(profile: Option<&str>, sets: &[&str]) -> Result<String, String> {
    let overrides =
        Overrides { profile: profile.map(str::to_owned), sets: sets.iter().map(|&set| set.to_owned()).collect() };
    match parse("w.toml", GOOD, &overrides) {
        Ok(workflow) => Ok(format!("{} {}", workflow.context.seed, workflow.stages[0].stage.settings()["file"])),
        Err(faults) => Err(faults[0].to_string()),
    }
}

#[test]
fn profiles_and_options_lie_over_the_file_in_that_order() {
    let ok = |text: &str| Ok(text.to_owned());
    assert_eq!(settings(None, &[]), ok("3 \"runs.csv\""));
    assert_eq!(settings(Some("quick"), &[]), ok("3 \"few.csv\""));
    assert_eq!(settings(Some("quick"), &["stage.runs.file='set.csv'", "workflow.seed = 0x10"]), ok("16 \"set.csv\""));
    assert_eq!(settings(None, &["stage.runs.file=plain text.csv"]), ok("3 \"plain text.csv\""), "falls back to text");
    assert_eq!(settings(None, &["workflow.title=new key"]), ok("3 \"runs.csv\""));
}

#[test]
fn two_options_for_one_value_are_a_fault() {
    let fault = |first: &str, second: &str| settings(None, &[first, second]).unwrap_err();
    let words = "gives what an option before it gives";
    let file = "stage.runs.file=a";
    assert_eq!(fault(file, "stage.\"runs\".file=b"), format!("--set:1:1: `stage.\"runs\".file=b` {words}"));
    assert_eq!(fault(file, file), format!("--set:1:1: `{file}` {words}"));
    assert_eq!(fault(file, "stage.runs={file = 'b'}"), format!("--set:1:13: `stage.runs={{file = 'b'}}` {words}"));
    assert_eq!(fault("stage.runs={file = 'b'}", file), format!("--set:1:1: `{file}` {words}"));
    assert_eq!(fault("factor.Ec.levels=[1]", "factor.Ec=2"), format!("--set:1:1: `factor.Ec=2` {words}"));
    assert_eq!(settings(None, &[file, "stage.runs.delimiter=comma"]), Ok("3 \"a\"".to_owned()));
    assert_eq!(settings(None, &["stage.runs={file = 'b'}", "stage.runs.delimiter=tab"]), Ok("3 \"b\"".to_owned()));
}

#[test]
fn options_that_set_nothing_are_faults() {
    let fault = |set: &str| settings(None, &[set]).unwrap_err();
    assert_eq!(fault("stage.rums.file=1"), "--set:1:1: the option sets `stage.rums`, which does not exist");
    assert_eq!(fault("stage.runs.fil=1"), "--set:1:1: unknown key `fil`");
    assert_eq!(fault("stage.runs.file=1"), "--set:1:17: wanted a text in quotes, found the number 1");
    assert_eq!(fault("profile.quick=1"), "--set:1:1: the option cannot set `profile`");
    assert_eq!(fault("stage.runs.file"), "--set:1:1: `stage.runs.file` has no `=`");
    assert_eq!(fault("stage..file=1"), "--set:1:1: `stage..file` is not a path of keys");
    assert_eq!(fault("workflow.seed=nan"), "--set:1:15: wanted a whole number of 0 or more, found the text \"nan\"");
    assert_eq!(fault("stage=1"), "--set:1:1: the option must name one of the stages below `stage`");
}

/// One specimen of a single group, tested with the first material; others stand beside it.
fn tested(materials: &str) -> String {
    format!(
        "[workflow]\nseed = 1\n[material]\n{materials}\n\
         [stage.core]\nkind = \"specimen\"\nwidth = \"40 mm\"\nheight = \"80 mm\"\nporosity = 0.12\nmean_radius = \"2 mm\"\n\
         radius_ratio = 2\ndensity = \"2000 kg/m^3\"\n\
         [stage.press]\nkind = \"simulate\"\nspecimen = \"core\"\nmaterial = \"base\"\ntest = \"uniaxial\"\n\
         platen_speed = \"0.1 m/s\"\n"
    )
}

const MORTAR: &str = "{ Ec = \"20 GPa\", kn_ks = 2.5, sigma_c = \"10 MPa\", tau_c = \"15 MPa\", mu = 0.5 }";

fn warned(materials: &str) -> Vec<String> {
    let workflow = parse("w.toml", &tested(materials), &Overrides::default()).unwrap_or_else(|e| panic!("{e:?}"));
    workflow.warnings.iter().map(|fault| format!("{fault} | {}", fault.hint.as_deref().unwrap_or_default())).collect()
}

#[test]
fn materials_and_groups_that_no_specimen_has_are_said() {
    assert_eq!(warned(&format!("base.mortar = {MORTAR}")), [""; 0]);
    let one = warned(&format!("base.mortar = {MORTAR}\nbase.stone = {MORTAR}\nspare.rock = {MORTAR}"));
    let [stone, spare] = &one[..] else { panic!("{one:?}") };
    assert!(stone.starts_with("w.toml:5:"), "{stone}");
    assert!(stone.contains("no stage uses `stone` of [material.base]: no specimen has such contacts"), "{stone}");
    assert!(stone.ends_with("the specimens have mortar"), "{stone}");
    assert!(spare.contains("no stage uses [material.spare] | say `material = \"spare\"` in a stage"), "{spare}");
}

/// Its contacts would follow the rule `pairs`, and nobody would see it.
#[test]
fn a_pair_with_a_group_that_is_none_is_a_fault() {
    let found = faults(&tested(&format!("base.mortar = {MORTAR}\nbase.mortar-morter = {MORTAR}")));
    let [slip] = &found[..] else { panic!("{found:?}") };
    assert!(slip.contains("`mortar-morter` of [material.base] is a pair with `morter`, which is no group"), "{slip}");
    assert!(slip.contains("did you mean `mortar`? the groups are mortar"), "{slip}");
}
