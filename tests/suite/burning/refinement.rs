//! Chapter 4: which triangles of the refinement pattern are in use, and what is drawn of them.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use bytemuck::Pod;
use fumarole::gpu::transfer::read_buffer;
use fumarole::gpu::{Buffer, Compiler, Device, Mode, Recorder};
use fumarole::measure::Paper;
use fumarole::papers::burning::model::{Model, tree};
use fumarole::papers::burning::{Burning, Counts, Parameters, Variant, VertexState};
use fumarole::scene::shapes::{cuboid, sphere};
use fumarole::scene::{Camera, Mesh};
use glam::Vec3;

use super::fire::text;
use crate::common::{gpu_test, shaders_by};

/// A fire that crosses the object in about 180 ticks and leaves holes soon after.
fn parameters() -> Parameters {
    Parameters {
        speed_per_s: 0.4,
        flammability: 20,
        fire: 0,
        smoke: 0,
        level_of_detail: Some(5),
        width: 64,
        height: 48,
        ..text()
    }
}

/// One object on fire.
struct Fire {
    burning: Burning,
    recorder: Recorder,
    device: Arc<Device>,
    next: u32,
}

impl Fire {
    fn new(device: &Arc<Device>, variant: Variant, parameters: &Parameters, mesh: &Mesh) -> Self {
        Fire::compiled(device, Compiler::Glslang, variant, parameters, mesh)
    }

    fn compiled(
        device: &Arc<Device>,
        compiler: Compiler,
        variant: Variant,
        parameters: &Parameters,
        mesh: &Mesh,
    ) -> Self {
        parameters.validate().unwrap();
        let shaders = shaders_by(device, compiler);
        let burning = Burning::new(&shaders, "test", variant, parameters, mesh).unwrap();
        Fire { burning, recorder: Recorder::new(device).unwrap(), device: device.clone(), next: 0 }
    }

    /// Burns until `ticks` ticks have passed, and shows the last.
    fn burn_to(&mut self, ticks: u32) {
        while self.next < ticks {
            let Fire { burning, recorder, next, .. } = self;
            let end = ticks.min(*next + 32);
            recorder.run(Mode::Plain, |frame| (*next..end).try_for_each(|n| burning.record(frame, n))).unwrap();
            *next = end;
        }
    }

    fn read<T: Pod>(&self, buffer: &Arc<Buffer>) -> Vec<T> {
        bytemuck::pod_collect_to_vec(&read_buffer(&self.device, buffer).unwrap())
    }

    fn model(&self) -> &Model {
        self.burning.model()
    }

    fn counts(&self) -> Counts {
        self.burning.counts().unwrap()
    }

    fn statuses(&self) -> Vec<i32> {
        self.read(&self.burning.refinement().expect("it is refined").statuses)
    }

    fn state(&self) -> Vec<VertexState> {
        self.read(self.burning.state().0)
    }

    /// Vertices of the drawn triangles.
    fn drawn(&self) -> Vec<[u32; 3]> {
        let arguments: Vec<u32> = self.read(&self.burning.buffers().arguments);
        let stream: Vec<[u32; 3]> = self.read(&self.burning.buffers().stream);
        assert_eq!(arguments, [3 * self.counts().drawn_triangles, 1, 0, 0, 0]);
        let welds = &self.model().lattice.welds;
        stream[..arguments[0] as usize / 3].iter().map(|t| t.map(|corner| welds[corner as usize])).collect()
    }

    /// The level of the leaf that each finest triangle lies in. The leaves part every coarse triangle: above a leaf all
    /// is split, below it nothing is in use.
    fn leaf_levels(&self) -> Vec<u32> {
        let levels = self.model().levels;
        let statuses = self.statuses();
        let mut found = Vec::new();
        for tree in statuses.chunks_exact(tree::nodes_of(levels) as usize) {
            visit(tree, levels, 0, 0, &mut found);
        }
        assert_eq!(found.len(), self.model().triangles.len());
        found
    }
}

fn visit(tree: &[i32], levels: u32, level: u32, index: u32, found: &mut Vec<u32>) {
    match tree[(tree::nodes_above(level) + index) as usize] {
        -1 if level < levels => (0..4).for_each(|child| visit(tree, levels, level + 1, 4 * index + child, found)),
        1 => {
            for below in 1..=levels - level {
                let first = (tree::nodes_above(level + below) + (index << (2 * below))) as usize;
                assert!(tree[first..first + (1 << (2 * below))].iter().all(|&s| s == 0), "below {level} {index}");
            }
            found.extend(std::iter::repeat_n(level, 1 << (2 * (levels - level))));
        }
        other => panic!("node {index} of level {level} has status {other}"),
    }
}

fn edges(t: &[u32; 3]) -> [(u32, u32); 3] {
    [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])]
}

/// Number of triangles of each directed edge.
fn directed(triangles: &[[u32; 3]]) -> BTreeMap<(u32, u32), u32> {
    let mut found = BTreeMap::new();
    for edge in triangles.iter().flat_map(edges) {
        *found.entry(edge).or_insert(0) += 1;
    }
    found
}

/// The edges that no neighbour shares in the other direction.
fn borders(triangles: &[[u32; 3]]) -> Vec<(u32, u32)> {
    let found = directed(triangles);
    for (edge, count) in &found {
        assert_eq!(*count, 1, "{edge:?} is an edge of two triangles that look to different sides");
    }
    found.keys().copied().filter(|&(a, b)| !found.contains_key(&(b, a))).collect()
}

/// The levels of leaves on both sides of an edge differ by one at most; so they do wherever several triangles meet in
/// an edge.
fn check_neighbours(model: &Model, leaf_levels: &[u32]) {
    let mut ranges: BTreeMap<(u32, u32), (u32, u32)> = BTreeMap::new();
    for (triangle, &level) in model.triangles.iter().zip(leaf_levels) {
        for (a, b) in edges(triangle) {
            let range = ranges.entry((a.min(b), a.max(b))).or_insert((level, level));
            *range = (range.0.min(level), range.1.max(level));
        }
    }
    for (edge, (coarsest, finest)) in ranges {
        assert!(finest - coarsest <= 1, "levels {coarsest} and {finest} meet in {edge:?}");
    }
}

/// A cross of three rectangles through one axis: six triangles round each edge of it, and no inside.
fn cross() -> Mesh {
    let mut mesh = Mesh { name: "cross".to_owned(), ..Mesh::default() };
    for wing in 0..6 {
        let angle = std::f32::consts::PI * wing as f32 / 3.0;
        let out = Vec3::new(angle.cos(), 0.0, angle.sin());
        let first = mesh.positions.len() as u32;
        mesh.positions.extend([Vec3::ZERO, out, out + Vec3::Y, Vec3::Y]);
        mesh.indices.extend([0, 1, 2, 0, 2, 3].map(|corner| first + corner));
    }
    mesh.smooth_normals();
    mesh
}

fn several() -> [Mesh; 3] {
    [cuboid(), cross(), sphere(7, 4)]
}

#[test]
fn leaves_part_every_coarse_triangle_and_neighbours_differ_by_one_level() {
    gpu_test(|device| {
        for mesh in several() {
            let mut fire = Fire::new(device, Variant::LowPoly, &parameters(), &mesh);
            let mut seen = BTreeSet::new();
            let mut before: Vec<u32> = Vec::new();
            for ticks in [1, 7, 20, 50, 90, 150, 260] {
                fire.burn_to(ticks);
                let levels = fire.leaf_levels();
                check_neighbours(fire.model(), &levels);
                assert!(before.iter().zip(&levels).all(|(b, now)| b <= now), "tick {ticks} has joined triangles");
                seen.extend(levels.iter().copied());
                before = levels;
            }
            assert!((1..=5).all(|level| seen.contains(&level)), "{}: {seen:?}", mesh.name);
        }
    });
}

#[test]
fn without_holes_every_edge_has_two_triangles_at_every_level_of_detail() {
    gpu_test(|device| {
        let levels: [&[u32]; 2] = [&[0, 1, 3, 5], &[2, 4, 5]];
        for (mesh, levels) in [cuboid(), sphere(7, 4)].iter().zip(levels) {
            for &level in levels {
                let slow = Parameters { flammability: 10_000, level_of_detail: Some(level), ..parameters() };
                let mut fire = Fire::new(device, Variant::LowPoly, &slow, mesh);
                for ticks in [1, 20, 60, 120] {
                    fire.burn_to(ticks);
                    let drawn = fire.drawn();
                    assert_eq!(borders(&drawn), [], "tick {ticks} at level {level}");
                    // Flat coarse triangles: whatever divides them keeps their area.
                    let model = fire.model();
                    let area = |t: &[u32; 3]| {
                        let [a, b, c] = t.map(|v| model.rest[v as usize].position.as_dvec3());
                        (b - a).cross(c - a).length()
                    };
                    let total: f64 = drawn.iter().map(area).sum();
                    let expected: f64 = model.triangles.iter().map(area).sum();
                    assert!((total / expected - 1.0).abs() < 1e-5, "{total} for {expected}");
                    let coarse = model.coarse_count() as usize;
                    assert!(drawn.len() >= coarse && drawn.len() <= coarse << (2 * level));
                    if level == 0 {
                        assert_eq!(drawn.len(), coarse);
                    }
                }
            }
        }
    });
}

/// The nodes of `level` that are hidden: two or more of their four children are, and of the finest those that were
/// removed.
fn hidden(removed: &[u32], levels: u32, level: u32) -> Vec<bool> {
    (level..levels).fold(removed.iter().map(|&r| r == 1).collect(), |hidden: Vec<bool>, _| {
        hidden.chunks_exact(4).map(|children| children.iter().filter(|&&h| h).count() >= 2).collect()
    })
}

#[test]
fn only_what_the_fire_has_removed_leaves_borders() {
    gpu_test(|device| {
        for (level, keep_connected) in [(5, false), (5, true), (4, false), (2, true), (0, false)] {
            let parameters = Parameters { level_of_detail: Some(level), keep_connected, ..parameters() };
            let mut fire = Fire::new(device, Variant::LowPoly, &parameters, &cuboid());
            for ticks in [60, 110, 160] {
                fire.burn_to(ticks);
                let removed: Vec<u32> = fire.read(&fire.burning.buffers().removed);
                assert_eq!(removed.iter().sum::<u32>(), fire.counts().removed_triangles);
                let lattice = &fire.model().lattice;
                let gone: Vec<[u32; 3]> = hidden(&removed, 5, level)
                    .iter()
                    .zip(&lattice.nodes[level as usize])
                    .filter(|(hidden, _)| **hidden)
                    .map(|(_, corners)| corners.map(|corner| lattice.welds[corner as usize]))
                    .collect();
                if level > 0 && ticks > 60 {
                    assert!(!gone.is_empty(), "tick {ticks} at level {level}");
                }
                let gone = directed(&gone);
                let drawn = fire.drawn();
                for (a, b) in borders(&drawn) {
                    assert!(gone.contains_key(&(b, a)), "({a}, {b}) at tick {ticks}, level {level}");
                }
                // What is hidden is not drawn.
                assert!(directed(&drawn).keys().all(|edge| !gone.contains_key(edge)), "tick {ticks}, level {level}");
            }
        }
    });
}

/// The simulation works on the finest triangles: where anything is heated, all of them are in use.
#[test]
fn what_burns_is_in_use_and_what_is_not_in_use_rests() {
    gpu_test(|device| {
        for mesh in several() {
            let mut fire = Fire::new(device, Variant::LowPoly, &parameters(), &mesh);
            for ticks in [1, 3, 10, 30, 60, 120, 200] {
                fire.burn_to(ticks);
                let alive: Vec<u32> = fire.read(&fire.burning.buffers().alive);
                let labels: Vec<u32> = fire.read(&fire.burning.buffers().labels);
                let levels = fire.leaf_levels();
                for (triangle, level) in fire.model().triangles.iter().zip(levels) {
                    if triangle.iter().any(|&v| labels[v as usize] >= 2) {
                        assert_eq!(level, 5, "a heated triangle at tick {ticks}");
                        assert!(triangle.iter().all(|&v| alive[v as usize] == 1));
                    }
                }
                let rest = &fire.model().rest;
                for (vertex, state) in fire.state().iter().enumerate().filter(|(v, _)| alive[*v] == 0) {
                    assert_eq!(*state, VertexState { position: rest[vertex].position, left: 20.0 }, "vertex {vertex}");
                }
            }
        }
    });
}

/// Exactly the vertices of leaves and the midpoints on their split edges exist.
#[test]
fn a_vertex_exists_as_soon_as_a_leaf_has_it() {
    gpu_test(|device| {
        let mut fire = Fire::new(device, Variant::LowPoly, &parameters(), &cuboid());
        for ticks in [1, 30, 80] {
            fire.burn_to(ticks);
            let alive: Vec<u32> = fire.read(&fire.burning.buffers().alive);
            let statuses = fire.statuses();
            let lattice = &fire.model().lattice;
            let mut expected = BTreeSet::new();
            for (tree, coarse) in statuses.chunks_exact(tree::nodes_of(5) as usize).zip(0_usize..) {
                for level in 0..=5_u32 {
                    for index in 0..1 << (2 * level) {
                        if tree[tree::nodes_above(level) as usize + index] == 1 {
                            expected.extend(lattice.nodes[level as usize][(coarse << (2 * level)) + index]);
                        }
                    }
                }
            }
            let expected: BTreeSet<u32> = expected.iter().map(|&corner| lattice.welds[corner as usize]).collect();
            let found: BTreeSet<u32> = (0..alive.len() as u32).filter(|&v| alive[v as usize] == 1).collect();
            assert_eq!(found, expected, "tick {ticks}");
        }
    });
}

/// Refinement saves work and changes nothing: the state is that of the fully subdivided object to the bit.
#[test]
fn the_fire_is_that_of_the_fully_subdivided_object() {
    gpu_test(|device| {
        let parameters = Parameters { keep_connected: false, ..parameters() };
        for mesh in several() {
            let mut fires = [Variant::LowPoly, Variant::FullySubdivided].map(|variant| {
                Fire::new(device, variant, &Parameters { levels: Some(5), ..parameters.clone() }, &mesh)
            });
            for ticks in [1, 40, 100, 200] {
                let [low, full] = fires.each_mut().map(|fire| {
                    fire.burn_to(ticks);
                    let buffers = fire.burning.buffers();
                    let counts = fire.counts();
                    (
                        fire.state(),
                        fire.read::<u32>(&buffers.removed),
                        fire.read::<u32>(&buffers.labels),
                        [counts.active_vertices, counts.active_triangles, counts.ready_vertices],
                    )
                });
                assert!(low == full, "tick {ticks} of {}", mesh.name);
                assert!(ticks < 100 || low.1.contains(&1));
            }
        }
    });
}

/// Section 4.4.2: "if this point is in the middle of one of the coarse triangles, the triangle will not be eligible for
/// subdivision until the virtual heat boundary hits one of its vertices. To avoid such issues" there are the
/// barycentric points.
#[test]
fn a_fire_in_the_middle_of_a_coarse_triangle_refines_it() {
    gpu_test(|device| {
        let model = Fire::new(device, Variant::LowPoly, &parameters(), &cuboid()).burning;
        let corners = model.model().lattice.nodes[0][3].map(|corner| model.model().lattice.welds[corner as usize]);
        let places = corners.map(|v| model.model().rest[v as usize].position);
        let middle = places.iter().sum::<Vec3>() / 3.0;
        drop(model);
        let parameters = Parameters { sources: vec![middle], ..parameters() };
        let mut fire = Fire::new(device, Variant::LowPoly, &parameters, &cuboid());
        fire.burn_to(1);
        let labels: Vec<u32> = fire.read(&fire.burning.buffers().labels);
        let levels = fire.leaf_levels();
        assert!(corners.iter().all(|&v| labels[v as usize] == 0));
        assert!(levels[3 << 10..4 << 10].contains(&5));
        // The opposite side of the box is as it was.
        assert!(levels.chunks_exact(1 << 10).any(|coarse| coarse[0] == 0));
    });
}

#[test]
fn a_restart_and_the_other_compiler_repeat_every_tick() {
    gpu_test(|device| {
        let outcome = |fire: &mut Fire| {
            fire.burn_to(70);
            (fire.statuses(), fire.read::<u32>(&fire.burning.buffers().alive), fire.drawn(), fire.state())
        };
        let mut fire = Fire::new(device, Variant::LowPoly, &parameters(), &cuboid());
        let first = outcome(&mut fire);
        fire.burning.restart().unwrap();
        fire.next = 0;
        fire.burn_to(1);
        assert_ne!(fire.statuses(), first.0);
        assert!(outcome(&mut fire) == first);
        let mut naga = Fire::compiled(device, Compiler::Naga, Variant::LowPoly, &parameters(), &cuboid());
        let again = outcome(&mut naga);
        assert!((again.0, again.1, again.2) == (first.0, first.1, first.2));
    });
}

/// Without a word from the user the camera's distance decides (4.5): nearer is finer.
#[test]
fn a_far_camera_draws_fewer_triangles() {
    gpu_test(|device| {
        let counts = [1.5_f32, 4.0, 8.0, 30.0, 90.0].map(|distance| {
            let target = Vec3::new(0.0, 0.29, 0.0);
            let eye = target + Vec3::Z * distance;
            let up = Vec3::Y;
            let camera = Camera { eye, target, up, vertical_fov_rad: 0.6, near_m: 0.1, far_m: 100.0 };
            let parameters = Parameters { level_of_detail: None, camera: Some(camera), ..parameters() };
            let mut fire = Fire::new(device, Variant::LowPoly, &parameters, &cuboid());
            fire.burn_to(60);
            fire.drawn().len()
        });
        assert!(counts.windows(2).all(|c| c[1] < c[0]), "{counts:?}");
        assert!(counts[4] <= 12);
    });
}

/// Fewer levels, and the chapters that borrow the pattern for their larger triangles (5.3.1).
#[test]
fn other_levels_and_variants_are_refined_too() {
    gpu_test(|device| {
        for variant in [Variant::LowPoly, Variant::Solid, Variant::Melting] {
            for levels in [1, 2, 4] {
                let parameters = Parameters { levels: Some(levels), ..parameters() };
                let mut fire = Fire::new(device, variant, &parameters, &cuboid());
                for ticks in [1, 60, 120] {
                    fire.burn_to(ticks);
                    let found = fire.leaf_levels();
                    check_neighbours(fire.model(), &found);
                    if variant != Variant::LowPoly {
                        assert_eq!(borders(&fire.drawn()), [], "{variant:?} tick {ticks}");
                    }
                }
            }
        }
        // Without levels there is nothing to refine.
        let parameters = Parameters { levels: Some(0), ..parameters() };
        let mut fire = Fire::new(device, Variant::LowPoly, &parameters, &cuboid());
        fire.burn_to(30);
        assert_eq!(fire.drawn().len(), 12);
    });
}
