//! Frames held in place while others go to their targets.

use kinopt::ik::hold_postures;
use kinopt::model::{FrameId, ModelError, ParameterMap};
use kinopt::skeleton::{BoneId, Holds};
use kinopt::task::{Posture, Task};

use super::weights::Weights;
use crate::failure::Outcome;
use crate::frame_name::BareName;
use crate::loaded_model::LoadedModel;

/// Weight of held feet on a free base: they stay if a target is out of reach.
const FEET_WEIGHT: f64 = 10.0;

/// Value of `--hold` that holds nothing.
pub(super) const NOTHING: &str = "none";

/// Bones and frames that keep their poses.
#[derive(Clone, Debug, Default)]
pub(super) struct Held {
    /// Bones that do not rotate, and bones with a narrow range.
    holds: Holds,
    /// True if a skeleton keeps near its start posture.
    keeps_posture: bool,
    /// True if `--hold` names the bones.
    by_name: bool,
    /// Tips that keep their positions, by bone name; links of a robot keep their poses.
    pub(super) tips: Vec<(String, FrameId)>,
}

impl Held {
    /// Frames of `--hold`, or the default of the model's kind, without the `dragged` frames. A rig holds the tips that
    /// its file pins. A scene or a capture holds the trunk and the ends of the other limbs. A robot holds nothing.
    ///
    /// # Errors An unknown bone or link, or a dragged frame in `--hold`.
    pub(super) fn of(loaded: &LoadedModel, named: &[String], dragged: &[FrameId]) -> Outcome<Self> {
        let dragged: Vec<FrameId> = dragged.iter().map(|&f| loaded.under_tool(f)).collect();
        let Some(rig) = &loaded.rig else {
            let mut held = Self::default();
            for name in named.iter().filter(|name| *name != NOTHING) {
                let frame = loaded.frame(name, BareName::Tip)?;
                refuse_dragged(name, frame, &dragged)?;
                held.tips.push((name.clone(), frame));
            }
            held.keeps_posture = held.has_held_feet(loaded);
            return Ok(held);
        };
        let skeleton = &rig.skeleton;
        let bone_of = |frame: &FrameId| skeleton.bone_of_frame(*frame).map(|(bone, _)| bone);
        let dragged_bones: Vec<BoneId> = dragged.iter().filter_map(bone_of).collect();
        let mut held = Self::default();
        if named == [NOTHING] {
            return Ok(held);
        }
        let mut tips = Vec::new();
        match named {
            [] if loaded.is_bare_figure() => {
                held.holds = skeleton.holds(&dragged_bones);
                held.keeps_posture = true;
                tips.clone_from(&held.holds.ends);
            }
            [] => tips.extend_from_slice(&rig.constrained),
            _ => {
                held.by_name = true;
                for name in named {
                    let frame = loaded.frame(name, BareName::Tip)?;
                    refuse_dragged(name, frame, &dragged)?;
                    let Some(bone) = bone_of(&frame) else {
                        continue;
                    };
                    // For an ancestor of a dragged bone, its tip alone would not be enough.
                    if dragged_bones.iter().any(|&b| loaded.carries(bone, b)) {
                        held.holds.trunk.extend(loaded.up_from(bone));
                    } else {
                        tips.push(bone);
                    }
                }
            }
        }
        held.tips = tips
            .into_iter()
            .map(|bone| (bone, skeleton.tip(bone)))
            .filter(|(_, tip)| !dragged.contains(tip))
            .filter_map(|(bone, tip)| Some((skeleton.bones().get(bone.index())?.name.clone(), tip)))
            .collect();
        held.keeps_posture |= held.has_held_feet(loaded);
        Ok(held)
    }

    /// Factor of the errors of a held frame.
    pub(super) fn weight(&self, loaded: &LoadedModel, weights: &Weights, frame: FrameId) -> f64 {
        let default_weight = if self.has_held_feet(loaded) {
            FEET_WEIGHT
        } else {
            1.0
        };
        weights.given(frame).unwrap_or(default_weight)
    }

    /// True if a model on a free base has held frames, its feet.
    pub(super) fn has_held_feet(&self, loaded: &LoadedModel) -> bool {
        !loaded.model.free_joints().is_empty() && !self.tips.is_empty()
    }

    /// True if held frames keep their orientation: links of a robot, and named frames of a skeleton on a free base.
    pub(super) fn turns(&self, loaded: &LoadedModel) -> bool {
        loaded.rig.is_none() || (self.by_name && self.has_held_feet(loaded))
    }

    /// True if some bones keep their joints near the start.
    pub(super) fn holds_still(&self) -> bool {
        self.keeps_posture || !self.holds.trunk.is_empty()
    }

    /// Solver variables; bones that do not rotate keep their joints of `start`.
    ///
    /// # Errors
    /// None for a start within the limits.
    pub(super) fn parameters(
        &self,
        loaded: &LoadedModel,
        start: &[f64],
    ) -> Result<ParameterMap, ModelError> {
        let Some(rig) = loaded.rig.as_ref().filter(|_| self.holds_still()) else {
            return Ok(loaded.parameters());
        };
        let builder = ParameterMap::builder(&loaded.model);
        let trunk = self.holds.trunk.iter();
        let (builder, trunk): (_, Vec<_>) = match &loaded.balls {
            Some(balls) => {
                let held = balls.hold(builder, &self.holds, start);
                (held, trunk.flat_map(|&bone| balls.joints(bone)).collect())
            }
            None => {
                let held = self.holds.narrow(builder, &rig.skeleton, start);
                let joints = trunk.flat_map(|&bone| rig.skeleton.joints(bone));
                (held, joints.collect())
            }
        };
        match &loaded.held {
            Some(held) => held.add_to(builder, &trunk).build(),
            None => builder.build(),
        }
    }

    /// Soft tasks that keep a model near its start posture, spines more than limbs. Empty for models without the need.
    pub(super) fn posture(
        &self,
        loaded: &LoadedModel,
        start: &[f64],
    ) -> Outcome<Vec<Task<Posture>>> {
        Ok(match (&loaded.rig, &loaded.balls) {
            _ if !self.keeps_posture => Vec::new(),
            (Some(rig), None) => hold_postures(&self.holds, &rig.skeleton, start)?,
            _ => {
                let posture = Posture::new(&loaded.model, start).upright(&loaded.model);
                vec![Task::new(posture).named("posture")]
            }
        })
    }
}

/// Rejects a held frame that has a target.
fn refuse_dragged(name: &str, frame: FrameId, dragged: &[FrameId]) -> Outcome<()> {
    match dragged.contains(&frame) {
        true => Err(usage!(
            "--hold {name}: it has a target, so it cannot be held"
        )),
        false => Ok(()),
    }
}

impl LoadedModel {
    /// A bone and its ancestors, up to the root.
    fn up_from(&self, bone: BoneId) -> impl Iterator<Item = BoneId> + '_ {
        let bones = self.rig.as_ref().map(|rig| rig.skeleton.bones());
        std::iter::successors(Some(bone), move |at| bones?.get(at.index())?.parent)
    }

    /// True if `bone` is a proper ancestor of `other`.
    fn carries(&self, bone: BoneId, other: BoneId) -> bool {
        self.up_from(other).skip(1).any(|above| above == bone)
    }
}
