//! Mesh of a rig in a pose.

use glam::DVec3;
use kinopt::io::rig::Rig;
use kinopt::skeleton::BonePlacements;
use kinopt::skinning::{SkinningMethod, single_precision_transform};

use crate::Failure;
use crate::render::Scene;

/// Adds the rig's skin for the stacked angles `q` (radians), translated by `shift` (metres).
pub(crate) fn add_posed(
    scene: &mut Scene,
    rig: &Rig,
    q: &[f64],
    shift: DVec3,
    colour: DVec3,
) -> Result<(), Failure> {
    add_placed(scene, rig, &rig.skeleton.pose(q)?, shift, colour)
}

/// Adds the rig's skin for placed bones, translated by `shift` (metres).
pub(crate) fn add_placed(
    scene: &mut Scene,
    rig: &Rig,
    placements: &BonePlacements,
    shift: DVec3,
    colour: DVec3,
) -> Result<(), Failure> {
    let (Some(mesh), Some(weights)) = (&rig.mesh, &rig.weights) else {
        return Err("the rig has no skin".into());
    };
    let transforms = placements.skinning_transforms(&rig.skeleton);
    let transforms: Vec<_> = transforms.map(|t| single_precision_transform(&t)).collect();
    let skin = SkinningMethod::LinearBlend.mesh(mesh, weights, &transforms)?;
    let positions: Vec<DVec3> = skin
        .positions()
        .iter()
        .map(|p| p.as_dvec3() + shift)
        .collect();
    let normals: Vec<DVec3> = skin.vertex_normals().iter().map(|n| n.as_dvec3()).collect();
    scene.add(&positions, &normals, skin.triangles(), colour);
    Ok(())
}
