//! "Detection of spatial collisions" (section 1): what bodies meet in a setup's terrain.

use std::time::Instant;

use glam::DVec3;
use rayon::prelude::*;
use serde_json::{Value, json};

use super::super::setup::Setup;
use super::decimals::Decimals;
use crate::measure::Error;
use crate::measure::ParameterError;
use crate::measure::experiment::json_text;
use crate::measure::study::Study;
use crate::papers::terrain::{Collider, Contact, Inputs, Surface, void_warnings};
use crate::scene::shown;

/// A coordinate's and a radius' largest value, metres.
const FAR_M: f64 = 1.0e8;

/// A body that may meet the ground, in the maps' frame: metres east, up from the base, south.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Body {
    /// A point that moves straight from one place to another.
    Segment {
        /// First place of the point.
        from: DVec3,
        /// Last place of the point.
        to: DVec3,
    },
    Sphere {
        /// Place of its middle.
        center: DVec3,
        /// Radius in metres, above 0.
        radius_m: f64,
    },
}

/// A body and its first contact, if any.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Collision {
    /// The body.
    pub body: Body,
    /// None where it meets nothing.
    pub contact: Option<Contact>,
}

impl From<&[f64; 6]> for Body {
    fn from([x, y, z, to @ ..]: &[f64; 6]) -> Self {
        Body::Segment { from: DVec3::new(*x, *y, *z), to: (*to).into() }
    }
}

impl From<&[f64; 4]> for Body {
    fn from([x, y, z, radius_m]: &[f64; 4]) -> Self {
        Body::Sphere { center: DVec3::new(*x, *y, *z), radius_m: *radius_m }
    }
}

impl Body {
    /// # Errors
    /// [`Error::Parameter`] for one without extent or too far away.
    pub fn check(&self) -> Result<(), Error> {
        let is_near = |place: DVec3| place.is_finite() && place.abs().max_element() <= FAR_M;
        let (name, is_near, is_body, what) = match *self {
            Body::Segment { from, to } => ("segment", is_near(from) && is_near(to), from != to, "has no length"),
            Body::Sphere { center, radius_m } => (
                "sphere",
                is_near(center),
                radius_m > 0.0 && radius_m <= FAR_M,
                "needs a radius of more than 0 to 100000 km",
            ),
        };
        ParameterError::check(is_body, name, self, what)?;
        ParameterError::check(is_near, name, self, "must lie within 100000 km")?;
        Ok(())
    }

    fn meet(&self, collider: &Collider) -> Option<Contact> {
        match *self {
            Body::Segment { from, to } => collider.segment(from, to),
            Body::Sphere { center, radius_m } => collider.sphere(center, radius_m),
        }
    }
}

impl std::fmt::Display for Body {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Body::Segment { from, to } => {
                let ([x, y, z], [to_x, to_y, to_z]) = (from.to_array().map(shown), to.to_array().map(shown));
                write!(formatter, "{x},{y},{z},{to_x},{to_y},{to_z}")
            }
            Body::Sphere { center, radius_m } => {
                let [x, y, z] = center.to_array().map(shown);
                write!(formatter, "{x},{y},{z},{}", shown(*radius_m))
            }
        }
    }
}

/// The first contacts of bodies, in their order, warnings of the maps, and the seconds that all contacts took.
///
/// # Errors
/// [`Error::Parameter`] for a body without extent or too far away, [`Error::Scene`].
pub fn collide(setup: &Setup, bodies: &[Body]) -> Result<(Vec<Collision>, Vec<String>, f64), Error> {
    bodies.iter().try_for_each(Body::check)?;
    let scene = setup.load()?;
    let collider = Collider::new(&setup.parameters, &Inputs { maps: &scene.maps, ..Inputs::default() });
    let collisions = bodies.par_iter().map(|body| Collision { body: *body, contact: body.meet(&collider) });
    let started = Instant::now();
    let collisions = collisions.collect();
    let seconds = started.elapsed().as_secs_f64();
    Ok((collisions, void_warnings(scene.maps.iter().map(|input| &*input.map)), seconds))
}

/// Record of `collide` as JSON: the collisions in the order of the bodies, and warnings of the maps. All cores make it, and of a
/// million bodies no document is there but the text.
///
/// # Errors
/// As [`json_text`].
pub fn record(collisions: &[Collision], warnings: &[String]) -> Result<String, Error> {
    /// The distance of a collision from the margin.
    const INSIDE: &str = "\n    ";
    let text = |collision: &Collision| Ok(json_text(&collision.json())?.trim_end().replace('\n', INSIDE));
    let collisions: Vec<String> = collisions.par_iter().map(text).collect::<Result<_, Error>>()?;
    let (collisions, warnings) = (collisions.join(&format!(",{INSIDE}")), json!(warnings));
    Ok(format!("{{\n  \"collisions\": [{INSIDE}{collisions}\n  ],\n  \"warnings\": {warnings}\n}}\n"))
}

impl Collision {
    fn json(&self) -> Value {
        let contact = self.contact.map(|m| {
            json!({
                "surface": m.surface.as_str(), "map": m.map, "parameter": m.t, "distance_m": m.distance_m,
                "point": m.point.to_array(), "normal": m.normal.to_array(), "steps": m.steps,
            })
        });
        match self.body {
            Body::Segment { from, to } => json!({"segment": [from.to_array(), to.to_array()], "meets": contact}),
            Body::Sphere { center, radius_m } => {
                json!({"sphere": {"center": center.to_array(), "radius_m": radius_m}, "meets": contact})
            }
        }
    }
}

/// One line.
impl std::fmt::Display for Collision {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let kind = match self.body {
            Body::Segment { .. } => "segment",
            Body::Sphere { .. } => "sphere",
        };
        let body = &self.body;
        let Some(m) = self.contact else { return writeln!(formatter, "{kind} {body}: meets nothing") };
        write!(formatter, "{kind} {body}: ")?;
        match m.surface {
            Surface::Base => formatter.write_str("meets the base"),
            Surface::Inside if m.t.is_some() => formatter.write_str("begins in the ground"),
            Surface::Inside => formatter.write_str("has its centre in the ground"),
            surface => write!(formatter, "meets the {} of map {}", surface.as_str(), m.map),
        }?;
        // No minus before a zero.
        let rounded = |v: DVec3, half: f64| {
            let rounded = |c: f64| (c * 1e6).round() / 1e6;
            v.to_array().map(|c| if rounded(c).abs() < half { 0.0 } else { rounded(c) })
        };
        let [x, y, z] = rounded(m.point, 0.5e-3).map(Decimals::<3>);
        write!(formatter, " at {x},{y},{z}, ")?;
        let distance_m = m.distance_m;
        match m.t.map(Decimals::<6>) {
            Some(t) => write!(formatter, "parameter {t}, {} m from its start", Decimals::<3>(distance_m)),
            None => write!(formatter, "{} m from its centre", Decimals::<6>(distance_m)),
        }?;
        let [x, y, z] = rounded(m.normal, 0.5e-6).map(Decimals::<6>);
        writeln!(formatter, ", normal {x},{y},{z}, {} steps", m.steps)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The text that is put together is that of the whole document.
    #[test]
    fn a_record_is_that_of_the_whole_document() {
        let setup = Setup { resolution: 16, ..Setup::default() };
        let bodies = [
            Body::from(&[0.0, 9000.0, 0.0, 100.0, -1.0, 0.0]),
            Body::from(&[0.0, 9000.0, 0.0, 1.0, 9000.0, 0.0]),
            Body::from(&[0.0, 0.0, 0.0, 5.0]),
        ];
        let (collisions, _, _) = collide(&setup, &bodies).unwrap();
        assert!(collisions[0].contact.is_some() && collisions[1].contact.is_none());
        for warnings in [vec![], vec!["one".to_owned(), "two\n\"quoted\"".to_owned()]] {
            let listed: Vec<Value> = collisions.iter().map(Collision::json).collect();
            let whole = json_text(&json!({"collisions": listed, "warnings": warnings})).unwrap();
            assert_eq!(record(&collisions, &warnings).unwrap(), whole);
        }
    }

    #[test]
    fn bodies_far_away_are_refused_in_a_short_line() {
        for body in [
            Body::from(&[0.0, 1e300, 0.0, 5.0]),
            Body::from(&[0.0, 1.0, 0.0, 1e300]),
            Body::from(&[1e300, 1e300, 1e300, -1e300, 0.0, 1e-300]),
        ] {
            let message = body.check().unwrap_err().to_string();
            assert!(message.contains("1e300") && message.len() < 120, "{message}");
        }
    }

    #[test]
    fn a_line_has_no_minus_before_a_zero() {
        let contact = Contact {
            t: Some(0.5),
            distance_m: 1.0,
            point: DVec3::new(-0.0004, -0.0006, -0.0),
            normal: DVec3::new(-4e-7, 1.0, -6e-7),
            surface: Surface::Terrain,
            map: 0,
            steps: 1,
        };
        let body = Body::from(&[0.0, 0.0, 0.0, 1.0, 1.0, 1.0]);
        let line = Collision { body, contact: Some(contact) }.to_string();
        assert!(
            line.contains(" at 0.000,-0.001,0.000, ") && line.contains("normal 0.000000,1.000000,-0.000001,"),
            "{line}"
        );
    }
}
