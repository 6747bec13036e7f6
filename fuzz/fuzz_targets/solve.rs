#![no_main]

libfuzzer_sys::fuzz_target!(
    init: {
        // One thread, so that an input is the same work every time.
        let pool = rayon::ThreadPoolBuilder::new().num_threads(1).use_current_thread();
        pool.build_global().expect("the first pool");
    },
    |bytes: &[u8]| flexlink_fuzz::solve(bytes)
);
