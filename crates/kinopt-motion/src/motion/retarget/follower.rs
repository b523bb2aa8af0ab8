//! Online retargeter: follows target positions sample by sample.

use super::aligned_axis::AlignedAxis;
use super::collision_free_frames::CollisionFreeFrames;
use super::driven_point::DrivenPoint;
use super::feet::Feet;
use super::frame_problem::FrameProblem;
use super::frame_targets::FrameTargets;
use super::orientations::FootAxes;
use super::pelvis_heading::HipLine;
use super::point_difference::PointDifference;
use super::relative_limb;
use super::unit::Unit;
use super::{RetargetError, Retargeting};
use crate::motion::trajectory::{MotionError, step_limits};
use kinopt_kinematics::model::{JointId, Model};
use kinopt_kinematics::scalar::elementary;
use kinopt_kinematics::spatial::Vector3;
use kinopt_solver::problem::{Problem, ProblemError, Targets, TaskId};
use kinopt_solver::solver::dot;
use kinopt_solver::task::{Posture, Task};

/// Maximum number of iterations of the first sample, and of each later sample.
const FIRST_FRAME_ITERATIONS: usize = 300;
const FRAME_ITERATIONS: usize = 3;
/// Additional iterations if a contact slides or a foot penetrates the ground by more than `SLIDING_TOLERANCE` metres.
const EXTRA_ITERATIONS: usize = 6;
const SLIDING_TOLERANCE: f64 = 5e-4;
/// Maximum number of ground corrections if a foot still penetrates the ground, each with `EXTRA_ITERATIONS` iterations.
const MAX_GROUND_CORRECTIONS: usize = 10;
/// Penetration of a locked foot beyond which its orientation is locked, metres.
const MAX_PENETRATION: f64 = 1e-3;
/// Weight of a contact position relative to the largest weight of a point, so that other points do not move it
/// noticeably.
const CONTACT_WEIGHT: f64 = 300.0;

/// Weight of the position of a hand on an object, relative to the largest weight of a point.
pub(super) const GRASP_WEIGHT: f64 = 10.0;

/// Weight of the posture, in metres of position per radian.
const POSTURE_WEIGHT: f64 = 0.02;
/// Weight of the previous configuration, in metres of position per radian; prevents jitter of undetermined joints.
const PREVIOUS_POSE_WEIGHT: f64 = 0.1;

/// Online retargeter: follows target positions within the limits of position and velocity.
///
/// Points in contact are locked at their touchdown position.
#[derive(Clone, Debug)]
pub struct BodyFollower {
    frame: FrameProblem,
    avoidance: Option<CollisionFreeFrames>,
    targets: Targets,
    points: Vec<TaskId<DrivenPoint>>,
    hip_line: Option<(HipLine, TaskId<PointDifference>)>,
    /// Tasks of the limbs that follow the vector from their parents: limb, parent and task.
    vectors: Vec<(usize, usize, TaskId<PointDifference>)>,
    /// Tasks of the axes of feet and hands, with their weights.
    axes: Vec<(TaskId<AlignedAxis>, f64)>,
    feet: Feet,
    foot_axes: Vec<FootAxes>,
    /// Targets of the driven points and axes with reachable headings of the feet.
    headed_positions: Vec<Vector3<f64>>,
    headed_directions: Vec<Vector3<f64>>,
    /// Reference between the nominal posture and the previous configuration. `posture` has the nominal value of each
    /// coordinate.
    stay_task: TaskId<Posture>,
    posture: Vec<(usize, f64)>,
    reference: Vec<f64>,
    weights: Vec<f64>,
    /// Factor of a point's weight at touchdown.
    landing_weight: f64,
    /// Largest weight of a point.
    max_weight: f64,
    anchors: Vec<Option<Vector3<f64>>>,
    /// Offset of each released point from its target, and number of samples until it is zero.
    release_offsets: Vec<(Vector3<f64>, usize)>,
    release_frames: usize,
    max_steps: Vec<f64>,
    lower: Vec<f64>,
    upper: Vec<f64>,
    x: Vec<f64>,
    /// Configuration of the solved body, in its unit.
    body_q: Vec<f64>,
    unit: Unit,
    /// Indices of the values of a configuration that are lengths.
    length_coordinates: Vec<usize>,
    /// Configuration in the model's unit.
    q: Vec<f64>,
    has_solved: bool,
}

/// Creates the posture task for undetermined joints.
pub(super) fn posture(model: &Model) -> Task<Posture> {
    Task::new(Posture::of_joints(posture_joints(model))).scale(POSTURE_WEIGHT)
}

/// Returns the joints that are not part of a free base, with their neutral values.
fn posture_joints(model: &Model) -> impl Iterator<Item = (JointId, f64)> {
    let free = move |id: &JointId| {
        let free_joints = model.free_joints();
        free_joints
            .iter()
            .any(|free| (free.index()..free.index() + 4).contains(&id.index()))
    };
    let neutral = model.neutral();
    model.moving_joints().iter().filter_map(move |&id| {
        let joint = &model.joints()[id.index()];
        let is_included = joint.kind.moves() && joint.kind.coordinates() == 1 && !free(&id);
        Some((id, *neutral.get(model.coordinate(id)?)?)).filter(|_| is_included)
    })
}

impl BodyFollower {
    pub(super) fn new(retargeting: &Retargeting<'_>) -> Result<Self, RetargetError> {
        let (robot, limbs) = (&*retargeting.body, &retargeting.limbs);
        let lead_s = retargeting.options.contacts.lead_s;
        let model = robot.model();
        let mut tasks = Problem::builder(model);
        tasks.parameters(robot.map().clone());
        let points = limbs.all.iter();
        let points = points.map(|limb| tasks.add(DrivenPoint::new(limb.frame, limb.offset)));
        let points: Vec<_> = points.collect();
        let hip_line = limbs.hip_line.clone().map(|line| {
            let task = tasks.add(line.task());
            (line, task)
        });
        let vectors = (0..limbs.all.len()).filter_map(|limb| {
            let task = tasks.add(relative_limb::task(&limbs.all, limb)?);
            Some((limb, limbs.all[limb].parent?, task))
        });
        let vectors: Vec<_> = vectors.collect();
        let axes = limbs.orientations.driven();
        let axes = axes.map(|axis| {
            (
                tasks.add(AlignedAxis::new(axis.frame, axis.axis)),
                axis.weight,
            )
        });
        let axes: Vec<_> = axes.collect();
        let combined =
            (POSTURE_WEIGHT * POSTURE_WEIGHT + PREVIOUS_POSE_WEIGHT * PREVIOUS_POSE_WEIGHT).sqrt();
        let stay_task =
            tasks.add(Task::new(Posture::of_joints(posture_joints(model))).scale(combined));
        let posture =
            posture_joints(model).filter_map(|(id, value)| Some((model.coordinate(id)?, value)));
        let posture: Vec<_> = posture.collect();
        let landing_weight = retargeting.options.landing_weight;
        let feet = Feet::new(limbs, landing_weight, &mut tasks);
        if let Some(obstacles) = &retargeting.obstacles {
            obstacles.add_to(&mut tasks);
        }
        let problem = tasks.build()?;
        let x = vec![0.0; problem.variables()];
        let q = model.neutral();
        let speeds = robot.moves_within(1.0);
        let weights =
            (0..limbs.all.len()).map(|limb| relative_limb::point_weight(&limbs.all, limb));
        let weights: Vec<f64> = weights.collect();
        let size = weights
            .iter()
            .fold(POSTURE_WEIGHT * POSTURE_WEIGHT, |sum, weight| {
                sum + weight * weight
            });
        let moves = step_limits(&problem, &speeds, 1.0 / retargeting.frame_rate)?;
        if let Some(joint) = moves.first_length_limit(&problem) {
            return Err(RetargetError::Motion(MotionError::SpeedOfBall { joint }));
        }
        Ok(Self {
            max_steps: moves.max_step,
            lower: problem.lower().to_vec(),
            upper: problem.upper().to_vec(),
            targets: problem.targets(),
            weights,
            anchors: vec![None; points.len()],
            release_offsets: vec![(Vector3::zero(), 0); points.len()],
            release_frames: (lead_s * retargeting.frame_rate).ceil() as usize,
            avoidance: problem
                .collision_constraint()
                .map(|fence| CollisionFreeFrames::new(fence, problem.rows(), size)),
            has_solved: false,
            reference: posture.iter().map(|(_, value)| *value).collect(),
            posture,
            stay_task,
            feet,
            foot_axes: limbs.orientations.foot_axes().cloned().collect(),
            headed_positions: Vec::new(),
            headed_directions: Vec::new(),
            landing_weight,
            max_weight: limbs.max_weight(),
            points,
            hip_line,
            vectors,
            axes,
            frame: FrameProblem::new(problem, size),
            x,
            unit: retargeting.unit,
            length_coordinates: model.slides().collect(),
            q: q.clone(),
            body_q: q,
        })
    }

    /// Current configuration.
    #[must_use]
    pub fn q(&self) -> &[f64] {
        &self.q
    }

    /// State of collision avoidance, if it is enabled.
    #[must_use]
    pub(super) fn avoidance(&self) -> Option<&CollisionFreeFrames> {
        self.avoidance.as_ref()
    }

    /// Number of points that are followed.
    #[must_use]
    pub fn places(&self) -> usize {
        self.points.len()
    }

    /// Sets the configuration from which the first sample is solved.
    pub(super) fn set_configuration(&mut self, q: &[f64]) {
        self.frame.problem().parameters().gather(q, &mut self.x);
    }

    /// Solves one sample and returns the configuration.
    ///
    /// `positions` are the target positions of the driven points, in the model's unit. The second list has their
    /// contacts, from 0 (free) to 1 (locked in place). Both are in the order of
    /// [`Retargeting::driven`](super::Retargeting::driven). If a target is not finite, the configuration stays
    /// unchanged.
    ///
    /// # Errors
    /// Returns an error if the number of targets or contacts is wrong.
    pub fn advance(
        &mut self,
        positions: &[Vector3<f64>],
        contacts: &[f64],
    ) -> Result<&[f64], RetargetError> {
        match self.unit.is_identity() {
            true => self.follow(&FrameTargets::of_points(positions, contacts))?,
            false => {
                let scale = self.unit.scale();
                let positions: Vec<_> =
                    positions.iter().map(|position| *position * scale).collect();
                self.follow(&FrameTargets::of_points(&positions, contacts))?
            }
        };
        Ok(&self.q)
    }

    /// Solves one sample with targets in the unit of the solved body. Returns its configuration.
    pub(super) fn follow(&mut self, frame: &FrameTargets<'_>) -> Result<&[f64], RetargetError> {
        let &FrameTargets {
            positions,
            contacts,
            grounds,
            ..
        } = frame;
        let n = self.points.len();
        for (given, what) in [
            (positions.len(), "target positions"),
            (contacts.len(), "contacts"),
        ] {
            if given != n {
                return Err(RetargetError::Motion(MotionError::Length {
                    what: what.to_owned(),
                    given,
                    expected: n,
                }));
            }
        }
        // Locked points stay locked.
        if !positions.iter().all(Vector3::is_finite)
            || contacts.iter().any(|contact| contact.is_nan())
        {
            return Ok(&self.body_q);
        }
        let (positions, directions) = self.headed_targets(frame);
        let headed = FrameTargets {
            positions: &positions,
            directions: &directions,
            ..*frame
        };
        self.set_targets(&headed)?;
        (self.headed_positions, self.headed_directions) = (positions, directions);
        let mut solved = self.descend();
        if solved && self.feet.lock_orientations(&self.anchors, MAX_PENETRATION) {
            self.feet
                .set_targets(&mut self.targets, &self.anchors, contacts, grounds)?;
            solved = self.descend();
        }
        if solved {
            self.lock_contacts(contacts)?;
        }
        let problem = self.frame.problem();
        let limits = problem.lower().iter().zip(problem.upper());
        let bounds = self.lower.iter_mut().zip(&mut self.upper);
        for ((&x, &max_step), ((lower, upper), (&low, &high))) in
            self.x.iter().zip(&self.max_steps).zip(bounds.zip(limits))
        {
            (*lower, *upper) = ((x - max_step).max(low), (x + max_step).min(high));
        }
        self.has_solved = true;
        Ok(&self.body_q)
    }

    /// Solves for the current targets. Returns false and keeps the configuration if a number is not finite.
    fn descend(&mut self) -> bool {
        let steps = if self.has_solved {
            FRAME_ITERATIONS
        } else {
            FIRST_FRAME_ITERATIONS
        };
        let (anchors, feet, targets) = (&self.anchors, &self.feet, &mut self.targets);
        let slipped = |problem: &Problem, residual: &[f64]| {
            let tasks = problem.compiled_tasks().iter().zip(anchors);
            tasks
                .filter(|(_, anchor)| anchor.is_some())
                .any(|(task, _)| {
                    let error = &residual[task.rows.clone()];
                    dot(error, error).sqrt() > SLIDING_TOLERANCE * CONTACT_WEIGHT * self.max_weight
                })
        };
        let within = [self.lower.as_slice(), &self.upper];
        let mut follow = |frame: &mut FrameProblem, x: &mut [f64]| {
            let mut solved = frame.descend(targets, within, x, steps);
            let (problem, residual) = (frame.problem(), frame.residual());
            let needs_more =
                slipped(problem, residual) || feet.penetrates(problem, residual, SLIDING_TOLERANCE);
            if solved && needs_more {
                solved = frame.descend(targets, within, x, EXTRA_ITERATIONS);
            }
            for _ in 0..MAX_GROUND_CORRECTIONS {
                let (problem, residual) = (frame.problem(), frame.residual());
                if !solved || !feet.raise_ground(targets, problem, residual, SLIDING_TOLERANCE) {
                    break;
                }
                solved = frame.descend(targets, within, x, EXTRA_ITERATIONS);
            }
            solved
        };
        let solved = match &mut self.avoidance {
            None => follow(&mut self.frame, &mut self.x),
            Some(avoidance) => avoidance.follow(&mut self.frame, within, &mut self.x, follow),
        };
        if solved {
            let parameters = self.frame.problem().parameters();
            parameters.scatter_within_limits(&self.x, &mut self.body_q);
            self.q.copy_from_slice(&self.body_q);
            for &slide in &self.length_coordinates {
                self.q[slide] *= self.unit.inverse_scale();
            }
            self.feet.store_poses(&mut self.frame, &self.x);
        }
        solved
    }

    /// Returns the targets of points and axes with headings near those of the feet.
    fn headed_targets(
        &mut self,
        frame: &FrameTargets<'_>,
    ) -> (Vec<Vector3<f64>>, Vec<Vector3<f64>>) {
        let mut positions = std::mem::take(&mut self.headed_positions);
        let mut directions = std::mem::take(&mut self.headed_directions);
        positions.clear();
        positions.extend_from_slice(frame.positions);
        directions.clear();
        directions.extend_from_slice(frame.directions);
        if self.has_solved {
            let feet = self.foot_axes.iter().zip(self.axes.chunks_exact(2));
            for ((foot, axes), directions) in feet.zip(directions.chunks_exact_mut(2)) {
                let (task, _) = axes[0];
                if let Some(pose) = self.frame.first_frame(&self.x, task.index()) {
                    foot.limit_heading(&pose.rotation, directions, &mut positions);
                }
            }
        }
        (positions, directions)
    }

    /// Sets all targets: locked points stay, released ones blend back to their targets.
    fn set_targets(&mut self, frame: &FrameTargets<'_>) -> Result<(), RetargetError> {
        let &FrameTargets {
            positions,
            directions,
            contacts,
            grasps,
            grounds,
        } = frame;
        let grasp = |limb: usize| grasps.get(limb).copied().unwrap_or(0.0);
        for &(limb, parent, task) in &self.vectors {
            let target = positions[limb] - positions[parent];
            let task = self.targets.get_mut(task)?;
            task.set_target(target);
            task.set_share(1.0 - grasp(limb));
        }
        for (&(task, weight), direction) in self.axes.iter().zip(directions) {
            self.targets.get_mut(task)?.set(*direction, weight);
        }
        for (k, (&position, &contact)) in positions.iter().zip(contacts).enumerate() {
            let locked = contact >= 1.0;
            if let (false, Some(anchor)) = (locked, self.anchors[k]) {
                self.anchors[k] = None;
                self.release_offsets[k] = (anchor - position, self.release_frames);
            }
            let target = match self.anchors[k] {
                Some(anchor) => anchor,
                None => position + self.release_offset(k),
            };
            let base_weight = self.weights[k].max(f64::MIN_POSITIVE);
            let weight = match self.anchors[k] {
                Some(_) => CONTACT_WEIGHT * self.max_weight,
                // Continuous from 1 to the touchdown weight.
                None => {
                    let landing = elementary::pow(self.landing_weight, contact.clamp(0.0, 1.0));
                    base_weight * landing + GRASP_WEIGHT * self.max_weight * grasp(k)
                }
            };
            let point = self.targets.get_mut(self.points[k])?;
            point.set(target, weight);
        }
        self.feet
            .set_targets(&mut self.targets, &self.anchors, contacts, grounds)?;
        if let Some((line, task)) = &self.hip_line {
            line.set_direction(positions, self.targets.get_mut(*task)?);
        }
        if self.has_solved {
            let ratio = PREVIOUS_POSE_WEIGHT * PREVIOUS_POSE_WEIGHT
                / (POSTURE_WEIGHT * POSTURE_WEIGHT + PREVIOUS_POSE_WEIGHT * PREVIOUS_POSE_WEIGHT);
            for (reference, (coordinate, value)) in self.reference.iter_mut().zip(&self.posture) {
                *reference = value + ratio * (self.body_q[*coordinate] - value);
            }
            self.targets
                .get_mut(self.stay_task)?
                .set_reference(&self.reference)
                .map_err(ProblemError::from)?;
        }
        Ok(())
    }

    /// Returns the offset of a released point from its target at this sample.
    fn release_offset(&mut self, k: usize) -> Vector3<f64> {
        let (offset, frames) = &mut self.release_offsets[k];
        if *frames == 0 {
            return Vector3::zero();
        }
        let fraction = *frames as f64 / (self.release_frames + 1) as f64;
        *frames -= 1;
        *offset * (fraction * fraction * (3.0 - 2.0 * fraction))
    }

    /// Locks new contacts at their current position.
    fn lock_contacts(&mut self, contacts: &[f64]) -> Result<(), RetargetError> {
        let new = |k: &usize| contacts[*k] >= 1.0 && self.anchors[*k].is_none();
        let new: Vec<usize> = (0..contacts.len()).filter(new).collect();
        if new.is_empty() {
            return Ok(());
        }
        let mut residual = vec![0.0; self.frame.problem().rows()];
        self.frame
            .residual_at(&self.targets, &self.x, &mut residual);
        for &k in &new {
            let rows = self.frame.problem().compiled_tasks()[k].rows.clone();
            let point = self.targets.get(self.points[k])?;
            self.anchors[k] = Some(point.position(&residual[rows]));
        }
        self.feet.update_ground_heights(&new, &self.anchors);
        Ok(())
    }
}
