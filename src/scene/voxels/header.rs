//! Headers of files of samples.

use std::io::{self, BufRead, Read, Seek, SeekFrom};

use flate2::bufread::{MultiGzDecoder, ZlibDecoder};
use glam::DVec3;

use super::VoxelGrid;
use super::raw::Raw;
use crate::scene::binary::{skip, spare_bytes};
use crate::scene::error::{Fault, Place};
use crate::scene::notes;

/// Layout, order and scale of the samples, by their header.
#[derive(Debug, PartialEq)]
pub(super) struct Header {
    /// Size, type and order of the samples.
    pub(super) raw: Raw,
    /// From a sample to the next of each axis, in the space of [`VoxelGrid`].
    pub(super) steps: [DVec3; 3],
    /// Lines before the samples, and then bytes.
    pub(super) skip_lines: u64,
    /// Bytes between those lines and the samples.
    pub(super) skip: Skip,
    /// Behind the lines it is packed by gzip or zlib.
    pub(super) is_packed: bool,
    /// Conversion of a sample to the value that it means.
    pub(super) scale: Scale,
}

/// Bytes before the samples.
#[derive(Debug, PartialEq)]
pub(super) enum Skip {
    Bytes(u64),
    /// The samples are the file's end.
    ToTheEnd,
}

/// Meaning of a sample: value times slope plus intercept.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Scale {
    /// Value of one unit of a sample.
    pub(super) slope: f32,
    /// Value of the sample 0.
    pub(super) intercept: f32,
}

impl Scale {
    pub(super) const PLAIN: Self = Self { slope: 1.0, intercept: 0.0 };
}

impl Header {
    /// Reads the samples from where the input stands, in a file of so many bytes.
    pub(super) fn grid(
        &self,
        mut input: impl BufRead + Seek,
        size_bytes: u64,
        component: u32,
    ) -> Result<VoxelGrid, Fault> {
        let failed = |error: io::Error| Fault::foreign(Place::Whole, &error);
        self.raw.check_component(component)?;
        for _ in 0..self.skip_lines {
            if input.skip_until(b'\n').map_err(failed)? == 0 {
                return Err(Fault::new(Place::Whole, format!("it has no {} lines to skip", self.skip_lines)));
            }
        }
        if self.is_packed {
            return self.grid_of_stream(unpacked(input).map_err(failed)?, size_bytes, component);
        }
        let start = input.stream_position().map_err(failed)?;
        let start = match self.skip {
            Skip::Bytes(bytes) => start.saturating_add(bytes),
            Skip::ToTheEnd => size_bytes.saturating_sub(self.raw.bytes()?).max(start),
        };
        let left = size_bytes.saturating_sub(start);
        self.raw.check_bytes(left)?;
        let more = left - self.raw.bytes()?;
        if more > 0 {
            notes::add(format!("{more} bytes behind the samples that its header states are left out"));
        }
        input.seek(SeekFrom::Start(start)).map_err(failed)?;
        self.made(self.raw.read(input, component)?)
    }

    /// Reads the samples from what a file of so many bytes is unpacked to.
    pub(super) fn grid_of_stream(
        &self,
        mut input: impl Read,
        size_bytes: u64,
        component: u32,
    ) -> Result<VoxelGrid, Fault> {
        let failed = |error: io::Error| match error.kind() {
            io::ErrorKind::UnexpectedEof => Fault::new(Place::Whole, "its packed samples end early; it is cut off"),
            _ => Fault::foreign(Place::Whole, &error),
        };
        self.raw.check_component(component)?;
        let Skip::Bytes(skip_bytes) = self.skip else {
            let reason = "what is packed has its samples at its start, not its end: skip a number of bytes, or none";
            return Err(Fault::new(Place::Whole, reason));
        };
        // A few bytes can be packed that unpack to anything.
        let most_bytes = spare_bytes(size_bytes);
        if self.raw.bytes()?.saturating_add(skip_bytes).max(4 * self.raw.count()) > most_bytes {
            let [x, y, z] = self.raw.size;
            let reason = format!(
                "it packs {x} x {y} x {z} samples into {size_bytes} bytes, which may be more than it holds; unpack it first"
            );
            return Err(Fault::new(Place::Whole, reason));
        }
        skip(&mut input, skip_bytes).map_err(failed)?;
        let samples = self.raw.read(&mut input, component)?;
        // What closes the packing tells whether it is whole.
        if io::copy(&mut input.take(1), &mut io::sink()).map_err(failed)? > 0 {
            notes::add("what is packed behind the samples that its header states is left out");
        }
        self.made(samples)
    }

    fn made(&self, mut samples: Vec<f32>) -> Result<VoxelGrid, Fault> {
        if self.scale != Scale::PLAIN {
            samples.iter_mut().for_each(|sample| *sample = *sample * self.scale.slope + self.scale.intercept);
        }
        VoxelGrid::new(self.raw.size, self.steps, samples)
    }
}

/// Undoes gzip, or zlib where it does not begin as gzip does.
pub(super) fn unpacked<'a>(mut input: impl BufRead + 'a) -> io::Result<Box<dyn Read + 'a>> {
    const GZIP: [u8; 2] = [0x1f, 0x8b];
    Ok(if input.fill_buf()?.starts_with(&GZIP) {
        Box::new(MultiGzDecoder::new(input))
    } else {
        Box::new(ZlibDecoder::new(input))
    })
}

#[cfg(test)]
mod tests {
    use super::super::tests::{META, NRRD, gzip, loaded, nifti, nrrd, shorts};
    use super::notes;

    #[test]
    fn what_follows_the_samples_is_told() {
        let bytes = shorts(0..14);
        let told = |files: &[(&str, &[u8])]| {
            notes::take();
            loaded(files, 0).unwrap();
            notes::take().join(" ")
        };
        let behind = "4 bytes behind the samples that its header states are left out";
        let packed = NRRD.replace("encoding: raw", "encoding: gzip");
        let apart = NRRD.replace("key:=value: x", "data file: a.raw");
        let scan = [nifti(false, &[]), vec![0; 4]].concat();
        for (name, file, part) in [
            ("a.nrrd", nrrd(NRRD, &bytes), behind),
            ("a.mha", nrrd(META, &bytes), behind),
            ("a.nii", scan.clone(), behind),
            ("a.nii.gz", gzip(&scan), "what is packed behind the samples"),
            ("a.nrrd", nrrd(&packed, &gzip(&bytes)), "what is packed behind the samples"),
            ("a.nhdr", apart.clone().into_bytes(), behind),
        ] {
            let found = told(&[(name, &file), ("a.raw", &bytes)]);
            assert!(found.starts_with("volume /") && found.contains(&format!("{name}: {part}")), "{name}: {found}");
        }
        assert_eq!(told(&[("a.nrrd", &nrrd(NRRD, &bytes[..24]))]), "");
        // There they stand at the end, whatever is before them.
        let end = apart.replace("data file", "byte skip: -1\ndata file");
        assert_eq!(told(&[("a.nhdr", end.as_bytes()), ("a.raw", &bytes)]), "");
    }
}
