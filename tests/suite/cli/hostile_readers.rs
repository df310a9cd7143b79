//! Costs of a refusal by the readers of meshes in binary, maps with files beside them, materials, bodies, and documents.

use super::hostile_cost::{black_png, cut_png, mesh, refused, refused_of};
use super::program::{Program, burning, caustics, fumarole, lava, terrain};

pub(super) const STRESS: &str = include_str!("../../../fuzz/corpus/stress/whole");
/// A program, and the name under which it is given a file.
type Reader = (fn() -> Program, &'static str);

/// Those of records of stress.
pub(super) const STRESS_READERS: [Reader; 3] = [
    (|| fumarole("assemble"), "parts/a-shard-0-of-2.json"),
    (|| fumarole("report"), "a.json"),
    (|| caustics("stress --device none --json"), "go-on.json"),
];
pub(super) const VERDICTS: &str = include_str!("../../../fuzz/corpus/verdicts/whole");
pub(super) const TABLES: &str = include_str!("../../../fuzz/corpus/tables/whole");
pub(super) const PART: &str = include_str!("../../../fuzz/corpus/part/whole");

/// A document with `more` in place of its first `marker`.
pub(super) fn with(document: &str, marker: &str, more: &str) -> Vec<u8> {
    assert!(document.contains(marker), "{marker}");
    document.replacen(marker, more, 1).into_bytes()
}

/// As [`with`], with so many of `item`, and a number, which none of them is, at the begin of a list.
pub(super) fn with_items(document: &str, list: &str, item: &str, count: usize) -> Vec<u8> {
    with(document, list, &format!("{list}{}0,", format!("{item},").repeat(count)))
}

#[test]
fn stl_files() {
    let binary = |count: u32, bytes: usize| [&[0; 80][..], &count.to_le_bytes(), &vec![0; bytes]].concat();
    refused(mesh, "large.stl", &binary(1 << 31, 5_000_000), &["byte 80", "up to byte 107374182484", "cut off"]);
    refused(mesh, "points.stl", &binary(300_000, 15_000_000), &["none of its 300000 triangles"]);
    let facet = "facet normal 0 0 0\nouter loop\nvertex 0 0 0\nvertex 0 0 0\nvertex 0 0 0\nendloop\nendfacet\n";
    let empty = format!("solid\n{}endsolid\n", facet.repeat(100_000));
    refused(mesh, "empty.stl", empty.as_bytes(), &["none of its 100000 triangles"]);
    refused(mesh, "cut.stl", format!("solid\n{}", facet.repeat(200_000)).as_bytes(), &["line 1400001: EOF"]);
    refused(mesh, "solids.stl", "solid\nendsolid\n".repeat(2_000_000).as_bytes(), &["0 vertices"]);
    refused(mesh, "blank.stl", format!("solid\n{}", "\n".repeat(20_000_000)).as_bytes(), &["line 20000001: EOF"]);
    refused(mesh, "word.stl", format!("solid\n{}", "a".repeat(20_000_000)).as_bytes(), &["line 2", "1024 bytes"]);
    for line in ["", "facet ", "facet normal 0 0 0\nouter loop\nvertex "] {
        refused(mesh, "words.stl", format!("solid\n{line}{}", "0 ".repeat(8_400_000)).as_bytes(), &["words.stl: line"]);
    }
}

/// A binary file of glTF with chunks of a kind, bytes, and a length that is claimed of them.
fn glb(chunks: &[(&[u8], &[u8], u32)]) -> Vec<u8> {
    let chunks = chunks.iter().flat_map(|(kind, bytes, length)| [&length.to_le_bytes()[..], kind, bytes].concat());
    let chunks: Vec<u8> = chunks.collect();
    [&b"glTF"[..], &2_u32.to_le_bytes(), &(12 + chunks.len() as u32).to_le_bytes(), &chunks].concat()
}

#[test]
fn glb_files() {
    let (json, data) = (&b"JSON"[..], &b"BIN\0"[..]);
    let blank = vec![b' '; 5_000_000];
    let zeros = vec![0; 5_000_000];
    for length in [0xffff_fff0, 5_000_004] {
        refused(mesh, "long.glb", &glb(&[(json, &blank, length)]), &["JSON chunk length exceeds"]);
    }
    let mut whole = glb(&[(json, &blank, 5_000_000)]);
    whole[8..12].copy_from_slice(&u32::MAX.to_le_bytes());
    refused(mesh, "whole.glb", &whole, &["byte 8", "claims a length of 4294967295"]);
    let asset: &[u8] = br#"{"asset":{"version":"2.0"}} "#;
    let many = [(json, asset, 28), (data, &b""[..], 0)].into_iter().chain(vec![(data, &b""[..], 0); 1_000_000]);
    refused(mesh, "chunks.glb", &glb(&many.collect::<Vec<_>>()), &["no scene"]);
    refused(mesh, "texts.glb", &glb(&vec![(json, &b""[..], 0); 1_000_000]), &["not expecting JSON"]);
    let scene = |count: u32, buffer: u32| {
        let mut text = format!(
            r#"{{"asset":{{"version":"2.0"}},"scenes":[{{"nodes":[0]}}],"nodes":[{{"mesh":0}}],
            "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}}}}]}}],"buffers":[{{"byteLength":{buffer}}}],
            "bufferViews":[{{"buffer":0,"byteLength":{buffer}}}],"accessors":[{{"bufferView":0,"componentType":5126,
            "count":{count},"type":"VEC3","min":[0,0,0],"max":[0,0,0]}}]}}"#
        );
        text.extend(std::iter::repeat_n(' ', text.len().wrapping_neg() % 4));
        text.into_bytes()
    };
    let file = |text: &[u8], length| glb(&[(json, text, text.len() as u32), (data, &zeros, length)]);
    refused(mesh, "data.glb", &file(&scene(3, 36), 0xffff_fff0), &["BIN", "chunk length exceeds"]);
    refused(mesh, "buffer.glb", &file(&scene(3, 4_000_000_000), 5_000_000), &["buffer 0", "claims 4000000000 bytes"]);
    refused(mesh, "list.glb", &file(&scene(1 << 31, 5_000_000), 5_000_000), &["simplify it"]);
    refused(mesh, "list.glb", &file(&scene(1_000_000, 5_000_000), 5_000_000), &["1000000 elements", "do not fit"]);
    let names = with_items("{\"extensionsUsed\":[0]}", "[", "\"\"", 6_000_000);
    refused(mesh, "names.glb", &glb(&[(json, &names, names.len() as u32)]), &["expected a string"]);
}

#[test]
fn tiles_and_rasters() {
    let map = || terrain("render --map");
    refused(map, "N37E140.hgt", &vec![0; 30_000_001], &["30000001 bytes", "2884802"]);
    refused(map, "N37E140.hgt", &[0x80, 0].repeat(3_601 * 3_601), &["all its samples are void"]);
    refused(map, "land.hgt", &vec![0; 2 * 3_601 * 3_601], &["tells no corner"]);
    let tile = vec![0; 2 * 1_201 * 1_201];
    let apart = |other: &'static str| [("maps/N00E000.hgt", &tile[..]), (other, &tile)];
    refused_of(map, &apart("maps/S80W170.hgt"), &["205201 x 97201", "65536"]);
    refused_of(map, &apart("maps/N40E040.hgt"), &["lie so far apart"]);
    let names: Vec<String> = (0..62_000)
        .map(|i| {
            format!("maps/{}{:02}{}{:03}.hgt", ["N", "S"][i % 2], 1 + i / 4 % 89, ["E", "W"][i / 2 % 2], 1 + i / 356)
        })
        .collect();
    refused_of(map, &names.iter().map(|name| (&name[..], &b""[..])).collect::<Vec<_>>(), &["0 bytes"]);

    let raster = |header: &str, count: usize, parts: &[&str]| {
        refused_of(map, &[("a.bil", &vec![0; count]), ("a.hdr", header.as_bytes())], parts);
    };
    let large = "ncols 65535\nnrows 65535\nnbits 32\n";
    raster(large, 1_000_000, &["1000000 bytes", "17179344900"]);
    raster("ncols 2\nnrows 2\nnbits 8\nskipbytes 1099511627776\n", 1_000_000, &["1099511627780"]);
    raster("ncols 2\nnrows 60000\nnbits 8\ntotalrowbytes 1099511627776\n", 1_000_000, &["65969598154932226"]);
    raster("ncols 2\nnrows 65536\nnbits 8\ntotalrowbytes 400\nnodata 0\n", 400 << 16, &["are void"]);
    raster("ncols 5000\nnrows 5000\nnbits 8\nnodata 0\n", 25_000_000, &["are void"]);
    raster("ncols 2500\nnrows 2500\nnbits 32\npixeltype float\nnodata 0\n", 25_000_000, &["are void"]);
    let header = |header: &[u8], part| refused_of(map, &[("a.hdr", header), ("a.bil", &[0; 4])], &[part]);
    header(&b"\xff".repeat(30_000_000), "no NCOLS");
    let keys: String = (0..100_000).map(|i| format!("{i:x} 1\n")).collect();
    header(format!("{keys}1 2\n").as_bytes(), "line 100001: \"1\" stands on line 2");
    let units = [("a.asc", &b"ncols 2\nnrows 2\n1 2 x 4\n"[..]), ("a.prj", &b"\xff".repeat(30_000_000))];
    refused_of(map, &units, &["line 3", "\"x\""]);
}

#[test]
fn world_files() {
    let picture = black_png(2);
    let beside = |bytes: &[u8], part| {
        let drape = || terrain("render --drape");
        refused_of(drape, &[("a.png", &picture), ("a.pgw", bytes)], &["world file", part]);
    };
    beside(&b"x".repeat(20_000_000), "line 1: \"xxx");
    beside(&b"9".repeat(20_000_000), "line 1: \"999");
    beside(&b" ".repeat(20_000_000), "0 numbers");
    beside(&b"0 ".repeat(10_000_000), "more than six");
    beside(&b"\xff".repeat(20_000_000), "no finite number");
    // A small file of many pixels is not kept before all beside it is seen to be good.
    let large = black_png(8_192);
    let drape = || terrain("render --drape");
    refused_of(drape, &[("a.png", &large), ("a.pgw", b"x")], &["world file"]);
    let placed = || terrain("render --map gone.asc --drape");
    refused_of(placed, &[("a.png", &large), ("a.pgw", b"1 0 0 -1 0 0")], &["gone.asc"]);
}

/// The rock is decoded when all else is right.
#[test]
fn rocks() {
    let rock = || lava("render --object gone.obj@0,0,0 --rock");
    refused_of(rock, &[("a.png", &black_png(4_096))], &["gone.obj"]);
    let bed = || lava("render --bed gone.asc --rock");
    refused_of(bed, &[("a.png", &black_png(4_096))], &["gone.asc"]);
}

#[test]
fn materials() {
    let materials = || burning("render --mesh box --materials");
    let toml = |text: &str, parts: &[&str]| refused(materials, "a.toml", text.as_bytes(), parts);
    let wood = "[[material]]\nkind = \"wood\"\n";
    toml(&"x".repeat(30_000_000), &["30000000 bytes", "limit of 98304"]);
    toml(&wood.repeat(3_500), &["3500 materials", "256"]);
    toml(&format!("{wood}parts = [{}]", "\"\",".repeat(32_000)), &["line 3", "names no parts"]);
    toml(&format!("x = [{}]", "[],".repeat(32_000)), &["line 1", "unknown field \"x\""]);
    toml(&format!("x = {}", "[".repeat(98_000)), &["line 1", "recurse"]);
    toml(&format!("a{} = 0", ".a".repeat(49_000)), &["recursion"]);
    toml(&"[[a]]\n".repeat(16_000), &["line 1", "unknown field \"a\""]);
    toml(&(0..12_000).map(|i| format!("{i:x}=0\n")).collect::<String>(), &["unknown field \"0\""]);
}

#[test]
fn bodies() {
    let csv = |text: &[u8], parts: &[&str]| refused(|| terrain("collide --bodies"), "a.csv", text, parts);
    csv(&[&b"1,2,3,4\n".repeat(500_000)[..], b"x"].concat(), &["line 500001", "1 field"]);
    csv(&b"#\n".repeat(10_000_000), &["no body"]);
    csv(&b",".repeat(20_000_000), &["line 1", "20000001 fields"]);
    csv(&b"\n".repeat(20_000_000), &["no body"]);
    csv(&[b"1,2,3,", &b"a".repeat(20_000_000)[..]].concat(), &["line 1: \"aaa", "aaa\"... is not a finite number"]);
    csv(&[b"1,2,3,", &b"9".repeat(20_000_000)[..]].concat(), &["line 1: \"999"]);
    csv(&b"\xff".repeat(20_000_000), &["not UTF-8"]);
}

#[test]
fn parts_of_films() {
    let assemble = || fumarole("assemble");
    let part = |bytes: &[u8], part| refused(assemble, "parts/a.png.part.json", bytes, &[part]);
    part(&b" ".repeat(17 << 20), "limit of 16777216");
    part(&with(PART, "fumarole.part/1", &"a ".repeat(8_000_000)), "its schema is a a");
    part(&with(PART, "[8,8]", &format!("\"{}\"", "a ".repeat(8_000_000))), "invalid type: string \"a a");
    part(&with(PART, "f-0003.rows-2-8.png", &"a/".repeat(8_000_000)), "a/a/a");
    part(&with_items(PART, "\"inputs\":[", "[]", 5_000_000), "expected struct");
    let parameters: String = (0..600_000).map(|i| format!("\"{i:x}\":\"\",")).collect();
    part(&with(PART, "\"particles\"", &format!("{parameters}\"particles\"")), "lack rows");
    let endless = with(PART, "[0,4]", "[0,4294967295]");
    part(&[&endless[..], &b" ".repeat(1_000_000)].concat(), "4294967295 frames");
    let whole = with(PART, "\"frames\":[0,4]", "\"frames\":[3,4]");
    let whole = with(&String::from_utf8(whole).unwrap(), "\"rows\":[2,8]", "\"rows\":[0,8192]");
    let whole = with(&String::from_utf8(whole).unwrap(), "[8,8]", "[8192,8192]");
    let picture = |bytes: &[u8], part| {
        let files = [("parts/a.png.part.json", &whole[..]), ("parts/f-0003.rows-2-8.png", bytes)];
        refused_of(assemble, &files, &["f-0003.rows-2-8.png", part]);
    };
    picture(&cut_png(8_192), "render it again");
    picture(&black_png(8_192), "not the picture that was drawn");
}

#[test]
fn records_of_stress() {
    for (program, name) in STRESS_READERS {
        let stress = |bytes: &[u8], part| refused(program, name, bytes, &[part]);
        let of_schema = if name == "go-on.json" { "it is no record of stress" } else { "its schema is \"a a" };
        stress(&with(STRESS, "fumarole.stress/1", &"a ".repeat(8_000_000)), of_schema);
        stress(&with_items(STRESS, "\"series\":[", "[]", 6_000_000), "field series[0]: invalid length 0");
        stress(&with_items(STRESS, "\"samples\":[", "{}", 6_000_000), "samples[0]: invalid type");
        stress(
            &with(STRESS, "\"config\":{", &format!("\"config\":{{\"x\":[{}0],", "[],".repeat(6_000_000))),
            "too many values",
        );
        let names: String = (0..500_000).map(|i| format!("\"{i:x}\":0,")).collect();
        stress(&with(STRESS, "\"not_finite\":{", &format!("\"not_finite\":{{{names}\"z\":[]")), "not_finite.z");
        let segment = r#"{"from":1.0,"to":2.0,"exponent":1.0,"interval":[0.9,1.1]}"#;
        stress(&with_items(STRESS, "\"segments\":[", segment, 300_000), "segments[300000]: invalid type");
        stress(&with_items(STRESS, "\"by_resource\":[", r#"{"name":"","bytes":0}"#, 800_000), "by_resource[800000]");
        let deep = format!("\"results\":{{\"x\":{}", "[".repeat(2_000_000) + &"]".repeat(2_000_000));
        stress(&with(STRESS, "\"results\":{", &deep), "recursion limit");
    }
}

#[test]
fn verdicts_and_tables() {
    let report = |bytes: &[u8], part| refused(|| fumarole("report"), "a.json", bytes, &[part]);
    report(&with_items(VERDICTS, "\"only_in_a\":[", "\"\"", 6_000_000), "limit of 16777216");
    report(&with_items(VERDICTS, "\"only_in_a\":[", "\"\"", 4_200_000), "only_in_a[4200000]");
    report(&with_items(VERDICTS, "\"missing_passes\":[", "\"\"", 4_200_000), "missing_passes[4200000]");
    report(&with_items(VERDICTS, "\"a_commands\":[", "[]", 4_200_000), "a_commands[4200000]");
    report(
        &with_items(VERDICTS, "\"differences\":[", r#"{"what":"","a":[""],"b":[""]}"#, 500_000),
        "differences[500000]",
    );
    report(&with_items(TABLES, "\"rows\":[", "{}", 5_000_000), "too many values");
    report(&with_items(TABLES, "\"columns\":[", "\"\"", 4_200_000), "columns[4200000]");
    report(&with(TABLES, "\"more\":{", &format!("\"more\":{{\"x\":[{}0]", "[0],".repeat(3_000_000))), "more.x[0]");
}
