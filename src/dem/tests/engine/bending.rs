//! Three-point bending of a lattice beam against Timoshenko's beam.
//!
//! A hexagonal lattice of contact bonds (spring in tension and compression alike) is isotropic with
//! E = 2√3 k_n(k_n + k_s)/(3k_n + k_s), ν = (k_n − k_s)/(3k_n + k_s). A row of it takes √3 R of the height, so n rows bend like
//! a beam of height √3 n R; the test reads its modulus with the nominal height h = 2R + √3 (n − 1) R. The deflection is
//! F L³/(4 E b h³) (1 + 2.4 (1 + ν)(h/L)²), the outermost stress 3 F L/(2 b h²).

use crate::case::{Case, Family, Near};
use crate::piece::{Rock, hexagon};
use dem::loading::kind::TestKind;
use dem::loading::material::BondKind;
use dem::loading::record::TestRecord;
use dem::loading::settings::{Loading, Notch, Particulars};
use dem::loading::speed::Speed;
use dem::{D2, Watch};
use std::sync::LazyLock;

const RADIUS: f64 = 1e-3;
const COLUMNS: usize = 76;
const ROWS: usize = 15;
const SPAN: f64 = 0.14;
const MODULUS: f64 = 10e9;
const RATIO: f64 = 2.0;

pub(crate) fn family() -> Family {
    static CASES: LazyLock<Vec<Case>> = LazyLock::new(cases);
    let about = "A beam of 76 by 15 discs of radius 1 mm in hexagonal order, contact bonds, E* 10 GPa, k_n/k_s 2, on supports 140 mm \
        apart, loaded at the middle until it breaks. The strength is that of the row bonds at mid-span, whose force is the \
        stress of the beam times the width of a row over the share of it that the row carries: it is compared between a \
        plain and a notched beam of the same section above the notch.";
    Family { title: "Three-point bending", about, cases: &CASES }
}

#[test]
fn a_lattice_beam_bends_as_a_beam() {
    family().check();
}

fn bent(rows: usize, notch: Option<Notch>) -> TestRecord<D2> {
    let rock =
        Rock { modulus: MODULUS, ratio: RATIO, strength: 10e6, friction: 0.3, bond: BondKind::Contact, gap: 1e-3 };
    let mut test = Loading { speed: Speed::Each(0.02), ..Loading::new(TestKind::Bending) };
    test.particulars = Particulars { span: Some(SPAN), notch, ..Particulars::default() };
    let record = test.run(&hexagon(COLUMNS, rows, RADIUS), &rock.material(), 1, &mut |_| Watch::Continue).unwrap();
    if std::env::var("SHOW").is_ok() {
        println!(
            "{:?} {:?} {:?} steps {} cracks {:?}",
            record.values,
            record.run.failure,
            record.validity(),
            record.run.steps,
            record.run.cracks.first()
        );
    }
    record
}

fn cases() -> Vec<Case> {
    let [kn, ks] = [MODULUS, MODULUS / RATIO];
    let r3 = 3.0_f64.sqrt();
    let young = 2.0 * r3 * kn * (kn + ks) / (3.0 * kn + ks);
    let poisson = (kn - ks) / (3.0 * kn + ks);
    let nominal = (2.0 + r3 * (ROWS - 1) as f64) * RADIUS;
    let own = r3 * ROWS as f64 * RADIUS;
    let bent_modulus = young * (own / nominal).powi(3) / (1.0 + 2.4 * (1.0 + poisson) * (own / SPAN).powi(2));
    let plain = bent(ROWS, None);
    let mut cases = vec![Case::new(
        "2D: modulus of the deflection, Pa",
        "F L³/(4bh³δ), Timoshenko",
        bent_modulus,
        plain.values.modulus_secant,
        Near::Relative(0.03),
    )];
    let crack = plain.run.cracks.first();
    let place = crack.map_or([f64::NAN; 2], |crack| crack.position);
    cases.push(Case::new(
        "2D: first crack, distance from mid-span over the height",
        "greatest moment",
        0.0,
        place[0] / nominal,
        Near::Absolute(0.15),
    ));
    cases.push(Case::new(
        "2D: its height above mid-height over half the height",
        "tension side",
        -1.0,
        2.0 * place[1] / nominal,
        Near::Absolute(0.15),
    ));
    cases
}
