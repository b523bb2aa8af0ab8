//! `--joints ball` and `--cones`: skeletons on ball joints.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use kinopt::animation::{Armature, BallPoseMap, EulerPoseMap, LayerError, Pose};
use kinopt::io::cones;
use kinopt::skeleton::{BallSkeleton, Cones, SkeletonRoot};

use crate::failure::Outcome;
use crate::help_headings::MODEL;
use crate::loaded_model::LoadedModel;

/// Options of the joints of a skeleton.
#[derive(Args, Debug, Default)]
pub(crate) struct FigureOptions {
    /// Joints of bones: a quaternion (ball) or three angles each. Default: twist-bend-twist.
    #[arg(long, value_enum, value_name = "KIND", help_heading = MODEL, hide_short_help = true)]
    joints: Option<FigureJoints>,

    /// Ball joints with swing and twist limits of a JSON file; see docs/guide/ball-joints.md.
    #[arg(long, value_name = "FILE", help_heading = MODEL, hide_short_help = true)]
    cones: Option<PathBuf>,
}

/// Joint type of bones.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum FigureJoints {
    TwistBendTwist,
    Ball,
}

impl FigureOptions {
    /// The given option, if any.
    pub(crate) fn given(&self) -> Option<&'static str> {
        let joints = self.joints.map(|_| "--joints");
        joints.or(self.cones.as_ref().map(|_| "--cones"))
    }

    /// True if bones have ball joints.
    pub(crate) fn are_balls(&self) -> bool {
        self.joints == Some(FigureJoints::Ball) || self.cones.is_some()
    }

    /// Cones of the bones.
    ///
    /// # Errors
    /// A file that cannot be read, or cones for joints that are not ball joints.
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
    /// The skeleton on ball joints.
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

/// Map from configurations of a skeleton to poses of its armature.
#[derive(Clone, Debug)]
pub(crate) enum FigurePosing {
    Angles(EulerPoseMap),
    Turns(Box<BallPoseMap>),
}

impl FigurePosing {
    /// Map for an armature with the bones of the model; `None` for a robot.
    pub(crate) fn of(loaded: &LoadedModel, armature: &Armature) -> Option<Self> {
        let rig = loaded.rig.as_ref()?;
        Some(match &loaded.balls {
            Some(balls) => Self::Turns(Box::new(BallPoseMap::new(armature, balls))),
            None => Self::Angles(EulerPoseMap::new(&rig.skeleton)),
        })
    }

    /// Writes a configuration into a pose.
    pub(crate) fn pose_of(&self, q: &[f64], pose: &mut Pose) -> Result<(), LayerError> {
        match self {
            Self::Angles(angles) => angles.pose_of(q, pose),
            Self::Turns(turns) => turns.pose_of(q, pose),
        }
    }
}
