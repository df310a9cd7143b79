//! A loop that does not finish fails the run by the name of its pass and by what the user may change. Shaders that were
//! changed leave their loops early, as a driver may.

use std::fs;

use super::program::{Program, caustics, entries, folder, gas};
use super::shaders::own_shaders;

/// A shader's file, a line of it, and the line that takes its place.
type Edit<'a> = (&'a str, &'a str, &'a str);

/// Asserts that a picture of the changed shaders fails with all `parts`.
fn assert_fails(program: Program, (file, line, instead): Edit<'_>, parts: &[&str]) {
    let out = folder();
    let path = own_shaders(out.path()).join(file);
    let text = fs::read_to_string(&path).unwrap();
    assert_eq!(text.matches(line).count(), 1, "{file} has {line:?} once");
    fs::write(&path, text.replace(line, instead)).unwrap();
    let program = program.args("--quiet --image a.png --shader-dir my-shaders").on_test_device().inside(out.path());
    program.run().refused(1, parts);
    assert_eq!(entries(out.path()), ["my-shaders"]);
}

#[test]
fn gas_names_each_pass_that_does_not_finish_a_pixel() {
    let line = "    uint is_last = uint(band.call + 1u == band.calls) & uint(!is_done);";
    for (pass, name, option) in [
        ("SORT", "sort", "--size"),
        ("VOLUME", "volume", "--steps"),
        ("LIGHT_ATTENUATION", "light-attenuation", "--steps"),
        ("RESOLVE", "resolve", "--size"),
    ] {
        let instead = format!("    is_done = is_done && pass != {pass};\n{line}");
        let program = gas("render --size 12x8 --steps 4 --table 4 --variant table");
        assert_fails(program, ("gas/progress.glsl", line, &instead), &[&format!("pass {name}"), option]);
    }
}

#[test]
fn gas_names_froxels_that_do_not_finish() {
    let program = gas("render --size 12x8 --steps 4 --froxels 9x7x8 --variant froxel");
    let edit = ("gas/froxel-inject.comp", "if (is_cut || i < counts.samples) {", "if (true) {");
    assert_fails(program, edit, &["pass volume", "--steps"]);
}

#[test]
fn caustics_names_light_that_is_left_out() {
    let small = "render --size 32x24 --map-size 16 --water-triangles 100 --mesh box --variant hit";
    for (pass, line) in [("land", "if (is_cut || y <= to.y) {"), ("straddle", "if (is_cut || at < straddling.count) {")]
    {
        let edit = (&*format!("caustics/{pass}.comp"), line, "if (true) {");
        assert_fails(caustics(small), edit, &[&format!("pass {pass}"), "--water-triangles"]);
    }
}

#[test]
fn caustics_names_rays_that_do_not_end() {
    let program = caustics("render --size 32x24 --map-size 16 --water-triangles 100 --planes 3 --variant culled");
    let line = "view.node_count, view.most_steps);";
    let edit = ("caustics/view-above.glsl", line, "view.node_count, 1u);");
    assert_fails(program, edit, &["pass view", "did not end", "--samples"]);
}
