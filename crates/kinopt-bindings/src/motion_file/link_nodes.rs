//! Motions in glTF files: nodes with the names of the robot's links.

use std::f64::consts::TAU;
use std::path::Path;

use kinopt::animation::{Armature, Clip, Cursor, Playback};
use kinopt::io::gltf;
use kinopt::model::{JointId, Model, SegmentKind};
use kinopt::motion::retarget::UpAxis;
use kinopt::robot::Robot;
use kinopt::spatial::{Placement, Quaternion, Vector3, rotation_log};

use super::{MotionFileError, MotionReading, RobotMotion, SCENE_RATE};

pub(super) fn read(
    robot: &Robot,
    path: &Path,
    reading: &MotionReading<'_>,
) -> Result<RobotMotion, MotionFileError> {
    let scene = gltf::read(path)?;
    let error = |problem: String| MotionFileError::new(path, problem);
    let clip = match reading.clip {
        Some(name) => {
            Clip::named(&scene.clips, name).map_err(|unknown| error(unknown.to_string()))?
        }
        None => scene
            .clips
            .first()
            .ok_or_else(|| error("no clip".to_owned()))?,
    };
    let nodes = LinkNodes::new(robot.model(), &scene.armature).map_err(error)?;
    let rate = reading.frame_rate.unwrap_or(SCENE_RATE);
    let frames = (clip.duration() * rate + 0.5).floor() as usize + 1;
    let mut pose = scene.armature.rest().clone();
    let mut cursor = Cursor::new();
    let mut model_from_bone = scene.armature.rest_from_model().to_vec();
    let mut q: Vec<f64> = Vec::new();
    let mut previous = robot.model().neutral();
    for frame in 0..frames {
        let time = clip.start() + frame as f64 / rate;
        let sampled = clip.sample(time, Playback::Hold, &mut cursor, &mut pose);
        sampled.map_err(|problem| error(problem.to_string()))?;
        let placed = scene.armature.local_to_model(&pose, &mut model_from_bone);
        placed.map_err(|problem| error(problem.to_string()))?;
        let placements = model_from_bone.iter().map(|bone| {
            let [x, y, z] = [bone.x_axis, bone.y_axis, bone.z_axis]
                .map(|axis| Vector3::from(axis.as_dvec3().normalize_or_zero().to_array()));
            let at = Vector3::from(bone.translation.as_dvec3().to_array());
            Placement::new(kinopt::spatial::Matrix3::from_columns(x, y, z), at)
        });
        let placements: Vec<_> = placements.collect();
        let row = nodes.configuration(robot.model(), &placements, &previous);
        q.extend_from_slice(&row);
        previous = row;
    }
    Ok(RobotMotion {
        q,
        frame_rate: Some(rate),
    })
}

/// Nodes of the joints of a model.
struct LinkNodes {
    /// For each joint, a node with the name of a frame on it, and the placement of that frame on the joint.
    of_joints: Vec<Option<(usize, Placement<f64>)>>,
}

impl LinkNodes {
    /// Finds the nodes.
    ///
    /// # Errors
    /// Returns a message with the links of moving joints that have no node.
    fn new(model: &Model, armature: &Armature) -> Result<Self, String> {
        let mut of_joints = vec![None; model.joints().len()];
        for frame in model.frames() {
            let Some(joint) = frame.joint else { continue };
            let node = armature.names().iter().position(|name| *name == frame.name);
            let place = &mut of_joints[joint.index()];
            if let (Some(node), None) = (node, &place) {
                *place = Some((node, frame.joint_from_frame));
            }
        }
        // The translations of a free joint carry no links.
        let ends = model
            .segments()
            .iter()
            .map(|segment| last_joint(model, segment.coordinate, segment.kind));
        let missing = ends.filter(|joint| of_joints[joint.index()].is_none());
        let missing: Vec<&str> = missing
            .map(|joint| model.joints()[joint.index()].name.as_str())
            .collect();
        match missing.is_empty() {
            true => Ok(Self { of_joints }),
            false => Err(format!(
                "no nodes with the names of the links of: {}",
                missing.join(", ")
            )),
        }
    }

    /// Configuration of a model from the placements of all nodes. A joint that rotates without limits is nearest to its
    /// value in `previous`.
    fn configuration(
        &self,
        model: &Model,
        placements: &[Placement<f64>],
        previous: &[f64],
    ) -> Vec<f64> {
        let upright = Placement::new(UpAxis::Y.turned_to_z(), Vector3::zero());
        let mut q = vec![0.0; model.configuration_len()];
        let mut world_from_joint: Vec<Placement<f64>> = Vec::with_capacity(model.joints().len());
        for (index, joint) in model.joints().iter().enumerate() {
            let parent = joint.parent.map_or_else(Placement::identity, |parent| {
                world_from_joint[parent.index()]
            });
            world_from_joint.push(match &self.of_joints[index] {
                Some((node, joint_from_frame)) => {
                    upright * placements[*node] * joint_from_frame.inverse()
                }
                None => parent * joint.parent_from_joint,
            });
        }
        for segment in model.segments() {
            let coordinate = segment.coordinate;
            let first = model.moving_joints()[coordinate];
            let last = last_joint(model, coordinate, segment.kind);
            let joint = &model.joints()[first.index()];
            let parent = joint.parent.map_or_else(Placement::identity, |parent| {
                world_from_joint[parent.index()]
            });
            let moved =
                (parent * joint.parent_from_joint).inverse() * world_from_joint[last.index()];
            match segment.kind {
                SegmentKind::Scalar if joint.kind.slides() => {
                    q[coordinate] = moved.translation.dot(joint.axis)
                }
                SegmentKind::Scalar => {
                    let angle = rotation_log(&moved.rotation).dot(joint.axis);
                    let turns = ((previous[coordinate] - angle) / TAU).round();
                    q[coordinate] = angle + TAU * turns;
                }
                SegmentKind::Ball => write_rotation(&moved, &mut q[coordinate..]),
                SegmentKind::Free => {
                    q[coordinate..coordinate + 3].copy_from_slice(&moved.translation.to_array());
                    write_rotation(&moved, &mut q[coordinate + 3..]);
                }
            }
        }
        q
    }
}

/// Joint that carries the links of a segment: for a free joint the ball joint after its translations.
fn last_joint(model: &Model, coordinate: usize, kind: SegmentKind) -> JointId {
    let offset = match kind {
        SegmentKind::Free => 3,
        _ => 0,
    };
    model.moving_joints()[coordinate + offset]
}

/// Writes the quaternion w, x, y, z of a placement.
fn write_rotation(placement: &Placement<f64>, to: &mut [f64]) {
    let Quaternion { w, v } = Quaternion::from_matrix(&placement.rotation);
    to[..4].copy_from_slice(&[w, v.x, v.y, v.z]);
}
