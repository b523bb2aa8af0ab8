//! How far anything on a model can move between two configurations.

use crate::model::{FrameId, JointId, Model, ModelError, SegmentKind};
use crate::spatial::Vector3;

/// What it takes to bound motions of one model's parts.
#[derive(Clone, Debug, Default)]
pub(super) struct MotionBound {
    /// By joint: from its origin to the farthest place of what it carries itself.
    own: Vec<f64>,
}

/// Room for a bound.
#[derive(Clone, Debug, Default)]
pub(super) struct BoundRoom {
    /// From one configuration to the other.
    velocity: Vec<f64>,
    /// By joint: how far it turns or slides, and whether that is an angle.
    moves: Vec<f64>,
    /// By joint: from its origin to the farthest place of all that it carries.
    reach: Vec<f64>,
    /// By joint: how far what it carries moves at most.
    motion: Vec<f64>,
}

impl MotionBound {
    /// Of parts that are on frames, each with balls around its shapes in the frame.
    pub(super) fn new(
        model: &Model,
        parts: impl Iterator<Item = (FrameId, Vec<(Vector3<f64>, f64)>)>,
    ) -> Self {
        let mut own = vec![0.0_f64; model.joints().len()];
        for (frame, balls) in parts {
            let frame = &model.frames()[frame.index()];
            let Some(joint) = frame.joint else { continue };
            for (centre, radius) in balls {
                let far = frame.joint_from_frame.apply(centre).norm() + radius;
                own[joint.index()] = own[joint.index()].max(far);
            }
        }
        Self { own }
    }

    /// The most that any place of any part moves on the way from one configuration to another, on which all joints move evenly:
    /// each joint by at most its turn times how far what it carries reaches, or by its slide.
    pub(super) fn of(
        &self,
        model: &Model,
        (from, to): (&[f64], &[f64]),
        room: &mut BoundRoom,
    ) -> Result<f64, ModelError> {
        room.velocity.resize(model.degrees_of_freedom(), 0.0);
        model.difference(from, to, &mut room.velocity)?;
        self.take_moves(model, room);
        let joints = model.joints();
        room.reach.clone_from(&self.own);
        // Children come after their parents.
        for (index, joint) in joints.iter().enumerate().rev() {
            let Some(parent) = joint.parent else { continue };
            let slide = match model.coordinate(JointId::new(index)) {
                Some(at) if joint.kind.slides() => from[at].abs().max(to[at].abs()),
                _ => 0.0,
            };
            let way = joint.parent_from_joint.translation.norm() + slide;
            let reach = &mut room.reach;
            reach[parent.index()] = reach[parent.index()].max(way + reach[index]);
        }
        room.motion.clear();
        let mut most = 0.0_f64;
        for (index, joint) in joints.iter().enumerate() {
            let before = joint
                .parent
                .map_or(0.0, |parent| room.motion[parent.index()]);
            let arm = match joint.kind.slides() {
                true => 1.0,
                false => room.reach[index],
            };
            let motion = before + room.moves[index] * arm;
            room.motion.push(motion);
            most = most.max(motion);
        }
        Ok(most)
    }

    /// How far each joint turns or slides.
    fn take_moves(&self, model: &Model, room: &mut BoundRoom) {
        room.moves.clear();
        room.moves.resize(self.own.len(), 0.0);
        let norm = |v: &[f64]| v.iter().map(|v| v * v).sum::<f64>().sqrt();
        for segment in model.segments() {
            let joint = |coordinate: usize| model.moving_joints()[coordinate].index();
            let (at, v) = (segment.coordinate, &room.velocity[segment.velocity..]);
            match segment.kind {
                SegmentKind::Scalar => room.moves[joint(at)] = v[0].abs(),
                SegmentKind::Ball => room.moves[joint(at)] = norm(&v[..3]),
                SegmentKind::Free => {
                    // Its origin's way is as long as its velocity, whichever slides make it.
                    room.moves[joint(at)] = norm(&v[..3]);
                    room.moves[joint(at + 3)] = norm(&v[3..6]);
                }
            }
        }
    }
}
