//! The order of a mesh's triangles and vertices, which files get anew for the vertex cache, changes no fire.

use std::collections::HashMap;

use fumarole::papers::burning::{Parameters, Variant};
use glam::Vec3;

use super::fire::{Fire, ball, quick};
use crate::common::gpu_test;

#[test]
fn a_mesh_in_another_order_burns_alike() {
    gpu_test(|device| {
        let plain = ball();
        let mut optimised = plain.clone();
        optimised.optimise_order();
        assert!(plain.indices != optimised.indices && plain.positions != optimised.positions);
        let parameters = Parameters { sources: vec![Vec3::new(0.1, 0.0, 0.05)], ..quick() };
        for variant in [Variant::Shell, Variant::Solid] {
            let parameters = Parameters { levels: Some(0), ..parameters.clone() };
            let burnt = [&plain, &optimised].map(|mesh| {
                let mut fire = Fire::new(device, variant, &parameters, mesh);
                fire.ticks(45);
                let (state, rest) = (fire.state(), &fire.paper.model().rest);
                let places = rest.iter().map(|r| r.position.to_array().map(f32::to_bits));
                let vertices = state.vertices.iter().zip(&state.labels).map(|(v, label)| (v.position, v.left, *label));
                let removed: u32 = state.removed.iter().sum();
                (places.zip(vertices).collect::<HashMap<_, _>>(), removed)
            });
            let [(first, removed), (second, removed_too)] = burnt;
            assert_eq!((first.len(), removed), (second.len(), removed_too), "{variant:?}");
            let burning = first.values().filter(|(_, left, _)| *left < parameters.flammability as f32).count();
            assert!(burning > 100 && burning < first.len(), "{variant:?}: {burning} of {}", first.len());
            for (place, (position, left, label)) in &first {
                let (other, left_too, label_too) = second[place];
                assert_eq!((*left, *label), (left_too, label_too), "{variant:?}");
                // Sums over neighbours are rounded in another order.
                assert!(position.distance(other) < 1e-4, "{variant:?}: {position} {other}");
            }
        }
    });
}
