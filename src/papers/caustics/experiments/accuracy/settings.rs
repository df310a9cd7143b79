//! Methods and their numbers.

use serde_json::{Value, json};

use super::super::super::setup::Setup;
use super::super::super::{IntensityRule, Variant};
use crate::measure::Variant as _;

/// A method with its numbers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Setting {
    /// The method.
    pub variant: Variant,
    /// Texels a side of its maps.
    pub map_size: u32,
    /// Of no meaning to `hit`.
    pub plane_count: u32,
    /// Texels a side that are drawn and averaged for each texel of the map.
    pub coverage: u32,
    /// Places that the intensity of eq. 4-18 belongs to.
    pub intensity: IntensityRule,
}

/// Samples along each side of a texel, where there are several.
const COVERAGE: u32 = 4;

/// The level map's options: the thesis's reading, and what departs from it.
const READINGS: [(u32, IntensityRule); 4] = [
    (1, IntensityRule::Face),
    (COVERAGE, IntensityRule::Face),
    (1, IntensityRule::Vertex),
    (COVERAGE, IntensityRule::Vertex),
];

/// Every method and reading with every size and count.
pub fn all_settings(sizes: &[u32], counts: &[u32]) -> Vec<Setting> {
    sizes.iter().flat_map(|&size| of_size(size, counts)).collect()
}

/// Every method and reading with the greatest size and the middle count.
pub fn some_settings(sizes: &[u32], counts: &[u32]) -> Vec<Setting> {
    let mut counts = counts.to_vec();
    counts.sort_unstable();
    let middle = counts.get(counts.len() / 2).copied();
    sizes.iter().max().into_iter().flat_map(|&size| of_size(size, middle.as_slice())).collect()
}

fn of_size(map_size: u32, counts: &[u32]) -> Vec<Setting> {
    let mut settings = Vec::new();
    for &plane_count in counts {
        let setting = |variant, (coverage, intensity)| Setting { variant, map_size, plane_count, coverage, intensity };
        settings.extend(READINGS.map(|reading| setting(Variant::LevelMap, reading)));
        let others = [Variant::LevelMapSmart, Variant::Culled, Variant::Volumetric];
        settings.extend(others.map(|variant| setting(variant, READINGS[0])));
        // What culling makes affordable.
        settings.push(setting(Variant::Culled, READINGS[3]));
    }
    let (coverage, intensity) = READINGS[0];
    settings.push(Setting { variant: Variant::Hit, map_size, plane_count: 0, coverage, intensity });
    settings
}

impl Setting {
    /// The scene by this method.
    pub fn of(&self, setup: &Setup) -> Setup {
        let mut setup = setup.clone();
        let numbers = &mut setup.parameters;
        (numbers.map_size, numbers.coverage, numbers.intensity) = (self.map_size, self.coverage, self.intensity);
        if self.has_planes() {
            numbers.planes = self.plane_count;
        }
        setup
    }

    pub fn has_planes(&self) -> bool {
        self.variant != Variant::Hit
    }

    pub fn planes(&self) -> Value {
        if self.has_planes() { json!(self.plane_count) } else { Value::Null }
    }

    /// The method, with the options that depart from the thesis's reading.
    pub fn name(&self) -> String {
        let mut name = self.variant.as_str().to_owned();
        if self.coverage > 1 {
            name.push_str(&format!(", coverage {}", self.coverage));
        }
        if self.intensity == IntensityRule::Vertex {
            name.push_str(", vertex");
        }
        name
    }
}
