//! Problems whose targets, weights and links can be changed by small amounts, for derivative tests.

use kinopt::Problem;
use kinopt::kinematics::ForwardKinematics;
use kinopt::model::{BallLimits, FrameId, JointId, Limits, Model, ParameterMap};
use kinopt::problem::{ParameterVector, Preferences, ProblemBuilder};
use kinopt::spatial::{Placement, Vector3, rotation_exp};
use kinopt::task::{FramePose, Orientation, Point, Posture, Quantity, Residual, Task};
use nalgebra as na;

use super::random::Random;
use super::stationary::Cone;

/// Weight of a radian relative to a metre, for any reach.
const RADIAN_WEIGHT: f64 = 0.5;

fn turning<R: Residual>(residual: R) -> Task<R> {
    Task::new(residual).weight(Quantity::Radians, RADIAN_WEIGHT)
}

/// Adds a task with its weight multiplied by a factor.
type Goal = Box<dyn Fn(&mut ProblemBuilder<'_>, f64)>;

/// Changed quantity and size of the change.
#[derive(Clone, Debug)]
pub enum Change {
    Targets(f64),
    Weight(f64),
    Origin(f64),
}

impl Change {
    pub fn times(&self, share: f64) -> Self {
        match self {
            Self::Targets(size) => Self::Targets(size * share),
            Self::Weight(size) => Self::Weight(size * share),
            Self::Origin(size) => Self::Origin(size * share),
        }
    }
}

/// Problem of a seed after a change.
pub struct Case {
    pub model: Model,
    pub problem: Problem,
    /// The same problem with the configuration as its variables.
    pub plain: Problem,
    pub cones: Vec<(usize, Cone)>,
    pub start: Vec<f64>,
    /// The change as rates of the library's parameters.
    pub rates: ParameterVector,
    pub goals: usize,
    pub traded: bool,
}

const KINDS: u64 = 8;

struct Body {
    model: Model,
    frames: Vec<FrameId>,
    cones: Vec<(usize, Cone)>,
}

/// True for models with a free base and balls in cones.
fn is_figure(kind: u64) -> bool {
    matches!(kind, 4..=6)
}

/// Chain in which the origin of one joint is shifted on its parent.
fn body(kind: u64, (shifted, shift): (usize, na::Vector3<f64>), random: &mut Random) -> Body {
    let mut joint = 0;
    let mut joint_placement = |random: &mut Random| {
        let mut at = random.rigid(0.3);
        if joint == shifted {
            at.translation.vector += shift;
        }
        joint += 1;
        super::placement(&at)
    };
    let mut builder = Model::builder("body");
    let mut frames: Vec<FrameId> = Vec::new();
    let mut cones = Vec::new();
    let mut last: Option<JointId> = None;
    let figure = is_figure(kind);
    let narrow = matches!(kind, 2 | 3 | 6);
    let (joints, reach) = match kind {
        1 => (6, 2.6),
        4..=6 => (4, 1.2),
        _ => (7, if narrow { 0.7 } else { 2.6 }),
    };
    let mut coordinate = 0;
    if figure {
        let position_limits = [Limits::new(-1.0, 1.0); 3];
        let at = joint_placement(random);
        last = Some(builder.free("base", None, at, position_limits));
        coordinate += 7;
    }
    for index in 0..joints {
        let at = joint_placement(random);
        let axis = random.direction();
        let along = super::vector(axis.into_inner());
        let name = format!("joint {index}");
        last = Some(match (figure, index % 4) {
            (true, 0 | 2) => {
                let half = [random.within(0.3, 0.6), random.within(0.5, 1.0)];
                let twist = Limits::new(-0.4, 0.5);
                let other = random.direction();
                let about = (other.into_inner() - axis.into_inner() * axis.dot(&other)).normalize();
                let limits = BallLimits::elliptic(super::vector(about), half, twist);
                cones.push((
                    coordinate,
                    Cone {
                        axis: axis.into_inner(),
                        about,
                        swing: half,
                        twist,
                    },
                ));
                coordinate += 4;
                builder.ball(name, last, at, along, Some(limits))
            }
            (_, 3) if kind == 7 => {
                coordinate += 1;
                builder.prismatic(name, last, at, along, Limits::new(-0.3, 0.3))
            }
            _ => {
                coordinate += 1;
                builder.revolute(name, last, at, along, Limits::new(-reach, reach))
            }
        });
        let tip = super::placement(&random.rigid(0.3));
        frames.push(builder.frame(format!("frame {index}"), last, tip));
    }
    Body {
        model: builder.build().unwrap(),
        frames,
        cones,
    }
}

/// Problem of a seed with a change applied.
pub fn case(seed: u64, change: &Change) -> Case {
    let random = &mut Random::new(seed + 77);
    let kind = seed % KINDS;
    let origin = match change {
        Change::Origin(size) => *size,
        _ => 0.0,
    };
    let shifted = random.below(4) + 1;
    let shift = random.vector(1.0);
    let straight = body(kind, (shifted, shift * 0.0), &mut random.clone());
    let Body {
        model,
        frames,
        cones,
    } = body(kind, (shifted, shift * origin), random);
    let figure = is_figure(kind);

    // Targets are frame positions at a random configuration, or beyond.
    let q = model.random_configuration(seed);
    let mut kinematics = ForwardKinematics::of_frames(&straight.model, &frames).unwrap();
    let at: Vec<Placement<f64>> = kinematics.place(&q).unwrap().to_vec();
    let step = match change {
        Change::Targets(size) => *size,
        _ => 0.0,
    };
    let weight = match change {
        Change::Weight(size) => *size,
        _ => 0.0,
    };
    let random_offset = |random: &mut Random, by: f64| super::vector(random.vector(by));
    let mut goals: Vec<Goal> = Vec::new();
    let mut target_steps: Vec<Vec<f64>> = Vec::new();
    let mut random_rates = |random: &mut Random, count: usize| -> Vec<f64> {
        let step: Vec<f64> = (0..count).map(|_| random.within(-1.0, 1.0)).collect();
        target_steps.push(step.clone());
        step
    };
    let turned = |rotation, step: &[f64], by: f64| {
        rotation * rotation_exp(Vector3::new(by * step[0], by * step[1], by * step[2]))
    };
    let (first, tip) = (frames[frames.len() / 2 - 1], *frames.last().unwrap());
    let (at_first, at_tip) = (at[frames.len() / 2 - 1], *at.last().unwrap());
    match kind {
        0..=2 => {
            let mut target = at_tip;
            if kind == 2 {
                target.translation += random_offset(random, 0.8);
            }
            let target_rates = random_rates(random, 6);
            goals.push(Box::new(move |tasks, times| {
                let mut target = target;
                let displacement =
                    Vector3::new(target_rates[0], target_rates[1], target_rates[2]) * step;
                target.translation += target.rotation * displacement;
                target.rotation = turned(target.rotation, &target_rates[3..], step);
                tasks.add(turning(FramePose::new(tip, target)).scale(times));
            }));
        }
        3 | 5 => {
            let target_rates = random_rates(random, 3);
            goals.push(Box::new(move |tasks, times| {
                let displacement =
                    Vector3::new(target_rates[0], target_rates[1], target_rates[2]) * step;
                tasks.add(
                    Task::new(Point::new(tip, at_tip.translation + displacement)).scale(times),
                );
            }));
        }
        4 | 6 => {
            let offset = if kind == 6 {
                random_offset(random, 1.5)
            } else {
                random_offset(random, 0.0)
            };
            let (target_rates, other) = (random_rates(random, 3), random_rates(random, 3));
            goals.push(Box::new(move |tasks, times| {
                let displacement =
                    Vector3::new(target_rates[0], target_rates[1], target_rates[2]) * step;
                let target = at_tip.translation + offset + displacement;
                tasks.add(Task::new(Point::new(tip, target)).scale(times));
                let target = turned(at_first.rotation, &other, step);
                tasks.add(turning(Orientation::new(first, target)));
            }));
        }
        _ => {
            let off = random_offset(random, 1.0);
            let (target_rates, other) = (random_rates(random, 3), random_rates(random, 6));
            goals.push(Box::new(move |tasks, times| {
                let displacement =
                    Vector3::new(target_rates[0], target_rates[1], target_rates[2]) * step;
                let target = at_first.translation + off + displacement;
                tasks.add(Task::new(Point::new(first, target)).scale(times));
                let mut target = at_tip;
                let displacement = Vector3::new(other[0], other[1], other[2]) * step;
                target.translation += target.rotation * displacement;
                target.rotation = turned(target.rotation, &other[3..], step);
                tasks.add(turning(FramePose::new(tip, target)));
            }));
        }
    }
    // A distant posture target, so that a soft task always has an error.
    let has_posture = !matches!(kind, 1 | 2 | 7);
    let mut reference = model.random_configuration(seed + 5000);
    let tasks_with = |map: Option<ParameterMap>, reference: &[f64]| {
        let mut tasks = Problem::builder(&model);
        if let Some(map) = map {
            tasks.parameters(map);
        }
        for goal in &goals {
            goal(&mut tasks, 1.0 + weight);
        }
        if has_posture {
            tasks.add(Task::new(Posture::new(&model, reference)).scale(0.3));
        }
        if matches!(kind, 5 | 6) {
            tasks.preferences(Preferences::Traded);
        }
        tasks.build().unwrap()
    };
    if has_posture {
        let dof = model.degrees_of_freedom();
        // Targets beyond cones and limits, so that limits are active.
        let off: Vec<f64> = (0..dof).map(|_| random.within(-0.8, 0.8)).collect();
        let by: Vec<f64> = (0..dof).map(|_| random.within(-1.0, 1.0)).collect();
        let mut to = vec![0.0; reference.len()];
        model.integrate(&reference, &off, &mut to).unwrap();
        let moved: Vec<f64> = by.iter().map(|by| by * step).collect();
        model.integrate(&to, &moved, &mut reference).unwrap();
        // The reference of a free joint is set for its prismatic joints and its ball separately.
        if figure {
            for k in 0..3 {
                reference[k] = to[k] + moved[k];
            }
        }
        target_steps.push(by);
    }
    let problem = tasks_with(None, &reference);
    let plain = tasks_with(Some(ParameterMap::identity(&model)), &reference);
    let mut rates = ParameterVector::new(&problem);
    match change {
        Change::Targets(_) => {
            for (task, step) in target_steps.iter().enumerate() {
                rates.target_mut(task).copy_from_slice(step);
            }
        }
        Change::Weight(_) => {
            // Position and orientation of a pose, each with its own weight.
            let blocks = if kind <= 2 { 2 } else { 1 };
            let block_rates = [1.0, RADIAN_WEIGHT];
            rates.weights_mut()[..blocks].copy_from_slice(&block_rates[..blocks]);
        }
        Change::Origin(_) => {
            rates = rates.with_joint_origins(model.joints().len());
            // A free base consists of four joints of the model; the first one has the position.
            let index = match (figure, shifted) {
                (true, 0) => 0,
                (true, later) => later + 3,
                (false, joint) => joint,
            };
            rates.joint_origins_mut()[index] = super::vector(shift);
        }
    }
    let start = model.random_configuration(seed + 9000);
    Case {
        goals: problem.tasks() - usize::from(has_posture),
        traded: matches!(kind, 5 | 6),
        model,
        problem,
        plain,
        cones,
        start,
        rates,
    }
}
