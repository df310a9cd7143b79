//! Scenes whose maps are not held: their tiles are read from files that are made once.

use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use glam::DVec2;

use super::MapInput;
use super::drape_source::ReadDrape;
use super::setup::{Scene, Setup};
use super::tile_file::TileFile;
use crate::content;
use crate::measure::Error;
use crate::measure::parameter::Value;
use crate::scene::loading::Conditions;
use crate::scene::{HeightMap, HeightMapSource, RowSource, SourceState, Voids, source_sha256};

/// Loads all but the samples of the maps, to lie under `drape`.
///
/// # Errors
/// [`Error::Input`] for what needs them; as [`TileFile::open`], and of the drape's place and the objects.
pub fn load(setup: &Setup, drape: Option<ReadDrape<'_>>) -> Result<Scene, Error> {
    if setup.objects.iter().any(|object| object.place.is_some()) {
        let reason =
            "an `object` with a place stands on the ground, which is not held; leave the place or `stream` out";
        return Err(Error::Input(reason.into()));
    }
    if setup.voids == Voids::Hole && setup.parameters.base_level_m.is_none() {
        let reason = "`voids` hole: with `stream` holes lie below `base-level`, which has to be given";
        return Err(Error::Input(reason.into()));
    }
    let tiles = setup.maps.iter().map(|source| open(setup, source).map(Arc::new)).collect::<Result<Vec<_>, _>>()?;
    let objects = setup.objects.iter().map(|object| object.load(setup.crease_deg)).collect::<Result<_, _>>()?;
    let bare: Vec<&HeightMap> = tiles.iter().map(|tiles| &**tiles.map()).collect();
    let drape = drape.map(|drape| drape.over(&bare, setup.exaggeration)).transpose()?;
    let input = |(tiles, placement): (&Arc<TileFile>, _)| MapInput { map: tiles.map().clone(), placement };
    let maps = tiles.iter().zip(setup.placements()).map(input).collect();
    Ok(Scene { maps, objects, drape, tiles })
}

/// The tiles of a map, from their file or made anew.
fn open(setup: &Setup, source: &HeightMapSource) -> Result<TileFile, Error> {
    let name = PathBuf::from(source.to_string());
    let folder = Conditions::tiles_folder();
    let interpolation = setup.parameters.interpolation;
    let state = || match source.path() {
        None => Ok(SourceState::default()),
        Some(path) => SourceState::of(path).map_err(|error| unreadable(path, error)),
    };
    let key = || key(setup, source);
    TileFile::open(folder.as_deref(), &name, interpolation, key, state, || rows(setup, source))
}

/// All that the tiles of a map are made of, and that says where it lies.
fn key(setup: &Setup, source: &HeightMapSource) -> Result<String, Error> {
    let Setup { parameters, voids, resolution, spacing_m, exaggeration, seed, overview, .. } = setup;
    let contents = match source.path() {
        None => format!("{source} {resolution} {seed}"),
        Some(path) => {
            let contents = source_sha256(path).map_err(|error| unreadable(path, error))?;
            // Of an SRTM tile the name says where it lies.
            let is_named = path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("hgt"));
            let place = path.file_name().filter(|_| is_named).unwrap_or_default();
            format!("{contents} {overview} {}", place.display())
        }
    };
    let level_m = if *voids == Voids::Hole { parameters.base_level_m } else { None };
    let (voids, interpolation) = (voids.text(), parameters.interpolation);
    let made_of = format!("{contents} {voids} {level_m:?} {spacing_m:?} {exaggeration:?} {interpolation:?}");
    Ok(content::sha256(made_of.as_bytes()))
}

fn unreadable(path: &Path, source: io::Error) -> Error {
    crate::scene::Error::Read { path: path.to_owned(), source }.into()
}

/// The samples, row by row: of the synthetic volcano as it is made, of a GeoTIFF without voids as it is read, else of the whole map.
fn rows(setup: &Setup, source: &HeightMapSource) -> Result<RowSource, Error> {
    let rows = match source.path() {
        None if *source == HeightMapSource::Volcano => Some(RowSource::volcano(setup.resolution, setup.seed)?),
        None => None,
        Some(path) => RowSource::geotiff(path, setup.map_options())?,
    };
    if let Some(mut rows) = rows {
        if let Some(spacing_m) = setup.spacing_m {
            rows = rows.with_spacing_m(DVec2::splat(spacing_m.into()))?;
        }
        return Ok(rows.with_exaggeration(setup.exaggeration)?);
    }
    let mut map = setup.load_map(source)?;
    if let (Voids::Hole, Some(base_m)) = (setup.voids, setup.parameters.base_level_m) {
        map = map.with_voids(Voids::Hole, base_m)?;
    }
    Ok(RowSource::of(map)?)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A tile of one degree says by its name alone where it lies; of other files the contents count.
    #[test]
    fn tiles_under_other_names_are_other_maps() {
        let folder = tempfile::tempdir().unwrap();
        let key_of = |name: &str| {
            let path = folder.path().join(name);
            std::fs::write(&path, "the same").unwrap();
            key(&Setup::default(), &HeightMapSource::File(path)).unwrap()
        };
        assert_ne!(key_of("N37E140.hgt"), key_of("N37E141.hgt"));
        assert_ne!(key_of("S01W079.HGT"), key_of("S02W079.HGT"));
        assert_eq!(key_of("one.asc"), key_of("other.asc"));
    }
}
