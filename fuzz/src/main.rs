//! One reader, fed by libFuzzer: `FUMAROLE_FUZZ_TARGET` names it. `run.sh` builds and runs it.
#![no_main]
// The readers of the window's files are built into the replay of the corpora alone.
#![allow(unexpected_cfgs)]

use std::sync::OnceLock;

mod targets;

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    static TARGET: OnceLock<targets::Target> = OnceLock::new();
    let target = TARGET.get_or_init(|| {
        let name = std::env::var("FUMAROLE_FUZZ_TARGET").unwrap_or_default();
        let found = targets::ALL.iter().find(|(known, _)| *known == name);
        found.expect("FUMAROLE_FUZZ_TARGET names a folder of fuzz/corpus").1
    });
    target(data);
});
