#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| flexlink_fuzz::quantity(bytes));
