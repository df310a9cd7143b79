//! A loop that does not finish fails the run by the name of its pass and by what the user may change. Shaders that were
//! changed leave their loops early, as a driver may.

use std::fs;

use super::program::{Program, caustics, entries, folder, gas, lava, terrain};
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
    let ends = "    } while (i < counts.samples);";
    for (line, instead) in [("if (is_cut || i < counts.samples) {", "if (true) {"), (ends, "    } while (false);")] {
        let program = gas("render --size 12x8 --steps 4 --samples 4 --froxels 9x7x8 --variant froxel");
        assert_fails(program, ("gas/froxel-inject.comp", line, instead), &["pass volume", "--steps"]);
    }
}

/// Each shader of the tiles says so by itself.
#[test]
fn gas_names_tiles_whose_triangles_do_not_end() {
    let of_tile = "for (; done < count; done++) {";
    let none = "for (; done < 0u; done++) {";
    // The three walks of a pixel through its triangles, by what follows each.
    let walk = |after: &str| {
        let line = format!("    }} while (bits != 0u || chunk < to);\n{after}");
        let instead = format!("    }} while (false);\n{after}");
        (line, instead)
    };
    let also = "    is_ended_here = is_ended_here || bits != 0u || chunk < to;\n";
    let covered = walk("    bool is_ended_here = bits");
    let counted = walk(&format!("{also}    uint wanted"));
    let kept = walk(&format!("{also}    if (behind"));
    let nearest = "    } while (bits != 0u || chunk < chunks.to);\n    if (bits";
    for (lists, shader, line, instead) in [
        ("tiles", "tiles-count", of_tile, none),
        ("tiles", "tiles-sum", "for (; tile < to; tile++) {", "for (; tile < from; tile++) {"),
        ("tiles", "tiles-fill", of_tile, none),
        ("tiles", "fragments-tiles", &*covered.0, &*covered.1),
        ("tiles", "fragments-tiles", &*counted.0, &*counted.1),
        ("tiles", "fragments-tiles", &*kept.0, &*kept.1),
        ("k:2", "fragments-nearest", nearest, "    } while (false);\n    if (bits"),
        ("k:2", "fragments-nearest", "for (; linked < kept; linked++) {", "for (; linked < 0u; linked++) {"),
        (
            "k:2",
            "fragments-nearest",
            "for (; looked_at < kept; looked_at++) {",
            "for (; looked_at < 1u; looked_at++) {",
        ),
    ] {
        let program = gas(&format!("render --size 12x8 --steps 4 --lists {lists}"));
        let file = format!("gas/{shader}.comp");
        assert_fails(program, (&file, line, instead), &["pass fragments", "loops", "--lists linked"]);
    }
}

/// The view below looks away from the map, so that it shows nothing but a box.
#[test]
fn terrain_names_rays_to_the_sun_that_do_not_end() {
    let small = "render --size 16x12 --resolution 16 --shadows --sun";
    let on_land = "0,3 --object box@0,0,0,300 --camera=0,1000,9000,0,1000,0";
    let alone = "0,0.5 --object box@0,9000,0,8000 --camera=0,50,5500,0,1600,9000";
    let in_tree = ("terrain/occlusion.glsl", "const uint MOST_STEPS = 60000u;", "const uint MOST_STEPS = 0u;");
    let once = "#define while(condition) for (int once = 0; once < 1; once++)\nint shadow_shift;";
    let over_map = ("terrain/leaf-shadow.glsl", "int shadow_shift;", once);
    for (pass, scene, edit) in [
        ("shadow", on_land, over_map),
        ("occlusion", on_land, in_tree),
        ("object-shadow", alone, over_map),
        ("object-occlusion", alone, in_tree),
    ] {
        let program = terrain(&format!("{small} {scene}"));
        assert_fails(program, edit, &[&format!("pass {pass}: "), "rays did not end", "--object"]);
    }
}

#[test]
fn lava_names_particles_that_are_left_out() {
    let small = "render --simulation sph --rheology basalt --pieces 1 --particles 400 --size 32x24 --density 32x16x32 \
                 --frame 2";
    let near = "place_m.y, reach_m, MOST);";
    let all = "uint first = max(stretch.x, max(stretch.y, MOST) - MOST);";
    for (pass, file, line, instead) in [
        ("sph-neighbours", "sph.glsl", "const uint MOST = 7200u;", "const uint MOST = 1u;"),
        ("surface-temperature", "surface-temperature.comp", near, "place_m.y, reach_m, 1u);"),
        ("surface-motion", "surface-motion.comp", all, "uint first = max(stretch.x, max(stretch.y, 1u) - 1u);"),
        (
            "crust-relief",
            "crust-relief.comp",
            "const uint MOST_OF_RELIEF = MOST / 4u;",
            "const uint MOST_OF_RELIEF = 1u;",
        ),
    ] {
        let file = format!("lava/{file}");
        assert_fails(lava(small), (&file, line, instead), &[&format!("pass {pass}: "), "--particles"]);
    }
}

#[test]
fn caustics_names_light_that_is_left_out() {
    let small = "render --size 32x24 --map-size 16 --water-triangles 100 --mesh box --variant hit";
    for (pass, line) in [
        ("land", "if (is_cut || y <= to.y) {"),
        ("straddle", "if (is_cut || is_shadow_cut || at < straddling.count) {"),
    ] {
        let edit = (&*format!("caustics/{pass}.comp"), line, "if (true) {");
        assert_fails(caustics(small), edit, &[&format!("pass {pass}"), "--water-triangles"]);
    }
    let rows = ("caustics/land.comp", "for (; y <= to.y; y++) {", "for (; y < from.y; y++) {");
    assert_fails(caustics(small), rows, &["pass land", "--water-triangles"]);
    let surfaces = "for (; layer < layer_count(); layer++) {\n            // Every";
    let first = "for (; layer < 0; layer++) {\n            // Every";
    let teapot = small.replace("--map-size 16", "--map-size 64").replace("--mesh box", "--mesh teapot");
    assert_fails(caustics(&teapot), ("caustics/straddle.comp", surfaces, first), &["pass straddle"]);
    let shadow = ("caustics/shadow-on.glsl", "for (; i < SHADOW_STEPS; i++) {", "for (; i < 0; i++) {");
    assert_fails(caustics(&format!("{small} --shadows")), shadow, &["pass intersect", "did not end"]);
    // Rays that have not come down to the receiver.
    let turns = ("caustics/intersect.comp", "const int MOST_TURNS = 60000;", "const int MOST_TURNS = 0;");
    for layers in [1, 2] {
        let program = caustics(&format!("{small} --layers {layers}"));
        assert_fails(program, turns, &["pass intersect", "did not end", "--map-size", "--layers"]);
    }
}

#[test]
fn caustics_names_rays_that_do_not_end() {
    let small = "render --size 32x24 --map-size 16 --water-triangles 100 --planes 3 --variant culled";
    let line = "view.node_count, view.most_steps);";
    for (camera, file) in [("above", "caustics/view-above.glsl"), ("below", "caustics/view-below.frag")] {
        let program = caustics(&format!("{small} --camera {camera}"));
        let edit = (file, line, "view.node_count, 1u);");
        assert_fails(program, edit, &["pass view", "did not end", "--samples"]);
    }
}
