//! A rig's mesh in a pose.

use glam::DVec3;
use kinopt::io::rig::Rig;

use crate::Failure;
use crate::render::Scene;

/// Adds the rig's skin for the stacked angles `q` (radians), moved by `shift`.
pub(crate) fn add_posed(
    scene: &mut Scene,
    rig: &Rig,
    q: &[f64],
    shift: DVec3,
    colour: DVec3,
) -> Result<(), Failure> {
    let (Some(mesh), Some(weights)) = (&rig.mesh, &rig.weights) else {
        return Err("the rig has no skin".into());
    };
    let placements = rig.skeleton.pose(q);
    let turns: Vec<_> = placements.skinning_transforms(&rig.skeleton).collect();
    let posed = mesh
        .positions()
        .iter()
        .zip(weights.iter())
        .map(|(p, influences)| {
            let p = p.as_dvec3().to_array().into();
            let each = influences.iter();
            let sum: DVec3 = each
                .map(|i| DVec3::from_array(turns[i.bone as usize].apply(p).to_array()) * i.weight)
                .sum();
            sum + shift
        });
    let posed: Vec<DVec3> = posed.collect();
    let skin = mesh.with_vertices(posed.iter().map(|p| p.as_vec3()).collect(), Vec::new())?;
    let normals: Vec<DVec3> = skin.vertex_normals().iter().map(|n| n.as_dvec3()).collect();
    scene.add(&posed, &normals, mesh.triangles(), colour);
    Ok(())
}
