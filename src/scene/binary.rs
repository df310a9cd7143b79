use crate::scene::error::{Fault, Place};
use bytemuck::Pod;
use std::io::{self, ErrorKind, Read};

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum ByteOrder {
    Little,
    Big,
}

/// The raw rows of a raster.
pub(super) struct Rows {
    /// Samples in a row.
    pub(super) width: usize,
    /// Number of rows.
    pub(super) height: usize,
    /// Bytes from one row's start to the next one's, at least the row's own.
    pub(super) stride_bytes: u64,
    /// Order of a sample's bytes.
    pub(super) order: ByteOrder,
}

impl Rows {
    /// Reads the samples from the first row's start on.
    pub(super) fn read<T: Pod>(&self, mut input: impl Read) -> Result<Vec<T>, Fault> {
        let mut values = allocate::<T>(self.width * self.height)?;
        let gap_bytes = self.stride_bytes.saturating_sub((self.width * size_of::<T>()) as u64);
        for (row, values) in values.chunks_exact_mut(self.width).enumerate() {
            let bytes = bytemuck::cast_slice_mut::<T, u8>(values);
            let read = if row == 0 { Ok(()) } else { skip(&mut input, gap_bytes) };
            read.and_then(|()| input.read_exact(bytes)).map_err(|error| cut(row, &error))?;
            let native = if cfg!(target_endian = "big") { ByteOrder::Big } else { ByteOrder::Little };
            if self.order != native {
                bytes.chunks_exact_mut(size_of::<T>()).for_each(<[u8]>::reverse);
            }
        }
        Ok(values)
    }
}

/// Zeros, or a fault where the memory is not there.
pub(super) fn allocate<T: Pod>(count: usize) -> Result<Vec<T>, Fault> {
    let mut values = Vec::new();
    values.try_reserve_exact(count).map_err(|_| {
        let size_mib = (count * size_of::<T>()) >> 20;
        Fault::new(Place::Whole, format!("its samples take {size_mib} MiB, which this machine does not give"))
    })?;
    values.resize(count, T::zeroed());
    Ok(values)
}

/// Bytes of memory that a damaged file of `size_bytes` may take.
pub(super) fn spare_bytes(size_bytes: u64) -> u64 {
    size_bytes.saturating_mul(16).saturating_add(64 << 20)
}

/// Passes over bytes that nobody needs.
pub(super) fn skip(input: &mut impl Read, count_bytes: u64) -> io::Result<()> {
    let skipped = io::copy(&mut input.take(count_bytes), &mut io::sink())?;
    if skipped < count_bytes { Err(ErrorKind::UnexpectedEof.into()) } else { Ok(()) }
}

fn cut(row: usize, error: &io::Error) -> Fault {
    let place = Place::Part(format!("row {row}"));
    if error.kind() == ErrorKind::UnexpectedEof {
        return Fault::new(place, "the file ends here; it is cut off");
    }
    Fault::foreign(place, error)
}
