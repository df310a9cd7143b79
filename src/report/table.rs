//! A text table with aligned columns.

use anstyle::{AnsiColor, Effects};
pub use comfy_table::CellAlignment as Align;
use comfy_table::{ColumnConstraint, presets};

use super::text::one_line;

/// Decoration of text for people.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Style {
    /// ANSI colours may be used.
    pub color: bool,
}

impl Style {
    /// Colours on a terminal, unless `NO_COLOR` is set and not empty (no-color.org).
    pub fn detect(is_terminal: bool) -> Self {
        let refused = std::env::var_os("NO_COLOR").is_some_and(|value| !value.is_empty());
        Self { color: is_terminal && !refused }
    }

    pub fn bold(self, text: &str) -> String {
        self.paint(Effects::BOLD.into(), text)
    }

    pub fn dim(self, text: &str) -> String {
        self.paint(Effects::DIMMED.into(), text)
    }

    pub fn red(self, text: &str) -> String {
        self.paint(AnsiColor::Red.on_default(), text)
    }

    pub fn green(self, text: &str) -> String {
        self.paint(AnsiColor::Green.on_default(), text)
    }

    pub fn yellow(self, text: &str) -> String {
        self.paint(AnsiColor::Yellow.on_default(), text)
    }

    fn paint(self, style: anstyle::Style, text: &str) -> String {
        if self.color { format!("{style}{text}{style:#}") } else { text.to_owned() }
    }
}

/// A number in a cell, with `digits` after the point; an absent one leaves the cell empty.
pub fn number(value: Option<f64>, digits: usize) -> String {
    value.map_or(String::new(), |value| format!("{value:.digits$}"))
}

/// An interval of a ratio in a cell; an absent one leaves the cell empty.
pub fn interval(ends: Option<[f64; 2]>) -> String {
    ends.map_or(String::new(), |[low, high]| format!("{low:.3} to {high:.3}"))
}

/// Rows under a header. Cells are plain text without colour and without line breaks.
#[derive(Clone, Debug)]
pub struct Table {
    table: comfy_table::Table,
    alignment: Vec<Align>,
}

impl Table {
    /// A table without rows: the name and alignment of each column.
    pub fn new(columns: &[(&str, Align)]) -> Self {
        let mut table = comfy_table::Table::new();
        table.load_preset(presets::NOTHING).set_header(columns.iter().map(|(name, _)| name));
        for (column, (_, align)) in table.column_iter_mut().zip(columns) {
            column.set_padding((0, 2)).set_cell_alignment(*align);
        }
        Self { table, alignment: columns.iter().map(|(_, align)| *align).collect() }
    }

    /// Adds a row; missing cells are empty. A cell stays on its line whatever it holds.
    pub fn push(&mut self, row: Vec<String>) {
        self.table.add_row(row.iter().map(|cell| one_line(cell)));
    }

    /// The table, each line ending in a newline. Columns in which no row has anything are left out.
    pub fn render(&self, style: Style) -> String {
        let mut table = self.table.clone();
        let is_empty =
            |column: usize| self.table.column_cells_iter(column).flatten().all(|cell| cell.content().is_empty());
        for (_, column) in table.column_iter_mut().enumerate().filter(|(index, _)| is_empty(*index)) {
            column.set_constraint(ColumnConstraint::Hidden);
        }
        let text = table.trim_fmt();
        match text.split_once('\n') {
            Some((header, rows)) => format!("{}\n{rows}\n", style.bold(header)),
            None => "\n".to_owned(),
        }
    }

    /// Name of each column, and whether it holds numbers.
    pub fn columns(&self) -> Vec<(String, bool)> {
        let names = self.table.header().into_iter().flat_map(|header| header.cell_iter().map(|cell| cell.content()));
        names.zip(&self.alignment).map(|(name, align)| (name, *align == Align::Right)).collect()
    }

    /// Cells of each row.
    pub fn rows(&self) -> Vec<Vec<String>> {
        self.table.row_iter().map(|row| row.cell_iter().map(|cell| cell.content()).collect()).collect()
    }

    /// The table in Markdown.
    pub fn markdown(&self) -> String {
        let line = |row: &comfy_table::Row| {
            row.cell_iter().fold("|".to_owned(), |line, cell| line + " " + &markdown_text(&cell.content()) + " |")
        };
        let aligned = self.alignment.iter().map(|align| match align {
            Align::Right => " ---: |",
            _ => " --- |",
        });
        let header = self.table.header().map(line).unwrap_or_default();
        let rule: String = std::iter::once("|").chain(aligned).collect();
        let rows = self.table.row_iter().map(|row| line(row) + "\n");
        format!("{header}\n{rule}\n{}", rows.collect::<String>())
    }
}

/// Text that Markdown shows as it is.
pub fn markdown_text(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for character in text.chars() {
        if r"\`*_{}[]<>#|".contains(character) {
            escaped.push('\\');
        }
        escaped.push(character);
    }
    escaped
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_are_aligned_and_empty_ones_left_out() {
        let mut table = Table::new(&[("pass", Align::Left), ("note", Align::Left), ("ms", Align::Right)]);
        table.push(vec!["a".into(), String::new(), "1.0 ± 0.1".into()]);
        table.push(vec!["longer".into(), String::new(), "10.0".into()]);
        let expected = "pass           ms\na       1.0 ± 0.1\nlonger       10.0\n";
        assert_eq!(table.render(Style::default()), expected);
    }

    #[test]
    fn markdown_keeps_its_columns_whatever_a_cell_says() {
        let mut table = Table::new(&[("pass", Align::Left), ("ms", Align::Right)]);
        table.push(vec!["a|b <i>".into(), "1.0".into()]);
        assert_eq!(table.markdown(), "| pass | ms |\n| --- | ---: |\n| a\\|b \\<i\\> | 1.0 |\n");
    }

    #[test]
    fn colour_is_only_used_when_asked_for() {
        let mut table = Table::new(&[("pass", Align::Left)]);
        table.push(vec!["a".into()]);
        assert!(!table.render(Style { color: false }).contains('\x1b'));
        assert!(table.render(Style { color: true }).contains('\x1b'));
        assert!(!Style::detect(false).color);
    }
}
