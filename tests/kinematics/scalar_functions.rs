//! Promise: every function of `Scalar` equals the function it names, and its derivative on dual numbers is exact. This
//! includes the axes, on which naive formulas divide by zero.

use kinopt::Scalar;
use kinopt::scalar::Dual;

const POINTS: [f64; 9] = [-3.0, -1.0, -0.4, -1e-3, 0.0, 1e-3, 0.5, 1.0, 2.7];

/// Derivative of f by Richardson extrapolation of central differences, accurate to about 1e-11.
fn slope(f: impl Fn(f64) -> f64, x: f64) -> f64 {
    let difference = |h: f64| (f(x + h) - f(x - h)) / (2.0 * h);
    let h = 1e-3 * x.abs().clamp(0.1, 1.0);
    let (one, two, four) = (difference(h), difference(h / 2.0), difference(h / 4.0));
    let (a, b) = ((4.0 * two - one) / 3.0, (4.0 * four - two) / 3.0);
    (16.0 * b - a) / 15.0
}

fn check(name: &str, x: f64, dual: Dual<2>, f: impl Fn(f64) -> f64) {
    // A quotient of dual numbers multiplies by the reciprocal, which rounds once more.
    let rounding = 2.0 * f64::EPSILON * f(x).abs();
    assert!((dual.value() - f(x)).abs() <= rounding, "{name}({x})");
    let [along, across] = dual.derivatives();
    let expected = slope(&f, x);
    let error = (along - expected).abs() / expected.abs().max(1.0);
    assert!(error < 1e-9, "{name}′({x}) = {along}, not {expected}");
    assert_eq!(across, 0.0, "{name}({x}) does not depend on the other");
}

/// One function over every scalar.
macro_rules! law {
    ($name:literal, $x:ident, $body:expr) => {
        (
            $name,
            (|$x: f64| $body) as fn(f64) -> f64,
            (|$x: Dual<2>| $body) as fn(Dual<2>) -> Dual<2>,
        )
    };
}

#[test]
fn functions_of_one_variable() {
    fn constant<S: Scalar>(value: f64, _like: S) -> S {
        S::constant(value)
    }
    let everywhere = [
        law!("sin", x, Scalar::sin_cos(x).0),
        law!("cos", x, Scalar::sin_cos(x).1),
        law!("exp", x, Scalar::exp(x)),
        law!("negation", x, -x),
        law!("square", x, x * x),
        law!("product", x, x * constant(3.0, x) * Scalar::sin_cos(x).0),
        law!("quotient", x, x / (x * x + constant(1.0, x))),
        law!("mul_add", x, Scalar::mul_add(x, x, constant(2.0, x) - x)),
        law!(
            "atan2 over a positive x",
            x,
            Scalar::atan2(x, constant(0.7, x))
        ),
        law!(
            "atan2 under a positive y",
            x,
            Scalar::atan2(constant(0.7, x), x)
        ),
        law!(
            "atan2 under a negative y",
            x,
            Scalar::atan2(constant(-0.7, x), x)
        ),
    ];
    for (name, plain, dual) in everywhere {
        for x in POINTS {
            check(name, x, dual(Dual::variable(x, 0)), plain);
        }
    }
    let positive = [
        law!("sqrt", x, Scalar::sqrt(x)),
        law!("ln", x, Scalar::ln(x)),
    ];
    for (name, plain, dual) in positive {
        for x in [1e-2, 0.5, 1.0, 40.0] {
            check(name, x, dual(Dual::variable(x, 0)), plain);
        }
    }
    let off_zero = [
        law!("abs", x, Scalar::abs(x)),
        law!("min", x, Scalar::min(x, -x)),
        law!("max", x, Scalar::max(x * x, x)),
    ];
    for (name, plain, dual) in off_zero {
        for x in POINTS.into_iter().filter(|x| *x != 0.0 && *x != 1.0) {
            check(name, x, dual(Dual::variable(x, 0)), plain);
        }
    }
}

#[test]
fn atan2_has_both_derivatives_on_the_axes() {
    for (y, x) in [
        (1.0, 0.0),
        (-2.0, 0.0),
        (0.0, 3.0),
        (0.5, -0.5),
        (1e-8, 0.0),
    ] {
        let angle = Dual::<2>::variable(y, 0).atan2(Dual::variable(x, 1));
        let squared: f64 = x * x + y * y;
        // The system's arc tangent may differ in the last bit.
        assert!((angle.value() - f64::atan2(y, x)).abs() <= 1e-15);
        let [by_y, by_x] = angle.derivatives();
        assert!((by_y - x / squared).abs() <= 1e-15 * (1.0 / squared.sqrt()));
        assert!((by_x + y / squared).abs() <= 1e-15 * (1.0 / squared.sqrt()));
    }
}

#[test]
fn select_keeps_derivatives_of_the_chosen_side() {
    let yes = Dual::<2>::new(1.0, [5.0, 6.0]);
    let no = Dual::<2>::new(2.0, [f64::NAN, f64::INFINITY]);
    assert_eq!(Dual::select(true, yes, no), yes);
    assert_eq!(Dual::select(false, no, yes), yes);
    assert!(yes.less_than(no), "comparisons look at the value alone");
    assert!(!no.less_than(yes));
    assert_eq!(Scalar::select(true, 1.0, f64::NAN), 1.0);
    let tie = Dual::<2>::new(1.0, [9.0, 9.0]);
    assert_eq!(yes.min(tie), yes, "of two equals the first is kept");
    assert_eq!(yes.max(tie), yes);
}

#[test]
fn constants_and_variables() {
    let constant = Dual::<2>::constant(3.5);
    assert_eq!((constant.value(), constant.derivatives()), (3.5, [0.0; 2]));
    let beyond = Dual::<2>::variable(3.5, 2);
    assert_eq!(beyond.derivatives(), [0.0; 2]);
    let mut sum = Dual::<2>::variable(1.0, 1);
    sum += constant;
    sum -= Dual::one();
    sum *= Dual::constant(2.0);
    assert_eq!((sum.value(), sum.derivatives()), (7.0, [0.0, 2.0]));
    assert_eq!(Dual::<2>::zero().value(), 0.0);
}

#[test]
fn unselected_branch_has_no_influence() {
    // The pattern that the trait's documentation prescribes for a guarded root.
    fn guarded<S: Scalar>(squared: S) -> S {
        let zero = squared.less_than(S::constant(1e-30));
        let root = S::select(zero, S::one(), squared).sqrt();
        S::select(zero, squared, root)
    }
    let at_zero = guarded(Dual::<1>::variable(0.0, 0));
    assert_eq!((at_zero.value(), at_zero.derivatives()), (0.0, [1.0]));
}
