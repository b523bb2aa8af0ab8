//! Loops: places that are held together although no joint of the tree joins them.

use super::{FrameId, JointId, Model, ModelError};
use crate::spatial::{Placement, rotation_log};

/// Two places that are one, as by a joint that the tree of joints leaves out: the fourth hinge of a four-bar
/// linkage, the rods of a Stewart platform, two hands on one box.
///
/// A configuration may leave it open. Every [`Problem`](crate::Problem) on the model asks for it.
///
/// ```
/// use kinopt::model::{Limits, Loop, Model};
/// use kinopt::spatial::{Placement, Vector3};
///
/// // A crank, a coupler, a rocker: the coupler's end is on the rocker's.
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
    /// Unique within the model.
    pub name: String,
    /// What is held together.
    pub kind: LoopKind,
    /// The frames that the places are on.
    pub frames: [FrameId; 2],
    /// Where on them: what is to fall together.
    pub frame_from_place: [Placement<f64>; 2],
}

/// What two places of a loop have in common.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum LoopKind {
    /// Their origins, as by a ball joint.
    Connect,
    /// Origins and axes.
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
    /// A loop is closed when its places are no farther apart than this, in metres and radians.
    pub const TOLERANCE: f64 = 1e-9;

    /// The origins of two frames fall together.
    #[must_use]
    pub fn connect(name: impl Into<String>, frames: [FrameId; 2]) -> Self {
        Self::new(name, LoopKind::Connect, frames)
    }

    /// Two frames fall together, origins and axes.
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

    setters! {
        /// Not the frames themselves but places on them fall together: frame_from_place, metres.
        pub fn at(mut self, frame_from_place: [Placement<f64>; 2]) { self.frame_from_place = frame_from_place }
    }
}

/// How short and how long something is that two turning places have between them, in metres.
type Length = [f64; 2];

/// From a place down to what carries it together with another.
struct Branch {
    /// Between one joint and the next, and how far slides take them.
    lengths: Vec<Length>,
    /// Where the last joint stands on what carries both; the place itself where none moves it.
    at: Placement<f64>,
    turns: bool,
}

impl Model {
    /// The moving joints that move the places of a loop against each other, from the first place's side to the
    /// second's; those of a frame that the model does not have are none.
    #[must_use]
    pub fn loop_joints(&self, closed: &Loop) -> Vec<JointId> {
        let [first, second] = closed.frames;
        let path = self.path(Some(first), second);
        let joints = path.up.into_iter().chain(path.down);
        joints.filter(|id| self.coordinate(*id).is_some()).collect()
    }

    /// Whether a joint moves the places of some loop against each other.
    #[must_use]
    pub fn moves_a_loop(&self, joint: JointId) -> bool {
        let mut loops = self.loops.iter();
        loops.any(|closed| self.loop_joints(closed).contains(&joint))
    }

    setters! {
        /// The same model without loops.
        pub fn without_loops(mut self) { self.loops.clear() }
    }

    /// Refuses a loop that no configuration closes, as far as lengths tell: where one link of it is longer than
    /// all others together, or no joint moves its places against each other.
    pub(super) fn check_closes(&self, own: &Loop) -> Result<(), ModelError> {
        let [first, second] = own.frames;
        let path = self.path(Some(first), second);
        let [from_first, from_second] = own.frame_from_place;
        let up = self.branch(first, from_first, path.up.iter());
        let down = self.branch(second, from_second, path.down.iter().rev());
        let between = (up.at.translation - down.at.translation).norm();
        let apart = |gap, unit| {
            Err(ModelError::LoopCannotClose {
                name: own.name.clone(),
                gap,
                unit,
            })
        };
        let turns = up.turns || down.turns;
        let turned = rotation_log(&(up.at.rotation.transpose() * down.at.rotation)).norm();
        if own.kind == LoopKind::Weld && !turns && turned > Loop::TOLERANCE {
            return apart(turned, "rad");
        }
        let mut lengths = up.lengths;
        lengths.extend(down.lengths);
        lengths.push([between; 2]);
        let all: f64 = lengths.iter().map(|[_, longest]| longest).sum();
        let gaps = lengths
            .iter()
            .map(|[shortest, longest]| shortest - (all - longest));
        let gap = gaps.fold(0.0, f64::max);
        match gap > Loop::TOLERANCE + ROUNDING * all {
            true => apart(gap, self.length_unit.symbol()),
            false => Ok(()),
        }
    }

    /// What is between a place and what carries both, by the joints above it, the nearest first.
    fn branch<'a>(
        &self,
        frame: FrameId,
        frame_from_place: Placement<f64>,
        above: impl Iterator<Item = &'a JointId>,
    ) -> Branch {
        let mut branch = Branch {
            lengths: Vec::new(),
            at: self.frames[frame.index()].joint_from_frame * frame_from_place,
            turns: false,
        };
        for id in above {
            let joint = &self.joints[id.index()];
            if joint.kind.turns() {
                branch.lengths.push([branch.at.translation.norm(); 2]);
                branch.at = joint.parent_from_joint;
                branch.turns = true;
            } else {
                branch.at = joint.parent_from_joint * branch.at;
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

/// What sums of lengths may be off by, as a share of them.
const ROUNDING: f64 = 1e-14;
