//! `tiles-*` and their `fragments`: the triangles of tiles of 8 x 8 pixels, and what they leave in each pixel.

mod fragments;
mod tiles_count;
mod tiles_empty;
mod tiles_fill;
mod tiles_pixels;
mod tiles_sum;

use std::sync::Arc;

use self::fragments::fragments;
use self::tiles_count::tiles_count;
use self::tiles_empty::tiles_empty;
use self::tiles_fill::tiles_fill;
use self::tiles_pixels::tiles_pixels;
use self::tiles_sum::tiles_sum;
use super::a_buffer::{ABuffer, read};
use super::band::{Band, BandConstants};
use super::capacity::Capacity;
use super::context::Context;
use super::parameters::{Lists, Parameters};
use super::pieces::Piece;
use super::scene_buffers::SceneBuffers;
use crate::gpu::pass::PassBuilder;
use crate::gpu::{Buffer, Error, Frame, Pass, ShaderLibrary};

/// Pixels along a tile's side.
pub const TILE: u32 = 8;
/// Bytes of a chunk in its widest buffer: two words a pixel.
pub const CHUNK_BYTES: u64 = 8 * (TILE * TILE) as u64;
/// Triangles of a chunk.
const CHUNK: u32 = 32;
/// Chunks of a tile that a dispatch of `fragments` does, without surface-defined gases and with some.
const CHUNKS_A_CALL: [u32; 2] = [32, 4];
/// Most dispatches of `fragments` for the triangles of a piece, as many as of a pass that carries work on.
const MOST_CALLS: u32 = 4096;
/// Threads of a row of a dispatch with a thread a triangle.
const TRIANGLES_A_ROW: u32 = 1 << 16;
/// Chunks of a row of a dispatch with a workgroup a chunk.
const CHUNKS_A_ROW: u32 = 1 << 15;
/// Bytes of a triangle in a chunk.
const TRIANGLE_BYTES: u64 = 16;
/// Bytes of a tile's count and place.
const TILE_BYTES: u64 = 8;

/// The passes that make the lists by tiles.
pub struct Tiles {
    chunks: u32,
    /// Of each tile its triangles and its first chunk.
    tiles: Arc<Buffer>,
    /// Of each place in a chunk the number of a triangle, and the depths of its nearest and its farthest corner.
    triangles: Arc<Buffer>,
    empty: Pass,
    sum: Pass,
    pieces: Vec<PieceOfTiles>,
}

/// The passes of a piece of the triangles.
struct PieceOfTiles {
    first_triangle: u32,
    triangle_count: u32,
    count: Pass,
    fill: Pass,
    pixels: Pass,
    fragments: Pass,
}

/// Resources of the passes.
struct Scope<'a> {
    scene: &'a SceneBuffers,
    lists: &'a ABuffer,
    /// As in [`Tiles`].
    tiles: &'a Arc<Buffer>,
    /// As in [`Tiles`].
    triangles: &'a Arc<Buffer>,
    /// uint\[chunks\]: the tile of each chunk.
    chunk_tiles: &'a Arc<Buffer>,
    /// uvec2\[64 chunks\]: of each pixel of a chunk's tile the triangles that touch it, and those that fill it and are opaque.
    pixels: &'a Arc<Buffer>,
}

impl Scope<'_> {
    /// Begins a pass over tiles.
    fn pass(&self, name: &'static str, shader: &str) -> PassBuilder {
        Pass::compute(name, "A-buffer", shader)
            .with("frame", &self.scene.frame)
            .with("Tiles", self.tiles)
            .constants::<BandConstants>()
    }

    /// Begins a pass over the triangles of a piece, in their tiles' chunks.
    fn pass_of_chunks(&self, name: &'static str, shader: &str, piece: &Piece) -> PassBuilder {
        self.pass(name, shader)
            .with("Objects", &self.scene.objects)
            .with("TileTriangles", self.triangles)
            .with("vertices", &piece.vertices)
            .with("triangles", &piece.triangles)
            .with("counts", &self.scene.counts)
    }
}

/// Tiles of a band of full height.
fn tile_count(parameters: &Parameters, capacity: Capacity) -> u64 {
    u64::from(parameters.width.div_ceil(TILE)) * u64::from(capacity.rows.div_ceil(TILE))
}

/// Bytes of the buffers of tiles; 0 without.
pub fn bytes(parameters: &Parameters, capacity: Capacity) -> f64 {
    let of_chunk = CHUNK_BYTES + u64::from(CHUNK) * TRIANGLE_BYTES + size_of::<u32>() as u64;
    let losses = size_of::<u32>() as u64 * u64::from(parameters.width) * u64::from(capacity.rows);
    let tiles = TILE_BYTES * (tile_count(parameters, capacity) + 1);
    match parameters.lists {
        Lists::Linked => 0.0,
        Lists::Tiles => (of_chunk * u64::from(capacity.chunks) + tiles) as f64,
        Lists::Nearest(_) => (of_chunk * u64::from(capacity.chunks) + tiles + losses) as f64,
    }
}

/// Dispatches of `fragments` for tiles of up to so many triangles.
///
/// # Errors
/// [`Error::Pass`] for more than [`MOST_CALLS`].
pub fn calls(most_of_tile: u32, has_surface_gas: bool) -> Result<u32, Error> {
    let calls = most_of_tile.div_ceil(CHUNK).div_ceil(CHUNKS_A_CALL[usize::from(has_surface_gas)]).max(1);
    if calls <= MOST_CALLS {
        return Ok(calls);
    }
    let problem = format!(
        "a tile of {TILE} x {TILE} pixels has {most_of_tile} triangles, for which {MOST_CALLS} dispatches are too few; give \
         `lists` linked"
    );
    Err(Error::Pass { pass: "fragments".to_owned(), problem })
}

impl Tiles {
    /// # Errors
    /// [`Error::Limit`] for more chunks than the device binds; what Vulkan answers.
    pub fn new(context: &Context<'_>, scene: &SceneBuffers, lists: &ABuffer) -> Result<Self, Error> {
        let capacity = lists.capacity;
        let chunks = u64::from(capacity.chunks);
        let tiles = context.storage::<[u32; 2]>("tiles", tile_count(context.parameters, capacity) + 1)?;
        let triangles = context.storage::<[u32; 4]>("tile-triangles", chunks * u64::from(CHUNK))?;
        let chunk_tiles = context.storage::<u32>("chunk-tiles", chunks)?;
        let pixels = context.storage::<[u32; 2]>("tile-pixels", chunks * u64::from(TILE * TILE))?;
        let pixel_count = u64::from(context.parameters.width) * u64::from(capacity.rows);
        let has_losses = context.parameters.lists.nearest().is_some();
        let losses = has_losses.then(|| context.storage::<u32>("losses", pixel_count)).transpose()?;
        let scope =
            Scope { scene, lists, tiles: &tiles, triangles: &triangles, chunk_tiles: &chunk_tiles, pixels: &pixels };
        let mut pieces: Vec<PieceOfTiles> = Vec::with_capacity(scene.pieces.len());
        for piece in &scene.pieces {
            let passes = match pieces.first() {
                Some(first) => first.rebound(context, piece)?,
                None => PieceOfTiles {
                    first_triangle: piece.first_triangle,
                    triangle_count: piece.triangle_count,
                    count: tiles_count(context.shaders, &scope, piece)?,
                    fill: tiles_fill(context.shaders, &scope, piece)?,
                    pixels: tiles_pixels(context.shaders, &scope, piece)?,
                    fragments: fragments(context, &scope, piece, losses.as_ref())?,
                },
            };
            pieces.push(passes);
        }
        let empty = tiles_empty(context.shaders, &scope)?;
        let sum = tiles_sum(context.shaders, &scope)?;
        Ok(Tiles { chunks: capacity.chunks, tiles, triangles, empty, sum, pieces })
    }

    /// The triangles of each tile of the last piece of the last band, by their numbers in the piece.
    ///
    /// # Errors
    /// [`Error::ReadBeforeWrite`] before the first frame; what Vulkan answers.
    pub fn read(&self, shaders: &ShaderLibrary) -> Result<Vec<Vec<u32>>, Error> {
        let tiles = read::<[u32; 2]>(shaders, &self.tiles)?;
        let triangles = read::<[u32; 4]>(shaders, &self.triangles)?;
        let of_tile = |&[count, first_chunk]: &[u32; 2]| {
            let places = triangles.iter().skip((first_chunk * CHUNK) as usize).take(count as usize);
            places.map(|[triangle, ..]| *triangle).collect()
        };
        Ok(tiles.iter().take(tiles.len().saturating_sub(1)).map(of_tile).collect())
    }

    /// Adds the fragments of a band to its lists, piece by piece.
    ///
    /// # Errors
    /// Those of Vulkan.
    pub fn record(&self, frame: &mut Frame<'_>, band: Band, calls: u32) -> Result<(), Error> {
        let rows = |count: u32, of: u32| (count.min(of), count.div_ceil(of));
        for piece in &self.pieces {
            let constants = band.constants_of_piece(piece.first_triangle, piece.triangle_count);
            let (x, y) = band.tiles(TILE);
            frame.compute(&self.empty, |dispatch| dispatch.constants(&constants).threads(x, y, 1))?;
            let (x, y) = rows(piece.triangle_count, TRIANGLES_A_ROW);
            frame.compute(&piece.count, |dispatch| dispatch.constants(&constants).threads(x, y, 1))?;
            frame.compute(&self.sum, |dispatch| dispatch.constants(&constants).threads(1, 1, 1))?;
            frame.compute(&piece.fill, |dispatch| dispatch.constants(&constants).threads(x, y, 1))?;
            let (x, y) = rows(self.chunks, CHUNKS_A_ROW);
            frame.compute(&piece.pixels, |dispatch| dispatch.constants(&constants).threads(x * CHUNK, y, 1))?;
            band.dispatch_piece(constants, calls, frame, &piece.fragments)?;
        }
        Ok(())
    }
}

impl PieceOfTiles {
    /// The same passes for another piece.
    fn rebound(&self, context: &Context<'_>, piece: &Piece) -> Result<Self, Error> {
        let rebound = |pass: &Pass| {
            let pass = pass.rebind().with("vertices", &piece.vertices).with("triangles", &piece.triangles);
            pass.build(context.shaders)
        };
        Ok(PieceOfTiles {
            first_triangle: piece.first_triangle,
            triangle_count: piece.triangle_count,
            count: rebound(&self.count)?,
            fill: rebound(&self.fill)?,
            pixels: rebound(&self.pixels)?,
            fragments: rebound(&self.fragments)?,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tiles_of_too_many_triangles_are_refused() {
        for (has_surface_gas, of_call) in [(false, 1024), (true, 128)] {
            let most = MOST_CALLS * of_call;
            let found = [0, of_call, of_call + 1, most].map(|count| calls(count, has_surface_gas).unwrap());
            assert_eq!(found, [1, 1, 2, MOST_CALLS]);
            let error = calls(most + 1, has_surface_gas).unwrap_err().to_string();
            assert!(error.contains("`lists` linked") && error.contains(&(most + 1).to_string()), "{error}");
        }
    }
}
