//! NRRD, the format of Teem and 3D Slicer: a header of lines, and samples behind it or in a file of their own.

use std::fs::File;
use std::io::{BufReader, Read};
use std::path::{Path, PathBuf};

use glam::DVec3;

use super::VoxelGrid;
use super::grid::{check_size, check_steps};
use super::header::{Header, Scale, Skip};
use super::lines::{self, Fields, shown};
use super::raw::{Kind, Raw};
use crate::scene::Error;
use crate::scene::binary::ByteOrder;
use crate::scene::error::{Fault, Place};

/// The field that names the file of the samples.
const DATA: &str = "data file";

/// Reads a file with its samples in it, or the one that its header names.
pub(super) fn load(path: &Path, component: u32) -> Result<VoxelGrid, Error> {
    lines::load(path, component, fields, header, samples_path)
}

/// The file of the samples, where they are not in this one.
pub(super) fn data_path(path: &Path) -> Result<Option<PathBuf>, Error> {
    lines::data_path(path, fields, samples_path)
}

fn samples_path(fields: &Fields, header: &Path) -> Result<Option<PathBuf>, Error> {
    fields.data_path(DATA, header)
}

/// Reads the fields, by their names in lower case, up to the empty line before the samples, or the end.
fn fields(input: &mut BufReader<File>) -> Result<Fields, Fault> {
    let mut magic = [0; 4];
    let is_nrrd = input.read_exact(&mut magic).is_ok() && magic == *b"NRRD";
    if !is_nrrd {
        return Err(Fault::new(Place::Byte(0), "it does not begin with NRRD; it is damaged or something else"));
    }
    let mut fields = Fields::default();
    // The rest of the first line is the version.
    for (line, text) in lines::read(input, str::is_empty)?.into_iter().skip(1) {
        // Comments, and keys of the user's own.
        let Some((key, value)) = text.split_once(':').filter(|(_, value)| !value.starts_with('=')) else { continue };
        let key = match key.trim().to_lowercase().as_str() {
            comment if comment.starts_with('#') => continue,
            "datafile" => DATA.to_owned(),
            "byteskip" => "byte skip".to_owned(),
            "lineskip" => "line skip".to_owned(),
            key => key.to_owned(),
        };
        fields.insert(line, key, value)?;
    }
    Ok(fields)
}

/// One item for each of the axes.
fn each<'a>(fields: &Fields, key: &str, text: &'a str, axes: usize) -> Result<Vec<&'a str>, Fault> {
    // A vector's own blanks part nothing.
    let mut depth = 0;
    let items: Vec<&str> = text
        .split(|c: char| {
            depth += i32::from(c == '(') - i32::from(c == ')');
            depth == 0 && c.is_whitespace()
        })
        .filter(|item| !item.is_empty())
        .collect();
    if items.len() == axes {
        return Ok(items);
    }
    Err(fields.fault(key, format!("has {} items for {axes} axes", items.len())))
}

fn header(fields: &Fields) -> Result<Header, Fault> {
    let axes: usize = fields.number("dimension", fields.required("dimension")?)?;
    if !(3..=4).contains(&axes) {
        return Err(fields.fault("dimension", format!("is {axes}; a volume has 3, or 4 with components")));
    }
    let sizes = each(fields, "sizes", fields.required("sizes")?, axes)?;
    let sizes = sizes.into_iter().map(|size| fields.number("sizes", size)).collect::<Result<Vec<u64>, _>>()?;
    let is_packed = match fields.required("encoding")?.to_lowercase().as_str() {
        "raw" => false,
        "gzip" | "gz" => true,
        other => {
            let reason = format!("is {}; save the volume with encoding raw or gzip", shown(other));
            return Err(fields.fault("encoding", reason));
        }
    };
    let kind = kind(fields)?;
    let order = match fields.get("endian").map(str::to_lowercase).as_deref() {
        Some("little") => ByteOrder::Little,
        Some("big") => ByteOrder::Big,
        None if kind.bytes() == 1 => ByteOrder::Little,
        None => return Err(Fault::new(Place::Whole, "its header has no field endian: add little or big")),
        Some(other) => return Err(fields.fault("endian", format!("is {}, neither little nor big", shown(other)))),
    };
    let steps = axis_steps(fields, axes)?;
    let space: Vec<usize> = (0..axes).filter(|&axis| steps[axis].is_some()).collect();
    let &[x, y, z] = space.as_slice() else {
        let count = space.len();
        let reason = format!("{count} of its {axes} axes lie in space; name 3 by kinds or space directions");
        return Err(Fault::new(Place::Whole, reason));
    };
    let size = check_size([x, y, z].map(|axis| sizes[axis])).map_err(|reason| fields.fault("sizes", reason))?;
    let component_axis = (0..axes).find(|&axis| steps[axis].is_none());
    let components = component_axis.map_or(1, |axis| sizes[axis]);
    if components == 0 {
        return Err(fields.fault("sizes", "has an axis of no components"));
    }
    let together = sizes[..component_axis.unwrap_or(0)].iter().fold(1, |all: u64, &side| all.saturating_mul(side));
    let raw = Raw { size, kind, order, components, together };
    raw.bytes()?;
    let steps = [x, y, z].map(|axis| steps[axis].unwrap_or_default());
    check_steps(steps)?;
    let skip = match fields.get("byte skip") {
        None => Skip::Bytes(0),
        Some("-1") => Skip::ToTheEnd,
        Some(text) => Skip::Bytes(fields.number("byte skip", text)?),
    };
    let skip_lines = fields.get("line skip").map_or(Ok(0), |text| fields.number("line skip", text))?;
    Ok(Header { raw, steps, skip_lines, skip, is_packed, scale: Scale::PLAIN })
}

fn kind(fields: &Fields) -> Result<Kind, Fault> {
    let text = fields.required("type")?;
    Ok(match text.to_lowercase().as_str() {
        "uchar" | "unsigned char" | "uint8" | "uint8_t" => Kind::Unsigned8,
        "signed char" | "int8" | "int8_t" => Kind::Signed8,
        "ushort" | "unsigned short" | "unsigned short int" | "uint16" | "uint16_t" => Kind::Unsigned16,
        "short" | "short int" | "signed short" | "signed short int" | "int16" | "int16_t" => Kind::Signed16,
        "uint" | "unsigned int" | "uint32" | "uint32_t" => Kind::Unsigned32,
        "int" | "signed int" | "int32" | "int32_t" => Kind::Signed32,
        "ulonglong" | "unsigned long long" | "unsigned long long int" | "uint64" | "uint64_t" => Kind::Unsigned64,
        "longlong"
        | "long long"
        | "long long int"
        | "signed long long"
        | "signed long long int"
        | "int64"
        | "int64_t" => Kind::Signed64,
        "float" => Kind::Float32,
        "double" => Kind::Float64,
        _ => {
            let reason = format!("is {}; integers of 8 to 64 bits, float and double can be read", shown(text));
            return Err(fields.fault("type", reason));
        }
    })
}

/// The step of each axis in space, to the left, backwards and up; none of one that counts components.
fn axis_steps(fields: &Fields, axes: usize) -> Result<Vec<Option<DVec3>>, Fault> {
    let signs = directions(fields)?;
    if let Some(text) = fields.get("space directions") {
        let vector = |item: &str| {
            if item.eq_ignore_ascii_case("none") {
                return Ok(None);
            }
            let numbers = item.strip_prefix('(').and_then(|item| item.strip_suffix(')')).map(|item| item.split(','));
            let numbers = numbers.into_iter().flatten().map(|number| fields.number("space directions", number.trim()));
            let numbers: Vec<f64> = numbers.collect::<Result<_, _>>()?;
            let vector = <[f64; 3]>::try_from(numbers)
                .map_err(|_| fields.fault("space directions", format!("has {}, no vector as (1,0,0)", shown(item))))?;
            Ok(Some(DVec3::from(vector) * signs))
        };
        return each(fields, "space directions", text, axes)?.into_iter().map(vector).collect();
    }
    let spacings = fields.get("spacings").map_or(Ok(vec![None; axes]), |text| {
        let spacing =
            |item: &str| fields.number::<f64>("spacings", item).map(|step| Some(step).filter(|s| !s.is_nan()));
        each(fields, "spacings", text, axes)?.into_iter().map(spacing).collect()
    })?;
    let is_space: Vec<bool> = match fields.get("kinds") {
        Some(text) => {
            let is_space = |kind: &str| ["space", "domain", "???", "none"].contains(&kind.to_lowercase().as_str());
            each(fields, "kinds", text, axes)?.into_iter().map(is_space).collect()
        }
        None if axes == 3 => vec![true; axes],
        // The axis of components has no spacing.
        None => spacings.iter().map(Option::is_some).collect(),
    };
    let mut units = [DVec3::X, DVec3::Y, DVec3::Z].into_iter();
    let step = |(is_space, spacing): (bool, Option<f64>)| {
        is_space.then(|| units.next().unwrap_or_default() * signs * spacing.unwrap_or(1.0))
    };
    Ok(is_space.into_iter().zip(spacings).map(step).collect())
}

/// The signs that turn the file's space into left, posterior, superior.
fn directions(fields: &Fields) -> Result<DVec3, Fault> {
    let Some(space) = fields.get("space") else {
        return match fields.get("space dimension") {
            None | Some("3") => Ok(DVec3::ONE),
            Some(other) => Err(fields.fault("space dimension", format!("is {}; a volume's is 3", shown(other)))),
        };
    };
    match space.to_lowercase().as_str() {
        "left-posterior-superior" | "lps" | "scanner-xyz" | "3d-right-handed" => Ok(DVec3::ONE),
        "right-anterior-superior" | "ras" => Ok(DVec3::new(-1.0, -1.0, 1.0)),
        "left-anterior-superior" | "las" | "3d-left-handed" => Ok(DVec3::new(1.0, -1.0, 1.0)),
        _ => {
            let reason = format!("is {}; spaces of 3 axes can be read, as right-anterior-superior", shown(space));
            Err(fields.fault("space", reason))
        }
    }
}
