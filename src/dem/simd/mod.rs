//! Lanes: the number type over which every law is written once; and threads that share one table of records.
//!
//! A contact block holds eight contacts; a lane type takes one, four or eight of them at a time. Only addition,
//! subtraction, multiplication, division, square root, comparison and selection are used, each correctly rounded, and
//! never a fused multiply-add, so one contact gives the same bits in every lane type and on every machine.
//!
//! This is the only module with `unsafe`. Its invariants:
//! * `Four` and `Eight` are reachable only through [`dispatch`], which asks the processor first; so no instruction is run
//!   that the machine lacks.
//! * Lane memory access goes through references to whole rows ([`Quad`], [`Row`]): in bounds and aligned by their types.
//! * `exchange`: between two meetings every thread reads one buffer and writes its own range of the other, and the
//!   ranges are disjoint; a thread passes a meeting only after all have come, with no borrow left (`meet` takes `&mut`).
#![allow(unsafe_code)]

#[cfg(target_arch = "x86_64")]
mod eight;
mod exchange;
#[cfg(target_arch = "x86_64")]
mod four;
mod lane;
mod table;
mod width;

pub(crate) use exchange::{Board, Rows, Same, Update, exchange};
pub use lane::{Lane, Quad, Row, WIDEST};
pub(crate) use table::{Table, prefetch, prefetch_rows};
pub use width::Width;
pub(crate) use width::{Kernel, dispatch};
