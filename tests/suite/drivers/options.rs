//! Options that add passes, shaders or buffers to a paper's own, each once under the current layer.

use std::fs;

use fumarole::image::{Rgba8, write_png};

use super::{BURNING, CAUSTICS, GAS, LAVA, Paper, TERRAIN};
use crate::cli::burning_materials::pot;
use crate::cli::program::{ONCE, folder};

/// Runs variants, each row's first words, with the row's options.
fn assert_clean(paper: &Paper, rows: &[(&str, &str)]) {
    let folder = folder();
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    write("pot.obj", &pot());
    write(
        "pot.toml",
        "[[material]]\nkind = \"metal\"\nparts = [\"tin\"]\n\n[[material]]\nkind = \"paper\"\nparts = [\"clay\"]\n",
    );
    let picture = Rgba8::new(2, 2, [90, 120, 60, 255].repeat(4)).unwrap();
    write_png(&folder.path().join("photo.png"), &picture).unwrap();
    let mut failures = Vec::new();
    for (variants, options) in rows {
        let program = paper.run("bench --quiet --json").args(ONCE).args("--variant").arg(variants).args(options);
        let program = paper.under_current_layer(program.on_test_device().inside(folder.path()), &folder);
        let ended = program.run();
        if ended.status.code() != Some(0) {
            failures.push(format!("{variants} {options}: {}", ended.stderr));
            continue;
        }
        let record = ended.json();
        let runs = record["runs"].as_array().unwrap();
        assert!(
            !runs.is_empty() && runs.iter().all(|run| run["validation"] == "clean"),
            "{variants} {options}: {record}"
        );
    }
    assert!(failures.is_empty(), "{} of {}:\n{}", failures.len(), rows.len(), failures.join("\n"));
}

#[test]
fn lava_is_clean_with_its_options() {
    let scene = "--size 32x24 --particles 100 --radius 0.3 --density 8x4x4 --splats 10x5 --splat-radius 0.2";
    assert_clean(
        &Paper { scene, ..LAVA },
        &[
            ("all", "--simulation sph --surface top --color blackbody --object box --no-geometry-stage"),
            ("gpu-driven", "--surface-draw splats --shading heights --splat-shape fitted"),
            (
                "gpu-driven",
                "--simulation sph --bed maunga-whau --space 4x2x4 --rheology basalt --effusion-rate 0.02 --surface crossing",
            ),
            (
                "gpu-driven",
                "--simulation sph --rheology basalt --surface crossing --skin 0.5 --pieces 1.5 --jumble 0.5",
            ),
            ("gpu-driven", "--shading particles"),
            ("paper", "--shading normals"),
        ],
    );
}

#[test]
fn gas_is_clean_with_its_options() {
    let eight = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/volumes/eight.nrrd");
    let files = format!(
        "--steps 4 --lists tiles --density-cache 4 --skip-empty 0 --volume-filter tricubic --volume-file {eight}"
    );
    let temperatures =
        format!("--froxels 5x4x6 --volume-file {eight} --volume-temperature 0 --volume-unfit clamp --samples 2");
    assert_clean(
        &Paper { scene: "--size 24x16 --table 4", ..GAS },
        &[
            ("traced", files.as_str()),
            ("table", "--steps 4 --lists k:2 --skip-empty 0.1 --bricks 4 --object teapot --no-geometry-stage"),
            ("surfaces", "--march delta --density-cache 4 --density clouds"),
            ("table", "--steps 4 --preset fig-7"),
            ("traced", "--steps 4 --volume-scale 3 --volume sphere,0,1,0,1,1,1 --gas-number 2:tau=9"),
            ("froxel", temperatures.as_str()),
            ("table", "--steps 4 --preset solid --light 0,-1,0 --point-light 0,3,0"),
            ("no-volume", "--preset fig-4 --lists tiles"),
        ],
    );
}

#[test]
fn caustics_is_clean_with_its_options() {
    assert_clean(
        &Paper { scene: "--size 32x24 --map-size 16 --water-triangles 100 --planes 3", ..CAUSTICS },
        &[
            ("all", "--mesh box --floor --no-mrt --shadows --fresnel --coverage 2 --intensity vertex"),
            ("culled", "--mesh box --mesh sphere --smart --cull groups --point-light 0,2,0 --light 0.2,-1,0"),
            ("culled", "--mesh box --cull planes-texels --planes-within 1"),
            ("culled", "--mesh box --cull none"),
            ("hit", "--mesh teapot --layers 3 --shadows --floor --no-mrt --point-light 0.5,1,0"),
            ("level-map-smart", "--mesh box --smart-placement kept --camera below"),
            ("level-map", "--mesh box --water-map volcano --water-map-range 0.1 --water-map-spacing 0.01"),
        ],
    );
}

#[test]
fn burning_is_clean_with_its_options() {
    let scene =
        "--size 24x16 --blocks 2x2x2 --fire 20 --smoke 10 --speed 1 --flammability 10 --first-frame 30 --levels 1";
    assert_clean(
        &Paper { scene, ..BURNING },
        &[
            ("all", "--mesh pot.obj --materials pot.toml"),
            ("all", "--mesh box --look dissertation --shading wire --time-division 2 --no-preload"),
            ("shell", "--mesh box --texture photo.png --random-rotation --no-keep-connected --active-limit 5"),
            ("melting", "--mesh box --evaporation 0.1 --setting 0.1 --shading normals"),
            ("shell", "--mesh box --object sphere@0.6,0,0,20,0.3 --heat surface --climb 3 --wind=-0.2,0,0.1"),
            ("shell", "--mesh box --smoke-as volume --bending 10"),
            ("solid", "--mesh box --no-burn-away --heat air --exposure 2 --tone clip --fire-scale 3 --fire-light 4"),
            ("solid", "--mesh box --no-collapse --no-ground --material plain --shading blocks --retire-at 0.4"),
            ("low-poly", "--mesh box --lod 1 --fire 0 --smoke 0 --shading areas"),
        ],
    );
}

#[test]
fn terrain_is_clean_with_its_options() {
    assert_clean(
        &Paper { scene: "--size 32x24 --resolution 9", ..TERRAIN },
        &[
            ("all", "--base earth --drape contours --object teapot"),
            (
                "gpu-compute,gpu-fragment",
                "--shadows --interpolation bicubic --lod exact --normals nodes --object teapot",
            ),
            ("gpu-compute", "--base cylinder:100000 --drape slope --normals surface --shadows"),
            ("gpu-fragment", "--drape photo.png --voids hole --camera top"),
            (
                "gpu-compute,gpu-fragment",
                "--map volcano --map volcano --place 0,0,0 --place 5000,0,10 --drape hypsometric",
            ),
            ("mesh-lod", "--mesh-error 4 --shadows"),
            ("dda-compute,dda-fragment", "--start rays --interpolation bicubic"),
            ("tiled-compute", "--tile-memory 1 --shadows --object teapot"),
        ],
    );
}
