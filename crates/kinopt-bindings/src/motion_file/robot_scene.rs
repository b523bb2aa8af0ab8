//! Writer of a robot's motion as glTF: a node for each link.

use std::path::Path;

use kinopt::animation::{Armature, ArmatureBone, Clip, LocalTransform};
use kinopt::glam::{Affine3A, Vec3A};
use kinopt::io::WriteError;
use kinopt::io::gltf::{self, Scene, WriteOptions};
use kinopt::kinematics::{ForwardKinematics, KinematicsError};
use kinopt::model::{JointId, Model};
use kinopt::motion::retarget::UpAxis;
use kinopt::robot::Robot;
use kinopt::spatial::Placement;

/// Writes configurations, one after another, as a .glb file with a node for each link and a clip of its motion.
/// `frame_rate` is in samples per second. The scene has no meshes. It is upright, with y up as glTF requires.
///
/// # Errors
/// Returns an error with the file's name if it cannot be written, or if the configurations are not those of the robot.
pub fn write_robot_glb(
    robot: &Robot,
    (q, frame_rate): (&[f64], f64),
    name: &str,
    path: &Path,
) -> Result<(), WriteError> {
    let bytes = glb(robot.model(), (q, frame_rate), name);
    let bytes = bytes.map_err(|problem| {
        let problem = std::io::Error::new(std::io::ErrorKind::InvalidInput, problem);
        WriteError::new(path, problem)
    });
    kinopt::io::write_file(path, &bytes?)
}

fn glb(
    model: &Model,
    (q, frame_rate): (&[f64], f64),
    name: &str,
) -> Result<Vec<u8>, Box<dyn std::error::Error + Send + Sync>> {
    let parents = parent_frames(model);
    let mut kinematics = ForwardKinematics::new(model);
    let bones = locals(&mut kinematics, &parents, &model.neutral())?;
    let bones = bones.into_iter().zip(&parents).zip(model.frames());
    let bones = bones.map(|((rest, parent), frame)| ArmatureBone {
        name: frame.name.clone(),
        parent: *parent,
        rest,
    });
    let armature = Armature::new(bones.collect(), Vec::new())?;
    let mut poses = Vec::new();
    for q in q.chunks_exact(model.configuration_len().max(1)) {
        let mut pose = armature.rest().clone();
        let locals = locals(&mut kinematics, &parents, q)?;
        for (bone, local) in armature.bone_ids().zip(locals) {
            pose.set_local(bone, local)?;
        }
        poses.push(pose);
    }
    let times: Vec<f32> = (0..poses.len())
        .map(|frame| (frame as f64 / frame_rate) as f32)
        .collect();
    let clip = Clip::through_poses(name, &armature, &times, &poses)?;
    let scene = Scene {
        armature,
        meshes: Vec::new(),
        clips: vec![clip],
        notes: Vec::new(),
    };
    let mut options = WriteOptions::default();
    options.up = UpAxis::Z.into();
    Ok(gltf::to_bytes(&scene, &options)?)
}

/// Transform of each frame in its parent frame.
fn locals(
    kinematics: &mut ForwardKinematics,
    parents: &[Option<usize>],
    q: &[f64],
) -> Result<Vec<LocalTransform>, KinematicsError> {
    let placed = kinematics.place(q)?;
    let local = |(placement, parent): (&Placement<f64>, &Option<usize>)| {
        let local = parent.map_or(*placement, |parent| placed[parent].inverse() * *placement);
        let affine = Affine3A::from(local);
        let (_, rotation, translation) = affine.to_scale_rotation_translation();
        LocalTransform {
            translation: Vec3A::from(translation),
            rotation: rotation.normalize(),
            ..LocalTransform::IDENTITY
        }
    };
    Ok(placed.iter().zip(parents).map(local).collect())
}

/// Index of the frame that carries each frame: the first frame on its joint, or on the next joint towards the root.
/// Frames come after the frames that carry them.
fn parent_frames(model: &Model) -> Vec<Option<usize>> {
    let mut first_of_joint: Vec<Option<usize>> = vec![None; model.joints().len()];
    let mut parents = Vec::with_capacity(model.frames().len());
    for (index, frame) in model.frames().iter().enumerate() {
        let above = std::iter::successors(frame.joint, |joint: &JointId| {
            model.joints()[joint.index()].parent
        });
        let mut carriers = above.filter_map(|joint| first_of_joint[joint.index()]);
        parents.push(carriers.next());
        if let Some(joint) = frame.joint {
            first_of_joint[joint.index()].get_or_insert(index);
        }
    }
    parents
}
