//! Parts of films, put together.

use std::collections::{BTreeMap, HashMap};
use std::path::{Path, PathBuf};

use super::super::failure::Failure;
use super::super::part::{Part, rows_suffix};
use crate::file;
use crate::image::{self, Rgba8, write_png};
use crate::measure::shard::Shard;

/// Parts of one film, frame by frame, each frame's by their first row.
pub struct Film {
    /// The first frame, and the one after the last.
    range: [u32; 2],
    size: [u32; 2],
    parts: BTreeMap<u32, Vec<(PathBuf, Part)>>,
}

/// Numbers of the shards that lack a part; all of them where there is none.
pub fn missing(mut parts: Vec<(PathBuf, Part)>, count: u32) -> Result<Vec<u32>, Failure> {
    parts.retain(|(path, part)| part.has_picture(&path.with_file_name(&part.picture)));
    if parts.is_empty() {
        return Ok((0..count).collect());
    }
    let film = Film::of(parts)?;
    let lacks = |number: &u32| {
        let shard = Shard { number: *number, count };
        if film.is_range() {
            shard.of(film.range[0]..film.range[1]).any(|frame| !film.gaps(frame).is_empty())
        } else {
            let rows = shard.of(0..film.size[1]);
            film.gaps(film.range[0]).iter().any(|gap| gap[0] < rows.end && rows.start < gap[1])
        }
    };
    Ok((0..count).filter(lacks).collect())
}

impl Film {
    /// The film that all parts are of.
    ///
    /// # Errors
    /// [`Failure::Input`] for none, for parts of other settings, and for rows that several parts have.
    pub fn of(parts: Vec<(PathBuf, Part)>) -> Result<Self, Failure> {
        let Some((first_path, first)) = parts.first() else {
            return Err(Failure::Input("assemble: no part was found; render --shard leaves them".to_owned()));
        };
        if let Some((path, part)) = parts.iter().find(|(_, part)| part.identity != first.identity) {
            let (a, b, what) = (first_path.display(), path.display(), difference(first, part));
            return Err(Failure::Input(format!("assembling {a} and {b}: their {what} differ; they are of two films")));
        }
        let mut film = Film { range: first.frames, size: first.size, parts: BTreeMap::new() };
        for (path, part) in parts {
            film.parts.entry(part.frame).or_default().push((path, part));
        }
        for frame in film.parts.values_mut() {
            frame.sort_by_key(|(_, part)| part.rows);
            let overlap = frame.windows(2).find(|pair| pair[1].1.rows[0] < pair[0].1.rows[1]);
            if let Some([(a, _), (b, part)]) = overlap {
                let (a, b, row, frame) = (a.display(), b.display(), part.rows[0], part.frame);
                return Err(Failure::Input(format!("assembling {a} and {b}: both have row {row} of frame {frame}")));
            }
        }
        Ok(film)
    }

    fn is_range(&self) -> bool {
        self.range[1] - self.range[0] > 1
    }

    /// Rows of a frame that no part has.
    fn gaps(&self, frame: u32) -> Vec<[u32; 2]> {
        let mut next = 0;
        let mut gaps = Vec::new();
        for (_, part) in self.parts.get(&frame).into_iter().flatten() {
            gaps.extend((next < part.rows[0]).then_some([next, part.rows[0]]));
            next = part.rows[1];
        }
        gaps.extend((next < self.size[1]).then_some([next, self.size[1]]));
        gaps
    }

    /// Fails where rows of a frame are missing.
    pub fn check_whole(&self) -> Result<(), Failure> {
        let Some(frame) = (self.range[0]..self.range[1]).find(|&frame| !self.gaps(frame).is_empty()) else {
            return Ok(());
        };
        let count = self.range[1] - self.range[0];
        let whole = self.parts.keys().filter(|frame| self.gaps(**frame).is_empty()).count();
        let rows: Vec<String> = self.gaps(frame).iter().map(|[first, end]| format!("{first}..{end}")).collect();
        Err(Failure::Input(format!(
            "assembling {count} frames: {} lack rows, the first is frame {frame} with rows {}; render what is missing",
            count as usize - whole,
            rows.join(", ")
        )))
    }

    /// A frame of its parts, which it has all.
    fn frame(&self, parts: &[(PathBuf, Part)]) -> Result<Rgba8, Failure> {
        let checked = |(path, part): &(PathBuf, Part)| {
            let picture = path.with_file_name(&part.picture);
            part.checked_picture(&picture)
                .map_err(unread)?
                .ok_or_else(|| to_be_drawn(&picture, "it is not the picture that was drawn"))
        };
        // All are seen to be right before the first takes its memory.
        let checked = parts.iter().map(checked).collect::<Result<Vec<_>, _>>()?;
        let mut pixels = Vec::new();
        for rows in checked {
            pixels.extend_from_slice(rows.into_picture().map_err(unread)?.pixels());
        }
        Ok(Rgba8::new(self.size[0], self.size[1], pixels)?)
    }

    /// Every frame, of a whole film.
    pub fn frames(&self) -> impl Iterator<Item = Result<Rgba8, Failure>> {
        self.parts.values().map(|parts| self.frame(parts))
    }

    /// Writes every frame under the name that the whole film would have given it, and gives their number.
    pub fn write(&self, out: &Path) -> Result<usize, Failure> {
        for (path, parts) in self.pictures(out)?.iter().zip(self.parts.values()) {
            file::check_writable(path)?;
            write_png(path, &self.frame(parts)?)?;
        }
        Ok(self.parts.len())
    }

    /// The files that [`write`](Self::write) writes.
    ///
    /// # Errors
    /// [`Failure::Input`] for parts that name one picture, or pictures of two series.
    pub fn pictures(&self, out: &Path) -> Result<Vec<PathBuf>, Failure> {
        let all = self.parts.values().flatten();
        let (mut of_names, mut first) = (HashMap::<String, (u32, &Path)>::new(), None);
        for (path, part) in all {
            let name = whole_name(part);
            let (frame, other) = *of_names.entry(name.clone()).or_insert((part.frame, path));
            if frame != part.frame {
                let (a, b) = (other.display(), path.display());
                return Err(Failure::Input(format!(
                    "assembling {a} and {b}: both name the picture {name}; render what they are of again"
                )));
            }
            let series = if self.is_range() { series_of(&name, part.frame) } else { name.clone() };
            let (known, of_first, a) = first.get_or_insert_with(|| (series.clone(), name.clone(), path));
            if *known != series {
                let (a, b) = (a.display(), path.display());
                return Err(Failure::Input(format!(
                    "assembling {a} and {b}: their pictures are named {of_first} and {name}; give all one --image"
                )));
            }
        }
        let of_frame = |parts: &Vec<(PathBuf, Part)>| parts.first().map(|(_, part)| out.join(whole_name(part)));
        Ok(self.parts.values().filter_map(of_frame).collect())
    }

    /// The files that are read: descriptions and pictures.
    pub fn read(&self) -> impl Iterator<Item = PathBuf> {
        let parts = self.parts.values().flatten();
        parts.flat_map(|(path, part)| [path.clone(), path.with_file_name(&part.picture)])
    }
}

/// The name of a picture of several frames without the number of its own.
fn series_of(name: &str, frame: u32) -> String {
    let path = Path::new(name);
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    let ending = path.extension().unwrap_or_default().to_string_lossy();
    stem.strip_suffix(&format!("-{frame:04}")).map_or_else(|| name.to_owned(), |series| format!("{series}.{ending}"))
}

fn to_be_drawn(picture: &Path, reason: &str) -> Failure {
    Failure::Input(format!("assembling {}: {reason}; render it again", picture.display()))
}

/// The refusal of a picture that cannot be read: the program has written it, and can do so again.
fn unread(error: image::Error) -> Failure {
    match &error {
        image::Error::Open { path, reason } | image::Error::Png { path, reason } => to_be_drawn(path, reason),
        _ => error.into(),
    }
}

/// `pool-0007.rows-0-9.png` is of `pool-0007.png`.
fn whole_name(part: &Part) -> String {
    let suffix = rows_suffix(part.rows);
    let mut name = part.picture.clone();
    if part.rows != [0, part.size[1]]
        && let Some(at) = name.rfind(&suffix)
    {
        name.replace_range(at..at + suffix.len(), "");
    }
    name
}

/// The settings in which two parts differ, for a message.
fn difference(a: &Part, b: &Part) -> String {
    let parameters =
        a.settings.parameters.iter().filter(|(name, value)| b.settings.parameters.get(*name) != Some(*value));
    let mut names: Vec<String> = parameters.map(|(name, _)| format!("--{name}")).collect();
    let mut add = |differs: bool, name: &str| names.extend(differs.then(|| name.to_owned()));
    add((&a.settings.paper, &a.settings.variant) != (&b.settings.paper, &b.settings.variant), "variants");
    add(a.settings.preset != b.settings.preset, "presets");
    add(a.settings.inputs.iter().map(|i| &i.sha256).ne(b.settings.inputs.iter().map(|i| &i.sha256)), "input files");
    add(
        (&a.settings.shader_compiler, &a.settings.shaders) != (&b.settings.shader_compiler, &b.settings.shaders),
        "shaders",
    );
    add(a.settings.program != b.settings.program, "programs");
    add(a.device != b.device, "devices");
    add((a.frames, a.size) != (b.frames, b.size), "frames or sizes");
    if names.is_empty() { "settings".to_owned() } else { names.join(", ") }
}
