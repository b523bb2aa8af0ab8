//! Characters of a crowd.

use std::sync::Arc;

use glam::{Affine3A, Vec3A};

use crate::animation::{
    Armature, Clip, Cursor, Limb, LimbGoal, Playback, Playhead, Pose, SizeMismatch,
};

/// Clip that a character plays.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct PlayingClip {
    clip: Arc<Clip>,
    cursor: Cursor,
    /// Playback position and speed.
    pub playhead: Playhead,
    /// Playback mode.
    pub playback: Playback,
    /// Weight of this clip's pose over the blend of the previous clips, clamped to [0, 1]. NaN counts as 0. Unused for
    /// the first clip.
    pub share: f32,
}

impl PlayingClip {
    /// Plays a clip from its start, in a loop, with share 1.
    #[must_use]
    pub fn new(clip: Arc<Clip>) -> Self {
        Self {
            clip,
            cursor: Cursor::new(),
            playhead: Playhead::new(),
            playback: Playback::Loop,
            share: 1.0,
        }
    }

    /// The clip.
    #[must_use]
    pub fn clip(&self) -> &Clip {
        &self.clip
    }

    pub(super) fn check(&self, armature: &Armature) -> Result<(), SizeMismatch> {
        self.clip.check_armature(armature)
    }

    fn sample(&mut self, pose: &mut Pose) -> Result<(), SizeMismatch> {
        let time = self.clip.start() + self.playhead.elapsed();
        self.clip
            .sample(time, self.playback, &mut self.cursor, pose)
    }
}

/// Character of a [`Crowd`](super::Crowd): its clips, the goals of its limbs, and its pose.
#[derive(Clone, Debug)]
pub struct Character {
    clips: Vec<PlayingClip>,
    goals: Vec<LimbGoal>,
    pose: Pose,
    model_from_bone: Vec<Affine3A>,
}

impl Character {
    pub(super) fn new(armature: &Armature, limbs: usize, clips: Vec<PlayingClip>) -> Self {
        let idle = LimbGoal {
            weight: 0.0,
            ..LimbGoal::at(Vec3A::ZERO)
        };
        let at_rest = armature.rest_from_model().iter();
        Self {
            clips,
            goals: vec![idle; limbs],
            pose: armature.rest().clone(),
            model_from_bone: at_rest.map(Affine3A::inverse).collect(),
        }
    }

    /// Clips of the character, each blended over the previous ones.
    #[must_use]
    pub fn clips_mut(&mut self) -> &mut [PlayingClip] {
        &mut self.clips
    }

    /// Goal for each limb of the crowd, in model coordinates.
    #[must_use]
    pub fn goals_mut(&mut self) -> &mut [LimbGoal] {
        &mut self.goals
    }

    /// Pose after the last frame.
    #[must_use]
    pub fn pose(&self) -> &Pose {
        &self.pose
    }

    /// Transforms from bones to the model after the last frame.
    #[must_use]
    pub fn model_from_bone(&self) -> &[Affine3A] {
        &self.model_from_bone
    }

    /// Advances one frame; `other` is a scratch pose.
    pub(super) fn advance(
        &mut self,
        armature: &Armature,
        limbs: &[Limb],
        seconds: f64,
        other: &mut Pose,
    ) -> Result<(), SizeMismatch> {
        if self.clips.is_empty() {
            // Each frame starts at the rest pose, so limb solutions do not depend on the previous frame.
            self.pose.copy_from(armature.rest());
        }
        for (number, playing) in self.clips.iter_mut().enumerate() {
            playing.playhead.advance(seconds);
            if number == 0 {
                playing.sample(&mut self.pose)?;
            } else if playing.share > 0.0 {
                playing.sample(other)?;
                self.pose.cross_fade(other, playing.share)?;
            }
        }
        for (limb, goal) in limbs.iter().zip(&self.goals) {
            limb.reach(armature, &mut self.pose, goal)?;
        }
        armature.local_to_model(&self.pose, &mut self.model_from_bone)
    }
}
