//! Strength envelopes of rock: lines through the greatest stress σ₁ at failure over the confining stress σ₃, compression positive.
//!
//! * Mohr–Coulomb: σ₁ = UCS + k σ₃, least squares; k = (1 + sin φ)/(1 − sin φ), c = UCS/(2 √k).
//! * Hoek–Brown for intact rock (Hoek & Brown 1980, doi:10.1061/AJGEB6.0001029; s = 1, a = ½): (σ₁ − σ₃)² = σ_ci² + m_i σ_ci σ₃, least
//!   squares of the left side over σ₃, as its authors fit it.
//!
//! Standard errors are those of the line, carried to the parameters by their slopes.

use math::elementary::{asin, sin};

/// A straight line through points by least squares.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Line {
    intercept: f64,
    slope: f64,
    /// Variances of intercept and slope, and their covariance; NaN for two points.
    variance: [f64; 3],
    r2: f64,
}

impl Line {
    /// Needs two different abscissae.
    fn through(points: &[[f64; 2]]) -> Option<Self> {
        let n = points.len() as f64;
        let mean = |k: usize| points.iter().map(|p| p[k]).sum::<f64>() / n;
        let (x, y) = (mean(0), mean(1));
        let sum = |f: &dyn Fn(&[f64; 2]) -> f64| points.iter().map(f).sum::<f64>();
        let xx = sum(&|p| (p[0] - x) * (p[0] - x));
        let xy = sum(&|p| (p[0] - x) * (p[1] - y));
        let yy = sum(&|p| (p[1] - y) * (p[1] - y));
        if !(xx > 0.0) {
            return None;
        }
        let slope = xy / xx;
        let intercept = y - slope * x;
        let residual = sum(&|p| {
            let off = p[1] - intercept - slope * p[0];
            off * off
        });
        let s2 = if points.len() > 2 { residual / (n - 2.0) } else { f64::NAN };
        let variance = [s2 * (1.0 / n + x * x / xx), s2 / xx, -s2 * x / xx];
        Some(Self { intercept, slope, variance, r2: if yy > 0.0 { 1.0 - residual / yy } else { 1.0 } })
    }

    /// Standard error of a quantity with these derivatives by intercept and slope.
    fn error(&self, [by_intercept, by_slope]: [f64; 2]) -> f64 {
        let [a, b, ab] = self.variance;
        let square = by_intercept * by_intercept * a + by_slope * by_slope * b + 2.0 * by_intercept * by_slope * ab;
        square.max(0.0).sqrt()
    }
}

/// A value and its standard error.
pub type Estimate = [f64; 2];

/// The Mohr–Coulomb line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MohrCoulomb {
    /// σ₁ at σ₃ = 0, in the unit of the stresses.
    pub ucs: Estimate,
    /// Slope of σ₁ over σ₃.
    pub k: Estimate,
    /// Cohesion, in the unit of the stresses.
    pub cohesion: Estimate,
    /// Friction angle, rad.
    pub friction_angle: Estimate,
    /// Coefficient of determination of σ₁.
    pub r2: f64,
}

/// The Hoek–Brown curve of intact rock.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HoekBrown {
    /// σ_ci, in the unit of the stresses.
    pub sigma_ci: Estimate,
    /// m_i.
    pub m_i: Estimate,
    /// Coefficient of determination of (σ₁ − σ₃)².
    pub r2: f64,
}

impl MohrCoulomb {
    /// The line through points (σ₃, σ₁); nothing without two different σ₃, or where σ₁ does not rise with them.
    pub fn fit(points: &[[f64; 2]]) -> Option<Self> {
        let line = Line::through(points)?;
        let (ucs, k) = (line.intercept, line.slope);
        if !(ucs > 0.0 && k > 0.0) {
            return None;
        }
        let root = k.sqrt();
        let angle = asin((k - 1.0) / (k + 1.0));
        Some(Self {
            ucs: [ucs, line.error([1.0, 0.0])],
            k: [k, line.error([0.0, 1.0])],
            cohesion: [ucs / (2.0 * root), line.error([0.5 / root, -0.25 * ucs / (k * root)])],
            friction_angle: [angle, line.error([0.0, 1.0 / (root * (k + 1.0))])],
            r2: line.r2,
        })
    }

    /// σ₁ at a confining stress.
    pub fn strength(&self, confinement: f64) -> f64 {
        self.ucs[0] + self.k[0] * confinement
    }
}

impl HoekBrown {
    /// The curve through points (σ₃, σ₁); nothing without two different σ₃, or where it has no strength at σ₃ = 0.
    pub fn fit(points: &[[f64; 2]]) -> Option<Self> {
        let squares: Vec<[f64; 2]> = points.iter().map(|&[low, high]| [low, (high - low) * (high - low)]).collect();
        let line = Line::through(&squares)?;
        if !(line.intercept > 0.0) {
            return None;
        }
        let sigma_ci = line.intercept.sqrt();
        let m_i = line.slope / sigma_ci;
        Some(Self {
            sigma_ci: [sigma_ci, line.error([0.5 / sigma_ci, 0.0])],
            m_i: [m_i, line.error([-0.5 * m_i / line.intercept, 1.0 / sigma_ci])],
            r2: line.r2,
        })
    }

    /// σ₁ at a confining stress; NaN beyond the tensile end of the curve.
    pub fn strength(&self, confinement: f64) -> f64 {
        let [ci, m] = [self.sigma_ci[0], self.m_i[0]];
        confinement + ci * (1.0 + m * confinement / ci).sqrt()
    }

    /// Tensile strength of the curve, positive: σ₃ of −σ_t where σ₁ = σ₃.
    pub fn tensile_strength(&self) -> f64 {
        self.sigma_ci[0] / self.m_i[0]
    }
}

/// The slope k of a friction angle (rad).
pub fn slope_of(friction_angle: f64) -> f64 {
    (1.0 + sin(friction_angle)) / (1.0 - sin(friction_angle))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn near(found: f64, wanted: f64, tolerance: f64) {
        assert!((found - wanted).abs() <= tolerance, "{found} {wanted}");
    }

    /// Hoek, Practical Rock Engineering, chapter "Rock mass properties": the worked triaxial tests, printed with σ_ci 37.4, m_i 15.50
    /// and r² 0.997.
    #[test]
    fn a_published_example_of_hoek_comes_out() {
        let tests = [[0.0, 38.3], [5.0, 72.4], [7.5, 80.5], [15.0, 115.6], [20.0, 134.3]];
        let found = HoekBrown::fit(&tests).unwrap();
        near(found.sigma_ci[0], 37.4, 0.05);
        near(found.m_i[0], 15.50, 0.005);
        near(found.r2, 0.997, 5e-4);
    }

    #[test]
    fn exact_envelopes_come_back_without_error() {
        let confinements = [0.0, 2.0, 5.0, 10.0, 20.0, 40.0];
        let (c, phi) = (25.0, 0.9);
        let k = slope_of(phi);
        let line = confinements.map(|p| [p, 2.0 * c * k.sqrt() + k * p]);
        let found = MohrCoulomb::fit(&line).unwrap();
        near(found.cohesion[0], c, 1e-9);
        near(found.friction_angle[0], phi, 1e-12);
        near(found.strength(10.0), line[3][1], 1e-9);
        assert!(found.cohesion[1] < 1e-6 && found.friction_angle[1] < 1e-8, "{found:?}");
        let curve = confinements.map(|p| [p, p + 150.0 * (1.0 + 25.0 * p / 150.0_f64).sqrt()]);
        let found = HoekBrown::fit(&curve).unwrap();
        near(found.sigma_ci[0], 150.0, 1e-9);
        near(found.m_i[0], 25.0, 1e-9);
        near(found.strength(-found.tensile_strength()), -found.tensile_strength(), 1e-6);
    }

    /// Errors against those of the same fits of 4,000 scattered sets.
    #[test]
    fn errors_are_the_scatter_of_repeated_fits() {
        let mut stream = math::random::Stream::new(1, "envelope", 0);
        let (mut found, mut told) = (Vec::new(), 0.0);
        for _ in 0..4000 {
            let points = [0.0, 5.0, 10.0, 20.0, 30.0, 40.0].map(|p| [p, 100.0 + 6.0 * p + 3.0 * stream.normal()]);
            let fit = MohrCoulomb::fit(&points).unwrap();
            found.push(fit.friction_angle[0]);
            told += fit.friction_angle[1] * fit.friction_angle[1] / 4000.0;
        }
        let mean = found.iter().sum::<f64>() / 4000.0;
        let scatter = found.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>() / 3999.0;
        near(told / scatter, 1.0, 0.1);
    }

    #[test]
    fn one_confinement_is_no_envelope() {
        assert_eq!(MohrCoulomb::fit(&[[5.0, 100.0], [5.0, 110.0]]), None);
        assert_eq!(HoekBrown::fit(&[[5.0, 100.0]]), None);
    }
}
