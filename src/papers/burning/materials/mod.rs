//! Table 3.1's constants at their levels, of an object of several materials: wood beside metal.

mod appearances;
mod conduction;
mod file;
mod levels;

use glam::Vec3;
use serde::Deserialize;
use serde_json::{Value, json};

pub use self::appearances::{Appearance, Appearances};
pub use self::conduction::conduct;
pub use self::file::load;
pub use self::levels::{BlockLevels, MaterialLevels};
use super::parameters::{Material, Parameters, Variant};

/// Materials whose constants are known.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Kind {
    /// Burns slowly and chars.
    Wood,
    /// Burns fast and chars.
    Paper,
    /// Melts, and neither chars nor glows.
    Wax,
    /// Melts and chars.
    Plastic,
    /// Does not burn; it glows, and heat runs ahead in it.
    Metal,
}

/// A material with its constants of table 3.1.
#[derive(Debug, Clone, PartialEq)]
pub struct Substance {
    /// Without, the object's own, whose constants are options.
    pub kind: Option<Kind>,
    /// L, ticks of combustion; 0 for what does not burn.
    pub flammability: u32,
    /// epsilon.
    pub epsilon: f32,
    /// beta.
    pub beta: f32,
    /// rho.
    pub rho: f32,
    /// phi.
    pub phi: f32,
    /// Distance that heat spreads in it along its edges, as a multiple of that through the air; at least 1.
    pub conductivity: f32,
    /// Linear RGB.
    pub albedo: Vec3,
    /// Its pattern, and whether it chars.
    pub surface: Material,
    /// In `melting` it flows; else it keeps its place.
    pub melts: bool,
}

impl Substance {
    /// The constants of a kind.
    pub fn of(kind: Kind) -> Self {
        let wood = Substance {
            kind: Some(kind),
            flammability: 60,
            epsilon: 0.1,
            beta: 0.05,
            rho: 0.5,
            phi: 0.5,
            conductivity: 1.0,
            albedo: Vec3::new(0.36, 0.17, 0.07),
            surface: Material::Wood,
            melts: false,
        };
        match kind {
            Kind::Wood => wood,
            Kind::Paper => Substance {
                flammability: 15,
                beta: 0.3,
                rho: 0.2,
                phi: 0.8,
                albedo: Vec3::new(0.75, 0.72, 0.64),
                surface: Material::Plain,
                ..wood
            },
            Kind::Wax => Substance {
                flammability: 90,
                epsilon: 0.4,
                rho: 0.3,
                phi: 0.3,
                albedo: Vec3::new(0.8, 0.66, 0.4),
                surface: Material::Wax,
                melts: true,
                ..wood
            },
            Kind::Plastic => Substance {
                flammability: 80,
                epsilon: 0.3,
                beta: 0.15,
                rho: 0.4,
                phi: 0.3,
                albedo: Vec3::new(0.1, 0.25, 0.5),
                surface: Material::Plain,
                melts: true,
                ..wood
            },
            Kind::Metal => Substance {
                flammability: 0,
                epsilon: 0.01,
                rho: 0.9,
                phi: 0.9,
                conductivity: 3.0,
                albedo: Vec3::new(0.4, 0.41, 0.43),
                surface: Material::Plain,
                ..wood
            },
        }
    }

    /// The substance that the options give to the whole object.
    pub fn own(variant: Variant, parameters: &Parameters) -> Self {
        Substance {
            kind: None,
            flammability: parameters.flammability,
            epsilon: parameters.epsilon,
            beta: parameters.beta,
            rho: parameters.rho,
            phi: parameters.phi,
            conductivity: 1.0,
            albedo: parameters.albedo(variant),
            surface: parameters.material(variant).unwrap_or(Material::Plain),
            melts: true,
        }
    }

    /// True for what burns away.
    pub fn burns(&self) -> bool {
        self.flammability > 0
    }

    /// Its constants, for the record.
    pub fn json(&self) -> Value {
        let kind = self.kind.map_or("own", |kind| match kind {
            Kind::Wood => "wood",
            Kind::Paper => "paper",
            Kind::Wax => "wax",
            Kind::Plastic => "plastic",
            Kind::Metal => "metal",
        });
        json!({
            "kind": kind,
            "flammability": self.flammability,
            "epsilon": self.epsilon,
            "beta": self.beta,
            "rho": self.rho,
            "phi": self.phi,
            "conductivity": self.conductivity,
            "albedo": self.albedo.to_array(),
        })
    }
}

/// The material of each vertex of a mesh.
#[derive(Debug, Clone, PartialEq)]
pub struct Materials {
    /// All but the object's own, which has number 0; the first has number 1.
    pub substances: Vec<Substance>,
    /// The number of the material of each vertex of the mesh.
    pub of_vertex: Vec<u32>,
    /// SHA-256 of the file.
    pub sha256: String,
}

impl Materials {
    /// The object's own material, and then the others.
    pub fn all(&self, variant: Variant, parameters: &Parameters) -> Vec<Substance> {
        std::iter::once(Substance::own(variant, parameters)).chain(self.substances.iter().cloned()).collect()
    }
}

/// Of the materials that meet at a vertex the one that it is of: what does not burn keeps its shape, and of others the
/// first.
pub fn stronger(substances: &[Substance], a: u32, b: u32) -> u32 {
    let rank = |number: u32| (substances[number as usize].burns(), number);
    if rank(a) <= rank(b) { a } else { b }
}
