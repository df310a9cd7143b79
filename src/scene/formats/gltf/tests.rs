use super::*;
use crate::scene::loading::Conditions;
use crate::scene::{Mesh, MeshOptions};

fn parse(bytes: &[u8], directory: &Path) -> Result<Mesh, Fault> {
    super::parse(bytes, directory, false)?.into_mesh(180.0)
}

/// A square in the plane z = 0: four positions, then the indices 0 1 2 3 0 2 as bytes.
const SQUARE: [[f32; 3]; 4] = [[0., 0., 0.], [1., 0., 0.], [1., 1., 0.], [0., 1., 0.]];

fn square_bytes() -> Vec<u8> {
    let mut bytes: Vec<u8> = SQUARE.iter().flatten().flat_map(|x| x.to_le_bytes()).collect();
    bytes.extend([0, 1, 2, 3, 0, 2]);
    bytes
}

fn base64(bytes: &[u8]) -> String {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::new();
    for chunk in bytes.chunks(3) {
        let word = chunk.iter().chain(&[0, 0]).take(3).fold(0, |w, b| w << 8 | usize::from(*b));
        for place in 0..4 {
            let digit = DIGITS[word >> (18 - 6 * place) & 63];
            text.push(if place <= chunk.len() { digit.into() } else { '=' });
        }
    }
    text
}

/// A document with one square; `nodes` and `primitive` are JSON, `uri` names the buffer.
fn document(nodes: &str, primitive: &str, uri: Option<&str>) -> String {
    let uri = uri.map_or(String::new(), |uri| format!(r#""uri":"{uri}","#));
    format!(
        r#"{{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[0]}}],"nodes":{nodes},
        "meshes":[{{"primitives":[{primitive}]}}],"buffers":[{{{uri}"byteLength":54}}],
        "bufferViews":[{{"buffer":0,"byteLength":48}},{{"buffer":0,"byteOffset":48,"byteLength":6}}],
        "accessors":[{{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3","min":[0,0,0],"max":[1,1,0]}},
        {{"bufferView":1,"componentType":5121,"count":6,"type":"SCALAR"}},
        {{"bufferView":1,"componentType":5121,"count":4,"type":"SCALAR"}}]}}"#
    )
}

const NODE: &str = r#"[{"mesh":0}]"#;

fn embedded(nodes: &str, primitive: &str) -> Result<Mesh, Fault> {
    let uri = format!("data:application/octet-stream;base64,{}", base64(&square_bytes()));
    parse(document(nodes, primitive, Some(&uri)).as_bytes(), Path::new(""))
}

fn binary(json: &str, chunk: &[u8]) -> Vec<u8> {
    let mut json = json.as_bytes().to_vec();
    json.resize(json.len().next_multiple_of(4), b' ');
    let mut chunk = chunk.to_vec();
    chunk.resize(chunk.len().next_multiple_of(4), 0);
    let mut bytes = b"glTF\x02\0\0\0".to_vec();
    bytes.extend((28 + json.len() as u32 + chunk.len() as u32).to_le_bytes());
    for (kind, data) in [(b"JSON", json), (b"BIN\0", chunk)] {
        bytes.extend((data.len() as u32).to_le_bytes());
        bytes.extend(kind);
        bytes.extend(data);
    }
    bytes
}

const STRIP: &str = r#"{"attributes":{"POSITION":0},"indices":2,"mode":5}"#;
const FAN: &str = r#"{"attributes":{"POSITION":0},"mode":6}"#;
const POINTS: &str = r#"{"attributes":{"POSITION":0},"mode":0}"#;
const LIST: &str = r#"{"attributes":{"POSITION":0},"indices":1}"#;

#[test]
fn lists_strips_and_fans_are_triangles_of_the_right_orientation() {
    assert_eq!(embedded(NODE, LIST).unwrap().indices, [0, 1, 2, 3, 0, 2]);
    assert_eq!(embedded(NODE, FAN).unwrap().indices, [1, 2, 0, 2, 3, 0]);
    assert_eq!(embedded(NODE, STRIP).unwrap().indices, [0, 1, 2, 1, 3, 2]);
    assert_eq!(embedded(NODE, FAN).unwrap().normals, [Vec3::Z; 4]);
    let mixed = embedded(NODE, &format!("{POINTS},{FAN},{LIST}")).unwrap();
    assert_eq!((mixed.triangle_count(), mixed.positions.len()), (4, 8));
    assert!(embedded(NODE, POINTS).unwrap_err().reason.contains("no triangles"));
}

#[test]
fn text_binary_and_external_files_are_equal() {
    let mesh = embedded(NODE, LIST).unwrap();
    let glb = binary(&document(NODE, LIST, None), &square_bytes());
    assert_eq!(parse(&glb, Path::new("")).unwrap(), mesh);
    let directory = tempfile::tempdir().unwrap();
    std::fs::write(directory.path().join("a b.bin"), square_bytes()).unwrap();
    let external = |uri| parse(document(NODE, LIST, Some(uri)).as_bytes(), directory.path());
    assert_eq!(external("a%20b.bin").unwrap(), mesh);
    for uri in ["none.bin", "%", "%ff", "http://a/b.bin", ".", "data:;base64,!"] {
        let fault = external(uri).expect_err(uri);
        assert_eq!(fault.place, Place::Part("buffer 0".to_owned()), "{fault}");
    }
    std::fs::write(directory.path().join("short.bin"), [0; 53]).unwrap();
    assert!(external("short.bin").unwrap_err().reason.contains("53"));
}

#[test]
fn node_transforms_are_applied_down_the_tree() {
    let nodes = r#"[{"children":[1,2],"translation":[10,0,0]},{"mesh":0,"scale":[2,2,2]},
        {"mesh":0,"scale":[-1,1,1]}]"#;
    let mesh = embedded(nodes, LIST).unwrap();
    assert_eq!(mesh.bounds().min, Vec3::new(9.0, 0.0, 0.0));
    assert_eq!(mesh.bounds().max, Vec3::new(12.0, 2.0, 0.0));
    assert_eq!(mesh.positions[1], Vec3::new(12.0, 0.0, 0.0));
    assert_eq!(mesh.normals, [Vec3::Z; 8]);
}

#[test]
fn rotations_are_of_unit_length_and_matrices_are_affine() {
    let node = |fields: &str| embedded(&format!(r#"[{{"children":[1]}},{{"mesh":0,{fields}}}]"#), LIST);
    // A quarter turn about z, by numbers of two digits, of which the squares' sum is 1.0082.
    let turned = node(r#""rotation":[0,0,0.71,0.71]"#).unwrap();
    assert!((turned.positions[1] - Vec3::Y).length() < 1e-6, "{}", turned.positions[1]);
    assert_eq!(node(r#""matrix":[0,1,0,0,-1,0,0,0,0,0,1,0,5,0,0,1]"#).unwrap().positions[1], Vec3::new(5.0, 1.0, 0.0));
    for (fields, part) in [
        (r#""rotation":[0,0,0,2]"#, "node 1: its rotation has the length 2; it has to be 1"),
        (r#""rotation":[0,0,0,0]"#, "node 1: its rotation has the length 0"),
        (r#""rotation":[1e30,0,0,1]"#, "node 1: its rotation has the length inf"),
        (r#""matrix":[1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,2]"#, "node 1: the last row of its matrix is 0 0 0 2"),
        (r#""matrix":[1,0,0,0.5,0,1,0,0,0,0,1,0,0,0,0,1]"#, "node 1: the last row of its matrix is 0.5 0 0 1"),
    ] {
        let fault = node(fields).unwrap_err().to_string();
        assert!(fault.starts_with(part), "{fields}: {fault}");
    }
}

#[test]
fn versions_and_extensions_that_are_not_read_are_refused() {
    let of = |asset: &str, more: &str| {
        let json = document(NODE, LIST, None).replacen(r#""asset":{"version":"2.0"}"#, &format!("{asset}{more}"), 1);
        parse(&binary(&json, &square_bytes()), Path::new("")).map_err(|fault| fault.to_string())
    };
    let plain = r#""asset":{"version":"2.0"}"#;
    for (asset, part) in [
        (r#""asset":{"version":"2.0"}"#, None),
        (r#""asset":{"version":"2.1","minVersion":"2.0"}"#, None),
        (
            r#""asset":{"version":"2.1","minVersion":"2.1"}"#,
            Some("asset: its minVersion is \"2.1\", and glTF 2.0 is read"),
        ),
        (r#""asset":{"version":"2.0","minVersion":"x"}"#, Some("asset: its minVersion is \"x\"")),
        (
            r#""asset":{"version":"3.0"}"#,
            Some("asset: its version is \"3.0\", and glTF 2.0 is read; export it as that"),
        ),
    ] {
        match (of(asset, ""), part) {
            (Ok(_), None) => {}
            (Err(fault), Some(part)) => assert!(fault.starts_with(part), "{fault}"),
            (read, _) => panic!("{asset}: {read:?}"),
        }
    }
    let required = |name: &str| of(plain, &format!(r#","extensionsRequired":["KHR_materials_unlit","{name}"]"#));
    assert!(required("KHR_texture_transform").is_ok());
    let fault = required("EXT_meshopt_compression").unwrap_err();
    assert_eq!(fault, "it requires the extension \"EXT_meshopt_compression\", which is not read; export it without");
}

#[test]
fn what_is_passed_over_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.glb");
    let told = |nodes: &str, mesh: &str, more: &str, bytes: &[u8]| {
        let json = document(nodes, LIST, None).replacen(r#""meshes":[{"#, &format!(r#"{more}"meshes":[{{{mesh}"#), 1);
        std::fs::write(&path, binary(&json, bytes)).unwrap();
        notes::take();
        crate::scene::MeshSource::File(path.clone()).load().unwrap();
        notes::take()
    };
    let skin = r#""skins":[{"joints":[0]}],"#;
    let instanced = r#""extensionsUsed":["KHR_materials_unlit","EXT_mesh_gpu_instancing"],"#;
    let twice = r#"[{"mesh":0,"children":[1]},{"mesh":0,"skin":0}]"#;
    let bent = r#"[{"mesh":0,"weights":[0,0.5]}]"#;
    for (nodes, mesh, more, part) in [
        (twice, "", skin, "the skins of 1 of its 2 meshes are left out: they keep the shape that is stored"),
        (
            NODE,
            r#""weights":[0,1],"#,
            "",
            "the morph targets of 1 of its 1 meshes are left out, whose weights are not 0",
        ),
        (bent, r#""weights":[0,0],"#, "", "the morph targets of 1 of its 1 meshes"),
        (
            NODE,
            "",
            instanced,
            "its extension EXT_mesh_gpu_instancing is not read: a mesh of many instances is placed once",
        ),
    ] {
        let notes = told(nodes, mesh, more, &square_bytes());
        assert!(notes.len() == 1 && notes[0].contains(&format!("a.glb: {part}")), "{part}: {notes:?}");
    }
    let json = document(NODE, &format!("{POINTS},{LIST}"), None);
    std::fs::write(&path, binary(&json, &square_bytes())).unwrap();
    crate::scene::MeshSource::File(path.clone()).load().unwrap();
    assert!(notes::take()[0].ends_with("1 primitives of points and lines are left out"));
    let whole = binary(&document(NODE, LIST, None), &square_bytes());
    std::fs::write(&path, [&whole[..], b"more"].concat()).unwrap();
    crate::scene::MeshSource::File(path.clone()).load().unwrap();
    assert!(
        notes::take()[0].ends_with(&format!("4 bytes behind the {} that its header states are left out", whole.len()))
    );
    // What changes nothing is no news.
    assert_eq!(told(r#"[{"mesh":0,"weights":[0,0]}]"#, r#""weights":[0,1],"#, skin, &square_bytes()), [""; 0]);
    // A large one is not kept, so that the next load tells it again.
    let large = [square_bytes(), vec![0; 1 << 21]].concat();
    let cache = tempfile::tempdir().unwrap();
    let conditions = Conditions { cache: Some(cache.path().to_owned()), ..Conditions::plain() };
    for (mesh, kept) in [(r#""weights":[1],"#, 0), ("", 1)] {
        let notes = told(NODE, mesh, "", &large);
        let load = || crate::scene::MeshSource::File(path.clone()).load_under(&MeshOptions::default(), &conditions);
        load().unwrap();
        assert_eq!(notes::take(), notes);
        assert_eq!(std::fs::read_dir(cache.path()).unwrap().count(), kept, "{mesh}");
    }
}

/// Points in any number are no scene either.
#[test]
fn small_files_place_no_vast_number_of_points() {
    let list = |item: &str, count: usize| vec![item; count].join(",");
    let roots = (0..10_000).map(|node| node.to_string()).collect::<Vec<_>>().join(",");
    let json = document("[NODES]", LIST, None)
        .replacen("NODES", &list(r#"{"mesh":0}"#, 10_000), 1)
        .replacen(r#""nodes":[0]"#, &format!(r#""nodes":[{roots}]"#), 1)
        .replacen(r#""primitives":["#, &format!(r#""primitives":[{},"#, list(POINTS, 10_000)), 1);
    let fault = parse(&binary(&json, &square_bytes()), Path::new("")).unwrap_err().to_string();
    assert!(fault.contains("1048576 primitives"), "{fault}");
}

#[test]
fn loops_and_shared_nodes_are_refused() {
    for nodes in [
        r#"[{"mesh":0,"children":[0]}]"#,
        r#"[{"children":[1]},{"children":[0]}]"#,
        r#"[{"children":[1,1]},{"mesh":0}]"#,
    ] {
        assert!(embedded(nodes, LIST).unwrap_err().reason.contains("twice"), "{nodes}");
    }
}

#[test]
fn accessors_beyond_their_buffers_are_refused() {
    let json = document(NODE, LIST, None);
    for (from, to) in [
        (r#""count":4,"type":"VEC3""#, r#""count":4000000000,"type":"VEC3""#),
        (r#""count":4,"type":"VEC3""#, r#""count":18446744073709551615,"type":"VEC3""#),
        (r#""count":4,"type":"VEC3""#, r#""count":0,"type":"VEC3""#),
        (r#""count":4,"type":"VEC3""#, r#""count":4,"type":"VEC2""#),
        (r#""componentType":5126"#, r#""componentType":5123"#),
        (r#""byteOffset":48,"#, r#""byteOffset":18446744073709551615,"#),
        (r#""byteOffset":48,"#, r#""byteOffset":49,"#),
        (r#""byteLength":48}"#, r#""byteLength":48,"byteStride":16}"#),
        (r#""byteLength":48}"#, r#""byteLength":48,"byteStride":8}"#),
        (r#""byteLength":48}"#, r#""byteLength":48,"byteStride":0}"#),
        (r#"{"bufferView":0,"componentType":5126"#, r#"{"componentType":5126"#),
        (r#""byteLength":54}"#, r#""byteLength":4000000000}"#),
        (r#""POSITION":0"#, r#""POSITION":9"#),
        (r#""POSITION":0"#, r#""NORMAL":0"#),
        (r#""scenes":[{"nodes":[0]}]"#, r#""scenes":[{"nodes":[7]}]"#),
        (r#""scene":0,"scenes":[{"nodes":[0]}],"#, ""),
        (r#""asset""#, r#""extensionsRequired":["X"],"asset""#),
    ] {
        assert!(json.contains(from), "{from}");
        let changed = binary(&json.replacen(from, to, 1), &square_bytes());
        let fault = parse(&changed, Path::new("")).expect_err(to);
        assert!(!fault.to_string().contains('\n'), "{fault}");
    }
}

#[test]
fn bad_contents_and_containers_are_refused() {
    let json = document(NODE, LIST, None);
    let mut nan = square_bytes();
    nan[14] = 0xc0;
    nan[15] = 0x7f;
    let fault = parse(&binary(&json, &nan), Path::new("")).unwrap_err();
    assert!(fault.to_string().starts_with("mesh 0, primitive 0: vertex 1: its position"), "{fault}");
    let mut index = square_bytes();
    index[50] = 4;
    let fault = parse(&binary(&json, &index), Path::new("")).unwrap_err();
    assert!(fault.to_string().starts_with("mesh 0, primitive 0: "), "{fault}");
    let good = binary(&json, &square_bytes());
    for length in [0_u32, 3, 11, 4_000_000_000] {
        let mut bytes = good.clone();
        bytes[8..12].copy_from_slice(&length.to_le_bytes());
        assert_eq!(parse(&bytes, Path::new("")).unwrap_err().place, Place::Byte(8));
        let mut bytes = good.clone();
        bytes[12..16].copy_from_slice(&length.to_le_bytes());
        assert!(parse(&bytes, Path::new("")).is_err());
    }
    // A container in a container, whose own stated length is less than its header.
    let fault = parse(&binary("glTF\x02\0\0\0\x02\0\0\0", &square_bytes()), Path::new("")).unwrap_err();
    assert!(fault.to_string().contains("expected value at line 1 column 1"), "{fault}");
}

#[test]
fn what_leaves_the_folder_is_not_read() {
    let root = tempfile::tempdir().unwrap();
    let folder = root.path().join("folder");
    std::fs::create_dir(&folder).unwrap();
    for place in ["secret.bin", "folder/a.bin"] {
        std::fs::write(root.path().join(place), square_bytes()).unwrap();
    }
    let absolute = root.path().join("secret.bin").to_str().unwrap().replace('\\', "/");
    let mut uris =
        vec!["../secret.bin", "%2e%2e/secret.bin", "..%2Fsecret.bin", "./../secret.bin", "a/../../secret.bin"];
    uris.push(&absolute);
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink("../secret.bin", folder.join("link.bin")).unwrap();
        uris.push("link.bin");
    }
    let external = |uri| parse(document(NODE, LIST, Some(uri)).as_bytes(), &folder);
    assert!(external("a.bin").is_ok() && external("./a.bin").is_ok());
    for uri in uris {
        let fault = external(uri).expect_err(uri).to_string();
        // A drive's letter reads as a scheme.
        let is_drive = cfg!(windows) && uri == absolute;
        let reason = if is_drive { "only data URIs and relative paths" } else { "it lies outside the folder" };
        assert!(fault.starts_with(&format!("buffer 0: {reason}")), "{uri}: {fault}");
    }
}

/// The buffer may be any file beside the document.
#[test]
fn messages_show_no_bytes_of_buffers() {
    let folder = tempfile::tempdir().unwrap();
    let json = document(NODE, LIST, Some("key"));
    let path = folder.path().join("key");
    // 0x73 is 115, 0x7373 is 29555; as a float 0x7fa17373 is no number.
    for (bytes, count) in [(vec![0x73; 54], 54), ([0x73, 0x73, 0xa1, 0x7f].repeat(14), 54)] {
        std::fs::write(&path, &bytes[..count]).unwrap();
        let fault = parse(json.as_bytes(), folder.path()).unwrap_err().to_string();
        assert!(!["115", "29555", "1.9", "e31"].iter().any(|shown| fault.contains(shown)), "{fault}");
    }
}

/// Each of many primitives and nodes names the same data.
#[test]
fn small_files_make_no_vast_scenes() {
    let bytes = vec![0; 1 << 20];
    let count = bytes.len() / 12;
    let list = |item: &str, count: usize| vec![item; count].join(",");
    let document = |nodes: usize, primitives: usize| {
        let primitive = r#"{"attributes":{"POSITION":0}}"#;
        let roots = (0..nodes).map(|node| node.to_string()).collect::<Vec<_>>().join(",");
        format!(
            r#"{{"asset":{{"version":"2.0"}},"scenes":[{{"nodes":[{roots}]}}],"nodes":[{}],
            "meshes":[{{"primitives":[{}]}}],"buffers":[{{"byteLength":{}}}],
            "bufferViews":[{{"buffer":0,"byteLength":{2}}}],
            "accessors":[{{"bufferView":0,"componentType":5126,"count":{count},"type":"VEC3",
            "min":[0,0,0],"max":[0,0,0]}}]}}"#,
            list(r#"{"mesh":0}"#, nodes),
            list(primitive, primitives),
            bytes.len()
        )
    };
    for (nodes, primitives) in [(10_000, 1), (1, 10_000), (1_000, 1_000)] {
        let glb = binary(&document(nodes, primitives), &bytes);
        let started = std::time::Instant::now();
        let fault = parse(&glb, Path::new("")).unwrap_err().to_string();
        assert!(fault.contains("has more than the 16777216 vertices"), "{fault}");
        assert!(started.elapsed().as_secs_f64() < 5.0, "{nodes} x {primitives}: {:?}", started.elapsed());
    }
    // A few are read, and only then seen to make no triangle.
    let fault = parse(&binary(&document(10, 10), &bytes), Path::new("")).unwrap_err().to_string();
    assert!(fault.contains("positive area"), "{fault}");
}

#[test]
fn a_document_of_nothing_but_objects_is_refused() {
    let json = format!(r#"{{"asset":{{"version":"2.0"}},"nodes":[{}{{}}]}}"#, "{},".repeat(1 << 20));
    let fault = parse(json.as_bytes(), Path::new("")).unwrap_err().to_string();
    assert!(fault.contains("1048579 objects"), "{fault}");
}

#[test]
fn lists_in_place_of_numbers_and_objects_are_refused() {
    let refused = |fields: &str| {
        let json = format!(r#"{{"asset":{{"version":"2.0"}},{fields}}}"#);
        parse(json.as_bytes(), Path::new("")).unwrap_err().to_string()
    };
    let accessor = |bounds: &str| {
        format!(r#""accessors":[{{"componentType":5126,"count":1,"type":"VEC3","bufferView":0,{bounds}}}]"#)
    };
    for (fields, expected) in [
        (accessor(r#""min":[0,[1],2]"#), "expected f64"),
        (accessor(&format!(r#""max":[{}0]"#, "0,".repeat(16))), "expected at most 16 numbers"),
        (accessor(r#""max":{"x":1}"#), "expected a sequence"),
        (r#""materials":[{},[]]"#.to_owned(), "expected an object"),
        (r#""samplers":[[]]"#.to_owned(), "expected an object"),
        // What some write for a number that is not finite.
        (format!(r#"{},"bufferViews":[]"#, accessor(r#""min":[null,1.5,-2],"max":null"#)), "accessors[0].bufferView"),
        (r#""materials":[{"pbrMetallicRoughness":{}}],"samplers":[{}]"#.to_owned(), "no scene"),
    ] {
        let fault = refused(&fields);
        assert!(fault.contains(expected), "{fields}: {fault}");
    }
    // Bounds take memory as objects do.
    let bounds = format!(r#"{{"min":[{0}0],"max":[{0}0]}},"#, "0,".repeat(8));
    let many = refused(&format!(r#""accessors":[{}{{}}]"#, bounds.repeat(40_000)));
    assert!(many.contains("40003 objects"), "{many}");
}

#[test]
fn buffers_of_one_file_share_it() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("a.bin"), square_bytes()).unwrap();
    let buffers = format!(r#""buffers":[{}]"#, vec![r#"{"uri":"a.bin","byteLength":54}"#; 100].join(","));
    let json = document(NODE, LIST, Some("a.bin")).replace(r#""buffers":[{"uri":"a.bin","byteLength":54}]"#, &buffers);
    let document = ::gltf::Gltf::from_slice(json.as_bytes()).unwrap().document;
    assert_eq!(Buffers::read(&document, None, folder.path()).unwrap().total_bytes(), 54);
    assert_eq!(parse(json.as_bytes(), folder.path()).unwrap().triangle_count(), 2);
}

#[test]
fn version_1_is_named() {
    for version in [r#""1.0""#, "1"] {
        let json = format!(r#"{{"asset": {{"version": {version}}}, "meshes": {{"a": {{}}}}, "buffers": {{}}}}"#);
        assert!(parse(json.as_bytes(), Path::new("")).unwrap_err().to_string().contains("glTF 1.0"));
    }
}

#[test]
fn the_document_promises_the_triangles_of_its_scene() {
    let watch = crate::scene::loading::Watch::default();
    let promised = |bytes: &[u8]| promised_triangles(&mut Stream::new(bytes, bytes.len() as u64, &watch)).unwrap();
    let twice = r#"[{"mesh":0,"children":[1]},{"mesh":0}]"#;
    for (nodes, primitive, triangles) in [(NODE, LIST, 2), (NODE, STRIP, 2), (NODE, FAN, 2), (twice, FAN, 4)] {
        let uri = format!("data:application/octet-stream;base64,{}", base64(&square_bytes()));
        assert_eq!(promised(document(nodes, primitive, Some(&uri)).as_bytes()), Some(triangles), "{primitive}");
        assert_eq!(promised(&binary(&document(nodes, primitive, None), &square_bytes())), Some(triangles));
    }
    // What is not there is no promise, and what is no document either.
    let whole = document(NODE, LIST, None);
    for (from, to) in [(r#""count":6"#, r#""count":6000000000"#), (r#""byteLength":54"#, r#""byteLength":5400000"#)] {
        assert_eq!(promised(&binary(&whole.replace(from, to), &square_bytes())), None, "{to}");
    }
    for bytes in [&b""[..], b"glTF", b"glTF\x02\0\0\0\xff\0\0\0\xff\xff\0\0JSON", b"{", b"[0]"] {
        assert_eq!(promised(bytes), None, "{bytes:?}");
    }
}
