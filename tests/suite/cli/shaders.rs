//! `--shader-dir`: shaders compiled at start.

use std::fs;
use std::path::{Path, PathBuf};

use super::program::{ONCE, caustics, folder, sha256};

fn copy(from: &Path, to: &Path) {
    fs::create_dir_all(to).unwrap();
    for entry in fs::read_dir(from).unwrap() {
        let (path, target) = (entry.as_ref().unwrap().path(), to.join(entry.unwrap().file_name()));
        if path.is_dir() { copy(&path, &target) } else { fs::write(&target, fs::read(&path).unwrap()).unwrap() }
    }
}

/// A copy of the program's own shaders in `folder`.
pub(super) fn own_shaders(folder: &Path) -> PathBuf {
    let shaders = folder.join("my-shaders");
    copy(&Path::new(env!("CARGO_MANIFEST_DIR")).join("shaders"), &shaders);
    shaders
}

/// Replaces the end of the cast's shader.
pub(super) fn end_cast_with(shaders: &Path, ending: &str) -> usize {
    let path = shaders.join("caustics/cast.frag");
    let text = fs::read_to_string(&path).unwrap();
    let (body, _) = text.rsplit_once('}').unwrap();
    fs::write(&path, format!("{body}{ending}\n}}\n")).unwrap();
    body.lines().count() + 1
}

#[test]
fn a_changed_shader_changes_the_picture() {
    let out = folder();
    let shaders = own_shaders(out.path());
    let picture = |name: &str, options: &str| {
        let program = caustics("render --quiet --validate --image").arg(name).inside(out.path()).tiny();
        program.args(options).run().succeeded();
        sha256(&out.path().join(name))
    };
    let built_in = picture("a.png", "");
    assert_eq!(built_in, picture("b.png", "--shader-dir my-shaders"));
    end_cast_with(&shaders, "    color.r += 0.5;");
    assert_ne!(built_in, picture("c.png", "--shader-dir my-shaders"));
    assert_eq!(built_in, picture("d.png", ""));
}

#[test]
fn a_shader_that_does_not_compile_is_refused_with_its_line() {
    let out = folder();
    let line = end_cast_with(&own_shaders(out.path()), "    color = no_such_value;");
    let program = || caustics("bench --shader-dir my-shaders").inside(out.path()).tiny().args(ONCE);
    program().run().refused(2, &[&format!("caustics/cast.frag:{line}"), "no_such_value"]);
    end_cast_with(&out.path().join("my-shaders"), "#include \"no/such.glsl\"");
    program().run().refused(2, &["caustics/cast.frag:", "no/such.glsl"]);
}

/// Else it would run the built-in shaders and say nothing.
#[test]
fn a_folder_that_replaces_nothing_is_refused() {
    let out = folder();
    fs::create_dir(out.path().join("empty")).unwrap();
    fs::create_dir(out.path().join("other")).unwrap();
    fs::write(out.path().join("other/mine.comp"), "#version 450\nvoid main() {}\n").unwrap();
    fs::write(out.path().join("file"), "").unwrap();
    for dir in ["empty", "other", "file", "no-such-dir"] {
        let program = caustics("bench --shader-dir").arg(dir).inside(out.path()).tiny().args(ONCE);
        program.run().refused(2, &[dir]);
    }
}
