//! An axis along which a paper's work grows: declared once in the paper's folder.

use std::ffi::OsStr;

use crate::measure::Error;
use crate::measure::study::Study;
use crate::report::record::Run;

/// Sets a set-up to a value of an axis.
type Set<S> = Box<dyn Fn(&mut S, u64) -> Result<(), Error>>;

/// One axis: what grows, from where, and how a set-up gets there.
pub struct Axis<S> {
    /// On the command line and in the record, kebab-case.
    pub name: &'static str,
    /// One line.
    pub help: &'static str,
    /// Plural, as it follows a value and stands before `a second`.
    pub unit: &'static str,
    /// Value of the first step that nobody names, at least 1.
    pub start: u64,
    /// Greatest value.
    pub most: u64,
    /// Parameter that it sets, and that must not be given beside it; empty where there is none.
    pub parameter: &'static str,
    /// Source of the amount of work that a step really had.
    pub amount: Amount<S>,
    set: Set<S>,
}

/// Amount of work of a step, which its throughput and exponents are of.
pub enum Amount<S> {
    /// The axis's value.
    Value,
    /// The value after rounding.
    Rounded(fn(&S) -> f64),
    /// An entry of the run's `config`, in the axis's unit.
    Counted(&'static str),
    /// An entry of the run's `results`, and its unit: what the device found to do.
    Found(&'static str, &'static str),
}

impl<S: 'static> Axis<S> {
    /// An axis without an end of its own.
    pub fn new(name: &'static str, start: u64, set: impl Fn(&mut S, u64) -> Result<(), Error> + 'static) -> Self {
        Axis {
            name,
            help: "",
            unit: name,
            start,
            most: u64::MAX,
            parameter: "",
            amount: Amount::Value,
            set: Box::new(set),
        }
    }

    pub fn help(self, help: &'static str) -> Self {
        Axis { help, ..self }
    }

    pub fn unit(self, unit: &'static str) -> Self {
        Axis { unit, ..self }
    }

    pub fn most(self, most: u64) -> Self {
        Axis { most, ..self }
    }

    /// The parameter that it sets.
    pub fn sets(self, parameter: &'static str) -> Self {
        Axis { parameter, ..self }
    }

    pub fn amount(self, amount: Amount<S>) -> Self {
        Axis { amount, ..self }
    }

    /// Sets the value.
    ///
    /// # Errors
    /// [`Error::Input`] for a set-up that has no such axis.
    pub fn set(&self, setup: &mut S, value: u64) -> Result<(), Error> {
        (self.set)(setup, value)
    }

    /// Unit of the amounts.
    pub fn amount_unit(&self) -> &'static str {
        if let Amount::Found(_, unit) = self.amount { unit } else { self.unit }
    }

    /// True when amounts are values, only rounded.
    pub fn counts_values(&self) -> bool {
        !matches!(self.amount, Amount::Found(..))
    }

    /// Amount of a step's run; its value where the run does not tell.
    pub fn amount_of(&self, setup: &S, value: u64, run: &Run) -> f64 {
        let told = match self.amount {
            Amount::Value => None,
            Amount::Rounded(amount) => Some(amount(setup)),
            Amount::Counted(key) => run.config.get(key).and_then(serde_json::Value::as_f64),
            Amount::Found(key, _) => run.results.get(key).and_then(serde_json::Value::as_f64),
        };
        told.unwrap_or(value as f64)
    }
}

impl<S: Study> Axis<S> {
    /// The axis of a whole-numbered parameter, which ends where its range ends.
    pub fn of(parameter: &'static str, start: u64) -> Self {
        let declared = move || S::parameters().into_iter().find(|declared| declared.name == parameter);
        let most = declared().and_then(|declared| declared.range.ends().1).map_or(u64::MAX, |most| most as u64);
        let set = move |setup: &mut S, value: u64| {
            let failed = |reason: String| Error::Input(format!("`{parameter}` {value}: {reason}"));
            let declared = declared().ok_or_else(|| failed("no such parameter".to_owned()))?;
            declared.set(setup, &[OsStr::new(&value.to_string())]).map_err(failed)
        };
        Axis::new(parameter, start, set).most(most).sets(parameter)
    }
}

/// Side of a square of about `area`, at least 1.
pub fn side(area: u64) -> u32 {
    ((area as f64).sqrt().round() as u32).max(1)
}

/// The sides of a box of about `volume` whose sides are as these, each at least 1.
pub fn scaled<const N: usize>(sides: [u32; N], volume: u64) -> [u32; N] {
    let product: f64 = sides.iter().map(|&side| f64::from(side.max(1))).product();
    let factor = (volume as f64 / product).powf(1.0 / N as f64);
    sides.map(|side| ((f64::from(side.max(1)) * factor).round() as u32).max(1))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn boxes_keep_their_shape() {
        assert_eq!((side(1 << 20), side(0), side(2)), (1024, 1, 1));
        assert_eq!(scaled([100, 24, 24], 57_600 * 8), [200, 48, 48]);
        assert_eq!(scaled([800, 600], 120_000), [400, 300]);
        assert_eq!(scaled([800, 600], 1), [1, 1]);
    }
}
