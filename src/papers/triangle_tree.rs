//! Triangles of meshes in a tree of boxes, on the host and on the device: rays look there for what they meet.

use std::sync::Arc;

use ash::vk;
use glam::Vec3;

use crate::gpu::transfer::upload;
use crate::gpu::{Buffer, Device, Error};
use crate::host_block;
use crate::scene::Mesh;

/// Triangles in a leaf at most.
const LEAF_TRIANGLES: usize = 4;
/// Bits of [`Node::leaf`] that count triangles.
const COUNT_BITS: u32 = 3;
/// Rounding must not let a ray through between two triangles.
const EDGE_SLACK: f32 = 1e-5;

host_block! {
    /// A box of the tree; its children follow it, so that no stack is needed.
    pub struct Node {
        low: [f32; 3],
        skip: u32,
        high: [f32; 3],
        leaf: u32,
    }
}

/// Pieces of one tree at most, by the names that the shaders give them.
const PIECES: [&str; 8] = ["tree_0", "tree_1", "tree_2", "tree_3", "tree_4", "tree_5", "tree_6", "tree_7"];

/// The tree on the device.
pub struct DeviceTree {
    /// Length of the nodes.
    pub node_count: u32,
    /// One list of words in pieces, since a buffer of the device holds too little.
    is_in_pieces: bool,
    /// By the names that the shaders give them: nodes with parents before children, x, y and z of every vertex of every
    /// mesh in metres, and three indices of those a triangle, leaf by leaf; or the pieces of all that.
    buffers: Vec<(&'static str, Arc<Buffer>)>,
}

impl DeviceTree {
    /// `label` goes before the names of the buffers.
    ///
    /// # Errors
    /// Errors of the Vulkan layer; [`Error::Limit`] for more triangles than eight storage buffers hold.
    pub fn new(device: &Arc<Device>, label: &str, tree: &TriangleTree) -> Result<Self, Error> {
        let storage = |name: &str, bytes: &[u8]| {
            upload(device, &format!("{label}/{name}"), vk::BufferUsageFlags::STORAGE_BUFFER, bytes)
        };
        let node_count = tree.nodes.len() as u32;
        let parts: [&[u8]; 3] = [
            bytemuck::cast_slice(&tree.nodes),
            bytemuck::cast_slice(&tree.triangles),
            bytemuck::cast_slice(&tree.corners),
        ];
        let physical = device.physical();
        let limit_bytes = u64::from(physical.limits.max_storage_buffer_range).min(physical.max_buffer_bytes());
        if parts.iter().all(|bytes| bytes.len() as u64 <= limit_bytes) {
            let mut buffers = Vec::with_capacity(parts.len());
            for (name, bytes) in ["nodes", "triangles", "corners"].into_iter().zip(parts) {
                buffers.push((name, storage(&format!("tree-{name}"), bytes)?));
            }
            return Ok(DeviceTree { node_count, is_in_pieces: false, buffers });
        }
        let words_bits = (limit_bytes / 4).max(1).ilog2();
        let header = [node_count, tree.triangles.len() as u32, words_bits];
        let all: Vec<&[u32]> =
            std::iter::once(&header[..]).chain(parts.iter().map(|&bytes| bytemuck::cast_slice(bytes))).collect();
        let total: usize = all.iter().map(|words| words.len()).sum();
        let count = total.div_ceil(1 << words_bits);
        if count > PIECES.len() {
            let (wanted, limit) = (4 * total as u64, (PIECES.len() as u64) << (words_bits + 2));
            let object = format!("{label}/tree");
            return Err(Error::Limit { object, what: "size in bytes of a tree of triangles", wanted, limit });
        }
        let mut pieces = Vec::with_capacity(count);
        for number in 0..count {
            let words = window(&all, number << words_bits, 1 << words_bits);
            pieces.push(storage(&format!("tree-{number}"), bytemuck::cast_slice(&words))?);
        }
        // Every binding has a buffer, whether there is so much or not.
        let piece = |(number, name): (usize, &'static str)| (name, pieces[number.min(count - 1)].clone());
        let buffers = PIECES.into_iter().enumerate().map(piece).collect();
        Ok(DeviceTree { node_count, is_in_pieces: true, buffers })
    }

    /// The buffers by the names that the shaders give them.
    pub fn buffers(&self) -> impl Iterator<Item = (&'static str, &Arc<Buffer>)> {
        self.buffers.iter().map(|(name, buffer)| (*name, buffer))
    }

    /// The variant of a shader that takes the tree as it is.
    pub fn variant(&self, shader: &str) -> String {
        format!("{shader}-{}", if self.is_in_pieces { "pieces" } else { "whole" })
    }
}

/// Words of several lists, one after the other, from one on, and so many at most.
fn window(lists: &[&[u32]], first: usize, most: usize) -> Vec<u32> {
    let mut words = Vec::new();
    let mut before = 0;
    for list in lists {
        let [from, end] = [first, first + most].map(|at| at.saturating_sub(before).min(list.len()));
        words.extend_from_slice(&list[from..end]);
        before += list.len();
    }
    words
}

/// The tree in host memory.
pub struct TriangleTree {
    nodes: Vec<Node>,
    corners: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
}

/// A triangle while the tree is built.
#[derive(Clone, Copy)]
struct Item {
    triangle: [u32; 3],
    low: Vec3,
    high: Vec3,
}

impl Item {
    fn middle(&self) -> Vec3 {
        self.low + self.high
    }
}

impl TriangleTree {
    /// The triangles of all `meshes`, at least one.
    pub fn over<'a>(meshes: impl IntoIterator<Item = &'a Mesh>) -> Self {
        let mut corners: Vec<Vec3> = Vec::new();
        let mut triangles: Vec<[u32; 3]> = Vec::new();
        for mesh in meshes {
            let first = corners.len() as u32;
            corners.extend(&mesh.positions);
            triangles.extend(mesh.indices.chunks_exact(3).map(|t| [t[0] + first, t[1] + first, t[2] + first]));
        }
        TriangleTree::of(corners, &triangles)
    }

    /// Of triangles by their corners, at least one.
    pub fn of(corners: Vec<Vec3>, triangles: &[[u32; 3]]) -> Self {
        let item = |&triangle: &[u32; 3]| {
            let [a, b, c] = triangle.map(|corner| corners[corner as usize]);
            Item { triangle, low: a.min(b).min(c), high: a.max(b).max(c) }
        };
        let mut items: Vec<Item> = triangles.iter().map(item).collect();
        let triangles = Vec::with_capacity(items.len());
        let mut tree = TriangleTree { nodes: Vec::new(), corners, triangles };
        tree.add(&mut items);
        tree
    }

    /// True when a ray of unit direction meets a triangle, on either side; as `first_hit` of `common/triangle-tree.glsl`.
    pub fn is_met(&self, origin: Vec3, direction: Vec3) -> bool {
        self.find(origin, direction, f32::INFINITY, |_| true).is_some()
    }

    /// A triangle that is `wanted` and that the segment meets, and where it does, as a fraction of the segment.
    pub fn met_between(&self, from: Vec3, to: Vec3, wanted: impl Fn(&[u32; 3]) -> bool) -> Option<([u32; 3], f32)> {
        self.find(from, to - from, 1.0, wanted)
    }

    /// A triangle that is `wanted` and that the ray meets after `most` times its direction at the latest.
    fn find(
        &self,
        origin: Vec3,
        direction: Vec3,
        most: f32,
        wanted: impl Fn(&[u32; 3]) -> bool,
    ) -> Option<([u32; 3], f32)> {
        let inverse = Vec3::select(direction.abs().cmplt(Vec3::splat(1e-9)), Vec3::splat(1e-9), direction).recip();
        let mut at = 0;
        while let Some(node) = self.nodes.get(at) {
            let (to_low, to_high) =
                ((Vec3::from_array(node.low) - origin) * inverse, (Vec3::from_array(node.high) - origin) * inverse);
            let entry = to_low.min(to_high).max_element().max(0.0);
            let exit = to_low.max(to_high).min_element().min(most);
            if entry > exit + 1e-5 * exit.abs() {
                at = node.skip as usize;
                continue;
            }
            let (first, count) = ((node.leaf >> COUNT_BITS) as usize, (node.leaf & ((1 << COUNT_BITS) - 1)) as usize);
            let met =
                self.triangles[first..first + count].iter().filter(|triangle| wanted(triangle)).find_map(|triangle| {
                    let t = self.meeting(triangle, origin, direction).filter(|&t| t <= most)?;
                    Some((*triangle, t))
                });
            if met.is_some() {
                return met;
            }
            at += 1;
        }
        None
    }

    /// Ray parameter t of the ray's meeting with the triangle's plane, if that lies within the triangle and ahead.
    fn meeting(&self, triangle: &[u32; 3], origin: Vec3, direction: Vec3) -> Option<f32> {
        let [a, b, c] = triangle.map(|corner| self.corners[corner as usize]);
        let (ab, ac) = (b - a, c - a);
        let across = direction.cross(ac);
        let determinant = ab.dot(across);
        let turned = (origin - a).cross(ab);
        let weight_b = (origin - a).dot(across) / determinant;
        let weight_c = direction.dot(turned) / determinant;
        let t = ac.dot(turned) / determinant;
        let is_met = determinant != 0.0
            && weight_b.min(weight_c) >= -EDGE_SLACK
            && weight_b + weight_c <= 1.0 + EDGE_SLACK
            && t > 0.0;
        is_met.then_some(t)
    }

    /// Adds the node of `items` and all below it: halves along the longest side of the middles' box.
    fn add(&mut self, items: &mut [Item]) {
        let low = items.iter().fold(Vec3::INFINITY, |low, item| low.min(item.low));
        let high = items.iter().fold(Vec3::NEG_INFINITY, |high, item| high.max(item.high));
        let at = self.nodes.len();
        self.nodes.push(Node { low: low.to_array(), skip: 0, high: high.to_array(), leaf: 0 });
        if items.len() <= LEAF_TRIANGLES {
            let first = self.triangles.len() as u32;
            self.nodes[at].leaf = first << COUNT_BITS | items.len() as u32;
            self.triangles.extend(items.iter().map(|item| item.triangle));
        } else {
            let low = items.iter().fold(Vec3::INFINITY, |low, item| low.min(item.middle()));
            let high = items.iter().fold(Vec3::NEG_INFINITY, |high, item| high.max(item.middle()));
            let axis = (high - low).max_position();
            let half = items.len() / 2;
            items.select_nth_unstable_by(half, |a, b| a.middle()[axis].total_cmp(&b.middle()[axis]));
            let (near, far) = items.split_at_mut(half);
            self.add(near);
            self.add(far);
        }
        self.nodes[at].skip = self.nodes.len() as u32;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::random::Random;
    use crate::scene::shapes;

    #[test]
    fn every_triangle_lies_in_one_leaf_and_in_all_boxes_above_it() {
        let mesh = shapes::teapot();
        let triangles: Vec<[u32; 3]> = mesh.indices.chunks_exact(3).map(|t| [t[0], t[1], t[2]]).collect();
        let tree = TriangleTree::over([&mesh]);
        let sorted = |mut list: Vec<[u32; 3]>| {
            list.sort_unstable();
            list
        };
        assert_eq!(sorted(tree.triangles.clone()), sorted(triangles));
        assert_eq!(tree.nodes[0].skip as usize, tree.nodes.len());
        let mut seen = 0;
        for (at, node) in tree.nodes.iter().enumerate() {
            let within = &tree.nodes[at..node.skip as usize];
            for leaf in within.iter().filter(|n| n.leaf > 0) {
                let (first, count) = ((leaf.leaf >> COUNT_BITS) as usize, (leaf.leaf & 7) as usize);
                assert!((1..=LEAF_TRIANGLES).contains(&count));
                seen += if at == 0 { count } else { 0 };
                for &corner in tree.triangles[first..first + count].as_flattened() {
                    let p = mesh.positions[corner as usize];
                    assert!(p.cmpge(Vec3::from(node.low)).all() && p.cmple(Vec3::from(node.high)).all());
                }
            }
        }
        assert_eq!(seen, tree.triangles.len());
    }

    #[test]
    fn a_ray_meets_the_tree_where_it_meets_a_triangle() {
        let mesh = shapes::teapot();
        let tree = TriangleTree::over([&mesh]);
        let bounds = mesh.bounds();
        let mut random = Random::new(5);
        let mut met = 0;
        for _ in 0..2000 {
            let target = bounds.min + bounds.diagonal() * Vec3::new(random.unit(), random.unit(), random.unit());
            let direction = random.direction();
            let origin = target - 20.0 * direction;
            let any = tree.triangles.iter().any(|triangle| tree.meeting(triangle, origin, direction).is_some());
            assert_eq!(tree.is_met(origin, direction), any);
            assert!(!tree.is_met(origin, -direction));
            met += i32::from(any);
        }
        assert!((500..1900).contains(&met), "{met}");
    }
}
