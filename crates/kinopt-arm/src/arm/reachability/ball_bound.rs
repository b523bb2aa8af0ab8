//! Balls that contain a point of the arm over a box, from the base's side and from the target's side.
//!
//! They exclude large boxes, where bounds by derivatives are too wide: a joint that turns freely gives a ball about its
//! axis.

use std::f64::consts::FRAC_PI_2;

use kinopt_kinematics::scalar::elementary;
use kinopt_kinematics::spatial::{Placement, Vector3};

use super::axis_chain::{AxisChain, AxisMotion};
use super::joint_box::JointBox;

/// Point in the frame of the link after the first `cut` joints.
#[derive(Clone, Copy, Debug)]
pub(super) struct AxisPoint {
    pub(super) cut: usize,
    pub(super) point: Vector3<f64>,
}

/// Ball of positions, metres.
#[derive(Clone, Copy, Debug)]
pub(super) struct PointBall {
    pub(super) centre: Vector3<f64>,
    pub(super) radius: f64,
}

impl PointBall {
    /// Ball in the base frame that contains the tool's position at every configuration within the limits.
    pub(super) fn of_tool(chain: &AxisChain) -> Self {
        let mut ball = Self {
            centre: chain.last_joint_from_tool.translation,
            radius: 0.0,
        };
        let JointBox { centre, half_width } = &chain.limits;
        for (index, joint) in chain.joints.iter().enumerate().rev() {
            ball = ball.moved(joint.motion, centre[index], half_width[index]);
            ball = ball.placed(&joint.parent_from_joint);
        }
        ball
    }

    /// Ball around a ball that a joint moves from `centre − half_width` to `centre + half_width`.
    fn moved(self, motion: AxisMotion, centre: f64, half_width: f64) -> Self {
        let Vector3 { x, y, z } = self.centre;
        if motion == AxisMotion::Translation {
            return Self {
                centre: Vector3::new(x, y, z + centre),
                radius: self.radius + half_width,
            };
        }
        // The smallest ball around an arc: over the chord up to half a revolution, else the circle's.
        let distance = (x * x + y * y).sqrt();
        let (towards_middle, reach) = match half_width < FRAC_PI_2 {
            true => {
                let (sin, cos) = elementary::sin_cos(half_width);
                (cos, distance * sin)
            }
            false => (0.0, distance),
        };
        let (sin, cos) = elementary::sin_cos(centre);
        Self {
            centre: Vector3::new(
                towards_middle * (x * cos - y * sin),
                towards_middle * (x * sin + y * cos),
                z,
            ),
            radius: self.radius + reach,
        }
    }

    fn placed(self, placement: &Placement<f64>) -> Self {
        Self {
            centre: placement.apply(self.centre),
            radius: self.radius,
        }
    }
}

impl AxisPoint {
    /// Origins of the joint frames, as points of the links before and after each joint. An origin is on the axis of its
    /// joint, so that the joint does not move it.
    pub(super) fn on_axes(chain: &AxisChain) -> Vec<Self> {
        let mut probes = vec![];
        for cut in 0..=chain.joints.len() {
            let point = Vector3::zero();
            probes.push(Self { cut, point });
            if let Some(next) = chain.joints.get(cut) {
                let point = next.parent_from_joint.translation;
                probes.push(Self { cut, point });
            }
        }
        probes
    }

    /// Returns true if the two balls of the point are farther apart than `tolerance` over the whole box, so that no
    /// configuration of the box reaches the target.
    pub(super) fn excludes(
        &self,
        chain: &AxisChain,
        joint_box: &JointBox,
        base_from_last_joint: &Placement<f64>,
        tolerance: f64,
    ) -> bool {
        let fixed = PointBall {
            centre: self.point,
            radius: 0.0,
        };
        let (centre, half_width) = (&joint_box.centre, &joint_box.half_width);
        let mut of_arm = fixed;
        // Lower bound of the point's distance from the origin of the joint frame at hand, which joints with concurrent
        // axes keep.
        let mut min_distance = self.point.norm();
        // Translations of a cell move the target instead, by a box whose half diagonal is less than the sum of its sides.
        let outer = chain.cell_translations;
        let mut first_origin = Vector3::zero();
        for (index, joint) in chain.joints[..self.cut].iter().enumerate().rev() {
            if index <= outer {
                first_origin = joint.parent_from_joint.apply(first_origin);
            }
            if index < outer {
                of_arm = of_arm.placed(&joint.parent_from_joint);
                continue;
            }
            min_distance = min_distance.max(of_arm.centre.norm() - of_arm.radius);
            if joint.motion == AxisMotion::Translation {
                min_distance -= centre[index].abs() + half_width[index];
            }
            of_arm = of_arm.moved(joint.motion, centre[index], half_width[index]);
            of_arm = of_arm.placed(&joint.parent_from_joint);
            if index > outer {
                min_distance -= joint.parent_from_joint.translation.norm();
            }
        }
        let mut of_target = fixed;
        for (index, joint) in chain.joints.iter().enumerate().skip(self.cut) {
            of_target = of_target.placed(&joint.joint_from_parent);
            of_target = of_target.moved(joint.motion, -centre[index], half_width[index]);
        }
        of_target = of_target.placed(base_from_last_joint);
        if outer == 3 {
            of_target.centre += Vector3::new(centre[0], centre[1], centre[2]);
            of_target.radius += Vector3::new(half_width[0], half_width[1], half_width[2]).norm();
        }
        let distance = (of_arm.centre - of_target.centre).norm();
        if distance > of_arm.radius + of_target.radius + tolerance {
            return true;
        }
        if self.cut <= outer {
            return false;
        }
        let from_first = (of_target.centre - first_origin).norm();
        from_first + of_target.radius + tolerance < min_distance
    }
}
