use super::*;
use crate::scene::{HeightMapSource, Samples};
use glam::DVec2;
use proptest::prelude::*;
use sha2::{Digest, Sha256};
use std::path::PathBuf;

fn asset(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/maps").join(name)
}

fn load_asset(name: &str) -> HeightMap {
    load(&asset(name), 0).unwrap_or_else(|error| panic!("{error}"))
}

fn heights(map: &HeightMap) -> Vec<f32> {
    let (width, height) = (map.width(), map.height());
    (0..height).flat_map(|row| (0..width).map(move |column| map.height_m(column, row))).collect()
}

/// Samples of the topobathy files in 16 bits that are void.
fn is_void(column: u32, row: u32) -> bool {
    (60..71).contains(&column) && (40..47).contains(&row)
}

#[test]
fn files_written_by_gdal_hold_the_same_heights() {
    let reference = load_asset("topobathy-int16.asc");
    assert_eq!((reference.width(), reference.height(), reference.voids()), (120, 91, 77));
    // The first line of the text file.
    assert_eq!([0, 1, 2, 119].map(|column| reference.height_m(column, 0)), [989.0, 943.0, 635.0, 1_015.0]);
    assert!(matches!(reference.samples(), Samples::Steps { step_m: 1.0, .. }));
    for name in [
        "topobathy-int16.tif",
        "topobathy-int16-deflate-tiled.tif",
        "topobathy-int16-lzw-big.tif",
        "topobathy-int16.bil",
        "topobathy-int16.hdr",
    ] {
        let map = load_asset(name);
        assert_eq!(map.samples(), reference.samples(), "{name}");
        assert_eq!(map.voids(), 77, "{name}");
        let (place, expected) = (map.geographic().unwrap(), reference.geographic().unwrap());
        assert!(
            (place.west_deg - expected.west_deg).abs() < 1e-9 && (place.north_deg - expected.north_deg).abs() < 1e-9
        );
        assert!((map.spacing_m() / reference.spacing_m() - 1.0).abs().max_element() < 1e-9, "{name}");
    }
    let raised: Vec<f32> = heights(&reference).iter().map(|height| height + 2_000.0).collect();
    let png = load_asset("topobathy-2000m-uint16.png");
    assert_eq!((heights(&png), png.voids(), png.spacing_m()), (raised, 77, DVec2::ONE));
    let coarse = load_asset("topobathy-uint8.png");
    for (row, column) in (0..91).flat_map(|row| (0..120).map(move |column| (row, column))) {
        let expected = ((reference.height_m(column, row) + 1_500.0) / 15.0).floor();
        assert!(is_void(column, row) || coarse.height_m(column, row) == expected, "{column}, {row}");
    }
}

#[test]
fn floating_point_files_written_by_gdal_are_exact() {
    let reference = load_asset("topobathy-float.bil");
    assert_eq!((reference.range_m(), reference.voids()), ((-1_437.0, 2_205.0), 0));
    assert!(matches!(reference.samples(), Samples::Float(_)));
    for name in ["topobathy-float-deflate.tif", "topobathy-float-lzw-tiled.tif"] {
        assert_eq!(load_asset(name).samples(), reference.samples(), "{name}");
    }
    // The 16-bit files are this map, rounded, with a hole in it: what fills the hole is near what was there.
    let rounded = load_asset("topobathy-int16.tif");
    let mut worst_m = 0.0_f32;
    for (row, column) in (0..91).flat_map(|row| (0..120).map(move |column| (row, column))) {
        let error_m = (rounded.height_m(column, row) - reference.height_m(column, row)).abs();
        assert!(is_void(column, row) || error_m <= 0.5);
        worst_m = worst_m.max(error_m);
    }
    assert!((1.0..900.0).contains(&worst_m), "{worst_m}");
}

#[test]
fn a_tile_written_by_gdal_is_read() {
    // GDAL's own tile of 2.9 MB is not shipped. It holds the nearest samples of the 16-bit map; its checksum shows that
    // these bytes are GDAL's.
    let map = load_asset("topobathy-int16.asc");
    let sample = |column: u32, row: u32| {
        let (x, y) = (column * 120 / 1_201, row * 91 / 1_201);
        if is_void(x, y) { i16::MIN } else { map.height_m(x, y) as i16 }
    };
    let places = (0..1_201).flat_map(|row| (0..1_201).map(move |column| (column, row)));
    let bytes: Vec<u8> = places.clone().flat_map(|(column, row)| sample(column, row).to_be_bytes()).collect();
    assert_eq!(sha256(&bytes), "418f24bf33f41a9d2f32732c12115bad0ce37bd2c484909d3418cc63b6b22616");
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("N42W072.hgt");
    std::fs::write(&path, bytes).unwrap();
    let tile = load(&path, 0).unwrap();
    let voids = places.clone().filter(|(column, row)| sample(*column, *row) == i16::MIN).count();
    assert_eq!((tile.width(), tile.height(), tile.voids()), (1_201, 1_201, voids as u64));
    for (column, row) in places {
        let expected = sample(column, row);
        assert!(expected == i16::MIN || tile.height_m(column, row) == f32::from(expected), "{column}, {row}");
    }
    let place = tile.geographic().unwrap();
    assert_eq!((place.west_deg, place.north_deg, place.step_deg), (-72.0, 43.0, DVec2::splat(1.0 / 1_200.0)));
}

#[test]
fn real_maps_lie_where_they_should() {
    let jacksboro = HeightMapSource::Jacksboro.load().unwrap();
    // 3 arc-seconds at 36.6 N.
    let spacing_m = jacksboro.spacing_m();
    assert!((spacing_m - DVec2::new(74.6, 92.5)).abs().max_element() < 0.1, "{spacing_m}");
    let place = jacksboro.geographic().unwrap();
    assert!((place.west_deg + 84.413_333).abs() < 1e-6 && (place.north_deg - 36.7325).abs() < 1e-6, "{place:?}");
    let lidar = load_asset("lidar-dem.tif");
    assert_eq!((lidar.width(), lidar.height(), lidar.spacing_m(), lidar.geographic()), (400, 400, DVec2::ONE, None));
    let (low_m, high_m) = lidar.range_m();
    assert!((low_m - 379.7).abs() < 0.1 && (high_m - 410.8).abs() < 0.1, "{low_m} to {high_m}");
    let maunga_whau = HeightMapSource::MaungaWhau.load().unwrap();
    assert_eq!(maunga_whau.spacing_m(), DVec2::splat(10.0));
    // The crater is a basin inside the summit's rim.
    assert!(maunga_whau.height_m(30, 60) > 150.0);
}

#[test]
fn shipped_maps_are_listed_with_their_checksums() {
    let list = std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/README.md")).unwrap();
    let mut count = 0;
    for entry in std::fs::read_dir(asset("")).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_string_lossy();
        let checksum = sha256(&std::fs::read(&path).unwrap());
        let listed = list.lines().any(|line| line.contains(&format!("`{name}`")) && line.contains(&checksum));
        assert!(listed, "{name} {checksum}");
        count += 1;
    }
    assert_eq!(count, 17);
}

fn sha256(bytes: &[u8]) -> String {
    Sha256::digest(bytes).iter().map(|byte| format!("{byte:02x}")).collect()
}

/// A directory with the 16-bit raster of `topobathy` under the name `map`, changed.
fn raster(
    ending: &str,
    header: impl Fn(&str) -> String,
    data: impl Fn(Vec<u8>) -> Vec<u8>,
) -> Result<HeightMap, String> {
    let directory = tempfile::tempdir().unwrap();
    let path = |ending: &str| directory.path().join("map").with_extension(ending);
    let text = std::fs::read_to_string(asset("topobathy-int16.hdr")).unwrap();
    std::fs::write(path("hdr"), header(&text)).unwrap();
    std::fs::write(path(ending), data(std::fs::read(asset("topobathy-int16.bil")).unwrap())).unwrap();
    let folder = directory.path().join("").display().to_string();
    load(&path(ending), 0).map_err(|error| error.to_string().replace(&folder, ""))
}

#[test]
fn byte_order_padding_and_skipped_bytes_change_nothing() {
    let reference = load_asset("topobathy-int16.bil");
    // As GTOPO30 ships: big endian, .dem, no pixel type.
    let gtopo30 = raster(
        "dem",
        |text| text.replace("BYTEORDER      I", "BYTEORDER M").replace("PIXELTYPE      SIGNEDINT\n", ""),
        |bytes| bytes.chunks(2).flat_map(|pair| [pair[1], pair[0]]).collect(),
    );
    assert_eq!(gtopo30.unwrap(), {
        // Without a projection, its coordinates are recognised as degrees.
        reference.clone()
    });
    let padded = raster(
        "bsq",
        |text| {
            text.replace("ROWBYTES   240", "ROWBYTES 250").replace("TOTALROWBYTES  240", "TOTALROWBYTES 250")
                + "SKIPBYTES 7\n"
        },
        |bytes| {
            let rows = bytes.chunks(240).flat_map(|row| [row, [9; 10].as_slice()].concat());
            [5; 7].into_iter().chain(rows).collect()
        },
    );
    assert_eq!(padded.unwrap(), reference);
}

#[test]
fn contradictions_between_header_and_data_are_named() {
    let same = |text: &str| text.to_owned();
    for (change, message) in [
        (
            ("NROWS          91", "NROWS 92"),
            "cannot load height map map.bil: its size is 21840 bytes, but its header's SKIPBYTES 0 and NROWS 92 x NCOLS 120 x NBITS 16 make 22080",
        ),
        (
            ("NROWS          91", "NROWS 90"),
            "cannot load height map map.bil: its size is 21840 bytes, but its header's SKIPBYTES 0 and NROWS 90 x NCOLS 120 x NBITS 16 make 21600",
        ),
        (
            ("NCOLS          120", "NCOLS 121"),
            "cannot load height map map.bil: its header contradicts itself: BANDROWBYTES is 240, but NCOLS 121 x NBITS 16 needs 242",
        ),
        (
            ("NCOLS          120", "NCOLS 0"),
            "cannot load height map map.bil: by NCOLS and NROWS of its header, it has 0 x 91 samples; a map has 2 to 65536 a side",
        ),
        (
            ("NBITS          16", "NBITS 32"),
            "cannot load height map map.bil: its header contradicts itself: BANDROWBYTES is 240, but NCOLS 120 x NBITS 32 needs 480",
        ),
        (
            ("NBITS          16", "NBITS 17"),
            "cannot load height map map.hdr: line 6: NBITS is 17; 8, 16 and 32 can be read",
        ),
    ] {
        let error = raster("bil", |text| text.replace(change.0, change.1), |bytes| bytes).unwrap_err();
        assert_eq!(error, message);
    }
    for size in [0, 1, 21_839] {
        let error = raster("bil", same, |mut bytes| {
            bytes.truncate(size);
            bytes
        });
        let error = error.unwrap_err();
        assert!(error.contains(&format!("its size is {size} bytes")), "{error}");
    }
    let error = raster("bil", same, |bytes| {
        bytes.iter().map(|_| 0).zip([0xf1, 0xd8].into_iter().cycle()).map(|(_, byte)| byte).collect()
    });
    assert_eq!(
        error.unwrap_err(),
        "cannot load height map map.bil: all its samples are void; a map needs at least one height"
    );
}

#[test]
fn files_that_cannot_be_read_are_named() {
    let directory = tempfile::tempdir().unwrap();
    let path = |name: &str| directory.path().join(name);
    std::fs::create_dir(path("folder.tif")).unwrap();
    for name in ["empty.hgt", "empty.asc", "empty.tif", "empty.png", "empty", "map.xyz", "alone.bil", "alone2.hdr"] {
        std::fs::write(path(name), "").unwrap();
    }
    for (name, expected) in [
        ("missing.hgt", "cannot read"),
        ("missing.bil", "cannot read"),
        ("folder.tif", "it has no .hgt file; name a folder of SRTM tiles, or a file"),
        ("empty.hgt", "its size is 0 bytes; an SRTM tile has one of"),
        ("empty.asc", "the file ends before its first height"),
        ("empty.tif", "its content is neither TIFF nor PNG"),
        ("empty.png", "its content is neither TIFF nor PNG"),
        ("empty", "unknown file ending \"\"; known endings are .hgt, .hdr, .bil"),
        ("map.xyz", "unknown file ending \"xyz\""),
        ("alone.bil", "its header is missing; put it beside it as alone.hdr"),
        ("alone2.hdr", "its samples are missing; put them beside it as alone2.bil, alone2.dem or alone2.bsq"),
    ] {
        let message = load(&path(name), 0).expect_err(name).to_string();
        assert!(message.contains(expected) && message.contains(name) && !message.contains('\n'), "{message}");
    }
}

#[test]
fn content_tells_a_tiff_or_png_of_any_name() {
    let directory = tempfile::tempdir().unwrap();
    for (from, to) in
        [("topobathy-int16.tif", "a.png"), ("topobathy-int16.tif", "a.gtiff"), ("topobathy-2000m-uint16.png", "b")]
    {
        let path = directory.path().join(to);
        std::fs::copy(asset(from), &path).unwrap();
        assert_eq!(load(&path, 0).unwrap().samples(), load_asset(from).samples());
    }
}

#[test]
fn tiffs_and_pngs_that_are_no_height_map_are_refused() {
    use ::png::{BitDepth, ColorType};
    let picture = |color: ColorType, depth: BitDepth, width: u32, height: u32| {
        let mut bytes = Vec::new();
        let mut encoder = ::png::Encoder::new(&mut bytes, width, height);
        encoder.set_color(color);
        encoder.set_depth(depth);
        let row_bytes = (color.samples() * width as usize * depth as usize).div_ceil(8);
        encoder.write_header().unwrap().write_image_data(&vec![0; row_bytes * height as usize]).unwrap();
        parse("png", bytes).unwrap_err().to_string()
    };
    assert!(picture(ColorType::Rgb, BitDepth::Eight, 3, 3).starts_with("IHDR: it is no grey picture"));
    assert!(picture(ColorType::Grayscale, BitDepth::Four, 3, 3).starts_with("IHDR: it is no grey picture"));
    assert!(picture(ColorType::Grayscale, BitDepth::Eight, 1, 9).starts_with("IHDR: it has 1 x 9 samples"));
    for depth in [BitDepth::Eight, BitDepth::Sixteen] {
        assert!(picture(ColorType::GrayscaleAlpha, depth, 4, 4).contains("all its samples are void"));
        // Of more bytes than a file of its size may take.
        assert!(picture(ColorType::GrayscaleAlpha, depth, 6_200, 6_200).contains("all its samples are void"));
    }
    type Encoder<'a> = tiff::encoder::TiffEncoder<&'a mut Cursor<Vec<u8>>, tiff::encoder::TiffKindStandard>;
    let tiff = |write: &dyn Fn(&mut Encoder<'_>)| {
        let mut bytes = Cursor::new(Vec::new());
        write(&mut tiff::encoder::TiffEncoder::new(&mut bytes).unwrap());
        parse("tif", bytes.into_inner())
    };
    use tiff::encoder::colortype::{Gray16, Gray32Float, RGB8};
    let fault = tiff(&|file| file.write_image::<RGB8>(2, 2, &[0; 12]).unwrap()).unwrap_err();
    assert!(fault.to_string().starts_with("SamplesPerPixel: "), "{fault}");
    let fault = tiff(&|file| file.write_image::<Gray32Float>(2, 2, &[0.0, 1.0, f32::NAN, 2.0]).unwrap()).unwrap_err();
    assert_eq!(fault.to_string(), "row 1, column 0: its height is NaN, not a finite number");
    let tagged = |tag: u16, text: &str| {
        tiff(&|file| {
            let mut image = file.new_image::<Gray16>(2, 2).unwrap();
            image.encoder().write_tag(tiff::tags::Tag::from_u16_exhaustive(tag), text).unwrap();
            image.write_data(&[1, 2, 7, 4]).unwrap();
        })
    };
    assert_eq!(tagged(42_113, " 7 ").unwrap().voids(), 1);
    assert_eq!(tagged(42_113, "void").unwrap_err().to_string(), "GDAL_NODATA: it is \"void\", not a number");
    let metadata = "<GDALMetadata><Item name=\"SCALE\" sample=\"0\" role=\"scale\">0.1</Item></GDALMetadata>";
    assert!(tagged(42_112, metadata).unwrap_err().to_string().contains("gdal_translate -unscale"));
    // Heights of another unit than the metre.
    let of_unit = |unit: &str| {
        let item = format!("<Item name=\"UNITTYPE\" sample=\"0\" role=\"unittype\">{unit}</Item>");
        tagged(42_112, &format!("<GDALMetadata>{item}</GDALMetadata>")).map_err(|fault| fault.to_string())
    };
    for unit in ["m", "metre", "Meters", "m above the sea", ""] {
        assert!(of_unit(unit).is_ok(), "{unit}");
    }
    for unit in ["ft", "US survey foot", "mm"] {
        let fault = of_unit(unit).unwrap_err();
        assert!(fault.starts_with(&format!("GDAL_METADATA: its heights are in {unit:?}; write metres")), "{fault}");
    }
    let of_key = |unit: u16| {
        tiff(&|file| {
            let mut image = file.new_image::<Gray16>(2, 2).unwrap();
            let keys = [1, 1, 0, 1, 4_099, 0, 1, unit];
            image.encoder().write_tag(tiff::tags::Tag::GeoKeyDirectoryTag, &keys[..]).unwrap();
            image.encoder().write_tag(tiff::tags::Tag::ModelPixelScaleTag, &[2.0_f64, 2.0, 0.0][..]).unwrap();
            image.write_data(&[1, 2, 7, 4]).unwrap();
        })
    };
    assert!(of_key(9_001).is_ok());
    assert!(of_key(9_003).unwrap_err().to_string().starts_with("VerticalUnits: its heights are in \"feet\"; write"));
    assert!(of_key(9_036).unwrap_err().to_string().starts_with("VerticalUnits: the unit 9036 of heights is not known"));
}

#[test]
fn a_geotiff_of_too_many_samples_is_refused_with_the_way_out() {
    let side = 40_000;
    // Tag, type (16 or 32 bits) and number: width, height, bits, no compression, black is zero, one strip of all rows.
    let entries: [(u16, u16, u32); 9] = [
        (256, 4, side),
        (257, 4, side),
        (258, 3, 16),
        (259, 3, 1),
        (262, 3, 1),
        (273, 4, 200),
        (277, 3, 1),
        (278, 4, side),
        (279, 4, 2 * side * side),
    ];
    let mut bytes = [&b"II*\0"[..], &8_u32.to_le_bytes(), &(entries.len() as u16).to_le_bytes()].concat();
    for (tag, kind, number) in entries {
        bytes.extend(
            [&tag.to_le_bytes()[..], &kind.to_le_bytes(), &1_u32.to_le_bytes(), &number.to_le_bytes()].concat(),
        );
    }
    bytes.extend([0; 4]);
    let fault = geotiff::parse(2 * u64::from(side).pow(2) + 200, Cursor::new(bytes), 0).unwrap_err().to_string();
    assert!(
        fault.contains("its samples take 3051 MiB, and 2048 are read at most") && fault.contains("gdalbuildvrt"),
        "{fault}"
    );
}

/// Reads bytes as the file of an ending.
fn parse(ending: &str, bytes: Vec<u8>) -> Result<HeightMap, Fault> {
    let size_bytes = bytes.len() as u64;
    match ending {
        "asc" => ascii_grid::parse(size_bytes, bytes.as_slice(), None, false),
        "tif" => geotiff::parse(size_bytes, Cursor::new(bytes), 0),
        "png" => png::parse(size_bytes, Cursor::new(bytes)),
        // The size is as it should be, and the file ends early.
        "hgt" => hgt::parse("N37E140.hgt", 2_884_802, bytes.as_slice()),
        _ => esri::tests::parse_header_and_samples(&bytes),
    }
}

/// Asserts the outcome that any bytes at all must have: a valid map, or a fault told in one line.
fn assert_sound(ending: &str, bytes: Vec<u8>) -> bool {
    match parse(ending, bytes) {
        Ok(map) => {
            let (low_m, high_m) = map.range_m();
            assert!(low_m.is_finite() && high_m.is_finite() && low_m <= high_m);
            assert_eq!(map.samples().len(), map.width() as usize * map.height() as usize);
            assert!(map.spacing_m().is_finite() && map.spacing_m().min_element() > 0.0);
            true
        }
        Err(fault) => {
            let message = fault.to_string();
            assert!(!message.contains(char::is_control) && message.len() < 1_000, "{ending}: {message:?}");
            false
        }
    }
}

/// A valid file of every kind that has a damage worth trying, with its ending.
fn valid_files() -> Vec<(&'static str, Vec<u8>)> {
    let file = |ending, name| (ending, std::fs::read(asset(name)).unwrap());
    let (_, mut raster) = file("hdr", "topobathy-int16.hdr");
    raster.push(0);
    raster.extend(std::fs::read(asset("topobathy-int16.bil")).unwrap());
    vec![
        file("asc", "topobathy-int16.asc"),
        file("tif", "topobathy-int16.tif"),
        file("tif", "topobathy-int16-deflate-tiled.tif"),
        file("tif", "topobathy-int16-lzw-big.tif"),
        file("tif", "topobathy-float-lzw-tiled.tif"),
        file("png", "topobathy-2000m-uint16.png"),
        file("png", "topobathy-uint8.png"),
        ("hdr", raster),
    ]
}

#[test]
fn valid_files_are_read_and_every_truncation_is_a_fault() {
    for (ending, bytes) in valid_files() {
        assert!(assert_sound(ending, bytes.clone()), "{ending}");
        let step = bytes.len().div_ceil(60);
        for end in (0..bytes.len() - 20).step_by(step).chain(1..40) {
            // GDAL writes a PNG's text and the end of a TIFF's last strip, which a reader may never need, last.
            assert!(!assert_sound(ending, bytes[..end].to_vec()) || end + 600 > bytes.len(), "{ending} cut at {end}");
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 1_000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn random_bytes_are_no_panic(bytes in prop::collection::vec(any::<u8>(), 0..400), magic in 0..6_usize) {
        let magic: &[u8] = [b"".as_slice(), PNG_MAGIC, b"II*\0\x08\0\0\0", b"MM\0+\0\x08\0\0", b"ncols 3\nnrows 3\n", b"NROWS 3\nNCOLS 3\n"][magic];
        for ending in ["asc", "tif", "png", "hgt", "hdr"] {
            assert_sound(ending, [magic, &bytes].concat());
        }
    }

    #[test]
    fn damaged_files_are_no_panic(
        file in 0..8_usize,
        damages in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>(), any::<bool>()), 1..6),
    ) {
        let (ending, mut bytes) = valid_files().swap_remove(file);
        for (place, byte, is_near_start) in damages {
            // Headers lie near the start of most files, and TIFF's at the end as well.
            let range = if is_near_start { bytes.len().min(400) } else { bytes.len() };
            bytes[place.index(range)] = byte;
        }
        assert_sound(ending, bytes);
    }
}
