//! All that differs between the plane and the solid: [`Space`] with its members [`D2`] and [`D3`].
//!
//! Plane: discs of unit thickness, a spin is one number, shear acts along t = (−n_y, n_x). Solid: spheres, a spin is a
//! vector, shear and bending are vectors that turn with the contact.
//!
//! Signs at a contact of i and j: n points from i to j; opening is positive; a shear displacement is that of j's
//! surface relative to i's; loads act on i (and with the opposite sign on j).

use super::engine::Engine;
use super::error::Failure;
use super::simd::{Lane, Quad};
use std::fmt::Debug;

mod plane;
mod solid;

pub use plane::D2;
pub use solid::D3;

/// A few numbers of one kind: a vector, a spin, a shear force.
pub trait Tuple<L: Lane>: Copy {
    /// How many.
    const LENGTH: usize;
    /// All zero.
    fn zero() -> Self;
    /// Sum.
    fn plus(self, other: Self) -> Self;
    /// Difference.
    fn minus(self, other: Self) -> Self;
    /// Multiple.
    fn times(self, factor: L) -> Self;
    /// Inner product.
    fn dot(self, other: Self) -> L;
    /// Euclidean length.
    fn norm(self) -> L;
    /// Component `k`.
    fn at(self, k: usize) -> L;
    /// From a function of the component.
    fn build(f: impl FnMut(usize) -> L) -> Self;
}

// Plain loops: closures handed to the array functions are not always inlined, and then run without the wide registers.
impl<L: Lane, const N: usize> Tuple<L> for [L; N] {
    const LENGTH: usize = N;
    #[inline(always)]
    fn zero() -> Self {
        [L::splat(0.0); N]
    }
    #[inline(always)]
    fn plus(mut self, other: Self) -> Self {
        for k in 0..N {
            self[k] = self[k] + other[k];
        }
        self
    }
    #[inline(always)]
    fn minus(mut self, other: Self) -> Self {
        for k in 0..N {
            self[k] = self[k] - other[k];
        }
        self
    }
    #[inline(always)]
    fn times(mut self, factor: L) -> Self {
        for x in &mut self {
            *x = *x * factor;
        }
        self
    }
    #[inline(always)]
    fn dot(self, other: Self) -> L {
        let mut sum = self[0] * other[0];
        for k in 1..N {
            sum = sum + self[k] * other[k];
        }
        sum
    }
    #[inline(always)]
    fn norm(self) -> L {
        if N == 1 { self[0].abs() } else { self.dot(self).sqrt() }
    }
    #[inline(always)]
    fn at(self, k: usize) -> L {
        self[k]
    }
    #[inline(always)]
    fn build(mut f: impl FnMut(usize) -> L) -> Self {
        let mut tuple = Self::zero();
        for (k, x) in tuple.iter_mut().enumerate() {
            *x = f(k);
        }
        tuple
    }
}

/// Kinematics of one end of a contact.
#[derive(Clone, Copy, Debug)]
pub struct End<S: Space, L: Lane> {
    /// Centre, m.
    pub position: S::Vector<L>,
    /// Radius, m.
    pub radius: L,
    /// Velocity, m/s.
    pub velocity: S::Vector<L>,
    /// Spin, rad/s.
    pub spin: S::Spin<L>,
}

/// Geometry of a touch: what the laws see of the two bodies.
#[derive(Clone, Copy, Debug)]
pub struct Touch<S: Space, L: Lane> {
    /// Unit vector from i to j (or to the wall).
    pub normal: S::Vector<L>,
    /// Distance of the surfaces, negative in overlap, m.
    pub gap: L,
    /// Distance from the centre of i to the contact point, m.
    pub arm_i: L,
    /// The same for j; zero at a wall.
    pub arm_j: L,
    /// The smaller radius, m.
    pub radius: L,
    /// Opening in this step, m: along the mean of the old and new normals, so that a rotation opens nothing.
    pub opening: L,
    /// Shear displacement in this step, m.
    pub slide: S::Shear<L>,
    /// Relative twist (about the normal) in this step, rad; zero in the plane.
    pub twist: L,
    /// Relative bending rotation in this step, rad.
    pub bend: S::Shear<L>,
    /// Mean of the normals before and after this step, to second order; along it vectors are laid into the new plane.
    pub tilt: S::Vector<L>,
    /// Rotation of the contact frame about the normal in this step, rad.
    pub roll: L,
}

impl<S: Space> Touch<S, f64> {
    /// A touch without motion, for reading forces.
    pub(crate) fn still(normal: Vector<S>, gap: f64) -> Self {
        let flat = S::Shear::<f64>::zero();
        let (arm_i, arm_j, radius) = (0.0, 0.0, 0.0);
        let (opening, twist, roll) = (0.0, 0.0, 0.0);
        Self { normal, gap, arm_i, arm_j, radius, opening, slide: flat, twist, bend: flat, tilt: normal, roll }
    }
}

/// What a contact does to its ends: tension positive along the normal of i.
#[derive(Clone, Copy, Debug)]
pub struct Load<S: Space, L: Lane> {
    /// Normal force, tension positive, N.
    pub normal: L,
    /// Shear force on i, N.
    pub shear: S::Shear<L>,
    /// Twisting moment on i, N·m.
    pub twist: L,
    /// Bending moment on i, N·m.
    pub bend: S::Shear<L>,
}

/// Plane or solid.
pub trait Space: Copy + Debug + Default + PartialEq + Send + Sync + 'static {
    /// Name in messages.
    const NAME: &'static str;
    /// Number of coordinates.
    const DIMENSION: usize;
    /// Rows of a kinematic record: position and radius, velocity (and spin).
    const RECORD: usize;
    /// Rows of a load record: force (and moment).
    const LOADS: usize;
    /// Numbers in a shear force.
    const SHEAR: usize;
    /// I / (A R²) of a bond's section: 1/3 for a strip, 1/4 for a disc.
    const GYRATION: f64;
    /// A vector.
    type Vector<L: Lane>: Tuple<L> + Debug + Send + Sync;
    /// A rotation rate or moment.
    type Spin<L: Lane>: Tuple<L> + Debug + Send + Sync;
    /// How a rigid body is turned against its first frame.
    type Turn: Copy + Debug + PartialEq + Send + Sync;
    /// A vector in the contact plane.
    type Shear<L: Lane>: Tuple<L> + Debug + Send + Sync;

    /// Makes `steps` steps of an engine. Each space names its own loop: so the loop is compiled here, in large units, and not
    /// in small ones in every crate that runs an engine of either space.
    ///
    /// # Errors
    /// Why the run failed.
    fn advance(engine: &mut Engine<Self>, steps: u64) -> Result<(), Failure>;

    /// Area (plane) or volume (solid) of a ball, m² or m³.
    fn volume(radius: f64) -> f64;
    /// Moment of inertia of a ball, kg·m².
    fn inertia(mass: f64, radius: f64) -> f64;
    /// Section of a beam of half width `radius`, m².
    fn section(radius: f64) -> f64;
    /// Reads the records of some ends.
    fn ends<L: Lane>(table: &[Quad], ends: &[u32]) -> End<Self, L>;
    /// Geometry and relative motion at a contact with unit normal `normal`, given both arms and 1/distance (0 at a
    /// wall, whose normal does not turn).
    fn touch<L: Lane>(
        i: &End<Self, L>,
        j: &End<Self, L>,
        normal: Self::Vector<L>,
        gap: L,
        arms: [L; 2],
        inverse_distance: L,
        dt: L,
    ) -> Touch<Self, L>;
    /// A shear vector of the last step in the contact frame of this one.
    fn turned<L: Lane>(shear: Self::Shear<L>, touch: &Touch<Self, L>) -> Self::Shear<L>;
    /// The shear vector shortened to `limit`.
    fn limited<L: Lane>(shear: Self::Shear<L>, limit: L) -> Self::Shear<L>;
    /// Adds the load to i, at a wall.
    fn push_one<L: Lane>(loads: &mut [Quad], ends: &[u32], touch: &Touch<Self, L>, load: &Load<Self, L>);
    /// Adds the load to i and the reaction to j, contact by contact.
    fn push_both<L: Lane>(loads: &mut [Quad], ends: [&[u32]; 2], touch: &Touch<Self, L>, load: &Load<Self, L>);
    /// Force on i as a vector.
    fn force<L: Lane>(touch: &Touch<Self, L>, load: &Load<Self, L>) -> Self::Vector<L>;
    /// Components of a vector of the contact plane along the frame t₁, t₂ = n × t₁; the second is 0 in the plane, where t₁
    /// is the tangent of the contact and `frame` is not used.
    fn flat<L: Lane>(vector: Self::Shear<L>, frame: Self::Shear<L>, normal: Self::Vector<L>) -> [L; 2];
    /// The vector of the contact plane with these components.
    fn raised<L: Lane>(flat: [L; 2], frame: Self::Shear<L>, normal: Self::Vector<L>) -> Self::Shear<L>;
    /// Slope of the face of j against that of i, along t₁ and t₂, that a relative bending rotation makes.
    fn slope<L: Lane>(bend: Self::Shear<L>, frame: Self::Shear<L>, normal: Self::Vector<L>) -> [L; 2];
    /// A vector of the contact plane in its own components.
    fn across<L: Lane>(vector: Self::Vector<L>, normal: Self::Vector<L>) -> Self::Shear<L>;
    /// Bending moment on i of normal forces (tension positive) with the first moments ∑ r f along t₁ and t₂.
    fn bend<L: Lane>(moments: [L; 2], frame: Self::Shear<L>, normal: Self::Vector<L>) -> Self::Shear<L>;
    /// Moment of the bond on i as a spin-like quantity.
    fn bond_moment<L: Lane>(touch: &Touch<Self, L>, load: &Load<Self, L>) -> Self::Spin<L>;
    /// a × b as a moment.
    fn moment<L: Lane>(arm: Self::Vector<L>, force: Self::Vector<L>) -> Self::Spin<L>;
    /// Velocity ω × r of a point at `arm`.
    fn carried<L: Lane>(spin: Self::Spin<L>, arm: Self::Vector<L>) -> Self::Vector<L>;

    /// Not turned.
    fn upright() -> Self::Turn;
    /// The turn after a further rotation vector (rad, fixed frame), kept orthonormal.
    fn turn_on(turn: Self::Turn, rotation: Spin<Self>) -> Self::Turn;
    /// A vector of the body's frame in the fixed frame.
    fn outward(turn: Self::Turn, vector: Vector<Self>) -> Vector<Self>;
    /// A spin or moment of the fixed frame in the body's frame.
    fn inward(turn: Self::Turn, spin: Spin<Self>) -> Spin<Self>;
    /// A spin or moment of the body's frame in the fixed frame.
    fn outward_spin(turn: Self::Turn, spin: Spin<Self>) -> Spin<Self>;
    /// Spin of a body from its angular momentum; `inverse` is the inverse inertia in the body's frame.
    fn spin_of(turn: Self::Turn, inverse: &[[f64; 3]; 3], momentum: Spin<Self>) -> Spin<Self>;
    /// Angular momentum of a body whose frame is the fixed one.
    fn momentum_of(inertia: &[[f64; 3]; 3], spin: Spin<Self>) -> Spin<Self>;
    /// An inertia of the body's frame in the fixed frame.
    fn turned_inertia(turn: Self::Turn, inertia: &[[f64; 3]; 3]) -> [[f64; 3]; 3];
    /// Inverse of an inertia; nothing if it is not positive definite.
    fn inverse_inertia(inertia: &[[f64; 3]; 3]) -> Option<[[f64; 3]; 3]>;
}

/// Vector of numbers.
pub type Vector<S> = <S as Space>::Vector<f64>;
/// Spin or moment of numbers.
pub type Spin<S> = <S as Space>::Spin<f64>;

/// Three coordinates, the third 0 in the plane.
pub(crate) fn flat<S: Space>(x: Vector<S>) -> [f64; 3] {
    std::array::from_fn(|k| if k < S::DIMENSION { x.at(k) } else { 0.0 })
}
