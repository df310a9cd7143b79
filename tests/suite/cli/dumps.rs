//! `render --dump`: every target that `passes` lists, in every format.

use std::path::Path;

use exr::prelude::read_all_flat_layers_from_file;
use fumarole::image::read_png;

use super::program::{caustics, entries, folder};

/// A target's name and what `passes --json` says of its shape.
fn targets(variant: &str) -> Vec<(String, String)> {
    let listed = caustics("passes --json --variant").arg(variant).tiny().run().succeeded().json();
    let targets = listed[0]["targets"].as_array().unwrap().iter();
    targets.map(|t| (t["name"].as_str().unwrap().to_owned(), t["shape"].as_str().unwrap().to_owned())).collect()
}

/// The numbers that a shape speaks of, with the type of its elements: `64 x 64 x 5 layers R16G16B16A16_SFLOAT` or
/// `286 rows of 8 f32`.
fn dimensions(shape: &str) -> Vec<u64> {
    shape.split(' ').filter_map(|word| word.parse().ok()).collect()
}

/// The shape and the values of a NumPy array of floats or bytes.
pub fn read_npy(path: &Path) -> (Vec<u64>, Vec<f64>) {
    let bytes = std::fs::read(path).unwrap();
    let (header, data) = bytes[10..].split_at(u16::from_le_bytes([bytes[8], bytes[9]]).into());
    let header = std::str::from_utf8(header).unwrap();
    let (_, shape) = header.split_once("'shape': (").unwrap();
    let lengths = shape.split(')').next().unwrap().split(',').map(str::trim).filter(|length| !length.is_empty());
    let values = if header.contains("'<f4'") {
        data.chunks_exact(4).map(|value| f32::from_le_bytes(value.try_into().unwrap()).into()).collect()
    } else {
        assert!(header.contains("'|u1'"), "{header}");
        data.iter().map(|&value| value.into()).collect()
    };
    (lengths.map(|length| length.parse().unwrap()).collect(), values)
}

#[test]
fn every_listed_target_is_written_in_every_format() {
    for variant in ["level-map", "volumetric"] {
        let out = folder();
        let targets = targets(variant);
        assert!(targets.iter().any(|(name, _)| name == "caustics-map"), "{targets:?}");
        let mut program = caustics("render --quiet --variant").arg(variant).inside(out.path()).tiny();
        for (name, _) in &targets {
            for ending in ["npy", "exr", "png"] {
                program = program.arg("--dump").arg(format!("{name}={name}.{ending}"));
            }
        }
        program.args("--image the-picture.png").run().succeeded();
        assert_eq!(entries(out.path()).len(), 3 * targets.len() + 1);
        for (name, shape) in &targets {
            check(out.path(), name, &dimensions(shape));
        }
    }
}

fn check(folder: &Path, name: &str, dimensions: &[u64]) {
    let path = |ending: &str| folder.join(format!("{name}.{ending}"));
    let (shape, values) = read_npy(&path("npy"));
    match (dimensions, &shape[..]) {
        ([rows, columns], [npy_rows, npy_columns]) => assert_eq!((rows, columns), (npy_rows, npy_columns), "{name}"),
        ([width, height, rest @ ..], [layers, npy_height, npy_width, _]) => {
            let expected = rest.first().copied().unwrap_or(1);
            assert_eq!((width, height, expected), (npy_width, npy_height, *layers), "{name}");
        }
        other => panic!("{name}: {other:?}"),
    }
    assert_eq!(values.len() as u64, shape.iter().product::<u64>(), "{name}");
    assert!(values.iter().all(|value| value.is_finite()), "{name}");
    assert!(values.iter().any(|value| *value != values[0]), "{name} is one value all over");

    // The EXR holds the same values, whatever its order.
    let exr = read_all_flat_layers_from_file(path("exr")).unwrap();
    let mut in_exr: Vec<f64> = exr
        .layer_data
        .iter()
        .flat_map(|layer| &layer.channel_data.list)
        .flat_map(|channel| channel.sample_data.values_as_f32().map(f64::from).collect::<Vec<_>>())
        .collect();
    let mut in_npy = values;
    in_exr.sort_by(f64::total_cmp);
    in_npy.sort_by(f64::total_cmp);
    assert_eq!(in_exr, in_npy, "{name}");

    assert!(read_png(&path("png")).unwrap().width() > 0, "{name}");
}

#[test]
fn an_unknown_target_is_refused_with_those_that_are_known() {
    let out = folder();
    let program = caustics("render --quiet --dump no-such-target=x.npy").inside(out.path()).tiny();
    program.run().refused(2, &["no-such-target", "water", "position-map", "caustics-map", "picture"]);
    let program = caustics("render --quiet --variant level-map --dump illumination-map=x.npy").inside(out.path());
    program.tiny().run().refused(2, &["illumination-map", "diffuse-map"]);
    assert!(!out.path().join("x.npy").exists());
}

/// The position map of level water has a sentinel where no surface is: it is masked, and heights keep the whole ramp.
#[test]
fn a_picture_of_values_masks_sentinels_and_tells_its_ramp() {
    let out = folder();
    let dump = "render --variant level-map --dump position-map=heights.png --dump position-map=heights.npy";
    let ended = caustics(dump).inside(out.path()).tiny().run().succeeded();
    let told = ended.stderr.lines().find_map(|line| line.strip_prefix("wrote heights.png (")?.strip_suffix(')'));
    let told = told.unwrap_or_else(|| panic!("{}", ended.stderr));
    assert!(told.contains("drawn from black to white") && told.contains("in magenta"), "{told}");
    let path = out.path().join("heights.png");
    let bytes = std::fs::read(&path).unwrap();
    let comment = [b"tEXtComment\0", told.as_bytes()].concat();
    assert!(bytes.windows(comment.len()).any(|part| part == comment), "the file's comment is {told}");
    let picture = read_png(&path).unwrap();
    let mut shades: Vec<&[u8]> = picture.pixels().chunks_exact(4).collect();
    shades.sort_unstable();
    shades.dedup();
    assert!(shades.len() > 16, "{} shades of {told}", shades.len());
}

/// Coordinates go below 0 and beyond 1, which a picture of light would cut off.
#[test]
fn normals_are_drawn_as_numbers_and_colours_as_light() {
    let out = folder();
    let dumps = "--dump surface-normal=normal.png --dump surface-albedo=albedo.png";
    let ended = caustics("render --variant stencil").args(dumps).inside(out.path()).tiny().run().succeeded();
    let told = |name: &str| {
        let line = ended.stderr.lines().find(|line| line.starts_with(&format!("wrote {name}"))).unwrap();
        line.contains("drawn from black to white")
    };
    assert!(told("normal.png") && !told("albedo.png"), "{}", ended.stderr);
    let picture = read_png(&out.path().join("normal.png")).unwrap();
    let (low, high) = (-1.0, 1.0);
    let shade = |value: f32| (255.0 * (value - low) / (high - low)).round();
    let below = picture.pixels().chunks_exact(4).filter(|pixel| f32::from(pixel[0]) < shade(-0.1)).count();
    let above = picture.pixels().chunks_exact(4).filter(|pixel| f32::from(pixel[0]) > shade(0.1)).count();
    assert!(below > 20 && above > 20, "{below} to one side, {above} to the other");
}
