//! Memos of a store.

#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| flow::store::hostile::memo(bytes));
