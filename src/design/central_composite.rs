//! Central composite designs (Box & Wilson 1951, *J. R. Stat. Soc. B* 13, 1, doi:10.1111/j.2517-6161.1951.tb00067.x;
//! Box & Hunter 1957, *Ann. Math. Stat.* 28, 195, doi:10.1214/aoms/1177707047).
//!
//! F corners of the cube at ±1 (the full factorial, or from five factors on the smallest fraction of resolution V), 2k
//! axial points at ±α, and n₀ centre points; N = F + 2k + n₀.
//!
//! | `alpha` | α | property |
//! |---|---|---|
//! | rotatable | F^(1/4), that is 2^(k/4) for a full cube | the variance of prediction depends on the distance from the centre only |
//! | orthogonal | √((√(F·N) − F) / 2) | the estimates of the squares are uncorrelated |
//! | spherical | √k | all points but the centre on one sphere |
//! | face | 1 | three levels suffice, no point leaves the cube |
//!
//! Without `centre_points`, n₀ gives uniform precision (Box & Hunter 1957): the integer nearest to λ(√F + 2)²
//! − F − 2k with λ = (k + 3 + √(9k² + 14k − 7)) / (4(k + 2)).

use super::coding::{Factor, check_surface};
use super::error::Fault;
use super::fractional::cube;
use super::table::{PointType, Points};
use super::{Design, Stream, is_default};
use serde::{Deserialize, Serialize};

/// Rule for the distance of the axial points.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Alpha {
    /// F^(1/4).
    #[default]
    Rotatable,
    /// Squares uncorrelated.
    Orthogonal,
    /// √k.
    Spherical,
    /// 1.
    Face,
    /// This number.
    #[serde(untagged)]
    Number(f64),
}

/// Meaning of the range of a factor.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Extent {
    /// The cube: axial points lie beyond the range when α > 1 (circumscribed).
    #[default]
    Cube,
    /// The axial points: the cube lies inside the range (inscribed).
    Axial,
}

/// Which corners are run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Corners {
    /// The full factorial up to four factors, then the smallest listed fraction of resolution V or more.
    #[default]
    Fraction,
    /// All of them.
    Full,
}

/// Options of a central composite design.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct CentralComposite {
    /// Distance of the axial points: a rule or a number.
    #[serde(skip_serializing_if = "is_default")]
    pub alpha: Alpha,
    /// Number of centre points; that of uniform precision if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub centre_points: Option<usize>,
    /// Meaning of the ranges of the factors.
    #[serde(skip_serializing_if = "is_default")]
    pub extent: Extent,
    /// Which corners are run.
    #[serde(skip_serializing_if = "is_default")]
    pub corners: Corners,
}

/// Corners of more factors than this are refused in full.
const MOST_FULL: usize = 12;

impl CentralComposite {
    /// α for `k` factors, `f` corners and `n0` centre points.
    fn distance(&self, k: usize, f: usize, n0: usize) -> f64 {
        let (k, f, n0) = (k as f64, f as f64, n0 as f64);
        match self.alpha {
            Alpha::Rotatable => f.sqrt().sqrt(),
            Alpha::Orthogonal => (((f * (f + 2.0 * k + n0)).sqrt() - f) / 2.0).sqrt(),
            Alpha::Spherical => k.sqrt(),
            Alpha::Face => 1.0,
            Alpha::Number(alpha) => alpha,
        }
    }

    fn faults(&self, factors: &[Factor], design: &str) -> Vec<Fault> {
        let mut faults = check_surface(factors, design);
        if factors.len() < 2 {
            faults.push(Fault::NoConstruction {
                design: design.into(),
                found: "one factor".into(),
                remedy: "a second-order surface of one factor needs a full factorial of three levels".into(),
            });
        }
        if let Alpha::Number(alpha) = self.alpha
            && !(alpha.is_finite() && alpha > 0.0)
        {
            faults.push(Fault::BadOption {
                option: "alpha".into(),
                found: alpha.to_string(),
                wanted: "it must be above 0, or one of rotatable, orthogonal, spherical, face".into(),
            });
        }
        if self.corners == Corners::Full && factors.len() > MOST_FULL {
            faults.push(Fault::BadOption {
                option: "corners".into(),
                found: format!("full for {} factors", factors.len()),
                wanted: format!("all corners are run for at most {MOST_FULL} factors; leave it at `fraction`"),
            });
        }
        faults
    }
}

/// Centre points of uniform precision for `k` factors and `f` corners.
fn uniform_precision(k: usize, f: usize) -> usize {
    let (k, f) = (k as f64, f as f64);
    let lambda = (k + 3.0 + (9.0 * k * k + 14.0 * k - 7.0).sqrt()) / (4.0 * (k + 2.0));
    let root = f.sqrt() + 2.0;
    (lambda * root * root - f - 2.0 * k).round().max(1.0) as usize
}

impl Design for CentralComposite {
    const NAME: &'static str = "central-composite";

    fn points(&self, factors: &[Factor], _: &mut Stream) -> Result<Points, Vec<Fault>> {
        let design = "a central composite design";
        let mut faults = self.faults(factors, design);
        let k = factors.len();
        let fraction = self.corners == Corners::Fraction && k >= 5;
        let corners = if k > MOST_FULL && !fraction { Ok(vec![]) } else { cube(k, fraction) };
        let corners = corners.map_err(|fault| faults.push(fault)).unwrap_or_default();
        if !faults.is_empty() {
            return Err(faults);
        }
        let f = corners.len();
        let centre = self.centre_points.unwrap_or_else(|| uniform_precision(k, f));
        let alpha = self.distance(k, f, centre);
        let unit = if self.extent == Extent::Axial && alpha > 1.0 { 1.0 / alpha } else { 1.0 };
        let scaled: Vec<Vec<f64>> = corners.iter().map(|r| r.iter().map(|x| x * unit).collect()).collect();
        let mut rows = Points::coded(&scaled, PointType::Cube);
        let reach = if self.extent == Extent::Axial && alpha > 1.0 { 1.0 } else { alpha };
        for i in 0..k {
            for sign in [-1.0, 1.0] {
                let mut row = vec![0.0; k];
                row[i] = sign * reach;
                rows.extend(Points::coded(&[row], PointType::Axial));
            }
        }
        let part = if fraction { ", a fraction of resolution V or more" } else { "" };
        Ok(Points {
            rows,
            centre,
            construction: format!(
                "central composite, {f} corners{part}, {} axial points at α = {alpha:.6}, {centre} centre points",
                2 * k
            ),
            source: "Box & Wilson 1951, J. R. Stat. Soc. B 13, 1, doi:10.1111/j.2517-6161.1951.tb00067.x".into(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{DesignTable, Layout, Method, build};

    fn factors(k: usize) -> Vec<Factor> {
        (0..k).map(|i| Factor::range(&format!("x{i}"), "", -1.0, 1.0)).collect()
    }

    fn table(design: CentralComposite, k: usize) -> DesignTable {
        build(&Method::CentralComposite(design), &factors(k), Layout::default(), 1).unwrap()
    }

    #[test]
    fn two_factors_are_the_printed_matrix() {
        let a = 2.0_f64.sqrt();
        let printed = [
            [-1.0, -1.0],
            [1.0, -1.0],
            [-1.0, 1.0],
            [1.0, 1.0],
            [-a, 0.0],
            [a, 0.0],
            [0.0, -a],
            [0.0, a],
            [0.0, 0.0],
            [0.0, 0.0],
            [0.0, 0.0],
            [0.0, 0.0],
            [0.0, 0.0],
        ];
        let t = table(CentralComposite::default(), 2);
        assert_eq!(t.runs(), 13);
        for (row, want) in t.coded.iter().zip(printed) {
            assert!(row.iter().zip(want).all(|(x, y)| (x - y).abs() < 1e-15), "{row:?} {want:?}");
        }
    }

    /// Box & Hunter 1957: corners, α and centre points of rotatable designs of uniform precision.
    #[test]
    fn rotatable_designs_have_the_published_size_and_alpha() {
        let published = [
            (2, Corners::Full, 4, 1.414, 5),
            (3, Corners::Full, 8, 1.682, 6),
            (4, Corners::Full, 16, 2.0, 7),
            (5, Corners::Full, 32, 2.378, 10),
            (5, Corners::Fraction, 16, 2.0, 6),
            (6, Corners::Full, 64, 2.828, 15),
            (6, Corners::Fraction, 32, 2.378, 9),
            (7, Corners::Full, 128, 3.364, 21),
            (7, Corners::Fraction, 64, 2.828, 14),
        ];
        for (k, corners, f, alpha, centre) in published {
            let t = table(CentralComposite { corners, ..Default::default() }, k);
            let count = |p| t.point_type.iter().filter(|q| **q == p).count();
            assert_eq!((count(PointType::Cube), count(PointType::Axial), count(PointType::Centre)), (f, 2 * k, centre));
            assert!((t.coded[f + 1][0] - alpha).abs() < 5e-4, "k = {k}: {}", t.coded[f + 1][0]);
        }
    }

    /// α for one centre point as listed in textbooks (Myers, Montgomery & Anderson-Cook 2016): k = 5 on the half
    /// cube.
    #[test]
    fn orthogonal_alpha_makes_squares_uncorrelated() {
        let orthogonal =
            |centre| CentralComposite { alpha: Alpha::Orthogonal, centre_points: Some(centre), ..Default::default() };
        for (k, alpha) in [(2, 1.0), (3, 1.2154), (4, 2.0_f64.sqrt()), (5, 1.5467)] {
            let t = table(orthogonal(1), k);
            assert!((t.coded.iter().map(|r| r[0]).fold(0.0, f64::max) - alpha).abs() < 1e-4, "k = {k}");
        }
        let t = table(orthogonal(4), 3);
        let square = |j: usize| t.coded.iter().map(|r| r[j] * r[j]).collect::<Vec<f64>>();
        let (a, b) = (square(0), square(2));
        let mean = a.iter().sum::<f64>() / a.len() as f64;
        let covariance: f64 = a.iter().zip(&b).map(|(x, y)| (x - mean) * (y - mean)).sum();
        assert!(covariance.abs() < 1e-12);
    }

    #[test]
    fn the_other_rules_and_the_inscribed_cube() {
        let most = |t: &DesignTable| t.coded.iter().flatten().fold(0.0_f64, |m, x| m.max(x.abs()));
        let with = |alpha| CentralComposite { alpha, ..Default::default() };
        assert_eq!(most(&table(with(Alpha::Face), 3)), 1.0);
        assert_eq!(most(&table(with(Alpha::Spherical), 3)), 3.0_f64.sqrt());
        assert_eq!(most(&table(with(Alpha::Number(1.25)), 3)), 1.25);
        let inside = table(CentralComposite { extent: Extent::Axial, ..Default::default() }, 2);
        assert_eq!((most(&inside), inside.coded[0][0]), (1.0, -1.0 / 2.0_f64.sqrt()));
    }

    #[test]
    fn bad_requests_are_refused() {
        let error = |design, k| {
            build(&Method::CentralComposite(design), &factors(k), Layout::default(), 1).unwrap_err().to_string()
        };
        assert!(error(CentralComposite::default(), 1).contains("one factor"));
        assert!(
            error(CentralComposite { alpha: Alpha::Number(f64::NAN), ..Default::default() }, 3)
                .contains("`alpha` is NaN")
        );
        assert!(error(CentralComposite::default(), 12).contains("none is listed for 12 factors and resolution 5"));
        assert!(
            error(CentralComposite { corners: Corners::Full, ..Default::default() }, 13).contains("`corners` is full")
        );
    }
}
