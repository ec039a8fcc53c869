//! kill −9 at any moment: the next run goes on, with the results of an undisturbed one.

use crate::space::{Ran, Space};
use std::collections::BTreeMap;
use std::time::Duration;

/// Many small runs of an external program, so that a kill meets every part of the work.
const CAMPAIGN: &str = r#"
[workflow]
seed = 1
[factor]
a = { sets = "mortar.a", levels = [1, 2, 3, 4, 5, 6] }
b = { sets = "mortar.b", levels = [1, 2, 3, 4] }
[response]
y = {}
[material.base]
mortar = { a = 1, b = 1 }
[stage.grid]
kind = "design"
method = "full-factorial"
factors = ["a", "b"]
[stage.table]
kind = "formula"
design = "grid"
material = "base"
responses.y = { value = "mortar_a + mortar_b", scatter = 0.1 }
[stage.anova]
kind = "anova"
table = "table"
"#;

fn undisturbed() -> BTreeMap<String, Option<String>> {
    let space = Space::new();
    space.write("w.toml", CAMPAIGN);
    space.run(&[]).objects.into_iter().collect()
}

#[test]
fn killed_at_random_moments_a_campaign_goes_on_to_the_same_end() {
    let wanted = undisturbed();
    let tasks = 27;
    for round in 0..12_u64 {
        let space = Space::new();
        space.write("w.toml", CAMPAIGN);
        let mut killed = 0;
        // Moments spread over the few milliseconds that the campaign takes.
        for moment in [1_000, 2_500, 5_000, 9_000].map(|us| us + 311 * round) {
            let mut child = space.start(&["run", "w.toml", "--quiet"]);
            std::thread::sleep(Duration::from_micros(moment));
            killed += u32::from(child.kill().is_ok());
            child.wait().expect("the end of a killed run");
        }
        assert!(killed > 0);
        let left = space.objects().len();
        let ran: Ran = space.run(&[]);
        let computed: u64 = ran.ran.iter().map(|(_, n)| n).sum();
        assert!(computed as usize + left >= tasks, "{computed} computed with {left} there");
        assert_eq!(ran.objects.into_iter().collect::<BTreeMap<_, _>>(), wanted);
        space.run(&[]).expect(&[]);
    }
}

#[test]
fn two_runs_on_one_store_share_the_work() {
    let wanted = undisturbed();
    let space = Space::new();
    space.write("w.toml", CAMPAIGN);
    let runs: Vec<_> = (0..4).map(|_| space.start(&["run", "w.toml", "--quiet", "--json"])).collect();
    let mut computed = 0;
    for run in runs {
        let output = run.wait_with_output().expect("the end of a run");
        assert!(output.status.success(), "{}", crate::space::told(&output));
        let ran = Ran::read(&output);
        computed += ran.ran.iter().map(|(_, n)| n).sum::<u64>();
        assert_eq!(ran.objects.into_iter().collect::<BTreeMap<_, _>>(), wanted);
    }
    assert_eq!(computed, 27, "each task is computed once");
}
