//! Time and quality of packings: `cargo bench -p flow-dem --bench packing [-- NUMBER STRESS/MODULUS]`.
#![allow(clippy::unwrap_used)]

use dem::genesis::compress::{Floaters, StressTarget};
use dem::genesis::fabric::Fabric;
use dem::genesis::packing::{Packed, Packing};
use dem::genesis::region::Region;
use dem::genesis::sizes::Sizes;
use dem::{D2, D3, Space, Watch};
use math::random::Stream;
use std::time::Instant;

fn report<S: Space>(name: &str, packing: &Packing, region: &Region) {
    let start = Instant::now();
    let packed: Packed<S> = packing.pack(region, &mut Stream::new(1, "packing", 0), &|| Watch::Continue).unwrap();
    let seconds = start.elapsed().as_secs_f64();
    let fabric = Fabric::of(&packed.heap);
    println!(
        "{name}: {} balls, {seconds:.2} s, {} iterations, {} rounds, factor {:.5}, growth {:.3}, porosity {:.4}, \
         coordination {:.3}, floaters {}, stress/modulus {:.3e}, mean overlap {:.2e}, anisotropy {:.3} {:.3}",
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
