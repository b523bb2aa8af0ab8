//! Retargeting of whole trajectories as one problem.

use std::sync::Arc;

use super::contacts::Standing;
use super::driven_point::DrivenPoint;
use super::follower::posture;
use super::footholds::Footholds;
use super::retargeting::as_map_error;
use super::{RetargetError, Retargeted, Retargeting};
use crate::kinematics::ForwardKinematics;
use crate::motion::contact_detection::smooth;
use crate::motion::trajectory::{MotionProblem, MotionSolver, RateCost};
use crate::spatial::Vector3;

/// Weight of a contact position in a whole trajectory, relative to the largest weight of a point.
const HELD: f64 = 200.0;
/// Maximum number of iterations per window.
const MOST_ITERATIONS: usize = 40;
/// Maximum number of solves of a trajectory that ends in collision.
const CLEAR_ROUNDS: usize = 3;
/// Maximum number of additional solves with raised ground under penetrating feet.
const PUSHES: usize = 3;

impl Retargeting<'_> {
    /// Solves the whole trajectory, which is smooth. Contacts are locked where the online result has them.
    ///
    /// # Errors
    /// Returns the errors of [`follower`](Self::follower) and of [`MotionSolver`].
    pub fn whole(&self) -> Result<Retargeted, RetargetError> {
        self.whole_with_progress(&mut |_| ())
    }

    /// Solves like [`whole`](Self::whole). `progress` receives the number of solved samples repeatedly.
    ///
    /// # Errors
    /// Returns the errors of [`whole`](Self::whole).
    pub fn whole_with_progress(
        &self,
        progress: &mut dyn FnMut(usize),
    ) -> Result<Retargeted, RetargetError> {
        let (mut q, mut near) = self.follow_all()?;
        let aims: Arc<[_]> = self.aims(&q)?.into();
        // A smoothed trajectory may collide at other samples than the online result.
        for _ in 0..CLEAR_ROUNDS {
            self.widen(&mut near);
            let mut footholds = self.footholds(&q)?;
            q = self.smooth(&q, &aims, &footholds, &near, progress)?;
            for _ in 0..PUSHES {
                if !self.raise_footholds(&q, &mut footholds)? {
                    break;
                }
                q = self.smooth(&q, &aims, &footholds, &near, &mut |_| ())?;
            }
            let touching = self.touching(&q);
            if touching.is_empty() {
                break;
            }
            touching.iter().for_each(|own| near[own.frame] = true);
        }
        self.measure(q)
    }

    /// Marks all samples within the blend duration of a marked one.
    fn widen(&self, near: &mut [bool]) {
        let reach = self.options.contacts.lead_frames(self.frame_rate);
        let known = near.to_vec();
        for (frame, _) in known.iter().enumerate().filter(|(_, near)| **near) {
            let end = (frame + reach + 1).min(near.len());
            near[frame.saturating_sub(reach)..end].fill(true);
        }
    }

    /// Returns the smooth trajectory near `start`, with collision avoidance at the samples in `near`.
    fn smooth(
        &self,
        start: &[f64],
        aims: &Arc<[(Vector3<f64>, f64)]>,
        footholds: &Footholds,
        near: &[bool],
        progress: &mut dyn FnMut(usize),
    ) -> Result<Vec<f64>, RetargetError> {
        let model = self.robot.model();
        let mut motion = MotionProblem::builder(model, self.frames(), 1.0 / self.frame_rate);
        motion.parameters(self.robot.map().clone());
        motion.max_speeds_of(self.robot);
        let n = self.limbs.all.len();
        for (k, limb) in self.limbs.all.iter().enumerate() {
            let point = motion.add(DrivenPoint::new(limb.frame, limb.offset));
            let aims = Arc::clone(aims);
            motion.follow(point, move |frame, point| {
                let (place, weight) = aims[frame * n + k];
                point.set(place, weight);
            });
        }
        if let Some(line) = self.limbs.hip_line.clone() {
            let (line, targets) = (motion.add(line), Arc::clone(&self.targets));
            motion.follow(line, move |frame, line| {
                line.aim(&targets[frame * n..(frame + 1) * n]);
            });
        }
        motion.add(posture(model));
        self.keep_feet_over_ground(footholds, &mut motion);
        if let Some(obstacles) = self.obstacles.as_ref().filter(|_| near.contains(&true)) {
            obstacles.add_to_motion(&mut motion, near.into());
        }
        motion.rate_cost(RateCost::acceleration(self.options.acceleration));
        let motion = motion.build()?;
        let solver = MotionSolver::default()
            .with_tolerance(self.options.tolerance)
            .with_curvature(false)
            .with_good_start()
            .with_max_iterations(MOST_ITERATIONS)
            .with_windows(Some(self.options.windows));
        let solved =
            solver.solve_near_unless(&motion, start, progress, self.cancelled.as_deref())?;
        Ok(solved.q().to_vec())
    }

    /// Returns target and weight of each driven point at each sample.
    ///
    /// Contacts have the positions of the online result, which are known to be reachable.
    fn aims(&self, q: &[f64]) -> Result<Vec<(Vector3<f64>, f64)>, RetargetError> {
        let model = self.robot.model();
        let n = self.limbs.all.len();
        let heaviest = self.limbs.heaviest();
        let weights = self.limbs.all.iter().map(|limb| limb.weight);
        let mut aims: Vec<_> = self.targets.iter().copied().zip(weights.cycle()).collect();
        let mut kinematics =
            ForwardKinematics::of_frames(model, &self.driven()).map_err(as_map_error)?;
        let lead = self.options.contacts.lead_frames(self.frame_rate);
        let mut stands = Vec::with_capacity(self.standing.len());
        for Standing { limb, span } in &self.standing {
            let middle = (span.start + span.end) / 2;
            let width = model.configuration_len();
            let placed = kinematics
                .place(&q[middle * width..(middle + 1) * width])
                .map_err(as_map_error)?;
            let place = placed[*limb].apply(self.limbs.all[*limb].offset);
            stands.push(place);
            // Blends of the targets to and from the contact position.
            let off = place - self.targets[middle * n + limb];
            for away in 1..=lead {
                let by = off * (1.0 - smooth(away as f64 / (lead + 1) as f64));
                let before = span.start.checked_sub(away);
                let after = Some(span.end + away - 1).filter(|frame| *frame < self.frames());
                for frame in before.into_iter().chain(after) {
                    let aim = &mut aims[frame * n + limb];
                    aim.0 += by;
                }
            }
        }
        for (Standing { limb, span }, place) in self.standing.iter().zip(stands) {
            for frame in span.clone() {
                aims[frame * n + limb] = (place, HELD * heaviest);
            }
        }
        Ok(aims)
    }
}
