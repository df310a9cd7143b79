//! Heat that runs ahead in what conducts it: a blade hands it on to its handle.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use glam::Vec3;

use super::Substance;

/// Lets heat take the way along the edges of what conducts it.
///
/// `distances` are the radii at which the boundary reaches the vertices through the air. Along an edge between vertices
/// of materials that conduct, the radius at which it reaches the farther end is that of the nearer and the edge's
/// length over the lower conductivity; from there heat goes on along the edges of any material by their length. `scale`
/// is what the boundary's radius grows by on a straight way of length 1.
pub fn conduct(
    positions: &[Vec3],
    triangles: &[[u32; 3]],
    substances: &[Substance],
    of_vertex: &[u32],
    scale: f32,
    distances: &mut [f32],
) {
    let conductivity = |vertex: u32| substances[of_vertex[vertex as usize] as usize].conductivity;
    if of_vertex.iter().all(|number| substances[*number as usize].conductivity <= 1.0) {
        return;
    }
    let mut first = vec![0_u32; positions.len() + 1];
    let edges = || triangles.iter().flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a), (b, a), (c, b), (a, c)]);
    edges().for_each(|(from, _)| first[from as usize + 1] += 1);
    for at in 1..first.len() {
        first[at] += first[at - 1];
    }
    let (mut next, mut ends) = (first.clone(), vec![0_u32; 6 * triangles.len()]);
    for (from, to) in edges() {
        ends[next[from as usize] as usize] = to;
        next[from as usize] += 1;
    }
    // Radii are not negative, so that their bits are in their order.
    let mut open: BinaryHeap<Reverse<(u32, u32)>> = (0..positions.len() as u32)
        .filter(|vertex| conductivity(*vertex) > 1.0)
        .map(|vertex| Reverse((distances[vertex as usize].to_bits(), vertex)))
        .collect();
    while let Some(Reverse((bits, vertex))) = open.pop() {
        let reached = f32::from_bits(bits);
        if reached > distances[vertex as usize] {
            continue;
        }
        let own = first[vertex as usize] as usize..first[vertex as usize + 1] as usize;
        for &end in &ends[own] {
            let length = positions[vertex as usize].distance(positions[end as usize]);
            let along = reached + scale * length / conductivity(vertex).min(conductivity(end));
            if along < distances[end as usize] {
                distances[end as usize] = along;
                open.push(Reverse((along.to_bits(), end)));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Kind, Substance};
    use super::*;

    /// A strip of squares along x of side 0.1, wood with metal in between, lit at its end.
    #[test]
    fn heat_runs_ahead_in_metal_and_goes_on_behind_it() {
        let count = 40;
        let positions: Vec<Vec3> =
            (0..2 * count).map(|i| Vec3::new(0.1 * (i / 2) as f32, 0.1 * (i % 2) as f32, 0.0)).collect();
        let triangles: Vec<[u32; 3]> = (0..2 * (count as u32 - 1)).map(|i| [i, i + 1, i + 2]).collect();
        let substances = [Substance::of(Kind::Wood), Substance { conductivity: 4.0, ..Substance::of(Kind::Metal) }];
        let of_vertex: Vec<u32> = (0..2 * count).map(|i| u32::from((10..30).contains(&(i / 2)))).collect();
        let air: Vec<f32> = positions.iter().map(|p| p.x).collect();
        let mut reached = air.clone();
        conduct(&positions, &triangles, &substances, &of_vertex, 1.0, &mut reached);
        for (i, (p, r)) in positions.iter().zip(&reached).enumerate() {
            let in_metal = (p.x - 1.0).clamp(0.0, 1.9);
            let expected = p.x - in_metal * 0.75;
            assert!((r - expected).abs() < 1e-5, "{i}: {r} {expected}");
        }
        // Nothing of what does not conduct changes.
        let mut wood = air.clone();
        conduct(&positions, &triangles, &substances, &vec![0; 2 * count], 1.0, &mut wood);
        assert_eq!(wood, air);
    }
}
