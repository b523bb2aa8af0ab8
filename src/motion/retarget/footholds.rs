//! What feet keep over in each frame of a whole movement.

use super::over_ground::{Footing, OverGround};
use super::retargeting::as_map_error;
use super::{RetargetError, Retargeting};
use crate::kinematics::ForwardKinematics;
use crate::model::FrameId;
use crate::motion::clip::MotionProblemBuilder;
use crate::spatial::Placement;

/// What a metre below the ground costs in a whole movement, for the most that any place counts: as much as one off what is held.
const OVER: f64 = 200.0;
/// What is held may be deeper than it came by so much, metres: where it stands it is on the edge, at which costs are not smooth.
const SLACK: f64 = 2e-4;
/// … but what is held is no deeper in the ground than this before, however it came.
const DEEPEST: f64 = 4e-4;

/// Where a foot is deeper than this in what it is kept over, metres, what each ball is kept over is raised by as much as it is deep.
const SUNK: f64 = 9e-4;

/// What each sole does in each frame.
#[derive(Clone, Debug)]
pub(super) struct Footholds {
    soles: Vec<Vec<Footing>>,
    /// By how much what each ball of each sole is kept over is raised, frame after frame, metres.
    raised: Vec<Vec<f64>>,
}

impl Retargeting<'_> {
    /// Where the soles are in all frames.
    fn placed_soles(&self, q: &[f64]) -> Result<Vec<Vec<Placement<f64>>>, RetargetError> {
        let model = self.body.model();
        let soles = self.limbs.soles.iter().map(|sole| sole.frame);
        let frames: Vec<FrameId> = soles.collect();
        let mut kinematics = ForwardKinematics::of_frames(model, &frames).map_err(as_map_error)?;
        let frames = q.chunks_exact(model.configuration_len());
        let placed = frames.map(|q| Ok(kinematics.place(q).map_err(as_map_error)?.to_vec()));
        placed.collect()
    }

    /// Keeps the soles over the ground, and as they stand in a movement frame by frame where all their limbs do: over what they
    /// stand on there too, as a foot that is held at its ankle alone is tipped by a leg that can do no more.
    pub(super) fn footholds(&self, q: &[f64]) -> Result<Footholds, RetargetError> {
        let placed = self.placed_soles(q)?;
        let mut soles = Vec::with_capacity(self.limbs.soles.len());
        for (k, sole) in self.limbs.soles.iter().enumerate() {
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
                    let lowest = heights.fold(f64::INFINITY, f64::min).max(-DEEPEST);
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
            soles.push(footings);
        }
        let balls = self.limbs.soles.iter().map(|sole| sole.balls.len());
        Ok(Footholds {
            raised: balls
                .map(|balls| vec![0.0; balls * self.frames()])
                .collect(),
            soles,
        })
    }

    /// Raises what feet are kept over where they are in it, as the spring that it is gives way to what presses on them: an augmented
    /// Lagrangian's step. Whether one was deep.
    pub(super) fn raise_footholds(
        &self,
        q: &[f64],
        footholds: &mut Footholds,
    ) -> Result<bool, RetargetError> {
        let placed = self.placed_soles(q)?;
        let mut deepest: f64 = 0.0;
        let Footholds { soles, raised } = footholds;
        for (k, (sole, (footings, raised))) in self
            .limbs
            .soles
            .iter()
            .zip(soles.iter_mut().zip(raised))
            .enumerate()
        {
            let frames = footings
                .iter_mut()
                .zip(raised.chunks_exact_mut(sole.balls.len()));
            for ((footing, raised), placed) in frames.zip(&placed) {
                let balls = sole.balls.iter().zip(footing.heights_mut()).zip(raised);
                for (((ball, _), height), raised) in balls {
                    let deep = (*height - *raised - ball.height(&placed[k])).max(-*raised);
                    deepest = deepest.max(deep);
                    *height += deep;
                    *raised += deep;
                }
            }
        }
        Ok(deepest > SUNK)
    }

    /// Has a movement keep its soles over these.
    pub(super) fn keep_feet_over_ground(
        &self,
        footholds: &Footholds,
        motion: &mut MotionProblemBuilder<'_>,
    ) {
        for (sole, footings) in self.limbs.soles.iter().zip(&footholds.soles) {
            let task = motion.add(OverGround::new(sole, OVER, self.limbs.heaviest()));
            let footings = footings.clone();
            motion.follow(task, move |frame, own| own.set(&footings[frame]));
        }
    }
}
