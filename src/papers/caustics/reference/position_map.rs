//! Position map and diffuse map (section 4.2.2): the receiver seen from the light.

use crate::papers::caustics::reference::raster::TexelTriangle;
use crate::papers::caustics::reference::{EDGE_BAND_TEXELS, ReceiverBox};
use glam::{DVec2, DVec3};

/// A triangle of a receiver in the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReceiverTriangle {
    /// Corners, in metres.
    pub positions: [DVec3; 3],
    /// Unit normals at the corners.
    pub normals: [DVec3; 3],
}

/// The surface nearest to the light at every texel centre of a square map, row by row.
#[derive(Clone, Debug, PartialEq)]
pub struct PositionMap {
    /// Texels a side.
    pub resolution: usize,
    /// Height in box space, in metres; `None` on the background.
    pub y: Vec<Option<f64>>,
    /// Interpolated unit normal in the world; zero on the background.
    pub normals: Vec<DVec3>,
    /// Lowest and highest height found within [`EDGE_BAND_TEXELS`] of the centre; `None` where nothing is covered.
    pub y_range: Vec<Option<[f64; 2]>>,
    /// True where surface and background meet within [`EDGE_BAND_TEXELS`] of the centre, so that either is right.
    pub at_outline: Vec<bool>,
}

/// Draws the receiver along -V in orthographic projection over the box's width and depth and keeps the surface nearest
/// to the light, from either side of a triangle (eq. 4-10 to 4-13). The map has `resolution` texels a side.
pub fn position_map(receiver: &ReceiverBox, triangles: &[ReceiverTriangle], resolution: usize) -> PositionMap {
    let everything = |_: f64| true;
    let surfaces = nearest_surfaces(receiver, triangles, resolution, DVec2::ZERO, everything);
    let mut map = PositionMap {
        resolution,
        y: surfaces.iter().map(|s| s.map(|s| s.y)).collect(),
        normals: surfaces.iter().map(|s| s.map_or(DVec3::ZERO, |s| s.normal)).collect(),
        y_range: surfaces.iter().map(|s| s.map(|s| [s.y, s.y])).collect(),
        at_outline: vec![false; resolution * resolution],
    };
    let steps = [-EDGE_BAND_TEXELS, 0.0, EDGE_BAND_TEXELS];
    for offset in steps.into_iter().flat_map(|y| steps.map(|x| DVec2::new(x, y))) {
        let nearby = nearest_surfaces(receiver, triangles, resolution, offset, everything);
        for (texel, surface) in nearby.iter().enumerate() {
            map.at_outline[texel] |= surface.is_some() != map.y[texel].is_some();
            if let Some(Surface { y, .. }) = *surface {
                let [low, high] = map.y_range[texel].unwrap_or([y, y]);
                map.y_range[texel] = Some([low.min(y), high.max(y)]);
            }
        }
    }
    map
}

/// Diffuse light I_d = albedo x max(0, N·(-T)), without the light's intensity; T is the unit direction of the light
/// refracted at flat water.
pub fn diffuse(albedo: DVec3, normal: DVec3, refracted: DVec3) -> DVec3 {
    albedo * normal.dot(-refracted).max(0.0)
}

/// The diffuse map that belongs to a position map of one receiver, of one albedo; black on the background.
pub fn diffuse_map(receiver: &ReceiverBox, map: &PositionMap, albedo: DVec3) -> Vec<DVec3> {
    let shade = |&normal: &DVec3| diffuse(albedo, normal, -receiver.v);
    map.normals.iter().map(shade).collect()
}

/// A point of a receiver's surface.
#[derive(Clone, Copy, Debug)]
pub(super) struct Surface {
    /// Height along V, metres.
    pub(super) y: f64,
    /// Unit normal in box space.
    pub(super) normal: DVec3,
}

/// The highest surface at every texel centre plus `offset` texels, among those whose height is kept.
pub(super) fn nearest_surfaces(
    receiver: &ReceiverBox,
    triangles: &[ReceiverTriangle],
    resolution: usize,
    offset: DVec2,
    keeps: impl Fn(f64) -> bool,
) -> Vec<Option<Surface>> {
    let mut surfaces: Vec<Option<Surface>> = vec![None; resolution * resolution];
    for triangle in triangles {
        let corners = triangle.positions.map(|p| receiver.to_box(p));
        let projected = corners.map(|p| receiver.to_texels(p, resolution));
        let Some(projected) = TexelTriangle::new(projected) else {
            continue;
        };
        for (texel, center) in projected.texels(resolution) {
            let Some(weights) = projected.weights(center + offset) else {
                continue;
            };
            let y = (0..3).map(|i| corners[i].y * weights[i]).sum();
            if keeps(y) && surfaces[texel].is_none_or(|nearest| y > nearest.y) {
                let normal: DVec3 = (0..3).map(|i| triangle.normals[i] * weights[i]).sum();
                let normal = normal.normalize_or_zero();
                surfaces[texel] = Some(Surface { y, normal });
            }
        }
    }
    surfaces
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::papers::caustics::reference::fixtures::{OBLIQUE, OVERHEAD, sphere, tilted};

    #[test]
    fn a_tilted_plane_has_its_analytic_height_and_one_normal() {
        let floor = tilted();
        for light in [OVERHEAD, OBLIQUE] {
            let receiver = floor.aligned(light);
            let map = position_map(&receiver, &floor.triangles, 32);
            let normal = floor.triangles[0].normals[0];
            let at = receiver.to_box(floor.triangles[0].positions[0]);
            let axis = receiver.direction_to_box(normal);
            let mut covered = 0;
            for texel in 0..32 * 32 {
                let x = ((texel % 32) as f64 + 0.5) / 32.0 - 0.5;
                let z = ((texel / 32) as f64 + 0.5) / 32.0 - 0.5;
                let Some(y) = map.y[texel] else { continue };
                let point = DVec3::new(x * receiver.width, y, z * receiver.depth);
                assert!(axis.dot(point - at).abs() < 1e-12);
                assert!((map.normals[texel] - normal).length() < 1e-12);
                covered += 1;
            }
            assert!(covered > 500);
        }
    }

    #[test]
    fn the_surface_nearest_to_the_light_wins_and_only_the_outline_is_uncertain() {
        let ball = sphere(48, 1.0);
        let receiver = ball.aligned(OVERHEAD);
        let map = position_map(&receiver, &ball.triangles, 64);
        assert!(map.y.iter().flatten().all(|&y| y > -1e-12));
        let covered = map.y.iter().flatten().count() as f64;
        assert!((covered / 64.0_f64.powi(2) - std::f64::consts::FRAC_PI_4).abs() < 0.01);
        let outline = map.at_outline.iter().filter(|&&at| at).count();
        assert!((1..24).contains(&outline), "{outline}");
        let center = 32 * 64 + 32;
        assert!((map.y[center].unwrap() - 1.0).abs() < 0.01);
        assert!(map.normals[center].distance(DVec3::Y) < 0.05);
        for (y, range) in map.y.iter().zip(&map.y_range) {
            if let (Some(y), Some([low, high])) = (y, range) {
                assert!(low <= y && y <= high);
            }
        }
    }

    #[test]
    fn diffuse_light_follows_the_cosine_and_never_turns_negative() {
        let albedo = DVec3::new(0.5, 1.0, 0.25);
        let half = DVec3::new(0.0, 0.5, 0.75_f64.sqrt());
        assert!((diffuse(albedo, half, -DVec3::Y) - albedo / 2.0).length() < 1e-14);
        assert_eq!(diffuse(albedo, -DVec3::Y, -DVec3::Y), DVec3::ZERO);
    }
}
