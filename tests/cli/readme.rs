//! Every command of the README, run in order, on a campaign that has the names of c30.toml and takes seconds; and the
//! links of all pages.

use crate::space::{Space, told};
use flow::stage::material::{Microparameter, Quantity};
use std::path::{Component, Path, PathBuf};
use std::process::Command;

const README: &str = include_str!("../../README.md");

/// The words of a command line: quotes hold words together, a `#` between blanks begins a comment.
pub(crate) fn words(line: &str) -> Vec<String> {
    let line = line.split(" # ").next().unwrap_or(line);
    let (mut words, mut word, mut quote) = (Vec::new(), None::<String>, None);
    for c in line.trim().chars() {
        match (c, quote) {
            ('\'' | '"', None) => {
                quote = Some(c);
                word.get_or_insert_default();
            }
            (c, Some(q)) if c == q => quote = None,
            (' ', None) => words.extend(word.take()),
            (c, _) => word.get_or_insert_default().push(c),
        }
    }
    words.extend(word);
    words
}

/// The commands in the blocks of the README that are for a shell.
fn commands() -> Vec<Vec<String>> {
    let mut inside = false;
    let mut found = Vec::new();
    for line in README.lines() {
        match line {
            "```sh" => inside = true,
            "```" => inside = false,
            line if inside && !line.trim().is_empty() && !line.starts_with('#') => found.push(words(line)),
            _ => {}
        }
    }
    found
}

const TABLE: (&str, &str) = (
    "<!-- microparameters: written by `cargo test --test cli -- --ignored write_the_microparameters` -->\n",
    "<!-- end -->\n",
);

/// The README with the table of microparameters as the laws declare them.
fn with_microparameters() -> String {
    let cell = |parameter: &Microparameter| {
        let one = parameter.declaration();
        let laws: Vec<String> = one.laws.iter().map(ToString::to_string).collect();
        let unit = match (one.quantity.unit(), one.quantity) {
            (_, Quantity::Deviation) => "Pa, or a share of the mean",
            ("", _) => "–",
            (unit, _) => unit,
        };
        let default = if one.default.is_nan() { String::new() } else { one.default.to_string() };
        let (key, symbol, range, meaning) = (one.key, one.symbol, one.range.words(), one.meaning);
        format!("| `{key}` | ${symbol}$ | {unit} | {range} | {default} | {} | {meaning} |\n", laws.join(", "))
    };
    let head = "| key | symbol | unit | range | default | laws | meaning |\n|---|---|---|---|---|---|---|\n";
    let rows: String = Microparameter::ALL.iter().map(cell).collect();
    let (before, rest) = README.split_once(TABLE.0).unwrap();
    let (_, after) = rest.split_once(TABLE.1).unwrap();
    format!("{before}{}{head}{rows}{}{after}", TABLE.0, TABLE.1)
}

#[test]
fn the_microparameters_are_those_that_the_laws_declare() {
    assert!(with_microparameters() == README, "write the table anew, see the comment above it");
}

#[test]
#[ignore = "writes the table of the README"]
fn write_the_microparameters() {
    std::fs::write(concat!(env!("CARGO_MANIFEST_DIR"), "/README.md"), with_microparameters()).unwrap();
}

/// The workflow in the README's section on materials can be read.
#[test]
fn the_example_of_a_material_has_no_fault() {
    let (_, rest) = README.split_once("### Materials and factors").unwrap();
    let (_, rest) = rest.split_once("```toml\n").unwrap();
    let (example, _) = rest.split_once("```").unwrap();
    let stages = r#"
[workflow]
seed = 1
[stage.specimen]
kind = "specimen"
width = "50 mm"
height = "100 mm"
porosity = 0.12
mean_radius = "2 mm"
radius_ratio = 2
density = "2000 kg/m^3"
[stage.plan]
kind = "design"
method = "sobol"
runs = 4
factors = ["sigma_c", "s", "ratio", "mu"]
valid = ["sigma_c/s <= 200 MPa", "ratio < 6.2", "mu in 0.1..0.9"]
[stage.runs]
kind = "simulate"
specimen = "specimen"
material = "granite"
design = "plan"
test = "uniaxial"
platen_speed = "0.1 m/s"
"#;
    let space = Space::new();
    space.write("w.toml", &format!("{example}{stages}"));
    space.stdout(&["check", "w.toml"]);
}

#[test]
fn the_first_two_commands_build_run_and_test() {
    let all = commands();
    assert_eq!(all[0][..6], ["cargo", "run", "--release", "--locked", "--", "run"]);
    assert!(Path::new(env!("CARGO_MANIFEST_DIR")).join(&all[0][6]).exists());
    assert_eq!(all[1], ["cargo", "test", "--release", "--locked"]);
}

#[test]
fn every_command_of_the_tour_works() {
    let space = Space::new();
    std::fs::create_dir(space.path("workflows")).unwrap();
    space.write("workflows/c30.toml", include_str!("small.toml"));
    let mut ran = 0;
    for command in commands().into_iter().skip(2) {
        if command[0] != "flow" {
            assert!(["cargo"].contains(&command[0].as_str()), "who tests {command:?}?");
            continue;
        }
        let arguments: Vec<&str> = command[1..].iter().map(String::as_str).collect();
        let output = space.flow(&arguments);
        assert!(output.status.success(), "flow {}\n{}", arguments.join(" "), told(&output));
        names_are_those_of_the_shipped_workflow(&arguments);
        ran += 1;
    }
    assert!(ran >= 12, "only {ran} commands");
}

/// Stages, profiles and settings that the README names are in the real workflow too: it is planned with them.
fn names_are_those_of_the_shipped_workflow(arguments: &[&str]) {
    let takes = ["run", "plan", "show", "export", "check", "graph"];
    let Some(["workflows/c30.toml", rest @ ..]) = arguments.get(1..).filter(|_| takes.contains(&arguments[0])) else {
        return;
    };
    let workflow = concat!(env!("CARGO_MANIFEST_DIR"), "/workflows/c30.toml");
    let mut plan = vec!["plan".to_owned(), workflow.to_owned()];
    let mut rest = rest.iter();
    while let Some(word) = rest.next() {
        match *word {
            "--profile" | "--set" => plan.extend([(*word).to_owned(), rest.next().unwrap().to_string()]),
            "--to" | "--folder" | "--table" | "--format" => drop(rest.next()),
            option if option.starts_with("--") => {}
            stage => plan.push(stage.split('[').next().unwrap().to_owned()),
        }
    }
    let space = Space::new();
    space.stdout(&plan.iter().map(String::as_str).collect::<Vec<_>>());
}

/// Pages for people who look at the repository, by their path in it.
const PAGES: [&str; 24] = [
    "README.md",
    "CHANGELOG.md",
    "workflows/annealing/README.md",
    "workflows/brazilian/README.md",
    "workflows/cluster/README.md",
    "workflows/guide/README.md",
    "workflows/guide/SUMMARY.md",
    "workflows/guide/first-ten-minutes.md",
    "workflows/guide/your-rock.md",
    "workflows/guide/your-data.md",
    "workflows/guide/designs.md",
    "workflows/guide/calibration.md",
    "workflows/guide/machines.md",
    "workflows/guide/engines.md",
    "workflows/guide/store.md",
    "workflows/guide/messages.md",
    "workflows/c30/README.md",
    "workflows/engines/README.md",
    "workflows/rcc/README.md",
    "workflows/stones/README.md",
    "store/README.md",
    "src/dem/tests/engine/VALIDATION.md",
    "tests/bench/README.md",
    "CONTRIBUTING.md",
];

/// What the links and pictures of a Markdown text point to.
fn links(text: &str) -> Vec<&str> {
    let markdown = text.split("](").skip(1).filter_map(|rest| rest.split([')', ' ']).next());
    let pictures = text.split("src=\"").skip(1).filter_map(|rest| rest.split('"').next());
    markdown.chain(pictures).map(|link| link.split('#').next().unwrap_or(link)).collect()
}

/// Files of the repository, when this is a clone and not an unpacked archive.
fn committed(root: &Path) -> Option<Vec<PathBuf>> {
    let listed = Command::new("git").args(["ls-files", "-z"]).current_dir(root).output().ok()?;
    let names = String::from_utf8(listed.stdout).ok()?;
    let files: Vec<PathBuf> = names.split_terminator('\0').map(PathBuf::from).collect();
    (listed.status.success() && files.contains(&PathBuf::from("Cargo.toml"))).then_some(files)
}

#[test]
fn every_link_of_the_pages_leads_to_a_file_of_the_repository() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let committed = committed(root);
    let (mut faults, mut seen) = (Vec::new(), 0);
    for page in PAGES {
        let text = std::fs::read_to_string(root.join(page)).unwrap();
        let relative = |link: &&str| !link.is_empty() && !link.contains("://") && !link.starts_with("mailto:");
        for link in links(&text).into_iter().filter(relative) {
            seen += 1;
            let mut path = PathBuf::new();
            for part in Path::new(page).parent().unwrap().join(link).components() {
                match part {
                    Component::ParentDir => assert!(path.pop(), "{page}: {link} leaves the repository"),
                    part => path.push(part),
                }
            }
            let is_committed = |files: &Vec<PathBuf>| files.iter().any(|file| file.starts_with(&path));
            if !root.join(&path).exists() || !committed.as_ref().is_none_or(is_committed) {
                faults.push(format!("{page}: {link}"));
            }
        }
    }
    assert!(seen >= 5, "only {seen} links were found");
    assert_eq!(faults, Vec::<String>::new());
}

#[test]
fn links_are_found_in_every_form() {
    let text = "[a](x/y.md#part) ![b](z.svg \"title\") <img src=\"w.png\"> [c](https://a.b/c) [d](#here)";
    assert_eq!(links(text), ["x/y.md", "z.svg", "https://a.b/c", "", "w.png"]);
}
