//! `collide`: what segments and spheres meet in the land.

use std::path::PathBuf;

use clap::{Args, Subcommand};
use glam::DVec3;
use serde_json::json;

use super::land::LandArgs;
use crate::cli::failure::Failure;
use crate::cli::outcome;
use crate::cli::paper::OwnVerbs;
use crate::papers::terrain::experiments::collisions::{Body, Collision, collide};
use crate::papers::terrain::setup::Setup;
use crate::report::output::{check_writable, write};

/// The verbs that no other paper has.
#[derive(Debug, Subcommand)]
pub enum TerrainVerbs {
    /// What segments and spheres meet in the land: section 1's detection of spatial collisions
    Collide(Box<CollideArgs>),
}

impl OwnVerbs for TerrainVerbs {
    fn run(&self) -> Result<(), Failure> {
        let TerrainVerbs::Collide(arguments) = self;
        arguments.run()
    }
}

#[derive(Debug, Clone, Args)]
pub struct CollideArgs {
    /// From a place to another, metres: east, up from the base, south; repeatable
    #[arg(long, value_name = "X,Y,Z,X,Y,Z", value_parser = parse_segment, allow_hyphen_values = true)]
    segment: Vec<Body>,
    /// Centre, metres as in --segment, and radius, above 0; repeatable
    #[arg(long, value_name = "X,Y,Z,R", value_parser = parse_sphere, allow_hyphen_values = true)]
    sphere: Vec<Body>,
    #[command(flatten)]
    land: LandArgs,
    /// Write what was met as JSON; to standard output without a file
    #[arg(long, value_name = "FILE", num_args = 0..=1, default_missing_value = "-", help_heading = "Output")]
    json: Option<PathBuf>,
}

/// Comma-separated numbers in double precision, exactly `N` of them.
fn parse_exact<const N: usize>(text: &str) -> Result<[f64; N], String> {
    let number = |part: &str| match part.trim().parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(value),
        _ => Err(format!("{part:?} is not a finite number")),
    };
    let values = text.split(',').map(number).collect::<Result<Vec<_>, _>>()?;
    let count = values.len();
    values.try_into().map_err(|_| format!("{N} comma-separated numbers are needed, {count} are given"))
}

fn parse_segment(text: &str) -> Result<Body, String> {
    let [ax, ay, az, bx, by, bz] = parse_exact(text)?;
    Ok(Body::Segment { from: DVec3::new(ax, ay, az), to: DVec3::new(bx, by, bz) })
}

fn parse_sphere(text: &str) -> Result<Body, String> {
    let [x, y, z, radius_m] = parse_exact(text)?;
    Ok(Body::Sphere { center: DVec3::new(x, y, z), radius_m })
}

impl CollideArgs {
    fn run(&self) -> Result<(), Failure> {
        let bodies: Vec<Body> = self.segment.iter().chain(&self.sphere).copied().collect();
        if bodies.is_empty() {
            return Err(Failure::Input("collide: there is nothing to collide; give a --segment or a --sphere".into()));
        }
        let file = self.json.as_deref().filter(|path| path.as_os_str() != "-");
        if let Some(path) = file {
            check_writable(path)?;
        }
        let mut setup = Setup::default();
        self.land.write(&mut setup)?;
        let collisions = collide(&setup, &bodies)?;
        let text = outcome::text(&json!({"collisions": collisions.iter().map(Collision::json).collect::<Vec<_>>()}))?;
        match (file, &self.json) {
            (Some(path), _) => write(path, text.as_bytes())?,
            (None, Some(_)) => return outcome::print(&text),
            (None, None) => {}
        }
        outcome::print(&collisions.iter().map(Collision::text).collect::<String>())
    }
}
