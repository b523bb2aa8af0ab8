//! What feet keep over in each frame of a whole movement.

use super::over_ground::{Footing, OverGround};
use super::retargeting::as_map_error;
use super::{RetargetError, Retargeting};
use crate::kinematics::ForwardKinematics;
use crate::model::FrameId;
use crate::motion::clip::MotionProblemBuilder;

/// What a metre below the ground costs in a whole movement, for the most that any place counts: as much as one off what is held.
const OVER: f64 = 200.0;
/// What is held may be deeper than it came by so much, metres: where it stands it is on the edge, at which costs are not smooth.
const SLACK: f64 = 2e-4;

impl Retargeting<'_> {
    /// Keeps the soles over the ground, and as they stand in a movement frame by frame where all their limbs do: over what they
    /// stand on there too, as a foot that is held at its ankle alone is tipped by a leg that can do no more.
    pub(super) fn keep_feet_over_ground(
        &self,
        q: &[f64],
        motion: &mut MotionProblemBuilder<'_>,
    ) -> Result<(), RetargetError> {
        let model = self.robot.model();
        let soles = &self.limbs.soles;
        let frames: Vec<FrameId> = soles.iter().map(|sole| sole.frame).collect();
        let mut kinematics = ForwardKinematics::of_frames(model, &frames).map_err(as_map_error)?;
        let frames = q.chunks_exact(model.configuration_len());
        let placed = frames.map(|q| Ok(kinematics.place(q).map_err(as_map_error)?.to_vec()));
        let placed = placed.collect::<Result<Vec<_>, RetargetError>>()?;
        for (k, sole) in soles.iter().enumerate() {
            let spans = |limb: usize| {
                let own = self.standing.iter().filter(move |own| own.limb == limb);
                own.map(|own| own.span.clone())
            };
            let mut on_ground = vec![vec![0.0; sole.balls.len()]; self.frames()];
            let mut standing = vec![0; self.frames()];
            for (ball, (own, limb)) in sole.balls.iter().enumerate() {
                for span in spans(*limb) {
                    // As low as it came: what holds still is not lifted.
                    let heights = placed[span.clone()].iter();
                    let heights = heights.map(|placed| own.height(&placed[k]));
                    let lowest = heights.fold(f64::INFINITY, f64::min);
                    for frame in span {
                        on_ground[frame][ball] = lowest;
                        standing[frame] += 1;
                    }
                }
            }
            let mut footings: Vec<Footing> = Vec::with_capacity(self.frames());
            let mut held: Option<Vec<f64>> = None;
            for (frame, heights) in on_ground.into_iter().enumerate() {
                let all = standing[frame] == sole.balls.len();
                if !all {
                    held = None;
                    let levelling = match standing[frame] {
                        0 => 1.0,
                        _ => self.options.landing_weight,
                    };
                    footings.push(Footing::Over { heights, levelling });
                    continue;
                }
                let tilts = held.take().unwrap_or_else(|| sole.tilts(&placed[frame][k]));
                footings.push(Footing::Held {
                    tilts: tilts.clone(),
                    firmly: false,
                    heights: heights.iter().map(|height| height - SLACK).collect(),
                });
                held = Some(tilts);
            }
            let task = motion.add(OverGround::new(sole, OVER, self.limbs.heaviest()));
            motion.follow(task, move |frame, own| own.set(&footings[frame]));
        }
        Ok(())
    }
}
