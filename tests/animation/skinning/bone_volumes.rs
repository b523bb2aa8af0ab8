//! Promise: the volume of a closed mesh is distributed to its bones by weight, to a thousandth of the whole. A rig's
//! masses and centre follow from it. Meshes without an inside are rejected.

use std::path::Path;
use support::twisted_tube::TwistedTube;

use glam::Vec3;
use kinopt::SizeMismatch;
use kinopt::io::rig::Rig;
use kinopt::kinematics::KinematicsError;
use kinopt::mesh::TriangleMesh;
use kinopt::model::ModelError;
use kinopt::skinning::{SkinWeights, SkinningError, bone_volumes};

/// Box between two corners, with its eight vertices indexed by bits x, y, z.
fn cuboid(low: [f32; 3], high: [f32; 3]) -> TriangleMesh {
    let corner = |bits: usize| {
        let side = |axis: usize| {
            if bits >> axis & 1 == 1 {
                high[axis]
            } else {
                low[axis]
            }
        };
        Vec3::new(side(0), side(1), side(2))
    };
    let triangles = vec![
        [0, 2, 1],
        [1, 2, 3],
        [4, 5, 6],
        [5, 7, 6],
        [0, 1, 4],
        [1, 5, 4],
        [2, 6, 3],
        [3, 6, 7],
        [0, 4, 2],
        [2, 4, 6],
        [1, 3, 5],
        [3, 7, 5],
    ];
    TriangleMesh::new((0..8).map(corner).collect(), Vec::new(), triangles).unwrap()
}

fn weights(weights_of: impl Fn(usize) -> [f64; 2], vertices: usize) -> SkinWeights {
    let mut builder = SkinWeights::builder(vertices, 2);
    for vertex in 0..vertices {
        for (bone, weight) in weights_of(vertex).into_iter().enumerate() {
            builder.add(vertex, bone, weight).unwrap();
        }
    }
    builder.build().unwrap()
}

fn assert_close(ours: f64, theirs: f64, within: f64) {
    assert!((ours - theirs).abs() < within, "{ours} {theirs}");
}

#[test]
fn box_volume_is_split_by_weights() {
    let mesh = cuboid([0.0, -1.0, 2.0], [4.0, 1.0, 3.0]);
    // One bone has all of it.
    let [all, none] = bone_volumes(&mesh, &weights(|_| [1.0, 0.0], 8)).unwrap()[..] else {
        panic!("two bones")
    };
    assert_close(all.volume, 8.0, 0.04);
    for (ours, theirs) in all.centre.to_array().into_iter().zip([2.0, 0.0, 2.5]) {
        assert_close(ours, theirs, 0.02);
    }
    assert_eq!((none.volume, none.centre.to_array()), (0.0, [0.0; 3]));
    // The weight changes linearly along x: ∫ x/4 = 1/2 each, with centres a third from either end.
    let over = weights(
        |vertex| {
            if vertex & 1 == 1 {
                [0.0, 1.0]
            } else {
                [1.0, 0.0]
            }
        },
        8,
    );
    let halves = bone_volumes(&mesh, &over).unwrap();
    for (half, x) in halves.iter().zip([4.0 / 3.0, 8.0 / 3.0]) {
        assert_close(half.volume, 4.0, 0.03);
        assert_close(half.centre.x, x, 0.02);
        assert_close(half.centre.y, 0.0, 0.02);
    }
    // And along the integration columns, as z is the narrowest axis.
    let over = weights(
        |vertex| {
            if vertex & 4 == 4 {
                [0.0, 1.0]
            } else {
                [1.0, 0.0]
            }
        },
        8,
    );
    let halves = bone_volumes(&mesh, &over).unwrap();
    for (half, z) in halves.iter().zip([7.0 / 3.0, 8.0 / 3.0]) {
        assert_close(half.volume, 4.0, 0.03);
        assert_close(half.centre.z, z, 0.02);
    }
}

#[test]
fn tube_volumes_sum_to_the_whole() {
    let tube = TwistedTube::default();
    let mesh = tube.mesh().unwrap();
    let volumes = bone_volumes(&mesh, &tube.weights().unwrap()).unwrap();
    let mesh_volume = mesh.signed_volume();
    assert_close(
        volumes.iter().map(|part| part.volume).sum(),
        mesh_volume,
        2e-3 * mesh_volume,
    );
    // Both ends are equal.
    assert_close(volumes[0].volume, volumes[1].volume, 2e-3 * mesh_volume);
    assert_close(volumes[0].centre.x + volumes[1].centre.x, tube.length, 0.02);
}

#[test]
fn open_mesh_is_rejected() {
    let closed_mesh = cuboid([0.0; 3], [1.0, 2.0, 3.0]);
    let (open, _) = closed_mesh.triangles().split_at(10);
    let open =
        TriangleMesh::new(closed_mesh.positions().to_vec(), Vec::new(), open.to_vec()).unwrap();
    let one = |vertices| weights(|_| [1.0, 0.0], vertices);
    assert_eq!(
        bone_volumes(&open, &one(8)).unwrap_err(),
        SkinningError::OpenMesh
    );
    let empty = TriangleMesh::new(Vec::new(), Vec::new(), Vec::new()).unwrap();
    assert_eq!(
        bone_volumes(&empty, &one(0)).unwrap_err(),
        SkinningError::OpenMesh
    );
    let flat = cuboid([0.0; 3], [1.0, 2.0, 0.0]);
    assert_eq!(
        bone_volumes(&flat, &one(8)).unwrap_err(),
        SkinningError::OpenMesh
    );
    let point = cuboid([1.0; 3], [1.0; 3]);
    assert_eq!(
        bone_volumes(&point, &one(8)).unwrap_err(),
        SkinningError::OpenMesh
    );
    let error = bone_volumes(&closed_mesh, &one(7)).unwrap_err();
    assert!(
        matches!(error, SkinningError::Size(SizeMismatch { .. })),
        "{error}"
    );
}

/// One column in a hundred may be open.
#[test]
fn small_hole_loses_only_its_own_volume() {
    let closed_mesh = cuboid([0.0; 3], [4.0, 4.0, 1.0]);
    for (side, is_open) in [(0.25_f32, false), (1.0, true)] {
        // A corner of the top is cut off.
        let mut corners = closed_mesh.positions().to_vec();
        corners.extend([Vec3::new(side, 0.0, 1.0), Vec3::new(0.0, side, 1.0)]);
        let rest = closed_mesh
            .triangles()
            .iter()
            .filter(|triangle| **triangle != [4, 5, 6]);
        let mut triangles: Vec<_> = rest.copied().collect();
        triangles.extend([[8, 5, 6], [8, 6, 9]]);
        let holed = TriangleMesh::new(corners, Vec::new(), triangles).unwrap();
        let volumes = bone_volumes(&holed, &weights(|_| [1.0, 0.0], 10));
        match is_open {
            true => assert_eq!(volumes.unwrap_err(), SkinningError::OpenMesh),
            false => assert_close(
                volumes.unwrap()[0].volume,
                16.0 - f64::from(side * side / 2.0),
                0.02,
            ),
        }
    }
}

#[test]
fn rig_mass_equals_mesh_volume() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../models/humanoid/humanoid.json");
    let rig = Rig::read(file).unwrap();
    let masses = rig.masses(1000.0).unwrap();
    let mesh_volume = rig.mesh.as_ref().unwrap().signed_volume();
    assert_close(masses.total() / 1000.0, mesh_volume, 5e-3 * mesh_volume);
    // At rest the centre is that of the mesh, by the divergence theorem.
    let mesh = rig.mesh.as_ref().unwrap();
    let mut moment = glam::DVec3::ZERO;
    for triangle in mesh.triangles() {
        let [a, b, c] = triangle.map(|corner| mesh.positions()[corner as usize].as_dvec3());
        moment += (a + b + c) / 4.0 * a.dot(b.cross(c)) / 6.0;
    }
    let rest = vec![0.0; rig.skeleton.model().configuration_len()];
    let centre = rig.centre_of_mass(&rest).unwrap();
    for (ours, theirs) in centre
        .to_array()
        .into_iter()
        .zip((moment / mesh_volume).to_array())
    {
        assert_close(ours, theirs, 3e-3 * mesh.size());
    }

    let invalid = rig.masses(-1.0).unwrap_err();
    assert!(matches!(invalid, ModelError::BadMass { .. }), "{invalid}");
    assert!(matches!(rig.masses(0.0), Err(ModelError::NoMass { .. })));
    let bare = Rig {
        mesh: None,
        ..rig.clone()
    };
    let error = bare.centre_of_mass(&rest).unwrap_err();
    assert!(
        matches!(error, KinematicsError::Masses(ModelError::NoVolume(_))),
        "{error}"
    );
}
