//! MetaImage, the format of ITK: a header of lines (`.mhd`) with its samples in another file, or behind it (`.mha`).

use std::fs::File;
use std::io::BufReader;
use std::path::{Path, PathBuf};
use std::str::FromStr;

use glam::DVec3;

use super::VoxelGrid;
use super::grid::{check_size, check_steps};
use super::header::{Header, Scale, Skip};
use super::lines::{self, Fields, shown};
use super::raw::{Kind, Raw};
use crate::scene::Error;
use crate::scene::binary::ByteOrder;
use crate::scene::error::Fault;

/// The key that the header ends with: the file of the samples, or LOCAL.
const DATA: &str = "ElementDataFile";

/// Reads a file with its samples in it, or the one that its header names.
pub(super) fn load(path: &Path, component: u32) -> Result<VoxelGrid, Error> {
    lines::load(path, component, fields, header, samples_path)
}

/// The file of the samples, where they are not in this one.
pub(super) fn data_path(path: &Path) -> Result<Option<PathBuf>, Error> {
    lines::data_path(path, fields, samples_path)
}

fn samples_path(fields: &Fields, header: &Path) -> Result<Option<PathBuf>, Error> {
    let is_local = fields.get(DATA).is_some_and(|name| name.eq_ignore_ascii_case("LOCAL"));
    if is_local { Ok(None) } else { fields.data_path(DATA, header) }
}

/// Reads up to the name of the samples' file.
fn fields(input: &mut BufReader<File>) -> Result<Fields, Fault> {
    let is_last = |line: &str| line.split_once('=').is_some_and(|(key, _)| key.trim() == DATA);
    let mut fields = Fields::default();
    for (line, text) in lines::read(input, is_last)? {
        if let Some((key, value)) = text.split_once('=') {
            fields.insert(line, key.trim().to_owned(), value)?;
        }
    }
    fields.required(DATA)?;
    Ok(fields)
}

fn numbers<T: FromStr, const N: usize>(fields: &Fields, key: &str) -> Result<Option<[T; N]>, Fault> {
    let Some(text) = fields.get(key) else { return Ok(None) };
    let numbers = text.split_whitespace().map(|word| fields.number(key, word)).collect::<Result<Vec<T>, _>>()?;
    let count = numbers.len();
    let numbers = numbers.try_into().map_err(|_| fields.fault(key, format!("has {count} numbers, not {N}")))?;
    Ok(Some(numbers))
}

fn is_true(fields: &Fields, keys: &[&str]) -> bool {
    keys.iter().any(|key| fields.get(key).is_some_and(|value| value.starts_with(['T', 't', '1'])))
}

fn header(fields: &Fields) -> Result<Header, Fault> {
    if let Some(kind) = fields.get("ObjectType").filter(|kind| *kind != "Image") {
        return Err(fields.fault("ObjectType", format!("is {}; a volume is an Image", shown(kind))));
    }
    fields.required("NDims")?;
    let axes = numbers::<u32, 1>(fields, "NDims")?;
    if axes != Some([3]) {
        let found = fields.get("NDims").unwrap_or_default();
        return Err(fields.fault("NDims", format!("is {}; a volume has 3", shown(found))));
    }
    fields.required("DimSize")?;
    let size = numbers(fields, "DimSize")?.unwrap_or_default();
    let size = check_size(size).map_err(|reason| fields.fault("DimSize", reason))?;
    if fields.get("BinaryData").is_some() && !is_true(fields, &["BinaryData"]) {
        return Err(fields.fault("BinaryData", "is False; save the volume as binary data"));
    }
    let [components] = numbers(fields, "ElementNumberOfChannels")?.unwrap_or([1]);
    if components == 0 {
        return Err(fields.fault("ElementNumberOfChannels", "is 0"));
    }
    let is_big = is_true(fields, &["BinaryDataByteOrderMSB", "ElementByteOrderMSB"]);
    let order = if is_big { ByteOrder::Big } else { ByteOrder::Little };
    let raw = Raw { size, kind: kind(fields)?, order, components, together: 1 };
    raw.bytes()?;
    let spacing = match numbers::<f64, 3>(fields, "ElementSpacing")? {
        Some(spacing) => spacing,
        None => numbers(fields, "ElementSize")?.unwrap_or([1.0; 3]),
    };
    // Three names of the directions of the axes, one after the other.
    let mut directions = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    for key in ["TransformMatrix", "Rotation", "Orientation"] {
        if let Some([a, b, c, d, e, f, g, h, i]) = numbers::<f64, 9>(fields, key)? {
            directions = [[a, b, c], [d, e, f], [g, h, i]];
            break;
        }
    }
    let steps = std::array::from_fn(|axis| DVec3::from(directions[axis]) * spacing[axis]);
    check_steps(steps)?;
    let skip = match fields.get("HeaderSize") {
        None => Skip::Bytes(0),
        Some("-1") => Skip::ToTheEnd,
        Some(text) => Skip::Bytes(fields.number("HeaderSize", text)?),
    };
    Ok(Header { raw, steps, skip_lines: 0, skip, is_packed: is_true(fields, &["CompressedData"]), scale: Scale::PLAIN })
}

fn kind(fields: &Fields) -> Result<Kind, Fault> {
    let text = fields.required("ElementType")?;
    Ok(match text.strip_suffix("_ARRAY").unwrap_or(text) {
        "MET_UCHAR" => Kind::Unsigned8,
        "MET_CHAR" => Kind::Signed8,
        "MET_USHORT" => Kind::Unsigned16,
        "MET_SHORT" => Kind::Signed16,
        "MET_UINT" | "MET_ULONG" => Kind::Unsigned32,
        "MET_INT" | "MET_LONG" => Kind::Signed32,
        "MET_ULONG_LONG" => Kind::Unsigned64,
        "MET_LONG_LONG" => Kind::Signed64,
        "MET_FLOAT" => Kind::Float32,
        "MET_DOUBLE" => Kind::Float64,
        _ => {
            let reason = format!("is {}; integers of 8 to 64 bits, MET_FLOAT and MET_DOUBLE can be read", shown(text));
            return Err(fields.fault("ElementType", reason));
        }
    })
}
