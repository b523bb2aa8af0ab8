//! Promise: so it is for whole bodies: strict levels with balance, drags of them, derivatives of solutions, closed loops, and a
//! capture that comes onto a robot.
#![allow(clippy::unwrap_used)]

use kinopt::Solver;
use kinopt::ik::{
    DerivativeWorkspace, Drag, LoopClosure, Restarts, SolutionDerivative, crouched_configuration,
};
use kinopt::kinematics::ForwardKinematics;
use kinopt::model::{FrameId, Limits, Loop, Masses, Model, ParameterMap, PointMass};
use kinopt::motion::ContactDetection;
use kinopt::motion::retarget::{BodyMap, Capture, RetargetOptions, Retargeting, UpAxis};
use kinopt::problem::{Problem, ProblemInstance};
use kinopt::robot::{BaseJoint, Robot};
use kinopt::spatial::{Placement, Vector3};
use kinopt::task::{FramePose, Gaze, Point, Posture, SupportPolygon, Task};
use support::arms::robot;
use support::random::Random;

use crate::digest::{Digest, Value, check};

/// A NAO that stands on its feet, knees bent.
struct Standing {
    robot: Robot,
    masses: Masses,
    start: Vec<f64>,
    soles: [(FrameId, Placement<f64>); 2],
    hand: (FrameId, Placement<f64>),
}

impl Standing {
    fn new() -> Self {
        let robot = robot("aldebaran_nao")
            .with_base_joint(BaseJoint::FREE)
            .unwrap();
        let model = robot.model();
        let frame = |name: &str| model.frame(name).unwrap();
        let parts = [("torso", 2.0), ("left_thigh", 0.5), ("right_hand", 0.5)];
        let parts = parts.map(|(name, mass)| PointMass {
            frame: frame(name),
            at: Vector3::zero(),
            mass,
        });
        let feet = [frame("left_sole"), frame("right_sole")];
        let up = [0.0, 0.0, 1.0];
        let start =
            crouched_configuration(model, robot.map(), &feet, &model.neutral(), up).unwrap();
        let hand = frame("left_hand");
        let frames = [feet[0], feet[1], hand];
        let mut kinematics = ForwardKinematics::of_frames(model, &frames).unwrap();
        let placed = kinematics.place(&start).unwrap().to_vec();
        Self {
            masses: Masses::new(model, parts).unwrap(),
            soles: [(feet[0], placed[0]), (feet[1], placed[1])],
            hand: (hand, placed[2]),
            start,
            robot,
        }
    }

    /// Feet first, balance second, the hand at a place and the head's gaze on it third, a posture at last.
    fn problem(&self, to: [f64; 3]) -> (Problem, kinopt::problem::TaskId<Point>) {
        let model = self.robot.model();
        let mut builder = Problem::builder(model);
        builder.parameters(self.robot.map().clone());
        let corners = [[0.07, 0.03], [0.07, -0.03], [-0.03, -0.03], [-0.03, 0.03]];
        let mut polygon = SupportPolygon::new(&self.masses).with_margin(0.01);
        for (sole, stands) in self.soles {
            builder.add(FramePose::new(sole, stands));
            polygon = polygon.with_points(corners.map(|[x, y]| stands.apply([x, y, 0.0].into())));
        }
        builder.add(Task::new(polygon).at_level(1));
        let hand = builder.add(Task::new(Point::new(self.hand.0, to)).at_level(2));
        let head = model.frame("head").unwrap();
        builder.add(Task::new(Gaze::at(head, [1.0, 0.0, 0.0], to, 0.4)).at_level(2));
        builder.add(Posture::new(model, &self.start));
        (builder.build().unwrap(), hand)
    }

    /// Places about the hand, some out of reach.
    fn places(&self) -> impl Iterator<Item = [f64; 3]> + '_ {
        let mut random = Random::new(6);
        let at = self.hand.1.translation;
        (0..8).map(move |_| {
            let by = Vector3::from([(); 3].map(|()| random.within(-0.2, 0.2)));
            (at + by).to_array()
        })
    }
}

fn levels() -> [Value; 2] {
    let (mut solved, mut differentiated) = (Digest::new(), Digest::new());
    let standing = Standing::new();
    let solver = Solver::default().with_restarts(Restarts::none());
    let mut workspace = DerivativeWorkspace::default();
    for to in standing.places() {
        let (problem, _) = standing.problem(to);
        let solution = solver.solve_once(&problem, &standing.start).unwrap();
        solved.solution(&solution);
        let question = ProblemInstance::from(&problem);
        let mut derivative =
            SolutionDerivative::new(question, &solution.q, &mut workspace).unwrap();
        differentiated.text(derivative.differentiability().name());
        for task in 0..4 {
            if let Ok(matrix) = derivative.by_target(task) {
                differentiated.doubles(matrix.iter().copied());
            }
        }
    }
    [solved.value(), differentiated.value()]
}

fn dragged() -> Value {
    let mut digest = Digest::new();
    let standing = Standing::new();
    let (problem, hand) = standing.problem(standing.hand.1.translation.to_array());
    let mut drag = Drag::new(problem, &standing.start).unwrap();
    for to in standing.places() {
        drag.target_mut(hand).unwrap().set_target(to);
        for _ in 0..6 {
            digest.solution(drag.advance());
        }
    }
    digest.value()
}

/// A crank, a coupler and a rocker, closed by a pin.
fn four_bar() -> Model {
    let mut builder = Model::builder("four-bar");
    let (z, turns) = (Vector3::UNITS[2], Limits::new(-4.0, 4.0));
    let x = |length: f64| Placement::translation([length, 0.0, 0.0].into());
    let crank = builder.revolute("crank", None, x(0.0), z, turns);
    let coupler = builder.revolute("coupler", Some(crank), x(0.12), z, turns);
    let rocker = builder.revolute("rocker", None, x(0.4), z, turns);
    let ends = [
        builder.frame("coupler end", Some(coupler), x(0.35)),
        builder.frame("rocker end", Some(rocker), x(0.3)),
    ];
    builder.frame("pen", Some(coupler), x(0.2));
    builder.close(Loop::connect("pin", ends));
    builder.build().unwrap()
}

fn loops() -> Value {
    let mut digest = Digest::new();
    let model = four_bar();
    let dependent = ["coupler", "rocker"].map(|name| model.joint(name).unwrap());
    let closure = LoopClosure::new(ParameterMap::builder(&model), &dependent).unwrap();
    let mut random = Random::new(8);
    let mut q = vec![0.5, 0.5, 1.5];
    for _ in 0..100 {
        q[0] += random.within(-0.3, 0.3);
        q[0] = q[0].clamp(-3.0, 3.0);
        closure.close(&mut q).unwrap();
        digest.doubles(q.iter().copied());
        let mut tasks = Problem::builder(&model);
        let to = [(); 2].map(|()| random.within(-0.3, 0.3));
        tasks.add(Point::new(model.frame("pen").unwrap(), [to[0], to[1], 0.0]));
        let solution = Solver::default().solve_once(&tasks.build().unwrap(), &q);
        digest.solution(&solution.unwrap());
    }
    digest.value()
}

fn retargeted() -> [Value; 2] {
    let robot = robot("aldebaran_nao")
        .with_base_joint(BaseJoint::FREE)
        .unwrap();
    let read = kinopt::io::bvh::read("../models/captures/steps.bvh").unwrap();
    let capture = Capture::of_clip(&read.armature, &read.clip, 30.0).unwrap();
    let guess = BodyMap::guess(&capture, robot.model()).unwrap();
    let contacts = ContactDetection::default().with_speed(0.06);
    let mut options = RetargetOptions::default();
    (options.up, options.contacts) = (UpAxis::Y, contacts);
    let retargeting = Retargeting::new(&robot, &guess.map, &capture, options).unwrap();
    [retargeting.per_frame(), retargeting.whole()].map(|found| {
        let (found, mut digest) = (found.unwrap(), Digest::new());
        digest.doubles(found.q);
        digest.doubles([found.mean_error, found.slip, found.ground_penetration]);
        found
            .contacts
            .iter()
            .for_each(|&own| digest.word(own.into()));
        digest.value()
    })
}

#[test]
fn of_levels_and_derivatives() {
    let [solved, differentiated] = levels();
    check(&[
        ("bodies on strict levels, counted", solved),
        ("derivatives of their solutions", differentiated),
    ]);
}

#[test]
fn of_bodies_dragged() {
    check(&[("a body dragged on strict levels, frame by frame", dragged())]);
}

#[test]
fn of_closed_loops() {
    check(&[("a linkage and its loop, counted", loops())]);
}

#[test]
fn of_captures_on_robots() {
    let [per_frame, whole] = retargeted();
    check(&[
        ("a capture on a robot, frame by frame", per_frame),
        ("a capture on a robot, as a whole", whole),
    ]);
}
