//! Models loaded from any supported file.

use std::path::Path;

use kinopt::Model;
use kinopt::animation::{Armature, EulerClip, LayerError, Playback, Pose};
use kinopt::io::bvh::BvhChannel;
use kinopt::io::gltf::SceneFile;
use kinopt::io::rig::Rig;
use kinopt::model::{FrameId, JointId, JointKind, ParameterMap, Source};
use kinopt::robot::{Robot, Srdf};
use kinopt::skeleton::{BallSkeleton, Skeleton};
use kinopt_bindings::problem_file::ModelSettings;

use crate::animated_armature::{AnimatedArmature, extension};
use crate::ball_figure::FigurePosing;
use crate::failure::Outcome;
use crate::file_access;
use crate::hinges;
use crate::model_options::{read_robot, refuse_skeleton_settings};
use crate::output;

/// File types of [`LoadedModel::read`]. A new type also needs a match arm there.
const SUPPORTED: &str = ".urdf and .xml (a robot), .json (a rig), .glb, .gltf and .vrm (a scene), .bvh (motion capture)";

/// Extensions of robots: URDF and MJCF. The root element of the document selects the reader.
const ROBOTS: [&str; 3] = ["urdf", "xml", "mjcf"];

/// Default tolerance of rigs: a share of their size, and an angle in radians.
const RIG_TOLERANCE: f64 = 1e-9;
/// Default tolerance of robots, in metres and radians.
const ROBOT_TOLERANCE: f64 = 1e-6;

/// Model with the rest of its file.
#[derive(Debug)]
pub(crate) struct LoadedModel {
    /// File name, as typed.
    pub(crate) file: String,
    /// Model of all problems.
    pub(crate) model: Model,
    /// Rest of a rig, or the bones of a scene; `None` for a robot.
    pub(crate) rig: Option<Box<Rig>>,
    /// The same bones on ball joints, if selected.
    pub(crate) balls: Option<Box<BallSkeleton>>,
    /// Scene file.
    pub(crate) scene: Option<Box<LoadedScene>>,
    /// Bones of a motion capture.
    pub(crate) capture: Option<Box<Capture>>,
    /// Robot with its mimic joints; `None` for a rig.
    pub(crate) robot: Option<Box<Robot>>,
    /// SRDF file of the robot, if given.
    pub(crate) srdf: Option<Box<Srdf>>,
    /// Joints that the command locks.
    pub(crate) held: Option<Box<HeldJoints>>,
    /// Frame with a tool, and the frame of the tool; targets of the former apply to the latter.
    pub(crate) tool: Option<(FrameId, FrameId)>,
}

/// Joints that a command locks.
#[derive(Clone, Debug)]
pub(crate) struct HeldJoints {
    /// Locked joints with values in radians or metres.
    pub(crate) locked: Vec<(JointId, f64)>,
    /// Locked ball joints with quaternions w, x, y, z.
    pub(crate) turned: Vec<(JointId, [f64; 4])>,
    /// The only free joints, and a configuration for all others.
    pub(crate) only: Option<(Vec<JointId>, Vec<f64>)>,
    pub(crate) map: ParameterMap,
}

/// Scene file, and the pose of its bones in the rest configuration of the model.
#[derive(Debug)]
pub(crate) struct LoadedScene {
    pub(crate) file: SceneFile,
    pub(crate) rest_pose: Pose,
}

impl LoadedScene {
    /// Pose of a configuration of its skeleton.
    pub(crate) fn pose(&self, bridge: &FigurePosing, q: &[f64]) -> Result<Pose, LayerError> {
        let mut pose = self.rest_pose.clone();
        bridge.pose_of(q, &mut pose)?;
        Ok(pose)
    }
}

/// Bones of a motion capture, in the rest pose of the model.
#[derive(Debug)]
pub(crate) struct Capture {
    pub(crate) armature: Armature,
    /// Time between frames, in seconds.
    pub(crate) frame_time: f64,
    /// Channels of each bone.
    pub(crate) channels: Vec<Vec<BvhChannel>>,
    notes: Vec<String>,
}

/// Time of a clip whose pose is the rest pose of a skeleton.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Moment<'a> {
    /// Time in seconds of the file.
    pub(crate) time: f64,
    /// Name of the clip; `None` for the first.
    pub(crate) clip: Option<&'a str>,
}

impl LoadedModel {
    /// Reads any supported file; its extension selects the reader.
    pub(crate) fn read(path: &Path, settings: &ModelSettings) -> Outcome<Self> {
        Self::read_at(path, settings, None)
    }

    /// Reads a model as [`read`](Self::read) does, with a scene or a capture at a time of a clip.
    pub(crate) fn read_at(
        path: &Path,
        settings: &ModelSettings,
        moment: Option<Moment<'_>>,
    ) -> Outcome<Self> {
        let file = path.display().to_string();
        let extension = extension(path);
        let is_robot = ROBOTS.contains(&extension.as_str());
        if is_robot {
            refuse_skeleton_settings(settings, &file)?;
        }
        if AnimatedArmature::is_at(path) {
            let animated = AnimatedArmature::read_for(path, settings)?;
            return Self::of_animated(animated, moment, settings)?.with_joints(settings);
        }
        if moment.is_some() {
            return Err(usage!(
                "{file}: `time` and `clip` are for scenes and motion capture"
            ));
        }
        match extension.as_str() {
            "json" => {
                let rig = Rig::read_with(path, &file_access::allowed())?;
                for note in &rig.notes {
                    output::message(&format!("{file}: {note}"));
                }
                Self::of_rig(file, rig).with_joints(settings)
            }
            "xacro" => Err(failure!(
                "{file}: xacro files are not supported: expand it first with `xacro {file} > OUT.urdf` \
                 (`pip install xacro`)"
            )),
            _ if is_robot => Ok(Self::of_robot(file, read_robot(settings, path)?)),
            "" => Err(failure!(
                "{file}: a model file needs an extension; supported: {SUPPORTED}"
            )),
            other => Err(failure!(
                "{file}: models in .{other} files are not supported; supported: {SUPPORTED}"
            )),
        }
    }

    /// Bones of a scene or a capture, all free to rotate, with the hinges of the settings. In a scene with skins, only the
    /// joints of skins rotate; in a capture, only joints with channels.
    fn of_animated(
        animated: AnimatedArmature,
        moment: Option<Moment<'_>>,
        settings: &ModelSettings,
    ) -> Outcome<Self> {
        let pose = moment.map(|Moment { time, clip }| {
            animated.pose_at(animated.clip(clip)?, time, Playback::Hold)
        });
        let pose = pose.transpose()?;
        let AnimatedArmature {
            file,
            mut armature,
            frames,
            notes,
            scene,
            turning,
            ..
        } = animated;
        if let Some(pose) = &pose {
            armature = armature.at_rest_in(pose)?;
        }
        let rest_pose = armature.rest().clone();
        let scene = scene.map(|file| LoadedScene {
            file: *file,
            rest_pose,
        });
        let skeleton = armature.turning_skeleton(file.clone(), &turning);
        let skeleton = skeleton.map_err(|error| failure!("{file}: {error}"))?;
        let skeleton = hinges::applied(skeleton, settings, &file)?;
        let capture = frames.map(|frames| Capture {
            armature,
            frame_time: frames.time,
            channels: frames.channels,
            notes,
        });
        Ok(Self {
            scene: scene.map(Box::new),
            capture: capture.map(Box::new),
            ..Self::of_skeleton(file, skeleton)
        })
    }

    /// Bones without mesh, keyframes and pins.
    pub(crate) fn of_skeleton(file: String, skeleton: Skeleton) -> Self {
        let rig = Rig {
            skeleton,
            mesh: None,
            weights: None,
            clip: EulerClip::default(),
            constrained: Vec::new(),
            notes: Vec::new(),
        };
        Self::of_rig(file, rig)
    }

    fn of_rig(file: String, rig: Rig) -> Self {
        let model = rig.skeleton.model().clone();
        let rig = Some(Box::new(rig));
        Self {
            rig,
            ..Self::of_model(file, model)
        }
    }

    fn of_robot(file: String, robot: Robot) -> Self {
        let model = robot.model().clone();
        let robot = Some(Box::new(robot));
        Self {
            robot,
            ..Self::of_model(file, model)
        }
    }

    fn of_model(file: String, model: Model) -> Self {
        Self {
            file,
            model,
            rig: None,
            balls: None,
            scene: None,
            capture: None,
            robot: None,
            srdf: None,
            held: None,
            tool: None,
        }
    }

    /// Rejects `--clip`, an option of scenes.
    pub(crate) fn refuse_clip(&self, clip: Option<&str>) -> Outcome<()> {
        let (file, kind) = (&self.file, self.kind());
        let refused = || usage!("{file}: --clip is for scenes; this is a {kind}");
        clip.map_or(Ok(()), |_| Err(refused()))
    }

    /// Notes of the reader.
    pub(crate) fn notes(&self) -> Vec<String> {
        let notes = self.rig.iter().flat_map(|rig| &rig.notes);
        let notes = notes.map(ToString::to_string);
        let capture = self.capture.iter().flat_map(|capture| &capture.notes);
        notes.chain(capture.cloned()).collect()
    }

    /// "rig", "scene", "motion capture" or "robot".
    pub(crate) fn kind(&self) -> &'static str {
        match self {
            Self { scene: Some(_), .. } => "scene",
            Self {
                capture: Some(_), ..
            } => "motion capture",
            Self { rig: Some(_), .. } => "rig",
            _ => "robot",
        }
    }

    /// Robot with its collision shapes, for a subcommand.
    ///
    /// # Errors
    /// A rig, a scene or a motion capture.
    pub(crate) fn robot_with_shapes(&self, subcommand: &str) -> Outcome<&Robot> {
        self.robot.as_deref().ok_or_else(|| {
            usage!(
                "{subcommand} is for robots with collision shapes (.urdf or .xml); {} is a {}",
                self.file,
                self.kind()
            )
        })
    }

    /// True if the file has neither rotation limits of bones nor pins.
    pub(crate) fn is_bare_figure(&self) -> bool {
        self.scene.is_some() || self.capture.is_some()
    }

    /// Size of the model: of a rig's mesh, or its bones without one, in the rig's unit; of a robot its reach in metres.
    pub(crate) fn size(&self) -> f64 {
        match &self.rig {
            Some(rig) => match rig.mesh.as_ref().map(|mesh| mesh.size()) {
                Some(size) if size > 0.0 => size,
                _ => rig.skeleton.size(),
            },
            None => self.model.reach(),
        }
    }

    /// Default tolerances: a length in metres (rigs: their own unit), and an angle in radians.
    pub(crate) fn default_tolerances(&self) -> (f64, f64) {
        match self.rig {
            Some(_) => (RIG_TOLERANCE * self.size(), RIG_TOLERANCE),
            None => (ROBOT_TOLERANCE, ROBOT_TOLERANCE),
        }
    }

    /// Name of the unit of length.
    pub(crate) fn length_unit(&self) -> &'static str {
        match self.rig {
            Some(_) => "rig units",
            None => "m",
        }
    }

    /// Map from solver variables to configurations, with mimic and locked joints.
    pub(crate) fn parameters(&self) -> ParameterMap {
        match &self.held {
            Some(held) => held.map.clone(),
            None => self.own_parameters(),
        }
    }

    /// Map of the model alone, without the joints that a command locks.
    pub(crate) fn own_parameters(&self) -> ParameterMap {
        match &self.robot {
            Some(robot) => robot.map().clone(),
            None => ParameterMap::free(&self.model),
        }
    }

    /// Rest configuration: all zeros, moved into the limits, with mimic joints.
    pub(crate) fn rest(&self) -> Vec<f64> {
        self.within_limits(&self.model.neutral())
    }

    /// Configuration moved into the limits, with mimic joints.
    pub(crate) fn within_limits(&self, q: &[f64]) -> Vec<f64> {
        let map = self.parameters();
        let mut within = q.to_vec();
        let mut x = vec![0.0; map.variables()];
        let read = map.reduce(q, &mut x);
        // An invalid configuration is returned unchanged; its user reports the error.
        match read.and_then(|()| map.expand_within_limits(&x, &mut within)) {
            Ok(()) => within,
            Err(_) => q.to_vec(),
        }
    }

    /// Root link of a robot.
    pub(crate) fn root_link(&self) -> Option<&str> {
        let mut frames = self.model.frames().iter();
        let root = frames.find(|frame| frame.joint.is_none());
        root.map(|frame| frame.name.as_str())
    }

    /// Links of a robot without child links.
    pub(crate) fn tip_links(&self) -> Vec<&str> {
        let tips = self.robot.as_ref().map(|robot| robot.tips());
        let frames = tips.unwrap_or_default().into_iter();
        let frames = frames.filter_map(|id| self.model.frames().get(id.index()));
        frames.map(|frame| frame.name.as_str()).collect()
    }

    /// Valid names of `--frame`: links, or the bones of a skeleton.
    pub(crate) fn frame_names(&self) -> Vec<&str> {
        match &self.rig {
            Some(rig) => rig
                .skeleton
                .bones()
                .iter()
                .map(|bone| bone.name.as_str())
                .collect(),
            None => self
                .model
                .frames()
                .iter()
                .map(|frame| frame.name.as_str())
                .collect(),
        }
    }

    /// Name of a joint; empty for a joint of another model.
    pub(crate) fn joint_name(&self, joint: JointId) -> &str {
        let joint = self.model.joints().get(joint.index());
        joint.map_or("", |joint| joint.name.as_str())
    }

    /// Names of the moving joints, in the order of a configuration.
    pub(crate) fn joint_names(&self) -> Vec<&str> {
        let moving = self.model.moving_joints().iter();
        moving.map(|&joint| self.joint_name(joint)).collect()
    }

    /// Names as of [`joint_names`](Self::joint_names), with the components of quaternions.
    pub(crate) fn coordinate_names(&self) -> Vec<String> {
        kinopt_bindings::coordinates::names(&self.model)
    }

    /// Names as of [`joint_names`](Self::joint_names), for documents; `None` for a rig, whose bones identify its
    /// angles.
    pub(crate) fn documented_joints(&self) -> Option<Vec<&str>> {
        let named = self.robot.is_some() || self.balls.is_some();
        named.then(|| self.joint_names())
    }

    /// Flags of the coordinates that a solver may change.
    pub(crate) fn free_coordinates(&self) -> Vec<bool> {
        self.leaders(&self.parameters())
    }

    /// Flags of the coordinates that a solver may change or the command locks.
    pub(crate) fn leading_coordinates(&self) -> Vec<bool> {
        self.leaders(&self.own_parameters())
    }

    /// Flags of the coordinates that the command locks.
    pub(crate) fn held_coordinates(&self) -> Vec<bool> {
        let is_leading = self.leading_coordinates().into_iter();
        let is_free = self.free_coordinates();
        is_leading
            .zip(is_free)
            .map(|(is_leading, is_free)| is_leading && !is_free)
            .collect()
    }

    fn leaders(&self, map: &ParameterMap) -> Vec<bool> {
        let mut leads = vec![false; self.model.configuration_len()];
        for &leader in map.leaders() {
            if let Some(flag) = leads.get_mut(leader) {
                *flag = true;
            }
        }
        for (flag, source) in leads.iter_mut().zip(map.sources()) {
            *flag |= matches!(source, Source::Rotation { .. });
        }
        leads
    }

    /// Variable of `map` that moves a joint.
    pub(crate) fn variable_of(&self, map: &ParameterMap, joint: JointId) -> Option<usize> {
        match map.sources().get(self.model.coordinate(joint)?) {
            Some(Source::Variable { variable, .. } | Source::Rotation { variable }) => {
                Some(*variable)
            }
            _ => None,
        }
    }

    /// Coordinates of a robot that move none of some frames; solvers keep them at the start. Empty for a rig, whose
    /// whole pose is the solution.
    pub(crate) fn idle_coordinates(&self, frames: impl Iterator<Item = FrameId>) -> Vec<usize> {
        if self.robot.is_none() {
            return Vec::new();
        }
        let map = self.own_parameters();
        let variable = |joint| self.variable_of(&map, joint);
        let in_loops = self.model.loops().iter().flat_map(|closure| closure.frames);
        let moving = frames.chain(in_loops);
        let moving = moving.flat_map(|frame| self.model.joints_above(frame));
        let moving: Vec<usize> = moving.filter_map(variable).collect();
        let joints = self.model.moving_joints().iter().enumerate();
        let idle =
            joints.filter(|&(_, &joint)| variable(joint).is_some_and(|v| !moving.contains(&v)));
        idle.map(|(coordinate, _)| coordinate).collect()
    }

    /// Flags of the coordinates that are angles; others are lengths and components of quaternions.
    pub(crate) fn is_angle(&self) -> impl Iterator<Item = bool> + '_ {
        let kinds = self.kinds();
        kinds.map(|kind| kind.turns() && !kind.is_ball())
    }

    /// Flags of the coordinates that are components of quaternions.
    pub(crate) fn is_of_ball(&self) -> impl Iterator<Item = bool> + '_ {
        self.kinds().map(JointKind::is_ball)
    }

    /// True if there is a prismatic joint.
    pub(crate) fn slides(&self) -> bool {
        self.kinds().any(JointKind::slides)
    }

    /// Kind of the joint of each coordinate.
    fn kinds(&self) -> impl Iterator<Item = JointKind> + '_ {
        let moving = self.model.moving_joints().iter();
        let joints = moving.filter_map(|id| self.model.joints().get(id.index()));
        joints.map(|joint| joint.kind)
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use kinopt::model::Limits;
    use kinopt::spatial::{Placement, Vector3};

    use super::*;
    use crate::frame_name::BareName;

    fn robot() -> LoadedModel {
        let mut builder = Model::builder("crane");
        let [x, _, z] = Vector3::UNITS;
        let half = Limits::new(-0.5, 0.5);
        let turn = builder.revolute("turn", None, Placement::identity(), z, half);
        let on = Some(turn);
        let slide = builder.prismatic("slide", on, Placement::translation(x), x, half);
        builder.frame("hook", Some(slide), Placement::translation(x));
        let robot = Robot::new(builder.build().unwrap(), Vec::new()).unwrap();
        LoadedModel::of_robot("crane.urdf".to_owned(), robot)
    }

    #[test]
    fn robot_needs_no_rig() {
        let robot = robot();
        assert_eq!((robot.kind(), robot.length_unit()), ("robot", "m"));
        assert_eq!(robot.size(), 2.5);
        assert_eq!(robot.default_tolerances(), (1e-6, 1e-6));
        assert!(robot.frame("hook", BareName::Tip).is_ok());
        let error = robot.frame("hand", BareName::Tip).unwrap_err().to_string();
        assert!(error.contains("`hand`") && error.contains("hook"));
        assert!(robot.skin(None).is_err() && robot.keyframes_at(0.0, Default::default()).is_err());
    }

    #[test]
    fn degrees_are_for_turning_joints_only() {
        let robot = robot();
        let q = robot
            .typed_configuration(&[90.0, 0.25], true, "--q")
            .unwrap();
        assert_eq!(q, [std::f64::consts::FRAC_PI_2, 0.25]);
        let q = robot
            .typed_configuration(&[0.1, 0.25], false, "--q")
            .unwrap();
        assert_eq!(q, [0.1, 0.25]);
        assert!(robot.typed_configuration(&[0.1], false, "--q").is_err());
    }

    #[test]
    fn robot_frames_are_placed() {
        let robot = robot();
        let report = robot
            .frame_report(&[], None, &[std::f64::consts::FRAC_PI_2, 0.5])
            .unwrap();
        let json = serde_json::to_value(&report).unwrap();
        let number = |key: &str, k: usize| json["hook"][key][k].as_f64().unwrap();
        assert!((number("position", 1) - 2.5).abs() < 1e-15);
        assert!(number("position", 0).abs() < 1e-15);
        let half = 0.5_f64.sqrt();
        assert!((number("quaternion", 0) - half).abs() < 1e-15);
        assert!((number("quaternion", 3) - half).abs() < 1e-15);
        assert!(json["hook"].get("tip").is_none());
    }
}
