//! Units.

#![no_main]

#[allow(dead_code)]
#[path = "../../tests/workflows/properties.rs"]
mod properties;

libfuzzer_sys::fuzz_target!(|text: &str| properties::unit(text));
