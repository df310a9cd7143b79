//! The levels of a map in tiles, written while its rows come: of each level the rows of one tile are held, no more.

use std::io::{self, Seek, SeekFrom, Write};
use std::path::Path;

use super::page_table::{PageTable, TILE};
use super::parameters::Interpolation;
use super::pyramid::{Bound, Shape, Texel, coarsen};
use crate::scene::{self, HeightMap, RowSource, Samples};

/// Writes all tiles in the order of their numbers, `first` being the place of the first, and gives the map without its samples
/// and the CRC-32 of each tile.
///
/// # Errors
/// Of the source; inside, of `out`.
pub fn write_tiles(
    out: &mut (impl Write + Seek),
    first: u64,
    table: &PageTable,
    interpolation: Interpolation,
    source: RowSource,
    name: &Path,
) -> Result<io::Result<(HeightMap, Vec<u32>)>, scene::Error> {
    match source.map().samples() {
        Samples::Steps { .. } => Writer::<u16, _>::new(out, first, table, interpolation).write(source, name),
        Samples::Float(_) => Writer::<f32, _>::new(out, first, table, interpolation).write(source, name),
    }
}

/// Rows of one level that no tile has yet.
struct Band<T> {
    bound: Bound,
    first_row: u32,
    texels: Vec<T>,
}

struct Writer<'a, T, W> {
    out: &'a mut W,
    first: u64,
    table: &'a PageTable,
    /// Of the levels of highest values from the data on, and of those of lowest values where there are any.
    chains: Vec<Vec<Band<T>>>,
    checksums: Vec<u32>,
}

impl<'a, T: Texel, W: Write + Seek> Writer<'a, T, W> {
    fn new(out: &'a mut W, first: u64, table: &'a PageTable, interpolation: Interpolation) -> Self {
        let bounds: &[Bound] = match interpolation {
            Interpolation::Bilinear => &[Bound::Highest],
            Interpolation::Bicubic => &[Bound::Highest, Bound::Lowest],
        };
        let band = |bound| Band { bound, first_row: 0, texels: Vec::new() };
        let chain = |&bound: &Bound| (0..=table.shape().top).map(|_| band(bound)).collect();
        let chains = bounds.iter().map(chain).collect();
        Writer { out, first, table, chains, checksums: vec![0; table.count()] }
    }

    fn write(mut self, source: RowSource, name: &Path) -> Result<io::Result<(HeightMap, Vec<u32>)>, scene::Error> {
        let mut failed = None;
        let map = source.read(name, &mut |rows| {
            let texels = T::rows_of(rows);
            let chains = 0..self.chains.len();
            failed = chains.map(|chain| self.push(chain, 0, texels)).find_map(Result::err);
            failed.is_none()
        })?;
        Ok(match (map, failed) {
            (Some(map), None) => Ok((map, self.checksums)),
            (_, failed) => Err(failed.unwrap_or_else(|| io::ErrorKind::WriteZero.into())),
        })
    }

    /// Takes whole rows of a level, and passes on to the coarser ones what fills the rows of a tile or ends the level.
    fn push(&mut self, chain: usize, shift: u32, rows: &[T]) -> io::Result<()> {
        let shape = self.table.shape();
        let (width, height) = shape.level(shift);
        let of_tile = TILE as usize * width as usize;
        let mut rest = rows;
        while !rest.is_empty() {
            let band = &mut self.chains[chain][shift as usize];
            let (now, later) = rest.split_at(rest.len().min(of_tile - band.texels.len()));
            band.texels.extend_from_slice(now);
            rest = later;
            let end = band.first_row + (band.texels.len() / width as usize) as u32;
            if band.texels.len() == of_tile || end == height {
                self.finish(chain, shift, shape)?;
            }
        }
        Ok(())
    }

    /// Writes the tiles of a band, and coarsens it.
    fn finish(&mut self, chain: usize, shift: u32, shape: Shape) -> io::Result<()> {
        let band = &mut self.chains[chain][shift as usize];
        let (bound, first_row) = (band.bound, band.first_row);
        let mut texels = std::mem::take(&mut band.texels);
        let (width, _) = shape.level(shift);
        let rows = (texels.len() / width as usize) as u32;
        band.first_row += rows;
        if let Some(number) = self.table.number(bound, shift, (0, first_row / TILE)) {
            self.write_row(number, &texels, width as usize)?;
        }
        if shift < shape.top {
            let coarser = (shape.level(shift + 1).0, rows.div_ceil(2));
            let coarser = coarsen(&texels, ((width, rows), coarser), bound);
            self.push(chain, shift + 1, &coarser)?;
        }
        texels.clear();
        self.chains[chain][shift as usize].texels = texels;
        Ok(())
    }

    /// Writes a row of tiles from a number on.
    fn write_row(&mut self, number: usize, texels: &[T], width: usize) -> io::Result<()> {
        let row_bytes = TILE as usize * size_of::<T>();
        let tile_bytes = TILE as usize * row_bytes;
        let mut bytes = vec![0; width.div_ceil(TILE as usize) * tile_bytes];
        for (row, texels) in texels.chunks_exact(width).enumerate() {
            for (tile, texels) in texels.chunks(TILE as usize).enumerate() {
                let texels: &[u8] = bytemuck::cast_slice(texels);
                bytes[tile * tile_bytes + row * row_bytes..][..texels.len()].copy_from_slice(texels);
            }
        }
        for (checksum, tile) in self.checksums[number..].iter_mut().zip(bytes.chunks_exact(tile_bytes)) {
            *checksum = crc32fast::hash(tile);
        }
        self.out.seek(SeekFrom::Start(self.first + number as u64 * tile_bytes as u64))?;
        self.out.write_all(&bytes)
    }
}
