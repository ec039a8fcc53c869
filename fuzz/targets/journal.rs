//! Journals of a store.

#![no_main]

use flow::store::hostile::Journal;

thread_local! {
    static JOURNAL: Journal = Journal::default();
}

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| JOURNAL.with(|journal| journal.read(bytes)));
