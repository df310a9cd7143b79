//! The triangles that each vertex belongs to: the lists that its thread gathers from.

/// One list a vertex, one after the other.
pub struct Incidence {
    /// First entry of each vertex's list, and the end of the last.
    pub offsets: Vec<u32>,
    /// Triangle times 4 plus corner, ascending within each list.
    pub entries: Vec<u32>,
}

impl Incidence {
    /// The lists of `vertex_count` vertices over `triangles`.
    pub fn new(vertex_count: usize, triangles: &[[u32; 3]]) -> Self {
        let mut offsets = vec![0; vertex_count + 1];
        for &vertex in triangles.as_flattened() {
            offsets[vertex as usize + 1] += 1;
        }
        for vertex in 0..vertex_count {
            offsets[vertex + 1] += offsets[vertex];
        }
        let mut next = offsets.clone();
        let mut entries = vec![0; triangles.len() * 3];
        for (triangle, corners) in (0..).zip(triangles) {
            for (corner, &vertex) in (0..).zip(corners) {
                let slot = &mut next[vertex as usize];
                entries[*slot as usize] = 4 * triangle + corner;
                *slot += 1;
            }
        }
        Incidence { offsets, entries }
    }

    /// The last vertex with the longest list, and its length.
    pub fn largest(&self) -> Option<(u32, u32)> {
        let counts = self.offsets.windows(2).map(|pair| pair[1] - pair[0]);
        (0..).zip(counts).max_by_key(|&(_, count)| count)
    }

    /// The list of one vertex.
    pub fn of(&self, vertex: u32) -> &[u32] {
        let [from, to] = [vertex, vertex + 1].map(|v| self.offsets[v as usize] as usize);
        &self.entries[from..to]
    }
}
