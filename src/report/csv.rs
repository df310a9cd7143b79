//! Runs as comma-separated values (RFC 4180): one row per run and pass, for spreadsheets and data frames.
//!
//! The columns are [`COLUMNS`]. A run without passes keeps one row with empty pass cells. Absent is an empty cell. Raw
//! samples are in the JSON only. `config`, `results` and `experiment` are JSON objects: the run's
//! parameters, the paper's own figures, and the row of a table that it reproduces.

use std::borrow::Cow;

use csv::{Terminator, WriterBuilder};

use super::record::{Bytes, Pass, Record, Run, Statistics, Summary};

/// A run of a record with one of its passes and the pass's index, if it has any.
struct Row<'a> {
    record: &'a Record,
    run: &'a Run,
    pass: Option<(usize, &'a Pass)>,
}

type Column = (&'static str, fn(&Row) -> String);

/// Names and cells of the columns, in order. Times are milliseconds, sizes bytes.
const COLUMNS: [Column; 72] = [
    ("device", |row| row.record.environment.device.name.clone()),
    ("device_type", |row| row.record.environment.device.kind.as_str().to_owned()),
    ("paper", |row| row.run.paper.clone()),
    ("variant", |row| row.run.variant.clone()),
    ("preset", |row| cell(row.run.preset.as_ref())),
    ("width", |row| row.run.width.to_string()),
    ("height", |row| row.run.height.to_string()),
    ("seed", |row| row.run.seed.to_string()),
    ("warmup", |row| row.run.warmup.to_string()),
    ("frames", |row| row.run.frames.to_string()),
    ("repeat", |row| row.run.repeat.to_string()),
    ("process", |row| row.run.process.to_string()),
    ("config", |row| json(&row.run.config)),
    ("results", |row| json(&row.run.results)),
    ("experiment", |row| row.run.experiment.as_ref().map_or_else(String::new, json)),
    ("frame_min_ms", |row| row.frame(|time| Some(time.min))),
    ("frame_median_ms", |row| row.frame(|time| Some(time.median))),
    ("frame_mean_ms", |row| row.frame(|time| Some(time.mean))),
    ("frame_p95_ms", |row| row.frame(|time| time.p95)),
    ("frame_p99_ms", |row| row.frame(|time| time.p99)),
    ("frame_max_ms", |row| row.frame(|time| Some(time.max))),
    ("frame_mad_ms", |row| row.frame(|time| time.mad)),
    ("overlap_ms", |row| cell(row.run.overlap_ms)),
    ("unaccounted_ms", |row| cell(row.run.unaccounted_ms)),
    ("pass_index", |row| cell(row.pass.map(|(index, _)| index))),
    ("pass", |row| row.of_pass(|pass| Some(pass.name.clone()))),
    ("section", |row| row.of_pass(|pass| pass.section.clone())),
    ("kind", |row| row.of_pass(|pass| Some(pass.kind.as_str()))),
    ("calls", |row| row.of_pass(|pass| Some(pass.calls))),
    ("submission", |row| row.of_pass(|pass| pass.submission)),
    ("shader_compiler", |row| row.of_pass(|pass| pass.shader_compiler.clone())),
    ("gpu_min_ms", |row| row.of_pass(|pass| Some(pass.gpu_ms.as_ref()?.min))),
    ("gpu_median_ms", |row| row.of_pass(|pass| Some(pass.gpu_ms.as_ref()?.median))),
    ("gpu_mad_ms", |row| row.of_pass(|pass| pass.gpu_ms.as_ref()?.mad)),
    ("host_median_ms", |row| row.of_pass(|pass| Some(pass.host_ms.as_ref()?.median))),
    ("wait_median_ms", |row| row.of_pass(|pass| Some(pass.wait_ms.as_ref()?.median))),
    ("vertices", |row| row.statistic(|count| count.vertices)),
    ("primitives", |row| row.statistic(|count| count.primitives)),
    ("clipped_primitives", |row| row.statistic(|count| count.clipped_primitives)),
    ("fragments", |row| row.statistic(|count| count.fragments)),
    ("compute_invocations", |row| row.statistic(|count| count.compute_invocations)),
    ("samples_passed", |row| row.statistic(|count| count.samples_passed)),
    ("bytes_read", |row| row.bytes(|bytes| Some(bytes.read))),
    ("bytes_written", |row| row.bytes(|bytes| Some(bytes.written))),
    ("date", |row| row.record.environment.date.clone()),
    ("driver_version", |row| cell(row.record.environment.device.driver_version.as_ref())),
    ("lp_num_threads", |row| cell(row.record.environment.host.lp_num_threads)),
    ("limit_copy_gb_s", |row| row.limit("copy_gb_s")),
    ("limit_fma_gflops", |row| row.limit("fma_gflops")),
    ("limit_fill_gpix_s", |row| row.limit("fill_gpix_s")),
    ("limit_blend_gpix_s", |row| row.limit("blend_gpix_s")),
    ("driver", |row| cell(row.record.environment.device.driver.as_ref())),
    ("rustc", |row| cell(row.record.environment.build.rustc.as_ref())),
    ("bytes_read_at_most", |row| row.bytes(|bytes| Some(bytes.at_most?.read))),
    ("bytes_written_at_most", |row| row.bytes(|bytes| Some(bytes.at_most?.written))),
    ("floor_ms", |row| row.of_pass(|pass| pass.floor_ms)),
    ("bound", |row| row.of_pass(|pass| pass.bound.clone())),
    ("share_of_limit", |row| row.of_pass(Pass::fraction_of_limit)),
    ("limit_vertex_gvertices_s", |row| row.limit("vertex_gvertices_s")),
    ("limit_triangle_gtriangles_s", |row| row.limit("triangle_gtriangles_s")),
    ("limit_issue_ginvocations_s", |row| row.limit("issue_ginvocations_s")),
    ("limit_empty_draw_ms", |row| row.limit("empty_draw_ms")),
    ("limit_empty_dispatch_ms", |row| row.limit("empty_dispatch_ms")),
    ("started", |row| cell(row.run.started.as_ref())),
    ("program_sha256", |row| cell(row.record.environment.build.executable_sha256.as_ref())),
    ("limit_small_copy_gb_s", |row| row.limit("small_copy_gb_s")),
    ("limit_fill_r32f_gpix_s", |row| row.limit("fill_r32f_gpix_s")),
    ("limit_fill_rgba16f_gpix_s", |row| row.limit("fill_rgba16f_gpix_s")),
    ("limit_fill_rgba32f_gpix_s", |row| row.limit("fill_rgba32f_gpix_s")),
    ("limit_blend_r32f_gpix_s", |row| row.limit("blend_r32f_gpix_s")),
    ("limit_blend_rgba16f_gpix_s", |row| row.limit("blend_rgba16f_gpix_s")),
    ("limit_blend_rgba32f_gpix_s", |row| row.limit("blend_rgba32f_gpix_s")),
];

impl Row<'_> {
    fn frame(&self, value: fn(&Summary) -> Option<f64>) -> String {
        cell(self.run.frame_ms.as_ref().and_then(value))
    }

    fn of_pass<T: ToString>(&self, value: fn(&Pass) -> Option<T>) -> String {
        cell(self.pass.and_then(|(_, pass)| value(pass)))
    }

    fn statistic(&self, value: fn(&Statistics) -> Option<u64>) -> String {
        cell(self.pass.and_then(|(_, pass)| value(pass.statistics.as_ref()?)))
    }

    fn limit(&self, name: &str) -> String {
        cell(self.run.limits.as_ref().and_then(|limits| limits.value(name)))
    }

    fn bytes(&self, value: fn(&Bytes) -> Option<u64>) -> String {
        cell(self.pass.and_then(|(_, pass)| value(pass.bytes.as_ref()?)))
    }
}

fn cell(value: Option<impl ToString>) -> String {
    value.map_or_else(String::new, |value| value.to_string())
}

fn json(value: &impl serde::Serialize) -> String {
    serde_json::to_string(value).unwrap_or_default()
}

/// The whole record with its header line.
pub fn to_string(record: &Record) -> String {
    let mut rows = vec![COLUMNS.map(|(name, _)| name.to_owned())];
    for run in &record.runs {
        let passes = run.passes.iter().enumerate().map(Some);
        let passes = passes.chain(run.passes.is_empty().then_some(None));
        rows.extend(passes.map(|pass| COLUMNS.map(|(_, cell)| cell(&Row { record, run, pass }))));
    }
    lines(Terminator::CRLF, rows)
}

/// A cell that no spreadsheet takes for a formula: an apostrophe goes before what begins like one, but for numbers.
fn guarded(cell: &[u8]) -> Cow<'_, [u8]> {
    let begins = matches!(cell, [b'=' | b'+' | b'-' | b'@' | b'\t' | b'\r', _, ..]);
    let is_number = || std::str::from_utf8(cell).is_ok_and(|text| text.parse::<f64>().is_ok());
    if begins && !is_number() { [b"'", cell].concat().into() } else { cell.into() }
}

/// Rows of cells as CSV text, each cell quoted where it holds a comma, a quote or a line break, and guarded where it
/// begins like a formula.
pub fn lines<C: AsRef<[u8]>>(
    terminator: Terminator,
    rows: impl IntoIterator<Item = impl IntoIterator<Item = C>>,
) -> String {
    let mut writer = WriterBuilder::new().flexible(true).terminator(terminator).from_writer(Vec::new());
    for row in rows {
        // Rows of any length into memory cannot fail.
        let _infallible = writer.write_record(row.into_iter().map(|cell| guarded(cell.as_ref()).into_owned()));
    }
    String::from_utf8(writer.into_inner().unwrap_or_default()).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::statistics::summarize;
    use crate::report::example;
    use crate::report::limits::LIMITS;

    /// An independent reader of RFC 4180.
    fn parse(text: &str) -> Vec<Vec<String>> {
        let (mut rows, mut row, mut cell) = (vec![], vec![], String::new());
        let mut quoted = false;
        let mut rest = text.chars().peekable();
        while let Some(c) = rest.next() {
            match c {
                '"' if quoted && rest.peek() == Some(&'"') => cell.extend(rest.next()),
                '"' => quoted = !quoted,
                ',' if !quoted => row.push(std::mem::take(&mut cell)),
                '\r' if !quoted => {
                    assert_eq!(rest.next(), Some('\n'));
                    row.push(std::mem::take(&mut cell));
                    rows.push(std::mem::take(&mut row));
                }
                other => cell.push(other),
            }
        }
        assert!(!quoted && row.is_empty() && cell.is_empty());
        rows
    }

    fn value<'a>(rows: &'a [Vec<String>], row: usize, column: &str) -> &'a str {
        let index = rows[0].iter().position(|name| name == column).unwrap();
        &rows[row][index]
    }

    #[test]
    fn one_row_per_pass_under_the_header() {
        let rows = parse(&to_string(&example::full()));
        assert_eq!(rows[0], COLUMNS.map(|(name, _)| name));
        assert_eq!(rows.len(), 3);
        assert!(rows.iter().all(|row| row.len() == COLUMNS.len()));
        assert_eq!(value(&rows, 1, "results"), r#"{"fps":200.0}"#);
        assert!(value(&rows, 2, "experiment").contains(r#""ratio":0.125"#));
        assert_eq!(value(&rows, 1, "pass"), "cluster");
        assert_eq!(value(&rows, 1, "gpu_median_ms"), "");
        assert_eq!(value(&rows, 1, "host_median_ms"), "0.5");
        assert_eq!(value(&rows, 2, "gpu_median_ms"), "2");
        assert_eq!(value(&rows, 2, "primitives"), "");
        assert_eq!(value(&rows, 2, "bytes_written"), "2048");
        assert_eq!(value(&rows, 2, "limit_copy_gb_s"), "6.5");
        assert_eq!(value(&rows, 2, "frame_median_ms"), "5");
    }

    #[test]
    fn every_limit_has_a_column_of_its_own() {
        let mut record = example::full();
        let limits = record.runs[0].limits.as_mut().unwrap();
        for (index, (name, ..)) in LIMITS.iter().enumerate() {
            limits.samples.extend(summarize(&[index as f64 + 0.5]).map(|rates| ((*name).to_owned(), rates)));
        }
        let rows = parse(&to_string(&record));
        for (index, (name, ..)) in LIMITS.iter().enumerate() {
            // A field of the record's own goes before the samples.
            let expected = if *name == "copy_gb_s" { 6.5 } else { index as f64 + 0.5 };
            assert_eq!(value(&rows, 1, &format!("limit_{name}")), expected.to_string());
        }
    }

    #[test]
    fn commas_quotes_and_line_breaks_survive() {
        let mut record = example::full();
        record.runs[0].passes[1].name = "a,\"b\"\r\nc".to_owned();
        let rows = parse(&to_string(&record));
        assert_eq!(value(&rows, 2, "pass"), "a,\"b\"\r\nc");
        assert_eq!(value(&rows, 2, "section"), "4.2, \"splats\"");
        let config: serde_json::Value = serde_json::from_str(value(&rows, 2, "config")).unwrap();
        assert_eq!(config["density"][1], 24);
    }

    #[test]
    fn no_cell_is_a_formula() {
        for (name, expected) in [
            ("=1+1", "'=1+1"),
            ("+cmd|' /C calc'!A0", "'+cmd|' /C calc'!A0"),
            ("-2+3", "'-2+3"),
            ("@SUM(A1)", "'@SUM(A1)"),
            ("\t=1", "'\t=1"),
            ("a=1", "a=1"),
            ("-", "-"),
        ] {
            let mut record = example::full();
            record.runs[0].passes[1].name = name.to_owned();
            record.runs[0].overlap_ms = Some(-1.5);
            let rows = parse(&to_string(&record));
            assert_eq!(value(&rows, 2, "pass"), expected);
            assert_eq!(value(&rows, 2, "overlap_ms"), "-1.5");
        }
    }

    #[test]
    fn a_run_without_passes_keeps_a_row() {
        let rows = parse(&to_string(&example::minimal()));
        assert_eq!(rows.len(), 2);
        assert_eq!(value(&rows, 1, "paper"), "gas");
        assert_eq!(value(&rows, 1, "frame_median_ms"), "");
        assert_eq!(value(&rows, 1, "pass"), "");
    }
}
