//! Choices that parameters name.

use crate::measure::parameter::Choice;

/// The material of the surface, to the eye.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Material {
    /// The albedo alone.
    Plain,
    /// The albedo with the rings of a tree around a vertical axis.
    Wood,
    /// The albedo alone, which neither chars nor glows.
    Wax,
}

impl Choice for Material {
    const ALL: &'static [Material] = &[Material::Plain, Material::Wood, Material::Wax];
    const NAMES: &'static [(&'static str, &'static str)] = &[
        ("plain", "The albedo alone"),
        ("wood", "The albedo with the rings of a tree"),
        ("wax", "The albedo alone, which neither chars nor glows"),
    ];
}

/// Whose pictures are drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Look {
    /// Parts that nothing holds fall, wax gathers in a puddle, flames light what is near, and the ground is drawn.
    Natural,
    /// The text's own, which its experiments measure.
    Dissertation,
}

impl Choice for Look {
    const ALL: &'static [Look] = &[Look::Natural, Look::Dissertation];
    const NAMES: &'static [(&'static str, &'static str)] = &[
        (
            "natural",
            "Parts that nothing holds fall, wax gathers in a puddle, flames light what is near, and the ground is drawn",
        ),
        ("dissertation", "The text alone, which its experiments measure: what burns is gone, and there is no ground"),
    ];
}

/// The way that heat takes from its sources.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Heat {
    /// Straight through the air, as in 3.3.
    Air,
    /// Along the surface, and through the air a third as far.
    Surface,
}

impl Choice for Heat {
    const ALL: &'static [Heat] = &[Heat::Air, Heat::Surface];
    const NAMES: &'static [(&'static str, &'static str)] = &[
        ("air", "Straight through the air, as in 3.3"),
        ("surface", "Along the surface, farther upwards, and through the air a third as far"),
    ];
}

/// The way that smoke is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum SmokeAs {
    /// A square for each particle.
    Particles,
    /// Its density in a grid, which rays march through.
    Volume,
}

impl Choice for SmokeAs {
    const ALL: &'static [SmokeAs] = &[SmokeAs::Particles, SmokeAs::Volume];
    const NAMES: &'static [(&'static str, &'static str)] =
        &[("particles", "A square for each particle"), ("volume", "Its density in a grid, which rays march through")];
}

/// The quantity that colours the mesh.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Shading {
    /// Lit, charred and glowing: the finished picture.
    Lit,
    /// The areas of the heat boundary (figures 3.3, 4.3, 5.3, 5.4).
    Areas,
    /// The blocks (figure 3.5).
    Blocks,
    /// Normals as colours.
    Normals,
    /// Lit, with the edges of the drawn triangles (figures 4.2, 4.4).
    Wire,
}

impl Choice for Shading {
    const ALL: &'static [Shading] = &[Shading::Lit, Shading::Areas, Shading::Blocks, Shading::Normals, Shading::Wire];
    const NAMES: &'static [(&'static str, &'static str)] = &[
        ("lit", "Lit, charred and glowing: the finished picture"),
        ("areas", "The areas of the heat boundary"),
        ("blocks", "The blocks"),
        ("normals", "Normals as colours"),
        ("wire", "Lit, with the edges of the drawn triangles"),
    ];
}
