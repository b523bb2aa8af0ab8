//! Proofs for cells of poses: no configuration reaches any pose of the cell.
//!
//! The coordinates of a cell become joints of the chain. With the arm's forward kinematics `base_from_tool(q)`, a pose
//! `T(p)·F·Ry(a)·Rx(c)·Rz(s)` is reached where `T(−p)·base_from_tool(q)·Rz(−s)·Rx(−c)·Ry(−a) = F`. This is a chain of
//! six more joints, whose target F is fixed, and a cell is a box of their values.

use super::super::PoseBounds;
use super::super::arm::Arm;
use super::axis_chain::AxisChain;
use super::ball_bound::{AxisPoint, PointBall};
use super::branch_and_prune::{BoxSearch, BoxSearchEnd};
use super::joint_box::JointBox;
use super::{LEVER, compared_points};
use crate::simd_ik::ChainJoint;
use kinopt_kinematics::model::JointKind;
use kinopt_kinematics::spatial::{Placement, Vector3};

/// Widening of a cell's rotations against rounding and targets that are rigid up to 1e-6, radians.
const ANGLE_MARGIN: f64 = 1e-5;
/// Widening of a cell's positions against rounding, as a fraction of their size.
const POSITION_MARGIN: f64 = 1e-9;

/// Interval of a coordinate: centre and half width, radians or metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Interval {
    pub(crate) centre: f64,
    pub(crate) half_width: f64,
}

/// Box of orientations `F·Ry(a)·Rx(c)·Rz(s)`: intervals of a, c and s for a fixed rotation F.
#[derive(Clone, Copy, Debug)]
pub(crate) struct OrientationCell {
    pub(crate) base_from_face: Placement<f64>,
    pub(crate) angles: [Interval; 3],
}

/// Search for proofs that no pose of a cell is reached.
#[derive(Clone, Debug)]
pub(crate) struct CellSearch {
    /// Joint values of the arm within its limits, at the indices of both chains.
    limits: JointBox,
    joints: usize,
    /// Proofs by the tool's position alone.
    positions: BoxSearch,
    /// Proofs for poses; `None` for a goal without orientation.
    poses: Option<BoxSearch>,
    /// Ball that contains all positions of the tool, up to the tolerances.
    centre: Vector3<f64>,
    radius: f64,
}

fn joint(kind: JointKind, axis: Vector3<f64>) -> ChainJoint {
    ChainJoint {
        parent_from_joint: Placement::identity(),
        axis,
        kind,
        lower: -1.0,
        upper: 1.0,
    }
}

impl Arm {
    /// Search for proofs about cells of poses; `None` for a chain or a goal without proofs.
    pub(crate) fn cell_search(&self) -> Option<CellSearch> {
        let chain = self.serial.chain.as_ref()?;
        let arm = AxisChain::new(chain)?;
        let joints = arm.joints.len();
        let extent = self.serial.extent;
        let lever = LEVER * extent;
        let (points, cut) = compared_points(&self.options.goal, lever, &arm)?;
        let ball = PointBall::of_tool(&arm);
        let tolerance =
            self.options.position_tolerance + (extent + lever) * self.options.orientation_tolerance;
        let radius = (ball.radius + tolerance) * (1.0 + POSITION_MARGIN);
        let slides = Vector3::UNITS.map(|axis| joint(JointKind::Prismatic, -axis));
        let [x, y, z] = Vector3::UNITS.map(|axis| joint(JointKind::Revolute, -axis));
        let with_position: Vec<ChainJoint> =
            slides.into_iter().chain(chain.joints().to_vec()).collect();
        let mut first_rotation = z;
        first_rotation.parent_from_joint = *chain.joint_from_tip();
        let with_pose: Vec<ChainJoint> = (with_position.iter().copied())
            .chain([first_rotation, x, y])
            .collect();
        let position_chain = AxisChain::of_joints(&with_position, chain.joint_from_tip())?;
        let pose_chain = AxisChain::of_joints(&with_pose, &Placement::identity())?;
        let shifted = |mut probe: AxisPoint| {
            probe.cut += 3;
            probe
        };
        let search = |chain: AxisChain, probes, points, cut| BoxSearch {
            chain: AxisChain {
                cell_translations: 3,
                ..chain
            },
            probes,
            points,
            cut,
            tolerance,
            // Targets are at most as far away as the ball of all positions.
            extent: extent + ball.centre.norm() + radius,
            deadline: None,
        };
        let tool = vec![position_chain.last_joint_from_tool.translation];
        let tool_probe = AxisPoint {
            cut: joints + 3,
            point: tool[0],
        };
        let is_pose = self.options.goal == PoseBounds::pose();
        let probes = match is_pose {
            true => AxisPoint::on_axes(&arm).into_iter().map(shifted).collect(),
            false => vec![tool_probe],
        };
        let has_orientation = self.options.goal != PoseBounds::position();
        Some(CellSearch {
            limits: arm.limits,
            joints,
            positions: search(position_chain, vec![tool_probe], tool, joints + 3),
            poses: has_orientation.then(|| search(pose_chain, probes, points, cut + 3)),
            centre: ball.centre,
            radius,
        })
    }
}

impl CellSearch {
    /// Centre and radius of a ball that contains every position of the tool, metres.
    pub(crate) fn ball(&self) -> (Vector3<f64>, f64) {
        (self.centre, self.radius)
    }

    /// Returns true for a proof that the tool is never within a cube of positions, with at most `max_boxes` boxes.
    pub(crate) fn excludes_cube(&self, cube: &[Interval; 3], max_boxes: usize) -> bool {
        let within = self.joint_box(cube);
        let end = self
            .positions
            .run_within(within, &Placement::identity(), max_boxes);
        matches!(end, BoxSearchEnd::Empty { .. })
    }

    /// Returns true for a proof that no pose of a cell is reached, with at most `max_boxes` boxes.
    pub(crate) fn excludes_cell(
        &self,
        cube: &[Interval; 3],
        orientations: &OrientationCell,
        max_boxes: usize,
    ) -> bool {
        let Some(poses) = &self.poses else {
            return self.excludes_cube(cube, max_boxes);
        };
        let mut within = self.joint_box(cube);
        let [a, c, spin] = orientations.angles;
        for (offset, angle) in [spin, c, a].into_iter().enumerate() {
            within.centre[self.joints + 3 + offset] = angle.centre;
            within.half_width[self.joints + 3 + offset] = angle.half_width + ANGLE_MARGIN;
        }
        let end = poses.run_within(within, &orientations.base_from_face, max_boxes);
        matches!(end, BoxSearchEnd::Empty { .. })
    }

    fn joint_box(&self, cube: &[Interval; 3]) -> JointBox {
        let mut within = JointBox::default();
        for (axis, interval) in cube.iter().enumerate() {
            let margin = POSITION_MARGIN * (interval.centre.abs() + self.radius);
            within.centre[axis] = interval.centre;
            within.half_width[axis] = interval.half_width + margin;
        }
        for joint in 0..self.joints {
            within.centre[joint + 3] = self.limits.centre[joint];
            within.half_width[joint + 3] = self.limits.half_width[joint];
        }
        within
    }
}
