//! A folder of SRTM tiles as one map. Neighbours share their borders' samples; what no tile covers is void.

use super::hgt::{self, Tile, VOID};
use super::malformed;
use crate::scene::binary::{allocate, spare_bytes};
use crate::scene::error::{Asset, Fault, Place};
use crate::scene::height_map::Geographic;
use crate::scene::height_map::grid::{Grid, Placement};
use crate::scene::height_map::map::check_size;
use crate::scene::{Error, HeightMap, file};
use glam::DVec2;
use std::collections::HashMap;
use std::fs;
use std::io::BufReader;
use std::path::{Path, PathBuf};

/// A tile's file, its size in bytes and its south-west corner, degrees.
struct Entry {
    path: PathBuf,
    name: String,
    size_bytes: u64,
    south_deg: i32,
    west_deg: i32,
}

/// Reads all files of a folder that end in `.hgt`, by the corners that their names tell.
pub(super) fn load(folder: &Path) -> Result<HeightMap, Error> {
    let entries = entries(folder)?;
    let Some(first) = entries.first() else {
        return Err(malformed(
            folder,
            Fault::new(Place::Whole, "it has no .hgt file; name a folder of SRTM tiles, or a file"),
        ));
    };
    let (columns, rows) = hgt::size(first.size_bytes).map_err(|fault| malformed(&first.path, fault))?;
    if let Some(other) = entries.iter().find(|entry| entry.size_bytes != first.size_bytes) {
        let reason = format!(
            "its size is {} bytes, that of {} {}; put tiles of one resolution into a folder",
            other.size_bytes, first.name, first.size_bytes
        );
        return Err(malformed(&other.path, Fault::new(Place::Whole, reason)));
    }
    let range = |of: fn(&Entry) -> i32| {
        entries.iter().map(of).fold((i32::MAX, i32::MIN), |(low, high), degree| (low.min(degree), high.max(degree)))
    };
    let ((south_deg, north_deg), (west_deg, east_deg)) =
        (range(|entry| entry.south_deg), range(|entry| entry.west_deg));
    // Cells of a degree; the samples of its border are the neighbour's, too.
    let (cells_x, cells_y) = (columns - 1, rows - 1);
    let along = |low: i32, high: i32, cells: u32| u64::from(high.abs_diff(low) + 1) * u64::from(cells) + 1;
    let (width, height) = (along(west_deg, east_deg, cells_x), along(south_deg, north_deg, cells_y));
    check_size(width, height).map_err(|reason| malformed(folder, Fault::new(Place::Whole, reason)))?;
    let tile_bytes: u64 = entries.iter().map(|entry| entry.size_bytes).sum();
    if 2 * width * height > spare_bytes(tile_bytes) {
        let reason = format!(
            "its {} tiles lie so far apart that {width} x {height} samples lie between them; name a folder of those that lie \
             together",
            entries.len()
        );
        return Err(malformed(folder, Fault::new(Place::Whole, reason)));
    }
    let stride = width as usize;
    let mut values = allocate::<i16>(stride * height as usize).map_err(|fault| malformed(folder, fault))?;
    values.fill(VOID);
    for entry in &entries {
        let Tile { values: samples, .. } = read(entry)?;
        let first_row = north_deg.abs_diff(entry.south_deg) as usize * cells_y as usize;
        let first_column = west_deg.abs_diff(entry.west_deg) as usize * cells_x as usize;
        for (row, samples) in samples.chunks_exact(columns as usize).enumerate() {
            let line = &mut values[(first_row + row) * stride + first_column..][..columns as usize];
            // A border that is void in one tile may be known in the other.
            line.iter_mut()
                .zip(samples)
                .filter(|(_, sample)| **sample != VOID)
                .for_each(|(value, sample)| *value = *sample);
        }
    }
    let place = Geographic {
        west_deg: west_deg.into(),
        north_deg: f64::from(north_deg) + 1.0,
        step_deg: DVec2::new(1.0 / f64::from(cells_x), 1.0 / f64::from(cells_y)),
    };
    let grid = Grid {
        width: width as u32,
        height: height as u32,
        values,
        integral: true,
        no_data: Some(VOID.into()),
        placement: Placement::Degrees(place),
    };
    grid.into_map().map_err(|fault| malformed(folder, fault))
}

/// The tiles of a folder, by name.
fn entries(folder: &Path) -> Result<Vec<Entry>, Error> {
    let failed = |source| Error::Read { path: folder.to_owned(), source };
    let mut entries = Vec::new();
    for entry in fs::read_dir(folder).map_err(failed)? {
        let path = entry.map_err(failed)?.path();
        if !path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("hgt")) {
            continue;
        }
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let (_, size_bytes) = file::open(&path, Asset::HeightMap)?;
        let (south_deg, west_deg) = hgt::corner(&name).map_err(|fault| malformed(&path, fault))?;
        entries.push(Entry { path, name, size_bytes, south_deg, west_deg });
    }
    entries.sort_by(|a, b| a.name.cmp(&b.name));
    let mut placed = HashMap::new();
    for entry in &entries {
        if let Some(other) = placed.insert((entry.south_deg, entry.west_deg), entry) {
            let reason = format!("it lies where {} does; a folder has one tile of each degree", other.name);
            return Err(malformed(&entry.path, Fault::new(Place::Whole, reason)));
        }
    }
    Ok(entries)
}

fn read(entry: &Entry) -> Result<Tile, Error> {
    let (file, size_bytes) = file::open(&entry.path, Asset::HeightMap)?;
    let tile = if size_bytes == entry.size_bytes {
        hgt::read(&entry.name, size_bytes, BufReader::new(file))
    } else {
        Err(Fault::new(Place::Whole, "it changed while the folder was read"))
    };
    tile.map_err(|fault| malformed(&entry.path, fault))
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIDE: usize = 1_201;

    /// A tile of 3 arc-seconds whose heights follow from their places on the Earth.
    fn tile(folder: &Path, name: &str, south_deg: i32, west_deg: i32, change: impl Fn(usize, usize, i16) -> i16) {
        let sample = |row: usize, column: usize| {
            let (north, east) = (south_deg * 1_200 + 1_200 - row as i32, west_deg * 1_200 + column as i32);
            change(row, column, height(north, east))
        };
        let bytes: Vec<u8> =
            (0..SIDE * SIDE).flat_map(|index| sample(index / SIDE, index % SIDE).to_be_bytes()).collect();
        fs::write(folder.join(name), bytes).unwrap();
    }

    /// Of a place in 3 arc-seconds.
    fn height(north: i32, east: i32) -> i16 {
        (north * 7 + east * 3).rem_euclid(2_000) as i16 - 500
    }

    #[test]
    fn tiles_lie_side_by_side_and_what_none_covers_is_void() {
        let folder = tempfile::tempdir().unwrap();
        // The eastern border of the one is void where the western one of the other is known, and the other way round.
        tile(folder.path(), "N46E007.hgt", 46, 7, |row, column, h| if column == 1_200 && row > 600 { VOID } else { h });
        tile(folder.path(), "n46e008.HGT", 46, 8, |row, column, h| if column == 0 && row < 600 { VOID } else { h });
        tile(folder.path(), "N45E007.hgt", 45, 7, |_, _, h| h);
        fs::write(folder.path().join("README.txt"), "of no account").unwrap();
        let map = super::super::load(folder.path(), 0).unwrap();
        assert_eq!((map.width(), map.height()), (2_401, 2_401));
        let place = map.geographic().unwrap();
        assert_eq!((place.west_deg, place.north_deg, place.step_deg), (7.0, 47.0, DVec2::splat(1.0 / 1_200.0)));
        // The degree in the south-east, but for the borders that its neighbours have.
        assert_eq!(map.voids(), 1_200 * 1_200);
        let known = |column: u32, row: u32| row <= 1_200 || column <= 1_200;
        for (row, column) in
            (0..2_401).step_by(7).flat_map(|row| (0..2_401).step_by(5).map(move |column| (row, column)))
        {
            let expected = f32::from(height(47 * 1_200 - row as i32, 7 * 1_200 + column as i32));
            assert!(!known(column, row) || map.height_m(column, row) == expected, "column {column}, row {row}");
        }
        for row in 0..=1_200 {
            let expected = f32::from(height(47 * 1_200 - row as i32, 8 * 1_200));
            assert_eq!(map.height_m(1_200, row), expected, "the border at row {row}");
        }
    }

    #[test]
    fn folders_that_are_no_map_are_refused_with_the_file() {
        let refused = |files: &[(&str, usize)]| {
            let folder = tempfile::tempdir().unwrap();
            for (name, size_bytes) in files {
                fs::File::create(folder.path().join(name)).unwrap().set_len(*size_bytes as u64).unwrap();
            }
            let message = load(folder.path()).unwrap_err().to_string();
            message.replace(&folder.path().display().to_string(), "F").replace('\\', "/")
        };
        let none: &[(&str, usize)] = &[];
        let (coarse, fine) = (2 * SIDE * SIDE, 2 * 3_601 * 3_601);
        for (files, expected) in [
            (none, "height map F: it has no .hgt file"),
            (&[("a.txt", 3)], "height map F: it has no .hgt file"),
            (&[("N46E007.hgt", 5)], "F/N46E007.hgt: its size is 5 bytes; an SRTM tile has one of"),
            (&[("bandai.hgt", coarse)], "F/bandai.hgt: its name tells no corner"),
            (
                &[("N46E007.hgt", coarse), ("N46E008.hgt", fine)],
                "F/N46E008.hgt: its size is 25934402 bytes, that of N46E007.hgt",
            ),
            (&[("N46E007.hgt", coarse), ("N46E007x.hgt", coarse)], "F/N46E007x.hgt: it lies where N46E007.hgt does"),
            (&[("N46E007.hgt", coarse), ("N55E017.hgt", coarse)], "height map F: its 2 tiles lie so far apart"),
            (&[("N46E007.hgt", coarse), ("S46E107.hgt", coarse)], "F: it has 121201 x"),
        ] {
            let message = refused(files);
            assert!(message.contains(expected), "{message}");
        }
    }
}
