//! Sections of the object, by their distance from its foot along the surface: what bends is a chain of them. Ours.
//!
//! A section is what hangs together of the vertices between two distances: a ring of a leg or of a neck, the whole of a
//! trunk. Where two meet is a joint, which is as long as the line around it.

use std::cmp::Reverse;
use std::collections::{BTreeMap, BinaryHeap, VecDeque};

use glam::{DVec3, Vec3};

use crate::host_block;

host_block! {
    /// `burning/sections.glsl`
    pub struct Section {
        /// Mean place of its vertices at rest.
        pub place: Vec3,
        /// First of its joints in the list of neighbours; the next section's is the end.
        pub first: u32,
    }
}

host_block! {
    /// `burning/sections.glsl`
    pub struct Joint {
        /// Middle of the line around it at rest.
        pub place: Vec3,
        /// Length of that line, in [`LENGTH_UNIT`]s.
        pub units: u32,
        /// The sections that meet.
        pub ends: [u32; 2],
        _pad: [u32; 2],
    }
}

host_block! {
    /// A triangle, or a pair of vertices that touch, at which two sections meet (`burning/sections.glsl`).
    pub struct Cut {
        /// First corner.
        pub a: u32,
        /// Second corner.
        pub b: u32,
        /// Third corner, of a pair the second.
        pub c: u32,
        /// Its number, [`super::NO_VERTEX`] of a pair.
        pub triangle: u32,
        /// The joint that it is part of.
        pub joint: u32,
        /// Length of the joint's line through it, in [`LENGTH_UNIT`]s.
        pub units: u32,
    }
}

host_block! {
    /// The sections that a vertex goes with (`burning/sections.glsl`).
    pub struct Hold {
        /// Its own in the low 16 bits, and the nearest other in the high ones.
        pub sections: u32,
        /// Share of the other, at most a half.
        pub share: f32,
    }
}

impl Joint {
    /// Of no sections: stands in for an empty list.
    pub fn none() -> Self {
        Joint { place: Vec3::ZERO, units: 0, ends: [0; 2], _pad: [0; 2] }
    }
}

/// Sections, and joints, at most.
pub const MOST_SECTIONS: usize = 512;
const MOST_JOINTS: usize = 1024;
/// Joints of a section at most: a thread visits them in every round of a search.
const MOST_AROUND: usize = 128;
/// Rounds of the search from the ground on (`burning/bending.comp`): what is deeper counts as held from two sides.
const ROUNDS: usize = 128;
/// Length of a section from the side of its foot to the other, diagonals; at least [`EDGES`] mean edges.
const WIDTH: f64 = 0.04;
const EDGES: f64 = 1.5;
/// Of the lengths of joints, diagonals.
pub const LENGTH_UNIT: f64 = 1.0 / 65536.0;
/// Height over the lowest vertex up to which a vertex is of the foot, diagonals.
const FOOT: f32 = 0.01;

/// The sections with their joints.
pub struct Sections {
    /// From the foot's side of a section to the other, diagonals.
    pub width: f64,
    /// The sections, and an end.
    pub sections: Vec<Section>,
    /// The joints.
    pub joints: Vec<Joint>,
    /// Joints of each section, one list after the other.
    pub around: Vec<u32>,
    /// Cuts that the joints consist of.
    pub cuts: Vec<Cut>,
    /// Of each vertex.
    pub holds: Vec<Hold>,
}

impl Sections {
    /// Divides an object. `touching` are pairs of vertices of separate parts that hold each other.
    pub fn new(positions: &[Vec3], triangles: &[[u32; 3]], touching: &[[u32; 2]], mean_edge: f32) -> Self {
        let beside = neighbours(positions.len(), triangles, touching);
        let distances = distances(positions, &beside);
        let mut width = WIDTH.max(EDGES * f64::from(mean_edge));
        loop {
            let divided = Self::of_width(width, (positions, triangles, touching), &beside, &distances);
            let most = divided.sections.windows(2).map(|pair| (pair[1].first - pair[0].first) as usize).max();
            let is_small = divided.sections.len() <= MOST_SECTIONS + 1
                && divided.joints.len() <= MOST_JOINTS
                && most.unwrap_or(0) <= MOST_AROUND
                && divided.depth(&distances) < ROUNDS;
            // Beyond every distance there is one section for each part of the mesh, and there are no joints.
            if is_small {
                return divided;
            }
            if width > 1e3 {
                return Self::whole(positions, width);
            }
            width *= 1.5;
        }
    }

    /// Joints between the ground and the section that is the most of them away from it. A piece without a foot, which may come
    /// to lie on the ground, counts from where it is lowest.
    fn depth(&self, distances: &[f64]) -> usize {
        let mut is_found = vec![false; self.sections.len() - 1];
        let mut open = VecDeque::new();
        for (hold, _) in self.holds.iter().zip(distances).filter(|(_, distance)| **distance == 0.0) {
            let section = (hold.sections & 0xffff) as usize;
            if !is_found[section] {
                is_found[section] = true;
                open.push_back((section, 0));
            }
        }
        let mut deepest = 0;
        while let Some((at, depth)) = open.pop_front() {
            deepest = depth;
            let joints = self.sections[at].first as usize..self.sections[at + 1].first as usize;
            for &joint in &self.around[joints] {
                let [a, b] = self.joints[joint as usize].ends.map(|end| end as usize);
                let other = if a == at { b } else { a };
                if !is_found[other] {
                    is_found[other] = true;
                    open.push_back((other, depth + 1));
                }
            }
        }
        deepest
    }

    /// One section, of a mesh in more parts than there may be sections: nothing bends.
    fn whole(positions: &[Vec3], width: f64) -> Self {
        let place = positions.iter().sum::<Vec3>() / positions.len().max(1) as f32;
        let sections = vec![Section { place, first: 0 }, Section { place: Vec3::ZERO, first: 0 }];
        let holds = vec![Hold { sections: 0, share: 0.0 }; positions.len()];
        Sections { width, sections, joints: Vec::new(), around: Vec::new(), cuts: Vec::new(), holds }
    }

    fn of_width(
        width: f64,
        (positions, triangles, touching): (&[Vec3], &[[u32; 3]], &[[u32; 2]]),
        beside: &[Vec<u32>],
        distances: &[f64],
    ) -> Self {
        let bands: Vec<i64> = distances.iter().map(|distance| (distance / width) as i64).collect();
        let (of_vertex, count) = pieces(beside, &bands);
        let mut lines: BTreeMap<[u32; 2], (f64, DVec3)> = BTreeMap::new();
        let mut cuts: Vec<([u32; 2], [u32; 3], u32, f64)> = Vec::new();
        let mut cut = |[a, b]: [u32; 2], vertices: [u32; 3], triangle: u32, length: f64, middle: DVec3| {
            let ends = [a.min(b), a.max(b)];
            let line = lines.entry(ends).or_default();
            line.0 += length;
            line.1 += length * middle;
            cuts.push((ends, vertices, triangle, length));
        };
        let place = |vertex: u32| positions[vertex as usize].as_dvec3();
        for (number, triangle) in (0..).zip(triangles) {
            let [a, b, c] = triangle.map(|vertex| of_vertex[vertex as usize]);
            let places = triangle.map(place);
            let middle = |i: usize, j: usize| (places[i] + places[j]) / 2.0;
            if a != b && b != c && c != a {
                let centroid = (places[0] + places[1] + places[2]) / 3.0;
                for (i, j, ends) in [(0, 1, [a, b]), (1, 2, [b, c]), (2, 0, [c, a])] {
                    let to = middle(i, j);
                    cut(ends, *triangle, number, to.distance(centroid), (to + centroid) / 2.0);
                }
            } else if a != b || b != c {
                // The corner that is alone.
                let alone = if b == c { 0 } else { 1 + usize::from(a != c) };
                let [next, last] = [(alone + 1) % 3, (alone + 2) % 3];
                let [from, to] = [middle(alone, next), middle(alone, last)];
                let ends = [[a, b, c][alone], [a, b, c][next]];
                cut(ends, *triangle, number, from.distance(to), (from + to) / 2.0);
            }
        }
        for &[a, b] in touching {
            let ends = [a, b].map(|vertex| of_vertex[vertex as usize]);
            if ends[0] != ends[1] {
                let middle = (place(a) + place(b)) / 2.0;
                cut(ends, [a, b, b], super::NO_VERTEX, place(a).distance(place(b)).max(LENGTH_UNIT), middle);
            }
        }
        let numbers: BTreeMap<[u32; 2], u32> = lines.keys().copied().zip(0..).collect();
        let whole = |length: f64| ((length / LENGTH_UNIT).round() as u32).max(1);
        let cuts: Vec<Cut> = cuts
            .into_iter()
            .map(|(ends, [a, b, c], triangle, length)| Cut {
                a,
                b,
                c,
                triangle,
                joint: numbers[&ends],
                units: whole(length),
            })
            .collect();
        let mut lengths = vec![0; lines.len()];
        cuts.iter().for_each(|cut| lengths[cut.joint as usize] += cut.units);
        let joints: Vec<Joint> = lines
            .iter()
            .zip(&lengths)
            .map(|((&ends, &(length, sum)), &whole)| {
                let place = (sum / length.max(f64::MIN_POSITIVE)).as_vec3();
                Joint { place, units: whole, ends, _pad: [0; 2] }
            })
            .collect();
        let (sections, around) = sections(positions, &of_vertex, count, &joints);
        let holds = holds(beside, &of_vertex, &bands, &distances.iter().map(|d| d / width).collect::<Vec<_>>());
        Sections { width, sections, joints, around, cuts, holds }
    }
}

/// Vertices beside each, along the triangles' edges and where parts touch.
fn neighbours(count: usize, triangles: &[[u32; 3]], touching: &[[u32; 2]]) -> Vec<Vec<u32>> {
    let mut beside = vec![Vec::new(); count];
    let edges = triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
    for [a, b] in edges.chain(touching.iter().copied()) {
        beside[a as usize].push(b);
        beside[b as usize].push(a);
    }
    for list in &mut beside {
        list.sort_unstable();
        list.dedup();
    }
    beside
}

/// Distance of each vertex from the foot along edges (Dijkstra 1959); what hangs together with no foot has its own where it
/// is lowest.
fn distances(positions: &[Vec3], beside: &[Vec<u32>]) -> Vec<f64> {
    let lowest = positions.iter().map(|place| place.y).fold(f32::INFINITY, f32::min);
    let mut order: Vec<u32> = (0..positions.len() as u32).collect();
    order.sort_by(|a, b| positions[*a as usize].y.total_cmp(&positions[*b as usize].y).then(a.cmp(b)));
    let mut distances = vec![f64::INFINITY; positions.len()];
    let mut open = BinaryHeap::new();
    for &start in &order {
        let is_foot = positions[start as usize].y <= lowest + FOOT;
        if distances[start as usize].is_finite() {
            continue;
        }
        if is_foot {
            distances[start as usize] = 0.0;
            open.push(Reverse((0.0_f64.to_bits(), start)));
            continue;
        }
        spread(positions, beside, &mut distances, &mut open);
        if distances[start as usize].is_infinite() {
            distances[start as usize] = 0.0;
            open.push(Reverse((0.0_f64.to_bits(), start)));
        }
    }
    spread(positions, beside, &mut distances, &mut open);
    distances
}

/// Until nothing is open. Bits of numbers that are not negative are in their order.
fn spread(positions: &[Vec3], beside: &[Vec<u32>], distances: &mut [f64], open: &mut BinaryHeap<Reverse<(u64, u32)>>) {
    while let Some(Reverse((bits, at))) = open.pop() {
        let distance = f64::from_bits(bits);
        if distance > distances[at as usize] {
            continue;
        }
        for &next in &beside[at as usize] {
            let edge = positions[at as usize].as_dvec3().distance(positions[next as usize].as_dvec3());
            if distance + edge < distances[next as usize] {
                distances[next as usize] = distance + edge;
                open.push(Reverse(((distance + edge).to_bits(), next)));
            }
        }
    }
}

/// The piece that each vertex is of: what hangs together within a band. In the order of their first vertices.
fn pieces(beside: &[Vec<u32>], bands: &[i64]) -> (Vec<u32>, u32) {
    let mut of_vertex = vec![u32::MAX; bands.len()];
    let mut count = 0;
    for first in 0..bands.len() {
        if of_vertex[first] != u32::MAX {
            continue;
        }
        let mut open = vec![first];
        of_vertex[first] = count;
        while let Some(at) = open.pop() {
            for next in beside[at].iter().map(|next| *next as usize) {
                if of_vertex[next] == u32::MAX && bands[next] == bands[first] {
                    of_vertex[next] = count;
                    open.push(next);
                }
            }
        }
        count += 1;
    }
    (of_vertex, count)
}

/// The sections with the lists of their joints.
fn sections(positions: &[Vec3], of_vertex: &[u32], count: u32, joints: &[Joint]) -> (Vec<Section>, Vec<u32>) {
    let mut sums = vec![(DVec3::ZERO, 0.0); count as usize];
    for (&section, place) in of_vertex.iter().zip(positions) {
        let sum = &mut sums[section as usize];
        sum.0 += place.as_dvec3();
        sum.1 += 1.0;
    }
    let mut lists = vec![Vec::new(); count as usize];
    for (number, joint) in (0..).zip(joints) {
        joint.ends.iter().for_each(|&end| lists[end as usize].push(number));
    }
    let mut first = 0;
    let mut sections: Vec<Section> = Vec::with_capacity(sums.len() + 1);
    for (&(sum, weight), list) in sums.iter().zip(&lists) {
        sections.push(Section { place: (sum / weight).as_vec3(), first });
        first += list.len() as u32;
    }
    sections.push(Section { place: Vec3::ZERO, first });
    (sections, lists.concat())
}

/// Each vertex goes with its section, and the less so the nearer it is to the next one, half and half where they meet.
fn holds(beside: &[Vec<u32>], of_vertex: &[u32], bands: &[i64], steps: &[f64]) -> Vec<Hold> {
    let [below, above] = [-1, 1].map(|side| nearest(beside, of_vertex, bands, side));
    let hold = |vertex: usize| {
        let own = of_vertex[vertex];
        let within = steps[vertex] - bands[vertex] as f64;
        let (other, share) = if within < 0.5 { (below[vertex], 0.5 - within) } else { (above[vertex], within - 0.5) };
        let (other, share) = if other == u32::MAX { (own, 0.0) } else { (other, share.clamp(0.0, 0.5) as f32) };
        // Where there are too many the division is done again, wider.
        Hold { sections: (own & 0xffff) | (other << 16), share }
    };
    (0..of_vertex.len()).map(hold).collect()
}

/// For each vertex the section above or below its own that is the fewest edges away, within its own; `u32::MAX` without any.
fn nearest(beside: &[Vec<u32>], of_vertex: &[u32], bands: &[i64], side: i64) -> Vec<u32> {
    let mut labels = vec![u32::MAX; of_vertex.len()];
    let mut open = VecDeque::new();
    for vertex in 0..of_vertex.len() {
        let next = beside[vertex].iter().find(|next| (bands[**next as usize] - bands[vertex]).signum() == side);
        if let Some(&next) = next {
            labels[vertex] = of_vertex[next as usize];
            open.push_back(vertex);
        }
    }
    while let Some(at) = open.pop_front() {
        for next in beside[at].iter().map(|next| *next as usize) {
            if labels[next] == u32::MAX && of_vertex[next] == of_vertex[at] {
                labels[next] = labels[at];
                open.push_back(next);
            }
        }
    }
    labels
}

#[cfg(test)]
mod tests {
    use glam::Mat4;

    use super::super::{Welded, with_triangles};
    use super::*;
    use crate::scene::shapes;

    /// A post of 0.2 x 1 x 0.2.
    fn post() -> (Vec<Vec3>, Vec<[u32; 3]>) {
        let mesh = shapes::cuboid().transformed(&Mat4::from_scale(Vec3::new(0.1, 0.5, 0.1)));
        let mesh = with_triangles(&mesh, 4000);
        let welded = Welded::new(&mesh);
        let triangles = welded.triangles.iter().map(|t| t.map(|corner| welded.welds[corner as usize])).collect();
        let mut positions = vec![Vec3::ZERO; welded.vertex_count as usize];
        for (&vertex, &place) in welded.welds.iter().zip(&mesh.positions) {
            positions[vertex as usize] = place;
        }
        (positions, triangles)
    }

    #[test]
    fn a_post_is_a_chain_of_rings() {
        let (positions, triangles) = post();
        let divided = Sections::new(&positions, &triangles, &[], 0.02);
        let count = divided.sections.len() - 1;
        assert!((20..32).contains(&count), "{count}");
        // Of rings and of the top; corners of bands may be pieces of their own, which their rings lack.
        let lengths: Vec<f64> = divided.joints.iter().map(|joint| f64::from(joint.units) * LENGTH_UNIT).collect();
        let around: Vec<f64> = lengths.iter().copied().filter(|length| *length > 0.4).collect();
        assert!(around.len() >= 20, "{lengths:?}");
        assert!(around.iter().all(|length| (0.6..1.4).contains(length)), "{lengths:?}");
        for cut in &divided.cuts {
            let joint = &divided.joints[cut.joint as usize];
            let own = [cut.a, cut.b, cut.c].map(|vertex| divided.holds[vertex as usize].sections & 0xffff);
            assert!(joint.ends.iter().all(|end| own.contains(end)), "{own:?} {:?}", joint.ends);
        }
        assert!(divided.holds.iter().all(|hold| (0.0..=0.5).contains(&hold.share)));
    }

    #[test]
    fn a_long_chain_is_no_deeper_than_a_search_goes() {
        // A band of 500 rows of two vertices: 250 sections of the least width.
        let row = |i: u32| [0.0, 0.02].map(|x| Vec3::new(x, 0.02 * i as f32, 0.0));
        let positions: Vec<Vec3> = (0..500).flat_map(row).collect();
        let square = |i: u32| [[2 * i, 2 * i + 1, 2 * i + 2], [2 * i + 2, 2 * i + 1, 2 * i + 3]];
        let triangles: Vec<[u32; 3]> = (0..499).flat_map(square).collect();
        let divided = Sections::new(&positions, &triangles, &[], 0.02);
        let count = divided.sections.len() - 1;
        assert_eq!(divided.joints.len(), count - 1);
        assert!(count > ROUNDS / 2 && count <= ROUNDS, "{count}");
    }
}
