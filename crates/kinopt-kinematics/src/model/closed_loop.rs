//! Loop closures: constraints between two frames that the joint tree does not connect.

use super::{FrameId, JointId, Model, ModelError};
use crate::spatial::{Placement, rotation_log};

/// A loop closure, as by a joint that the joint tree leaves out.
///
/// Examples: the fourth hinge of a four-bar linkage, the rods of a Stewart platform, two hands on one box. Two anchors,
/// one on each frame, coincide in a closed loop. A configuration may leave the loop open. Every
/// `Problem` on the model has the closure as a constraint.
///
/// ```
/// use kinopt::model::{Limits, Loop, Model};
/// use kinopt::spatial::{Placement, Vector3};
///
/// // A crank, a coupler and a rocker: the end of the coupler is pinned to the end of the rocker.
/// let mut builder = Model::builder("four-bar");
/// let (z, x) = (Vector3::new(0.0, 0.0, 1.0), |length| Placement::translation(Vector3::new(length, 0.0, 0.0)));
/// let limits = Limits::new(-3.2, 3.2);
/// let crank = builder.revolute("crank", None, Placement::identity(), z, limits);
/// let coupler = builder.revolute("coupler", Some(crank), x(0.1), z, limits);
/// let rocker = builder.revolute("rocker", None, x(0.4), z, limits);
/// let ends = [builder.frame("coupler end", Some(coupler), x(0.35)), builder.frame("rocker end", Some(rocker), x(0.2))];
/// builder.close(Loop::connect("pin", ends));
/// let model = builder.build()?;
/// assert_eq!(model.loops()[0].name, "pin");
/// # Ok::<(), kinopt::model::ModelError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Loop {
    /// Name, unique within the model.
    pub name: String,
    /// The constrained degrees of freedom.
    pub kind: LoopKind,
    /// The frames that carry the anchors.
    pub frames: [FrameId; 2],
    /// The anchors, in the coordinates of their frames, metres.
    pub frame_from_place: [Placement<f64>; 2],
}

/// The degrees of freedom that a loop closure constrains.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum LoopKind {
    /// Position, as by a ball joint.
    Connect,
    /// Position and orientation.
    Weld,
}

impl LoopKind {
    /// "connect" or "weld".
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Connect => "connect",
            Self::Weld => "weld",
        }
    }
}

impl Loop {
    /// Largest closure error of a closed loop, metres and radians.
    pub const TOLERANCE: f64 = 1e-9;

    /// A loop that makes the origins of two frames coincide.
    #[must_use]
    pub fn connect(name: impl Into<String>, frames: [FrameId; 2]) -> Self {
        Self::new(name, LoopKind::Connect, frames)
    }

    /// A loop that makes two frames coincide, in position and orientation.
    #[must_use]
    pub fn weld(name: impl Into<String>, frames: [FrameId; 2]) -> Self {
        Self::new(name, LoopKind::Weld, frames)
    }

    fn new(name: impl Into<String>, kind: LoopKind, frames: [FrameId; 2]) -> Self {
        Self {
            name: name.into(),
            kind,
            frames,
            frame_from_place: [Placement::identity(); 2],
        }
    }

    /// Sets the anchors, in the coordinates of the frames, metres. By default the frames themselves are the
    /// anchors.
    #[must_use]
    pub fn at(mut self, frame_from_place: [Placement<f64>; 2]) -> Self {
        self.frame_from_place = frame_from_place;
        self
    }
}

/// Shortest and longest distance between two rotating points of a loop, metres.
type Length = [f64; 2];

/// The chain from an anchor up to the common ancestor of both anchors.
struct AncestorChain {
    /// Distances between successive rotating joints, and the travel of prismatic joints.
    lengths: Vec<Length>,
    /// Placement of the topmost rotating joint in the common ancestor; of the anchor if no joint rotates.
    placement: Placement<f64>,
    rotates: bool,
}

impl Model {
    /// The moving joints of a loop, from the first anchor's side to the second's.
    ///
    /// A frame that is not in the model contributes none.
    #[must_use]
    pub fn loop_joints(&self, closed: &Loop) -> Vec<JointId> {
        let [first, second] = closed.frames;
        let path = self.path(Some(first), second);
        let joints = path.up.into_iter().chain(path.down);
        joints.filter(|id| self.coordinate(*id).is_some()).collect()
    }

    /// True if the joint moves the anchors of a loop relative to each other.
    #[must_use]
    pub fn moves_a_loop(&self, joint: JointId) -> bool {
        let mut loops = self.loops.iter();
        loops.any(|closed| self.loop_joints(closed).contains(&joint))
    }

    /// The model without loops.
    #[must_use]
    pub fn without_loops(mut self) -> Self {
        self.loops.clear();
        self
    }

    /// Rejects loops that no configuration closes, as far as link lengths show it.
    ///
    /// A loop cannot close if one link is longer than all others together. A weld without rotating joints cannot close
    /// if its orientations differ.
    pub(super) fn check_closes(&self, closed: &Loop) -> Result<(), ModelError> {
        let [first, second] = closed.frames;
        let path = self.path(Some(first), second);
        let [from_first, from_second] = closed.frame_from_place;
        let up = self.branch(first, from_first, path.up.iter());
        let down = self.branch(second, from_second, path.down.iter().rev());
        let anchor_distance = (up.placement.translation - down.placement.translation).norm();
        let cannot_close = |gap, unit| {
            Err(ModelError::LoopCannotClose {
                name: closed.name.clone(),
                gap,
                unit,
            })
        };
        let rotates = up.rotates || down.rotates;
        let angle =
            rotation_log(&(up.placement.rotation.transpose() * down.placement.rotation)).norm();
        if closed.kind == LoopKind::Weld && !rotates && angle > Loop::TOLERANCE {
            return cannot_close(angle, "rad");
        }
        let mut lengths = up.lengths;
        lengths.extend(down.lengths);
        lengths.push([anchor_distance; 2]);
        let total: f64 = lengths.iter().map(|[_, longest]| longest).sum();
        let gaps = lengths
            .iter()
            .map(|[shortest, longest]| shortest - (total - longest));
        let gap = gaps.fold(0.0, f64::max);
        match gap > Loop::TOLERANCE + ROUNDING * total {
            true => cannot_close(gap, self.length_unit.symbol()),
            false => Ok(()),
        }
    }

    /// The chain from an anchor to the common ancestor; `joints` lists its joints, nearest first.
    fn branch<'a>(
        &self,
        frame: FrameId,
        frame_from_place: Placement<f64>,
        joints: impl Iterator<Item = &'a JointId>,
    ) -> AncestorChain {
        let mut branch = AncestorChain {
            lengths: Vec::new(),
            placement: self.frames[frame.index()].joint_from_frame * frame_from_place,
            rotates: false,
        };
        for id in joints {
            let joint = &self.joints[id.index()];
            if joint.kind.turns() {
                branch
                    .lengths
                    .push([branch.placement.translation.norm(); 2]);
                branch.placement = joint.parent_from_joint;
                branch.rotates = true;
            } else {
                branch.placement = joint.parent_from_joint * branch.placement;
            }
            if joint.kind.slides() {
                let (lower, upper) = (joint.limits.lower, joint.limits.upper);
                let shortest = lower.max(-upper).max(0.0);
                let longest = lower.abs().max(upper.abs());
                branch.lengths.push([shortest, longest]);
            }
        }
        branch
    }
}

/// Relative rounding error of a sum of lengths.
const ROUNDING: f64 = 1e-14;
