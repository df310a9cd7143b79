//! Appendix B: normals of the drawn vertices, and what heat does to their colour.

use glam::DVec3;

use super::{State, Tick};

impl Tick<'_> {
    /// Pass `normals`: unit normals by area over the triangles that are left (all if none is). A vertex that refinement
    /// has not made is not shaded.
    pub fn shade(&self, state: &mut State) {
        let radius = self.radius(state.growth_ticks);
        for (c, &v) in self.model.welds.iter().enumerate() {
            if !state.alive[v] {
                (state.normals[c], state.chars[c], state.glows[c]) = (DVec3::Y, 0.0, 0.0);
                continue;
            }
            let sum = self.normal_sum(state, c);
            state.normals[c] = if sum == DVec3::ZERO { DVec3::Y } else { sum.normalize() };
            let reach = self.constants.reaches[v];
            state.chars[c] = self.char(radius, reach);
            state.glows[c] = self.glow(radius, reach);
        }
    }

    /// Twice the directed area of the triangles at a drawn vertex.
    pub fn normal_sum(&self, state: &State, corner: usize) -> DVec3 {
        let triangles = &self.model.corner_incidence[corner];
        let are_all_gone = triangles.iter().all(|t| state.removed[*t]);
        let left = triangles.iter().filter(|t| are_all_gone || !state.removed[**t]);
        left.map(|t| {
            let [a, b, c] = self.model.triangles[*t].vertices.map(|v| state.mapped[v]);
            (b - a).cross(c - a)
        })
        .sum()
    }

    /// 0 at the initial boundary, 1 at the deformed one.
    fn char(&self, radius: f64, reach: f64) -> f64 {
        ((radius - reach) / (2.0 * self.constants.width)).clamp(0.0, 1.0)
    }

    /// 1 at the combustion-ready edge, 0 from half a width away on.
    fn glow(&self, radius: f64, reach: f64) -> f64 {
        let away = (reach - (radius - self.constants.width)).abs();
        (1.0 - away / (self.constants.width / 2.0)).max(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::super::Variant;
    use super::super::fixtures::Scene;
    use super::*;

    #[test]
    fn a_spheres_normals_point_away_from_its_middle() {
        let scene = Scene::sphere(Variant::Shell);
        let tick = scene.tick();
        let mut state = State::at_rest(&tick);
        tick.shade(&mut state);
        let middle = DVec3::Y * scene.model.rest.iter().map(|p| p.y).fold(0.0, f64::max) / 2.0;
        for (c, &v) in scene.model.welds.iter().enumerate() {
            let out = (state.mapped[v] - middle).normalize();
            assert!(state.normals[c].dot(out) > 0.98, "{} {out}", state.normals[c]);
        }
        state.mapped.fill(DVec3::ZERO);
        tick.shade(&mut state);
        assert!(state.normals.iter().all(|n| *n == DVec3::Y));
    }

    #[test]
    fn charring_runs_over_two_widths_and_glow_peaks_between() {
        let scene = Scene::sphere(Variant::Shell);
        let (tick, w) = (scene.tick(), scene.constants.width);
        let at = |behind: f64| [tick.char(0.5, 0.5 - behind * w), tick.glow(0.5, 0.5 - behind * w)];
        for (behind, expected) in [(-0.1, [0.0, 0.0]), (0.5, [0.25, 0.0]), (1.0, [0.5, 1.0]), (2.5, [1.0, 0.0])] {
            let found = at(behind);
            assert!((found[0] - expected[0]).abs() < 1e-9 && (found[1] - expected[1]).abs() < 1e-9, "{found:?}");
        }
    }
}
