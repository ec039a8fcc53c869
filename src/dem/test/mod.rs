//! Loading tests: a specimen, a material and a machine in; curves, cracks and macroscopic quantities out.
//!
//! * [`material`]: microparameters by contact group; [`rig`]: the specimen mounted with bonds in, free of force
//! * [`loading`]: the loop all tests share; [`snapshot`]: states at shares of the peak
//! * [`gauge`]: lateral strain; [`curve`]: strength, moduli, Poisson's ratio by name
//! * [`uniaxial`]: the tests

pub mod curve;
pub mod gauge;
pub mod loading;
pub mod material;
pub mod rig;
pub mod snapshot;
pub mod uniaxial;
