//! Promise: placements, nalgebra's isometries and glam's affine maps are the same motions; what is no
//! rigid motion is refused.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use glam::{Affine3A, DAffine3, DVec3, Vec3};
use kinopt::spatial::{Matrix3, Placement, Vector3};
use nalgebra::Isometry3;
use support::random::Random;

fn any(random: &mut Random) -> Placement<f64> {
    let axis = Vector3::from(random.vector(1.0).data.0[0]);
    let axis = axis * axis.norm().recip();
    let turn = Matrix3::rotation(axis, random.within(-3.0, 3.0).sin_cos());
    Placement::new(turn, Vector3::from(random.vector(2.0).data.0[0]))
}

fn apart(a: &Placement<f64>, b: &Placement<f64>) -> f64 {
    let columns = |p: &Placement<f64>| [p.rotation.x, p.rotation.y, p.rotation.z, p.translation];
    let pairs = columns(a).into_iter().zip(columns(b));
    pairs.map(|(a, b)| (a - b).norm()).fold(0.0, f64::max)
}

#[test]
fn there_and_back() {
    let mut random = Random::new(5);
    for _ in 0..500 {
        let placement = any(&mut random);
        let point = random.vector(1.0);
        let [x, y, z] = point.data.0[0];
        let moved = placement.apply(Vector3::new(x, y, z)).to_array();

        let double = DAffine3::from(placement);
        let by_glam = double.transform_point3(DVec3::new(x, y, z)).to_array();
        let isometry = Isometry3::from(placement);
        let by_nalgebra = (isometry * nalgebra::Point3::from(point)).coords.data.0[0];
        let single = Affine3A::from(placement);
        let by_single = single.transform_point3(Vec3::new(x as f32, y as f32, z as f32));
        for k in 0..3 {
            assert!((by_glam[k] - moved[k]).abs() < 1e-14);
            assert!((by_nalgebra[k] - moved[k]).abs() < 1e-14);
            assert!((f64::from(by_single[k]) - moved[k]).abs() < 2e-6);
        }
        assert!(apart(&Placement::try_from(double).unwrap(), &placement) < 1e-14);
        assert!(apart(&Placement::from(isometry), &placement) < 1e-14);
        let back = Placement::try_from(single).unwrap();
        assert!(apart(&back, &placement) < 1e-6);
        // Rigid in double precision though it came from single.
        assert!(back.check_rigid(1e-14).is_ok());
    }
}

#[test]
fn what_is_not_rigid_is_refused() {
    let shear = Affine3A::from_mat3(glam::Mat3::from_cols(
        Vec3::X,
        Vec3::new(0.01, 1.0, 0.0),
        Vec3::Z,
    ));
    for (map, reason) in [
        (Affine3A::from_scale(Vec3::splat(1.001)), "orthonormal"),
        (shear, "orthonormal"),
        (Affine3A::from_scale(Vec3::new(1.0, -1.0, 1.0)), "mirrors"),
        (
            Affine3A::from_translation(Vec3::new(f32::NAN, 0.0, 0.0)),
            "not finite",
        ),
    ] {
        let error = Placement::try_from(map).unwrap_err().to_string();
        assert!(
            error.contains("not a rigid motion") && error.contains(reason),
            "{error}"
        );
    }
    let large = DAffine3::from_scale(DVec3::splat(1.0 + 1e-5));
    assert!(Placement::try_from(large).is_err());
}
