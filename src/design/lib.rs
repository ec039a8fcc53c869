//! Designs of experiments: from factors to a table of runs, and reports on such tables.
//!
//! Every file is one design; its head cites who published the construction and for which sizes. A size for which none
//! is published is refused with the nearest one that is. Coded values run from −1 to +1 over a factor's range
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
pub use table::{DesignTable, Layout, Order, PointType, Points, Position};

use math::random::Stream;
use serde::{Deserialize, Serialize};

/// A way to lay out runs.
pub trait Design {
    /// The name by which a workflow asks for it.
    const NAME: &'static str;

    /// The runs for these factors in standard order. The factors were checked; `stream` is for designs that draw.
    ///
    /// # Errors
    /// Everything that is wrong: sizes for which no construction is published, options without meaning.
    fn points(&self, factors: &[Factor], stream: &mut Stream) -> Result<Points, Vec<Fault>>;

    /// The errors of [`Design::points`], for designs that would take long to find them.
    fn faults(&self, factors: &[Factor]) -> Vec<Fault> {
        self.points(factors, &mut Stream::new(0, "design", 0)).err().unwrap_or_default()
    }

    /// Runs of a design without faults, and how many more at its centre; for designs whose points take long.
    fn size(&self, factors: &[Factor]) -> (usize, usize) {
        let points = self.points(factors, &mut Stream::new(0, "design", 0));
        points.map_or((0, 0), |points| (points.rows.len(), points.centre))
    }

    /// Whether the points depend on the stream.
    fn draws(&self) -> bool {
        false
    }
}

fn is_default<T: Default + PartialEq>(value: &T) -> bool {
    *value == T::default()
}

/// The list of designs: one line each gives the variant, its name and its dispatch.
macro_rules! methods {
    ($($(#[$doc:meta])* $name:ident($module:ident),)*) => {
        /// A design with its options.
        #[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
        #[serde(tag = "method", rename_all = "kebab-case")]
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

            /// Whether its points depend on the seed.
            pub fn draws(&self) -> bool {
                match self { $(Self::$name(design) => design.draws(),)* }
            }

            fn faults(&self, factors: &[Factor]) -> Vec<Fault> {
                match self { $(Self::$name(design) => design.faults(factors),)* }
            }

            fn size(&self, factors: &[Factor]) -> (usize, usize) {
                match self { $(Self::$name(design) => design.size(factors),)* }
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

/// Builds the table of a design. The same factors, options and seed give the same bits; the seed matters only for
/// designs that draw and for [`Order::Random`], and the random order is drawn apart from the points.
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

/// Everything that [`build`] would find wrong, without building what takes long.
pub fn check(method: &Method, factors: &[Factor], layout: Layout) -> Vec<Fault> {
    let mut faults = coding::check(factors);
    if faults.is_empty() {
        faults = method.faults(factors);
    }
    let (rows, centre) = if faults.is_empty() { method.size(factors) } else { (0, 0) };
    faults.extend(layout.fault(rows, centre));
    faults
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::table::MOST_RUNS;

    /// The name in a task text is the name in a workflow.
    #[test]
    fn names_are_the_tags() {
        let position = latin_hypercube::Position::Centre;
        let criterion = latin_hypercube::Criterion::Maximin;
        let all = [
            Method::FullFactorial(Default::default()),
            Method::FractionalFactorial(Default::default()),
            Method::Orthogonal(Default::default()),
            Method::PlackettBurman(Default::default()),
            Method::CentralComposite(Default::default()),
            Method::BoxBehnken(Default::default()),
            Method::LatinHypercube(latin_hypercube::LatinHypercube { runs: 2, criterion, position }),
            Method::Sobol(sobol::Sobol { runs: 2, scramble: true, skip: 0 }),
            Method::Given(Default::default()),
        ];
        assert_eq!(all.each_ref().map(Method::name), Method::NAMES);
        for method in all {
            let value = serde_json::to_value(&method).unwrap();
            assert_eq!(value["method"], method.name());
            assert_eq!(serde_json::from_value::<Method>(value).unwrap(), method);
        }
    }

    #[test]
    fn options_at_their_default_are_not_written() {
        let text = |m: Method| serde_json::to_string(&m).unwrap();
        assert_eq!(text(Method::Orthogonal(Default::default())), r#"{"method":"orthogonal"}"#);
        assert_eq!(text(Method::CentralComposite(Default::default())), r#"{"method":"central-composite"}"#);
        assert_eq!(text(Method::PlackettBurman(Default::default())), r#"{"method":"plackett-burman"}"#);
        let sobol = sobol::Sobol { runs: 8, scramble: true, skip: 0 };
        assert_eq!(text(Method::Sobol(sobol)), r#"{"method":"sobol","runs":8}"#);
    }

    #[test]
    fn random_order_is_a_permutation_by_the_seed_and_replicates_repeat() {
        let factors = [Factor::range("a", "", 0.0, 1.0), Factor::range("b", "", 0.0, 1.0)];
        let layout = Layout { replicates: 3, order: Order::Random };
        let table = |seed| build(&Method::FullFactorial(Default::default()), &factors, layout, seed).unwrap();
        let t = table(1);
        let mut order = t.standard_order.clone();
        order.sort_unstable();
        assert_eq!(order, (1..=12).collect::<Vec<_>>());
        assert_ne!(t.standard_order, order);
        assert_ne!(t.standard_order, table(2).standard_order);
        assert_eq!(t.replicate().iter().filter(|r| **r == 3).count(), 4);
        let none = Layout { replicates: 0, order: Order::Standard };
        let error = build(&Method::FullFactorial(Default::default()), &factors, none, 1).unwrap_err();
        assert!(error.to_string().contains("`replicates` is 0"));
    }

    /// The count of a file is judged, with the number of runs that it would be, before room is made for it.
    #[test]
    fn counts_beyond_all_tables_are_refused_before_they_take_memory() {
        let factors = ["a", "b", "c"].map(|name| Factor::range(name, "", 0.0, 1.0));
        let once = Layout::default();
        for count in [MOST_RUNS, 1 << 32, usize::MAX] {
            let all = [
                Method::FullFactorial(factorial::FullFactorial { centre_points: count }),
                Method::FractionalFactorial(fractional::FractionalFactorial {
                    resolution: Some(3),
                    centre_points: count,
                    ..Default::default()
                }),
                Method::PlackettBurman(plackett_burman::PlackettBurman { centre_points: count, ..Default::default() }),
                Method::CentralComposite(central_composite::CentralComposite {
                    centre_points: Some(count),
                    ..Default::default()
                }),
                Method::BoxBehnken(box_behnken::BoxBehnken { centre_points: Some(count) }),
            ];
            for method in all {
                let found = check(&method, &factors, once);
                assert!(
                    found.iter().any(|fault| fault
                        .to_string()
                        .starts_with(&format!("`centre_points` is {count}; the table would have "))),
                    "{found:?}"
                );
                assert_eq!(build(&method, &factors, once, 1).unwrap_err().to_string(), found[0].to_string());
                let many = Layout { replicates: count, ..once };
                assert!(!check(&Method::FullFactorial(Default::default()), &factors, many).is_empty());
            }
        }
        let most = Method::BoxBehnken(box_behnken::BoxBehnken { centre_points: Some(MOST_RUNS - 12) });
        assert_eq!(check(&most, &factors, once), []);
    }
}
