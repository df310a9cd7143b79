//! The shadow table against the oracle's sequential one, and against rays traced in double precision.

use fumarole::papers::gas::model::{DensityFunction, SolidTexture, Volume};
use fumarole::papers::gas::parameters::default_volume;
use fumarole::papers::gas::reference::density::Medium;
use fumarole::papers::gas::reference::shadow_table::{entry_position, shadow_table};
use fumarole::papers::gas::{Parameters, Variant};
use fumarole::scene::Light;
use glam::{DVec3, IVec3, Vec3};

use super::drawing::Drawing;
use crate::common::gpu_test;

fn point(x: f32, y: f32, z: f32) -> Light {
    Light::Point { position: Vec3::new(x, y, z), intensity: Vec3::ONE }
}

fn parallel(x: f32, y: f32, z: f32) -> Light {
    Light::Parallel { direction: Vec3::new(x, y, z), intensity: Vec3::ONE }
}

/// At infinity (also along an axis and a diagonal), outside, in the middle (a node where the entries of a side are
/// odd), on a face, inside.
fn lights() -> Vec<Light> {
    vec![
        parallel(-0.3, -1.0, -0.45),
        parallel(0.0, -1.0, 0.0),
        parallel(1.0, 1.0, 1.0),
        point(3.0, 6.0, 3.0),
        point(-1.7, 0.3, 0.2),
        point(0.0, 0.0, 0.0),
        point(1.0, 0.1, 0.3),
        point(0.31, -0.42, 0.53),
    ]
}

fn parameters(volume: Volume, lights: &[Light], table_size: u32) -> Parameters {
    let lights = lights.to_vec();
    Parameters { volumes: vec![volume], lights, table_size, width: 8, height: 8, steps: 4, ..Parameters::default() }
}

fn constant() -> Volume {
    let texture = SolidTexture { function: DensityFunction::Constant, ..default_volume().texture };
    Volume { half_extent_m: Vec3::new(1.0, 0.9, 1.2), texture, ..default_volume() }
}

fn turbulent() -> Volume {
    let texture = SolidTexture { scale_per_m: 1.5, ..default_volume().texture };
    Volume { texture, ..default_volume() }
}

/// The order of wavefronts is right: every entry is what one finds by computing each after those that it reads.
#[test]
fn the_devices_table_is_the_sequential_one() {
    gpu_test(|device| {
        for (volume, lights) in [turbulent(), constant()]
            .iter()
            .flat_map(|v| lights().chunks(4).map(|l| (*v, l.to_vec())).collect::<Vec<_>>())
        {
            let size = 17;
            let parameters = parameters(volume, &lights, size);
            let drawing = Drawing::of(device, Variant::Table, &parameters, &[]);
            let densities: Vec<f64> =
                drawing.entries("density-table", size as usize).iter().map(|&d| f64::from(d)).collect();
            let sums = drawing.entries("shadow-table", size as usize);
            for (table, light) in sums.chunks_exact(densities.len()).zip(&lights) {
                let expected = shadow_table(&densities, &volume, light, size);
                let worst = table.iter().zip(&expected).map(|(&a, b)| (f64::from(a) - b).abs()).fold(0.0, f64::max);
                assert!(worst < 1e-4, "{light:?}: {worst}");
                assert!(expected.iter().any(|&s| s > 0.1), "{light:?}");
            }
        }
    });
}

/// The way out of the box is a linear function of the place wherever all rays leave by one face, so that the
/// interpolation is exact: under a light along an axis everywhere, under an oblique one for all entries of which no
/// entry that they follow from sees another face. Those are one up along the ray's largest axis, and at most one along
/// each other.
#[test]
fn a_constant_density_is_exact() {
    gpu_test(|device| {
        let (volume, size) = (constant(), 64);
        for way in [DVec3::Y, DVec3::new(0.3, 1.0, 0.45)] {
            let light = parallel(-way.x as f32, -1.0, -way.z as f32);
            let drawing = Drawing::of(device, Variant::Table, &parameters(volume, &[light], size), &[]);
            let mut count = 0;
            for (i, &sum) in drawing.entries("shadow-table", 64).iter().enumerate() {
                let [column, row, slice] = [i % 64, i / 64 % 64, i / 4096];
                if way != DVec3::Y && (column > row || slice > row) {
                    continue;
                }
                let expected = f64::from(2.0 * volume.half_extent_m.y) * (63 - row) as f64 / 63.0 * way.length();
                assert!((f64::from(sum) - expected).abs() < 1e-4, "{i}: {sum} for {expected}");
                count += 1;
            }
            assert!(count > 80_000, "{count} entries");
        }
    });
}

/// Below 0.03 mean error in transmittance at 64 entries a side, and below 0.01 where the density is constant.
#[test]
fn the_table_is_near_traced_rays() {
    gpu_test(|device| {
        // Of 64 entries a side.
        let node = entry_position(&turbulent(), 64, IVec3::new(20, 41, 33)).as_vec3();
        let on_a_node = point(node.x, node.y, node.z);
        let lights = [lights(), vec![on_a_node]].concat();
        let cases = [(turbulent(), 0.03), (constant(), 0.01)];
        for ((volume, most), lights) in cases.iter().flat_map(|case| lights.chunks(4).map(move |l| (*case, l))) {
            let parameters = parameters(volume, lights, 64);
            let drawing = Drawing::of(device, Variant::Table, &parameters, &[]);
            let medium = Medium::new(&parameters, 0);
            for (table, light) in drawing.entries("shadow-table", 64).chunks_exact(64 * 64 * 64).zip(lights) {
                let (mut sum, mut count) = (0.0, 0);
                for i in (0..table.len()).step_by(1013) {
                    let i32s = i as i32;
                    let from = entry_position(&volume, 64, IVec3::new(i32s % 64, i32s / 64 % 64, i32s / 4096));
                    let to = end_of_ray(&volume, from, light);
                    let expected = (-medium.optical_depth(&volume, from, to, 200)).exp();
                    let found = (-f64::from(volume.tau_per_m) * f64::from(table[i])).exp();
                    sum += (found - expected).abs();
                    count += 1;
                }
                let mean = sum / f64::from(count);
                println!("{:?}, {light:?}: {mean:.4} over {count} entries", volume.texture.function);
                assert!(mean < most, "{:?}, {light:?}: {mean}", volume.texture.function);
            }
        }
    });
}

/// The point at which the ray from a point inside the box to the light leaves the box, or the light itself.
fn end_of_ray(volume: &Volume, from: DVec3, light: &Light) -> DVec3 {
    let (way, length) = match *light {
        Light::Parallel { direction, .. } => (-direction.as_dvec3().normalize(), f64::INFINITY),
        Light::Point { position, .. } => {
            let way = position.as_dvec3() - from;
            (way.normalize_or_zero(), way.length())
        }
    };
    let half = volume.half_extent_m.as_dvec3();
    let local = from - volume.center.as_dvec3();
    let to_side = |axis: usize| match way[axis] {
        0.0 => f64::INFINITY,
        w => ((half[axis] * w.signum() - local[axis]) / w).max(0.0),
    };
    from + way * (0..3).map(to_side).fold(length, f64::min)
}
