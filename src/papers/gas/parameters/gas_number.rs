//! A number of one gas alone: of a volume by its place, or of the surface-defined gases.

use std::ffi::OsStr;

use serde_json::Value as Json;

use super::{default_volume, volumes};
use crate::measure::Error;
use crate::measure::parameter::{Shape, Value, one};
use crate::papers::gas::model::{Object, Volume};

/// The gas that a number is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Gas {
    /// The volume of that place, from 1: the scene's, then the user's.
    Volume(usize),
    /// All surfaces whose opacity is a gas's.
    Surfaces,
}

/// Numbers that a surface-defined gas does not have: those of light inside a volume, and of its solid.
const OF_VOLUMES: [&str; 4] = ["tau", "albedo", "falloff", "phase"];

/// `2:tau=0.5`, `surfaces:opaque=0.4`: an option of all volumes and its value, for that gas alone.
#[derive(Debug, Clone, PartialEq)]
pub struct GasNumber {
    of: Gas,
    name: String,
    value: String,
}

impl Value for GasNumber {
    const SHAPE: Shape = Shape::single("GAS:NAME=VALUE");

    fn parse(texts: &[&OsStr]) -> Result<Self, String> {
        let form =
            || "give a volume's place or surfaces, an option of the gases and its value, as 2:tau=0.5".to_owned();
        let text = one(texts)?;
        let (of, number) = text.split_once(':').ok_or_else(form)?;
        let (name, value) = number.split_once('=').ok_or_else(form)?;
        let of = match of {
            "surfaces" => Gas::Surfaces,
            place => Gas::Volume(place.parse().ok().filter(|place| *place > 0).ok_or_else(form)?),
        };
        let declared = volumes::declared();
        let parameter = declared.iter().find(|parameter| parameter.name == name).ok_or_else(|| {
            let names: Vec<&str> = declared.iter().map(|parameter| parameter.name).collect();
            format!("{name:?} is no number of a gas: these are {}", names.join(", "))
        })?;
        parameter.parser()(&[OsStr::new(value)])?;
        Ok(GasNumber { of, name: name.to_owned(), value: value.to_owned() })
    }

    fn text(&self) -> String {
        let Self { of, name, value } = self;
        match of {
            Gas::Volume(place) => format!("{place}:{name}={value}"),
            Gas::Surfaces => format!("surfaces:{name}={value}"),
        }
    }

    fn json(&self) -> Json {
        self.text().into()
    }
}

impl GasNumber {
    /// Sets it, where it is a volume's.
    ///
    /// # Errors
    /// [`Error::Input`] for a volume that is not there, or that has no such number.
    pub fn set_in(&self, all: &mut [Volume]) -> Result<(), Error> {
        let Gas::Volume(place) = self.of else { return Ok(()) };
        let count = all.len();
        match all.get_mut(place - 1) {
            Some(volume) => self.set(volume),
            None => {
                Err(self.refused(&format!("there is no such volume, the scene has {count}; give `volume` for more")))
            }
        }
    }

    /// Sets it, where it is the surface-defined gases'.
    ///
    /// # Errors
    /// [`Error::Input`] for a scene without such surfaces, or a number that they do not have.
    pub fn set_on(&self, objects: &mut [Object]) -> Result<(), Error> {
        if self.of != Gas::Surfaces {
            return Ok(());
        }
        let mut gases = objects.iter_mut().filter_map(|object| object.gas.as_mut()).peekable();
        if gases.peek().is_none() {
            return Err(self.refused("the scene has no surface-defined gas: give `preset` fig-4"));
        }
        if OF_VOLUMES.contains(&self.name.as_str()) {
            return Err(self.refused(&format!("a surface-defined gas has no `{}`", self.name)));
        }
        gases.try_for_each(|texture| {
            let mut volume = Volume { texture: *texture, ..default_volume() };
            self.set(&mut volume)?;
            *texture = volume.texture;
            Ok(())
        })
    }

    fn set(&self, volume: &mut Volume) -> Result<(), Error> {
        let mut alone = vec![*volume];
        let declared = volumes::declared();
        let Some(parameter) = declared.iter().find(|parameter| parameter.name == self.name) else { return Ok(()) };
        parameter.set(&mut alone, &[OsStr::new(&self.value)]).map_err(|problem| self.refused(&problem))?;
        if parameter.text(&alone).is_empty() {
            return Err(self.refused(&format!("that gas has no `{}`", self.name)));
        }
        *volume = alone[0];
        Ok(())
    }

    fn refused(&self, problem: &str) -> Error {
        Error::Input(format!("`gas-number` {}: {problem}", self.text()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::papers::gas::model::DensityFunction;
    use crate::papers::gas::scenes::Preset;

    fn parse(text: &str) -> Result<GasNumber, String> {
        GasNumber::parse(&[OsStr::new(text)])
    }

    #[test]
    fn each_number_goes_to_its_gas_alone() {
        let mut all = vec![default_volume(); 3];
        for text in ["2:tau=0.5", "3:density=clouds", "3:frequency=9", "1:phase=1,0,0,0"] {
            let number = parse(text).unwrap();
            assert_eq!(number.text(), text);
            number.set_in(&mut all).unwrap();
        }
        assert_eq!(all.iter().map(|v| v.tau_per_m).collect::<Vec<_>>(), [2.0, 0.5, 2.0]);
        assert_eq!(all[2].texture.function, DensityFunction::Clouds { frequency: 9.0 });
        assert_eq!(all[1].texture.function, DensityFunction::Turbulence);
        assert_eq!(all.iter().map(|v| v.phase[0].weight).collect::<Vec<_>>(), [1.0, 0.8, 0.8]);
        for (text, part) in [("4:tau=1", "has 3"), ("1:frequency=3", "no `frequency`")] {
            let error = parse(text).unwrap().set_in(&mut all).unwrap_err().to_string();
            assert!(error.contains(part) && error.contains(text), "{error}");
        }
        for text in ["", "tau=1", "2:tau", "0:tau=1", "2:colour=1", "2:tau=thick", "front:tau=1"] {
            assert!(parse(text).is_err(), "{text}");
        }
    }

    #[test]
    fn surfaces_have_the_numbers_of_their_textures() {
        let mut objects = Preset::Fig4.scene().objects;
        parse("surfaces:opaque=0.25").unwrap().set_on(&mut objects).unwrap();
        parse("surfaces:density=turbulence").unwrap().set_on(&mut objects).unwrap();
        let gases: Vec<_> = objects.iter().filter_map(|object| object.gas).collect();
        assert_eq!(gases.len(), 3);
        assert!(gases.iter().all(|gas| gas.opaque == 0.25 && gas.function == DensityFunction::Turbulence));
        assert!(gases.iter().any(|gas| gas.power != gases[0].power), "others stay");
        for name in OF_VOLUMES {
            let value = if name == "phase" { "1,0,0,0" } else { "1" };
            let number = parse(&format!("surfaces:{name}={value}")).unwrap();
            assert!(number.set_on(&mut objects).unwrap_err().to_string().contains(name));
        }
        let error = parse("surfaces:opaque=1").unwrap().set_on(&mut Preset::Fig8.scene().objects).unwrap_err();
        assert!(error.to_string().contains("fig-4"), "{error}");
    }
}
