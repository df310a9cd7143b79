//! The paper `caustics` on the device: against its oracle, against closed forms and conservation laws, variant against
//! variant, and its pictures against goldens.

mod culled;
mod drawing;
mod extremes;
mod hit;
mod hit_layers;
mod hit_shapes;
mod laws;
mod level_map;
mod options;
mod oracle;
mod pictures;
mod scene;
mod seen;
mod several;
mod smart;
mod stencil;
mod variants;
mod view;
mod volumes;
mod warnings;
mod water_map;
