//! Brazilian test of an unbreakable disc: the stress at its centre, on flat platens and on jaws.
//!
//! On flat platens the tension at the centre is 2P/(πDt), on jaws of the whole angle 2α 2P/(πDt) (sin 2α/α − 1) (Hondros
//! 1959), with P the force on a platen. The stress is measured in a disc of 0.4 of the diameter. The mean of a sum of
//! point loads over it is known from the exact field of one pair (Flamant): compression s along the load and tension s − 2
//! across it, s = 2.84 in units of 2P/(πDt). A pair at the angle φ to the axis gives the tension −1 + (s − 1) cos 2φ along x,
//! so an arc of the half angle α gives −1 + (s − 1) sin 2α/(2α).

use crate::case::{Case, Family, Near};
use crate::piece::{Rock, random};
use dem::genesis::region::Region;
use dem::loading::kind::TestKind;
use dem::loading::material::BondKind;
use dem::loading::platens::{balance, between_platens};
use dem::loading::settings::{Loading, Particulars};
use dem::*;
use math::elementary::sin_cos;
use std::sync::LazyLock;

const DIAMETER: f64 = 0.05;
/// Mean compression along the load in the inner 0.4 of the diameter over 2P/(πDt); the sum over a grid is in `disc`.
const ALONG: f64 = 2.84;
const SEEDS: u64 = 5;

pub(crate) fn family() -> Family {
    static CASES: LazyLock<Vec<Case>> = LazyLock::new(cases);
    let about = "Random discs of 50 mm, mean radius 0.6 mm, ratio 1.66, contact bonds that do not break, E* 20 GPa, k_n/k_s 2.5: mean over five \
        packings of the stress in the inner 0.4 of the diameter, over 2P/(πDt).";
    Family { title: "Brazilian test: elastic stresses", about, cases: &CASES }
}

#[test]
fn a_disc_between_platens_or_jaws_has_its_elastic_stresses() {
    family().check();
}

/// Mean tension across the load and compression along it, over 2P/(πDt).
fn measured(jaw_angle: Option<f64>) -> [f64; 2] {
    let rock = Rock { modulus: 20e9, ratio: 2.5, strength: 1e15, friction: 0.5, bond: BondKind::Contact, gap: 1e-3 };
    let mut test = Loading::new(TestKind::Brazilian);
    test.particulars = Particulars { jaw_angle, ..Particulars::default() };
    let mut sums = [0.0; 2];
    for seed in 1..=SEEDS {
        let piece = random(Region::Disc { diameter: DIAMETER }, 0.6e-3, seed);
        let (mounted, platens) = between_platens(&test, &piece, &rock.material(), 1).unwrap();
        let mut engine = mounted.engine;
        platens.approach(&mut engine, 0.05).unwrap();
        let steps = (4e-4 * DIAMETER / (2.0 * 0.05 * engine.time_step())) as u64;
        engine.advance(steps).unwrap();
        let [force, _] = balance(platens.forces(&engine));
        let unit = 2.0 * force / (std::f64::consts::PI * DIAMETER);
        let region = measure::Region::<D2>::Ball { centre: [0.0, 0.0], radius: 0.2 * DIAMETER };
        let found = measure::stress(&engine, &region);
        sums = [sums[0] - found[0][0] / unit, sums[1] + found[1][1] / unit];
    }
    sums.map(|sum| sum / SEEDS as f64)
}

fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for (name, angle) in [("flat platens", None), ("jaws of 20°", Some(20.0_f64.to_radians()))] {
        let share = angle.map_or(1.0, |angle| sin_cos(angle).0 / angle);
        let [across, along] = measured(angle);
        let expected = [-1.0 + (ALONG - 1.0) * share, 1.0 + (ALONG - 1.0) * share];
        let source = "Flamant, Hondros 1959";
        cases.push(Case::new(format!("2D: {name}, tension across"), source, expected[0], across, Near::Relative(0.1)));
        cases.push(Case::new(
            format!("2D: {name}, compression along"),
            source,
            expected[1],
            along,
            Near::Relative(0.1),
        ));
    }
    cases
}
