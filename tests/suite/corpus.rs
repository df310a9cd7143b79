//! Replays the corpora of the fuzz targets: every reader, on every input that once told something new.

#[path = "../../fuzz/src/targets.rs"]
mod targets;

use std::fs;
use std::path::Path;

#[test]
fn every_input_of_every_corpus_ends_well() {
    let corpus = Path::new(env!("CARGO_MANIFEST_DIR")).join("fuzz/corpus");
    let folders: Vec<String> =
        fs::read_dir(&corpus).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    assert_eq!(folders.len(), targets::ALL.len(), "a corpus for every target: {folders:?}");
    for (name, target) in targets::ALL {
        let inputs: Vec<_> = fs::read_dir(corpus.join(name)).unwrap().map(|entry| entry.unwrap().path()).collect();
        assert!(!inputs.is_empty(), "{name}");
        for input in inputs {
            let started = std::time::Instant::now();
            // The harness tells which test panicked, not on which input.
            println!("{}", input.display());
            target(&fs::read(&input).unwrap());
            assert!(started.elapsed().as_secs_f64() < 10.0, "{}: {:?}", input.display(), started.elapsed());
        }
    }
}
