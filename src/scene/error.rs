use std::fmt;
use std::io;
use std::path::PathBuf;

/// Why a mesh, a height map, a volume or a camera cannot be used. Every message is one line.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    #[error("cannot read {}: {source}; name a file that can be read", path.display())]
    Read {
        /// File that was to be read.
        path: PathBuf,
        /// The system's error.
        source: io::Error,
    },
    #[error("cannot read {}: it is not a regular file; name a {asset} file", path.display())]
    NotAFile {
        /// Directory, pipe or device that was named.
        path: PathBuf,
        /// Contents that were expected.
        asset: Asset,
    },
    #[error("cannot load {asset} {}: unknown file ending {ending:?}; known endings are {known}", path.display())]
    UnknownEnding {
        /// File that was named.
        path: PathBuf,
        /// Contents that were expected.
        asset: Asset,
        /// Its ending, without the dot.
        ending: String,
        /// Endings that are read as such contents.
        known: String,
    },
    #[error("cannot load {asset} {}: there is no such file, and none of that name is built in; name {known}", path.display())]
    UnknownName {
        /// Name that stands for no file.
        path: PathBuf,
        /// Contents that were expected.
        asset: Asset,
        /// Names and files that are read as such contents.
        known: String,
    },
    #[error("cannot load mesh {}: the number after the colon, of triangles that a mesh is divided into, must be 1 to {most}", path.display())]
    Division {
        /// The mesh and the number.
        path: PathBuf,
        /// Most triangles that a mesh is divided into.
        most: u64,
    },
    #[error("cannot load {asset} {}: {fault}", path.display())]
    Malformed {
        /// File that was read.
        path: PathBuf,
        /// Contents that were expected.
        asset: Asset,
        /// The fault and its place in the file.
        fault: Fault,
    },
    #[error("interrupted while reading {}", path.display())]
    Interrupted {
        /// File that was being read.
        path: PathBuf,
    },
    #[error("cannot use the camera: {reason}")]
    Camera {
        /// The fault in its position, target, angle or planes.
        reason: String,
    },
    #[error("cannot use the height map: {reason}")]
    HeightMap {
        /// The fault in its size, spacing or heights.
        reason: String,
    },
}

/// Kind of contents that a file is read as.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Asset {
    Mesh,
    HeightMap,
    Volume,
    WorldFile,
}

impl Asset {
    /// Names of those that the program carries; none of contents of which there is none.
    pub(super) fn built_in(self) -> Option<&'static str> {
        match self {
            Self::Mesh => Some("teapot, sphere, box, bunny, plane"),
            Self::HeightMap => Some("volcano, maunga-whau, jacksboro"),
            Self::Volume | Self::WorldFile => None,
        }
    }
}

/// A fault in the contents of a mesh, a height map or a volume, with its place.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{place}{reason}")]
pub struct Fault {
    /// Place of the fault.
    pub place: Place,
    /// One line.
    pub reason: String,
}

/// A place in a file or a mesh.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Place {
    Whole,
    /// Line of a text file, from 1.
    Line(usize),
    /// Offset in a binary file, from 0.
    Byte(usize),
    /// Vertex number, from 0.
    Vertex(usize),
    /// Face number, from 0.
    Face(usize),
    /// A named part, such as a buffer of a glTF file or a sample of a map.
    Part(String),
}

impl Fault {
    pub(super) fn new(place: Place, reason: impl Into<String>) -> Self {
        Self { place, reason: reason.into() }
    }

    /// A fault reported by a format library, whose messages may span lines and quote whole files.
    pub(super) fn foreign(place: Place, error: &impl fmt::Display) -> Self {
        const LONGEST: usize = 400;
        let text = error.to_string();
        let mut reason = text
            .lines()
            .map(str::trim)
            .filter(|line| !line.is_empty() && !line.starts_with("String:"))
            .collect::<Vec<_>>()
            .join("; ");
        reason.retain(|character| !character.is_control());
        // Names in backticks are options of ours.
        reason = reason.replace('`', "\"");
        if let Some((end, _)) = reason.char_indices().nth(LONGEST) {
            reason.truncate(end);
            reason.push_str("...");
        }
        Self { place, reason }
    }
}

impl fmt::Display for Asset {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(match self {
            Self::Mesh => "mesh",
            Self::HeightMap => "height map",
            Self::Volume => "volume",
            Self::WorldFile => "world file",
        })
    }
}

impl fmt::Display for Place {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Whole => Ok(()),
            Self::Line(line) => write!(formatter, "line {line}: "),
            Self::Byte(offset) => write!(formatter, "byte {offset}: "),
            Self::Vertex(index) => write!(formatter, "vertex {index}: "),
            Self::Face(index) => write!(formatter, "face {index}: "),
            Self::Part(name) => write!(formatter, "{name}: "),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn foreign_messages_become_one_short_line() {
        let message = format!("bad\n\tString: 'x'\n\tError: {}\u{7}", "y".repeat(1_000));
        let fault = Fault::foreign(Place::Line(3), &message);
        let shown = fault.to_string();
        assert!(shown.starts_with("line 3: bad; Error: yyy"), "{shown}");
        assert!(shown.chars().count() < 420 && !shown.contains(char::is_control));
    }
}
