//! Small numerical pieces that every domain crate may use; they import no other crate of flow.
//!
//! * [`random`]: seeded streams whose values never change between versions, hosts or thread counts
//! * [`elementary`]: `exp`, `sin`, `pow` … with one implementation everywhere, so that results keep their bits
//! * [`distribution`]: tails and quantiles of F, t and the normal distribution
//! * [`occurrence`]: which of equal rows each row is
//! * [`sample`]: mean, standard deviation and interval of the mean of a sample
//! * [`scale`]: whether a range is divided by differences or by ratios
//! * [`text`]: numbers as people and programs read them back

pub mod distribution;
pub mod elementary;
pub mod occurrence;
pub mod random;
pub mod sample;
pub mod scale;
pub mod text;
