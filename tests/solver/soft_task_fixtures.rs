//! Fixtures of the tests of soft tasks.

use kinopt::Solution;
use kinopt::model::{Model, ParameterMap};
use kinopt::problem::{Evaluation, Problem, ProblemBuilder};
use kinopt::solver::LeastSquares;
use kinopt::spatial::Placement;
use kinopt::task::{LookAt, Orientation, Point, Posture, Quantity, Role, Task};
use nalgebra::{DMatrix, DVector};
use support::bones::RandomRig;
use support::random::Random;
use support::trees::configuration_of;

/// Distance at which a variable counts as on its bound, in radians or metres.
pub(crate) const AT_BOUND: f64 = 1e-4;

pub(crate) type Add<'a> = &'a dyn Fn(&mut ProblemBuilder<'_>);

/// Problem of the model with the tasks that `adds` add.
pub(crate) fn problem(model: &Model, map: &ParameterMap, adds: &[Add<'_>]) -> Problem {
    let mut builder = Problem::builder(model);
    builder.parameters(map.clone());
    for add in adds {
        add(&mut builder);
    }
    builder.build().unwrap()
}

/// Residual and Jacobian at x.
pub(crate) fn linearised(problem: &Problem, x: &[f64]) -> (DVector<f64>, DMatrix<f64>) {
    let mut scratch = problem.scratch();
    let mut evaluation = Evaluation::new(problem, &mut scratch);
    let mut residual = vec![0.0; problem.rows()];
    let mut jacobian = DMatrix::zeros(problem.rows(), problem.variables());
    evaluation.residual(x, &mut residual);
    evaluation.jacobian(x, &mut jacobian);
    (DVector::from_vec(residual), jacobian)
}

/// Fraction of the soft tasks' gradient that required tasks and bounds leave: ‖g + Cᵀy‖ without components that push
/// out of bounds. The multipliers y come from nalgebra's singular values and Newton steps with halvings.
pub(crate) fn remaining_gradient(goals: &Problem, pulls: &Problem, q: &[f64]) -> f64 {
    let mut x = vec![0.0; goals.variables()];
    goals.parameters().reduce(q, &mut x).unwrap();
    let (_, held) = linearised(goals, &x);
    let (residual, jacobian) = linearised(pulls, &x);
    let slope = jacobian.transpose() * residual;
    let left = |multipliers: &DVector<f64>| {
        let mut left = &slope + held.transpose() * multipliers;
        for (j, left) in left.iter_mut().enumerate() {
            let pinned = (x[j] <= goals.lower()[j] + AT_BOUND && *left > 0.0)
                || (x[j] >= goals.upper()[j] - AT_BOUND && *left < 0.0);
            *left = if pinned { 0.0 } else { *left };
        }
        left
    };
    let mut multipliers = DVector::zeros(held.nrows());
    for _ in 0..60 {
        let now = left(&multipliers);
        let mut free = held.clone();
        for (mut column, left) in free.column_iter_mut().zip(&now) {
            if *left == 0.0 {
                column.fill(0.0);
            }
        }
        let newton = -free.transpose().svd(true, true).solve(&now, 1e-9).unwrap();
        let shares = (0..30).map(|halvings| 0.5_f64.powi(halvings));
        let trials = shares.map(|share| &multipliers + &newton * share);
        let lower = |trial: &DVector<f64>| left(trial).norm() < now.norm();
        let Some(better) = trials.into_iter().find(lower) else {
            break;
        };
        multipliers = better;
    }
    left(&multipliers).norm() / slope.norm().max(1e-9)
}

pub(crate) fn within_limits(problem: &Problem, q: &[f64]) -> bool {
    let mut x = vec![0.0; problem.variables()];
    problem.parameters().reduce(q, &mut x).unwrap();
    let bounds = problem.lower().iter().zip(problem.upper());
    x.iter().zip(bounds).all(|(x, (l, u))| l <= x && x <= u)
}

/// ½ Σ ‖W r‖² of the soft tasks of a solution whose rows all have weight 1.
pub(crate) fn pull_of(solution: &Solution) -> f64 {
    let preferences = solution.tasks().filter(|t| t.role == Role::Preference);
    let rows = preferences.flat_map(|task| task.rows);
    0.5 * rows.map(|rows| rows.error * rows.error).sum::<f64>()
}

pub(crate) fn placement_of(model: &Model, frame: &str, q: &[f64]) -> Placement<f64> {
    let mut kinematics = kinopt::kinematics::ForwardKinematics::new(model);
    let placements = kinematics.place(q).unwrap();
    placements[model.frame(frame).unwrap().index()]
}

/// Rig with dragged tips and soft tasks.
pub(crate) struct Drag {
    pub(crate) rig: RandomRig,
    pub(crate) map: ParameterMap,
    pub(crate) rest: Vec<f64>,
    pub(crate) start: Vec<f64>,
    pub(crate) targets: Vec<nalgebra::Vector3<f64>>,
}

pub(crate) fn drag(seed: u64) -> Drag {
    let rig = RandomRig::new(seed);
    let model = rig.skeleton.model();
    let mut random = Random::new(seed);
    let start = configuration_of(model, &mut random);
    let target_q = configuration_of(model, &mut random);
    let at = rig.transforms(&target_q);
    Drag {
        map: ParameterMap::free(model),
        rest: model.neutral(),
        targets: rig.tips.iter().map(|&tip| rig.tip(&at, tip)).collect(),
        start,
        rig,
    }
}

impl Drag {
    pub(crate) fn add_goals(&self, builder: &mut ProblemBuilder<'_>, farther: f64) {
        for (&tip, target) in self.rig.tips.iter().zip(&self.targets) {
            builder.add(Point::new(self.rig.skeleton.tip(tip), target * farther));
        }
    }

    /// A posture, a gaze and an upright bone.
    pub(crate) fn add_pulls(&self, builder: &mut ProblemBuilder<'_>) {
        let skeleton = &self.rig.skeleton;
        builder.add(Posture::new(skeleton.model(), &self.rest));
        let gaze = LookAt::new(
            skeleton.tail(self.rig.tips[0]),
            nalgebra::Vector3::x(),
            [3.0, 1.0, 0.5],
        );
        builder.add(Task::new(gaze).weight(Quantity::Radians, 1.0).preference());
        let upright = nalgebra::Matrix3::identity();
        let upright = Orientation::new(skeleton.tail(self.rig.tips[1]), upright);
        builder.add(
            Task::new(upright)
                .weight(Quantity::Radians, 1.0)
                .preference(),
        );
    }
}
