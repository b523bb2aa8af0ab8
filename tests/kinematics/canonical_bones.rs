//! Promise: a bone bends and twists in its canonical frame, for any rest placement. The rest's twist selects the
//! bending direction and moves neither end. Twist, bend and twist give any rotation.

use std::f64::consts::FRAC_PI_2;

use glam::{DMat3, DVec3};
use kinopt::animation::rotation::EulerOrder;
use kinopt::model::Limits;
use kinopt::skeleton::{Bone, BoneId, Skeleton};
use nalgebra as na;
use support::random::Random;
use support::{Rigid, placement, rigid};

const LENGTH: f64 = 0.7;

fn one_bone(rest: &Rigid) -> (Skeleton, BoneId) {
    let mut builder = Skeleton::builder("one bone");
    let bone = builder.add(Bone {
        name: "bone".into(),
        parent: None,
        length: LENGTH,
        model_from_rest: placement(rest),
        limits: [Limits::UNBOUNDED; 3],
    });
    (builder.build().unwrap(), bone)
}

fn about(axis: usize, angle: f64) -> na::Rotation3<f64> {
    na::Rotation3::new(na::Vector3::ith(axis, angle))
}

fn turn(axis: usize, angle: f64) -> Rigid {
    rigid(about(axis, angle), na::Vector3::zeros())
}

fn tip(skeleton: &Skeleton, bone: BoneId, q: &[f64]) -> na::Point3<f64> {
    na::Vector3::from(skeleton.pose(q).unwrap().tip(skeleton, bone).unwrap()).into()
}

#[test]
fn canonical_bone_is_along_x() {
    let (canonical, bone) = one_bone(&Rigid::identity());
    assert_eq!(canonical.bones()[0].rest_tail().to_array(), [0.0; 3]);
    assert_eq!(
        canonical.bones()[0].rest_tip().to_array(),
        [LENGTH, 0.0, 0.0]
    );
    // Bending rotates about z: the tip moves towards y.
    let bent = tip(&canonical, bone, &[0.0, FRAC_PI_2, 0.0]);
    assert!((bent - na::Point3::new(0.0, LENGTH, 0.0)).amax() < 1e-15);

    // The translation of T̂ is the tail, and T̂ (ℓ, 0, 0, 1) the tip.
    let mut random = Random::new(1);
    let rest = rigid(random.rotation(), random.vector(2.0));
    let (placed, _) = one_bone(&rest);
    let tail = na::Vector3::from(placed.bones()[0].rest_tail());
    assert_eq!(tail, rest.translation.vector);
    let end = na::Vector3::from(placed.bones()[0].rest_tip());
    let expected = rest.rotation * na::Vector3::new(LENGTH, 0.0, 0.0) + tail;
    assert!((end - expected).amax() < 1e-15);
}

#[test]
fn rest_twist_rotates_bending_and_moves_no_end() {
    let mut random = Random::new(2);
    let rest = rigid(random.rotation(), random.vector(2.0));
    let (plain, bone) = one_bone(&rest);
    for twist in [0.4, -1.3, 3.0] {
        let (twisted, _) = one_bone(&(rest * turn(0, twist)));
        let [a, b] = [&plain, &twisted].map(|s| &s.bones()[0]);
        assert_eq!(a.rest_tail(), b.rest_tail());
        assert!((a.rest_tip() - b.rest_tip()).norm() < 1e-15);
        // The same bend has another direction: that of the plain bone after an equal twist.
        let bend = 0.8;
        let by_rest = tip(&twisted, bone, &[0.0, bend, 0.0]);
        let by_angle = tip(&plain, bone, &[0.0, bend, twist]);
        let untwisted = tip(&plain, bone, &[0.0, bend, 0.0]);
        assert!((by_rest - by_angle).amax() < 1e-14);
        assert!((by_rest - untwisted).amax() > 0.1);
    }
    // A first twist alone rotates about the bone: its ends are fixed.
    let spun = tip(&plain, bone, &[1.1, 0.0, 0.0]);
    assert!((spun - tip(&plain, bone, &[0.0; 3])).amax() < 1e-15);
}

#[test]
fn bending_about_y_needs_a_quarter_twist() {
    let (skeleton, bone) = one_bone(&Rigid::identity());
    for angle in [0.3, -1.2, 2.5] {
        // R_y(β) = R_x(−90°) R_z(β) R_x(90°).
        let q = [FRAC_PI_2, angle, -FRAC_PI_2];
        let placed: na::Matrix3<f64> = skeleton.pose(&q).unwrap().model_from_bone[0]
            .rotation
            .into();
        assert!((placed - about(1, angle).into_inner()).amax() < 1e-15);
        let angles = EulerOrder::Xzx
            .from_matrix(&DMat3::from_rotation_y(angle))
            .angles;
        for outer in [angles[0], angles[2]] {
            assert!((outer.abs() - FRAC_PI_2).abs() < 1e-14, "{angles:?}");
        }
        assert!((tip(&skeleton, bone, &q).z + LENGTH * angle.sin()).abs() < 1e-15);
    }
}

#[test]
fn twist_bend_twist_gives_any_rotation() {
    let mut random = Random::new(3);
    let (skeleton, _) = one_bone(&Rigid::identity());
    for _ in 0..300 {
        let target = random.rotation().into_inner();
        let columns = [0, 1, 2].map(|k| DVec3::new(target[(0, k)], target[(1, k)], target[(2, k)]));
        let rotation = DMat3::from_cols(columns[0], columns[1], columns[2]);
        let [third, second, first] = EulerOrder::Xzx.from_matrix(&rotation).angles;
        let pose = skeleton.pose(&[first, second, third]).unwrap();
        let placed: na::Matrix3<f64> = pose.model_from_bone[0].rotation.into();
        assert!((placed - target).amax() < 1e-14);
    }
}
