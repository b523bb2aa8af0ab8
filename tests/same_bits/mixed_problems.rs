//! Problems that are drawn at random on a body of every joint: residuals of every kind with all that may be said of them and of their
//! tasks, maps and bounds, levels, preferences and something to keep clear of; some are none.
#![allow(clippy::unwrap_used)]

use kinopt::kinematics::ForwardKinematics;
use kinopt::model::{FrameId, JointId, Limits, Masses, Model, ParameterMap};
use kinopt::problem::{Derivatives, Preferences, Problem, ProblemBuilder, ProblemError, TaskId};
use kinopt::spatial::{Placement, Vector3};
use kinopt::task::{
    Axis, Bounded, CentreOfMass, Distance, FramePose, FrameVelocity, Gaze, JointCoupling,
    LimitCentring, LookAt, Manipulability, Numeric, Orientation, Pixel, Plane, Point, PoseBounds,
    Posture, Ray, Residual, Smoothness, SupportPolygon, Task,
};
use support::random::Random;

use crate::drags::Floor;
use crate::drawn::one_of;
use crate::every_joint::{frames, looped, masses, model, place, vector};
use crate::mixed_arms::{INF, rarely};
use crate::searches::places;
use crate::tasks::{Own, camera};

/// A body, and what is known of where it may stand.
pub(crate) struct Body {
    pub(crate) model: Model,
    pub(crate) masses: Masses,
    pub(crate) q: Vec<f64>,
    pub(crate) at: Vec<Placement<f64>>,
}

impl Body {
    pub(crate) fn new(random: &mut Random) -> Self {
        let model = match random.below(8) {
            0 => looped(random),
            kind => model(random, kind % 2 == 0),
        };
        let q = model.random_configuration(random.bits() % 50);
        Self {
            masses: masses(&model, random),
            at: places(&model, &q),
            q,
            model,
        }
    }

    /// Within limits, at rest, on limits, with quaternions of any length.
    pub(crate) fn start(&self, random: &mut Random) -> Vec<f64> {
        match random.below(6) {
            0 | 5 => self.q.clone(),
            1 => self.model.neutral(),
            2 => (self.model.limits())
                .map(|own| own.clamp(one_of(random, &[-9.0, 9.0, 0.3])))
                .collect(),
            _ => crate::every_joint::configuration(&self.model, random),
        }
    }
}

/// Adds a residual with some of what a task may say of it.
fn put<R: Residual>(tasks: &mut ProblemBuilder<'_>, own: R, random: &mut Random) -> TaskId<R> {
    let quantities: Vec<_> = own.rows().iter().map(|rows| rows.quantity).collect();
    let mut own = Task::new(own);
    for _ in 0..random.below(4) {
        let quantity = one_of(random, &quantities);
        own = match random.below(8) {
            0 => own.named(one_of(random, &["led", "pose of `hand`", ""])),
            1 => own.weight(quantity, one_of(random, &[0.0, 0.3, 2.0])),
            2 => own.scale(one_of(random, &[0.1, 0.5, 4.0, 0.0])),
            3 | 4 => own.tolerance(quantity, one_of(random, &[0.0, 1e-4, 0.05, 0.5, INF])),
            5 => own.preference(),
            6 if rarely(random, 3) => own.at_level(one_of(random, &[0, 1, 3])),
            _ => own.goal(),
        };
    }
    if rarely(random, 60) {
        own = own.tolerance(quantities[0], -1.0);
    }
    tasks.add(own)
}

/// A residual of frames.
fn of_frames(tasks: &mut ProblemBuilder<'_>, body: &Body, random: &mut Random) {
    let all = frames(
        &body.model,
        &["hand", "foot", "head", "back", "tray", "middle"],
    );
    let [one, other] = [(); 2].map(|()| one_of(random, &all));
    let near = |frame: FrameId| body.at[frame.index()];
    let size = one_of(random, &[0.0, 0.02, 0.3, 3.0]);
    let (off, far) = (vector(random, 0.2), vector(random, size));
    let to = near(one).translation + far;
    let axis = one_of(random, &[Axis::X, Axis::Y, Axis::Z]);
    let turned = Placement::new(place(random, 0.1).rotation, to);
    let goal = one_of(
        random,
        &[
            PoseBounds::pose(),
            PoseBounds::free_about(axis),
            PoseBounds::free_along(axis),
        ],
    );
    let room = PoseBounds::within([(); 6].map(|()| one_of(random, &[0.0, 0.1, 0.4, INF])));
    match random.below(18) {
        0 => drop(put(tasks, Point::new(one, to).at(off), random)),
        1 => drop(put(
            tasks,
            Point::new(one, off).relative_to(other).at(far),
            random,
        )),
        2 => drop(put(tasks, FramePose::new(one, near(one)), random)),
        3 => drop(put(
            tasks,
            FramePose::new(one, turned).with_goal(goal).with_tool(off),
            random,
        )),
        4 => drop(put(
            tasks,
            FramePose::new(one, turned).with_goal(room),
            random,
        )),
        5 => {
            let own = FramePose::new(one, place(random, 0.3)).relative_to(other);
            put(tasks, own.with_goal(goal), random);
        }
        6 => drop(put(tasks, Orientation::new(one, turned.rotation), random)),
        7 => {
            let own = Orientation::new(one, near(one).rotation).relative_to(other);
            put(tasks, own, random);
        }
        8 => drop(put(tasks, LookAt::new(one, off, to + off), random)),
        9 => drop(put(
            tasks,
            Gaze::at(one, off, to + off, one_of(random, &[0.0, 0.3])),
            random,
        )),
        10 => drop(put(tasks, Gaze::along(one, off, far + off, 0.4), random)),
        11 => {
            let plane = Plane::new(one, to, off);
            let [low, high] = [one_of(random, &[-0.3, 0.0]), one_of(random, &[0.1, INF])];
            match random.below(4) {
                0 => drop(put(tasks, plane, random)),
                1 => drop(put(tasks, Bounded::at_least(plane, low), random)),
                2 => drop(put(tasks, Bounded::at_most(plane, high), random)),
                _ => drop(put(tasks, Bounded::between(plane, low, high), random)),
            }
        }
        12 => drop(put(
            tasks,
            Ray::new(one, to + off, near(one).translation),
            random,
        )),
        13 => drop(put(
            tasks,
            Distance::new(one, other, one_of(random, &[0.0, 0.3, 2.0])),
            random,
        )),
        14 => {
            let own = Pixel::new(one, camera(random), [300.0, 200.0]);
            put(tasks, own, random);
        }
        15 => {
            let time = one_of(random, &[0.01, 0.1, 1.0]);
            let own = FrameVelocity::new(one, near(one), time, (off, far));
            put(tasks, own, random);
        }
        16 => {
            let own = Bounded::new(Point::new(one, to).relative_to(other), 0.1);
            put(tasks, own, random);
        }
        _ => {
            let own = Own {
                frames: [one, other],
                joint: joint(&body.model, random),
                knows: random.below(2) == 0,
            };
            put(tasks, Numeric(own), random);
        }
    }
}

/// A joint of one number.
fn joint(model: &Model, random: &mut Random) -> JointId {
    let names = [
        "elbow",
        "slide",
        "chest",
        "wrist",
        "ankle/first",
        "ankle/second",
    ];
    model.joint(one_of(random, &names)).unwrap()
}

/// A residual of joints, or of the whole body.
fn of_bodies(tasks: &mut ProblemBuilder<'_>, body: &Body, random: &mut Random) {
    let Body { model, masses, .. } = body;
    let all = frames(model, &["hand", "foot", "head", "back", "tray"]);
    let [one, other] = [(); 2].map(|()| one_of(random, &all));
    let q = body.start(random);
    let (off, wide) = (vector(random, 0.3), one_of(random, &[0.02, 0.3, 2.0]));
    let corners = [[-wide, 0.1, 0.0], [wide, -0.2, 0.1], [0.0, wide, 0.0]];
    let count = one_of(random, &[1, 2, 3]);
    let mut moving = model.moving_joints().to_vec();
    moving.dedup();
    let weights: Vec<f64> = moving
        .iter()
        .map(|_| one_of(random, &[0.0, 1.0, 3.0]))
        .collect();
    match random.below(14) {
        0 => drop(put(tasks, CentreOfMass::new(masses, off), random)),
        1 => {
            let own =
                CentreOfMass::new(masses, off).free_along(one_of(random, &[Axis::X, Axis::Z]));
            put(tasks, own.relative_to(one), random);
        }
        2 => {
            let own = SupportPolygon::new(masses).with_points(corners[..count].to_vec());
            put(
                tasks,
                own.with_margin(one_of(random, &[0.0, 0.05, 1.0])),
                random,
            );
        }
        3 => {
            let own = SupportPolygon::new(masses).with_points_on(one, corners[..count].to_vec());
            let own = own
                .with_points_on(other, [[0.1, 0.0, 0.0]])
                .with_margin(0.01);
            put(
                tasks,
                own.with_up(one_of(random, &[off, Vector3::UNITS[1]])),
                random,
            );
        }
        4 => drop(put(tasks, Posture::new(model, &q), random)),
        5 => drop(put(tasks, Posture::new(model, &q).by_range(model), random)),
        6 => drop(put(
            tasks,
            Posture::new(model, &q).with_weights(weights).upright(model),
            random,
        )),
        7 => {
            let [a, b] = [(); 2].map(|()| joint(model, random));
            let own = Posture::of_joints([(a, 0.2), (b, -0.1)]);
            put(tasks, own.with_weights([2.0, 0.5]), random);
        }
        8 => {
            let own = Smoothness::new(model, &q, one_of(random, &[0.02, 1.0]));
            match random.below(3) {
                0 => put(tasks, own, random),
                1 => put(tasks, own.by_range(model), random),
                _ => put(tasks, own.with_weights(weights), random),
            };
        }
        9 => drop(put(tasks, LimitCentring::new(model), random)),
        10 | 11 => {
            let [a, b] = [(); 2].map(|()| joint(model, random));
            let own = JointCoupling::new(model, [(a, 0.5), (b, -2.0)], 0.3);
            put(tasks, own, random);
        }
        _ => {
            let base = one_of(random, &[None, Some(other)]);
            let own = Manipulability::new(model, base, one, one_of(random, &[1e-3, 0.3]));
            match random.below(3) {
                0 => put(tasks, own, random),
                1 => put(tasks, own.of_position(), random),
                _ => put(tasks, own.of_orientation(), random),
            };
        }
    }
}

/// Joints locked, following, narrowed, balls held; as refused where these do not go together.
pub(crate) fn map(model: &Model, random: &mut Random) -> Result<ParameterMap, String> {
    let mut own = ParameterMap::builder(model);
    for _ in 0..random.below(4) {
        let one = joint(model, random);
        let value = one_of(random, &[0.0, 0.2, -0.1, 0.4]);
        own = match random.below(5) {
            0 => own.with_locked(one, value),
            1 => own.with_coupled(
                one,
                joint(model, random),
                one_of(random, &[-0.5, 1.0, 0.0]),
                value,
            ),
            2 => own.with_narrowed(one, Limits::new(value - 0.2, one_of(random, &[0.5, INF]))),
            3 => {
                let ball = model
                    .joint(one_of(random, &["waist", "neck", "hip"]))
                    .unwrap();
                own.with_locked_ball(ball, [1.0, 0.1, value, 0.0])
            }
            _ => own
                .with_locked(one, value)
                .with_narrowed(one, Limits::new(-1.0, 1.0)),
        };
    }
    own.build().map_err(|error| error.to_string())
}

/// A floor that the hand and the foot keep over, near where they are.
fn floor(body: &Body, random: &mut Random) -> Floor {
    let own = frames(&body.model, &["hand", "foot"]);
    let heights = own.iter().map(|frame| body.at[frame.index()].translation.z);
    let lowest = heights.fold(INF, f64::min);
    Floor {
        kinematics: ForwardKinematics::of_frames(&body.model, &own).unwrap(),
        height: lowest - one_of(random, &[0.3, 0.02, -0.05]),
        frames: own,
    }
}

/// A hand that is led, and up to three more tasks; a word for each thing that is refused on the way.
pub(crate) fn problem(
    body: &Body,
    random: &mut Random,
    refused: &mut Vec<String>,
) -> (Result<Problem, ProblemError>, TaskId<Point>) {
    let mut tasks = Problem::builder(&body.model);
    match map(&body.model, random) {
        Ok(map) => drop(tasks.parameters(map).clone()),
        Err(error) => refused.push(error),
    }
    let hand = body.model.frame("hand").unwrap();
    let prefers = rarely(random, 4);
    let sizes = [0.0, 0.02, 0.3, 4.0];
    let size = one_of(random, if prefers { &sizes[..3] } else { &sizes });
    let off = vector(random, size);
    let led = put(
        &mut tasks,
        Point::new(hand, body.at[hand.index()].translation + off),
        random,
    );
    if prefers {
        let q = body.start(random);
        put(&mut tasks, Posture::new(&body.model, &q), random);
    }
    for _ in 0..random.below(if prefers { 1 } else { 4 }) {
        match random.below(3) {
            0 => of_bodies(&mut tasks, body, random),
            _ => of_frames(&mut tasks, body, random),
        }
    }
    if rarely(random, 3) {
        let low = one_of(random, &[-0.4, 0.0, 0.3]);
        tasks.bound(joint(&body.model, random), Limits::new(low, low + 0.8));
    }
    if rarely(random, 4) {
        let quantity = kinopt::task::Quantity::Metres;
        tasks.tolerance(quantity, one_of(random, &[1e-3, 0.1]));
    }
    if rarely(random, 3) {
        tasks.preferences(one_of(
            random,
            &[Preferences::Traded, Preferences::WithinGoals],
        ));
    }
    if rarely(random, 6) {
        tasks.derivatives(one_of(random, &Derivatives::ALL));
    }
    if rarely(random, if prefers { 2 } else { 6 }) {
        tasks.keep_clear(&floor(body, random));
    }
    (tasks.build(), led)
}
