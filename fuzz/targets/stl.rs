//! Surfaces.

#![no_main]

#[allow(dead_code)]
#[path = "../../tests/workflows/properties.rs"]
mod properties;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| properties::surface(bytes));
