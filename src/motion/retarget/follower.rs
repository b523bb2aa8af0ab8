//! Online retargeter: follows target positions sample by sample.

use super::clear_frames::ClearFrames;
use super::driven_point::DrivenPoint;
use super::feet::Feet;
use super::frame_problem::ProblemOfFrame;
use super::pelvis_heading::HipLine;
use super::unit::Unit;
use super::{RetargetError, Retargeting};
use crate::model::{JointId, Model};
use crate::motion::trajectory::{MotionError, step_limits};
use crate::problem::{Problem, ProblemError, Targets, TaskId};
use crate::scalar::elementary;
use crate::solver::dot;
use crate::spatial::Vector3;
use crate::task::{Posture, Task};

/// Maximum number of iterations of the first sample, and of each later sample.
const FIRST_STEPS: usize = 300;
const STEPS: usize = 3;
/// Additional iterations if a contact slides or a foot penetrates the ground by more than `SLIPPED` metres.
const MORE_STEPS: usize = 6;
const SLIPPED: f64 = 5e-4;
/// Maximum number of ground corrections if a foot still penetrates the ground, each with `MORE_STEPS` iterations.
const PUSHES: usize = 10;
/// Penetration of a locked foot beyond which its orientation is locked, metres.
const SUNK: f64 = 1e-3;
/// Weight of a contact position relative to the largest weight of a point, so that other points do not move it
/// noticeably.
const HELD: f64 = 300.0;

/// Weight of the posture, in metres of position per radian.
const POSTURE: f64 = 0.02;
/// Weight of the previous configuration, in metres of position per radian; prevents jitter of undetermined joints.
const STAY: f64 = 0.1;

/// Online retargeter: follows target positions within the limits of position and velocity.
///
/// Points in contact are locked at their touchdown position.
#[derive(Clone, Debug)]
pub struct BodyFollower {
    frame: ProblemOfFrame,
    clear: Option<ClearFrames>,
    targets: Targets,
    points: Vec<TaskId<DrivenPoint>>,
    hip_line: Option<TaskId<HipLine>>,
    feet: Feet,
    /// Reference between the nominal posture and the previous configuration. `posture` has the nominal value of each
    /// coordinate.
    stay: TaskId<Posture>,
    posture: Vec<(usize, f64)>,
    reference: Vec<f64>,
    weights: Vec<f64>,
    /// Factor of a point's weight at touchdown.
    landing_weight: f64,
    /// Largest weight of a point.
    heaviest: f64,
    anchors: Vec<Option<Vector3<f64>>>,
    /// Offset of each released point from its target, and number of samples until it is zero.
    left: Vec<(Vector3<f64>, usize)>,
    release: usize,
    most: Vec<f64>,
    lower: Vec<f64>,
    upper: Vec<f64>,
    x: Vec<f64>,
    /// Configuration of the solved body, in its unit.
    body_q: Vec<f64>,
    unit: Unit,
    /// Indices of the values of a configuration that are lengths.
    slides: Vec<usize>,
    /// Configuration in the model's unit.
    q: Vec<f64>,
    followed: bool,
}

/// Creates the posture task for undetermined joints.
pub(super) fn posture(model: &Model) -> Task<Posture> {
    Task::new(Posture::of_joints(hinges(model))).scale(POSTURE)
}

/// Returns the joints that are not part of a free base, with their neutral values.
fn hinges(model: &Model) -> impl Iterator<Item = (JointId, f64)> {
    let free = move |id: &JointId| {
        let first = model.free_joints();
        first
            .iter()
            .any(|free| (free.index()..free.index() + 4).contains(&id.index()))
    };
    let neutral = model.neutral();
    model.moving_joints().iter().filter_map(move |&id| {
        let joint = &model.joints()[id.index()];
        let counts = joint.kind.moves() && joint.kind.coordinates() == 1 && !free(&id);
        Some((id, *neutral.get(model.coordinate(id)?)?)).filter(|_| counts)
    })
}

impl BodyFollower {
    pub(super) fn new(asked: &Retargeting<'_>) -> Result<Self, RetargetError> {
        let (robot, limbs) = (&*asked.body, &asked.limbs);
        let lead_s = asked.options.contacts.lead_s;
        let model = robot.model();
        let mut tasks = Problem::builder(model);
        tasks.parameters(robot.map().clone());
        let points = limbs.all.iter();
        let points = points.map(|limb| tasks.add(DrivenPoint::new(limb.frame, limb.offset)));
        let points: Vec<_> = points.collect();
        let hip_line = limbs.hip_line.clone().map(|line| tasks.add(line));
        let both = (POSTURE * POSTURE + STAY * STAY).sqrt();
        let stay = tasks.add(Task::new(Posture::of_joints(hinges(model))).scale(both));
        let posture = hinges(model).filter_map(|(id, value)| Some((model.coordinate(id)?, value)));
        let posture: Vec<_> = posture.collect();
        let landing_weight = asked.options.landing_weight;
        let feet = Feet::new(limbs, landing_weight, &mut tasks);
        if let Some(obstacles) = &asked.obstacles {
            obstacles.add_to(&mut tasks);
        }
        let problem = tasks.build()?;
        let x = vec![0.0; problem.variables()];
        let q = model.neutral();
        let speeds = robot.moves_within(1.0);
        let weights: Vec<f64> = limbs.all.iter().map(|limb| limb.weight).collect();
        let size = weights
            .iter()
            .fold(POSTURE * POSTURE, |sum, own| sum + own * own);
        let moves = step_limits(&problem, &speeds, 1.0 / asked.frame_rate)?;
        if let Some(joint) = moves.first_together(&problem) {
            return Err(RetargetError::Motion(MotionError::SpeedOfBall { joint }));
        }
        Ok(Self {
            most: moves.most,
            lower: problem.lower().to_vec(),
            upper: problem.upper().to_vec(),
            targets: problem.targets(),
            weights,
            anchors: vec![None; points.len()],
            left: vec![(Vector3::zero(), 0); points.len()],
            release: (lead_s * asked.frame_rate).ceil() as usize,
            clear: problem
                .collision_constraint()
                .map(|fence| ClearFrames::new(fence, problem.rows(), size)),
            followed: false,
            reference: posture.iter().map(|(_, value)| *value).collect(),
            posture,
            stay,
            feet,
            landing_weight,
            heaviest: limbs.heaviest(),
            points,
            hip_line,
            frame: ProblemOfFrame::new(problem, size),
            x,
            unit: asked.unit,
            slides: model.slides().collect(),
            q: q.clone(),
            body_q: q,
        })
    }

    getters! {
        /// Current configuration.
        pub fn q(&self) -> &[f64] = &self.q;
        /// State of collision avoidance, if it is enabled.
        pub(super) fn clear(&self) -> Option<&ClearFrames> = self.clear.as_ref();
        /// Number of points that are followed.
        pub fn places(&self) -> usize = self.points.len();
    }

    /// Sets the configuration from which the first sample is solved.
    pub(super) fn set_configuration(&mut self, q: &[f64]) {
        self.frame.problem().parameters().gather(q, &mut self.x);
    }

    /// Solves one sample and returns the configuration.
    ///
    /// `places` are the target positions of the driven points, in the model's unit. The second list has their contacts,
    /// from 0 (free) to 1 (locked in place). Both are in the order of
    /// [`Retargeting::driven`](super::Retargeting::driven). If a target is not finite, the configuration stays unchanged.
    ///
    /// # Errors
    /// Returns an error if the number of targets or contacts is wrong.
    pub fn advance(
        &mut self,
        places: &[Vector3<f64>],
        stands: &[f64],
    ) -> Result<&[f64], RetargetError> {
        match self.unit.is_identity() {
            true => self.follow(places, stands)?,
            false => {
                let scale = self.unit.scale();
                let places: Vec<_> = places.iter().map(|at| *at * scale).collect();
                self.follow(&places, stands)?
            }
        };
        Ok(&self.q)
    }

    /// Solves one sample with targets in the unit of the solved body. Returns its configuration.
    pub(super) fn follow(
        &mut self,
        places: &[Vector3<f64>],
        stands: &[f64],
    ) -> Result<&[f64], RetargetError> {
        let n = self.points.len();
        for (given, what) in [
            (places.len(), "target positions"),
            (stands.len(), "contacts"),
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
        if !places.iter().all(Vector3::is_finite) || stands.iter().any(|stands| stands.is_nan()) {
            return Ok(&self.body_q);
        }
        self.aim(places, stands)?;
        let mut whole = self.descend();
        if whole && self.feet.hold_firmly(&self.anchors, SUNK) {
            self.feet.aim(&mut self.targets, &self.anchors, stands)?;
            whole = self.descend();
        }
        if whole {
            self.anchor(stands)?;
        }
        let problem = self.frame.problem();
        let limits = problem.lower().iter().zip(problem.upper());
        let bounds = self.lower.iter_mut().zip(&mut self.upper);
        for ((&x, &most), ((lower, upper), (&low, &high))) in
            self.x.iter().zip(&self.most).zip(bounds.zip(limits))
        {
            (*lower, *upper) = ((x - most).max(low), (x + most).min(high));
        }
        self.followed = true;
        Ok(&self.body_q)
    }

    /// Solves for the current targets. Returns false and keeps the configuration if a number is not finite.
    fn descend(&mut self) -> bool {
        let steps = if self.followed { STEPS } else { FIRST_STEPS };
        let (anchors, feet, targets) = (&self.anchors, &self.feet, &mut self.targets);
        let slipped = |problem: &Problem, residual: &[f64]| {
            let tasks = problem.compiled_tasks().iter().zip(anchors);
            tasks
                .filter(|(_, anchor)| anchor.is_some())
                .any(|(task, _)| {
                    let miss = &residual[task.rows.clone()];
                    dot(miss, miss).sqrt() > SLIPPED * HELD * self.heaviest
                })
        };
        let within = [self.lower.as_slice(), &self.upper];
        let mut follow = |frame: &mut ProblemOfFrame, x: &mut [f64]| {
            let mut whole = frame.descend(targets, within, x, steps);
            let (problem, residual) = (frame.problem(), frame.residual());
            let off = slipped(problem, residual) || feet.is_sunk(problem, residual, SLIPPED);
            if whole && off {
                whole = frame.descend(targets, within, x, MORE_STEPS);
            }
            for _ in 0..PUSHES {
                let (problem, residual) = (frame.problem(), frame.residual());
                if !whole || !feet.push_out(targets, problem, residual, SLIPPED) {
                    break;
                }
                whole = frame.descend(targets, within, x, MORE_STEPS);
            }
            whole
        };
        let whole = match &mut self.clear {
            None => follow(&mut self.frame, &mut self.x),
            Some(clear) => clear.follow(&mut self.frame, within, &mut self.x, follow),
        };
        if whole {
            let parameters = self.frame.problem().parameters();
            parameters.scatter_within_limits(&self.x, &mut self.body_q);
            self.q.copy_from_slice(&self.body_q);
            for &slide in &self.slides {
                self.q[slide] *= self.unit.back();
            }
            self.feet.place(&mut self.frame, &self.x);
        }
        whole
    }

    /// Sets all targets: locked points stay, released ones blend back to their targets.
    fn aim(&mut self, places: &[Vector3<f64>], stands: &[f64]) -> Result<(), RetargetError> {
        for (k, (&place, &stands)) in places.iter().zip(stands).enumerate() {
            let held = stands >= 1.0;
            if let (false, Some(anchor)) = (held, self.anchors[k]) {
                self.anchors[k] = None;
                self.left[k] = (anchor - place, self.release);
            }
            let target = match self.anchors[k] {
                Some(anchor) => anchor,
                None => place + self.still_left(k),
            };
            let own = self.weights[k].max(f64::MIN_POSITIVE);
            let weight = match self.anchors[k] {
                Some(_) => HELD * self.heaviest,
                // Continuous from 1 to the touchdown weight.
                None => own * elementary::pow(self.landing_weight, stands.clamp(0.0, 1.0)),
            };
            let point = self.targets.get_mut(self.points[k])?;
            point.set(target, weight);
        }
        self.feet.aim(&mut self.targets, &self.anchors, stands)?;
        if let Some(line) = self.hip_line {
            self.targets.get_mut(line)?.aim(places);
        }
        if self.followed {
            let share = STAY * STAY / (POSTURE * POSTURE + STAY * STAY);
            for (reference, (coordinate, value)) in self.reference.iter_mut().zip(&self.posture) {
                *reference = value + share * (self.body_q[*coordinate] - value);
            }
            self.targets
                .get_mut(self.stay)?
                .set_reference(&self.reference)
                .map_err(ProblemError::from)?;
        }
        Ok(())
    }

    /// Returns the offset of a released point from its target at this sample.
    fn still_left(&mut self, k: usize) -> Vector3<f64> {
        let (off, frames) = &mut self.left[k];
        if *frames == 0 {
            return Vector3::zero();
        }
        let share = *frames as f64 / (self.release + 1) as f64;
        *frames -= 1;
        *off * (share * share * (3.0 - 2.0 * share))
    }

    /// Locks new contacts at their current position.
    fn anchor(&mut self, stands: &[f64]) -> Result<(), RetargetError> {
        let new = |k: &usize| stands[*k] >= 1.0 && self.anchors[*k].is_none();
        let new: Vec<usize> = (0..stands.len()).filter(new).collect();
        if new.is_empty() {
            return Ok(());
        }
        let mut residual = vec![0.0; self.frame.problem().rows()];
        self.frame
            .residual_at(&self.targets, &self.x, &mut residual);
        for &k in &new {
            let rows = self.frame.problem().compiled_tasks()[k].rows.clone();
            let point = self.targets.get(self.points[k])?;
            self.anchors[k] = Some(point.place(&residual[rows]));
        }
        self.feet.land(&new, &self.anchors);
        Ok(())
    }
}
