//! Joint positions and velocities outside their limits.

use std::collections::BTreeSet;

use super::LimitExcess;
use kinopt_robot::robot::Robot;

/// Distance outside a position limit up to which rounding of a file explains it, radians or metres.
const POSITION_TOLERANCE: f64 = 1e-4;
/// Excess of a velocity limit up to which rounding of a file explains it, relative to the limit.
const VELOCITY_TOLERANCE: f64 = 5e-3;

/// Measures the joints of one coordinate against the robot's limits.
pub(super) fn limit_excess(robot: &Robot, q: &[f64], frame_rate: f64) -> LimitExcess {
    let model = robot.model();
    let width = model.configuration_len().max(1);
    let rows: Vec<&[f64]> = q.chunks_exact(width).collect();
    let max_steps = robot.moves_within(1.0 / frame_rate);
    let mut is_outside = vec![false; rows.len()];
    let mut is_fast = vec![false; rows.len()];
    let (mut position, mut velocity_ratio) = (0.0_f64, 0.0_f64);
    let mut joints = BTreeSet::new();
    for segment in model.segments() {
        let coordinate = segment.coordinate;
        let joint = model.joint_of(coordinate);
        if joint.kind.coordinates() != 1
            || model
                .free_coordinates()
                .any(|free| free.contains(&coordinate))
        {
            continue;
        }
        let limits = joint.limits;
        let max_step = max_steps.get(coordinate).copied().unwrap_or(f64::INFINITY);
        for (sample, row) in rows.iter().enumerate() {
            let value = row[coordinate];
            let outside = (limits.lower - value).max(value - limits.upper).max(0.0);
            position = position.max(outside);
            if outside > POSITION_TOLERANCE {
                is_outside[sample] = true;
                joints.insert(coordinate);
            }
            let previous = sample
                .checked_sub(1)
                .map(|previous| rows[previous][coordinate]);
            let Some(previous) = previous.filter(|_| max_step.is_finite() && max_step > 0.0) else {
                continue;
            };
            let ratio = (value - previous).abs() / max_step;
            velocity_ratio = velocity_ratio.max(ratio);
            if ratio > 1.0 + VELOCITY_TOLERANCE {
                is_fast[sample] = true;
                joints.insert(coordinate);
            }
        }
    }
    let share = |flags: &mut dyn Iterator<Item = bool>| {
        flags.filter(|flag| *flag).count() as f64 / rows.len().max(1) as f64
    };
    let either = is_outside.iter().zip(&is_fast).map(|(a, b)| *a || *b);
    LimitExcess {
        share: share(&mut either.into_iter()),
        position_share: share(&mut is_outside.iter().copied()),
        position,
        velocity_share: share(&mut is_fast.iter().copied()),
        velocity_ratio,
        joints: joints
            .into_iter()
            .map(|coordinate| model.joint_of(coordinate).name.clone())
            .collect(),
    }
}
