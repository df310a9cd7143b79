//! Numbers outside their range: exit code 2 and the option's name.

use super::program::{ONCE, Program, caustics, fumarole, gas, terrain};
use crate::faults::Layer;

fn bench(options: &str) -> Program {
    caustics("bench --mesh box").args(ONCE).on_test_device().args(options)
}

#[test]
fn parameters_outside_their_range_are_refused_with_it() {
    for (options, parts) in [
        ("--planes 0", &["--planes 0", "1 to 4096"][..]),
        ("--planes 4097", &["--planes 4097", "1 to 4096"]),
        ("--size 0x0", &["--size 0x0"]),
        ("--size 0x64", &["--size 0x64"]),
        ("--map-size 0", &["--map-size 0"]),
        ("--water-triangles 1", &["--water-triangles 1"]),
        ("--water-triangles 20000001", &["--water-triangles 20000001"]),
        ("--refraction-index 1", &["--refraction-index 1"]),
        ("--absorption -0.5", &["--absorption -0.5"]),
        ("--water-depth 0", &["--water-depth 0"]),
        ("--waves 65", &["--waves 65"]),
        ("--amplitude -1", &["--amplitude -1"]),
        ("--amplitude 9 --wavelength 0.1", &["--amplitude 9", "steep"]),
        ("--wavelength 0", &["--wavelength 0"]),
        ("--time-step -1", &["--time-step -1"]),
        ("--water-map maunga-whau", &["--water-map maunga-whau", "within 10 m"]),
        ("--water-map maunga-whau --water-map-range 0", &["--water-map-range 0"]),
        ("--water-map maunga-whau --water-map-spacing -1", &["--water-map-spacing -1"]),
        ("--water-map no-such.png", &["no-such.png"]),
        ("--light 0,0,0", &["--light 0,0,0"]),
        ("--light 0,1,0", &["--light 0,1,0", "downwards"]),
        ("--point-light 0,-1,0", &["--point-light 0,-1,0", "above the water"]),
        ("--camera 1,2,3,1,2,3", &["--camera 1,2,3,1,2,3"]),
    ] {
        bench(options).run().refused(2, parts);
    }
}

#[test]
fn what_the_device_cannot_hold_is_refused_with_its_limit() {
    let layer = Layer::new();
    for (options, parts) in [
        ("--variant level-map --size 70000x70000", &["limit", "(--size)"][..]),
        ("--variant level-map --map-size 100000", &["limit", "(--map-size)"]),
        ("--variant all --map-size 100000", &["limit", "(--map-size or --planes)"]),
        ("--variant level-map --map-size 64 --water-triangles 20000000", &["water", "limit", "(--water-triangles)"]),
        (
            "--variant volumetric --size 96x64 --map-size 64 --water-triangles 500 --planes 4096",
            &["illumination-map", "4096", "limit of 256", "(--planes)"],
        ),
    ] {
        layer.least(bench(options)).arg("--quiet").run().refused(2, parts);
    }
}

#[test]
fn no_option_takes_what_is_not_finite() {
    for option in ["refraction-index", "absorption", "water-depth", "amplitude", "wavelength", "time-step", "min-time"]
    {
        for value in ["nan", "inf", "-inf", "1e999", "two", ""] {
            bench("").arg(format!("--{option}={value}")).run().misused(&[&format!("--{option}")]);
        }
    }
    for (option, values) in [
        ("light", &["nan,-1,0", "0,-inf,0", "0,-1", "0,-1,0,0", "down"][..]),
        ("point-light", &["nan,1,0", "0,1"]),
        ("camera", &["0,0,0,nan,0,0", "0,0,0", "0,0,0,0,0,0,0"]),
    ] {
        for value in values {
            bench("").arg(format!("--{option}={value}")).run().misused(&[&format!("--{option}")]);
        }
    }
}

#[test]
fn nonsense_is_a_usage_error() {
    for (options, part) in [
        ("--size nonsense", "nonsense"),
        ("--size 96", "96"),
        ("--size 96x", "--size"),
        ("--size=-1x-1", "--size"),
        ("--planes many", "many"),
        ("--planes 99999999999", "99999999999"),
        ("--planes 1.5", "1.5"),
        ("--frames 0", "--frames"),
        ("--repeat 0", "--repeat"),
        ("--warmup 0", "--warmup"),
        ("--processes 0", "--processes"),
        ("--seed -1", "-1"),
        ("--variant fast", "fast"),
        ("--preset 9-9", "9-9"),
        ("--shader-compiler gcc", "gcc"),
        ("--no-such-option", "--no-such-option"),
        ("stray", "stray"),
    ] {
        bench(options).run().misused(&[part]);
    }
    caustics("paint").run().misused(&["paint"]);
}

#[test]
fn what_was_meant_is_named() {
    let sweep = caustics("experiment 5-1 --counts 0").on_test_device().run();
    sweep.refused(2, &["--counts 0", "1 to 4096"]);
    let lists = gas("render --lists linked,tiles").on_test_device().run();
    lists.refused(2, &["--lists: several values in turn are for bench"]);
    fumarole("bench --planes 3").run().refused(2, &["bench: give a paper first", "fumarole PAPER bench", "lava, gas"]);
    fumarole("collide").run().refused(2, &["collide: give a paper first", "one of terrain"]);
    fumarole("paint").run().misused(&["paint"]);
    caustics("render --mesh bunnny")
        .on_test_device()
        .run()
        .refused(2, &["bunnny", "teapot, sphere, box, bunny, plane"]);
    terrain("render --map nope").on_test_device().run().refused(2, &["nope", "volcano, maunga-whau, jacksboro"]);
    caustics("render --mesh bunny:0").on_test_device().run().refused(2, &["bunny:0", "1 to 200000000"]);
}
