//! The oracle's own model of the device's object, under the device's numbers.

use std::collections::BTreeSet;

use fumarole::papers::burning::reference::{Constants, Model, Node, Tick, scaled};
use fumarole::papers::burning::{Parameters, Variant};
use fumarole::scene::Mesh;
use glam::DVec3;

use super::fire::Fire;

/// The model that the oracle burns.
pub struct Twin {
    variant: Variant,
    pub model: Model,
    pub constants: Constants,
    /// Finest level that is drawn.
    pub finest: u32,
}

impl Twin {
    /// Makes the model anew from the mesh, and holds every table of the device against it.
    pub fn new(fire: &Fire, variant: Variant, parameters: &Parameters, mesh: &Mesh) -> Self {
        let prepared = fire.paper.model();
        let buffers = fire.paper.buffers();
        // What no triangle uses does not count.
        let used: Vec<u32> = BTreeSet::from_iter(&mesh.indices).into_iter().copied().collect();
        let positions: Vec<DVec3> = used.iter().map(|i| mesh.positions[*i as usize].as_dvec3()).collect();
        let number = |i: u32| used.binary_search(&i).expect("it is used");
        let triangles: Vec<[usize; 3]> =
            mesh.indices.chunks_exact(3).map(|t| [0, 1, 2].map(|k| number(t[k]))).collect();
        let model = Model::new(&scaled(&positions), &triangles, prepared.levels, parameters.blocks.map(|b| b as usize));

        let triangles: Vec<[u32; 3]> = fire.read(&buffers.triangles);
        let corners: Vec<[u32; 3]> = fire.read(&buffers.corners);
        let pairs = |ours: fn(&Node) -> [usize; 3], theirs: &[[u32; 3]]| {
            let ours: Vec<usize> = model.triangles.iter().flat_map(ours).collect();
            numbers(&ours, theirs.as_flattened())
        };
        let mut model = model.renumbered(&pairs(|n| n.vertices, &triangles), &pairs(|n| n.corners, &corners));

        let rest: Vec<[f32; 4]> = fire.read(&buffers.rest);
        assert_eq!(rest.len(), model.rest.len());
        for (place, [x, y, z, _]) in model.rest.iter().zip(&rest) {
            assert!(place.distance(DVec3::new(f64::from(*x), f64::from(*y), f64::from(*z))) < 1e-6);
        }
        let welds: Vec<u32> = fire.read(&buffers.welds);
        assert!(welds.iter().map(|w| *w as usize).eq(model.welds.iter().copied()));
        let lists = |offsets, entries| {
            let (offsets, entries): (Vec<u32>, Vec<u32>) = (fire.read(offsets), fire.read(entries));
            let list = |pair: &[u32]| entries[pair[0] as usize..pair[1] as usize].to_vec();
            offsets.windows(2).map(list).collect::<Vec<_>>()
        };
        let around = lists(&buffers.incidence_offsets, &buffers.incidence);
        let expected = model.incidence.iter().map(|l| l.iter().map(|[t, k]| (4 * t + k) as u32).collect::<Vec<_>>());
        assert!(around.into_iter().eq(expected), "vertices' triangles in ascending order");
        let around = lists(&buffers.corner_incidence_offsets, &buffers.corner_incidence);
        let around = around.iter().map(|l| l.iter().map(|entry| (entry / 4) as usize).collect::<Vec<_>>());
        assert!(around.eq(model.corner_incidence.iter().cloned()), "draw vertices' triangles in ascending order");
        assert!((model.mean_edge - f64::from(prepared.mean_edge)).abs() < 1e-6);
        assert!((model.char_depth - f64::from(prepared.char_depth)).abs() < 1e-6);
        assert!(model.grid.low.distance(prepared.grid.origin.as_dvec3()) < 1e-6);
        assert!(model.grid.size.distance(prepared.grid.cell_size.as_dvec3()) < 1e-6);

        // On a wall, or as near to a block's middle as another, either choice will do: the device's counts.
        let cells: Vec<u32> = fire.read(&buffers.rest_cells);
        for (v, cell) in cells.iter().map(|c| *c as usize).enumerate() {
            assert!(cell == model.rest_cells[v] || model.grid.margin(model.rest[v]) < 1e-6);
            model.rest_cells[v] = cell;
        }
        let base: Vec<u32> = fire.read(&buffers.base_points);
        for (cell, theirs) in base.iter().enumerate() {
            let theirs = (*theirs != u32::MAX).then_some(*theirs as usize);
            let away = |v: usize| model.rest[v].distance(model.grid.midpoint(cell));
            match (model.base_points[cell], theirs) {
                (Some(a), Some(b)) => assert!((away(a) - away(b)).abs() < 1e-6, "block {cell}: {a} {b}"),
                (a, b) => assert_eq!(a, b, "block {cell}"),
            }
            model.base_points[cell] = theirs;
        }

        let height = |y: f64| if variant == Variant::Melting { -y } else { y };
        let sources: Vec<DVec3> = prepared.sources.iter().map(|s| s.as_dvec3()).collect();
        if parameters.sources.is_empty() {
            let lowest = model.rest.iter().map(|p| height(p.y)).fold(f64::INFINITY, f64::min);
            assert!((height(sources[0].y) - lowest).abs() < 1e-6 && sources.len() == 1);
        }
        let floor = parameters.floor.map_or(0.0, f64::from);
        assert!((f64::from(prepared.floor) - floor).abs() < 1e-6);
        let constants = Constants::new(parameters, &model, &sources, floor);
        for (reach, [.., r]) in constants.reaches.iter().zip(&rest) {
            assert!((reach - f64::from(*r)).abs() < 1e-5, "R {r}, expected {reach}");
        }
        let finest = parameters.level_of_detail.expect("tests say it").min(model.levels);
        Twin { variant, model, constants, finest }
    }

    pub fn tick(&self) -> Tick<'_> {
        Tick { variant: self.variant, model: &self.model, constants: &self.constants }
    }
}

/// The number over there of each of ours; one to one.
fn numbers(ours: &[usize], theirs: &[u32]) -> Vec<usize> {
    assert_eq!(ours.len(), theirs.len());
    let count = ours.iter().max().map_or(0, |m| m + 1);
    let mut number = vec![usize::MAX; count];
    for (our, their) in ours.iter().zip(theirs) {
        let their = *their as usize;
        assert!(number[*our] == usize::MAX || number[*our] == their, "the same vertex everywhere");
        number[*our] = their;
    }
    let mut sorted = number.clone();
    sorted.sort_unstable();
    assert!(sorted.into_iter().eq(0..count), "each vertex once");
    number
}
