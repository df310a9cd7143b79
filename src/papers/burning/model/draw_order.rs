//! The order of the drawn triangles in which a device shades the fewest vertices twice.

use rayon::slice::ParallelSliceMut;

/// The numbers of the triangles, neighbours after each other.
pub fn draw_order(triangles: &[[u32; 3]], vertex_count: u32) -> Vec<u32> {
    let ordered = meshopt::optimize_vertex_cache(triangles.as_flattened(), vertex_count as usize);
    // Both lists hold the same triangles, each in some order: sorted alike they lie side by side.
    let own = sorted(triangles.iter().copied());
    let ordered = sorted(ordered.chunks_exact(3).map(|t| [t[0], t[1], t[2]]));
    let mut order = vec![0; triangles.len()];
    for ((_, number), (_, place)) in own.iter().zip(&ordered) {
        order[*place as usize] = *number;
    }
    order
}

/// Triangles by their corners, whichever comes first, each with its place in the list.
fn sorted(triangles: impl Iterator<Item = [u32; 3]>) -> Vec<([u32; 3], u32)> {
    let turned = |[a, b, c]: [u32; 3]| [a, b, c].min([b, c, a]).min([c, a, b]);
    let mut sorted: Vec<_> = triangles.map(turned).zip(0..).collect();
    sorted.par_sort_unstable();
    sorted
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::papers::burning::model::{Welded, with_triangles};
    use crate::scene::{MeshSource, shapes};

    /// Vertices that a cache of 32 lacks, a triangle.
    fn misses(triangles: impl ExactSizeIterator<Item = [u32; 3]>) -> f64 {
        let (mut cache, mut missed, count) = (Vec::new(), 0, triangles.len());
        for vertex in triangles.flatten() {
            if !cache.contains(&vertex) {
                missed += 1;
                cache.push(vertex);
                if cache.len() > 32 {
                    cache.remove(0);
                }
            }
        }
        f64::from(missed) / count as f64
    }

    #[test]
    fn every_triangle_is_drawn_once_after_its_neighbours() {
        for mesh in [with_triangles(&MeshSource::Bunny.load().unwrap(), 8000), with_triangles(&shapes::cuboid(), 3000)]
        {
            let Welded { triangles, positions, .. } = Welded::new(&mesh);
            let order = draw_order(&triangles, positions.len() as u32);
            let mut sorted = order.clone();
            sorted.sort_unstable();
            assert!(sorted.into_iter().eq(0..triangles.len() as u32));
            let own = misses(triangles.iter().copied());
            let drawn = misses(order.iter().map(|number| triangles[*number as usize]));
            assert!(drawn < 0.9 && drawn < 0.6 * own, "{own} {drawn}");
        }
    }

    #[test]
    fn triangles_that_are_there_twice_are_drawn_twice() {
        let order = draw_order(&[[0, 1, 2], [3, 1, 2], [1, 2, 0], [0, 1, 2]], 4);
        let mut sorted = order.clone();
        sorted.sort_unstable();
        assert_eq!(sorted, [0, 1, 2, 3]);
    }
}
