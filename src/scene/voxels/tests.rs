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

const NRRD: &str = "NRRD0004\n# a comment: with a colon\ntype: short\ndimension: 3\nsizes: 3 2 2\nendian: little\n\
    encoding: raw\nspace: right-anterior-superior\nspace directions: (0.5,0,0) (0, 2,0) (0,0.1,3)\nkey:=value: x\n\n";

fn shorts(values: impl IntoIterator<Item = i16>) -> Vec<u8> {
    values.into_iter().flat_map(i16::to_le_bytes).collect()
}

fn nrrd(header: &str, samples: &[u8]) -> Vec<u8> {
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
        (("sizes: 3 2 2", "sizes: 3 2 -2"), "line 5: sizes is \"-2\", not a number"),
        (("sizes: 3 2 2", "sizes: 3 0 2"), "line 5: sizes asks for 3 x 0 x 2 samples"),
        (("sizes: 3 2 2", "sizes: 65536 65536 65536"), "are more than a file has"),
        (("sizes: 3 2 2", "sizes: 3 2 3"), "24 bytes of samples, but 3 x 2 x 3 of 2 bytes each make 36; it is cut off"),
        (("endian: little", "endian: middle"), "line 6: endian is \"middle\""),
        (("endian: little\n", ""), "no field endian: add little or big"),
        (("encoding: raw", "encoding: hex"), "line 7: encoding is \"hex\"; save the volume with encoding raw"),
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
    ] {
        let header = NRRD.replace(change.0, change.1);
        assert_ne!(header, NRRD, "{part}");
        let found = message(&[("a.nrrd", &nrrd(&header, &bytes))]);
        assert!(found.contains(part), "{part}: {found}");
    }
    assert!(message(&[("a.nrrd", b"")]).contains("does not begin with NRRD"));
    assert!(message(&[("a.nrrd", &[b"NRRD0004\n".as_slice(), &vec![b'a'; 2 << 20]].concat())]).contains("1 MiB"));
    assert!(message(&[("a.vol", b"")]).contains("unknown file ending \"vol\"; known endings are .nrrd"));
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
    #![proptest_config(ProptestConfig::with_cases(512))]

    #[test]
    fn damage_is_refused_or_read(at in 0_usize..250, byte: u8, length in 0_usize..250) {
        let mut bytes = nrrd(NRRD, &shorts(0..12));
        let last = bytes.len() - 1;
        bytes[at.min(last)] = byte;
        bytes.truncate(length.max(4));
        match loaded(&[("a.nrrd", &bytes)], 0) {
            Ok(grid) => prop_assert_eq!(grid.samples().len() as u64, grid.size().map(u64::from).iter().product::<u64>()),
            Err(error) => prop_assert!(!error.to_string().contains('\n') && error.to_string().len() < 1_000),
        }
    }
}
