//! Start configurations from a goal's cell of the atlas and the neighbouring cells.

use std::ops::Range;

use super::atlas::Candidates;
use super::chain::MAX_JOINTS;
use super::lane::Lanes;
use super::prepared::Prepared;
use kinopt_kinematics::spatial::Placement;

/// Largest change by clamping to the bounds, radians or lengths of the solver; beyond it a start is dropped.
const MAX_CLAMPING: f64 = 0.3;

/// Number of cells in a neighbourhood along four coordinates, including the centre.
const NEIGHBOURHOOD_CELLS: usize = 3_usize.pow(4);

impl Prepared {
    /// Appends the configurations of a target's cell and of its neighbours with numbers `cells`.
    ///
    /// Neighbours are numbered by how many coordinates differ. Values are radians and metres within the bounds;
    /// configurations far outside are dropped. Returns true if there are further cells.
    ///
    /// A cell's configurations are corrected to the target in first order, so those of neighbours also converge in a
    /// few steps. Each cell holds samples of other branches, and other points of one branch.
    pub(super) fn neighbour_seeds(
        &self,
        target: &Placement<f64>,
        cells: Range<usize>,
        q: &mut Vec<f64>,
    ) -> bool {
        let (Some(atlas), false) = (&self.atlas, self.settings.weighted) else {
            return false;
        };
        let goal = self.links.goal_from_first(target, false);
        let (mut seed, n) = ([0.0; MAX_JOINTS], self.joints());
        for &cell_offset in
            &CELL_OFFSETS[cells.start.min(NEIGHBOURHOOD_CELLS)..cells.end.min(NEIGHBOURHOOD_CELLS)]
        {
            let mut candidates = Candidates::none();
            atlas.look_up_at::<Lanes<4, false>>(&self.links, &goal, cell_offset, &mut candidates);
            for index in 0..candidates.count {
                candidates.fill(index, &mut seed);
                let mut clamping: f64 = 0.0;
                for (q, link) in seed.iter_mut().zip(&self.links.links) {
                    let clamped = q.max(link.lower).min(link.upper);
                    clamping = clamping.max((clamped - *q).abs());
                    *q = clamped;
                }
                if clamping > MAX_CLAMPING {
                    continue;
                }
                self.links.to_metres(&mut seed[..n]);
                q.extend_from_slice(&seed[..n]);
            }
        }
        cells.end < NEIGHBOURHOOD_CELLS
    }
}

/// Offsets from a cell to itself and to its neighbours, those along few coordinates first.
const CELL_OFFSETS: [[i8; 4]; NEIGHBOURHOOD_CELLS] = {
    let mut offsets = [[0; 4]; NEIGHBOURHOOD_CELLS];
    let (mut count, mut changed) = (0, 0);
    while changed <= 4 {
        let mut code = 0;
        while code < NEIGHBOURHOOD_CELLS {
            let (mut offset, mut remainder, mut nonzero, mut k) = ([0; 4], code, 0, 0);
            while k < 4 {
                offset[k] = (remainder % 3) as i8 - 1;
                nonzero += (offset[k] != 0) as usize;
                remainder /= 3;
                k += 1;
            }
            if nonzero == changed {
                offsets[count] = offset;
                count += 1;
            }
            code += 1;
        }
        changed += 1;
    }
    offsets
};
