//! Parts of a film: which frames and rows a process draws, and what stands beside a finished part.

use std::ops::Range;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};
use serde_json::json;

use super::failure::Failure;
use super::options::MachineArgs;
use super::outcome;
use crate::content;
use crate::file;
use crate::image::{self, CheckedPng, Rgba8, suffixed};
use crate::measure::Variant;
use crate::measure::bench::inputs;
use crate::measure::machine::Machine;
use crate::measure::study::Study;
use crate::report::record::InputFile;
use crate::report::{environment, json as reader};

/// The value of [`Part::schema`].
pub const SCHEMA: &str = "fumarole.part/1";
/// Ending of the file beside a part's picture.
pub const ENDING: &str = ".part.json";

/// Parses the rows `A..B`.
pub fn parse_rows(text: &str) -> Result<Range<u32>, String> {
    let wrong = || format!("{text:?} are no rows: give A..B, from row A up to but not including row B");
    let (first, end) = text.split_once("..").ok_or_else(wrong)?;
    match (first.parse::<u32>(), end.parse::<u32>()) {
        (Ok(first), Ok(end)) if first < end => Ok(first..end),
        _ => Err(wrong()),
    }
}

/// Everything that fixes the pixels of a film but its frames, beside the device.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Settings {
    /// Name of the paper's command, such as `lava`.
    pub paper: String,
    /// Name of the variant that is drawn.
    pub variant: String,
    /// Name of the preset; `None` without one.
    pub preset: Option<String>,
    /// Every parameter as it is typed.
    pub parameters: std::collections::BTreeMap<String, String>,
    /// Files that the parameters name, by path and content.
    pub inputs: Vec<InputFile>,
    /// Compiler whose SPIR-V runs, `glslang` or `naga`.
    pub shader_compiler: String,
    /// SHA-256 of the shaders that stand in for the built-in ones.
    pub shaders: Option<String>,
    /// Version and commit of the program, and the SHA-256 of its file where it is not built of a commit as it is.
    pub program: [Option<String>; 3],
}

/// Description of a part of a film, the file beside its picture.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Part {
    /// [`SCHEMA`] of the version that wrote it.
    pub schema: String,
    /// SHA-256 of the settings, the device and the film's frames and size.
    pub identity: String,
    /// Everything else that fixes the pixels; equal in all parts of a film.
    pub settings: Settings,
    /// Name, driver and its version.
    pub device: [Option<String>; 3],
    /// The film's frames, from the first up to but not including the second.
    pub frames: [u32; 2],
    /// The film's pixels.
    pub size: [u32; 2],
    /// Number of the frame that the picture shows rows of.
    pub frame: u32,
    /// From the first up to but not including the second.
    pub rows: [u32; 2],
    /// Name of the picture's file, which lies beside this one.
    pub picture: String,
    /// Of its pixels.
    pub sha256: String,
}

impl Part {
    /// A part that has no frame yet.
    ///
    /// # Errors
    /// [`Failure::Input`] for a file that cannot be read.
    pub fn of<S: Study>(
        study: &S,
        variant: S::Variant,
        arguments: &MachineArgs,
        machine: &Machine,
        frames: Range<u32>,
    ) -> Result<Self, Failure> {
        let options = arguments.resolve(0);
        let identity = study.identity();
        let build = environment::build();
        let settings = Settings {
            paper: S::PAPER.to_owned(),
            variant: variant.as_str().to_owned(),
            preset: identity.preset,
            parameters: S::parameters().iter().map(|p| (p.name.to_owned(), p.text(study))).collect(),
            inputs: inputs(study)?,
            shader_compiler: options.compiler.to_string(),
            shaders: options.shaders_sha256()?,
            program: [
                Some(build.version),
                build.git_commit,
                build.executable_sha256.filter(|_| build.dirty != Some(false)),
            ],
        };
        let device = machine.environment().device;
        let device = [Some(device.name), device.driver, device.driver_version];
        let (frames, size) = ([frames.start, frames.end], [identity.width, identity.height]);
        // Paths may differ from machine to machine, contents may not.
        let contents: Vec<&String> = settings.inputs.iter().map(|input| &input.sha256).collect();
        let mut fixed = settings.clone();
        fixed.inputs.clear();
        let fixed = json!([fixed, contents, device, frames, size]).to_string();
        Ok(Part {
            schema: SCHEMA.to_owned(),
            identity: content::sha256(fixed.as_bytes()),
            settings,
            device,
            frames,
            size,
            frame: 0,
            rows: [0, size[1]],
            picture: String::new(),
            sha256: String::new(),
        })
    }

    /// The same of a frame and its rows.
    pub fn at(&mut self, frame: u32, rows: &Range<u32>) -> &mut Self {
        (self.frame, self.rows) = (frame, [rows.start, rows.end]);
        self
    }

    /// True when the picture is there, whole, and of the same settings, frame and rows.
    pub fn is_finished(&self, picture: &Path) -> bool {
        let found = read(&beside(picture));
        found.is_ok_and(|found| {
            let is_same = (&found.identity, found.frame, found.rows) == (&self.identity, self.frame, self.rows);
            is_same && found.has_picture(picture)
        })
    }

    /// True when the file is the picture that was drawn.
    pub fn has_picture(&self, picture: &Path) -> bool {
        matches!(self.checked_picture(picture), Ok(Some(_)))
    }

    /// The picture that was drawn; `None` where the file is another one.
    ///
    /// # Errors
    /// As [`read_png`](image::read_png).
    pub fn checked_picture(&self, picture: &Path) -> Result<Option<CheckedPng>, image::Error> {
        let (found, sha256) = CheckedPng::read_hashed(picture)?;
        let is_same = found.size() == (self.size[0], self.rows[1] - self.rows[0]) && sha256 == self.sha256;
        Ok(is_same.then_some(found))
    }

    /// Writes what stands beside the picture, which was written before it.
    pub fn write(&mut self, path: &Path, picture: &Rgba8) -> Result<(), Failure> {
        self.picture = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        self.sha256 = picture.sha256();
        Ok(file::write(&beside(path), outcome::text(self)?.as_bytes())?)
    }
}

/// Stands before the ending of a picture of some rows.
pub fn rows_suffix([first, end]: [u32; 2]) -> String {
    format!(".rows-{first}-{end}")
}

/// `pool-0007.rows-0-9.png` for rows of `pool-0007.png`.
pub fn of_rows(picture: &Path, rows: [u32; 2]) -> PathBuf {
    suffixed(picture, &rows_suffix(rows))
}

/// The file beside a picture.
pub fn beside(picture: &Path) -> PathBuf {
    let mut name = picture.file_name().unwrap_or_default().to_owned();
    name.push(ENDING);
    picture.with_file_name(name)
}

/// Reads what stands beside a picture.
///
/// # Errors
/// [`Failure::Input`] for a file that cannot be read or is no part of a film.
pub fn read(path: &Path) -> Result<Part, Failure> {
    let failed = |reason: String| Failure::Input(format!("reading the part {}: {reason}", path.display()));
    // Far more than any part has.
    let text = file::read_text(path, 1 << 24).map_err(|e| failed(e.to_string()))?;
    let part: Part = serde_json::from_str(&text).map_err(|e| failed(reader::plain(&e)))?;
    if part.schema != SCHEMA {
        return Err(failed(format!("its schema is {}, not {SCHEMA}", part.schema)));
    }
    let [first, end] = part.rows;
    let is_possible = first < end && end <= part.size[1] && part.frames[0] <= part.frame && part.frame < part.frames[1];
    if !is_possible {
        return Err(failed("its frame or rows are not the film's".to_owned()));
    }
    if Path::new(&part.picture).file_name().is_none_or(|name| name != part.picture.as_str()) {
        return Err(failed(format!("{:?} is no name of a file beside it", part.picture)));
    }
    Ok(part)
}

/// The parts of a folder, with their places.
pub fn in_folder(folder: &Path) -> Result<Vec<(PathBuf, Part)>, Failure> {
    let is_part = |path: &PathBuf| path.to_string_lossy().ends_with(ENDING);
    outcome::listed(folder)?.into_iter().filter(is_part).map(|path| read(&path).map(|part| (path, part))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_checked() {
        assert_eq!(parse_rows("0..9"), Ok(0..9));
        for text in ["5..5", "6..2", "3", "..", "-1..2"] {
            assert!(parse_rows(text).is_err(), "{text}");
        }
    }
}
