//! Sources of a volume.

use std::path::{Path, PathBuf};

use super::{VoxelGrid, metaimage, nanovdb, nifti, nrrd};
use crate::file;
use crate::scene::error::{Asset, Fault};
use crate::scene::{Error, notes};

const KNOWN_ENDINGS: &str = ".nrrd, .nhdr, .mha, .mhd, .nii, .nii.gz, .hdr, .img, .nvdb";

/// Reads a volume, told apart by the file's ending; of samples of several values the component of that number, from 0, of
/// several grids the grid. A note says where more samples follow than the header states.
///
/// # Errors
/// A file that cannot be read, of an unknown format, or malformed, with the field that is wrong.
pub fn load(path: &Path, component: u32) -> Result<VoxelGrid, Error> {
    let read = || match ending(path).as_str() {
        "nrrd" | "nhdr" => nrrd::load(path, component),
        "mha" | "mhd" => metaimage::load(path, component),
        "nii" | "nii.gz" | "hdr" | "img" => nifti::load(path, component),
        "nvdb" => nanovdb::load(path, component),
        ending => {
            let (path, ending, known) = (path.to_owned(), ending.to_owned(), KNOWN_ENDINGS.to_owned());
            Err(Error::UnknownEnding { path, asset: Asset::Volume, ending, known })
        }
    };
    notes::of(Asset::Volume, path, read).0
}

/// The files that are read with one: the samples that its header names or that lie beside it, or the header.
pub fn companions(path: &Path) -> Vec<PathBuf> {
    let found = match ending(path).as_str() {
        "nrrd" | "nhdr" => nrrd::data_path(path),
        "mha" | "mhd" => metaimage::data_path(path),
        "hdr" | "img" => nifti::data_path(path),
        _ => Ok(None),
    };
    found.ok().flatten().into_iter().collect()
}

/// The ending in small letters, of a packed file with that of what is packed.
fn ending(path: &Path) -> String {
    let of = |path: &Path| path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
    let last = of(path);
    match of(&path.with_extension("")).as_str() {
        "nii" if last == "gz" => "nii.gz".to_owned(),
        _ => last,
    }
}

pub(super) fn malformed(path: &Path, fault: Fault) -> Error {
    Error::Malformed { path: path.to_owned(), asset: Asset::Volume, fault }
}

/// The file of the samples that a header names, in the header's folder or below.
pub(super) fn beside(header: &Path, name: &str) -> Result<PathBuf, Error> {
    let folder = header.parent().unwrap_or(Path::new(""));
    file::below(folder, Path::new(name)).map_err(|source| Error::Read { path: folder.join(name), source })
}
