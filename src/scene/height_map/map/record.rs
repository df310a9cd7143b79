//! A map without its samples, as text: for files that hold those in another order.

use glam::DVec2;
use serde::{Deserialize, Serialize};

use super::{HeightMap, Samples};
use crate::scene::height_map::void_samples::{Suspect, VoidSamples, Voids};
use crate::scene::height_map::{Coordinates, Geographic};

/// Names as the text has them. Lengths are metres.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Record {
    width: u32,
    height: u32,
    /// Origin and step of 16-bit steps; none for floats.
    steps: Option<[f32; 2]>,
    range: [f32; 2],
    spacing: [f64; 2],
    slope: f64,
    /// West, north, steps east and south, degrees.
    geographic: Option<[f64; 4]>,
    /// East, north, steps east and south, in the source's unit.
    coordinates: Option<[f64; 4]>,
    voids: Option<(u64, Treatment)>,
    /// The height of the nodes in holes.
    hole: Option<f32>,
    /// The height, its samples, the lowest of the others.
    suspect: Option<(f64, u64, f64)>,
}

#[derive(Serialize, Deserialize)]
enum Treatment {
    Fill,
    Level(f32),
    Hole,
}

impl HeightMap {
    /// All but the samples, as JSON.
    ///
    /// # Errors
    /// None that a map has.
    pub fn to_record(&self) -> serde_json::Result<String> {
        let treatment = |voids: &VoidSamples| match voids.treatment() {
            Voids::Fill => Treatment::Fill,
            Voids::Level(level_m) => Treatment::Level(level_m),
            Voids::Hole => Treatment::Hole,
        };
        serde_json::to_string(&Record {
            width: self.width,
            height: self.height,
            steps: match self.samples {
                Samples::Steps { origin_m, step_m, .. } => Some([origin_m, step_m]),
                Samples::Float(_) => None,
            },
            range: self.range_m.into(),
            spacing: self.spacing_m.to_array(),
            slope: self.slope(),
            geographic: self.geographic.map(|g| [g.west_deg, g.north_deg, g.step_deg.x, g.step_deg.y]),
            coordinates: self.coordinates.map(|c| [c.north_west.x, c.north_west.y, c.step.x, c.step.y]),
            voids: self.voids.as_ref().map(|voids| (voids.count(), treatment(voids))),
            hole: self.hole_m,
            suspect: self.suspect.map(|suspect| (suspect.height_m, suspect.samples, suspect.next_m)),
        })
    }

    /// A map whose samples lie elsewhere; none of text that no map wrote.
    pub fn from_record(text: &str) -> Option<Self> {
        let record: Record = serde_json::from_str(text).ok()?;
        let kind = match record.steps {
            Some([origin_m, step_m]) => Samples::Steps { values: Vec::new(), origin_m, step_m },
            None => Samples::Float(Vec::new()),
        };
        let map = Self::promised(record.width, record.height, kind).ok()?;
        let map = map.with_spacing_m(record.spacing.into()).ok()?;
        let treatment = |treatment| match treatment {
            Treatment::Fill => Voids::Fill,
            Treatment::Level(level_m) => Voids::Level(level_m),
            Treatment::Hole => Voids::Hole,
        };
        Some(Self {
            range_m: record.range.into(),
            slope: Some(record.slope),
            geographic: record.geographic.map(|[west_deg, north_deg, x, y]| Geographic {
                west_deg,
                north_deg,
                step_deg: DVec2::new(x, y),
            }),
            coordinates: record
                .coordinates
                .map(|[east, north, x, y]| Coordinates { north_west: DVec2::new(east, north), step: DVec2::new(x, y) }),
            hole_m: record.hole,
            voids: record.voids.map(|(count, how)| VoidSamples::anywhere(count, treatment(how))),
            suspect: record.suspect.map(|(height_m, samples, next_m)| Suspect { height_m, samples, next_m }),
            ..map
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_that_a_map_says_of_itself_comes_back() {
        let steps = Samples::Steps { values: vec![0, 9, 7, 3, 1, 2], origin_m: 100.1, step_m: 0.3 };
        let place = Geographic { west_deg: 139.7, north_deg: 40.1, step_deg: DVec2::splat(1.0 / 1_200.0) };
        let suspect = Suspect { height_m: -9_999.0, samples: 3, next_m: 12.5 };
        let full = HeightMap::new(3, 2, steps).unwrap().with_geographic(place).with_void_samples(&[1, 5]);
        let full = full.with_spacing_m(DVec2::new(70.3, 92.6)).unwrap().with_suspect(Some(suspect));
        let level = full.clone().with_voids(Voids::Level(101.0), 0.0).unwrap();
        let hole = full.clone().with_voids(Voids::Hole, 100.0).unwrap();
        assert!(hole.lowest_node_m() < 100.0 && hole.range_m() == full.range_m());
        let plain = HeightMap::new(2, 2, Samples::Float(vec![0.1, -2.7, 3.0, 1.0e-20])).unwrap();
        for map in [full, level, hole, plain] {
            let (range_m, slope) = (map.range_m(), map.slope());
            let bare = map.clone().without_samples(range_m, slope).unwrap();
            assert_eq!(HeightMap::from_record(&map.to_record().unwrap()), Some(bare.clone()));
            assert_eq!(HeightMap::from_record(&bare.to_record().unwrap()), Some(bare.clone()));
            assert_eq!((bare.void_note(), bare.slope(), bare.range_m()), (map.void_note(), slope, range_m));
            assert_eq!(bare.lowest_node_m(), map.lowest_node_m());
        }
        for text in ["", "{}", "{\"width\":1}"] {
            assert_eq!(HeightMap::from_record(text), None);
        }
    }
}
