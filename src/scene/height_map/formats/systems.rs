//! Systems of coordinates and heights that EPSG numbers and names.

use std::ops::RangeInclusive;

/// Systems of EPSG in the metres of Web Mercator.
pub(super) const WEB_MERCATOR: [u16; 2] = [3_785, 3_857];
/// Vertical systems of EPSG in feet.
pub(super) const HEIGHTS_IN_FEET: [u16; 15] =
    [5_614, 5_702, 5_754, 6_130, 6_131, 6_132, 6_358, 6_359, 6_360, 8_050, 8_051, 8_052, 8_053, 8_228, 8_897];
/// Projected systems of EPSG in other units than metres whose names do not say so.
pub(super) const NOT_IN_METRES: [RangeInclusive<u16>; 39] = [
    2_066..=2_066,
    2_136..=2_136,
    2_155..=2_155,
    2_159..=2_160,
    2_194..=2_194,
    2_204..=2_204,
    2_964..=2_964,
    3_080..=3_080,
    3_102..=3_102,
    3_139..=3_140,
    3_167..=3_167,
    3_407..=3_407,
    3_561..=3_565,
    3_991..=3_992,
    4_455..=4_456,
    5_472..=5_472,
    5_588..=5_588,
    5_589..=5_589,
    5_623..=5_625,
    6_128..=6_141,
    6_200..=6_202,
    6_391..=6_391,
    6_966..=6_966,
    7_057..=7_070,
    8_518..=8_540,
    10_481..=10_481,
    22_300..=22_300,
    24_100..=24_100,
    24_370..=24_374,
    24_382..=24_382,
    24_571..=24_571,
    26_729..=26_813,
    27_291..=27_292,
    29_371..=29_385,
    29_871..=29_871,
    30_200..=30_200,
    32_001..=32_058,
    32_074..=32_077,
    32_099..=32_099,
];

/// Metres of the foot that a system's name tells of as EPSG's names do.
pub(super) fn foot_m(name: &str) -> Option<f64> {
    if name.contains("(ftUS)") {
        return Some(1_200.0 / 3_937.0);
    }
    name.contains("(ft)").then_some(0.3048)
}

#[cfg(test)]
mod tests {
    use crate::scene::HeightMap;
    use crate::scene::error::Fault;
    use crate::scene::height_map::formats::geotiff;
    use glam::DVec2;
    use std::io::Cursor;
    use tiff::encoder::TiffEncoder;
    use tiff::encoder::colortype::Gray16;

    /// A GeoTIFF of projected coordinates, with these keys behind the first, and the names of its systems.
    fn projected(keys: &[(u16, u16)], names: &str) -> Result<HeightMap, Fault> {
        let mut bytes = Cursor::new(Vec::new());
        let mut encoder = TiffEncoder::new(&mut bytes).unwrap();
        let mut image = encoder.new_image::<Gray16>(2, 2).unwrap();
        let mut directory = vec![1_u16, 1, 0, 2 + keys.len() as u16, 1_024, 0, 1, 1];
        directory.extend([1_026, 34_737, names.len() as u16, 0]);
        keys.iter().for_each(|&(key, value)| directory.extend([key, 0, 1, value]));
        let tags = image.encoder();
        tags.write_tag(tiff::tags::Tag::GeoKeyDirectoryTag, &directory[..]).unwrap();
        tags.write_tag(tiff::tags::Tag::Unknown(34_737), names).unwrap();
        tags.write_tag(tiff::tags::Tag::ModelPixelScaleTag, &[100.0_f64, 100.0, 0.0][..]).unwrap();
        tags.write_tag(tiff::tags::Tag::ModelTiepointTag, &[0.0_f64, 0.0, 0.0, 500.0, 5_870_100.0, 0.0][..]).unwrap();
        image.write_data(&[1, 2, 7, 4]).unwrap();
        let bytes = bytes.into_inner();
        geotiff::parse(bytes.len() as u64, Cursor::new(bytes), 0)
    }

    /// GDAL writes neither unit of a projected system with one of heights.
    #[test]
    fn units_of_systems_with_heights_are_those_of_their_names() {
        let spacing_m = |system: u16, heights: u16, names: &str| {
            projected(&[(3_072, system), (4_096, heights)], names).map(|map| map.spacing_m().x)
        };
        assert_eq!(spacing_m(2_056, 5_703, "CH1903+ / LV95 + NAVD88 height|"), Ok(100.0));
        let us_foot_m = 100.0 * (1_200.0 / 3_937.0);
        assert_eq!(spacing_m(2_225, 5_703, "NAD83 / California zone 1 (ftUS) + NAVD88 height|"), Ok(us_foot_m));
        assert_eq!(spacing_m(2_222, 5_703, "NAD83 / Arizona East (ft) + NAVD88 height|"), Ok(100.0 * 0.3048));
        let refused = |system, heights, names| spacing_m(system, heights, names).unwrap_err().to_string();
        let unnamed = refused(26_741, 5_703, "NAD27 / California zone I + NAVD88 height|");
        assert!(unnamed.starts_with("ProjectedCSType: EPSG:26741 is not in metres") && unnamed.contains("gdalwarp"));
        for (heights, names) in [
            (6_360, "CH1903+ / LV95 + NAVD88|"),
            (32_767, "CH1903+ / LV95 + a datum of their own (ftUS)|"),
            (8_228, "x|"),
        ] {
            let in_feet = refused(2_056, heights, names);
            assert!(in_feet.starts_with("VerticalCSType: its heights are in \"feet\""), "{in_feet}");
        }
        // A unit that is named counts.
        let named = projected(&[(3_072, 26_741), (3_076, 9_001)], "NAD27 / California zone I|");
        assert_eq!(named.unwrap().spacing_m(), DVec2::splat(100.0));
    }

    #[test]
    fn web_mercator_is_refused_with_the_spacing_on_the_ground() {
        for keys in [&[(3_072, 3_857)][..], &[(3_072, 3_857), (3_076, 9_001)], &[(3_072, 3_785)]] {
            let message = projected(keys, "WGS 84 / Pseudo-Mercator|").unwrap_err().to_string();
            // 46.6 degrees north.
            assert!(message.contains("a metre of Web Mercator is 0.688 m of the ground"), "{message}");
            assert!(message.contains("gdalwarp") && message.contains("`spacing` 68.76"), "{message}");
        }
    }
}
