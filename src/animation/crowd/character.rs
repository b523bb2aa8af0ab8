//! One of a crowd.

use std::sync::Arc;

use glam::{Affine3A, Vec3A};

use crate::animation::{
    Armature, Clip, Cursor, Limb, LimbGoal, Playback, Playhead, Pose, SizeMismatch,
};

/// A clip that a character plays.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct PlayingClip {
    clip: Arc<Clip>,
    cursor: Cursor,
    /// Where it is, and how fast it plays.
    pub playhead: Playhead,
    /// What happens at its ends.
    pub playback: Playback,
    /// How far the pose of the clips before it goes to this one's, taken into [0, 1]; NaN counts as
    /// 0. The first clip's does not count.
    pub share: f32,
}

impl PlayingClip {
    /// From its start, in a loop, with share 1.
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

/// One of a [`Crowd`](super::Crowd): what it plays, what its limbs reach for, and its pose.
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

    getters! {
        /// Its clips, each blended over those before it.
        pub fn clips_mut(&mut self) -> &mut [PlayingClip] = &mut self.clips;
        /// A goal for each limb of the crowd, in model coordinates.
        pub fn goals_mut(&mut self) -> &mut [LimbGoal] = &mut self.goals;
        /// Its pose as of the last frame.
        pub fn pose(&self) -> &Pose = &self.pose;
        /// Where its bones are in the model, as of the last frame.
        pub fn model_from_bone(&self) -> &[Affine3A] = &self.model_from_bone;
    }

    /// One frame; `other` is room for a pose.
    pub(super) fn advance(
        &mut self,
        armature: &Armature,
        limbs: &[Limb],
        seconds: f64,
        other: &mut Pose,
    ) -> Result<(), SizeMismatch> {
        if self.clips.is_empty() {
            // Limbs reach from rest, not from where they were.
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
