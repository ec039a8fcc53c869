//! `flow` runs a numerical-experiment campaign with bonded-particle models that is written down as one TOML file.

pub mod artifact;
pub mod design;
pub mod math;
pub mod stage;
pub mod unit;
