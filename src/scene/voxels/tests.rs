use std::fs;
use std::path::PathBuf;

use glam::DVec3;
use proptest::prelude::*;
use tempfile::TempDir;

use super::*;
use crate::scene::Error;

/// A folder with these files, and the path of the first one.
pub(super) fn written(files: &[(&str, &[u8])]) -> (TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    for (name, bytes) in files {
        fs::write(folder.path().join(name), bytes).unwrap();
    }
    let path = folder.path().join(files[0].0);
    (folder, path)
}

pub(super) fn loaded(files: &[(&str, &[u8])], component: u32) -> Result<VoxelGrid, Error> {
    let (_folder, path) = written(files);
    load(&path, component)
}

fn message(files: &[(&str, &[u8])]) -> String {
    let message = loaded(files, 0).unwrap_err().to_string();
    assert!(!message.contains('\n'), "{message}");
    message
}

pub(super) const NRRD: &str = "NRRD0004\n# a comment: with a colon\ntype: short\ndimension: 3\nsizes: 3 2 2\nendian: little\n\
    encoding: raw\nspace: right-anterior-superior\nspace directions: (0.5,0,0) (0, 2,0) (0,0.1,3)\nkey:=value: x\n\n";

pub(super) fn shorts(values: impl IntoIterator<Item = i16>) -> Vec<u8> {
    values.into_iter().flat_map(i16::to_le_bytes).collect()
}

pub(super) fn nrrd(header: &str, samples: &[u8]) -> Vec<u8> {
    [header.as_bytes(), samples].concat()
}

#[test]
fn an_nrrd_file_is_read_as_teem_writes_it() {
    let samples: Vec<i16> = (0..12).map(|i| 100 * i - 300).collect();
    let bytes = shorts(samples.iter().copied());
    let grid = loaded(&[("a.nrrd", &nrrd(NRRD, &bytes))], 0).unwrap();
    assert_eq!(grid.size(), [3, 2, 2]);
    // To the left and backwards, where the file has right and anterior.
    let steps = [DVec3::new(-0.5, 0.0, 0.0), DVec3::new(0.0, -2.0, 0.0), DVec3::new(0.0, -0.1, 3.0)];
    assert_eq!(grid.steps(), steps);
    let expected: Vec<f32> = samples.iter().map(|&v| f32::from(v)).collect();
    assert_eq!(grid.samples(), expected);

    // The same apart, behind lines and bytes, with its lines ended as elsewhere.
    let named = |skip: &str| format!("{}\ndata file: ./a.raw\n{skip}", NRRD.trim_end());
    let behind = [b"one\ntwo\n12345".as_slice(), &bytes].concat();
    for header in [named("line skip: 2\nbyte skip: 5\n"), named("byte skip: -1\n"), named("byteskip: 13\n")] {
        let header = header.replace('\n', "\r\n");
        let apart = loaded(&[("a.nhdr", header.as_bytes()), ("a.raw", &behind)], 0);
        assert_eq!(apart.unwrap(), grid, "{header}");
    }
    let big = NRRD.replace("endian: little", "endian: BIG").replace("NRRD0004", "NRRD0001");
    let swapped: Vec<u8> = samples.iter().flat_map(|v| v.to_be_bytes()).collect();
    assert_eq!(loaded(&[("a.nrrd", &nrrd(&big, &swapped))], 0).unwrap(), grid);
}

#[test]
fn an_nrrd_file_may_have_components_and_plain_spacings() {
    let of = |fields: &str, samples: &[u8], component| {
        loaded(&[("a.nrrd", &nrrd(&format!("NRRD0002\ntype: uchar\nencoding: raw\n{fields}\n\n"), samples))], component)
    };
    let grid = of("dimension: 3\nsizes: 2 1 2\nspacings: 1 nan 0.25", &[1, 2, 3, 4], 0).unwrap();
    assert_eq!((grid.size(), grid.samples()), ([2, 1, 2], [1.0, 2.0, 3.0, 4.0].as_slice()));
    assert_eq!(grid.steps(), [DVec3::X, DVec3::Y, 0.25 * DVec3::Z]);
    for axis in ["kinds: vector domain domain domain", "space: LPS\nspace directions: none (1,0,0) (0,1,0) (0,0,1)"] {
        let fields = format!("dimension: 4\nsizes: 2 3 1 1\n{axis}");
        let grid = of(&fields, &[1, 10, 2, 20, 3, 30], 1).unwrap();
        assert_eq!((grid.size(), grid.samples()), ([3, 1, 1], [10.0, 20.0, 30.0].as_slice()), "{axis}");
        let error = of(&fields, &[0; 6], 2).unwrap_err().to_string();
        assert!(error.contains("give `volume-component` 0 to 1"), "{error}");
    }
    let last = of("dimension: 4\nsizes: 3 1 1 2\nspacings: 1 1 1 nan", &[1, 2, 3, 10, 20, 30], 1).unwrap();
    assert_eq!(last.samples(), [10.0, 20.0, 30.0]);
    let error = of("dimension: 4\nsizes: 3 1 1 2", &[0; 6], 0).unwrap_err().to_string();
    assert!(error.contains("0 of its 4 axes lie in space"), "{error}");
}

#[test]
fn faults_of_nrrd_files_name_line_and_field() {
    let bytes = shorts(0..12);
    for (change, part) in [
        (("NRRD0004", "nrrd0004"), "byte 0: it does not begin with NRRD"),
        (("type: short", "type: block"), "line 3: type is \"block\""),
        (("type: short\n", ""), "its header has no field type"),
        (("dimension: 3", "dimension: 2"), "line 4: dimension is 2; a volume has 3"),
        (("sizes: 3 2 2", "sizes: 3 2"), "line 5: sizes has 2 items for 3 axes"),
        (("sizes: 3 2 2", "sizes: 3 2 -2"), "line 5: sizes has \"-2\", not a number"),
        (("sizes: 3 2 2", "sizes: 3 0 2"), "line 5: sizes asks for 3 x 0 x 2 samples"),
        (("sizes: 3 2 2", "sizes: 65536 65536 65536"), "are more than a file has"),
        (("sizes: 3 2 2", "sizes: 3 2 3"), "24 bytes of samples, but 3 x 2 x 3 of 2 bytes each make 36; it is cut off"),
        (("endian: little", "endian: middle"), "line 6: endian is \"middle\""),
        (("endian: little\n", ""), "no field endian: add little or big"),
        (("encoding: raw", "encoding: hex"), "line 7: encoding is \"hex\"; save the volume with encoding raw or gzip"),
        (("right-anterior-superior", "lunar"), "line 8: space is \"lunar\""),
        (("(0, 2,0)", "(0,2)"), "line 9: space directions has \"(0,2)\", no vector"),
        (("(0, 2,0)", "(2,0,0)"), "must span space"),
        (("(0, 2,0)", "none"), "2 of its 3 axes lie in space"),
        (("key:=value: x", "sizes: 1 1 1"), "line 10: \"sizes\" stands on line 5 already"),
        (("key:=value: x", "line skip: 9"), "it has no 9 lines to skip"),
        (("key:=value: x", "byte skip: 18446744073709551615"), "0 bytes of samples"),
        (("key:=value: x", "data file: LIST"), "names several files"),
        (("key:=value: x", "data file: ../a.raw"), "it lies outside the folder"),
        (("key:=value: x", "data file: b.raw"), "b.raw"),
        (("key:=value: x", "data file: b\u{1b}.raw"), "line 10: data file is \"b\\u{1b}.raw\", no name of a file"),
    ] {
        let header = NRRD.replace(change.0, change.1);
        assert_ne!(header, NRRD, "{part}");
        let found = message(&[("a.nrrd", &nrrd(&header, &bytes))]);
        assert!(found.contains(part), "{part}: {found}");
    }
    assert!(message(&[("a.nrrd", b"")]).contains("does not begin with NRRD"));
    assert!(message(&[("a.nrrd", &[b"NRRD0004\n".as_slice(), &vec![b'a'; 2 << 20]].concat())]).contains("1 MiB"));
    assert!(message(&[("a.vol", b"")]).contains("unknown file ending \"vol\"; known endings are .nrrd, .nhdr, .mha"));
}

pub(super) const META: &str = "ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\n\
    CompressedData = False\nTransformMatrix = 0 1 0 -1 0 0 0 0 1\nOffset = 1 2 3\nElementSpacing = 0.5 2 3\n\
    DimSize = 3 2 2\nElementType = MET_SHORT\nElementDataFile = LOCAL\n";

#[test]
fn a_metaimage_is_read_as_itk_writes_it() {
    let bytes = shorts((0..12).map(|i| 100 * i - 300));
    let grid = loaded(&[("a.mha", &nrrd(META, &bytes))], 0).unwrap();
    assert_eq!(grid.size(), [3, 2, 2]);
    // Each three numbers of the matrix are the direction of an axis.
    assert_eq!(grid.steps(), [0.5 * DVec3::Y, -2.0 * DVec3::X, 3.0 * DVec3::Z]);
    let expected: Vec<f32> = (0..12).map(|i| (100 * i - 300) as f32).collect();
    assert_eq!(grid.samples(), expected);

    let behind = [b"1234567".as_slice(), &bytes].concat();
    for skip in ["HeaderSize = 7\n", "HeaderSize = -1\n"] {
        let header = META.replace("ElementDataFile = LOCAL", &format!("{skip}ElementDataFile = a.raw"));
        let apart = loaded(&[("a.mhd", header.replace('\n', "\r\n").as_bytes()), ("a.raw", &behind)], 0);
        assert_eq!(apart.unwrap(), grid, "{skip}");
    }
    let channels = META.replace("MET_SHORT", "MET_UCHAR_ARRAY\nElementNumberOfChannels = 2");
    let picked = loaded(&[("a.mha", &nrrd(&channels, &bytes))], 1).unwrap();
    assert_eq!(picked.samples()[0], f32::from(bytes[1]));
    let big = META.replace("MSB = False", "MSB = True");
    let swapped: Vec<u8> = bytes.chunks(2).flat_map(|two| [two[1], two[0]]).collect();
    assert_eq!(loaded(&[("a.mha", &nrrd(&big, &swapped))], 0).unwrap(), grid);
}

#[test]
fn faults_of_metaimages_name_line_and_key() {
    let bytes = shorts(0..12);
    for (change, part) in [
        (("ElementDataFile = LOCAL\n", ""), "its header has no field ElementDataFile"),
        (("= LOCAL", "= LIST"), "line 11: ElementDataFile names several files"),
        (("= LOCAL", "= ../a.raw"), "it lies outside the folder"),
        (("= Image", "= Tube"), "line 1: ObjectType is \"Tube\""),
        (("NDims = 3", "NDims = 2"), "line 2: NDims is \"2\"; a volume has 3"),
        (("DimSize = 3 2 2", "DimSize = 3 2"), "line 9: DimSize has 2 numbers, not 3"),
        (("DimSize = 3 2 2", "DimSize = 3 2 x"), "line 9: DimSize has \"x\", not a number"),
        (("DimSize = 3 2 2", "DimSize = 3 2 9"), "24 bytes of samples, but 3 x 2 x 9 of 2 bytes each make 108"),
        (("BinaryData = True", "BinaryData = False"), "line 3: BinaryData is False; save"),
        (("CompressedData = False", "CompressedData = True"), "corrupt deflate stream"),
        (("MET_SHORT", "MET_STRING"), "line 10: ElementType is \"MET_STRING\""),
        (("MET_SHORT", "MET_SHORT\nElementNumberOfChannels = 0"), "line 11: ElementNumberOfChannels is 0"),
        (("0.5 2 3", "0.5 0 3"), "must span space"),
        (("0.5 2 3", "0.5 1e-300 3"), "1e-300"),
        (("= LOCAL", "= b\0.raw"), "line 11: ElementDataFile is \"b\\0.raw\", no name of a file"),
        (("Offset = 1 2 3", "NDims = 3"), "line 7: \"NDims\" stands on line 2 already"),
    ] {
        let header = META.replace(change.0, change.1);
        assert_ne!(header, META, "{part}");
        let found = message(&[("a.mha", &nrrd(&header, &bytes))]);
        assert!(found.contains(part), "{part}: {found}");
    }
}

/// A header with its samples; `one` in one file.
pub(super) fn nifti(is_big: bool, changes: &[(usize, &[u8])]) -> Vec<u8> {
    let mut bytes = vec![0; 352];
    let swapped = |bytes: &[u8]| if is_big { bytes.iter().rev().copied().collect() } else { bytes.to_vec() };
    let mut put = |at: usize, value: &[u8]| bytes[at..at + value.len()].copy_from_slice(&swapped(value));
    put(0, &348_i32.to_le_bytes());
    for (i, dimension) in [4_i16, 3, 2, 2, 2].into_iter().enumerate() {
        put(40 + 2 * i, &dimension.to_le_bytes());
    }
    put(70, &4_i16.to_le_bytes());
    put(72, &16_i16.to_le_bytes());
    for (i, distance) in [1.0_f32, 0.5, 2.0, 3.0].into_iter().enumerate() {
        put(76 + 4 * i, &distance.to_le_bytes());
    }
    put(108, &352.0_f32.to_le_bytes());
    for (at, value) in changes {
        put(*at, value);
    }
    let place = if changes.iter().any(|(at, _)| *at == 344) { 0 } else { 4 };
    bytes[344..344 + place].copy_from_slice(&b"n+1\0"[..place]);
    let samples = (0..24_i16).map(|i| 100 * i - 300);
    bytes.extend(samples.flat_map(|v| if is_big { v.to_be_bytes() } else { v.to_le_bytes() }));
    bytes
}

#[test]
fn a_nifti_file_is_read_as_scanners_write_it() {
    let load = |bytes: &[u8], component| loaded(&[("a.nii", bytes)], component);
    let [right, front, up] = [DVec3::NEG_X, DVec3::NEG_Y, DVec3::Z];
    let plain = load(&nifti(false, &[]), 0).unwrap();
    assert_eq!((plain.size(), plain.steps()), ([3, 2, 2], [0.5 * right, 2.0 * front, 3.0 * up]));
    let expected: Vec<f32> = (0..12).map(|i| (100 * i - 300) as f32).collect();
    assert_eq!(plain.samples(), expected);
    assert_eq!(load(&nifti(true, &[]), 0).unwrap(), plain);
    let second = load(&nifti(false, &[]), 1).unwrap();
    assert_eq!((second.samples()[0], second.samples()[11]), (900.0, 2000.0));
    assert!(load(&nifti(false, &[]), 2).unwrap_err().to_string().contains("`volume-component` 0 to 1"));

    let floats = |values: &[f32]| values.iter().flat_map(|v| v.to_le_bytes()).collect::<Vec<u8>>();
    let one = 1_i16.to_le_bytes();
    let scaled = load(&nifti(false, &[(112, &floats(&[0.5])), (116, &floats(&[10.0]))]), 0).unwrap();
    assert_eq!(scaled.samples()[1], 0.5 * -200.0 + 10.0);
    // A quarter turn about the vertical, and a hand that is the other one.
    let half = 0.5_f32.sqrt();
    let turned = nifti(false, &[(252, &one), (264, &floats(&[half])), (76, &floats(&[-1.0]))]);
    let [x, y, z] = load(&turned, 0).unwrap().steps();
    assert!((x - 0.5 * front).length() < 1e-6 && (y + 2.0 * right).length() < 1e-6 && (z + 3.0 * up).length() < 1e-6);
    let mut rows = vec![(254_usize, one.to_vec())];
    rows.extend([(284, 2.0_f32), (304, 3.0), (312, 4.0)].map(|(at, value)| (at, floats(&[value]))));
    let rows: Vec<(usize, &[u8])> = rows.iter().map(|(at, bytes)| (*at, bytes.as_slice())).collect();
    assert_eq!(load(&nifti(false, &rows), 0).unwrap().steps(), [4.0 * up, 2.0 * right, 3.0 * front]);

    // Many write none, and mean where samples begin, or the bits of their kind.
    assert_eq!(load(&nifti(false, &[(108, &floats(&[0.0]))]), 0).unwrap(), plain);
    assert_eq!(load(&nifti(false, &[(72, &[0, 0])]), 0).unwrap(), plain);
    // A header and its samples apart, named by either.
    let mut header = nifti(false, &[(108, &floats(&[0.0]))]);
    let samples = header.split_off(352);
    header[344..348].copy_from_slice(b"ni1\0");
    for names in [["a.hdr", "a.img"], ["a.HDR", "a.IMG"]] {
        let (folder, path) = written(&[(names[0], &header), (names[1], &samples)]);
        assert_eq!(super::load(&path, 0).unwrap(), plain);
        assert_eq!(super::load(&folder.path().join(names[1]), 0).unwrap(), plain);
        // Where letters' case is nothing to the system, the name is found in either.
        let found: Vec<_> = companions(&path).iter().map(|file| file.canonicalize().unwrap()).collect();
        assert_eq!(found, [folder.path().join(names[1]).canonicalize().unwrap()]);
    }
    assert!(message(&[("a.hdr", &header)]).contains("it lacks its samples (.img); put that beside it, named a"));
}

#[test]
fn faults_of_nifti_files_name_byte_and_field() {
    let short = |value: i16| value.to_le_bytes().to_vec();
    let float = |value: f32| value.to_le_bytes().to_vec();
    for (change, part) in [
        ((0, 540_i32.to_le_bytes().to_vec()), "byte 0: it is NIfTI-2"),
        ((0, 347_i32.to_le_bytes().to_vec()), "byte 0: it does not begin as NIfTI-1 does"),
        ((344, vec![0; 4]), "byte 344: its magic is not n+1"),
        ((40, short(2)), "byte 40: dim[0] is 2"),
        ((44, short(-2)), "byte 44: dim[2] is -2; no axis has fewer samples than 0"),
        ((44, short(0)), "byte 42: dim asks for 3 x 0 x 2 samples"),
        ((48, short(-1)), "byte 48: dim[4] is -1; no axis"),
        ((42, short(32_767)), "it is cut off"),
        ((70, short(128)), "byte 70: datatype is 128"),
        ((70, short(16)), "byte 72: bitpix is 16, but a sample of datatype 16 has 32 bits; it is damaged"),
        ((72, short(8)), "byte 72: bitpix is 8, but a sample of datatype 4 has 16 bits; it is damaged"),
        ((72, short(-16)), "byte 72: bitpix is -16"),
        (
            (252, [vec![1, 0, 0, 0], float(2.0)].concat()),
            "byte 256: quatern_b, quatern_c and quatern_d have the length 2",
        ),
        ((108, float(-8.0)), "byte 108: vox_offset is -8"),
        ((108, float(f32::NAN)), "byte 108: vox_offset is NaN"),
        ((108, float(348.0)), "byte 108: vox_offset is 348; samples begin at 352"),
        ((108, float(400.0)), "of samples, but 3 x 2 x 2 of 4 bytes each make 48"),
        ((80, float(0.0)), "must span space"),
    ] {
        let found = message(&[("a.nii", &nifti(false, &[(change.0, &change.1)]))]);
        assert!(found.contains(part), "{part}: {found}");
    }
    assert!(message(&[("a.nii", &nifti(false, &[])[..300])]).contains("no header of 348 bytes"));
}

/// Grids that `nanovdb_convert` of OpenVDB 10.0.1 wrote: a block of numbers and a tile over a background, on axes that are
/// exchanged; a mask; the numbers of another.
fn blob() -> Vec<u8> {
    let packed = include_bytes!(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/blob.nvdb.gz"));
    let mut bytes = Vec::new();
    std::io::Read::read_to_end(&mut flate2::bufread::GzDecoder::new(packed.as_slice()), &mut bytes).unwrap();
    bytes
}

#[test]
fn a_nanovdb_file_holds_what_openvdb_put_there() {
    let grid = loaded(&[("blob.nvdb", &blob())], 0).unwrap();
    assert_eq!(grid.size(), [19, 21, 13]);
    // The file's y, which is up, and z, which comes to the front.
    assert_eq!(grid.steps(), [0.5 * DVec3::X, -0.25 * DVec3::Y, -2.0 * DVec3::Z]);
    let expected = |i: i32, j: i32, k: i32| match (i, j, k) {
        (-3..=6, -4..=4, 5..=12) => (i + 3 + 10 * (j + 4) + 100 * (k - 5)) as f32,
        (8..=15, -16..=-9, 0..=7) => 7.5,
        _ => 0.25,
    };
    let places = (0..13).flat_map(|k| (0..21).flat_map(move |j| (0..19).map(move |i| (i - 3, j - 16, k))));
    let expected: Vec<f32> = places.map(|(i, j, k)| expected(i, j, k)).collect();
    assert_eq!(grid.samples(), expected);
    assert_eq!(loaded(&[("blob.nvdb", &blob())], 2).unwrap().samples(), [5.0; 8]);
    let message = |number| loaded(&[("blob.nvdb", &blob())], number).unwrap_err().to_string();
    assert!(message(1).contains("grid 1 holds no floats"), "{}", message(1));
    assert!(message(3).contains("no grid 3: give `volume-component` 0 to 2"), "{}", message(3));
}

/// A grid of one tile of the root for each of some corners, and the box of its samples.
pub(super) fn tiles(corners: &[i32], high: i32) -> Vec<u8> {
    let length = 672 + 64 + 64 + 32 * corners.len();
    let mut bytes = vec![0; 16 + 176 + 2 + length];
    let mut put = |at: usize, value: &[u8]| bytes[at..at + value.len()].copy_from_slice(value);
    put(0, b"NanoVDB0");
    put(8, &(32_u32 << 21).to_le_bytes());
    put(12, &[1, 0]);
    put(16 + 8, &(length as u64).to_le_bytes());
    put(16 + 32, &1_u32.to_le_bytes());
    put(16 + 136, &2_u32.to_le_bytes());
    let grid = 16 + 176 + 2;
    for axis in 0..3 {
        put(grid + 296 + 88 + 32 * axis, &1.0_f64.to_le_bytes());
    }
    put(grid + 672 + 24, &64_u64.to_le_bytes());
    let root = grid + 672 + 64;
    put(root, &[0; 12]);
    [12, 16, 20].iter().for_each(|at| put(root + at, &high.to_le_bytes()));
    put(root + 24, &(corners.len() as u32).to_le_bytes());
    put(root + 28, &0.5_f32.to_le_bytes());
    for (number, corner) in corners.iter().enumerate() {
        let tile = root + 64 + 32 * number;
        let part = u64::from(*corner as u32 >> 12);
        put(tile, &(part << 42 | part << 21 | part).to_le_bytes());
        put(tile + 20, &(number as f32 + 1.0).to_le_bytes());
    }
    bytes
}

#[test]
fn damaged_nanovdb_files_are_refused_within_their_bounds() {
    let load = |bytes: &[u8]| loaded(&[("a.nvdb", bytes)], 0);
    assert_eq!(load(&tiles(&[0], 1)).unwrap().samples(), [1.0; 8]);
    assert_eq!(load(&tiles(&[4096, -4096], 1)).unwrap().samples(), [0.5; 8]);
    let good = tiles(&[0, 4096], 2);
    let changed = |at: usize, value: &[u8]| {
        let mut bytes = good.clone();
        bytes[at..at + value.len()].copy_from_slice(value);
        bytes
    };
    let grid = 16 + 176 + 2;
    for (bytes, part) in [
        (tiles(&[0, 0], 1), "its nodes overlap"),
        (tiles(&[0], -1), "has no active samples"),
        (tiles(&[0], 1 << 30), "an axis has 1 to 65536"),
        (tiles(&[0], 1000), "too many for so small a file"),
        (changed(0, b"nanovdb0"), "byte 0: it does not begin as NanoVDB does"),
        (changed(8, &(33_u32 << 21).to_le_bytes()), "its version is 33"),
        (changed(12, &[0]), "byte 0: a segment of it has no grid"),
        (changed(14, &[1]), "it is compressed"),
        (changed(16 + 8, &u64::MAX.to_le_bytes()), "the file is cut off"),
        (changed(16 + 136, &u32::MAX.to_le_bytes()), "the file is cut off"),
        (changed(grid + 672 + 24, &(-8000_i64).to_le_bytes()), "a node lies before its grid"),
        (changed(grid + 672 + 24, &(i64::MAX - 10_000).to_le_bytes()), "it ends before; it is damaged"),
        (changed(grid + 672 + 128 + 8, &1_u64.to_le_bytes()), "its nodes overlap"),
        (changed(grid + 296 + 88, &f64::NAN.to_le_bytes()), "must span space"),
        (good[..good.len() - 40].to_vec(), "the file is cut off"),
        (good[..100].to_vec(), "the file is cut off"),
        (Vec::new(), "it has no grid 0"),
    ] {
        let found = load(&bytes).expect_err(part).to_string();
        assert!(found.contains(part) && !found.contains('\n'), "{part}: {found}");
    }
}

pub(super) fn gzip(bytes: &[u8]) -> Vec<u8> {
    let mut packer = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    std::io::Write::write_all(&mut packer, bytes).unwrap();
    packer.finish().unwrap()
}

fn zlib(bytes: &[u8]) -> Vec<u8> {
    let mut packer = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::fast());
    std::io::Write::write_all(&mut packer, bytes).unwrap();
    packer.finish().unwrap()
}

#[test]
fn packed_samples_are_those_that_are_not() {
    let bytes = shorts((0..12).map(|i| 100 * i - 300));
    let plain = loaded(&[("a.nrrd", &nrrd(NRRD, &bytes))], 0).unwrap();
    let header = NRRD.replace("encoding: raw", "encoding: gzip");
    assert_eq!(loaded(&[("a.nrrd", &nrrd(&header, &gzip(&bytes)))], 0).unwrap(), plain);
    // Lines are skipped before it is unpacked, bytes behind.
    let apart = format!("{}\ndata file: a.gz\nline skip: 1\nbyte skip: 2\n", header.trim_end());
    let data = [b"a line\n".as_slice(), &gzip(&[&[1, 2], bytes.as_slice()].concat())].concat();
    assert_eq!(loaded(&[("a.nhdr", apart.as_bytes()), ("a.gz", &data)], 0).unwrap(), plain);
    let meta = loaded(&[("a.mha", &nrrd(META, &bytes))], 0).unwrap();
    let packed = META.replace("CompressedData = False", "CompressedData = True\nCompressedDataSize = 40");
    assert_eq!(loaded(&[("a.mha", &nrrd(&packed, &zlib(&bytes)))], 0).unwrap(), meta);
    let scan = loaded(&[("a.nii", &nifti(true, &[]))], 1).unwrap();
    assert_eq!(loaded(&[("a.NII.gz", &gzip(&nifti(true, &[])))], 1).unwrap(), scan);
}

#[test]
fn packed_samples_that_are_damaged_are_refused() {
    let bytes = shorts(0..12);
    let header = NRRD.replace("encoding: raw", "encoding: gz");
    let whole = gzip(&bytes);
    let of = |header: &str, packed: &[u8]| message(&[("a.nrrd", &nrrd(header, packed))]);
    let short = of(&header, &gzip(&bytes[..20]));
    assert!(short.contains("cut off"), "{short}");
    for cut in [0, 5, 12, whole.len() - 1] {
        let found = of(&header, &whole[..cut]);
        assert!(found.contains("cut off") || found.contains("corrupt") || found.contains("deflate"), "{cut}: {found}");
    }
    let mut damaged = whole.clone();
    // The checksum.
    damaged[whole.len() - 6] ^= 1;
    assert!(!of(&header, &damaged).is_empty());
    let end = header.replace("key:=value: x", "byte skip: -1");
    assert!(of(&end, &whole).contains("has its samples at its start"));
    let large = header.replace("sizes: 3 2 2", "sizes: 1000 1000 1000");
    assert!(of(&large, &whole).contains("unpack it first"));
    assert!(message(&[("a.nii.gz", &gzip(&nifti(false, &[])[..300]))]).contains("no header of 348 bytes"));
}

/// The same samples on tilted axes, written by SimpleITK 2.5.7 and by pynrrd 1.1.3.
#[test]
fn files_of_other_writers_hold_the_same() {
    let folder = PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/volumes"));
    let (cosine, sine) = (0.3_f64.cos(), 0.3_f64.sin());
    let steps = [0.5 * DVec3::new(cosine, 0.0, sine), -2.0 * DVec3::Y, 3.0 * DVec3::new(sine, 0.0, -cosine)];
    let places = (0..2).flat_map(|k| (0..3).flat_map(move |j| (0..4).map(move |i| 100 * i + 10 * j + k - 50)));
    let samples: Vec<f32> = places.map(|value: i16| f32::from(value)).collect();
    for name in ["itk.mha", "itk-zlib.mha", "itk.mhd", "itk.nii", "itk.nii.gz", "itk-gzip.nrrd", "pynrrd.nhdr"] {
        let grid = load(&folder.join(name), 0).unwrap();
        assert_eq!((grid.size(), grid.samples()), ([4, 3, 2], samples.as_slice()), "{name}");
        for (found, expected) in grid.steps().iter().zip(&steps) {
            assert!((*found - *expected).length() < 1e-6, "{name}: {found}");
        }
    }
}

#[cfg(unix)]
#[test]
fn samples_without_an_end_are_refused() {
    let header = NRRD.replace("key:=value: x", "data file: a.raw");
    let (folder, path) = written(&[("a.nhdr", header.as_bytes())]);
    std::os::unix::fs::symlink("/dev/zero", folder.path().join("a.raw")).unwrap();
    assert!(matches!(load(&path, 0), Err(Error::Read { .. })));
    fs::remove_file(folder.path().join("a.raw")).unwrap();
    assert!(std::process::Command::new("mkfifo").arg(folder.path().join("a.raw")).status().unwrap().success());
    assert!(matches!(load(&path, 0), Err(Error::NotAFile { .. })));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2_048))]

    #[test]
    fn damage_is_refused_or_read(
        format in 0_usize..5, places in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..4),
        length in prop::option::weighted(0.2, any::<prop::sample::Index>())
    ) {
        let (name, mut bytes) = match format {
            0 => ("a.nrrd", nrrd(NRRD, &shorts(0..12))),
            1 => ("a.mha", nrrd(META, &shorts(0..12))),
            2 => ("a.nii", nifti(false, &[])),
            3 => ("a.nii.gz", gzip(&nifti(true, &[]))),
            _ => ("a.nvdb", tiles(&[0, -4096], 3)),
        };
        for (place, byte) in places {
            let at = place.index(bytes.len());
            bytes[at] = byte;
        }
        bytes.truncate(length.map_or(bytes.len(), |length| length.index(bytes.len())));
        match loaded(&[(name, &bytes)], 0) {
            Ok(grid) => prop_assert_eq!(grid.samples().len() as u64, grid.size().map(u64::from).iter().product::<u64>()),
            Err(error) => prop_assert!(!error.to_string().contains('\n') && error.to_string().len() < 1_000),
        }
    }
}
