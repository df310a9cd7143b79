//! The iterations after which the device ends loops.

use ash::vk;
use fumarole::gpu::{Mode, Pass, transfer};

use super::fixtures::{run, shaders};
use crate::common::gpu_test;

/// The number after so many iterations of `test/loops.comp`.
fn number_after(iterations: u32) -> u32 {
    (0..iterations).fold(0_u32, |number, _| number.wrapping_mul(1_664_525).wrapping_add(1_013_904_223))
}

/// lavapipe ends all loops of a shader after 65,535 iterations together, without a word; other devices end none. What
/// carries work on from dispatch to dispatch finds that out by itself; this test shows when a driver changes.
#[test]
fn loops_end_where_this_driver_is_known_to_end_them() {
    gpu_test(|device| {
        let made = |wanted: [u32; 2]| -> Vec<u32> {
            let usage = vk::BufferUsageFlags::STORAGE_BUFFER;
            let buffer = |name: &str, values: &[u32]| {
                transfer::upload(device, name, usage, bytemuck::cast_slice(values)).unwrap()
            };
            let made = buffer("made", &[0; 2]);
            let pass = Pass::compute("loops", "", "test/loops.comp")
                .with("Wanted", &buffer("wanted", &wanted.map(number_after)))
                .with("Made", &made)
                .build(&shaders(device))
                .unwrap();
            run(device, Mode::Plain, |frame| frame.compute(&pass, |dispatch| dispatch.threads(1, 1, 1))).unwrap();
            bytemuck::pod_collect_to_vec(&transfer::read_buffer(device, &made).unwrap())
        };
        assert_eq!(made([100, 60_000]), [100, 60_000]);
        let found = [made([100_000, 7]), made([40_000, 40_000])];
        println!("{}: of 100,000 and 7 iterations {:?} are made", device.physical().name, found);
        let expected = if device.physical().name.contains("llvmpipe") {
            // The outer loop and the pass in which a loop ends by itself count too.
            [vec![65_535, 0], vec![40_000, 25_533]]
        } else {
            [vec![100_000, 7], vec![40_000, 40_000]]
        };
        assert_eq!(found, expected);
    });
}
