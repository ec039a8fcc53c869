//! Loading tests: a specimen, a material and a machine in; curves, cracks and macroscopic quantities out.
//!
//! * [`material`]: microparameters by contact group; [`rig`]: the specimen mounted with bonds in, free of force
//! * [`loading`]: settings and the loop all tests share; [`crack`], [`snapshot`]: what is noted on the way
//! * [`gauge`]: lateral strain; [`curve`]: strength, moduli, Poisson's ratio by name; [`judgement`]: is it quasi-static
//! * [`uniaxial`], [`brazilian`], [`tension`]: the tests

pub mod brazilian;
pub mod crack;
pub mod curve;
pub mod gauge;
pub mod judgement;
pub mod loading;
pub mod material;
pub mod rig;
pub mod snapshot;
pub mod tension;
pub mod uniaxial;

#[cfg(test)]
mod tests;
