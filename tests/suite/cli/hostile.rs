//! Input that means harm: names that command a terminal, links out of folders, files without an end.

use std::ffi::OsStr;
use std::fs;
use std::os::unix::ffi::OsStrExt;
use std::os::unix::fs::symlink;
use std::path::Path;
use std::process::Command;

use super::program::{
    ONCE, Program, assert_schema, burning, caustics, entries, file, folder, fumarole, gas, lava, read_json, terrain,
};

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
    caustics("render --mesh").arg(named(".ply")).tiny().run().refused(2, &["caf\u{fffd}.ply", "No such file"]);
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

/// A command line that lacks the file to read, and an ending that it knows.
type Reader = (fn() -> Program, &'static str);

/// Every option that reads a file.
fn readers() -> [Reader; 15] {
    [
        (|| caustics("render --mesh"), "obj"),
        (|| caustics("render --mesh"), "gltf"),
        (|| terrain("render --map"), "asc"),
        (|| terrain("render --variant tiled-compute --stream --map"), "asc"),
        (|| terrain("render --map"), "png"),
        (|| terrain("render --drape"), "png"),
        (|| gas("render --volume-file"), "nrrd"),
        (|| gas("render --volume-file"), "nhdr"),
        (|| gas("render --volume-file"), "mhd"),
        (|| gas("render --volume-file"), "nii"),
        (|| gas("render --volume-file"), "nii.gz"),
        (|| gas("render --volume-file"), "nvdb"),
        (|| lava("render --rock"), "png"),
        (|| burning("render --mesh box --texture"), "png"),
        (|| fumarole("compare"), "json"),
    ]
}

#[test]
fn what_has_no_end_is_refused() {
    let out = folder();
    for (number, (reader, ending)) in readers().into_iter().enumerate() {
        let zeros = out.path().join(format!("zeros{number}.{ending}"));
        let pipe = out.path().join(format!("pipe{number}.{ending}"));
        symlink("/dev/zero", &zeros).unwrap();
        assert!(Command::new("mkfifo").arg(&pipe).status().unwrap().success());
        for path in [&zeros, &pipe, &out.path().to_owned()] {
            let program = reader().arg(path);
            let program = if ending == "json" { program.arg(path) } else { program };
            let ended = program.run();
            let is_folder = path == out.path();
            let part = if is_folder { "" } else { "regular file" };
            ended.refused(2, &[part, path.to_str().unwrap()]);
        }
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
    assert!(Command::new("mkfifo").arg(&cast).status().unwrap().success());
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
}

#[test]
fn no_message_names_a_temporary_file() {
    for option in ["--json /proc/a.json", "--csv /proc/a.csv", "--image /proc/a.png"] {
        let ended = caustics("bench --quiet").args(option).tiny().args(ONCE).run();
        assert!(!ended.stderr.contains(".tmp"), "{}", ended.stderr);
        ended.refused(2, &["/proc/a."]);
    }
}
