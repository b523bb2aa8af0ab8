//! Promise: placements, nalgebra's isometries and glam's affine maps convert into each other, and non-rigid maps are
//! rejected.

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

fn difference(a: &Placement<f64>, b: &Placement<f64>) -> f64 {
    let columns = |p: &Placement<f64>| [p.rotation.x, p.rotation.y, p.rotation.z, p.translation];
    let pairs = columns(a).into_iter().zip(columns(b));
    pairs.map(|(a, b)| (a - b).norm()).fold(0.0, f64::max)
}

#[test]
fn conversions_round_trip() {
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
        assert!(difference(&Placement::try_from(double).unwrap(), &placement) < 1e-14);
        assert!(difference(&Placement::from(isometry), &placement) < 1e-14);
        let back = Placement::try_from(single).unwrap();
        assert!(difference(&back, &placement) < 1e-6);
        // Rigid in double precision although it came from single.
        assert!(back.check_rigid(1e-14).is_ok());
        let turn = glam::DQuat::from_mat3(&double.matrix3);
        let [single, double] = [Matrix3::from(turn.as_quat()), Matrix3::from(turn)];
        let turned = Placement::new(single, Vector3::zero());
        assert!(turned.check_rigid(1e-14).is_ok());
        assert!(difference(&turned, &Placement::new(double, Vector3::zero())) < 1e-6);
    }
}

#[test]
fn non_rigid_maps_are_rejected() {
    let shear = Affine3A::from_mat3(glam::Mat3::from_cols(
        Vec3::X,
        Vec3::new(0.01, 1.0, 0.0),
        Vec3::Z,
    ));
    for (map, reason) in [
        (Affine3A::from_scale(Vec3::splat(1.001)), "orthonormal"),
        (shear, "orthonormal"),
        (
            Affine3A::from_scale(Vec3::new(1.0, -1.0, 1.0)),
            "reflection",
        ),
        (
            Affine3A::from_translation(Vec3::new(f32::NAN, 0.0, 0.0)),
            "row 0, column 3 of its 4 x 4 matrix is NaN",
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

#[test]
fn vectors_and_rotations_convert() {
    let [x, y, z] = [0.25, -1.5, 3.0];
    let vector = Vector3::new(x, y, z);
    let glams = DVec3::new(x, y, z);
    let theirs = nalgebra::Vector3::new(x, y, z);
    assert_eq!(Vector3::from(glams), vector);
    assert_eq!(Vector3::from(glams.as_vec3()), vector);
    assert_eq!(Vector3::from(glam::Vec3A::from(glams.as_vec3())), vector);
    assert_eq!(Vector3::from(theirs), vector);
    assert_eq!(Vector3::from(nalgebra::Point3::from(theirs)), vector);
    assert_eq!(DVec3::from(vector), glams);
    assert_eq!(
        nalgebra::Point3::from(vector),
        nalgebra::Point3::from(theirs)
    );

    let mut random = Random::new(8);
    let deviation_of = |a: Matrix3<f64>, b: Matrix3<f64>| {
        let [a, b] = [a, b].map(|rotation| Placement::new(rotation, Vector3::zero()));
        difference(&a, &b)
    };
    for _ in 0..200 {
        let turn = any(&mut random).rotation;
        let theirs = nalgebra::Matrix3::from(turn);
        let by_matrix = nalgebra::Rotation3::from_matrix_unchecked(theirs);
        let quaternion = nalgebra::UnitQuaternion::from_rotation_matrix(&by_matrix);
        let glams = glam::DMat3::from(turn);
        let glams_quaternion = glam::DQuat::from_mat3(&glams);
        assert_eq!(Matrix3::from(theirs), turn);
        assert_eq!(Matrix3::from(by_matrix), turn);
        assert_eq!(Matrix3::from(glams), turn);
        assert!(deviation_of(quaternion.into(), turn) < 1e-14);
        assert!(deviation_of(glams_quaternion.into(), turn) < 1e-14);
        assert!(deviation_of(glams_quaternion.as_quat().into(), turn) < 1e-6);
        let placement = Placement::from(quaternion);
        assert!(difference(&placement, &Placement::new(turn, Vector3::zero())) < 1e-14);
    }
}

#[test]
fn builders_accept_types_of_both_crates() {
    use kinopt::model::{Limits, Model};
    let mut models = Vec::new();
    let limits = Limits::new(-1.0, 1.0);
    let mut builder = Model::builder("one arm");
    let joint = builder.revolute("joint", None, Isometry3::identity(), DVec3::Z, limits);
    builder.frame(
        "tip",
        Some(joint),
        nalgebra::Translation3::new(0.5, 0.0, 0.0),
    );
    models.push(builder.build().unwrap());
    let mut builder = Model::builder("one arm");
    let axis = nalgebra::Vector3::z_axis();
    let joint = builder.revolute("joint", None, Placement::identity(), axis, limits);
    builder.frame("tip", Some(joint), Vector3::new(0.5, 0.0, 0.0));
    models.push(builder.build().unwrap());
    assert_eq!(models[0].joints(), models[1].joints());
    assert_eq!(models[0].frames(), models[1].frames());
}
