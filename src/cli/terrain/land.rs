//! The options that say what land there is: maps and the base that they lie over.

use std::convert::Infallible;

use clap::{Args, ValueEnum};
use glam::DVec2;

use crate::cli::failure::Failure;
use crate::cli::options::{parse_finite, parse_numbers};
use crate::papers::terrain::setup::{PlacedMap, Setup};
use crate::papers::terrain::{Base, Interpolation, Parameters, Placement};
use crate::scene::HeightMapSource;

fn parse_map(text: &str) -> Result<HeightMapSource, Infallible> {
    text.parse()
}

/// The surface between the samples.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum InterpolationWord {
    /// Eq. 7
    Bilinear,
    /// Catmull-Rom
    Bicubic,
}

fn parse_base(text: &str) -> Result<Base, String> {
    match text.split_once(':') {
        None if text == "plane" => Ok(Base::Plane),
        None if text == "earth" => Ok(Base::EARTH),
        Some(("ellipsoid", axes)) => {
            parse_numbers::<2>(axes).map(|[equatorial_m, polar_m]| Base::Ellipsoid { equatorial_m, polar_m })
        }
        Some(("cylinder", radius)) => parse_finite(radius).map(|radius_m| Base::Cylinder { radius_m }),
        _ => Err("give plane, earth, ellipsoid:EQUATORIAL,POLAR or cylinder:RADIUS".to_owned()),
    }
}

#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Land")]
pub struct LandArgs {
    /// Height map: volcano, maunga-whau, jacksboro, or a .hgt, .hdr with .bil or .dem, .tif, .png or .asc file; repeatable, the
    /// terrains are united [default: volcano]
    #[arg(long, value_name = "NAME|FILE", value_parser = parse_map)]
    map: Vec<HeightMapSource>,
    /// Where a map's middle lies: metres east and south of the origin, degrees counterclockwise; once for each map
    /// [default: 0,0,0]
    #[arg(long, value_name = "EAST,SOUTH,DEGREES", value_parser = parse_numbers::<3>, allow_hyphen_values = true)]
    place: Vec<[f32; 3]>,
    /// Samples a side of the synthetic volcano, 2 to 16384 [default: 1024]
    #[arg(long, value_name = "N")]
    resolution: Option<u32>,
    /// Metres between samples, above 0 [default: what the map says of itself]
    #[arg(long, value_name = "M", value_parser = parse_finite, allow_negative_numbers = true)]
    spacing: Option<f32>,
    /// What heights are multiplied by, above 0 [default: 1]
    #[arg(long, value_name = "F", value_parser = parse_finite, allow_negative_numbers = true)]
    exaggeration: Option<f32>,
    /// The surface between the samples [default: bilinear]
    #[arg(long, value_enum)]
    interpolation: Option<InterpolationWord>,
    /// Base surface that heights are added to: plane, earth (WGS84), ellipsoid:EQUATORIAL,POLAR or cylinder:RADIUS, semi-axes
    /// and radius in metres, 1 to 100000000; the cylinder's axis runs north and south [default: plane]
    #[arg(long, value_name = "BASE", value_parser = parse_base)]
    base: Option<Base>,
    /// Height at which the base surface lies, -1000000 to 1000000 metres [default: the maps' minimum]
    #[arg(long, value_name = "M", value_parser = parse_finite, allow_negative_numbers = true)]
    base_level: Option<f32>,
    /// Seed of the synthetic volcano [default: 1]
    #[arg(long, value_name = "N")]
    seed: Option<u64>,
}

impl LandArgs {
    /// Writes what was typed over what `setup` has.
    ///
    /// # Errors
    /// [`Failure::Input`] for more places than maps, and for a resolution that no map heeds.
    pub fn write(&self, setup: &mut Setup) -> Result<(), Failure> {
        let p: &mut Parameters = &mut setup.parameters;
        p.base = self.base.unwrap_or(p.base);
        if let Some(interpolation) = self.interpolation {
            p.interpolation = match interpolation {
                InterpolationWord::Bilinear => Interpolation::Bilinear,
                InterpolationWord::Bicubic => Interpolation::Bicubic,
            };
        }
        p.base_level_m = self.base_level;
        if !self.map.is_empty() {
            let placed =
                |source: &HeightMapSource| PlacedMap { source: source.clone(), placement: Placement::default() };
            setup.maps = self.map.iter().map(placed).collect();
        }
        if self.place.len() > setup.maps.len() {
            let message =
                format!("--place: {} places for {} maps; give one for each", self.place.len(), setup.maps.len());
            return Err(Failure::Input(message));
        }
        for (placed, [east, south, degrees]) in setup.maps.iter_mut().zip(&self.place) {
            placed.placement = Placement {
                center_m: DVec2::new(f64::from(*east), f64::from(*south)),
                turn_rad: f64::from(*degrees).to_radians(),
            };
        }
        let has_volcano = setup.maps.iter().any(|placed| placed.source == HeightMapSource::Volcano);
        if let (Some(resolution), false) = (self.resolution, has_volcano) {
            let message =
                format!("--resolution {resolution}: only the synthetic volcano has any size; name --map volcano");
            return Err(Failure::Input(message));
        }
        setup.resolution = self.resolution.unwrap_or(setup.resolution);
        setup.spacing_m = self.spacing.map(f64::from);
        setup.exaggeration = self.exaggeration.unwrap_or(1.0);
        setup.seed = self.seed.unwrap_or(setup.seed);
        Ok(())
    }

    /// Whether a map was named.
    pub fn names_maps(&self) -> bool {
        !self.map.is_empty()
    }

    /// Whether a number of samples a side was named.
    pub fn names_resolution(&self) -> bool {
        self.resolution.is_some()
    }
}
