//! Promise: so it is for what skin refuses and what it is made of: boxes around it, dual quaternions, handles, tubes.
#![allow(clippy::unwrap_used)]

use glam::{Affine3A, Mat3A, Quat, Vec3};
use kinopt::mesh::TriangleMesh;
use kinopt::skinning::{
    BoneBoxes, Deformation, DualQuaternion, DualQuaternionBlend, LinearBlend,
    PackedDualQuaternionBlend, PackedLinearBlend, PackedWeights, PointHandle, SkinWeights,
    SkinningMethod, single_precision_transform,
};
use kinopt::spatial::Placement;
use support::random::Random;
use support::twisted_tube::TwistedTube;

use crate::animated::{check_single, number, rotation, vector};
use crate::digest::{Digest, Value};
use crate::skins::{BONES, Skins, rigid};

fn refused() -> Value {
    let mut digest = Digest::new();
    let own = Skins::new(145);
    let with = |change: &dyn Fn(&mut Vec<Affine3A>)| {
        let mut changed = own.rigid.clone();
        change(&mut changed);
        changed
    };
    let short = with(&|all| all.truncate(BONES - 1));
    let nan = with(&|all| all[4].matrix3.y_axis.z = f32::NAN);
    let scaled = with(&|all| all[3].matrix3.x_axis *= 1.01);
    let sheared = with(&|all| all[2].matrix3.z_axis = all[2].matrix3.x_axis);
    let mirrored = with(&|all| all[1].matrix3.x_axis *= -1.0);
    let packed = PackedWeights::new(&own.few).unwrap();
    let mut pivots = own.pivots.clone();
    pivots[2].y = f32::NAN;
    for odd in [&short, &nan] {
        digest.refused(LinearBlend::new(&own.many, odd));
        digest.refused(PackedLinearBlend::new(&packed, odd));
    }
    for odd in [&short, &nan, &scaled, &sheared, &mirrored] {
        digest.refused(DualQuaternionBlend::new(&own.many, odd));
        digest.refused(PackedDualQuaternionBlend::new(&packed, odd));
    }
    for odd in [&short, &nan, &mirrored] {
        digest.refused(DualQuaternionBlend::stretched(&own.many, odd, &own.pivots));
        digest.refused(PackedDualQuaternionBlend::stretched(
            &packed,
            odd,
            &own.pivots,
        ));
    }
    digest.refused(DualQuaternionBlend::stretched(
        &own.many, &own.rigid, &pivots,
    ));
    digest.refused(DualQuaternionBlend::stretched(
        &own.many,
        &own.rigid,
        &pivots[1..],
    ));
    digest.refused(PackedWeights::new(&own.many));
    digest.refused(PackedWeights::new(
        &SkinWeights::builder(0, 65_537).build().unwrap(),
    ));
    let blend = LinearBlend::new(&own.few, &own.rigid).unwrap();
    let (positions, mut room) = (&own.rest.positions, own.rest.clone());
    digest.refused(blend.positions(positions, &mut room.positions[1..]));
    digest.refused(blend.positions(&positions[1..], &mut room.positions[1..]));
    digest.refused(blend.normals(&[], &mut room.normals));
    digest.refused(blend.tangents(&own.rest.tangents, &mut []));
    let mesh = TriangleMesh::new(positions[1..].to_vec(), vec![], vec![]).unwrap();
    digest.refused(blend.mesh(&mesh));
    let mesh = TriangleMesh::new(positions.clone(), vec![], vec![]).unwrap();
    let huge = with(&|all| all[0].translation.x = f32::MAX);
    let far = with(&|all| all.iter_mut().for_each(|t| t.translation.x = f32::MAX));
    digest.debug(
        LinearBlend::new(&own.few, &huge)
            .unwrap()
            .mesh(&mesh)
            .is_ok(),
    );
    let doubled = with(&|all| all.iter_mut().for_each(|t| t.matrix3 *= f32::MAX));
    digest.debug(
        LinearBlend::new(&own.few, &far)
            .unwrap()
            .mesh(&mesh)
            .is_ok(),
    );
    digest.refused(LinearBlend::new(&own.few, &doubled).unwrap().mesh(&mesh));
    for odd in [Quat::from_xyzw(0.0, 0.0, 0.0, 0.0), Quat::NAN] {
        digest.refused(DualQuaternion::from_rotation_translation(odd, Vec3::ONE));
    }
    digest.refused(BoneBoxes::new(&own.few, &positions[1..]));
    let mut odd = positions.clone();
    odd[7].z = f32::INFINITY;
    digest.refused(BoneBoxes::new(&own.few, &odd));
    let boxes = BoneBoxes::new(&own.few, positions).unwrap();
    digest.refused(boxes.linear_blend(&short));
    digest.refused(boxes.linear_blend(&nan));
    digest.value()
}

fn parts() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(146));
    let own = Skins::new(147);
    for transforms in [&own.rigid, &own.stretched] {
        let boxes = BoneBoxes::new(&own.many, &own.rest.positions).unwrap();
        digest.debug(boxes.linear_blend(transforms).unwrap());
    }
    // A bone that moves nothing, and weights below 0.
    let mut builder = SkinWeights::builder(2, 3);
    builder.add(0, 0, 1.005).unwrap();
    builder.add(0, 2, -0.005).unwrap();
    builder.add(1, 2, 1.0).unwrap();
    let odd = builder.build().unwrap();
    let boxes = BoneBoxes::new(&odd, &own.rest.positions[..2]).unwrap();
    digest.debug(boxes.linear_blend(&own.rigid[..3]).unwrap());
    let none = SkinWeights::builder(0, 1).build().unwrap();
    digest.debug(
        BoneBoxes::new(&none, &[])
            .unwrap()
            .linear_blend(&own.rigid[..1])
            .unwrap(),
    );
    // Equal weights, where the first bone leads.
    let mut builder = SkinWeights::builder(1, 4);
    (0..4).for_each(|bone| builder.add(0, bone, 0.25).unwrap());
    let equal = builder.build().unwrap();
    let packed = PackedWeights::new(&equal).unwrap();
    for _ in 0..20 {
        let transforms: Vec<Affine3A> = (0..4).map(|_| rigid(&mut random)).collect();
        let any = DualQuaternionBlend::new(&equal, &transforms).unwrap();
        let packed = PackedDualQuaternionBlend::new(&packed, &transforms).unwrap();
        let mut out = [Vec3::ZERO];
        any.positions(&own.rest.positions[..1], &mut out).unwrap();
        digest.vector(out[0]);
        packed
            .positions(&own.rest.positions[..1], &mut out)
            .unwrap();
        digest.vector(out[0]);
    }
    for _ in 0..5 {
        let [p, v, at] = [(); 3].map(|()| Vec3::from(vector(&mut random, 2.0)));
        let turned = rotation(&mut random) * 3.0;
        let one = DualQuaternion::from_rotation_translation(turned, at).unwrap();
        let other = DualQuaternion::from_rotation_translation(rotation(&mut random), v).unwrap();
        let sum = one * 0.3 + other * 0.7;
        for motion in [one, other, sum] {
            digest.debug(motion);
            digest.vector(motion.transform_point(p));
            digest.vector(motion.transform_vector(v));
        }
        let linear = Mat3A::from_quat(turned.normalize()) * 1.5;
        let handle = PointHandle::at(p).moved_to(v).turned_by(linear);
        digest.affines(&PointHandle::transforms(&[handle, PointHandle::at(at)]));
        let placed =
            Placement::translation([0.1, f64::from(number(&mut random, 1.0)), 1e10].into());
        digest.affine(&single_precision_transform(&placed));
    }
    for tube in [
        TwistedTube::default(),
        TwistedTube {
            radius: 0.3,
            length: 2.0,
            blended_share: 0.0,
            sides: 2,
            rings: 1,
        },
        TwistedTube {
            sides: 5,
            rings: 4,
            blended_share: 0.8,
            ..TwistedTube::default()
        },
    ] {
        let (mesh, weights) = (tube.mesh().unwrap(), tube.weights().unwrap());
        let transforms = TwistedTube::transforms(2.0);
        digest.affines(&transforms);
        let posed = SkinningMethod::LinearBlend.mesh(&mesh, &weights, &transforms);
        let posed = posed.unwrap();
        digest.singles(posed.positions().iter().flat_map(|v| v.to_array()));
        digest.singles(posed.normals().iter().flat_map(|v| v.to_array()));
        digest.debug(posed.triangles());
        let radii = tube.ring_radii(&posed);
        digest.doubles(
            radii
                .into_iter()
                .flat_map(|(along, radius)| [along, radius]),
        );
    }
    let endless = TwistedTube {
        length: f64::INFINITY,
        blended_share: f64::NAN,
        ..TwistedTube::default()
    };
    digest.refused(endless.mesh());
    digest.value()
}

#[test]
fn of_parts_of_skin() {
    check_single(&[
        ("skin: what is refused", refused()),
        ("skin: what it is made of", parts()),
    ]);
}
