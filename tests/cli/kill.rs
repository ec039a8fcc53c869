//! kill −9 at any moment: the next run goes on, with the results of an undisturbed one.

use crate::space::{Ran, Space};
use std::collections::BTreeMap;
use std::time::Duration;

/// Many small tasks, so that a kill meets every part of the work.
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

/// Kills as many runs as `FLOW_TEST_KILLS` says, 200 for the whole test, at moments spread over the time that a campaign
/// takes from its first breath to its end.
#[test]
fn killed_at_random_moments_a_campaign_goes_on_to_the_same_end() {
    let (wanted, span) = (undisturbed(), time_of_a_run());
    let kills: u32 = std::env::var("FLOW_TEST_KILLS").ok().and_then(|n| n.parse().ok()).unwrap_or(24);
    let (mut moment, mut killed) = (0x9e37_79b9_7f4a_7c15_u64, 0);
    while killed < kills {
        let space = Space::new();
        space.write("w.toml", CAMPAIGN);
        let mut here = 0;
        while here < 8 {
            moment = moment.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            let mut child = space.start(&["run", "w.toml", "--quiet", "--jobs", "2"]);
            std::thread::sleep(span.mul_f64((moment >> 40) as f64 / f64::from(1 << 24)));
            if child.try_wait().expect("the state of a run").is_some() {
                break;
            }
            child.kill().expect("killing a run");
            child.wait().expect("the end of a killed run");
            (here, killed) = (here + 1, killed + 1);
        }
        let computed = space.objects().iter().filter(|path| is_object(path)).count();
        let ran: Ran = space.run(&[]);
        let last: u64 = ran.ran.iter().map(|(_, n)| n).sum();
        // What had its name among the objects is at most not yet recorded: a worker each for every kill.
        assert!(last as usize + computed >= TASKS, "{last} computed with {computed} there");
        assert!(
            last as usize + computed <= TASKS + 2 * here,
            "{last} computed with {computed} there after {here} kills"
        );
        assert_eq!(ran.objects.into_iter().collect::<BTreeMap<_, _>>(), wanted);
        space.run(&[]).expect(&[]);
    }
}

const TASKS: usize = 27;

fn is_object(path: &std::path::Path) -> bool {
    path.extension().is_some_and(|extension| extension == "h5")
}

/// A cold run of the campaign, the faster of two.
fn time_of_a_run() -> Duration {
    let run = || {
        let space = Space::new();
        space.write("w.toml", CAMPAIGN);
        let start = std::time::Instant::now();
        space.run(&[]);
        start.elapsed()
    };
    run().min(run())
}

#[test]
fn two_and_eight_runs_on_one_store_share_the_work() {
    let wanted = undisturbed();
    for count in [2, 8] {
        share(count, &wanted);
    }
}

fn share(count: usize, wanted: &BTreeMap<String, Option<String>>) {
    let space = Space::new();
    space.write("w.toml", CAMPAIGN);
    let runs: Vec<_> = (0..count).map(|_| space.start(&["run", "w.toml", "--quiet", "--json"])).collect();
    let mut computed = 0;
    for run in runs {
        let output = run.wait_with_output().expect("the end of a run");
        assert!(output.status.success(), "{}", crate::space::told(&output));
        let ran = Ran::read(&output);
        computed += ran.ran.iter().map(|(_, n)| n).sum::<u64>();
        assert_eq!(&ran.objects.into_iter().collect::<BTreeMap<_, _>>(), wanted);
    }
    assert_eq!(computed, TASKS as u64, "each task is computed once");
}
