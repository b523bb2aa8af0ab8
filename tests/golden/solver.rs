//! Kinematics, solvers of task problems, priority levels, drags, closed loops, geometric solvers and derivatives.

use kinopt::geometric::{Ccd, Fabrik, Geometric};
use kinopt::ik::{DerivativeWorkspace, Drag, LoopClosure, Restarts, SolutionDerivative};
use kinopt::io::rig::Rig;
use kinopt::kinematics::{ForwardKinematics, frame_jacobian};
use kinopt::model::{FrameId, Limits, Loop, Masses, Model, ParameterMap, PointMass};
use kinopt::problem::{Problem, ProblemInstance, TaskId};
use kinopt::solver::Stopping;
use kinopt::spatial::{Placement, Vector3};
use kinopt::task::{FramePose, Gaze, LookAt, Point, Posture, SupportPolygon, Task};
use kinopt::{Solution, Solver};
use support::arms::{floating_nao, robot};
use support::bones::humanoid;
use support::methods::solvers;
use support::random::Random;

use super::record::{Case, Record};

pub(crate) const CASES: &[Case] = &[
    Case::double("kinematics", kinematics),
    Case::double("solver_methods", methods),
    Case::double("solver_character", character),
    Case::double("solver_levels", levels),
    Case::double("solver_drag", drag),
    Case::double("solver_loops", loops),
    Case::double("solver_geometric", geometric),
];

fn vector(random: &mut Random, size: f64) -> Vector3<f64> {
    Vector3::from([(); 3].map(|()| random.within(-size, size)))
}

fn kinematics(record: &mut Record) {
    let nao = floating_nao();
    let model = nao.model();
    for seed in 0..3 {
        let q = model.random_configuration(seed);
        let mut kinematics = ForwardKinematics::new(model);
        record.numbers("q", q.iter().copied());
        record.placements("placements", kinematics.place(&q).unwrap());
        let hand = model.frame("left_hand").unwrap();
        let jacobian = frame_jacobian(model, hand, &q).unwrap();
        record.numbers("jacobian", jacobian.iter().copied());
    }
}

/// Every method on reachable and unreachable targets of a robot.
fn methods(record: &mut Record) {
    let nao = robot("aldebaran_nao");
    let model = nao.model();
    let [hand, sole] = ["left_hand", "right_sole"].map(|name| model.frame(name).unwrap());
    for (k, solver) in solvers().into_iter().enumerate() {
        let mut random = Random::new(k as u64);
        let solver = solver
            .with_stopping(Stopping::default().with_max_iterations(60))
            .with_restarts(Restarts::default().with_attempts(2).with_seed(3));
        let mut solutions = Vec::new();
        for far in [0.0, 0.6] {
            let q = model.random_configuration(10 + k as u64);
            let mut kinematics = ForwardKinematics::of_frames(model, &[hand, sole]).unwrap();
            let placed = kinematics.place(&q).unwrap();
            let mut tasks = Problem::builder(model);
            tasks.parameters(nao.map().clone());
            let target = placed[0].translation + vector(&mut random, far);
            tasks.add(Point::new(hand, target));
            tasks.add(Task::new(FramePose::new(sole, placed[1])).scale(0.5));
            tasks.add(LookAt::new(
                model.frame("head").unwrap(),
                [1.0, 0.0, 0.0],
                target,
            ));
            let problem = tasks.build().unwrap();
            solutions.push(solver.solve_once(&problem, &model.neutral()).unwrap());
        }
        record.solutions(solver.method(), &solutions);
    }
}

/// Point tasks of the five tips, moved by up to `size`, with their ids; and a soft posture on request.
fn pinned(
    rig: &Rig,
    random: &mut Random,
    size: f64,
    posture: bool,
) -> (Problem, Vec<TaskId<Point>>) {
    let model = rig.skeleton.model();
    let tips = rig.constrained.iter().map(|&bone| rig.skeleton.tip(bone));
    let tips: Vec<FrameId> = tips.collect();
    let mut kinematics = ForwardKinematics::of_frames(model, &tips).unwrap();
    let placed = kinematics.place(&model.neutral()).unwrap();
    let mut tasks = Problem::builder(model);
    let points = tips.iter().zip(placed);
    let points = points.map(|(tip, at)| Point::new(*tip, at.translation + vector(random, size)));
    let ids = points.map(|point| tasks.add(point)).collect();
    if posture {
        tasks.add(Task::new(Posture::new(model, &model.neutral())).preference());
    }
    (tasks.build().unwrap(), ids)
}

fn character(record: &mut Record) {
    let rig = humanoid();
    let (mut random, solver) = (Random::new(21), Solver::default());
    let rest = rig.skeleton.model().neutral();
    let mut solve = |size: f64| {
        let (problem, _) = pinned(&rig, &mut random, size, true);
        solver.solve_once(&problem, &rest).unwrap()
    };
    let solutions = [0.05, 0.1, 0.3, 1.0].map(&mut solve);
    record.solutions("five tips", &solutions);
}

/// Feet first, balance second, a hand and the gaze on it third. Derivatives of the solutions follow.
fn levels(record: &mut Record) {
    let nao = floating_nao();
    let model = nao.model();
    let frame = |name: &str| model.frame(name).unwrap();
    let feet = [frame("left_sole"), frame("right_sole")];
    let up = [0.0, 0.0, 1.0];
    let start = kinopt::ik::crouched_configuration(model, nao.map(), &feet, &model.neutral(), up);
    let start = start.unwrap();
    record.numbers("crouch", start.iter().copied());
    let frames = [feet[0], feet[1], frame("left_hand")];
    let mut kinematics = ForwardKinematics::of_frames(model, &frames).unwrap();
    let placed = kinematics.place(&start).unwrap().to_vec();
    let masses = [("torso", 2.0), ("left_thigh", 0.5), ("right_hand", 0.5)];
    let masses = masses.map(|(name, mass)| PointMass {
        frame: frame(name),
        at: Vector3::zero(),
        mass,
    });
    let masses = Masses::new(model, masses).unwrap();
    let mut random = Random::new(6);
    let solver = Solver::default().with_restarts(Restarts::none());
    let mut workspace = DerivativeWorkspace::default();
    let (mut solutions, mut derivatives) = (Vec::new(), Vec::new());
    for _ in 0..5 {
        let target = placed[2].translation + vector(&mut random, 0.2);
        let mut tasks = Problem::builder(model);
        tasks.parameters(nao.map().clone());
        let corners = [[0.07, 0.03], [0.07, -0.03], [-0.03, -0.03], [-0.03, 0.03]];
        let mut polygon = SupportPolygon::new(&masses).with_margin(0.01);
        for (foot, at) in feet.into_iter().zip(&placed) {
            tasks.add(FramePose::new(foot, *at));
            polygon = polygon.with_points(corners.map(|[x, y]| at.apply([x, y, 0.0].into())));
        }
        tasks.add(Task::new(polygon).at_level(1));
        tasks.add(Task::new(Point::new(frames[2], target)).at_level(2));
        let gaze = Gaze::at(frame("head"), [1.0, 0.0, 0.0], target, 0.4);
        tasks.add(Task::new(gaze).at_level(2));
        tasks.add(Posture::new(model, &start));
        let problem = tasks.build().unwrap();
        let solution = solver.solve_once(&problem, &start).unwrap();
        let query = ProblemInstance::from(&problem);
        let mut derivative = SolutionDerivative::new(query, &solution.q, &mut workspace).unwrap();
        if let Ok(matrix) = derivative.by_target(3) {
            derivatives.extend(matrix.iter().copied());
        }
        solutions.push(solution);
    }
    record.solutions("solve", &solutions);
    record.numbers("derivative", derivatives);
}

fn drag(record: &mut Record) {
    let rig = humanoid();
    let (problem, ids) = pinned(&rig, &mut Random::new(0), 0.0, true);
    let rest = rig.skeleton.model().neutral();
    let from = problem.targets().get(ids[0]).unwrap().target();
    let mut drag = Drag::new(problem, &rest).unwrap();
    let mut frames: Vec<Solution> = Vec::new();
    for frame in 0..60 {
        let along = 0.02 * f64::from(frame);
        let target = from + Vector3::new(-0.25, 0.5, 1.0) * along;
        drag.target_mut(ids[0]).unwrap().set_target(target);
        frames.push(drag.advance().clone());
    }
    record.solutions("frames", &frames);
    record.solutions("settled", &[drag.settle(40).clone()]);
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

fn loops(record: &mut Record) {
    let model = four_bar();
    let passive = ["coupler", "rocker"].map(|name| model.joint(name).unwrap());
    let closure = LoopClosure::new(ParameterMap::builder(&model), &passive).unwrap();
    let mut random = Random::new(8);
    let mut q = vec![0.5, 0.5, 1.5];
    let (mut closed, mut solutions) = (Vec::new(), Vec::new());
    for _ in 0..12 {
        q[0] = (q[0] + random.within(-0.3, 0.3)).clamp(-3.0, 3.0);
        closure.close(&mut q).unwrap();
        closed.extend_from_slice(&q);
        let mut tasks = Problem::builder(&model);
        let mut target = vector(&mut random, 0.3);
        target.z = 0.0;
        tasks.add(Point::new(model.frame("pen").unwrap(), target));
        let problem = tasks.build().unwrap();
        solutions.push(Solver::default().solve_once(&problem, &q).unwrap());
    }
    record.numbers("closed", closed);
    record.solutions("pen", &solutions);
}

fn geometric(record: &mut Record) {
    let rig = humanoid();
    let rest = rig.skeleton.model().neutral();
    let mut random = Random::new(5);
    let (problem, _) = pinned(&rig, &mut random, 0.1, false);
    let ccd = Ccd::default().solve(&problem, &rest);
    record.solutions("ccd", &[ccd.unwrap()]);
    let fabrik = Fabrik::default().solve(&problem, &rest);
    record.solutions("fabrik", &[fabrik.unwrap()]);
}
