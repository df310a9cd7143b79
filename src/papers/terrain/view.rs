//! The camera and the haze that suit maps of any extent.

use std::f64::consts::FRAC_PI_4;

use glam::{DVec3, Vec3};

use super::parameters::{Parameters, View};
use super::placement::Extent;
use crate::scene::Camera;

/// The optical depth of the haze over the maps' longest side.
const OPTICAL_DEPTH: f64 = 0.24;
/// A share of its contrast that is too little to see terrain by.
const FAINT: f64 = 0.05;
/// The relief, as a fraction of the longest side, up to which maps count as low.
const LOW: f64 = 0.25;
/// The most steps back, each a tenth of the way, that a camera takes to hold all that it has to: enough for the highest and narrowest
/// map in the narrowest picture.
const MOST_STEPS_BACK: i32 = 480;

impl Parameters {
    /// The camera of [`Parameters::view`] for maps of this extent.
    pub fn camera(&self, extent: &Extent) -> Camera {
        let size = extent.high - extent.low;
        let center = (extent.high + extent.low) / 2.0;
        let reach = size.x.max(size.z);
        let (eye, target, up) = match self.view {
            View::Camera(camera) => return camera,
            View::Side => {
                let (eye, target) = self.side_view(extent, reach);
                (eye, target, Vec3::Y)
            }
            View::Top => {
                let needed = size.z.max(size.x / self.aspect());
                let eye = DVec3::new(center.x, extent.high.y + 0.53 * needed / (FRAC_PI_4 / 2.0).tan(), center.z);
                (eye, DVec3::new(center.x, extent.low.y, center.z), Vec3::NEG_Z)
            }
        };
        Camera {
            eye: eye.as_vec3(),
            target: target.as_vec3(),
            up,
            vertical_fov_rad: FRAC_PI_4 as f32,
            near_m: (reach * 1e-3).max(1e-3) as f32,
            far_m: (reach * 1e3).max(1.0) as f32,
        }
    }

    /// Eye and target: of broad low maps so near that nine rays in ten meet them, of others as far back as it takes to have the
    /// far edge, or the whole of a high one, in the picture.
    fn side_view(&self, extent: &Extent, reach: f64) -> (DVec3, DVec3) {
        let (low, high) = (extent.low, extent.high);
        let center = (high + low) / 2.0;
        let is_low = high.y - low.y <= LOW * reach;
        let aim_m = if is_low { low.y } else { center.y };
        let above_m = if is_low { high.y - low.y + 0.109 * reach } else { 0.2 * reach };
        let target = DVec3::new(center.x, aim_m, center.z + 0.1 * reach);
        let back = DVec3::new(0.0, above_m, 0.35 * reach);
        let nearest_z = if is_low { low.z } else { high.z };
        let highest_y = if is_low { low.y } else { high.y };
        let corners = [low.x, high.x].into_iter().flat_map(|x| {
            [low.y, highest_y].into_iter().flat_map(move |y| [low.z, nearest_z].map(|z| DVec3::new(x, y, z)))
        });
        let corners: Vec<DVec3> = corners.collect();
        let forward = -back.normalize();
        let upward = DVec3::X.cross(forward);
        let half = (FRAC_PI_4 / 2.0).tan();
        let is_seen = |eye: DVec3| {
            corners.iter().all(|corner| {
                let seen = *corner - eye;
                let depth_m = seen.dot(forward) * half;
                seen.x.abs() <= depth_m * self.aspect() && seen.dot(upward).abs() <= depth_m
            })
        };
        let factors = (0..=MOST_STEPS_BACK).map(|step| 1.1_f64.powi(step));
        let mut eyes = factors.map(|factor| target + back * factor);
        let eye = eyes.find(|eye| is_seen(*eye)).unwrap_or(target + back * 1.1_f64.powi(MOST_STEPS_BACK));
        (eye, target)
    }

    /// Extinction by haze per kilometre, as it was set or as it suits maps of this extent.
    pub fn extinction_per_km(&self, extent: &Extent) -> f32 {
        let size = extent.high - extent.low;
        let reach_km = size.x.max(size.z).max(0.5 * self.distance_m(extent)) / 1000.0;
        self.haze_per_km.unwrap_or((OPTICAL_DEPTH / reach_km.max(1e-6)) as f32)
    }

    /// From the eye to the middle of the maps.
    fn distance_m(&self, extent: &Extent) -> f64 {
        self.camera(extent).eye.as_dvec3().distance((extent.high + extent.low) / 2.0)
    }

    /// A warning where haze hides maps of this extent from the camera.
    pub fn haze_warning(&self, extent: &Extent) -> Option<String> {
        let size = extent.high - extent.low;
        let distance_km = self.distance_m(extent).max(0.25 * size.x.max(size.z)) / 1000.0;
        let haze = self.extinction_per_km(extent);
        let left = (-f64::from(haze) * distance_km).exp();
        (left < FAINT).then(|| {
            format!(
                "`haze` {haze} per kilometre leaves {:.1} % of the terrain's contrast at {distance_km:.0} km, the distance of its \
                 middle; lower `haze`, or leave it out to suit the maps",
                100.0 * left
            )
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn extent(x: f64, y: f64, z: f64) -> Extent {
        Extent { low: DVec3::new(-x / 2.0, 0.0, -z / 2.0), high: DVec3::new(x / 2.0, y, z / 2.0) }
    }

    /// Of a point, right and up in half pictures.
    fn seen(camera: &Camera, aspect: f64, point: DVec3) -> (f64, f64) {
        let place = camera.view().as_dmat4().transform_point3(point);
        let half = (f64::from(camera.vertical_fov_rad) / 2.0).tan();
        assert!(place.z < 0.0, "{point} lies behind the camera");
        (place.x / -place.z / half / aspect, place.y / -place.z / half)
    }

    #[test]
    fn the_far_edge_of_any_map_is_in_the_side_view_and_all_of_it_in_the_top_view() {
        for (x, y, z) in [
            (12e3, 1.2e3, 12e3),
            (400e3, 2e3, 300e3),
            (300.0, 5.0, 20.0),
            (20.0, 5.0, 300.0),
            (60.0, 900.0, 60.0),
            (60.0, 4e5, 60.0),
            (1e7, 9e3, 5e6),
            (100.0, 0.0, 100.0),
        ] {
            for (width, height) in [(800, 600), (1600, 400), (300, 300), (200, 500)] {
                let extent = extent(x, y, z);
                let is_low = y <= LOW * x.max(z);
                let parameters = Parameters { width, height, ..Parameters::default() };
                let (side, top) = (parameters.clone(), Parameters { view: View::Top, ..parameters.clone() });
                let cameras = [(side.camera(&extent), !is_low), (top.camera(&extent), true)];
                for (camera, is_whole) in cameras {
                    for corner in 0..8 {
                        let side = |bit: i32, size: f64| if corner & bit == 0 { -size / 2.0 } else { size / 2.0 };
                        let point = DVec3::new(side(1, x), if corner & 2 == 0 { 0.0 } else { y }, side(4, z));
                        if is_whole || corner & 6 == 0 {
                            let (right, up) = seen(&camera, parameters.aspect(), point);
                            let name = format!("{x} x {y} x {z} in {width} x {height}");
                            assert!(right.abs() < 1.001 && up.abs() < 1.001, "{name}: {point} at {right}, {up}");
                        }
                    }
                }
            }
        }
    }

    #[test]
    fn haze_suits_the_maps_unless_it_is_set() {
        let volcano = extent(12e3, 1.2e3, 12e3);
        let default = Parameters::default();
        assert_eq!(default.extinction_per_km(&volcano), 0.02);
        for scale in [1.0, 30.0, 1000.0, 0.01] {
            let extent = extent(12e3 * scale, 1.2e3, 12e3 * scale);
            assert_eq!(default.haze_warning(&extent), None, "{scale}");
        }
        let set = Parameters { haze_per_km: Some(0.02), ..default };
        assert_eq!(set.extinction_per_km(&extent(1e6, 1e3, 1e6)), 0.02);
        assert_eq!(set.haze_warning(&volcano), None);
        let warning = set.haze_warning(&extent(1e6, 1e3, 1e6)).unwrap();
        assert!(warning.contains("`haze` 0.02 per kilometre leaves 0.0 %"), "{warning}");
    }
}
