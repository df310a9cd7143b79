//! Tables of densities that rays read in place of the functions, against the functions and rays in double precision.

use fumarole::gpu::Compiler;
use fumarole::papers::gas::reference::density::Medium;
use fumarole::papers::gas::reference::density_cache::Values;
use fumarole::papers::gas::reference::rays::Sampling;
use fumarole::papers::gas::reference::shadow_table::density_table;
use fumarole::papers::gas::{Parameters, Variant};
use glam::Vec3;

use super::drawing::Drawing;
use super::march::{FRAME, differences, gases, parameters, worst};
use crate::common::gpu_test;

/// Entries that points of the solid lie between hold the function's values, of the frame that is drawn.
#[test]
fn the_cache_holds_the_functions() {
    gpu_test(|device| {
        for gas in gases() {
            let size = 11;
            let parameters = Parameters { steps: 4, density_cache: Some(size), ..parameters(vec![gas]) };
            let drawing = Drawing::of(device, Variant::None, &parameters, &[]);
            let medium = Medium::new(&parameters, FRAME);
            let expected = Values::new(&gas, size, |world| medium.texture_density(&gas.texture, Some(&gas), world));
            let mut needed = 0;
            let entries: Vec<[f32; 4]> =
                drawing.target("density-cache").chunks_exact(4).map(|e| [0, 1, 2, 3].map(|i| e[i])).collect();
            let side = size as usize;
            for (i, &value) in expected.values().iter().enumerate() {
                let found = entries[i][0];
                // Beside it stand those after it, of the last ones the first.
                let (x, y, layer) = (i % side, i / side % side, i / (side * side) * side * side);
                let of = |x: usize, y: usize| entries[layer + y % side * side + x % side][0];
                assert_eq!(entries[i][1..], [of(x + 1, y), of(x, y + 1), of(x + 1, y + 1)]);
                if expected.is_needed(i) {
                    needed += 1;
                    assert!(
                        (f64::from(found) - value).abs() < 2e-4 * (1.0 + value),
                        "{:?}, {i}: {found} for {value}",
                        gas.texture.function
                    );
                } else {
                    assert!(found == 0.0 || (f64::from(found) - value).abs() < 2e-4 * (1.0 + value));
                }
            }
            assert!(needed > 700, "{needed} entries of {:?}", gas.shape);
        }
    });
}

/// Viewer's rays and shadow rays, through every gas in every shape.
#[test]
fn rays_read_the_cache() {
    gpu_test(|device| {
        for gas in gases() {
            let parameters = Parameters { steps: 12, density_cache: Some(9), ..parameters(vec![gas]) };
            for (variant, is_shadowed) in [(Variant::None, false), (Variant::Traced, true)] {
                let drawing = Drawing::of(device, variant, &parameters, &[]);
                let worst = worst(&differences(&drawing, &parameters, is_shadowed, Sampling::Random));
                println!("{:?}, {variant:?}: {worst:.2e}", gas.texture.function);
                assert!(worst < 5e-5, "{:?}, {variant:?}: {worst}", gas.texture.function);
            }
        }
    });
}

/// Several volumes have tables of their own, which the shadow table begins with too; naga's shaders draw the same.
#[test]
fn volumes_have_their_own_tables() {
    gpu_test(|device| {
        let mut volumes = gases();
        volumes.truncate(3);
        volumes[1].center = Vec3::new(0.5, 0.4, 0.3);
        volumes[2].half_extent_m *= 1.4;
        let parameters =
            Parameters { steps: 12, density_cache: Some(7), table_size: 10, ..parameters(volumes.clone()) };
        let drawing = Drawing::of(device, Variant::Traced, &parameters, &[]);
        let off = |drawing: &Drawing| {
            let differences = differences(drawing, &parameters, true, Sampling::Random);
            differences.iter().filter(|d| d.abs().max_element() > 1e-4).count()
        };
        assert_eq!(off(&drawing), 0);
        let naga = Drawing::frame(device, Compiler::Naga, Variant::Traced, &parameters, &[], 0);
        assert_eq!(off(&naga), 0);

        let drawing = Drawing::of(device, Variant::Table, &parameters, &[]);
        let medium = Medium::new(&parameters, FRAME);
        for (table, volume) in drawing.entries("density-table", 10).chunks_exact(1000).zip(&volumes) {
            for (i, (&found, value)) in table.iter().zip(density_table(&medium, volume, 10)).enumerate() {
                // An entry on the boundary may be outside but for rounding: what it holds then has faded.
                let is_near = (f64::from(found) - value).abs() < 2e-4 * (1.0 + value);
                assert!(is_near, "{:?}, {i}: {found} for {value}", volume.texture.function);
            }
        }
    });
}

/// Pictures come nearer to that of the functions as entries become more.
#[test]
fn more_entries_are_nearer_to_the_functions() {
    gpu_test(|device| {
        let gas = gases()[4];
        let own = parameters(vec![gas]);
        let mean = |entries: u32| {
            let cached = Parameters { density_cache: Some(entries), ..own.clone() };
            let drawing = Drawing::of(device, Variant::Traced, &cached, &[]);
            let differences = differences(&drawing, &own, true, Sampling::Random);
            differences.iter().map(|d| d.abs().max_element()).sum::<f64>() / differences.len() as f64
        };
        let means = [12, 24, 48].map(mean);
        println!("means of the difference: {means:.6?}");
        assert!(means[1] < 0.6 * means[0] && means[2] < 0.6 * means[1], "{means:?}");
    });
}
