//! A rock: one of the two that we make, or a picture's.

use std::borrow::Cow;
use std::ffi::OsStr;
use std::path::PathBuf;

use super::rock::Rock;
use crate::image::read_png_within;
use crate::measure::Error;
use crate::measure::parameter::{Shape, Value, one};

/// Source of a rock. As text: `plates` or `crust`; anything else is a path, so that a file named `crust` is `./crust`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum RockSource {
    /// [`Rock::built_in`].
    Plates,
    /// [`Rock::crust`].
    Crust,
    /// A PNG.
    File(PathBuf),
}

const PLATES: &str = "plates";
const CRUST: &str = "crust";

impl RockSource {
    /// Makes or decodes it.
    ///
    /// # Errors
    /// Of a file that is no PNG [`Error::Image`]; [`Error::Input`] of one of another size than rocks have.
    pub fn load(&self) -> Result<Cow<'static, Rock>, Error> {
        let path = match self {
            RockSource::Plates => return Ok(Cow::Borrowed(Rock::built_in())),
            RockSource::Crust => return Ok(Cow::Borrowed(Rock::crust())),
            RockSource::File(path) => path,
        };
        let picture = read_png_within(path, Rock::MAX_SIDE)?;
        let texels = picture.pixels().as_chunks().0.to_vec();
        let rock = Rock { width: picture.width(), height: picture.height(), texels };
        rock.validate().map_err(|e| Error::Input(format!("reading the rock {}: {e}", path.display())))?;
        Ok(Cow::Owned(rock))
    }
}

impl Value for RockSource {
    const SHAPE: Shape = Shape::single("NAME|FILE");

    fn parse(texts: &[&OsStr]) -> Result<Self, String> {
        Ok(match texts {
            [text] if *text == PLATES => RockSource::Plates,
            [text] if *text == CRUST => RockSource::Crust,
            [text] => RockSource::File(text.into()),
            _ => return one(texts).map(|text| RockSource::File(text.into())),
        })
    }

    fn text(&self) -> String {
        match self {
            RockSource::Plates => PLATES.to_owned(),
            RockSource::Crust => CRUST.to_owned(),
            RockSource::File(path) => path.display().to_string(),
        }
    }

    fn files(&self) -> Vec<PathBuf> {
        if let RockSource::File(path) = self { vec![path.clone()] } else { Vec::new() }
    }
}
