//! The object, prepared on the host and uploaded once (3.7.4).

mod blocks;
mod boundary;
mod chunks;
mod count;
mod division;
mod draw_order;
mod incidence;
mod lattice;
mod sections;
mod surface_heat;
mod touching;
pub mod tree;
mod weld;

use glam::Vec3;

use super::buffers::RestVertex;
use super::materials::{conduct, stronger};
use super::parameters::{Heat, Parameters, Variant};
use crate::gpu::Error;
use crate::scene::{Bounds, Mesh};

pub use self::blocks::Grid;
pub use self::chunks::{CHUNK, Chunks};
pub use self::count::with_triangles;
pub use self::division::Division;
pub use self::draw_order::draw_order;
pub use self::incidence::Incidence;
pub use self::lattice::Lattice;
pub use self::sections::{Cut, Hold, Joint, LENGTH_UNIT, MOST_SECTIONS, Section, Sections};
pub use self::touching::roots_of;
pub use self::weld::Welded;

/// The object at rest. A vertex is a simulated one, welded; a draw vertex one of the mesh as loaded.
pub struct Model {
    /// Subdivisions of each coarse triangle.
    pub levels: u32,
    /// All nodes of all levels.
    pub lattice: Lattice,
    /// Every vertex at rest.
    pub rest: Vec<RestVertex>,
    /// The material of each vertex, or empty where there is one alone.
    pub substances: Vec<u32>,
    /// Vertices of the finest triangles.
    pub triangles: Vec<[u32; 3]>,
    /// Finest triangles of each vertex.
    pub incidence: Incidence,
    /// Finest triangles of each draw vertex.
    pub corner_incidence: Incidence,
    /// Of the object at rest.
    pub bounds: Bounds,
    /// The blocks of 3.5.1.
    pub grid: Grid,
    /// The block of each vertex at rest.
    pub rest_cells: Vec<u32>,
    /// For each block the vertex at rest nearest to its middle, [`NO_VERTEX`] without any: a base point of 6.3.4.
    pub base_points: Vec<u32>,
    /// Mean length of the finest triangles' edges at rest.
    pub mean_edge: f32,
    /// Places of ignition.
    pub sources: Vec<Vec3>,
    /// Height of the ground, which nothing melts below.
    pub floor: f32,
    /// 1 where the triangles wind so that their normals point out of the enclosed volume, or else -1.
    pub outward: f32,
    /// Farthest that a vertex of a solid comes from its position at rest: [`CHAR_FRACTION`] of its volume over its
    /// surface, a quarter of a ball's radius.
    pub char_depth: f32,
    /// Pairs of vertices at which separate parts of the mesh touch and hold each other.
    pub touching: Vec<[u32; 2]>,
    /// Of an object in which what hangs by little bends.
    pub sections: Option<Sections>,
    /// Each edge of the mesh has two triangles, which run along it in opposite directions.
    pub is_closed: bool,
    /// It is closed, and each of its parts winds outwards: what faces away from a viewer outside is hidden.
    pub hides_inside: bool,
    /// Triangles of the mesh that were left out because two of their corners coincide.
    pub degenerate: u32,
}

/// Stands for no vertex in a list of vertices.
pub const NO_VERTEX: u32 = u32::MAX;

/// Triangles around a vertex at most: a thread visits each up to five times, and lavapipe ends the loops of a shader after
/// 65,535 iterations.
const MOST_AROUND: u32 = 8192;

/// Vertices of an object whose parts fall, at most: to number the parts each of 256 threads walks twice over its share
/// of them, 32,000 vertices, and the loops of a shader have 65,535 iterations all together, as above.
const MOST_NUMBERED: u64 = 256 * 32_000;

/// Fraction of volume over surface: with more, crumpled sides of a box that burns one after the other were seen to pass
/// each other.
pub const CHAR_FRACTION: f64 = 0.75;

impl Model {
    /// Prepares a mesh for a variant. `largest_bytes` is the device's longest storage buffer.
    ///
    /// # Errors
    /// [`Error::Limit`] for more triangles than that holds, or vertices than parts have; [`Error::Pass`] for too many
    /// around one vertex.
    pub fn new(mesh: &Mesh, variant: Variant, parameters: &Parameters, largest_bytes: u64) -> Result<Self, Error> {
        // Three 32-bit indices a triangle are the longest list; an incidence holds a triangle's number times 4.
        let limit = (largest_bytes / 12).min(1 << 30);
        // Before the work, and again once the levels are known.
        let check = |count: usize, levels: u32| {
            let wanted = (count as u64) << (2 * levels);
            let object = match levels {
                0 => format!("the mesh of {count} triangles, which `triangles` simplifies"),
                levels => format!("`levels` {levels} of {count} triangles"),
            };
            let error = Error::Limit { object, what: "number of triangles", wanted, limit };
            if wanted > limit { Err(error) } else { Ok(()) }
        };
        check(mesh.triangle_count(), parameters.levels.or(variant.own_levels()).unwrap_or(0))?;
        let division = Division::new(mesh, variant, parameters);
        let materials = parameters.materials.as_deref();
        let of_mesh = materials.map_or_else(Vec::new, |materials| division.with_new(&materials.of_vertex));
        let Division { welded, levels, .. } = division;
        let (degenerate, is_closed) = (welded.degenerate, welded.is_closed());
        check(welded.triangles.len(), levels)?;
        let lattice = Lattice::new(welded, &of_mesh, levels);
        let triangles: Vec<[u32; 3]> =
            lattice.finest().iter().map(|t| t.map(|corner| lattice.welds[corner as usize])).collect();
        let positions = &lattice.positions;
        if parameters.collapses(variant) {
            check_numbered(positions.len() as u64)?;
        }
        let incidence = Incidence::new(positions.len(), &triangles);
        if let Some((vertex, wanted)) = incidence.largest().filter(|&(_, triangles)| triangles > MOST_AROUND) {
            let [x, y, z] = positions[vertex as usize].to_array();
            let problem = format!(
                "{wanted} triangles of the `mesh` meet at {x},{y},{z} of the scaled object, and a thread visits \
                 {MOST_AROUND} at most; cut the fan into rings"
            );
            return Err(Error::Pass { pass: "internal-deformation".into(), problem });
        }
        let bounds = Bounds::of_points(positions.iter().copied());
        let grid = Grid::new(&bounds, parameters.blocks);
        let sources = match &parameters.sources[..] {
            [] => vec![ignition(positions, variant)],
            given => given.to_vec(),
        };
        let seed = parameters.noise_seed();
        let mean_edge = mean_edge(positions, &triangles);
        let touching = touching::touching(positions, &triangles, mean_edge);
        let squared_distances: Vec<f64> = match parameters.heat() {
            Heat::Air => positions.iter().map(|&position| boundary::straight(position, &sources)).collect(),
            Heat::Surface => {
                let lean = surface_heat::lean(parameters.climb, parameters.wind);
                let heated = surface_heat::distances((positions, &triangles), &touching, &sources, lean);
                heated.into_iter().map(|distance| distance * distance).collect()
            }
        };
        let reached = positions.iter().zip(squared_distances);
        let mut distances: Vec<f32> =
            reached.map(|(&p, squared)| boundary::distance(p, squared, parameters.psi, seed) as f32).collect();
        let mut substances = Vec::new();
        if let Some(materials) = materials {
            let all = materials.all(variant, parameters);
            substances = substances_of(&lattice, |a, b| stronger(&all, a, b));
            conduct(positions, &triangles, &all, &substances, parameters.psi.sqrt(), &mut distances);
        }
        let rest = positions.iter().zip(distances);
        let rest = rest.map(|(&position, boundary_distance)| RestVertex { position, boundary_distance }).collect();
        let rest_cells: Vec<u32> = positions.iter().map(|&p| grid.cell(p)).collect();
        let volume = enclosed_volume(positions, &triangles);
        let outward = if volume < 0.0 { -1.0 } else { 1.0 };
        let hides_inside = is_closed
            && volumes_of_parts(positions, &triangles).iter().all(|volume| volume * f64::from(outward) >= 0.0);
        let bends = parameters.collapses(variant) && parameters.bending > 0.0;
        let sections = bends.then(|| Sections::new(positions, &triangles, &touching, mean_edge));
        Ok(Model {
            touching,
            sections,
            levels,
            rest,
            substances,
            incidence,
            corner_incidence: Incidence::new(lattice.welds.len(), lattice.finest()),
            base_points: base_points(&grid, positions, &rest_cells),
            mean_edge,
            outward,
            char_depth: (CHAR_FRACTION * volume.abs() / surface(positions, &triangles)) as f32,
            floor: parameters.floor.unwrap_or(bounds.min.y),
            bounds,
            grid,
            rest_cells,
            triangles,
            sources,
            is_closed,
            hides_inside,
            degenerate,
            lattice,
        })
    }

    /// Simulated vertices.
    pub fn vertex_count(&self) -> u32 {
        self.rest.len() as u32
    }

    /// Vertices of the mesh as it is drawn.
    pub fn draw_vertex_count(&self) -> u32 {
        self.lattice.welds.len() as u32
    }

    /// Finest triangles.
    pub fn triangle_count(&self) -> u32 {
        self.triangles.len() as u32
    }

    /// A third of the area of each vertex's triangles at rest, square diagonals.
    pub fn vertex_areas(&self) -> Vec<f64> {
        let mut areas = vec![0.0; self.rest.len()];
        for triangle in &self.triangles {
            let [a, b, c] = triangle.map(|vertex| self.rest[vertex as usize].position.as_dvec3());
            let area = (b - a).cross(c - a).length() / 6.0;
            triangle.iter().for_each(|&vertex| areas[vertex as usize] += area);
        }
        areas
    }

    /// Of a vertex.
    pub fn mean_vertex_area(&self) -> f64 {
        self.vertex_areas().iter().sum::<f64>() / self.rest.len().max(1) as f64
    }

    /// Blocks of the grid.
    pub fn block_count(&self) -> u32 {
        self.grid.cell_count()
    }

    /// Triangles of the mesh before they are divided.
    pub fn coarse_count(&self) -> u32 {
        self.lattice.nodes[0].len() as u32
    }
}

impl Variant {
    /// Low-poly models divide to five levels (4.4), and shells are dense enough; others follow the mesh.
    pub fn own_levels(self) -> Option<u32> {
        match self {
            Variant::Shell => Some(0),
            Variant::LowPoly | Variant::FullySubdivided => Some(5),
            Variant::Solid | Variant::Melting => None,
        }
    }
}

/// Refuses more vertices than the search for parts may walk over.
fn check_numbered(wanted: u64) -> Result<(), Error> {
    let object =
        "parts that fall, by `collapse`, of the mesh, which `triangles` simplifies and `levels` divides".to_owned();
    let error = Error::Limit { object, what: "number of vertices", wanted, limit: MOST_NUMBERED };
    if wanted > MOST_NUMBERED { Err(error) } else { Ok(()) }
}

/// The lowest vertex, and the highest of what melts: it is to run down. Of several the first.
fn ignition(positions: &[Vec3], variant: Variant) -> Vec3 {
    let height = |p: &&Vec3| if variant == Variant::Melting { -p.y } else { p.y };
    positions.iter().min_by(|a, b| height(a).total_cmp(&height(b))).copied().unwrap_or_default()
}

fn mean_edge(positions: &[Vec3], triangles: &[[u32; 3]]) -> f32 {
    let position = |vertex: u32| positions[vertex as usize].as_dvec3();
    let around = |&[a, b, c]: &[u32; 3]| {
        position(a).distance(position(b)) + position(b).distance(position(c)) + position(c).distance(position(a))
    };
    (triangles.iter().map(around).sum::<f64>() / (3.0 * triangles.len().max(1) as f64)) as f32
}

/// The materials of the simulated vertices: of those of the draw vertices at each, what `chosen` takes of two.
fn substances_of(lattice: &Lattice, chosen: impl Fn(u32, u32) -> u32) -> Vec<u32> {
    let mut substances: Vec<Option<u32>> = vec![None; lattice.positions.len()];
    for (&vertex, &substance) in lattice.welds.iter().zip(&lattice.substances) {
        let own = &mut substances[vertex as usize];
        *own = Some(own.map_or(substance, |own| chosen(own, substance)));
    }
    substances.into_iter().map(Option::unwrap_or_default).collect()
}

/// Signed: by the tetrahedra that the triangles make with the origin.
fn enclosed_volume(positions: &[Vec3], triangles: &[[u32; 3]]) -> f64 {
    let position = |vertex: u32| positions[vertex as usize].as_dvec3();
    triangles.iter().map(|&[a, b, c]| position(a).dot(position(b).cross(position(c))) / 6.0).sum()
}

/// Signed, of each part that hangs together, at its lowest vertex; 0 elsewhere.
fn volumes_of_parts(positions: &[Vec3], triangles: &[[u32; 3]]) -> Vec<f64> {
    let roots = touching::roots_of(positions.len(), triangles);
    let mut volumes = vec![0.0; positions.len()];
    for triangle in triangles {
        volumes[roots[triangle[0] as usize] as usize] += enclosed_volume(positions, &[*triangle]);
    }
    volumes
}

fn surface(positions: &[Vec3], triangles: &[[u32; 3]]) -> f64 {
    let position = |vertex: u32| positions[vertex as usize].as_dvec3();
    let area = |&[a, b, c]: &[u32; 3]| (position(b) - position(a)).cross(position(c) - position(a)).length() / 2.0;
    triangles.iter().map(area).sum::<f64>().max(f64::MIN_POSITIVE)
}

fn base_points(grid: &Grid, positions: &[Vec3], rest_cells: &[u32]) -> Vec<u32> {
    let mut nearest = vec![(f32::INFINITY, NO_VERTEX); grid.cell_count() as usize];
    for ((vertex, &position), &cell) in (0..).zip(positions).zip(rest_cells) {
        let distance = position.distance_squared(grid.midpoint(cell));
        let best = &mut nearest[cell as usize];
        if distance < best.0 {
            *best = (distance, vertex);
        }
    }
    nearest.into_iter().map(|(_, vertex)| vertex).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two walks and the sum over the workgroup stay below what lavapipe grants.
    #[test]
    fn parts_of_too_many_vertices_are_refused_in_one_line() {
        const { assert!(2 * (MOST_NUMBERED / 256) + 8 < 65_535) };
        assert!(check_numbered(MOST_NUMBERED).is_ok());
        let line = check_numbered(MOST_NUMBERED + 1).unwrap_err().to_string();
        assert!(line.contains("number of vertices") && line.contains("`triangles`") && !line.contains('\n'), "{line}");
    }
}
