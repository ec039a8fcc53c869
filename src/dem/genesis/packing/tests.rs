//! Packings to a porosity and to a stress.

use super::super::compress::Floaters;
use super::super::fabric::Pressure;
use super::super::sizes::{Size, SizeLaw};
use super::*;
use crate::D3;

const GO_ON: &dyn Fn() -> Watch = &|| Watch::Continue;
const SPECIMEN: Region = Region::Rectangle { width: 0.1, height: 0.2 };

fn small() -> Packing {
    Packing::uniform(0.12, 2e-3, 2.5)
}

fn pack(packing: &Packing, region: &Region, seed: u64) -> Packed {
    packing.pack::<D2>(region, &mut Stream::new(seed, "packing", 0), GO_ON).unwrap()
}

fn refused(packing: &Packing) -> PackingError {
    packing.pack::<D2>(&SPECIMEN, &mut Stream::new(1, "packing", 0), GO_ON).unwrap_err()
}

pub(super) fn target(stress: f64, cloud_porosity: f64) -> StressTarget {
    StressTarget {
        stress,
        modulus: 30e9,
        tolerance: 0.01,
        cloud_porosity,
        equilibrium: 8e-3,
        floaters: Floaters::Enlarge,
        floater_share: 0.0,
    }
}

/// Isostatic frictionless discs have coordination 4; the study with another code had 4.55 at this porosity.
#[test]
fn a_dense_packing_is_at_rest_and_held() {
    let packed = pack(&small(), &SPECIMEN, 1);
    assert!((1.0 - packed.heap.ball_volume() / 0.02 - 0.12).abs() < 1e-12);
    let contacts = packed.heap.contact_counts();
    assert!(contacts.iter().all(|&n| n >= 3), "{} floaters", contacts.iter().filter(|&&n| n < 3).count());
    let mean = Fabric::of(&packed.heap).coordination;
    assert!((4.4..4.7).contains(&mean), "{mean}");
    assert!(packed.unbalanced < 1e-3 && Fabric::of(&packed.heap).largest_overlap < 0.35);
    assert!((0.95..0.98).contains(&packed.radius_factor), "{}", packed.radius_factor);
}

/// Bits of packings to a porosity as they were when the published campaign was computed.
#[test]
fn published_packings_keep_their_bits() {
    let cases = [
        (SPECIMEN, small(), 0xc4ff_352e_e673_bb18),
        (Region::Disc { diameter: 0.1 }, small(), 0xec08_1a1e_9a8c_35b4),
        (Region::Rectangle { width: 0.05, height: 0.1 }, Packing::uniform(0.15, 1e-3, 1.66), 0xd11c_582f_9ff8_f953),
    ];
    for (region, packing, expected) in cases {
        let heap = pack(&packing, &region, 1).heap;
        let bytes = heap.centres.iter().flatten().chain(&heap.radii).flat_map(|x| x.to_bits().to_le_bytes());
        // FNV-1a.
        let hash =
            bytes.fold(0xcbf2_9ce4_8422_2325_u64, |h, byte| (h ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3));
        assert_eq!(hash, expected, "{region:?}");
    }
}

#[test]
fn a_seed_gives_its_packing_and_another_seed_another() {
    assert_eq!(pack(&small(), &SPECIMEN, 1).heap.centres, pack(&small(), &SPECIMEN, 1).heap.centres);
    assert_ne!(pack(&small(), &SPECIMEN, 1).heap.centres, pack(&small(), &SPECIMEN, 2).heap.centres);
}

/// Stopped in its first iteration, in a later one, and after the last: never a packing that is another one.
#[test]
fn a_packing_that_is_stopped_is_none() {
    let to_stress = Packing::Stress { sizes: Sizes::uniform(3e-3, 1.66), target: target(1e6, 0.16) };
    for packing in [small(), to_stress] {
        for after in [0, 100] {
            let asked = std::cell::Cell::new(0);
            let watch = || {
                asked.set(asked.get() + 1);
                if asked.get() > after { Watch::Stop } else { Watch::Continue }
            };
            let error = packing.pack::<D2>(&SPECIMEN, &mut Stream::new(1, "packing", 0), &watch).unwrap_err();
            assert_eq!(error, PackingError::Stopped);
            assert!(asked.get() < after + 10, "{}", asked.get());
        }
    }
}

#[test]
fn a_disc_is_packed_by_the_same_code() {
    let region = Region::Disc { diameter: 0.1 };
    let packed = pack(&small(), &region, 1);
    assert!(packed.heap.centres.iter().all(|&c| region.depth::<D2>(c) > 0.0));
    assert_eq!(packed.heap.centres.len() as f64, small().count::<D2>(&region));
}

/// Stress within its tolerance, no floaters, coordination near the isostatic 2 d, in the plane and in the solid.
#[test]
fn a_packing_to_a_stress_has_it() {
    let target = target(3e6, 0.16);
    let packed = pack(&Packing::Stress { sizes: Sizes::uniform(3e-3, 1.66), target }, &SPECIMEN, 1);
    let fabric = Fabric::of(&packed.heap);
    assert!((Pressure::of(&packed.heap).stress / 1e-4 - 1.0).abs() <= 0.01);
    assert!((fabric.mean_stress / 1e-4 - 1.0).abs() <= 0.01 && fabric.floaters < 2, "{fabric:?}");
    assert!((3.8..4.3).contains(&fabric.coordination) && fabric.anisotropy.abs() < 0.1, "{fabric:?}");

    let region = Region::Cylinder { diameter: 0.05, height: 0.08 };
    let target = StressTarget { cloud_porosity: 0.36, ..target };
    let packing = Packing::Stress { sizes: Sizes::uniform(2.5e-3, 1.66), target };
    let packed = packing.pack::<D3>(&region, &mut Stream::new(1, "packing", 0), GO_ON).unwrap();
    let fabric = Fabric::of(&packed.heap);
    assert!((fabric.mean_stress / 1e-4 - 1.0).abs() <= 0.01 && fabric.floaters < 3, "{fabric:?}");
    assert!((4.5..6.5).contains(&fabric.coordination), "{fabric:?}");
    assert!(packed.heap.centres.iter().all(|&c| region.depth::<D3>(c) > 0.0));
}

#[test]
fn floaters_are_deleted_or_kept_as_asked() {
    let sizes = Sizes::uniform(3e-3, 1.66);
    let with =
        |floaters| Packing::Stress { sizes: sizes.clone(), target: StressTarget { floaters, ..target(3e6, 0.16) } };
    let [kept, deleted] = [Floaters::Keep, Floaters::Delete].map(|floaters| pack(&with(floaters), &SPECIMEN, 1));
    let count = sizes.count::<D2>(0.02, 0.16) as usize;
    assert!(kept.heap.radii.len() == count && Fabric::of(&kept.heap).floaters > 0 && kept.floater_growth == 1.0);
    assert_eq!(deleted.heap.radii.len() + deleted.deleted, count);
    assert!(deleted.deleted > 0 && Fabric::of(&deleted.heap).floaters < 2);
}

/// The radii at the stress are the stated ones when the number gives way, those of floaters aside.
#[test]
fn a_number_that_gives_way_leaves_the_radii_alone() {
    let (law, size) = (SizeLaw::Uniform { ratio: 1.66 }, Size::Smallest(2.25e-3));
    let sizes = Sizes { law, size, gives_way: GivesWay::Number };
    let target = StressTarget { floaters: Floaters::Delete, ..target(3e6, 0.12) };
    let packed = pack(&Packing::Stress { sizes: sizes.clone(), target }, &SPECIMEN, 1);
    assert!((packed.radius_factor - 1.0).abs() < 1e-3, "{}", packed.radius_factor);
    let smallest = packed.heap.radii.iter().copied().fold(f64::INFINITY, f64::min);
    assert!((smallest / 2.25e-3 - 1.0).abs() < 3e-3, "{smallest}");
    assert!((Fabric::of(&packed.heap).mean_stress / 1e-4 - 1.0).abs() <= 0.01);
    let dense = pack(&Packing::Porosity { sizes, porosity: 0.12, floaters: 1.0 }, &SPECIMEN, 1);
    assert_eq!(dense.radius_factor, 1.0);
    assert!((1.0 - dense.heap.ball_volume() / 0.02 - 0.12).abs() < 2e-3);
}

#[test]
fn a_porosity_out_of_reach_says_on_which_side() {
    let error = refused(&Packing::uniform(0.25, 2e-3, 2.5));
    assert!(matches!(error, PackingError::Loose { porosity: 0.25, .. }), "{error}");
    let error = refused(&Packing::uniform(0.001, 3e-3, 10.0));
    assert!(matches!(error, PackingError::Dense { .. }), "{error}");
}

#[test]
fn faults_of_the_settings_are_named_at_once() {
    let sizes = Sizes::uniform(-1.0, 0.5);
    let bad = Packing::Porosity { sizes, porosity: 0.9, floaters: 2.0 };
    assert_eq!(bad.faults::<D2>(&SPECIMEN).len(), 4);
    let few = Packing::uniform(0.12, 0.02, 2.5).faults::<D2>(&SPECIMEN);
    assert!(matches!(few[..], [PackingError::Few { count: 14, .. }]), "{few:?}");
    let wide = Packing::uniform(0.12, 2e-3, 100.0).faults::<D2>(&SPECIMEN);
    assert_eq!(wide.len(), 1, "{wide:?}");
    let large = Packing::uniform(0.12, 6e-3, 20.0).faults::<D2>(&Region::Rectangle { width: 0.02, height: 0.6 });
    assert!(matches!(large[..], [PackingError::Large { .. }]), "{large:?}");
}

/// A radius of a nanometre: the error states the number of balls and their memory, before any is made.
#[test]
fn a_monstrous_packing_is_refused_with_its_number() {
    let tiny = Packing::uniform(0.12, 1e-9, 2.5).faults::<D2>(&SPECIMEN);
    let [PackingError::Many { count, gigabytes, .. }] = tiny[..] else { panic!("{tiny:?}") };
    assert!((count / 5.6e15 - 1.0).abs() < 0.01 && gigabytes > 1e9);
    let lattice = Packing::Lattice { lattice: Lattice::Square, radius: 1e-9 };
    assert!(matches!(lattice.faults::<D2>(&SPECIMEN)[..], [PackingError::Many { .. }]));
}

#[test]
fn lists_of_sizes_that_do_not_go_together_are_named() {
    let with = |law| {
        let sizes = Sizes { law, size: Size::Stated, gives_way: GivesWay::Radius };
        Packing::Porosity { sizes, porosity: 0.12, floaters: 0.0 }.faults::<D2>(&SPECIMEN)
    };
    let sieve = |diameters: &[f64], passing: &[f64]| {
        with(SizeLaw::Sieve { diameters: diameters.to_vec(), passing: passing.to_vec() })
    };
    assert!(sieve(&[2e-3, 4e-3], &[0.0, 1.0]).is_empty());
    assert_eq!(sieve(&[2e-3, 4e-3], &[0.0]).len(), 1);
    assert_eq!(sieve(&[4e-3, 2e-3], &[0.0, 1.0]).len(), 1);
    assert_eq!(sieve(&[2e-3, 4e-3], &[0.1, 1.0]).len(), 1);
    assert_eq!(with(SizeLaw::Classes { radii: vec![2e-3], counts: vec![0] }).len(), 1);
    let lattice = Packing::Lattice { lattice: Lattice::FaceCentred, radius: 1e-3 };
    assert!(matches!(lattice.faults::<D2>(&SPECIMEN)[..], [PackingError::Dimension { wanted: 3, found: 2, .. }]));
}
