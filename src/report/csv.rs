//! Runs as comma-separated values (RFC 4180): one row per run and pass, for spreadsheets and data frames.
//!
//! The columns are [`COLUMNS`]. A run without passes keeps one row with empty pass cells. Absent is an empty cell. Raw
//! samples are in the JSON only. `config`, `results` and `experiment` are JSON objects: the run's
//! parameters, the paper's own figures, and the row of a table that it reproduces.

use super::record::{Bytes, Pass, Record, Run, Statistics, Summary};

/// The header, in order. Times are milliseconds, sizes bytes.
pub const COLUMNS: [&str; 43] = [
    "device",
    "device_type",
    "paper",
    "variant",
    "preset",
    "width",
    "height",
    "seed",
    "warmup",
    "frames",
    "repeat",
    "process",
    "config",
    "results",
    "experiment",
    "frame_min_ms",
    "frame_median_ms",
    "frame_mean_ms",
    "frame_p95_ms",
    "frame_p99_ms",
    "frame_max_ms",
    "frame_mad_ms",
    "overlap_ms",
    "unaccounted_ms",
    "pass_index",
    "pass",
    "section",
    "kind",
    "calls",
    "submission",
    "shader_compiler",
    "gpu_min_ms",
    "gpu_median_ms",
    "gpu_mad_ms",
    "host_median_ms",
    "wait_median_ms",
    "vertices",
    "primitives",
    "fragments",
    "compute_invocations",
    "samples_passed",
    "bytes_read",
    "bytes_written",
];

/// The whole record with its header line.
pub fn to_string(record: &Record) -> String {
    let mut text = String::new();
    push_row(&mut text, COLUMNS.map(str::to_owned));
    for run in &record.runs {
        let passes: Vec<Option<(usize, &Pass)>> =
            if run.passes.is_empty() { vec![None] } else { run.passes.iter().enumerate().map(Some).collect() };
        for pass in passes {
            push_row(&mut text, row(record, run, pass));
        }
    }
    text
}

fn row(record: &Record, run: &Run, pass: Option<(usize, &Pass)>) -> [String; COLUMNS.len()] {
    let frame = |value: fn(&Summary) -> Option<f64>| cell(run.frame_ms.as_ref().and_then(value));
    let (index, pass) = pass.unzip();
    let statistic =
        |value: fn(&Statistics) -> Option<u64>| cell(pass.and_then(|pass| pass.statistics.as_ref()).and_then(value));
    let bytes = |value: fn(Bytes) -> u64| cell(pass.and_then(|pass| pass.bytes).map(value));
    let gpu = |value: fn(&Summary) -> Option<f64>| cell(pass.and_then(|pass| pass.gpu_ms.as_ref()).and_then(value));
    let median =
        |time: fn(&Pass) -> &Option<Summary>| cell(pass.and_then(|pass| time(pass).as_ref()).map(|time| time.median));
    let device = &record.environment.device;
    [
        device.name.clone(),
        device.kind.name().to_owned(),
        run.paper.clone(),
        run.variant.clone(),
        cell(run.preset.as_ref()),
        run.width.to_string(),
        run.height.to_string(),
        run.seed.to_string(),
        run.warmup.to_string(),
        run.frames.to_string(),
        run.repeat.to_string(),
        run.process.to_string(),
        serde_json::Value::Object(run.config.clone()).to_string(),
        serde_json::Value::Object(run.results.clone()).to_string(),
        cell(run.experiment.as_ref().and_then(|row| serde_json::to_string(row).ok())),
        frame(|time| Some(time.min)),
        frame(|time| Some(time.median)),
        frame(|time| Some(time.mean)),
        frame(|time| time.p95),
        frame(|time| time.p99),
        frame(|time| Some(time.max)),
        frame(|time| time.mad),
        cell(run.overlap_ms),
        cell(run.unaccounted_ms),
        cell(index),
        cell(pass.map(|pass| &pass.name)),
        cell(pass.and_then(|pass| pass.section.as_ref())),
        cell(pass.map(|pass| pass.kind.name())),
        cell(pass.map(|pass| pass.calls)),
        cell(pass.and_then(|pass| pass.submission)),
        cell(pass.and_then(|pass| pass.shader_compiler.as_ref())),
        gpu(|time| Some(time.min)),
        gpu(|time| Some(time.median)),
        gpu(|time| time.mad),
        median(|pass| &pass.host_ms),
        median(|pass| &pass.wait_ms),
        statistic(|value| value.vertices),
        statistic(|value| value.primitives),
        statistic(|value| value.fragments),
        statistic(|value| value.compute_invocations),
        statistic(|value| value.samples_passed),
        bytes(|value| value.read),
        bytes(|value| value.written),
    ]
}

fn cell(value: Option<impl ToString>) -> String {
    value.map_or_else(String::new, |value| value.to_string())
}

fn push_row(text: &mut String, cells: [String; COLUMNS.len()]) {
    text.push_str(&cells.map(|cell| quote(&cell)).join(","));
    text.push_str("\r\n");
}

/// A cell, quoted where it holds a comma, a quote or a line break.
pub fn quote(cell: &str) -> String {
    if cell.contains([',', '"', '\n', '\r']) { format!("\"{}\"", cell.replace('"', "\"\"")) } else { cell.to_owned() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::example;

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
        assert_eq!(rows[0], COLUMNS);
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
        assert_eq!(value(&rows, 2, "frame_median_ms"), "5");
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
    fn a_run_without_passes_keeps_a_row() {
        let rows = parse(&to_string(&example::minimal()));
        assert_eq!(rows.len(), 2);
        assert_eq!(value(&rows, 1, "paper"), "gas");
        assert_eq!(value(&rows, 1, "frame_median_ms"), "");
        assert_eq!(value(&rows, 1, "pass"), "");
    }
}
