//! Promise: SIMD lanes compute what `f64` computes. Sine and cosine are accurate to 1e-15; the portable and the fused
//! kernels agree.

use kinopt::Scalar;
use kinopt::simd_ik::lane::Lanes;
use kinopt::simd_ik::trigonometry::MAX_ANGLE;
use kinopt::simd_ik::{LaneOptions, PoseOutcome, PoseSolver, Prefer};
use support::random::Random;
use support::simd_chains::{panda, target};

fn worst_error(x: f64) -> f64 {
    let (s, c) = Lanes::<4, false>([x, -x, 0.5 * x, x + 1.0]).sin_cos();
    [x, -x, 0.5 * x, x + 1.0]
        .iter()
        .enumerate()
        .map(|(i, x)| (s.0[i] - x.sin()).abs().max((c.0[i] - x.cos()).abs()))
        .fold(0.0, f64::max)
}

#[test]
fn sine_and_cosine_are_accurate_over_full_range() {
    let mut random = Random::split_mix(1);
    for magnitude in [1e-12, 1e-6, 0.1, 1.0, 4.0, 10.0, 1e3, 1e5, 0.9 * MAX_ANGLE] {
        for _ in 0..2000 {
            let x = random.within(-magnitude, magnitude);
            assert!(worst_error(x) < 1e-15, "{x}: {}", worst_error(x));
        }
    }
    // Multiples of π/4, where the reduction cancels most.
    for k in -400..400 {
        let x = f64::from(k) * std::f64::consts::FRAC_PI_4;
        assert!(worst_error(x) < 1e-15, "{x}: {}", worst_error(x));
    }
}

#[test]
fn tiny_angles_keep_their_relative_precision() {
    for exponent in 1..300 {
        let x = 0.1f64.powi(exponent);
        let (s, c) = Lanes::<1, false>([x]).sin_cos();
        assert!((s.0[0] - x.sin()).abs() <= 4e-16 * x);
        assert!((c.0[0] - x.cos()).abs() < 1e-15);
    }
}

/// Both kernels evaluate the same formulas, with one or two roundings for a product and a sum. Attempts that converge
/// reach the same point. The step counts differ only where rounding decides about the last step.
#[test]
fn portable_and_fused_kernels_agree() {
    let chain = panda();
    let fast = LaneOptions::default().with_atlas(false).with_attempts(1);
    let portable = fast.clone().with_portable(true);
    let solvers = [fast, portable].map(|options| PoseSolver::new(&chain, options).unwrap());
    let mut random = Random::split_mix(2);
    let (mut compared, mut steps) = (0, [0; 2]);
    for _ in 0..40 {
        let truth = random.chain_configuration(&chain);
        let goal = target(&chain, &truth);
        let start: Vec<f64> = truth.iter().map(|q| q + random.within(-0.2, 0.2)).collect();
        let mut q = [[0.0; 7]; 2];
        let mut outcomes = [PoseOutcome::default(); 2];
        for k in 0..2 {
            outcomes[k] = solvers[k]
                .solve(&goal, &start, Prefer::Start, None, &mut q[k])
                .unwrap();
        }
        if outcomes[0].reached && outcomes[1].reached {
            compared += 1;
            let apart = (0..7)
                .map(|i| (q[0][i] - q[1][i]).abs())
                .fold(0.0, f64::max);
            assert!(apart < 1e-8, "{apart}");
            for k in 0..2 {
                steps[k] += outcomes[k].iterations;
            }
        }
    }
    assert!(compared > 30, "{compared}");
    assert!(steps[0].abs_diff(steps[1]) <= compared / 8, "{steps:?}");
}
