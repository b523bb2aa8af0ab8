//! Promise: affine maps of the plane are interpolated by their parts, so a rotating square keeps its size. Any map is
//! the product of its parts.

use std::f64::consts::{FRAC_PI_4, PI};

use glam::{DAffine2, DAffine3, DMat2, DMat3, DVec2};
use kinopt::animation::{PlaneDecomposition, interpolate_affine, interpolate_plane_affine};
use support::random::Random;

fn linear(matrix2: DMat2) -> DAffine2 {
    DAffine2 {
        matrix2,
        translation: DVec2::new(1.0, -2.0),
    }
}

fn any(random: &mut Random) -> DMat2 {
    let mut part = || random.within(-2.0, 2.0);
    DMat2::from_cols_array(&[part(), part(), part(), part()])
}

#[test]
fn square_rotates_without_shrinking() {
    let (start, end) = (DMat2::IDENTITY, DMat2::from_angle(FRAC_PI_4));
    let corner = DVec2::new(1.0, 1.0);
    for t in [0.0, 0.2, 0.5, 0.9, 1.0] {
        let between = interpolate_plane_affine(&linear(start), &linear(end), t).unwrap();
        assert!(
            between
                .matrix2
                .abs_diff_eq(DMat2::from_angle(t * FRAC_PI_4), 1e-15)
        );
        assert!(((between.matrix2 * corner).length() - corner.length()).abs() < 1e-15);
        // Linear interpolation of the entries keeps rows and columns orthogonal but shrinks. The determinant is 1 + 2t
        // (cos θ − 1) + 2t² (1 − cos θ). It is 1 at t = 0 and t = 1 only.
        let straight = start * (1.0 - t) + end * t;
        let shrunk = 1.0 - 2.0 * t * (1.0 - t) * (1.0 - FRAC_PI_4.cos());
        assert!((straight.determinant() - shrunk).abs() < 1e-15);
        assert_eq!(shrunk < 1.0, t > 0.0 && t < 1.0);
        for m in [straight, straight.transpose()] {
            assert!(m.x_axis.dot(m.y_axis).abs() < 1e-15);
        }
    }
}

#[test]
fn angle_takes_the_shorter_arc() {
    for (from, to) in [(3.0, -3.0), (-3.0, 3.0), (0.1, 3.0), (2.0, -1.0)] {
        let [a, b] = [from, to].map(|angle| linear(DMat2::from_angle(angle)));
        let middle = interpolate_plane_affine(&a, &b, 0.5).unwrap().matrix2;
        let turned = |m: DMat2, by: DMat2| (m.transpose() * by).x_axis.to_angle().abs();
        let [first, second] = [turned(a.matrix2, middle), turned(middle, b.matrix2)];
        assert!((first - second).abs() < 1e-14 && first <= 0.5 * PI);
    }
}

#[test]
fn decomposition_agrees_with_that_of_space() {
    let mut random = Random::new(7);
    for case in 0..300 {
        let m = match case {
            0 => DMat2::ZERO,
            1 => DMat2::from_diagonal(DVec2::new(1.0, -3.0)),
            2 => any(&mut random) * 1e-300,
            3 => any(&mut random) * 5e307,
            _ => any(&mut random),
        };
        let parts = PlaneDecomposition::new(&linear(m)).unwrap();
        let size = m
            .to_cols_array()
            .iter()
            .fold(0.0_f64, |a, b| a.max(b.abs()));
        assert!(parts.compose().matrix2.abs_diff_eq(m, 4e-15 * size));
        assert_eq!(parts.translation, DVec2::new(1.0, -2.0));
        let [[a, b], [c, d]] = parts.stretch.to_cols_array_2d();
        assert!((b - c).abs() <= 1e-15 * 4.0 * size, "{case}: not symmetric");
        if m.determinant() > 1e-3 && size < 1e100 {
            assert!(a + d > 0.0 && a * d - b * c > 0.0, "{case}: not positive");
            // The same map in space with z unchanged.
            let other = DMat2::from_angle(0.4) * DMat2::from_diagonal(DVec2::new(2.0, 0.5));
            let wide = |m: DMat2| DAffine3::from_mat3(DMat3::from_mat2(m));
            let flat = interpolate_plane_affine(&linear(m), &linear(other), 0.3).unwrap();
            let space = interpolate_affine(&wide(m), &wide(other), 0.3).unwrap();
            for k in 0..2 {
                let offset = space.matrix3.col(k).truncate() - flat.matrix2.col(k);
                // If the angles differ by half a turn, both directions are equally short.
                let turn = (parts.angle - 0.4).rem_euclid(2.0 * PI) - PI;
                assert!(offset.length() < 1e-12 || turn.abs() < 1e-9, "{case}");
            }
        }
    }
    let nan = DMat2::from_diagonal(DVec2::new(1.0, f64::NAN));
    assert!(PlaneDecomposition::new(&linear(nan)).is_err());
}
