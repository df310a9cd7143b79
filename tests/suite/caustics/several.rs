//! Several receivers, concave ones too, under several lights.

use fumarole::measure::Variant as _;
use fumarole::papers::caustics::{Parameters, ReceiverInput, Variant};
use fumarole::scene::{Camera, Light};
use glam::{Mat4, Vec3};

use super::drawing::Drawing;
use super::scene::{OBLIQUE, OVERHEAD, POINT, bowl, parameters, teapot, tilted_plane};
use crate::common::gpu_test;

/// Half floats of a sum and of its three parts, relative to the sum.
const HALF_FLOATS: f32 = 3e-3;

const AMBIENT: Vec3 = Vec3::new(0.05, 0.1, 0.2);

/// A teapot, a bowl and a tilted square side by side, each of its own colour.
fn receivers() -> [ReceiverInput; 3] {
    let placed = |receiver: ReceiverInput, x_m: f32, albedo: Vec3| {
        let mesh = receiver.mesh.transformed(&Mat4::from_translation(Vec3::X * x_m));
        ReceiverInput { mesh, albedo }
    };
    [
        placed(teapot(), -2.3, Vec3::new(0.9, 0.6, 0.3)),
        placed(bowl(), 0.0, Vec3::new(0.2, 0.8, 0.4)),
        placed(tilted_plane(), 2.3, Vec3::new(0.5, 0.5, 1.0)),
    ]
}

fn shining(light: Light, color: Vec3) -> Light {
    match light {
        Light::Parallel { direction, .. } => Light::Parallel { direction, intensity: color },
        Light::Point { position, .. } => Light::Point { position, intensity: color },
    }
}

/// Eq. 4-20: what each light adds alone, all lights add together, and the ambient light counts once.
#[test]
fn lights_add_up_over_ambient_light_that_counts_once() {
    gpu_test(|device| {
        let receivers = receivers();
        let camera = Camera {
            eye: Vec3::new(0.4, -0.5, 5.2),
            target: Vec3::new(0.0, -2.5, 0.0),
            vertical_fov_rad: 0.9,
            ..parameters(OVERHEAD).camera
        };
        for &variant in Variant::ALL {
            let draw = |warm: Vec3, cool: Vec3| {
                let lights = vec![shining(OBLIQUE, warm), shining(POINT, cool)];
                let parameters = Parameters { lights, ambient: AMBIENT, camera, ..parameters(OVERHEAD) };
                let drawing = Drawing::of(device, variant, &parameters, &receivers);
                let depth = drawing.target("underwater-depth").iter().map(|&depth| depth < 1.0);
                let colors = drawing.target("underwater-color").chunks_exact(4).map(Vec3::from_slice);
                colors.zip(depth).collect::<Vec<_>>()
            };
            let (warm, cool) = (Vec3::new(0.8, 0.4, 0.2), Vec3::new(0.1, 0.3, 0.6));
            let dark = draw(Vec3::ZERO, Vec3::ZERO);
            let both = draw(warm, cool);
            let alone = [draw(warm, Vec3::ZERO), draw(Vec3::ZERO, cool)];
            let mut lit_by = [[0; 2]; 3];
            for (pixel, &(unlit, is_receiver)) in dark.iter().enumerate() {
                let parts = [0, 1].map(|light| alone[light][pixel].0 - unlit);
                let (found, expected) = (both[pixel].0, unlit + parts[0] + parts[1]);
                let tolerance = HALF_FLOATS * expected + 1e-6;
                assert!(
                    (found - expected).abs().cmple(tolerance).all(),
                    "{}, pixel {pixel}: {found} instead of {expected}",
                    variant.as_str()
                );
                if !is_receiver {
                    assert_eq!(found, unlit);
                    continue;
                }
                let matching = |r: &ReceiverInput| unlit.abs_diff_eq(r.albedo * AMBIENT, 2e-4);
                let receiver = receivers.iter().position(matching).expect("ambient light alone, once");
                for light in 0..2 {
                    lit_by[receiver][light] += u32::from(parts[light].max_element() > 0.02);
                }
            }
            println!("{}: pixels of each receiver lit by each light: {lit_by:?}", variant.as_str());
            assert!(lit_by.iter().flatten().all(|&pixels| pixels > 50), "{lit_by:?}");
        }
    });
}
