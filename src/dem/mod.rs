//! Engine.
pub mod genesis;
pub mod test;
