//! The tests against closed forms, on lattices where there are any and on small random specimens.

use super::drive::TestFailure;
use super::kind::TestKind;
use super::material::{Contact, Material};
use super::pace::Pace;
use super::piece::Piece;
use super::platens::{balance, between_platens};
use super::record::TestRecord;
use super::settings::{Loading, TestError};
use super::speed::{Speed, Threshold};
use crate::genesis::groups::Share;
use crate::genesis::packing::Packing;
use crate::genesis::region::Region;
use crate::genesis::specimen::{Recipe, Specimen};
use crate::measure::{self, stress};
use crate::{D2, Faults, Group, Watch};

fn material(modulus: f64, ratio: f64, strength: f64) -> Material {
    let contact = Contact::bonded("rock", modulus, ratio, [strength; 2], 0.5);
    Material { gap: 1e-3, ..Material::of_one(contact) }
}

/// Unit discs in `rows` rows of `columns`, touching; every other row shifted by a radius and one shorter.
fn hexagon(columns: usize, rows: usize) -> Specimen {
    let rise = 3.0_f64.sqrt();
    let (width, height) = (2.0 * columns as f64, 2.0 + rise * (rows - 1) as f64);
    let mut centres = Vec::new();
    for row in 0..rows {
        let short = row % 2;
        for column in 0..columns - short {
            let x = 1.0 + short as f64 + 2.0 * column as f64 - 0.5 * width;
            centres.push([x, 1.0 + rise * row as f64 - 0.5 * height]);
        }
    }
    let radii = vec![1.0; centres.len()];
    let region = Region::Rectangle { width, height };
    let (groups, group_names) = (vec![Group(0); radii.len()], vec!["mortar".to_owned()]);
    let (polygons, clumps) = (Vec::new(), Vec::new());
    Specimen { region, centres, radii, groups, group_names, density: 2000.0, polygons, clumps }
}

fn random(region: Region, mean_radius: f64) -> Specimen {
    let packing = Packing::uniform(0.12, mean_radius, 2.5);
    let groups = vec![Share { name: "mortar".to_owned(), share: 1.0 }];
    Recipe { region, packing, density: 2000.0, groups, aggregate: None }.make(1, &|| Watch::Continue).unwrap().0
}

fn small() -> Specimen {
    random(Region::Rectangle { width: 0.05, height: 0.1 }, 2.5e-3)
}

fn run(test: &Loading, specimen: &Specimen, material: &Material) -> TestRecord<D2> {
    test.run(&Piece::from(specimen), material, 1, &mut |_| Watch::Continue).unwrap()
}

fn loading(kind: TestKind, speed: f64) -> Loading {
    Loading { speed: Speed::Each(speed), ..Loading::new(kind) }
}

/// E = 2√3 k_n (k_n + k_s) / (3 k_n + k_s) per unit thickness; for k_s = k_n that is √3 k_n with ν = 0, so that rows
/// across the load stay unstrained and only one branch of the bilinear contact acts: spring and cement (k_n = 2 E_c) in
/// compression, cement alone (k_n = E_c) in tension. At the platens a ball of width 2R bears on a spring 2 E_c, which
/// adds R / E_c to the compliance at each end. Between two rows of n and n − 1 balls stand 2 (n − 1) contacts, not 2 n;
/// the balls at the free sides turn, which is the tolerance.
#[test]
fn a_hexagonal_lattice_has_its_modulus_in_compression_and_in_tension() {
    let (modulus, specimen) = (1e9, hexagon(40, 41));
    let material = material(modulus, 1.0, 1e6);
    let height = specimen.region.extent()[1];
    let lattice = 2.0 * 3.0_f64.sqrt() * modulus * 39.0 / 40.0;
    let mounted = height / ((height - 2.0) / lattice + 2.0 / modulus);
    let compressed = run(&loading(TestKind::Uniaxial, 0.02), &specimen, &material).values;
    assert!((compressed.modulus_secant / mounted - 1.0).abs() < 0.03, "{compressed:?} {mounted}");
    assert!(compressed.poisson_secant.abs() < 0.05, "{compressed:?}");
    let pulled = run(&loading(TestKind::Tension, 0.02), &specimen, &material).values;
    assert!((pulled.modulus_secant / (0.5 * lattice) - 1.0).abs() < 0.03, "{pulled:?}");
}

#[test]
fn a_random_specimen_fails_with_a_record_and_the_same_bits_every_time() {
    let (test, specimen, material) = (loading(TestKind::Uniaxial, 0.2), small(), material(20e9, 2.5, 20e6));
    let (a, b) = (run(&test, &specimen, &material), run(&test, &specimen, &material));
    assert_eq!(a.run.samples, b.run.samples);
    assert_eq!(format!("{:?}", a.run.cracks), format!("{:?}", b.run.cracks));
    assert_eq!(a.run.failure, None);
    assert!((25e6..75e6).contains(&a.values.strength), "{:?}", a.values);
    assert!((20e9..40e9).contains(&a.values.modulus_tangent), "{:?}", a.values);
    assert!((0.1..0.45).contains(&a.values.poisson_secant), "{:?}", a.values);
    let last = a.run.samples[a.run.samples.len() - 1];
    assert!(last.stress <= 0.75 * a.values.strength && a.run.cracks.len() == last.cracks);
    assert_eq!(a.run.snapshots.len(), 4);
    assert!(a.run.cracks.windows(2).all(|pair| pair[0].strain <= pair[1].strain));
    let books = a.run.energies.last().unwrap().1;
    assert!(books.imbalance().abs() < 0.02 && books.boundary > 0.0, "{books:?}");
    let (least, warning) = (super::judgement::LEAST_TRANSITS, a.judgement.warning().unwrap());
    assert!(a.judgement.transits < least && warning.found == a.judgement.transits);
    let slower = Loading { speed: Speed::Each(0.999 * warning.remedy), ..test };
    let slower = run(&slower, &specimen, &material).judgement;
    assert!(slower.warning().is_none() && slower.transits < 1.01 * least, "{slower:?}");
}

/// The trace of the stress is Σ f_n l / A over all contacts, and there is nothing across the load. The outermost branches,
/// from the platens to the centres of the balls that they touch, belong to the platens: about one radius at each end.
#[test]
fn forces_that_are_kept_carry_the_load() {
    let (mut test, specimen, material) = (loading(TestKind::Uniaxial, 0.1), small(), material(20e9, 2.5, 20e6));
    let plain = run(&test, &specimen, &material);
    test.rule.forces = true;
    let kept = run(&test, &specimen, &material);
    assert_eq!(plain.run.samples, kept.run.samples);
    assert!(plain.run.snapshots.iter().all(|snapshot| snapshot.state.forces.is_empty()));
    let [width, height] = specimen.region.extent();
    for snapshot in &kept.run.snapshots[..3] {
        let (centres, forces) = (&snapshot.state.centres, &snapshot.state.forces);
        assert!(forces.windows(2).all(|pair| pair[0].ends < pair[1].ends));
        let length = |[i, j]: [usize; 2]| {
            let [dx, dy] = [0, 1].map(|k| centres[j][k] - centres[i][k]);
            (dx * dx + dy * dy).sqrt()
        };
        let trace: f64 = forces.iter().map(|link| link.normal * length(link.ends)).sum();
        let load = snapshot.stress * width * (height * (1.0 - snapshot.strain) - 2.0 * specimen.mean_radius());
        assert!((trace / load - 1.0).abs() < 0.02, "{} at {} Pa", trace / load, snapshot.stress);
    }
}

/// What finished simulations are known by does not change with the setting that they do not use.
#[test]
fn a_test_that_keeps_no_forces_does_not_speak_of_them() {
    let text = |test: &Loading| serde_json::to_string(test).unwrap();
    let mut test = loading(TestKind::Uniaxial, 0.02);
    assert!(!text(&test).contains("forces"));
    test.rule.forces = true;
    assert!(text(&test).contains("\"forces\":true"));
}

/// With moduli and strengths times 4 and speed times 2 every number of the run scales by a power of two: the time step
/// halves, forces grow fourfold, and the results follow to the last bit.
#[test]
fn strength_and_modulus_scale_with_their_microparameters() {
    let specimen = small();
    let base = run(&loading(TestKind::Uniaxial, 0.2), &specimen, &material(20e9, 2.5, 20e6)).values;
    let scaled = run(&loading(TestKind::Uniaxial, 0.4), &specimen, &material(80e9, 2.5, 80e6)).values;
    assert_eq!(scaled.strength, 4.0 * base.strength);
    assert_eq!(scaled.modulus_tangent, 4.0 * base.modulus_tangent);
    assert_eq!(scaled.poisson_secant, base.poisson_secant);
}

#[test]
fn a_test_without_a_peak_is_a_result_with_a_reason() {
    let mut test = loading(TestKind::Uniaxial, 0.2);
    test.rule.strain_limit = Threshold::Absolute(1e-4);
    let record = run(&test, &small(), &material(20e9, 2.5, 20e6));
    assert!(matches!(record.run.failure, Some(TestFailure::NoPeak { strain_limit: 1e-4, .. })));
    assert!(record.run.samples.len() > 10);
    assert_eq!(
        TestFailure::NoPeak { strain_limit: 2e-9, stress: 34_512.0 }.to_string(),
        "no peak up to a strain of 2e-9: the largest stress is 34.5 kPa; raise strain_limit, or check the strengths of \
         the bonds"
    );
}

/// Tension stretches 0.8 of the height between grips, bending strains the outer fibre by 6 h w/L²: a rate of strain that is
/// asked for is that of the piece in each test.
#[test]
fn a_rate_of_strain_is_that_of_the_piece_in_every_kind_of_test() {
    let scales = super::rig::Scales { modulus: 20e9, strength: 20e6, density: 2000.0 };
    let outline = Region::Rectangle { width: 0.2, height: 0.04 }.into();
    for kind in super::kind::KINDS {
        let test = Loading { speed: Speed::StrainRate(0.25), ..Loading::new(kind) };
        let schedule = test.schedule(&scales, &outline, 1e-7).unwrap();
        assert!((schedule.rate - 0.25).abs() < 1e-15, "{kind:?}: {}", schedule.rate);
        let speed = match kind {
            TestKind::Tension => 0.25 * 0.4 * 0.04,
            TestKind::Bending => 0.25 * 0.18 * 0.18 / (6.0 * 0.04),
            _ => 0.25 * 0.02,
        };
        assert!((schedule.speed - speed).abs() < 1e-12 * speed, "{kind:?}: {}", schedule.speed);
    }
}

#[test]
fn an_outline_that_does_not_fit_names_the_remedy() {
    let disc = random(Region::Disc { diameter: 0.05 }, 2e-3);
    let error = Loading::new(TestKind::Uniaxial)
        .run(&Piece::from(&disc), &material(20e9, 2.5, 20e6), 1, &mut |_| Watch::Continue);
    assert!(matches!(error.unwrap_err(), TestError::Outline { wanted: "rectangle", .. }));
}

/// Each would run for ever or not at all.
#[test]
fn settings_of_a_test_that_cannot_end_are_named() {
    let mut test = loading(TestKind::Uniaxial, 0.0);
    test.rule.sample_strain = Threshold::Absolute(f64::NAN);
    test.rule.stop_fraction = 1.5;
    test.rule.strain_limit = Threshold::Absolute(-1.0);
    test.rule.snapshots = vec![0.5, 0.0];
    let error = test.run(&Piece::from(&small()), &material(20e9, 2.5, 20e6), 1, &mut |_| Watch::Continue).unwrap_err();
    let TestError::Faults(Faults(faults)) = error else { panic!("{error}") };
    let text: Vec<String> = faults.iter().map(ToString::to_string).collect();
    assert_eq!(
        text,
        [
            "speed of the test is 0 m/s, wanted a number above 0",
            "strain between samples is NaN, wanted a number above 0",
            "share of the peak at the end is 1.5, wanted in (0, 1]",
            "strain limit is -1, wanted a number above 0",
            "share of the peak of a snapshot is 0, wanted in (0, 1]",
        ]
    );
}

/// Elastic disc under point loads: at the centre compression 3 along the load and tension 1 across it, in units of
/// 2F/(πD); the mean of that field over the inner 0.4 D is 2.84 and 0.84. The packing's noise and its lower stiffness in
/// tension are the tolerance.
#[test]
fn an_unbroken_disc_has_the_elastic_stresses_at_its_centre() {
    let diameter = 0.1;
    let specimen = random(Region::Disc { diameter }, 1.5e-3);
    let test = loading(TestKind::Brazilian, 0.05);
    let piece = Piece::from(&specimen);
    let (mounted, platens) = between_platens(&test, &piece, &material(20e9, 2.5, 1e12), 1).unwrap();
    let mut engine = mounted.engine;
    platens.approach(&mut engine, 0.05).unwrap();
    let steps = (1e-4 * diameter / (2.0 * 0.05 * engine.time_step())) as u64;
    engine.advance(steps).unwrap();
    let [force, _] = balance(platens.forces(&engine));
    let unit = 2.0 * force / (std::f64::consts::PI * diameter);
    let region = measure::Region::<D2>::Ball { centre: [0.0, 0.0], radius: 0.2 * diameter };
    let found = stress(&engine, &region);
    let (along, across) = (found[1][1] / unit, -found[0][0] / unit);
    assert!((along - 2.84).abs() < 0.25 && (across - 0.84).abs() < 0.25, "{along} {across}");
}

#[test]
fn a_disc_splits_along_the_loaded_diameter() {
    let specimen = random(Region::Disc { diameter: 0.1 }, 2e-3);
    let record = run(&loading(TestKind::Brazilian, 0.1), &specimen, &material(20e9, 2.5, 20e6));
    assert_eq!(record.run.failure, None);
    assert!((3e6..30e6).contains(&record.values.strength), "{:?}", record.values);
    assert_eq!(record.validity(), "");
}

/// Few discs make each run a draw; what is asked for here is that nothing but the number of steps changes by much.
#[test]
fn a_test_that_adapts_takes_fewer_steps_to_the_same_answer() {
    let (specimen, material) = (small(), material(20e9, 2.0, 20e6));
    for kind in [TestKind::Uniaxial, TestKind::Tension] {
        let fixed = run(&Loading { speed: Speed::Transits(80.0), ..Loading::new(kind) }, &specimen, &material);
        let test = Loading { speed: Speed::Transits(80.0), pace: Pace::Adaptive, ..Loading::new(kind) };
        let adaptive = run(&test, &specimen, &material);
        assert!(
            (adaptive.run.steps as f64) < 0.6 * fixed.run.steps as f64,
            "{kind:?}: {} {}",
            adaptive.run.steps,
            fixed.run.steps
        );
        for (a, b, bound) in [
            (adaptive.values.strength, fixed.values.strength, 0.05),
            (adaptive.values.modulus_secant, fixed.values.modulus_secant, 0.005),
            (adaptive.values.poisson_secant, fixed.values.poisson_secant, 0.02),
        ] {
            assert!((a / b - 1.0).abs() < bound, "{kind:?}: {a} {b}");
        }
        let speeds: Vec<f64> = adaptive.run.samples.iter().map(|sample| sample.speed).collect();
        let slow = fixed.judgement.speed;
        let [least, most] = [f64::min, f64::max].map(|pick| speeds.iter().map(|v| v / slow).reduce(pick).unwrap());
        assert!(least > 0.999 && most > 5.0, "{kind:?}: {least} {most}");
        assert!(adaptive.run.energies.iter().all(|(_, energy)| energy.imbalance().abs() < 0.02), "{kind:?}");
        let again = run(&test, &specimen, &material);
        assert_eq!(again.run.samples, adaptive.run.samples, "{kind:?}");
    }
}
