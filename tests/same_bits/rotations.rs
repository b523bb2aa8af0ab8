//! Promise: so it is for rotations: every way to write one, every curve through them, and affine maps taken apart.
#![allow(clippy::unwrap_used)]

use std::f64::consts::{FRAC_PI_2, PI};

use glam::{DAffine2, DAffine3, DMat2, DMat3, DQuat, DVec2, DVec3, Quat, Vec3, Vec4};
use kinopt::animation::rotation::{
    AxisAngle, EulerOrder, RotationCurve, RotationHermite, mean_rates, nearer, nlerp, slerp,
    slerp_vectors, squad, squad_control,
};
use kinopt::animation::{
    Decomposition, Easing, PlaneDecomposition, interpolate_affine, interpolate_plane_affine,
};
use support::random::Random;

use crate::animated::{check_single, rotation, turn, vector};
use crate::digest::{Digest, Value};

fn written() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(92));
    let axis_angle = |digest: &mut Digest, own: AxisAngle| {
        digest.doubles(own.axis.to_array());
        digest.doubles([own.angle]);
        digest.doubles(own.to_quaternion().to_array());
        digest.doubles(own.to_matrix().to_cols_array());
        digest.doubles(own.to_rotation_vector().to_array());
    };
    for _ in 0..20 {
        let q = rotation(&mut random).as_dquat().normalize();
        let v = vector(&mut random, 4.0).as_dvec3();
        axis_angle(&mut digest, AxisAngle::from_quaternion(q));
        axis_angle(&mut digest, AxisAngle::from_rotation_vector(v));
        axis_angle(&mut digest, AxisAngle::about(v, q.w).unwrap());
        axis_angle(&mut digest, AxisAngle::from_matrix(&DMat3::from_quat(q)));
    }
    digest.debug(AxisAngle::about(DVec3::ZERO, 1.0));
    let half = DQuat::from_xyzw(0.6, -0.8, 0.0, 0.0);
    for q in [DQuat::IDENTITY, -DQuat::IDENTITY, half, -half] {
        axis_angle(&mut digest, AxisAngle::from_quaternion(q));
    }
    axis_angle(&mut digest, AxisAngle::from_rotation_vector(DVec3::ZERO));
    for order in EulerOrder::ALL {
        digest.json(&order);
        digest.debug((order.axes(), order.is_proper()));
        let ends = match order.is_proper() {
            true => [0.0, PI],
            false => [FRAC_PI_2, -FRAC_PI_2],
        };
        for middle in [ends[0], ends[1], ends[0] - 1e-10, ends[1] + 1e-7, 0.4, -0.3] {
            for outer in [[0.3, -1.1], [3.0, 2.9], [-3.0, -2.5]] {
                let angles = [outer[0], middle, outer[1]];
                let q = order.to_quaternion(angles);
                for q in [q, -q] {
                    let found = order.from_quaternion(q);
                    digest.doubles(found.angles);
                    digest.word(found.gimbal_lock.into());
                }
                let matrix = order.to_matrix(angles);
                digest.doubles(matrix.to_cols_array());
                digest.doubles(order.from_matrix(&matrix).angles);
            }
        }
    }
    digest.value()
}

fn arcs() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(93));
    for _ in 0..20 {
        let a = rotation(&mut random);
        let near = a * turn(&mut random, 0.005);
        for b in [
            rotation(&mut random),
            near,
            -near,
            -a,
            a * Quat::from_xyzw(1.0, 0.0, 0.0, 0.0),
        ] {
            for t in [0.0, 0.3, 1.0, 1.2] {
                digest.quaternion(slerp(a, b, t));
                digest.quaternion(nlerp(a, b, t));
                let controls = [squad_control(b, a, near), squad_control(a, b, near)];
                digest.quaternion(squad(a, controls, b, t));
                let rates = [a.xyz() * 4.0, b.xyz() * -3.0];
                digest.quaternion(RotationHermite::new(a, rates[0], b, rates[1]).at(t));
                digest.quaternion(RotationHermite::new(a, Vec3::ZERO, b, Vec3::ZERO).at(t));
            }
            digest.quaternion(nearer(b, a));
        }
        let from = a.xyz().normalize();
        let close = (from + Vec3::splat(1e-7)).normalize();
        for to in [near.xyz().normalize(), -from, from, close, Vec3::Y] {
            digest.vector(slerp_vectors(from, to, 0.3));
        }
    }
    digest.value()
}

fn keyed() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(94));
    for count in [1, 2, 5] {
        let times: Vec<f32> = [-1.0, 0.5, 0.75, 2.0, 2.5][..count].to_vec();
        let keys: Vec<Quat> = (0..count)
            .map(|k| rotation(&mut random) * [1.0, 3.0][k % 2])
            .collect();
        let rates = (0..count).map(|_| {
            let mut rate = || Vec4::from((vector(&mut random, 2.0), 0.5));
            [rate(), rate()]
        });
        let rates = rates.collect();
        let easings = Easing::ALL.into_iter().skip(1).take(count).collect();
        let given = || (times.clone(), keys.clone());
        digest.singles(mean_rates(&times, &keys).iter().flat_map(|v| v.to_array()));
        let ((t, k), (t1, k1), (t2, k2)) = (given(), given(), given());
        let ((t3, k3), (t4, k4), (t5, k5)) = (given(), given(), given());
        for curve in [
            RotationCurve::step(t, k),
            RotationCurve::slerp(t1, k1),
            RotationCurve::eased(t2, k2, easings),
            RotationCurve::squad(t3, k3),
            RotationCurve::smooth(t4, k4),
            RotationCurve::cubic(t5, k5, rates),
        ] {
            let curve = curve.unwrap();
            digest.json(&curve);
            let text = serde_json::to_string(&curve).unwrap();
            let again: RotationCurve = serde_json::from_str(&text).unwrap();
            digest.singles(again.times().iter().copied());
            again.rotations().iter().for_each(|&q| digest.quaternion(q));
            for time in [
                -2.0,
                -1.0,
                -0.2,
                0.5,
                0.6,
                0.75,
                1.6,
                2.0,
                2.3,
                2.5,
                3.0,
                f32::NAN,
            ] {
                digest.quaternion(again.at(time));
            }
        }
    }
    // A cubic that passes zero, and a key on the other side.
    let opposite = vec![Quat::IDENTITY, -Quat::IDENTITY];
    let cubic = RotationCurve::cubic(vec![0.0, 1.0], opposite.clone(), vec![[Vec4::ZERO; 2]; 2]);
    let slerp = RotationCurve::slerp(vec![0.0, 1.0], opposite);
    for curve in [cubic.unwrap(), slerp.unwrap()] {
        digest.quaternion(curve.at(0.5));
        digest.quaternion(curve.at(0.75));
    }
    digest.value()
}

fn refused() -> Value {
    let mut digest = Digest::new();
    let (two, one, zero) = (
        || vec![0.0, 1.0],
        Quat::IDENTITY,
        Quat::from_vec4(Vec4::ZERO),
    );
    let nan = Quat::from_xyzw(f32::NAN, 0.0, 0.0, 1.0);
    let flat = [Vec4::ZERO; 2];
    for curve in [
        RotationCurve::step(vec![], vec![]),
        RotationCurve::slerp(two(), vec![one]),
        RotationCurve::slerp(vec![1.0, 0.5], vec![one; 2]),
        RotationCurve::squad(two(), vec![one, nan]),
        RotationCurve::smooth(two(), vec![zero, one]),
        RotationCurve::eased(two(), vec![one; 2], vec![Easing::Linear]),
        RotationCurve::cubic(two(), vec![one; 3], vec![flat; 2]),
        RotationCurve::cubic(two(), vec![one; 2], vec![flat; 1]),
        RotationCurve::cubic(two(), vec![one; 2], vec![flat, [Vec4::ZERO, Vec4::NAN]]),
        RotationCurve::cubic(vec![0.0, 0.0], vec![one; 2], vec![flat; 2]),
        RotationCurve::cubic(two(), vec![one, zero], vec![flat; 2]),
    ] {
        digest.refused(curve);
    }
    for between in [
        r#"{"Squad":[[0,0,0,1]]}"#,
        r#"{"Hermite":[[0,0,0],[0,0,1e39]]}"#,
        r#"{"Hermite":[[0,0,0]]}"#,
        r#"{"Squad":[[0,0,0,1],[0,0,0,1e39]]}"#,
        r#"{"Eased":["linear"]}"#,
        r#"{"Cubic":[]}"#,
    ] {
        let text =
            format!(r#"{{"times":[0,1],"rotations":[[0,0,0,1],[0,0,0,1]],"between":{between}}}"#);
        digest.refused(serde_json::from_str::<RotationCurve>(&text));
    }
    digest.value()
}

fn affine() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(95));
    let mut space = || {
        let mut numbers = || random.within(-1.5, 1.5);
        let matrix = DMat3::from_cols_array(&std::array::from_fn(|_| numbers()));
        DAffine3::from_mat3_translation(
            matrix,
            DVec3::from_array(std::array::from_fn(|_| numbers())),
        )
    };
    let mut maps: Vec<DAffine3> = (0..8).map(|_| space()).collect();
    maps[3].matrix3.z_axis = maps[3].matrix3.x_axis;
    maps[4].matrix3 = DMat3::ZERO;
    maps[5].matrix3 = DMat3::from_diagonal(DVec3::new(2.0, -1.0, 3.0));
    for pair in maps.windows(2) {
        let own = Decomposition::new(&pair[0]).unwrap();
        digest.doubles(own.translation.to_array());
        digest.doubles(own.rotation.to_array());
        digest.doubles(own.stretch.to_cols_array());
        digest.doubles(own.compose().to_cols_array());
        let between = interpolate_affine(&pair[0], &pair[1], 0.3).unwrap();
        digest.doubles(between.to_cols_array());
    }
    digest.refused(interpolate_affine(&DAffine3::IDENTITY, &DAffine3::NAN, 0.5));
    digest.refused(Decomposition::new(&DAffine3::from_translation(DVec3::NAN)));
    let mut plane = || {
        let mut numbers = || random.within(-1.5, 1.5);
        let matrix = DMat2::from_cols_array(&std::array::from_fn(|_| numbers()));
        DAffine2::from_mat2_translation(matrix, DVec2::new(numbers(), numbers()))
    };
    let mut maps: Vec<DAffine2> = (0..8).map(|_| plane()).collect();
    maps[2].matrix2 = DMat2::from_cols_array(&[-1.0, 0.01, -0.01, -1.0]);
    maps[3].matrix2 = DMat2::from_cols_array(&[-1.0, -0.01, 0.01, -1.0]);
    for pair in maps.windows(2) {
        let own = PlaneDecomposition::new(&pair[0]).unwrap();
        digest.doubles(own.translation.to_array());
        digest.doubles([own.angle]);
        digest.doubles(own.stretch.to_cols_array());
        digest.doubles(own.compose().to_cols_array());
        let between = interpolate_plane_affine(&pair[0], &pair[1], 0.3).unwrap();
        digest.doubles(between.to_cols_array());
    }
    digest.refused(interpolate_plane_affine(
        &DAffine2::NAN,
        &DAffine2::IDENTITY,
        0.5,
    ));
    digest.value()
}

#[test]
fn of_rotations() {
    check_single(&[
        ("rotations as axes and angles", written()),
        ("rotations between two", arcs()),
        ("rotations through keys", keyed()),
        ("rotations: what is refused", refused()),
        ("affine maps", affine()),
    ]);
}
