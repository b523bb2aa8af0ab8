//! Upper bounds of the motion of a model's parts between two configurations.

use std::ops::Range;

use kinopt_kinematics::model::{FrameId, JointId, Model, ModelError, SegmentKind};
use kinopt_kinematics::spatial::Vector3;

/// Joint chains of a model's parts, for motion bounds.
#[derive(Clone, Debug, Default)]
pub(super) struct ChainMotionBound {
    parts: Vec<PartChain>,
    /// Joints above each part, from its joint to the root, part by part.
    joints: Vec<usize>,
}

/// The joints that move a part.
#[derive(Clone, Debug)]
struct PartChain {
    joints: Range<usize>,
    /// Largest distance of a point of the part from the origin of its joint, metres.
    reach: f64,
}

/// Workspace and result of a bound.
#[derive(Clone, Debug, Default)]
pub(super) struct BoundWorkspace {
    /// Velocity from one configuration to the other, over a unit of time.
    velocity: Vec<f64>,
    /// Rotation or translation of each joint, radians or metres.
    displacements: Vec<f64>,
    /// Bound of the motion of a part relative to the parent of each joint above it, metres.
    motion: Vec<f64>,
    /// Bound of the acceleration of the points of each part.
    accelerations: Vec<f64>,
}

impl ChainMotionBound {
    /// Bounds for parts, each on a frame, with bounding balls of its shapes in that frame.
    pub(super) fn new(
        model: &Model,
        parts: impl Iterator<Item = (FrameId, Vec<(Vector3<f64>, f64)>)>,
    ) -> Self {
        let mut bound = Self::default();
        for (frame, balls) in parts {
            let frame = &model.frames()[frame.index()];
            let farthest_distance = |(centre, radius): &(Vector3<f64>, f64)| {
                frame.joint_from_frame.apply(*centre).norm() + radius
            };
            let first = bound.joints.len();
            let mut joint = frame.joint;
            while let Some(id) = joint {
                bound.joints.push(id.index());
                joint = model.joints()[id.index()].parent;
            }
            bound.parts.push(PartChain {
                joints: first..bound.joints.len(),
                reach: balls.iter().map(farthest_distance).fold(0.0, f64::max),
            });
        }
        bound
    }

    /// Bounds the motion of all parts between two configurations, along which all joints move uniformly.
    ///
    /// Each joint above a part moves it by at most its rotation times the distance to the part's farthest point, or by
    /// its translation.
    pub(super) fn take(
        &self,
        model: &Model,
        (from, to): (&[f64], &[f64]),
        workspace: &mut BoundWorkspace,
    ) -> Result<(), ModelError> {
        workspace.velocity.resize(model.degrees_of_freedom(), 0.0);
        model.difference(from, to, &mut workspace.velocity)?;
        compute_displacements(model, workspace);
        workspace.motion.clear();
        workspace.accelerations.clear();
        for part in &self.parts {
            let (mut motion, mut reach, mut rotation) = (0.0, part.reach, 0.0);
            for &index in &self.joints[part.joints.clone()] {
                let joint = &model.joints()[index];
                let is_prismatic = joint.kind.slides();
                let displacement = workspace.displacements[index];
                // A joint that does not move contributes nothing, even if the reach is infinite.
                if displacement > 0.0 {
                    motion += displacement * if is_prismatic { 1.0 } else { reach };
                    rotation += if is_prismatic { 0.0 } else { displacement };
                }
                workspace.motion.push(motion);
                let translation = match model.coordinate(JointId::new(index)) {
                    Some(coordinate) if is_prismatic => {
                        from[coordinate].abs().max(to[coordinate].abs())
                    }
                    _ => 0.0,
                };
                reach += joint.parent_from_joint.translation.norm() + translation;
            }
            workspace.accelerations.push(2.0 * rotation * motion);
        }
        Ok(())
    }

    /// Upper bound of the motion of a part's points in the world, metres.
    pub(super) fn of_part(&self, part: usize, workspace: &BoundWorkspace) -> f64 {
        self.motion_below(part, 0, workspace)
    }

    /// Upper bound of the acceleration of a part's points in the world, for a motion of unit duration, metres.
    ///
    /// Joints with rates ω accelerate a point by at most Σ ωᵢ rᵢ (ωᵢ + 2 Σ ωⱼ) over the joints j above i. That is at
    /// most twice the sum of the rates times the motion.
    pub(super) fn acceleration_of(&self, part: usize, workspace: &BoundWorkspace) -> f64 {
        workspace.accelerations[part]
    }

    /// Upper bound of the approach of two parts, metres. Joints above both do not move them relative to each other.
    pub(super) fn of_pair(&self, [a, b]: [usize; 2], workspace: &BoundWorkspace) -> f64 {
        let above = |part: usize| self.joints[self.parts[part].joints.clone()].iter().rev();
        let shared = above(a).zip(above(b)).take_while(|(a, b)| a == b).count();
        self.motion_below(a, shared, workspace) + self.motion_below(b, shared, workspace)
    }

    /// Bound of the motion of a part relative to the frame below the uppermost `shared` joints, metres.
    fn motion_below(&self, part: usize, shared: usize, workspace: &BoundWorkspace) -> f64 {
        let joints = &self.parts[part].joints;
        match joints.len().checked_sub(shared + 1) {
            Some(last) => workspace.motion[joints.start + last],
            None => 0.0,
        }
    }
}

/// Computes the rotation or translation of each joint.
fn compute_displacements(model: &Model, workspace: &mut BoundWorkspace) {
    workspace.displacements.clear();
    workspace.displacements.resize(model.joints().len(), 0.0);
    let norm = |v: &[f64]| v.iter().map(|v| v * v).sum::<f64>().sqrt();
    for segment in model.segments() {
        let joint = |coordinate: usize| model.moving_joints()[coordinate].index();
        let (at, v) = (segment.coordinate, &workspace.velocity[segment.velocity..]);
        match segment.kind {
            SegmentKind::Scalar => workspace.displacements[joint(at)] = v[0].abs(),
            SegmentKind::Ball => workspace.displacements[joint(at)] = norm(&v[..3]),
            SegmentKind::Free => {
                // The displacement of its origin is as long as its velocity, for any split over its prismatic joints.
                workspace.displacements[joint(at)] = norm(&v[..3]);
                workspace.displacements[joint(at + 3)] = norm(&v[3..6]);
            }
        }
    }
}
