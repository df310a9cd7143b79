//! The papers' pages have the tables of options that the declarations make; `FUMAROLE_BLESS=1` writes them.

use std::fs;
use std::path::PathBuf;

use fumarole::cli::options_table;
use fumarole::measure::study::{Study, Visitor};
use fumarole::papers;

const BEGIN: &str = "<!-- options -->\n";
const END: &str = "<!-- end of options -->";

struct Pages;

impl Visitor for Pages {
    type Error = String;

    fn visit<S: Study>(&mut self) -> Result<(), String> {
        let path = PathBuf::from(format!("{}/docs/{}.md", env!("CARGO_MANIFEST_DIR"), S::PAPER));
        let page = fs::read_to_string(&path).map_err(|e| format!("{}: {e}", path.display()))?;
        let (head, rest) = page.split_once(BEGIN).ok_or(format!("{} has no {BEGIN:?}", path.display()))?;
        let (table, tail) = rest.split_once(END).ok_or(format!("{} has no {END:?}", path.display()))?;
        let made = format!("\n{}\n", options_table::<S>());
        if table == made {
            return Ok(());
        }
        if std::env::var_os("FUMAROLE_BLESS").is_none() {
            return Err(format!("{}: its options differ from the declarations; bless it", path.display()));
        }
        fs::write(&path, format!("{head}{BEGIN}{made}{END}{tail}")).map_err(|e| e.to_string())
    }
}

#[test]
fn pages_list_the_options_that_are_declared() {
    assert_eq!(papers::each(&mut Pages), Ok(()));
}
