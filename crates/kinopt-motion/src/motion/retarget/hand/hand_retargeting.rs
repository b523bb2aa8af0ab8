//! Retargeting of a captured hand.

use super::hand_map::HandMap;
use super::{Finger, palm};
use crate::motion::contact::smooth;
use crate::motion::retarget::driven_point::DrivenPoint;
use crate::motion::retarget::frame_problem::FrameProblem;
use crate::motion::retarget::limb_lengths::quantile;
use crate::motion::retarget::limb_tree::joints_above;
use crate::motion::retarget::point_difference::PointDifference;
use crate::motion::retarget::retargeting::as_map_error;
use crate::motion::retarget::{Capture, RetargetError};
use crate::motion::trajectory::step_limits;
use kinopt_kinematics::Trajectory;
use kinopt_kinematics::kinematics::ForwardKinematics;
use kinopt_kinematics::model::{FrameId, JointId, Model, Source};
use kinopt_kinematics::spatial::{Matrix3, Placement, Vector3};
use kinopt_robot::robot::Robot;
use kinopt_solver::problem::{Problem, ProblemError, Targets, TaskId};
use kinopt_solver::task::{Posture, Task};

/// Maximum number of iterations of the first frame, and of each later frame.
const FIRST_FRAME_ITERATIONS: usize = 100;
const FRAME_ITERATIONS: usize = 4;
/// Number of random configurations in which a finger is measured, and the quantile that counts as its length.
const SAMPLES: u64 = 256;
const LENGTH_QUANTILE: f64 = 0.95;
/// Distances of the subject's fingertips from the thumb between which they approach a pinch, relative to the length of
/// the middle finger.
const PINCH_DISTANCES: [f64; 2] = [0.2, 0.6];
/// Weights of the vectors from the thumb: of open fingers and of a pinch, relative to those from the base.
const THUMB_WEIGHTS: [f64; 2] = [0.5, 4.0];
/// Weights of the neutral and of the previous configuration, relative to the length of a finger, per radian.
const POSTURE_SHARE: f64 = 0.02;
const PREVIOUS_SHARE: f64 = 0.05;

/// Finger of the subject and of the robot hand.
#[derive(Clone, Copy, Debug)]
struct DrivenFinger {
    /// Captured joints.
    base: usize,
    tip: usize,
    frame: FrameId,
    /// Base of the robot's finger, metres.
    robot_base: Vector3<f64>,
    /// Ratio of the lengths of both fingers.
    scale: f64,
}

/// Scales and axes of both hands.
#[derive(Clone, Debug)]
struct Hands {
    wrist: usize,
    joints: usize,
    /// The thumb is the first.
    fingers: Vec<DrivenFinger>,
    /// Axes of the robot's palm as columns; mirrored for a hand of the other side.
    robot_axes: Matrix3<f64>,
    /// Distances between which a pinch begins, in the capture's unit.
    pinch: [f64; 2],
    /// Length of the robot's middle finger, or of the last one, metres.
    length: f64,
}

/// Measures of a retargeted hand.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct HandReport {
    /// Samples per second.
    pub frame_rate: f64,
    /// Mean distance of fingertips from the scaled ones of the subject, metres.
    pub tip_error: f64,
    /// Mean distance of a fingertip from the thumb's while the subject pinches, metres; 0 without a pinch.
    pub pinch_distance: f64,
    /// Ratio of each robot finger's length to the subject's, from the thumb outward.
    pub scales: Vec<f64>,
}

/// Captured hand fitted to a robot hand.
#[derive(Clone, Debug)]
pub struct HandRetargeting<'r> {
    robot: &'r Robot,
    capture: Capture,
    hands: Hands,
}

/// Online retargeter of a hand: one capture frame in, one configuration out.
#[derive(Clone, Debug)]
pub struct HandFollower {
    frame: FrameProblem,
    targets: Targets,
    tips: Vec<TaskId<DrivenPoint>>,
    /// Vectors from the thumb to the other tips.
    vectors: Vec<TaskId<PointDifference>>,
    previous: TaskId<Posture>,
    coordinates: Vec<usize>,
    reference: Vec<f64>,
    max_steps: Vec<f64>,
    /// Position limits of the variables, and their bounds in the next frame.
    limits: (Vec<f64>, Vec<f64>),
    lower: Vec<f64>,
    upper: Vec<f64>,
    x: Vec<f64>,
    q: Vec<f64>,
    hands: Hands,
    has_solved: bool,
    tip_targets: Vec<Vector3<f64>>,
    pinch_levels: Vec<f64>,
}

impl<'r> HandRetargeting<'r> {
    /// Fits a captured hand to a robot hand on a fixed base: measures scales and axes of both.
    ///
    /// Joints above all fingers, such as those of a wrist, stay in the neutral configuration.
    ///
    /// # Errors
    /// Returns an error if the map lacks the thumb or two more fingers, or a name of it does not exist. Returns an error
    /// if a hand has no palm: its finger bases are on one line.
    pub fn new(robot: &'r Robot, map: &HandMap, capture: &Capture) -> Result<Self, RetargetError> {
        map.check()?;
        let hands = Hands::new(robot, map, capture)?;
        Ok(Self {
            robot,
            capture: capture.clone(),
            hands,
        })
    }

    /// Creates an online retargeter that starts in the neutral configuration.
    ///
    /// # Errors
    /// Returns an error if a velocity limit is invalid.
    pub fn live(&self) -> Result<HandFollower, RetargetError> {
        HandFollower::new(self.robot, self.hands.clone(), self.capture.frame_rate())
    }

    /// Retargets all capture frames, one by one.
    ///
    /// # Errors
    /// Returns the errors of [`live`](Self::live).
    pub fn per_frame(&self) -> Result<Trajectory<HandReport>, RetargetError> {
        let mut follower = self.live()?;
        let model = self.robot.model();
        let frames: Vec<FrameId> = self
            .hands
            .fingers
            .iter()
            .map(|finger| finger.frame)
            .collect();
        let mut kinematics = ForwardKinematics::of_frames(model, &frames).map_err(as_map_error)?;
        let (mut q, mut tip_errors, mut pinches) = (Vec::new(), Vec::new(), Vec::new());
        let (mut targets, mut levels) = (Vec::new(), Vec::new());
        for captured in (0..self.capture.frames()).filter_map(|frame| self.capture.frame(frame)) {
            q.extend_from_slice(follower.step(captured)?);
            let placed = kinematics.place(follower.q()).map_err(as_map_error)?;
            self.hands
                .write_targets(captured, &mut targets, &mut levels);
            let tips = placed.iter().map(|placed| placed.translation);
            let tips: Vec<_> = tips.collect();
            tip_errors.extend(
                tips.iter()
                    .zip(&targets)
                    .map(|(tip, target)| (*tip - *target).norm()),
            );
            let pinching = tips[1..]
                .iter()
                .zip(&levels)
                .filter(|(_, level)| **level >= 1.0);
            pinches.extend(pinching.map(|(tip, _)| (*tip - tips[0]).norm()));
        }
        let rate = self.capture.frame_rate();
        Ok(Trajectory {
            times: (0..self.capture.frames())
                .map(|frame| frame as f64 / rate)
                .collect(),
            q,
            nq: model.configuration_len(),
            report: HandReport {
                frame_rate: rate,
                tip_error: mean(&tip_errors),
                pinch_distance: mean(&pinches),
                scales: self
                    .hands
                    .fingers
                    .iter()
                    .map(|finger| finger.scale)
                    .collect(),
            },
        })
    }
}

fn mean(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |sum, value| sum + value) / values.len().max(1) as f64
}

impl Hands {
    fn new(robot: &Robot, map: &HandMap, capture: &Capture) -> Result<Self, RetargetError> {
        let model = robot.model();
        let mut kinematics = ForwardKinematics::new(model);
        let neutral = kinematics
            .place(&model.neutral())
            .map_err(as_map_error)?
            .to_vec();
        let drives: Vec<_> = map.fingers.values().collect();
        let frames = drives.iter().map(|drive| Ok(model.frame(&drive.frame)?));
        let frames: Vec<FrameId> = frames.collect::<Result<_, RetargetError>>()?;
        let roots = finger_roots(model, &frames)?;
        let bases: Vec<Vector3<f64>> = roots
            .iter()
            .map(|root| joint_origin(model, &neutral, *root))
            .collect();
        let mut vectors = vec![Vec::new(); frames.len()];
        for seed in 0..SAMPLES {
            let mut q = robot.random_configuration(seed);
            lock_shared(model, &roots, &mut q);
            let placed = kinematics.place(&q).map_err(as_map_error)?;
            for (k, frame) in frames.iter().enumerate() {
                vectors[k].push(placed[frame.index()].translation - bases[k]);
            }
        }
        let joint = |name: &str| Ok::<usize, RetargetError>(capture.joint(name)?);
        let wrist = joint(&map.wrist)?;
        let captured = drives
            .iter()
            .map(|drive| Ok([joint(&drive.base)?, joint(&drive.tip)?]));
        let captured: Vec<[usize; 2]> = captured.collect::<Result<_, RetargetError>>()?;
        let positions = || (0..capture.frames()).filter_map(|frame| capture.frame(frame));
        let straight: Vec<Vector3<f64>> = (1..frames.len())
            .map(|k| neutral[frames[k].index()].translation - bases[k])
            .collect();
        let along = straight
            .iter()
            .fold(Vector3::zero(), |sum, vector| sum + *vector);
        let no_palm = || RetargetError::Hand("the bases of its fingers are on one line".to_owned());
        let mut robot_axes = palm::axes(along, &bases[1..]).ok_or_else(no_palm)?;
        let mut fingers = Vec::with_capacity(frames.len());
        for (k, frame) in frames.iter().enumerate() {
            let [base, tip] = captured[k];
            let mut own: Vec<f64> = vectors[k].iter().map(|vector| vector.norm()).collect();
            let mut subject: Vec<f64> = positions().map(|at| (at[tip] - at[base]).norm()).collect();
            let lengths = [
                quantile(&mut own, LENGTH_QUANTILE),
                quantile(&mut subject, LENGTH_QUANTILE),
            ];
            if lengths.iter().any(|length| *length <= 0.0) {
                let finger = map.fingers.keys().nth(k).map_or("", |finger| finger.name());
                return Err(RetargetError::Hand(format!(
                    "the {finger} has no length: its base and tip are at one position"
                )));
            }
            fingers.push(DrivenFinger {
                base,
                tip,
                frame: *frame,
                robot_base: bases[k],
                scale: lengths[0] / lengths[1],
            });
        }
        // Fingers curl to the palm. A hand of the other side curls to the other side of its axes.
        let curl = |vectors: &mut dyn Iterator<Item = Vector3<f64>>, normal: Vector3<f64>| -> f64 {
            vectors.map(|vector| vector.dot(normal)).sum()
        };
        let own_curl = curl(&mut vectors[1..].iter().flatten().copied(), robot_axes.z);
        let captured_bases: Vec<usize> = captured.iter().map(|joints| joints[0]).collect();
        let subject_curl: f64 = positions()
            .filter_map(|at| {
                let axes = subject_axes(at, wrist, &captured_bases)?;
                let mut vectors = captured[1..].iter().map(|[base, tip]| at[*tip] - at[*base]);
                Some(curl(&mut vectors, axes.z))
            })
            .sum();
        if own_curl * subject_curl < 0.0 {
            robot_axes = Matrix3::from_columns(robot_axes.x, robot_axes.y, -robot_axes.z);
        }
        let middle = map
            .fingers
            .keys()
            .position(|finger| *finger == Finger::Middle);
        let middle = middle.unwrap_or(frames.len() - 1);
        let length = straight[middle.max(1) - 1].norm();
        let subject_length = length / fingers[middle].scale;
        Ok(Self {
            wrist,
            joints: capture.names().len(),
            fingers,
            robot_axes,
            pinch: PINCH_DISTANCES.map(|distance| distance * subject_length),
            length,
        })
    }

    /// Writes the targets of all tips, and the level of pinch, 0 to 1, of all fingers but the thumb.
    fn write_targets(
        &self,
        captured: &[Vector3<f64>],
        tips: &mut Vec<Vector3<f64>>,
        levels: &mut Vec<f64>,
    ) {
        let bases: Vec<usize> = self.fingers.iter().map(|finger| finger.base).collect();
        let Some(axes) = subject_axes(captured, self.wrist, &bases) else {
            return;
        };
        tips.clear();
        tips.extend(self.fingers.iter().map(|finger| {
            let vector = axes.transpose_mul(captured[finger.tip] - captured[finger.base]);
            finger.robot_base + self.robot_axes * vector * finger.scale
        }));
        let thumb = captured[self.fingers[0].tip];
        let [near, far] = self.pinch;
        levels.clear();
        levels.extend(self.fingers[1..].iter().map(|finger| {
            let distance = (captured[finger.tip] - thumb).norm();
            1.0 - smooth(((distance - near) / (far - near)).clamp(0.0, 1.0))
        }));
    }
}

/// Returns the axes of the subject's palm. The first base is that of the thumb.
fn subject_axes(at: &[Vector3<f64>], wrist: usize, bases: &[usize]) -> Option<Matrix3<f64>> {
    let bases: Vec<Vector3<f64>> = bases[1..].iter().map(|&base| at[base]).collect();
    let sum = bases.iter().fold(Vector3::zero(), |sum, base| sum + *base);
    palm::axes(sum * (1.0 / bases.len() as f64) - at[wrist], &bases)
}

/// Returns the first moving joint of each finger: the one nearest to the palm that not all fingers share.
fn finger_roots(model: &Model, frames: &[FrameId]) -> Result<Vec<JointId>, RetargetError> {
    let chains: Vec<Vec<JointId>> = frames
        .iter()
        .map(|&frame| {
            let joints = joints_above(model, frame).into_iter();
            joints
                .filter(|id| model.joints()[id.index()].moves())
                .collect()
        })
        .collect();
    let roots = chains.iter().zip(frames).map(|(chain, frame)| {
        let is_own = |id: &&JointId| !chains.iter().all(|other| other.contains(id));
        chain.iter().rfind(is_own).copied().ok_or_else(|| {
            let name = &model.frames()[frame.index()].name;
            RetargetError::Hand(format!("frame `{name}` has no joints of its own finger"))
        })
    });
    roots.collect()
}

/// Returns the joints that move all fingers together.
fn shared_joints(model: &Model, roots: &[JointId]) -> Vec<JointId> {
    let above = |root: &JointId| {
        let parents = std::iter::successors(model.joints()[root.index()].parent, |id| {
            model.joints()[id.index()].parent
        });
        parents.collect::<Vec<_>>()
    };
    let chains: Vec<Vec<JointId>> = roots.iter().map(above).collect();
    let mut shared = chains.first().cloned().unwrap_or_default();
    shared.retain(|id| {
        model.joints()[id.index()].moves() && chains.iter().all(|chain| chain.contains(id))
    });
    shared
}

/// Sets the joints that move all fingers to their neutral values.
fn lock_shared(model: &Model, roots: &[JointId], q: &mut [f64]) {
    let neutral = model.neutral();
    for joint in shared_joints(model, roots) {
        if let Some(coordinate) = model.coordinate(joint) {
            q[coordinate] = neutral[coordinate];
        }
    }
}

/// Returns the position of a joint in a configuration.
fn joint_origin(model: &Model, placed: &[Placement<f64>], joint: JointId) -> Vector3<f64> {
    let frames = model.frames().iter().zip(placed);
    let origin = frames.filter(|(frame, _)| frame.joint == Some(joint));
    let mut origin =
        origin.map(|(frame, placed)| (*placed * frame.joint_from_frame.inverse()).translation);
    origin.next().unwrap_or(Vector3::zero())
}

impl HandFollower {
    fn new(robot: &Robot, hands: Hands, rate: f64) -> Result<Self, RetargetError> {
        let model = robot.model();
        let frames: Vec<FrameId> = hands.fingers.iter().map(|finger| finger.frame).collect();
        let shared = shared_joints(model, &finger_roots(model, &frames)?);
        let mut tasks = Problem::builder(model);
        tasks.parameters(robot.map().clone());
        let origin = Vector3::zero();
        let tips = frames
            .iter()
            .map(|&frame| tasks.add(DrivenPoint::new(frame, origin)));
        let tips: Vec<_> = tips.collect();
        let vectors = frames[1..]
            .iter()
            .map(|&frame| tasks.add(PointDifference::new([frame, frames[0]], [origin; 2], 1.0)));
        let vectors: Vec<_> = vectors.collect();
        let neutral = model.neutral();
        let joints: Vec<(JointId, f64)> = model
            .moving_joints()
            .iter()
            .filter_map(|&id| Some((id, *neutral.get(model.coordinate(id)?)?)))
            .collect();
        let scale = |share: f64| share * hands.length;
        tasks.add(Task::new(Posture::of_joints(joints.clone())).scale(scale(POSTURE_SHARE)));
        let previous =
            tasks.add(Task::new(Posture::of_joints(joints.clone())).scale(scale(PREVIOUS_SHARE)));
        let problem = tasks.build()?;
        let moves = step_limits(&problem, &robot.moves_within(1.0), 1.0 / rate)?;
        let (mut lower, mut upper) = (problem.lower().to_vec(), problem.upper().to_vec());
        let mut x = vec![0.0; problem.variables()];
        problem.parameters().gather(&neutral, &mut x);
        let coordinates: Vec<usize> = joints
            .iter()
            .filter_map(|(id, _)| model.coordinate(*id))
            .collect();
        let is_shared = |coordinate: usize| {
            shared
                .iter()
                .any(|id| model.coordinate(*id) == Some(coordinate))
        };
        let mut locked = vec![false; problem.variables()];
        for (coordinate, source) in problem.parameters().sources().iter().enumerate() {
            if let (Source::Variable { variable, .. }, true) = (source, is_shared(coordinate)) {
                locked[*variable] = true;
            }
        }
        for ((locked, x), (lower, upper)) in
            locked.iter().zip(&x).zip(lower.iter_mut().zip(&mut upper))
        {
            if *locked {
                (*lower, *upper) = (*x, *x);
            }
        }
        Ok(Self {
            targets: problem.targets(),
            max_steps: moves.max_step,
            limits: (lower.clone(), upper.clone()),
            lower,
            upper,
            tips,
            vectors,
            previous,
            reference: coordinates
                .iter()
                .map(|&coordinate| neutral[coordinate])
                .collect(),
            coordinates,
            frame: FrameProblem::new(problem, hands.fingers.len() as f64),
            x,
            q: neutral,
            hands,
            has_solved: false,
            tip_targets: Vec::new(),
            pinch_levels: Vec::new(),
        })
    }

    /// Current configuration.
    #[must_use]
    pub fn q(&self) -> &[f64] {
        &self.q
    }

    /// Number of joints of a capture frame.
    #[must_use]
    pub fn joints(&self) -> usize {
        self.hands.joints
    }

    /// Retargets the next capture frame and returns its configuration, within the limits of position and velocity.
    ///
    /// `captured` are joint positions in the capture's order and unit. If a position is not finite, or the palm has no
    /// orientation, the configuration stays unchanged.
    ///
    /// # Errors
    /// Returns an error if the number of joints is wrong.
    pub fn step(&mut self, captured: &[Vector3<f64>]) -> Result<&[f64], RetargetError> {
        if captured.len() != self.hands.joints {
            return Err(RetargetError::NotFrames {
                numbers: 3 * captured.len(),
                joints: self.hands.joints,
            });
        }
        if !captured.iter().all(Vector3::is_finite) {
            return Ok(&self.q);
        }
        self.hands
            .write_targets(captured, &mut self.tip_targets, &mut self.pinch_levels);
        if self.tip_targets.is_empty() {
            return Ok(&self.q);
        }
        for (task, target) in self.tips.iter().zip(&self.tip_targets) {
            self.targets.get_mut(*task)?.set(*target, 1.0);
        }
        let thumb = self.tip_targets[0];
        let vectors = self
            .vectors
            .iter()
            .zip(&self.tip_targets[1..])
            .zip(&self.pinch_levels);
        for ((task, target), level) in vectors {
            let task = self.targets.get_mut(*task)?;
            task.set_target((*target - thumb) * (1.0 - level));
            task.set_share(THUMB_WEIGHTS[0] + (THUMB_WEIGHTS[1] - THUMB_WEIGHTS[0]) * level);
        }
        self.targets
            .get_mut(self.previous)?
            .set_reference(&self.reference)
            .map_err(ProblemError::from)?;
        let steps = match self.has_solved {
            true => FRAME_ITERATIONS,
            false => FIRST_FRAME_ITERATIONS,
        };
        let within = [self.lower.as_slice(), &self.upper];
        if self
            .frame
            .descend(&self.targets, within, &mut self.x, steps)
        {
            let parameters = self.frame.problem().parameters();
            parameters.scatter_within_limits(&self.x, &mut self.q);
            for (reference, &coordinate) in self.reference.iter_mut().zip(&self.coordinates) {
                *reference = self.q[coordinate];
            }
            self.has_solved = true;
            let limits = self.limits.0.iter().zip(&self.limits.1);
            let bounds = self.lower.iter_mut().zip(&mut self.upper);
            for ((x, max_step), ((lower, upper), (low, high))) in
                self.x.iter().zip(&self.max_steps).zip(bounds.zip(limits))
            {
                (*lower, *upper) = ((x - max_step).max(*low), (x + max_step).min(*high));
            }
        }
        Ok(&self.q)
    }
}
