//! Derivatives of a solution compared with its solve: a complete reverse product, including the factorisation, from
//! near the target.

use std::error::Error;
use std::hint::black_box;

use kinopt::ik::{DerivativeWorkspace, SolutionDerivative};
use kinopt::model::{FrameId, Model};
use kinopt::problem::ParameterVector;
use kinopt::robot::Robot;
use kinopt::task::{FramePose, Posture};
use kinopt::{Arm, Problem, Solver, Workspace};

use super::{Run, Stage, single};
use crate::Sequence;

pub(super) fn stages() -> Vec<Stage> {
    vec![
        single("solve near, arm of six joints", || {
            solve(&arm("universal_ur5e")?)
        }),
        single("derivative backward, arm of six joints", || {
            reverse(&arm("universal_ur5e")?)
        }),
        single("derivative of an arm by its target, six joints", by_target),
        single("solve from rest, arm of six joints", || {
            solve(&arm("universal_ur5e")?.starting_at_rest())
        }),
        single("solve from anywhere, arm of six joints", || {
            solve(&arm("universal_ur5e")?.starting_anywhere())
        }),
        single("solve from rest, humanoid, four poses", || {
            solve(&body(false)?.starting_at_rest())
        }),
        single("solve from anywhere, humanoid, four poses", || {
            solve(&body(false)?.starting_anywhere())
        }),
        single("solve near, humanoid, four poses", || solve(&body(false)?)),
        single("derivative backward, humanoid, four poses", || {
            reverse(&body(false)?)
        }),
        single("solve near, humanoid with a posture", || {
            solve(&body(true)?)
        }),
        single("derivative backward, humanoid with a posture", || {
            reverse(&body(true)?)
        }),
    ]
}

struct Query {
    problem: Problem,
    start: Vec<f64>,
    rest: Vec<f64>,
    /// A different configuration within the limits.
    anywhere: Vec<f64>,
}

impl Query {
    fn starting_at_rest(self) -> Self {
        Self {
            start: self.rest.clone(),
            ..self
        }
    }

    fn starting_anywhere(self) -> Self {
        Self {
            start: self.anywhere.clone(),
            ..self
        }
    }
}

fn model_of(name: &str) -> Result<Robot, Box<dyn Error>> {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../models");
    Ok(Robot::read(format!("{folder}/{name}.urdf"))?)
}

/// Targets of some frames at their poses in a configuration near the start.
fn query_near(model: &Model, frames: &[FrameId], posture: bool) -> Result<Query, Box<dyn Error>> {
    let mut random = Sequence::new(0.5);
    let neutral = model.neutral();
    let mut perturbed = |amount: f64| -> Result<Vec<f64>, Box<dyn Error>> {
        let mut q = neutral.clone();
        for (value, limits) in q.iter_mut().zip(model.limits()) {
            *value = limits.clamp(*value + amount * (2.0 * random.unit() - 1.0));
        }
        Ok(q)
    };
    let target_configuration = perturbed(0.8)?;
    let start: Vec<f64> = {
        let perturbation = perturbed(0.2)?;
        let differences = perturbation.iter().zip(&neutral);
        target_configuration
            .iter()
            .zip(differences)
            .map(|(value, (a, b))| value + a - b)
            .collect()
    };
    let mut kinematics = kinopt::kinematics::ForwardKinematics::of_frames(model, frames)?;
    let mut tasks = Problem::builder(model);
    for (&frame, &target) in frames.iter().zip(kinematics.place(&target_configuration)?) {
        tasks.add(FramePose::new(frame, target));
    }
    if posture {
        tasks.add(Posture::new(model, &neutral));
    }
    let anywhere = perturbed(1.5)?;
    Ok(Query {
        problem: tasks.build()?,
        start,
        rest: neutral,
        anywhere,
    })
}

fn arm(name: &str) -> Result<Query, Box<dyn Error>> {
    let robot = model_of(name)?;
    let flange = robot.model().frame("flange")?;
    query_near(robot.model(), &[flange], false)
}

fn body(posture: bool) -> Result<Query, Box<dyn Error>> {
    let robot = model_of("aldebaran_nao")?;
    let robot = robot.with_base_joint(kinopt::robot::BaseJoint::FREE)?;
    let ends = ["left_sole", "right_sole", "left_hand", "right_hand"];
    let frames: Result<Vec<_>, _> = ends.iter().map(|name| robot.model().frame(name)).collect();
    query_near(robot.model(), &frames?, posture)
}

fn solve(query: &Query) -> Result<Run, Box<dyn Error>> {
    let (problem, start) = (query.problem.clone(), query.start.clone());
    let (solver, mut workspace) = (Solver::default(), Workspace::new());
    if !solver.solve(&problem, &start, &mut workspace)?.reached {
        return Err("what a configuration has is not reached".into());
    }
    Ok(Box::new(move || {
        let solution = solver.solve(&problem, &start, &mut workspace);
        black_box(solution.is_ok());
    }))
}

fn reverse(query: &Query) -> Result<Run, Box<dyn Error>> {
    let problem = query.problem.clone();
    let q = Solver::default().solve_once(&problem, &query.start)?.q;
    let mut memory = DerivativeWorkspace::default();
    let mut gradient = ParameterVector::new(&problem);
    let dof = SolutionDerivative::new(&problem, &q, &mut memory)?.degrees_of_freedom();
    let slope = vec![1.0; dof];
    Ok(Box::new(move || {
        let derivative = SolutionDerivative::new(&problem, &q, &mut memory);
        let is_ok = derivative
            .is_ok_and(|mut derivative| derivative.gradient(&slope, &mut gradient).is_ok());
        black_box((is_ok, &gradient));
    }))
}

fn by_target() -> Result<Run, Box<dyn Error>> {
    let arm = Arm::builder(&model_of("universal_ur5e")?, "base", "flange").build()?;
    let q = vec![0.4, -1.2, 1.1, -0.8, 1.2, 0.5];
    let target = arm.base_from_tool(&q)?;
    Ok(Box::new(move || {
        black_box(arm.derivative(target, &q).is_ok());
    }))
}
