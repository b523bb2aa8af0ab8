//! Promise: so it is for placements that come from other crates and go to them, and for maps that are nearly rigid.
#![allow(clippy::unwrap_used)]

use glam::{Affine3A, DAffine3, DMat3, DQuat, DVec3, Quat, Vec3, Vec3A};
use kinopt::spatial::{Matrix3, Placement, Quaternion, Vector3};
use nalgebra as na;
use support::random::Random;

use crate::digest::{Digest, Value, check};
use crate::every_joint::place;

fn conversions() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(103));
    for _ in 0..12 {
        let own = place(&mut random, 1.0);
        let other = place(&mut random, 2.0);
        digest.placement(&(own * other));
        digest.placement(&own.inverse());
        digest.doubles(own.apply(other.translation).to_array());
        let isometry = na::Isometry3::from(own);
        digest.placement(&Placement::from(isometry));
        digest.placement(&Placement::from(&isometry));
        digest.placement(&Placement::from(isometry.rotation));
        digest.placement(&Placement::from(isometry.translation));
        digest.placement(&Placement::from(own.translation));
        let double = DAffine3::from(own);
        let single = Affine3A::from(own);
        digest.placement(&Placement::try_from(double).unwrap());
        digest.singles(single.to_cols_array());
        digest.placement(&Placement::try_from(single).unwrap());
        let v = own.translation;
        let vectors: [Vector3<f64>; 6] = [
            na::Vector3::from(v).into(),
            na::Point3::from(v).into(),
            DVec3::from(v).into(),
            DVec3::from(v).as_vec3().into(),
            Vec3A::from(DVec3::from(v).as_vec3()).into(),
            na::UnitVector3::new_unchecked(na::Vector3::from(v)).into(),
        ];
        vectors.iter().for_each(|v| digest.doubles(v.to_array()));
        let q = Quaternion::from_matrix(&own.rotation);
        let glam = DQuat::from(q);
        let matrices: [Matrix3<f64>; 7] = [
            na::Matrix3::from(own.rotation).into(),
            na::Rotation3::from_matrix_unchecked(na::Matrix3::from(own.rotation)).into(),
            isometry.rotation.into(),
            DMat3::from(own.rotation).into(),
            glam.into(),
            Quat::from_array(glam.as_quat().to_array()).into(),
            q.into(),
        ];
        for m in matrices {
            digest.placement(&Placement::new(m, v));
        }
        let quaternions: [Quaternion<f64>; 3] =
            [isometry.rotation.into(), glam.into(), glam.as_quat().into()];
        for q in quaternions {
            digest.doubles([q.w, q.v.x, q.v.y, q.v.z]);
        }
    }
    digest.value()
}

/// Maps that are nearly rigid, and that are not.
fn rigid() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(104));
    for off in [
        0.0,
        1e-16,
        1e-15,
        1e-13,
        4e-7,
        9e-7,
        3e-6,
        4e-5,
        2e-4,
        0.1,
        f64::NAN,
    ] {
        for entry in 0..12 {
            let mut own = place(&mut random, 1.0);
            let Placement {
                rotation,
                translation,
            } = &mut own;
            let parts = [
                &mut rotation.x,
                &mut rotation.y,
                &mut rotation.z,
                translation,
            ];
            let v = &mut *parts.into_iter().nth(entry / 3).unwrap();
            let part = [&mut v.x, &mut v.y, &mut v.z].into_iter().nth(entry % 3);
            *part.unwrap() += off;
            for tolerance in [1e-12, 1e-6, 1e-3] {
                digest.refusal(own.check_rigid(tolerance));
            }
            for taken in [
                Placement::try_from(DAffine3::from(own)),
                Placement::try_from(Affine3A::from(own)),
            ] {
                match taken {
                    Ok(taken) => digest.placement(&taken),
                    Err(error) => digest.refusal(Err::<(), _>(error)),
                }
            }
        }
    }
    let mut mirror = place(&mut random, 1.0);
    mirror.rotation.y = -mirror.rotation.y;
    digest.refusal(mirror.check_rigid(1e-6));
    mirror.rotation.x = mirror.rotation.x * 2.0;
    digest.refusal(mirror.check_rigid(1e-6));
    digest.refusal(Placement::try_from(Affine3A::from_scale(Vec3::new(
        1.0, 2.0, 1.0,
    ))));
    let far = Placement::translation([1.0, f64::INFINITY, 0.0].into());
    digest.refusal(far.check_rigid(1e-6));
    digest.value()
}

#[test]
fn of_placements() {
    check(&[
        ("placements from and to other crates", conversions()),
        ("maps that are nearly rigid", rigid()),
    ]);
}
