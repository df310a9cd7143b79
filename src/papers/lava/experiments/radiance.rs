//! Emitted radiance (chapter 9): chromaticities of pixels of lava of one temperature, beside Planck's law for the CIE 1931 observer.

use serde_json::{Value, json};

use super::super::blackbody::xyz;
use super::super::setup::Setup;
use crate::gpu::transfer::read_image;
use crate::measure::bench::build;
use crate::measure::machine::Machine;
use crate::measure::result_table::ResultTable;
use crate::measure::study::Study as _;
use crate::measure::{Error, Paper as _, picture};
use crate::papers::lava::{Shading, Simulation, SurfaceDraw, Variant};

/// Kelvin.
const TEMPERATURES: [f32; 11] =
    [1000.0, 1200.0, 1423.0, 1700.0, 2000.0, 2500.0, 3000.0, 4000.0, 5000.0, 6504.0, 10_000.0];
/// From linear light in the primaries of ITU-R BT.709 to XYZ.
const TO_XYZ: [[f64; 3]; 3] = [
    [0.412_456_4, 0.357_576_1, 0.180_437_5],
    [0.212_672_9, 0.715_152_2, 0.072_175],
    [0.019_333_9, 0.119_192, 0.950_304_1],
];

fn chromaticity(xyz: [f64; 3]) -> Option<[f64; 2]> {
    let sum: f64 = xyz.iter().sum();
    (sum > 0.0).then(|| [xyz[0] / sum, xyz[1] / sum])
}

/// Mean of the lit pixels' linear light, of the sums of eq. 7.2.
fn light(sums: &[[f32; 4]]) -> Option<[f64; 3]> {
    let lit: Vec<&[f32; 4]> = sums.iter().filter(|sum| sum[3] > 0.0).collect();
    let mean = |axis: usize| lit.iter().map(|sum| f64::from(sum[axis] / sum[3])).sum::<f64>() / lit.len() as f64;
    (!lit.is_empty()).then(|| [mean(0), mean(1), mean(2)])
}

/// Only free particles have the temperature that they are told.
///
/// # Errors
/// [`Error::Input`] for a fluid.
pub fn check(setup: &Setup) -> Result<(), Error> {
    match setup.parameters.simulation {
        Simulation::Free => Ok(()),
        Simulation::Sph => {
            Err(Error::Input("`simulation` sph: its particles have temperatures of their own; give free".to_owned()))
        }
    }
}

/// A row for each temperature.
///
/// # Errors
/// [`Error::Gpu`], [`Error::Image`], [`Error::Parameter`], [`Error::Input`].
pub fn table(machine: &mut Machine, setup: &Setup) -> Result<ResultTable, Error> {
    let mut setup = setup.clone();
    let p = &mut setup.parameters;
    (p.is_blackbody, p.shading, p.surface_draw) = (true, Shading::Color, Some(SurfaceDraw::March));
    let scene = setup.load()?;
    let mut paper = build(machine, &setup, &scene, Variant::GpuDriven)?.paper;
    let mut rows: Vec<Vec<Value>> = Vec::new();
    for kelvin in TEMPERATURES {
        setup.parameters.temperatures_k = Some([kelvin; 2]);
        paper.set_drawn(&setup.parameters, &scene.rock, &scene.objects)?;
        if !rows.is_empty() {
            paper.repeat();
        }
        picture::render(machine, &mut paper, 0)?;
        let sums: Vec<[f32; 4]> = bytemuck::pod_collect_to_vec(&read_image(&machine.device, &paper.splatting.sums)?);
        let found = light(&sums).map(|light| TO_XYZ.map(|row| (0..3).map(|axis| row[axis] * light[axis]).sum::<f64>()));
        let found = found.and_then(chromaticity);
        let expected = chromaticity(xyz(f64::from(kelvin)));
        let apart = found.zip(expected).map(|(a, b)| (a[0] - b[0]).hypot(a[1] - b[1]));
        let along = |at: Option<[f64; 2]>, axis: usize| json!(at.map(|at| at[axis]));
        rows.push(vec![
            json!(kelvin),
            along(found, 0),
            along(found, 1),
            along(expected, 0),
            along(expected, 1),
            json!(apart),
        ]);
    }
    Ok(ResultTable {
        title: "Radiance: chromaticities of pixels beside Planck's law; the display has none of below 1,900 K",
        columns: &["kelvin", "x", "y", "Planck's x", "Planck's y", "apart"],
        rows,
    })
}
