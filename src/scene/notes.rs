//! Notes of readers: what they pass over in a file that they read, for whoever asked for it.

use std::cell::RefCell;
use std::path::Path;

use super::error::Asset;

#[derive(Default)]
struct Notes {
    /// Of the file that is read.
    own: Vec<String>,
    /// Of the files before it.
    told: Vec<String>,
}

thread_local! {
    static NOTES: RefCell<Notes> = const { RefCell::new(Notes { own: Vec::new(), told: Vec::new() }) };
}

/// Says what the reader of a file passes over, in one line.
pub(super) fn add(note: impl Into<String>) {
    NOTES.with_borrow_mut(|notes| notes.own.push(note.into()));
}

/// Says in a whole line what is passed over in what a parameter names.
pub fn tell(line: String) {
    NOTES.with_borrow_mut(|Notes { told, .. }| {
        if !told.contains(&line) {
            told.push(line);
        }
    });
}

/// Result of a reader of the file at `path`, and true where it has notes; they begin with the file's name.
pub(super) fn of<T>(asset: Asset, path: &Path, read: impl FnOnce() -> T) -> (T, bool) {
    NOTES.with_borrow_mut(|notes| notes.own.clear());
    let result = read();
    let own = NOTES.with_borrow_mut(|notes| std::mem::take(&mut notes.own));
    let has_any = !own.is_empty();
    own.into_iter().for_each(|note| tell(format!("{asset} {}: {note}", path.display())));
    (result, has_any)
}

/// Those of the files that this thread has read since the last call, a line each, each once.
pub fn take() -> Vec<String> {
    NOTES.with_borrow_mut(|notes| std::mem::take(&mut notes.told))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn notes_name_their_file_and_come_once() {
        take();
        let read = |path: &str, notes: &[&'static str]| {
            let (given, has_any) = of(Asset::Mesh, Path::new(path), || {
                notes.iter().for_each(|note| add(*note));
                7
            });
            assert_eq!((given, has_any), (7, !notes.is_empty()), "{path}");
        };
        read("a.stl", &["one", "two"]);
        read("b.stl", &[]);
        read("a.stl", &["two"]);
        assert_eq!(take(), ["mesh a.stl: one", "mesh a.stl: two"]);
        assert_eq!(take(), Vec::<String>::new());
    }
}
