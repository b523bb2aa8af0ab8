//! Frames held in place while others go to their targets.

use kinopt::model::{FrameId, ModelError, ParameterMap};
use kinopt::skeleton::{BoneId, Holds};
use kinopt::task::{Posture, Task};

use super::arguments::Arguments;
use super::weights::Weights;
use crate::failure::Outcome;
use crate::frame_name::BareName;
use crate::loaded_model::LoadedModel;

/// How much more feet count than what is dragged, on a free base: they stay where a hand is beyond reach.
const FEET: f64 = 10.0;

/// What `--hold none` is called.
pub(super) const NOTHING: &str = "none";

/// What is held.
#[derive(Clone, Debug, Default)]
pub(super) struct Held {
    /// Bones that do not turn, and those that hardly bend.
    holds: Holds,
    /// Whether a figure keeps to the posture that it starts in.
    keeps_posture: bool,
    /// Whether it was said what is held.
    by_name: bool,
    /// Tips that stay where they are, by their bones' names, and links of a robot, turned as they are.
    pub(super) tips: Vec<(String, FrameId)>,
}

impl Held {
    /// What `--hold` names, or else what the model's kind holds: of a rig the tips that its file pins,
    /// of a scene its trunk and the ends of its other limbs, of a robot nothing. Of these never the `dragged` frames.
    ///
    /// # Errors
    /// An unknown bone or link, or one of the dragged by name.
    pub(super) fn of(
        loaded: &LoadedModel,
        arguments: &Arguments,
        dragged: &[FrameId],
    ) -> Outcome<Self> {
        let named = arguments.hold.as_slice();
        let dragged: Vec<FrameId> = dragged.iter().map(|&f| loaded.under_tool(f)).collect();
        let Some(rig) = &loaded.rig else {
            let mut held = Self::default();
            for name in named.iter().filter(|name| *name != NOTHING) {
                let frame = loaded.frame(name, BareName::Tip)?;
                refuse_dragged(name, frame, &dragged)?;
                held.tips.push((name.clone(), frame));
            }
            held.keeps_posture = held.stands(loaded);
            return Ok(held);
        };
        let skeleton = &rig.skeleton;
        let bone_of = |frame: &FrameId| skeleton.bone_of_frame(*frame).map(|(bone, _)| bone);
        let dragged_bones: Vec<BoneId> = dragged.iter().filter_map(bone_of).collect();
        let mut held = Self::default();
        if arguments.free || named == [NOTHING] {
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
        held.keeps_posture |= held.stands(loaded);
        Ok(held)
    }

    /// What the errors of something held are multiplied by.
    pub(super) fn weight(&self, loaded: &LoadedModel, weights: &Weights, frame: FrameId) -> f64 {
        let usual = if self.stands(loaded) { FEET } else { 1.0 };
        weights.given(frame).unwrap_or(usual)
    }

    /// Whether a body on a free base stands on what is held, its feet.
    pub(super) fn stands(&self, loaded: &LoadedModel) -> bool {
        !loaded.model.free_joints().is_empty() && !self.tips.is_empty()
    }

    /// Whether what is held stays as it is turned, too: links of a robot, and of a figure on a free base what is held by name, its feet.
    pub(super) fn turns(&self, loaded: &LoadedModel) -> bool {
        loaded.rig.is_none() || (self.by_name && self.stands(loaded))
    }

    /// Whether some bones stay as the start has them.
    pub(super) fn holds_still(&self) -> bool {
        self.keeps_posture || !self.holds.trunk.is_empty()
    }

    /// The variables of the solver: what is held still stays as in `start`.
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
            Some(held) => held.say(builder, &trunk).build(),
            None => builder.build(),
        }
    }

    /// What keeps a figure that says nothing of itself near the posture it starts in, where the targets
    /// leave room, its back more than its limbs: none for the others.
    pub(super) fn posture(
        &self,
        loaded: &LoadedModel,
        start: &[f64],
    ) -> Outcome<Vec<Task<Posture>>> {
        Ok(match (&loaded.rig, &loaded.balls) {
            _ if !self.keeps_posture => Vec::new(),
            (Some(rig), None) => self.holds.postures(&rig.skeleton, start)?,
            _ => {
                let posture = Posture::new(&loaded.model, start).upright(&loaded.model);
                vec![Task::new(posture).named("posture")]
            }
        })
    }
}

/// What goes somewhere cannot stay as well.
fn refuse_dragged(name: &str, frame: FrameId, dragged: &[FrameId]) -> Outcome<()> {
    match dragged.contains(&frame) {
        true => Err(usage!(
            "--hold {name}: it has a target, so it cannot stay where it is"
        )),
        false => Ok(()),
    }
}

impl LoadedModel {
    /// A bone and those above it, up to the root.
    fn up_from(&self, bone: BoneId) -> impl Iterator<Item = BoneId> + '_ {
        let bones = self.rig.as_ref().map(|rig| rig.skeleton.bones());
        std::iter::successors(Some(bone), move |at| bones?.get(at.index())?.parent)
    }

    /// Whether `bone` carries `other`, which is another.
    fn carries(&self, bone: BoneId, other: BoneId) -> bool {
        self.up_from(other).skip(1).any(|above| above == bone)
    }
}
