//! Files of what is seen.

use std::io;
use std::path::Path;

use super::side::Side;
use crate::file;
use crate::gpu::Mode;
use crate::image::{self, Rgba8, contact_sheet, preview, write_png, y4m};
use crate::measure::machine::Machine;
use crate::measure::study::Study;
use crate::measure::{Error, Paper};

/// Side of a picture of a contact sheet, pixels.
const CELL_PX: u32 = 256;

/// The picture as PNG.
///
/// # Errors
/// Of a picture that is not there yet, and of the file.
pub fn picture<S: Study>(machine: &Machine, side: &Side<S>, file: &Path) -> Result<(), Error> {
    check_ending(file, "png", "a picture")?;
    Ok(write_png(file, &shown(machine, side)?)?)
}

fn shown<S: Study>(machine: &Machine, side: &Side<S>) -> Result<Rgba8, Error> {
    side.picture(machine)?.ok_or_else(|| Error::Input("no pass has drawn the picture yet".to_owned()))
}

fn check_ending(file: &Path, ending: &str, what: &str) -> Result<(), Error> {
    let is_one = file.extension().is_some_and(|found| found.eq_ignore_ascii_case(ending));
    if is_one { Ok(()) } else { Err(Error::Input(format!("{}: end the name of {what} in .{ending}", file.display()))) }
}

/// All layers of a target at full precision.
///
/// # Errors
/// As [`picture`].
pub fn target<S: Study>(machine: &Machine, side: &Side<S>, name: &str, file: &Path) -> Result<(), Error> {
    image::Format::of(file)?;
    let Some(raster) = side.values(machine, name)? else {
        return Err(Error::Input(format!("no pass has written {name} yet")));
    };
    image::write(file, &raster)?;
    Ok(())
}

/// The picture and every target, small, in the order of the targets from the upper left; black where nothing is written.
///
/// # Errors
/// As [`picture`].
pub fn sheet<S: Study>(machine: &Machine, side: &Side<S>, file: &Path) -> Result<(), Error> {
    check_ending(file, "png", "a contact sheet")?;
    let whole = shown(machine, side)?;
    let raster = image::Raster::image(whole.width(), whole.height(), 4, 1, whole.pixels().to_vec())?;
    let mut cells = vec![cell(&preview(&raster, CELL_PX)?)?];
    for target in side.targets() {
        let small = side.values(machine, &target.name)?.map(|raster| preview(&raster, CELL_PX)).transpose()?;
        cells.push(small.as_ref().map_or_else(blank, cell)?);
    }
    let columns = cells.len().isqrt().max(1);
    let columns = if columns * columns < cells.len() { columns + 1 } else { columns };
    while cells.len() % columns != 0 {
        cells.push(blank()?);
    }
    let rows = cells.chunks(columns).map(contact_sheet::side_by_side).collect::<Result<Vec<_>, _>>()?;
    Ok(write_png(file, &contact_sheet::below_each_other(&rows)?)?)
}

fn blank() -> Result<Rgba8, Error> {
    Ok(Rgba8::new(CELL_PX, CELL_PX, [0, 0, 0, 255].repeat((CELL_PX * CELL_PX) as usize))?)
}

/// A small picture in the middle of a black square.
fn cell(small: &Rgba8) -> Result<Rgba8, Error> {
    let mut pixels = blank()?.pixels().to_vec();
    let (left, top) = ((CELL_PX - small.width()) / 2, (CELL_PX - small.height()) / 2);
    let row = 4 * small.width() as usize;
    for (y, line) in small.pixels().chunks_exact(row.max(1)).enumerate() {
        let start = 4 * ((top as usize + y) * CELL_PX as usize + left as usize);
        pixels[start..start + row].copy_from_slice(line);
    }
    // A target's alpha is a value, and no opacity.
    pixels.iter_mut().skip(3).step_by(4).for_each(|alpha| *alpha = 255);
    Ok(Rgba8::new(CELL_PX, CELL_PX, pixels)?)
}

/// Frames `first` up to but not including `end`, as one `.y4m` or as PNG files of their numbers. `proceed` is told the frames
/// that are done and says whether to go on; what is drawn then is kept. Gives the files.
///
/// # Errors
/// Of a range without a frame, of an ending that is neither; those of the Vulkan layer and of the files.
pub fn film<S: Study>(
    machine: &mut Machine,
    side: &mut Side<S>,
    (first, end): (u32, u32),
    file: &Path,
    mut proceed: impl FnMut(u32) -> bool,
) -> Result<Vec<String>, Error> {
    if first >= end {
        return Err(Error::Input(format!("{first}..{end} holds no frame")));
    }
    let mut draw = |number: u32| -> Result<Option<Rgba8>, Error> {
        if !proceed(number - first) {
            return Ok(None);
        }
        let going = |_| proceed(number - first);
        if side.draw(machine, number, (Mode::Plain, false), going)?.is_none() {
            return Ok(None);
        }
        side.picture(machine)
    };
    if check_ending(file, "y4m", "a film").is_ok() {
        let mut failure = None;
        let written = file::write_with(file, |output| {
            let (mut output, mut film) = (Some(output), None);
            for number in first..end {
                let frame = match draw(number) {
                    Ok(Some(frame)) => frame,
                    Ok(None) => break,
                    Err(error) => {
                        failure = Some(error);
                        return Err(io::Error::other("a frame could not be drawn"));
                    }
                };
                if let Some(output) = output.take() {
                    film = Some(y4m::Film::new(output, (frame.width(), frame.height()), y4m::RATE)?);
                }
                film.iter_mut().try_for_each(|film| film.push(&frame))?;
            }
            if film.is_some() { Ok(()) } else { Err(io::Error::other("it was cancelled before its first frame")) }
        });
        return match failure {
            Some(error) => Err(error),
            None => Ok(written.map(|()| vec![file.display().to_string()])?),
        };
    }
    check_ending(file, "png", "a film without .y4m")?;
    let mut files = Vec::new();
    for number in first..end {
        let Some(frame) = draw(number)? else { break };
        let path = image::numbered(file, number);
        write_png(&path, &frame)?;
        files.push(path.display().to_string());
    }
    Ok(files)
}

/// Notes on the files of a side and warnings of its paper that were not told before.
pub fn news<S: Study>(side: &Side<S>, told: &mut Vec<String>) -> Vec<String> {
    let all = side.notes.iter().cloned().chain(side.paper.warnings());
    let fresh: Vec<String> = all.filter(|warning| !told.contains(warning)).collect();
    told.extend(fresh.iter().cloned());
    fresh
}
