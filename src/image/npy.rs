use std::io::{self, Write};

use super::raster::{Raster, Samples};

/// Bytes before the dictionary of format 1.0: the magic string, the version and the dictionary's length.
const PREFIX_BYTES: usize = 10;
/// The format asks that the elements begin at a multiple of this.
const ALIGNMENT_BYTES: usize = 64;

/// Writes a raster as a NumPy array of its own element type and shape (format 1.0, little-endian machines).
pub(super) fn encode(file: &mut impl Write, raster: &Raster) -> io::Result<()> {
    let (element, bytes): (_, &[u8]) = match raster.samples() {
        Samples::F32(values) => ("<f4", bytemuck::cast_slice(values)),
        Samples::U32(values) => ("<u4", bytemuck::cast_slice(values)),
        Samples::I32(values) => ("<i4", bytemuck::cast_slice(values)),
        Samples::U16(values) => ("<u2", bytemuck::cast_slice(values)),
        Samples::U8(values) => ("|u1", values),
    };
    let shape: String = raster.shape().dimensions().iter().map(|length| format!("{length}, ")).collect();
    let dictionary = format!("{{'descr': '{element}', 'fortran_order': False, 'shape': ({shape}), }}");
    let length = (PREFIX_BYTES + dictionary.len() + 1).next_multiple_of(ALIGNMENT_BYTES) - PREFIX_BYTES;
    file.write_all(b"\x93NUMPY\x01\x00")?;
    // At most four lengths of 20 digits.
    file.write_all(&(length as u16).to_le_bytes())?;
    writeln!(file, "{dictionary:<0$}", length - 1)?;
    file.write_all(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The header's dictionary and the data, by the format's description and not by the crate that wrote them.
    fn parse(bytes: &[u8]) -> (String, &[u8]) {
        assert_eq!(&bytes[..8], b"\x93NUMPY\x01\x00");
        let length = usize::from(u16::from_le_bytes([bytes[8], bytes[9]]));
        assert_eq!((10 + length) % 16, 0, "the data must be aligned");
        let header = std::str::from_utf8(&bytes[10..10 + length]).unwrap();
        assert!(header.ends_with('\n'));
        (header.trim_end().replace(' ', ""), &bytes[10 + length..])
    }

    fn written(raster: &Raster) -> Vec<u8> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("x.npy");
        super::super::write(&path, raster).unwrap();
        std::fs::read(path).unwrap()
    }

    fn assert_header(header: &str, descr: &str, shape: &[u64]) {
        let descr = format!("'descr':'{descr}'");
        assert!(header.contains(&descr), "{header} lacks {descr}");
        assert!(header.contains("'fortran_order':False"), "{header}");
        let (_, tuple) = header.split_once("'shape':(").unwrap();
        let (tuple, _) = tuple.split_once(')').unwrap();
        let found = tuple.trim_end_matches(',').split(',');
        let found: Vec<u64> = found.map(|number| number.parse().unwrap()).collect();
        assert_eq!(found, shape);
    }

    #[test]
    fn floats_keep_their_bits_and_the_whole_shape() {
        let mut values: Vec<f32> = (0..2 * 3 * 4 * 2).map(|i| i as f32 * 0.1).collect();
        values[7] = f32::NAN;
        values[8] = f32::NEG_INFINITY;
        let bytes = written(&Raster::image(4, 3, 2, 2, values.clone()).unwrap());
        let (header, data) = parse(&bytes);
        assert_header(&header, "<f4", &[2, 3, 4, 2]);
        let expected: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
        assert_eq!(data, expected);
    }

    #[test]
    fn integers_keep_their_type() {
        let bytes = written(&Raster::table(2, 1, vec![u32::MAX, 1]).unwrap());
        let (header, data) = parse(&bytes);
        assert_header(&header, "<u4", &[2, 1]);
        assert_eq!(data, [255, 255, 255, 255, 1, 0, 0, 0]);
        let bytes = written(&Raster::table(1, 2, vec![-2i32, 1]).unwrap());
        let (header, data) = parse(&bytes);
        assert_header(&header, "<i4", &[1, 2]);
        assert_eq!(data, [254, 255, 255, 255, 1, 0, 0, 0]);
        let bytes = written(&Raster::table(1, 2, vec![258u16, 3]).unwrap());
        let (header, data) = parse(&bytes);
        assert_header(&header, "<u2", &[1, 2]);
        assert_eq!(data, [2, 1, 3, 0]);
        let bytes = written(&Raster::image(2, 1, 1, 1, vec![7u8, 9]).unwrap());
        let (header, data) = parse(&bytes);
        assert_header(&header, "|u1", &[1, 1, 2, 1]);
        assert_eq!(data, [7, 9]);
    }

    #[test]
    fn an_empty_buffer_keeps_its_columns() {
        let bytes = written(&Raster::table(0, 6, Vec::<f32>::new()).unwrap());
        let (header, data) = parse(&bytes);
        assert_header(&header, "<f4", &[0, 6]);
        assert!(data.is_empty());
    }
}
