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
    /// Vertices of triangles outside of the picture, 10^9 a second.
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

/// Every limit in the order in which they are shown: its name in the record, what it is, its unit.
pub const LIMITS: [(&str, &str, &str); 16] = [
    ("copy_gb_s", "copy", "GB/s"),
    ("small_copy_gb_s", "copy inside the caches", "GB/s"),
    ("fma_gflops", "multiply-add", "GFLOPS"),
    ("fill_gpix_s", "fill rgba8", "Gpixel/s"),
    ("fill_r32f_gpix_s", "fill r32f", "Gpixel/s"),
    ("fill_rgba16f_gpix_s", "fill rgba16f", "Gpixel/s"),
    ("fill_rgba32f_gpix_s", "fill rgba32f", "Gpixel/s"),
    ("blend_gpix_s", "blend rgba8", "Gpixel/s"),
    ("blend_r32f_gpix_s", "blend r32f", "Gpixel/s"),
    ("blend_rgba16f_gpix_s", "blend rgba16f", "Gpixel/s"),
    ("blend_rgba32f_gpix_s", "blend rgba32f", "Gpixel/s"),
    ("vertex_gvertices_s", "vertices", "Gvertex/s"),
    ("triangle_gtriangles_s", "triangles", "Gtriangle/s"),
    ("issue_ginvocations_s", "invocations", "Ginvocation/s"),
    ("empty_draw_ms", "empty draw", "ms"),
    ("empty_dispatch_ms", "empty dispatch", "ms"),
];

/// A limit that was measured.
pub struct Limit<'a> {
    /// Description; its name in the record where that is not one of [`LIMITS`].
    pub what: &'a str,
    /// Unit of value and spread; empty where it is not known.
    pub unit: &'static str,
    /// The rate, or the time.
    pub value: f64,
    /// Median absolute deviation of its samples; absent where there are none, or one.
    pub mad: Option<f64>,
}

impl Limits {
    /// Each limit that was measured, those of other programs of the schema at the end.
    pub fn listed(&self) -> impl Iterator<Item = Limit<'_>> {
        let known = LIMITS.into_iter().filter_map(|(name, what, unit)| {
            Some(Limit {
                what,
                unit,
                value: self.value(name)?,
                mad: self.samples.get(name).and_then(|rates| rates.mad),
            })
        });
        let is_known = |name: &str| LIMITS.iter().any(|(known, ..)| *known == name);
        let others = self.samples.iter().filter(move |(name, _)| !is_known(name));
        known.chain(others.map(|(name, rates)| Limit { what: name, unit: "", value: rates.median, mad: rates.mad }))
    }

    /// The limit of that name; absent where it was not measured.
    pub fn value(&self, name: &str) -> Option<f64> {
        let field = match name {
            "copy_gb_s" => self.copy_gb_s,
            "fma_gflops" => self.fma_gflops,
            "fill_gpix_s" => self.fill_gpix_s,
            "blend_gpix_s" => self.blend_gpix_s,
            "vertex_gvertices_s" => self.vertex_gvertices_s,
            "triangle_gtriangles_s" => self.triangle_gtriangles_s,
            "issue_ginvocations_s" => self.issue_ginvocations_s,
            "empty_draw_ms" => self.empty_draw_ms,
            "empty_dispatch_ms" => self.empty_dispatch_ms,
            _ => None,
        };
        field.or_else(|| self.samples.get(name).map(|rates| rates.median))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::limits::{FORMATS, pixel_rate};
    use crate::measure::statistics::summarize;

    #[test]
    fn every_limit_is_listed_once_with_its_own_value() {
        let samples = LIMITS.iter().enumerate().filter_map(|(index, (name, ..))| {
            Some(((*name).to_owned(), summarize(&[index as f64 + 1.0, index as f64 + 2.0, index as f64 + 4.0])?))
        });
        let mut limits = Limits { samples: samples.collect(), ..Limits::default() };
        limits.samples.extend(summarize(&[0.5]).map(|rates| ("rays_g_s".to_owned(), rates)));
        limits.copy_gb_s = Some(2.0);
        let listed: Vec<Limit> = limits.listed().collect();
        assert_eq!(listed.len(), LIMITS.len() + 1);
        for (index, (limit, (_, what, unit))) in listed.iter().zip(LIMITS).enumerate() {
            assert_eq!((limit.what, limit.unit, limit.value, limit.mad), (what, unit, index as f64 + 2.0, Some(1.0)));
        }
        let last = &listed[LIMITS.len()];
        assert_eq!((last.what, last.unit, last.value, last.mad), ("rays_g_s", "", 0.5, None));
        // Records from before the samples.
        let older = Limits { blend_gpix_s: Some(0.25), ..Limits::default() };
        assert_eq!(older.listed().map(|limit| (limit.what, limit.value)).collect::<Vec<_>>(), [("blend rgba8", 0.25)]);
        assert_eq!(Limits::default().listed().count(), 0);
    }

    #[test]
    fn the_rates_of_every_format_have_a_name_for_people() {
        for (format, _) in FORMATS {
            for blends in [false, true] {
                let rate = pixel_rate(format, blends).unwrap();
                assert!(LIMITS.iter().any(|(name, ..)| *name == rate), "{rate}");
            }
        }
    }
}
