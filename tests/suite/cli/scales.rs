//! The unit of length is nothing to a picture: what is larger or smaller by a factor in all its parts looks the same.

use std::fmt::Write;
use std::path::Path;

use fumarole::image::{Rgba8, read_png};

use super::program::{Program, burning, file, folder, lava, terrain};

/// Asserts that pictures of scenes of these sizes are that of size 1, to a step of a channel in a few pixels.
fn assert_alike(what: &str, sizes: &[f64], scene: impl Fn(f64, &tempfile::TempDir) -> Program) {
    let out = folder();
    let picture = |size: f64| -> Rgba8 {
        let path = out.path().join("a.png");
        scene(size, &out).args("--quiet --image").arg(&path).on_test_device().run().succeeded();
        read_png(Path::new(&path)).unwrap()
    };
    let one = picture(1.0);
    let (low, high) = one.pixels().iter().fold((255, 0), |(low, high), value| (low.min(*value), high.max(*value)));
    assert!(high - low > 60, "{what}: there is nothing in the picture");
    for &size in sizes {
        let other = picture(size);
        let apart = |(a, b): (&u8, &u8)| usize::from(a.abs_diff(*b) > 1);
        let apart: usize = one.pixels().iter().zip(other.pixels()).map(apart).sum();
        assert!(apart * 500 <= one.pixels().len(), "{what}, {size} times as large: {apart} values differ");
    }
}

/// Numbers of metres with commas between them, `size` times as large.
fn metres(numbers: &[f64], size: f64) -> String {
    numbers.iter().map(|number| (number * size).to_string()).collect::<Vec<_>>().join(",")
}

#[test]
fn lava_looks_alike_at_any_size() {
    for variant in
        ["paper", "gpu-driven", "gpu-driven --color blackbody", "paper --culling facing --splat-shading deferred"]
    {
        assert_alike(variant, &[1e-4, 1e-2, 10.0, 200.0], |size, _| {
            let space = metres(&[4.0, 1.0, 1.0], size).replace(',', "x");
            let camera = metres(&[1.0, 1.5, 3.0, 2.0, 0.3, 0.5], size);
            let [radius, splat, epsilon, border, speed, tile] =
                [0.12, 0.05, 0.05, 0.2, 0.2, 2.0].map(|metres| (metres * size).to_string());
            lava(&format!(
                "render --variant {variant} --particles 2000 --space {space} --radius {radius} --density 60x24x16 \
                 --splats 120x40 --splat-radius {splat} --epsilon {epsilon} --border {border} --speed {speed} \
                 --rock-tile {tile} --camera={camera} --size 48x36 --frame 3"
            ))
        });
    }
}

#[test]
fn terrain_looks_alike_at_any_size() {
    for variant in ["gpu-compute --interpolation bicubic", "dda-fragment --shadows", "mesh-lod", "tiled-compute"] {
        assert_alike(variant, &[1e-4, 1e-2, 1e3], |size, out| {
            let mut map = format!("ncols 33\nnrows 33\ncellsize {}\n", 100.0 * size);
            for (row, column) in (0..33).flat_map(|row| (0..33).map(move |column| (row, column))) {
                let (x, y) = (f64::from(column), f64::from(row));
                let peak = 300.0 * (-((x - 15.0).powi(2) + (y - 17.0).powi(2)) / 40.0).exp();
                let height = size * (peak + 60.0 * (1.4 * x).sin() * y.cos());
                let _infallible = writeln!(map, "{height}");
            }
            let map = file(out, "land.asc", map);
            let camera = metres(&[0.0, 900.0, 2500.0, 0.0, 100.0, 0.0], size);
            terrain(&format!("render --variant {variant} --camera={camera} --haze 0 --size 48x36 --map")).arg(map)
        });
    }
}

#[test]
fn burning_looks_alike_at_any_size() {
    for variant in ["shell", "solid", "melting"] {
        assert_alike(variant, &[1e-5, 1e-2, 1e6], |size, out| {
            let mut ball = String::new();
            for (row, column) in (0..9).flat_map(|row| (0..16).map(move |column| (row, column))) {
                let (theta, phi) = (0.1 + 0.368 * f64::from(row), std::f64::consts::FRAC_PI_8 * f64::from(column));
                let place = [theta.sin() * phi.cos(), theta.cos(), theta.sin() * phi.sin()].map(|along| along * size);
                let _infallible = writeln!(ball, "v {} {} {}", place[0], place[1], place[2]);
            }
            for (row, column) in (0..8).flat_map(|row| (0..16).map(move |column| (row, column))) {
                let at = |row: u32, column: u32| 16 * row + column % 16 + 1;
                let [a, b, c, d] = [at(row, column), at(row, column + 1), at(row + 1, column + 1), at(row + 1, column)];
                let _infallible = writeln!(ball, "f {a} {b} {c} {d}");
            }
            // Its ends.
            for first in [1, 129] {
                let corners: Vec<String> = (first..first + 16).map(|corner| corner.to_string()).collect();
                let _infallible = writeln!(ball, "f {}", corners.join(" "));
            }
            let ball = file(out, "ball.obj", ball);
            let scene =
                "--frame 60 --blocks 3x3x3 --fire 60 --smoke 30 --levels 1 --flammability 10 --size 48x36 --mesh";
            burning(&format!("render --variant {variant} {scene}")).arg(ball)
        });
    }
}
