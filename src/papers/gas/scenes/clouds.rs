//! Clouds by surfaces whose transparency is a solid texture: a layer on a flat plane, and single clouds on ellipsoids in the
//! same space of the texture (section "Modeling the geometry of gases"). The paper prints no picture of them; the scene is ours.

use glam::{Mat4, Quat, Vec2, Vec3};

use super::{Scene, floor};
use crate::papers::gas::model::{DensityFunction, Object, SolidTexture, Veins};
use crate::papers::gas::parameters::Parameters;
use crate::scene::{Camera, Light, shapes};

const WHITE: Vec3 = Vec3::splat(0.92);

/// All clouds lie in one space.
fn texture(frequency: f32, opaque: f32, power: f32, scale_per_m: f32) -> SolidTexture {
    let function = DensityFunction::Clouds { frequency };
    SolidTexture { function, opaque, power, scale_per_m, offset: Vec3::new(4.2, 1.7, 9.1) }
}

/// Ellipsoids around a middle, each by its offset and its half extents, metres.
fn cloud(middle: Vec3, ellipsoids: &[(Vec3, Vec3)]) -> Vec<Object> {
    let ellipsoid = |&(offset, half_m): &(Vec3, Vec3)| {
        let place = Mat4::from_scale_rotation_translation(half_m, Quat::IDENTITY, middle + offset);
        let gas = Some(texture(4.0, 1.0, 2.0, 1.1));
        let mesh = shapes::sphere(28, 14).transformed(&place);
        Object { gas, rim: 0.75, is_two_sided: false, ..Object::new(mesh, WHITE) }
    };
    ellipsoids.iter().map(ellipsoid).collect()
}

/// A layer over a land, and three clouds below it.
pub fn scene() -> Scene {
    let land = Veins {
        color: Vec3::new(0.20, 0.16, 0.09),
        texture: SolidTexture {
            function: DensityFunction::Turbulence,
            opaque: 1.5,
            power: 1.6,
            scale_per_m: 0.4,
            offset: Vec3::new(7.3, 2.9, 1.1),
        },
    };
    let layer = floor(Vec2::splat(120.0), 7.0, WHITE);
    let mut objects = vec![
        Object { veins: Some(land), ..floor(Vec2::splat(240.0), 0.0, Vec3::new(0.05, 0.12, 0.04)) },
        Object { gas: Some(texture(6.0, 1.0, 3.5, 0.22)), fade_m: 30.0, ends_m: Vec2::splat(60.0), ..layer },
    ];
    let wide = [
        (Vec3::ZERO, Vec3::new(2.0, 0.8, 1.2)),
        (Vec3::new(-1.5, -0.15, 0.3), Vec3::new(1.2, 0.55, 0.9)),
        (Vec3::new(1.6, -0.1, 0.2), Vec3::new(1.3, 0.6, 1.0)),
        (Vec3::new(0.4, 0.55, -0.2), Vec3::new(1.0, 0.6, 0.8)),
    ];
    objects.extend(cloud(Vec3::new(-2.2, 3.2, -2.0), &wide));
    objects.extend(cloud(Vec3::new(4.6, 4.0, -8.0), &wide));
    let small = wide.map(|(offset, half_m)| (0.55 * offset, 0.6 * half_m));
    objects.extend(cloud(Vec3::new(3.0, 2.2, 2.0), &small));
    let parameters = Parameters {
        volumes: Vec::new(),
        lights: vec![Light::Parallel { direction: Vec3::new(-0.5, -1.0, -0.55), intensity: Vec3::splat(0.6) }],
        ambient: Vec3::new(0.50, 0.53, 0.58),
        background: Vec3::new(0.16, 0.33, 0.66),
        camera: Camera {
            eye: Vec3::new(0.5, 2.4, 12.0),
            target: Vec3::new(0.0, 3.2, 0.0),
            up: Vec3::Y,
            vertical_fov_rad: 0.75,
            near_m: 0.1,
            far_m: 150.0,
        },
        width: 480,
        height: 320,
        ..Parameters::default()
    };
    Scene { parameters, objects }
}
