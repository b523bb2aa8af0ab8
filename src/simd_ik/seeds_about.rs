//! Start configurations from a goal's cell of the atlas and the neighbouring cells.

use std::ops::Range;

use super::atlas::Candidates;
use super::chain::MAX_JOINTS;
use super::lane::Lanes;
use super::prepared::Prepared;
use crate::spatial::Placement;

/// Largest change by clamping to the bounds, radians or lengths of the solver; beyond it a start is dropped.
const MOVED: f64 = 0.3;

/// Number of cells in a neighbourhood along four coordinates, including the centre.
const ABOUT: usize = 3_usize.pow(4);

impl Prepared {
    /// Appends the configurations of a target's cell and of its neighbours with numbers `cells`.
    ///
    /// Neighbours are numbered by how many coordinates differ. Values are radians and metres within the bounds;
    /// configurations far outside are dropped. Returns true if there are further cells.
    ///
    /// A cell's configurations are corrected to the target in first order, so those of neighbours also converge in a
    /// few steps. Each cell holds samples of other branches, and other points of one branch.
    pub(super) fn seeds_about(
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
        for &beside in &WAYS[cells.start.min(ABOUT)..cells.end.min(ABOUT)] {
            let mut found = Candidates::none();
            atlas.look_up_beside::<Lanes<4, false>>(&self.links, &goal, beside, &mut found);
            for index in 0..found.count {
                found.fill(index, &mut seed);
                let mut moved: f64 = 0.0;
                for (q, link) in seed.iter_mut().zip(&self.links.links) {
                    let within = q.max(link.lower).min(link.upper);
                    moved = moved.max((within - *q).abs());
                    *q = within;
                }
                if moved > MOVED {
                    continue;
                }
                self.links.to_metres(&mut seed[..n]);
                q.extend_from_slice(&seed[..n]);
            }
        }
        cells.end < ABOUT
    }
}

/// Offsets from a cell to itself and to its neighbours, those along few coordinates first.
const WAYS: [[i8; 4]; ABOUT] = {
    let mut ways = [[0; 4]; ABOUT];
    let (mut count, mut along) = (0, 0);
    while along <= 4 {
        let mut code = 0;
        while code < ABOUT {
            let (mut way, mut rest, mut steps, mut k) = ([0; 4], code, 0, 0);
            while k < 4 {
                way[k] = (rest % 3) as i8 - 1;
                steps += (way[k] != 0) as usize;
                rest /= 3;
                k += 1;
            }
            if steps == along {
                ways[count] = way;
                count += 1;
            }
            code += 1;
        }
        along += 1;
    }
    ways
};
