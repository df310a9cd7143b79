//! Vertices, or triangles, in the order in which the heat boundary reaches them, cut into chunks: what a tick visits.

use super::NO_VERTEX;

/// Elements of a chunk (`burning/chunks.glsl`).
pub const CHUNK: usize = 128;
/// Chunks whose elements keep their own order among each other, at most: they lie together in memory then.
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
    /// Of elements by their least and greatest R.
    pub fn new(reaches: &[[f32; 2]]) -> Self {
        let mut order: Vec<u32> = (0..reaches.len() as u32).collect();
        let reach = |element: u32| reaches[element as usize];
        order.sort_by(|&a, &b| reach(a)[0].total_cmp(&reach(b)[0]));
        order.chunks_mut(CHUNK * together(reaches.len())).for_each(<[u32]>::sort_unstable);
        let span = |chunk: &[u32]| {
            let joined = |[low, high]: [f32; 2], [a, b]: [f32; 2]| [low.min(a), high.max(b)];
            chunk.iter().map(|&element| reach(element)).fold([f32::INFINITY, f32::NEG_INFINITY], joined)
        };
        let spans = order.chunks(CHUNK).map(span).collect();
        order.resize(order.len().next_multiple_of(CHUNK), NO_VERTEX);
        Chunks { order, spans }
    }

    /// Of vertices by their R.
    pub fn of_vertices(distances: impl Iterator<Item = f32>) -> Self {
        Self::new(&distances.map(|distance| [distance; 2]).collect::<Vec<_>>())
    }

    /// Of triangles by the R of their vertices: where all or none of them burn, the first alone changes a triangle's area.
    pub fn of_triangles(triangles: &[[u32; 3]], distance: impl Fn(u32) -> f32, burns: impl Fn(u32) -> bool) -> Self {
        let reach = |triangle: &[u32; 3]| {
            let [a, b, c] = triangle.map(&distance);
            let [one, two, three] = triangle.map(&burns);
            let first = a.min(b).min(c);
            [first, if one == two && two == three { first } else { a.max(b).max(c) }]
        };
        Self::new(&triangles.iter().map(reach).collect::<Vec<_>>())
    }

    /// Number of chunks.
    pub fn count(&self) -> u32 {
        self.spans.len() as u32
    }
}

/// Chunks of `count` elements that keep their own order among each other.
fn together(count: usize) -> usize {
    (count / (CHUNK * APART)).clamp(1, MOST_TOGETHER)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn chunks_hold_each_element_once_within_their_spans() {
        for count in [1, CHUNK, CHUNK + 1, 3 * CHUNK * APART - 3] {
            let reaches: Vec<[f32; 2]> =
                (0..count).map(|i| (i * 7919 % count) as f32).map(|low| [low, low + 2.0]).collect();
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
                assert!(inside.clone().all(|[a, b]| a >= *low && b <= *high));
                assert!(inside.clone().any(|[a, _]| a == *low) && inside.clone().any(|[_, b]| b == *high));
                assert!(high - low <= (CHUNK * together(count)) as f32 + 2.0);
            }
        }
    }
}
