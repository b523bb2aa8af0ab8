//! Promise: every function of `Scalar` equals the function it names, and its derivative on dual numbers is exact. This
//! includes the axes, on which naive formulas divide by zero.

use kinopt::Scalar;
use kinopt::num_dual::DualSVec64;
use kinopt::scalar::Dual;
use support::dual_numbers::DualNumber;

const POINTS: [f64; 9] = [-3.0, -1.0, -0.4, -1e-3, 0.0, 1e-3, 0.5, 1.0, 2.7];

/// Derivative of f by Richardson extrapolation of central differences, accurate to about 1e-11.
fn slope(f: impl Fn(f64) -> f64, x: f64) -> f64 {
    let difference = |h: f64| (f(x + h) - f(x - h)) / (2.0 * h);
    let h = 1e-3 * x.abs().clamp(0.1, 1.0);
    let (one, two, four) = (difference(h), difference(h / 2.0), difference(h / 4.0));
    let (a, b) = ((4.0 * two - one) / 3.0, (4.0 * four - two) / 3.0);
    (16.0 * b - a) / 15.0
}

fn check<D: DualNumber<2>>(name: &str, x: f64, dual: D, f: impl Fn(f64) -> f64) {
    // A quotient of dual numbers multiplies by the reciprocal, which rounds once more.
    let rounding = 2.0 * f64::EPSILON * f(x).abs();
    assert!((dual.value() - f(x)).abs() <= rounding, "{name}({x})");
    let [along, across] = dual.derivatives();
    let expected = slope(&f, x);
    let error = (along - expected).abs() / expected.abs().max(1.0);
    assert!(error < 1e-9, "{name}′({x}) = {along}, not {expected}");
    assert_eq!(across, 0.0, "{name}({x}) does not depend on the other");
}

/// One function over `f64` and over the dual numbers `D`.
macro_rules! law {
    ($name:literal, $x:ident, $body:expr) => {
        (
            $name,
            (|$x: f64| $body) as fn(f64) -> f64,
            (|$x: D| $body) as fn(D) -> D,
        )
    };
}

fn check_functions_of_one_variable<D: DualNumber<2>>() {
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
            check(name, x, dual(D::variable(x, 0)), plain);
        }
    }
    let positive = [
        law!("sqrt", x, Scalar::sqrt(x)),
        law!("ln", x, Scalar::ln(x)),
    ];
    for (name, plain, dual) in positive {
        for x in [1e-2, 0.5, 1.0, 40.0] {
            check(name, x, dual(D::variable(x, 0)), plain);
        }
    }
    let off_zero = [
        law!("abs", x, Scalar::abs(x)),
        law!("min", x, Scalar::min(x, -x)),
        law!("max", x, Scalar::max(x * x, x)),
    ];
    for (name, plain, dual) in off_zero {
        for x in POINTS.into_iter().filter(|x| *x != 0.0 && *x != 1.0) {
            check(name, x, dual(D::variable(x, 0)), plain);
        }
    }
}

#[test]
fn functions_of_one_variable() {
    check_functions_of_one_variable::<Dual<2>>();
    check_functions_of_one_variable::<DualSVec64<2>>();
}

fn check_atan2_on_the_axes<D: DualNumber<2>>() {
    for (y, x) in [
        (1.0, 0.0),
        (-2.0, 0.0),
        (0.0, 3.0),
        (0.5, -0.5),
        (1e-8, 0.0),
    ] {
        let angle = D::variable(y, 0).atan2(D::variable(x, 1));
        let squared: f64 = x * x + y * y;
        // The system's arc tangent may differ in the last bit.
        assert!((angle.value() - f64::atan2(y, x)).abs() <= 1e-15);
        let [by_y, by_x] = angle.derivatives();
        assert!((by_y - x / squared).abs() <= 1e-15 * (1.0 / squared.sqrt()));
        assert!((by_x + y / squared).abs() <= 1e-15 * (1.0 / squared.sqrt()));
    }
}

#[test]
fn atan2_has_both_derivatives_on_the_axes() {
    check_atan2_on_the_axes::<Dual<2>>();
    check_atan2_on_the_axes::<DualSVec64<2>>();
}

fn check_select<D: DualNumber<2>>() {
    let parts = |number: D| (number.value(), number.derivatives());
    let yes = D::with_derivatives(1.0, [5.0, 6.0]);
    let no = D::with_derivatives(2.0, [f64::NAN, f64::INFINITY]);
    assert_eq!(parts(D::select(true, yes, no)), parts(yes));
    assert_eq!(parts(D::select(false, no, yes)), parts(yes));
    assert!(yes.less_than(no), "comparisons look at the value alone");
    assert!(!no.less_than(yes));
    let tie = D::with_derivatives(1.0, [9.0, 9.0]);
    let first = parts(yes);
    assert_eq!(
        parts(yes.min(tie)),
        first,
        "of two equals the first is kept"
    );
    assert_eq!(parts(yes.max(tie)), first);
}

#[test]
fn select_keeps_derivatives_of_the_chosen_side() {
    check_select::<Dual<2>>();
    check_select::<DualSVec64<2>>();
    assert_eq!(Scalar::select(true, 1.0, f64::NAN), 1.0);
}

fn check_constants_and_variables<D: DualNumber<2>>() {
    let constant = D::constant(3.5);
    assert_eq!((constant.value(), constant.derivatives()), (3.5, [0.0; 2]));
    let mut sum = D::variable(1.0, 1);
    sum += constant;
    sum -= D::one();
    sum *= D::constant(2.0);
    assert_eq!((sum.value(), sum.derivatives()), (7.0, [0.0, 2.0]));
    assert_eq!(D::zero().value(), 0.0);
}

#[test]
fn constants_and_variables() {
    check_constants_and_variables::<Dual<2>>();
    check_constants_and_variables::<DualSVec64<2>>();
    let beyond = Dual::<2>::variable(3.5, 2);
    assert_eq!(beyond.derivatives(), [0.0; 2]);
}

fn check_guarded_root<D: DualNumber<1>>() {
    // The pattern that the trait's documentation prescribes for a guarded root.
    fn guarded<S: Scalar>(squared: S) -> S {
        let zero = squared.less_than(S::constant(1e-30));
        let root = S::select(zero, S::one(), squared).sqrt();
        S::select(zero, squared, root)
    }
    let at_zero = guarded(D::variable(0.0, 0));
    assert_eq!((at_zero.value(), at_zero.derivatives()), (0.0, [1.0]));
}

#[test]
fn unselected_branch_has_no_influence() {
    check_guarded_root::<Dual<1>>();
    check_guarded_root::<DualSVec64<1>>();
}
