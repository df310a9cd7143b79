//! The papers' pages have the tables of options that the declarations make; `FUMAROLE_BLESS=1` writes them.

use std::fs;
use std::path::PathBuf;

use fumarole::cli::{axes_table, options_table};
use fumarole::measure::study::{Study, Visitor};
use fumarole::papers;

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
