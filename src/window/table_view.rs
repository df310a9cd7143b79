//! A buffer as a table of its rows.

use egui::{DragValue, RichText, ScrollArea, Ui};

use super::protocol::{TABLE_VALUES, TargetInfo, TargetShape, TargetValues, ValueKind};
use super::target_view::cell;

/// Columns that are shown at once.
const COLUMNS: u32 = 64;

/// The rows that came; gives the first row that the user wants instead.
pub fn show(ui: &mut Ui, values: &TargetValues, first: u64, info: &TargetInfo) -> Option<u64> {
    let TargetShape::Table { rows, columns } = info.shape else { return None };
    let mut wanted = None;
    let at_once = (TABLE_VALUES / columns.max(1)).max(1);
    if rows > at_once {
        ui.horizontal(|ui| {
            let mut row = first;
            let most = rows.saturating_sub(1);
            let field =
                ui.add(DragValue::new(&mut row).range(0..=most).speed(at_once as f64 / 100.0).prefix("from row "));
            if field.changed() {
                wanted = Some(row);
            }
            ui.weak(format!("{} of {rows} rows are here", values.height));
        });
    }
    show_statistics(ui, values);
    let shown = values.width.min(COLUMNS);
    let height = ui.text_style_height(&egui::TextStyle::Monospace);
    ScrollArea::both().auto_shrink(false).show_rows(ui, height, values.height as usize, |ui, range| {
        for row in range {
            let row = row as u32;
            let cells = (0..shown).map(|column| match (cell(values, row, column), values.kind) {
                (Some(number), ValueKind::F32) => format!("{number:>14.6}"),
                (Some(number), _) => format!("{number:>12}"),
                (None, _) => String::new(),
            });
            let text = cells.collect::<Vec<_>>().join(" ");
            ui.horizontal(|ui| {
                ui.label(RichText::new(format!("{:>9}", first + u64::from(row))).monospace().weak());
                ui.label(RichText::new(text).monospace());
            });
        }
    });
    wanted
}

fn show_statistics(ui: &mut Ui, values: &TargetValues) {
    ui.horizontal_wrapped(|ui| {
        for statistics in values.statistics.iter().take(4) {
            if let (Some(min), Some(max), Some(mean)) = (statistics.min, statistics.max, statistics.mean) {
                ui.weak(format!("min {min:.5}, mean {mean:.5}, max {max:.5}"));
            }
        }
    });
}
