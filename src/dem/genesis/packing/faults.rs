//! What can be found wrong with a packing before it is made, and what it would cost.

use super::super::compress::StressTarget;
use super::super::region::Region;
use super::super::sizes::{GivesWay, Size, SizeLaw, Sizes};
use super::{MOST_BALLS, Packing, PackingError};
use crate::space::Space;
use math::text::Amount;

/// Fewest balls that make a packing.
const FEWEST_BALLS: f64 = 30.0;
/// Largest ratio of radii.
const WIDEST: f64 = 20.0;

impl Packing {
    /// All that is wrong with the settings for a specimen of this outline.
    pub fn faults<S: Space>(&self, region: &Region) -> Vec<PackingError> {
        let mut faults = Vec::new();
        let narrowest = region.narrowest();
        need(
            &mut faults,
            narrowest > 0.0 && narrowest.is_finite(),
            "specimen extent",
            Amount(narrowest, "m"),
            "a positive length",
        );
        match self {
            Self::Porosity { sizes, porosity, floaters } => {
                porosity_faults::<S>("porosity", *porosity, &mut faults);
                share_fault("floaters", *floaters, &mut faults);
                size_faults(sizes, &mut faults);
            }
            Self::Stress { sizes, target } => {
                target_faults::<S>(target, &mut faults);
                size_faults(sizes, &mut faults);
            }
            Self::Lattice { lattice, radius } => {
                need(&mut faults, *radius > 0.0, "radius", Amount(*radius, "m"), "a positive length");
                if lattice.dimension() != region.dimension() {
                    let (wanted, found) = (lattice.dimension(), region.dimension());
                    faults.push(PackingError::Dimension { lattice: *lattice, wanted, found });
                }
            }
        }
        if faults.is_empty() {
            faults.extend(self.number_fault::<S>(region));
            let diameter = 2.0 * self.largest_radius::<S>();
            if faults.is_empty() && diameter > 0.5 * narrowest {
                faults.push(PackingError::Large { diameter, narrowest });
            }
        }
        faults
    }

    /// About how many balls the packing has.
    pub fn count<S: Space>(&self, region: &Region) -> f64 {
        match self {
            Self::Porosity { sizes, porosity, .. } => sizes.count::<S>(region.volume(), *porosity),
            Self::Stress { sizes, target } => sizes.count::<S>(region.volume(), target.cloud_porosity),
            Self::Lattice { lattice, radius } => lattice.count::<S>(region, *radius),
        }
    }

    /// Mean radius asked for (m).
    pub fn mean_radius<S: Space>(&self) -> f64 {
        match self {
            Self::Porosity { sizes, .. } | Self::Stress { sizes, .. } => sizes.mean_radius::<S>(),
            Self::Lattice { radius, .. } => *radius,
        }
    }

    fn largest_radius<S: Space>(&self) -> f64 {
        match self {
            Self::Porosity { sizes, .. } | Self::Stress { sizes, .. } => sizes.largest::<S>(),
            Self::Lattice { radius, .. } => *radius,
        }
    }

    /// Too few balls, or too many, with what they would cost: about 0.5 kB and 0.3 ms a disc, twice that a sphere.
    fn number_fault<S: Space>(&self, region: &Region) -> Option<PackingError> {
        let (count, mean_radius) = (self.count::<S>(region), self.mean_radius::<S>());
        if count < FEWEST_BALLS {
            return Some(PackingError::Few { mean_radius, count: count as usize });
        }
        let share = if S::DIMENSION == 2 { 1.0 } else { 2.0 };
        let (gigabytes, hours) = (share * 0.5e-6 * count, share * 3e-4 * count / 3600.0);
        (count > MOST_BALLS || count.is_nan()).then_some(PackingError::Many { mean_radius, count, gigabytes, hours })
    }
}

fn need(faults: &mut Vec<PackingError>, ok: bool, name: &'static str, found: Amount, expected: &'static str) {
    if !ok {
        faults.push(PackingError::Value { name, found, expected });
    }
}

fn share_fault(name: &'static str, found: f64, faults: &mut Vec<PackingError>) {
    need(faults, (0.0..=1.0).contains(&found), name, Amount::number(found), "a share between 0 and 1");
}

fn porosity_faults<S: Space>(name: &'static str, porosity: f64, faults: &mut Vec<PackingError>) {
    let (most, expected) = if S::DIMENSION == 2 { (0.3, "between 0 and 0.3") } else { (0.6, "between 0 and 0.6") };
    need(faults, porosity > 0.0 && porosity < most, name, Amount::number(porosity), expected);
}

fn target_faults<S: Space>(target: &StressTarget, faults: &mut Vec<PackingError>) {
    porosity_faults::<S>("cloud_porosity", target.cloud_porosity, faults);
    share_fault("floater_share", target.floater_share, faults);
    need(faults, target.stress > 0.0, "stress", Amount(target.stress, "Pa"), "a positive stress");
    need(faults, target.modulus > 0.0, "modulus", Amount(target.modulus, "Pa"), "a positive stress");
    if target.stress > 0.0 && target.modulus > 0.0 {
        let relative = target.relative();
        let expected = "between 1e-7 and 0.1; 1e-5 to 1e-3 is usual";
        need(faults, (1e-7..=0.1).contains(&relative), "stress over modulus", Amount::number(relative), expected);
    }
    let tolerance = target.tolerance;
    need(faults, (1e-4..0.5).contains(&tolerance), "tolerance", Amount::number(tolerance), "between 0.0001 and 0.5");
    let equilibrium = target.equilibrium;
    let found = Amount::number(equilibrium);
    need(faults, (1e-6..=0.1).contains(&equilibrium), "equilibrium", found, "between 1e-6 and 0.1");
}

fn size_faults(sizes: &Sizes, faults: &mut Vec<PackingError>) {
    match sizes.size {
        Size::Mean(mean) => need(faults, mean > 0.0, "mean_radius", Amount(mean, "m"), "a positive length"),
        Size::Smallest(smallest) => {
            need(faults, smallest > 0.0, "smallest_radius", Amount(smallest, "m"), "a positive length");
        }
        Size::Stated => {}
    }
    let ratio_fault = |ratio: f64, faults: &mut Vec<PackingError>| {
        need(
            faults,
            (1.0..=WIDEST).contains(&ratio),
            "radius ratio",
            Amount::number(ratio),
            "between 1 and 20 (largest over smallest)",
        );
    };
    let list = |name, problem| PackingError::List { name, problem };
    match &sizes.law {
        SizeLaw::Uniform { ratio } => ratio_fault(*ratio, faults),
        SizeLaw::UniformVolume { ratio } => {
            ratio_fault(*ratio, faults);
            need(faults, *ratio > 1.0, "radius ratio", Amount::number(*ratio), "above 1, or `sizes = \"uniform\"`");
        }
        SizeLaw::LogNormal { ratio, deviation } => {
            ratio_fault(*ratio, faults);
            need(faults, *ratio > 1.0, "radius ratio", Amount::number(*ratio), "above 1: it cuts the law");
            let found = Amount::number(*deviation);
            need(faults, *deviation > 0.0 && *deviation <= 2.0, "size_deviation", found, "above 0 and at most 2");
        }
        SizeLaw::Sieve { diameters, passing } => {
            let rises = |values: &[f64]| values.windows(2).all(|pair| pair[0] <= pair[1]);
            let strictly = diameters.windows(2).all(|pair| pair[0] < pair[1]);
            if diameters.len() < 2 || diameters.len() != passing.len() {
                faults.push(list("sieve", "give at least two diameters and as many shares that pass"));
            } else if !strictly || !(diameters[0] > 0.0) {
                faults.push(list("sieve diameters", "they must be positive and increase"));
            } else if !rises(passing) || passing[0] != 0.0 || passing[passing.len() - 1] != 1.0 {
                faults.push(list(
                    "sieve passing",
                    "shares must not decrease, from 0 at the first sieve to 1 at the last",
                ));
            } else {
                ratio_fault(diameters[diameters.len() - 1] / diameters[0], faults);
            }
        }
        SizeLaw::Classes { radii, counts } => {
            if radii.is_empty() || radii.len() != counts.len() {
                faults.push(list("classes", "give at least one radius and as many counts"));
            } else if radii.iter().any(|r| !(*r > 0.0 && r.is_finite())) || counts.contains(&0) {
                faults.push(list("classes", "radii must be positive and counts at least 1"));
            } else if sizes.gives_way == GivesWay::Number {
                faults.push(list("classes", "radii and counts are given, so the number cannot give way"));
            } else {
                let [low, high] = radii.iter().fold([f64::INFINITY, 0.0_f64], |[l, h], &r| [l.min(r), h.max(r)]);
                ratio_fault(high / low, faults);
            }
        }
    }
}
