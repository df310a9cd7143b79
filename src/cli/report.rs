//! `report`: records, tables, pictures and plots as one page.

use std::collections::{BTreeMap, HashMap, HashSet};
use std::fs;
use std::path::{Path, PathBuf};

use clap::Args;
use serde::Deserialize;
use serde::de::{DeserializeOwned, IgnoredAny};
use serde_json::{Map, Value};

use super::ab::VERDICTS_FILE;
use super::compare::{Side, parse_side};
use super::failure::Failure;
use super::outcome;
use crate::content;
use crate::file;
use crate::image::{self, Rgba8};
use crate::measure::compare::{self, Comparison, Input, Options, are_in_blocks, compare, sections};
use crate::report::alternative::alternatives;
use crate::report::html::{Contents, Pair, Picture, PictureDifference, Plot, Section, Source, TableSource, name, page};
use crate::report::json::{self, ReadError};
use crate::report::record::Share;
use crate::report::tables::{self, Rows, Tables};
use crate::report::{Record, Run};

#[derive(Debug, Clone, Args)]
pub struct ReportArgs {
    /// Records, tables and comparisons, or folders with them and with plots
    #[arg(value_name = "DIR|FILE.json")]
    sources: Vec<PathBuf>,
    /// Records of side A, comma-separated, for verdicts
    #[arg(long, value_name = "A.json[,..]", value_parser = side(), requires = "b")]
    a: Option<Side>,
    /// Records of side B
    #[arg(long, value_name = "B.json[,..]", value_parser = side(), requires = "a")]
    b: Option<Side>,
    /// The page
    #[arg(long, short, value_name = "FILE.html", default_value = "fumarole-out/report.html")]
    output: PathBuf,
    /// Print nothing but errors
    #[arg(long, short)]
    quiet: bool,
}

/// Largest plot that is shown, bytes.
const MAX_PLOT_BYTES: u64 = 16 << 20;
/// Largest comparison, and largest tables, that are shown, bytes.
const MAX_DOCUMENT_BYTES: u64 = 16 << 20;
/// Cells of a table that are shown.
const MAX_CELLS: usize = 1 << 17;
/// Largest picture that is shown, bytes.
const MAX_PICTURE_BYTES: u64 = 64 << 20;

fn side() -> impl clap::builder::TypedValueParser<Value = Side> {
    use clap::builder::{OsStringValueParser, TypedValueParser};
    OsStringValueParser::new().try_map(|text| parse_side(&text))
}

pub fn run(arguments: &ReportArgs) -> Result<(), Failure> {
    if arguments.sources.is_empty() && arguments.a.is_none() {
        return Err(Failure::Input("report: name records or a folder, as in: fumarole report fumarole-out".into()));
    }
    if arguments.output.as_os_str() == "-" {
        return Err(Failure::Input("report -o -: a report is a file; name one, as in -o report.html, or ./-".into()));
    }
    file::check_writable(&arguments.output)?;
    outcome::check_apart([&arguments.output], &arguments.documents())?;
    let mut contents = Contents { title: "fumarole".to_owned(), ..Contents::default() };
    for source in &arguments.sources {
        if source.is_dir() {
            add_folder(&mut contents, source)?;
        } else {
            match document(source)? {
                Document::Record(record) => {
                    add_record(&mut contents, source, *record);
                }
                Document::Tables(tables) => add_tables(&mut contents, source, *tables),
                Document::Verdicts(verdicts) => contents.verdicts.extend(named_sections(source, &verdicts)),
            }
        }
    }
    if let (Some(a), Some(b)) = (&arguments.a, &arguments.b) {
        let (a, b) = (a.read()?, b.read()?);
        let options = Options::default();
        let options = if are_in_blocks(&a, &b) { options.for_blocks(&a, &b) } else { options };
        contents.verdicts.extend(sections(&compare(&a, &b, &options)?));
        let [a, b] = [a, b].map(|side| {
            let records = side.into_iter().map(|input| add_record(&mut contents, Path::new(&input.name), input.record));
            records.flatten().collect::<Vec<_>>()
        });
        contents.pairs.extend(pairs(&a, &b));
    }
    if [contents.records.len(), contents.tables.len(), contents.plots.len(), contents.verdicts.len()] == [0; 4] {
        return Err(Failure::Input("report: no record, no table and no plot was found; write one with --json".into()));
    }
    let of_source = |source: &Source| {
        let runs = source.pictures.iter().map(|shown| &source.record.runs[shown.run]);
        runs.filter_map(|run| picture_files(Path::new(&source.name), run)).flatten().collect::<Vec<_>>()
    };
    let pictures: Vec<PathBuf> = contents.records.iter().flat_map(of_source).collect();
    outcome::check_apart([&arguments.output], &pictures)?;
    write(&contents, &arguments.output, arguments.quiet)
}

impl ReportArgs {
    /// The documents and plots that are read; of a folder that cannot be listed none.
    fn documents(&self) -> Vec<PathBuf> {
        let is_read = |path: &PathBuf| path.extension().is_some_and(|ending| ending == "json" || ending == "svg");
        let of_source = |source: &PathBuf| match source.is_dir() {
            true => outcome::listed(source).unwrap_or_default().into_iter().filter(is_read).collect(),
            false => vec![source.clone()],
        };
        let sides = self.a.iter().chain(&self.b).flat_map(|side| side.files().to_vec());
        self.sources.iter().flat_map(of_source).chain(sides).collect()
    }
}

/// A record that was just measured, as a page.
pub fn write_record(record: &Record, name: &Path, output: &Path, quiet: bool) -> Result<(), Failure> {
    let mut contents = Contents { title: "fumarole".to_owned(), ..Contents::default() };
    add_record(&mut contents, name, record.clone());
    write(&contents, output, quiet)
}

fn write(contents: &Contents, output: &Path, quiet: bool) -> Result<(), Failure> {
    file::write(output, page(contents).as_bytes())?;
    if !quiet {
        contents.warnings.iter().for_each(|warning| outcome::say(&format!("warning: {warning}")));
        outcome::say(&format!("wrote {}", output.display()));
    }
    Ok(())
}

/// All records, tables, comparisons and plots of a folder by their names; what `ab` left there is compared. What is ours and
/// is not shown is named in a warning.
fn add_folder(contents: &mut Contents, folder: &Path) -> Result<(), Failure> {
    let files = outcome::listed(folder)?;
    let mut sides: HashMap<&str, Vec<Input>> = HashMap::new();
    let mut verdicts = None;
    let mut foreign: BTreeMap<String, Vec<String>> = BTreeMap::new();
    let mut commands: HashMap<String, Vec<String>> = HashMap::new();
    let first_plot = contents.plots.len();
    let mut drawn: HashMap<&str, Vec<Drawn>> = HashMap::new();
    for path in &files {
        let ending = path.extension().unwrap_or_default();
        if ending == "svg" {
            match file::read(path, MAX_PLOT_BYTES) {
                Ok(svg) => contents.plots.push(Plot { name: name_of(path), svg, command: vec![] }),
                Err(e) => contents.warnings.push(format!("{}: {e}", path.display())),
            }
        } else if ending == "json" {
            match document(path) {
                Ok(Document::Record(record)) => {
                    let record = *record;
                    commands.insert(stem_of(path), record.command.clone());
                    let side = ["ab-a.json", "ab-b.json"].into_iter().find(|side| path.ends_with(side));
                    if let Some(side) = side {
                        sides.insert(side, by_process(path, &record));
                    }
                    let pictures = add_record(contents, path, record);
                    if let Some(side) = side {
                        drawn.insert(side, pictures);
                    }
                }
                Ok(Document::Tables(tables)) => {
                    commands.insert(stem_of(path), tables.command.clone());
                    add_tables(contents, path, *tables);
                }
                Ok(Document::Verdicts(found)) if path.ends_with(VERDICTS_FILE) => verdicts = Some(*found),
                Ok(Document::Verdicts(found)) => contents.verdicts.extend(named_sections(path, &found)),
                Err(ReadError::WrongSchema { found, .. }) if found.starts_with("\"fumarole.") => {
                    foreign.entry(told(&found).to_owned()).or_default().push(name_of(path));
                }
                Err(ReadError::WrongSchema { .. }) if is_older_table(path) => {
                    let problem = "tables of an older program, which the page does not show; run the experiment again";
                    contents.warnings.push(format!("{}: {problem}", path.display()));
                }
                // Others' documents, and traces, lie there too.
                Err(ReadError::WrongSchema { .. }) => {}
                Err(e) => contents.warnings.push(e.to_string()),
            }
        }
    }
    if let (None, Some(a), Some(b)) = (&verdicts, sides.get("ab-a.json"), sides.get("ab-b.json")) {
        match compare(a, b, &Options::default().for_blocks(a, b)) {
            Ok(comparison) => verdicts = Some(comparison),
            Err(e) => contents.warnings.push(e.to_string()),
        }
    }
    for plot in &mut contents.plots[first_plot..] {
        plot.command = command_of(&plot.name, &commands);
    }
    contents.warnings.extend(foreign.iter().map(|(schema, names)| {
        let folder = folder.display();
        let (first, more) = (&names[0], names.len() - 1);
        let more = if more > 0 { format!(" and {more} more") } else { String::new() };
        format!("{folder}: the page does not show documents of schema {schema}: {first}{more}")
    }));
    contents.verdicts.extend(verdicts.iter().flat_map(|comparison| named_sections(folder, comparison)));
    if let (Some(_), Some(a), Some(b)) = (&verdicts, drawn.get("ab-a.json"), drawn.get("ab-b.json")) {
        contents.pairs.extend(pairs(a, b));
    }
    Ok(())
}

/// A document that the page shows.
enum Document {
    Record(Box<Record>),
    Tables(Box<Tables>),
    Verdicts(Box<Comparison>),
}

/// Reads a document of any schema that the page shows.
///
/// # Errors
/// As [`json::read`].
fn document(path: &Path) -> Result<Document, ReadError> {
    let is = |found: &str, schema: &str| found.trim_matches('"') == schema;
    match json::read(path) {
        Err(ReadError::WrongSchema { found, .. }) if is(&found, tables::SCHEMA) => {
            Ok(Document::Tables(Box::new(whole(path)?)))
        }
        Err(ReadError::WrongSchema { found, .. }) if is(&found, compare::SCHEMA) => {
            Ok(Document::Verdicts(Box::new(whole(path)?)))
        }
        read => Ok(Document::Record(Box::new(read?))),
    }
}

fn whole<T: DeserializeOwned>(path: &Path) -> Result<T, ReadError> {
    let unreadable = |source| ReadError::Unreadable { path: path.to_owned(), source };
    json::document(&file::read_text(path, MAX_DOCUMENT_BYTES).map_err(unreadable)?, path)
}

/// True for what experiments without runs wrote before their document had a schema.
fn is_older_table(path: &Path) -> bool {
    #[derive(Deserialize)]
    struct Header {
        experiment: Option<IgnoredAny>,
        environment: Option<IgnoredAny>,
        table: Option<IgnoredAny>,
    }
    let text = file::read_text(path, MAX_DOCUMENT_BYTES).unwrap_or_default();
    let header = serde_json::from_str::<Header>(&text);
    header.is_ok_and(|header| header.experiment.and(header.environment).and(header.table).is_some())
}

fn named_sections(source: &Path, comparison: &Comparison) -> Vec<Section> {
    let mut sections = sections(comparison);
    if let Some(first) = sections.first_mut() {
        first.title = format!("{}: {}", source.display(), first.title);
    }
    sections
}

/// Adds tables, unless a page of them would be too large.
fn add_tables(contents: &mut Contents, path: &Path, document: Tables) {
    let name = path.display().to_string();
    let cells = document.all().map(|table| table.columns.len().max(1).saturating_mul(table.rows.len()));
    let cells = cells.fold(0_usize, usize::saturating_add);
    // A heading that stands there twice has its cells twice.
    let bytes = || document.all().map(Rows::text_bytes).fold(0_usize, usize::saturating_add) as u64;
    if cells > MAX_CELLS {
        contents.warnings.push(format!("{name}: tables of {cells} cells are too large for a page; see their CSV"));
    } else if bytes() > MAX_DOCUMENT_BYTES {
        contents.warnings.push(format!("{name}: its tables have too much text for a page; see their CSV"));
    } else {
        contents.tables.push(TableSource { name, document });
    }
}

/// A schema as a message tells it, of a file that nobody named.
fn told(schema: &str) -> &str {
    let is_plain = |letter: char| letter.is_ascii_alphanumeric() || "\"./-".contains(letter);
    if schema.len() <= 40 && schema.chars().all(is_plain) { schema } else { "of another program" }
}

/// A joined record as one input a process, in their order.
fn by_process(path: &Path, record: &Record) -> Vec<Input> {
    let mut processes: BTreeMap<u32, (Vec<Run>, Vec<u32>)> = BTreeMap::new();
    for (at, run) in record.runs.iter().enumerate() {
        let (runs, items) = processes.entry(run.process).or_default();
        runs.push(run.clone());
        items.extend(record.share.as_ref().and_then(|share| share.items.get(at)));
    }
    let of = |(runs, items): (Vec<Run>, Vec<u32>)| {
        let share = record.share.as_ref();
        let share = share.map(|share| Share { identity: share.identity.clone(), shard: share.shard, items });
        let Record { environment, command, .. } = record;
        let record = Record { share, ..Record::new(environment.clone(), command.clone(), runs) };
        Input { name: path.display().to_string(), record }
    };
    processes.into_values().map(of).collect()
}

fn name_of(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

fn stem_of(path: &Path) -> String {
    path.file_stem().unwrap_or_default().to_string_lossy().into_owned()
}

/// The command of the document beside a plot: `gas-1-tables.svg` is drawn with `gas-1.json`, and not with `gas.json` where
/// both are there.
fn command_of(plot: &str, commands: &HashMap<String, Vec<String>>) -> Vec<String> {
    let stems = plot.match_indices(['-', '.']).map(|(end, _)| &plot[..end]);
    stems.rev().find_map(|stem| commands.get(stem)).cloned().unwrap_or_default()
}

/// A run's picture, as one side of a comparison has drawn it.
struct Drawn {
    run: Run,
    /// Its name among the runs of its record.
    name: String,
    png: Vec<u8>,
    picture: Rgba8,
}

/// The pictures that both sides have drawn, in the order of A; of several processes a side the first one's. Where the
/// sides have other parameters, those are put together that differ in the fewest.
fn pairs(a: &[Drawn], b: &[Drawn]) -> Vec<Pair> {
    let [a, b] = [a, b].map(first_ones);
    let places: HashMap<_, usize> = b.iter().enumerate().map(|(of, other)| (configuration(&other.run), of)).collect();
    let mut partners: Vec<Option<usize>> = a.iter().map(|one| places.get(&configuration(&one.run)).copied()).collect();
    let mut taken = vec![false; b.len()];
    partners.iter().flatten().for_each(|of| taken[*of] = true);
    // Two that differ in nothing are nearest; only what is left is looked at by twos.
    let mut others: HashMap<String, Vec<usize>> = HashMap::new();
    for of in (0..b.len()).filter(|of| !taken[*of]) {
        others.entry(name(&b[of].run, "")).or_default().push(of);
    }
    let mut candidates: Vec<(usize, usize, usize)> = vec![];
    for (at, one) in a.iter().enumerate().filter(|(at, _)| partners[*at].is_none()) {
        let others = others.get(&name(&one.run, "")).into_iter().flatten();
        candidates.extend(others.map(|of| (differing(&one.run, &b[*of].run), at, *of)));
    }
    candidates.sort_unstable();
    for (_, at, of) in candidates {
        if partners[at].is_none() && !taken[of] {
            (partners[at], taken[of]) = (Some(of), true);
        }
    }
    let pair = |(a, of): (&&Drawn, Option<usize>)| {
        let b = b[of?];
        // Of one size, or their runs would not be called alike.
        let difference = image::compare(&a.picture, &b.picture, None).ok()?;
        let (mean, p99) = (difference.mean, difference.p99);
        Some(Pair { title: a.name.clone(), pngs: [a.png.clone(), b.png.clone()], mean, p99 })
    };
    a.iter().zip(partners).filter_map(pair).collect()
}

/// The first picture of each configuration.
fn first_ones(all: &[Drawn]) -> Vec<&Drawn> {
    let mut known = HashSet::new();
    all.iter().filter(|one| known.insert(configuration(&one.run))).collect()
}

/// Name and parameters.
fn configuration(run: &Run) -> (String, &Map<String, Value>) {
    (name(run, ""), &run.config)
}

/// Number of parameters that differ.
fn differing(a: &Run, b: &Run) -> usize {
    let of_a = a.config.iter().filter(|(name, value)| b.config.get(*name) != Some(value)).count();
    of_a + b.config.keys().filter(|name| !a.config.contains_key(*name)).count()
}

/// Adds a record with its pictures, which it gives back.
fn add_record(contents: &mut Contents, path: &Path, record: Record) -> Vec<Drawn> {
    let mut found: Vec<(Picture, Rgba8)> = vec![];
    let mut known = HashSet::new();
    // The first of each paper and size.
    let mut bases: HashMap<(&str, u32, u32), usize> = HashMap::new();
    for (index, run) in record.runs.iter().enumerate() {
        // Every process of a side of `ab` has drawn the same.
        let image = run.image.as_ref().map(|image| (&image.path, &image.sha256));
        if !known.insert((&run.paper, &run.variant, image)) {
            continue;
        }
        match picture(path, run) {
            None => {}
            Some(Err(problem)) => contents.warnings.push(problem),
            Some(Ok((png, decoded))) => {
                let base = bases.entry((run.paper.as_str(), decoded.width(), decoded.height())).or_insert(found.len());
                let difference = found.get(*base).and_then(|(other, base)| {
                    let difference = image::compare(base, &decoded, None).ok()?;
                    Some(PictureDifference { base: other.run, mean: difference.mean, p99: difference.p99 })
                });
                found.push((Picture { run: index, png, difference }, decoded));
            }
        }
    }
    let names = alternatives(&record.runs);
    let (mut pictures, mut drawn) = (vec![], vec![]);
    for (picture, decoded) in found {
        let run = record.runs[picture.run].clone();
        let name = name(&run, &names[picture.run]);
        drawn.push(Drawn { run, name, png: picture.png.clone(), picture: decoded });
        pictures.push(picture);
    }
    contents.records.push(Source { name: path.display().to_string(), record, pictures });
    drawn
}

/// Places of a run's picture: where it was written, and beside the record.
fn picture_files(record: &Path, run: &Run) -> Option<[PathBuf; 2]> {
    let written = PathBuf::from(&run.image.as_ref()?.path);
    let beside = record.with_file_name(written.file_name()?);
    Some([written, beside])
}

/// A run's picture, if it is still the one that the record names, in one of its places.
fn picture(record: &Path, run: &Run) -> Option<Result<(Vec<u8>, Rgba8), String>> {
    let named = run.image.as_ref()?;
    let files = picture_files(record, run)?;
    let is_it = |path: &&PathBuf| content::file_sha256(path).is_ok_and(|found| found == named.sha256);
    let is_small = |path: &&PathBuf| fs::metadata(path).is_ok_and(|m| m.is_file() && m.len() <= MAX_PICTURE_BYTES);
    let found = files.iter().filter(is_small).find(is_it);
    let Some(path) = found else {
        return Some(Err(format!("{}: the picture of the record is not there, or has changed since", named.path)));
    };
    let read = file::read(path, MAX_PICTURE_BYTES).map_err(|e| format!("{}: {e}", path.display()));
    Some(read.and_then(|png| Ok((png, image::read_png(path).map_err(|e| e.to_string())?))))
}

#[cfg(test)]
mod tests {
    use std::time::{Duration, Instant};

    use super::*;
    use crate::report::example;

    fn run(process: u32, planes: u32) -> Run {
        let mut run = Run { process, ..example::run() };
        run.config.insert("planes".to_owned(), planes.into());
        run
    }

    /// A record is copied once, and not for each of its processes.
    #[test]
    fn a_record_of_many_processes_is_taken_apart_at_once() {
        let count = 4_000;
        let runs: Vec<Run> = (0..2 * count).map(|at| run(count - 1 - at % count, at)).collect();
        let share = Share { identity: "ab".to_owned(), shard: None, items: (0..2 * count).collect() };
        let record =
            Record { share: Some(share), ..Record::new(example::environment(), vec!["ab".to_owned()], runs.clone()) };
        let begun = Instant::now();
        let inputs = by_process(Path::new("ab-a.json"), &record);
        assert!(begun.elapsed() < Duration::from_secs(5), "{:?}", begun.elapsed());
        assert_eq!(inputs.len(), count as usize);
        for (process, Input { name, record }) in (0..count).zip(&inputs) {
            let places = [count - 1 - process, 2 * count - 1 - process];
            assert_eq!(record.runs, places.map(|place| runs[place as usize].clone()), "{process}");
            assert_eq!(record.share.as_ref().unwrap().items, places, "{process}");
            assert_eq!((name.as_str(), record.command.as_slice()), ("ab-a.json", &["ab".to_owned()][..]));
        }
    }

    /// Equal ones go together, then those that differ least; a picture that another process has drawn again is left out.
    #[test]
    fn pictures_go_with_the_nearest() {
        let drawn = |side: u8, planes: &[u32]| -> Vec<Drawn> {
            let one = |&planes: &u32| Drawn {
                run: run(0, planes),
                name: planes.to_string(),
                png: vec![side, planes as u8],
                picture: Rgba8::new(1, 1, vec![side, 0, 0, 255]).unwrap(),
            };
            planes.iter().map(one).collect()
        };
        let found = pairs(&drawn(1, &[7, 13, 7, 11, 17]), &drawn(2, &[11, 9, 7, 11]));
        let found: Vec<_> = found.into_iter().map(|pair| (pair.title, pair.pngs)).collect();
        let pair = |a: u8, b: u8| (a.to_string(), [vec![1, a], vec![2, b]]);
        assert_eq!(found, [pair(7, 7), pair(13, 9), pair(11, 11)]);
    }

    #[test]
    fn a_plot_has_the_command_of_the_longest_name() {
        let of_stem = |stem: &str| (stem.to_owned(), vec![stem.to_owned()]);
        let commands = HashMap::from(["gas", "gas-1", "gas-12", "b.c"].map(of_stem));
        for (plot, stem) in [
            ("gas-1.svg", "gas-1"),
            ("gas-1-tables.svg", "gas-1"),
            ("gas-12.svg", "gas-12"),
            ("gas-123.svg", "gas"),
            ("b.c-1.svg", "b.c"),
        ] {
            assert_eq!(command_of(plot, &commands), [stem], "{plot}");
        }
        assert!(command_of("lava-1.svg", &commands).is_empty() && command_of("gas", &commands).is_empty());
    }
}
