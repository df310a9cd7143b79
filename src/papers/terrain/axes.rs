//! The axes of `stress`.

use super::object_source::{ObjectSource, Stand};
use super::setup::Setup;
use crate::measure::Error;
use crate::measure::stress::{Amount, Axis, scaled, side};
use crate::scene::{HeightMapSource, MeshSource};

/// Samples a side of the largest map of a sweep: the images of many devices hold no more.
const MOST_SIDE: u64 = 16_384;

/// The default first.
pub fn all() -> Vec<Axis<Setup>> {
    vec![
        Axis::new("map", 128 * 128, resize_map)
            .help("Samples of the synthetic volcano")
            .unit("samples")
            .sets("resolution")
            .most(MOST_SIDE.pow(2))
            .amount(Amount::Rounded(|setup| f64::from(setup.resolution).powi(2))),
        Axis::new("screen", 100 * 75, |setup: &mut Setup, pixels| {
            let parameters = &mut setup.parameters;
            [parameters.width, parameters.height] = scaled([parameters.width, parameters.height], pixels);
            Ok(())
        })
        .help("Pixels of the picture, as wide to high as they are")
        .unit("pixels")
        .most(1 << 32)
        .sets("size")
        .amount(Amount::Rounded(|setup| f64::from(setup.parameters.width) * f64::from(setup.parameters.height))),
        Axis::new("objects", 1, stand_objects)
            .help("Polygon objects on the ground: the given ones, or teapots, again and again in a square grid")
            .most(1 << 16),
        Axis::new("object-triangles", 8_000, divide)
            .help("Triangles of the polygon objects, which are divided evenly; of a teapot on the ground where there are none")
            .unit("triangles")
            .most(MeshSource::MOST_DIVIDED)
            .amount(Amount::Counted("object_triangles")),
    ]
}

fn resize_map(setup: &mut Setup, samples: u64) -> Result<(), Error> {
    if setup.maps.iter().all(|map| *map == HeightMapSource::Volcano) {
        setup.resolution = side(samples).max(2);
        return Ok(());
    }
    Err(Error::Input(
        "`axis` map: only the synthetic volcano has any size; leave `map` out, or take another axis".into(),
    ))
}

/// Metres of the shorter side of the first map.
fn extent_m(setup: &Setup) -> Result<f32, Error> {
    let Some(source) = setup.maps.first() else { return Ok(1.0) };
    let map = setup.load_map(source)?;
    let spacing_m = map.spacing_m();
    Ok((f64::from(map.width()) * spacing_m.x).min(f64::from(map.height()) * spacing_m.y) as f32)
}

/// The given meshes, or a teapot.
fn meshes(setup: &Setup) -> Vec<MeshSource> {
    let given: Vec<MeshSource> = setup.objects.iter().map(|object| object.mesh.clone()).collect();
    if given.is_empty() { vec![MeshSource::Teapot] } else { given }
}

/// A mesh on the ground, its longest side so many metres.
fn stand(mesh: &MeshSource, [east_m, south_m]: [f32; 2], longest_m: f32) -> Result<ObjectSource, Error> {
    let longest = mesh.load()?.bounds().diagonal().max_element();
    let place = Stand { east_m, south_m, yaw_deg: 0.0, scale: longest_m / longest };
    Ok(ObjectSource { mesh: mesh.clone(), place: Some(place) })
}

/// The middle half of the map is divided into cells, each with an object of half their size.
fn stand_objects(setup: &mut Setup, objects: u64) -> Result<(), Error> {
    let meshes = meshes(setup);
    let columns = (objects as f64).sqrt().ceil().max(1.0) as u64;
    let cell_m = 0.5 * extent_m(setup)? / columns as f32;
    let middle = |cell: u64| (cell as f32 + 0.5 - 0.5 * columns as f32) * cell_m;
    let first = meshes.iter().map(|mesh| stand(mesh, [0.0, 0.0], 0.5 * cell_m)).collect::<Result<Vec<_>, _>>()?;
    let placed = (0..objects).zip(first.into_iter().cycle()).map(|(number, mut object)| {
        if let Some(place) = &mut object.place {
            [place.east_m, place.south_m] = [middle(number % columns), middle(number / columns)];
        }
        object
    });
    setup.objects = placed.collect();
    Ok(())
}

fn divide(setup: &mut Setup, triangles: u64) -> Result<(), Error> {
    if setup.objects.is_empty() {
        setup.objects = vec![stand(&MeshSource::Teapot, [0.0, 0.0], 0.25 * extent_m(setup)?)?];
    }
    let each = triangles.div_ceil(setup.objects.len() as u64);
    for object in &mut setup.objects {
        object.mesh = object.mesh.divided(each);
    }
    Ok(())
}
