use super::*;
use crate::scene::normals::double_area_vector;
use crate::scene::random::Random;
use std::path::PathBuf;

fn asset(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("assets").join(name)
}

fn parse(ending: &str, bytes: Vec<u8>) -> Result<Mesh, Fault> {
    let (_, read) = FORMATS.iter().find(|(known, _)| *known == ending).unwrap();
    read_with(|stream| read(stream, Path::new("nowhere")), &bytes)
}

/// The mesh that a reader makes of bytes, smooth everywhere.
pub fn read_with(read: impl FnOnce(&mut Stream<'_>) -> Result<Parts, Stop>, bytes: &[u8]) -> Result<Mesh, Fault> {
    let watch = Watch::default();
    match read(&mut Stream::new(bytes, bytes.len() as u64, &watch)) {
        Ok(parts) => parts.into_mesh(180.0),
        Err(Stop::Fault(fault)) => Err(fault),
        Err(stop) => panic!("{stop:?}"),
    }
}

fn load_plain(path: &Path) -> Result<Mesh, Error> {
    load(path, &MeshOptions { crease_deg: 180.0, ..MeshOptions::default() }, &Conditions::plain())
}

/// A small valid file of every kind, with its ending.
fn samples() -> Vec<(&'static str, Vec<u8>)> {
    let ply = |format: &str, body: &[u8]| {
        let header = format!(
            "ply\nformat {format} 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
             element face 1\nproperty list uchar int vertex_indices\nend_header\n"
        );
        [header.as_bytes(), body].concat()
    };
    let corners = [[0.0_f32, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let positions = |bytes: fn(f32) -> [u8; 4]| corners.iter().flatten().flat_map(|x| bytes(*x)).collect();
    let little: Vec<u8> = positions(f32::to_le_bytes);
    let big: Vec<u8> = positions(f32::to_be_bytes);
    let list = |bytes: fn(i32) -> [u8; 4]| std::iter::once(3).chain((0..3).flat_map(bytes)).collect();
    let little_list: Vec<u8> = list(i32::to_le_bytes);
    let big_list: Vec<u8> = list(i32::to_be_bytes);
    let stl = [&[0; 80][..], &1_u32.to_le_bytes(), &[0; 12], &little, &[0; 2]].concat();
    let json = r#"{"asset":{"version":"2.0"},"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],
        "meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],"buffers":[{URI"byteLength":36}],
        "bufferViews":[{"buffer":0,"byteLength":36,"byteStride":12}],
        "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]}]}"#;
    let data = r#""uri":"data:;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA","#;
    let gltf = json.replace("URI", data).into_bytes();
    let mut chunk = json.replace("URI", "").into_bytes();
    chunk.resize(chunk.len().next_multiple_of(4), b' ');
    let total = 28 + chunk.len() as u32 + 36;
    let glb = [
        b"glTF\x02\0\0\0",
        &total.to_le_bytes()[..],
        &(chunk.len() as u32).to_le_bytes(),
        b"JSON",
        &chunk,
        &36_u32.to_le_bytes(),
        b"BIN\0",
        &little,
    ]
    .concat();
    let obj = b"# a\no b\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nvn 0 0 1\nvt 0 1\n\
                f 1/1/1 2/1/1 -1/-1/-1 3//1\n";
    let stl_text = b"solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n\
                     endloop\nendfacet\nendsolid a\n";
    vec![
        ("obj", obj.to_vec()),
        ("ply", ply("ascii", b"0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n")),
        ("ply", ply("binary_little_endian", &[little.clone(), little_list].concat())),
        ("ply", ply("binary_big_endian", &[big, big_list].concat())),
        ("stl", stl),
        ("stl", stl_text.to_vec()),
        ("gltf", gltf),
        ("glb", glb),
    ]
}

#[test]
fn samples_are_valid() {
    for (ending, bytes) in samples() {
        let mesh = parse(ending, bytes).unwrap_or_else(|fault| panic!("{ending}: {fault}"));
        mesh.validate().unwrap();
    }
}

/// Asserts the outcome that any bytes at all must have: a valid mesh, or a fault told in one line.
fn assert_sound(ending: &str, bytes: Vec<u8>) -> bool {
    match parse(ending, bytes) {
        Ok(mesh) => {
            mesh.validate().unwrap();
            true
        }
        Err(fault) => {
            let message = fault.to_string();
            assert!(!message.contains(char::is_control), "{ending}: {message:?}");
            assert!(message.len() < 1_000, "{ending}: {message:?}");
            false
        }
    }
}

#[test]
fn every_prefix_is_a_mesh_or_a_fault() {
    for (ending, bytes) in samples() {
        let is_text = bytes.is_ascii() && !bytes.contains(&0);
        for end in 0..bytes.len() {
            let is_mesh = assert_sound(ending, bytes[..end].to_vec());
            // Text may miss its last words: the end of a number, a face or a name.
            let may_be_mesh = is_text && end + 20 > bytes.len();
            assert!(may_be_mesh || !is_mesh, "{ending} cut at {end}");
        }
    }
}

#[test]
fn random_bytes_and_damaged_files_are_meshes_or_faults() {
    let mut random = Random::new(11);
    let mut below = |limit: usize| random.next_u32() as usize % limit;
    let samples = samples();
    let texts = [
        "0",
        "-1",
        "4294967295",
        "18446744073709551615",
        "9223372036854775808",
        "1e39",
        "nan",
        "/",
        "[]",
        "{}",
        "null",
        "\n",
        " ",
    ];
    let mut meshes = 0;
    for round in 0..6_000 {
        let (ending, mut bytes) = samples[round % samples.len()].clone();
        match below(8) {
            0 => bytes = (0..below(300)).map(|_| below(256) as u8).collect(),
            1 => {
                let start = below(bytes.len());
                bytes.truncate(start);
                bytes.extend((0..below(100)).map(|_| below(256) as u8));
            }
            2 | 3 => {
                let digits: Vec<usize> = (0..bytes.len()).filter(|i| bytes[*i].is_ascii_digit()).collect();
                if !digits.is_empty() {
                    let place = digits[below(digits.len())];
                    let text = texts[below(texts.len())].bytes();
                    bytes.splice(place..=place, text);
                }
            }
            4 => {
                let (from, length) = (below(bytes.len()), below(40));
                let end = bytes.len().min(from + length);
                bytes.drain(from..end);
            }
            _ => {
                for _ in 0..=below(4) {
                    let place = below(bytes.len());
                    bytes[place] = [below(256) as u8, 0, 255, b'0' + below(10) as u8][below(4)];
                }
            }
        }
        meshes += usize::from(assert_sound(ending, bytes));
    }
    // Neither all refused nor all accepted, or the damage tests nothing.
    assert!((100..5_000).contains(&meshes), "{meshes}");
}

#[test]
fn files_that_cannot_be_read_are_named() {
    let directory = tempfile::tempdir().unwrap();
    let path = |name: &str| directory.path().join(name);
    std::fs::create_dir(path("folder.obj")).unwrap();
    for name in ["empty.obj", "empty.PLY", "empty.stl", "empty.gltf", "empty.glb", "bare", "mesh.xyz"] {
        std::fs::write(path(name), "").unwrap();
    }
    let error = |name: &str| load_plain(&path(name)).expect_err(name);
    assert!(matches!(error("missing.obj"), Error::Read { .. }));
    assert!(matches!(error("folder.obj"), Error::NotAFile { .. }));
    for name in ["empty.obj", "empty.PLY", "empty.stl", "empty.gltf", "empty.glb"] {
        assert!(matches!(error(name), Error::Malformed { .. }), "{name}");
    }
    for name in ["bare", "mesh.xyz"] {
        assert!(matches!(error(name), Error::UnknownEnding { .. }), "{name}");
        assert!(error(name).to_string().ends_with(".obj, .ply, .stl, .gltf, .glb"));
    }
    for name in ["missing.obj", "folder.obj", "empty.stl", "bare"] {
        let message = error(name).to_string();
        assert!(message.contains(name) && !message.contains('\n'), "{message}");
    }
}

#[cfg(unix)]
#[test]
fn files_beyond_the_limit_are_refused_unread() {
    let file = tempfile::Builder::new().suffix(".stl").tempfile().unwrap();
    file.as_file().set_len(MAX_FILE_BYTES + 1).unwrap();
    assert!(load_plain(file.path()).unwrap_err().to_string().contains("exceed the limit"));
    assert!(matches!(load_plain(Path::new("/dev/zero.obj")), Err(Error::Read { .. })));
    let link = tempfile::tempdir().unwrap().keep().join("endless.obj");
    std::os::unix::fs::symlink("/dev/zero", &link).unwrap();
    assert!(matches!(load_plain(&link), Err(Error::NotAFile { .. })));
    std::fs::remove_dir_all(link.parent().unwrap()).unwrap();
}

#[test]
fn shipped_meshes_have_their_documented_counts() {
    for (name, vertices, triangles) in [
        ("meshes/bunny.obj", 1_839, 3_674),
        ("meshes/teapot.obj", 792, 992),
        ("meshes/spider.obj", 974, 1_368),
        ("meshes/concave_polygon.obj", 64, 64),
        ("meshes/wuson.stl", 2_117, 3_732),
        ("meshes/ant.ply", 486, 912),
        ("meshes/airplane.ply", 1_335, 2_452),
        ("meshes/cube_binary.ply", 8, 12),
        ("meshes/Mesh_PrimitiveMode_05.gltf", 4, 2),
        ("meshes/Mesh_PrimitiveMode_11.gltf", 4, 2),
    ] {
        let mesh = load_plain(&asset(name)).unwrap();
        mesh.validate().unwrap();
        assert_eq!((mesh.positions.len(), mesh.triangle_count()), (vertices, triangles), "{name}");
        assert_eq!(Path::new(name).file_stem().unwrap().to_str(), Some(mesh.name.as_str()));
    }
}

/// Both glTF samples are a square of edge 1 seen from +Z, as a fan and as an indexed strip.
#[test]
fn shipped_strips_and_fans_cover_their_square() {
    for mode in ["05", "11"] {
        let mesh = load_plain(&asset(&format!("meshes/Mesh_PrimitiveMode_{mode}.gltf"))).unwrap();
        for corners in mesh.indices.chunks_exact(3) {
            let [a, b, c] = [0, 1, 2].map(|i| mesh.positions[corners[i] as usize]);
            assert_eq!(double_area_vector(a, b, c), glam::DVec3::Z, "{mode}");
        }
    }
}

/// The polygon is a flat ring, open at one corner, in a plane of constant x; a fan would cover its
/// hole.
#[test]
fn a_concave_polygon_keeps_its_area() {
    let path = asset("meshes/concave_polygon.obj");
    let mesh = load_plain(&path).unwrap();
    let text = std::fs::read_to_string(path).unwrap();
    let statement = |keyword: &str| {
        let keyword = format!("{keyword} ");
        text.lines().filter_map(move |line| line.strip_prefix(&keyword).map(str::to_owned)).collect::<Vec<_>>()
    };
    let points: Vec<[f64; 2]> = statement("v")
        .iter()
        .map(|line| line.split_whitespace().skip(1).map(|x| x.parse().unwrap()).collect::<Vec<f64>>())
        .map(|yz| [yz[0], yz[1]])
        .collect();
    let outline: Vec<[f64; 2]> = statement("f")[0]
        .split_whitespace()
        .map(|corner| corner.split('/').next().unwrap().parse::<usize>().unwrap() - 1)
        .map(|index| points[index])
        .collect();
    // Shoelace formula.
    let area: f64 = (0..outline.len())
        .map(|i| (outline[i], outline[(i + 1) % outline.len()]))
        .map(|([y0, z0], [y1, z1])| (y0 * z1 - y1 * z0) / 2.0)
        .sum();
    let covered: Vec<f64> = mesh
        .indices
        .chunks_exact(3)
        .map(|t| {
            double_area_vector(
                mesh.positions[t[0] as usize],
                mesh.positions[t[1] as usize],
                mesh.positions[t[2] as usize],
            )
            .x / 2.0
        })
        .collect();
    assert!((covered.iter().sum::<f64>() - area).abs() < 1e-5, "{area}");
    assert!((covered.iter().map(|x| x.abs()).sum::<f64>() - area.abs()).abs() < 1e-5);
}

/// Fetches the meshes that are not shipped, once, and says loudly what could not be fetched: past the test harness,
/// which keeps the output of tests that pass to itself.
fn fetch_assets() {
    use std::io::Write;
    let script = asset("fetch.sh");
    let Ok(output) = std::process::Command::new("sh").arg(&script).stdin(std::process::Stdio::null()).output() else {
        let _unheard = writeln!(std::io::stderr(), "SKIPPED fetched meshes: this system has no sh");
        return;
    };
    let said = String::from_utf8_lossy(&output.stdout);
    assert!(output.status.success(), "{said}{}", String::from_utf8_lossy(&output.stderr));
    if let Some(line) = said.lines().find(|line| line.starts_with("SKIPPED")) {
        let _unheard = writeln!(std::io::stderr(), "{line}");
    }
}

#[test]
fn fetched_dragons_have_their_documented_counts() {
    fetch_assets();
    for (name, vertices, triangles) in
        [("fetched/dragon_vrip.ply", 437_645, 871_414), ("fetched/dragon_vrip_res3.ply", 22_998, 47_794)]
    {
        let path = asset(name);
        // Said above.
        if !path.exists() {
            continue;
        }
        let mesh = load_plain(&path).unwrap();
        mesh.validate().unwrap();
        assert_eq!((mesh.positions.len(), mesh.triangle_count()), (vertices, triangles), "{name}");
        assert!(mesh.bounds().diagonal().length() < 0.3);
    }
}
