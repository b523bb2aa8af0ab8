//! Chain in normal form for the inner loop: every axis is z, every constant rotation is about x.
//!
//! Between two z axes any constant rotation is R_z(β) R_x(α) R_z(γ). The rotations about z move into the offsets of the
//! adjacent joints, which leaves R_x(α). The origin of a joint may move along its axis, which removes the z part of
//! every translation. Both are exact for any chain, even with nearly parallel axes, unlike Denavit-Hartenberg's common
//! normal.

use super::chain::Chain;
use kinopt_kinematics::model::JointKind;
use kinopt_kinematics::scalar::elementary;
use kinopt_kinematics::spatial::{Matrix3, Placement, Vector3, rounding};

/// One joint and the constant transform to the next.
///
/// A revolute joint is `R_z(value + offset)`, then a translation `(along_x, along_y, 0)`, then `R_x(α)`. A prismatic
/// joint is a translation by the value along z and `R_z(offset)` instead.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Link {
    pub(crate) kind: JointKind,
    /// Slot of the group's frames that this link reads.
    pub(crate) from: usize,
    /// Slot of the group's frames that this link writes.
    pub(crate) to: usize,
    /// Constant rotation about z, radians.
    pub(crate) offset: f64,
    /// Sine and cosine of the offset, for prismatic joints.
    pub(crate) offset_sin_cos: (f64, f64),
    /// Translation to the next joint along x, lengths of the solver.
    pub(crate) along_x: f64,
    /// Translation to the next joint along y, lengths of the solver.
    pub(crate) along_y: f64,
    /// Sine and cosine of α.
    pub(crate) twist: (f64, f64),
    /// Lower bound of the value, radians or lengths of the solver.
    pub(crate) lower: f64,
    /// Upper bound of the value, radians or lengths of the solver.
    pub(crate) upper: f64,
}

/// A chain as links, with the constant transforms at its ends.
///
/// The solver's unit of length is `metres_per_length`, so thresholds mean the same for chains of any size. It is the
/// chain's reach: results in other units agree up to rounding, and exactly if the units differ by a power of two. With
/// prismatic joints it is rounded down to a power of two, so values and limits convert without loss.
#[derive(Clone, Debug)]
pub(crate) struct Links {
    pub(crate) links: Vec<Link>,
    /// Placement of the first joint in the base frame; lengths of the solver.
    pub(crate) base_from_first: Placement<f64>,
    /// Orientation of the tip in the frame after the last joint; the last link includes its position.
    pub(crate) last_from_tip: Matrix3<f64>,
    /// Displacement of the first and the last origin along their axes, metres.
    pub(crate) origin_shifts: (f64, f64),
    /// True if every joint is revolute.
    pub(crate) all_revolute: bool,
    /// Metres per length of the solver.
    pub(crate) metres_per_length: f64,
    /// Lengths of the solver per metre.
    pub(crate) lengths_per_metre: f64,
    /// Sum of the lengths of the chain's constant translations, metres.
    pub(crate) extent: f64,
}

impl Links {
    /// Rounding error of the tip's pose at joint values of these magnitudes, metres and radians.
    ///
    /// Values are in the solver's units and not negative.
    #[inline]
    pub(crate) fn resolution(&self, values: impl Iterator<Item = f64>) -> (f64, f64) {
        let (mut turned, mut slid) = (0.0, 0.0);
        for (value, link) in values.zip(&self.links) {
            *(if link.kind.slides() {
                &mut slid
            } else {
                &mut turned
            }) += value;
        }
        let size = self.extent + slid * self.metres_per_length;
        rounding(self.links.len(), turned, size)
    }

    pub(crate) fn new(chain: &Chain) -> Self {
        let joints = chain.joints();
        let mut links: Vec<Link> = Vec::with_capacity(joints.len());
        let mut translations: Vec<Vector3<f64>> = Vec::with_capacity(joints.len());
        let mut previous_alignment = Matrix3::identity();
        let mut base_from_first = Placement::identity();
        for (index, joint) in joints.iter().enumerate() {
            let alignment = frame_along(joint.axis);
            let step = Placement::new(previous_alignment.transpose(), Vector3::zero())
                * joint.parent_from_joint
                * Placement::new(alignment, Vector3::zero());
            previous_alignment = alignment;
            let mut offset = 0.0;
            if let Some(before) = links.last_mut() {
                let (beta, twist, gamma) = decompose_zxz(&step.rotation);
                before.offset += beta;
                before.twist = twist;
                offset = gamma;
                translations.push(
                    Matrix3::identity().rotated_about_z(elementary::sin_cos(-beta))
                        * step.translation,
                );
            } else {
                base_from_first = step;
            }
            debug_assert_eq!(links.len(), index);
            links.push(Link {
                kind: joint.kind,
                from: index & 1,
                to: (index + 1) & 1,
                offset,
                offset_sin_cos: (0.0, 1.0),
                along_x: 0.0,
                along_y: 0.0,
                twist: (0.0, 1.0),
                lower: joint.lower,
                upper: joint.upper,
            });
        }
        let tip = chain.joint_from_tip();
        translations.push(previous_alignment.transpose() * tip.translation);
        let last_from_tip = previous_alignment.transpose() * tip.rotation;

        // Move origins along their axes, tip to base, until no translation has a z part.
        let mut origin_shifts = (
            0.0,
            translations.last().map_or(0.0, |translation| translation.z),
        );
        for index in (0..links.len()).rev() {
            let z = translations[index].z;
            if let Some(before) = index.checked_sub(1) {
                let (sin, cos) = links[before].twist;
                translations[before] += Vector3::new(0.0, -sin * z, cos * z);
            } else {
                base_from_first.translation += base_from_first.rotation.z * z;
                origin_shifts.0 = z;
            }
            let link = &mut links[index];
            (link.along_x, link.along_y) = (translations[index].x, translations[index].y);
            link.offset_sin_cos = elementary::sin_cos(link.offset);
        }
        let all_revolute = links.iter().all(|link| link.kind.turns());
        let metres_per_length = unit_of_length(reach(&links), all_revolute);
        let lengths_per_metre = metres_per_length.recip();
        base_from_first.translation = base_from_first.translation * lengths_per_metre;
        for link in &mut links {
            link.along_x *= lengths_per_metre;
            link.along_y *= lengths_per_metre;
        }
        let mut links = Self {
            all_revolute,
            links,
            base_from_first,
            last_from_tip,
            origin_shifts,
            metres_per_length,
            lengths_per_metre,
            extent: chain.extent(),
        };
        let bounds: Vec<(f64, f64)> = joints.iter().map(|j| (j.lower, j.upper)).collect();
        links.set_bounds(bounds.into_iter());
        links
    }

    /// Sets the bounds, radians or metres.
    pub(crate) fn set_bounds(&mut self, bounds: impl Iterator<Item = (f64, f64)>) {
        for (link, (lower, upper)) in self.links.iter_mut().zip(bounds) {
            let unit = match link.kind.slides() {
                true => self.lengths_per_metre,
                false => 1.0,
            };
            (link.lower, link.upper) = (lower * unit, upper * unit);
        }
    }

    /// Converts a configuration from lengths of the solver to metres, in place.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn to_metres(&self, q: &mut [f64]) {
        if self.all_revolute {
            return;
        }
        for (value, link) in q.iter_mut().zip(&self.links) {
            if link.kind.slides() {
                *value *= self.metres_per_length;
            }
        }
    }

    /// Orientation of the tip in the base frame, at a configuration in the solver's units.
    pub(crate) fn tip_rotation(&self, q: &[f64]) -> Matrix3<f64> {
        let mut r = self.base_from_first.rotation;
        for (link, &q) in self.links.iter().zip(q) {
            let turn = match link.kind.turns() {
                true => elementary::sin_cos(q + link.offset),
                false => link.offset_sin_cos,
            };
            r = r.rotated_about_z(turn).rotated_about_x(link.twist);
        }
        r * self.last_from_tip
    }

    /// Frames along the chain in the base frame, metres: the base, then the frame after each joint.
    ///
    /// Joint values are radians and metres.
    #[cfg(feature = "collision")]
    pub(crate) fn frames(&self, q: &[f64]) -> Vec<Placement<f64>> {
        let metres = self.metres_per_length;
        let mut r = self.base_from_first.rotation;
        let mut p = self.base_from_first.translation * metres;
        let mut frames = vec![Placement::identity()];
        for (link, &q) in self.links.iter().zip(q) {
            if link.kind.turns() {
                r = r.rotated_about_z(elementary::sin_cos(q + link.offset));
            } else {
                p += r.z * q;
                r = r.rotated_about_z(link.offset_sin_cos);
            }
            p += (r.x * link.along_x + r.y * link.along_y) * metres;
            r = r.rotated_about_x(link.twist);
            frames.push(Placement::new(r, p));
        }
        frames
    }

    /// Pose of the first joint in the goal frame, in which the kernel works; lengths of the solver.
    ///
    /// The goal frame is at the target, oriented so that the frame after the last joint should coincide with it.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn goal_from_first(
        &self,
        base_from_target: &Placement<f64>,
        weighted: bool,
    ) -> Placement<f64> {
        // Weighted goals need the target's axes: there the kernel applies the tip's rotation.
        let rotation = if weighted {
            base_from_target.rotation
        } else {
            base_from_target.rotation * self.last_from_tip.transpose()
        };
        let translation = base_from_target.translation * self.lengths_per_metre;
        let goal = Placement::new(rotation, translation);
        goal.inverse() * self.base_from_first
    }
}

/// Largest reach of a chain, including the ends of its prismatic joints, metres.
fn reach(links: &[Link]) -> f64 {
    let lengths = links.iter().map(|link| {
        let ends = link.lower.abs().max(link.upper.abs());
        let slide = match link.kind.slides() && ends.is_finite() {
            true => ends,
            false => 0.0,
        };
        elementary::hypot(link.along_x, link.along_y) + slide
    });
    lengths.sum()
}

/// Unit of length for a chain of this reach, metres; 1 if the reach is zero or extreme.
fn unit_of_length(reach: f64, all_revolute: bool) -> f64 {
    if !(reach.is_normal() && reach > 1e-200 && reach < 1e200) {
        1.0
    } else if all_revolute {
        reach
    } else {
        // Without the mantissa: the largest power of two that is not larger.
        f64::from_bits(reach.to_bits() & 0x7FF0_0000_0000_0000)
    }
}

/// Returns a right-handed frame whose z axis is the unit vector `axis`.
#[cfg_attr(not(debug_assertions), inline(always))]
pub(crate) fn frame_along(axis: Vector3<f64>) -> Matrix3<f64> {
    // A coordinate axis far from `axis`, to avoid cancellation.
    let other = if axis.x.abs() < 0.6 {
        Vector3::new(1.0, 0.0, 0.0)
    } else {
        Vector3::new(0.0, 1.0, 0.0)
    };
    let x = other - axis * other.dot(axis);
    let x = x * x.norm().recip();
    Matrix3::from_columns(x, axis.cross(x), axis)
}

/// Decomposes R = R_z(β) R_x(α) R_z(γ): returns β, (sin α, cos α) and γ, radians.
fn decompose_zxz(rotation: &Matrix3<f64>) -> (f64, (f64, f64), f64) {
    let z = rotation.z;
    let sin = elementary::hypot(z.x, z.y);
    let beta = if sin > 0.0 {
        elementary::atan2(z.x, -z.y)
    } else {
        0.0
    };
    let untwisted = Matrix3::identity()
        .rotated_about_z(elementary::sin_cos(beta))
        .rotated_about_x((sin, z.z))
        .transpose()
        * *rotation;
    let gamma = elementary::atan2(untwisted.x.y, untwisted.x.x);
    (beta, (sin, z.z), gamma)
}
