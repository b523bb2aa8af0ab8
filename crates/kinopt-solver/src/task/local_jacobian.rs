//! Derivatives of one residual by the twists of its frames and the values of its joints.

use std::ops::Range;

use kinopt_kinematics::buffer::refill;
use kinopt_kinematics::spatial::Vector3;

/// ∂r/∂twist for each frame and ∂r/∂value for each joint of one residual.
///
/// A frame's twist is its velocity (m) and angular velocity (rad) in world axes at its origin.
#[derive(Clone, Debug, Default)]
pub struct LocalJacobian {
    rows: usize,
    linear: Vec<Vector3<f64>>,
    angular: Vec<Vector3<f64>>,
    has_angular: Vec<bool>,
    joint_count: usize,
    /// The rows that each joint moves; empty until something is written.
    columns: Vec<Column>,
    entries: Vec<f64>,
}

/// The consecutive rows that one joint moves, and the range of their entries.
#[derive(Clone, Copy, Debug)]
struct Column {
    first_row: usize,
    first: usize,
    count: usize,
}

impl LocalJacobian {
    /// Sets the shape and every entry to zero; allocates only if the shape exceeds all shapes before.
    #[doc(hidden)]
    pub fn reset(&mut self, rows: usize, frames: usize, joints: usize) {
        self.rows = rows;
        refill(&mut self.linear, rows * frames, Vector3::zero());
        // Zeroed on first use of a frame, because most frames have no angular part.
        self.angular.resize(rows * frames, Vector3::zero());
        refill(&mut self.has_angular, frames, false);
        self.joint_count = joints;
        self.columns.clear();
        self.entries.clear();
    }

    /// Reserves memory for a residual of this shape.
    pub(crate) fn reserve(&mut self, rows: usize, frames: usize, joints: usize) {
        reserve_total(&mut self.linear, rows * frames);
        reserve_total(&mut self.angular, rows * frames);
        reserve_total(&mut self.has_angular, frames);
        reserve_total(&mut self.columns, joints);
        reserve_total(&mut self.entries, rows * joints);
    }

    /// Number of rows of the residual.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Range of one frame's or joint's rows; past the end for an unknown index.
    fn range(&self, index: usize) -> Range<usize> {
        let start = index.saturating_mul(self.rows);
        start..start.saturating_add(self.rows)
    }

    /// ∂r/∂velocity of a frame, one vector per row; empty for a frame that the residual does not read.
    #[must_use]
    pub fn linear(&self, frame: usize) -> &[Vector3<f64>] {
        self.linear.get(self.range(frame)).unwrap_or_default()
    }

    /// ∂r/∂angular velocity of a frame, one vector per row; empty if it was never written.
    #[must_use]
    pub fn angular(&self, frame: usize) -> &[Vector3<f64>] {
        match self.has_angular.get(frame) {
            Some(true) => self.angular.get(self.range(frame)).unwrap_or_default(),
            _ => &[],
        }
    }

    /// The stored entries of ∂r/∂value of a joint, as (row, entry); all other entries are zero.
    pub(crate) fn joint(&self, joint: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
        let column = self.columns.get(joint).copied();
        let (first_row, entry_range) = column.map_or((0, 0..0), |column| {
            (column.first_row, column.first..column.first + column.count)
        });
        let entries = self.entries.get(entry_range).unwrap_or_default();
        (first_row..).zip(entries.iter().copied())
    }

    /// ∂r/∂velocity of a frame, mutable; empty for a frame that the residual does not read.
    pub fn linear_mut(&mut self, frame: usize) -> &mut [Vector3<f64>] {
        let range = self.range(frame);
        self.linear.get_mut(range).unwrap_or_default()
    }

    /// ∂r/∂angular velocity of a frame, mutable; empty for a frame that the residual does not read.
    pub fn angular_mut(&mut self, frame: usize) -> &mut [Vector3<f64>] {
        let range = self.range(frame);
        let angular = self.angular.get_mut(range).unwrap_or_default();
        if let Some(turning) = self.has_angular.get_mut(frame) {
            if !*turning {
                angular.fill(Vector3::zero());
            }
            *turning = true;
        }
        angular
    }

    /// ∂r/∂value of a joint, mutable; empty for a joint that the residual does not read.
    pub fn joint_mut(&mut self, joint: usize) -> &mut [f64] {
        let is_dense = |column: &Column| column.count == self.rows;
        if self.columns.len() < self.joint_count || !self.columns.iter().all(is_dense) {
            self.make_dense();
        }
        let range = self.range(joint);
        self.entries.get_mut(range).unwrap_or_default()
    }

    /// Stores all rows for every joint.
    fn make_dense(&mut self) {
        let (rows, joints) = (self.rows, self.joint_count);
        let sparse = std::mem::take(&mut self.columns);
        let sparse_entries = match sparse.is_empty() {
            true => Vec::new(),
            false => std::mem::take(&mut self.entries),
        };
        refill(&mut self.entries, rows * joints, 0.0);
        for (joint, column) in sparse.iter().enumerate() {
            let to = &mut self.entries[joint * rows + column.first_row..][..column.count];
            to.copy_from_slice(&sparse_entries[column.first..column.first + column.count]);
        }
        self.columns = sparse;
        self.columns.clear();
        self.columns.extend((0..joints).map(|joint| Column {
            first_row: 0,
            first: joint * rows,
            count: rows,
        }));
    }

    /// Sets a diagonal Jacobian: row k depends on joint k only, with these derivatives.
    pub fn set_diagonal(&mut self, entries: impl IntoIterator<Item = f64>) {
        self.columns.clear();
        self.entries.clear();
        let count = self.rows.min(self.joint_count);
        for (joint, entry) in entries.into_iter().take(count).enumerate() {
            self.push_column(joint, [entry]);
        }
    }

    /// Adds the entries of the next joint, in consecutive rows from `first_row`.
    pub(super) fn push_column(&mut self, first_row: usize, entries: impl IntoIterator<Item = f64>) {
        let first = self.entries.len();
        self.entries.extend(entries);
        self.columns.push(Column {
            first_row,
            first,
            count: self.entries.len() - first,
        });
    }

    /// Writes the position of a point of a frame, times `weight`, to the first three rows.
    ///
    /// `lever` is the point relative to the frame's origin, in the axes of the rows; `None` for the origin itself.
    #[doc(hidden)]
    pub fn set_point(&mut self, frame: usize, lever: Option<Vector3<f64>>, weight: f64) {
        for (row, unit) in self.linear_mut(frame).iter_mut().zip(Vector3::UNITS) {
            *row = unit * weight;
        }
        let Some(lever) = lever else { return };
        // e · (ω × l) = ω · (l × e)
        for (row, unit) in self.angular_mut(frame).iter_mut().zip(Vector3::UNITS) {
            *row = lever.cross(unit) * weight;
        }
    }

    /// Multiplies each row by its weight.
    #[doc(hidden)]
    pub fn scale_rows(&mut self, weights: &[f64]) {
        if weights.iter().all(|weight| *weight == 1.0) {
            return;
        }
        // A residual may have no rows, but chunks must have a length.
        let rows = self.rows.max(1);
        let scale = |frame: &mut [Vector3<f64>]| {
            for (entry, &weight) in frame.iter_mut().zip(weights) {
                *entry = *entry * weight;
            }
        };
        self.linear.chunks_exact_mut(rows).for_each(scale);
        let frames = self.angular.chunks_exact_mut(rows).zip(&self.has_angular);
        for (frame, _) in frames.filter(|(_, turning)| **turning) {
            scale(frame);
        }
        for column in &self.columns {
            let column_entries = self.entries[column.first..].iter_mut().take(column.count);
            let weights = weights.iter().skip(column.first_row);
            for (entry, &weight) in column_entries.zip(weights) {
                *entry *= weight;
            }
        }
    }
}

/// Reserves capacity for `count` elements in total.
pub(super) fn reserve_total<T>(vector: &mut Vec<T>, count: usize) {
    vector.reserve(count.saturating_sub(vector.len()));
}
