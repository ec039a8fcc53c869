//! Time and quality of packings: `cargo bench -p flow-dem --bench packing [-- NUMBER STRESS/MODULUS] [WORDS]`.
//!
//! Words choose cases by their names. Times are those of the thread, because other work on the machine does not count then.
//! `bits` is a fingerprint of centres and radii: builds that pack alike print the same.
#![allow(clippy::unwrap_used)]

use dem::genesis::compress::{Floaters, StressTarget};
use dem::genesis::fabric::Fabric;
use dem::genesis::packing::{Packed, Packing};
use dem::genesis::region::Region;
use dem::genesis::sizes::Sizes;
use dem::space::Tuple;
use dem::{D2, D3, Space, Watch};
use math::random::Stream;
use rustix::time::{ClockId, clock_gettime};

/// Seconds that this thread ran.
fn seconds() -> f64 {
    let time = clock_gettime(ClockId::ThreadCPUTime);
    time.tv_sec as f64 + time.tv_nsec as f64 * 1e-9
}

/// Fingerprint of centres and radii.
fn bits<S: Space>(packed: &Packed<S>) -> u64 {
    let heap = &packed.heap;
    let centres = heap.centres.iter().flat_map(|x| (0..S::DIMENSION).map(|k| x.at(k)));
    centres
        .chain(heap.radii.iter().copied())
        .fold(0, |sum: u64, x| (sum ^ x.to_bits()).wrapping_mul(0x0100_0000_01b3).rotate_left(23))
}

fn report<S: Space>(name: &str, packing: &Packing, region: &Region) {
    let words: Vec<String> =
        std::env::args().skip(1).filter(|a| !a.starts_with("--") && a.parse::<f64>().is_err()).collect();
    if !words.iter().all(|word| name.contains(word.as_str())) {
        return;
    }
    let start = seconds();
    let packed: Packed<S> = packing.pack(region, &mut Stream::new(1, "packing", 0), &|| Watch::Continue).unwrap();
    let seconds = seconds() - start;
    let fabric = Fabric::of(&packed.heap);
    println!(
        "{name}: {} balls, {seconds:.2} s, {} iterations, {} rounds, factor {:.5}, growth {:.3}, porosity {:.4}, \
         coordination {:.3}, floaters {}, stress/modulus {:.3e}, mean overlap {:.2e}, anisotropy {:.3} {:.3}, bits {:016x}",
        packed.heap.radii.len(),
        packed.iterations,
        packed.floater_rounds,
        packed.radius_factor,
        packed.floater_growth,
        1.0 - packed.heap.ball_volume() / region.volume(),
        fabric.coordination,
        fabric.floaters,
        fabric.mean_stress,
        fabric.mean_overlap,
        fabric.anisotropy,
        fabric.normals,
        bits(&packed),
    );
}

fn main() {
    let numbers: Vec<f64> = std::env::args().filter_map(|argument| argument.parse().ok()).collect();
    let (count, relative) = (numbers.first().copied().unwrap_or(20_000.0), numbers.get(1).copied().unwrap_or(1e-4));
    let rectangle = Region::Rectangle { width: 0.1, height: 0.2 };
    let radius = |porosity: f64| (0.02 * (1.0 - porosity) / (std::f64::consts::PI * count)).sqrt();
    report::<D2>("discs to porosity 0.12", &Packing::uniform(0.12, radius(0.12), 2.5), &rectangle);
    let mut target = StressTarget {
        stress: relative,
        modulus: 1.0,
        tolerance: 0.01,
        cloud_porosity: 0.16,
        equilibrium: 8e-3,
        floaters: Floaters::Enlarge,
        floater_share: 0.0,
    };
    let sizes = Sizes::uniform(radius(0.16), 1.66);
    report::<D2>("discs to a stress", &Packing::Stress { sizes, target }, &rectangle);
    target.cloud_porosity = 0.36;
    let region = Region::Box { width: 0.05, height: 0.1, depth: 0.05 };
    let sphere = 4.0 / 3.0 * std::f64::consts::PI;
    let sizes = Sizes::uniform(math::elementary::cbrt(region.volume() * 0.64 / (sphere * count)), 1.66);
    for floaters in [Floaters::Keep, Floaters::Enlarge, Floaters::Delete] {
        let packing = Packing::Stress { sizes: sizes.clone(), target: StressTarget { floaters, ..target } };
        report::<D3>(&format!("spheres to a stress, floaters {floaters:?}"), &packing, &region);
    }
}
