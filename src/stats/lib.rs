//! Statistics of designed experiments: what matters, how much, and how sure one may be.
//!
//! Everything here is pure: a [`sample::Sample`] and settings in, results out. Terms of the trade are used as in the
//! books the files cite.
//!
//! * [`sample`]: the table: factors, responses, weights, missing rows
//! * [`range`]: mean per level, range and rank of each factor
//! * [`anova`]: sums of squares of factors and interactions, F, p, contribution
//! * [`regression`]: polynomial models in natural and coded units, with [`terms`], [`selection`] and [`diagnostics`]
//! * [`model`]: a fitted polynomial: prediction, intervals, domain
//! * [`categories`]: factors whose levels are names, as dummy terms of a regression
//! * [`groups`]: rows by equal values of columns: one fit per group, and pivot tables
//! * [`summary`]: quartiles, whiskers and bins of plain values
//! * [`band`]: mean and scatter of many curves
//! * [`envelope`]: strength of rock over the confining stress, by Mohr–Coulomb and Hoek–Brown
//! * [`agreement`]: how well two sets of values agree: ratios, ranks
//! * [`canonical`]: stationary point of a second-order surface, its nature and axes, path of steepest ascent
//! * [`screening`]: effects of an unreplicated two-level design, Lenth's limits
//!
//! All fits go through one orthogonal reduction (`triangle`), small ones in pairs of doubles (`number`).

pub mod agreement;
pub mod anova;
pub mod band;
pub mod canonical;
pub mod categories;
pub mod diagnostics;
pub mod envelope;
pub mod error;
pub mod fit;
pub mod groups;
pub mod model;
pub mod range;
pub mod regression;
pub mod sample;
pub mod screening;
pub mod selection;
pub mod summary;
pub mod terms;

mod columns;
mod number;
mod triangle;
