//! The oracle: what each pass computes, in double precision, from the paper's equations.

mod bounds;
pub mod coverage;
pub mod density;
pub mod density_cache;
pub mod froxels;
pub mod grid;
pub mod noise;
pub mod paths;
pub mod phase;
pub mod rays;
pub mod resolve;
pub mod shadow_table;
pub mod texture;
