//! The light of the flames: as bright as what the picture shows of them, on the ground, and in the display's tone.

use std::sync::Arc;

use fumarole::gpu::Device;
use fumarole::gpu::bindings::Resource;
use fumarole::gpu::transfer::read_image;
use fumarole::image::{Rgba8, compare, srgb};
use fumarole::measure::Paper;
use fumarole::measure::parameter::Choice as _;
use fumarole::papers::burning::model::with_triangles;
use fumarole::papers::burning::reference::flames::Particle;
use fumarole::papers::burning::reference::lights::{Light, ember, irradiance, lights};
use fumarole::papers::burning::{FireLight, Look, Parameters, Particle as DeviceParticle, Tone, Variant};
use fumarole::papers::lava::reference::toned;
use fumarole::scene::{Mesh, shapes};
use glam::{DVec3, DVec4};
use half::f16;

use super::dump;
use super::fire::{Fire, ball};
use crate::common::gpu_test;

/// A fire of few flames, well alight.
pub fn burning() -> Parameters {
    Parameters {
        width: 96,
        height: 72,
        speed_per_s: 0.3,
        flammability: 40,
        blocks: [4, 4, 4],
        fire: 600,
        smoke: 200,
        first_frame: 100,
        ..Parameters::default()
    }
}

pub fn first_picture(device: &Arc<Device>, variant: Variant, parameters: &Parameters, mesh: &Mesh) -> Fire {
    let mut fire = Fire::new(device, variant, parameters, mesh);
    fire.frame(0);
    fire
}

pub fn bytes(device: &Arc<Device>, fire: &Fire, name: &str) -> Vec<u8> {
    let targets = fire.paper.targets();
    let target = targets.iter().find(|target| target.name == name).expect("the target");
    let Resource::Image(view) = &target.resource else { panic!("{name} is no image") };
    read_image(device, view).unwrap()
}

pub fn image(device: &Arc<Device>, fire: &Fire, name: &str) -> Vec<DVec4> {
    let halves: Vec<f16> = bytemuck::pod_collect_to_vec(&bytes(device, fire, name));
    let texel = |t: &[f16]| DVec4::new(t[0].into(), t[1].into(), t[2].into(), t[3].into());
    halves.chunks_exact(4).map(texel).collect()
}

/// A particle of the device as the oracle's.
pub fn particle(p: &DeviceParticle) -> Particle {
    Particle {
        position: p.position.as_dvec3(),
        age: p.age_ticks as u32,
        life: p.life_ticks as u32,
        block: p.block as usize,
        own: p.random.map(f64::from),
    }
}

pub fn on_device(fire: &Fire) -> Vec<FireLight> {
    let lights: Vec<FireLight> = fire.read(fire.paper.fire_lights().unwrap());
    lights[..lights[0].count as usize].to_vec()
}

#[test]
fn the_flames_light_as_brightly_as_they_show() {
    gpu_test(|device| {
        let parameters = Parameters { fire_light: 2.0, ..burning() };
        for variant in [Variant::Shell, Variant::Melting] {
            let fire = first_picture(device, variant, &parameters, &ball());
            let particles: Vec<DeviceParticle> = fire.read(&fire.paper.flames().unwrap().particles);
            let flames: Vec<Particle> = particles[..parameters.fire as usize].iter().map(particle).collect();
            let ours = lights(&flames, parameters.particle_radius.into(), parameters.fire_light.into());
            let theirs = on_device(&fire);
            assert!(ours.len() > 8 && ours.len() == theirs.len(), "{} lights, not {}", theirs.len(), ours.len());
            for (ours, theirs) in ours.iter().zip(&theirs) {
                let at = format!("{ours:?}: {:?} {:?}", theirs.position, theirs.intensity);
                assert!(ours.place.distance(theirs.position.as_dvec3()) < 1e-4, "{at}");
                assert!((ours.radius - f64::from(theirs.radius)).abs() < 1e-4, "{at}");
                let whole = ours.intensity.x;
                let apart = (ours.intensity - theirs.intensity.as_dvec3()).abs();
                // A flame that has just been lit shows nothing yet.
                assert!(apart.max_element() <= 0.03 * whole + 1e-7, "{at}");
            }
            assert!(ours.iter().filter(|light| light.intensity.x > 1e-4).count() > 5, "{ours:?}");
        }
        let unlit = first_picture(device, Variant::Shell, &Parameters { fire: 0, ..burning() }, &ball());
        assert!(on_device(&unlit).is_empty(), "there is smoke alone");
    });
}

#[test]
fn the_ground_has_the_light_of_the_flames() {
    gpu_test(|device| {
        let parameters = Parameters { fire_light: 20.0, ..burning() };
        let lit = first_picture(device, Variant::Shell, &parameters, &ball());
        let unlit = first_picture(device, Variant::Shell, &Parameters { fire_light: 0.0, ..burning() }, &ball());
        let [with, without] = [&lit, &unlit].map(|fire| image(device, fire, "radiance"));
        let depths: Vec<f32> = bytemuck::pod_collect_to_vec(&bytes(device, &lit, "depth"));
        let of_device = |light: &FireLight| Light {
            place: light.position.as_dvec3(),
            radius: light.radius.into(),
            intensity: light.intensity.as_dvec3(),
        };
        let lights: Vec<Light> = on_device(&lit).iter().map(of_device).collect();
        // The sun on the ground: ambient light and its own by the angle.
        let sun = 0.35 + 0.65 * DVec3::new(0.45, 0.75, 0.6).normalize().y;
        let camera = *Paper::camera(&lit.paper).as_ref().unwrap();
        let to_clip = (camera.projection(parameters.aspect()) * camera.view()).as_dmat4();
        let (width, height) = (parameters.width, parameters.height);
        let floor = f64::from(lit.paper.model().floor);
        let (mut seen, mut brightest) = (0, 0.0_f64);
        for (i, (with, without)) in (0..).zip(with.iter().zip(&without)) {
            let clip = |x: f64, pixels: u32| 2.0 * (x + 0.5) / f64::from(pixels) - 1.0;
            let at = [clip((i % width).into(), width), clip((i / width).into(), height)];
            let [near, far] = [0.1, 0.9].map(|depth| to_clip.inverse().project_point3(DVec3::new(at[0], at[1], depth)));
            let way = (floor - near.y) / (far.y - near.y);
            let place = near + way * (far - near);
            // On the ground before it fades.
            let from_middle = DVec3::new(place.x, 0.0, place.z).length();
            if !(0.0..1e3).contains(&way) || from_middle > 0.48 {
                continue;
            }
            let found = (with.truncate() / without.truncate() - 1.0) * sun;
            let expected = irradiance(&lights, place, DVec3::Y);
            // Where the object stands it is as near, but of another colour; ash is left out too.
            let is_near = (to_clip.project_point3(place).z - f64::from(depths[i as usize])).abs() < 2e-5;
            let mut ratios = [0.15 / 0.14, 0.15 / 0.13].into_iter().zip([without.y, without.z]);
            if is_near && ratios.all(|(of_ground, other)| (without.x / other - of_ground).abs() < 0.02) {
                seen += 1;
                brightest = brightest.max(expected.x);
                let apart = (found - expected).abs().max_element();
                assert!(apart < 0.004 + 0.01 * expected.x, "{i}: {found} {expected}");
            }
        }
        assert!(seen > 100 && brightest > 0.1, "{seen} pixels of ground, {brightest}");
    });
}

#[test]
fn char_glows_while_it_burns() {
    gpu_test(|device| {
        let mesh = with_triangles(&shapes::sphere(32, 32), 4000);
        let fire = first_picture(device, Variant::Shell, &burning(), &mesh);
        let state = dump::state(&fire, true);
        let counts = fire.paper.counts().unwrap();
        let [mapped, colors] =
            [&fire.paper.buffers().mapped, &fire.paper.buffers().colors].map(|list| fire.read::<[f32; 4]>(list));
        let rest = &fire.paper.model().rest;
        let (mut glowing, mut dark) = (0, 0);
        for (&vertex, color) in fire.paper.model().lattice.welds.iter().zip(&colors) {
            let vertex = vertex as usize;
            let behind = counts.radius - rest[vertex].boundary_distance;
            // Beyond the edge that glows by itself.
            if behind < 0.081 || !state.alive[vertex] {
                continue;
            }
            let left = f64::from(mapped[vertex][3]);
            let expected = ember(rest[vertex].position.as_dvec3(), left, f64::from(counts.tick) / 60.0);
            assert!((f64::from(color[3]) - expected).abs() < 1e-3, "{vertex}: {} {expected}", color[3]);
            assert!(left > 0.0 || color[3] == 0.0, "what has burnt out is dark");
            *(if color[3] > 0.1 { &mut glowing } else { &mut dark }) += 1;
        }
        assert!(glowing > 30 && dark > 50, "{glowing} {dark}");
    });
}

#[test]
fn the_picture_is_the_exposed_light_with_the_layer_over_it() {
    gpu_test(|device| {
        for (exposure, tone) in [(1.0, Tone::Shoulder), (2.5, Tone::Shoulder), (2.5, Tone::Clip), (0.0, Tone::Clip)] {
            let parameters = Parameters { exposure, tone, fire_scale: 1, fire_light: 4.0, ..burning() };
            let fire = first_picture(device, Variant::Shell, &parameters, &ball());
            let (light, layer) = (image(device, &fire, "radiance"), image(device, &fire, "fire-layer"));
            assert!(layer.iter().filter(|texel| texel.x > 0.05).count() > 50);
            let picture = read_image(device, fire.paper.picture()).unwrap();
            for (i, (light, layer)) in light.iter().zip(&layer).enumerate() {
                let whole = light.truncate() * (1.0 - layer.w) + layer.truncate();
                for channel in 0..3 {
                    let value = toned(whole[channel] * f64::from(exposure), tone == Tone::Shoulder);
                    let wanted = 255.0 * srgb::encode(value);
                    let found = f64::from(picture[4 * i + channel]);
                    assert!((found - wanted).abs() < 1.0, "{i}, {channel}: {found} {wanted}");
                }
            }
        }
    });
}

#[test]
fn a_layer_of_fewer_pixels_is_close_to_that_of_all() {
    gpu_test(|device| {
        let cases = [(Variant::Shell, 100), (Variant::Shell, 160), (Variant::Melting, 100)];
        for (look, (variant, frame)) in Look::ALL.iter().flat_map(|look| cases.map(|case| (*look, case))) {
            let pictured = |fire_scale: u32| {
                let (width, height) = (401, 299);
                let parameters = Parameters { width, height, fire_scale, look, first_frame: frame, ..burning() };
                let fire = first_picture(device, variant, &parameters, &ball());
                Rgba8::new(width, height, read_image(device, fire.paper.picture()).unwrap()).unwrap()
            };
            let whole = pictured(1);
            let [half, eighth] = [2, 8].map(|scale| compare(&whole, &pictured(scale), None).unwrap());
            assert!(half.mean > 0.0 && half.mean < 2.0 && half.p99 < 50.0, "{look:?}: {half:?}");
            assert!(eighth.mean > half.mean && eighth.mean < 10.0, "{look:?}: {eighth:?}");
        }
    });
}

/// The four texels of a layer of `scale` that a pixel is between.
fn around(pixel: [u32; 2], size: [u32; 2], scale: u32) -> [usize; 4] {
    let texel = |axis: usize, next: i64| {
        let first = (i64::from(pixel[axis]) - i64::from(scale / 2)).div_euclid(scale.into());
        (first + next).clamp(0, ((size[axis] - 1) / scale).into()) as usize
    };
    let columns = size[0].div_ceil(scale) as usize;
    [[0, 0], [1, 0], [0, 1], [1, 1]].map(|[x, y]| texel(0, x) + columns * texel(1, y))
}

#[test]
fn the_texts_layer_goes_over_the_picture_wherever_it_shows_something() {
    gpu_test(|device| {
        let size = [187, 121];
        for fire_scale in [2, 3] {
            let [width, height] = size;
            let look = Look::Dissertation;
            let parameters = Parameters { width, height, fire_scale, look, first_frame: 130, ..burning() };
            let fire = first_picture(device, Variant::Shell, &parameters, &ball());
            let layer = image(device, &fire, "fire-layer");
            let picture = read_image(device, fire.paper.picture()).unwrap();
            let bare = Parameters { fire: 0, smoke: 0, ..parameters };
            let bare = first_picture(device, Variant::Shell, &bare, &ball());
            let bare = read_image(device, bare.paper.picture()).unwrap();
            let (mut burning, mut clear) = (0, 0);
            for (i, (own, without)) in picture.chunks_exact(4).zip(bare.chunks_exact(4)).enumerate() {
                let at = [i as u32 % width, i as u32 / width];
                let texels = around(at, size, fire_scale).map(|texel| layer[texel]);
                if texels.iter().all(|texel| *texel == DVec4::ZERO) {
                    assert!(own == without, "{at:?} is clear");
                    clear += 1;
                } else if texels.iter().all(|texel| texel.x > 0.05 && texel.w == 0.0) && without[0] < 200 {
                    assert!(own[0] > without[0], "{at:?} burns: {own:?} {without:?}");
                    burning += 1;
                }
            }
            assert!(burning > 50 && clear > 1000, "{burning} {clear}");
        }
    });
}

#[test]
fn the_text_alone_has_no_lights() {
    gpu_test(|device| {
        let straight = Parameters { fire_scale: 1, ..super::fire::quick() };
        let fire = first_picture(device, Variant::Shell, &straight, &ball());
        assert!(fire.paper.fire_lights().is_none());
        let names: Vec<String> = fire.paper.targets().into_iter().map(|target| target.name).collect();
        assert!(!names.iter().any(|name| ["radiance", "fire-layer", "fire-lights"].contains(&name.as_str())));
    });
}
