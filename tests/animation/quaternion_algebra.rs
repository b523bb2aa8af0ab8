//! Promise: quaternions multiply by Hamilton's rules, and q X q̄ rotates by twice the angle in q.

use kinopt::spatial::{Quaternion, Vector3};
use nalgebra as na;
use support::random::Random;

type Q = Quaternion<f64>;

fn q(w: f64, x: f64, y: f64, z: f64) -> Q {
    Quaternion {
        w,
        v: Vector3::new(x, y, z),
    }
}

fn any(random: &mut Random) -> Q {
    let v: [f64; 3] = random.vector(2.0).into();
    q(random.within(-2.0, 2.0), v[0], v[1], v[2])
}

fn unit(random: &mut Random) -> Q {
    Quaternion::exp(Vector3::from(random.vector(3.0)))
}

/// Norm √(q q̄), whose imaginary part must vanish.
fn norm(a: Q) -> f64 {
    let square = a * a.conjugate();
    assert!(square.v.norm() < 1e-14 * square.w.max(1.0));
    square.w.sqrt()
}

fn apart(a: Q, b: Q) -> f64 {
    (a.w - b.w).abs().max((a.v - b.v).norm())
}

#[test]
fn basis_quaternions_follow_hamiltons_rules() {
    let [one, i, j, k] = [
        q(1.0, 0.0, 0.0, 0.0),
        q(0.0, 1.0, 0.0, 0.0),
        q(0.0, 0.0, 1.0, 0.0),
        q(0.0, 0.0, 0.0, 1.0),
    ];
    let minus = |a: Q| q(-a.w, -a.v.x, -a.v.y, -a.v.z);
    for square in [i * i, j * j, k * k, i * j * k] {
        assert_eq!(square, minus(one));
    }
    for (a, b, c) in [(i, j, k), (j, k, i), (k, i, j)] {
        assert_eq!(a * b, c);
        assert_eq!(b * a, minus(c));
    }
}

#[test]
fn product_equals_that_of_the_components() {
    let mut random = Random::new(1);
    for _ in 0..100 {
        let (a, b) = (any(&mut random), any(&mut random));
        // By the table of i, j and k, term by term: row · column gives sign and index.
        let table = [
            [(1.0, 0), (1.0, 1), (1.0, 2), (1.0, 3)],
            [(1.0, 1), (-1.0, 0), (1.0, 3), (-1.0, 2)],
            [(1.0, 2), (-1.0, 3), (-1.0, 0), (1.0, 1)],
            [(1.0, 3), (1.0, 2), (-1.0, 1), (-1.0, 0)],
        ];
        let parts = |c: Q| [c.w, c.v.x, c.v.y, c.v.z];
        let mut product = [0.0; 4];
        for (row, left) in table.iter().zip(parts(a)) {
            for (&(sign, index), right) in row.iter().zip(parts(b)) {
                product[index] += sign * left * right;
            }
        }
        assert!(apart(a * b, q(product[0], product[1], product[2], product[3])) < 1e-14);
        // (s₁ s₂ − v₁·v₂, s₁ v₂ + s₂ v₁ + v₁ × v₂).
        let v = b.v * a.w + a.v * b.w + a.v.cross(b.v);
        let w = a.w * b.w - a.v.dot(b.v);
        assert!(apart(a * b, Quaternion { w, v }) < 1e-14);
    }
}

#[test]
fn product_is_associative_not_commutative() {
    let mut random = Random::new(2);
    for _ in 0..100 {
        let (a, b, c) = (any(&mut random), any(&mut random), any(&mut random));
        assert!(apart((a * b) * c, a * (b * c)) < 1e-13);
        assert!((norm(a * b) - norm(a) * norm(b)).abs() < 1e-13);
        assert!(apart((a * b).conjugate(), b.conjugate() * a.conjugate()) < 1e-14);
        assert!(apart(a * b, b * a) > 1e-3, "vectors of random directions");
        let (u, v) = (unit(&mut random), unit(&mut random));
        assert!((norm(u * v) - 1.0).abs() < 1e-15);
        // The inverse of a unit quaternion is its conjugate.
        assert!(apart(u * u.conjugate(), q(1.0, 0.0, 0.0, 0.0)) < 1e-15);
    }
}

#[test]
fn sandwich_product_rotates_by_twice_the_angle() {
    let mut random = Random::new(3);
    for _ in 0..100 {
        let axis = random.direction();
        let psi = random.within(-3.0, 3.0);
        let turn = Quaternion {
            w: psi.cos(),
            v: Vector3::from(*axis * psi.sin()),
        };
        let point = random.vector(2.0);
        let imaginary = Quaternion {
            w: 0.0,
            v: Vector3::from(point),
        };
        let turned = turn * imaginary * turn.conjugate();
        let expected = na::Rotation3::from_axis_angle(&axis, 2.0 * psi) * point;
        assert!(turned.w.abs() < 1e-14);
        assert!((na::Vector3::from(turned.v) - expected).amax() < 1e-14);
        // The negative quaternion gives the same rotation and the same matrix.
        let opposite = Quaternion {
            w: -turn.w,
            v: -turn.v,
        };
        let same = opposite * imaginary * opposite.conjugate();
        assert!(apart(same, turned) < 1e-15);
        assert!((turn.to_matrix() * Vector3::from(point) - turned.v).norm() < 1e-14);
    }
}

#[test]
fn product_applies_the_second_rotation_first() {
    let mut random = Random::new(4);
    for _ in 0..100 {
        let (first, second) = (unit(&mut random), unit(&mut random));
        let x = Quaternion {
            w: 0.0,
            v: Vector3::from(random.vector(2.0)),
        };
        let one_by_one = first * (second * x * second.conjugate()) * first.conjugate();
        let both = first * second;
        assert!(apart(one_by_one, both * x * both.conjugate()) < 1e-14);
        let matrices = first.to_matrix() * second.to_matrix();
        assert!((matrices * x.v - one_by_one.v).norm() < 1e-14);
    }
}
