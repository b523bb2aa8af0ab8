//! Promise: the rotation exponential and logarithm are inverse to 1e-12, in values and derivatives, at 0, near 0, near
//! π and at π.

use std::f64::consts::PI;

use kinopt::num_dual::DualSVec64;
use kinopt::scalar::Dual;
use kinopt::spatial::{Matrix3, Vector3, rotation_exp, rotation_log, rotation_log_jacobian};
use nalgebra as na;
use support::dual_numbers::DualNumber;
use support::random::Random;

const ANGLES: [f64; 19] = [
    0.0,
    1e-300,
    1e-160,
    1e-20,
    1e-12,
    1e-9,
    1e-8,
    1e-6,
    1e-4,
    1e-3,
    9.999e-3,
    1.0001e-2,
    0.3,
    1.0,
    2.0,
    3.0,
    PI - 1e-3,
    PI - 1e-7,
    PI - 1e-10,
];

fn axes() -> Vec<na::Vector3<f64>> {
    let mut random = Random::new(11);
    let mut axes: Vec<na::Vector3<f64>> = (0..20).map(|_| *random.direction()).collect();
    for k in 0..3 {
        axes.push(na::Vector3::ith(k, 1.0));
        axes.push(na::Vector3::ith(k, -1.0));
    }
    // The boundaries of Shepperd's four cases.
    axes.push(na::Vector3::new(1.0, 1.0, 0.0).normalize());
    axes.push(na::Vector3::new(1.0, -1.0, 1.0).normalize());
    axes
}

fn length(v: Vector3<f64>) -> f64 {
    na::Vector3::from(v).norm()
}

fn difference(a: Matrix3<f64>, b: na::Matrix3<f64>) -> f64 {
    (na::Matrix3::from(a) - b).amax()
}

/// ω with derivatives along x, y and z.
fn variables<D: DualNumber<3>>(omega: na::Vector3<f64>) -> Vector3<D> {
    Vector3::new(
        D::variable(omega.x, 0),
        D::variable(omega.y, 1),
        D::variable(omega.z, 2),
    )
}

/// ∂v/∂ω by rows.
fn jacobian<D: DualNumber<3>>(v: Vector3<D>) -> na::Matrix3<f64> {
    let rows = v.to_array().map(|c| na::RowVector3::from(c.derivatives()));
    na::Matrix3::from_rows(&rows)
}

#[test]
fn exponential_is_rotation_about_the_axis() {
    for axis in axes() {
        for angle in ANGLES.into_iter().chain([PI, 4.0, 2.0 * PI, 10.0]) {
            let ours = rotation_exp(Vector3::from(axis * angle));
            let unit = na::Unit::new_normalize(axis);
            let theirs = na::Rotation3::from_axis_angle(&unit, angle);
            assert!(
                difference(ours, theirs.into_inner()) < 2e-15,
                "{axis} {angle}"
            );
        }
    }
}

#[test]
fn logarithm_inverts_the_exponential() {
    for axis in axes() {
        for angle in ANGLES {
            let omega = axis * angle;
            let back = rotation_log(&rotation_exp(Vector3::from(omega)));
            let error = length(back - Vector3::from(omega));
            // Below half a turn the pair is the identity; tiny vectors keep their relative precision.
            assert!(
                error <= 1e-12 * angle.clamp(1e-150, 1.0),
                "{axis} × {angle}: off by {error:e}"
            );
        }
    }
}

#[test]
fn exponential_inverts_the_logarithm() {
    let mut random = Random::new(5);
    for _ in 0..300 {
        let rotation = random.rotation().into_inner();
        let back = rotation_exp(rotation_log(&Matrix3::from(rotation)));
        assert!(difference(back, rotation) < 1e-14);
    }
}

#[test]
fn half_turn_logarithm_is_one_of_two_vectors() {
    for axis in axes() {
        // I − 2 (I − a aᵀ): half a turn about a, without a sine.
        let half = axis * axis.transpose() * 2.0 - na::Matrix3::identity();
        let log = na::Vector3::from(rotation_log(&Matrix3::from(half)));
        let error = (log - axis * PI).norm().min((log + axis * PI).norm());
        assert!(error < 1e-12, "{axis}: {log}");
        assert!(log.norm() <= PI * (1.0 + 1e-15));
    }
}

#[test]
fn logarithm_beyond_half_a_turn_is_shortest() {
    for axis in axes() {
        for beyond in [1e-9, 1e-6, 1e-3, 0.5, 2.0] {
            let long = rotation_exp(Vector3::from(axis * (PI + beyond)));
            let short = Vector3::from(-axis * (PI - beyond));
            assert!(length(rotation_log(&long) - short) < 1e-12);
        }
    }
}

fn check_derivative_of_log_exp<D: DualNumber<3>>() {
    for axis in axes() {
        for angle in ANGLES {
            let omega = variables::<D>(axis * angle);
            let there_and_back = jacobian(rotation_log(&rotation_exp(omega)));
            let error = (there_and_back - na::Matrix3::identity()).amax();
            assert!(error < 1e-12, "{axis} × {angle}: {error:e}");
        }
    }
}

#[test]
fn derivative_of_log_exp_is_the_identity() {
    check_derivative_of_log_exp::<Dual<3>>();
    check_derivative_of_log_exp::<DualSVec64<3>>();
}

fn check_exponential_derivative_at_zero<D: DualNumber<3>>() {
    let turned = rotation_exp(variables::<D>(na::Vector3::zeros()));
    let columns = [turned.x, turned.y, turned.z].map(jacobian);
    for (k, ours) in columns.into_iter().enumerate() {
        // ∂(ω × e_k)/∂ω = −[e_k]×
        let theirs = -na::Vector3::ith(k, 1.0).cross_matrix();
        assert_eq!(ours, theirs);
    }
}

#[test]
fn exponential_derivative_at_zero_is_cross_product() {
    check_exponential_derivative_at_zero::<Dual<3>>();
    check_exponential_derivative_at_zero::<DualSVec64<3>>();
}

fn check_logarithm_jacobian<D: DualNumber<3>>() {
    for axis in axes() {
        for angle in ANGLES {
            let phi = axis * angle;
            let turn = rotation_exp(variables::<D>(na::Vector3::zeros()));
            let turned = turn * Matrix3::constant(rotation_exp(Vector3::from(phi)));
            let dual = jacobian(rotation_log(&turned));
            let closed = na::Matrix3::from(rotation_log_jacobian(Vector3::from(phi)));
            let error = (dual - closed).amax();
            assert!(error < 1e-12, "{axis} × {angle}: {error:e}");
        }
    }
}

#[test]
fn logarithm_jacobian_matches_dual_numbers() {
    check_logarithm_jacobian::<Dual<3>>();
    check_logarithm_jacobian::<DualSVec64<3>>();
}

#[test]
fn logarithm_jacobian_inverts_left_jacobian() {
    // J_l = Σ [φ]ᵏ / (k + 1)!, summed directly (Chirikjian 2012, eq. 10.86).
    for axis in axes() {
        for angle in ANGLES {
            let phi = axis * angle;
            let (mut term, mut sum) = (na::Matrix3::identity(), na::Matrix3::zeros());
            for k in 1..60 {
                sum += term / f64::from(k);
                term = term * phi.cross_matrix() / f64::from(k);
            }
            let ours = na::Matrix3::from(rotation_log_jacobian(Vector3::from(phi)));
            let error = (ours * sum - na::Matrix3::identity()).amax();
            assert!(error < 1e-13, "{axis} × {angle}: {error:e}");
        }
    }
}

/// The Jacobian of the exponential equals small rotations by finite differences, from zero to beyond half a turn.
#[test]
fn exponential_jacobian_matches_differences() {
    use kinopt::spatial::{Matrix3, Vector3, rotation_exp, rotation_exp_jacobian, rotation_log};
    use support::random::Random;
    let mut random = Random::new(23);
    for size in [0.0, 1e-9, 1e-3, 0.09, 0.11, 1.0, 3.0, 5.0] {
        for _ in 0..20 {
            let direction = random.direction();
            let phi = Vector3::new(direction.x, direction.y, direction.z) * size;
            let jacobian = rotation_exp_jacobian(phi);
            for (unit, column) in Vector3::UNITS
                .into_iter()
                .zip([jacobian.x, jacobian.y, jacobian.z])
            {
                let by = 1e-5;
                let [ahead, behind] = [by, -by].map(|by| rotation_exp(phi + unit * by));
                let turned = rotation_log(&(ahead * behind.transpose())) * (0.5 / by);
                assert!(
                    (turned - column).norm() < 1e-9,
                    "{size}: {turned:?} {column:?}"
                );
            }
        }
    }
    let turned: Matrix3<f64> = rotation_exp(Vector3::new(0.3, -0.7, 0.5));
    let (angle, v) = (0.8_f64, Vector3::new(0.2, 0.5, -0.4));
    let about_y = rotation_exp(Vector3::UNITS[1] * angle);
    let [a, b] = [turned.rotated_about_y(angle.sin_cos()), turned * about_y];
    assert!((a.x - b.x).norm() + (a.y - b.y).norm() + (a.z - b.z).norm() < 1e-15);
    assert!((turned.transpose_mul(v) - turned.transpose() * v).norm() < 1e-15);
}
