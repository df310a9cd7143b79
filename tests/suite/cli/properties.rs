//! Random parameters from the ranges that the declarations state, in any variant and preset: every run ends with a picture or
//! with one clear line, in bounded memory, and says so beforehand where it takes long. `FUMAROLE_CASES=100` draws more cases
//! of each paper, `FUMAROLE_TEST_SEED` others.

use std::convert::Infallible;
use std::fs;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use fumarole::measure::Variant;
use fumarole::measure::parameter::{Parameter, Range};
use fumarole::measure::study::{Study, Visitor};
use fumarole::papers;
use fumarole::scene::random::Random;

use super::program::{Program, folder, fumarole};
use crate::common::beside_others;
use crate::faults::Layer;

/// Draws of each paper.
const CASES: u64 = 6;

/// Address space that no run may pass: the heap of lavapipe twice (the device's memory and what the host makes of it),
/// the driver and its threads.
const LIMIT_KIB: u64 = 8 << 20;

/// Longest run that said nothing beforehand.
const SILENT: Duration = Duration::from_secs(60);

/// Pictures that are drawn at once, of every shape.
const SIZES: [&str; 6] = ["32x24", "1x1", "1x40", "40x1", "33x17", "8x64"];

/// A case: what was typed.
struct Cases(Vec<(&'static str, Vec<String>)>);

impl Visitor for Cases {
    type Error = Infallible;

    fn visit<S: Study>(&mut self) -> Result<(), Infallible> {
        let number = |name: &str| std::env::var(name).ok().and_then(|text| text.parse::<u64>().ok());
        let seed = number("FUMAROLE_TEST_SEED").unwrap_or(1);
        let mut random = Random::new(seed << 8 | u64::from(S::PAPER.as_bytes()[0]));
        let presets = S::presets();
        let parameters: Vec<_> = S::parameters().into_iter().filter(|p| draw(p, &mut random).is_some()).collect();
        for _ in 0..number("FUMAROLE_CASES").unwrap_or(CASES) {
            let mut choice = |of: usize| random.next_u32() as usize % of;
            let variant = S::Variant::ALL[choice(S::Variant::ALL.len())];
            let mut options = vec![format!("--variant={}", variant.as_str())];
            // A preset's own scene takes long: seldom, and small.
            options.push(match choice(8) {
                0 => format!("--preset={}", presets[choice(presets.len())].name),
                _ => format!("--size={}", SIZES[choice(SIZES.len())]),
            });
            for _ in 0..=random.next_u32() % 3 {
                let parameter = &parameters[random.next_u32() as usize % parameters.len()];
                let option = format!("--{}=", parameter.name);
                let Some(value) = draw(parameter, &mut random) else { continue };
                if options.iter().any(|given| given.starts_with(&option)) {
                    continue;
                }
                options.push(option + &value);
                let needed = parameter.requires.map(|name| format!("--{name}={}", example(name)));
                if let Some(needed) = needed.filter(|needed| !options.contains(needed)) {
                    options.push(needed);
                }
            }
            self.0.push((S::PAPER, options));
        }
        Ok(())
    }
}

/// A value of a parameter that another one needs.
pub fn example(name: &str) -> &'static str {
    match name {
        "volume-file" => concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/volumes/eight.nrrd"),
        _ => "volcano",
    }
}

/// A value inside the range; none for flags, files and words, which have no numbers.
fn draw<S: Study>(parameter: &Parameter<S>, random: &mut Random) -> Option<String> {
    let shape = parameter.shape();
    if shape.is_flag || parameter.name == "size" {
        return None;
    }
    if !shape.choices.is_empty() {
        return Some(shape.choices[random.next_u32() as usize % shape.choices.len()].0.to_owned());
    }
    template(parameter).map(|template| template.filled(|| number(&parameter.range, random)))
}

/// Form of a value that is numbers.
pub struct Template {
    /// After each number but the last.
    separators: Vec<char>,
    pub is_whole: bool,
}

/// The form of a parameter's numbers, as its default or its placeholder show it. None for words.
pub fn template<S: Study>(parameter: &Parameter<S>) -> Option<Template> {
    let separators = |text: &str| text.chars().filter(|c| [',', 'x'].contains(c)).collect();
    let parts = |text: &str| text.split([',', 'x']).map(str::to_owned).collect::<Vec<_>>();
    let placeholder = parameter.shape().placeholder;
    let default = parameter.text(&S::default());
    // Of a list that is typed one by one, one.
    let default = default.split(' ').next().unwrap_or_default();
    if parts(default).iter().all(|part| part.parse::<f64>().is_ok()) {
        let is_whole = parts(default).iter().all(|part| part.parse::<u64>().is_ok()) && !placeholder.contains('F');
        return Some(Template { separators: separators(default), is_whole });
    }
    let form = placeholder.rsplit('|').next().unwrap_or_default().replace("EYE,TARGET", "X,Y,Z,X,Y,Z");
    let is_numbers = form.contains(',') && !form.contains("SHAPE") && !placeholder.contains("FILE");
    (is_numbers || ["N", "F"].contains(&form.as_str()))
        .then(|| Template { separators: separators(&form), is_whole: form == "N" })
}

impl Template {
    /// Numbers in its form.
    pub fn filled(&self, mut number: impl FnMut() -> f64) -> String {
        let mut text = String::new();
        for separator in self.separators.iter().map(Some).chain([None]) {
            let value = number();
            text += &if self.is_whole { format!("{}", value.round().max(0.0) as u64) } else { format!("{value}") };
            text.extend(separator);
        }
        text
    }
}

/// An end of the range, or a number between them by the logarithm.
fn number(range: &Range, random: &mut Random) -> f64 {
    let (low, high) = range.ends();
    let (low, high) = (low.unwrap_or(-1e3), high.unwrap_or(4e9));
    let between = |random: &mut Random| {
        let share = f64::from(random.next_u32()) / f64::from(u32::MAX);
        let from = if low > 0.0 { low } else { (high.abs() * 1e-6).max(1e-9) };
        (from.ln() + share * (high.ln() - from.ln())).exp()
    };
    let value = match random.next_u32() % 4 {
        0 => low,
        1 => high,
        _ => between(random),
    };
    // Small enough numbers behind the point for any type.
    f64::from(value as f32)
}

#[test]
fn whatever_the_ranges_hold_ends_well() {
    let mut cases = Cases(vec![]);
    let Ok(()) = papers::each(&mut cases);
    // Found by hand: eight terabytes, minutes of one frame, a command buffer of 2,000 steps, and days of them without a word.
    let days = "--frame=100000000 --particles=100";
    for words in
        ["--density=1x67108864x1", "--splats=4000x4000", "--splat-radius=1", "--frame=2000 --particles=100", days]
    {
        cases.0.push(("lava", words.split(' ').chain(["--size=32x24"]).map(str::to_owned).collect()));
    }
    let (mut drawn, mut failures) = (0, vec![]);
    for (paper, options) in &cases.0 {
        let out = folder();
        let picture = out.path().join("a.png");
        let mut program = fumarole(paper).args("render").on_test_device().arg("--image").arg(&picture);
        for option in options {
            program = program.arg(option);
        }
        match ends_well(&program) {
            Ok(is_drawn) => drawn += u32::from(is_drawn),
            Err(failure) => failures.push(format!("{paper} {}: {failure}", options.join(" "))),
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
    // Neither all refused nor all drawn, or the draws test nothing.
    assert!(drawn > 4 && (drawn as usize) < cases.0.len(), "{drawn} of {}", cases.0.len());
}

/// Runs to its end, or to where it has said that it takes long, on a device that gives no more memory than its heaps have.
/// True for exit code 0.
pub fn ends_well(program: &Program) -> Result<bool, String> {
    let (out, layer) = (folder(), Layer::new());
    let (stdout, stderr) = (out.path().join("stdout"), out.path().join("stderr"));
    let script = format!("ulimit -v {LIMIT_KIB}; exec {}", program.for_shell());
    let said = || fs::read_to_string(&stderr).unwrap_or_default();
    beside_others(|| {
        let mut child = Command::new("sh")
            .arg("-c")
            .arg(&script)
            .envs(layer.environment(false))
            .env("FUMAROLE_LAYER_HEAPS", "all")
            .current_dir(out.path())
            .stdin(Stdio::null())
            .stdout(fs::File::create(&stdout).unwrap())
            .stderr(fs::File::create(&stderr).unwrap())
            .spawn()
            .unwrap();
        let started = Instant::now();
        let status = loop {
            if let Some(status) = child.try_wait().unwrap() {
                break status;
            }
            let has_foretold = said().contains("note: ") && started.elapsed() > Duration::from_secs(3);
            if has_foretold || started.elapsed() > SILENT {
                child.kill().unwrap();
                child.wait().unwrap();
                return if has_foretold { Ok(true) } else { Err(format!("runs on without a word: {}", said())) };
            }
            std::thread::sleep(Duration::from_millis(20));
        };
        let text = said();
        let errors: Vec<&str> = text.lines().filter(|line| !is_remark(line)).collect();
        // The argument parser adds usage below its line.
        let is_usage = errors.iter().any(|line| line.contains("try '--help'"));
        let is_one_line =
            (errors.len() == 1 || is_usage) && errors.first().is_some_and(|line| line.starts_with("error: "));
        match status.code() {
            Some(0) if errors.is_empty() => Ok(true),
            // It names an option.
            Some(2) if is_one_line && errors[0].contains("--") => Ok(false),
            _ => Err(format!("{status}: {text}")),
        }
    })
}

fn is_remark(line: &str) -> bool {
    ["device: ", "wrote ", "warning: ", "note: "].iter().any(|start| line.starts_with(start))
}
