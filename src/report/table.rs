//! A text table with aligned columns.

/// How text for people is decorated.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Style {
    /// Whether ANSI colours may be used.
    pub color: bool,
}

impl Style {
    /// Colours on a terminal, unless `NO_COLOR` is set and not empty (no-color.org).
    pub fn detect(is_terminal: bool) -> Self {
        let refused = std::env::var_os("NO_COLOR").is_some_and(|value| !value.is_empty());
        Self { color: is_terminal && !refused }
    }

    pub fn bold(self, text: &str) -> String {
        self.paint("1", text)
    }

    pub fn dim(self, text: &str) -> String {
        self.paint("2", text)
    }

    pub fn red(self, text: &str) -> String {
        self.paint("31", text)
    }

    pub fn green(self, text: &str) -> String {
        self.paint("32", text)
    }

    pub fn yellow(self, text: &str) -> String {
        self.paint("33", text)
    }

    fn paint(self, code: &str, text: &str) -> String {
        if self.color { format!("\x1b[{code}m{text}\x1b[0m") } else { text.to_owned() }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Align {
    Left,
    Right,
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
    columns: Vec<(String, Align)>,
    rows: Vec<Vec<String>>,
}

impl Table {
    pub fn new(columns: &[(&str, Align)]) -> Self {
        Self { columns: columns.iter().map(|&(name, align)| (name.to_owned(), align)).collect(), rows: vec![] }
    }

    /// Adds a row; missing cells are empty, cells beyond the last column are left out.
    pub fn push(&mut self, mut row: Vec<String>) {
        row.resize(self.columns.len(), String::new());
        self.rows.push(row);
    }

    /// The table, each line ending in a newline. Columns in which no row has anything are left out.
    pub fn render(&self, style: Style) -> String {
        let shown: Vec<usize> =
            (0..self.columns.len()).filter(|&column| self.rows.iter().any(|row| !row[column].is_empty())).collect();
        let width = |column: usize| {
            let cells = self.rows.iter().map(|row| row[column].as_str());
            cells.chain([self.columns[column].0.as_str()]).map(|cell| cell.chars().count()).max().unwrap_or(0)
        };
        let widths: Vec<usize> = shown.iter().map(|&column| width(column)).collect();
        let line = |cell: &dyn Fn(usize) -> String| {
            let cells = shown.iter().zip(&widths).map(|(&column, &width)| {
                let text = cell(column);
                match self.columns[column].1 {
                    Align::Left => format!("{text:<width$}"),
                    Align::Right => format!("{text:>width$}"),
                }
            });
            cells.collect::<Vec<_>>().join("  ").trim_end().to_owned()
        };
        let mut text = style.bold(&line(&|column| self.columns[column].0.clone()));
        text.push('\n');
        for row in &self.rows {
            text.push_str(&line(&|column| row[column].clone()));
            text.push('\n');
        }
        text
    }
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
    fn colour_is_only_used_when_asked_for() {
        let mut table = Table::new(&[("pass", Align::Left)]);
        table.push(vec!["a".into()]);
        assert!(!table.render(Style { color: false }).contains('\x1b'));
        assert!(table.render(Style { color: true }).contains('\x1b'));
        assert!(!Style::detect(false).color);
    }
}
