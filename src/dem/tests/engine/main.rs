//! The engine against closed forms, invariances and itself.
//!
//! Each family of cases computes rows (what, source, expected, got, allowed); a test per family checks them, and the
//! page `VALIDATION.md` beside this file lists them all. `cargo test --test engine -- --ignored write` writes the page
//! anew; a test keeps it in step with what is computed.
#![allow(clippy::unwrap_used)]
// Loops over axes read better with their index.
#![allow(clippy::needless_range_loop)]

mod balance;
mod beam;
mod bending;
mod bits;
mod block;
mod bond;
mod case;
mod changes;
mod clump;
mod confined;
mod curve;
mod disc;
mod energy;
mod faults;
mod flat_joint;
mod friction;
mod genesis;
mod impact;
mod incremental;
mod invariance;
mod lattice;
mod limit;
mod measuring;
mod memory;
mod moduli;
mod packing;
mod page;
mod periodic;
mod piece;
mod platens;
mod rest;
mod scaling;
mod smooth_joint;
mod split;
mod step;
mod stiffness;
mod strength;
mod turned;
mod twin;
