//! Replays the corpora of the fuzz targets: every reader, on every input that once told something new, and on changed ones.
//! `FUMAROLE_TEST_MUTATIONS=100000` draws so many of each target, `FUMAROLE_TEST_SEED` others.

#[path = "../../fuzz/src/targets.rs"]
mod targets;

use std::env;
use std::fs;
use std::panic::{self, AssertUnwindSafe};
use std::path::Path;
use std::time::Instant;

use rand_pcg::Pcg32;
use rand_pcg::rand_core::Rng;

const CORPUS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/fuzz/corpus");
/// Changed inputs of each target.
const MUTATIONS: u32 = 40;
/// Longest that a reader may take, on a busy machine.
const LONGEST_S: f64 = 10.0;
/// As of `fuzz/run.sh`.
const LONGEST: usize = 65_536;

/// The inputs of a target, by their names.
fn inputs(target: &str) -> Vec<Vec<u8>> {
    let mut paths: Vec<_> =
        fs::read_dir(Path::new(CORPUS).join(target)).unwrap().map(|entry| entry.unwrap().path()).collect();
    assert!(!paths.is_empty(), "{target}");
    paths.sort();
    paths.iter().map(|path| fs::read(path).unwrap()).collect()
}

/// Reads the input; one that fails is left as a file that the test names.
fn read(name: &str, target: targets::Target, input: &[u8]) {
    let started = Instant::now();
    let ended = panic::catch_unwind(AssertUnwindSafe(|| target(input)));
    let took_s = started.elapsed().as_secs_f64();
    if ended.is_err() || took_s >= LONGEST_S {
        let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("failing-{name}"));
        fs::write(&path, input).unwrap();
        panic!("{name}: {took_s:.1} s, {}: {}", if ended.is_err() { "panicked" } else { "too long" }, path.display());
    }
}

#[test]
fn every_input_of_every_corpus_ends_well() {
    let folders: Vec<String> =
        fs::read_dir(CORPUS).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    assert_eq!(folders.len(), targets::ALL.len(), "a corpus for every target: {folders:?}");
    for (name, target) in targets::ALL {
        inputs(name).iter().for_each(|input| read(name, target, input));
    }
}

#[test]
fn changed_inputs_end_well() {
    let number = |name: &str| env::var(name).ok().and_then(|text| text.parse().ok());
    let count = number("FUMAROLE_TEST_MUTATIONS").unwrap_or(MUTATIONS);
    let seed = number("FUMAROLE_TEST_SEED").unwrap_or(1);
    for (index, (name, target)) in (0..).zip(targets::ALL) {
        let inputs = inputs(name);
        let mut random = Pcg32::new(seed.into(), index);
        for _ in 0..count {
            read(name, target, &changed(&inputs, &mut random));
        }
    }
}

/// Numbers that readers may not expect, as text.
const NUMBERS: [&str; 12] =
    ["0", "-1", "1", "65536", "2147483648", "4294967295", "18446744073709551616", "1e308", "-1e-320", "nan", "inf", ""];
/// As bytes.
const WORDS: [u32; 8] = [0, 1, 0x7f, 0xff, 0x7fff_ffff, 0x8000_0000, 0xffff_ffff, 0x0001_0000];

/// One of the inputs, changed in a few places.
fn changed(inputs: &[Vec<u8>], random: &mut Pcg32) -> Vec<u8> {
    let mut input = inputs[below(random, inputs.len())].clone();
    for _ in 0..=below(random, 6) {
        let at = below(random, input.len() + 1);
        let end = (at + below(random, 16)).min(input.len());
        match below(random, 9) {
            0 if at < input.len() => input[at] ^= 1 << below(random, 8),
            1 if at < input.len() => input[at] = random.next_u32() as u8,
            2 => input.truncate(at),
            3 => drop(input.drain(at..end)),
            4 => {
                let piece = input[at..end].to_vec();
                let to = below(random, input.len() + 1);
                input.splice(to..to, piece);
            }
            5 => {
                let other = &inputs[below(random, inputs.len())];
                let from = below(random, other.len() + 1);
                input.truncate(at);
                input.extend(&other[from..]);
            }
            6 => {
                let word = WORDS[below(random, WORDS.len())];
                let bytes = if random.next_u32().is_multiple_of(2) { word.to_le_bytes() } else { word.to_be_bytes() };
                input.iter_mut().skip(at).zip(bytes).for_each(|(byte, new)| *byte = new);
            }
            _ => with_number(&mut input, at, NUMBERS[below(random, NUMBERS.len())]),
        }
    }
    input.truncate(LONGEST);
    input
}

/// Puts another number in place of the next one that is text.
fn with_number(input: &mut Vec<u8>, at: usize, number: &str) {
    let Some(start) = input[at..].iter().position(u8::is_ascii_digit).map(|offset| at + offset) else { return };
    let is_of_number = |byte: &u8| byte.is_ascii_digit() || b"+-.eE".contains(byte);
    let length = input[start..].iter().take_while(|byte| is_of_number(byte)).count();
    input.splice(start..start + length, number.bytes());
}

fn below(random: &mut Pcg32, end: usize) -> usize {
    random.next_u32() as usize % end
}
