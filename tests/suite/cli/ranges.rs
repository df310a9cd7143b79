//! Both ends of every declared range, each alone beside a small scene: a picture or one clear line, in bounded memory, and
//! a word beforehand where it takes long.

use std::convert::Infallible;

use fumarole::measure::parameter::Parameter;
use fumarole::measure::study::{Study, Visitor};
use fumarole::papers;
use rand_pcg::Pcg32;
use rand_pcg::rand_core::Rng;

use super::program::{folder, fumarole};
use super::properties::{ends_well, example, template};

/// All of them with this variable, else so many.
const ALL_VARIABLE: &str = "FUMAROLE_TEST_ALL_RANGES";
const SAMPLE: usize = 12;

/// A scene that is drawn at once.
fn small(paper: &str) -> &'static str {
    match paper {
        "lava" => "size=32x24 particles=300 radius=0.2 density=12x6x6 splats=40x10",
        "gas" => "size=24x16 steps=6 table=6",
        "caustics" => "size=32x24 map-size=32 water-triangles=200 planes=5 mesh=box",
        "burning" => "size=32x24 mesh=sphere triangles=200 blocks=2x2x2 fire=20 smoke=10 speed=1",
        _ => "size=32x24 resolution=17",
    }
}

/// Sizes of pictures, which have no upper end of their own.
const SIZES: [&str; 4] = ["1x1", "16384x1", "1x16384", "4000000000x4000000000"];

/// The ends of a parameter's range as they are typed, and what lies just inside: an end may be out of its range.
fn ends<S: Study>(parameter: &Parameter<S>) -> Vec<String> {
    if parameter.name == "size" {
        return SIZES.map(str::to_owned).to_vec();
    }
    let shape = parameter.shape();
    if shape.is_flag {
        return vec![String::new()];
    }
    if !shape.choices.is_empty() {
        return shape.choices.iter().map(|choice| choice.0.to_owned()).collect();
    }
    let Some(template) = template(parameter) else { return vec![] };
    let (low, high) = parameter.range.ends();
    let inside = |end: f64, towards: f64| {
        if end == 0.0 { 1e-30_f64.copysign(towards) } else { end * (1.0 + 1e-6 * towards * end.signum()) }
    };
    let low = low.map_or(vec![-1e30, 0.0], |low| vec![low, inside(low, 1.0)]);
    let high = high
        .map_or(vec![if template.is_whole { 4_294_967_295.0 } else { 1e30 }], |high| vec![high, inside(high, -1.0)]);
    let mut texts: Vec<String> = low.into_iter().chain(high).map(|end| template.filled(|| end)).collect();
    texts.dedup();
    texts
}

/// Command lines of every paper.
struct Lines(Vec<(&'static str, Vec<String>)>);

impl Visitor for Lines {
    type Error = Infallible;

    fn visit<S: Study>(&mut self) -> Result<(), Infallible> {
        let options = |name: &str, value: &str| match value {
            "" => format!("--{name}"),
            value => format!("--{name}={value}"),
        };
        for parameter in S::parameters() {
            for end in ends(&parameter) {
                let rest = small(S::PAPER).split(' ').filter_map(|word| word.split_once('='));
                let rest = rest.filter(|(name, _)| *name != parameter.name);
                let mut line: Vec<String> = rest.map(|(name, value)| options(name, value)).collect();
                let needed = parameter.requires.map(|name| options(name, example(name)));
                line.extend(needed.into_iter().chain([options(parameter.name, &end)]));
                self.0.push((S::PAPER, line));
            }
        }
        Ok(())
    }
}

#[test]
fn both_ends_of_every_range_end_well() {
    let mut lines = Lines(vec![]);
    let Ok(()) = papers::each(&mut lines);
    if std::env::var_os(ALL_VARIABLE).is_none() {
        let mut random = Pcg32::new(1, 1);
        while lines.0.len() > SAMPLE {
            lines.0.swap_remove(random.next_u32() as usize % lines.0.len());
        }
    }
    let (mut drawn, mut failures) = (0, vec![]);
    for (paper, options) in &lines.0 {
        let out = folder();
        let mut program = fumarole(paper).args("render").on_test_device().arg("--image").arg(out.path().join("a.png"));
        for option in options {
            program = program.arg(option);
        }
        match ends_well(&program) {
            Ok(is_drawn) => drawn += u32::from(is_drawn),
            Err(failure) => failures.push(format!("{paper} {}: {failure}", options.join(" "))),
        }
    }
    println!("{drawn} of {} were drawn", lines.0.len());
    assert!(failures.is_empty(), "{} of {}:\n{}", failures.len(), lines.0.len(), failures.join("\n"));
    assert!(drawn > 4 && (drawn as usize) < lines.0.len(), "{drawn} of {}", lines.0.len());
}
