//! An unbonded lattice between walls under a confining stress: the stress ratio at which it slips.
//!
//! Nearly rigid contacts of the FCC lattice slip at σ₁/σ₃ = 2(1 + μ)/(1 − μ) under a load along an edge (Thornton 1979,
//! doi:10.1680/geot.1979.29.4.441). A cube has equal faces, so its ratio is that of the wall forces. Spheres at the edges of
//! the platens may roll instead of sliding, which takes a few per cent off a small cube.

use crate::case::{Case, Family, Near};
use crate::piece::{Rock, face_centred};
use dem::loading::kind::TestKind;
use dem::loading::material::BondKind;
use dem::loading::piece::Piece;
use dem::loading::settings::{Loading, Particulars};
use dem::loading::speed::{Speed, Threshold};
use dem::{Space, Watch};
use std::sync::LazyLock;

pub(crate) fn family() -> Family {
    static CASES: LazyLock<Vec<Case>> = LazyLock::new(cases);
    let about = "A cube of 6 cells to an edge, unbonded spheres of radius 1 mm, between frictionless walls, E* 10 GPa, k_n/k_s 2, confining stress 0.1 MPa \
        by servo, 60 wave transits to the strain σ₃/E*: largest ratio of the axial to the confining stress.";
    Family { title: "Compression under a confining stress", about, cases: &CASES }
}

#[test]
fn unbonded_lattices_slip_at_their_stress_ratio() {
    family().check();
}

fn ratio<S: Space>(kind: TestKind, piece: &Piece<S>, friction: f64) -> f64 {
    let rock = Rock { modulus: 1e10, ratio: 2.0, strength: 1e-3, friction, bond: BondKind::Contact, gap: 0.0 };
    let mut test = Loading { speed: Speed::Transits(60.0), ..Loading::new(kind) };
    test.particulars = Particulars { confinement: Some(1e5), ..Particulars::default() };
    test.rule.strain_limit = Threshold::Share(6.0);
    test.rule.sample_strain = Threshold::Share(0.05);
    let record = test.run(piece, &rock.material(), 1, &mut |_| Watch::Continue).unwrap();
    let values = record.values;
    (values.strength + values.confinement) / values.confinement
}

fn cases() -> Vec<Case> {
    let mu = 0.2;
    let got = ratio(TestKind::Triaxial, &face_centred(6, 1e-3), mu);
    let expected = 2.0 * (1.0 + mu) / (1.0 - mu);
    vec![Case::new("3D: FCC, μ = 0.2", "2(1 + μ)/(1 − μ), exact", expected, got, Near::Relative(0.02))]
}
