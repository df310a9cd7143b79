//! Input that means harm: names that command a terminal, links out of folders, files without an end.

use std::ffi::OsStr;
use std::fs;
use std::os::unix::ffi::OsStrExt;
use std::os::unix::fs::symlink;
use std::path::Path;
use std::process::Command;

use super::hostile_cost::{black_png, scan_header};
use super::program::{
    ONCE, Program, assert_schema, burning, caustics, entries, file, folder, fumarole, gas, lava, read_json, terrain,
};
use crate::faults::Layer;

/// Retitles the terminal, clears it, and turns the text about.
const ESCAPES: &str = "\x1b]0;x\x07\x1b[2J\u{202e}";

fn is_tame(text: &str) -> bool {
    text.chars().all(|c| c == '\n' || !(c.is_control() || c == '\u{202e}'))
}

#[test]
fn names_command_no_terminal() {
    let out = folder();
    let name = format!("{ESCAPES}\nerror: more.obj");
    let ended = caustics("render --mesh").arg(&name).tiny().run();
    assert!(is_tame(&ended.stderr) && ended.stderr.contains("\\u001b]0;x\\u0007"), "{:?}", ended.stderr);
    ended.refused(2, &["\\u202e", "more.obj"]);

    let usage = caustics("render --planes").arg(ESCAPES).tiny().run();
    assert!(is_tame(&usage.stderr), "{:?}", usage.stderr);
    usage.misused(&["--planes", "\\u202e"]);

    let path = out.path().join(format!("a{ESCAPES}\nb.png"));
    let ended = caustics("render --image").arg(&path).tiny().run().succeeded();
    let is_ours = |line: &str| ["device: ", "warning: ", "wrote "].iter().any(|begin| line.starts_with(begin));
    assert!(path.is_file() && is_tame(&ended.stderr) && ended.stderr.lines().all(is_ours), "{:?}", ended.stderr);
    assert!(ended.stderr.contains("\\u202e\\u000ab.png"), "{:?}", ended.stderr);
}

#[test]
fn records_command_no_terminal() {
    let out = folder();
    caustics("bench --quiet --json a.json").inside(out.path()).tiny().args(ONCE).run().succeeded();
    let mut record = read_json(&out.path().join("a.json"));
    let text = format!("{ESCAPES}\nSAME: all is well");
    for pointer in ["/environment/device/name", "/runs/0/variant", "/runs/0/preset", "/runs/0/passes/0/name"] {
        *record.pointer_mut(pointer).unwrap() = text.clone().into();
    }
    let hostile = file(&out, "b.json", record.to_string());
    let ended = fumarole("compare").arg(&hostile).arg(&hostile).run().succeeded();
    assert!(is_tame(&ended.stdout) && ended.stdout.contains("\\u001b[2J"), "{:?}", ended.stdout);
    let ended = fumarole("compare").arg(&hostile).arg(&hostile).arg("--json").run().succeeded();
    assert!(is_tame(&ended.stdout) && ended.json()["runs"][0]["variant"] == text, "{:?}", ended.stdout);
}

/// Its driver names a device.
#[test]
fn devices_command_no_terminal() {
    let (out, layer) = (folder(), Layer::new());
    let name = format!("{ESCAPES}\nSAME: llvmpipe");
    let on = |program: Program| layer.before(program.inside(out.path()), false).env("FUMAROLE_LAYER_NAME", &name);
    let ended = on(fumarole("devices")).run().succeeded();
    assert!(is_tame(&ended.stdout) && ended.stdout.contains("\\u001b[2J"), "{:?}", ended.stdout);
    let ended = on(fumarole("devices --json")).run().succeeded();
    assert!(is_tame(&ended.stdout) && ended.stdout.contains("\\u001b[2J"), "{:?}", ended.stdout);
    on(caustics("render --device nowhere")).run().refused(2, &["\\u001b[2J", "SAME"]);
    let ended = on(caustics("bench --json a.json").tiny().args(ONCE)).run().succeeded();
    assert!(is_tame(&ended.stderr) && is_tame(&ended.stdout), "{:?}", ended.stderr);
    assert_eq!(read_json(&out.path().join("a.json"))["environment"]["device"]["name"], name);
    let ended = fumarole("report a.json -o a.html").inside(out.path()).run().succeeded();
    assert!(is_tame(&ended.stderr), "{:?}", ended.stderr);
    assert!(is_tame(&fs::read_to_string(out.path().join("a.html")).unwrap()));
}

#[test]
fn names_that_are_not_utf_8_work() {
    let out = folder();
    let named = |ending: &str| out.path().join(OsStr::from_bytes(&[b"caf\xe9", ending.as_bytes()].concat()));
    fs::write(named(".obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
    let dump = [OsStr::new("picture="), named(".npy").as_os_str()].concat_os();
    let render = caustics("render --quiet --mesh").arg(named(".obj")).arg("--image").arg(named(".png")).tiny();
    render.arg("--dump").arg(dump).run().succeeded();
    let range = caustics("render --quiet --frame 0..2 --image").arg(named(".png")).tiny();
    range.run().succeeded();
    assert!(named(".npy").is_file() && named("-0001.png").is_file(), "{:?}", fs::read_dir(out.path()).unwrap());
    let json = named(".json");
    caustics("bench --quiet --mesh").arg(named(".obj")).arg("--json").arg(&json).tiny().args(ONCE).run().succeeded();
    assert_schema(&read_json(&json));
    let twice = [json.as_os_str(), OsStr::new(","), json.as_os_str()].concat_os();
    fumarole("compare").arg(twice).arg(&json).run().succeeded();
    others_that_are_not_utf_8_work(&named);
    caustics("render --mesh").arg(named(".ply")).tiny().run().refused(2, &["caf\u{fffd}.ply", "No such file"]);
}

/// Maps, volumes, materials, folders, tables, traces, films and pages by such names.
fn others_that_are_not_utf_8_work(named: &dyn Fn(&str) -> std::path::PathBuf) {
    fs::write(named(".asc"), "ncols 2\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 30\n1 2\n3 4\n").unwrap();
    let land = terrain("render --quiet --size 32x24 --map").arg(named(".asc"));
    land.arg("--image").arg(named("-map.png")).run().succeeded();
    let volume =
        b"NRRD0004\ntype: uint8\ndimension: 3\nsizes: 2 2 2\nencoding: raw\n\n\x01\x02\x03\x04\x05\x06\x07\x08";
    fs::write(named(".nrrd"), volume).unwrap();
    let gas = gas("render --quiet --size 32x24 --volume-file").arg(named(".nrrd"));
    gas.arg("--image").arg(named("-gas.png")).run().succeeded();
    fs::write(named("-pot.obj"), super::burning_materials::pot()).unwrap();
    fs::write(named(".toml"), "[[material]]\nkind = \"metal\"\nparts = [\"tin\"]\n").unwrap();
    let bench = burning("bench --quiet --variant low-poly --levels 1 --size 32x24 --mesh").arg(named("-pot.obj"));
    let bench = bench.arg("--materials").arg(named(".toml"));
    let bench = bench.args(ONCE).arg("--csv").arg(named(".csv")).arg("--trace").arg(named(".trace.json"));
    bench.arg("--json").arg(named("-burnt.json")).run().succeeded();
    fumarole("report --quiet").arg(named("-burnt.json")).arg("--output").arg(named(".html")).run().succeeded();
    let film = caustics("render --quiet --frame 0..2 --film").arg(named(".y4m")).tiny();
    film.run().succeeded();
    for ending in ["-map.png", "-gas.png", ".csv", ".trace.json", ".html", ".y4m"] {
        assert!(named(ending).exists(), "{ending}");
    }
}

/// Pieces of a name as one.
trait Concat {
    fn concat_os(&self) -> std::ffi::OsString;
}

impl Concat for [&OsStr] {
    fn concat_os(&self) -> std::ffi::OsString {
        self.iter().copied().collect()
    }
}

/// A command line that reads a file, and the endings that it knows.
type Reader = (fn(&Path) -> Program, &'static [&'static str]);

/// Every option that reads a file.
fn readers() -> [Reader; 20] {
    [
        (|path| caustics("render --mesh").arg(path), &["obj", "ply", "stl", "gltf", "glb"]),
        (|path| burning("render --mesh").arg(path), &["obj"]),
        (|path| burning("render --mesh box --object").arg(placed(path)), &["ply"]),
        (|path| gas("render --object").arg(path), &["stl"]),
        (|path| lava("render --object").arg(path), &["obj"]),
        (|path| terrain("render --object").arg(path), &["glb"]),
        (|path| terrain("render --map").arg(path), &["asc", "png", "tif", "hgt", "vrt", "hdr", "bil", "bsq", "dem"]),
        (|path| terrain("render --overview 1 --map").arg(path), &["tif"]),
        (|path| streamed().arg(path), &["asc", "tif", "hgt", "vrt", "hdr"]),
        (|path| lava("render --simulation sph --bed").arg(path), &["asc", "tif", "png"]),
        (|path| caustics("render --water-map").arg(path), &["asc", "tif", "png"]),
        (|path| terrain("render --drape").arg(path), &["png"]),
        (|path| lava("render --rock").arg(path), &["png"]),
        (|path| burning("render --mesh box --texture").arg(path), &["png"]),
        (|path| burning("render --mesh box --materials").arg(path), &["toml"]),
        (|path| gas("render --volume-file").arg(path), &["nrrd", "nhdr", "mhd", "mha", "nii", "nii.gz", "img", "nvdb"]),
        (|path| terrain("collide --bodies").arg(path), &["csv"]),
        (|path| fumarole("compare").arg(path).arg(path), &["json"]),
        (|path| caustics("experiment 5-1 --quiet --assembled").arg(path).on_test_device(), &["json"]),
        // Goes on with the record that is there.
        (|path| caustics("stress --quiet --json").arg(path).on_test_device(), &["json"]),
    ]
}

fn streamed() -> Program {
    terrain("render --variant tiled-compute --stream --map")
}

/// An object of a file with its place.
fn placed(path: &Path) -> std::ffi::OsString {
    [path.as_os_str(), OsStr::new("@1,0,0")].concat_os()
}

fn make_pipe(path: &Path) {
    assert!(Command::new("mkfifo").arg(path).status().unwrap().success());
}

#[test]
fn what_has_no_end_is_refused() {
    let out = folder();
    let each = readers().into_iter().flat_map(|(reader, endings)| endings.iter().map(move |ending| (reader, ending)));
    for (number, (reader, ending)) in each.enumerate() {
        let zeros = out.path().join(format!("zeros{number}.{ending}"));
        let pipe = out.path().join(format!("pipe{number}.{ending}"));
        let nested = out.path().join(format!("folder{number}.{ending}"));
        symlink("/dev/zero", &zeros).unwrap();
        make_pipe(&pipe);
        fs::create_dir(&nested).unwrap();
        for path in [&zeros, &pipe] {
            reader(path).run().refused(2, &["regular file", path.to_str().unwrap()]);
        }
        reader(&nested).run().refused(2, &[nested.to_str().unwrap()]);
    }
}

/// Pipes that a file names, or that lie in a folder; options that take files and folders.
#[test]
fn what_has_no_end_is_refused_in_folders_and_by_name() {
    let out = folder();
    let pipe = out.path().join("pipe");
    make_pipe(&pipe);
    let part = "xOff='0' yOff='0' xSize='2' ySize='2'";
    let source = format!("<SourceFilename relativeToVRT='1'>pipe</SourceFilename><SrcRect {part}/><DstRect {part}/>");
    let vrt = format!(
        "<VRTDataset rasterXSize='2' rasterYSize='2'><VRTRasterBand><SimpleSource>{source}</SimpleSource>\
         </VRTRasterBand></VRTDataset>"
    );
    let vrt = file(&out, "a.vrt", vrt);
    let mhd = "NDims = 3\nDimSize = 2 2 2\nElementType = MET_DOUBLE\nElementDataFile = pipe\n";
    let nhdr = "NRRD0004\ntype: double\ndimension: 3\nsizes: 2 2 2\nendian: little\nencoding: raw\ndata file: pipe\n\n";
    let gltf = r#"{"asset":{"version":"2.0"},"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],
        "meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],"buffers":[{"byteLength":36,"uri":"pipe"}],
        "bufferViews":[{"buffer":0,"byteLength":36}],"accessors":[{"bufferView":0,"componentType":5126,"count":3,
        "type":"VEC3","min":[0,0,0],"max":[0,0,0]}]}"#;
    let toml = "texture = \"pipe\"\n[[material]]\nkind = \"metal\"\ncolor = [0, 0, 1]\n";
    let pipe_in = |name: &str, pipe: &str| {
        let folder = out.path().join(name);
        fs::create_dir(&folder).unwrap();
        make_pipe(&folder.join(pipe));
        folder
    };
    // What is read with a file that lies beside it.
    let beside = |folder: &str, name: &str, bytes: &[u8], pipe: &str| {
        let path = pipe_in(folder, pipe).join(name);
        fs::write(&path, bytes).unwrap();
        path
    };
    let (grid, mut scan) = (&b"ncols 2\nnrows 2\n1 2\n3 4\n"[..], scan_header());
    scan[344..347].copy_from_slice(b"ni1");
    let fail = "it is not a regular file";
    for (program, path, named) in [
        (terrain("render --map"), vrt.clone(), "pipe"),
        (streamed(), vrt, "pipe"),
        (terrain("render --map"), pipe_in("maps", "N45E006.hgt"), "N45E006.hgt"),
        (gas("render --volume-file"), file(&out, "a.mhd", mhd), "pipe"),
        (gas("render --volume-file"), file(&out, "a.nhdr", nhdr), "pipe"),
        (caustics("render --mesh"), file(&out, "a.gltf", gltf), "buffer 0"),
        (burning("render --mesh box --materials"), file(&out, "a.toml", toml), "pipe"),
        (terrain("render --map"), beside("placed", "a.png", &black_png(2), "a.pgw"), "a.pgw"),
        (terrain("render --drape"), beside("drape", "a.png", &black_png(2), "a.pgw"), "a.pgw"),
        (terrain("render --map"), beside("grid", "a.asc", grid, "a.prj"), "a.prj"),
        (terrain("render --map"), beside("raster", "a.bil", &[0; 4], "a.hdr"), "a.hdr"),
        (terrain("render --map"), beside("header", "a.hdr", b"ncols 2\nnrows 2\n", "a.bil"), "a.bil"),
        (gas("render --volume-file"), beside("scan", "a.hdr", &scan, "a.img"), "a.img"),
        (gas("render --volume-file"), beside("samples", "a.img", &[0; 8], "a.hdr"), "a.hdr"),
        (fumarole("assemble"), pipe_in("shards", "a-shard-0-of-2.json"), "a-shard-0-of-2.json"),
        (fumarole("assemble"), pipe_in("parts", "a.png.part.json"), "a.png.part.json"),
        (fumarole("report"), pipe.clone(), "pipe"),
        (fumarole("report --b a.json --a"), pipe.clone(), "pipe"),
        (fumarole("report"), "/dev/zero".into(), "zero"),
    ] {
        program.arg(path).run().refused(2, &[&format!("{named}: {fail}")]);
    }
    fumarole("assemble").arg(&pipe).run().refused(2, &["pipe", "Not a directory"]);
    // What cannot be read is not in the report of a folder, which has nothing then.
    for name in ["a.json", "a.svg"] {
        fumarole("report").arg(pipe_in(&format!("of-{name}"), name)).run().refused(2, &["no record", "no plot"]);
    }
}

fn own_shaders(to: &Path) {
    let from = Path::new(env!("CARGO_MANIFEST_DIR")).join("shaders");
    assert!(Command::new("cp").arg("-r").arg(from).arg(to).status().unwrap().success());
}

#[test]
fn shader_folders_hold_their_shaders_themselves() {
    let out = folder();
    let shaders = out.path().join("shaders");
    own_shaders(&shaders);
    let secret = file(&out, "secret", "root:x:0:0:secret words\n");
    let cast = shaders.join("caustics/cast.frag");
    for (target, part) in [(secret.as_path(), "link out of"), (Path::new("/dev/zero"), "link out of")] {
        fs::remove_file(&cast).unwrap();
        symlink(target, &cast).unwrap();
        let ended = caustics("render --shader-dir").arg(&shaders).tiny().run();
        assert!(!ended.stderr.contains("secret words"), "{}", ended.stderr);
        ended.refused(2, &["cast.frag", part]);
    }
    fs::remove_file(&cast).unwrap();
    make_pipe(&cast);
    caustics("render --shader-dir").arg(&shaders).tiny().run().refused(2, &["cast.frag", "regular file"]);
}

#[test]
fn a_shader_with_another_interface_is_refused_as_input() {
    let out = folder();
    let shaders = out.path().join("shaders");
    own_shaders(&shaders);
    let cast = shaders.join("caustics/cast.frag");
    let text = fs::read_to_string(&cast).unwrap();
    let (head, tail) = text.split_once('\n').unwrap();
    let more = "layout(location = 9) in vec4 more;\n";
    let tail = tail.replacen("void main() {", "void main() {\n    if (more.x > 2.0) discard;", 1);
    fs::write(&cast, format!("{head}\n{more}{tail}")).unwrap();
    let program = caustics("render --quiet --shader-dir").arg(&shaders).tiny();
    program.run().refused(2, &["shaders", "cast-one.frag", "more", "keep the inputs"]);
}

#[test]
fn links_are_written_through_by_every_writer() {
    let out = folder();
    fs::create_dir(out.path().join("real")).unwrap();
    for name in ["a.json", "a.csv", "a.trace", "a.png"] {
        symlink(format!("real/{name}"), out.path().join(name)).unwrap();
    }
    let files = "--quiet --json a.json --csv a.csv --trace a.trace --image a.png";
    // The first run makes the files, the second replaces them.
    for _ in 0..2 {
        caustics("bench").args(files).inside(out.path()).tiny().args(ONCE).run().succeeded();
        assert_eq!(entries(&out.path().join("real")), ["a.csv", "a.json", "a.png", "a.trace"]);
        for name in ["a.json", "a.csv", "a.trace", "a.png"] {
            assert!(fs::symlink_metadata(out.path().join(name)).unwrap().is_symlink(), "{name}");
        }
    }
    let more = ["film.y4m", "water.npy", "page.html"];
    for name in more {
        symlink(format!("real/{name}"), out.path().join(name)).unwrap();
    }
    for written in ["--frame 0..2 --film film.y4m", "--image a.png --dump water=water.npy"] {
        caustics("render --quiet").args(written).inside(out.path()).tiny().run().succeeded();
    }
    fumarole("report a.json --quiet -o page.html").inside(out.path()).run().succeeded();
    for name in more {
        assert!(fs::symlink_metadata(out.path().join(name)).unwrap().is_symlink(), "{name}");
        assert!(fs::metadata(out.path().join("real").join(name)).unwrap().len() > 0, "{name}");
    }
}

#[test]
fn no_message_names_a_temporary_file() {
    for option in ["--json /proc/a.json", "--csv /proc/a.csv", "--image /proc/a.png"] {
        let ended = caustics("bench --quiet").args(option).tiny().args(ONCE).run();
        assert!(!ended.stderr.contains(".tmp"), "{}", ended.stderr);
        ended.refused(2, &["/proc/a."]);
    }
}
