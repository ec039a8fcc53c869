//! Settings read, refused, and stored.

use super::*;
use dem::genesis::packing::Packing;
use dem::genesis::region::Region;

#[test]
fn a_specimen_comes_back_as_it_was_stored() {
    let config: Specimen = toml::from_str(
        "width = '50 mm'\nheight = '100 mm'\nporosity = 0.12\nmean_radius = '1.5 mm'\nradius_ratio = 2.5\n\
         density = '2000 kg/m^3'\n[aggregate]\ngradation = 'walraven'\ncontent = 0.75\n\
         classes = ['8 mm', '12 mm']\nvertices = [4, 6]\narea = 'equal-area'\nangles = 'jittered'\n\
         density = '2650 kg/m^3'",
    )
    .unwrap();
    let (made, quality) = config.recipe().unwrap().make::<D2>(1, &|| dem::Watch::Continue).unwrap();
    assert!(!made.clumps.is_empty());
    let artifact = stored::store(&made, &quality).to_artifact();
    assert_eq!(format!("{:?}", load(&artifact).unwrap().plane().unwrap()), format!("{made:?}"));
}

#[test]
fn settings_that_lack_or_have_no_effect_are_complaints() {
    let text = "width = '50 mm'\nheight = '100 mm'\nporosity = 0.12\nmean_radius = '1.5 mm'\nradius_ratio = 2.5\n\
                density = '2000 kg/m^3'\n[aggregate]\ngradation = 'table'\ncontent = 0.75\nclasses = ['8 mm', '12 mm']\n\
                vertices = [4, 6]\narea = 'inscribed'\ndensity = '2650 kg/m^3'";
    let config: Specimen = toml::from_str(text).unwrap();
    let messages: Vec<String> = config.check(&Context::default()).into_iter().map(|c| c.message).collect();
    assert_eq!(messages, ["`content` has no effect on gradation `table`", "gradation `table` needs `passing`"]);
}

fn read(text: &str) -> Specimen {
    toml::from_str(text).unwrap()
}

fn messages(text: &str) -> Vec<String> {
    read(text).check(&Context::default()).into_iter().map(|c| format!("{}: {}", c.path.join("."), c.message)).collect()
}

const RADII: &str = "mean_radius = '2 mm'\nradius_ratio = 1.66\ndensity = '2650 kg/m^3'\n";

#[test]
fn a_solid_specimen_to_a_stress_comes_back_as_it_was_stored() {
    let outline = "diameter = '30 mm'\nheight = '40 mm'\ngroups = { quartz = 0.3, feldspar = 0.7 }\n";
    let config = read(&format!("{outline}{RADII}packing = {{ stress = '3 MPa' }}"));
    let recipe = config.recipe().unwrap();
    assert_eq!(recipe.region, Region::Cylinder { diameter: 0.03, height: 0.04 });
    let (made, quality) = recipe.make::<D3>(1, &|| dem::Watch::Continue).unwrap();
    assert!((quality.stress.unwrap() / 3e6 - 1.0).abs() < 0.01);
    assert_eq!(made.group_names, ["feldspar", "quartz"]);
    let artifact = stored::store(&made, &quality).to_artifact();
    let Loaded::Solid(loaded) = load(&artifact).unwrap() else { panic!("a plane specimen") };
    assert_eq!(format!("{loaded:?}"), format!("{made:?}"));
    assert!(load(&artifact).unwrap().plane().is_err());
}

const STONES: &str = "width = '40 mm'\nheight = '40 mm'\ndepth = '40 mm'\nporosity = 0.36\n[stones]\nshapes = 'shapes'\n\
                      density = '2700 kg/m^3'\nbulk_density = '2300 kg/m^3'\n";

/// Rigid clumps in space come back with their pebbles, whole inertia and centre.
#[test]
fn a_mix_comes_back_as_it_was_stored() {
    let classes = "classes = [{ from = '8 mm', to = '14 mm', count = 5 }]";
    let config = read(&format!("{RADII}{STONES}{classes}"));
    assert!(config.check(&Context::default()).is_empty());
    let recipe = config.recipe().unwrap();
    let mix = config.stones.as_ref().unwrap().mix(&recipe).unwrap();
    let shape = dem::genesis::stones::Template {
        share: 1.0,
        breadth: 10e-3,
        volume: 7e-7,
        inertia: [6e-12, 9e-12, 9e-12],
        centres: vec![[-3e-3, 0.0, 0.0], [3e-3, 0.0, 0.0]],
        radii: vec![5e-3; 2],
    };
    let (made, quality, report) = mix.make(&recipe, &[shape], 1, &|| dem::Watch::Continue).unwrap();
    let mut stored = stored::store(&made, &quality);
    stored.quality = report::with_mix(stored.quality, &report, quality.contacts);
    let artifact = stored.to_artifact();
    let Loaded::Solid(loaded) = load(&artifact).unwrap() else { panic!("a plane specimen") };
    assert_eq!(format!("{loaded:?}"), format!("{made:?}"));
    let table = artifact.table("quality").unwrap();
    let row = table.texts("quantity").unwrap().iter().position(|name| name == "bulk density").unwrap();
    assert!((table.numbers("value", "").unwrap()[row] - 2300.0).abs() < 1e-6);
}

/// Masses and Fuller's curve become numbers; what lacks or is twice there is named.
#[test]
fn classes_of_stones_have_one_number_each() {
    let of = |keys: &str| messages(&format!("{RADII}{STONES}{keys}"));
    let class = |number: &str| format!("classes = [{{ from = '8 mm', to = '14 mm'{number} }}]");
    assert!(of(&class(", mass = '20 g'")).is_empty());
    assert!(of(&format!("{}\nfuller = {{ content = 0.2 }}", class(""))).is_empty());
    let lacks = ["stones.classes: class 1 needs one of `count`, `mass`, `share`"];
    assert_eq!(of(&class("")), lacks);
    assert_eq!(of(&class(", count = 3, share = 0.1")), lacks);
    let odd = of(&format!("{}\ncoarsen = 0.5\ngroup = 'mortar'", class(", share = 2")));
    assert_eq!(
        odd.iter().map(|f| f.split(':').next().unwrap()).collect::<Vec<_>>(),
        ["stones.classes", "stones.coarsen", "stones.group"]
    );
}

/// Each outline has its keys and no other.
#[test]
fn outlines_are_told_by_their_keys() {
    let region = |keys: &str| {
        let config = read(&format!("{keys}\n{RADII}porosity = 0.12"));
        config.recipe().map(|recipe| recipe.region.name()).map_err(|faults| faults[0].message.clone())
    };
    assert_eq!(region("width = '0.1 m'\nheight = '0.1 m'"), Ok("rectangle"));
    assert_eq!(region("diameter = '0.1 m'"), Ok("disc"));
    assert_eq!(region("width = '0.1 m'\nheight = '0.1 m'\ndepth = '0.1 m'"), Ok("box"));
    assert_eq!(region("diameter = '0.1 m'\nheight = '0.1 m'"), Ok("cylinder"));
    assert_eq!(region("diameter = '0.1 m'\ndepth = '0.1 m'"), Ok("thick-disc"));
    assert_eq!(region("width = '0.1 m'"), Err("the outline is not clear".to_owned()));
    assert_eq!(region("width = '0.1 m'\ndiameter = '0.1 m'"), Err("the outline is not clear".to_owned()));
}

#[test]
fn settings_of_packings_and_sizes_that_do_not_fit_are_named() {
    let plane = "width = '0.1 m'\nheight = '0.2 m'\ndensity = '2650 kg/m^3'\n";
    assert_eq!(messages(&format!("{plane}mean_radius = '2 mm'\nradius_ratio = 2")), [": the packing is not clear"]);
    assert_eq!(
        messages(&format!(
            "{plane}mean_radius = '2 mm'\nradius_ratio = 2\nporosity = 0.1\npacking = {{ stress = '1 MPa' }}"
        )),
        ["porosity: `porosity` has no effect on a packing to a stress or as a lattice"]
    );
    assert_eq!(
        messages(&format!("{plane}mean_radius = '2 mm'\npacking = {{ lattice = 'hexagonal', stress = '1 MPa' }}")),
        ["packing.stress: `packing.stress` has no effect on a lattice"]
    );
    assert_eq!(
        messages(&format!("{plane}sizes = 'log-normal'\nmean_radius = '2 mm'\nporosity = 0.1")),
        [
            "radius_ratio: sizes \"log-normal\" needs `radius_ratio`",
            "size_deviation: sizes \"log-normal\" needs `size_deviation`"
        ]
    );
    assert_eq!(
        messages(&format!("{plane}mean_radius = '2 mm'\nsmallest_radius = '1 mm'\nradius_ratio = 2\nporosity = 0.1")),
        ["smallest_radius: `mean_radius` and `smallest_radius` are both given"]
    );
    let sieve =
        "sizes = 'sieve'\nsieve = { diameters = ['2 mm', '4 mm', '8 mm'], passing = [0, 0.4, 1] }\nporosity = 0.12";
    assert!(messages(&format!("{plane}{sieve}")).is_empty());
    let lattice =
        read(&format!("{plane}mean_radius = '2 mm'\npacking = {{ lattice = 'hexagonal' }}")).recipe().unwrap();
    assert!(matches!(lattice.packing, Packing::Lattice { radius, .. } if radius == 2e-3));
}

/// What would take all memory or never end is refused by `check`, with the number that it would be.
#[test]
fn monstrous_and_impossible_packings_are_refused_before_they_run() {
    let plane = "width = '0.1 m'\nheight = '0.2 m'\ndensity = '2650 kg/m^3'\nradius_ratio = 2.5\n";
    let of = |keys: &str| messages(&format!("{plane}{keys}"));
    let tiny = of("mean_radius = '1 nm'\nporosity = 0.12");
    assert!(tiny.len() == 1 && tiny[0].starts_with("mean_radius:") && tiny[0].contains("5.60e15"), "{tiny:?}");
    let loose = of("mean_radius = '1 mm'\nporosity = 0.9");
    assert!(loose.len() == 1 && loose[0].starts_with("porosity:"), "{loose:?}");
    let one = of("mean_radius = '50 mm'\nporosity = 0.12");
    assert!(one.len() == 1 && one[0].contains("gives 2 balls"), "{one:?}");
    let wide = messages(
        "width = '0.1 m'\nheight = '0.2 m'\ndensity = '2650 kg/m^3'\nradius_ratio = 100\nmean_radius = '1 mm'\nporosity = 0.12",
    );
    assert!(wide.len() == 1 && wide[0].starts_with("radius_ratio:"), "{wide:?}");
}

/// A stress of a twentieth of the modulus swallows the small ones of discs whose radii differ tenfold.
#[test]
fn a_packing_that_comes_to_nothing_is_a_result_with_its_reason() {
    let config = read(
        "diameter = '20 mm'\nsmallest_radius = '0.2 mm'\nradius_ratio = 10\ngives_way = 'number'\n\
         density = '2600 kg/m^3'\npacking = { stress = '50 MPa', modulus = '1 GPa' }",
    );
    let (params, said) = (serde_json::to_value(config.recipe().unwrap()).unwrap(), std::sync::Mutex::new(Vec::new()));
    let job = Job {
        params: &params,
        seed: Some(1),
        inputs: &[],
        files: &[],
        threads: &|| 1,
        time_limit: None,
        say: &|progress| said.lock().unwrap().push(progress.note),
        stop: &std::sync::atomic::AtomicBool::new(false),
    };
    let artifact = make(&job).unwrap();
    let failure = Stored::from_artifact(&artifact).unwrap().failure.unwrap();
    assert!(failure.starts_with("packing: overlaps reach"), "{failure}");
    assert_eq!(*said.lock().unwrap(), std::slice::from_ref(&failure));
    assert_eq!(config.unmet(&artifact), Some(failure.clone()));
    // Nobody takes it for a specimen without balls.
    assert_eq!(load(&artifact).unwrap_err().message, failure);
}
