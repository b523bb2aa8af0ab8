//! Promise: so it is for the numbers below everything else: scalars and their derivatives, rotations and their
//! logarithms near no turn and near half of one.
#![allow(clippy::unwrap_used)]

use kinopt::Scalar;
use kinopt::scalar::Dual;
use kinopt::spatial::{
    Matrix3, Placement, Quaternion, Vector3, rotation_exp, rotation_exp_jacobian, rotation_log,
    rotation_log_jacobian,
};
use support::random::Random;

use crate::digest::{Digest, Value, check};
use crate::every_joint::vector;

type D3 = Dual<3>;

/// A number and three derivatives of it.
fn dual(random: &mut Random, low: f64, high: f64) -> D3 {
    D3::new(random.within(low, high), vector(random, 2.0).to_array())
}

fn put(digest: &mut Digest, numbers: impl IntoIterator<Item = D3>) {
    for number in numbers {
        digest.doubles([number.value()]);
        digest.doubles(number.derivatives());
    }
}

/// Every function of two numbers of a kind.
fn functions<S: Scalar>(a: S, b: S, positive: S) -> Vec<S> {
    let mut sum = a;
    sum += b;
    sum *= a;
    sum -= positive;
    let (sin, cos) = a.sin_cos();
    vec![
        a + b,
        a - b,
        a * b,
        a / b,
        -a,
        sum,
        sin,
        cos,
        a.mul_add(b, positive),
        positive.sqrt(),
        positive.ln(),
        a.exp(),
        a.atan2(b),
        b.atan2(positive),
        a.abs(),
        b.abs(),
        a.min(b),
        a.max(b),
        b.min(a),
        b.max(a),
        S::select(a.less_than(b), a, positive),
        S::zero().atan2(-positive),
        S::one(),
        S::constant(0.25),
    ]
}

fn scalars() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(101));
    for _ in 0..40 {
        let [a, b] = [(); 2].map(|()| dual(&mut random, -4.0, 4.0));
        let positive = dual(&mut random, 0.1, 3.0);
        put(&mut digest, functions(a, b, positive));
        digest.doubles(functions(a.value(), b.value(), positive.value()));
        put(
            &mut digest,
            [D3::variable(a.value(), 1), D3::variable(b.value(), 3)],
        );
    }
    // Signs of zero, equal ones, ends of arc tangents, what is not finite.
    let edges = [0.0, -0.0, 1.0, -1.0, f64::INFINITY, f64::NAN, 1e-300, 4e15];
    for a in edges {
        for b in edges {
            digest.doubles(functions(a, b, b).map_nan());
            let [a, b] = [D3::variable(a, 0), D3::variable(b, 2)];
            let values = [
                a.min(b),
                a.max(b),
                a.abs(),
                D3::select(a.less_than(b), a, b),
            ];
            digest.doubles(values.map(|v| v.value()).to_vec().map_nan());
            digest.word(u64::from(a.is_finite()) + 2 * u64::from(b.value().is_finite()));
            digest.noted(&a.as_f64().map(f64::is_nan));
        }
    }
    // Many at once: every quarter of a turn, and beyond where the polynomials hold.
    let mut angles: Vec<f64> = (0..60).map(|k| 0.37 * f64::from(k) - 11.0).collect();
    angles.extend((0..20).map(|_| random.within(-1e6, 1e6)));
    let [mut sines, mut cosines] = [(); 2].map(|()| vec![0.0; angles.len()]);
    f64::sin_cos_all(&angles, &mut sines, &mut cosines);
    digest.doubles(sines.iter().chain(&cosines).copied());
    angles[3] = 1.5e6;
    angles[70] = -7.3e9;
    f64::sin_cos_all(&angles, &mut sines, &mut cosines);
    digest.doubles(sines.iter().chain(&cosines).copied());
    let duals: Vec<D3> = (0..3).map(|_| dual(&mut random, -9.0, 9.0)).collect();
    let [mut sines, mut cosines] = [(); 2].map(|()| vec![D3::zero(); 3]);
    D3::sin_cos_all(&duals, &mut sines, &mut cosines);
    put(&mut digest, sines.into_iter().chain(cosines));
    digest.value()
}

/// NaN is one: which of its bits are set is the machine's own.
trait MapNan {
    fn map_nan(self) -> Vec<f64>;
}

impl MapNan for Vec<f64> {
    fn map_nan(self) -> Vec<f64> {
        let own = |v: f64| if v.is_nan() { f64::NAN } else { v };
        self.into_iter().map(own).collect()
    }
}

/// Rotation vectors of every length, those at which formulas change among them.
fn turns(random: &mut Random) -> Vec<Vector3<f64>> {
    let lengths = [
        0.0,
        1e-9,
        9e-4,
        1.1e-3,
        9e-3,
        1.1e-2,
        0.031,
        0.033,
        0.09,
        0.11,
        0.5,
        1.5,
        2.5,
        3.1,
        std::f64::consts::PI - 1e-7,
        3.2,
        5.0,
        6.5,
    ];
    let mut all = Vec::new();
    for length in lengths {
        let v = vector(random, 1.0);
        all.push(v * (length / v.norm()));
        all.push(Vector3::UNITS[random.below(3)] * -length);
    }
    all
}

fn rotations() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(102));
    let matrix = |digest: &mut Digest, m: Matrix3<f64>| {
        digest.placement(&Placement::new(m, Vector3::zero()));
    };
    for omega in turns(&mut random) {
        let rotation = rotation_exp(omega);
        matrix(&mut digest, rotation);
        digest.doubles(rotation_log(&rotation).to_array());
        matrix(&mut digest, rotation_log_jacobian(omega));
        matrix(&mut digest, rotation_exp_jacobian(omega));
        let own = Quaternion::exp(omega);
        for q in [
            own,
            own.conjugate(),
            own * Quaternion::exp(vector(&mut random, 1.0)),
        ] {
            digest.doubles([q.w]);
            digest.doubles(q.v.to_array());
            digest.doubles(q.log().to_array());
            let back = Quaternion::from_matrix(&q.to_matrix());
            digest.doubles([back.w, back.v.x, back.v.y, back.v.z]);
        }
        // The same with derivatives, along the turn and across it.
        let [x, y, z] = omega.to_array();
        let moved = Vector3::new(D3::variable(x, 0), D3::variable(y, 1), D3::variable(z, 2));
        let turned = rotation_exp(moved);
        put(
            &mut digest,
            turned.x.to_array().into_iter().chain(turned.z.to_array()),
        );
        put(&mut digest, rotation_log(&turned).to_array());
        put(&mut digest, rotation_exp_jacobian(moved).y.to_array());
        let quarter = Scalar::sin_cos(x);
        for own in [
            rotation.rotated_about_x(quarter),
            rotation.rotated_about_y(quarter),
            rotation.rotated_about_z(quarter),
            Matrix3::rotation(Vector3::UNITS[1], quarter),
            rotation.transpose(),
        ] {
            matrix(&mut digest, own);
        }
        digest.doubles(
            rotation
                .transpose_mul(omega + vector(&mut random, 1.0))
                .to_array(),
        );
    }
    digest.value()
}

#[test]
fn of_numbers() {
    check(&[
        ("scalars and their derivatives", scalars()),
        ("rotations, their logarithms and Jacobians", rotations()),
    ]);
}
