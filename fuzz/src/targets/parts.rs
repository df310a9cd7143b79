//! Readers of what several processes have left, and records as a page.

use std::fs;
use std::path::{Path, PathBuf};

use fumarole::cli::{self, Film};
use fumarole::measure::shard;
use fumarole::measure::shared_sweep::Assembled;
use fumarole::report::html::{self, Contents, Picture, Source};
use fumarole::report::record::Record;
use fumarole::report::stress::StressRecord;
use fumarole::report::{self, json};

use super::{document, is_one_line, parted, written};

/// An empty folder of this thread.
fn emptied(name: &str) -> PathBuf {
    let folder = written(&[("none", b"")]).with_file_name(name);
    let _none_yet = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).expect("room for a folder");
    folder
}

/// Names of what lies in a folder.
fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).expect("it is a folder");
    entries.map(|entry| entry.expect("it is readable").file_name().to_string_lossy().into_owned()).collect()
}

/// The shard that a record says it is of, where it is a record.
fn shard_of(data: &[u8]) -> Option<[u32; 2]> {
    let is_stress = std::str::from_utf8(data).ok().and_then(json::schema).as_deref() == Some(report::stress::SCHEMA);
    if is_stress {
        document::<StressRecord>(data, json::document)?.shard
    } else {
        document(data, json::parse)?.share?.shard
    }
}

/// Records of two shards, the second where there is a zero byte, joined.
pub fn shards(data: &[u8]) {
    let (folder, out) = (emptied("shards"), emptied("joined").join("out"));
    let (first, second) = parted(data);
    fs::write(folder.join("a-shard-0-of-2.json"), first).expect("room for a file");
    if data.contains(&0) {
        fs::write(folder.join("a-shard-1-of-2.json"), second).expect("room for a file");
    }
    let found = match cli::shards_in_folders(&[folder]) {
        Ok(found) => found,
        Err(error) => return assert!(!error.to_string().is_empty()),
    };
    // All that are missing are counted: no list may be as long as any number in a file.
    let possible = |[number, count]: [u32; 2]| number < count && count <= shard::MOST;
    for read in [first, second] {
        assert!(shard_of(read).is_none_or(possible), "{:?} is no shard", shard_of(read));
    }
    for shards in found {
        match shards.missing(2) {
            Ok(missing) => assert!(missing.is_sorted() && missing.iter().all(|number| *number < 2)),
            Err(error) => is_one_line(&error),
        }
        match shards.publish(&out, true) {
            Ok(()) => {
                let whole = json::read(&out.join("a.json")).expect("the whole is a record");
                assert!(whole.share.is_none_or(|share| share.shard.is_none() && share.items.is_sorted()));
                assert!(out.join("a.csv").is_file());
            }
            Err(error) => assert!(!error.to_string().is_empty()),
        }
        // Names of plots come from the records.
        let around = out.parent().expect("it lies in a folder");
        assert!(names(around).iter().all(|name| name == "out"), "{:?}", names(around));
        assert!(!out.is_dir() || names(&out).iter().all(|name| out.join(name).is_file()), "{:?}", names(&out));
    }
}

/// The description of a part of a film, and the picture of its rows.
pub fn film(data: &[u8]) {
    let (description, png) = parted(data);
    let (folder, out) = (emptied("film"), emptied("pictures"));
    let path = folder.join("a.png.part.json");
    fs::write(&path, description).expect("room for the description");
    if let Ok(part) = cli::read_part(&path) {
        // A name that no file can have leaves the part without its picture.
        let picture = folder.join(&part.picture);
        let _unwritten = if picture == path { Ok(()) } else { fs::write(picture, png) };
    }
    let parts = match cli::parts_in_folder(&folder) {
        Ok(parts) => parts,
        Err(error) => return assert!(!error.to_string().is_empty()),
    };
    assert!(Film::of([parts.clone(), parts.clone()].concat()).is_err(), "both have the same rows");
    match cli::missing_parts(parts.clone(), 3) {
        Ok(missing) => assert!(missing.is_sorted() && missing.iter().all(|number| *number < 3)),
        Err(error) => is_plain(&error),
    }
    let Some(size) = parts.first().map(|(_, part)| part.size) else { return };
    let whole = match Film::of(parts) {
        Ok(whole) => whole,
        Err(error) => return is_plain(&error),
    };
    if let Err(error) = whole.check_whole() {
        return is_plain(&error);
    }
    for frame in whole.frames() {
        match frame {
            Ok(frame) => assert!([frame.width(), frame.height()] == size),
            Err(error) => is_plain(&error),
        }
    }
    match whole.write(&out) {
        Ok(count) => assert!(names(&out).len() == count),
        Err(error) => is_plain(&error),
    }
}

/// A message may have the name of a picture in it, and so any letter.
fn is_plain(error: &cli::Failure) {
    let text = error.to_string();
    assert!(!text.is_empty() && text.len() < 100_000);
}

/// The joined record that an experiment is published from.
pub fn assembled(data: &[u8]) {
    let path = written(&[("g.json", data)]);
    match Assembled::read(&path) {
        Ok(_) => {
            let share = document(data, json::parse).and_then(|record| record.share);
            assert!(share.is_some_and(|share| share.shard.is_none()));
        }
        Err(error) => assert!(error.to_string().starts_with("`assembled` ")),
    }
}

/// A record, of `stress` too, as the page that `report` writes, with a picture of its first run.
pub fn page(data: &[u8]) {
    let Some(record): Option<Record> = document(data, json::parse) else { return };
    let written = json::to_string(&record).expect("a record is JSON");
    let png = data[..data.len().min(64)].to_vec();
    let pictures = record.runs.first().map(|_| Picture { run: 0, png, difference: None });
    let source = Source { name: "a.json".to_owned(), record, pictures: pictures.into_iter().collect() };
    let page = html::page(&Contents { records: vec![source], ..Contents::default() });
    let scripts = |page: &str| page.to_ascii_lowercase().matches("<script").count();
    assert!(scripts(&page) == scripts(&html::page(&Contents::default())), "text of the record is markup");
    assert!(page.trim_end().ends_with("</html>"));
    // JSON escapes what no line of text has: without that, the page has none of it either.
    let is_control = |letter: char| letter.is_control() && letter != '\n';
    if !written.contains('\\') && !written.contains(is_control) {
        assert!(!page.contains(is_control));
    }
}
