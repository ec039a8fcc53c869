//! `flow` runs a numerical-experiment campaign with bonded-particle models that is written down as one TOML file.

pub mod dem;
pub mod math;
