//! The axes of `stress`.

use super::setup::Setup;
use crate::measure::stress::{Amount, Axis, scaled};

/// First frame that is measured: the boundary has grown for a second.
const GROWN: u32 = 60;
/// Diagonals that it has grown by then: some of the object is burnt, some burns, some does not yet.
const REACHED: f32 = 0.35;

/// Sets the object alight where its first frame is that of the start, at which nothing burns.
fn alight(setup: &mut Setup) {
    let parameters = &mut setup.parameters;
    if parameters.first_frame == 0 {
        (parameters.first_frame, parameters.speed_per_s) = (GROWN, REACHED);
    }
}

/// The default first.
pub fn all() -> Vec<Axis<Setup>> {
    vec![
        Axis::new("triangles", 4_000, |setup: &mut Setup, triangles| {
            setup.triangles = u32::try_from(triangles).ok();
            alight(setup);
            Ok(())
        })
        .help("Triangles of the mesh, whose longest edges are split")
        .most(4_000_000)
        .sets("triangles")
        .amount(Amount::Counted("triangles")),
        Axis::new("active-share", 1, |setup: &mut Setup, percent| {
            let parameters = &mut setup.parameters;
            // What the boundary has reached burns on, so that only its reach counts.
            parameters.flammability = 1_000_000;
            (parameters.first_frame, parameters.time_step_s) = (GROWN, 1.0 / 60.0);
            parameters.speed_per_s = percent as f32 / 100.0;
            Ok(())
        })
        .help("Hundredths of the object's diagonal that the heat boundary has reached; all behind it burns")
        .unit("hundredths")
        .most(128)
        .amount(Amount::Found("active_vertices", "active vertices")),
        Axis::new("particles", 1_000, |setup: &mut Setup, particles| {
            (setup.parameters.fire, setup.parameters.smoke) = (particles as u32, particles as u32);
            alight(setup);
            Ok(())
        })
        .help("Most particles of the fire, and as many of the smoke")
        .most(1_000_000),
        Axis::new("blocks", 8, |setup: &mut Setup, blocks| {
            setup.parameters.blocks = scaled(setup.parameters.blocks, blocks).map(|side| side.min(256));
            alight(setup);
            Ok(())
        })
        .help("Blocks that hold the object together")
        .most(1 << 20)
        .sets("blocks")
        .amount(Amount::Rounded(|setup| setup.parameters.blocks.iter().map(|&side| f64::from(side)).product())),
    ]
}
