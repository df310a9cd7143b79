//! The receivers' triangles in a tree of boxes: the rays of the finished picture look there for what they hit first.

use std::sync::Arc;

use ash::vk;
use glam::Vec3;

use super::receiver::ReceiverInput;
use super::resources::Context;
use crate::gpu::{Buffer, Error};
use crate::host_block;

/// Triangles in a leaf at most.
const LEAF_TRIANGLES: usize = 4;
/// Bits of [`Node::leaf`] that count triangles.
const COUNT_BITS: u32 = 3;

host_block! {
    /// A box of the tree; its children follow it, so that no stack is needed.
    pub struct Node {
        low: [f32; 3],
        skip: u32,
        high: [f32; 3],
        leaf: u32,
    }
}

/// The tree on the device.
pub struct ReceiverTree {
    /// A [`Node`] each, parents before children.
    pub nodes: Arc<Buffer>,
    /// Length of the nodes.
    pub node_count: u32,
    /// x, y and z of every vertex of every receiver, metres.
    pub corners: Arc<Buffer>,
    /// Three indices of corners a triangle, leaf by leaf.
    pub triangles: Arc<Buffer>,
}

impl ReceiverTree {
    /// # Errors
    /// Errors of the Vulkan layer; [`Error::Limit`] for more triangles than a storage buffer holds.
    pub fn new(context: Context<'_>, receivers: &[ReceiverInput]) -> Result<Self, Error> {
        let mut corners: Vec<Vec3> = Vec::new();
        let mut triangles: Vec<[u32; 3]> = Vec::new();
        for ReceiverInput { mesh, .. } in receivers {
            let first = corners.len() as u32;
            corners.extend(&mesh.positions);
            triangles.extend(mesh.indices.chunks_exact(3).map(|t| [t[0] + first, t[1] + first, t[2] + first]));
        }
        let tree = Tree::over(&corners, &triangles);
        let storage = |name, bytes: &[u8]| context.upload(name, vk::BufferUsageFlags::STORAGE_BUFFER, bytes);
        Ok(ReceiverTree {
            nodes: storage("tree-nodes", bytemuck::cast_slice(&tree.nodes))?,
            node_count: tree.nodes.len() as u32,
            corners: storage("tree-corners", bytemuck::cast_slice(&corners))?,
            triangles: storage("tree-triangles", bytemuck::cast_slice(&tree.triangles))?,
        })
    }
}

/// The tree in host memory.
struct Tree {
    nodes: Vec<Node>,
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

impl Tree {
    fn over(corners: &[Vec3], triangles: &[[u32; 3]]) -> Self {
        let item = |&triangle: &[u32; 3]| {
            let [a, b, c] = triangle.map(|corner| corners[corner as usize]);
            Item { triangle, low: a.min(b).min(c), high: a.max(b).max(c) }
        };
        let mut items: Vec<Item> = triangles.iter().map(item).collect();
        let mut tree = Tree { nodes: Vec::new(), triangles: Vec::with_capacity(items.len()) };
        tree.add(&mut items);
        tree
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
    use crate::scene::shapes;

    #[test]
    fn every_triangle_lies_in_one_leaf_and_in_all_boxes_above_it() {
        let mesh = shapes::teapot();
        let triangles: Vec<[u32; 3]> = mesh.indices.chunks_exact(3).map(|t| [t[0], t[1], t[2]]).collect();
        let tree = Tree::over(&mesh.positions, &triangles);
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
}
