//! Key of a goal and its cell in the atlas.

use super::table::Atlas;
use crate::simd_ik::links::frame_along;
use kinopt_kinematics::spatial::{Placement, Vector3};

/// A goal reduced by the symmetries of the leading and the last joint; lengths of the solver.
#[derive(Clone, Copy)]
pub(super) struct Key {
    /// Value of a prismatic leading joint; for a revolute one its angle, set only while a sample is stored.
    pub(super) shift: f64,
    /// Radius about a revolute leading axis and height along it; the two coordinates across a prismatic one.
    pub(super) position: [f64; 2],
    /// Last joint's axis, in the frame of the half plane.
    pub(super) axis: Vector3<f64>,
    /// First column of the orientation, in the frame of the half plane.
    pub(super) side: Vector3<f64>,
}

impl Atlas {
    /// Reduces a goal, given as the pose of the last joint's frame after its rotation.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(super) fn key(&self, pose: &Placement<f64>) -> Key {
        let p = pose.translation;
        let r = &pose.rotation;
        if self.lead_turns {
            let radius = (p.x * p.x + p.y * p.y).sqrt();
            let (sin, cos) = if radius > 1e-12 {
                (p.y / radius, p.x / radius)
            } else {
                (0.0, 1.0)
            };
            let into_half_plane =
                |v: Vector3<f64>| Vector3::new(v.x * cos + v.y * sin, v.y * cos - v.x * sin, v.z);
            Key {
                shift: 0.0,
                position: [radius, p.z],
                axis: into_half_plane(r.z),
                side: into_half_plane(r.x),
            }
        } else {
            Key {
                shift: p.z,
                position: [p.x, p.y],
                axis: r.z,
                side: r.x,
            }
        }
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(super) fn cell(&self, key: &Key) -> usize {
        self.cell_number(self.bins(key))
    }

    /// Number of the cell at this offset from the key's cell; `None` outside the table.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(super) fn cell_at_offset(&self, key: &Key, offset: [i8; 4]) -> Option<usize> {
        let mut bins = self.bins(key);
        if offset != [0; 4] {
            let r = &self.resolution;
            let counts = [r.radius, r.height, r.direction, r.direction];
            for k in 0..4 {
                bins[k] = bins[k].checked_add_signed(isize::from(offset[k]))?;
                if bins[k] >= counts[k] {
                    return None;
                }
            }
        }
        Some(self.cell_number(bins))
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn cell_number(&self, [i, j, k, l]: [usize; 4]) -> usize {
        let r = &self.resolution;
        ((i * r.height + j) * r.direction + k) * r.direction + l
    }

    /// Index of a key's cell along each coordinate.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn bins(&self, key: &Key) -> [usize; 4] {
        let bin = |value: f64, count: usize| (value.max(0.0) as usize).min(count - 1);
        let r = &self.resolution;
        let i = bin((key.position[0] - self.low[0]) * self.scale[0], r.radius);
        let j = bin((key.position[1] - self.low[1]) * self.scale[1], r.height);
        // Octahedral map of the direction.
        let a = key.axis;
        let size = (a.x.abs() + a.y.abs() + a.z.abs()).max(1e-12);
        let (mut u, mut v) = (a.x / size, a.y / size);
        if a.z < 0.0 {
            (u, v) = ((1.0 - v.abs()).copysign(u), (1.0 - u.abs()).copysign(v));
        }
        let half = 0.5 * r.direction as f64;
        let k = bin((u + 1.0) * half, r.direction);
        let l = bin((v + 1.0) * half, r.direction);
        [i, j, k, l]
    }

    /// Central direction of a cell and a unit vector perpendicular to it.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(super) fn direction_frame(&self, cell: usize) -> (Vector3<f64>, Vector3<f64>) {
        let d = self.resolution.direction;
        let (k, l) = (cell / d % d, cell % d);
        let to = |i: usize| (i as f64 + 0.5) * 2.0 / d as f64 - 1.0;
        let (u, v) = (to(k), to(l));
        let z = 1.0 - u.abs() - v.abs();
        let (x, y) = if z < 0.0 {
            ((1.0 - v.abs()).copysign(u), (1.0 - u.abs()).copysign(v))
        } else {
            (u, v)
        };
        let length = (x * x + y * y + z * z).sqrt();
        let centre = Vector3::new(x / length, y / length, z / length);
        (centre, frame_along(centre).x)
    }

    /// Sine and cosine of the rotation about the last axis from `h`, times a common factor.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(super) fn roll_parts(&self, key: &Key, h: Vector3<f64>) -> (f64, f64) {
        let x = key.side;
        (x.dot(key.axis.cross(h)), x.dot(h))
    }
}
