//! Which unknowns a symmetric matrix couples once it is factorised.

/// The way of each unknown to the root of its tree. A factorisation that takes out the last unknown first fills nothing beside
/// these ways (Liu 1990, "The role of elimination trees in sparse factorization"): of joints whose rows are each of one frame
/// they are the ways to a body's root.
#[derive(Clone, Debug)]
pub(super) struct EliminationTree {
    /// One way after the other, each from its own unknown on; numbers fall along it.
    ways: Vec<usize>,
    /// Where each begins, and where the last one ends.
    starts: Vec<usize>,
}

impl EliminationTree {
    /// Of so many unknowns, where those of each set are coupled with each other.
    pub(super) fn new(unknowns: usize, coupled: &[Vec<usize>]) -> Self {
        let mut before = vec![vec![false; unknowns]; unknowns];
        for set in coupled {
            for (&a, &b) in set.iter().flat_map(|a| set.iter().map(move |b| (a, b))) {
                before[a.max(b)][a.min(b)] = a != b;
            }
        }
        let mut parents = vec![None; unknowns];
        for unknown in (0..unknowns).rev() {
            let own = std::mem::take(&mut before[unknown]);
            parents[unknown] = own.iter().rposition(|coupled| *coupled);
            // What is coupled with one that is taken out is coupled from then on.
            if let Some(parent) = parents[unknown] {
                for (fill, _) in own[..parent].iter().enumerate().filter(|own| *own.1) {
                    before[parent][fill] = true;
                }
            }
        }
        let (mut ways, mut starts) = (Vec::new(), vec![0]);
        for unknown in 0..unknowns {
            ways.extend(std::iter::successors(Some(unknown), |&at| parents[at]));
            starts.push(ways.len());
        }
        Self { ways, starts }
    }

    pub(super) fn unknowns(&self) -> usize {
        self.starts.len() - 1
    }

    /// How many entries all ways have.
    pub(super) fn entries(&self) -> usize {
        self.ways.len()
    }

    /// The unknowns from one to its root.
    pub(super) fn way(&self, unknown: usize) -> &[usize] {
        &self.ways[self.starts[unknown]..self.starts[unknown + 1]]
    }

    /// Where the entries of an unknown begin.
    pub(super) fn start(&self, unknown: usize) -> usize {
        self.starts[unknown]
    }

    /// Where the entry of two coupled unknowns is.
    pub(super) fn entry(&self, a: usize, b: usize) -> usize {
        let (below, above) = (a.max(b), a.min(b));
        self.starts[below] + self.way(below).len() - self.way(above).len()
    }
}
