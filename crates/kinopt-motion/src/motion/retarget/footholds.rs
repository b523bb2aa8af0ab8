//! Foot constraints at each sample of a whole trajectory.

use super::over_ground::{Footing, OverGround};
use super::retargeting::as_map_error;
use super::{RetargetError, Retargeting};
use crate::motion::trajectory::MotionProblemBuilder;
use kinopt_kinematics::kinematics::ForwardKinematics;
use kinopt_kinematics::model::FrameId;
use kinopt_kinematics::spatial::Placement;

/// Weight of ground penetration per metre, relative to the largest weight of a point; as large as that of contact
/// sliding.
const PENETRATION_WEIGHT: f64 = 200.0;
/// Allowed penetration of a locked foot beyond its reference, metres, because the cost is not smooth at the boundary.
const PENETRATION_SLACK: f64 = 2e-4;
/// Largest penetration of a reference, metres.
const MAX_REFERENCE_PENETRATION: f64 = 4e-4;

/// Penetration above which the ground under a foot is raised, metres.
const MAX_PENETRATION: f64 = 9e-4;

/// Task of each foot at each sample.
#[derive(Clone, Debug)]
pub(super) struct Footholds {
    soles: Vec<Vec<Footing>>,
    /// Raise of the ground under each ball, by foot and sample, metres.
    raised: Vec<Vec<f64>>,
}

impl Retargeting<'_> {
    /// Returns the poses of all feet at all samples.
    fn sole_poses(&self, q: &[f64]) -> Result<Vec<Vec<Placement<f64>>>, RetargetError> {
        let model = self.body.model();
        let soles = self.limbs.soles.iter().map(|sole| sole.frame);
        let frames: Vec<FrameId> = soles.collect();
        let mut kinematics = ForwardKinematics::of_frames(model, &frames).map_err(as_map_error)?;
        let frames = q.chunks_exact(model.configuration_len());
        let placed = frames.map(|q| Ok(kinematics.place(q).map_err(as_map_error)?.to_vec()));
        placed.collect()
    }

    /// Creates foot constraints from an online result. Feet stay above the ground.
    ///
    /// Feet with all limbs in contact keep their tilt from the online result. With an ankle lock alone, a leg at its
    /// limits would tip the foot.
    pub(super) fn footholds(&self, q: &[f64]) -> Result<Footholds, RetargetError> {
        let placed = self.sole_poses(q)?;
        let mut soles = Vec::with_capacity(self.limbs.soles.len());
        for (k, sole) in self.limbs.soles.iter().enumerate() {
            let spans = |limb: usize| {
                let contact = self
                    .limb_contacts
                    .iter()
                    .filter(move |contact| contact.limb == limb);
                contact.map(|contact| contact.span.clone())
            };
            let level = vec![0.0; sole.balls.len()];
            let ground = |frame: usize| self.frame_grounds(frame).get(k);
            let heights = |frame: usize| {
                ground(frame)
                    .map_or(&level, |ground| &ground.heights)
                    .clone()
            };
            let mut ground_heights: Vec<Vec<f64>> = (0..self.frames()).map(heights).collect();
            let mut contact_counts = vec![0; self.frames()];
            let lowest_ground =
                |frame: usize| heights(frame).into_iter().fold(f64::INFINITY, f64::min);
            for (ball, (shape, limb)) in sole.balls.iter().enumerate() {
                for span in spans(*limb) {
                    // The lowest height of the contact, so that a resting foot is not lifted.
                    let heights = placed[span.clone()].iter();
                    let heights = heights.map(|placed| shape.height(&placed[k]));
                    let lowest = heights
                        .fold(f64::INFINITY, f64::min)
                        .max(lowest_ground(span.start) - MAX_REFERENCE_PENETRATION);
                    for frame in span {
                        ground_heights[frame][ball] = lowest;
                        contact_counts[frame] += 1;
                    }
                }
            }
            let is_oriented = self.limbs.orients(sole);
            let mut footings: Vec<Footing> = Vec::with_capacity(self.frames());
            let mut locked_tilts: Option<Vec<f64>> = None;
            for (frame, heights) in ground_heights.into_iter().enumerate() {
                let is_locked = contact_counts[frame] == sole.balls.len();
                if !is_locked {
                    locked_tilts = None;
                    let levelling = match contact_counts[frame] {
                        0 if is_oriented => 0.0,
                        0 => 1.0,
                        _ => self.options.landing_weight,
                    };
                    let tilts = ground(frame).map(|ground| ground.tilts.clone());
                    footings.push(Footing::Above {
                        heights,
                        tilts: tilts.unwrap_or_default(),
                        levelling,
                    });
                    continue;
                }
                let tilts = locked_tilts
                    .take()
                    .unwrap_or_else(|| sole.tilts(&placed[frame][k]));
                footings.push(Footing::Locked {
                    tilts: tilts.clone(),
                    orientation_locked: false,
                    heights: heights
                        .iter()
                        .map(|height| height - PENETRATION_SLACK)
                        .collect(),
                });
                locked_tilts = Some(tilts);
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

    /// Raises the ground under feet that penetrate it, as in an augmented Lagrangian method. Returns whether a
    /// penetration was large.
    pub(super) fn raise_footholds(
        &self,
        q: &[f64],
        footholds: &mut Footholds,
    ) -> Result<bool, RetargetError> {
        let placed = self.sole_poses(q)?;
        let mut max_depth: f64 = 0.0;
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
                    let depth = (*height - *raised - ball.height(&placed[k])).max(-*raised);
                    max_depth = max_depth.max(depth);
                    *height += depth;
                    *raised += depth;
                }
            }
        }
        Ok(max_depth > MAX_PENETRATION)
    }

    /// Adds the foot constraints to a trajectory problem.
    pub(super) fn keep_feet_over_ground(
        &self,
        footholds: &Footholds,
        motion: &mut MotionProblemBuilder<'_>,
    ) {
        for (sole, footings) in self.limbs.soles.iter().zip(&footholds.soles) {
            let task = motion.add(OverGround::new(
                sole,
                PENETRATION_WEIGHT,
                self.limbs.max_weight(),
            ));
            let footings = footings.clone();
            motion.follow(task, move |frame, residual| residual.set(&footings[frame]));
        }
    }
}
