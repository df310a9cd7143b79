//! The water: its waves, and a regular triangle mesh large enough that its refracted light covers every receiver.

use std::f64::consts::TAU;

use glam::{DVec2, DVec3};

use super::bounding_box::ReceiverBox;
use super::landing::{along_and_across, most_moved, moved_by_slope};
use super::parameters::Parameters;
use super::water_map::WaterMap;
use crate::scene::Light;
use crate::scene::random::Random;

/// Height of the flat water in the world.
pub const LEVEL_M: f64 = 0.0;
/// The fraction of a footprint's extent that the mesh reaches beyond it on every side.
const MARGIN: f64 = 0.1;
/// Slopes of the sum of many waves above which there is hardly any, in roots of their mean square.
const SELDOM: f64 = 2.0;
const GRAVITY_M_S2: f64 = 9.81;
/// Along a cell's side, in refined water.
const MOST_PARTS: f64 = 8.0;
/// Of a refined cell's side.
const LONGEST_TEXELS: f64 = 8.0;
/// By which a side may be longer than it is meant to be, of that length.
const LEEWAY: f64 = 0.25;

/// One sine wave of the surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Wave {
    /// Wave vector along x and z, rad/m.
    pub vector: DVec2,
    /// rad/s, of deep water: omega = sqrt(g k).
    pub angular_frequency: f64,
    /// Phase at the origin at time 0.
    pub phase_rad: f64,
    /// Half the height from trough to crest.
    pub amplitude_m: f64,
}

/// The seeded waves of a configuration: amplitudes in proportion to wavelength, so that all have one slope.
pub fn waves(parameters: &Parameters) -> Vec<Wave> {
    let mut random = Random::new(parameters.seed);
    let count = parameters.waves.count;
    let fraction = |i: u32| 0.4f64.powf(if count > 1 { f64::from(i) / f64::from(count - 1) } else { 0.0 });
    let total: f64 = (0..count).map(fraction).sum();
    (0..count)
        .map(|i| {
            let number = TAU / (f64::from(parameters.waves.wavelength_m) * fraction(i));
            let angle = TAU * f64::from(random.unit());
            Wave {
                vector: DVec2::from_angle(angle) * number,
                angular_frequency: (GRAVITY_M_S2 * number).sqrt(),
                phase_rad: TAU * f64::from(random.unit()),
                amplitude_m: f64::from(parameters.waves.amplitude_m) * fraction(i) / total,
            }
        })
        .collect()
}

impl Parameters {
    /// Root of the water's mean square slope.
    pub fn mean_slope(&self) -> f64 {
        self.water_map.as_ref().map_or_else(|| mean_derivative(self, 1), WaterMap::mean_slope)
    }

    /// Root of the mean square of the Laplacian of the water's height, per metre.
    pub fn mean_curvature(&self) -> f64 {
        self.water_map.as_ref().map_or_else(|| mean_derivative(self, 2), WaterMap::mean_curvature)
    }

    /// A slope that the water hardly exceeds anywhere.
    fn likely_slope(&self) -> f64 {
        let of_waves = || {
            let sum: f64 = waves(self).iter().map(|wave| wave.amplitude_m * wave.vector.length()).sum();
            // The crests of many waves hardly ever meet.
            sum.min(SELDOM * self.mean_slope())
        };
        self.water_map.as_ref().map_or_else(of_waves, |map| f64::from(map.steepest_slope()))
    }

    /// Height above or below the water's level that the water does not leave, metres.
    fn rise_m(&self) -> f64 {
        self.water_map.as_ref().map_or(f64::from(self.waves.amplitude_m), |map| {
            let (low_m, high_m) = map.range_m();
            f64::from(low_m.abs().max(high_m.abs()))
        })
    }

    /// Reach of the entry into this water.
    fn reach(&self) -> Reach {
        Reach { index: f64::from(self.refraction_index), slope: self.likely_slope(), rise_m: self.rise_m() }
    }

    /// Shortest length in metres over which the water repeats, or that a map of it resolves.
    pub fn shortest_wave_m(&self) -> f64 {
        let of_waves = || waves(self).iter().map(|w| TAU / w.vector.length()).fold(f64::INFINITY, f64::min);
        let of_map = |map: &WaterMap| 4.0 * map.heights().spacing_m().min_element();
        self.water_map.as_ref().map_or_else(of_waves, of_map)
    }
}

/// Root of the mean square of the waves' derivatives of that order, each wave's along itself: they do not correlate.
fn mean_derivative(parameters: &Parameters, order: i32) -> f64 {
    let square = |wave: &Wave| (wave.amplitude_m * wave.vector.length().powi(order)).powi(2) / 2.0;
    waves(parameters).iter().map(square).sum::<f64>().sqrt()
}

/// Water that light enters beside the place where it would enter it flat.
struct Reach {
    /// Refraction index.
    index: f64,
    /// A slope that is hardly exceeded.
    slope: f64,
    /// Greatest height above or below the level, metres.
    rise_m: f64,
}

impl Reach {
    /// Most distance between the two places, metres, for light to a target `depth_m` down whose ray in flat water runs down by
    /// `cos_refracted`.
    fn to(&self, cos_refracted: f64, depth_m: f64) -> f64 {
        // Light that grazes the water is refracted to the latter.
        let cos2 = (cos_refracted * cos_refracted).max(1.0 - 1.0 / (self.index * self.index));
        let (along, _) = along_and_across(cos2.sqrt(), self.index);
        // In proportion to small slopes, which is a little too far in water of moderate ones; steep water turns light farther.
        let moved = (along * self.slope).min(1.0 / cos2).max(most_moved(cos2.sqrt(), self.slope, self.index));
        self.rise_m * ((1.0 - cos2).max(0.0) / cos2).sqrt() + moved * (depth_m + self.rise_m).max(0.0)
    }
}

/// The regular mesh: where it lies and how many cells it has along x and z; each cell is two triangles.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Grid {
    /// x and z of the first vertex, metres.
    pub corner: DVec2,
    /// Cell size along x and z, metres.
    pub cell: DVec2,
    /// Cells along x.
    pub columns: u32,
    /// Cells along z.
    pub rows: u32,
}

impl Grid {
    /// A mesh of about `triangles` triangles, twice as many cells along z as along x where that divides (10,000 are 50
    /// x 100 cells), over the footprint of `boxes` under `light`s and a margin.
    pub fn over(boxes: &[(ReceiverBox, Light)], parameters: &Parameters) -> Self {
        let (mut low, mut high) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
        let (mut least, mut most) = (low, high);
        let mut deepest = LEVEL_M;
        let reach = parameters.reach();
        for (receiver, light) in boxes {
            for corner in receiver.corners() {
                let place = entry_point(light, corner, receiver, f64::from(parameters.refraction_index));
                low = low.min(place);
                high = high.max(place);
                deepest = deepest.min(corner.y);
                let cos_refracted = cos_refracted(light, corner, receiver, place);
                let reach = DVec2::splat(reach.to(cos_refracted, LEVEL_M - corner.y));
                least = least.min(place - reach);
                most = most.max(place + reach);
            }
        }
        // A wave of slope s deviates a ray by about s (1 - 1/n), and moves the edge of the footprint by as much.
        let deviation = f64::from(parameters.steepest_slope()) * (1.0 - 1.0 / f64::from(parameters.refraction_index));
        let mut margin = (high - low) * MARGIN + DVec2::splat(deviation.min(1.0) * (LEVEL_M - deepest));
        if let Some(map) = &parameters.water_map {
            // A map may lie above or below the level as a whole: a slanting ray then enters beside its place at the
            // level.
            let (low_m, high_m) = map.range_m();
            margin += DVec2::splat(f64::from(low_m.abs().max(high_m.abs())));
        }
        // Slanted light enters farther away, through water that leans or lies above its level.
        let (low, high) = ((low - margin).min(least), (high + margin).max(most));
        let (columns, rows) = cells(parameters.water_triangles);
        let cell = (high - low) / DVec2::new(f64::from(columns), f64::from(rows));
        Grid { corner: low, cell, columns, rows }
    }

    /// The same mesh with cells divided along each side until linear triangles show light from overhead to a quarter of a texel or
    /// so, slanted light to half of one, and none is longer than eight texels or so; by eight along a side at most (section 6.3).
    pub fn refined(self, boxes: &[(ReceiverBox, Light)], parameters: &Parameters) -> Self {
        let texel_m = |b: &ReceiverBox| (b.extent.x * b.extent.z).sqrt() / f64::from(parameters.map_size);
        let texel_m = boxes.iter().map(|(b, _)| texel_m(b)).fold(f64::INFINITY, f64::min);
        let depth_m = boxes.iter().flat_map(|(b, _)| b.corners()).map(|p| LEVEL_M - p.y).fold(0.0, f64::max);
        // From overhead a ray is turned by (1 - 1/n) of the slope; between vertices it strays by an eighth of its second
        // derivative.
        let index = f64::from(parameters.refraction_index);
        let most_slanted = |(b, light): &(ReceiverBox, Light)| moved_by_slope(least_cosine(light, b, index), index);
        let slanted = boxes.iter().map(most_slanted).fold(0.0, f64::max);
        let turn = parameters.mean_slope() * (1.0 - 1.0 / index).max(slanted / 2.0);
        let bend = turn * (TAU / parameters.shortest_wave_m()).powi(2) * depth_m;
        let strays = if bend > 0.0 { (2.0 * texel_m / bend).sqrt() } else { f64::INFINITY };
        let finest_m = strays.min(LONGEST_TEXELS * texel_m).max(f64::MIN_POSITIVE);
        let parts = (self.cell / finest_m - LEEWAY).ceil().clamp(DVec2::ONE, DVec2::splat(MOST_PARTS));
        let (along_x, along_z) = (parts.x as u32, parts.y as u32);
        Grid { cell: self.cell / parts, columns: self.columns * along_x, rows: self.rows * along_z, ..self }
    }

    pub fn vertex_count(&self) -> u32 {
        (self.columns + 1) * (self.rows + 1)
    }

    pub fn triangle_count(&self) -> u32 {
        2 * self.columns * self.rows
    }

    /// Extent along x and z, metres.
    pub fn extent_m(&self) -> DVec2 {
        self.cell * DVec2::new(f64::from(self.columns), f64::from(self.rows))
    }

    /// x and z of the middle, metres.
    pub fn center(&self) -> DVec2 {
        self.corner + self.extent_m() / 2.0
    }

    /// Three indices a triangle, row by row.
    pub fn indices(&self) -> Vec<u32> {
        let stride = self.columns + 1;
        let cell = |row: u32, column: u32| {
            let a = row * stride + column;
            let (b, c, d) = (a + 1, a + stride, a + stride + 1);
            [a, c, b, b, c, d]
        };
        (0..self.rows).flat_map(|row| (0..self.columns).flat_map(move |column| cell(row, column))).collect()
    }
}

/// Cells along x and z for a number of triangles: an exact division near one to two where there is one.
pub fn cells(triangles: u32) -> (u32, u32) {
    let cells = (triangles / 2).max(1);
    let ideal = (f64::from(cells) / 2.0).sqrt();
    let (least, most) = ((ideal / 1.5).ceil().max(1.0) as u32, (ideal * 1.5).floor().max(1.0) as u32);
    let exact = (least..=most)
        .filter(|columns| cells.is_multiple_of(*columns))
        .min_by(|a, b| (f64::from(*a) - ideal).abs().total_cmp(&(f64::from(*b) - ideal).abs()));
    let columns = exact.unwrap_or((ideal.round() as u32).max(1));
    (columns, (f64::from(cells) / f64::from(columns)).round() as u32)
}

/// x and z where light to `target` enters flat water.
fn entry_point(light: &Light, target: DVec3, receiver: &ReceiverBox, refraction_index: f64) -> DVec2 {
    match *light {
        Light::Parallel { .. } => {
            let v = receiver.axes.v;
            let entry = target + v * ((LEVEL_M - target.y) / v.y);
            DVec2::new(entry.x, entry.z)
        }
        Light::Point { position, .. } => {
            // Fermat: between the foot of the light and the foot of the target the entry point has equal optical
            // slopes; the difference is monotonic, so bisection finds it.
            let position = position.as_dvec3();
            let (from, to) = (DVec2::new(position.x, position.z), DVec2::new(target.x, target.z));
            let (above, below) = (position.y - LEVEL_M, LEVEL_M - target.y);
            let distance = from.distance(to);
            let sine = |run: f64, rise: f64| run / run.hypot(rise).max(f64::MIN_POSITIVE);
            let (mut low, mut high) = (0.0, 1.0);
            for _ in 0..60 {
                let middle = (low + high) / 2.0;
                let excess = sine(distance * middle, above) - refraction_index * sine(distance * (1.0 - middle), below);
                if excess < 0.0 { low = middle } else { high = middle }
            }
            from.lerp(to, low)
        }
    }
}

/// Cosine of the angle to the vertical at which light runs down from its `entry` into flat water to `target`.
fn cos_refracted(light: &Light, target: DVec3, receiver: &ReceiverBox, entry: DVec2) -> f64 {
    let depth_m = LEVEL_M - target.y;
    match light {
        Light::Parallel { .. } => receiver.axes.v.y,
        Light::Point { .. } if depth_m > 0.0 => depth_m / depth_m.hypot(entry.distance(DVec2::new(target.x, target.z))),
        // Light to what lies above the level passes no water.
        Light::Point { .. } => 1.0,
    }
}

/// Cosine of the angle to the vertical at which the most slanted light runs down through flat water to a box's corners.
pub fn least_cosine(light: &Light, receiver: &ReceiverBox, refraction_index: f64) -> f64 {
    let cosine = |corner| {
        let entry = entry_point(light, corner, receiver, refraction_index);
        cos_refracted(light, corner, receiver, entry)
    };
    receiver.corners().map(cosine).into_iter().fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::super::bounding_box::Axes;
    use super::super::parameters::WaveParameters;
    use super::super::reference::refract;
    use super::*;

    /// Boxes of a floor of 2 x 2 m, 3 m down, under light from `direction`, below water of an index.
    fn floor_below(refraction_index: f64, direction: Vec3) -> [(ReceiverBox, Light); 1] {
        let light = Light::Parallel { direction, intensity: Vec3::ONE };
        let points = [(-1.0, -1.0), (-1.0, 1.0), (1.0, -1.0), (1.0, 1.0)].map(|(x, z)| Vec3::new(x, -3.0, z));
        let axes = Axes::aligned_with(&light, DVec3::NEG_Y * 3.0, refraction_index);
        [(ReceiverBox::around(axes, &points), light)]
    }

    fn floor_under(direction: Vec3) -> [(ReceiverBox, Light); 1] {
        floor_below(4.0 / 3.0, direction)
    }

    const SLANTED: Vec3 = Vec3::new(1.0, -0.5, 0.0);

    /// Rays through every place of a swell that is wider than the mesh, through small waves, and through a steep one: those that the
    /// floor receives enter through the mesh.
    #[test]
    fn the_mesh_holds_all_water_that_lights_the_receivers() {
        let swell = WaveParameters { count: 3, amplitude_m: 4.0, wavelength_m: 200.0 };
        let small = WaveParameters { count: 12, amplitude_m: 0.05, wavelength_m: 1.2 };
        let steep = WaveParameters { count: 1, amplitude_m: 0.6, wavelength_m: 1.0 };
        let grazing = Vec3::new(1.0, -0.1, 0.3);
        let water = Parameters::default().refraction_index;
        let slanted = [(swell, water), (small, water), (small, 4.0), (steep, water), (steep, 4.0)];
        let slanted = slanted.into_iter().flat_map(|(waves, index)| [(waves, index, SLANTED), (waves, index, grazing)]);
        let overhead = [water, 4.0].map(|index| (steep, index, Vec3::NEG_Y));
        for (wave_parameters, refraction_index, direction) in slanted.chain(overhead) {
            let index = f64::from(refraction_index);
            for seed in 1..=6 {
                let parameters = Parameters { seed, waves: wave_parameters, refraction_index, ..Parameters::default() };
                let grid = Grid::over(&floor_below(index, direction), &parameters);
                let (low, high) = (grid.corner, grid.corner + grid.extent_m());
                let waves = waves(&parameters);
                let incident = direction.as_dvec3().normalize();
                let (mut lit, mut outside) = (0, 0);
                for place in (0..160_000).map(|i| DVec2::new(f64::from(i % 400), f64::from(i / 400)) * 0.1 - 20.0) {
                    let (mut height, mut slope) = (LEVEL_M, DVec2::ZERO);
                    for wave in &waves {
                        let (sine, cosine) = (wave.vector.dot(place) + wave.phase_rad).sin_cos();
                        height += wave.amplitude_m * sine;
                        slope += wave.vector * (wave.amplitude_m * cosine);
                    }
                    let normal = DVec3::new(-slope.x, 1.0, -slope.y).normalize();
                    let Some(ray) = refract(incident, normal, 1.0, index).filter(|ray| ray.y < 0.0) else {
                        continue;
                    };
                    let landing = place + DVec2::new(ray.x, ray.z) * ((height + 3.0) / -ray.y);
                    if incident.dot(normal) < 0.0 && landing.abs().max_element() <= 1.0 {
                        lit += 1;
                        outside += u32::from(place.cmplt(low).any() || place.cmpgt(high).any());
                    }
                }
                assert!(
                    lit > 50 && f64::from(outside) < 0.002 * f64::from(lit),
                    "{wave_parameters:?}, {index}, {direction}, seed {seed}: {outside} of {lit}"
                );
            }
        }
    }

    /// Light from overhead has the mesh that it always had: the footprint, a tenth of it, and what the steepest slope moves a ray by.
    #[test]
    fn under_overhead_light_the_mesh_has_its_plain_margin() {
        let parameters = Parameters::default();
        let grid = Grid::over(&floor_under(Vec3::NEG_Y), &parameters);
        let margin = 0.2 + 0.25 * f64::from(parameters.steepest_slope()) * 3.0;
        assert!((grid.extent_m() - (2.0 + 2.0 * margin)).abs().max_element() < 0.01, "{grid:?}");
    }

    #[test]
    fn slanted_light_strays_by_half_a_texel_at_most() {
        let parameters = Parameters { water_triangles: 1000, map_size: 128, ..Parameters::default() };
        let boxes = floor_under(SLANTED);
        let cell_m = Grid::over(&boxes, &parameters).refined(&boxes, &parameters).cell.max_element();
        let (ReceiverBox { axes, extent, .. }, _) = boxes[0];
        let texel_m = (extent.x * extent.z).sqrt() / 128.0;
        let turn = parameters.mean_slope() * moved_by_slope(axes.v.y, 4.0 / 3.0);
        let strays_m = turn * 3.0 * (TAU / parameters.shortest_wave_m() * cell_m).powi(2) / 8.0;
        assert!(strays_m < 0.55 * texel_m, "{strays_m} of {texel_m}");
    }

    /// The rays of a light close over the middle of a wide floor slant towards its corners, though its axis is upright.
    #[test]
    fn a_near_light_has_water_as_fine_as_its_most_slanted_rays_ask_for() {
        let near = Light::Point { position: Vec3::Y * 0.3, intensity: Vec3::ONE };
        let overhead = Light::Parallel { direction: Vec3::NEG_Y, intensity: Vec3::ONE };
        let points = [(-3.0, -3.0), (-3.0, 3.0), (3.0, -3.0), (3.0, 3.0)].map(|(x, z)| Vec3::new(x, -0.5, z));
        let index = 4.0 / 3.0;
        let lit_by = |light: Light| {
            let axes = Axes::aligned_with(&light, DVec3::NEG_Y * 0.5, index);
            [(ReceiverBox::around(axes, &points), light)]
        };
        let (near, overhead) = (lit_by(near), lit_by(overhead));
        let cosine = |[(receiver, light)]: &[(ReceiverBox, Light); 1]| least_cosine(light, receiver, index);
        // To a corner the ray that reaches it falls towards the critical angle.
        assert!((0.64..0.69).contains(&cosine(&near)), "{}", cosine(&near));
        assert_eq!(cosine(&overhead), overhead[0].0.axes.v.y);
        assert!((near[0].0.axes.v.y - 1.0).abs() < 1e-9);
        let parameters = Parameters { water_triangles: 200, map_size: 128, ..Parameters::default() };
        let grid = Grid::over(&overhead, &parameters);
        let [fine, plain] = [&near, &overhead].map(|boxes| grid.refined(boxes, &parameters).columns);
        assert!(fine > plain, "{fine} and {plain} columns");
    }

    /// Refined cells are divided alike, since there would be hardly fewer if each were divided by what its own water bends the light
    /// between its vertices, as the root of it along each side.
    #[test]
    fn waves_bend_light_alike_everywhere() {
        for seed in 1..=4 {
            let waves = waves(&Parameters { seed, ..Parameters::default() });
            // Second derivatives along x and along z of the place where light lands, for a unit of turn and depth.
            let bend = |place: DVec2| {
                let (mut along_x, mut along_z) = (DVec2::ZERO, DVec2::ZERO);
                for wave in &waves {
                    let third = wave.vector * (wave.amplitude_m * (wave.vector.dot(place) + wave.phase_rad).cos());
                    along_x += third * wave.vector.x.powi(2);
                    along_z += third * wave.vector.y.powi(2);
                }
                (along_x.length(), along_z.length())
            };
            let places = (0..10_000).map(|i| DVec2::new(f64::from(i % 100), f64::from(i / 100)) * 0.11);
            let bends: Vec<(f64, f64)> = places.map(bend).collect();
            let mean = |of: fn(&(f64, f64)) -> f64| bends.iter().map(of).sum::<f64>() / bends.len() as f64;
            let alike = (mean(|(x, _)| x * x) * mean(|(_, z)| z * z)).powf(0.25);
            let ratio = mean(|(x, z)| (x * z).sqrt()) / alike;
            println!("seed {seed}: each by its own bend would be {ratio:.3} times as many cells");
            assert!((0.65..0.95).contains(&ratio), "{ratio}");
        }
    }
}
