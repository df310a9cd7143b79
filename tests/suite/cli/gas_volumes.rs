//! `gas --volume-file` through the binary: where the samples are seen, the record, and what is refused.

use std::path::{Path, PathBuf};

use fumarole::image::read_png;

use super::dumps::read_npy;
use super::program::{ONCE, Program, assert_schema, entries, file, folder, gas, read_json, sha256};

const SMALL: &str = "--size 45x31 --steps 12 --table 8 --camera 0,1.5,6,0,1.5,0 --tau 20";

fn small(verb: &str, volume: &Path, place: &str) -> Program {
    let mut value = volume.as_os_str().to_owned();
    value.push(place);
    gas(verb).args(SMALL).on_test_device().arg("--volume-file").arg(value)
}

/// A grid of 6 x 6 x 6 floats, of which the half that is low in x is 1, as far as it is high in y and z.
fn corner(folder: &tempfile::TempDir, name: &str, fields: &str, other: f32) -> PathBuf {
    let header =
        format!("NRRD0004\ntype: float\ndimension: 3\nsizes: 6 6 6\nendian: little\nencoding: raw\n{fields}\n");
    let is_in = |i: usize| i % 6 < 3 && i / 6 % 6 >= 3 && i / 36 >= 3;
    let samples = (0..216).flat_map(|i| if is_in(i) { 1.0_f32 } else { other }.to_le_bytes());
    file(folder, name, header.into_bytes().into_iter().chain(samples).collect::<Vec<u8>>())
}

/// Column and row of the middle of what the volume changes, over the picture's size.
fn middle(folder: &Path, program: Program, plain: &Path) -> [f64; 2] {
    let path = folder.join("volume.png");
    program.args("--quiet --variant none --image").arg(&path).run().succeeded();
    let [drawn, plain] = [&path, plain].map(|path| read_png(path).unwrap());
    let (mut sum, mut place) = (0.0, [0.0; 2]);
    for (i, (a, b)) in drawn.pixels().chunks_exact(4).zip(plain.pixels().chunks_exact(4)).enumerate() {
        let change = f64::from(a.iter().zip(b).map(|(a, b)| a.abs_diff(*b)).max().unwrap());
        sum += change;
        place[0] += change * ((i % 45) as f64 + 0.5) / 45.0;
        place[1] += change * ((i / 45) as f64 + 0.5) / 31.0;
    }
    assert!(sum > 1000.0, "the volume is not seen: {sum}");
    place.map(|p| p / sum)
}

#[test]
fn directions_of_a_file_are_those_of_the_picture() {
    let out = folder();
    let plain = out.path().join("plain.png");
    gas("render --quiet --variant no-volume --image").arg(&plain).args(SMALL).on_test_device().run().succeeded();
    let place = "@0,0.5,0,0,2";
    let plain_file = corner(&out, "plain.nrrd", "", 0.0);
    let seen = |path: &Path, place: &str, options: &str| {
        middle(out.path(), small("render", path, place).args(options), &plain)
    };
    // Without directions low x is left, and high z is up.
    let [column, row] = seen(&plain_file, place, "");
    assert!(column < 0.47 && row < 0.45, "{column} {row}");
    // A turn by 180 degrees.
    let [turned, same] = seen(&plain_file, "@0,0.5,0,180,2", "");
    assert!(turned > 0.53 && (same - row).abs() < 0.05, "{turned} {same}");
    // With y up, high y is.
    let [_, upright] = seen(&plain_file, place, "--volume-up y");
    assert!(upright < 0.45, "{upright}");
    // A patient who faces us has the right, which is high x here, to our left, so that low x is to our right.
    let patient = corner(&out, "patient.nrrd", "space: RAS\nspace directions: (1,0,0) (0,1,0) (0,0,1)\n", 0.0);
    let [column, row] = seen(&patient, place, "");
    assert!(column > 0.53 && row < 0.45, "{column} {row}");
    // Samples that go down.
    let down = corner(&out, "down.nrrd", "space: LPS\nspace directions: (1,0,0) (0,1,0) (0,0,-1)\n", 0.0);
    let [column, row] = seen(&down, place, "--volume-filter tricubic");
    assert!(column < 0.47 && row > 0.55, "{column} {row}");
}

#[test]
fn a_file_is_recorded_and_fills_every_variant() {
    let out = folder();
    let path = corner(&out, "a.nrrd", "", 0.0);
    let json = out.path().join("a.json");
    let program = gas("bench --quiet --variant all --json").arg(&json).args(SMALL).on_test_device();
    program.arg("--volume-file").arg(&path).arg("--volume-file").arg(&path).args(ONCE).run().succeeded();
    let record = read_json(&json);
    assert_schema(&record);
    let runs = record["runs"].as_array().unwrap();
    assert_eq!(runs.len(), 6);
    for run in runs {
        assert_eq!(run["config"]["volume_file"][0], path.to_str().unwrap());
        assert_eq!(run["config"]["volume_filter"], "trilinear");
        assert_eq!(run["config"]["volumes"].as_array().unwrap().len(), 2);
        // Of the steam's frustum: 1.5 x 2.1 x 1.5 m from 0.85 m on.
        assert_eq!(run["config"]["volumes"][0]["half_extent"], serde_json::json!([0.75, 0.75, 0.75]));
        assert_eq!(run["inputs"][0]["sha256"], sha256(&path).as_str());
        let names: Vec<_> = run["memory"]["by_resource"].as_array().unwrap().iter().map(|r| &r["name"]).collect();
        assert!(names.iter().any(|name| *name == "grid-samples"), "{names:?}");
    }
}

/// Figure 4 has no volumes of its own and is drawn without any, unless there is a file.
#[test]
fn a_scene_without_volumes_shows_a_file() {
    let out = folder();
    let path = corner(&out, "a.nrrd", "", 0.0);
    let draw = |name: &str, program: Program| {
        let path = out.path().join(name);
        program.args("--quiet --preset fig-4 --size 45x31 --steps 8 --table 8 --image").arg(&path).run().succeeded();
        std::fs::read(path).unwrap()
    };
    let plain = draw("plain.png", gas("render").on_test_device());
    let filled = draw("filled.png", gas("render").on_test_device().arg("--volume-file").arg(&path).args("--tau 20"));
    assert!(plain != filled);
}

/// A scan of a head, `assets/volumes/anatomical.nii`: its densities are the values of its own bytes, interpolated in double precision,
/// the patient upright and facing +z. Without a range what lies below 0 is refused.
#[test]
fn a_scan_of_a_head_has_its_own_densities() {
    const COUNTS: [usize; 3] = [33, 41, 25]; // to the left, to the front, up
    const SIDE: usize = 8; // of the table
    let out = folder();
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/volumes/anatomical.nii");
    let program = small("render --quiet", &path, "@0,0.5,0,0,2").args("--variant table --volume-range 2000,16000");
    program.args("--image head.png --dump density-table=table.npy").inside(out.path()).run().succeeded();
    // Beside each density stands that of the entry after it.
    let (_, pairs) = read_npy(&out.path().join("table.npy"));
    let table: Vec<f64> = pairs.iter().copied().step_by(2).collect();
    let bytes = std::fs::read(&path).unwrap();
    let value = |at: [usize; 3]| {
        let byte = 352 + 2 * ((at[2] * COUNTS[1] + at[1]) * COUNTS[0] + at[0]);
        f64::from(i16::from_be_bytes([bytes[byte], bytes[byte + 1]]))
    };
    // The sample before an entry of the table along an axis of the file, and the way from it to the next.
    let place = |entry: usize, count: usize| {
        let at = (entry as f64 / (SIDE - 1) as f64 * count as f64 - 0.5).clamp(0.0, (count - 1) as f64);
        let low = (at as usize).min(count - 2);
        (low, at - low as f64)
    };
    assert_eq!(table.len(), SIDE.pow(3));
    let (mut worst, mut sum) = (0.0_f64, 0.0);
    for (i, density) in table.iter().enumerate() {
        let [x, y, z] = [i % SIDE, i / SIDE % SIDE, i / SIDE.pow(2)];
        let places = [place(x, COUNTS[0]), place(z, COUNTS[1]), place(y, COUNTS[2])];
        let mut expected = 0.0;
        for corner in 0..8 {
            let is_next = [0, 1, 2].map(|axis| corner >> axis & 1);
            let weight = |axis: usize| if is_next[axis] == 1 { places[axis].1 } else { 1.0 - places[axis].1 };
            expected += value([0, 1, 2].map(|axis| places[axis].0 + is_next[axis])) * weight(0) * weight(1) * weight(2);
        }
        let expected = ((expected - 2000.0) / 14000.0).clamp(0.0, 1.0);
        worst = worst.max((density - expected).abs());
        sum += density;
    }
    assert!(worst < 1e-5, "{worst}");
    assert!((0.2..0.6).contains(&(sum / table.len() as f64)), "{sum}");
    let refused = small("render --image never.png", &path, "").run();
    refused.refused(2, &["anatomical.nii", "sample (22, 3, 1) is -277, below density 0", "--volume-range"]);
}

/// A file of densities and temperatures glows in its temperatures' colours, and the more the lower the white one is.
#[test]
fn temperatures_of_a_file_are_seen() {
    let out = folder();
    let header = "NRRD0004\ntype: float\ndimension: 4\nsizes: 2 4 4 4\nkinds: vector domain domain domain\nendian: little\n\
                  encoding: raw\n\n";
    let write = |name: &str, kelvin: f32| {
        let samples = (0..64).flat_map(|_| [1.0_f32, kelvin]).flat_map(f32::to_le_bytes);
        file(&out, name, header.bytes().chain(samples).collect::<Vec<u8>>())
    };
    let hot = write("hot.nrrd", 1500.0);
    let draw = |path: &Path, options: &str| {
        let picture = out.path().join("picture.png");
        let program = small("render", path, "").args("--quiet --variant none --albedo 0.1 --image").arg(&picture);
        program.args(options).run().succeeded();
        let pixels = read_png(&picture).unwrap().pixels().to_vec();
        [0, 1, 2].map(|channel| pixels.chunks_exact(4).map(|pixel| u64::from(pixel[channel])).sum::<u64>())
    };
    let cold = draw(&hot, "");
    let glowing = draw(&hot, "--volume-temperature 1 --white-temperature 1500");
    let dim = draw(&hot, "--volume-temperature 1 --white-temperature 1800");
    assert!(glowing[0] > dim[0] && dim[0] > cold[0], "{glowing:?} {dim:?} {cold:?}");
    assert!(glowing[0] - cold[0] > 2 * (glowing[2] - cold[2]), "{glowing:?} {cold:?}");
    for (path, options, parts) in [
        (&hot, "--volume-temperature 2", &["no component 2"][..]),
        (&hot, "--volume-temperature 1 --white-temperature 0", &["--white-temperature 0"]),
        (&hot, "--white-temperature 900", &["--white-temperature", "--volume-temperature"]),
        (&hot, "--volume-temperature 1 --density-cache 8", &["--density-cache", "--volume-temperature"]),
        (&write("low.nrrd", -3.0), "--volume-temperature 1", &["-3 K", "--volume-unfit clamp"]),
    ] {
        small("render --image never.png", path, "").args(options).run().refused(2, parts);
    }
    for options in ["--volume-temperature 1", "--white-temperature 900"] {
        gas("render --image never.png").args(options).run().misused(&["--volume-file"]);
    }
}

#[test]
fn files_and_values_that_cannot_be_are_refused() {
    let out = folder();
    let good = corner(&out, "good.nrrd", "", 0.0);
    let nan = corner(&out, "nan.nrrd", "", f32::NAN);
    let negative = corner(&out, "negative.nrrd", "", -1.0);
    let zero = corner(&out, "zero.nrrd", "", 1.0);
    for (path, options, parts) in [
        (&nan, "", &["nan.nrrd", "sample (0, 0, 0) is NaN", "--volume-unfit clamp"][..]),
        (&nan, "--volume-range 0,1", &["sample (0, 0, 0) is NaN"]),
        (&negative, "", &["negative.nrrd", "sample (0, 0, 0) is -1, below density 0", "--volume-range"]),
        (&good, "--volume-range 2,2", &["has no width"]),
        (&good, "--volume-component 1", &["no component 1"]),
        (&good, "--preset fig-4 --frequency 2", &["--frequency"]),
    ] {
        small("render --image never.png", path, "").args(options).run().refused(2, parts);
    }
    small("render --image never.png", Path::new("no-such.nrrd"), "")
        .run()
        .refused(2, &["no-such.nrrd", "No such file"]);
    small("render --image never.png", Path::new("a.xyz"), "").run().refused(2, &["unknown file ending", ".nrrd"]);
    small("render --image never.png", &good, "@0,0,0,0,0").run().misused(&["longest side"]);
    small("render --image never.png", &good, "@0,0,0,0,1e30").run().refused(2, &["its box has"]);
    for options in ["--density fog", "--texture-scale 2", "--volume box,0,0,0,1,1,1"] {
        small("render --image never.png", &good, "").args(options).run().misused(&["--volume-file"]);
    }
    for options in ["--volume-range 0,1", "--volume-filter tricubic", "--volume-unfit clamp", "--volume-up y"] {
        gas("render --image never.png").args(options).run().misused(&["--volume-file"]);
    }
    for (path, options) in [
        (&nan, "--volume-unfit clamp"),
        (&negative, "--volume-unfit clamp"),
        (&negative, "--volume-range -1,1"),
        (&zero, "--volume-range 3,0 --opaque 2 --power 2 --falloff 0.5"),
    ] {
        small("render --quiet --image seen.png", path, "").args(options).inside(out.path()).run().succeeded();
    }
}

/// A step that lavapipe's loops cannot take to its end fails the run by pass and option.
#[test]
fn a_step_beyond_the_driver_s_loops_fails_the_run() {
    let picture = folder();
    let program = gas("render --quiet --variant traced --size 3x1 --steps 100000 --image")
        .arg(picture.path().join("picture.png"));
    program.on_test_device().run().refused(1, &["pass ", "more iterations", "--steps"]);
    assert!(entries(picture.path()).is_empty());
}
