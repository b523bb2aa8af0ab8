//! Mesh of a captured person: a capsule for each bone.

use glam::{DAffine3, DQuat, DVec3};
use kinopt::animation::Armature;
use kinopt::collision::Shape;
use kinopt::motion::retarget::Capture;
use kinopt::spatial::Vector3;

use super::shape_mesh::ShapeMesh;
use crate::Failure;
use crate::render::Scene;

/// Radius of the bone that starts at a joint, centimetres: the first entry whose word the joint's name contains.
const RADII: [(&str, f64); 11] = [
    ("Spine1", 11.5),
    ("Spine", 11.0),
    ("Hips", 10.0),
    ("Neck", 5.0),
    ("Head", 9.5),
    ("UpLeg", 7.5),
    ("Leg", 5.5),
    ("Foot", 3.5),
    ("ToeBase", 3.0),
    ("Shoulder", 6.5),
    ("ForeArm", 4.0),
];
/// Radius of all other bones, centimetres.
const OTHER_RADIUS: f64 = 4.5;

/// Capsules between the joints of a capture.
pub(super) struct PersonMesh {
    bones: Vec<Bone>,
}

struct Bone {
    /// Indices of the joints at both ends.
    ends: [usize; 2],
    mesh: ShapeMesh,
}

impl PersonMesh {
    /// Measures the bones in the first frame of a capture in centimetres.
    pub(super) fn new(armature: &Armature, capture: &Capture) -> Result<Self, Failure> {
        let positions = capture.frame(0).unwrap_or_default();
        let mut bones = Vec::new();
        for (index, bone) in armature.bone_ids().enumerate() {
            let Some(parent) = armature.parent(bone) else {
                continue;
            };
            let ends = [parent.index(), index];
            let [from, to] = ends.map(|end| DVec3::from(positions[end]));
            let name = &armature.names()[parent.index()];
            let entry = RADII.iter().find(|(word, _)| name.contains(word));
            let radius = entry.map_or(OTHER_RADIUS, |(_, radius)| *radius);
            let shape = Shape::capsule(radius, from.distance(to))?;
            let mesh = ShapeMesh::new(&shape)?;
            bones.push(Bone { ends, mesh });
        }
        Ok(Self { bones })
    }

    /// Adds the person to a scene, from the positions of the joints.
    pub(super) fn add_to(
        &self,
        scene: &mut Scene,
        positions: &[Vector3<f64>],
        scene_from_capture: DAffine3,
        colour: DVec3,
    ) {
        for bone in &self.bones {
            let [from, to] = bone.ends.map(|end| DVec3::from(positions[end]));
            let turn = DQuat::from_rotation_arc(DVec3::Z, (to - from).normalize_or(DVec3::Z));
            let capture_from_bone = DAffine3::from_rotation_translation(turn, from.midpoint(to));
            bone.mesh
                .add_to(scene, scene_from_capture * capture_from_bone, colour);
        }
    }
}
