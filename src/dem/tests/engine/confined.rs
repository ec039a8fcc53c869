//! Unbonded lattices between walls under a confining stress: the stress ratio at which they slip.
//!
//! Nearly rigid contacts slip at σ₁/σ₃ = tan 60° tan(60° + φ) = √3 (√3 + μ)/(1 − √3 μ) (hexagonal, load across the rows; Rowe
//! 1962, doi:10.1098/rspa.1962.0193) and 2(1 + μ)/(1 − μ) (FCC along an edge; Thornton 1979, doi:10.1680/geot.1979.29.4.441).
//! A cube has equal faces, so its ratio is that of the wall forces. In the hexagon the rows bear on the side walls with
//! every other disc, and the wall forces are taken over the nominal sides.

use crate::case::{Case, Family, Near};
use crate::piece::{Rock, face_centred, hexagon};
use dem::loading::kind::TestKind;
use dem::loading::material::BondKind;
use dem::loading::piece::Piece;
use dem::loading::settings::{Loading, Particulars};
use dem::loading::speed::{Speed, Threshold};
use dem::{Space, Watch};
use std::sync::LazyLock;

pub(crate) fn family() -> Family {
    static CASES: LazyLock<Vec<Case>> = LazyLock::new(cases);
    let about = "Unbonded lattices of balls of radius 1 mm between frictionless walls, E* 10 GPa, k_n/k_s 2, confining stress 0.1 MPa \
        by servo, 200 wave transits to the strain σ₃/E*: largest ratio of the axial to the confining stress.";
    Family { title: "Compression under a confining stress", about, cases: &CASES }
}

#[test]
fn unbonded_lattices_slip_at_their_stress_ratio() {
    family().check();
}

fn ratio<S: Space>(kind: TestKind, piece: &Piece<S>, friction: f64) -> f64 {
    let rock = Rock { modulus: 1e10, ratio: 2.0, strength: 1e-3, friction, bond: BondKind::Contact, gap: 0.0 };
    let mut test = Loading { speed: Speed::Transits(200.0), ..Loading::new(kind) };
    test.particulars = Particulars { confinement: Some(1e5), ..Particulars::default() };
    test.rule.strain_limit = Threshold::Share(12.0);
    test.rule.sample_strain = Threshold::Share(0.02);
    let record = test.run(piece, &rock.material(), 1, &mut |_| Watch::Continue).unwrap();
    let values = record.values;
    if std::env::var("SHOW").is_ok() {
        println!(
            "{:?} {:?} {:?} steps {} {:?}",
            values, record.run.failure, record.checks, record.run.steps, record.run.at_peak
        );
        for s in record.run.samples.iter().step_by(25) {
            println!("{:e} {:e} {:e}", s.axial, s.lateral, s.stress);
        }
    }
    (values.strength + values.confinement) / values.confinement
}

fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    let r3 = 3.0_f64.sqrt();
    for mu in [0.2, 0.4] {
        let expected = 2.0 * (1.0 + mu) / (1.0 - mu);
        let got = ratio(TestKind::Triaxial, &face_centred(3, 1e-3), mu);
        cases.push(Case::new(
            format!("3D: FCC, μ = {mu}"),
            "2(1 + μ)/(1 − μ), exact",
            expected,
            got,
            Near::Relative(0.02),
        ));
    }
    let mu = 0.2;
    let expected = r3 * (r3 + mu) / (1.0 - r3 * mu);
    let got = ratio(TestKind::Biaxial, &hexagon(16, 17, 1e-3), mu);
    cases.push(Case::new("2D: hexagon, μ = 0.2", "tan 60° tan(60° + φ), exact", expected, got, Near::Relative(0.02)));
    cases
}
