//! Lanes: the number type over which every law is written once.
//!
//! A contact block holds eight contacts; a lane type takes one, four or eight of them at a time. Only addition,
//! subtraction, multiplication, division, square root, comparison and selection are used, each correctly rounded, and
//! never a fused multiply-add, so one contact gives the same bits in every lane type and on every machine.

mod lane;

pub use lane::{Lane, Quad, Row, WIDEST};
