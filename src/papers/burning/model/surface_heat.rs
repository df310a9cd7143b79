//! Heat that climbs along the surface: the way of the fire from its sources, in position of 3.3's straight line. Ours.
//!
//! A way over the triangles counts by its length, of which a part that rises counts less: flames reach farther up than
//! to the sides, and lean with the wind. Through the air heat comes from any vertex to any other at three times the
//! length, so that fire leaps to a separate part, or over a gap, only where the surface leads far around.

use std::cmp::Reverse;
use std::collections::{BinaryHeap, HashMap};

use glam::{DVec3, Vec3};
use rayon::slice::ParallelSliceMut;

use super::Incidence;
use crate::scene::Bounds;

/// Length of a way through the air, over that of one on the surface which takes the heat as long.
pub const THROUGH_AIR: f64 = 3.0;

/// Share of a way by which another one is to be shorter: rounding ends no search.
const SHORTER: f64 = 1e-9;
/// Times that a place is found nearer before that share doubles with every further one: around long, thin triangles distances may
/// come down by less and less, millions of times.
const TIMES: u32 = 8;

/// Speed at which flames rise (`burning/flames.comp`), diagonals a second.
const RISE_PER_S: f64 = 0.17;

/// The lean of flames in a wind, diagonals a second: straight up without any, `climb` long where they rise as ever.
pub fn lean(climb: f32, wind: Vec3) -> DVec3 {
    f64::from(climb) * (DVec3::Y + wind.as_dvec3() / RISE_PER_S)
}

/// Voxels along the longest side of the box around the object, through which heat comes in the air.
const VOXELS: f64 = 32.0;

/// The air around the vertices, in voxels.
struct Air {
    low: DVec3,
    voxel: f64,
    counts: [i32; 3],
    /// The vertices in each voxel.
    inside: Incidence,
}

impl Air {
    fn new(positions: &[Vec3]) -> Self {
        let bounds = Bounds::of_points(positions.iter().copied());
        let low = bounds.min.as_dvec3();
        let size = bounds.max.as_dvec3() - low;
        let voxel = size.max_element().max(f64::MIN_POSITIVE) / VOXELS;
        let counts = size.to_array().map(|side| ((side / voxel).ceil() as i32).clamp(1, VOXELS as i32));
        let mut air = Air { low, voxel, counts, inside: Incidence { offsets: Vec::new(), entries: Vec::new() } };
        let voxels: Vec<u32> = positions.iter().map(|place| air.voxel_of(place.as_dvec3()) as u32).collect();
        let mut offsets = vec![0; 1 + counts.iter().product::<i32>() as usize];
        voxels.iter().for_each(|&voxel| offsets[voxel as usize + 1] += 1);
        for voxel in 1..offsets.len() {
            offsets[voxel] += offsets[voxel - 1];
        }
        let mut entries: Vec<u32> = (0..positions.len() as u32).collect();
        entries.sort_by_key(|vertex| voxels[*vertex as usize]);
        air.inside = Incidence { offsets, entries };
        air
    }

    fn count(&self) -> usize {
        self.inside.offsets.len() - 1
    }

    fn number(&self, [x, y, z]: [i32; 3]) -> usize {
        ((z * self.counts[1] + y) * self.counts[0] + x) as usize
    }

    fn voxel_of(&self, place: DVec3) -> usize {
        let at = ((place - self.low) / self.voxel).to_array();
        self.number([0, 1, 2].map(|axis| (at[axis] as i32).clamp(0, self.counts[axis] - 1)))
    }

    fn steps(&self, voxel: usize) -> [i32; 3] {
        let [x, y, _] = self.counts;
        let voxel = voxel as i32;
        [voxel % x, voxel / x % y, voxel / (x * y)]
    }

    fn middle(&self, voxel: usize) -> DVec3 {
        self.low + self.voxel * (DVec3::from(self.steps(voxel).map(f64::from)) + 0.5)
    }

    /// The voxels around one.
    fn around(&self, voxel: usize) -> impl Iterator<Item = usize> + '_ {
        let own = self.steps(voxel);
        let near = (0..27).map(move |i| [own[0] + i % 3 - 1, own[1] + i / 3 % 3 - 1, own[2] + i / 9 - 1]);
        let is_inside = |at: &[i32; 3]| (0..3).all(|axis| (0..self.counts[axis]).contains(&at[axis]));
        near.filter(is_inside).map(|at| self.number(at)).filter(move |other| *other != voxel)
    }
}

/// Length of the fire's way to each vertex, diagonals; what comes along `lean` counts 1 / (1 + its length) of its own.
///
/// Heat passes between the vertices of each pair of `touching`, of separate parts, too.
pub fn distances(
    (positions, triangles): (&[Vec3], &[[u32; 3]]),
    touching: &[[u32; 2]],
    sources: &[Vec3],
    lean: DVec3,
) -> Vec<f64> {
    let place = |vertex: usize| positions[vertex].as_dvec3();
    let straight = |vertex: usize, source: &Vec3| length(source.as_dvec3(), place(vertex), lean);
    let vertices = 0..positions.len();
    let by_air = |vertex: usize| {
        sources.iter().map(|source| THROUGH_AIR * straight(vertex, source)).fold(f64::INFINITY, f64::min)
    };
    let mut distances: Vec<f64> = vertices.clone().map(by_air).collect();
    // The fire is lit where the surface is nearest to a source.
    for source in sources {
        if let Some(nearest) = vertices.clone().min_by(|a, b| straight(*a, source).total_cmp(&straight(*b, source))) {
            distances[nearest] = distances[nearest].min(straight(nearest, source));
        }
    }
    let incidence = Incidence::new(positions.len(), triangles);
    let mut beside: HashMap<usize, Vec<usize>> = HashMap::new();
    for [a, b] in touching.iter().map(|pair| pair.map(|vertex| vertex as usize)) {
        beside.entry(a).or_default().push(b);
        beside.entry(b).or_default().push(a);
    }
    // Behind the vertices come the voxels, each with the vertex that its heat comes from in a straight line.
    let air = Air::new(positions);
    let mut in_air = vec![(f64::INFINITY, 0); air.count()];
    // Ways are not negative, so that their bits are in their order. Those that all vertices begin with are sorted once: the heap
    // holds what is found on the way alone.
    let mut begun: Vec<(u64, usize)> = vertices.map(|vertex| (distances[vertex].to_bits(), vertex)).collect();
    begun.par_sort_unstable();
    let mut begun = begun.into_iter().peekable();
    let mut open: BinaryHeap<Reverse<(u64, usize)>> = BinaryHeap::new();
    let mut next = |open: &mut BinaryHeap<Reverse<(u64, usize)>>| match (open.peek(), begun.peek()) {
        (Some(Reverse(found)), Some(first)) if first < found => begun.next(),
        (None, _) => begun.next(),
        _ => open.pop().map(|Reverse(found)| found),
    };
    let mut times = vec![0; positions.len() + air.count()];
    // What is already as near as the place that a way goes on from is not asked for: that way is no shorter.
    let mut reached: Vec<(usize, f64)> = Vec::new();
    while let Some((bits, node)) = next(&mut open) {
        let from = match node.checked_sub(positions.len()) {
            None if f64::from_bits(bits) > distances[node] => continue,
            None => {
                along_surface(node, &distances, (positions, triangles), &incidence, lean, &mut reached);
                let over = beside.get(&node).into_iter().flatten();
                reached.extend(over.map(|&to| (to, distances[node] + length(place(node), place(to), lean))));
                (node, vec![air.voxel_of(place(node))])
            }
            Some(voxel) if f64::from_bits(bits) > in_air[voxel].0 => continue,
            Some(voxel) => {
                let from = in_air[voxel].1;
                let through = |to: DVec3| distances[from] + THROUGH_AIR * length(place(from), to, lean);
                let inside = air.inside.of(voxel as u32).iter().map(|to| *to as usize);
                let farther = inside.filter(|&to| distances[to] > distances[from]);
                reached.extend(farther.map(|to| (to, through(place(to)))));
                (from, air.around(voxel).collect())
            }
        };
        let (from, voxels) = from;
        for voxel in voxels {
            if in_air[voxel].0 <= distances[from] {
                continue;
            }
            let distance = distances[from] + THROUGH_AIR * length(place(from), air.middle(voxel), lean);
            if is_shorter(distance, in_air[voxel].0, &mut times[positions.len() + voxel]) {
                in_air[voxel] = (distance, from);
                open.push(Reverse((distance.to_bits(), positions.len() + voxel)));
            }
        }
        for (to, distance) in reached.drain(..) {
            if is_shorter(distance, distances[to], &mut times[to]) {
                distances[to] = distance;
                open.push(Reverse((distance.to_bits(), to)));
            }
        }
    }
    distances
}

/// True of a way that is worth going on from; counts it for the place.
fn is_shorter(distance: f64, known: f64, times: &mut u32) -> bool {
    if distance >= known {
        return false;
    }
    let share = SHORTER * f64::from(times.saturating_sub(TIMES).min(60)).exp2();
    let is = distance < (1.0 - share) * known;
    *times += u32::from(is);
    is
}

/// Adds the corners of a vertex's triangles that the way over it may be the shortest to, each with its distance.
fn along_surface(
    vertex: usize,
    distances: &[f64],
    (positions, triangles): (&[Vec3], &[[u32; 3]]),
    incidence: &Incidence,
    lean: DVec3,
    reached: &mut Vec<(usize, f64)>,
) {
    let place = |vertex: usize| positions[vertex].as_dvec3();
    for entry in incidence.of(vertex as u32) {
        let corners = triangles[(entry / 4) as usize].map(|corner| corner as usize);
        let [first, second] = [1, 2].map(|step| corners[(*entry as usize % 4 + step) % 3]);
        for (to, other) in [(first, second), (second, first)] {
            let ends = [vertex, other];
            let known = ends.map(|end| distances[end]);
            // What is over an edge is no nearer than the nearer of its ends.
            if distances[to] > known[0].min(known[1]) {
                reached.push((to, across(ends.map(place), known, place(to), lean)));
            }
        }
    }
}

/// Of a straight way, as heat takes it.
fn length(from: DVec3, to: DVec3, lean: DVec3) -> f64 {
    let way = to - from;
    let length = way.length();
    if length == 0.0 { 0.0 } else { length / (1.0 + lean.dot(way).max(0.0) / length) }
}

/// Of the way to a corner of a triangle over the opposite edge, along which distances are linear: the least of those through
/// some of its places, and through the one that a plane front would come from.
fn across(ends: [DVec3; 2], distances: [f64; 2], to: DVec3, lean: DVec3) -> f64 {
    let edge = ends[1] - ends[0];
    let edge_length = edge.length();
    let by =
        |share: f64| distances[0] + share * (distances[1] - distances[0]) + length(ends[0] + share * edge, to, lean);
    // By quarters too: where distances that rise are shorter, no formula has the least.
    let least = [0.0, 0.25, 0.5, 0.75].map(by).into_iter().fold(f64::INFINITY, f64::min);
    let slope = (distances[1] - distances[0]) / edge_length;
    if !slope.is_finite() || slope.abs() >= 1.0 {
        return least;
    }
    let along = (to - ends[0]).dot(edge) / edge_length;
    let height = ((to - ends[0]).length_squared() - along * along).max(0.0).sqrt();
    let share = (along - height * slope / (1.0 - slope * slope).sqrt()) / edge_length;
    if (0.0..=1.0).contains(&share) { least.min(by(share)) } else { least }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::papers::burning::model::with_triangles;
    use crate::scene::{Mesh, shapes};

    /// A square of `side` x `side` places in the plane of x and y, 1 wide.
    fn sheet(side: u32) -> (Vec<Vec3>, Vec<[u32; 3]>) {
        let at = |i: u32| i as f32 / (side - 1) as f32;
        let positions = (0..side * side).map(|i| Vec3::new(at(i % side), at(i / side), 0.0)).collect();
        let squares = (0..(side - 1) * (side - 1)).map(|i| i / (side - 1) * side + i % (side - 1));
        let triangles = squares.flat_map(|a| [[a, a + 1, a + side], [a + 1, a + side + 1, a + side]]).collect();
        (positions, triangles)
    }

    #[test]
    fn what_comes_down_by_less_and_less_ends() {
        for by in [1e-6, 1e-8] {
            let (mut known, mut times) = (1.0, 0);
            while is_shorter((1.0 - by) * known, known, &mut times) {
                known *= 1.0 - by;
                assert!(times < 100, "{by}");
            }
            assert!(times > TIMES && !is_shorter(f64::INFINITY, known, &mut times));
        }
        assert!(is_shorter(1.0, f64::INFINITY, &mut 0));
    }

    #[test]
    fn on_a_sheet_the_way_is_straight() {
        let (positions, triangles) = sheet(41);
        let source = Vec3::new(0.5, 0.5, 0.0);
        let distances = distances((&positions, &triangles), &[], &[source], DVec3::ZERO);
        for (distance, place) in distances.iter().zip(&positions) {
            let straight = f64::from(place.distance(source));
            assert!(
                *distance >= 0.999 * straight && *distance < straight + 1.1 / 40.0,
                "{place}: {distance}, {straight}"
            );
        }
    }

    #[test]
    fn it_climbs() {
        let (positions, triangles) = sheet(41);
        let distances = distances((&positions, &triangles), &[], &[Vec3::new(0.5, 0.5, 0.0)], lean(1.0, Vec3::ZERO));
        let at = |x: usize, y: usize| distances[41 * y + x];
        let [up, down, slanting] = [at(20, 40), at(20, 0), at(40, 40)];
        assert!((up - 0.25).abs() < 1e-6 && (down - 0.5).abs() < 1e-6, "{up} {down}");
        let straight = 0.5_f64.sqrt() / (1.0 + 0.5_f64.sqrt());
        assert!(slanting > 0.999 * straight && slanting < straight + 1.5 / 40.0, "{slanting} {straight}");
    }

    #[test]
    fn the_wind_leans_it() {
        let (positions, triangles) = sheet(41);
        let source = Vec3::new(0.5, 0.5, 0.0);
        let distances = distances((&positions, &triangles), &[], &[source], lean(1.0, Vec3::new(0.34, -0.17, 0.0)));
        let at = |x: usize, y: usize| distances[41 * y + x];
        // The flames lie twice as long as they were, to the right.
        let [right, left, up] = [at(40, 20), at(0, 20), at(20, 40)];
        assert!((right - 0.5 / 3.0).abs() < 1e-6 && (left - 0.5).abs() < 1e-6, "{right} {left}");
        assert!(up < 0.5 && up > 0.3, "{up}: aside and back");
    }

    #[test]
    fn around_a_ball_it_is_an_arc() {
        let Mesh { positions, indices, .. } = with_triangles(&shapes::sphere(48, 48), 8000);
        let welded = super::super::Welded::new(&Mesh { positions, indices, ..Mesh::default() });
        let triangles: Vec<[u32; 3]> =
            welded.triangles.iter().map(|t| t.map(|corner| welded.welds[corner as usize])).collect();
        let mut positions = vec![Vec3::ZERO; welded.vertex_count as usize];
        for (corner, &vertex) in welded.welds.iter().enumerate() {
            positions[vertex as usize] = welded.positions[corner];
        }
        let radius = f64::from(positions[0].distance(positions.iter().sum::<Vec3>() / positions.len() as f32));
        let middle = positions.iter().map(|p| p.as_dvec3()).sum::<DVec3>() / positions.len() as f64;
        let source = positions[0];
        let to = |p: Vec3| (p.as_dvec3() - middle).normalize();
        let distances = distances((&positions, &triangles), &[], &[source], DVec3::ZERO);
        for (distance, place) in distances.iter().zip(&positions) {
            let arc = radius * to(*place).angle_between(to(source));
            assert!((distance - arc).abs() < 0.03 * arc + 0.02 * radius, "{place}: {distance}, {arc}");
        }
    }

    #[test]
    fn it_leaps_over_gaps_that_the_surface_leads_far_around() {
        // Two sheets that do not touch, 0.1 apart.
        let (near, triangles) = sheet(21);
        let count = near.len() as u32;
        let positions: Vec<Vec3> = near.iter().copied().chain(near.iter().map(|p| *p + 0.1 * Vec3::Z)).collect();
        let other = triangles.iter().map(|t| t.map(|vertex| vertex + count));
        let triangles: Vec<[u32; 3]> = triangles.iter().copied().chain(other).collect();
        let touching = distances((&positions, &triangles), &[[20, count + 20]], &[Vec3::ZERO], DVec3::ZERO);
        assert!(
            (touching[count as usize + 20] - 1.1).abs() < 1e-6,
            "from part to part: {}",
            touching[count as usize + 20]
        );
        let distances = distances((&positions, &triangles), &[], &[Vec3::ZERO], DVec3::ZERO);
        assert!((distances[count as usize] - 0.3).abs() < 1e-6, "through the air: {}", distances[count as usize]);
        // At the best angle, whose sine is a third, or nearly so.
        let aside = distances[count as usize + 20];
        assert!(aside > 1.28 && aside < 1.31, "along the surface and then through the air: {aside}");
        for (distance, place) in distances.iter().zip(&positions) {
            let straight = f64::from(place.length());
            assert!(*distance >= 0.999 * straight && *distance <= THROUGH_AIR * straight + 1e-6, "{place}: {distance}");
        }
    }

    #[test]
    fn it_goes_on_from_part_to_part() {
        // In a row, 0.1 apart.
        let (near, triangles) = sheet(21);
        let count = near.len() as u32;
        let row = (0..3).flat_map(|part| near.iter().map(move |p| *p + 1.1 * part as f32 * Vec3::X));
        let positions: Vec<Vec3> = row.collect();
        let triangles: Vec<[u32; 3]> =
            (0..3).flat_map(|part| triangles.iter().map(move |t| t.map(|vertex| vertex + part * count))).collect();
        let distances = distances((&positions, &triangles), &[], &[Vec3::ZERO], DVec3::ZERO);
        let last = distances[2 * count as usize + 20];
        // A voxel is as wide as a gap here, and all that is in it has its heat from one vertex, aside of the straight way.
        assert!(last > 3.59 && last < 1.07 * 3.6, "three sheets and two gaps: {last}");
    }
}
