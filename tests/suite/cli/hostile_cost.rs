//! Bounds of a refusal's cost: a second and one more for each 100 MB of the file, 64 MiB and 16 times the file's size.

use std::fmt::Write;
use std::fs;
use std::path::Path;
use std::time::Instant;

use super::program::{Program, burning, caustics, folder, fumarole, gas, terrain};
use crate::common::beside_others;

/// Memory of a program that reads next to nothing, on two threads: what its libraries write to, stacks and heap. The one
/// that takes the most, `caustics`, takes 10 MiB.
const OWN_KIB: usize = 16 << 10;
/// Memory that a refusal may take besides, and as many times what it reads.
const SPARE_KIB: usize = 64 << 10;
const TIMES: usize = 16;

/// A program that is refused `bytes` under `name`, within the rule. A map of 2 x 2 samples, `two.asc`, and a record,
/// `record.json`, lie beside them.
pub(super) fn refused(program: fn() -> Program, name: &str, bytes: &[u8], parts: &[&str]) {
    refused_of(program, &[(name, bytes)], parts);
}

/// As [`refused`], of several files, of which the first is named; one in a folder by that.
pub(super) fn refused_of(program: fn() -> Program, files: &[(&str, &[u8])], parts: &[&str]) {
    let size: usize = files.iter().map(|(_, bytes)| bytes.len()).sum();
    refused_in(OWN_KIB + SPARE_KIB + TIMES * size / 1024, program, files, parts);
}

/// As [`refused_of`], in so much memory.
fn refused_in(limit_kib: usize, program: fn() -> Program, files: &[(&str, &[u8])], parts: &[&str]) {
    let out = folder();
    fs::write(out.path().join("two.asc"), "ncols 2\nnrows 2\ncellsize 1\n1 2\n3 4\n").unwrap();
    fs::write(out.path().join("record.json"), include_str!("../../data/record.json")).unwrap();
    for (name, bytes) in files {
        let path = out.path().join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, bytes).unwrap();
    }
    let name = files[0].0;
    let named = name.split_once('/').map_or(name, |(folder, _)| folder);
    // Private memory that can be written: reserved addresses and mapped files do not count.
    let script = format!(
        "ulimit -c 0; ulimit -d {limit_kib}; timeout -s KILL 60 {}; code=$?; times; exit $code",
        program().arg(out.path().join(named)).for_shell()
    );
    let mut shell = std::process::Command::new("sh");
    shell.arg("-c").arg(&script).current_dir(out.path()).stdin(std::process::Stdio::null());
    // Each thread has a stack of its own, a backtrace reads the whole program, and one without memory may never end.
    shell.env("RAYON_NUM_THREADS", "2").env_remove("RUST_BACKTRACE");
    let output = beside_others(|| shell.output().unwrap());
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{name}: {stderr}");
    assert!(stderr.starts_with("error: ") && stderr.lines().count() == 1, "{name}: {stderr}");
    assert!(!stderr.contains("out of memory"), "{name}: {stderr}");
    for part in parts {
        assert!(stderr.contains(part), "{name}: {part:?} is missing: {stderr}");
    }
    // Half as much again: time on a busy core counts for more.
    let seconds = seconds(&String::from_utf8_lossy(&output.stdout));
    let size: usize = files.iter().map(|(_, bytes)| bytes.len()).sum();
    assert!(seconds < 1.5 * (1.0 + size as f64 / 1e8), "{name}: {seconds} s");
}

/// Processor time of a shell's children, by the second line of its `times`: `0m0.12s 0m0.03s`.
fn seconds(times: &str) -> f64 {
    let words = times.lines().nth(1).unwrap_or_default().split_whitespace();
    let parts = words.filter_map(|word| word.trim_end_matches('s').split_once('m'));
    parts.map(|(minutes, seconds)| 60.0 * minutes.parse::<f64>().unwrap() + seconds.parse::<f64>().unwrap()).sum()
}

pub(super) fn mesh() -> Program {
    caustics("render --mesh")
}

/// The own share is what the programs take, so that none of them spends what the rule grants besides.
#[test]
fn a_tiny_file_takes_no_more_than_the_program() {
    let tiny = |program, name, part| refused_in(OWN_KIB, program, &[(name, &b"{"[..])], &[part]);
    tiny(mesh, "a.obj", "a.obj");
    tiny(|| gas("render --volume-file"), "a.nrrd", "a.nrrd");
    tiny(|| terrain("render --map"), "a.asc", "a.asc");
    tiny(|| terrain("render --variant tiled-compute --stream --map"), "a.tif", "a.tif");
    tiny(|| terrain("collide --bodies"), "a.csv", "a.csv");
    tiny(|| burning("render --mesh box --texture"), "a.png", "a.png");
    tiny(|| burning("render --mesh box --materials"), "a.toml", "a.toml");
    tiny(|| fumarole("compare record.json"), "a.json", "a.json");
    tiny(|| fumarole("report"), "a.json", "a.json");
    tiny(|| fumarole("assemble"), "parts/a.png.part.json", "a.png.part.json");
}

#[test]
fn small_files_of_many_triangles() {
    let list = |item: &str, count: usize| vec![item; count].join(",");
    let gltf = |nodes: usize, primitives: usize, buffers: usize| {
        let roots = (0..nodes).map(|node| node.to_string()).collect::<Vec<_>>().join(",");
        let data = format!(r#"{{"byteLength":3000,"uri":"data:;base64,{}"}}"#, "A".repeat(4000));
        format!(
            r#"{{"asset":{{"version":"2.0"}},"scenes":[{{"nodes":[{roots}]}}],"nodes":[{}],"meshes":[{{"primitives":[{}]}}],
            "buffers":[{}],"bufferViews":[{{"buffer":0,"byteLength":3000}}],"accessors":[{{"bufferView":0,
            "componentType":5126,"count":250,"type":"VEC3","min":[0,0,0],"max":[0,0,0]}}]}}"#,
            list(r#"{"mesh":0}"#, nodes),
            list(r#"{"attributes":{"POSITION":0}}"#, primitives),
            list(&data, buffers)
        )
    };
    refused(mesh, "instances.gltf", gltf(10_000, 9_000, 1).as_bytes(), &["simplify it"]);
    refused(mesh, "objects.gltf", format!("{{\"nodes\":[{}{{}}]}}", "{},".repeat(1 << 20)).as_bytes(), &["objects"]);
    refused(mesh, "buffers.gltf", gltf(1, 1, 500).as_bytes(), &["positive area"]);
    // Files by their names, of which each wants a look by the system.
    let shared = vec![r#"{"byteLength":3,"uri":"two.asc"}"#; 600_000];
    let missing: Vec<String> = (0..600_000).map(|n| format!(r#"{{"byteLength":3,"uri":"{n:07}"}}"#)).collect();
    for (buffers, part) in [(shared.join(","), "it has no scene"), (missing.join(","), "buffer 0: No such file")] {
        let text = format!(r#"{{"asset":{{"version":"2.0"}},"buffers":[{buffers}]}}"#);
        refused(mesh, "names.gltf", text.as_bytes(), &[part]);
    }
    let extras = format!("{{\"extras\":[{}0]}}", "0,".repeat(20_000_000));
    refused(mesh, "extras.gltf", extras.as_bytes(), &["no valid glTF"]);
    let trees = |begin: &str, item: &str, end: &str| format!("{begin}{}0{end}", item.repeat(5_000_000)).into_bytes();
    for item in ["[],", "[0],", "0,"] {
        refused(mesh, "version.gltf", &trees("{\"asset\":{\"version\":[", item, "]}}"), &["expected"]);
        let begin = "{\"asset\":{\"version\":\"2.0\"},\"accessors\":[{\"min\":[";
        refused(mesh, "least.gltf", &trees(begin, item, "]}]}"), &["least.gltf", "expected"]);
        for list in ["accessors", "materials", "samplers", "meshes", "textures", "nodes"] {
            refused(mesh, "list.gltf", &trees(&format!("{{\"{list}\":["), item, "]}"), &["no valid glTF"]);
        }
    }
    let bounds = format!("\"min\":[{}0],\"max\":[{0}0]", "0,".repeat(8));
    let accessor = format!("{{\"count\":1,\"componentType\":5126,\"type\":\"MAT3\",{bounds}}},");
    let accessors = format!("{{\"asset\":{{\"version\":\"2.0\"}},\"accessors\":[{}0]}}", accessor.repeat(200_000));
    refused(mesh, "bounds.gltf", accessors.as_bytes(), &["bounds.gltf"]);
}

#[test]
fn texts_of_many_values() {
    let header = |vertices: usize, faces: usize| {
        format!(
            "ply\nformat ascii 1.0\nelement vertex {vertices}\nproperty float x\nproperty float y\nproperty float z\n\
             element face {faces}\nproperty list uint int vertex_indices\nend_header\n"
        )
    };
    let ply = |name: &str, text: String, part: &str| refused(mesh, name, text.as_bytes(), &[name, part]);
    ply("promised.ply", header(90_000_000, 90_000_000) + &"0 0 0\n".repeat(1 << 20), "leaves them empty");
    ply("points.ply", header(4_000_000, 1) + &"0 0 0\n".repeat(4_000_000) + "3 0 1 2\n", "positive area");
    ply("long.ply", header(3, 1) + "0 0 0\n1 0 0\n0 1 0\n9000000" + &" 0".repeat(9_000_000), "positive area");
    ply("words.ply", header(3, 1) + &"0 ".repeat(9_000_000), "cut off");
    ply("empty.ply", header(3, 9_000_000) + "0 0 0\n1 0 0\n0 1 0\n" + &"0\n".repeat(9_000_000), "leaves them empty");
    ply("blank.ply", header(3, 1) + &"\n".repeat(9_000_000), "a value is missing");
}

#[test]
fn long_polygons() {
    let mut teeth = String::new();
    let count = 60_000;
    for i in 0..count {
        let _ = writeln!(teeth, "v {i} {} 0", if i % 2 == 0 { 1.0 + i as f32 / 60_000.0 } else { 0.0 });
    }
    let face = (1..=count).map(|i| i.to_string()).collect::<Vec<_>>().join(" ");
    refused(mesh, "teeth.obj", format!("{teeth}f {face}\n").as_bytes(), &["face 0", "60000 corners"]);
    let mut ring = "v 0 0 0\nv 1 0 0\nv 0 1 0\n".to_owned();
    ring.push_str(&"f 1 1 1\n".repeat(1 << 20));
    refused(mesh, "points.obj", ring.as_bytes(), &["positive area"]);
    let long = "f".to_owned() + &" 1".repeat(4_000_000);
    refused(mesh, "long.obj", format!("v 0 0 0\nv 1 0 0\n{long}\n").as_bytes(), &["positive area"]);
    // More than a power of two, by which lists grow.
    for (corner, count) in [(" 1", 4_200_000), (" 1//1", 2_100_000), (" 1/1/1", 2_100_000)] {
        let long = format!("v 0 0 0\nv 1 0 0\nvn 1 0 0\nvt 0 0\nf{}\n", corner.repeat(count));
        refused(mesh, "longer.obj", long.as_bytes(), &["positive area"]);
    }
    let distinct: String = (1..1_500_000).map(|i| format!(" {i}")).collect();
    refused(mesh, "names.obj", format!("v 0 0 0\nf 1{distinct}\n").as_bytes(), &["index 1499999 is out of range"]);
}

#[test]
fn headers_that_promise() {
    let header = "ply\nformat binary_little_endian 1.0\nelement vertex 1\nproperty uchar x\nproperty uchar y\n\
                  property uchar z\nelement face 9000000\nproperty list uchar uchar vertex_indices\nend_header\n";
    refused(mesh, "empty.ply", &[header.as_bytes(), &[0; 9_000_003]].concat(), &["leaves them empty"]);
    refused(|| terrain("render --map"), "grid.asc", b"ncols 16384\nnrows 16384\n1 2 3", &["cut off"]);
    let streamed = || terrain("render --variant tiled-compute --stream --map");
    refused(streamed, "strip.tif", &tiff_of_one_strip(16_384), &["one strip"]);
}

/// A TIFF whose samples are one strip, packed by Deflate, of which there is a beginning.
fn tiff_of_one_strip(side: u32) -> Vec<u8> {
    let mut packer = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::best());
    std::io::Write::write_all(&mut packer, &[0; 1 << 16]).unwrap();
    let mut strip = packer.finish().unwrap();
    // As long as the tightest packing of all of them.
    strip.resize(side as usize * side as usize / 1_990, 0);
    // Columns, rows, bits, packing, black is 0, the strip's place, channels, rows of a strip, the strip's bytes.
    let length = strip.len() as u32;
    let tags = [(256, side), (257, side), (258, 8), (259, 8), (262, 1), (273, 8), (277, 1), (278, side), (279, length)];
    let directory = tags.iter().flat_map(|&(tag, value): &(u16, u32)| {
        // A long number.
        [&tag.to_le_bytes()[..], &4_u16.to_le_bytes(), &1_u32.to_le_bytes(), &value.to_le_bytes()].concat()
    });
    let start = [b"II*\0", &(8 + length).to_le_bytes()[..], &strip, &(tags.len() as u16).to_le_bytes()].concat();
    start.into_iter().chain(directory).chain([0; 4]).collect()
}

#[test]
fn mosaics_that_promise() {
    let map = || terrain("render --map");
    let part = |name: &str, (column, row): (u32, u32), side: u32| {
        let size = format!("xSize='{side}' ySize='{side}'");
        format!(
            "<SimpleSource><SourceFilename relativeToVRT='1'>{name}</SourceFilename><SrcRect xOff='0' yOff='0' {size}/>\
             <DstRect xOff='{column}' yOff='{row}' {size}/></SimpleSource>\n"
        )
    };
    let mosaic = |(width, height): (u32, u32), parts: &str| {
        let size = format!("rasterXSize='{width}' rasterYSize='{height}'");
        format!("<VRTDataset {size}>\n<VRTRasterBand>\n{parts}</VRTRasterBand></VRTDataset>").into_bytes()
    };
    let side = 16_384;
    refused(map, "gone.vrt", &mosaic((side, side), &part("gone.asc", (0, 0), side)), &["gone.asc: No such file"]);
    refused(map, "small.vrt", &mosaic((side, side), &part("two.asc", (0, 0), side)), &["leaves two.asc"]);
    let many: String = (0..60_000).map(|i| part("two.asc", (i, 0), 1)).collect();
    let many = many + &part("gone.asc", (0, 0), 1);
    refused(map, "many.vrt", &mosaic((60_000, 2), &many), &["line 60003: gone.asc: No such file"]);
    // Packed parts that are good, before one that is not, and of which no sample is a height.
    let (black, tiff) = (black_png(8_192), black_tiff(8_192));
    let cut = ("cut.asc", &b"ncols 2\nnrows 2\n1 2 3\n"[..]);
    for (name, bytes) in [("black.png", &black), ("black.tif", &tiff)] {
        let small = mosaic((4, 2), &(part(name, (0, 0), 2) + &part("cut.asc", (2, 0), 2)));
        refused_of(map, &[("small.vrt", &small), (name, bytes), cut], &["cut.asc", "3 heights for"]);
        let voids = "<NoDataValue>0</NoDataValue>".to_owned() + &part(name, (0, 0), 8_192);
        let voids = mosaic((8_192, 8_192), &voids);
        refused_of(map, &[("voids.vrt", &voids), (name, bytes)], &["all its samples are void"]);
    }
    // Many packed files, of each of which a corner is taken.
    let names: Vec<String> = (0..40).map(|i| format!("{i}.tif")).collect();
    let corners: String = names.iter().zip(0..).map(|(name, i)| part(name, (2 * i, 0), 2)).collect();
    let corners = mosaic((82, 2), &(corners + &part("cut.asc", (80, 0), 2)));
    let files = [("corners.vrt", &corners[..]), cut].into_iter().chain(names.iter().map(|name| (&name[..], &tiff[..])));
    let parts = ["its packed files unpack to more than 2048 MiB", "COMPRESS=NONE"];
    refused_of(map, &files.collect::<Vec<_>>(), &parts);
    // A file of voids that many parts are cut from.
    let header = &b"NROWS 2000\nNCOLS 2000\nNBITS 16\n"[..];
    let cuts: String = (0..20_000).map(|i| part("zero.bil", (i % 7_200, i / 7_200), 1)).collect();
    let voids = "<NoDataValue>0</NoDataValue>".to_owned() + &part("zero.bil", (0, 0), 2_000) + &cuts;
    let voids = mosaic((7_200, 7_200), &voids);
    let zeros = vec![0; 8_000_000];
    refused_of(map, &[("cuts.vrt", &voids), ("zero.bil", &zeros), ("zero.hdr", header)], &["all its samples are void"]);
    refused(
        map,
        "nodes.vrt",
        &format!("<VRTDataset>{}</VRTDataset>", "<a/>".repeat(1 << 20)).into_bytes(),
        &["it has no"],
    );
}

/// The header of a scan of 2 x 2 x 2 bytes in one file with them.
pub(super) fn scan_header() -> Vec<u8> {
    let mut scan = vec![0; 352];
    scan[..4].copy_from_slice(&348_i32.to_le_bytes());
    scan[40..48].copy_from_slice(&[3, 0, 2, 0, 2, 0, 2, 0]);
    scan[70] = 2;
    scan[72] = 8;
    scan[108..112].copy_from_slice(&352.0_f32.to_le_bytes());
    [80, 84, 88].iter().for_each(|&at| scan[at..at + 4].copy_from_slice(&1.0_f32.to_le_bytes()));
    scan[344..347].copy_from_slice(b"n+1");
    scan
}

#[test]
fn volumes_that_promise() {
    let volume = || gas("render --volume-file");
    let header = |sizes: &str, more: &str| {
        format!("NRRD0004\ntype: double\ndimension: 3\nsizes: {sizes}\nendian: little\nencoding: raw\n{more}\n")
    };
    refused(volume, "large.nrrd", header("60000 60000 60000", "").as_bytes(), &["more than a file has"]);
    refused(volume, "cut.nrrd", header("1000 1000 100", "").as_bytes(), &["cut off"]);
    let lines = [header("2 2 2", "line skip: 18446744073709551615\n").as_bytes(), &vec![b'\n'; 30_000_000]].concat();
    refused(volume, "lines.nrrd", &lines, &["lines to skip"]);
    let long = format!("NRRD0004\n{}", "a".repeat(20_000_000));
    refused(volume, "long.nrrd", long.as_bytes(), &["1 MiB"]);
    let keys = format!("NRRD0004\n{}", (0..90_000).map(|i| format!("k{i}: 1\n")).collect::<String>());
    refused(volume, "keys.nrrd", keys.as_bytes(), &["no field dimension"]);
    let samples = [header("200 200 100", "").into_bytes(), f64::NAN.to_le_bytes().repeat(4_000_000)].concat();
    refused(volume, "nan.nrrd", &samples, &["sample (0, 0, 0) is NaN", "volume-unfit"]);
    let samples = [header("200 200 100", "").into_bytes(), (-1_f64).to_le_bytes().repeat(4_000_000)].concat();
    refused(volume, "negative.nrrd", &samples, &["sample (0, 0, 0) is -1", "volume-range"]);
    let meta = |sizes: &str| {
        format!(
            "NDims = 3\nDimSize = {sizes}\nElementType = MET_DOUBLE\nCompressedData = True\nElementDataFile = LOCAL\n"
        )
    };
    refused(volume, "large.mha", meta("60000 60000 60000").as_bytes(), &["more than a file has"]);
    // What is packed the tightest: more than may be unpacked, and as much as may, without its end.
    let zeros = |count: usize| {
        let mut packer = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::best());
        std::io::Write::write_all(&mut packer, &vec![0; count]).unwrap();
        packer.finish().unwrap()
    };
    let packed = zeros(60_000_000);
    refused(volume, "tight.mha", &[meta("1000 1000 100").as_bytes(), &packed].concat(), &["unpack it first"]);
    let short = [meta("200 200 200").as_bytes(), &packed[..packed.len() - 8]].concat();
    refused(volume, "cut.mha", &short, &["cut off"]);
    let mut scan = scan_header();
    scan[40..48].copy_from_slice(&[3, 0, 0xff, 0x7f, 0xff, 0x7f, 0xff, 0x7f]);
    refused(volume, "large.nii", &scan, &["cut off"]);
    let gzip = |bytes: &[u8]| {
        let mut packer = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::best());
        std::io::Write::write_all(&mut packer, bytes).unwrap();
        packer.finish().unwrap()
    };
    refused(volume, "large.nii.gz", &gzip(&scan), &["unpack it first"]);
    refused(volume, "long.nii.gz", &gzip(&vec![0; 300_000_000]), &["does not begin as NIfTI-1"]);
    scan[344..347].copy_from_slice(b"ni1");
    refused_of(volume, &[("large.hdr", &scan), ("large.img", &[0; 1 << 20])], &["cut off"]);
    // Headers with their samples beside them.
    let nhdr = |sizes: &str, encoding: &str| {
        header(sizes, "data file: a.raw").replace("raw\ndata", &format!("{encoding}\ndata"))
    };
    for (sizes, encoding, samples, part) in [
        ("60000 60000 60000", "raw", &vec![0; 5_000_000], "more than a file has"),
        ("1000 1000 100", "raw", &vec![0; 5_000_000], "cut off"),
        ("1000 1000 1000", "gzip", &gzip(&vec![0; 60_000_000]), "unpack it first"),
        ("1000 1000 1000", "ascii", &b"0 ".repeat(10_000_000), "raw or gzip"),
    ] {
        refused_of(volume, &[("a.nhdr", nhdr(sizes, encoding).as_bytes()), ("a.raw", samples)], &[part]);
    }
    let mhd = |sizes: &str| meta(sizes).replace("LOCAL", "a.zraw");
    let cut = &packed[..packed.len() - 8];
    for (sizes, samples, part) in [("1000 1000 100", &*packed, "unpack it first"), ("200 200 200", cut, "cut off")] {
        refused_of(volume, &[("a.mhd", mhd(sizes).as_bytes()), ("a.zraw", samples)], &[part]);
    }
    // The samples of a grid whose boxes of tiles are all the same.
    let mut grid = vec![0; 16 + 176 + 672 + 64 + 64 + 32 * 900_000];
    let length = (grid.len() - 192) as u64;
    let mut put = |at: usize, bytes: &[u8]| grid[at..at + bytes.len()].copy_from_slice(bytes);
    put(0, b"NanoVDB0");
    put(8, &(32_u32 << 21).to_le_bytes());
    put(12, &[1]);
    put(24, &length.to_le_bytes());
    put(48, &[1]);
    [0, 32, 64].iter().for_each(|more| put(192 + 384 + more, &1.0_f64.to_le_bytes()));
    put(192 + 672 + 24, &[64]);
    let root = 192 + 736;
    [12, 16, 20].iter().for_each(|at| put(root + at, &500_u32.to_le_bytes()));
    put(root + 24, &900_000_u32.to_le_bytes());
    refused(volume, "tiles.nvdb", &grid, &["its nodes overlap"]);
    // Segments of a grid without bytes.
    let mut segment = [0; 16 + 176];
    segment[..8].copy_from_slice(b"NanoVDB0");
    segment[8..12].copy_from_slice(&(32_u32 << 21).to_le_bytes());
    segment[12] = 1;
    let last = || gas("render --volume-component 4000000 --volume-file");
    refused(last, "segments.nvdb", &segment.repeat(150_000), &["it has no grid 4000000"]);
}

/// A PNG of black pixels.
pub(super) fn black_png(side: u32) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, side, side);
    encoder.set_color(png::ColorType::Grayscale);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_compression(png::Compression::High);
    let mut writer = encoder.write_header().unwrap();
    let mut stream = writer.stream_writer().unwrap();
    let row = vec![0; side as usize];
    for _ in 0..side {
        std::io::Write::write_all(&mut stream, &row).unwrap();
    }
    stream.finish().unwrap();
    writer.finish().unwrap();
    bytes
}

/// A packed TIFF of zeros.
fn black_tiff(side: u32) -> Vec<u8> {
    let mut file = std::io::Cursor::new(Vec::new());
    let encoder = tiff::encoder::TiffEncoder::new(&mut file).unwrap();
    let packing = tiff::encoder::Compression::Deflate(tiff::encoder::DeflateLevel::Fast);
    let mut encoder = encoder.with_compression(packing);
    let mut picture = encoder.new_image::<tiff::encoder::colortype::Gray8>(side, side).unwrap();
    picture.rows_per_strip(64).unwrap();
    picture.write_data(&vec![0; side as usize * side as usize]).unwrap();
    file.into_inner()
}

/// As [`black_png`], without its end.
pub(super) fn cut_png(side: u32) -> Vec<u8> {
    let mut bytes = black_png(side);
    bytes.truncate(bytes.len() - 40);
    bytes
}

#[test]
fn small_pictures_of_many_pixels() {
    let bytes = cut_png(8_192);
    assert!(bytes.len() < 200_000, "{}", bytes.len());
    refused(|| burning("render --mesh box --texture"), "cut.png", &bytes, &["cut.png"]);
    refused(|| terrain("render --drape"), "cut.png", &bytes, &["cut.png"]);
    refused(|| terrain("render --map"), "cut.png", &bytes, &["cut.png"]);
}

#[test]
fn records_of_many_values() {
    let compare: fn() -> Program = || fumarole("compare record.json");
    let assembled: fn() -> Program = || caustics("experiment 5-1 --device none --assembled");
    let example = include_str!("../../data/record.json");
    let marker = "\"config\": {";
    assert!(example.contains(marker));
    let with = |config: String| example.replacen(marker, &format!("{marker}{config}"), 1);
    let negative = example.replacen("\"samples\": [", "\"samples\": [-1.0, ", 1);
    assert_ne!(negative, example);
    for program in [compare, assembled] {
        let record = |text: &str, parts: &[&str]| refused(program, "a.json", text.as_bytes(), parts);
        record(&with(format!("\"x\": [{}[]],", "[],".repeat(3_000_000))), &["config", "too many values"]);
        record(&with(format!("\"x\": {},", "[".repeat(500_000))), &["a.json"]);
        record(&with(format!("\"x\": \"{}\", \"seed\"", "a".repeat(3_000_000))), &["a.json"]);
    }
    refused(compare, "negative.json", negative.as_bytes(), &["-1 ms", "no time is negative"]);
    refused(assembled, "a.json", example.as_bytes(), &["it is of one process"]);
}

/// Three million samples take no minutes.
#[test]
fn a_long_record_is_compared_within_seconds() {
    let out = folder();
    let example = include_str!("../../data/record.json");
    let samples: Vec<String> =
        (0..3_000_000).map(|i| format!("{}", 1.0 + f64::from(i % 1_000 * 7_919 % 1_000) / 1e5)).collect();
    let joined = samples.join(",");
    let write = |name: &str, first: &str| {
        let text = example.replacen("\"samples\": [", &format!("\"samples\": [{first}, {joined}, "), 1);
        fs::write(out.path().join(name), text).unwrap();
    };
    write("a.json", "1.0");
    write("b.json", "1.1");
    let path = |name: &str| Path::new(out.path()).join(name);
    let started = Instant::now();
    fumarole("compare").arg(path("a.json")).arg(path("b.json")).run().succeeded();
    assert!(started.elapsed().as_secs() < 20, "{:?}", started.elapsed());
}
