//! The kinds of test, and the responses that each declares: what a run of it can be measured by, known before it runs.

use super::curve::Macro;
use serde::{Deserialize, Serialize};

/// Kinds of test.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum TestKind {
    /// Compression of a rectangle, box or standing cylinder between two platens.
    Uniaxial,
    /// Splitting of a disc or lying cylinder between two platens or jaws.
    Brazilian,
    /// Direct tension of a rectangle, box or standing cylinder by grips.
    Tension,
    /// Compression of a rectangle under a confining stress; plane.
    Biaxial,
    /// Compression of a box or standing cylinder under a confining stress; solid.
    Triaxial,
    /// Three-point bending of a beam, plain or notched; plane.
    Bending,
}

/// Every kind.
pub const KINDS: [TestKind; 6] = [
    TestKind::Uniaxial,
    TestKind::Brazilian,
    TestKind::Tension,
    TestKind::Biaxial,
    TestKind::Triaxial,
    TestKind::Bending,
];

/// A number that a test gives.
#[derive(Clone, Copy, Debug)]
pub struct Response {
    /// Name in tables.
    pub name: &'static str,
    /// Symbol, as in LaTeX.
    pub symbol: &'static str,
    /// SI unit; empty for a pure number.
    pub unit: &'static str,
    /// Definition.
    pub about: &'static str,
    /// How it is read from the record's quantities.
    pub read: fn(&Macro) -> f64,
}

const PEAK_STRAIN: Response = Response {
    name: "peak_strain",
    symbol: r"\varepsilon_p",
    unit: "",
    about: "axial strain at the peak",
    read: |m| m.peak_strain,
};
const INITIATION: Response = Response {
    name: "sigma_ci",
    symbol: r"\sigma_{ci}",
    unit: "Pa",
    about: "stress at which 1 % of the cracks present at the peak exist",
    read: |m| m.crack_initiation,
};
const MODULUS: Response = Response {
    name: "E",
    symbol: "E",
    unit: "Pa",
    about: "tangent modulus between 40 and 60 % of the peak",
    read: |m| m.modulus_tangent,
};
const SECANT: Response = Response {
    name: "E_secant",
    symbol: r"E_{sec}",
    unit: "Pa",
    about: "secant modulus to half the peak",
    read: |m| m.modulus_secant,
};
const POISSON: Response = Response {
    name: "nu",
    symbol: r"\nu",
    unit: "",
    about: "lateral over axial strain at half the peak",
    read: |m| m.poisson_secant,
};
const POISSON_TANGENT: Response = Response {
    name: "nu_tangent",
    symbol: r"\nu_{tan}",
    unit: "",
    about: "slope of lateral against axial strain between 40 and 60 % of the peak",
    read: |m| m.poisson_tangent,
};
const DAMAGE: Response = Response {
    name: "sigma_cd",
    symbol: r"\sigma_{cd}",
    unit: "Pa",
    about: "stress at the largest volumetric contraction before the peak",
    read: |m| m.crack_damage,
};
const UCS: Response = Response {
    name: "UCS",
    symbol: r"\sigma_u",
    unit: "Pa",
    about: "uniaxial compressive strength: the peak stress",
    read: |m| m.strength,
};
const TENSILE: Response =
    Response { name: "sigma_t", symbol: r"\sigma_t", unit: "Pa", about: "tensile strength", read: |m| m.strength };
const DEVIATOR: Response = Response {
    name: "q",
    symbol: "q",
    unit: "Pa",
    about: "peak deviator stress: axial less confining stress",
    read: |m| m.strength,
};
const AXIAL: Response = Response {
    name: "sigma_1",
    symbol: r"\sigma_1",
    unit: "Pa",
    about: "axial stress at the peak of the deviator",
    read: |m| m.strength + m.confinement,
};
const CONFINING: Response = Response {
    name: "sigma_3",
    symbol: r"\sigma_3",
    unit: "Pa",
    about: "confining stress at the peak of the deviator, as measured at the side walls",
    read: |m| m.confinement,
};
const FLEXURAL: Response = Response {
    name: "f_b",
    symbol: "f_b",
    unit: "Pa",
    about: "flexural strength, 3 F L / (2 b (h − a)²) at the largest force",
    read: |m| m.strength,
};
const BEAM_MODULUS: Response = Response {
    name: "E",
    symbol: "E",
    unit: "Pa",
    about: "modulus of the beam of the same deflection, shear left out, between 40 and 60 % of the peak",
    read: |m| m.modulus_tangent,
};
const FRACTURE_ENERGY: Response = Response {
    name: "G_F",
    symbol: "G_F",
    unit: "J/m^2",
    about: "work of the force up to the end of the test over the area above the notch",
    read: |m| m.fracture_energy,
};

impl TestKind {
    /// Name in files and messages.
    pub fn name(self) -> &'static str {
        match self {
            Self::Uniaxial => "uniaxial",
            Self::Brazilian => "brazilian",
            Self::Tension => "tension",
            Self::Biaxial => "biaxial",
            Self::Triaxial => "triaxial",
            Self::Bending => "bending",
        }
    }

    /// Whether one crack through one section ends the test; damage is spread over the piece otherwise.
    pub fn localised(self) -> bool {
        matches!(self, Self::Brazilian | Self::Tension | Self::Bending)
    }

    /// The responses of the test, the strength first.
    pub fn responses(self) -> &'static [Response] {
        match self {
            Self::Uniaxial => {
                const { &[UCS, PEAK_STRAIN, INITIATION, MODULUS, POISSON, SECANT, POISSON_TANGENT, DAMAGE] }
            }
            Self::Brazilian => const { &[TENSILE, PEAK_STRAIN, INITIATION] },
            Self::Tension => const { &[TENSILE, PEAK_STRAIN, INITIATION, MODULUS, POISSON, SECANT, POISSON_TANGENT] },
            Self::Biaxial | Self::Triaxial => {
                const {
                    &[
                        DEVIATOR,
                        AXIAL,
                        CONFINING,
                        PEAK_STRAIN,
                        INITIATION,
                        MODULUS,
                        POISSON,
                        SECANT,
                        POISSON_TANGENT,
                        DAMAGE,
                    ]
                }
            }
            Self::Bending => const { &[FLEXURAL, BEAM_MODULUS, FRACTURE_ENERGY, PEAK_STRAIN, INITIATION] },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What a published workflow may ask of each test; a name that goes breaks those files.
    #[test]
    fn names_of_responses_are_unique_and_stay() {
        let names = |kind: TestKind| kind.responses().iter().map(|r| r.name).collect::<Vec<_>>().join(" ");
        assert_eq!(names(TestKind::Uniaxial), "UCS peak_strain sigma_ci E nu E_secant nu_tangent sigma_cd");
        assert_eq!(names(TestKind::Brazilian), "sigma_t peak_strain sigma_ci");
        assert_eq!(names(TestKind::Tension), "sigma_t peak_strain sigma_ci E nu E_secant nu_tangent");
        assert_eq!(
            names(TestKind::Triaxial),
            "q sigma_1 sigma_3 peak_strain sigma_ci E nu E_secant nu_tangent sigma_cd"
        );
        for kind in KINDS {
            let mut sorted: Vec<&str> = kind.responses().iter().map(|r| r.name).collect();
            sorted.sort_unstable();
            assert!(sorted.windows(2).all(|pair| pair[0] != pair[1]), "{kind:?}");
        }
    }
}
