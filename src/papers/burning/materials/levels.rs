//! The constants on the device: L of each vertex, epsilon of each edge, and beta, rho and phi of each block (table 3.1).

use super::super::model::Model;
use super::super::parameters::{Parameters, Variant};
use super::{Materials, Substance};
use crate::host_block;

host_block! {
    /// Constants of a block (`burning/block-levels.glsl`).
    #[derive(Default)]
    pub struct BlockLevels {
        /// beta.
        pub beta: f32,
        /// rho.
        pub rho: f32,
        /// phi.
        pub phi: f32,
        /// Mean L of its vertices that burn, at least 1.
        pub flammability: f32,
    }
}

/// The lists of an object.
pub struct MaterialLevels {
    /// L of each vertex, 0 for what does not burn; one number where all have the same.
    pub flammabilities: Vec<f32>,
    /// epsilon of the edge after each corner of each finest triangle, the mean of its ends' materials; one number where
    /// all have the same.
    pub meltabilities: Vec<f32>,
    /// Of each block the means over its vertices at rest.
    pub blocks: Vec<BlockLevels>,
    /// 1 for each vertex that keeps its place where others flow; empty where all flow.
    pub holds: Vec<bool>,
}

impl MaterialLevels {
    /// Those of an object of one material, or of the materials of its vertices.
    pub fn new(variant: Variant, parameters: &Parameters, model: &Model) -> Self {
        let of = |substance: &Substance| BlockLevels {
            beta: substance.beta,
            rho: substance.rho,
            phi: substance.phi,
            flammability: (substance.flammability as f32).max(1.0),
        };
        let own = Substance::own(variant, parameters);
        let Some(materials) = &parameters.materials else {
            return MaterialLevels {
                flammabilities: vec![own.flammability as f32],
                meltabilities: vec![own.epsilon],
                blocks: vec![of(&own); model.block_count() as usize],
                holds: Vec::new(),
            };
        };
        let all = Materials::all(materials, variant, parameters);
        let substance = |vertex: u32| &all[model.substances[vertex as usize] as usize];
        let edge = |a: u32, b: u32| 0.5 * (substance(a).epsilon + substance(b).epsilon);
        let edges = model.triangles.iter().flat_map(|&[a, b, c]| [edge(a, b), edge(b, c), edge(c, a)]);
        let each = model.substances.iter().map(|number| &all[*number as usize]);
        MaterialLevels {
            flammabilities: each.clone().map(|substance| substance.flammability as f32).collect(),
            meltabilities: edges.collect(),
            blocks: blocks(model, &all, of(&own)),
            holds: each.map(|substance| !substance.melts).collect(),
        }
    }
}

/// Means of the vertices at rest of each block; `usual` where there is none.
fn blocks(model: &Model, all: &[Substance], usual: BlockLevels) -> Vec<BlockLevels> {
    // Sums of beta, rho, phi and 1, and of L and 1 of what burns.
    let mut sums = vec![[0.0_f64; 6]; model.block_count() as usize];
    for (&cell, &number) in model.rest_cells.iter().zip(&model.substances) {
        let substance = &all[number as usize];
        let burning = f64::from(u8::from(substance.burns()));
        let more = [
            substance.beta.into(),
            substance.rho.into(),
            substance.phi.into(),
            1.0,
            substance.flammability.into(),
            burning,
        ];
        sums[cell as usize].iter_mut().zip(more).for_each(|(sum, more)| *sum += more);
    }
    let mean = |[beta, rho, phi, count, ticks, burning]: [f64; 6]| {
        if count == 0.0 {
            return usual;
        }
        BlockLevels {
            beta: (beta / count) as f32,
            rho: (rho / count) as f32,
            phi: (phi / count) as f32,
            flammability: if burning > 0.0 { (ticks / burning) as f32 } else { 1.0 },
        }
    };
    sums.into_iter().map(mean).collect()
}
