//! What a movement is brought onto: a robot, or a figure that moves as a whole.

use std::path::Path;

use kinopt::animation::{Armature, Pose};
use kinopt::glam::{Affine3A, DQuat, DVec3, Quat};
use kinopt::robot::{BaseJoint, Robot};
use kinopt::skeleton::Skeleton;
use kinopt::spatial::{Matrix3, Placement, Vector3};

use super::source::Up;
use crate::animated_armature::AnimatedArmature;
use crate::ball_figure::PoseBridge;
use crate::failure::Outcome;
use crate::loaded_model::LoadedModel;
use crate::model_options::ModelOptions;

/// A robot, or a figure as one.
#[derive(Debug)]
pub(super) struct Target {
    pub(super) loaded: LoadedModel,
    pub(super) robot: Robot,
    /// Of a figure's numbers so many are of the base that was put under it.
    base: usize,
    /// Whether y points upward in the figure's file.
    turned: bool,
}

/// What a free base has of a configuration: x, y, z and a quaternion w, x, y, z.
pub(super) const BASE: usize = 7;

impl Target {
    /// Reads a robot as the options say, and a figure on a free base.
    pub(super) fn read(path: &Path, up: Option<Up>, options: &ModelOptions) -> Outcome<Self> {
        let animated = AnimatedArmature::is_at(path);
        let turned = up.map_or(animated, |up| up == Up::Y);
        let figure = animated || path.extension().is_some_and(|own| own == "json");
        if !figure {
            if up.is_some() {
                return Err(usage!(
                    "{}: --target-up is for figures; upward is z of a robot",
                    path.display()
                ));
            }
            let loaded = LoadedModel::read(path, options)?;
            let lacks = || usage!("{}: it is no robot", loaded.file);
            let robot = Robot::clone(loaded.robot.as_ref().ok_or_else(lacks)?);
            return Ok(Self {
                loaded,
                robot,
                base: 0,
                turned: false,
            });
        }
        if options.makes_figure() {
            return Err(usage!(
                "{}: figures are brought to move by their angles, without --joints and --cones",
                path.display()
            ));
        }
        let mut loaded = LoadedModel::read(path, &ModelOptions::default())?;
        let lacks = || failure!("{}: it has no bones", loaded.file);
        let rig = loaded.rig.as_ref().ok_or_else(lacks)?;
        let skeleton = match turned {
            true => rig
                .skeleton
                .placed(Placement::new(upright(), Vector3::zero()))?,
            false => rig.skeleton.clone(),
        };
        let robot = Robot::new(skeleton.model().clone(), Vec::new())?;
        let robot = robot.with_base_joint(BaseJoint::FREE)?;
        loaded.model = robot.model().clone();
        Ok(Self {
            loaded,
            robot,
            base: BASE,
            turned,
        })
    }

    /// The skeleton of a figure.
    pub(super) fn skeleton(&self) -> Option<&Skeleton> {
        self.loaded.rig.as_ref().map(|rig| &rig.skeleton)
    }

    /// Names of the numbers of a configuration.
    pub(super) fn names(&self) -> Vec<String> {
        self.loaded.coordinate_names()
    }

    /// Whether a configuration begins with a free base.
    pub(super) fn is_free(&self) -> bool {
        let model = self.robot.model();
        let first = model.free_joints().first();
        first.is_some_and(|&joint| model.coordinate(joint) == Some(0))
    }

    /// The poses of a figure's armature, in the axes of its file.
    pub(super) fn poses(&self, armature: &Armature, q: &[f64]) -> Outcome<Vec<Pose>> {
        let lacks = || failure!("{}: it is no figure", self.loaded.file);
        let bridge = PoseBridge::of(&self.loaded, armature).ok_or_else(lacks)?;
        // What moves all of the body: the bones that turn, on none that does.
        let skeleton = self.skeleton().ok_or_else(lacks)?;
        let turns = |name: &str| {
            let bone = skeleton.bone(name);
            bone.is_ok_and(|bone| {
                let joints = skeleton.joints(bone);
                let limits = joints.map(|id| skeleton.model().joints()[id.index()].limits);
                limits.iter().any(|limits| limits.upper > limits.lower)
            })
        };
        let turning: Vec<_> = armature
            .bone_ids()
            .filter(|bone| turns(&armature.names()[bone.index()]))
            .collect();
        let is_topmost = |bone: &&kinopt::skeleton::BoneId| {
            let above = std::iter::successors(armature.parent(**bone), |own| armature.parent(*own));
            above.into_iter().all(|own| !turning.contains(&own))
        };
        let topmost: Vec<_> = turning.iter().filter(is_topmost).copied().collect();
        let width = self.robot.model().configuration_len();
        let frames = q.chunks_exact(width.max(1)).map(|q| {
            let mut pose = match &self.loaded.scene {
                Some(scene) => scene.stands.clone(),
                None => armature.rest().clone(),
            };
            let (base, angles) = q.split_at(self.base);
            bridge.pose_of(angles, &mut pose);
            if let Ok(base) = <&[f64; BASE]>::try_from(base) {
                let moved = self.moved(base);
                for &bone in &topmost {
                    let stood = armature.model_from_bone(&pose, bone)?;
                    armature.set_model_from_bone(&mut pose, bone, moved * stood)?;
                }
            }
            Ok(pose)
        });
        frames.collect()
    }

    /// How the base moves the figure, in the axes of its file.
    fn moved(&self, [x, y, z, w, i, j, k]: &[f64; BASE]) -> Affine3A {
        let turn = DQuat::from_xyzw(*i, *j, *k, *w);
        let way = DVec3::new(*x, *y, *z);
        // From z upward back to y.
        let back = match self.turned {
            true => DQuat::from_rotation_x(-std::f64::consts::FRAC_PI_2),
            false => DQuat::IDENTITY,
        };
        let (turn, way) = (back * turn * back.inverse(), back * way);
        let turn = Quat::from_xyzw(turn.x as f32, turn.y as f32, turn.z as f32, turn.w as f32);
        Affine3A::from_rotation_translation(turn.normalize(), way.as_vec3())
    }
}

/// From y upward to z upward.
fn upright() -> Matrix3<f64> {
    let [x, y, z] = Vector3::UNITS;
    Matrix3::from_columns(x, z, y * -1.0)
}
