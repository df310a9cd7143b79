//! Smart slicing without times: the planes it needs (table 5-4), what it changes in the picture (table 5-5,
//! figure 5-13), the depth profiles (figure 5-12), and the memory of the methods (section 5.1).

use serde_json::{Value, json};

use super::super::named_mesh::NamedMesh;
use super::super::setup::{Scene, Setup};
use super::points::Point;
use super::thesis::{TABLE_5_2, TABLE_5_4};
use crate::gpu::Mode;
use crate::image::{Difference, Rgba8, Samples, compare};
use crate::measure::Error;
use crate::measure::bench::build;
use crate::measure::machine::Machine;
use crate::measure::picture;
use crate::measure::result_table::ResultTable;
use crate::measure::study::Study;
use crate::measure::{Paper, Variant as _};
use crate::papers::caustics::{SmartPlacement, Variant};
use crate::report::plot::{BarChart, BarSeries};
use crate::scene::MeshSource;

/// Table 5-2: polygons of the models.
///
/// # Errors
/// [`Error::Scene`].
pub fn polygon_counts(setup: &Setup, meshes: &[MeshSource]) -> Result<ResultTable, Error> {
    let mut rows = Vec::new();
    for mesh in NamedMesh::all(meshes) {
        let scene = Setup { meshes: vec![mesh.source.clone()], ..setup.clone() }.load()?;
        let thesis = TABLE_5_2.iter().find(|(name, _)| *name == mesh.model).map(|(_, count)| *count);
        rows.push(vec![json!(mesh.name), json!(scene.receivers[0].mesh.triangle_count()), json!(thesis)]);
    }
    Ok(ResultTable { title: "Table 5-2: polygons of the models", columns: &["mesh", "triangles", "thesis"], rows })
}

/// Table 5-4: planes that smart slicing draws of those specified, in both placements.
pub const ACTUAL_PLANES: ResultTable = ResultTable {
    title: "Table 5-4: planes that smart slicing draws",
    columns: &["mesh", "specified", "fitted", "kept", "thesis"],
    rows: Vec::new(),
};

/// Its row.
///
/// # Errors
/// [`Error::Gpu`].
pub fn actual_planes(
    machine: &mut Machine,
    Point { mesh, planes, setup, scene }: Point<'_>,
) -> Result<Vec<Vec<Value>>, Error> {
    let mut setup = setup.clone();
    let mut drawn = |placement| -> Result<usize, Error> {
        setup.parameters.smart.placement = placement;
        let mut built = build(machine, &setup, scene, Variant::LevelMapSmart)?;
        machine.recorder.run(Mode::Plain, |frame| built.paper.record(frame, 0))?;
        Ok(built.paper.plane_counts().iter().sum())
    };
    let fitted = drawn(SmartPlacement::Fitted { epsilon_m: None })?;
    let kept = drawn(SmartPlacement::Kept)?;
    let thesis = TABLE_5_4.get(&mesh.model, planes).map(|t| t as u64);
    Ok(vec![vec![json!(mesh.name), json!(planes), json!(fitted), json!(kept), json!(thesis)]])
}

/// A frame's picture by normal slicing and by smart slicing, and how far they differ over the object's pixels.
pub struct PicturePair {
    /// Picture with planes at equal distances.
    pub normal: Rgba8,
    /// Picture with smart planes.
    pub smart: Rgba8,
    /// Luv difference of the two.
    pub difference: Difference,
}

/// Renders the pair of figure 5-13.
///
/// # Errors
/// [`Error::Gpu`], [`Error::Image`]: when the object is nowhere in the picture.
pub fn picture_pair(machine: &mut Machine, setup: &Setup, scene: &Scene) -> Result<PicturePair, Error> {
    let (normal, mask) = masked_picture(machine, setup, scene, Variant::LevelMap)?;
    let (smart, _) = masked_picture(machine, setup, scene, Variant::LevelMapSmart)?;
    let difference = compare(&normal, &smart, Some(&mask))?;
    Ok(PicturePair { normal, smart, difference })
}

/// The picture of the first frame, and its pixels that show an object where the camera is under water.
fn masked_picture(
    machine: &mut Machine,
    setup: &Setup,
    scene: &Scene,
    variant: Variant,
) -> Result<(Rgba8, Vec<bool>), Error> {
    let mut built = build(machine, setup, scene, variant)?;
    let rendered = picture::render(machine, &mut built.paper, 0)?;
    let targets = built.paper.targets();
    let depth = targets.iter().find(|t| t.name == "underwater-depth");
    let mask = match depth.map(|t| picture::read_target(&machine.device, t)).transpose()?.map(|r| r.samples().clone()) {
        Some(Samples::F32(depth)) => depth.iter().map(|&d| d < 1.0).collect(),
        _ => Vec::new(),
    };
    Ok((rendered, mask))
}

/// Section 6.1: what fewer planes for a far receiver change in the picture.
pub const FEWER_PLANES: ResultTable = ResultTable {
    title: "Section 6.1: Luv difference of fewer planes for a receiver that is farther away than `planes-within`, over the object's \
            pixels; within: of its distance",
    columns: &["mesh", "planes", "within", "planes drawn", "mean", "p99"],
    rows: Vec::new(),
};

/// Its rows: by shares of the receiver's distance from the camera within which it would have all planes; with one half it has half
/// of them.
///
/// # Errors
/// As [`picture_pair`].
pub fn fewer_planes(
    machine: &mut Machine,
    Point { mesh, planes, setup, scene }: Point<'_>,
) -> Result<Vec<Vec<Value>>, Error> {
    let mut setup = setup.clone();
    let middle = scene.receivers[0].mesh.bounds().center();
    let distance_m = setup.parameters.camera.eye.distance(middle);
    setup.parameters.planes_within_m = None;
    let (every, mask) = masked_picture(machine, &setup, scene, Variant::Culled)?;
    let row = |fraction: f32| {
        setup.parameters.planes_within_m = Some(distance_m * fraction);
        let (fewer, _) = masked_picture(machine, &setup, scene, Variant::Culled)?;
        let Difference { mean, p99, .. } = compare(&every, &fewer, Some(&mask))?;
        let drawn = setup.parameters.planes_at(middle);
        Ok(vec![json!(mesh.name), json!(planes), json!(fraction), json!(drawn), json!(mean), json!(p99)])
    };
    [0.5, 0.25, 0.125].into_iter().map(row).collect()
}

/// Table 5-5: mean Luv difference (eq. 2-9) between normal and smart slicing, in both placements.
pub const INTENSITY_DIFFERENCE: ResultTable = ResultTable {
    title: "Table 5-5: Luv difference between normal and smart slicing, over the object's pixels",
    columns: &["mesh", "planes", "fitted mean", "fitted p99", "kept mean", "kept p99", "thesis"],
    rows: Vec::new(),
};

/// Its row.
///
/// # Errors
/// As [`picture_pair`].
pub fn intensity_difference(
    machine: &mut Machine,
    Point { mesh, planes, setup, scene }: Point<'_>,
) -> Result<Vec<Vec<Value>>, Error> {
    let mut setup = setup.clone();
    let mut row = vec![json!(mesh.name), json!(planes)];
    for placement in [SmartPlacement::Fitted { epsilon_m: None }, SmartPlacement::Kept] {
        setup.parameters.smart.placement = placement;
        let Difference { mean, p99, .. } = picture_pair(machine, &setup, scene)?.difference;
        row.extend([json!(mean), json!(p99)]);
    }
    row.push(json!(TABLE_5_4.get(&mesh.model, planes).map(|_| 0)));
    Ok(vec![row])
}

/// Figure 5-12: texels in each depth level of a mesh.
///
/// # Errors
/// [`Error::Gpu`].
pub fn depth_profile(machine: &mut Machine, setup: &Setup, scene: &Scene) -> Result<Vec<u32>, Error> {
    let mut setup = setup.clone();
    setup.parameters.smart.placement = SmartPlacement::Fitted { epsilon_m: None };
    let mut built = build(machine, &setup, scene, Variant::LevelMapSmart)?;
    machine.recorder.run(Mode::Plain, |frame| built.paper.record(frame, 0))?;
    Ok(built.paper.depth_profile().unwrap_or_default().to_vec())
}

/// The histogram of figure 5-12.
pub fn profile_chart(mesh: &str, histogram: &[u32]) -> BarChart {
    // About ten levels have their number under them.
    let step = histogram.len().div_ceil(10).max(1);
    let label = |level: usize| if level == 1 || level.is_multiple_of(step) { level.to_string() } else { String::new() };
    BarChart {
        title: format!("Figure 5-12: depth profile of {mesh}, level 1 nearest to the light"),
        y_label: "texels".to_owned(),
        groups: (1..=histogram.len()).map(label).collect(),
        series: vec![BarSeries {
            name: "texels".to_owned(),
            values: histogram.iter().map(|&texels| Some(f64::from(texels))).collect(),
        }],
    }
}

/// Section 5.1: device memory of the methods by number of planes; only the volumetric method grows.
pub const MEMORY: ResultTable = ResultTable {
    title: "Section 5.1: memory by method",
    columns: &["mesh", "planes", "method", "maps, bytes", "all, bytes"],
    rows: Vec::new(),
};

/// Its rows.
///
/// # Errors
/// [`Error::Gpu`].
pub fn memory(
    machine: &mut Machine,
    Point { mesh, planes, setup, scene }: Point<'_>,
) -> Result<Vec<Vec<Value>>, Error> {
    let row = |&variant: &Variant| {
        let built = build(machine, setup, scene, variant)?;
        let of = |test: fn(&str) -> bool| built.memory.iter().filter(|m| test(&m.name)).map(|m| m.bytes).sum::<u64>();
        let (maps, all) = (of(is_map), of(|_| true));
        Ok(vec![json!(mesh.name), json!(planes), json!(variant.as_str()), json!(maps), json!(all)])
    };
    Variant::ALL.iter().map(row).collect()
}

/// True for a resource that a method keeps for its own light: its maps and their depth, the stencil method's images of what is
/// seen. The cast's target, the water and the receivers are all methods' alike.
fn is_map(resource: &str) -> bool {
    let is_depth = resource.ends_with("-depth") && resource != "underwater-depth";
    resource != "water-map" && resource.ends_with("-map") || is_depth || resource.starts_with("surface-")
}
