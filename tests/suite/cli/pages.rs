//! The papers' pages have the tables of options that the declarations make, which `FUMAROLE_BLESS=1` writes, and the README the
//! passes of each variant.

use std::fs;
use std::path::PathBuf;

use fumarole::cli::{axes_table, options_table};
use fumarole::measure::study::{Study, Visitor};
use fumarole::papers;

use super::program::fumarole;

struct Pages;

impl Visitor for Pages {
    type Error = String;

    fn visit<S: Study>(&mut self) -> Result<(), String> {
        check(S::PAPER, "options", &options_table::<S>())?;
        check(S::PAPER, "axes", &axes_table::<S>())
    }
}

/// The part of a paper's page between `<!-- what -->` and `<!-- end of what -->` is `table`, or becomes it.
fn check(paper: &str, what: &str, table: &str) -> Result<(), String> {
    let (begin, end) = (format!("<!-- {what} -->\n"), format!("<!-- end of {what} -->"));
    let path = PathBuf::from(format!("{}/docs/{paper}.md", env!("CARGO_MANIFEST_DIR")));
    let page = fs::read_to_string(&path).map_err(|e| format!("{}: {e}", path.display()))?;
    let (head, rest) = page.split_once(&begin).ok_or(format!("{} has no {begin:?}", path.display()))?;
    let (found, tail) = rest.split_once(&end).ok_or(format!("{} has no {end:?}", path.display()))?;
    let made = format!("\n{table}\n");
    if found == made {
        return Ok(());
    }
    if std::env::var_os("FUMAROLE_BLESS").is_none() {
        return Err(format!("{}: its {what} differ from the declarations; bless it", path.display()));
    }
    fs::write(&path, format!("{head}{begin}{made}{end}{tail}")).map_err(|e| e.to_string())
}

#[test]
fn pages_list_the_options_and_axes_that_are_declared() {
    assert_eq!(papers::each(&mut Pages), Ok(()));
}

/// Names in backticks.
fn quoted(cell: &str) -> Vec<&str> {
    cell.split('`').skip(1).step_by(2).collect()
}

#[test]
fn the_readme_lists_the_passes_of_each_variant() {
    let page = fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/README.md")).unwrap();
    let (_, table) = page.split_once("## Papers, passes, shaders").unwrap();
    let (table, _) = table.split_once("## The window").unwrap();
    // Of each paper the variants in a row, with their passes; others say in words how they differ from a row above.
    type Passes<'a> = (&'a str, Vec<&'a str>);
    let mut rows: Vec<(&str, Vec<Passes<'_>>)> = Vec::new();
    for row in table.lines().filter(|line| line.starts_with("| ")) {
        let cells: Vec<&str> = row.split('|').map(str::trim).collect();
        if let Some(&paper) = quoted(cells[1]).first() {
            rows.push((paper, Vec::new()));
        }
        let passes = cells[3].split(';').next().unwrap_or_default();
        if let ([variant], true, Some((_, rows))) = (&quoted(cells[2])[..], passes.starts_with('`'), rows.last_mut()) {
            rows.push((variant, quoted(passes)));
        }
    }
    let mut compared = 0;
    for (paper, rows) in rows {
        let variants: Vec<&str> = rows.iter().map(|(variant, _)| *variant).collect();
        let passes = format!("{paper} passes --json --variant {}", variants.join(","));
        let listed = fumarole(&passes).on_test_device().run().succeeded().json();
        let listed = listed.as_array().unwrap();
        assert_eq!(listed.len(), rows.len(), "{paper}");
        for ((variant, passes), listed) in rows.iter().zip(listed) {
            let names = listed["passes"].as_array().unwrap().iter().map(|pass| pass["name"].as_str().unwrap());
            assert_eq!((*variant, passes), (listed["variant"].as_str().unwrap(), &names.collect()), "{paper}");
            compared += 1;
        }
    }
    assert!(compared >= 15, "{compared} rows");
}
