//! Vertices, or triangles, in the order in which the heat boundary reaches them, cut into chunks: what a tick visits.

use super::NO_VERTEX;

/// Elements of a chunk (`burning/chunks.glsl`).
pub const CHUNK: usize = 128;
/// Chunks that count as reached together, at most: what burns as long keeps its own order among them, and lies together in
/// memory then.
const MOST_TOGETHER: usize = 8;
/// So many times as many chunks there are at least, so that the borders of areas pass through few of all.
const APART: usize = 512;

/// The chunks of a list of elements.
pub struct Chunks {
    /// Elements, [`CHUNK`] a chunk, [`NO_VERTEX`] beyond the last.
    pub order: Vec<u32>,
    /// Least and greatest R at which an element of each chunk changes.
    pub spans: Vec<[f32; 2]>,
}

impl Chunks {
    /// Of elements by the least and the greatest R at which they change, and the R of what of them burns last.
    pub fn new(reaches: &[[f32; 3]]) -> Self {
        let mut order: Vec<u32> = (0..reaches.len() as u32).collect();
        let reach = |element: u32| reaches[element as usize];
        order.sort_by(|&a, &b| reach(a)[0].total_cmp(&reach(b)[0]));
        // A chunk burns until the last of its elements has: those that burn long lie in chunks of their own.
        let burns = |element: u32| reach(element)[2] - reach(element)[0];
        for apart in order.chunks_mut(CHUNK * together(reaches.len())) {
            apart.sort_unstable();
            apart.sort_by(|&a, &b| burns(a).total_cmp(&burns(b)));
            apart.chunks_mut(CHUNK).for_each(<[u32]>::sort_unstable);
        }
        let span = |chunk: &[u32]| {
            let joined = |[low, high]: [f32; 2], [a, b, _]: [f32; 3]| [low.min(a), high.max(b)];
            chunk.iter().map(|&element| reach(element)).fold([f32::INFINITY, f32::NEG_INFINITY], joined)
        };
        let spans = order.chunks(CHUNK).map(span).collect();
        order.resize(order.len().next_multiple_of(CHUNK), NO_VERTEX);
        Chunks { order, spans }
    }

    /// Of vertices by their R.
    pub fn of_vertices(distances: impl Iterator<Item = f32>) -> Self {
        Self::new(&distances.map(|distance| [distance; 3]).collect::<Vec<_>>())
    }

    /// Of triangles by the R of their vertices: where all or none of them burn, the first alone changes a triangle's area.
    pub fn of_triangles(triangles: &[[u32; 3]], distance: impl Fn(u32) -> f32, burns: impl Fn(u32) -> bool) -> Self {
        let reach = |triangle: &[u32; 3]| {
            let [a, b, c] = triangle.map(&distance);
            let [one, two, three] = triangle.map(&burns);
            let (first, last) = (a.min(b).min(c), a.max(b).max(c));
            [first, if one == two && two == three { first } else { last }, last]
        };
        Self::new(&triangles.iter().map(reach).collect::<Vec<_>>())
    }

    /// Number of chunks.
    pub fn count(&self) -> u32 {
        self.spans.len() as u32
    }
}

/// Chunks of `count` elements that count as reached together.
fn together(count: usize) -> usize {
    (count / (CHUNK * APART)).clamp(1, MOST_TOGETHER)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn chunks_hold_each_element_once_within_their_spans() {
        for count in [1, CHUNK, CHUNK + 1, 3 * CHUNK * APART - 3] {
            let reaches: Vec<[f32; 3]> =
                (0..count).map(|i| (i * 7919 % count) as f32).map(|low| [low, low + 2.0, low + low % 9.0]).collect();
            let chunks = Chunks::new(&reaches);
            assert_eq!(
                (chunks.order.len(), chunks.count() as usize),
                (count.div_ceil(CHUNK) * CHUNK, count.div_ceil(CHUNK))
            );
            let (elements, padding) = chunks.order.split_at(count);
            assert!(padding.iter().all(|&none| none == NO_VERTEX));
            let mut sorted = elements.to_vec();
            sorted.sort_unstable();
            assert!(sorted.into_iter().eq(0..count as u32));
            for (chunk, [low, high]) in elements.chunks(CHUNK).zip(&chunks.spans) {
                let inside = chunk.iter().map(|&element| reaches[element as usize]);
                assert!(inside.clone().all(|[a, b, _]| a >= *low && b <= *high));
                assert!(inside.clone().any(|[a, ..]| a == *low) && inside.clone().any(|[_, b, _]| b == *high));
                assert!(high - low <= (CHUNK * together(count)) as f32 + 2.0);
            }
            // Of those that lie together, a chunk's elements burn longer than those of the chunk before it.
            let burns = |&element: &u32| reaches[element as usize][2] - reaches[element as usize][0];
            for apart in elements.chunks(CHUNK * together(count)) {
                let chunks: Vec<&[u32]> = apart.chunks(CHUNK).collect();
                for pair in chunks.windows(2) {
                    let longest = pair[0].iter().map(burns).fold(0.0, f32::max);
                    assert!(pair[1].iter().map(burns).all(|longer| longer >= longest));
                }
            }
        }
    }
}
