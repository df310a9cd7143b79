//! The multilevel altitude map, built by both processors.

use fumarole::gpu::transfer::read_image;
use fumarole::gpu::{Compiler, ShaderLibrary};
use fumarole::papers::terrain::{Bound, Levels, Pyramid, Shape, Texel};
use fumarole::scene::random::Random;
use fumarole::scene::{HeightMap, Samples};

use crate::common::gpu_test;

const BOUNDS: [Bound; 2] = [Bound::Highest, Bound::Lowest];

/// The texels of a level in a layer of the device's image.
fn level<T: bytemuck::Pod>(shape: Shape, layer: u32, shift: u32, texels: &[T]) -> Vec<T> {
    let (width, height) = shape.extent();
    let ((x, y), (columns, rows)) = (shape.origin(shift), shape.level(shift));
    let row = |row: u32| &texels[((layer * height + y + row) * width + x) as usize..][..columns as usize];
    (0..rows).flat_map(|r| row(r).to_vec()).collect()
}

fn assert_identical<T: Texel + bytemuck::Pod + std::fmt::Debug>(shape: Shape, data: &[T], texels: &[T]) {
    for (layer, bound) in (1..).zip(BOUNDS) {
        let expected = Pyramid::build(shape, data, bound);
        for shift in 1..=shape.top {
            let found = level(shape, layer, shift, texels);
            let bytes = |texels: &[T]| bytemuck::cast_slice::<T, u8>(texels).to_vec();
            let expected = bytes(expected.level(shift).unwrap());
            assert!(bytes(&found) == expected, "{shape:?} {bound:?}: the level {shift} above the data differs");
        }
    }
}

#[test]
fn the_device_builds_the_same_levels_bit_for_bit() {
    gpu_test(|device| {
        let shaders = ShaderLibrary::new(device, Compiler::Glslang, None).unwrap();
        let mut random = Random::new(7);
        for (width, height) in [(2, 2), (3, 2), (129, 65), (64, 64), (2, 300), (301, 97)] {
            let shape = Shape::new(width, height);
            let values: Vec<u16> = (0..width * height).map(|_| (random.unit() * 65_535.0) as u16).collect();
            let floats: Vec<f32> = values.iter().map(|&v| f32::from(v) * 0.37 - 9000.0).collect();
            let texels = |samples| {
                let map = HeightMap::new(width, height, samples).unwrap();
                read_image(device, &Levels::new(&shaders, "test", &map, &BOUNDS).unwrap().view).unwrap()
            };
            let steps = texels(Samples::Steps { values: values.clone(), origin_m: 0.0, step_m: 1.0 });
            assert_identical(shape, &values, &bytemuck::pod_collect_to_vec::<u8, u16>(&steps));
            assert_identical(
                shape,
                &floats,
                &bytemuck::pod_collect_to_vec::<u8, f32>(&texels(Samples::Float(floats.clone()))),
            );
        }
    });
}
