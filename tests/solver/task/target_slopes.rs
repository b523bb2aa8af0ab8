//! Promise: handwritten derivatives with respect to a task's target equal those by dual numbers.

use kinopt::model::{FrameId, Model};
use kinopt::num_dual::DualSVec64;
use kinopt::scalar::Dual;
use kinopt::spatial::{Placement, Vector3, rotation_exp};
use kinopt::task::{DifferentiableTarget, FramePose, Orientation, Point};
use support::dual_numbers::DualNumber;
use support::random::Random;

fn anywhere(random: &mut Random) -> Placement<f64> {
    let mut random_vector = || Vector3::from([0; 3].map(|_| random.within(-1.0, 1.0)));
    Placement::new(rotation_exp(random_vector() * 1.8), random_vector())
}

/// By the dual numbers of `evaluate_moved`.
fn expected<D: DualNumber<6>>(
    residual: &impl DifferentiableTarget,
    frames: &[Placement<f64>],
    counts: &[f64],
) -> Vec<f64> {
    let frames: Vec<Placement<D>> = frames.iter().map(Placement::constant).collect();
    let step: Vec<_> = (0..residual.target_len())
        .map(|k| D::variable(0.0, k))
        .collect();
    let mut rows = vec![D::zero(); counts.len()];
    residual.evaluate_moved(&frames, &[], &step, &mut rows);
    let slope = |k: usize| {
        rows.iter()
            .zip(counts)
            .map(|(row, c)| c * row.derivatives()[k])
            .sum()
    };
    (0..residual.target_len()).map(slope).collect()
}

fn agree(residual: &impl DifferentiableTarget, frames: &[Placement<f64>], random: &mut Random) {
    let rows = residual.rows().iter().map(|rows| rows.count).sum();
    let counts: Vec<f64> = (0..rows).map(|_| random.within(-1.0, 1.0)).collect();
    let mut slopes = vec![0.25; residual.target_len()];
    assert!(residual.add_target_slopes(frames, &[], &counts, &mut slopes));
    for expected in [
        expected::<Dual<6>>(residual, frames, &counts),
        expected::<DualSVec64<6>>(residual, frames, &counts),
    ] {
        for (slope, expected) in slopes.iter().zip(expected) {
            assert!(
                (slope - 0.25 - expected).abs() < 1e-12,
                "{slope} {expected}"
            );
        }
    }
}

#[test]
fn target_derivatives_match_dual_numbers() {
    let mut builder = Model::builder("frames");
    let [hand, base]: [FrameId; 2] =
        ["hand", "base"].map(|name| builder.frame(name, None, Placement::identity()));
    builder.build().unwrap();
    let mut random = Random::new(77);
    for case in 0..200 {
        let [target, placed, tool] = [0; 3].map(|_| anywhere(&mut random));
        let mut frames = vec![placed];
        let mut pose = FramePose::new(hand, target);
        let mut turn = Orientation::new(hand, target.rotation);
        let mut point = Point::new(hand, target.translation);
        if case % 2 == 1 {
            frames.push(anywhere(&mut random));
            pose = pose.relative_to(base);
            turn = turn.relative_to(base);
            point = point.relative_to(base);
        }
        agree(&pose, &frames, &mut random);
        agree(&pose.with_tool(tool), &frames, &mut random);
        agree(&turn, &frames, &mut random);
        agree(&point, &frames, &mut random);
        // Exactly at its target.
        let reached = match frames.get(1) {
            Some(base) => base.inverse() * frames[0],
            None => frames[0],
        };
        agree(&FramePose::new(hand, reached), &frames[..1], &mut random);
    }
}
