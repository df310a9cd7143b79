//! Appearance of a set-up: the consequences of its material and its look for each variant.

use glam::Vec3;

use super::parameters::{Heat, Look, Material, Parameters, Shading, SmokeAs, Variant};

impl Parameters {
    /// The material of the surface; a texture has none.
    pub fn material(&self, variant: Variant) -> Option<Material> {
        let own = if variant == Variant::Melting { Material::Wax } else { Material::Wood };
        self.texture.is_none().then(|| self.material.unwrap_or(own))
    }

    /// Linear RGB of the surface, or the factor of its texture.
    pub fn albedo(&self, variant: Variant) -> Vec3 {
        self.albedo.unwrap_or(match self.material(variant) {
            None => Vec3::ONE,
            Some(Material::Plain | Material::Wood) => Vec3::new(0.36, 0.17, 0.07),
            Some(Material::Wax) => Vec3::new(0.8, 0.66, 0.4),
        })
    }

    /// True for a surface that chars and glows: not wax, nor a texture on what melts.
    pub fn chars(&self, variant: Variant) -> bool {
        match self.material(variant) {
            None => variant != Variant::Melting,
            Some(material) => material != Material::Wax,
        }
    }

    /// The way that heat takes.
    pub fn heat(&self) -> Heat {
        self.heat.unwrap_or(match self.look {
            Look::Natural => Heat::Surface,
            Look::Dissertation => Heat::Air,
        })
    }

    /// True where consumed triangles leave the drawn stream: those of solids by the natural look alone.
    pub fn removes(&self, variant: Variant) -> bool {
        let burns_away = self.look == Look::Natural && self.burn_away && variant == Variant::Solid;
        variant.removes() || burns_away
    }

    /// True where parts that nothing holds fall.
    pub fn collapses(&self, variant: Variant) -> bool {
        self.look == Look::Natural && self.collapse && self.removes(variant)
    }

    /// True where what is consumed stays as long as something would come off (3.5.4).
    pub fn keeps_connected(&self, variant: Variant) -> bool {
        self.keep_connected && self.removes(variant) && !self.collapses(variant)
    }

    /// True where what melts gathers in a puddle.
    pub fn has_puddle(&self, variant: Variant) -> bool {
        self.look == Look::Natural && variant == Variant::Melting
    }

    /// True where ash comes down.
    pub fn has_ash(&self, variant: Variant) -> bool {
        self.has_ground() || self.collapses(variant)
    }

    /// True where the picture is made of linear light, which the flames add to.
    pub fn has_linear_light(&self) -> bool {
        self.look == Look::Natural && self.shading == Shading::Lit
    }

    /// True where fire and smoke are drawn into a layer that goes over the picture once.
    pub fn has_fire_layer(&self) -> bool {
        self.has_linear_light() || self.fire_scale > 1
    }

    /// True where smoke is a volume in the light of the flames.
    pub fn has_smoke_volume(&self) -> bool {
        self.has_linear_light() && self.smoke_as == SmokeAs::Volume && self.smoke > 0
    }

    /// True where triangles are drawn in the order that vertex caches like best: objects that are not refined. Of triangles
    /// at one depth another is seen then than in the mesh's own order. The text's baseline of refinement keeps its own, as
    /// what it is held against does.
    pub fn orders_triangles(&self, variant: Variant, is_refined: bool) -> bool {
        !is_refined && (self.look == Look::Natural || variant != Variant::FullySubdivided)
    }

    /// True where the ground is drawn.
    pub fn has_ground(&self) -> bool {
        self.has_linear_light() && self.ground
    }
}
