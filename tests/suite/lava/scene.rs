//! Small configurations, and one run of the paper on the device.

use std::sync::Arc;

use bytemuck::Pod;
use fumarole::gpu::transfer::read_image;
use fumarole::gpu::{Compiler, Device, FrameSample, ImageView, Mode, Recorder, ShaderLibrary};
use fumarole::measure::Paper;
use fumarole::papers::lava::reference::Grid;
use fumarole::papers::lava::{Lava, Method, Parameters, Particles, ReadBack, Rock, Variant};
use glam::{DVec3, Vec3};

use crate::common::shaders_by;

/// 1,000 particles in a space whose sides differ, grid cells that are no squares, planes that are no multiple of four.
pub fn parameters() -> Parameters {
    Parameters {
        space_m: Vec3::new(2.0, 1.0, 1.2),
        particles: 1000,
        radius_m: 0.171,
        density: [30, 10, 17],
        splats: [60, 36],
        splat_radius_m: 0.05,
        width: 160,
        height: 120,
        ..Parameters::default()
    }
}

pub fn shaders(device: &Arc<Device>) -> Arc<ShaderLibrary> {
    shaders_by(device, Compiler::Glslang)
}

/// The paper with its seeded particles and the built-in rock.
pub fn lava(device: &Arc<Device>, parameters: &Parameters) -> Lava {
    lava_of(device, parameters, &Particles::seeded(parameters))
}

pub fn lava_of(device: &Arc<Device>, parameters: &Parameters, particles: &Particles) -> Lava {
    variant_of(device, Variant::Paper, parameters, particles)
}

/// The variant `gpu-driven`, as [`lava`].
pub fn driven(device: &Arc<Device>, parameters: &Parameters) -> Lava {
    variant_of(device, Variant::GpuDriven, parameters, &Particles::seeded(parameters))
}

pub fn variant_of(device: &Arc<Device>, variant: Variant, parameters: &Parameters, particles: &Particles) -> Lava {
    parameters.validate().unwrap();
    Lava::new(&shaders(device), "test", variant, parameters, particles, Rock::built_in(), &[]).unwrap()
}

/// Stages one and two of the thesis.
pub fn read_back(lava: &Lava) -> &ReadBack {
    match &lava.method {
        Method::Paper(read_back) => read_back,
        Method::GpuDriven(_) => panic!("nothing is read back"),
    }
}

/// Draws frame `number`.
pub fn draw(device: &Arc<Device>, lava: &mut Lava, number: u32) -> FrameSample {
    let mut recorder = Recorder::new(device).unwrap();
    recorder.run(Mode::Plain, |frame| lava.record_picture(frame, number)).unwrap().clone()
}

pub fn texels<T: Pod>(device: &Arc<Device>, view: &Arc<ImageView>) -> Vec<T> {
    bytemuck::pod_collect_to_vec(&read_image(device, view).unwrap())
}

/// Particles in the last frame's clusters, from the position texture: inside the space, as `cluster` takes them.
pub fn clamped(device: &Arc<Device>, lava: &Lava, parameters: &Parameters) -> Vec<DVec3> {
    let positions: Vec<[f32; 4]> = texels(device, &lava.animate.state().positions);
    let places = positions.iter().take(parameters.particles as usize);
    places.map(|&[x, y, z, _]| Vec3::new(x, y, z).clamp(Vec3::ZERO, parameters.space_m).as_dvec3()).collect()
}

pub fn grid(parameters: &Parameters) -> Grid {
    Grid::new(parameters.space_m, parameters.density)
}

/// The texture of densities in the order of [`Grid::indices`].
pub fn densities(device: &Arc<Device>, lava: &Lava, parameters: &Parameters) -> Vec<f64> {
    let layers: Vec<[f32; 4]> = texels(device, lava.method.density());
    let [columns, _, rows] = parameters.density.map(|n| n as usize);
    let at = |[i, j, k]: [usize; 3]| layers[(j / 4) * columns * rows + k * columns + i][j % 4];
    grid(parameters).indices().map(|index| f64::from(at(index))).collect()
}
