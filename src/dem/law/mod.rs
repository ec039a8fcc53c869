//! The laws of a contact, each a pure formula over lanes, and the rows of memory they share.
//!
//! A law sees the geometry of a touch, the constants of its class and its own rows; it answers with the load on i.
//! Forces and moments of the memory act on i, tension positive.

mod contact_bond;
mod flat_joint;
mod linear;
mod memory;
mod parallel_bond;
mod smooth_joint;

pub(crate) use contact_bond::ContactBondLaw;
pub use flat_joint::Interface;
pub(crate) use flat_joint::{FlatJointLaw, Layout, idle, join, rows as flat_joint_rows};
pub(crate) use linear::LinearLaw;
pub(crate) use memory::{Memory, bonded, fresh, unbond};
pub(crate) use parallel_bond::ParallelBondLaw;
pub(crate) use smooth_joint::{SmoothJointLaw, lay, read as read_joint, rows as smooth_joint_rows};

use super::interaction::{Bond, Interaction, NormalForce, ShearBreak, SmoothJoint};
use super::simd::{Lane, Row};
use super::space::{Load, Space, Touch, Tuple};

/// Row of k_n, N/m.
pub(crate) const KN: usize = 0;
/// Row of the reference gap g_r, m.
pub(crate) const REFERENCE: usize = 1;
/// First row of the shear force of the linear spring, N.
pub(crate) const SHEAR: usize = 2;

/// Indices of the other rows, which depend on the space.
pub(crate) struct RowIndex<S>(std::marker::PhantomData<S>);

impl<S: Space> RowIndex<S> {
    /// Tensile capacity σ_c A (∞ where nothing is bonded), N.
    pub(crate) const TENSION: usize = SHEAR + S::SHEAR;
    /// Shear capacity c A (∞ where nothing is bonded), N.
    pub(crate) const COHESION: usize = Self::TENSION + 1;
    /// k̄_n A (0 where nothing is bonded), N/m.
    pub(crate) const BOND: usize = Self::COHESION + 1;
    /// Normal force of the bond, N.
    pub(crate) const BOND_NORMAL: usize = Self::BOND + 1;
    /// First row of its shear force, N.
    pub(crate) const BOND_SHEAR: usize = Self::BOND_NORMAL + 1;
    /// First row of its bending moment, N·m.
    pub(crate) const BOND_BEND: usize = Self::BOND_SHEAR + S::SHEAR;
    /// Its twisting moment (solid only), N·m.
    pub(crate) const BOND_TWIST: usize = Self::BOND_BEND + S::SHEAR;
    /// All rows of a block.
    pub(crate) const COUNT: usize = if S::DIMENSION == 2 { Self::BOND_TWIST } else { Self::BOND_TWIST + 1 };
}

/// Constants of a class, in the form in which the laws use them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Constants {
    /// k_s / k_n of the linear spring.
    pub(crate) shear_share: f64,
    /// μ.
    pub(crate) friction: f64,
    /// k̄_s / k̄_n.
    pub(crate) bond_share: f64,
    /// λ.
    pub(crate) multiplier: f64,
    /// β.
    pub(crate) moment_factor: f64,
    /// tan φ.
    pub(crate) slope: f64,
    /// Whether the reference gap follows a spring that is let go.
    pub(crate) incremental: bool,
    /// β_n, β_s.
    pub(crate) dashpot: [f64; 2],
    /// Whether an unbonded dashpot may pull.
    pub(crate) tensile_dashpot: bool,
    /// Whether a contact bond that breaks in shear drops its shear force.
    pub(crate) zero_shear: bool,
    /// Elements of a flat joint.
    pub(crate) layout: Layout,
    /// tan ψ of a smooth joint.
    pub(crate) dilation: f64,
}

impl Constants {
    pub(crate) fn new<S: Space>(interaction: &Interaction) -> Self {
        let linear = &interaction.linear;
        let mut c = Self {
            shear_share: linear.stiffness.shear_share(),
            friction: linear.friction,
            bond_share: 0.0,
            multiplier: 1.0,
            moment_factor: 0.0,
            slope: 0.0,
            incremental: linear.normal_force == NormalForce::Incremental,
            dashpot: [linear.dashpot.normal, linear.dashpot.shear],
            tensile_dashpot: linear.dashpot.tensile,
            zero_shear: false,
            layout: Layout::default(),
            dilation: 0.0,
        };
        match interaction.bond {
            Bond::None => {}
            Bond::Contact(bond) => c.zero_shear = bond.shear_break == ShearBreak::Zero,
            Bond::Parallel(bond) => {
                c.bond_share = bond.stiffness.shear_share();
                c.multiplier = bond.radius_multiplier;
                c.moment_factor = bond.moment_factor;
                c.slope = math::elementary::tan(bond.friction_angle);
            }
            Bond::Flat(joint) => {
                c.bond_share = joint.stiffness.shear_share();
                c.multiplier = joint.radius_multiplier;
                c.slope = math::elementary::tan(joint.friction_angle);
                c.layout = Layout::new::<S>(joint.division);
            }
        }
        c
    }
}

impl Constants {
    /// Of a smooth joint.
    pub(crate) fn joint(joint: &SmoothJoint) -> Self {
        Self {
            shear_share: 0.0,
            friction: joint.friction,
            bond_share: joint.stiffness.shear_share(),
            multiplier: joint.radius_multiplier,
            moment_factor: 0.0,
            slope: joint.bond.map_or(0.0, |bond| math::elementary::tan(bond.friction_angle)),
            incremental: false,
            dashpot: [0.0; 2],
            tensile_dashpot: false,
            zero_shear: false,
            layout: Layout::default(),
            dilation: math::elementary::tan(joint.dilation),
        }
    }
}

/// Viscous coefficients of some contacts over the time step: force = coefficient × displacement in the step.
#[derive(Clone, Copy)]
pub(crate) struct Viscous<L> {
    pub(crate) normal: L,
    pub(crate) shear: L,
}

/// A piece of a bond that broke.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Piece {
    /// Tension, else shear.
    pub(crate) tensile: bool,
    /// Its number; 0 for a bond that breaks as a whole.
    pub(crate) element: u32,
    /// From the contact point, over the radius of the smaller particle: along t₁ and t₂ = n × t₁.
    pub(crate) arm: [f64; 2],
    /// t₁ in space; the plane has its own tangent.
    pub(crate) frame: [f64; 3],
}

/// Which contacts of a lane broke in this step.
pub(crate) struct Broken<L: Lane> {
    pub(crate) tension: L::Mask,
    pub(crate) shear: L::Mask,
}

/// What contacts have spent, if a run tracks its energy: rows of a block in J.
pub(crate) struct Account<'a>(pub(crate) Option<&'a mut [Row]>);

/// Rows of a block's account.
pub(crate) const ENERGIES: usize = 4;
/// Friction.
pub(crate) const SLIP: usize = 0;
/// Dashpots.
pub(crate) const DASHPOT: usize = 1;
/// Strain energy that was lost when a bond broke.
pub(crate) const BROKEN: usize = 2;
/// Work of a moving wall.
pub(crate) const BOUNDARY: usize = 3;

impl Account<'_> {
    /// Whether the run tracks its energy.
    #[inline(always)]
    pub(crate) fn open(&self) -> bool {
        self.0.is_some()
    }

    /// Adds to a row.
    #[inline(always)]
    pub(crate) fn charge<L: Lane>(&mut self, row: usize, at: usize, energy: L) {
        if let Some(rows) = &mut self.0 {
            (L::load(&rows[row], at) + energy).store(&mut rows[row], at);
        }
    }
}

/// One law: how a contact answers a step, and what is left in its rows.
pub(crate) trait Law<S: Space> {
    /// Rows of memory that it uses, from the first on.
    fn rows(layout: &Layout) -> usize;

    /// Normal stiffness for the dashpot, N/m.
    #[inline(always)]
    fn stiffness<L: Lane>(rows: &[Row], at: usize) -> L {
        L::load(&rows[KN], at)
    }

    /// Calls `put` with every piece of contact `lane` that broke in this step, in a lane of which [`respond`](Self::respond)
    /// reported a break; `tensile` is its report on this contact. A bond breaks in one piece.
    fn pieces(_constants: &Constants, _rows: &mut [Row], _lane: usize, tensile: bool, mut put: impl FnMut(Piece)) {
        put(Piece { tensile, ..Piece::default() });
    }

    /// Load on i, and the breaks if there was any.
    fn respond<L: Lane>(
        constants: &Constants,
        touch: &Touch<S, L>,
        viscous: Option<Viscous<L>>,
        rows: &mut [Row],
        at: usize,
        account: &mut Account<'_>,
    ) -> (Load<S, L>, Option<Broken<L>>);
}

/// Loads the shear-like tuple that begins at row `first`.
#[inline(always)]
pub(crate) fn load_shear<S: Space, L: Lane>(rows: &[Row], first: usize, at: usize) -> S::Shear<L> {
    S::Shear::<L>::build(|k| L::load(&rows[first + k], at))
}

/// Stores the shear-like tuple that begins at row `first`.
#[inline(always)]
pub(crate) fn store_shear<S: Space, L: Lane>(rows: &mut [Row], first: usize, at: usize, value: S::Shear<L>) {
    for k in 0..S::SHEAR {
        value.at(k).store(&mut rows[first + k], at);
    }
}
