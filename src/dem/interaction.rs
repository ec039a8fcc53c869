//! Which law, with which values, acts between two groups: the contact table of a specimen.
//!
//! # From moduli to stiffnesses
//! Linear spring of a contact of radii R₁, R₂ (ball and wall: R₂ = ∞, so L = R₁):
//!
//! | convention | plane (unit thickness) | solid | source |
//! |---|---|---|---|
//! | [`Convention::Present`] | E* 2 min(R) / L | E* π min(R)² / L | PFC 5 and later, L = R₁ + R₂ |
//! | [`Convention::Pc2004`] | E* (wall: 2 E*) | 4 E* R₁ R₂ / (R₁ + R₂) (wall: 4 E* R₁) | Potyondy & Cundall 2004, doi:10.1016/j.ijrmms.2004.09.011 |
//!
//! k_s = k_n / κ. Bond stiffness per area: Ē / L and Ē / (L κ̄), bond radius λ min(R₁, R₂). λ is not in the stiffness per area.

use super::particle::Group;
use super::space::Space;
use super::strength::Scatter;

/// How a modulus becomes the stiffness of a linear contact.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Convention {
    /// PFC 5 and later.
    #[default]
    Present,
    /// PFC 3, 4 and Potyondy & Cundall (2004).
    Pc2004,
}

/// Stiffness of the linear spring.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Stiffness {
    /// Effective modulus E*, Pa, and κ = k_n / k_s.
    Modulus {
        /// E*, Pa.
        modulus: f64,
        /// k_n / k_s.
        ratio: f64,
        /// How it becomes a stiffness.
        convention: Convention,
    },
    /// Stiffnesses of the contact, N/m, for every pair of radii.
    Direct {
        /// k_n, N/m.
        kn: f64,
        /// k_s, N/m.
        ks: f64,
    },
}

/// Viscous dashpots: F = 2 β √(m_eff k) v in each direction; β = 0 for none.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Dashpot {
    /// β_n, share of the critical damping.
    pub normal: f64,
    /// β_s.
    pub shear: f64,
    /// Whether the dashpot may pull in an unbonded contact.
    pub tensile: bool,
}

/// How the normal force of the linear spring follows the gap g.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum NormalForce {
    /// F_n = k_n (g_r − g), 0 where that pulls.
    #[default]
    Absolute,
    /// F_n ← max(0, F_n − k_n Δg) while the surfaces overlap, else 0: a spring that was let go grips again from where it is,
    /// and a change of stiffness leaves the force as it is. A new overlap starts as in the absolute form.
    Incremental,
}

/// Linear contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Linear {
    /// Spring.
    pub stiffness: Stiffness,
    /// How its normal force follows the gap.
    pub normal_force: NormalForce,
    /// Coulomb friction μ.
    pub friction: f64,
    /// Dashpots.
    pub dashpot: Dashpot,
}

impl Linear {
    /// From E*, κ and μ in the present convention, without dashpots.
    pub fn modulus(modulus: f64, ratio: f64, friction: f64) -> Self {
        let stiffness = Stiffness::Modulus { modulus, ratio, convention: Convention::Present };
        Self { stiffness, normal_force: NormalForce::Absolute, friction, dashpot: Dashpot::default() }
    }

    /// From k_n, k_s and μ, without dashpots.
    pub fn direct(kn: f64, ks: f64, friction: f64) -> Self {
        Self { stiffness: Stiffness::Direct { kn, ks }, ..Self::modulus(1.0, 1.0, friction) }
    }
}

/// What a contact bond does with its shear force when it breaks in shear.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ShearBreak {
    /// Unchanged under compression, limited by friction from then on (continuous; PFC 3).
    #[default]
    Keep,
    /// Zeroed (present PFC text).
    Zero,
}

/// Point bond: the linear spring also pulls and does not slip. Strengths are stresses on the section of min(R₁, R₂).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactBond {
    /// σ_t, Pa.
    pub tensile_strength: f64,
    /// τ_s, Pa.
    pub shear_strength: f64,
    /// Scatter of both strengths.
    pub scatter: Scatter,
    /// What happens to the shear force at a shear break.
    pub shear_break: ShearBreak,
}

impl ContactBond {
    /// A bond with its strengths (Pa), without scatter.
    pub fn new(tensile_strength: f64, shear_strength: f64) -> Self {
        Self { tensile_strength, shear_strength, scatter: Scatter::default(), shear_break: ShearBreak::default() }
    }
}

/// Stiffness of the bonding cement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum BondStiffness {
    /// Ē, Pa, and κ̄ = k̄_n / k̄_s.
    Modulus {
        /// Ē, Pa.
        modulus: f64,
        /// k̄_n / k̄_s.
        ratio: f64,
    },
    /// Per area, Pa/m.
    PerArea {
        /// k̄_n, Pa/m.
        kn: f64,
        /// k̄_s, Pa/m.
        ks: f64,
    },
}

/// Elastic cement beside the linear contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ParallelBond {
    /// λ: bond radius over the smaller particle radius.
    pub radius_multiplier: f64,
    /// Stiffness of the cement.
    pub stiffness: BondStiffness,
    /// σ_c, Pa.
    pub tensile_strength: f64,
    /// c, Pa.
    pub cohesion: f64,
    /// φ, rad: τ_c = c − σ tan φ, tension positive.
    pub friction_angle: f64,
    /// β: share of the moments in the stresses, 0 … 1.
    pub moment_factor: f64,
    /// Scatter of both strengths.
    pub scatter: Scatter,
}

/// How an interface is divided: `rings` rings of equal area by `sectors` equal sectors in space; `rings * sectors` equal
/// segments in the plane.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Division {
    /// Rings.
    pub rings: u32,
    /// Sectors of a ring.
    pub sectors: u32,
}

impl Division {
    /// Most elements of an interface.
    pub const MOST: u32 = 32;

    /// Elements of the interface.
    pub fn count(&self) -> u32 {
        self.rings.saturating_mul(self.sectors)
    }
}

/// State in which interfaces are made: a share of them gapped (unbonded, open by `gap`), a share slit (unbonded, closed), the
/// rest bonded.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Shares {
    /// Share of gapped interfaces.
    pub gapped: f64,
    /// Share of slit interfaces.
    pub slit: f64,
    /// Gap g₀ of the gapped ones, m.
    pub gap: f64,
}

/// Interface of finite size instead of the linear contact, divided into elements that break one by one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FlatJoint {
    /// λ: radius of the interface over the smaller particle radius.
    pub radius_multiplier: f64,
    /// Its elements.
    pub division: Division,
    /// Stiffness of the interface.
    pub stiffness: BondStiffness,
    /// σ_b, Pa.
    pub tensile_strength: f64,
    /// c_b, Pa.
    pub cohesion: f64,
    /// φ_b, rad: an element breaks in shear at c_b − σ tan φ_b, tension positive.
    pub friction_angle: f64,
    /// Bonded, gapped and slit interfaces.
    pub shares: Shares,
    /// Scatter of both strengths, from interface to interface.
    pub scatter: Scatter,
}

impl FlatJoint {
    /// A bonded interface of the full radius in four elements, with its modulus (Pa), k_n / k_s and strengths (Pa): no angle
    /// of friction, no scatter. The friction of broken elements is that of the linear contact.
    pub fn new(modulus: f64, ratio: f64, tensile_strength: f64, cohesion: f64) -> Self {
        Self {
            radius_multiplier: 1.0,
            division: Division { rings: 1, sectors: 4 },
            stiffness: BondStiffness::Modulus { modulus, ratio },
            tensile_strength,
            cohesion,
            friction_angle: 0.0,
            shares: Shares::default(),
            scatter: Scatter::default(),
        }
    }

    /// Area of the interface, m².
    pub fn section<S: Space>(&self, radii: [f64; 2]) -> f64 {
        S::section(self.radius_multiplier * radii[0].min(radii[1]))
    }

    /// k_n A, N/m.
    pub fn normal<S: Space>(&self, radii: [f64; 2]) -> f64 {
        self.stiffness.per_area(radii) * self.section::<S>(radii)
    }
}

/// Bond of a smooth joint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointBond {
    /// σ, Pa.
    pub tensile_strength: f64,
    /// c, Pa.
    pub cohesion: f64,
    /// φ, rad: τ = c − σ_n tan φ, tension positive.
    pub friction_angle: f64,
}

/// What acts between grains on the two sides of a fracture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SmoothJoint {
    /// λ: radius of the section over the smaller particle radius.
    pub radius_multiplier: f64,
    /// Stiffness.
    pub stiffness: BondStiffness,
    /// μ.
    pub friction: f64,
    /// ψ, rad: a slip parts the faces by its tangent.
    pub dilation: f64,
    /// The bond, if any.
    pub bond: Option<JointBond>,
}

impl SmoothJoint {
    /// Unbonded, without dilation: stiffnesses per area (Pa/m) and μ.
    pub fn new(kn: f64, ks: f64, friction: f64) -> Self {
        let stiffness = BondStiffness::PerArea { kn, ks };
        Self { radius_multiplier: 1.0, stiffness, friction, dilation: 0.0, bond: None }
    }

    /// Section of a contact, m².
    pub fn section<S: Space>(&self, radii: [f64; 2]) -> f64 {
        S::section(self.radius_multiplier * radii[0].min(radii[1]))
    }

    /// k_n A, N/m.
    pub fn normal<S: Space>(&self, radii: [f64; 2]) -> f64 {
        self.stiffness.per_area(radii) * self.section::<S>(radii)
    }
}

/// The bond that [`install_bonds`](super::Engine::install_bonds) puts into a contact.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Bond {
    /// None: the contact is linear.
    #[default]
    None,
    /// Point bond.
    Contact(ContactBond),
    /// Cement.
    Parallel(ParallelBond),
    /// Interface in place of the contact.
    Flat(FlatJoint),
}

/// Law and values between two groups.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interaction {
    /// The contact.
    pub linear: Linear,
    /// The bond, where one is installed.
    pub bond: Bond,
}

impl Interaction {
    /// A contact that is never bonded.
    pub fn unbonded(linear: Linear) -> Self {
        Self { linear, bond: Bond::None }
    }
}

/// One interaction for each pair of groups that can meet.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ContactTable {
    pub(crate) entries: Vec<(Group, Group, Interaction)>,
}

impl ContactTable {
    /// Empty.
    pub fn new() -> Self {
        Self::default()
    }

    /// Sets the interaction of `a` with `b`, in either order; a second call replaces the first.
    pub fn set(&mut self, a: Group, b: Group, interaction: Interaction) {
        let pair = (a.min(b), a.max(b));
        match self.entries.iter_mut().find(|e| (e.0, e.1) == pair) {
            Some(entry) => entry.2 = interaction,
            None => self.entries.push((pair.0, pair.1, interaction)),
        }
    }

    /// [`set`](Self::set), in a chain.
    #[must_use]
    pub fn with(mut self, a: Group, b: Group, interaction: Interaction) -> Self {
        self.set(a, b, interaction);
        self
    }

    /// The index of a pair in the table: its class.
    pub fn class(&self, a: Group, b: Group) -> Option<usize> {
        let pair = (a.min(b), a.max(b));
        self.entries.iter().position(|e| (e.0, e.1) == pair)
    }

    /// The interaction of a pair.
    pub fn get(&self, a: Group, b: Group) -> Option<&Interaction> {
        self.class(a, b).map(|k| &self.entries[k].2)
    }
}

/// The radii on both sides of a contact: the second is infinite at a wall.
fn length(radii: [f64; 2]) -> f64 {
    if radii[1].is_finite() { radii[0] + radii[1] } else { radii[0] }
}

impl Stiffness {
    /// k_n of a contact, N/m.
    pub fn normal<S: Space>(&self, radii: [f64; 2]) -> f64 {
        let small = radii[0].min(radii[1]);
        match *self {
            Self::Direct { kn, .. } => kn,
            Self::Modulus { modulus, convention: Convention::Present, .. } => {
                modulus * S::section(small) / length(radii)
            }
            Self::Modulus { modulus, convention: Convention::Pc2004, .. } if S::DIMENSION == 2 => {
                if radii[1].is_finite() { modulus } else { 2.0 * modulus }
            }
            Self::Modulus { modulus, convention: Convention::Pc2004, .. } => {
                // Two springs 4 E R in series; a wall is rigid, so only the ball's own remains (2 E in the plane).
                let series = if radii[1].is_finite() { radii[0] * radii[1] / (radii[0] + radii[1]) } else { radii[0] };
                4.0 * modulus * series
            }
        }
    }

    /// k_s / k_n.
    pub fn shear_share(&self) -> f64 {
        match *self {
            Self::Direct { kn, ks } => ks / kn,
            Self::Modulus { ratio, .. } => 1.0 / ratio,
        }
    }
}

impl ParallelBond {
    /// A bond of the full radius, with its modulus (Pa), k̄_n / k̄_s and strengths (Pa): no angle of friction, no scatter.
    pub fn new(modulus: f64, ratio: f64, tensile_strength: f64, cohesion: f64) -> Self {
        Self {
            radius_multiplier: 1.0,
            stiffness: BondStiffness::Modulus { modulus, ratio },
            tensile_strength,
            cohesion,
            friction_angle: 0.0,
            moment_factor: 1.0,
            scatter: Scatter::default(),
        }
    }

    /// Section of the cement, m².
    pub fn section<S: Space>(&self, radii: [f64; 2]) -> f64 {
        S::section(self.radius_multiplier * radii[0].min(radii[1]))
    }

    /// k̄_n A, N/m.
    pub fn normal<S: Space>(&self, radii: [f64; 2]) -> f64 {
        self.stiffness.per_area(radii) * self.section::<S>(radii)
    }
}

impl BondStiffness {
    /// k̄_n between two radii, Pa/m.
    fn per_area(&self, radii: [f64; 2]) -> f64 {
        match *self {
            Self::Modulus { modulus, .. } => modulus / length(radii),
            Self::PerArea { kn, .. } => kn,
        }
    }

    /// k̄_s / k̄_n.
    pub fn shear_share(&self) -> f64 {
        match *self {
            Self::Modulus { ratio, .. } => 1.0 / ratio,
            Self::PerArea { kn, ks } => ks / kn,
        }
    }
}
