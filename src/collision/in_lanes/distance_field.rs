//! How far the points of a grid are from what stands around: measured when first asked for, then remembered.
//!
//! A distance changes by at most as much as its point moves, so that the one at a grid point bounds all about it, from below and from
//! above. A sphere within half a cell's diagonal of touching is left to the shapes themselves, and nothing of what is said depends on what was
//! asked before.

use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};

use crate::collision::BoundingBox;
use crate::spatial::Vector3;

/// Grid points at most: four megabytes. Measured among 1 000 primitives: a quarter of them takes twice as long, twice as many save a fifth.
const MOST: f64 = 1_048_576.0;
/// Finer than so far, metres, shapes are asked as seldom.
const FINEST: f64 = 0.01;
/// More than what single precision loses of a few metres.
const ROUNDING: f64 = 1e-5;
/// Tells a value that was measured from one that was not.
const MEASURED: u32 = 1 << 31;

/// Distances over a grid in a box.
#[derive(Clone, Debug)]
pub(super) struct DistanceField {
    room: BoundingBox,
    cell: f64,
    counts: [usize; 3],
    /// Farther than so far, metres, is not told apart.
    farthest: f64,
    /// Single-precision bits, or 0; a clone shares them.
    distances: Arc<[AtomicU32]>,
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
                break counts;
            }
            cell *= 1.05;
        };
        let counts = counts.map(|count| count as usize);
        Some(Self {
            room,
            cell,
            farthest,
            distances: (0..counts.iter().product())
                .map(|_| AtomicU32::new(0))
                .collect(),
            counts,
        })
    }

    /// What is known of a point; `measure` tells how far a grid point is from all, if that is less than so far. `None` beside the grid.
    #[inline]
    pub(super) fn about(
        &self,
        point: Vector3<f64>,
        measure: impl FnOnce(Vector3<f64>, f64) -> f64,
    ) -> Option<Known> {
        let from_corner = (point - self.room.min) * self.cell.recip();
        let [x, y, z] = from_corner.to_array().map(|steps| steps as usize);
        let [columns, rows, layers] = self.counts;
        let inside = from_corner.to_array().iter().all(|&steps| steps >= 0.0);
        if !inside || x >= columns || y >= rows || z >= layers {
            return None;
        }
        let middle = Vector3::new(x as f64, y as f64, z as f64) + Vector3::new(0.5, 0.5, 0.5);
        let from_middle = (from_corner - middle).norm() * self.cell + ROUNDING;
        let remembered = &self.distances[(z * rows + y) * columns + x];
        let bits = match remembered.load(Ordering::Relaxed) {
            0 => {
                let place = self.room.min + middle * self.cell;
                let far = measure(place, self.farthest).clamp(0.0, self.farthest);
                let bits = (far as f32).to_bits() | MEASURED;
                // Whoever else measures it finds the same.
                remembered.store(bits, Ordering::Relaxed);
                bits
            }
            bits => bits,
        };
        let far = f64::from(f32::from_bits(bits & !MEASURED));
        Some(Known {
            least: far - from_middle,
            most: match far + ROUNDING < self.farthest {
                true => far + from_middle,
                false => f64::INFINITY,
            },
        })
    }
}
