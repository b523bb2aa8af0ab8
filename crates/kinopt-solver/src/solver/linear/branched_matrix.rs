//! Symmetric matrix with branch-induced sparsity, factorised from the tips to the root.

use std::sync::Arc;

use super::elimination_tree::EliminationTree;

/// Smallest pivot, relative to the largest diagonal entry.
const NEGLIGIBLE: f64 = 1e-14;

/// Symmetric matrix whose unknowns are each coupled only with those on the path to a root.
///
/// This is branch-induced sparsity (Featherstone 2005, "Efficient factorization of the joint-space inertia matrix for
/// branched kinematic trees"). A row stores the entries of its path in sequence, so an elimination updates one
/// contiguous part of another row.
#[derive(Clone, Debug)]
#[doc(hidden)]
pub struct BranchedMatrix {
    tree: Arc<EliminationTree>,
    entries: Vec<f64>,
}

impl BranchedMatrix {
    /// Zero matrix of this many unknowns, with coupling within each set.
    pub(crate) fn new(unknowns: usize, coupled: &[Vec<usize>]) -> Self {
        let tree = EliminationTree::new(unknowns, coupled);
        Self {
            entries: vec![0.0; tree.entries()],
            tree: Arc::new(tree),
        }
    }

    pub(crate) fn clear(&mut self) {
        self.entries.fill(0.0);
    }

    /// Adds to the entry of two coupled unknowns.
    pub(crate) fn add(&mut self, a: usize, b: usize, value: f64) {
        self.entries[self.tree.entry(a, b)] += value;
    }

    /// Writes A x.
    #[doc(hidden)]
    pub fn multiply(&self, x: &[f64], to: &mut [f64]) {
        to.fill(0.0);
        for k in 0..self.tree.unknowns() {
            let (path, row) = (self.tree.path_to_root(k), self.row(k));
            let mut sum = row[0] * x[k];
            for (&above, entry) in path[1..].iter().zip(&row[1..]) {
                sum += entry * x[above];
                to[above] += entry * x[k];
            }
            to[k] += sum;
        }
    }

    /// Copies another matrix with the same tree, adds damping to its diagonal, and fixes the held unknowns at `values`.
    ///
    /// Rows of held unknowns become rows of the identity. Their effect on the other equations moves to `right`.
    #[doc(hidden)]
    pub fn copy_free(
        &mut self,
        other: &Self,
        damping: f64,
        (held, values): (&[bool], &[f64]),
        right: &mut [f64],
    ) {
        self.entries.copy_from_slice(&other.entries);
        let tree = &*self.tree;
        for k in 0..tree.unknowns() {
            self.entries[tree.start(k)] += damping;
        }
        if !held.contains(&true) {
            return;
        }
        for k in 0..tree.unknowns() {
            let path = tree.path_to_root(k);
            let row = &mut self.entries[tree.start(k)..][..path.len()];
            for (&above, entry) in path[1..].iter().zip(&mut row[1..]) {
                if held[k] || held[above] {
                    // The right side of a held unknown is set below.
                    right[above] -= *entry * values[k];
                    right[k] -= *entry * values[above];
                    *entry = 0.0;
                }
            }
            if held[k] {
                row[0] = 1.0;
            }
        }
        for (k, right) in right.iter_mut().enumerate().filter(|(k, _)| held[*k]) {
            *right = values[k];
        }
    }

    /// Factorises A = LᵀL in place (Featherstone 2008, "Rigid Body Dynamics Algorithms", table 6.3).
    ///
    /// The diagonal then holds the inverses of L's. Returns false if the matrix is not positive definite.
    #[doc(hidden)]
    pub fn factorise(&mut self) -> bool {
        let tree = &*self.tree;
        let diagonal = (0..tree.unknowns()).map(|k| self.entries[tree.start(k)]);
        let min_pivot = NEGLIGIBLE * diagonal.fold(0.0, f64::max);
        for k in (0..tree.unknowns()).rev() {
            let path = tree.path_to_root(k);
            let (ancestors, later) = self.entries.split_at_mut(tree.start(k));
            let row = &mut later[..path.len()];
            let pivot = row[0];
            if pivot <= min_pivot || pivot.is_nan() {
                return false;
            }
            row[0] = 1.0 / pivot.sqrt();
            let inverse = row[0];
            row[1..].iter_mut().for_each(|entry| *entry *= inverse);
            for (step, &above) in path.iter().enumerate().skip(1) {
                let tail = &row[step..];
                let ancestor_row = &mut ancestors[tree.start(above)..][..tail.len()];
                let factor = tail[0];
                for (entry, value) in ancestor_row.iter_mut().zip(tail) {
                    *entry -= factor * value;
                }
            }
        }
        true
    }

    /// Solves A x = b in place after [`factorise`](Self::factorise): Lᵀ from the tips to the root, then L back.
    #[doc(hidden)]
    pub fn solve(&self, b: &mut [f64]) {
        for k in (0..self.tree.unknowns()).rev() {
            let (path, row) = (self.tree.path_to_root(k), self.row(k));
            let value = b[k] * row[0];
            b[k] = value;
            for (&above, entry) in path[1..].iter().zip(&row[1..]) {
                b[above] -= entry * value;
            }
        }
        for k in 0..self.tree.unknowns() {
            let (path, row) = (self.tree.path_to_root(k), self.row(k));
            let above = path[1..].iter().zip(&row[1..]);
            let known: f64 = above.map(|(&above, entry)| entry * b[above]).sum();
            b[k] = (b[k] - known) * row[0];
        }
    }

    fn row(&self, unknown: usize) -> &[f64] {
        &self.entries[self.tree.start(unknown)..self.tree.start(unknown + 1)]
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::{DMatrix, DVector};

    use super::BranchedMatrix;
    use kinopt_kinematics::random::RandomStream;

    /// Three branches on a root chain; two branches coupled at their tips; everything coupled; nothing.
    fn couplings() -> [Vec<Vec<usize>>; 4] {
        let limbs = vec![vec![0, 1, 2, 3], vec![0, 1, 4, 5, 6], vec![0, 7]];
        let mut tied = limbs.clone();
        tied.push(vec![3, 6]);
        [limbs, tied, vec![(0..8).collect()], Vec::new()]
    }

    #[test]
    fn branched_matrix_multiplies_and_solves_like_dense() {
        let mut random = RandomStream::new(5, 0);
        for coupled in couplings() {
            let n = 8;
            let (mut branched, mut dense) =
                (BranchedMatrix::new(n, &coupled), DMatrix::zeros(n, n));
            for set in coupled.into_iter().chain((0..n).map(|k| vec![k])) {
                // A row that depends on these unknowns.
                let row: Vec<f64> = set.iter().map(|_| 2.0 * random.unit() - 1.0).collect();
                for (p, &a) in set.iter().enumerate() {
                    for (q, &b) in set.iter().enumerate() {
                        dense[(a, b)] += row[p] * row[q];
                        if a >= b {
                            branched.add(a, b, row[p] * row[q]);
                        }
                    }
                }
            }
            let x = DVector::from_fn(n, |_, _| random.unit());
            let mut product = vec![0.0; n];
            branched.multiply(x.as_slice(), &mut product);
            assert!((&dense * &x - DVector::from_vec(product)).amax() < 1e-14);

            let damping = 0.5;
            for held in [vec![false; n], (0..n).map(|k| k % 3 == 1).collect()] {
                let b = DVector::from_fn(n, |_, _| random.unit());
                let mut full = &dense + DMatrix::identity(n, n) * damping;
                let mut right = b.clone();
                for k in (0..n).filter(|&k| held[k]) {
                    right -= full.column(k) * x[k];
                    full.row_mut(k).fill(0.0);
                    full.column_mut(k).fill(0.0);
                    full[(k, k)] = 1.0;
                }
                for k in (0..n).filter(|&k| held[k]) {
                    right[k] = x[k];
                }
                let expected = full.cholesky().map(|factor| factor.solve(&right));
                let (mut factor, mut solution) = (branched.clone(), b.as_slice().to_vec());
                factor.copy_free(&branched, damping, (&held, x.as_slice()), &mut solution);
                assert!(factor.factorise());
                factor.solve(&mut solution);
                let error =
                    expected.map(|expected| (expected - DVector::from_vec(solution)).amax());
                assert!(error.is_some_and(|error| error < 1e-13), "{error:?}");
            }
        }
    }

    #[test]
    fn factorise_rejects_indefinite_matrix() {
        let mut matrix = BranchedMatrix::new(2, &[vec![0, 1]]);
        for (a, b, value) in [(0, 0, 1.0), (1, 0, 2.0), (1, 1, 1.0)] {
            matrix.add(a, b, value);
        }
        assert!(!matrix.factorise());
    }
}
