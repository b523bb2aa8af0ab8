//! Which points of a surface are next to each other.

/// The other ends of each point's edges: compressed sparse rows.
pub(super) struct Neighbours {
    starts: Vec<usize>,
    others: Vec<u32>,
}

impl Neighbours {
    /// Of so many points and the triangles over them.
    pub(super) fn of(points: usize, triangles: impl Iterator<Item = [u32; 3]>) -> Self {
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

    /// The points next to each point.
    pub(super) fn rows(&self) -> impl Iterator<Item = &[u32]> {
        let ends = self.starts.windows(2);
        ends.map(|ends| &self.others[ends[0]..ends[1]])
    }
}
