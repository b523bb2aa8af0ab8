//! Adjacency of the points of a surface.

/// Adjacent points of each point, as compressed sparse rows.
pub(super) struct Neighbours {
    starts: Vec<usize>,
    others: Vec<u32>,
}

impl Neighbours {
    /// Builds the adjacency of `points` points from triangles over them.
    pub(super) fn new(points: usize, triangles: impl Iterator<Item = [u32; 3]>) -> Self {
        let directed = |[a, b, c]: [u32; 3]| [(a, b), (b, a), (b, c), (c, b), (c, a), (a, c)];
        let mut edges: Vec<(u32, u32)> = triangles.flat_map(directed).collect();
        edges.sort_unstable();
        edges.dedup();
        let mut starts = vec![0; points + 1];
        for &(point, _) in &edges {
            starts[point as usize + 1] += 1;
        }
        for point in 1..starts.len() {
            starts[point] += starts[point - 1];
        }
        let others = edges.into_iter().map(|(_, other)| other).collect();
        Self { starts, others }
    }

    /// The adjacent points of each point.
    pub(super) fn rows(&self) -> impl Iterator<Item = &[u32]> {
        let ends = self.starts.windows(2);
        ends.map(|ends| &self.others[ends[0]..ends[1]])
    }
}
