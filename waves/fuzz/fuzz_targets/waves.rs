//! Reads arbitrary bytes as a VCD or an FST: this must give an error or a result, and a file must never differ from
//! itself.
#![no_main]

use std::io::Write;

use libfuzzer_sys::fuzz_target;
use wavecmp::diff::{self, DiffOptions, DiffVerdict, Reset};

fuzz_target!(|content: &[u8]| {
    let mut file = tempfile::NamedTempFile::new().expect("a temporary file");
    file.write_all(content).expect("room for it");
    for raw in [false, true] {
        let options = DiffOptions {
            raw,
            reset: Reset::Found,
            glitch_fs: u128::from(raw) * 1_000_000,
            ..DiffOptions::default()
        };
        if let Ok(result) = diff::compare(file.path(), file.path(), &options, &mut |_| {}) {
            assert_ne!(result.result, DiffVerdict::Different, "a file differs from itself: {result}");
        }
    }
});
