//! Retargeting of whole trajectories as one problem.

use std::sync::Arc;

use super::aligned_axis::AlignedAxis;
use super::contacts::LimbContact;
use super::driven_point::DrivenPoint;
use super::follower::{GRASP_WEIGHT, posture};
use super::footholds::Footholds;
use super::relative_limb;
use super::retargeting::as_map_error;
use super::{RetargetError, RetargetReport, Retargeting};
use crate::motion::contact::smooth;
use crate::motion::trajectory::{MotionProblem, MotionSolver, RateCost};
use kinopt_kinematics::Trajectory;
use kinopt_kinematics::kinematics::ForwardKinematics;
use kinopt_kinematics::spatial::Vector3;

/// Weight of a contact position in a whole trajectory, relative to the largest weight of a point.
const CONTACT_WEIGHT: f64 = 200.0;
/// Maximum number of iterations per window.
const MAX_ITERATIONS: usize = 40;
/// Maximum number of solves of a trajectory that ends in collision.
const MAX_COLLISION_PASSES: usize = 3;
/// Maximum number of additional solves with raised ground under penetrating feet.
const MAX_GROUND_CORRECTIONS: usize = 3;

/// Targets of a whole trajectory.
struct TrajectoryTargets {
    /// Target and weight of each driven point at each sample.
    points: Arc<[(Vector3<f64>, f64)]>,
    /// Directions of the driven axes at each sample.
    directions: Arc<[Vector3<f64>]>,
}

impl Retargeting<'_> {
    /// Solves the whole trajectory, which is smooth. Contacts are locked where the online result has them.
    ///
    /// # Errors
    /// Returns the errors of [`follower`](Self::follower) and of [`MotionSolver`].
    pub fn whole(&self) -> Result<Trajectory<RetargetReport>, RetargetError> {
        self.whole_with_progress(&mut |_| ())
    }

    /// Solves like [`whole`](Self::whole). `progress` receives the number of solved samples repeatedly.
    ///
    /// # Errors
    /// Returns the errors of [`whole`](Self::whole).
    pub fn whole_with_progress(
        &self,
        progress: &mut dyn FnMut(usize),
    ) -> Result<Trajectory<RetargetReport>, RetargetError> {
        if let Some(character) = self.rotated_character() {
            let q = character.whole(self.cancelled.as_deref())?;
            progress(self.frames());
            return self.measure(q);
        }
        let (mut q, mut avoidance) = self.follow_all()?;
        let targets = self.trajectory_targets(&q)?;
        // A smoothed trajectory may collide at other samples than the online result.
        for _ in 0..MAX_COLLISION_PASSES {
            self.extend_avoidance(&mut avoidance);
            let mut footholds = self.footholds(&q)?;
            q = self.smooth(&q, &targets, &footholds, &avoidance, progress)?;
            for _ in 0..MAX_GROUND_CORRECTIONS {
                if !self.raise_footholds(&q, &mut footholds)? {
                    break;
                }
                q = self.smooth(&q, &targets, &footholds, &avoidance, &mut |_| ())?;
            }
            let touching = self.touching(&q);
            if touching.is_empty() {
                break;
            }
            touching
                .iter()
                .for_each(|collision| avoidance[collision.frame] = true);
        }
        self.measure(q)
    }

    /// Marks all samples within the blend duration of a marked one.
    fn extend_avoidance(&self, avoidance: &mut [bool]) {
        let blend_frames = self.options.contacts.lead_frames(self.frame_rate);
        let marked = avoidance.to_vec();
        for (frame, _) in marked
            .iter()
            .enumerate()
            .filter(|(_, avoidance)| **avoidance)
        {
            let end = (frame + blend_frames + 1).min(avoidance.len());
            avoidance[frame.saturating_sub(blend_frames)..end].fill(true);
        }
    }

    /// Returns the smooth trajectory near `start`, with collision avoidance at the samples in `avoidance`.
    fn smooth(
        &self,
        start: &[f64],
        targets: &TrajectoryTargets,
        footholds: &Footholds,
        avoidance: &[bool],
        progress: &mut dyn FnMut(usize),
    ) -> Result<Vec<f64>, RetargetError> {
        let model = self.body.model();
        let mut motion = MotionProblem::builder(model, self.frames(), 1.0 / self.frame_rate);
        motion.parameters(self.body.map().clone());
        motion.max_speeds_of(&self.body);
        let n = self.limbs.all.len();
        for (k, limb) in self.limbs.all.iter().enumerate() {
            let point = motion.add(DrivenPoint::new(limb.frame, limb.offset));
            let weighted_targets = Arc::clone(&targets.points);
            motion.follow(point, move |frame, point| {
                let (target, weight) = weighted_targets[frame * n + k];
                point.set(target, weight);
            });
        }
        if let Some(line) = self.limbs.hip_line.clone() {
            let (task, targets) = (motion.add(line.task()), Arc::clone(&self.targets));
            motion.follow(task, move |frame, task| {
                line.set_direction(&targets[frame * n..(frame + 1) * n], task);
            });
        }
        for (k, limb) in self.limbs.all.iter().enumerate() {
            let (Some(task), Some(parent)) = (relative_limb::task(&self.limbs.all, k), limb.parent)
            else {
                continue;
            };
            let (task, targets) = (motion.add(task), Arc::clone(&self.targets));
            let grasps = Arc::clone(&self.grasps);
            motion.follow(task, move |frame, task| {
                task.set_target(targets[frame * n + k] - targets[frame * n + parent]);
                task.set_share(1.0 - grasps.get(frame * n + k).copied().unwrap_or(0.0));
            });
        }
        let driven: Vec<_> = self.limbs.orientations.driven().cloned().collect();
        for (k, axis) in driven.iter().enumerate() {
            let (weight, count) = (axis.weight, driven.len());
            let (task, directions) = (
                motion.add(AlignedAxis::new(axis.frame, axis.axis)),
                Arc::clone(&targets.directions),
            );
            motion.follow(task, move |frame, task| {
                task.set(directions[frame * count + k], weight)
            });
        }
        motion.add(posture(model));
        self.keep_feet_over_ground(footholds, &mut motion);
        if let Some(obstacles) = self
            .obstacles
            .as_ref()
            .filter(|_| avoidance.contains(&true))
        {
            obstacles.add_to_motion(&mut motion, avoidance.into());
        }
        motion.rate_cost(RateCost::acceleration(self.options.acceleration));
        let motion = motion.build()?;
        let solver = MotionSolver::default()
            .with_tolerance(self.options.tolerance)
            .with_curvature(false)
            .with_good_start()
            .with_max_iterations(MAX_ITERATIONS)
            .with_windows(Some(self.options.windows));
        let solved =
            solver.solve_near_unless(&motion, start, progress, self.cancelled.as_deref())?;
        Ok(solved.q)
    }

    /// Returns the targets of a trajectory near an online result.
    fn trajectory_targets(&self, q: &[f64]) -> Result<TrajectoryTargets, RetargetError> {
        let headed = self.headed_targets(q)?;
        Ok(TrajectoryTargets {
            points: self.weighted_targets(q, &headed.positions)?.into(),
            directions: headed.directions.into(),
        })
    }

    /// Returns target and weight of each driven point at each sample.
    ///
    /// Contacts have the positions of the online result, which are known to be reachable.
    fn weighted_targets(
        &self,
        q: &[f64],
        targets: &[Vector3<f64>],
    ) -> Result<Vec<(Vector3<f64>, f64)>, RetargetError> {
        let model = self.body.model();
        let n = self.limbs.all.len();
        let max_weight = self.limbs.max_weight();
        let weights = (0..n).map(|limb| relative_limb::point_weight(&self.limbs.all, limb));
        let mut weighted_targets: Vec<_> = targets.iter().copied().zip(weights.cycle()).collect();
        for ((_, weight), grasp) in weighted_targets.iter_mut().zip(&*self.grasps) {
            *weight += GRASP_WEIGHT * max_weight * grasp;
        }
        let mut kinematics =
            ForwardKinematics::of_frames(model, &self.driven()).map_err(as_map_error)?;
        let lead = self.options.contacts.lead_frames(self.frame_rate);
        let mut positions = Vec::with_capacity(self.limb_contacts.len());
        for LimbContact { limb, span } in &self.limb_contacts {
            let middle = (span.start + span.end) / 2;
            let width = model.configuration_len();
            let placed = kinematics
                .place(&q[middle * width..(middle + 1) * width])
                .map_err(as_map_error)?;
            let position = placed[*limb].apply(self.limbs.all[*limb].offset);
            positions.push(position);
            // Blends of the targets to and from the contact position.
            let offset = position - targets[middle * n + limb];
            for distance in 1..=lead {
                let shift = offset * (1.0 - smooth(distance as f64 / (lead + 1) as f64));
                let before = span.start.checked_sub(distance);
                let after = Some(span.end + distance - 1).filter(|frame| *frame < self.frames());
                for frame in before.into_iter().chain(after) {
                    let weighted_target = &mut weighted_targets[frame * n + limb];
                    weighted_target.0 += shift;
                }
            }
        }
        for (LimbContact { limb, span }, position) in self.limb_contacts.iter().zip(positions) {
            for frame in span.clone() {
                weighted_targets[frame * n + limb] = (position, CONTACT_WEIGHT * max_weight);
            }
        }
        Ok(weighted_targets)
    }
}
