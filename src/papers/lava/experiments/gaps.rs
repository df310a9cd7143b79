//! Gaps between splats (chapter 9): pixels at which a ray meets the surface, and a picture of splats shows what lies behind it.

use glam::{Vec2, Vec3};
use serde_json::{Value, json};

use super::super::setup::Setup;
use crate::gpu::transfer::read_image;
use crate::measure::bench::build;
use crate::measure::machine::Machine;
use crate::measure::parameter::Choice as _;
use crate::measure::result_table::ResultTable;
use crate::measure::study::Study as _;
use crate::measure::{Error, Paper, picture};
use crate::papers::lava::{Parameters, SplatShape, SurfaceDraw, Variant, depth_range_m};
use crate::scene::Camera;

/// Cameras of a ring.
const TURNS: u8 = 8;
/// Of the rings above the lava.
const ELEVATIONS_DEG: [f32; 4] = [12.0, 30.0, 50.0, 75.0];
/// Their distance, in diagonals of the space.
const DISTANCE: f32 = 0.9;
/// Distance, in radii of a splat, by which splats show what lies behind the surface. Neighbours whose depths differ by as
/// much lie at an outline, which splats draw a pixel wider or narrower.
const BEHIND: f32 = 4.0;

/// From all around and above.
fn cameras(parameters: &Parameters) -> Vec<Camera> {
    let middle = parameters.space_m * Vec3::new(0.5, 0.3, 0.5);
    let distance_m = DISTANCE * parameters.space_m.length();
    let of = |elevation_deg: f32| {
        (0..TURNS).map(move |turn| {
            let (sine, cosine) = (std::f32::consts::TAU * f32::from(turn) / f32::from(TURNS)).sin_cos();
            let (up, out) = elevation_deg.to_radians().sin_cos();
            let eye = middle + distance_m * Vec3::new(out * cosine, up, out * sine);
            Camera { eye, target: middle, ..parameters.camera }
        })
    };
    ELEVATIONS_DEG.into_iter().flat_map(of).collect()
}

/// Direction of the ray through a pixel's middle, its length along the view 1.
fn direction(parameters: &Parameters, at: usize) -> Vec3 {
    let Parameters { camera, width, height, .. } = parameters;
    let view = camera.view();
    let [right, up, back] = [view.row(0), view.row(1), view.row(2)].map(|row| row.truncate());
    let half = (0.5 * camera.vertical_fov_rad).tan();
    let along = |at: usize, count: u32| (at as f32 + 0.5) / count as f32 * 2.0 - 1.0;
    let (x, y) = (along(at % *width as usize, *width), along(at / *width as usize, *height));
    half * parameters.aspect() * x * right - half * y * up - back
}

/// Depths of a picture in metres, row by row.
struct Depths {
    width: usize,
    metres: Vec<f32>,
    /// False without lava, and at the walls that close the space's sides for rays alone.
    is_sheet: Vec<bool>,
}

impl Depths {
    /// Of the parameters' camera, from shares of the range of depths.
    fn of(parameters: &Parameters, shares: &[f32]) -> Self {
        let range_m = depth_range_m(parameters);
        let [columns, _, rows] = parameters.density;
        let half_column_m = 0.5 * Vec2::new(parameters.space_m.x / columns as f32, parameters.space_m.z / rows as f32);
        let is_sheet = |(at, share): (usize, &f32)| {
            let place_m = parameters.camera.eye + (share * range_m - parameters.epsilon_m) * direction(parameters, at);
            let place_m = Vec2::new(place_m.x, place_m.z);
            let side_m = place_m.min(Vec2::new(parameters.space_m.x, parameters.space_m.z) - place_m);
            *share < 0.9999 && side_m.cmpgt(half_column_m).all()
        };
        Depths {
            width: parameters.width as usize,
            metres: shares.iter().map(|share| share * range_m).collect(),
            is_sheet: shares.iter().enumerate().map(is_sheet).collect(),
        }
    }

    /// True well inside an outline: all neighbours up to two pixels away are within so many metres of the pixel's depth.
    fn is_inside(&self, at: usize, within_m: f32) -> bool {
        let (x, y) = ((at % self.width) as i64, (at / self.width) as i64);
        let height = (self.metres.len() / self.width) as i64;
        let mut around = (-2..=2).flat_map(|down| (-2..=2).map(move |across| (x + across, y + down)));
        around.all(|(x, y)| {
            (0..self.width as i64).contains(&x) && (0..height).contains(&y) && {
                let beside = y as usize * self.width + x as usize;
                self.is_sheet[beside] && (self.metres[beside] - self.metres[at]).abs() < within_m
            }
        })
    }

    /// Pixels well inside an outline, and those of them at which splats show what lies so far behind.
    fn gaps(&self, splats: &Depths, behind_m: f32) -> (usize, usize) {
        let inside = (0..self.metres.len()).filter(|&at| self.is_inside(at, behind_m));
        inside.fold((0, 0), |(seen, gaps), at| {
            (seen + 1, gaps + usize::from(splats.metres[at] > self.metres[at] + behind_m))
        })
    }
}

/// Depths of a frame from every camera.
fn depths(machine: &mut Machine, setup: &Setup, cameras: &[Camera], frame: u32) -> Result<Vec<Depths>, Error> {
    let mut setup = setup.clone();
    let scene = setup.load()?;
    let mut paper = build(machine, &setup, &scene, Variant::GpuDriven)?.paper;
    let mut all = Vec::with_capacity(cameras.len());
    for camera in cameras {
        setup.parameters.camera = *camera;
        paper.set_drawn(&setup.parameters, &scene.rock, &scene.objects)?;
        if !all.is_empty() {
            paper.repeat();
        }
        picture::render(machine, &mut paper, frame)?;
        // It sees as far as there is something.
        let camera = paper.camera().unwrap_or(*camera);
        let parameters = Parameters { camera, ..setup.parameters.clone() };
        let shares: Vec<f32> = bytemuck::pod_collect_to_vec(&read_image(&machine.device, &paper.splatting.depth)?);
        all.push(Depths::of(&parameters, &shares));
    }
    Ok(all)
}

/// A row for each shape of splats.
///
/// # Errors
/// [`Error::Gpu`], [`Error::Image`], [`Error::Parameter`], [`Error::Input`].
pub fn table(machine: &mut Machine, setup: &Setup, frame: u32) -> Result<ResultTable, Error> {
    let p = &setup.parameters;
    let cameras = cameras(p);
    let mut of = |draw: SurfaceDraw, shape: SplatShape| {
        let mut setup = setup.clone();
        (setup.parameters.surface_draw, setup.parameters.splat_shape) = (Some(draw), shape);
        depths(machine, &setup, &cameras, frame)
    };
    let rays = of(SurfaceDraw::March, SplatShape::Disc)?;
    let behind_m = BEHIND * p.splat_radius_m;
    let mut row = |shape: SplatShape| -> Result<Vec<Value>, Error> {
        let splats = of(SurfaceDraw::Splats, shape)?;
        let counts: Vec<(usize, usize)> =
            rays.iter().zip(&splats).map(|(rays, splats)| rays.gaps(splats, behind_m)).collect();
        let (seen, gaps) = counts.iter().fold((0, 0), |sum, count| (sum.0 + count.0, sum.1 + count.1));
        let worst = counts.iter().map(|count| count.1).max();
        let gaping = counts.iter().filter(|count| count.1 > 0).count();
        Ok(vec![
            json!(shape.name()),
            json!(cameras.len()),
            json!(seen),
            json!(gaps),
            json!((seen > 0).then(|| 1e6 * gaps as f64 / seen as f64)),
            json!(gaping),
            json!(worst),
        ])
    };
    let rows = SplatShape::ALL.iter().map(|&shape| row(shape)).collect::<Result<_, _>>()?;
    Ok(ResultTable {
        title: "Gaps between splats from all around: pixels that show what lies behind the surface",
        columns: &[
            "splats",
            "cameras",
            "pixels",
            "gaps",
            "gaps a million",
            "cameras with gaps",
            "most gaps of a camera",
        ],
        rows,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gaps_are_pixels_inside_that_show_what_lies_behind() {
        let of = |metres: Vec<f32>| {
            let is_sheet = metres.iter().map(|&m| m < 19.0).collect();
            Depths { width: 8, metres, is_sheet }
        };
        let mut rays = vec![3.0; 64];
        // The last column is empty.
        (0..8).for_each(|row| rays[8 * row + 7] = 20.0);
        let mut splats = rays.clone();
        splats[8 * 3 + 3] = 3.2;
        // Just behind, in front, and at the outline.
        (splats[8 * 4 + 3], splats[8 * 4 + 4], splats[8 * 4 + 6]) = (3.05, 2.0, 20.0);
        // From 2 to 5 down, from 2 to 4 across.
        assert_eq!(of(rays.clone()).gaps(&of(splats), 0.1), (12, 1));
        assert_eq!(of(vec![20.0; 64]).gaps(&of(rays), 0.1), (0, 0));
    }

    /// The ray through a pixel comes out in its middle.
    #[test]
    fn rays_go_through_their_pixels() {
        let p = Parameters { width: 40, height: 30, ..Parameters::default() };
        let to_clip = p.camera.projection(p.aspect()) * p.camera.view();
        for at in [0, 39, 615, 1199] {
            let clip = to_clip.project_point3(p.camera.eye + 3.0 * direction(&p, at));
            let pixel = (Vec2::new(clip.x, clip.y) + 1.0) * 0.5 * Vec2::new(40.0, 30.0) - 0.5;
            assert!(pixel.distance(Vec2::new((at % 40) as f32, (at / 40) as f32)) < 1e-3, "{at}: {pixel}");
        }
    }

    #[test]
    fn cameras_stand_around_the_space_and_outside() {
        let p = Parameters::default();
        let cameras = cameras(&p);
        assert_eq!(cameras.len(), 32);
        for Camera { eye, .. } in cameras {
            let inside = eye.cmpge(Vec3::ZERO) & eye.cmple(p.space_m);
            assert!(!inside.all() && eye.y > 0.5, "{eye}");
        }
    }
}
