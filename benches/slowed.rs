//! Verdicts on a device: a shader that is 10 % slower through `--shader-dir` must be named by its pass and no other pass, and
//! equal sides must be found neither faster nor slower. Both by `fumarole ab`, in fresh processes.
//!
//! `cargo bench --bench slowed -- PAIRS BLOCKS`: pairs of equal sides (20 without a number), blocks A B B A in each at most
//! (20). Fails where the pass is not named, or more than 3 of 20 pairs have a false verdict; it ends as soon as no further
//! pair could change that. On an idle machine: it takes about three quarters of an hour on lavapipe with 2 cores.

use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use fumarole::measure::compare::{Clock, Comparison, Verdict};
use fumarole::measure::statistics::median;
use fumarole::report::json;

const PROGRAM: &str = env!("CARGO_BIN_EXE_fumarole");
/// Of this scene a process takes about a second, the pass has most of a frame, and its long rays scatter little.
const SCENE: &str =
    "terrain --variant gpu-compute --size 160x120 --warmup 2 --frames 20 --repeat 1 --no-limits --seed 1";
const SHADER: &str = "terrain/depth.comp";
const PASS: &str = "depth";
const SLOWER: f64 = 0.10;

type Result<T> = std::result::Result<T, Box<dyn Error>>;

fn main() -> Result<()> {
    let numbers: Vec<u32> = std::env::args().filter_map(|argument| argument.parse().ok()).collect();
    let (pairs, blocks) = (numbers.first().copied().unwrap_or(20), numbers.get(1).copied().unwrap_or(20));
    let folder = tempfile::tempdir()?;
    let changed = folder.path().join("shaders");
    let steps = calibrate(folder.path(), &changed)?;
    slow_down(&changed, steps)?;
    println!("{SHADER} with {steps} dependent multiply-adds more, {:.0} % aimed at", 100.0 * SLOWER);

    let options = format!("--shader-dir {}", changed.display());
    let slowed = ab(folder.path(), &options, 40)?;
    report("slowed", &slowed);
    let named = found(&slowed);
    println!("named: {}\n", if named.is_empty() { "nothing".to_owned() } else { named.join(", ") });

    let allowed = allowed(pairs);
    let (mut wrong, mut measured) = (0, 0);
    while !is_settled(wrong, measured, pairs) {
        let equal = ab(folder.path(), "", blocks)?;
        let named = found(&equal);
        measured += 1;
        wrong += u32::from(!named.is_empty());
        println!(
            "equal sides {measured}: {}",
            if named.is_empty() { "no difference".to_owned() } else { named.join(", ") }
        );
    }
    println!("{wrong} of {measured} pairs of equal sides have a false verdict");
    if measured < pairs {
        let bound = if wrong > allowed { "is broken" } else { "can no longer be broken" };
        println!("the others of {pairs} were left out: at most {allowed} may have one, a bound that {bound}");
    }
    let expected = [format!("{PASS} SLOWER"), "frame SLOWER".to_owned()];
    if !named.contains(&expected[0]) || named.iter().any(|name| !expected.contains(name)) {
        return Err(format!("not the slower pass {PASS} alone is named").into());
    }
    if wrong > allowed {
        return Err("more than 3 in 20 false verdicts".into());
    }
    Ok(())
}

/// False verdicts that so many pairs of equal sides may have: 3 in 20.
fn allowed(pairs: u32) -> u32 {
    3 * pairs / 20
}

/// True when no further pair can change whether the false verdicts are more than [`allowed`].
fn is_settled(wrong: u32, measured: u32, pairs: u32) -> bool {
    wrong > allowed(pairs) || wrong + (pairs - measured) <= allowed(pairs)
}

/// Number of steps that slow the pass down as much as is aimed at: its time grows linearly with them, so that many more,
/// which stand out of any noise, tell what one takes.
fn calibrate(folder: &Path, changed: &Path) -> Result<u32> {
    const MANY: u32 = 10_000;
    slow_down(changed, MANY)?;
    let mut ratios = Vec::new();
    for _ in 0..7 {
        let before = pass_ms(folder, "")?;
        let after = pass_ms(folder, &format!("--shader-dir {}", changed.display()))?;
        ratios.push(after / before - 1.0);
    }
    let slower = median(&ratios).filter(|&slower| slower > SLOWER).ok_or("more steps take no longer")?;
    Ok((f64::from(MANY) * SLOWER / slower) as u32)
}

/// Copies the shaders, with a loop of `steps` at the start of the one.
fn slow_down(folder: &Path, steps: u32) -> Result<()> {
    copy(&PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/shaders")), folder)?;
    let path = folder.join(SHADER);
    let text = fs::read_to_string(&path)?;
    let work = format!(
        "void main() {{\n    float busy = float(gl_GlobalInvocationID.x) * 1.0e-6;\n    for (int step = 0; step < {steps}; step++) {{\n        \
         busy = fma(busy, 0.999, 0.001);\n    }}\n    // Never, and no compiler knows.\n    if (busy > 1.0e9) {{\n        \
         return;\n    }}\n"
    );
    let changed = text.replacen("void main() {\n", &work, 1);
    if changed == text {
        return Err(format!("{SHADER} has no main as it is looked for").into());
    }
    Ok(fs::write(path, changed)?)
}

fn copy(from: &Path, to: &Path) -> Result<()> {
    fs::create_dir_all(to)?;
    for entry in fs::read_dir(from)? {
        let entry = entry?;
        let target = to.join(entry.file_name());
        if entry.file_type()?.is_dir() {
            copy(&entry.path(), &target)?;
        } else {
            fs::copy(entry.path(), target)?;
        }
    }
    Ok(())
}

/// The median time of the pass in a fresh process.
fn pass_ms(folder: &Path, options: &str) -> Result<f64> {
    let file = folder.join("one.json");
    let (paper, scene) = SCENE.split_once(' ').ok_or("a scene")?;
    let mut command = Command::new(PROGRAM);
    command.args([paper, "bench", "--quiet"]).args(scene.split(' ')).args(options.split_whitespace());
    run(command.arg("--json").arg(&file), &[0])?;
    let record = json::read(&file)?;
    let pass = record.runs[0].passes.iter().find(|pass| pass.name == PASS);
    Ok(pass.and_then(|pass| pass.gpu_ms.as_ref()).ok_or("the device times no pass")?.median)
}

fn ab(folder: &Path, b: &str, blocks: u32) -> Result<Comparison> {
    let file = folder.join("comparison.json");
    let mut command = Command::new(PROGRAM);
    command.args(["ab", "--quiet", "--budget", "3600", "--blocks", &blocks.to_string(), "--out"]).arg(folder);
    command.arg("--b").arg(b).arg("--json").arg(&file).args(SCENE.split(' '));
    run(&mut command, &[0])?;
    Ok(serde_json::from_str(&fs::read_to_string(&file)?)?)
}

fn run(command: &mut Command, codes: &[i32]) -> Result<()> {
    let ended = command.output()?;
    if ended.status.code().is_some_and(|code| codes.contains(&code)) {
        return Ok(());
    }
    Err(format!("{command:?}: {}", String::from_utf8_lossy(&ended.stderr)).into())
}

/// The frame and the passes that are faster or slower.
fn found(comparison: &Comparison) -> Vec<String> {
    let of = |name: &str, verdict| match verdict {
        Verdict::Faster => Some(format!("{name} FASTER")),
        Verdict::Slower => Some(format!("{name} SLOWER")),
        Verdict::Same | Verdict::Unclear => None,
    };
    let mut names = Vec::new();
    for run in &comparison.runs {
        names.extend(of("frame", run.frame.verdict));
        names.extend(run.passes.iter().filter_map(|pass| of(&pass.name, pass.time.verdict)));
    }
    names
}

fn report(title: &str, comparison: &Comparison) {
    for run in &comparison.runs {
        println!("{title}: {} processes a side", run.a_processes);
        let frame = ("frame", None, &run.frame);
        let passes = run.passes.iter().map(|pass| (pass.name.as_str(), Some(pass.clock), &pass.time));
        for (name, clock, time) in std::iter::once(frame).chain(passes) {
            let clock = match clock {
                None => "",
                Some(Clock::Gpu) => " gpu",
                Some(Clock::Host) => " host",
                Some(Clock::Wait) => " wait",
            };
            let ratio = time.ratio.map_or_else(|| "-".to_owned(), |ratio| format!("{ratio:.4}"));
            let [low, high] = time.interval.map_or([f64::NAN; 2], |interval| interval);
            println!("  {name}{clock}: {ratio} [{low:.4}, {high:.4}] {:?}", time.verdict);
        }
    }
}
