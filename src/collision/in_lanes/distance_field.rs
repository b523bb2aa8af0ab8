//! How far the points of grids are from what stands around: measured when first asked for, then remembered.
//!
//! A distance changes by at most as much as its point moves, so that the one at a grid point bounds all about it, from below and from
//! above. Grids are asked from the coarsest, which is soon full, to the finest, until the bounds tell: what is left is within half a fine cell's
//! diagonal of touching, and asks the shapes themselves. Nothing of what is said depends on what was asked before.

use std::sync::OnceLock;
use std::sync::atomic::{AtomicU32, Ordering};

use crate::collision::BoundingBox;
use crate::spatial::Vector3;

/// Points of the finest grid at most: four megabytes where all are asked about. Measured among 1 000 primitives: a quarter of them takes twice as
/// long, twice as many save a fifth.
const MOST: f64 = 1_048_576.0;
/// Finer than so far, metres, shapes are asked as seldom.
const FINEST: f64 = 0.01;
/// Each grid's cells are half as long as those of the one before.
const GRIDS: usize = 3;
/// More than what single precision loses of a few metres.
const ROUNDING: f64 = 1e-5;
/// Tells a value that was measured from one that was not.
const MEASURED: u32 = 1 << 31;

/// Distances over grids in a box.
#[derive(Debug)]
pub(super) struct DistanceField {
    corner: Vector3<f64>,
    /// Of the finest grid, metres.
    cell: f64,
    cells_per_metre: f64,
    /// Of the finest grid along each axis.
    counts: [usize; 3],
    /// Farther than so far, metres, is not told apart.
    farthest: f64,
    /// Along each axis.
    block_counts: [usize; 3],
    blocks: Box<[Block]>,
}

/// A cell of the coarsest grid.
#[derive(Debug, Default)]
struct Block {
    remembered: Remembered,
    /// Those in it, grid by grid, made when first asked about.
    finer: OnceLock<Box<[Remembered; FINER]>>,
}

/// Cells of all finer grids in one of the coarsest: 8 + 64 + ….
const FINER: usize = first_of(GRIDS);

/// Where those of a grid begin among them.
const fn first_of(grid: usize) -> usize {
    ((1 << (3 * grid)) - 8) / 7
}

/// A distance at the middle of a cell: single-precision bits, or 0 before it was measured.
#[derive(Debug, Default)]
struct Remembered(AtomicU32);

/// Which grids are asked.
#[derive(Clone, Copy, Debug)]
pub(super) enum Grids {
    /// All but the finest: these are soon full.
    Coarse,
    All,
}

/// What a field knows of the distance of a point, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Known {
    /// At least so far.
    pub(super) least: f64,
    /// At most so far; infinite where only the least is known.
    pub(super) most: f64,
}

impl DistanceField {
    /// Over a box, as fine as its memory allows; `None` for one without bounds or without volume.
    pub(super) fn new(room: BoundingBox, farthest: f64) -> Option<Self> {
        let extent = room.max - room.min;
        let volume = extent.x * extent.y * extent.z;
        // Not a number where the box is empty or without bounds.
        let has_volume = volume.is_finite() && extent.to_array().iter().all(|&length| length > 0.0);
        if !has_volume {
            return None;
        }
        let mut cell = FINEST;
        let counts = loop {
            let counts = extent.to_array().map(|length| (length / cell).ceil());
            if counts.iter().product::<f64>() <= MOST {
                break counts.map(|count| count as usize);
            }
            cell *= 1.05;
        };
        let block_counts = counts.map(|count| count.div_ceil(1 << (GRIDS - 1)));
        Some(Self {
            corner: room.min,
            cell,
            cells_per_metre: cell.recip(),
            counts,
            farthest,
            block_counts,
            blocks: (0..block_counts.iter().product())
                .map(|_| Block::default())
                .collect(),
        })
    }

    /// What is known of a point, as far as it takes to tell whether it is nearer than so far; `measure` tells how far a grid point is from
    /// all, if that is less than so far. `None` beside the grids.
    #[inline]
    pub(super) fn about(
        &self,
        point: Vector3<f64>,
        reach: f64,
        grids: Grids,
        measure: impl Fn(Vector3<f64>, f64) -> f64,
    ) -> Option<Known> {
        let point = point - self.corner;
        let cell = self.cell_of(point)?;
        let [x, y, z] = cell.map(|steps| steps >> (GRIDS - 1));
        let [columns, rows, _] = self.block_counts;
        let block = &self.blocks[(z * rows + y) * columns + x];
        let mut known = Known {
            least: f64::NEG_INFINITY,
            most: f64::INFINITY,
        };
        // What was measured last: where, and how far it is at most.
        let mut coarser = (point, f64::INFINITY);
        let asked = match grids {
            Grids::Coarse => GRIDS - 1,
            Grids::All => GRIDS,
        };
        for grid in 0..asked {
            let steps = GRIDS - 1 - grid;
            let own = cell.map(|along| along >> steps);
            let [x, y, z] = own.map(|along| along as f64 + 0.5);
            let middle = Vector3::new(x, y, z) * (self.cell * f64::from(1 << steps));
            let far = block.remembered(grid, own).or_measured(|| {
                let (about, far) = coarser;
                let limit = (far + (middle - about).norm()).min(self.farthest);
                measure(self.corner + middle, limit).clamp(0.0, limit)
            });
            let from_middle = (point - middle).norm();
            let most = match far + ROUNDING < self.farthest {
                true => far + ROUNDING,
                false => f64::INFINITY,
            };
            known = Known {
                least: far - ROUNDING - from_middle,
                most: most + from_middle,
            };
            if known.least >= reach || known.most < reach {
                break;
            }
            coarser = (middle, most);
        }
        Some(known)
    }

    /// The cell of the finest grid that a point from the corner is in.
    #[inline]
    fn cell_of(&self, point: Vector3<f64>) -> Option<[usize; 3]> {
        let steps = (point * self.cells_per_metre).to_array();
        let cell = steps.map(|steps| steps as usize);
        let inside = (0..3).all(|axis| steps[axis] >= 0.0 && cell[axis] < self.counts[axis]);
        inside.then_some(cell)
    }
}

impl Block {
    /// What is remembered of a cell of a grid, which is in this one.
    #[inline]
    fn remembered(&self, grid: usize, cell: [usize; 3]) -> &Remembered {
        if grid == 0 {
            return &self.remembered;
        }
        let finer = self
            .finer
            .get_or_init(|| Box::new([const { Remembered(AtomicU32::new(0)) }; FINER]));
        let [x, y, z] = cell.map(|along| along & ((1 << grid) - 1));
        &finer[first_of(grid) + (((z << grid | y) << grid) | x)]
    }
}

impl Remembered {
    /// What is remembered, else what is measured.
    #[inline]
    fn or_measured(&self, measure: impl FnOnce() -> f64) -> f64 {
        let bits = match self.0.load(Ordering::Relaxed) {
            0 => {
                let bits = (measure() as f32).to_bits() | MEASURED;
                // Whoever else measures it finds the same.
                self.0.store(bits, Ordering::Relaxed);
                bits
            }
            bits => bits,
        };
        f64::from(f32::from_bits(bits & !MEASURED))
    }
}
