//! Lights and waters that methods are tried under.

use glam::Vec3;

use super::super::super::named_mesh::NamedMesh;
use super::super::super::setup::Setup;
use super::super::Context;
use crate::scene::Light;

/// A light and a water.
#[derive(Clone)]
pub struct Case {
    /// Name in tables, such as `steep`.
    pub name: &'static str,
    change: fn(&mut Setup),
    /// Parameters that it sets: where one of them is given, the case is left out.
    sets: &'static [&'static str],
}

impl Case {
    /// The user's set-up, with that mesh and the case's own light or water.
    pub fn setup(&self, context: &Context<'_>, mesh: &NamedMesh) -> Setup {
        let mut setup = Setup { meshes: vec![mesh.source.clone()], ..context.setup.clone() };
        (self.change)(&mut setup);
        setup
    }
}

const OBLIQUE: Light = Light::Parallel { direction: Vec3::new(0.6, -1.0, -0.35), intensity: Vec3::ONE };
const POINT: Light = Light::Point { position: Vec3::new(1.0, 2.5, -0.6), intensity: Vec3::ONE };
/// Amplitude of the waves of root mean square slope 0.34, metres.
const STEEP_M: f32 = 0.21;
/// Absorption of murky water, per metre.
const MURKY: f32 = 1.0;

const LIGHTS: &[&str] = &["light", "point-light"];
const WATER: &[&str] = &["amplitude", "waves", "wavelength", "water-map"];

/// The user's set-up as it is, then the other cases that set no parameter which the user has set.
pub fn cases(context: &Context<'_>) -> Vec<Case> {
    let all = [
        Case { name: "as set", change: |_| (), sets: &[] },
        Case { name: "steep", change: |setup| setup.parameters.waves.amplitude_m = STEEP_M, sets: WATER },
        Case { name: "oblique", change: |setup| setup.parameters.lights = vec![OBLIQUE], sets: LIGHTS },
        Case { name: "point", change: |setup| setup.parameters.lights = vec![POINT], sets: LIGHTS },
        Case { name: "two lights", change: |setup| setup.parameters.lights.push(OBLIQUE), sets: LIGHTS },
        Case { name: "murky", change: |setup| setup.parameters.absorption_per_m = MURKY, sets: &["absorption"] },
    ];
    all.into_iter().filter(|case| !case.sets.iter().any(|name| context.given.has(name))).collect()
}
