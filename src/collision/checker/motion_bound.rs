//! How far the parts of a model can come towards each other between two configurations.

use std::ops::Range;

use crate::model::{FrameId, JointId, Model, ModelError, SegmentKind};
use crate::spatial::Vector3;

/// What it takes to bound motions of one model's parts.
#[derive(Clone, Debug, Default)]
pub(super) struct MotionBound {
    parts: Vec<PartChain>,
    /// The joints above each part, from its own upwards, part by part.
    joints: Vec<usize>,
}

/// The joints that move a part.
#[derive(Clone, Debug)]
struct PartChain {
    joints: Range<usize>,
    /// From the origin of its own joint to its farthest place.
    reach: f64,
}

/// Room for a bound.
#[derive(Clone, Debug, Default)]
pub(super) struct BoundRoom {
    /// From one configuration to the other.
    velocity: Vec<f64>,
    /// By joint: how far it turns or slides, and whether that is an angle.
    moves: Vec<f64>,
    /// By joint above each part: how far any place of the part moves at most, as seen from above that joint.
    motion: Vec<f64>,
    /// By part: the bound on the acceleration of its places.
    bends: Vec<f64>,
}

impl MotionBound {
    /// Of parts that are on frames, each with balls around its shapes in the frame.
    pub(super) fn new(
        model: &Model,
        parts: impl Iterator<Item = (FrameId, Vec<(Vector3<f64>, f64)>)>,
    ) -> Self {
        let mut bound = Self::default();
        for (frame, balls) in parts {
            let frame = &model.frames()[frame.index()];
            let far = |(centre, radius): &(Vector3<f64>, f64)| {
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
                reach: balls.iter().map(far).fold(0.0, f64::max),
            });
        }
        bound
    }

    /// Bounds how far the parts move on the way from one configuration to another, on which all joints move evenly: by each joint above
    /// them at most by its turn times how far it is from there to the part's farthest place, or by its slide.
    pub(super) fn take(
        &self,
        model: &Model,
        (from, to): (&[f64], &[f64]),
        room: &mut BoundRoom,
    ) -> Result<(), ModelError> {
        room.velocity.resize(model.degrees_of_freedom(), 0.0);
        model.difference(from, to, &mut room.velocity)?;
        take_moves(model, room);
        room.motion.clear();
        room.bends.clear();
        for part in &self.parts {
            let (mut motion, mut reach, mut turns) = (0.0, part.reach, 0.0);
            for &index in &self.joints[part.joints.clone()] {
                let joint = &model.joints()[index];
                let slides = joint.kind.slides();
                let moves = room.moves[index];
                // What stands still keeps still, however far it reaches.
                if moves > 0.0 {
                    motion += moves * if slides { 1.0 } else { reach };
                    turns += if slides { 0.0 } else { moves };
                }
                room.motion.push(motion);
                let slide = match model.coordinate(JointId::new(index)) {
                    Some(at) if slides => from[at].abs().max(to[at].abs()),
                    _ => 0.0,
                };
                reach += joint.parent_from_joint.translation.norm() + slide;
            }
            room.bends.push(2.0 * turns * motion);
        }
        Ok(())
    }

    /// The most that any place of a part moves in the world.
    pub(super) fn of_part(&self, part: usize, room: &BoundRoom) -> f64 {
        self.beyond(part, 0, room)
    }

    /// The most that any place of a part is accelerated by in the world, the way taken in a unit of time: joints that turn at rates ω accelerate
    /// a place by Σ ωᵢ rᵢ (ωᵢ + 2 Σ ωⱼ) over the joints j above i at most, which is no more than twice all rates times its motion.
    pub(super) fn bend_of(&self, part: usize, room: &BoundRoom) -> f64 {
        room.bends[part]
    }

    /// The most that two parts come towards each other: joints above both move neither against the other.
    pub(super) fn of_pair(&self, [a, b]: [usize; 2], room: &BoundRoom) -> f64 {
        let above = |part: usize| self.joints[self.parts[part].joints.clone()].iter().rev();
        let shared = above(a).zip(above(b)).take_while(|(a, b)| a == b).count();
        self.beyond(a, shared, room) + self.beyond(b, shared, room)
    }

    /// The motion of a part as seen from below the uppermost so many joints.
    fn beyond(&self, part: usize, shared: usize, room: &BoundRoom) -> f64 {
        let joints = &self.parts[part].joints;
        match joints.len().checked_sub(shared + 1) {
            Some(last) => room.motion[joints.start + last],
            None => 0.0,
        }
    }
}

/// How far each joint turns or slides.
fn take_moves(model: &Model, room: &mut BoundRoom) {
    room.moves.clear();
    room.moves.resize(model.joints().len(), 0.0);
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
