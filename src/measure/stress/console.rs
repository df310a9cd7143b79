//! A record of `stress` as tables: for the console, and to paste.

use super::costs::device_bytes;
use super::plots::series_name;
use crate::report::stress::{Cost, Segment, Series, Step, Stop, StressRecord};
use crate::report::table::{Align, Style, Table, number};

/// Form of the tables.
#[derive(Debug, Clone, Copy)]
pub enum Form {
    Console(Style),
    Markdown,
}

/// The steps, the costs and the end of every series.
pub fn tables(record: &StressRecord, form: Form) -> String {
    let device = &record.environment.device;
    let mut text = format!("{} stress, {}: {}\n", record.paper, record.axis.name, record.axis.help);
    text += &format!("{} ({})\n", device.name, device.driver_version.as_deref().unwrap_or("driver unknown"));
    for series in &record.series {
        text += &match form {
            Form::Console(style) => format!("\n{}\n", style.bold(&series_name(record, series))),
            Form::Markdown => format!("\n**{}**\n\n", series_name(record, series)),
        };
        let tables = [steps(record, series), costs(record, series)];
        for table in tables.iter().filter(|table| !table.rows().is_empty()) {
            text += &match form {
                Form::Console(style) => table.render(style),
                Form::Markdown => table.markdown(),
            };
            text += "\n";
        }
        if let Some(stop) = &series.stop {
            text += &format!("{}\n", stop_line(record, stop));
        }
    }
    text
}

/// `stopped by memory at 64000000 triangles: reason`.
pub fn stop_line(record: &StressRecord, stop: &Stop) -> String {
    format!("stopped by {} at {} {}: {}", stop.kind.as_str(), stop.value, record.axis.unit, stop.reason)
}

fn steps(record: &StressRecord, series: &Series) -> Table {
    let unit = &record.axis.amount_unit;
    let per_second = format!("{unit} a second");
    let has_amounts = series.steps.iter().any(|step| step.amount != step.value as f64);
    let mut columns = vec![(record.axis.name.as_str(), Align::Right)];
    columns.extend(has_amounts.then_some((unit.as_str(), Align::Right)));
    columns.extend([
        ("frame ms", Align::Right),
        (per_second.as_str(), Align::Right),
        ("load ms", Align::Right),
        ("upload and pipelines ms", Align::Right),
        ("device MB", Align::Right),
        ("process MB", Align::Right),
        ("largest resource", Align::Left),
        ("slowest pass", Align::Left),
        ("seconds", Align::Right),
    ]);
    let mut table = Table::new(&columns);
    for step in &series.steps {
        let run = &step.run;
        let mut row = vec![step.value.to_string()];
        row.extend(has_amounts.then(|| format!("{:.0}", step.amount)));
        row.extend([
            number(run.median_frame_ms(), 2),
            step.throughput_per_s.map_or_else(String::new, significant),
            number(run.load_ms, 1),
            number(run.pipeline_ms, 1),
            number(device_bytes(run).map(|bytes| bytes / 1e6), 1),
            number(step.peak_bytes.map(|bytes| bytes as f64 / 1e6), 0),
            largest(step).unwrap_or_default(),
            slowest(step).unwrap_or_default(),
            format!("{:.1}", step.wall_s),
        ]);
        table.push(row);
    }
    table
}

fn largest(step: &Step) -> Option<String> {
    let resource = step.run.memory.by_resource.iter().max_by_key(|resource| resource.bytes)?;
    Some(format!("{}, {:.1} MB", resource.name, resource.bytes as f64 / 1e6))
}

fn slowest(step: &Step) -> Option<String> {
    let times = step
        .run
        .passes
        .iter()
        .filter_map(|pass| Some((&pass.name, pass.gpu_ms.as_ref().or(pass.host_ms.as_ref())?.median)));
    let (name, time) = times.max_by(|a, b| a.1.total_cmp(&b.1))?;
    Some(format!("{name}, {time:.1} ms"))
}

fn costs(record: &StressRecord, series: &Series) -> Table {
    let knee = format!("knee at {}", record.axis.amount_unit);
    let mut table = Table::new(&[
        ("cost", Align::Left),
        ("clock", Align::Left),
        ("points", Align::Right),
        ("exponent", Align::Right),
        ("95 %", Align::Left),
        (&knee, Align::Right),
        ("exponent after it", Align::Right),
        ("95 %", Align::Left),
    ]);
    let interval = |segment: Option<&Segment>| {
        segment
            .and_then(|segment| segment.interval)
            .map_or_else(String::new, |[low, high]| format!("{low:.2} to {high:.2}"))
    };
    for Cost { name, clock, scaling } in &series.costs {
        let Some(scaling) = scaling else { continue };
        let [first, second] = [scaling.segments.first(), scaling.segments.get(1)];
        table.push(vec![
            name.clone(),
            clock.clone().unwrap_or_default(),
            scaling.points.to_string(),
            number(first.map(|segment| segment.exponent), 2),
            interval(first),
            scaling.knee.map_or_else(String::new, significant),
            number(second.map(|segment| segment.exponent), 2),
            interval(second),
        ]);
    }
    table
}

/// Three significant digits of what is large, without an exponent where it is short.
fn significant(value: f64) -> String {
    if value >= 1e15 {
        return format!("{value:.2e}");
    }
    let digits = if value > 0.0 { 2 - value.log10().floor() as i32 } else { 0 };
    let scale = 10f64.powi(digits.min(6));
    let rounded = (value * scale).round() / scale;
    format!("{rounded:.*}", usize::try_from(digits.clamp(0, 6)).unwrap_or(0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn large_numbers_have_three_digits() {
        let texts = [0.0, 0.001234, 1.0, 8.254, 12.34, 999.9, 123_456.0, 3.5e9].map(significant);
        assert_eq!(texts, ["0", "0.00123", "1.00", "8.25", "12.3", "1000", "123000", "3500000000"]);
    }
}
