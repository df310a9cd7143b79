//! Words for the parameters of every paper, set as the command line sets them.

use std::collections::BTreeMap;
use std::convert::Infallible;
use std::ffi::OsStr;

use fumarole::measure::parameter::{self, Given, Parameter};
use fumarole::measure::study::{Study, Visitor, check_one};
use fumarole::papers;

use super::is_one_line;

/// Words by the names of their parameters, in their order.
type Words<'a> = BTreeMap<&'a str, Vec<&'a str>>;

/// Lines of a name, a space, and a word; those of no parameter say nothing.
pub fn settings(data: &[u8]) {
    let Ok(text) = std::str::from_utf8(data) else { return };
    let mut words = Words::new();
    for line in text.lines() {
        let (name, word) = line.split_once(' ').unwrap_or((line, ""));
        words.entry(name).or_default().push(word);
    }
    let Ok(()) = papers::each(&mut Typed { words: &words, longest: text.len() });
}

struct Typed<'a> {
    words: &'a Words<'a>,
    /// Of all words together, bytes.
    longest: usize,
}

impl Visitor for Typed<'_> {
    type Error = Infallible;

    fn visit<S: Study>(&mut self) -> Result<(), Infallible> {
        let preset = self.words.get("preset").and_then(|words| words.last());
        let preset = preset.and_then(|name| S::presets().into_iter().find(|preset| preset.name == *name));
        let mut setup = preset.map_or_else(S::default, |preset| preset.setup());
        let given = self.set(&S::parameters(), &mut setup, S::default);
        self.set(&S::options(), &mut S::Options::default(), S::Options::default);
        if is_cheap(&setup) {
            match setup.resolve(&given) {
                Ok(()) => self.use_all(&setup),
                Err(error) => self.check(&error),
            }
        }
        Ok(())
    }
}

impl Typed<'_> {
    /// Sets what was typed, and gives its names.
    fn set<S: 'static>(&self, parameters: &[Parameter<S>], setup: &mut S, default: fn() -> S) -> Given {
        let mut names = vec![];
        for parameter in parameters {
            let Some(typed) = self.words.get(parameter.name) else { continue };
            let words = as_passed(parameter, typed);
            for word in &words {
                self.comes_back(parameter, default(), word);
            }
            let words: Vec<&OsStr> = words.iter().map(OsStr::new).collect();
            match parameter.set(setup, &words) {
                Ok(()) => names.push(parameter.name.to_owned()),
                Err(reason) => self.check(&reason),
            }
        }
        if let Err(error) = parameter::check(parameters, setup) {
            self.check(&error);
        }
        names.into_iter().collect()
    }

    /// The form is that of the value; a value's text is the same value.
    fn comes_back<S: 'static>(&self, parameter: &Parameter<S>, mut setup: S, word: &str) {
        let is_of_form = parameter.parser()(&[OsStr::new(word)]).is_ok();
        let set = parameter.set(&mut setup, &[OsStr::new(word)]);
        assert!(set.is_ok() == is_of_form, "{} {word:?}", parameter.name);
        if let Err(reason) = set {
            return self.check(&reason);
        }
        let text = parameter.text(&setup);
        let typed = match text.as_str() {
            // Nothing is not typed.
            "" => return,
            "on" if parameter.shape().is_flag => "true",
            "off" if parameter.shape().is_flag => "false",
            other => other,
        };
        let again = parameter.set(&mut setup, &[OsStr::new(typed)]);
        assert!(again.is_ok(), "{} {word:?}: {text:?}: {again:?}", parameter.name);
        let read = parameter.text(&setup);
        assert!(is_same(parameter.name, &text, &read), "{} {word:?}: {text:?} and {read:?}", parameter.name);
    }

    /// All that is asked of a set-up before its scene is loaded.
    fn use_all<S: Study>(&self, setup: &S) {
        let parameters = S::parameters();
        if let Err(error) = check_one(setup) {
            self.check(&error);
        }
        let alternatives = setup.alternatives();
        assert!(!alternatives.is_empty());
        for alternative in &alternatives {
            let config = parameter::config(&parameters, alternative);
            assert!(config.len() <= parameters.len());
            let (_, _) = (alternative.summary(), alternative.rendered(None));
            if parameter::check(&parameters, alternative).is_ok() {
                let identity = alternative.identity();
                assert!(identity.width > 0 && identity.height > 0);
            }
        }
    }

    /// A message has the words in it, and no line breaks but theirs.
    fn check(&self, error: &impl std::fmt::Display) {
        let is_plain = |words: &Vec<&str>| words.iter().all(|word| !word.contains(char::is_control));
        if self.longest < 200 && self.words.values().all(is_plain) {
            is_one_line(error);
        } else {
            assert!(!error.to_string().is_empty());
        }
    }
}

/// The words as the argument parser hands them on: all of a list, between commas where those separate, else the last.
fn as_passed<S: 'static>(parameter: &Parameter<S>, typed: &[&str]) -> Vec<String> {
    let shape = parameter.shape();
    match typed {
        _ if shape.is_list && shape.joins => typed.iter().flat_map(|word| word.split(',')).map(str::to_owned).collect(),
        _ if shape.is_list => typed.iter().map(|word| (*word).to_owned()).collect(),
        _ => typed.last().map(|word| (*word).to_owned()).into_iter().collect(),
    }
}

/// Angles that are kept as radians come back but for the last digit.
fn is_same(name: &str, a: &str, b: &str) -> bool {
    let numbers = |text: &str| text.split(',').map(|part| part.parse().unwrap_or(f64::NAN)).collect::<Vec<_>>();
    let are_near = |(a, b): (&f64, &f64)| (a - b).abs() <= 1e-6 * a.abs() + 1e-40;
    a == b || name == "sun" && numbers(a).iter().zip(&numbers(b)).all(are_near)
}

/// True where nothing large is read for it: water's map is loaded at once, and any file may lie in this folder.
fn is_cheap<S: Study>(setup: &S) -> bool {
    const LARGE: [&str; 2] = ["volcano", "jacksboro"];
    S::parameters().iter().all(|parameter| {
        let is_large = parameter.name == "water-map" && LARGE.contains(&parameter.text(setup).as_str());
        !is_large && parameter.files(setup).iter().all(|file| !file.exists())
    })
}
