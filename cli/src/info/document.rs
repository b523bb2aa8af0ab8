//! Report of a model, as a JSON document.

use std::collections::BTreeSet;

use kinopt::io::rig::Rig;
use kinopt::model::{Joint, JointId};
use kinopt::skeleton::BoneId;
use serde::Serialize;

use super::cone::ConeDocument;
use super::robot::{self, PlaceDocument, RobotDocument};
use crate::loaded_model::LoadedModel;

#[derive(Serialize)]
pub(super) struct Document<'a> {
    pub(super) file: &'a str,
    pub(super) kind: &'static str,
    pub(super) degrees_of_freedom: usize,
    pub(super) free: usize,
    pub(super) size: f64,
    pub(super) joints: Vec<JointDocument<'a>>,
    pub(super) frames: Vec<&'a str>,
    #[serde(flatten)]
    pub(super) rig: Option<RigDocument<'a>>,
    #[serde(flatten)]
    pub(super) robot: Option<RobotDocument<'a>>,
}

#[derive(Serialize)]
pub(super) struct JointDocument<'a> {
    pub(super) name: &'a str,
    pub(super) kind: &'static str,
    /// Index in a configuration; `None` for a fixed joint.
    pub(super) coordinate: Option<usize>,
    pub(super) free: bool,
    /// Limits in radians or metres; `None` without a limit.
    pub(super) lower: Option<f64>,
    pub(super) upper: Option<f64>,
    /// Limits of a ball joint; `None` if it rotates freely.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) cone: Option<ConeDocument>,
    /// Only for robots.
    #[serde(flatten)]
    pub(super) place: Option<PlaceDocument<'a>>,
}

#[derive(Serialize)]
pub(super) struct RigDocument<'a> {
    pub(super) bones: Vec<BoneDocument<'a>>,
    pub(super) mesh: Option<MeshDocument>,
    pub(super) weights: Option<WeightsDocument>,
    pub(super) keyframes: Option<KeyframesDocument>,
    pub(super) constrained: Vec<&'a str>,
    /// Notes of the reader.
    pub(super) notes: Vec<String>,
}

#[derive(Serialize)]
pub(super) struct BoneDocument<'a> {
    pub(super) name: &'a str,
    pub(super) parent: Option<&'a str>,
    pub(super) length: f64,
    pub(super) rest_tail: [f64; 3],
    pub(super) rest_tip: [f64; 3],
}

#[derive(Serialize)]
pub(super) struct MeshDocument {
    pub(super) vertices: usize,
    pub(super) triangles: usize,
    pub(super) normals: bool,
    pub(super) closed: bool,
    pub(super) bounding_box: Option<[[f32; 3]; 2]>,
}

#[derive(Serialize)]
pub(super) struct WeightsDocument {
    pub(super) max_influences: usize,
}

#[derive(Serialize)]
pub(super) struct KeyframesDocument {
    pub(super) bones: usize,
    pub(super) keys: usize,
    /// Start and end in seconds.
    pub(super) start: f64,
    pub(super) end: f64,
    /// Interpolations of the tracks, by name.
    pub(super) interpolation: Vec<&'static str>,
}

/// Content of a model.
pub(super) fn document(loaded: &LoadedModel) -> Document<'_> {
    let (model, robot) = (&loaded.model, loaded.robot.as_deref());
    let free = loaded.free_coordinates();
    let moving = model.moving_joints().iter().enumerate();
    let moving = moving.filter(|&(coordinate, id)| model.coordinate(*id) == Some(coordinate));
    let moving = moving.filter_map(|(coordinate, id)| {
        let joint = model.joints().get(id.index())?;
        let free = free.get(coordinate).copied().unwrap_or(false);
        Some(joint_document(loaded, *id, joint, Some(coordinate), free))
    });
    let fixed = model.joint_ids().zip(model.joints());
    let fixed = fixed.filter(|(_, joint)| !joint.kind.moves());
    let fixed = fixed.map(|(id, joint)| joint_document(loaded, id, joint, None, false));
    Document {
        file: &loaded.file,
        kind: loaded.kind(),
        degrees_of_freedom: model.degrees_of_freedom(),
        free: loaded.parameters().variables(),
        size: loaded.size(),
        joints: moving.chain(fixed).collect(),
        frames: loaded.frame_names(),
        rig: loaded.rig.as_deref().map(rig_document),
        robot: robot.map(|robot| robot::document(loaded, robot)),
    }
}

fn joint_document<'a>(
    loaded: &'a LoadedModel,
    id: JointId,
    joint: &'a Joint,
    coordinate: Option<usize>,
    free: bool,
) -> JointDocument<'a> {
    let finite = |limit: f64| limit.is_finite().then_some(limit);
    let (limited, robot) = (coordinate.is_some(), loaded.robot.as_deref());
    JointDocument {
        name: &joint.name,
        kind: joint.kind.name(),
        coordinate,
        free,
        lower: finite(joint.limits.lower).filter(|_| limited),
        upper: finite(joint.limits.upper).filter(|_| limited),
        cone: ConeDocument::of(joint),
        place: robot.map(|robot| robot::joint_place(robot, id, joint)),
    }
}

fn rig_document(rig: &Rig) -> RigDocument<'_> {
    let bones = rig.skeleton.bones();
    let name = |bone: BoneId| Some(bones.get(bone.index())?.name.as_str());
    RigDocument {
        bones: bones
            .iter()
            .map(|bone| BoneDocument {
                name: &bone.name,
                parent: bone.parent.and_then(name),
                length: bone.length,
                rest_tail: bone.rest_tail().to_array(),
                rest_tip: bone.rest_tip().to_array(),
            })
            .collect(),
        mesh: rig.mesh.as_ref().map(|mesh| MeshDocument {
            vertices: mesh.positions().len(),
            triangles: mesh.triangles().len(),
            normals: !mesh.normals().is_empty(),
            closed: mesh.is_closed(),
            bounding_box: mesh
                .bounding_box()
                .map(|ends| ends.map(|end| end.to_array())),
        }),
        weights: rig.weights.as_ref().map(|weights| WeightsDocument {
            max_influences: weights.max_influences(),
        }),
        keyframes: rig.clip.time_span().map(|[start, end]| KeyframesDocument {
            bones: rig.clip.tracks().len(),
            keys: rig.clip.tracks().iter().map(|t| t.keys.len()).sum(),
            start,
            end,
            interpolation: interpolation(rig),
        }),
        constrained: rig.constrained.iter().copied().filter_map(name).collect(),
        notes: rig.notes.iter().map(ToString::to_string).collect(),
    }
}

/// Names of the interpolations of the rig's tracks.
fn interpolation(rig: &Rig) -> Vec<&'static str> {
    let tracks = rig.clip.tracks().iter();
    let names = tracks.map(|track| rig.clip.interpolation(track.bone).name());
    names.collect::<BTreeSet<_>>().into_iter().collect()
}
