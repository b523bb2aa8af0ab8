//! Skeletons on ball joints.

use kinopt::animation::{Armature, BallPoseMap, EulerPoseMap, LayerError, Pose};
use kinopt::io::cones;
use kinopt::skeleton::{BallSkeleton, Cones};
use kinopt_bindings::problem_file::{BoneJoints, ModelSettings};

use crate::failure::Outcome;
use crate::loaded_model::LoadedModel;
use crate::model_options::{refuse_robot_settings, refuse_settings_of_robots};
use crate::robot_base::skeleton_root;

/// Swing and twist limits of the bones.
///
/// # Errors
/// A file that cannot be read, or cones for joints that are not ball joints.
fn read_cones(settings: &ModelSettings) -> Outcome<Cones> {
    if settings.cones.is_some() && settings.joints == Some(BoneJoints::TwistBendTwist) {
        return Err(usage!(
            "`cones` are for ball joints, not for twist-bend-twist"
        ));
    }
    let cones = settings.cones.as_ref().map(cones::read).transpose()?;
    Ok(cones.unwrap_or_default())
}

impl LoadedModel {
    /// Skeleton with the joints of the settings.
    pub(crate) fn with_joints(self, settings: &ModelSettings) -> Outcome<Self> {
        match settings.are_balls() {
            true => {
                refuse_settings_of_robots(settings, &self.file)?;
                self.on_balls(settings)
            }
            false => {
                refuse_robot_settings(settings, &self.file)?;
                Ok(self)
            }
        }
    }

    /// The skeleton on ball joints.
    fn on_balls(mut self, settings: &ModelSettings) -> Outcome<Self> {
        let Some(rig) = &self.rig else {
            return Ok(self);
        };
        let root = skeleton_root(settings)?;
        let file = match &settings.cones {
            Some(cones) => cones.display().to_string(),
            None => self.file.clone(),
        };
        let balls = BallSkeleton::new(rig.skeleton.clone(), &read_cones(settings)?, root);
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
