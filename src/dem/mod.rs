//! Engine.
pub mod genesis;
