//! Valid configurations at the edge of sense: every value of every target is a finite number.

use std::slice::from_ref;

use fumarole::measure::Variant as _;
use fumarole::papers::caustics::reference::{AIR, refract};
use fumarole::papers::caustics::{Parameters, ReceiverInput, Variant, WaveParameters};
use fumarole::scene::{Light, Mesh};
use glam::{DVec3, Mat4, Vec3};

use super::drawing::Drawing;
use super::oracle::Oracle;
use super::scene::{OBLIQUE, OVERHEAD, POINT, bowl, parameters, sphere, teapot, tilted_plane};
use crate::common::gpu_test;

/// Light that just grazes the water.
const GRAZING: Light = Light::Parallel { direction: Vec3::new(1.0, -0.06, 0.1), intensity: Vec3::ONE };
const LIGHTS: [Light; 4] = [OVERHEAD, OBLIQUE, POINT, GRAZING];

/// The highest absorption that is taken, which leaves no light after a tenth of a millimetre.
const INK_PER_M: f32 = 1e6;

/// The highest intensity that is taken.
const BRIGHTEST: f32 = 64.0;

/// Waves as steep as they may be.
const STORM: WaveParameters = WaveParameters { count: 64, amplitude_m: 0.6, wavelength_m: 1.0 };

fn lifted(receiver: &ReceiverInput, by_m: f32) -> ReceiverInput {
    let mesh = receiver.mesh.transformed(&Mat4::from_translation(Vec3::Y * by_m));
    ReceiverInput { mesh, ..receiver.clone() }
}

fn of_triangles(corners: &[(Vec3, Vec3)], indices: &[u32]) -> ReceiverInput {
    let mesh = Mesh {
        positions: corners.iter().map(|corner| corner.0).collect(),
        normals: corners.iter().map(|corner| corner.1).collect(),
        indices: indices.to_vec(),
        ..Mesh::default()
    };
    mesh.validate().unwrap();
    ReceiverInput { mesh, albedo: Vec3::splat(0.8) }
}

#[test]
fn a_receiver_that_sticks_out_of_the_water_is_lit_below_it_alone() {
    gpu_test(|device| {
        // A sphere from 1.5 m below to 0.5 m above the water.
        let receiver = lifted(&sphere(), 1.5);
        for light in LIGHTS {
            let parameters = parameters(light);
            let drawing = Drawing::of(device, Variant::LevelMap, &parameters, from_ref(&receiver));
            drawing.assert_finite();
            let frame = Oracle::of(&parameters, &light, &receiver, &drawing.grid).receiver;
            // The plane that accepts a texel lies up to half a cell from it.
            let unsure_m = f64::from(parameters.waves.amplitude_m) + frame.height / f64::from(2 * parameters.planes);
            let size = parameters.map_size as usize;
            let (mut above, mut lit_below) = (0, 0);
            for (texel, &height) in drawing.target("position-map").iter().enumerate().filter(|(_, h)| **h > -1e29) {
                let fraction = |i: usize| (i as f64 + 0.5) / size as f64 - 0.5;
                let (x, z) = (fraction(texel % size) * frame.width, fraction(texel / size) * frame.depth);
                let world_y = frame.to_world(DVec3::new(x, f64::from(height), z)).y;
                let caustics = drawing.target("caustics-map")[texel];
                if world_y > unsure_m {
                    assert_eq!(caustics, 0.0, "{light:?}, texel {texel} at {world_y} m");
                    above += 1;
                } else if world_y < -unsure_m {
                    lit_below += u32::from(caustics > 0.0);
                }
            }
            println!("{light:?}: {above} texels above the water, {lit_below} lit below it");
            assert!(above > 1000 && lit_below > 1000, "{light:?}: {above} {lit_below}");
        }
    });
}

#[test]
fn a_receiver_out_of_the_water_is_dark() {
    gpu_test(|device| {
        for (variant, light) in Variant::ALL.iter().copied().flat_map(|v| LIGHTS.map(|light| (v, light))) {
            let drawing = Drawing::of(device, variant, &parameters(light), &[lifted(&sphere(), 3.2)]);
            drawing.assert_finite();
            assert_dark(&drawing, variant);
        }
    });
}

/// Nothing but ambient light.
fn assert_dark(drawing: &Drawing, variant: Variant) {
    if variant != Variant::Stencil {
        return assert!(drawing.target("combined-map").chunks_exact(4).all(|texel| texel[..3] == [0.0; 3]));
    }
    let pixels =
        drawing.target("underwater-color").chunks_exact(4).zip(drawing.target("surface-albedo").chunks_exact(4));
    let ambient = Parameters::default().ambient;
    for (color, albedo) in pixels.filter(|(_, albedo)| albedo[3] == 1.0) {
        let expected = ambient * Vec3::from_slice(albedo);
        assert!(Vec3::from_slice(color).abs_diff_eq(expected, 1e-4), "{color:?} instead of {expected}");
    }
}

#[test]
fn storms_and_water_like_ink_stay_finite() {
    gpu_test(|device| {
        for (variant, light) in Variant::ALL.iter().copied().flat_map(|v| LIGHTS.map(|light| (v, light))) {
            for (absorption_per_m, refraction_index, map_size) in
                [(0.0, 4.0, 128), (0.0, 1.0001, 1), (INK_PER_M, 1.33, 65)]
            {
                let parameters =
                    Parameters { waves: STORM, absorption_per_m, refraction_index, map_size, ..parameters(light) };
                for receiver in [teapot(), lifted(&bowl(), 2.0)] {
                    let drawing = Drawing::of(device, variant, &parameters, from_ref(&receiver));
                    drawing.assert_finite();
                }
            }
            let ink = Parameters { absorption_per_m: INK_PER_M, water_triangles: 2, ..parameters(light) };
            let drawing = Drawing::of(device, variant, &ink, &[sphere()]);
            drawing.assert_finite();
            assert_dark(&drawing, variant);
        }
    });
}

#[test]
fn odd_meshes_and_bright_lights_stay_finite() {
    gpu_test(|device| {
        let (a, b, c, d) = (
            Vec3::new(-1.0, -3.0, -1.0),
            Vec3::new(-1.0, -2.5, 1.0),
            Vec3::new(1.0, -3.0, 1.0),
            Vec3::new(1.0, -2.0, -1.0),
        );
        let up = |p: Vec3| (p, Vec3::Y);
        let receivers = [
            // Two triangles without area beside one with.
            of_triangles(&[up(a), up(b), up(c), up(d)], &[0, 1, 2, 3, 3, 3, 0, 0, 1]),
            // Opposite normals, whose interpolation passes through zero at the middle texel of an odd map.
            of_triangles(&[(a, Vec3::X), (b, Vec3::X), (c, Vec3::NEG_X), (d, Vec3::NEG_X)], &[0, 1, 2, 0, 2, 3]),
            // Edge-on to light from overhead.
            of_triangles(&[(a, Vec3::Z), (a + Vec3::X, Vec3::Z), (a + Vec3::Y, Vec3::Z)], &[0, 1, 2]),
        ];
        let bright = Light::Parallel { direction: Vec3::new(0.3, -1.0, 0.1), intensity: Vec3::splat(BRIGHTEST) };
        for (variant, light) in
            Variant::ALL.iter().copied().flat_map(|v| [OVERHEAD, OBLIQUE, bright].map(|light| (v, light)))
        {
            for receiver in &receivers {
                let parameters = Parameters { map_size: 65, ..parameters(light) };
                Drawing::of(device, variant, &parameters, from_ref(receiver)).assert_finite();
            }
        }
    });
}

#[test]
fn what_goes_beyond_the_edge_is_refused() {
    let lit_by = |intensity| parameters(Light::Parallel { direction: Vec3::NEG_Y, intensity });
    assert_eq!(lit_by(Vec3::new(0.0, BRIGHTEST, 1.0)).validate(), Ok(()));
    for intensity in [BRIGHTEST.next_up(), -f32::MIN_POSITIVE, f32::INFINITY, f32::NAN] {
        let error = lit_by(Vec3::new(1.0, 1.0, intensity)).validate().unwrap_err();
        assert_eq!(error.to_string(), "light 0,-1,0: must have an intensity of 0 to 64");
    }
    let ink = |absorption_per_m| Parameters { absorption_per_m, ..parameters(OVERHEAD) };
    assert_eq!(ink(INK_PER_M).validate(), Ok(()));
    for absorption_per_m in [INK_PER_M.next_up(), -f32::MIN_POSITIVE, f32::NAN] {
        let error = ink(absorption_per_m).validate().unwrap_err();
        assert!(error.to_string().ends_with("must be 0 to 1000000 per metre"), "{error}");
    }
}

/// Steep water under grazing light: faces that are turned away while the normals of their vertices are not pass nothing,
/// on the device as in the oracle.
#[test]
fn faces_turned_away_pass_nothing() {
    gpu_test(|device| {
        let waves = WaveParameters { count: 5, amplitude_m: 0.12, wavelength_m: 1.4 };
        let low_sun = Light::Parallel { direction: Vec3::new(1.0, -0.27, 0.2), intensity: Vec3::ONE };
        let low_lamp = Light::Point { position: Vec3::new(-9.0, 1.8, 1.0), intensity: Vec3::ONE };
        for light in [low_sun, low_lamp] {
            let parameters = Parameters { waves, water_triangles: 1400, ..parameters(light) };
            let receiver = tilted_plane();
            let drawing = Drawing::of(device, Variant::LevelMap, &parameters, from_ref(&receiver));
            let oracle = Oracle::of(&parameters, &light, &receiver, &drawing.grid);
            let turned_away = turned_away(&oracle, &drawing);
            println!("{light:?}: {turned_away} faces are turned away with normals that are not");
            assert!(turned_away > 3, "{light:?}: {turned_away}");
            let map = oracle.caustics_map();
            let pairs = drawing.target("caustics-map").iter().zip(&map.intensity).zip(&map.excluded);
            let off = |((&found, &expected), &excluded): ((&f32, &f64), &bool)| {
                !excluded && (f64::from(found) - expected).abs() > 1e-3 * expected.max(0.1)
            };
            let off = pairs.filter(|&pair| off(pair)).count();
            println!("{off} texels off");
            assert!(off <= 6, "{light:?}: {off} texels off");
        }
    });
}

/// Faces that pass no light although all of their vertices refract theirs.
fn turned_away(oracle: &Oracle, drawing: &Drawing) -> usize {
    let refracts = |&vertex: &u32| {
        let vertex = oracle.water[vertex as usize];
        let incident = oracle.light.direction_at(vertex.position);
        refract(incident, vertex.normal, AIR, oracle.medium.refraction_index).is_some()
    };
    let faces = drawing.grid.indices();
    faces.chunks_exact(3).filter(|face| face.iter().all(refracts)).count() - oracle.volumes.len()
}
