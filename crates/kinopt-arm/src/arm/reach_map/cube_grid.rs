//! Grid of equal cubes of positions.

use super::super::reachability::Interval;
use kinopt_kinematics::spatial::Vector3;

/// Grid of `per_axis`³ cubes about a centre, in the base frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct CubeGrid {
    /// Metres.
    pub(super) centre: Vector3<f64>,
    /// Edge of a cube, metres.
    pub(super) step: f64,
    /// Number of cubes along each axis.
    pub(super) per_axis: usize,
}

impl CubeGrid {
    /// The smallest grid that contains a ball, with an odd number of cubes along each axis.
    ///
    /// The ball's centre is the centre of a cube, so that planar arms have cubes centred on their plane. Returns `None`
    /// for more than 2³¹ cubes.
    pub(super) fn around(centre: Vector3<f64>, radius: f64, step: f64) -> Option<Self> {
        let beside = (radius / step - 0.5).ceil().max(0.0);
        (beside < 640.0).then(|| Self {
            centre,
            step,
            per_axis: 2 * beside as usize + 1,
        })
    }

    pub(super) fn cubes(&self) -> usize {
        self.per_axis.pow(3)
    }

    /// Index of the cube that contains a position; `None` outside of the grid.
    pub(super) fn cube_at(&self, position: Vector3<f64>) -> Option<usize> {
        let offset = position - self.centre;
        let middle = 0.5 * self.per_axis as f64;
        let mut index = 0;
        for coordinate in offset.to_array() {
            let along = coordinate / self.step + middle;
            if !(along >= 0.0 && along < self.per_axis as f64) {
                return None;
            }
            index = index * self.per_axis + along as usize;
        }
        Some(index)
    }

    /// Intervals of x, y and z of a cube.
    pub(super) fn cube(&self, index: usize) -> [Interval; 3] {
        let n = self.per_axis;
        let centre = self.centre.to_array();
        let cells = [index / (n * n), index / n % n, index % n];
        [0, 1, 2].map(|axis| Interval {
            centre: centre[axis] + self.step * (cells[axis] as f64 - 0.5 * (n - 1) as f64),
            half_width: 0.5 * self.step,
        })
    }
}
