//! Wax on the ground: what the mesh loses the puddle gains.

use fumarole::papers::burning::model::with_triangles;
use fumarole::papers::burning::{Film, Heat, PUDDLE_CELLS, PUDDLE_HALF_WIDTH, Parameters, Variant};
use fumarole::scene::{Mesh, MeshSource};
use glam::DVec3;

use super::fire::{Fire, ball};
use crate::common::gpu_test;

/// Of volumes.
const UNIT: f64 = 1.0 / 4294967296.0;

pub fn wax() -> Parameters {
    Parameters { width: 32, height: 24, speed_per_s: 0.1, flammability: 40, levels: Some(0), ..Parameters::default() }
}

fn meshes() -> [Mesh; 3] {
    let [bunny, teapot] = [MeshSource::Bunny, MeshSource::Teapot].map(|mesh| mesh.load().unwrap());
    [ball(), with_triangles(&bunny, 1500), with_triangles(&teapot, 1500)]
}

/// By the divergence theorem, about a point of the ground.
pub fn enclosed(fire: &Fire) -> f64 {
    let state = fire.state();
    let place = |v: u32| state.vertices[v as usize].position.as_dvec3();
    let tetrahedron = |&[a, b, c]: &[u32; 3]| DVec3::dot(place(a), place(b).cross(place(c))) / 6.0;
    let model = fire.paper.model();
    f64::from(model.outward) * model.triangles.iter().map(tetrahedron).sum::<f64>()
}

pub struct Puddle {
    film: Film,
    heights: Vec<u32>,
}

impl Puddle {
    pub fn of(fire: &Fire) -> Self {
        let puddle = fire.paper.puddle().expect("it melts");
        let newest = (fire.paper.ticks() % 2) as usize;
        Puddle { film: fire.read(&puddle.film)[0], heights: fire.read(&puddle.heights[newest]) }
    }

    pub fn volume(&self) -> f64 {
        UNIT * self.heights.iter().map(|v| f64::from(*v)).sum::<f64>()
    }

    fn footprint(&self) -> usize {
        self.heights.iter().filter(|v| **v > 0).count()
    }
}

#[test]
fn mesh_and_puddle_keep_their_volume_and_come_to_rest() {
    gpu_test(|device| {
        for (at, mesh) in meshes().iter().enumerate() {
            let mut fire = Fire::new(device, Variant::Melting, &wax(), mesh);
            let start = enclosed(&fire);
            let mut widest = 0;
            for _ in 0..40 {
                fire.ticks(30);
                let (mesh, puddle) = (enclosed(&fire), Puddle::of(&fire));
                assert!((f64::from(puddle.film.mesh_volume) * UNIT - mesh).abs() < 1e-3 * start, "mesh {at}");
                assert_eq!(puddle.film.evaporated, 0);
                assert_eq!(f64::from(puddle.film.spread_volume) * UNIT, puddle.volume());
                let now = mesh + puddle.volume();
                assert!((now / start - 1.0).abs() < 0.05, "mesh {at}: {now} of {start}, {mesh} of it the mesh's");
                assert!(puddle.footprint() >= widest, "mesh {at}: {} after {widest}", puddle.footprint());
                widest = puddle.footprint();
            }
            // A disc of its width is wider than the object.
            let cell = f64::from(2.0 * PUDDLE_HALF_WIDTH) / f64::from(PUDDLE_CELLS);
            let bounds = fire.paper.model().bounds;
            let foot = f64::from((bounds.max.x - bounds.min.x) * (bounds.max.z - bounds.min.z));
            assert!(widest as f64 * cell * cell > 0.8 * foot, "mesh {at}: {} of {foot}", widest as f64 * cell * cell);
            assert!(Puddle::of(&fire).volume() > 0.5 * start, "mesh {at} has hardly melted");
            assert_eq!(fire.paper.counts().unwrap().live_vertices, 0);
            // Five seconds after the fire has ended, a tenth of a second moves less than five thousandths of it.
            fire.ticks(300);
            let before = Puddle::of(&fire).heights;
            fire.ticks(6);
            let moved: u64 =
                Puddle::of(&fire).heights.iter().zip(&before).map(|(a, b)| u64::from(a.abs_diff(*b))).sum();
            assert!(moved as f64 * UNIT < 5e-3 * start, "mesh {at}: {moved}");
            // The mesh has set: nothing of it moves at all.
            let set = fire.state().vertices;
            fire.ticks(6);
            assert!(fire.state().vertices == set, "mesh {at} moves");
        }
    });
}

#[test]
fn a_rate_evaporates_the_puddle() {
    gpu_test(|device| {
        let parameters = Parameters { evaporation_per_s: 0.01, ..wax() };
        let mut fire = Fire::new(device, Variant::Melting, &parameters, &ball());
        let start = enclosed(&fire);
        fire.ticks(600);
        let puddle = Puddle::of(&fire);
        let evaporated = f64::from(puddle.film.evaporated) * UNIT;
        assert!(evaporated > 0.0);
        let now = enclosed(&fire) + puddle.volume() + evaporated;
        assert!((now / start - 1.0).abs() < 0.05, "{now} of {start}");
        fire.ticks(2400);
        let puddle = Puddle::of(&fire);
        assert!(puddle.volume() < 0.01 * start, "{} is left of {start}", puddle.volume());
    });
}

#[test]
fn the_text_alone_has_no_puddle_and_the_same_mesh() {
    use super::fire::text;
    gpu_test(|device| {
        // Until something has burnt out, and sets.
        let wax = Parameters { heat: Some(Heat::Air), flammability: 10_000, ..wax() };
        let [mut ours, mut theirs] = [wax.clone(), Parameters { look: text().look, ..wax }]
            .map(|parameters| Fire::new(device, Variant::Melting, &parameters, &ball()));
        assert!(theirs.paper.puddle().is_none());
        for fire in [&mut ours, &mut theirs] {
            fire.ticks(400);
        }
        assert!(ours.state() == theirs.state());
    });
}
