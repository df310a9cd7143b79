//! Choices that parameters name.

use crate::choice;

choice! {
    /// The material of the surface, to the eye.
    pub enum Material {
        /// The albedo alone.
        Plain = ("plain", "The albedo alone"),
        /// The albedo with the rings of a tree around a vertical axis.
        Wood = ("wood", "The albedo with the rings of a tree"),
        /// The albedo alone, which neither chars nor glows.
        Wax = ("wax", "The albedo alone, which neither chars nor glows"),
    }
}

choice! {
    /// Whose pictures are drawn.
    pub enum Look {
        /// Parts that nothing holds fall, wax gathers in a puddle, flames light what is near, and the ground is drawn.
        Natural = (
            "natural",
            "Parts that nothing holds fall, wax gathers in a puddle, flames light what is near, and the ground is drawn",
        ),
        /// The text's own, which its experiments measure.
        Dissertation = (
            "dissertation",
            "The text alone, which its experiments measure: what burns is gone, and there is no ground",
        ),
    }
}

choice! {
    /// The way that heat takes from its sources.
    pub enum Heat {
        /// Straight through the air, as in 3.3.
        Air = ("air", "Straight through the air, as in 3.3"),
        /// Along the surface, and through the air a third as far.
        Surface = ("surface", "Along the surface, farther upwards, and through the air a third as far"),
    }
}

choice! {
    /// The way that smoke is drawn.
    pub enum SmokeAs {
        /// A square for each particle.
        Particles = ("particles", "A square for each particle"),
        /// Its density in a grid, which rays march through.
        Volume = ("volume", "Its density in a grid, which rays march through"),
    }
}

choice! {
    /// The quantity that colours the mesh.
    pub enum Shading {
        /// Lit, charred and glowing: the finished picture.
        Lit = ("lit", "Lit, charred and glowing: the finished picture"),
        /// The areas of the heat boundary (figures 3.3, 4.3, 5.3, 5.4).
        Areas = ("areas", "The areas of the heat boundary"),
        /// The blocks (figure 3.5).
        Blocks = ("blocks", "The blocks"),
        /// Normals as colours.
        Normals = ("normals", "Normals as colours"),
        /// Lit, with the edges of the drawn triangles (figures 4.2, 4.4).
        Wire = ("wire", "Lit, with the edges of the drawn triangles"),
    }
}
