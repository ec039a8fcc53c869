//! Designs of experiments: from factors to a table of runs, and what such a table can tell.
//!
//! Every file is one design; its head cites who published the construction and for which sizes. A size for which none is
//! published is refused with the nearest one that is. Coded values run from −1 to +1 over a factor's range
//! ([`coding`]); standard order is that of the construction. [`report()`] judges any table by its rows alone.

pub mod box_behnken;
pub mod central_composite;
pub mod coding;
pub mod error;
pub mod factorial;
pub mod fractional;
mod galois;
pub mod given;
mod hadamard;
pub mod latin_hypercube;
pub mod orthogonal;
pub mod plackett_burman;
pub mod report;
pub mod sobol;
pub mod table;

pub use coding::{Domain, Factor};
pub use error::{DesignError, Fault};
pub use report::{Report, report};
pub use table::{DesignTable, Layout, Order, Place, PointType, Points};

use crate::math::random::Stream;

/// A way to lay out runs.
pub trait Design {
    /// The name by which a workflow asks for it.
    const NAME: &'static str;

    /// The runs for these factors in standard order. The factors were checked; `stream` is for designs that draw.
    ///
    /// # Errors
    /// Everything that is wrong: sizes for which no construction is published, options without meaning.
    fn points(&self, factors: &[Factor], stream: &mut Stream) -> Result<Points, Vec<Fault>>;
}

/// The list of designs: one line each gives the variant, its name and its dispatch.
macro_rules! methods {
    ($($(#[$doc:meta])* $name:ident($module:ident),)*) => {
        /// A design with its options.
        #[derive(Clone, Debug, PartialEq)]
        pub enum Method {
            $($(#[$doc])* $name($module::$name),)*
        }

        impl Method {
            /// The names a workflow may ask for.
            pub const NAMES: &[&str] = &[$(<$module::$name as Design>::NAME),*];

            /// The name of this one.
            pub fn name(&self) -> &'static str {
                match self { $(Self::$name(_) => <$module::$name as Design>::NAME,)* }
            }

            fn points(&self, factors: &[Factor], stream: &mut Stream) -> Result<Points, Vec<Fault>> {
                match self { $(Self::$name(design) => design.points(factors, stream),)* }
            }
        }
    };
}

methods! {
    /// Every combination of levels.
    FullFactorial(factorial),
    /// A regular fraction of the two-level factorial.
    FractionalFactorial(fractional),
    /// Tables of finite geometry and difference schemes.
    Orthogonal(orthogonal),
    /// Two-level screening in multiples of four runs.
    PlackettBurman(plackett_burman),
    /// Cube, axial and centre points.
    CentralComposite(central_composite),
    /// Edge midpoints and centre points.
    BoxBehnken(box_behnken),
    /// A stratified sample.
    LatinHypercube(latin_hypercube),
    /// A low-discrepancy sample.
    Sobol(sobol),
    /// Rows that are given.
    Given(given),
}

/// Builds the table of a design. The same factors, options and seed give the same bits; the seed matters only for designs that
/// draw and for [`Order::Random`], and the random order is drawn apart from the points.
///
/// # Errors
/// All faults of the factors, or else all faults of the design's options and size.
pub fn build(method: &Method, factors: &[Factor], layout: Layout, seed: u64) -> Result<DesignTable, DesignError> {
    let faults = coding::check(factors);
    if !faults.is_empty() {
        return Err(faults.into());
    }
    let points = method.points(factors, &mut Stream::new(seed, "design", 0))?;
    Ok(DesignTable::lay_out(factors, &points, layout, &mut Stream::new(seed, "design order", 0))?)
}
