//! The device's own limits in the record.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::record::Summary;

/// The device's own limits, measured in the same process.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Limits {
    /// Bytes read and written by a buffer copy, 10^9 a second.
    pub copy_gb_s: Option<f64>,
    /// Operations of 32-bit multiply-adds, two each, 10^9 a second.
    pub fma_gflops: Option<f64>,
    /// Pixels written to an 8-bit RGBA target, 10^9 a second; those of other formats are among the samples.
    pub fill_gpix_s: Option<f64>,
    /// Pixels blended additively into an 8-bit RGBA target, 10^9 a second.
    pub blend_gpix_s: Option<f64>,
    /// Vertices of points that nothing is drawn of, 10^9 a second.
    #[serde(default)]
    pub vertex_gvertices_s: Option<f64>,
    /// Triangles without area, 10^9 a second.
    #[serde(default)]
    pub triangle_gtriangles_s: Option<f64>,
    /// Compute invocations that do nothing, 10^9 a second.
    #[serde(default)]
    pub issue_ginvocations_s: Option<f64>,
    /// Time of a pass with one draw that covers nothing.
    #[serde(default)]
    pub empty_draw_ms: Option<f64>,
    /// Time of a pass with one dispatch that does nothing.
    #[serde(default)]
    pub empty_dispatch_ms: Option<f64>,
    /// The samples behind each rate, under its name.
    #[serde(default)]
    pub samples: BTreeMap<String, Summary>,
}

impl Limits {
    /// Each limit that was measured: its name, value, what it is, unit.
    pub fn listed(&self) -> impl Iterator<Item = (&'static str, f64, &'static str, &'static str)> {
        let all = [
            ("copy_gb_s", self.copy_gb_s, "copy", "GB/s"),
            ("fma_gflops", self.fma_gflops, "multiply-add", "GFLOPS"),
            ("fill_gpix_s", self.fill_gpix_s, "fill", "Gpixel/s"),
            ("blend_gpix_s", self.blend_gpix_s, "blend", "Gpixel/s"),
            ("vertex_gvertices_s", self.vertex_gvertices_s, "vertices", "Gvertex/s"),
            ("triangle_gtriangles_s", self.triangle_gtriangles_s, "triangles", "Gtriangle/s"),
            ("issue_ginvocations_s", self.issue_ginvocations_s, "invocations", "Ginvocation/s"),
            ("empty_draw_ms", self.empty_draw_ms, "empty draw", "ms"),
            ("empty_dispatch_ms", self.empty_dispatch_ms, "empty dispatch", "ms"),
        ];
        all.into_iter().filter_map(|(name, value, what, unit)| Some((name, value?, what, unit)))
    }
}
