//! Penetration of the ground.

use super::{GroundPenetration, ScoreError, Spread};
use crate::motion::contact::{FootBall, FootShapes};
use kinopt_kinematics::kinematics::ForwardKinematics;
use kinopt_kinematics::model::{FrameId, Model};
use kinopt_kinematics::spatial::Vector3;

/// Depth above which a sample counts as penetrating, metres.
const MIN_DEPTH: f64 = 1e-3;

/// Balls of a frame, with the radius of a sphere around its origin that has them all.
struct FrameBalls {
    frame: FrameId,
    balls: Vec<FootBall>,
    radius: f64,
}

/// Measures the lowest point of all shapes over the ground at `height` metres, without shapes of all frames.
pub(super) fn ground_penetration(
    model: &Model,
    shapes: &FootShapes,
    q: &[f64],
    height: f64,
) -> Result<GroundPenetration, ScoreError> {
    let frames = balls_by_frame(model, shapes);
    let ids: Vec<FrameId> = frames.iter().map(|balls| balls.frame).collect();
    let mut kinematics = ForwardKinematics::of_frames(model, &ids)?;
    let mut depths = Vec::new();
    for q in q.chunks_exact(model.configuration_len().max(1)) {
        let placed = kinematics.place(q)?;
        let mut lowest = height;
        for (balls, placed) in frames.iter().zip(placed) {
            if placed.translation.z - balls.radius >= lowest {
                continue;
            }
            let heights = balls.balls.iter().map(|ball| ball.height(placed));
            lowest = heights.fold(lowest, f64::min);
        }
        depths.push(height - lowest);
    }
    let deep = depths.iter().filter(|depth| **depth > MIN_DEPTH).count();
    Ok(GroundPenetration {
        share: deep as f64 / depths.len().max(1) as f64,
        depth: Spread::of(depths),
    })
}

fn balls_by_frame(model: &Model, shapes: &FootShapes) -> Vec<FrameBalls> {
    let origin = |frame: FrameId| FootBall {
        frame,
        at: Vector3::zero(),
        radius: 0.0,
    };
    let balls: Vec<FootBall> = match shapes.balls.is_empty() {
        true => model.frame_ids().map(origin).collect(),
        false => shapes.balls.clone(),
    };
    let mut frames: Vec<FrameBalls> = Vec::new();
    for ball in balls {
        let radius = ball.at.norm() + ball.radius;
        match frames.iter_mut().find(|known| known.frame == ball.frame) {
            Some(known) => {
                known.radius = known.radius.max(radius);
                known.balls.push(ball);
            }
            None => frames.push(FrameBalls {
                frame: ball.frame,
                radius,
                balls: vec![ball],
            }),
        }
    }
    frames
}
