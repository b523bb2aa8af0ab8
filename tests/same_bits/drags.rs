//! Promise: so it is for drags under every option, frame by frame: with limits on the move, searches, another method, to rest and
//! after what moves on; and for what keeps clear of a floor, as a search and as a drag.
#![allow(clippy::unwrap_used)]

use kinopt::Solver;
use kinopt::ik::{Drag, Restarts};
use kinopt::kinematics::ForwardKinematics;
use kinopt::model::{FrameId, Model};
use kinopt::problem::{ClearanceCheck, Collision, CollisionAvoidance, Problem, TaskId};
use kinopt::scalar::Scalar;
use kinopt::solver::{Damping, GaussNewton, LevenbergMarquardt, Stopping};
use kinopt::spatial::{Placement, Vector3};
use kinopt::task::{
    Description, Inequality, InequalityResidual, Inputs, LimitCentring, Point, Posture, Quantity,
    Residual, RowBlock, Task,
};
use support::random::Random;

use crate::digest::{Digest, Value, check};
use crate::every_joint::{frames, model, vector};
use crate::searches::places;

/// What a drag says after a frame.
pub(crate) fn told(digest: &mut Digest, drag: &Drag) {
    digest.told(drag.solution());
    digest.doubles(drag.q().iter().copied());
    digest.noted(&(drag.is_speed_limited(), drag.is_at_rest(), drag.jump()));
    digest.noted(&(
        drag.solution().collisions(),
        drag.problem().tasks(),
        drag.question().rows(),
    ));
}

/// A hand that is led, a foot that is held, preferences if asked for.
fn tasks(model: &Model, q: &[f64], case: usize) -> (Problem, TaskId<Point>, Vector3<f64>) {
    let [hand, foot] = frames(model, &["hand", "foot"])[..] else {
        unreachable!()
    };
    let at = places(model, q);
    let mut tasks = Problem::builder(model);
    let from = at[hand.index()].translation;
    let goal = tasks.add(Point::new(hand, from));
    let held = Task::new(Point::new(foot, at[foot.index()].translation));
    tasks.add(if case == 7 { held.at_level(1) } else { held });
    if case % 2 == 1 {
        tasks.add(Posture::new(model, q));
        tasks.add(Task::new(LimitCentring::new(model)).scale(0.1));
    }
    (tasks.build().unwrap(), goal, from)
}

fn drags() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(191));
    for case in 0..8 {
        let model = model(&mut random, case == 3);
        let q = model.random_configuration(case as u64);
        let (problem, goal, from) = tasks(&model, &q, case);
        let stopping = Stopping::default().with_max_iterations(5);
        let drag = Drag::new(problem, &q).unwrap();
        let drag = drag.with_solver(Solver::default(), stopping).unwrap();
        let mut drag = match case {
            1 => drag.with_max_move(0.05).unwrap(),
            2 => drag
                .with_search(Restarts::default().with_attempts(2).with_seed(4))
                .unwrap(),
            4 => drag
                .with_solver(Solver::new(GaussNewton::default()), stopping)
                .unwrap(),
            5 => drag.with_max_move(f64::INFINITY).unwrap(),
            6 => drag
                .with_solver(
                    Solver::new(LevenbergMarquardt::new(Damping::ErrorProportional)),
                    stopping,
                )
                .unwrap(),
            _ => drag,
        };
        let way = vector(&mut random, 1.0);
        // Strict levels take their time.
        let shares: &[f64] = if case == 7 {
            &[0.1, 2.0]
        } else {
            &[0.1, 0.4, 2.0, 2.0, 0.3, 0.0]
        };
        for share in shares {
            drag.target_mut(goal)
                .unwrap()
                .set_target(from + way * *share);
            drag.advance();
            told(&mut digest, &drag);
        }
        if case == 7 {
            continue;
        }
        drag.target_mut(goal).unwrap().set_target(from - way * 0.3);
        drag.follow(2);
        told(&mut digest, &drag);
        drag.set_configuration(&q).unwrap();
        drag.target_mut(goal).unwrap().set_target(from + way * 9.0);
        drag.settle(2);
        told(&mut digest, &drag);
        drag.target_mut(goal).unwrap().set_target(from);
        drag.settle(2);
        told(&mut digest, &drag);
    }
    digest.value()
}

fn refused() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(192));
    let model = model(&mut random, false);
    let q = model.random_configuration(1);
    let (problem, _, _) = tasks(&model, &q, 0);
    let new = || Drag::new(problem.clone(), &q).unwrap();
    digest.refusal(Drag::new(problem.clone(), &q[1..]));
    digest.refusal(new().set_configuration(&q[1..]));
    for radians in [0.0, -1.0, f64::NAN] {
        digest.refusal(new().with_max_move(radians));
    }
    digest.refusal(new().with_search(Restarts::default().with_attempts(0)));
    let wrong = Stopping::default().with_gradient_tolerance(-1.0);
    digest.refusal(new().with_solver(Solver::default(), wrong));
    let wrong = Solver::new(GaussNewton::default().with_rank_tolerance(0.9));
    digest.refusal(new().with_solver(wrong, Stopping::default()));
    let mut fewer = Problem::builder(&model);
    fewer.add(Posture::new(&model, &q));
    let id = fewer.add(Posture::new(&model, &q));
    digest.refusal(new().target_mut(id));
    digest.value()
}

/// How deep frames are under a floor across z.
#[derive(Clone, Debug)]
pub(crate) struct Depths(Vec<FrameId>, f64);

impl Residual for Depths {
    fn inputs(&self) -> Inputs {
        Inputs::frames(self.0.clone())
    }

    fn rows(&self) -> Vec<RowBlock> {
        vec![RowBlock::new(Quantity::Metres, self.0.len())]
    }

    fn evaluate<S: Scalar>(&self, frames: &[Placement<S>], _joints: &[S], residual: &mut [S]) {
        for (row, frame) in residual.iter_mut().zip(frames) {
            *row = (S::constant(self.1) - frame.translation.z).max(S::zero());
        }
    }

    fn description(&self) -> Description {
        Description::new("depths")
    }
}

impl InequalityResidual for Depths {
    fn inequalities(&self) -> Vec<Inequality> {
        Vec::new()
    }

    fn slacks<S: Scalar>(&self, _: &[Placement<S>], _: &[S], _: &mut [S]) {}
}

/// The floor, and whose frames stay over it.
#[derive(Clone, Debug)]
pub(crate) struct Floor {
    pub(crate) kinematics: ForwardKinematics,
    pub(crate) frames: Vec<FrameId>,
    pub(crate) height: f64,
}

impl ClearanceCheck for Floor {
    fn collisions(&mut self, q: &[f64]) -> Vec<Collision> {
        let height = self.height;
        let placed = self.kinematics.place(q).unwrap().iter().enumerate();
        let under = placed.filter(|(_, at)| at.translation.z < height);
        let mut all: Vec<Collision> = under
            .map(|(k, at)| Collision::new(["one", "other"][k], "floor", at.translation.z - height))
            .collect();
        all.sort_by(|a, b| a.distance.total_cmp(&b.distance));
        all
    }

    fn blocked(&mut self, _: &[f64], to: &[f64]) -> Option<Collision> {
        self.collisions(to)
            .into_iter()
            .next()
            .map(Collision::met_on_the_way)
    }

    fn free_share(&mut self, from: &[f64], to: &[f64]) -> f64 {
        match self.collisions(to).is_empty() {
            true => 1.0,
            false if self.collisions(from).is_empty() => 0.4,
            false => 0.0,
        }
    }
}

impl CollisionAvoidance for Floor {
    type Clearance = Depths;
    type Check = Self;

    fn configuration_len(&self) -> usize {
        self.kinematics.variables()
    }

    fn clearance(&self) -> Task<Depths> {
        Task::new(Depths(self.frames.clone(), self.height + 1e-3)).named("clearance")
    }

    fn check(&self) -> Self {
        self.clone()
    }
}

/// Two frames that stay over a floor, which the goals lead one of them under.
fn clear() -> [Value; 2] {
    let (mut searched, mut dragged, mut random) = (Digest::new(), Digest::new(), Random::new(193));
    for case in 0..6 {
        let model = model(&mut random, case == 4);
        let q = model.random_configuration(20 + case as u64);
        let own = frames(&model, &["hand", "foot"]);
        let at = places(&model, &q);
        let [hand, foot] = [own[0], own[1]].map(|frame| at[frame.index()].translation);
        let floor = Floor {
            kinematics: ForwardKinematics::of_frames(&model, &own).unwrap(),
            height: hand.z.min(foot.z) - [0.1, 0.02, -0.05][case % 3],
            frames: own.clone(),
        };
        let mut tasks = Problem::builder(&model);
        let goal = tasks.add(Point::new(own[0], hand + vector(&mut random, 0.2)));
        if case % 2 == 0 {
            tasks.add(Task::new(Point::new(own[1], foot)).at_level(usize::from(case == 2)));
        }
        if case % 5 > 1 {
            tasks.add(Posture::new(&model, &model.neutral()));
        }
        tasks.keep_clear(&floor);
        let problem = tasks.build().unwrap();
        let solver = Solver::default().with_restarts(Restarts::default().with_attempts(3));
        let solver = solver.with_stopping(Stopping::default().with_max_iterations(12));
        searched.told(&solver.solve_once(&problem, &q).unwrap());
        searched.refusal(problem.clone().with_weights(&problem.weights()));
        searched.refusal(problem.clone().with_joint_origins(&model));
        let ccd = kinopt::geometric::Ccd::default();
        searched.refusal(kinopt::geometric::Geometric::solve(&ccd, &problem, &q));
        let few = Stopping::default().with_max_iterations(6);
        let drag = Drag::new(problem, &q).unwrap();
        let mut drag = drag.with_solver(Solver::default(), few).unwrap();
        let ways: &[f64] = if case == 2 {
            &[0.5]
        } else {
            &[0.1, 0.3, 0.5, 0.4, 0.0]
        };
        for down in ways {
            let down = Vector3::new(0.0, 0.7, -1.0) * *down;
            drag.target_mut(goal).unwrap().set_target(hand + down);
            drag.advance();
            told(&mut dragged, &drag);
        }
        if case != 2 {
            drag.settle(2);
        }
        told(&mut dragged, &drag);
    }
    let other = model(&mut random, false);
    let free = model(&mut random, true);
    let own = frames(&other, &["hand", "foot"]);
    let kinematics = ForwardKinematics::of_frames(&other, &own).unwrap();
    let mut tasks = Problem::builder(&free);
    tasks.add(Point::new(own[0], Vector3::zero()));
    tasks.keep_clear(&Floor {
        kinematics,
        frames: own,
        height: 0.0,
    });
    searched.refusal(tasks.build());
    [searched.value(), dragged.value()]
}

#[test]
fn of_drags() {
    let [searched, dragged] = clear();
    check(&[
        ("drags of a body under every option", drags()),
        ("drags that are refused", refused()),
        ("searches over a floor of one's own", searched),
        ("drags over a floor of one's own", dragged),
    ]);
}
