//! Three-point bending of a hexagonal lattice: the modulus of a plain beam, and how a notched one opens.
//!
//! Rows lie along the beam, contacts hold and carry no moment. A row alone carries k_n l per unit of strain (l = 2R), the slanted contacts
//! between two rows what the lattice carries besides, E √3 l/2 − k_n l. Sections stay plane, so with y from the middle
//!
//! ```text
//! E I = k_n l Σ y² (rows) + (√3/2 E − k_n) l Σ y² (between rows)          exact for the lattice; E h³/12 for many rows
//! δ   = F L³/(48 E I) (1 + (2.4 + 1.5 ν)(h/L)² − 0.84 (h/L)³)             of the axis; Seewald 1927, in Timoshenko & Goodier
//! CMOD = 4 σ a/E V(a/h),  σ = 3 F L/(2 h²),  L = 4 h                       Tada, Paris & Irwin
//! V(α) = 0.76 − 2.28 α + 3.87 α² − 2.04 α³ + 0.66/(1 − α)²                 within 1 % for every α
//! ```
//!
//! The notch takes away whole rows; its tip is taken half a row below the first that is left. How far it is off falls as one row
//! over the height, so two beams, one with twice the rows, give the limit.

use crate::case::{Case, Family, Near};
use crate::lattice::{KN, KS, hexagon, of_sheet};
use crate::piece::{Rock, piece};
use dem::loading::curve::Sample;
use dem::loading::kind::TestKind;
use dem::loading::material::BondKind;
use dem::loading::piece::Outline;
use dem::loading::settings::{Loading, Notch, Particulars};
use dem::loading::speed::{Speed, Threshold};
use dem::*;
use std::sync::LazyLock;

const RADIUS: f64 = 0.5e-3;
const MODULUS: f64 = 20e9;
/// As in [`crate::lattice`].
const RATIO: f64 = KN / KS;
/// Largest strain of the outer fibre.
const STRAIN: f64 = 1e-5;
/// Swings of the beam up to it; one takes 2.2 (L/h)² transits of a wave through the height.
const SWINGS: f64 = 8.0;
const DENSITY: f64 = 2000.0;

pub(crate) fn family() -> Family {
    static CASES: LazyLock<Vec<Case>> = LazyLock::new(cases);
    let about = "Beams of discs of 1 mm in hexagonal order, rows along the beam, contact bonds that hold, k_n 20 GPa, k_n/k_s 2.5, between three \
        rollers; span 8 heights for the modulus, 4 for the notch, whose opening is extrapolated from 20 and 40 rows.";
    Family { title: "Three-point bending", about, cases: &CASES }
}

#[test]
fn beams_bend_and_open_as_the_theory_says() {
    family().check();
}

/// Modulus and Poisson's ratio of the lattice.
fn elastic() -> [f64; 2] {
    let [c11, c12, _] = hexagon().constants.map(|c| c * MODULUS / KN);
    of_sheet(c11, c12)
}

/// A beam of so many rows and its height.
struct Beam {
    rows: usize,
    height: f64,
}

impl Beam {
    fn new(rows: usize) -> Self {
        Self { rows, height: 2.0 * RADIUS + (rows - 1) as f64 * Self::SPACING }
    }

    /// Distance of two rows: √3 R.
    const SPACING: f64 = 1.732_050_807_568_877_2 * RADIUS;

    /// Height of row `k` over the axis.
    fn level(&self, k: f64) -> f64 {
        (k - 0.5 * (self.rows - 1) as f64) * Self::SPACING
    }

    /// Samples of a test on a beam a tenth longer than its span of so many heights.
    fn bent(&self, spans: f64, notch: Option<Notch>) -> Vec<Sample> {
        // An odd number: the notch ends below a disc, not between two.
        let long = (1.1 * spans * self.height / (2.0 * RADIUS)).round() as usize | 1;
        let centres = (0..self.rows).flat_map(|row| {
            // Every other row is shifted by a radius and has one disc less.
            let shift = (row % 2) as f64;
            let start = 0.5 * (shift - (long - 1) as f64);
            (0..long - row % 2).map(move |i| [(start + i as f64) * 2.0 * RADIUS, self.level(row as f64)])
        });
        let outline = Outline::Block { width: 2.0 * RADIUS * long as f64, height: self.height, depth: 1.0 };
        let beam = piece::<D2>(outline, centres.collect(), RADIUS);
        let rock =
            Rock { modulus: MODULUS, ratio: RATIO, strength: 1e15, friction: 0.0, bond: BondKind::Contact, gap: 1e-6 };
        let mut test = Loading::new(TestKind::Bending);
        test.speed =
            Speed::StrainRate(STRAIN * (MODULUS / DENSITY).sqrt() / (2.2 * SWINGS * spans * spans * self.height));
        test.particulars = Particulars { span: Some(spans * self.height), notch, ..Particulars::default() };
        // Local damping does not stop a swing about a steady motion; without it the mean over some swings is that of rest.
        test.machine.damping = 0.0;
        test.rule.seating = Threshold::Absolute(0.0);
        test.rule.strain_limit = Threshold::Absolute(STRAIN);
        test.rule.sample_strain = Threshold::Absolute(STRAIN / 50.0);
        test.run(&beam, &rock.material(), 1, &mut |_| Watch::Continue).unwrap().run.samples
    }

    /// Modulus of a plain beam by E I of its rows, and by the test.
    fn modulus(&self) -> [f64; 2] {
        let [young, poisson] = elastic();
        let square = |k: f64| self.level(k) * self.level(k);
        let rows: f64 = (0..self.rows).map(|k| square(k as f64)).sum();
        let between: f64 = (1..self.rows).map(|k| square(k as f64 - 0.5)).sum();
        let l = 2.0 * RADIUS;
        let slanted = young * Self::SPACING / l - MODULUS;
        let stiffness = l * (MODULUS * rows + slanted * between);
        let flat: f64 = 1.0 / 8.0;
        let sheared = 1.0 + (2.4 + 1.5 * poisson) * flat.powi(2) - 0.84 * flat.powi(3);
        let expected = 12.0 * stiffness / self.height.powi(3) / sheared;
        [expected, slope(&self.bent(8.0, None), |sample| sample.axial, |sample| sample.stress)]
    }

    /// Opening of a notch of two fifths of the height over σ a/E, by Tada and by the test.
    fn opening(&self) -> [f64; 2] {
        let cut = (0.4 * self.rows as f64).round();
        let alpha = (self.level(cut - 0.5) + 0.5 * self.height) / self.height;
        let notch = Notch { depth: alpha, width: 2.2 * RADIUS / self.height };
        let samples = self.bent(4.0, Some(notch));
        // The test reports the stress of the ligament.
        let whole = (1.0 - alpha).powi(2);
        let found = slope(&samples, |sample| sample.stress * whole, |sample| sample.lateral * self.height);
        let [young, _] = elastic();
        let tada = 0.76 - 2.28 * alpha + 3.87 * alpha.powi(2) - 2.04 * alpha.powi(3) + 0.66 / (1.0 - alpha).powi(2);
        [4.0 * tada, found * young / (alpha * self.height)]
    }
}

/// Slope of the line through the origin, y on x, by least squares: the mean over the swings.
fn slope(samples: &[Sample], x: impl Fn(&Sample) -> f64, y: impl Fn(&Sample) -> f64) -> f64 {
    let [xy, xx] = samples.iter().fold([0.0; 2], |[xy, xx], sample| {
        let (x, y) = (x(sample), y(sample));
        [xy + x * y, xx + x * x]
    });
    xy / xx
}

fn cases() -> Vec<Case> {
    let plain = [8, 16].map(|rows| {
        let [expected, found] = Beam::new(rows).modulus();
        let name = format!("2D: plain beam of {rows} rows, E, Pa");
        Case::new(name, "E I of the rows, Seewald", expected, found, Near::Relative(0.01))
    });
    let [few, many] = [20, 40].map(|rows| Beam::new(rows).opening());
    let limit = |k: usize| 2.0 * many[k] - few[k];
    let name = "2D: opening of the notch over σ a/E";
    plain.into_iter().chain([Case::new(name, "Tada", limit(0), limit(1), Near::Relative(0.02))]).collect()
}
