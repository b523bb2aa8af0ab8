//! Geometric Jacobian of a chain.
//!
//! A revolute joint about the axis z through p adds (z × (x − p), z) to the twist of a tip at x. A prismatic joint
//! along z adds (z, 0) (Siciliano et al. 2009, "Robotics", eq. 3.30).

use super::lane::{LaneScalar, Lanes};
use super::links::Links;
use kinopt_kinematics::scalar::Scalar;
use kinopt_kinematics::spatial::Vector3;

type Four = Lanes<4, false>;

impl Links {
    /// Writes six entries per joint at q (radians and metres), in the base's axes.
    ///
    /// They are the tip's linear velocity in metres and its angular velocity, per unit of joint velocity. A radian of
    /// angular velocity counts as `radian`.
    pub(crate) fn write_twists(&self, q: &[f64], radian: f64, entries: &mut [f64]) {
        let mut r = self.base_from_first.rotation;
        let mut p = self.base_from_first.translation;
        // Sines and cosines of four joints at a time. The linear half holds the joint's position until the tip is
        // known.
        let fours = self.links.chunks(4).zip(q.chunks(4));
        for ((links, q), columns) in fours.zip(entries.chunks_mut(24)) {
            let mut angle = Four::zero();
            for (i, (link, q)) in links.iter().zip(q).enumerate() {
                angle.set_lane(i, q + link.offset);
            }
            let (sin, cos) = angle.sin_cos();
            let columns = columns.chunks_exact_mut(6);
            for (i, ((link, &q), column)) in links.iter().zip(q).zip(columns).enumerate() {
                let z = r.z;
                column.copy_from_slice(&[p.x, p.y, p.z, z.x, z.y, z.z]);
                if link.kind.turns() {
                    r = r.rotated_about_z((sin.lane(i), cos.lane(i)));
                } else {
                    p += z * (q * self.lengths_per_metre);
                    r = r.rotated_about_z(link.offset_sin_cos);
                }
                p = p + r.x * link.along_x + r.y * link.along_y;
                r = r.rotated_about_x(link.twist);
            }
        }
        let metres = self.metres_per_length;
        for (link, column) in self.links.iter().zip(entries.chunks_exact_mut(6)) {
            let &mut [x, y, z, a, b, c] = column else {
                continue;
            };
            let axis = Vector3::new(a, b, c);
            let (linear, angular) = match link.kind.slides() {
                true => (axis, Vector3::zero()),
                false => {
                    let arm = p - Vector3::new(x, y, z);
                    (axis.cross(arm) * metres, axis * radian)
                }
            };
            column[..3].copy_from_slice(&linear.to_array());
            column[3..].copy_from_slice(&angular.to_array());
        }
    }
}
