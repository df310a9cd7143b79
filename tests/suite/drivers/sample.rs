//! Options drawn at random, a few at once, each line under the current layer: whatever shaders, passes and buffers they bring
//! together. `FUMAROLE_CASES=100` draws more lines of each paper, `FUMAROLE_TEST_SEED` others.

use std::convert::Infallible;
use std::env;

use fumarole::measure::Variant;
use fumarole::measure::parameter::Parameter;
use fumarole::measure::study::{Study, Visitor};
use fumarole::papers;
use rand_pcg::Pcg32;
use rand_pcg::rand_core::Rng;

use super::TINY;
use crate::cli::program::{ONCE, folder};
use crate::cli::properties::example;

/// Lines of each paper.
const LINES: usize = 5;
/// Options that are drawn for a line.
const OPTIONS: usize = 4;

/// Lines of options of every paper.
struct Lines {
    random: Pcg32,
    count: usize,
    found: Vec<(&'static str, Vec<String>)>,
}

impl Lines {
    fn below(&mut self, count: usize) -> usize {
        self.random.next_u32() as usize % count
    }

    /// A value near the one that the scene has, or else the default; none of words and files.
    fn near(&mut self, text: &str) -> Option<String> {
        let separators = |c: char| [',', 'x'].contains(&c);
        let mut value = String::new();
        for part in text.split_inclusive(separators) {
            let number = part.trim_end_matches(separators);
            let scale = 0.5 + self.below(1000) as f64 / 1000.0;
            match (number.parse::<u64>(), number.parse::<f64>()) {
                (Ok(whole), _) => value += &((whole as f64 * scale).round() as u64).to_string(),
                (_, Ok(real)) if real.is_finite() => value += &((real * scale) as f32).to_string(),
                _ => return None,
            }
            value += &part[number.len()..];
        }
        (!value.is_empty()).then_some(value)
    }

    fn option<S: Study>(&mut self, parameter: &Parameter<S>, scene: &str) -> Option<String> {
        let (name, shape) = (parameter.name, parameter.shape());
        if shape.is_flag {
            return Some(if self.below(4) == 0 { format!("--no-{name}") } else { format!("--{name}") });
        }
        if !shape.choices.is_empty() {
            return Some(format!("--{name}={}", shape.choices[self.below(shape.choices.len())].0));
        }
        let mut words = scene.split_whitespace().skip_while(|word| *word != format!("--{name}"));
        let given = words.nth(1).map(str::to_owned);
        let value = self.near(&given.unwrap_or_else(|| parameter.text(&S::default())))?;
        Some(format!("--{name}={value}"))
    }
}

impl Visitor for Lines {
    type Error = Infallible;

    fn visit<S: Study>(&mut self) -> Result<(), Infallible> {
        let Some((_, paper)) = TINY.iter().find(|(name, _)| *name == S::PAPER) else { return Ok(()) };
        let parameters: Vec<_> = S::parameters().into_iter().filter(|p| !["size", "seed"].contains(&p.name)).collect();
        for _ in 0..self.count {
            let variant = S::Variant::ALL[self.below(S::Variant::ALL.len())].as_str();
            let mut line = vec![format!("--variant={variant}")];
            while line.len() <= OPTIONS {
                let at = self.below(parameters.len());
                let Some(option) = self.option(&parameters[at], paper.scene) else { continue };
                line.extend(parameters[at].requires.map(|name| format!("--{name}={}", example(name))));
                line.push(option);
            }
            self.found.push((S::PAPER, line));
        }
        Ok(())
    }
}

#[test]
fn options_drawn_at_random_are_clean() {
    let number = |name: &str| env::var(name).ok().and_then(|text| text.parse::<u64>().ok());
    let count = number("FUMAROLE_CASES").map_or(LINES, |count| count as usize);
    let random = Pcg32::new(number("FUMAROLE_TEST_SEED").unwrap_or(1), 7);
    let mut lines = Lines { random, count, found: Vec::new() };
    let Ok(()) = papers::each(&mut lines);
    let folder = folder();
    let (mut clean, mut failures) = (0, Vec::new());
    for (name, line) in &lines.found {
        let Some((_, paper)) = TINY.iter().find(|(paper, _)| paper == name) else { continue };
        let program =
            line.iter().fold(paper.run("bench --quiet --json").args(ONCE), |program, option| program.arg(option));
        let ended = paper.under_current_layer(program.on_test_device(), &folder).run();
        match ended.status.code() {
            Some(0) => {
                let record = ended.json();
                let runs = record["runs"].as_array().unwrap();
                assert!(!runs.is_empty() && runs.iter().all(|run| run["validation"] == "clean"), "{line:?}: {record}");
                clean += 1;
            }
            // What cannot be together is refused in a line, or by the argument parser in a few.
            Some(2) if ended.stderr.starts_with("error: ") => {}
            _ => failures.push(format!("{name} {}: {}: {}", line.join(" "), ended.status, ended.stderr)),
        }
    }
    println!("{clean} of {} ran", lines.found.len());
    assert!(failures.is_empty(), "{} of {}:\n{}", failures.len(), lines.found.len(), failures.join("\n"));
    assert!(2 * clean > lines.found.len(), "{clean} of {} ran", lines.found.len());
}
