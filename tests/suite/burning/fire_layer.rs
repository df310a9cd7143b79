//! The layer of fire and smoke, pixel by pixel.

use fumarole::measure::Paper;
use fumarole::measure::parameter::Choice as _;
use fumarole::papers::burning::reference::fire_layer::{Square, Viewer};
use fumarole::papers::burning::reference::lights::Light;
use fumarole::papers::burning::{FireLight, Look, Parameters, Particle as DeviceParticle, Variant};
use glam::{DVec2, DVec3, DVec4};

use super::fire::{Fire, ball};
use super::lights::{burning, bytes, first_picture, image, on_device, particle};
use crate::common::gpu_test;

/// The squares of a fire in their order.
fn squares(fire: &Fire, viewer: &Viewer, parameters: &Parameters) -> Vec<Square> {
    let particles: Vec<DeviceParticle> = fire.read(&fire.paper.flames().unwrap().particles);
    let there = |of: &[DeviceParticle]| of.iter().filter(|p| p.life_ticks > 0.0).map(particle).collect::<Vec<_>>();
    let (flames, smoke) = particles.split_at(parameters.fire as usize);
    let lights = (parameters.look == Look::Natural).then(|| {
        let of = |light: &FireLight| Light {
            place: light.position.as_dvec3(),
            radius: light.radius.into(),
            intensity: light.intensity.as_dvec3(),
        };
        on_device(fire).iter().map(of).collect::<Vec<_>>()
    });
    let smoke = there(smoke).into_iter().map(|p| viewer.smoke(&p, lights.as_deref()));
    smoke.chain(there(flames).iter().map(|p| viewer.fire(p))).collect()
}

#[test]
fn each_pixel_of_the_layer_is_the_sum_of_the_squares_in_their_order() {
    gpu_test(|device| {
        // Chunks of 8,192 that smoke ends in, begins anew and fire fills; a radius of many tiles; sizes that end within one.
        let small = Parameters { width: 101, height: 75, particle_radius: 0.08, ..burning() };
        let many = Parameters {
            width: 35,
            height: 23,
            fire: 9000,
            smoke: 8300,
            particle_radius: 0.06,
            fire_scale: 1,
            ..burning()
        };
        let wide = Parameters { particle_radius: 0.3, fire: 40, smoke: 30, fire_scale: 1, ..small.clone() };
        let fire = Parameters { smoke: 0, fire_scale: 3, ..small.clone() };
        let smoke = Parameters { fire: 0, ..small.clone() };
        let cases = [small, many, wide, fire, smoke];
        for (look, case) in Look::ALL.iter().flat_map(|look| cases.iter().map(move |case| (*look, case))) {
            let fire_scale = if look == Look::Dissertation { case.fire_scale.max(2) } else { case.fire_scale };
            let parameters = Parameters { look, fire_scale, ..case.clone() };
            let fire = first_picture(device, Variant::Shell, &parameters, &ball());
            let layer = image(device, &fire, "fire-layer");
            let depths: Vec<f32> = bytemuck::pod_collect_to_vec(&bytes(device, &fire, "depth"));
            let camera = *Paper::camera(&fire.paper).as_ref().unwrap();
            let view = camera.view().as_dmat4();
            let (width, height) = (parameters.width, parameters.height);
            let viewer = Viewer {
                to_clip: camera.projection(parameters.aspect()).as_dmat4() * view,
                right: view.row(0).truncate(),
                up: view.row(1).truncate(),
                size: [width, height].map(|pixels| pixels.div_ceil(fire_scale)),
                radius: parameters.particle_radius.into(),
            };
            let from_clip = viewer.to_clip.inverse();
            let squares = squares(&fire, &viewer, &parameters);
            let (mut seen, mut near_a_side, mut apart) = (0, 0, 0);
            for (i, found) in (0..).zip(&layer) {
                let at = [i % viewer.size[0], i / viewer.size[0]];
                let [x, y] = [(at[0], width), (at[1], height)]
                    .map(|(texel, pixels)| (texel * fire_scale + fire_scale / 2).min(pixels - 1));
                let depth = f64::from(depths[(y * width + x) as usize]);
                let mesh = (viewer.to_clip * from_clip.project_point3(DVec3::new(0.0, 0.0, depth)).extend(1.0)).w;
                let middle = DVec2::new(at[0].into(), at[1].into());
                let (expected, margin) = viewer.pixel(middle, mesh, &squares);
                seen += u32::from(expected != DVec4::ZERO);
                // On a square's side rounding decides.
                if margin < 1e-4 {
                    near_a_side += 1;
                    continue;
                }
                let error = (*found - expected).abs().max_element();
                apart += u32::from(error > 2e-3 * (1.0 + expected.max_element()));
                assert!(error < 0.02 * (1.0 + expected.max_element()), "{look:?} {at:?}: {found} {expected}");
            }
            println!("{look:?}, {} of {}: {seen} {near_a_side} {apart}", parameters.fire, parameters.smoke);
            assert!(seen > 50 && near_a_side * 20 < seen && apart * 200 < seen, "{seen} {near_a_side} {apart}");
        }
    });
}
