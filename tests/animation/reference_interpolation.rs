//! Promise: interpolants, Euler angles and polar decompositions equal SciPy's.

use glam::{DAffine3, DMat3, DQuat, DVec3, Quat, Vec3};
use kinopt::animation::Decomposition;
use kinopt::animation::curve::{CubicBezier, KeyedCurve};
use kinopt::animation::rotation::{AxisAngle, EulerOrder, RotationHermite, nlerp, slerp};
use serde::Deserialize;

/// Three numbers of the file.
type Triple = [f64; 3];

#[derive(Deserialize)]
struct Reference {
    provenance: Provenance,
    slerp: Vec<Arc>,
    hermite: Vec<Spline>,
    bezier: Vec<Bezier>,
    rotation_spline: Vec<RotationSpline>,
    euler: Vec<Euler>,
    polar: Vec<Polar>,
}

#[derive(Deserialize)]
struct Provenance {
    tool: String,
    version: String,
    date: String,
    seed: u64,
}

#[derive(Deserialize)]
struct Arc {
    from: [f64; 4],
    to: [f64; 4],
    shares: Vec<f32>,
    at: Vec<[f64; 4]>,
}

#[derive(Deserialize)]
struct Spline {
    times: Vec<f64>,
    values: Vec<Triple>,
    rates: Vec<Triple>,
    at: Vec<f64>,
    position: Vec<Triple>,
    rate: Vec<Triple>,
}

#[derive(Deserialize)]
struct Bezier {
    points: [Triple; 4],
    at: Vec<f64>,
    position: Vec<Triple>,
    tangent: Vec<Triple>,
}

#[derive(Deserialize)]
struct RotationSpline {
    times: Vec<f64>,
    rotations: Vec<[f64; 4]>,
    rates: Vec<Triple>,
    at: Vec<f64>,
    rotation: Vec<[f64; 4]>,
}

#[derive(Deserialize)]
struct Euler {
    order: EulerOrder,
    angles: [f64; 3],
    quaternion: [f64; 4],
    matrix: [[f64; 3]; 3],
    rotation_vector: Triple,
}

#[derive(Deserialize)]
struct Polar {
    matrix: [[f64; 3]; 3],
    rotation: [[f64; 3]; 3],
    stretch: [[f64; 3]; 3],
}

fn reference() -> Reference {
    let reference: Reference =
        serde_json::from_str(include_str!("../reference/interpolation.json")).unwrap();
    let Provenance {
        tool,
        version,
        date,
        seed,
    } = &reference.provenance;
    assert_eq!(tool, "SciPy");
    assert!(!version.is_empty() && date.len() == 10 && *seed > 0);
    reference
}

fn quaternion([w, x, y, z]: [f64; 4]) -> DQuat {
    DQuat::from_xyzw(x, y, z, w).normalize()
}

fn matrix(rows: [[f64; 3]; 3]) -> DMat3 {
    DMat3::from_cols_array_2d(&rows).transpose()
}

/// Angle between the rotations of two unit quaternions, in radians.
fn angle_between(a: DQuat, b: DQuat) -> f64 {
    2.0 * (a.conjugate() * b).xyz().length().min(1.0).asin()
}

#[test]
fn slerp_equals_scipy() {
    for arc in reference().slerp {
        let (from, to) = (quaternion(arc.from).as_quat(), quaternion(arc.to).as_quat());
        for (&share, at) in arc.shares.iter().zip(arc.at) {
            let ours = slerp(from, to, share);
            assert!(
                angle_between(ours.as_dquat(), quaternion(at)) < 2e-6,
                "{share}"
            );
            assert!((ours.length() - 1.0).abs() < 1e-6);
            // `nlerp` stays on the arc and equals `slerp` at the ends and in the middle.
            let close = [0.0, 0.5, 1.0].contains(&share);
            let deviation = angle_between(nlerp(from, to, share).as_dquat(), quaternion(at));
            assert!(
                deviation < if close { 2e-6 } else { 0.2 },
                "{share}: {deviation}"
            );
        }
    }
}

#[test]
fn hermite_splines_equal_scipy() {
    for spline in reference().hermite {
        let tangents = spline.rates.iter().map(|&rate| [rate.into(); 2]).collect();
        let values: Vec<DVec3> = spline.values.into_iter().map(DVec3::from).collect();
        let curve = KeyedCurve::cubic(spline.times, values, tangents).unwrap();
        for ((&at, position), rate) in spline.at.iter().zip(spline.position).zip(spline.rate) {
            assert!((curve.at(at) - DVec3::from(position)).length() < 1e-13);
            assert!((curve.rate(at) - DVec3::from(rate)).length() < 1e-12);
        }
    }
}

#[test]
fn bezier_curves_equal_scipy() {
    for bezier in reference().bezier {
        let curve = CubicBezier::new(bezier.points.map(DVec3::from));
        for ((&u, position), tangent) in bezier.at.iter().zip(bezier.position).zip(bezier.tangent) {
            assert!((curve.position(u) - DVec3::from(position)).length() < 1e-14);
            assert!((curve.tangent(u) - DVec3::from(tangent)).length() < 1e-13);
        }
    }
}

#[test]
fn rotation_hermites_about_one_axis_equal_scipy() {
    for spline in reference().rotation_spline {
        let keys: Vec<Quat> = spline
            .rotations
            .iter()
            .map(|&q| quaternion(q).as_quat())
            .collect();
        for (&at, rotation) in spline.at.iter().zip(spline.rotation) {
            let after = spline.times.partition_point(|&t| t <= at);
            let key = after.saturating_sub(1).min(spline.times.len() - 2);
            let length = spline.times[key + 1] - spline.times[key];
            let rate = |key: usize| (DVec3::from(spline.rates[key]) * length).as_vec3();
            let segment = RotationHermite::new(keys[key], rate(key), keys[key + 1], rate(key + 1));
            let u = (at - spline.times[key]) / length;
            let deviation = angle_between(segment.at(u as f32).as_dquat(), quaternion(rotation));
            assert!(deviation < 3e-6, "{deviation}");
        }
    }
}

#[test]
fn euler_angles_of_all_orders_equal_scipy() {
    let mut orders = std::collections::HashSet::new();
    for case in reference().euler {
        let theirs = quaternion(case.quaternion);
        orders.insert(case.order);
        let to = case.order.to_quaternion(case.angles);
        assert!(angle_between(to, theirs) < 1e-14);
        assert!(
            (case.order.to_matrix(case.angles) - matrix(case.matrix))
                .abs_diff_eq(DMat3::ZERO, 1e-14)
        );
        let from_matrix = case.order.from_matrix(&matrix(case.matrix));
        for actual in [case.order.from_quaternion(theirs), from_matrix] {
            assert!(!actual.gimbal_lock);
            for (ours, theirs) in actual.angles.iter().zip(case.angles) {
                assert!(
                    (ours - theirs).abs() < 1e-13,
                    "{:?}: {actual:?}",
                    case.order
                );
            }
        }
        let turn = AxisAngle::from_quaternion(theirs);
        assert!((turn.to_rotation_vector() - DVec3::from(case.rotation_vector)).length() < 1e-14);
        let turn = AxisAngle::from_matrix(&matrix(case.matrix));
        assert!((turn.to_rotation_vector() - DVec3::from(case.rotation_vector)).length() < 1e-13);
    }
    assert_eq!(orders.len(), 12);
}

#[test]
fn polar_decompositions_equal_scipy() {
    for case in reference().polar {
        let translation = DVec3::new(1.0, -2.0, 3.0);
        let matrix3 = matrix(case.matrix);
        let map = DAffine3 {
            matrix3,
            translation,
        };
        let parts = Decomposition::new(&map).unwrap();
        let rotation = DMat3::from_quat(parts.rotation);
        assert!(rotation.abs_diff_eq(matrix(case.rotation), 1e-13));
        assert!(parts.stretch.abs_diff_eq(matrix(case.stretch), 1e-13));
        assert!(parts.compose().abs_diff_eq(map, 1e-13));
    }
}

#[test]
fn single_precision_curves_equal_double_precision() {
    for spline in reference().hermite {
        let times = spline.times.iter().map(|&t| t as f32).collect();
        let values = spline
            .values
            .iter()
            .map(|&v| DVec3::from(v).as_vec3())
            .collect();
        let tangents: Vec<[Vec3; 2]> = spline
            .rates
            .iter()
            .map(|&r| [DVec3::from(r).as_vec3(); 2])
            .collect();
        let curve = KeyedCurve::cubic(times, values, tangents).unwrap();
        for (&at, position) in spline.at.iter().zip(&spline.position) {
            assert!((curve.at(at as f32).as_dvec3() - DVec3::from(*position)).length() < 1e-5);
        }
    }
}
