//! The order of the drawn triangles in which a device shades the fewest vertices twice.

use std::collections::HashMap;

/// The numbers of the triangles, neighbours after each other.
pub fn draw_order(triangles: &[[u32; 3]], vertex_count: u32) -> Vec<u32> {
    // The first corner may be another afterwards.
    let turned = |&[a, b, c]: &[u32; 3]| {
        let least = a.min(b).min(c);
        if a == least {
            [a, b, c]
        } else if b == least {
            [b, c, a]
        } else {
            [c, a, b]
        }
    };
    let mut numbers: HashMap<[u32; 3], Vec<u32>> = HashMap::with_capacity(triangles.len());
    for (number, triangle) in triangles.iter().enumerate().rev() {
        numbers.entry(turned(triangle)).or_default().push(number as u32);
    }
    let ordered = meshopt::optimize_vertex_cache(triangles.as_flattened(), vertex_count as usize);
    let number_of = |t: &[u32]| numbers.get_mut(&turned(&[t[0], t[1], t[2]]))?.pop();
    ordered.chunks_exact(3).filter_map(number_of).collect()
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
