//! The tiles of a map's levels: which of them lie in the pool that the device holds, and what answers for the others.
//!
//! A tile that is not in the pool is answered for by the finest one over it that is. A texel of the highest values bounds all
//! that it covers, so whatever is in the pool, a level's value is at least that of every finer one below it, and rays meet one
//! surface: the data where they are held, elsewhere as high as the texel that stands for them.

use super::parameters::Interpolation;
use super::pyramid::{Bound, Shape};

/// Binary logarithm of the columns and rows of a tile; `shaders/terrain/tiles.glsl` has it, too.
const TILE_BITS: u32 = 7;
/// Columns and rows of a tile.
pub const TILE: u32 = 1 << TILE_BITS;
/// A tile, by what it is a part of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Tile {
    /// The highest values, or the lowest; the data are both.
    pub bound: Bound,
    /// Levels above the data.
    pub shift: u32,
    /// Its first column and row in its level.
    pub origin: (u32, u32),
}

/// The tiles of one level.
#[derive(Debug, Clone)]
struct Grid {
    bound: Bound,
    shift: u32,
    /// The number of its first tile; numbers rise row by row.
    first: usize,
    columns: u32,
    rows: u32,
    /// The grid of the next coarser level.
    coarser: Option<usize>,
}

impl Grid {
    fn count(&self) -> usize {
        self.columns as usize * self.rows as usize
    }

    /// Column and row of a tile by its number in the grid.
    fn tile_at(&self, index: usize) -> (u32, u32) {
        (index as u32 % self.columns, index as u32 / self.columns)
    }
}

/// A tile that is to be copied to a place of the pool, both by their numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Load {
    /// The tile.
    pub tile: usize,
    /// The place.
    pub place: usize,
}

/// The tiles of a map's levels, the coarsest first, and the places of a pool that hold some of them.
#[derive(Debug, Clone)]
pub struct PageTable {
    grids: Vec<Grid>,
    shape: Shape,
    column_bits: u32,
    /// Of each tile the place that holds it.
    places: Vec<Option<usize>>,
    /// Of each place its tile.
    tiles: Vec<Option<usize>>,
    /// Of each place the last exchange that its tile was asked in.
    asked_in: Vec<u64>,
    exchanges: u64,
    missing: usize,
    /// True where an image of the device has no room for tiles that the memory has room for.
    is_cut: bool,
}

/// Places that any pool has beside those of the tiles that are always held.
const FEW: usize = 4;

/// The number of grids of one tile, which come first.
fn always(grids: &[Grid]) -> usize {
    grids.iter().take_while(|grid| grid.count() == 1).count()
}

impl PageTable {
    /// Of a pool with room for `most` tiles, for as many as there are, or for those that are always held and a few more; it has at most
    /// `side` of them a side, which has room for the latter.
    pub fn new(shape: Shape, interpolation: Interpolation, most: usize, side: u32) -> Self {
        let mut grids: Vec<Grid> = Vec::new();
        for shift in (0..=shape.top).rev() {
            let (width, height) = shape.level(shift);
            let bounds: &[Bound] = match interpolation {
                Interpolation::Bicubic if shift > 0 => &[Bound::Highest, Bound::Lowest],
                _ => &[Bound::Highest],
            };
            for &bound in bounds {
                let first = grids.last().map_or(0, |last| last.first + last.count());
                let coarser = grids.iter().rposition(|grid| grid.bound == bound);
                let (columns, rows) = (width.div_ceil(TILE), height.div_ceil(TILE));
                grids.push(Grid { bound, shift, first, columns, rows, coarser });
            }
        }
        let count = grids.last().map_or(0, |last| last.first + last.count());
        let most = most.max(always(&grids) + FEW);
        let rows_in = |column_bits: u32| count.div_ceil(1 << column_bits).min(most >> column_bits);
        let (side, mut column_bits) = (side.max(1), most.min(count).max(1).ilog2() / 2);
        column_bits = column_bits.min(side.ilog2());
        // Wider, where it would be longer than an image.
        while rows_in(column_bits) > side as usize && column_bits < side.ilog2() {
            column_bits += 1;
        }
        let is_cut = rows_in(column_bits) > side as usize;
        let places = rows_in(column_bits).min(side as usize) << column_bits;
        PageTable {
            grids,
            shape,
            column_bits,
            places: vec![None; count],
            tiles: vec![None; places],
            asked_in: vec![0; places],
            exchanges: 0,
            missing: 0,
            is_cut,
        }
    }

    /// True where an image of the device has no room for tiles that the memory has room for.
    pub fn is_cut(&self) -> bool {
        self.is_cut
    }

    /// Sizes of the levels.
    pub fn shape(&self) -> Shape {
        self.shape
    }

    /// Columns and rows of the pool, in tiles.
    pub fn pool(&self) -> (u32, u32) {
        (1 << self.column_bits, (self.tiles.len() >> self.column_bits) as u32)
    }

    /// Column and row of a place in the pool, in texels.
    pub fn origin(&self, place: usize) -> (u32, u32) {
        let column = place & ((1 << self.column_bits) - 1);
        ((column as u32) << TILE_BITS, ((place >> self.column_bits) as u32) << TILE_BITS)
    }

    /// The number of tiles that are always held: those of levels of one tile.
    pub fn held_always(&self) -> usize {
        always(&self.grids)
    }

    /// The number of tiles.
    pub fn count(&self) -> usize {
        self.places.len()
    }

    /// The number of tiles that the pool holds.
    pub fn held(&self) -> usize {
        self.tiles.iter().flatten().count()
    }

    /// The number of tiles that were asked for in the last exchange and are not held.
    pub fn missing(&self) -> usize {
        self.missing
    }

    /// The tile of a number.
    pub fn tile(&self, number: usize) -> Tile {
        let after = self.grids.partition_point(|grid| grid.first <= number);
        let Grid { bound, shift, first, columns, .. } = self.grids[after - 1];
        let index = (number - first) as u32;
        Tile { bound, shift, origin: (index % columns * TILE, index / columns * TILE) }
    }

    /// The number of the tile of a level at a column and row of tiles; none of a level that there is not.
    pub fn number(&self, bound: Bound, shift: u32, (x, y): (u32, u32)) -> Option<usize> {
        let grid = self.grids.iter().find(|grid| grid.bound == bound && grid.shift == shift)?;
        (x < grid.columns && y < grid.rows).then(|| grid.first + y as usize * grid.columns as usize + x as usize)
    }

    /// Gives places to the tiles that are asked for, whose numbers rise, as many as the pool has, the coarsest first. Those that
    /// nothing asked for longest make room.
    pub fn exchange(&mut self, asked: impl IntoIterator<Item = usize>) -> Vec<Load> {
        self.exchanges += 1;
        let always = self.held_always();
        let mut wanted: Vec<usize> = (0..always).collect();
        wanted.extend(asked.into_iter().filter(|&tile| tile >= always && tile < self.places.len()));
        let (kept, without_room) = wanted.split_at(wanted.len().min(self.tiles.len()));
        for place in kept.iter().filter_map(|&tile| self.places[tile]) {
            self.asked_in[place] = self.exchanges;
        }
        let mut free: Vec<usize> =
            (0..self.tiles.len()).filter(|&place| self.asked_in[place] < self.exchanges).collect();
        free.sort_by_key(|&place| self.asked_in[place]);
        let lacking = kept.iter().copied().filter(|&tile| self.places[tile].is_none());
        let loads: Vec<Load> = lacking.zip(free).map(|(tile, place)| Load { tile, place }).collect();
        for &Load { tile, place } in &loads {
            if let Some(before) = self.tiles[place].replace(tile) {
                self.places[before] = None;
            }
            self.places[tile] = Some(place);
            self.asked_in[place] = self.exchanges;
        }
        self.missing = without_room.iter().filter(|&&tile| self.places[tile].is_none()).count();
        loads
    }

    /// The tiles whose marks are set, in the order of their numbers.
    pub fn marked(&self, marks: &[u32]) -> Vec<usize> {
        let tiles = self.grids.iter().flat_map(|grid| {
            (0..grid.count()).map(move |index| (grid.first + index, self.page(grid, grid.tile_at(index))))
        });
        tiles.filter(|(_, page)| marks.get(*page).is_some_and(|mark| *mark != 0)).map(|(tile, _)| tile).collect()
    }

    /// The pages as `shaders/terrain/tiles.glsl` reads them.
    pub fn pages(&self) -> Vec<u32> {
        let lowest = self.grids.iter().any(|grid| grid.bound == Bound::Lowest);
        let mut pages = vec![0_u32; self.bound_pages() * if lowest { 2 } else { 1 }];
        for grid in &self.grids {
            for index in 0..grid.count() {
                let (x, y) = grid.tile_at(index);
                let page = match (self.places[grid.first + index], grid.coarser.map(|coarser| &self.grids[coarser])) {
                    (Some(place), _) => {
                        let (column, row) = self.origin(place);
                        column >> TILE_BITS | row >> TILE_BITS << 12
                    }
                    // Before the first exchange nothing is held.
                    (None, None) => 0,
                    // A level further up from here.
                    (None, Some(coarser)) => pages[self.page(coarser, (x / 2, y / 2))] + (1 << 24),
                };
                pages[self.page(grid, (x, y))] = page;
            }
        }
        pages
    }

    /// The place of a tile among the pages: of each level they are a square, as if the map were one of 2^n x 2^n texels.
    fn page(&self, grid: &Grid, (x, y): (u32, u32)) -> usize {
        let finer = grid.shift.min(self.page_bits());
        let first = self.first_page(grid.shift) + if grid.bound == Bound::Lowest { self.bound_pages() } else { 0 };
        first + ((y as usize) << (self.page_bits() - finer)) + x as usize
    }

    /// The binary logarithm of the tiles a side of the data of such a map.
    fn page_bits(&self) -> u32 {
        self.shape.top.saturating_sub(TILE_BITS)
    }

    /// The first page of a level: the finer ones come before it.
    fn first_page(&self, shift: u32) -> usize {
        let squares = 4_usize << (2 * self.page_bits());
        let finer = shift.min(self.page_bits());
        // A geometric series, and then levels of one tile.
        (squares - (squares >> (2 * finer))) / 3 + (shift - finer) as usize
    }

    /// Pages of the highest values, or of the lowest, of all levels.
    fn bound_pages(&self) -> usize {
        self.first_page(self.shape.top) + 1
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::papers::terrain::pyramid::Pyramid;
    use crate::scene::random::Random;

    const SHAPE: Shape = Shape { width: 700, height: 391, top: 10 };
    /// Tiles along the images of many devices.
    const SIDE: u32 = 128;

    /// The page of a texel, as the shader finds it: the place that answers, and the levels up to it.
    fn answer(table: &PageTable, pages: &[u32], (bound, shift): (Bound, u32), (x, y): (u32, u32)) -> (usize, u32) {
        let bits = SHAPE.top - TILE_BITS;
        let first = |shift: u32| (0..shift).map(|finer| 1_usize << (2 * bits.saturating_sub(finer))).sum::<usize>();
        let lowest = if bound == Bound::Lowest && shift > 0 { first(SHAPE.top + 1) } else { 0 };
        let columns = 1_usize << bits.saturating_sub(shift);
        let page = pages[lowest + first(shift) + (y >> TILE_BITS) as usize * columns + (x >> TILE_BITS) as usize];
        let (column, row) = (page & 0xfff, page >> 12 & 0xfff);
        ((row as usize * table.pool().0 as usize) + column as usize, page >> 24)
    }

    /// Whatever the pool holds, a texel's value is that of its own level or a coarser one over it, and bounds those below it.
    #[test]
    fn levels_bound_each_other_whatever_is_held() {
        let mut random = Random::new(11);
        let data: Vec<u16> = (0..SHAPE.width * SHAPE.height).map(|_| (random.unit() * 60_000.0) as u16).collect();
        let pyramids = [Bound::Highest, Bound::Lowest].map(|bound| Pyramid::build(SHAPE, &data, bound));
        let mut table = PageTable::new(SHAPE, Interpolation::Bicubic, 40, SIDE);
        assert!(table.count() > 50 && table.held_always() == 16, "{} {}", table.count(), table.held_always());
        let mut was_up = 0;
        for round in 0..12 {
            let asked: Vec<usize> = (0..table.count()).filter(|_| random.unit() < 0.05 * round as f32).collect();
            table.exchange(asked.iter().copied());
            let pages = table.pages();
            let mut marks = vec![0; pages.len()];
            for grid in &table.grids {
                for index in (0..grid.count()).filter(|index| asked.contains(&(grid.first + index))) {
                    marks[table.page(grid, grid.tile_at(index))] = 1;
                }
            }
            assert_eq!(table.marked(&marks), asked);
            let value = |bound: Bound, shift: u32, (x, y): (u32, u32)| {
                let (place, up) = answer(&table, &pages, (bound, shift), (x, y));
                let tile = table.tile(table.tiles[place].unwrap());
                let (x, y, level) = (x >> up, y >> up, shift + up);
                // The data are their own lowest and highest values; what stands for them is the highest.
                assert!(tile.shift == level && (tile.bound == bound || shift == 0), "{tile:?} for level {shift}");
                assert_eq!((x & !(TILE - 1), y & !(TILE - 1)), tile.origin);
                let columns = SHAPE.level(level).0;
                let pyramid = &pyramids[usize::from(tile.bound == Bound::Lowest)];
                let texels = pyramid.level(level).unwrap_or(&data);
                (texels[(y * columns + x) as usize], up)
            };
            for shift in 1..=SHAPE.top {
                let (width, height) = SHAPE.level(shift - 1);
                for _ in 0..400 {
                    let below = ((random.unit() * width as f32) as u32, (random.unit() * height as f32) as u32);
                    let over = (below.0 >> 1, below.1 >> 1);
                    let (finer, up) = value(Bound::Highest, shift - 1, below);
                    assert!(value(Bound::Highest, shift, over).0 >= finer);
                    assert!(value(Bound::Lowest, shift, over).0 <= value(Bound::Lowest, shift - 1, below).0);
                    was_up = was_up.max(up);
                }
            }
        }
        assert!(was_up >= 2, "nothing was answered for by a level far above: {was_up}");
    }

    #[test]
    fn the_coarsest_come_first_and_the_longest_unasked_make_room() {
        let mut table = PageTable::new(SHAPE, Interpolation::Bilinear, 20, SIDE);
        let (always, places) = (table.held_always(), table.tiles.len());
        assert_eq!((always, places, table.pool()), (8, 20, (4, 5)));
        assert_eq!(table.exchange([]).len(), always);
        // All that there is: what has no room is the end of the list, the finest.
        let loads = table.exchange(0..table.count());
        assert_eq!(loads.iter().map(|load| load.tile).collect::<Vec<_>>(), (always..places).collect::<Vec<_>>());
        assert_eq!((table.held(), table.missing()), (places, table.count() - places));
        // Nothing new, nothing to do.
        assert!(table.exchange(0..table.count()).is_empty());
        // The first of the rest is still asked for; another takes the place of one that is not.
        table.exchange([always]);
        let loads = table.exchange([always, table.count() - 1]);
        assert_eq!(loads.len(), 1);
        assert!(table.places[always].is_some() && table.missing() == 0);
        assert_eq!(table.places[table.count() - 1], Some(loads[0].place));
        // No two tiles have one place, and both lists agree.
        for (place, tile) in table.tiles.iter().enumerate() {
            assert_eq!(tile.and_then(|tile| table.places[tile]), Some(place));
        }
    }

    #[test]
    fn numbers_and_tiles_are_each_others_inverse() {
        for interpolation in [Interpolation::Bilinear, Interpolation::Bicubic] {
            let table = PageTable::new(SHAPE, interpolation, 1, SIDE);
            for number in 0..table.count() {
                let Tile { bound, shift, origin: (x, y) } = table.tile(number);
                assert_eq!(table.number(bound, shift, (x / TILE, y / TILE)), Some(number));
            }
            assert_eq!(table.number(Bound::Lowest, 0, (0, 0)), None);
            assert_eq!(table.number(Bound::Highest, 0, (6, 0)), None);
        }
    }

    #[test]
    fn a_pool_is_no_larger_than_the_map_and_its_room() {
        for (most, expected) in [(1, (2, 6)), (14, (2, 7)), (20, (4, 5)), (1 << 20, (4, 10))] {
            let table = PageTable::new(SHAPE, Interpolation::Bilinear, most, SIDE);
            assert_eq!(table.pool(), expected, "{most} of {}", table.count());
        }
    }

    /// No pool is longer than an image, however much the memory has room for, and one that has fewer tiles for that says so.
    #[test]
    fn a_pool_is_an_image_of_the_device() {
        let shape = Shape { width: 16_000, height: 9_000, top: 14 };
        for side in [32, 61, 64, 128] {
            for (most, interpolation) in (4..16)
                .flat_map(|bits| [(1 << bits, Interpolation::Bilinear), ((2 << bits) - 1, Interpolation::Bicubic)])
            {
                let table = PageTable::new(shape, interpolation, most, side);
                let ((columns, rows), wanted) = (table.pool(), most.min(table.count()));
                let name = format!("{most} of {} in {side}: {columns} x {rows}", table.count());
                assert!(columns <= side && rows <= side && columns * rows >= (wanted as u32).min(20), "{name}");
                let is_short = ((columns * rows) as usize) < wanted - wanted / 4;
                assert!(table.is_cut() || !is_short, "{name}");
                assert!(!table.is_cut() || rows == side && 2 * columns > side, "{name}");
            }
        }
    }
}
