//! Pictures of what is in space.

use super::*;
use crate::stage::Sketch;
use dem::genesis::region::Region;

fn cube() -> Artifact {
    let stored = Specimen {
        outline: "box".into(),
        width: 0.02,
        height: 0.04,
        depth: 0.03,
        density: 2000.0,
        centres: Array2::from(vec![[0.0, 0.01, 0.005], [0.002, 0.0, 0.0], [0.004, 0.01, -0.004]]),
        group_of: vec![0, 1, 1],
        groups: words(["mortar", "aggregate"]),
        radii: vec![1e-3; 3],
        clump_of: vec![-1; 3],
        clumps: table(),
        polygon_of: Vec::new(),
        vertices: Vec::new(),
        quality: table(),
        warnings: Vec::new(),
        failure: None,
    };
    stored.to_artifact()
}

/// Height points up and is called y, as in files of the specimen; all balls are numbers of the figure.
#[test]
fn a_specimen_in_space_stands_upright() {
    let picture = made("show = 'specimen'\nof = 'a'", &[cube()], &[]).unwrap();
    let data = picture.table("data").unwrap();
    assert_eq!(data.shown("x").unwrap().0, [0.0, 2.0, 4.0]);
    assert_eq!(data.shown("y").unwrap().0, [10.0, 0.0, 10.0]);
    assert_eq!(data.shown("z").unwrap().0, [5.0, 0.0, -4.0]);
    assert!(text(&picture, "svg").contains("y 40 mm"));
    assert!(text(&picture, "description").contains("3 balls in 20 mm × 30 mm × 40 mm"));
}

/// The cut is asked for by the axes of the specimen, and said by them.
#[test]
fn a_specimen_in_space_is_cut_where_it_is_asked_for() {
    let cut = |more: &str| {
        let picture = made(&format!("show = 'specimen'\nof = 'a'\n{more}"), &[cube()], &[]).unwrap();
        text(&picture, "description").split_once("cut open at ").map(|(_, at)| at.to_owned())
    };
    assert_eq!(cut(""), None);
    assert_eq!(cut("cut = 'x'").unwrap(), "x = 0 mm.");
    assert_eq!(cut("cut = 'y'\ncut_at = '5 mm'").unwrap(), "y = 5 mm.");
    assert_eq!(cut("cut = 'z'\ncut_at = '-4 mm'").unwrap(), "z = -4 mm.");
    let mut context = context();
    let region = |region| Sketch { region: Some(region), ..Sketch::default() };
    context.sketches.insert("a".into(), region(Region::Box { width: 0.02, height: 0.04, depth: 0.03 }));
    context.sketches.insert("flat".into(), region(Region::Rectangle { width: 0.02, height: 0.04 }));
    let message_of = |text: &str| {
        let found = settings(&format!("show = 'specimen'\n{text}")).check(&context);
        found.into_iter().map(|c| c.message).collect::<Vec<_>>().join("; ")
    };
    assert_eq!(message_of("of = 'a'\ncut = 'y'\ncut_at = '19 mm'"), "");
    assert_eq!(message_of("of = 'a'\ncut = 'z'\ncut_at = '15 mm'"), "the specimen reaches 15 mm from its middle");
    assert_eq!(message_of("of = 'a'\ncut_at = '1 mm'"), "`cut_at` has no effect without `cut`");
    assert_eq!(message_of("of = 'flat'\ncut = 'x'"), "`cut` has no effect on a specimen in the plane");
    let other = settings("show = 'crack-rose'\nof = 'a'\ncut = 'x'").check(&context);
    assert_eq!(other[0].message, "`cut` has no effect on a figure that shows `crack-rose`");
}

/// Cracks of a run in space stand in the frame of its specimen, as discs of half their size.
#[test]
fn cracks_in_space_are_discs() {
    let mut run = Run::from_artifact(&run()).unwrap();
    let cracks = run.cracks.as_mut().unwrap();
    cracks.position = Array2::from_shape_fn((30, 3), |(i, axis)| [1e-4, 2e-4, -1e-4][axis] * i as f64);
    cracks.normal = Array2::from_shape_fn((30, 3), |(_, axis)| [0.0, 1.0, 0.0][axis]);
    let picture = made("show = 'cracks'\nof = 'a'\ncompare = 'b'", &[run.to_artifact()], &[cube()]).unwrap();
    let data = picture.table("data").unwrap();
    assert_eq!(data.shown("normal_y").unwrap().0[3], 1.0);
    assert!((data.shown("radius").unwrap().0[0] - 0.5).abs() < 1e-12);
    assert!(text(&picture, "description").starts_with("30 cracks in 20 mm"));
}
