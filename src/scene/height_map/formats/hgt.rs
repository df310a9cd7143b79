use crate::scene::HeightMap;
use crate::scene::binary::{ByteOrder, Rows};
use crate::scene::error::{Fault, Place};
use crate::scene::height_map::Geographic;
use crate::scene::height_map::grid::{Grid, Placement};
use glam::DVec2;
use std::io::Read;

/// Columns and rows of a tile of one degree: 3 arc-seconds, 1 arc-second, and 1 arc-second north of 50 degrees.
const SIZES: [(u32, u32); 3] = [(1_201, 1_201), (3_601, 3_601), (1_801, 3_601)];
/// The sample of no height.
pub(super) const VOID: i16 = i16::MIN;

/// An SRTM tile of one degree.
pub(super) struct Tile {
    /// Columns.
    pub(super) width: u32,
    /// Rows.
    pub(super) height: u32,
    /// Latitude of its southern border, degrees.
    south_deg: i32,
    /// Longitude of its western border, degrees.
    west_deg: i32,
    /// Metres, row by row from the north-west; [`VOID`] where there are none.
    pub(super) values: Vec<i16>,
}

/// Columns and rows of a tile of so many bytes.
pub(super) fn size(size_bytes: u64) -> Result<(u32, u32), Fault> {
    let bytes = |(width, height): (u32, u32)| 2 * u64::from(width) * u64::from(height);
    SIZES.iter().copied().find(|size| bytes(*size) == size_bytes).ok_or_else(|| {
        let known = SIZES.map(|size| format!("{} ({} x {})", bytes(size), size.0, size.1)).join(", ");
        Fault::new(Place::Whole, format!("its size is {size_bytes} bytes; an SRTM tile has one of {known}"))
    })
}

/// Latitude and longitude of the south-west corner that a tile's name begins with, degrees.
pub(super) fn corner(name: &str) -> Result<(i32, i32), Fault> {
    named_corner(name).ok_or_else(|| {
        let reason =
            "its name tells no corner; name it after the degrees of its south-west corner, such as N37E140.hgt";
        Fault::new(Place::Whole, reason)
    })
}

/// Reads an SRTM tile: big-endian 16-bit metres, whose size tells the resolution and whose name, such as `N37E140.hgt`,
/// tells the degrees of the south-west corner.
pub(super) fn read(name: &str, size_bytes: u64, input: impl Read) -> Result<Tile, Fault> {
    let (width, height) = size(size_bytes)?;
    let (south_deg, west_deg) = corner(name)?;
    let rows = Rows {
        width: width as usize,
        height: height as usize,
        stride_bytes: 2 * u64::from(width),
        order: ByteOrder::Big,
    };
    Ok(Tile { width, height, south_deg, west_deg, values: rows.read::<i16>(input)? })
}

/// The map of one tile.
pub(super) fn parse(name: &str, size_bytes: u64, input: impl Read) -> Result<HeightMap, Fault> {
    let Tile { width, height, south_deg, west_deg, values } = read(name, size_bytes, input)?;
    let step_deg = DVec2::new(1.0 / f64::from(width - 1), 1.0 / f64::from(height - 1));
    let place = Geographic { west_deg: west_deg.into(), north_deg: f64::from(south_deg) + 1.0, step_deg };
    let (no_data, placement) = (Some(VOID.into()), Placement::Degrees(place));
    Grid { width, height, values, integral: true, no_data, placement }.into_map()
}

fn named_corner(name: &str) -> Option<(i32, i32)> {
    let upper = name.to_ascii_uppercase();
    let signed = |text: &str, positive: char, negative: char, most: i32| {
        let (sign, digits) = match text.chars().next()? {
            letter if letter == positive => (1, &text[1..]),
            letter if letter == negative => (-1, &text[1..]),
            _ => return None,
        };
        let degrees: i32 = digits.bytes().all(|byte| byte.is_ascii_digit()).then(|| digits.parse().ok())??;
        (degrees <= most).then_some(sign * degrees)
    };
    let latitude_deg = signed(upper.get(..3)?, 'N', 'S', 90)?;
    let longitude_deg = signed(upper.get(3..7)?, 'E', 'W', 180)?;
    (latitude_deg < 90).then_some((latitude_deg, longitude_deg))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_tell_the_corner() {
        assert_eq!(named_corner("N37E140.hgt"), Some((37, 140)));
        assert_eq!(named_corner("s01w079.SRTMGL1.HGT"), Some((-1, -79)));
        for name in
            ["", "N37", "bandai.hgt", "N37E1.hgt", "N3xE140.hgt", "N95E140.hgt", "N37E181.hgt", "N-1E140", "é37E140"]
        {
            assert_eq!(named_corner(name), None, "{name}");
        }
    }

    #[test]
    fn a_tile_is_big_endian_with_filled_voids() {
        let mut bytes: Vec<u8> =
            (0..1_201 * 1_201).flat_map(|i: i32| (i % 1_201 - 500).to_be_bytes()[2..].to_vec()).collect();
        bytes[2 * (1_201 * 7 + 5)..][..2].copy_from_slice(&i16::MIN.to_be_bytes());
        let map = parse("N37E140.hgt", bytes.len() as u64, bytes.as_slice()).unwrap();
        assert_eq!((map.width(), map.height(), map.voids()), (1_201, 1_201, 1));
        assert_eq!(map.range_m(), (-500.0, 700.0));
        assert_eq!((map.height_m(0, 0), map.height_m(1_200, 3), map.height_m(5, 7)), (-500.0, 700.0, -495.0));
        let place = map.geographic().unwrap();
        assert_eq!((place.west_deg, place.north_deg), (140.0, 38.0));
        // A degree at 37.5 N is 88.425 km of longitude and 110.987 km of latitude.
        let degree_m = map.spacing_m() * 1_200.0;
        assert!((degree_m.x - 88_425.0).abs() < 5.0 && (degree_m.y - 110_987.0).abs() < 5.0, "{degree_m}");
    }

    #[test]
    fn other_sizes_and_names_are_refused() {
        for size_bytes in [0, 1, 2_884_801, 2_884_803, 25_934_400] {
            let fault = parse("N37E140.hgt", size_bytes, std::io::empty()).unwrap_err().to_string();
            assert!(fault.contains(&size_bytes.to_string()) && fault.contains("2884802 (1201 x 1201)"), "{fault}");
        }
        assert!(parse("bandai.hgt", 2_884_802, std::io::empty()).unwrap_err().to_string().contains("N37E140.hgt"));
        assert_eq!(parse("N37E140.hgt", 2_884_802, [0; 9].as_slice()).unwrap_err().place.to_string(), "row 0: ");
        let void = [0x80, 0].repeat(1_201 * 1_201);
        let fault = parse("N37E140.hgt", void.len() as u64, void.as_slice()).unwrap_err().to_string();
        assert!(fault.contains("all its samples are void"), "{fault}");
    }
}
