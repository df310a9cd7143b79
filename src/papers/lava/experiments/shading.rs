//! Other shading techniques (chapter 9): colours of splats blended, a colour for each pixel by blended normals and depths, and by rays.

use serde_json::json;

use super::super::setup::Setup;
use super::readback::stage;
use crate::image::Rgba8;
use crate::measure::bench::build;
use crate::measure::machine::Machine;
use crate::measure::result_table::ResultTable;
use crate::measure::study::Study as _;
use crate::measure::sweep::{Point, Row};
use crate::measure::{Error, picture};
use crate::papers::lava::{SplatShading, SurfaceDraw, Variant};

const DRAWINGS: [(&str, SurfaceDraw, SplatShading); 3] = [
    ("gouraud", SurfaceDraw::Splats, SplatShading::Gouraud),
    ("deferred", SurfaceDraw::Splats, SplatShading::Deferred),
    ("march", SurfaceDraw::March, SplatShading::Gouraud),
];

/// Each way to shade.
pub fn points(setup: &Setup) -> Vec<Point<Setup>> {
    let point = |(name, draw, shading): (&str, SurfaceDraw, SplatShading)| {
        let mut study = setup.clone();
        (study.parameters.surface_draw, study.parameters.splat_shading) = (Some(draw), shading);
        Point { variants: vec![Variant::Paper], ..Point::single(name, study) }
    };
    DRAWINGS.into_iter().map(point).collect()
}

/// Mean difference of the green of pixels beside each other that are both lit, of 255.
fn contrast(picture: &Rgba8) -> Option<f64> {
    let row_bytes = 4 * picture.width() as usize;
    let rows = picture.pixels().chunks_exact(row_bytes);
    let pixels: Vec<Vec<&[u8]>> = rows.map(|row| row.chunks_exact(4).collect()).collect();
    let pairs = pixels.iter().flat_map(|row| row.windows(2));
    let lit = pairs.filter(|pair| pair.iter().all(|pixel| pixel[..3].iter().any(|&value| value > 0)));
    let off: Vec<f64> = lit.map(|pair| f64::from(pair[0][1].abs_diff(pair[1][1]))).collect();
    (!off.is_empty()).then(|| off.iter().sum::<f64>() / off.len() as f64)
}

/// The contrast of each point's first picture.
///
/// # Errors
/// [`Error::Gpu`], [`Error::Image`], [`Error::Parameter`], [`Error::Input`].
pub fn contrasts(machine: &mut Machine, points: &[Point<Setup>]) -> Result<Vec<Option<f64>>, Error> {
    let mut of = |point: &Point<Setup>| -> Result<Option<f64>, Error> {
        let scene = point.study.load()?;
        let mut paper = build(machine, &point.study, &scene, Variant::Paper)?.paper;
        Ok(contrast(&picture::render(machine, &mut paper, 0)?))
    };
    points.iter().map(&mut of).collect()
}

/// Times of every row, and the contrast of its picture.
pub fn table(rows: &[Row], contrasts: &[Option<f64>]) -> ResultTable {
    let first_ms = rows.first().and_then(|row| row.run.median_frame_ms());
    let cells = rows.iter().zip(contrasts).map(|(row, contrast)| {
        let passes = row.run.passes.iter().filter(|pass| stage(pass) == "three");
        let stage_ms: Option<f64> = passes.map(|pass| pass.gpu_ms.as_ref().map(|summary| summary.median)).sum();
        let frame_ms = row.run.median_frame_ms();
        vec![
            json!(row.label),
            json!(stage_ms),
            json!(frame_ms),
            json!(first_ms.zip(frame_ms).map(|(first, own)| first / own)),
            json!(contrast),
        ]
    });
    ResultTable {
        title: "Shading: blended colours, blended normals and depths, and rays",
        columns: &["shading", "stage three ms", "frame ms", "times faster", "contrast of neighbours"],
        rows: cells.collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn contrast_is_that_of_lit_neighbours() {
        let pixel = |green: u8| [9, green, 0, 255];
        let dark = [0, 0, 0, 255];
        let rows = [[pixel(10), pixel(30), dark], [dark, pixel(5), pixel(1)]];
        let picture = Rgba8::new(3, 2, rows.iter().flatten().flatten().copied().collect()).unwrap();
        assert_eq!(contrast(&picture), Some(12.0));
        assert_eq!(contrast(&Rgba8::new(1, 1, dark.to_vec()).unwrap()), None);
    }
}
