//! `assemble`: parts of films, and records of shards, put together.

mod pictures;
mod records;

use std::collections::BTreeSet;
use std::path::PathBuf;

use clap::Args;

pub use self::pictures::{Film, missing as missing_parts};
pub use self::records::{Shards, in_folders as shards_in_folders};
use super::failure::Failure;
use super::film;
use super::outcome;
use super::part;
use crate::image::y4m;
use crate::measure::shard;

#[derive(Debug, Clone, Args)]
pub struct AssembleArgs {
    /// Folders with what `render --shard`, `render --rows`, and --shard of stress, ab and experiments leave
    #[arg(value_name = "DIR", required = true)]
    sources: Vec<PathBuf>,
    /// Folder of the film's pictures, and of joined records
    #[arg(long, value_name = "DIR", default_value = "fumarole-out/assembled")]
    out: PathBuf,
    /// Write the frames as one film, YUV4MPEG2, in place of pictures
    #[arg(long, value_name = "FILE.y4m")]
    film: Option<PathBuf>,
    /// Frames of the film a second, 1 to 1000
    #[arg(long, value_name = "N", default_value_t = y4m::RATE, requires = "film",
        value_parser = clap::value_parser!(u32).range(1..=1000))]
    film_rate: u32,
    /// Of N shards, print the numbers of those that lack a part, comma-separated, and assemble nothing
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=i64::from(shard::MOST)))]
    missing: Option<u32>,
    /// Print nothing but errors and what was asked for
    #[arg(long, short)]
    quiet: bool,
}

pub fn run(arguments: &AssembleArgs) -> Result<(), Failure> {
    let mut parts = Vec::new();
    for source in &arguments.sources {
        parts.extend(part::in_folder(source)?);
    }
    let measurements = records::in_folders(&arguments.sources)?;
    if let Some(count) = arguments.missing {
        let mut missing = BTreeSet::new();
        for shards in &measurements {
            missing.extend(shards.missing(count)?);
        }
        if !parts.is_empty() || measurements.is_empty() {
            missing.extend(pictures::missing(parts, count)?);
        }
        let numbers: Vec<String> = missing.iter().map(u32::to_string).collect();
        return outcome::print(&if numbers.is_empty() { String::new() } else { numbers.join(",") + "\n" });
    }
    if parts.is_empty() && measurements.is_empty() {
        let message = "assemble: no part was found; render --shard, render --rows, and --shard of stress, ab and \
                       experiments leave them";
        return Err(Failure::Input(message.to_owned()));
    }
    let mut read: Vec<PathBuf> = measurements.iter().flat_map(records::Shards::read).collect();
    let film = if parts.is_empty() { None } else { Some(Film::of(parts)?) };
    let mut written = Vec::new();
    if let Some(film) = &film {
        film.check_whole()?;
        read.extend(film.read());
        match &arguments.film {
            Some(path) => {
                film::check(path)?;
                written.push(path.clone());
            }
            None => written.extend(film.pictures(&arguments.out)?),
        }
    }
    let joined = measurements.into_iter().map(|shards| shards.joined(&arguments.out)).collect::<Result<Vec<_>, _>>()?;
    outcome::check_apart(written.iter().chain(joined.iter().flat_map(records::Joined::files)), &read)?;
    film.map_or(Ok(()), |film| arguments.assemble(&film))?;
    joined.iter().try_for_each(|whole| whole.publish(arguments.quiet))
}

impl AssembleArgs {
    /// Writes the pictures, or the film.
    fn assemble(&self, whole: &Film) -> Result<(), Failure> {
        let wrote = match &self.film {
            Some(path) => {
                let count = film::shoot(path, self.film_rate, whole.frames())?;
                format!("wrote {count} frames to {}", path.display())
            }
            None => format!("wrote {} pictures to {}", whole.write(&self.out)?, self.out.display()),
        };
        if !self.quiet {
            outcome::say(&wrote);
        }
        Ok(())
    }
}
