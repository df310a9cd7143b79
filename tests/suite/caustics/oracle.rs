//! The oracle, fed with what the device is fed with.

use std::f64::consts::TAU;
use std::slice::from_ref;

use fumarole::papers::caustics::reference::{
    CausticsMap, Cell, HeightField, IlluminationVolume, Medium, PositionMap, ReceiverBox, ReceiverTriangle,
    ReferenceLight, Water, WaterVertex, Wave, align_box, caustics_map, illumination_volumes, place_planes,
    position_map, wave_vertex,
};
use fumarole::papers::caustics::water::{Grid, LEVEL_M, waves};
use fumarole::papers::caustics::{Parameters, ReceiverInput};
use fumarole::scene::{Bounds, HeightMap, Light};
use glam::{DVec2, DVec3};

use super::drawing::FRAME;

pub struct Oracle {
    pub light: ReferenceLight,
    pub medium: Medium,
    pub receiver: ReceiverBox,
    pub cells: Vec<Cell>,
    pub water: Vec<WaterVertex>,
    pub volumes: Vec<IlluminationVolume>,
    pub positions: PositionMap,
}

impl Oracle {
    /// One light and one receiver at the time of the frame that is drawn, under the water of `grid`.
    pub fn of(parameters: &Parameters, light: &Light, receiver: &ReceiverInput, grid: &Grid) -> Self {
        Self::among(parameters, light, receiver, from_ref(receiver), grid)
    }

    /// One light and one of `receivers`, at whose common centre point lights are aimed.
    pub fn among(
        parameters: &Parameters,
        light: &Light,
        receiver: &ReceiverInput,
        receivers: &[ReceiverInput],
        grid: &Grid,
    ) -> Self {
        let light = match *light {
            Light::Parallel { direction, .. } => {
                ReferenceLight::Parallel { direction: direction.as_dvec3().normalize() }
            }
            Light::Point { position, .. } => ReferenceLight::Point { position: position.as_dvec3() },
        };
        let medium = Medium {
            refraction_index: f64::from(parameters.refraction_index),
            absorption_per_m: f64::from(parameters.absorption_per_m),
        };
        let mesh = &receiver.mesh;
        let points: Vec<DVec3> = mesh.positions.iter().map(|p| p.as_dvec3()).collect();
        let triangles: Vec<ReceiverTriangle> = mesh
            .indices
            .chunks_exact(3)
            .map(|corners| {
                let corners = [0, 1, 2].map(|i| corners[i] as usize);
                let normals = corners.map(|i| mesh.normals[i].as_dvec3());
                ReceiverTriangle { positions: corners.map(|i| points[i]), normals }
            })
            .collect();
        let everything = receivers.iter().flat_map(|r| r.mesh.positions.iter().copied());
        let center = Bounds::of_points(everything).center().as_dvec3();
        let aligned = align_box(light, &points, center, medium).unwrap();
        let water = water(parameters, grid, center);
        let indices: Vec<[u32; 3]> = grid.indices().chunks_exact(3).map(|i| [i[0], i[1], i[2]]).collect();
        Oracle {
            volumes: illumination_volumes(Water { vertices: &water, triangles: &indices }, light, medium),
            cells: place_planes(aligned.height, parameters.planes as usize),
            positions: position_map(&aligned, &triangles, parameters.map_size as usize),
            receiver: aligned,
            light,
            medium,
            water,
        }
    }

    pub fn caustics_map(&self) -> CausticsMap {
        caustics_map(&self.receiver, &self.cells, &self.volumes, self.medium, &self.positions)
    }

    /// The oracle's position map with the heights that the device found.
    pub fn with_heights(&self, found: &[f32]) -> PositionMap {
        let y = found.iter().map(|&height| (height > -1e29).then_some(f64::from(height))).collect();
        PositionMap { y, ..self.positions.clone() }
    }
}

fn water(parameters: &Parameters, grid: &Grid, middle: DVec3) -> Vec<WaterVertex> {
    let columns = grid.columns + 1;
    let places = (0..grid.vertex_count())
        .map(|i| DVec2::new(f64::from(i % columns), f64::from(i / columns)))
        .map(|place| grid.corner + grid.cell * place);
    if let Some(map) = &parameters.water_map {
        let heights = exact_heights(map.heights());
        let (columns, spacing_m) = (map.heights().width() as usize, map.heights().spacing_m());
        let field = HeightField::through(&heights, columns, spacing_m, DVec2::new(middle.x, middle.z));
        return places.map(|place| field.vertex(LEVEL_M, place.x, place.y)).collect();
    }
    let surface = waves_surface(parameters);
    places.map(|place| surface(place.x, place.y)).collect()
}

/// The waves of `parameters` at the time of the frame that is drawn, by x and z.
pub fn waves_surface(parameters: &Parameters) -> impl Fn(f64, f64) -> WaterVertex + use<> {
    let waves: Vec<Wave> = waves(parameters)
        .iter()
        .map(|wave| Wave {
            amplitude_m: wave.amplitude_m,
            direction: wave.vector.normalize(),
            wavelength_m: TAU / wave.vector.length(),
            angular_frequency_rad_s: wave.angular_frequency,
            phase_rad: wave.phase_rad,
        })
        .collect();
    let time_s = f64::from(FRAME) * f64::from(parameters.time_step_s);
    move |x, z| wave_vertex(&waves, LEVEL_M, x, z, time_s)
}

fn exact_heights(map: &HeightMap) -> Vec<f64> {
    let places = (0..map.height()).flat_map(|row| (0..map.width()).map(move |column| (column, row)));
    places.map(|(column, row)| f64::from(map.height_m(column, row))).collect()
}
