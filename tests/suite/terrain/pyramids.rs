//! The multilevel altitude map, built by both processors.

use fumarole::gpu::Compiler;
use fumarole::gpu::transfer::read_image;
use fumarole::papers::terrain::{Bound, Cover, Interpolation, Levels, Pyramid, Shape, Texel};
use fumarole::scene::random::Random;
use fumarole::scene::{HeightMap, Samples};

use crate::common::{gpu_test, shaders_by};

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
        let shaders = shaders_by(device, Compiler::Glslang);
        let mut random = Random::new(7);
        for (width, height) in [(2, 2), (3, 2), (129, 65), (64, 64), (2, 300), (301, 97)] {
            let shape = Shape::new(width, height);
            let values: Vec<u16> = (0..width * height).map(|_| (random.unit() * 65_535.0) as u16).collect();
            let floats: Vec<f32> = values.iter().map(|&v| f32::from(v) * 0.37 - 9000.0).collect();
            let texels = |samples| {
                let map = HeightMap::new(width, height, samples).unwrap();
                read_image(device, &Levels::new(&shaders, "test", &map, &BOUNDS, Cover::Nodes).unwrap().view).unwrap()
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

/// For the variants that walk from cell to cell: a texel has the highest and the lowest of all nodes that the surface over its
/// cells reads, whatever the sides.
#[test]
fn levels_of_cells_bound_what_their_surface_reads() {
    gpu_test(|device| {
        let shaders = shaders_by(device, Compiler::Glslang);
        let mut random = Random::new(8);
        for (width, height) in [(2, 2), (3, 2), (65, 33), (64, 40), (2, 70), (51, 97)] {
            let shape = Shape::new(width, height);
            let values: Vec<u16> = (0..width * height).map(|_| (random.unit() * 65_535.0) as u16).collect();
            for interpolation in [Interpolation::Bilinear, Interpolation::Bicubic] {
                let samples = Samples::Steps { values: values.clone(), origin_m: 0.0, step_m: 1.0 };
                let map = HeightMap::new(width, height, samples).unwrap();
                let cover = Cover::Cells(interpolation);
                let levels = Levels::new(&shaders, "test", &map, &BOUNDS, cover).unwrap();
                let texels = bytemuck::pod_collect_to_vec::<u8, u16>(&read_image(device, &levels.view).unwrap());
                // Nodes before a cell's own and after, as the interpolation reads them.
                let (before, after) = if interpolation == Interpolation::Bilinear { (0, 1) } else { (1, 2) };
                for (layer, shift) in (1..=2).flat_map(|layer| (1..=shape.top).map(move |shift| (layer, shift))) {
                    let found = level(shape, layer, shift, &texels);
                    let (columns, rows) = shape.level(shift);
                    for (index, found) in found.iter().enumerate() {
                        let (x, y) = (index as i64 % i64::from(columns), index as i64 / i64::from(columns));
                        assert!(y < i64::from(rows));
                        let side = 1_i64 << shift;
                        let along = |at: i64, size: u32| {
                            (at * side - before).max(0)..=((at + 1) * side - 1 + after).min(i64::from(size) - 1)
                        };
                        let read = along(y, height).flat_map(|row| along(x, width).map(move |column| (column, row)));
                        let read = read.map(|(column, row)| values[(row * i64::from(width) + column) as usize]);
                        let expected = if layer == 1 { read.max() } else { read.min() };
                        let name =
                            format!("{width} x {height} {interpolation:?}: layer {layer}, level {shift}, {x}, {y}");
                        assert_eq!(Some(*found), expected, "{name}");
                    }
                }
            }
        }
    });
}
