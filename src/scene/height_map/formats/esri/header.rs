use crate::scene::binary::ByteOrder;
use crate::scene::error::{Fault, Place};
use crate::scene::height_map;
use glam::DVec2;
use std::collections::HashMap;
use std::str::FromStr;

/// Contents of an ESRI `.hdr` file: the layout of the samples beside it.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Header {
    /// Samples in a row (`NCOLS`).
    pub(super) columns: u32,
    /// Number of rows (`NROWS`).
    pub(super) rows: u32,
    /// Type of a sample (`NBITS`, `PIXELTYPE`).
    pub(super) kind: Kind,
    /// Order of a sample's bytes (`BYTEORDER`).
    pub(super) order: ByteOrder,
    /// Bytes before the first row (`SKIPBYTES`).
    pub(super) skip_bytes: u64,
    /// From one row to the next, if the header says so.
    pub(super) stride_bytes: Option<u64>,
    /// Value of a sample without a height (`NODATA`), if there is one.
    pub(super) no_data: Option<f64>,
    /// Centre of the north-west sample, in map coordinates.
    pub(super) north_west: Option<DVec2>,
    /// Steps east and south between samples, in map coordinates, both positive.
    pub(super) step: Option<DVec2>,
}

/// Type of one sample.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Unsigned8,
    Signed8,
    Unsigned16,
    Signed16,
    Unsigned32,
    Signed32,
    Float32,
}

/// Offsets and strides beyond this are no part of a map of 65,536 samples a side.
const MAX_BYTES: u64 = 1 << 40;

impl Header {
    pub(super) fn parse(text: &str) -> Result<Self, Fault> {
        let fields = Fields::parse(text)?;
        let band_count: u32 = fields.number("NBANDS")?.unwrap_or(1);
        if band_count != 1 {
            return Err(fields.fault("NBANDS", format!("is {band_count}; a height map has one band")));
        }
        // With one band, all three layouts are rows of samples.
        if let Some(layout) = fields.upper("LAYOUT").filter(|layout| !["BIL", "BIP", "BSQ"].contains(&layout.as_str()))
        {
            return Err(fields.fault("LAYOUT", format!("is {}, none of BIL, BIP and BSQ", shown(&layout))));
        }
        let order = match fields.upper("BYTEORDER").as_deref() {
            // The format leaves it to the machine, and nearly all are little-endian.
            None | Some("I" | "L" | "LSBFIRST" | "LSB") => ByteOrder::Little,
            Some("M" | "B" | "MSBFIRST" | "MSB") => ByteOrder::Big,
            Some(other) => return Err(fields.fault("BYTEORDER", format!("is {}, neither I nor M", shown(other)))),
        };
        let bytes = |key| -> Result<Option<u64>, Fault> {
            match fields.number(key)? {
                Some(bytes) if bytes > MAX_BYTES => Err(fields.fault(key, format!("is {bytes}, too many bytes"))),
                bytes => Ok(bytes),
            }
        };
        let band_row_bytes = bytes("BANDROWBYTES")?;
        let stride_bytes = bytes("TOTALROWBYTES")?.or(band_row_bytes);
        Ok(Self {
            columns: fields.required("NCOLS")?,
            rows: fields.required("NROWS")?,
            kind: fields.kind()?,
            order,
            skip_bytes: bytes("SKIPBYTES")?.unwrap_or(0),
            stride_bytes,
            no_data: fields.number("NODATA")?,
            north_west: fields.pair("ULXMAP", "ULYMAP")?,
            step: fields.pair("XDIM", "YDIM")?.map_or(Ok(None), |step| {
                if step.is_finite() && step.min_element() > 0.0 {
                    return Ok(Some(step));
                }
                let [x, y] = step.to_array().map(height_map::shown);
                Err(fields.fault("XDIM", format!("and YDIM are {x} and {y}; both have to be positive")))
            })?,
        })
    }
}

/// The lines of a header: a keyword and its value.
struct Fields(HashMap<String, (usize, String)>);

impl Fields {
    fn parse(text: &str) -> Result<Self, Fault> {
        let mut fields = HashMap::new();
        for (line, text) in (1..).zip(text.lines()) {
            let mut tokens = text.split_whitespace();
            let Some(key) = tokens.next().map(str::to_uppercase) else { continue };
            // Other keywords, such as statistics, are of no concern.
            let Some(value) = tokens.next() else { continue };
            let key = if key == "NODATA_VALUE" { "NODATA".to_owned() } else { key };
            if let Some((before, _)) = fields.insert(key.clone(), (line, value.to_owned())) {
                let reason = format!("{} stands on line {before} already", shown(&key));
                return Err(Fault::new(Place::Line(line), reason));
            }
        }
        Ok(Self(fields))
    }

    fn upper(&self, key: &str) -> Option<String> {
        self.0.get(key).map(|(_, value)| value.to_uppercase())
    }

    fn number<T: FromStr>(&self, key: &str) -> Result<Option<T>, Fault> {
        let Some((_, value)) = self.0.get(key) else { return Ok(None) };
        let parsed =
            value.parse().map_err(|_| self.fault(key, format!("is {}, not a number of its kind", shown(value))));
        parsed.map(Some)
    }

    fn required(&self, key: &str) -> Result<u32, Fault> {
        self.number(key)?.ok_or_else(|| Fault::new(Place::Whole, format!("the header has no {key}")))
    }

    /// Two numbers, if both are there.
    fn pair(&self, x: &str, y: &str) -> Result<Option<DVec2>, Fault> {
        Ok(self.number(x)?.zip(self.number(y)?).map(DVec2::from))
    }

    fn kind(&self) -> Result<Kind, Fault> {
        let bits: u32 = self.number("NBITS")?.unwrap_or(8);
        let pixel_type = self.upper("PIXELTYPE");
        Ok(match (bits, pixel_type.as_deref()) {
            (8, None | Some("UNSIGNEDINT")) => Kind::Unsigned8,
            (8, Some("SIGNEDINT")) => Kind::Signed8,
            // GTOPO30 and its like name no pixel type, and their heights are signed.
            (16, None | Some("SIGNEDINT")) => Kind::Signed16,
            (16, Some("UNSIGNEDINT")) => Kind::Unsigned16,
            (32, None | Some("UNSIGNEDINT")) => Kind::Unsigned32,
            (32, Some("SIGNEDINT")) => Kind::Signed32,
            (32, Some("FLOAT")) => Kind::Float32,
            (8 | 16 | 32, Some(other)) => {
                let reason = format!("is {}; with NBITS {bits} it cannot be read", shown(other));
                return Err(self.fault("PIXELTYPE", reason));
            }
            _ => return Err(self.fault("NBITS", format!("is {bits}; 8, 16 and 32 can be read"))),
        })
    }

    fn fault(&self, key: &str, reason: String) -> Fault {
        let place = self.0.get(key).map_or(Place::Whole, |(line, _)| Place::Line(*line));
        Fault::new(place, format!("{key} {reason}"))
    }
}

/// A token of the file, short enough for a message.
fn shown(token: &str) -> String {
    format!("{:?}", token.chars().take(40).collect::<String>())
}

#[cfg(test)]
mod tests {
    use super::*;

    const GTOPO30: &str = "BYTEORDER      M\nLAYOUT       BIL\nNROWS         6000\nNCOLS         4800\nNBANDS        1\n\
        NBITS         16\nBANDROWBYTES         9600\nTOTALROWBYTES        9600\nBANDGAPBYTES         0\n\
        NODATA        -9999\nULXMAP        139.99583333333334\nULYMAP        39.99583333333333\n\
        XDIM          0.00833333333333\nYDIM          0.00833333333333\n";

    #[test]
    fn the_header_of_gtopo30_is_understood() {
        let header = Header::parse(GTOPO30).unwrap();
        assert_eq!((header.columns, header.rows, header.kind), (4_800, 6_000, Kind::Signed16));
        assert_eq!((header.order, header.stride_bytes, header.no_data), (ByteOrder::Big, Some(9_600), Some(-9_999.0)));
        assert_eq!(header.north_west, Some(DVec2::new(139.995_833_333_333_34, 39.995_833_333_333_33)));
        assert_eq!(header.step, Some(DVec2::splat(0.008_333_333_333_33)));
        assert_eq!(header.skip_bytes, 0);
    }

    #[test]
    fn kinds_follow_from_bits_and_pixel_type() {
        let kind = |fields: &str| Header::parse(&format!("nrows 2\nncols 2\n{fields}")).map(|header| header.kind);
        assert_eq!(kind("").unwrap(), Kind::Unsigned8);
        assert_eq!(kind("nbits 8\npixeltype signedint").unwrap(), Kind::Signed8);
        assert_eq!(kind("NBITS 16\nPIXELTYPE UNSIGNEDINT").unwrap(), Kind::Unsigned16);
        assert_eq!(kind("NBITS 32").unwrap(), Kind::Unsigned32);
        assert_eq!(kind("NBITS 32\nPIXELTYPE SIGNEDINT").unwrap(), Kind::Signed32);
        assert_eq!(kind("NBITS 32\nPIXELTYPE FLOAT").unwrap(), Kind::Float32);
        for (fields, message) in [
            ("NBITS 16\nPIXELTYPE FLOAT", "line 4: PIXELTYPE is \"FLOAT\"; with NBITS 16 it cannot be read"),
            ("NBITS 12", "line 3: NBITS is 12; 8, 16 and 32 can be read"),
        ] {
            assert_eq!(kind(fields).unwrap_err().to_string(), message);
        }
    }

    #[test]
    fn faults_name_line_and_field() {
        for (change, message) in [
            (("NROWS         6000", "NROWS -1"), "line 3: NROWS is \"-1\", not a number of its kind"),
            (("NCOLS         4800", ""), "the header has no NCOLS"),
            (("NBANDS        1", "NBANDS 3"), "line 5: NBANDS is 3; a height map has one band"),
            (("LAYOUT       BIL", "LAYOUT ZIP"), "line 2: LAYOUT is \"ZIP\", none of BIL, BIP and BSQ"),
            (("BYTEORDER      M", "BYTEORDER X"), "line 1: BYTEORDER is \"X\", neither I nor M"),
            (
                ("YDIM          0.00833333333333", "YDIM 0"),
                "line 13: XDIM and YDIM are 0.00833333333333 and 0; both have to be positive",
            ),
            (("NODATA        -9999", "NODATA none"), "line 10: NODATA is \"none\", not a number of its kind"),
            (("NODATA        -9999", "NROWS 7"), "line 10: \"NROWS\" stands on line 3 already"),
            (
                ("BANDGAPBYTES         0", "SKIPBYTES 18446744073709551615"),
                "line 9: SKIPBYTES is 18446744073709551615, too many bytes",
            ),
        ] {
            let text = GTOPO30.replace(change.0, change.1);
            assert_ne!(text, GTOPO30);
            assert_eq!(Header::parse(&text).unwrap_err().to_string(), message);
        }
    }
}
