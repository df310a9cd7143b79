//! Every reader of the program, fed with bytes: a result or one clear line, whatever they are.

use std::ffi::OsString;
use std::fmt::Display;
use std::fs;
use std::path::{Path, PathBuf};

use fumarole::measure::compare::{self, Comparison, Input, Options};
use fumarole::papers::burning;
use fumarole::papers::terrain::experiments::bodies;
use fumarole::report::html::{self, Contents, TableSource};
use fumarole::report::stress::StressRecord;
use fumarole::report::tables::Tables;
use fumarole::scene::{HeightMapSource, MeshOptions, MeshSource, RowSource, Rows, load_voxels, world_file};
use fumarole::{cli, image, report, shader_build};

#[path = "targets/cached.rs"]
mod cached;
#[path = "targets/parts.rs"]
mod parts;
#[path = "targets/settings.rs"]
mod settings;

/// A reader.
pub type Target = fn(&[u8]);

/// Readers under the names of their corpora.
pub const ALL: [(&str, Target); 38] = [
    ("obj", |data| mesh(&[("a.obj", data)])),
    ("ply", |data| mesh(&[("a.ply", data)])),
    ("stl", |data| mesh(&[("a.stl", data)])),
    ("gltf", gltf),
    ("glb", |data| mesh(&[("a.glb", data)])),
    ("asc", |data| height_map(&[("a.asc", data)])),
    ("esri", esri),
    ("hgt", hgt),
    ("tif", tif),
    ("vrt", |data| height_map(&[("f.vrt", parted(data).0), ("f.asc", parted(data).1)])),
    ("map-png", |data| height_map(&[("a.png", data)])),
    ("nrrd", |data| volume(&[("a.nrrd", data)])),
    ("nhdr", nhdr),
    ("mha", |data| volume(&[("a.mha", data)])),
    ("mhd", |data| volume(&[("c.mhd", parted(data).0), ("b.raw", parted(data).1)])),
    ("nii", |data| volume(&[("a.nii", data)])),
    ("nii-gz", |data| volume(&[("a.nii.gz", data)])),
    ("nii-pair", pair),
    ("nvdb", |data| volume(&[("a.nvdb", data)])),
    ("png", picture),
    ("world", world),
    ("sidecars", sidecars),
    ("materials", materials),
    ("record", record),
    ("compare", compared),
    ("verdicts", verdicts),
    ("tables", tables),
    ("stress", stress),
    ("part", part),
    ("bodies", listed_bodies),
    ("include", include),
    ("arguments", arguments),
    ("shards", parts::shards),
    ("film", parts::film),
    ("assembled", parts::assembled),
    ("page", parts::page),
    ("settings", settings::settings),
    ("cached", cached::cached),
];

/// Writes the files into a folder of this thread, and gives the first one's path.
fn written(files: &[(&str, &[u8])]) -> PathBuf {
    thread_local! {
        static FOLDER: tempfile::TempDir = {
            let memory = Path::new("/dev/shm");
            let place = if memory.is_dir() { memory.to_owned() } else { std::env::temp_dir() };
            tempfile::tempdir_in(place).expect("a folder for the files")
        };
    }
    FOLDER.with(|folder| {
        for (name, data) in files {
            fs::write(folder.path().join(name), data).expect("room for the files");
        }
        folder.path().join(files[0].0)
    })
}

fn is_one_line(error: &impl Display) {
    let text = error.to_string();
    assert!(text.len() < 2_000, "{} characters: {text:.200}", text.len());
    assert!(!text.contains(char::is_control), "{text:?}");
}

fn mesh(files: &[(&str, &[u8])]) {
    let source = MeshSource::File(written(files));
    if let Err(error) = source.promised_triangles() {
        is_one_line(&error);
    }
    match source.load() {
        Ok(mesh) => assert!(mesh.validate().is_ok()),
        Err(error) => is_one_line(&error),
    }
}

/// The document up to the first zero byte, and a file beside it.
fn gltf(data: &[u8]) {
    let (document, buffer) = parted(data);
    mesh(&[("a.gltf", document), ("a.bin", buffer)]);
}

fn height_map(files: &[(&str, &[u8])]) {
    height_map_of(written(files));
}

fn height_map_of(path: PathBuf) {
    match HeightMapSource::File(path).load() {
        Ok(map) => assert!(map.samples().len() == map.width() as usize * map.height() as usize),
        Err(error) => is_one_line(&error),
    }
}

/// A folder of one file, whose name stands before the first zero byte; without one a tile as it is, which only a tile's
/// own size lets pass, and repeated to a tile of three arc seconds.
fn hgt(data: &[u8]) {
    let (name, samples) = parted(data);
    let is_name = |name: &&str| {
        (1..200).contains(&name.len()) && !name.contains(|letter: char| letter == '/' || letter.is_control())
    };
    if let Some(name) = std::str::from_utf8(name).ok().filter(is_name) {
        let folder = written(&[("none", b"")]).with_file_name("tiles");
        fs::create_dir_all(&folder).expect("room for a folder");
        let file = folder.join(format!("{name}.hgt"));
        fs::write(&file, samples).expect("room for the file");
        height_map_of(folder);
        return fs::remove_file(file).expect("it is there");
    }
    height_map(&[("N37E140.hgt", data)]);
    if !data.is_empty() {
        let tile: Vec<u8> = data.iter().copied().cycle().take(2 * 1201 * 1201).collect();
        height_map(&[("N37E140.hgt", &tile)]);
    }
}

/// As a map, its first overview as one, and the rows of both one after another.
fn tif(data: &[u8]) {
    height_map(&[("a.tif", data)]);
    let path = written(&[("a.tif", data)]);
    if let Err(error) = HeightMapSource::File(path.clone()).load_with(1_u32) {
        is_one_line(&error);
    }
    for overview in [0_u32, 1] {
        let mut samples = 0;
        let mut take = |rows: Rows<'_>| {
            samples += match rows {
                Rows::Steps(values) => values.len(),
                Rows::Float(values) => values.len(),
            };
            true
        };
        let source = RowSource::geotiff(&path, overview);
        match source.and_then(|rows| rows.map(|rows| rows.read(&path, &mut take)).transpose()) {
            Ok(Some(Some(map))) => assert!(samples == map.width() as usize * map.height() as usize),
            Ok(_) => {}
            Err(error) => is_one_line(&error),
        }
    }
}

/// The header up to the first zero byte, and the samples.
fn esri(data: &[u8]) {
    let (header, samples) = parted(data);
    height_map(&[("b.hdr", header), ("b.bil", samples)]);
}

fn volume(files: &[(&str, &[u8])]) {
    let path = written(files);
    for component in [0, 1] {
        match load_voxels(&path, component) {
            Ok(grid) => {
                assert!(grid.samples().len() as u64 == grid.size().map(u64::from).iter().product::<u64>());
                assert!(grid.steps().iter().all(|step| step.is_finite()));
            }
            Err(error) => is_one_line(&error),
        }
    }
}

/// The header up to the first zero byte, and the samples.
fn nhdr(data: &[u8]) {
    let (header, samples) = parted(data);
    volume(&[("b.nhdr", header), ("b.raw", samples)]);
}

/// A header of its own length, and the samples.
fn pair(data: &[u8]) {
    let (header, samples) = data.split_at(data.len().min(348));
    volume(&[("d.hdr", header), ("d.img", samples)]);
}

fn parted(data: &[u8]) -> (&[u8], &[u8]) {
    let end = data.iter().position(|byte| *byte == 0).unwrap_or(data.len());
    (&data[..end], data.get(end + 1..).unwrap_or_default())
}

fn picture(data: &[u8]) {
    match image::read_png(&written(&[("c.png", data)])) {
        Ok(picture) => assert!(picture.pixels().len() == 4 * picture.width() as usize * picture.height() as usize),
        Err(error) => is_one_line(&error),
    }
}

/// The world file beside a picture.
fn world(data: &[u8]) {
    written(&[("d.pgw", data)]);
    match world_file::beside(&written(&[("d.png", &[])])) {
        Ok(found) => {
            let coordinates = found.expect("it lies there").1;
            assert!(coordinates.step.min_element() > 0.0 && coordinates.north_west.is_finite());
        }
        Err(error) => is_one_line(&error),
    }
}

/// What stands beside a grid: the text of its projection up to the first zero byte, and GDAL's file.
fn sidecars(data: &[u8]) {
    const GRID: &[u8] = b"ncols 2\nnrows 2\nxllcorner 500000\nyllcorner 4000000\ncellsize 10\n1 2\n3 4\n";
    let (projection, auxiliary) = parted(data);
    height_map(&[("g.asc", GRID), ("g.prj", projection), ("g.asc.aux.xml", auxiliary)]);
}

/// Materials of two parts that have a colour each.
fn materials(data: &[u8]) {
    const MESH: &str = "v 0 0 0 1 0 0\nv 1 0 0 1 0 0\nv 0 1 0 0 0 1\nv 1 1 0 0 0 1\ng one\nf 1 2 3\ng other\nf 4 3 2\n";
    let options = MeshOptions { keeps_tags: true, ..MeshOptions::default() };
    let source = MeshSource::File(written(&[("e.obj", MESH.as_bytes())]));
    let mesh = source.load_with(&options).expect("the mesh is one");
    if let Err(error) = burning::materials::load(&written(&[("e.toml", data)]), &mesh) {
        is_one_line(&error);
    }
}

fn record(data: &[u8]) {
    let Ok(text) = std::str::from_utf8(data) else { return };
    if let Ok(record) = report::json::parse(text, Path::new("a.json")) {
        // What was read is written, shown and read again.
        let written = report::json::to_string(&record).expect("a record is JSON");
        assert!(report::json::parse(&written, Path::new("b.json")).is_ok());
        let style = report::table::Style::default();
        assert!(!report::console::record(&record, style).is_empty() && !report::csv::to_string(&record).is_empty());
    }
}

/// Records of two sides between zero bytes, by processes and by blocks.
fn compared(data: &[u8]) {
    let side = |data: &[u8]| {
        let record = document(data, report::json::parse)?;
        Some([Input { name: "a.json".to_owned(), record }])
    };
    let (a, b) = parted(data);
    let (Some(a), Some(b)) = (side(a), side(b)) else { return };
    for options in [Options { fail_above: Some(0.05), ..Options::default() }, Options::default().for_blocks(&a, &b)] {
        match compare::compare(&a, &b, &options) {
            Ok(comparison) => {
                let written = report::json::to_string(&comparison).expect("a comparison is JSON");
                verdicts(written.as_bytes());
            }
            Err(error) => assert!(!error.to_string().is_empty()),
        }
    }
}

/// A document, or an error, which may be long: what prints it cuts it and joins its lines.
fn document<T>(data: &[u8], parse: impl Fn(&str, &Path) -> Result<T, report::json::ReadError>) -> Option<T> {
    let text = std::str::from_utf8(data).ok()?;
    let read = parse(text, Path::new("a.json"));
    assert!(read.as_ref().err().is_none_or(|error| !error.to_string().is_empty()));
    read.ok()
}

/// A comparison, printed and as a page.
fn verdicts(data: &[u8]) {
    let Some(comparison) = document::<Comparison>(data, report::json::document) else { return };
    let style = report::table::Style::default();
    assert!(!compare::render(&comparison, style).is_empty() && !compare::markdown(&comparison).is_empty());
    let verdicts = compare::sections(&comparison);
    assert!(!html::page(&Contents { verdicts, ..Contents::default() }).is_empty());
}

/// Tables as a page; as `report` does, larger ones are left out.
fn tables(data: &[u8]) {
    const MOST_CELLS: usize = 1 << 12;
    let Some(document) = document::<Tables>(data, report::json::document) else { return };
    let cells = document.all().map(|table| table.columns.len().saturating_mul(table.rows.len()));
    if cells.fold(0, usize::saturating_add) <= MOST_CELLS {
        let tables = vec![TableSource { name: "a.json".to_owned(), document }];
        assert!(!html::page(&Contents { tables, ..Contents::default() }).is_empty());
    }
}

/// A record that a second call of `stress` goes on with: its own, and one of other steps.
fn stress(data: &[u8]) {
    const OTHER: &[u8] = include_bytes!("../corpus/stress/whole");
    let file = cli::StressFile::new(written(&[("f.json", data)]));
    let other: StressRecord = document(OTHER, report::json::document).expect("it is a record of stress");
    let own: Option<StressRecord> = document(data, report::json::document);
    for template in own.iter().chain([&other]) {
        match file.left(false).and_then(|left| file.known(left, template)) {
            Ok(series) => assert!(series.len() < data.len()),
            Err(error) => assert!(!error.to_string().is_empty()),
        }
    }
    if let Some(record) = own {
        assert!(!record.csv().is_empty() && report::json::to_string(&record).is_ok());
    }
}

fn part(data: &[u8]) {
    match cli::read_part(&written(&[("a.png.part.json", data)])) {
        Ok(part) => assert!(part.rows[1] <= part.size[1] && !part.picture.contains('/')),
        Err(error) => assert!(!error.to_string().is_empty()),
    }
}

fn listed_bodies(data: &[u8]) {
    let mut found = Vec::new();
    match bodies::read(&written(&[("a.csv", data)]), &mut found) {
        Ok(()) => assert!(found.iter().all(|body| body.check().is_ok())),
        Err(error) => assert!(!error.to_string().is_empty()),
    }
}

/// A shader and two files that it may include, between zero bytes.
fn include(data: &[u8]) {
    let (shader, rest) = parted(data);
    let (first, second) = parted(rest);
    let path = written(&[("a.frag", shader), ("b.glsl", first), ("c.glsl", second)]);
    let folder = path.parent().expect("it lies in a folder");
    match shader_build::Source::read_variants(folder, "a.frag") {
        Ok(sources) => {
            for (_, source) in sources {
                let lines = source.text.lines().count();
                assert!((1..=lines).all(|line| source.origin(line).is_some()) && source.text.is_ascii());
            }
        }
        Err(error) => assert!(error.to_string().len() < 100_000),
    }
}

/// A command line, its words between zero bytes.
fn arguments(data: &[u8]) {
    let words = data.split(|byte| *byte == 0);
    #[cfg(unix)]
    let words = words.map(|word| std::os::unix::ffi::OsStringExt::from_vec(word.to_vec()));
    #[cfg(not(unix))]
    let words = words.map(|word| OsString::from(String::from_utf8_lossy(word).into_owned()));
    let line: Vec<OsString> = std::iter::once(OsString::from("fumarole")).chain(words).collect();
    #[cfg(feature = "window")]
    match cli::view_reordered(line.clone()) {
        // The paper that is shown may be added.
        Ok(reordered) => assert!((0..=1).contains(&(reordered.len() - line.len()))),
        Err(error) => assert!(!error.to_string().is_empty()),
    }
    let _result = cli::parsed(line);
}
