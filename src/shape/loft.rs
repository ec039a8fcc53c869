//! The closed surface through sections across a stone's longest side.
//!
//! Each section lies at a position along x and has a thickness a (along y) and a height b (along z), as measured with a
//! caliper. Its outline is the superellipse
//!
//! ```text
//! |2 y / a|ᵖ + |2 z / b|ᵖ = 1
//! ```
//!
//! with the exponent p: 2 is an ellipse, 1 a rhombus, 4 and more a box with rounded edges. A caliper does not measure p, so the
//! user chooses it. All outlines have the same number of points at the same angles of the parameter. Triangles join the
//! points of neighbouring outlines (a ruled surface), and both ends are capped by a fan, or end in a point where a section
//! has no extent.

use super::mesh::Mesh;
use math::elementary::{pow, sin_cos};
use math::text::Amount;
use std::f64::consts::TAU;

/// A section across the longest side.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Section {
    /// Where along the longest side (m).
    pub position: f64,
    /// Largest thickness a (m).
    pub thickness: f64,
    /// Largest height b (m).
    pub height: f64,
    /// Exponent of the outline; 2 is an ellipse.
    pub exponent: f64,
}

/// Why sections make no solid.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum LoftFault {
    /// Too few.
    #[error("{0} sections; a stone needs at least 2, the first and the last where it ends")]
    Few(usize),
    /// Order.
    #[error("section {section} is at {at:#}, not beyond the one before it; list sections along the longest side")]
    Order {
        /// From 1.
        section: usize,
        /// Its position.
        at: Amount,
    },
    /// A number outside its range.
    #[error("section {section}: {name} is {found:#}; it must be {expected}")]
    Value {
        /// From 1.
        section: usize,
        /// Which number.
        name: &'static str,
        /// What was given.
        found: Amount,
        /// What it must be.
        expected: &'static str,
    },
    /// One extent only.
    #[error(
        "section {section} has a thickness of {thickness:#} and a height of {height:#}; give both, or 0 for both at a pointed end"
    )]
    Line {
        /// From 1.
        section: usize,
        /// Its thickness.
        thickness: Amount,
        /// Its height.
        height: Amount,
    },
    /// No extent between the ends.
    #[error("section {0} is a point between the ends: the stone would fall in two")]
    Waist(usize),
    /// Points around.
    #[error("{0} points around a section; it takes 8 to 512, in multiples of 4")]
    Points(usize),
}

/// The faults of sections.
pub fn faults(sections: &[Section]) -> Vec<LoftFault> {
    let mut faults = Vec::new();
    if sections.len() < 2 {
        faults.push(LoftFault::Few(sections.len()));
    }
    for (k, s) in sections.iter().enumerate() {
        let section = k + 1;
        let mut need = |ok: bool, name, found, expected| {
            faults.extend((!ok).then_some(LoftFault::Value { section, name, found, expected }));
        };
        need(s.position.is_finite(), "position", Amount(s.position, "m"), "a finite length");
        let length = |x: f64| x >= 0.0 && x.is_finite();
        need(length(s.thickness), "thickness", Amount(s.thickness, "m"), "a finite length of at least 0");
        need(length(s.height), "height", Amount(s.height, "m"), "a finite length of at least 0");
        need(
            (1.0..=20.0).contains(&s.exponent),
            "exponent",
            Amount::number(s.exponent),
            "from 1 (rhombus) over 2 (ellipse) to 20 (box)",
        );
        if k > 0 && !(s.position > sections[k - 1].position) {
            faults.push(LoftFault::Order { section, at: Amount(s.position, "m") });
        }
        let point = s.thickness == 0.0 && s.height == 0.0;
        if !point && (s.thickness == 0.0 || s.height == 0.0) {
            let [thickness, height] = [s.thickness, s.height].map(|extent| Amount(extent, "m"));
            faults.push(LoftFault::Line { section, thickness, height });
        }
        if point && k > 0 && section < sections.len() {
            faults.push(LoftFault::Waist(section));
        }
    }
    let ends = [sections.first(), sections.last()].map(|end| end.is_some_and(|s| s.thickness == 0.0));
    if sections.len() == 2 && ends == [true, true] {
        faults.push(LoftFault::Few(0));
    }
    faults
}

/// The solid through sections, with `around` points on each outline.
///
/// # Errors
/// The first fault of the sections, or a number of points outside its range.
pub fn loft(sections: &[Section], around: usize) -> Result<Mesh, LoftFault> {
    if let Some(fault) = faults(sections).into_iter().next() {
        return Err(fault);
    }
    if !(8..=512).contains(&around) || !around.is_multiple_of(4) {
        return Err(LoftFault::Points(around));
    }
    let mut vertices = Vec::new();
    let mut facets = Vec::new();
    let mut before: Option<Ring> = None;
    for section in sections {
        let ring = Ring::of(section, around, &mut vertices);
        match (before, ring) {
            // The first cap faces −x.
            (None, Ring::Points(first)) => cap(first, around, section, true, &mut vertices, &mut facets),
            (None, Ring::Apex(_)) => {}
            (Some(last), next) => join(last, next, around, &mut facets),
        }
        before = Some(ring);
    }
    if let (Some(Ring::Points(first)), Some(last)) = (before, sections.last()) {
        cap(first, around, last, false, &mut vertices, &mut facets);
    }
    Ok(Mesh { vertices, facets })
}

/// Where the vertices of a section begin, or its only one.
#[derive(Clone, Copy)]
enum Ring {
    Points(u32),
    Apex(u32),
}

impl Ring {
    fn of(section: &Section, around: usize, vertices: &mut Vec<[f64; 3]>) -> Self {
        let first = vertices.len() as u32;
        if section.thickness == 0.0 {
            vertices.push([section.position, 0.0, 0.0]);
            return Self::Apex(first);
        }
        let bent = |x: f64| pow(x.abs(), 2.0 / section.exponent).copysign(x);
        for k in 0..around {
            // Half a step off the axes, so that the corners of a box are points of its outline.
            let (sine, cosine) = sin_cos(TAU * (k as f64 + 0.5) / around as f64);
            vertices.push([
                section.position,
                0.5 * section.thickness * bent(cosine),
                0.5 * section.height * bent(sine),
            ]);
        }
        Self::Points(first)
    }
}

/// The facets between two sections.
fn join(last: Ring, next: Ring, around: usize, facets: &mut Vec<[u32; 3]>) {
    let at = |first: u32, k: usize| first + (k % around) as u32;
    for k in 0..around {
        match (last, next) {
            (Ring::Points(a), Ring::Points(b)) => {
                facets.extend([[at(a, k), at(a, k + 1), at(b, k + 1)], [at(a, k), at(b, k + 1), at(b, k)]]);
            }
            (Ring::Apex(a), Ring::Points(b)) => facets.push([a, at(b, k + 1), at(b, k)]),
            (Ring::Points(a), Ring::Apex(b)) => facets.push([at(a, k), at(a, k + 1), b]),
            (Ring::Apex(_), Ring::Apex(_)) => {}
        }
    }
}

/// The flat end at a section.
fn cap(
    first: u32,
    around: usize,
    section: &Section,
    back: bool,
    vertices: &mut Vec<[f64; 3]>,
    facets: &mut Vec<[u32; 3]>,
) {
    let hub = vertices.len() as u32;
    vertices.push([section.position, 0.0, 0.0]);
    for k in 0..around {
        let (a, b) = (first + k as u32, first + ((k + 1) % around) as u32);
        facets.push(if back { [hub, b, a] } else { [hub, a, b] });
    }
}

#[cfg(test)]
mod tests {
    use super::super::mend::{Mended, mend};
    use super::super::moments::Moments;
    use super::*;
    use std::f64::consts::PI;

    fn section(position: f64, thickness: f64, height: f64, exponent: f64) -> Section {
        Section { position, thickness, height, exponent }
    }

    /// A cylinder, a cone and a frustum of 256 points, against π a b c / 4, a third of it, and the frustum's formula.
    #[test]
    fn cylinder_cone_and_frustum_have_their_volumes() {
        let volume = |sections: &[Section]| Moments::of(&loft(sections, 256).unwrap()).volume;
        let (a, b, c) = (2.0, 3.0, 5.0);
        let whole = PI * a * b * c / 4.0;
        let cylinder = volume(&[section(0.0, a, b, 2.0), section(c, a, b, 2.0)]);
        assert!((cylinder / whole - 1.0).abs() < 2e-4);
        let cone = volume(&[section(0.0, 0.0, 0.0, 2.0), section(c, a, b, 2.0)]);
        assert!((cone / whole * 3.0 - 1.0).abs() < 2e-4);
        let frustum = volume(&[section(0.0, a, b, 2.0), section(c, a / 2.0, b / 2.0, 2.0)]);
        assert!((frustum / (whole * 7.0 / 12.0) - 1.0).abs() < 2e-4);
    }

    /// Area of a superellipse: a b Γ(1 + 1/p)² / Γ(1 + 2/p); for p = 4 Γ(5/4)²/Γ(3/2) = 0.927037, for p = 1 one half.
    #[test]
    fn outlines_have_the_area_of_superellipses() {
        for (exponent, share) in [(4.0, 0.927_037_338_650_685_9), (1.0, 0.5), (2.0, PI / 4.0)] {
            let ends = [section(0.0, 2.0, 3.0, exponent), section(1.0, 2.0, 3.0, exponent)];
            let found = Moments::of(&loft(&ends, 512).unwrap()).volume;
            assert!((found / (6.0 * share) - 1.0).abs() < 2e-3, "{exponent}: {found}");
        }
    }

    /// Watertight and outward: mending finds nothing to do.
    #[test]
    fn lofts_are_closed_and_face_outwards() {
        let stones = [
            vec![section(0.0, 1.0, 2.0, 6.0), section(1.0, 2.0, 1.0, 2.0), section(3.0, 0.5, 0.5, 1.0)],
            vec![section(0.0, 0.0, 0.0, 2.0), section(1.0, 2.0, 1.0, 2.0), section(3.0, 0.0, 0.0, 2.0)],
            vec![section(-4.0, 1.0, 1.0, 3.0), section(4.0, 0.0, 0.0, 3.0)],
        ];
        for stone in stones {
            let mesh = loft(&stone, 16).unwrap();
            let (mended, did) = mend(&mesh.triangles().collect::<Vec<_>>()).unwrap();
            assert_eq!((did, mended.facets().len()), (Mended::default(), mesh.facets().len()));
            assert!(Moments::of(&mesh).volume > 0.0);
        }
    }

    #[test]
    fn faults_name_their_section() {
        let good = section(0.0, 1.0, 1.0, 2.0);
        let odd = [good, section(0.0, f64::NAN, 1.0, 2.0), section(1.0, 0.0, 0.0, 2.0), section(2.0, 1.0, 0.0, 50.0)];
        let found = faults(&odd);
        assert!(matches!(found[0], LoftFault::Value { section: 2, name: "thickness", .. }));
        assert!(found.contains(&LoftFault::Order { section: 2, at: Amount(0.0, "m") }));
        assert!(found.contains(&LoftFault::Waist(3)));
        assert!(matches!(found[found.len() - 2], LoftFault::Value { section: 4, name: "exponent", .. }));
        assert!(matches!(found[found.len() - 1], LoftFault::Line { section: 4, .. }));
        assert_eq!(faults(&[good]), [LoftFault::Few(1)]);
        assert_eq!(loft(&[good, section(1.0, 1.0, 1.0, 2.0)], 9), Err(LoftFault::Points(9)));
    }
}
