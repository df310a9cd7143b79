//! The land against the sky, as brute force has it and as it was drawn.

use fumarole::papers::terrain::reference::{Part, Ray};
use fumarole::papers::terrain::{Rays, Surface};
use fumarole::scene::Camera;
use rayon::prelude::*;

use super::drawing::Drawing;
use super::world::World;

/// Rows of the first land from above, of each column; the picture's rows where there is none.
#[derive(Debug, Clone, PartialEq)]
pub struct Silhouette {
    rows: Vec<u32>,
}

pub fn is_land(surface: Surface) -> bool {
    !matches!(surface, Surface::Sky | Surface::Base)
}

impl Silhouette {
    fn new(is_land: &[bool], (width, height): (u32, u32)) -> Self {
        let top = |x: u32| (0..height).find(|y| is_land[(y * width + x) as usize]).unwrap_or(height);
        Silhouette { rows: (0..width).map(top).collect() }
    }

    /// By a ray in double precision through the middle of each pixel; most columns show land.
    pub fn of_world(world: &World, camera: &Camera, size: (u32, u32)) -> Self {
        let rays = Rays::new(camera, size.0, size.1);
        let is_land = |pixel: u32| {
            let (x, y) = (f64::from(pixel % size.0), f64::from(pixel / size.0));
            let direction = rays.corner + x * rays.across + y * rays.down;
            let ray = Ray::new(world.moved(rays.eye), world.turned(direction));
            let hit = world.terrain.first_hit(&ray, [0.0, f64::INFINITY]);
            hit.is_some_and(|hit| matches!(hit.part, Part::Surface | Part::Wall))
        };
        let is_land: Vec<bool> = (0..size.0 * size.1).into_par_iter().map(is_land).collect();
        let silhouette = Self::new(&is_land, size);
        let seen = silhouette.rows.iter().filter(|row| **row < size.1).count();
        assert!(seen > 20, "{}: only {seen} columns show land", world.name);
        silhouette
    }

    pub fn of_drawing(drawing: &Drawing) -> Self {
        let is_land: Vec<bool> = drawing.hits.iter().map(|hit| is_land(hit.surface)).collect();
        Self::new(&is_land, (drawing.picture.width(), drawing.picture.height()))
    }

    /// Each row is that of a column at most `columns` to the side, or between two such, or at most `rows` from there: where land
    /// rises steeply a pixel to the side is several up or down.
    pub fn assert_near(&self, name: &str, expected: &Silhouette, (columns, rows): (usize, u32)) {
        for (column, row) in self.rows.iter().enumerate() {
            let end = (column + columns + 1).min(expected.rows.len());
            let beside = &expected.rows[column.saturating_sub(columns)..end];
            let (highest, lowest) = (beside.iter().min().unwrap(), beside.iter().max().unwrap());
            let is_near = (highest.saturating_sub(rows)..=lowest + rows).contains(row);
            assert!(is_near, "{name}: column {column}: {row}, not {beside:?}");
        }
    }
}
