//! Pictures of what is in space.

use super::*;

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
