//! Promise: affine maps are interpolated by their parts, so the middle of two rotations is a rotation. Mirrored and
//! singular maps are decomposed as well.

use glam::{DAffine3, DMat3, DQuat, DVec3};
use kinopt::animation::{Decomposition, interpolate_affine};
use support::random::Random;

fn matrix(random: &mut Random) -> DMat3 {
    let columns: [DVec3; 3] = std::array::from_fn(|_| <[f64; 3]>::from(random.vector(2.0)).into());
    DMat3::from_cols(columns[0], columns[1], columns[2])
}

fn linear(matrix3: DMat3) -> DAffine3 {
    DAffine3 {
        matrix3,
        translation: DVec3::new(1.0, 2.0, 3.0),
    }
}

#[test]
fn square_rotates_without_shrinking() {
    let quarter = linear(DMat3::from_rotation_z(std::f64::consts::FRAC_PI_4));
    let start = linear(DMat3::IDENTITY);
    for t in [0.0, 0.25, 0.5, 1.0] {
        let between = interpolate_affine(&start, &quarter, t).unwrap();
        let expected = DMat3::from_rotation_z(t * std::f64::consts::FRAC_PI_4);
        assert!(between.matrix3.abs_diff_eq(expected, 1e-14));
        // Linear interpolation of the entries does not give a rotation.
        let straight = start.matrix3 * (1.0 - t) + quarter.matrix3 * t;
        let cos = std::f64::consts::FRAC_PI_4.cos();
        let determinant = 1.0 + 2.0 * t * (cos - 1.0) + 2.0 * t * t * (1.0 - cos);
        assert!((straight.determinant() - determinant).abs() < 1e-14);
    }
}

#[test]
fn midpoint_of_rotations_is_a_rotation() {
    let mut random = Random::new(41);
    for _ in 0..100 {
        let mut turn = || {
            let v = random.vector(3.0);
            linear(DMat3::from_quat(DQuat::from_scaled_axis(DVec3::new(
                v.x, v.y, v.z,
            ))))
        };
        let middle = interpolate_affine(&turn(), &turn(), 0.5).unwrap().matrix3;
        assert!((middle.transpose() * middle).abs_diff_eq(DMat3::IDENTITY, 1e-13));
        assert!((middle.determinant() - 1.0).abs() < 1e-13);
    }
}

#[test]
fn decomposition_reproduces_any_map() {
    let mut random = Random::new(42);
    for case in 0..300 {
        let mut m = matrix(&mut random);
        match case % 6 {
            0 => m.z_axis = m.x_axis,
            1 => m = DMat3::from_diagonal(DVec3::new(-1.0, 2.0, 0.5)),
            2 => m *= 1e-200,
            3 => m *= 1e200,
            4 if case == 4 => m = DMat3::ZERO,
            _ => {}
        }
        let parts = Decomposition::new(&linear(m)).unwrap();
        let size = m
            .to_cols_array()
            .iter()
            .fold(0.0_f64, |a, b| a.max(b.abs()));
        let error = parts.compose().matrix3 - m;
        assert!(
            error
                .to_cols_array()
                .iter()
                .all(|e| e.abs() <= 1e-14 * size * 10.0)
        );
        let s = parts.stretch;
        assert!(
            (s - s.transpose())
                .to_cols_array()
                .iter()
                .all(|e| e.abs() <= 1e-13 * size)
        );
        assert!((parts.rotation.length() - 1.0).abs() < 1e-14);
        assert_eq!(parts.translation, DVec3::new(1.0, 2.0, 3.0));
        // Positive definite, or negative definite for maps that mirror.
        if size < 1e100 && size > 1e-100 {
            let sign = if m.determinant() < -1e-9 { -1.0 } else { 1.0 };
            for axis in 0..20 {
                let d = DVec3::new((axis as f64).sin(), (2.0 * axis as f64).cos(), 0.3);
                assert!(sign * d.dot(s * d) > -1e-12 * size, "{case}");
            }
        }
        for (t, end) in [(0.0, m), (1.0, DMat3::IDENTITY)] {
            let actual = interpolate_affine(&linear(m), &linear(DMat3::IDENTITY), t).unwrap();
            let error = (actual.matrix3 - end).to_cols_array();
            assert!(error.iter().all(|e| e.abs() <= 1e-13 * size.max(1.0)));
        }
    }
    let nan = DMat3::from_diagonal(DVec3::new(1.0, f64::NAN, 1.0));
    assert!(Decomposition::new(&linear(nan)).is_err());
}
