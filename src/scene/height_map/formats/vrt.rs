//! Mosaics of GDAL: a virtual raster in XML whose parts are other files, sample by sample. Nothing is resampled or scaled.

use super::geotiff::MAX_BYTES;
use super::placement::{self, MapCoordinates, Unit};
use super::{check_unit, first_look, load as load_file, malformed};
use crate::file as any_file;
use crate::scene::binary::{allocate, spare_bytes};
use crate::scene::error::{Asset, Fault, Place};
use crate::scene::height_map::grid::{Grid, Placement, all_void, is_same};
use crate::scene::height_map::map::check_size;
use crate::scene::height_map::{self, Coordinates, Geographic, MapOptions};
use crate::scene::{Error, HeightMap, Samples, file};
use glam::DVec2;
use roxmltree::{Document, Node};
use std::collections::btree_map::Entry;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::str::FromStr;

/// Some hundred thousand parts.
const MOST_BYTES: u64 = 256 << 20;
/// A raster may be so much larger than what its parts cover, beside some samples that any may have.
const MOST_EMPTY: u64 = 16;
const ANY_SAMPLES: u64 = 16 << 20;
/// Most parts over a sample, on average.
const MOST_OVER: u64 = 4;
/// Bytes that the packed files of a mosaic may unpack to together, beyond so many for each of theirs: as many as one of them may.
const MOST_UNPACKED: u64 = MAX_BYTES as u64;
const UNPACKED_PER_BYTE: u64 = 16;
/// A file's parts stand together, or are parted by others so often, beside some times that any mosaic may have.
const MOST_TIMES: usize = 4;
const ANY_TIMES: usize = 16;
/// Bytes of the longest name of a file that is looked for.
const LONGEST_NAME: usize = 1024;

/// A mosaic as its file describes it.
struct Mosaic {
    size: (u32, u32),
    no_data: Option<f64>,
    /// The middle of its first sample, and the steps between them.
    coordinates: Option<Coordinates>,
    /// Of the coordinates, as its reference system names it.
    unit: Option<Unit>,
    parts: Vec<Part>,
}

/// A rectangle of another file, and its place.
struct Part {
    /// In the mosaic's file, bytes.
    at: usize,
    name: String,
    no_data: Option<f64>,
    /// First column and row in the other file, and here.
    from: (u32, u32),
    to: (u32, u32),
    size: (u32, u32),
}

/// Reads a mosaic with all its parts.
pub(super) fn load(path: &Path, has_own_spacing: bool) -> Result<HeightMap, Error> {
    let text = any_file::read_text(path, MOST_BYTES).map_err(|source| file::failed(path, Asset::HeightMap, source))?;
    let mosaic = Mosaic::parse(&text).map_err(|fault| malformed(path, fault))?;
    let is_placed = mosaic.coordinates.is_some();
    mosaic.assemble(path, &text, MapOptions { overview: 0, has_own_spacing, is_placed })
}

/// The files of a mosaic's parts that are there.
pub(in crate::scene) fn parts(path: &Path) -> Vec<PathBuf> {
    let text = any_file::read_text(path, MOST_BYTES).unwrap_or_default();
    let names: BTreeSet<String> = Mosaic::parse(&text)
        .map_or_else(|_| BTreeSet::new(), |mosaic| mosaic.parts.into_iter().map(|part| part.name).collect());
    names.iter().filter_map(|name| beside(path, name).ok()).filter(|file| file.is_file()).collect()
}

/// The file that a mosaic names, which lies in its folder or below.
fn beside(path: &Path, name: &str) -> std::io::Result<PathBuf> {
    any_file::below(path.parent().unwrap_or(Path::new("")), Path::new(name))
}

impl Mosaic {
    fn parse(text: &str) -> Result<Self, Fault> {
        let document = Document::parse(text).map_err(|error| Fault::foreign(Place::Whole, &error))?;
        let root = document.root_element();
        if !root.has_tag_name("VRTDataset") {
            return Err(fault(root, "it is no VRTDataset"));
        }
        let (width, height): (u64, u64) = (attribute(root, "rasterXSize")?, attribute(root, "rasterYSize")?);
        check_size(width, height).map_err(|reason| fault(root, reason))?;
        let size = (width as u32, height as u32);
        let coordinates = child(root, "GeoTransform").map(coordinates_of).transpose()?;
        let system = child(root, "SRS");
        if let Some(node) = system {
            placement::check_heights(self::text(node)).map_err(|reason| fault(node, reason))?;
        }
        let unit = system.and_then(|node| placement::unit(self::text(node)));
        if let Some(node) = child(root, "MaskBand") {
            return Err(fault(
                node,
                "it hides samples, and is not read; declare them as voids with gdal_translate -a_nodata",
            ));
        }
        let mut bands = root.children().filter(|node| node.has_tag_name("VRTRasterBand"));
        let Some(band) = bands.next() else { return Err(fault(root, "it has no VRTRasterBand")) };
        if let Some(other) = bands.next() {
            return Err(fault(other, "it is a second band; a height map has one"));
        }
        if let Some(kind) = band.attribute("subClass") {
            return Err(fault(band, format!("its subClass is {:?}; plain mosaics alone are read", shown(kind))));
        }
        for (name, plain) in [("Scale", 1.0), ("Offset", 0.0)] {
            if let Some(node) = child(band, name)
                && number(node)? != plain
            {
                return Err(fault(node, "it changes heights; write plain metres with gdal_translate -unscale"));
            }
        }
        if let Some(node) = child(band, "UnitType") {
            check_unit(self::text(node)).map_err(|reason| fault(node, reason))?;
        }
        let no_data = child(band, "NoDataValue").map(number).transpose()?;
        let sources = band.children().filter(|node| node.tag_name().name().ends_with("Source"));
        let parts: Vec<Part> = sources.map(|node| Part::parse(node, size)).collect::<Result<_, _>>()?;
        if parts.is_empty() {
            return Err(fault(band, "it has no SimpleSource"));
        }
        let places: BTreeSet<_> = parts.iter().map(|part| (part.to, part.size)).collect();
        let covered: u64 = places.iter().map(|(_, (columns, rows))| u64::from(*columns) * u64::from(*rows)).sum();
        if width * height > MOST_EMPTY * covered + ANY_SAMPLES {
            let reason =
                format!("its parts cover {covered} of {width} x {height} samples; take those that lie together");
            return Err(fault(root, reason));
        }
        let copied: u64 = parts.iter().map(|part| u64::from(part.size.0) * u64::from(part.size.1)).sum();
        if copied > MOST_OVER * width * height + ANY_SAMPLES {
            let reason =
                format!("its parts have {copied} samples for {width} x {height}; leave out those that others hide");
            return Err(fault(root, reason));
        }
        Ok(Mosaic { size, no_data, coordinates, unit, parts })
    }

    /// The file of each part, in their order, and what is known of all of them.
    fn files(&self, path: &Path, text: &str, options: MapOptions) -> Result<Files, Error> {
        let mut sizes = BTreeMap::new();
        let (mut most_bytes, mut unpacked_bytes) = (0, 0_u64);
        let mut files: Vec<PathBuf> = Vec::with_capacity(self.parts.len());
        for part in &self.parts {
            let refused = |reason: String| part.refused(path, text, reason);
            let file = beside(path, &part.name).map_err(|error| refused(format!("{}: {error}", part.name)))?;
            if file.is_dir() || file.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("vrt")) {
                return Err(refused(format!("{}: a mosaic's parts are files of heights", part.name)));
            }
            if let Entry::Vacant(size) = sizes.entry(file.clone()) {
                let size_bytes = *size.insert(file::open(&file, Asset::HeightMap)?.1);
                let unpacked = first_look::unpacked(&file, options)?;
                most_bytes = most_bytes.max(unpacked.most_bytes);
                unpacked_bytes += unpacked.raw_bytes.saturating_sub(UNPACKED_PER_BYTE.saturating_mul(size_bytes));
                // All of them are unpacked before one that is damaged is found.
                if unpacked_bytes > MOST_UNPACKED {
                    return Err(refused(format!(
                        "with {} its packed files unpack to more than {} MiB beyond {UNPACKED_PER_BYTE} times their size; \
                         write some anew with gdal_translate -co COMPRESS=NONE",
                        part.name,
                        MOST_UNPACKED >> 20
                    )));
                }
            }
            files.push(file);
        }
        let times = 1 + files.windows(2).filter(|pair| pair[0] != pair[1]).count();
        if times > MOST_TIMES * sizes.len() + ANY_TIMES {
            let reason = format!(
                "its parts go to and fro between its {} files, {times} times; let those of a file follow each other",
                sizes.len()
            );
            return Err(malformed(path, Fault::new(Place::Whole, reason)));
        }
        let size_bytes = sizes.values().fold(0, |sum: u64, bytes| sum.saturating_add(*bytes));
        Ok(Files { files, size_bytes, most_bytes })
    }

    /// Looks at all parts, and keeps nothing of those that are packed.
    ///
    /// # Errors
    /// Those of reading them one after another; [`Error::Malformed`] where none of them has a height.
    fn check(&self, path: &Path, text: &str, files: &[PathBuf], read: &mut LastRead) -> Result<(), Error> {
        let (mut agreed, mut seen, mut has_height) = (Agreed::default(), BTreeMap::new(), false);
        for (part, file) in self.parts.iter().zip(files) {
            let voids: Vec<f64> = [self.no_data, part.no_data].into_iter().flatten().collect();
            let is_first = !seen.contains_key(file);
            let (looked, first_voids) = match seen.entry(file) {
                Entry::Occupied(known) => known.into_mut(),
                Entry::Vacant(unknown) => {
                    let looked = first_look::look_through(file, read.options, &voids)?;
                    unknown.insert((looked, voids.clone()))
                }
            };
            // A file is looked through once, for its first part. By other voids it may have heights, as the whole map will tell.
            has_height |= *first_voids != voids;
            let map = if let Some((map, has_known)) = looked {
                has_height |= *has_known;
                &*map
            } else {
                let (map, heights) = read.map(file)?;
                has_height = has_height || is_first && heights.iter().any(|height| !is_void(*height, &voids));
                map
            };
            agreed.check(self, part, map).map_err(|reason| part.refused(path, text, reason))?;
        }
        if has_height { Ok(()) } else { Err(malformed(path, all_void())) }
    }

    fn assemble(&self, path: &Path, text: &str, options: MapOptions) -> Result<HeightMap, Error> {
        let (width, height) = (self.size.0 as usize, self.size.1 as usize);
        let Files { files, size_bytes, most_bytes } = self.files(path, text, options)?;
        let mut read = LastRead { options, last: None };
        let own_bytes = (width * height * size_of::<f32>()) as u64;
        // Nothing is kept of a mosaic that could take far more than its files before all of them are seen to be whole.
        if own_bytes + most_bytes > spare_bytes(size_bytes) {
            self.check(path, text, &files, &mut read)?;
        }
        let mut values = allocate::<f32>(width * height).map_err(|fault| malformed(path, fault))?;
        values.fill(f32::NAN);
        let mut agreed = Agreed::default();
        for (part, file) in self.parts.iter().zip(&files) {
            let (map, heights) = read.map(file)?;
            agreed.check(self, part, map).map_err(|reason| part.refused(path, text, reason))?;
            let ((column, row), (columns, rows)) = (part.from, part.size);
            let voids: Vec<f64> = [self.no_data, part.no_data].into_iter().flatten().collect();
            for line in 0..rows as usize {
                let first = (row as usize + line) * map.width() as usize + column as usize;
                let to = (part.to.1 as usize + line) * width + part.to.0 as usize;
                let pairs = values[to..][..columns as usize].iter_mut().zip(&heights[first..][..columns as usize]);
                pairs.filter(|(_, height)| !is_void(**height, &voids)).for_each(|(value, height)| *value = *height);
            }
        }
        let placement = match agreed.placement {
            Some(Placement::Unknown) | None if !options.has_own_spacing => {
                self.own_placement().map_err(|fault| malformed(path, fault))?
            }
            placement => placement.unwrap_or(Placement::Unknown),
        };
        let integral = !agreed.has_fractions;
        let (width, height) = self.size;
        Grid { width, height, values, integral, no_data: Some(f64::NAN), placement }
            .into_map()
            .map_err(|fault| malformed(path, fault))
    }

    /// The place that the mosaic itself states, for parts that have none.
    fn own_placement(&self) -> Result<Placement, Fault> {
        let Some(Coordinates { north_west, step }) = self.coordinates else { return Ok(Placement::Unknown) };
        let (width, height) = self.size;
        let north_west = Some(north_west);
        MapCoordinates { north_west, step, width, height, field: "GeoTransform" }.placed(self.unit)
    }

    /// The mosaic's place as one of its parts has it.
    fn placement(&self, map: &HeightMap, part: &Part) -> Result<Placement, String> {
        let Some(Coordinates { north_west, step }) = map.coordinates() else { return Ok(Placement::Unknown) };
        if self.coordinates.is_some_and(|own| ((own.step - step) / step).abs().max_element() > 1e-6) {
            return Err(format!("the samples of {} are not as far apart as its GeoTransform says", part.name));
        }
        let offset = |to: u32, from: u32| f64::from(to) - f64::from(from);
        let moved = DVec2::new(offset(part.to.0, part.from.0), -offset(part.to.1, part.from.1));
        let north_west = north_west - moved * step;
        Ok(match map.geographic() {
            Some(_) => {
                Placement::Degrees(Geographic { west_deg: north_west.x, north_deg: north_west.y, step_deg: step })
            }
            None => Placement::Metres(map.spacing_m(), Some(Coordinates { north_west, step })),
        })
    }
}

/// The mosaic as the parts seen so far describe it.
#[derive(Default)]
struct Agreed {
    has_fractions: bool,
    placement: Option<Placement>,
}

impl Agreed {
    fn check(&mut self, mosaic: &Mosaic, part: &Part, map: &HeightMap) -> Result<(), String> {
        let (wide, high) = (map.width(), map.height());
        if part.from.0 + part.size.0 > wide || part.from.1 + part.size.1 > high {
            return Err(format!("its SrcRect leaves {}, which has {wide} x {high} samples", part.name));
        }
        self.has_fractions |= !matches!(map.samples(), Samples::Steps { step_m: 1.0, .. });
        let here = mosaic.placement(map, part)?;
        let first = *self.placement.get_or_insert(here);
        if is_one(first, here) {
            return Ok(());
        }
        let name = &part.name;
        Err(match (first, here) {
            (Placement::Unknown, _) => format!("{name} has a place, and the first part has none that a map may have"),
            (_, Placement::Unknown) => format!("{name} has no place that a map may have, and the first part has one"),
            _ => format!("{name} does not lie where its DstRect says, beside the first part"),
        })
    }
}

/// True for a height that stands for none, by the file itself or by one of `voids`.
fn is_void(height: f32, voids: &[f64]) -> bool {
    height.is_nan() || voids.iter().any(|void| is_same(height.into(), *void))
}

/// The files of a mosaic's parts.
struct Files {
    /// Of each part.
    files: Vec<PathBuf>,
    /// Of all of them together, each counted once.
    size_bytes: u64,
    /// Most bytes that one of them takes while it is read, beyond what its size allows.
    most_bytes: u64,
}

/// The map that was read last with its heights, no number where they are void: a file may have several parts.
struct LastRead {
    options: MapOptions,
    last: Option<(PathBuf, HeightMap, Vec<f32>)>,
}

impl LastRead {
    fn map(&mut self, file: &Path) -> Result<(&HeightMap, &[f32]), Error> {
        // Another one goes before this one comes.
        let (path, map, heights) = match self.last.take().filter(|(path, ..)| path == file) {
            Some(read) => read,
            None => {
                let map = load_file(file, self.options)?;
                let heights = map.known_heights();
                (file.to_owned(), map, heights)
            }
        };
        let (_, map, heights) = self.last.insert((path, map, heights));
        Ok((map, heights.as_slice()))
    }
}

/// True where two parts say the same of the mosaic, to a hundredth of a sample.
fn is_one(a: Placement, b: Placement) -> bool {
    let near = |a: DVec2, b: DVec2, step: DVec2, other: DVec2| {
        ((a - b) / step).abs().max_element() < 0.01 && ((step - other) / step).abs().max_element() < 1e-6
    };
    match (a, b) {
        (Placement::Unknown, Placement::Unknown) => true,
        (Placement::Degrees(a), Placement::Degrees(b)) => {
            let corner = |place: Geographic| DVec2::new(place.west_deg, place.north_deg);
            near(corner(a), corner(b), a.step_deg, b.step_deg)
        }
        (Placement::Metres(_, Some(a)), Placement::Metres(_, Some(b))) => {
            near(a.north_west, b.north_west, a.step, b.step)
        }
        _ => false,
    }
}

impl Part {
    fn refused(&self, path: &Path, text: &str, reason: String) -> Error {
        malformed(path, Fault::new(Place::Line(line_at(text, self.at)), reason))
    }

    fn parse(node: Node<'_, '_>, (width, height): (u32, u32)) -> Result<Self, Fault> {
        let kind = node.tag_name().name();
        if !["SimpleSource", "ComplexSource"].contains(&kind) {
            return Err(fault(node, "SimpleSource and ComplexSource are read"));
        }
        let plain = ["SourceFilename", "SourceBand", "SourceProperties", "SrcRect", "DstRect", "NODATA", "OpenOptions"];
        if let Some(other) =
            node.children().find(|child| child.is_element() && !plain.contains(&child.tag_name().name()))
        {
            return Err(fault(other, "it changes heights; write plain ones with gdal_translate"));
        }
        let name = required(node, "SourceFilename")?;
        if name.attribute("relativeToVRT") != Some("1") {
            return Err(fault(
                name,
                "it is not relative to the mosaic; put the mosaic beside its parts and build it there",
            ));
        }
        if let Some(band) = child(node, "SourceBand").filter(|band| text(*band) != "1") {
            return Err(fault(band, format!("it is band {:?}; a height map has one", shown(text(band)))));
        }
        if text(name).is_empty() {
            return Err(fault(name, "it names no file"));
        }
        if text(name).len() > LONGEST_NAME || text(name).contains(char::is_control) {
            return Err(fault(name, format!("it is {:?}, no name of a file", shown(text(name)))));
        }
        let (source, here) = (required(node, "SrcRect")?, required(node, "DstRect")?);
        let whole = |rectangle: Node<'_, '_>, name: &str| -> Result<u32, Fault> {
            let value: f64 = attribute(rectangle, name)?;
            let is_whole = value.fract() == 0.0 && (0.0..=f64::from(u16::MAX) + 1.0).contains(&value);
            if is_whole {
                Ok(value as u32)
            } else {
                Err(fault(rectangle, format!("{name} is {}; whole samples alone are read", height_map::shown(value))))
            }
        };
        let pair =
            |rectangle: Node<'_, '_>, x: &str, y: &str| Ok::<_, Fault>((whole(rectangle, x)?, whole(rectangle, y)?));
        let (size, other) = (pair(source, "xSize", "ySize")?, pair(here, "xSize", "ySize")?);
        if size != other || size.0 == 0 || size.1 == 0 {
            let reason =
                format!("{} x {} samples become {} x {}; nothing is resampled", size.0, size.1, other.0, other.1);
            return Err(fault(here, reason));
        }
        let (from, to) = (pair(source, "xOff", "yOff")?, pair(here, "xOff", "yOff")?);
        if to.0 + size.0 > width || to.1 + size.1 > height {
            return Err(fault(here, "it leaves the raster"));
        }
        let no_data = child(node, "NODATA").map(number).transpose()?;
        Ok(Part { at: node.range().start, name: text(name).to_owned(), no_data, from, to, size })
    }
}

/// The middle of the first sample and the steps between samples, of a raster that is not turned.
fn coordinates_of(node: Node<'_, '_>) -> Result<Coordinates, Fault> {
    let numbers: Vec<f64> = text(node).split(',').filter_map(|part| part.trim().parse().ok()).collect();
    match numbers[..] {
        [west, east, turned, north, other, south] if east > 0.0 && south < 0.0 && turned == 0.0 && other == 0.0 => {
            let north_west = DVec2::new(west + east / 2.0, north + south / 2.0);
            Ok(Coordinates { north_west, step: DVec2::new(east, -south) })
        }
        _ => Err(fault(node, "it is not north up")),
    }
}

fn child<'a, 'input>(node: Node<'a, 'input>, name: &str) -> Option<Node<'a, 'input>> {
    node.children().find(|child| child.has_tag_name(name))
}

fn required<'a, 'input>(node: Node<'a, 'input>, name: &str) -> Result<Node<'a, 'input>, Fault> {
    child(node, name).ok_or_else(|| fault(node, format!("it has no {name}")))
}

fn text<'a>(node: Node<'a, '_>) -> &'a str {
    node.text().unwrap_or_default().trim()
}

fn number(node: Node<'_, '_>) -> Result<f64, Fault> {
    text(node).parse().map_err(|_| fault(node, format!("it is {:?}, not a number", shown(text(node)))))
}

fn attribute<T: FromStr>(node: Node<'_, '_>, name: &str) -> Result<T, Fault> {
    let value = node.attribute(name).ok_or_else(|| fault(node, format!("it has no {name}")))?;
    value.parse().map_err(|_| fault(node, format!("{name} is {:?}, not a number of samples", shown(value))))
}

fn shown(text: &str) -> String {
    text.chars().take(40).collect()
}

/// Counted for a fault alone: of each part it would be counted from the file's beginning.
fn line_at(text: &str, at: usize) -> usize {
    1 + text.bytes().take(at).filter(|byte| *byte == b'\n').count()
}

/// A fault of an element, by its line and name.
fn fault(node: Node<'_, '_>, reason: impl AsRef<str>) -> Fault {
    let line = line_at(node.document().input_text(), node.range().start);
    Fault::new(Place::Line(line), format!("{}: {}", shown(node.tag_name().name()), reason.as_ref()))
}

#[cfg(test)]
mod tests;
