//! Promise: conversions between Euler angles of all twelve orders, axis and angle, quaternion and matrix are lossless,
//! also in and near gimbal lock.

use std::f64::consts::{FRAC_PI_2, PI};

use glam::{DMat3, DQuat, DVec3};
use kinopt::animation::rotation::{AxisAngle, EulerOrder};
use kinopt::model::Limits;
use kinopt::skeleton::{Bone, Skeleton};
use kinopt::spatial::Placement;
use support::random::Random;

fn apart(a: DQuat, b: DQuat) -> f64 {
    2.0 * (a.conjugate() * b).xyz().length().min(1.0).asin()
}

#[test]
fn euler_angles_round_trip_in_gimbal_lock() {
    let mut random = Random::new(11);
    for order in EulerOrder::ALL {
        let ends = if order.is_proper() {
            [0.0, PI]
        } else {
            [-FRAC_PI_2, FRAC_PI_2]
        };
        let middle = 0.5 * (ends[0] + ends[1]);
        for _ in 0..100 {
            let outer = [random.within(-PI, PI), random.within(-PI, PI)];
            let from_end = [0.0, 1e-15, 1e-12, 1e-9, 1e-8, 1e-7, 1e-5, 1e-3, 0.2, 1.0];
            for (distance, end) in from_end.iter().flat_map(|&d| ends.map(|end| (d, end))) {
                let beta = end + distance * (middle - end).signum();
                let angles = [outer[0], beta, outer[1]];
                let q = order.to_quaternion(angles);
                let actual = order.from_quaternion(q);
                // At the threshold itself rounding decides.
                if distance != 1e-9 {
                    assert_eq!(actual.gimbal_lock, distance < 1e-9);
                }
                let again = order.to_quaternion(actual.angles);
                let allowed = if actual.gimbal_lock { 2e-9 } else { 1e-14 };
                assert!(
                    apart(q, again) < allowed,
                    "{order:?} {angles:?}: {actual:?}"
                );
                assert!(actual.angles.iter().all(|angle| angle.abs() <= PI));
                // The negative quaternion of the same rotation.
                let other = order.from_quaternion(-q);
                assert!(other.angles.iter().all(|angle| angle.abs() <= PI));
                assert!(apart(q, order.to_quaternion(other.angles)) < allowed);
                let (low, high) = (ends[0] - 1e-12, ends[1] + 1e-12);
                assert!(low <= actual.angles[1] && actual.angles[1] <= high);
                if distance >= 0.2 {
                    for (a, b) in actual.angles.iter().zip(angles) {
                        assert!((a - b).abs() < 1e-13);
                    }
                }
                if actual.gimbal_lock {
                    assert_eq!(actual.angles[2], 0.0);
                }
            }
        }
    }
}

#[test]
fn euler_rotations_are_about_the_orders_axes() {
    for order in EulerOrder::ALL {
        let angles = [0.3, 0.4, -0.5];
        let turns = order.axes().into_iter().zip(angles);
        let product = turns.fold(DMat3::IDENTITY, |product, (axis, angle)| {
            let (sin, cos) = f64::sin_cos(angle);
            let (next, last) = ((axis + 1) % 3, (axis + 2) % 3);
            let mut turn = [[0.0; 3]; 3];
            turn[axis][axis] = 1.0;
            (turn[next][next], turn[last][last]) = (cos, cos);
            (turn[next][last], turn[last][next]) = (sin, -sin);
            product * DMat3::from_cols_array_2d(&turn)
        });
        assert!(order.to_matrix(angles).abs_diff_eq(product, 1e-15));
    }
}

#[test]
fn bone_angles_are_xzx_in_reverse() {
    let bone = Bone {
        name: "bone".into(),
        parent: None,
        length: 1.0,
        model_from_rest: Placement::identity(),
        limits: [Limits::UNBOUNDED; 3],
    };
    let skeleton = Skeleton::new("one bone", vec![bone]).unwrap();
    let [first, bend, second] = [0.7, -1.1, 0.4];
    let posed = skeleton
        .pose(&[first, bend, second])
        .unwrap()
        .model_from_bone[0]
        .rotation;
    let ours = EulerOrder::Xzx.to_matrix([second, bend, first]);
    for (column, ours) in [posed.x, posed.y, posed.z]
        .iter()
        .zip(ours.to_cols_array_2d())
    {
        for (a, b) in column.to_array().iter().zip(ours) {
            assert!((a - b).abs() < 1e-15);
        }
    }
}

#[test]
fn axis_angle_round_trips_at_all_angles() {
    let mut random = Random::new(12);
    for _ in 0..100 {
        let axis = DVec3::from(<[f64; 3]>::from(random.vector(1.0))).normalize();
        for angle in [1e-12, 1e-8, 1e-3, 1.0, 3.0, PI - 1e-8, PI - 1e-12] {
            let turn = AxisAngle { axis, angle };
            let back = AxisAngle::from_quaternion(turn.to_quaternion());
            assert!((back.to_rotation_vector() - axis * angle).length() < 2e-15 * (1.0 + angle));
            // A matrix near the identity contains the sine to rounding only.
            let back = AxisAngle::from_matrix(&turn.to_matrix());
            assert!((back.to_rotation_vector() - axis * angle).length() < 1e-14);
            assert!((back.axis.length() - 1.0).abs() < 1e-15);
            assert!(apart(turn.to_quaternion(), DQuat::from_mat3(&turn.to_matrix())) < 1e-15);
        }
    }
    // An axis of any length, as in the lecture's function.
    let third = AxisAngle::about(DVec3::new(0.0, 7.0, 0.0), 2.0 * PI / 3.0).unwrap();
    let expected = DQuat::from_xyzw(0.0, 0.75_f64.sqrt(), 0.0, 0.5);
    assert!(third.to_quaternion().abs_diff_eq(expected, 1e-15));
    for none in [DVec3::ZERO, DVec3::NAN] {
        assert_eq!(AxisAngle::about(none, 1.0), None);
    }
    assert_eq!(AxisAngle::from_quaternion(DQuat::IDENTITY).angle, 0.0);
    assert_eq!(AxisAngle::from_quaternion(-DQuat::IDENTITY).angle, 0.0);
}

#[test]
fn rotation_vector_is_unique_and_shortest() {
    let mut random = Random::new(13);
    for _ in 0..100 {
        let axis = DVec3::from(<[f64; 3]>::from(random.vector(1.0))).normalize();
        let angle = random.within(0.0, PI);
        let turn = AxisAngle { axis, angle };
        let others = [
            (-axis, -angle),
            (axis, angle + 2.0 * PI),
            (-axis, 2.0 * PI - angle),
        ];
        for (axis, angle) in others {
            let other = AxisAngle { axis, angle };
            assert!(other.to_matrix().abs_diff_eq(turn.to_matrix(), 1e-14));
        }
        // R_â(‖a‖), and back to the same three numbers.
        let a = turn.to_rotation_vector();
        let again = AxisAngle::from_rotation_vector(a);
        assert!(again.to_matrix().abs_diff_eq(turn.to_matrix(), 1e-15));
        let back = AxisAngle::from_matrix(&again.to_matrix()).to_rotation_vector();
        assert!((back - a).length() < 1e-12);
        // Slightly more than half a turn equals slightly less than half a turn in the other direction. The rotations
        // are close, and their vectors are a whole turn apart.
        let [less, more] = [PI - 1e-6, PI + 1e-6].map(|angle| AxisAngle { axis, angle });
        assert!(apart(less.to_quaternion(), more.to_quaternion()) < 2.1e-6);
        let [less, more] =
            [less, more].map(|t| AxisAngle::from_matrix(&t.to_matrix()).to_rotation_vector());
        assert!(((less - more).length() - 2.0 * PI).abs() < 1e-5);
    }
    let nothing = AxisAngle::from_rotation_vector(DVec3::ZERO);
    assert_eq!((nothing.axis, nothing.angle), (DVec3::X, 0.0));
}

#[test]
fn gimbal_lock_merges_two_angles() {
    // With β = 90° only α − γ counts; the third degree of freedom is lost.
    let locked = |alpha: f64, gamma: f64| EulerOrder::Zyx.to_matrix([gamma, FRAC_PI_2, alpha]);
    for shift in [0.1, -0.9, 2.0] {
        assert!(locked(0.3, 0.7).abs_diff_eq(locked(0.3 + shift, 0.7 + shift), 1e-15));
        assert!(!locked(0.3, 0.7).abs_diff_eq(locked(0.3 + shift, 0.7), 0.05));
    }
    let found = EulerOrder::Zyx.from_matrix(&locked(0.3, 0.7));
    assert!(found.gimbal_lock);
    assert!(
        EulerOrder::Zyx
            .to_matrix(found.angles)
            .abs_diff_eq(locked(0.3, 0.7), 1e-8)
    );
}
