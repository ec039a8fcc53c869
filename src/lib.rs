//! `flow` runs a numerical-experiment campaign with bonded-particle models that is written down as one TOML file.

pub mod artifact;
pub mod cli;
pub mod dem;
pub mod design;
pub mod exec;
pub mod figure;
pub mod math;
pub mod optim;
pub mod plan;
pub mod run;
pub mod stage;
pub mod stats;
pub mod store;
pub mod unit;
