//! Mesh of a robot: its collision shapes.

use glam::{DAffine3, DVec3};
use kinopt::collision::CollisionModel;
use kinopt::spatial::Placement;

use super::shape_mesh::ShapeMesh;
use crate::Failure;
use crate::render::Scene;

/// Meshes on the links of a robot.
pub(super) struct RobotMesh {
    parts: Vec<Part>,
}

struct Part {
    /// Index of the link among the frames of the model.
    link: usize,
    link_from_shape: DAffine3,
    mesh: ShapeMesh,
}

impl RobotMesh {
    pub(super) fn new(model: &CollisionModel) -> Result<Self, Failure> {
        let parts = model.objects().iter().map(|object| {
            Ok(Part {
                link: object.link.index(),
                link_from_shape: object.link_from_shape.into(),
                mesh: ShapeMesh::new(&object.shape)?,
            })
        });
        Ok(Self {
            parts: parts.collect::<Result<_, Failure>>()?,
        })
    }

    /// Adds the robot to a scene, from the placements of all frames of its model.
    pub(super) fn add_to(
        &self,
        scene: &mut Scene,
        placements: &[Placement<f64>],
        scene_from_world: DAffine3,
        colour: DVec3,
    ) {
        for part in &self.parts {
            let world_from_link = DAffine3::from(placements[part.link]);
            let scene_from_shape = scene_from_world * world_from_link * part.link_from_shape;
            part.mesh.add_to(scene, scene_from_shape, colour);
        }
    }
}
