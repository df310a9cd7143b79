//! NIfTI-1, the format of brain scanners: a binary header with its samples behind it (`.nii`), or beside it (`.hdr` and
//! `.img`).

use std::io::{BufRead, BufReader, Read};
use std::path::{Path, PathBuf};

use glam::{DQuat, DVec3};

use super::VoxelGrid;
use super::grid::{check_size, check_steps};
use super::header::{Header, Scale, Skip, unpacked};
use super::raw::{Kind, Raw};
use super::source::malformed;
use crate::scene::binary::ByteOrder;
use crate::scene::error::{Asset, Fault, Place};
use crate::scene::{Error, file};

const HEADER_BYTES: usize = 348;
/// Offset of the first sample of a file with both, at least.
const FIRST_SAMPLE: u64 = HEADER_BYTES as u64 + 4;

/// Length of the imaginary parts of a rotation, at most; some round them.
const MOST_LENGTH: f64 = 1.01;

/// Reads a file with its samples in it, or those beside its header, given either file.
pub(super) fn load(path: &Path, component: u32) -> Result<VoxelGrid, Error> {
    let ending = path.extension().unwrap_or_default().to_ascii_lowercase();
    let (header_path, data_path) = if ending == "hdr" {
        (path.to_owned(), Some(beside(path, ["img", "IMG"], "samples (.img)")?))
    } else if ending == "img" {
        file::open(path, Asset::Volume)?;
        (beside(path, ["hdr", "HDR"], "header (.hdr)")?, Some(path.to_owned()))
    } else {
        (path.to_owned(), None)
    };
    let (file, size_bytes) = file::open(&header_path, Asset::Volume)?;
    if ending == "gz" {
        return packed(BufReader::new(file), size_bytes, component).map_err(|fault| malformed(path, fault));
    }
    let mut input = BufReader::new(file);
    let header = header(&mut input, data_path.is_none()).map_err(|fault| malformed(&header_path, fault))?;
    let Some(data) = data_path else {
        return header.grid(input, size_bytes, component).map_err(|fault| malformed(path, fault));
    };
    let (file, size_bytes) = file::open(&data, Asset::Volume)?;
    header.grid(BufReader::new(file), size_bytes, component).map_err(|fault| malformed(&data, fault))
}

/// Reads a file that is packed as a whole.
fn packed(input: impl BufRead, size_bytes: u64, component: u32) -> Result<VoxelGrid, Fault> {
    let mut input = unpacked(input).map_err(|error| Fault::foreign(Place::Whole, &error))?;
    header(&mut input, true)?.grid_of_stream(input, size_bytes, component)
}

/// The other file of two.
pub(super) fn data_path(path: &Path) -> Result<Option<PathBuf>, Error> {
    let ending = path.extension().unwrap_or_default().to_ascii_lowercase();
    let others = if ending == "hdr" { ["img", "IMG"] } else { ["hdr", "HDR"] };
    if ending == "nii" { Ok(None) } else { beside(path, others, "other file").map(Some) }
}

fn beside(path: &Path, endings: [&str; 2], what: &str) -> Result<PathBuf, Error> {
    let fault = |name: &str| format!("it lacks its {what}; put that beside it, named {name}");
    file::first_beside(path, &endings, |name| malformed(path, Fault::new(Place::Whole, fault(name))))
}

/// The bytes of a header and their order.
struct Bytes {
    bytes: [u8; HEADER_BYTES],
    order: ByteOrder,
}

impl Bytes {
    fn at<const N: usize>(&self, offset: usize) -> [u8; N] {
        let mut bytes: [u8; N] = std::array::from_fn(|i| self.bytes[offset + i]);
        if self.order == ByteOrder::Big {
            bytes.reverse();
        }
        bytes
    }

    fn short(&self, offset: usize) -> i16 {
        i16::from_le_bytes(self.at(offset))
    }

    fn float(&self, offset: usize) -> f32 {
        f32::from_le_bytes(self.at(offset))
    }

    fn vector(&self, offset: usize) -> DVec3 {
        DVec3::from([0, 4, 8].map(|more| f64::from(self.float(offset + more))))
    }
}

fn at(offset: usize, reason: impl Into<String>) -> Fault {
    Fault::new(Place::Byte(offset), reason)
}

/// Reads the header; `is_one_file` has its samples behind it.
fn header(input: &mut impl Read, is_one_file: bool) -> Result<Header, Fault> {
    let mut bytes = Bytes { bytes: [0; HEADER_BYTES], order: ByteOrder::Little };
    let read = input.read_exact(&mut bytes.bytes);
    read.map_err(|_| Fault::new(Place::Whole, format!("it has no header of {HEADER_BYTES} bytes; it is cut off")))?;
    match i32::from_le_bytes(bytes.at(0)) {
        348 => {}
        540 => return Err(at(0, "it is NIfTI-2; save the volume as NIfTI-1")),
        0x5c01_0000 => bytes.order = ByteOrder::Big,
        _ => return Err(at(0, "it does not begin as NIfTI-1 does; it is damaged or something else")),
    }
    let magic = &bytes.bytes[344..];
    if !(magic == b"n+1\0" && is_one_file || magic == b"ni1\0" && !is_one_file) {
        let expected = if is_one_file { "n+1" } else { "ni1" };
        return Err(at(344, format!("its magic is not {expected}; it is damaged, or a scan of the older Analyze 7.5")));
    }
    let axes = bytes.short(40);
    if !(3..=7).contains(&axes) {
        return Err(at(40, format!("dim[0] is {axes}; a volume has 3 dimensions or more")));
    }
    let mut dimensions = [0; 7];
    for (axis, dimension) in (1..).zip(&mut dimensions[..axes as usize]) {
        let (offset, count) = (40 + 2 * axis, bytes.short(40 + 2 * axis));
        *dimension = u64::try_from(count)
            .map_err(|_| at(offset, format!("dim[{axis}] is {count}; no axis has fewer samples than 0")))?;
    }
    let [x, y, z, rest @ ..] = dimensions;
    let size = check_size([x, y, z]).map_err(|reason| at(42, format!("dim {reason}")))?;
    // Times, and values of a sample: each a volume of its own. Many writers call one 0.
    let components = rest.into_iter().map(|count| count.max(1)).product();
    let (code, bits) = (bytes.short(70), bytes.short(72));
    let kind = kind(code)?;
    let own_bits = 8 * kind.bytes();
    // Some writers leave it out.
    if bits != 0 && u64::try_from(bits) != Ok(own_bits) {
        let reason = format!("bitpix is {bits}, but a sample of datatype {code} has {own_bits} bits; it is damaged");
        return Err(at(72, reason));
    }
    let raw = Raw { size, kind, order: bytes.order, components, together: size.map(u64::from).iter().product() };
    raw.bytes()?;
    let steps = steps(&bytes)?;
    check_steps(steps)?;
    let offset = bytes.float(108);
    if !(0.0..1e9).contains(&offset) {
        return Err(at(108, format!("vox_offset is {offset}, no offset of samples")));
    }
    // In a file of their own samples may begin anywhere. Behind a header they begin after its four bytes of extensions, which many
    // writers call 0.
    let offset = offset as u64;
    if is_one_file && offset > 0 && offset < FIRST_SAMPLE {
        return Err(at(108, format!("vox_offset is {offset}; samples begin at {FIRST_SAMPLE} or behind")));
    }
    let behind = if is_one_file { offset.max(FIRST_SAMPLE) - HEADER_BYTES as u64 } else { offset };
    let (slope, intercept) = (bytes.float(112), bytes.float(116));
    let is_scaled = slope != 0.0 && slope.is_finite() && intercept.is_finite();
    let scale = if is_scaled { Scale { slope, intercept } } else { Scale::PLAIN };
    Ok(Header { raw, steps, skip_lines: 0, skip: Skip::Bytes(behind), is_packed: false, scale })
}

fn kind(code: i16) -> Result<Kind, Fault> {
    Ok(match code {
        2 => Kind::Unsigned8,
        4 => Kind::Signed16,
        8 => Kind::Signed32,
        16 => Kind::Float32,
        64 => Kind::Float64,
        256 => Kind::Signed8,
        512 => Kind::Unsigned16,
        768 => Kind::Unsigned32,
        1024 => Kind::Signed64,
        1280 => Kind::Unsigned64,
        _ => {
            let reason = format!("datatype is {code}; integers of 8 to 64 bits, floats and doubles can be read");
            return Err(at(70, reason));
        }
    })
}

/// The steps of the axes by sform, else by qform, else by the distances alone; to the left, backwards and up, where the
/// format has right, anterior and superior.
fn steps(bytes: &Bytes) -> Result<[DVec3; 3], Fault> {
    let turned = |step: DVec3| step * DVec3::new(-1.0, -1.0, 1.0);
    if bytes.short(254) > 0 {
        let [x, y, z] = [280, 296, 312].map(|offset| bytes.vector(offset));
        return Ok([0, 1, 2].map(|axis| turned(DVec3::new(x[axis], y[axis], z[axis]))));
    }
    let distances = bytes.vector(80);
    let axes = [DVec3::X, DVec3::Y, DVec3::Z];
    if bytes.short(252) <= 0 {
        return Ok([0, 1, 2].map(|axis| turned(axes[axis] * distances[axis].abs())));
    }
    let imaginary = bytes.vector(256);
    let (length, [b, c, d]) = (imaginary.length(), imaginary.to_array());
    let is_rotation = length <= MOST_LENGTH;
    if !is_rotation {
        let reason =
            format!("quatern_b, quatern_c and quatern_d have the length {length}; it is at most 1 in a rotation");
        return Err(at(256, reason));
    }
    // Rounding may leave nothing for the real part.
    let a = (1.0 - b * b - c * c - d * d).max(0.0).sqrt();
    let rotation = DQuat::from_xyzw(b, c, d, a).normalize();
    let handed = if bytes.float(76) < 0.0 { -1.0 } else { 1.0 };
    let signs = DVec3::new(1.0, 1.0, handed);
    Ok([0, 1, 2].map(|axis| turned(rotation * axes[axis] * distances[axis].abs() * signs[axis])))
}
