//! Tables of experiments that time nothing.

use csv::Terminator;
use serde_json::Value;

use crate::report::csv::lines;
use crate::report::plot::{BarChart, BarSeries, LineChart, PlotError, Scale, Series};
use crate::report::table::{Align, Style, Table};
use crate::report::tables::{self, shown};

/// A table of an experiment that times nothing: for the console and, row by row, for JSON and CSV.
pub struct ResultTable {
    /// Line above the table.
    pub title: &'static str,
    /// Headings, with units.
    pub columns: &'static [&'static str],
    /// Cells of each row, one per column.
    pub rows: Vec<Vec<Value>>,
}

impl ResultTable {
    /// For the console.
    pub fn render(&self, style: Style) -> String {
        format!("{}\n{}", self.title, self.table().render(style))
    }

    fn table(&self) -> Table {
        let columns: Vec<(&str, Align)> = self.columns.iter().map(|&c| (c, Align::Right)).collect();
        let mut table = Table::new(&columns);
        for row in &self.rows {
            table.push(row.iter().map(shown).collect());
        }
        table
    }

    /// Bars of some columns for each row, which is called by the columns before the first of them.
    ///
    /// # Errors
    /// [`PlotError`] when no row has a number in those columns.
    pub fn bars(&self, y_label: &str, columns: &[&str]) -> Result<String, PlotError> {
        let at = |name: &str| self.columns.iter().position(|column| *column == name);
        let first = columns.iter().filter_map(|name| at(name)).min().unwrap_or(0);
        let name_of = |row: &Vec<Value>| row[..first].iter().map(shown).collect::<Vec<_>>().join(" ");
        let series = columns.iter().filter_map(|name| {
            let column = at(name)?;
            let values = self.rows.iter().map(|row| row.get(column).and_then(Value::as_f64)).collect();
            Some(BarSeries { name: (*name).to_owned(), values })
        });
        let chart = BarChart {
            title: self.title.to_owned(),
            y_label: y_label.to_owned(),
            groups: self.rows.iter().map(name_of).collect(),
            series: series.collect(),
        };
        chart.to_svg()
    }

    /// Lines of some columns over column `x`: one for each of them and each combination of the rows' texts.
    ///
    /// # Errors
    /// [`PlotError`] when no row has a number in those columns.
    pub fn lines(&self, x: &str, y_label: &str, columns: &[&str]) -> Result<String, PlotError> {
        let at = |name: &str| self.columns.iter().position(|column| *column == name);
        let x_column = at(x).unwrap_or(0);
        let mut series: Vec<Series> = Vec::new();
        for row in &self.rows {
            let names = row.iter().enumerate().filter(|(column, value)| *column != x_column && value.is_string());
            let names: Vec<String> = names.map(|(_, value)| shown(value)).collect();
            for column in columns {
                let value = |column: usize| row.get(column).and_then(Value::as_f64);
                let Some(point) = value(x_column).zip(at(column).and_then(value)) else { continue };
                let name = match (columns.len() > 1, names.is_empty()) {
                    (true, true) => (*column).to_owned(),
                    (true, false) => format!("{}, {column}", names.join(" ")),
                    (false, _) => names.join(" "),
                };
                match series.iter_mut().find(|s| s.name == name) {
                    Some(line) => line.points.push(point),
                    None => series.push(Series { name, points: vec![point], reference: *column == "thesis" }),
                }
            }
        }
        let chart = LineChart {
            title: self.title.to_owned(),
            x_label: x.to_owned(),
            y_label: y_label.to_owned(),
            x_scale: Scale::Linear,
            y_scale: Scale::Linear,
            series,
        };
        chart.to_svg()
    }

    /// For the document: the cells of each row by their columns.
    pub fn document(&self) -> tables::Rows {
        let row = |row: &Vec<Value>| {
            tables::Row(self.columns.iter().zip(row).map(|(name, value)| ((*name).to_owned(), value.clone())).collect())
        };
        tables::Rows {
            title: self.title.to_owned(),
            columns: self.columns.iter().map(|&name| name.to_owned()).collect(),
            rows: self.rows.iter().map(row).collect(),
        }
    }

    /// Comma-separated, with a header.
    pub fn csv(&self) -> String {
        let header = self.columns.iter().map(|&name| name.to_owned()).collect();
        let rows = self.rows.iter().map(|row| row.iter().map(shown).collect::<Vec<String>>());
        lines(Terminator::Any(b'\n'), std::iter::once(header).chain(rows))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn bars_are_called_by_the_columns_before_them() {
        let rows = vec![
            vec![json!("teapot"), json!(11), json!(8), json!(7)],
            vec![json!("sphere"), json!(11), json!(5), Value::Null],
        ];
        let table = ResultTable { title: "Planes", columns: &["mesh", "specified", "drawn", "thesis"], rows };
        let svg = table.bars("planes", &["drawn", "thesis"]).unwrap();
        for text in ["Planes", "teapot 11", "sphere 11", "drawn", "thesis"] {
            assert!(svg.contains(text), "{text} is missing");
        }
        assert!(table.bars("planes", &["no such column"]).is_err());
        let svg = table.lines("specified", "planes", &["drawn", "thesis"]).unwrap();
        for text in ["teapot, drawn", "teapot, thesis", "sphere, drawn"] {
            assert!(svg.contains(text), "{text} is missing");
        }
        assert!(!svg.contains("sphere, thesis"));
        let rows = vec![vec![json!(1), json!(2), json!(3)], vec![json!(2), json!(3), json!(4)]];
        let nameless = ResultTable { title: "Nameless", columns: &["time", "front", "back"], rows };
        let svg = nameless.lines("time", "metres", &["front", "back"]).unwrap();
        assert!(svg.contains("front") && svg.contains("back") && !svg.contains(", front"), "{svg}");
    }
}
