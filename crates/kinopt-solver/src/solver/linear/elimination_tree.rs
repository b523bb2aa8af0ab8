//! Elimination tree: the couplings of a symmetric matrix after factorisation.

/// Path of each unknown to the root of its tree.
///
/// A factorisation that eliminates the last unknown first fills in nothing outside these paths (Liu 1990, "The role of
/// elimination trees in sparse factorization"). For joints whose rows each belong to one frame, they are the paths to
/// the root of the kinematic tree.
#[derive(Clone, Debug)]
pub(super) struct EliminationTree {
    /// Paths in sequence, each from its unknown on; indices decrease along a path.
    paths: Vec<usize>,
    /// Index of the start of each path, and of the end of the last one.
    starts: Vec<usize>,
}

impl EliminationTree {
    /// Tree of this many unknowns, with coupling within each set.
    pub(super) fn new(unknowns: usize, coupled: &[Vec<usize>]) -> Self {
        let mut before = vec![vec![false; unknowns]; unknowns];
        for set in coupled {
            for (&a, &b) in set.iter().flat_map(|a| set.iter().map(move |b| (a, b))) {
                before[a.max(b)][a.min(b)] = a != b;
            }
        }
        let mut parents = vec![None; unknowns];
        for unknown in (0..unknowns).rev() {
            let couplings = std::mem::take(&mut before[unknown]);
            parents[unknown] = couplings.iter().rposition(|coupled| *coupled);
            // Unknowns coupled with an eliminated one become coupled with each other.
            if let Some(parent) = parents[unknown] {
                for (fill, _) in couplings[..parent]
                    .iter()
                    .enumerate()
                    .filter(|entry| *entry.1)
                {
                    before[parent][fill] = true;
                }
            }
        }
        let (mut paths, mut starts) = (Vec::new(), vec![0]);
        for unknown in 0..unknowns {
            paths.extend(std::iter::successors(Some(unknown), |&at| parents[at]));
            starts.push(paths.len());
        }
        Self { paths, starts }
    }

    pub(super) fn unknowns(&self) -> usize {
        self.starts.len() - 1
    }

    /// Number of entries of all paths.
    pub(super) fn entries(&self) -> usize {
        self.paths.len()
    }

    /// Unknowns from one to its root.
    pub(super) fn path_to_root(&self, unknown: usize) -> &[usize] {
        &self.paths[self.starts[unknown]..self.starts[unknown + 1]]
    }

    /// Index of an unknown's first entry.
    pub(super) fn start(&self, unknown: usize) -> usize {
        self.starts[unknown]
    }

    /// Index of the entry of two coupled unknowns.
    pub(super) fn entry(&self, a: usize, b: usize) -> usize {
        let (below, above) = (a.max(b), a.min(b));
        self.starts[below] + self.path_to_root(below).len() - self.path_to_root(above).len()
    }
}
