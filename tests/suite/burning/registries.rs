//! The laws on meshes from the registries, with legs, feelers, wings and spouts, modelled by others.

use std::path::Path;

use fumarole::papers::burning::Variant;
use fumarole::scene::{Mesh, MeshSource};

use super::falling::assert_supported;
use super::fire::Fire;
use super::melting::in_range;
use super::puddle::{Puddle, enclosed, wax};
use crate::common::gpu_test;

pub const FILES: [&str; 5] = ["ant.ply", "airplane.ply", "spider.obj", "wuson.stl", "teapot.obj"];

pub fn load(file: &str) -> Mesh {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/meshes").join(file);
    MeshSource::File(path).load().unwrap()
}

#[test]
fn nothing_of_them_hovers() {
    gpu_test(|device| {
        let fallen: usize = FILES.iter().map(|file| assert_supported(device, file, &load(file))).sum();
        assert!(fallen > 100, "{fallen}");
    });
}

#[test]
fn their_wax_keeps_its_volume_and_comes_to_rest_with_its_edges_in_range() {
    gpu_test(|device| {
        for file in FILES {
            let mut fire = Fire::new(device, Variant::Melting, &wax(), &load(file));
            let start = enclosed(&fire);
            let mut left_ticks = None;
            while left_ticks != Some(0) {
                fire.ticks(30);
                let now = enclosed(&fire) + Puddle::of(&fire).volume();
                assert!((now / start - 1.0).abs() < 0.05, "{file}: {now} of {start}");
                // 4 s in which it sets, and five more.
                let is_out = fire.paper.counts().unwrap().live_vertices == 0;
                left_ticks = left_ticks.map(|ticks: u32| ticks.saturating_sub(30)).or(is_out.then_some(540));
                assert!(fire.paper.ticks() < 6000, "{file} burns on");
            }
            let state = fire.state();
            fire.ticks(6);
            assert!(fire.state().vertices == state.vertices, "{file} moves");
            let share = in_range(&fire, &state, &wax());
            assert!(share >= 0.95, "{file}: {share} of the edges are in range");
        }
    });
}
