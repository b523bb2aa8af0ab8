//! `--joints ball` and `--cones`: skeletons on ball joints.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use kinopt::animation::{Armature, BallPoseMap, EulerPoseMap, Pose, ReachError};
use kinopt::io::cones;
use kinopt::skeleton::{BallSkeleton, Cones, SkeletonRoot};

use crate::failure::Outcome;
use crate::help_headings::MODEL;
use crate::loaded_model::LoadedModel;

/// Options about the joints of a figure.
#[derive(Args, Debug, Default)]
pub(crate) struct FigureOptions {
    /// What the bones of a rig, a scene or a capture turn on: `ball`, one ball joint each (q has a quaternion w, x, y, z
    /// a bone, how it is turned from rest in its own axes), or `twist-bend-twist`, three angles each.
    ///
    /// Default: twist-bend-twist. With `ball` the ranges of a rig's file do not count, those of --cones do; and
    /// --base-joint free lets the figure move as a whole: x, y, z come before the quaternion of its root.
    #[arg(long, value_enum, value_name = "KIND", help_heading = MODEL, hide_short_help = true)]
    joints: Option<FigureJoints>,

    /// How far bones may swing and twist from rest, from a JSON file; with it joints are balls.
    ///
    /// For each bone's name an object: "swing" in degrees, of one number or two, "twist": [from, to], "angle", how far
    /// it may turn in all; and where wanted "axis": [x, y, z], what it twists about in its own axes, along it unless
    /// said, and "about": [x, y, z], the axis of the first of two swings. Default: bones turn any way.
    #[arg(long, value_name = "FILE", help_heading = MODEL, hide_short_help = true)]
    cones: Option<PathBuf>,
}

/// What bones turn on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum FigureJoints {
    TwistBendTwist,
    Ball,
}

impl FigureOptions {
    /// The option that was given, if one was.
    pub(crate) fn given(&self) -> Option<&'static str> {
        let joints = self.joints.map(|_| "--joints");
        joints.or(self.cones.as_ref().map(|_| "--cones"))
    }

    /// Whether bones turn on balls.
    pub(crate) fn are_balls(&self) -> bool {
        self.joints == Some(FigureJoints::Ball) || self.cones.is_some()
    }

    /// The cones of the bones.
    ///
    /// # Errors
    /// A file that cannot be read, or cones for joints that are no balls.
    fn cones(&self) -> Outcome<Cones> {
        if self.cones.is_some() && self.joints == Some(FigureJoints::TwistBendTwist) {
            return Err(usage!(
                "--cones are for ball joints, not for twist-bend-twist"
            ));
        }
        let cones = self.cones.as_ref().map(cones::read).transpose()?;
        Ok(cones.unwrap_or_default())
    }
}

impl LoadedModel {
    /// The same figure on ball joints.
    pub(crate) fn on_balls(mut self, options: &FigureOptions, root: SkeletonRoot) -> Outcome<Self> {
        let Some(rig) = &self.rig else {
            return Ok(self);
        };
        let file = match &options.cones {
            Some(cones) => cones.display().to_string(),
            None => self.file.clone(),
        };
        let balls = BallSkeleton::new(rig.skeleton.clone(), &options.cones()?, root);
        let balls = balls.map_err(|error| failure!("{file}: {error}"))?;
        self.model = balls.model().clone();
        self.balls = Some(Box::new(balls));
        Ok(self)
    }
}

/// From the configurations of a figure to poses of its armature.
#[derive(Clone, Debug)]
pub(crate) enum FigurePosing {
    Angles(EulerPoseMap),
    Turns(Box<BallPoseMap>),
}

impl FigurePosing {
    /// For poses of an armature whose bones the figure's are; none for a robot.
    pub(crate) fn of(loaded: &LoadedModel, armature: &Armature) -> Option<Self> {
        let rig = loaded.rig.as_ref()?;
        Some(match &loaded.balls {
            Some(balls) => Self::Turns(Box::new(BallPoseMap::new(armature, balls))),
            None => Self::Angles(EulerPoseMap::new(&rig.skeleton)),
        })
    }

    /// Writes a configuration into a pose.
    pub(crate) fn pose_of(&self, q: &[f64], pose: &mut Pose) -> Result<(), ReachError> {
        match self {
            Self::Angles(angles) => angles.pose_of(q, pose),
            Self::Turns(turns) => turns.pose_of(q, pose),
        }
    }
}
