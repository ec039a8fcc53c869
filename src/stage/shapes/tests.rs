use super::*;
use crate::stage::FileInput;
use ::shape::moments::Moments;
use std::sync::atomic::AtomicBool;

const SECTIONS: &str = "shape,position [mm],thickness [mm],height [mm]\n\
    egg,0,0,0\negg,10,14,12\negg,20,16,14\negg,30,0,0\n\
    slab,0,20,8\nslab,15,24,10\nslab,30,18,8\n";

fn made(settings: &str, files: &[(&str, &[u8])]) -> Result<Artifact, Failure> {
    let stage: Shapes = toml::from_str(settings).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let input = |(name, bytes): &(&str, &[u8])| {
        let path = folder.path().join(name);
        std::fs::write(&path, bytes).unwrap();
        FileInput { name: (*name).to_owned(), path, digest: *blake3::hash(bytes).as_bytes() }
    };
    let files: Vec<FileInput> = files.iter().map(input).collect();
    let (params, stop) = (json!(stage.params()), AtomicBool::new(false));
    make(&Job {
        params: &params,
        seed: None,
        inputs: &[],
        files: &files,
        threads: &|| 1,
        time_limit: None,
        say: &|_| {},
        stop: &stop,
    })
}

fn complaints(settings: &str) -> Vec<String> {
    let stage: Shapes = toml::from_str(settings).unwrap();
    stage
        .check(&Context::default())
        .into_iter()
        .map(|fault| format!("{}: {}", fault.path.join("."), fault.message))
        .collect()
}

/// Stored shapes come back as clumps in their principal axes and solids of the same volume.
#[test]
fn shapes_come_back_as_they_were_stored() {
    let artifact = made("sections = 's.csv'\nshare = [0.25, 0.75]", &[("sections", SECTIONS.as_bytes())]).unwrap();
    let shapes = load(&artifact).unwrap();
    assert_eq!(shapes.iter().map(|s| (s.name.as_str(), s.share)).collect::<Vec<_>>(), [("egg", 0.25), ("slab", 0.75)]);
    for shape in &shapes {
        let solid = Moments::of(&shape.mesh);
        assert!((shape.clump.moments.volume / solid.volume - 1.0 - shape.clump.errors.volume).abs() < 1e-9);
        let inertia = shape.clump.moments.inertia;
        assert!(inertia[0][0] < inertia[1][1] && inertia[1][1] < inertia[2][2]);
        assert!((solid.inertia[0][0] / inertia[0][0] - 1.0).abs() < 0.06);
        let (low, high) = shape.mesh.extent();
        assert!(high[0] - low[0] > high[1] - low[1]);
    }
    assert!((shapes[1].breadth - 24e-3).abs() < 1e-3);
}

#[test]
fn an_stl_is_a_shape_with_its_unit_and_what_was_mended() {
    let sections = [0.0, 10.0].map(|position| Section { position, thickness: 8.0, height: 6.0, exponent: 4.0 });
    let mut bytes = stl::write(&loft(&sections, 16).unwrap(), 1.0);
    // One facet turned: its second and third corner changed places.
    let (a, b) = (84 + 24, 84 + 36);
    let held: Vec<u8> = bytes[a..a + 24].to_vec();
    bytes[a..a + 12].copy_from_slice(&held[12..]);
    bytes[b..b + 12].copy_from_slice(&held[..12]);
    let artifact = made("stl = ['stones/pebble.stl']\nunit = '1 mm'", &[("pebble", &bytes)]).unwrap();
    let shape = &load(&artifact).unwrap()[0];
    assert_eq!(shape.name, "pebble");
    assert!((shape.mesh.surface() / 2.5e-4 - 1.0).abs() < 0.6);
    let stored = crate::artifact::shapes::Shapes::from_artifact(&artifact).unwrap();
    assert_eq!(stored.warnings, ["pebble: 1 facet faced inwards and was turned"]);
}

#[test]
fn what_is_wrong_is_said_before_anything_runs() {
    assert_eq!(complaints(""), [": no stones are named"]);
    let found = complaints(
        "sections = 'a.csv'\nunit = '1 mm'\naround = 7\nshare = [0.5, 0.6]\npebbles = { ratio = 2, distance = 190 }\nwithin = { volume = 0 }",
    );
    assert_eq!(
        found.iter().map(|f| f.split(':').next().unwrap()).collect::<Vec<_>>(),
        ["unit", "around", "pebbles.ratio", "pebbles.distance", "within.volume", "share"]
    );
    assert_eq!(complaints("stl = ['a/x.stl', 'b/x.stl']").len(), 2);
}

#[test]
fn every_fault_of_the_table_is_said_at_once() {
    let odd = SECTIONS.replace("egg,20", "egg,5").replace("slab,15,24,10", "slab,15,24,0");
    let Err(Failure::Failed(error)) = made("sections = 's.csv'", &[("sections", odd.as_bytes())]) else { panic!() };
    assert!(error.message.contains("shape `egg`: section 3 is at 5 mm, not beyond"), "{error}");
    assert!(error.message.contains("shape `slab`: section 2 has a thickness of"), "{error}");
}
