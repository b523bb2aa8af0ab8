//! `kinopt path`: joint path for a Cartesian path of an arm, with the fewest reconfigurations.

mod arguments;
mod report;
mod rows_file;

use std::time::Instant;

use kinopt::arm::{Arm, Base, JointPath};
use kinopt::counted;
use kinopt::motion::path::{CartesianPath, PathReport, PathSolver, TimingLimits};
use kinopt::spatial::Placement;

pub(crate) use arguments::Arguments;
use kinopt_bindings::problem_file::ProblemSettings;
use kinopt_bindings::problem_file::number_list::Numbers;
use report::Report;

use crate::failure::{Failure, Outcome};
use crate::frame_name::BareName;
use crate::joint_columns::JointColumns;
use crate::loaded_model::LoadedModel;
use crate::output;
use crate::solve::axis_intervals::GoalBounds;
use crate::solve::held;
use crate::solve::locked_joints::held_joints;
use crate::solve::obstacles::keep_clear;

pub(crate) fn run(arguments: &Arguments, json: bool) -> Outcome<()> {
    let problem = arguments.problem()?;
    let mut loaded = LoadedModel::read(&arguments.query.model, &problem.model)?;
    if loaded.robot.is_none() {
        return Err(usage!("{}: path is for robots", loaded.file));
    }
    loaded.read_srdf(&problem.model)?;
    if problem.model.locks() {
        let rest = loaded.rest();
        let held = held_joints(&problem.model, &loaded, &rest)?;
        loaded.held = Some(Box::new(held));
    }
    let loaded = &loaded;
    let (path, columns_read) = CartesianPath::read(&arguments.path, problem.path.order)?;
    let file = arguments.path.display();
    let turns = columns_read.quaternion.is_some() && !problem.goal.position_only;
    let bounds = GoalBounds::new(&problem.goal.interval, (turns, turns))?;
    let (arm, columns) = arm(&problem, loaded, bounds)?;
    let path = match arguments.curve {
        Some((curve, step)) => path.along(curve, step)?,
        None => path,
    };
    let path = placed(arguments, path, bounds).with_traversal(arguments.traversal);
    let one_each = |option, given: Option<&Numbers>| {
        let by_joint = |given: &Numbers| columns.one_each(loaded, option, given);
        given.map(by_joint).transpose()
    };
    let typed = |option, given: Option<&Numbers>| {
        one_each(
            option,
            given
                .map(|given| given.typed(arguments.query.degrees))
                .as_ref(),
        )
    };
    let tools = problem.path.add_tool.iter();
    let tools = tools
        .map(|tool| arm.with_tool(*tool))
        .collect::<Result<Vec<Arm>, _>>()?;
    let mut solver = PathSolver::new(&arm)
        .with_tools(&tools)
        .with_max_step(arguments.max_step())
        .with_times_kept(problem.path.keep_times);
    if let Some(samples) = problem.path.samples {
        solver = solver.with_samples(samples);
    }
    let weights = one_each("joint_weights", problem.solve.joint_weights.as_ref())?;
    if let Some(weights) = &weights {
        solver = solver.with_joint_weights(weights);
    }
    if let Some(start) = typed("--start", arguments.start.as_ref())? {
        solver = solver.with_start(&start);
    }
    if let Some(end) = typed("--end", arguments.end.as_ref())? {
        solver = solver.with_end(&end);
    }
    let accelerations = typed("--accelerations", arguments.accelerations.as_ref())?;
    let started = Instant::now();
    let solution = solver.solve(&path)?;
    let milliseconds = 1e3 * started.elapsed().as_secs_f64();
    let times = times(&arm, &path, &solution, accelerations.as_deref())?;
    let report = Report {
        loaded,
        arm: &arm,
        path: &path,
        solution: &solution,
        times,
        milliseconds,
        columns_read: &columns_read,
    };
    if let Some(out) = &arguments.out {
        rows_file::write(out, &report)?;
    }
    output::message(&format!(
        "{file}: {}; {columns_read}",
        counted(path.points().len(), "point")
    ));
    output::result(json, || report.document(), || report.text())?;
    if let Some(out) = &arguments.out {
        output::message(&format!("wrote {}", out.display()));
    }
    match arguments.query.fail_on_miss && !solution.report.missed.is_empty() {
        true => Err(Failure::Missed(format!(
            "{} of {} points are not reached",
            solution.report.missed.len(),
            path.points().len()
        ))),
        false => Ok(()),
    }
}

/// Times of the rows, in seconds: shortest times under joint limits if accelerations are known, else the table's.
fn times(
    arm: &Arm,
    path: &CartesianPath,
    solution: &JointPath<PathReport>,
    accelerations: Option<&[f64]>,
) -> Outcome<Option<Vec<f64>>> {
    let arm_limits = arm.acceleration_limits();
    let finite_limits = arm_limits
        .iter()
        .all(|limit| limit.is_finite())
        .then_some(arm_limits);
    if let Some(accelerations) = accelerations.or(finite_limits) {
        if !solution.unreached.is_empty() {
            let unreached = counted(solution.unreached.len(), "row");
            output::message(&format!(
                "no times: {unreached} not reached or not collision-free"
            ));
            return Ok(None);
        }
        let limits = TimingLimits::of(arm).with_acceleration_limits(accelerations);
        return Ok(Some(solution.trajectory(&limits)?.times));
    }
    let path_times = path
        .times()
        .filter(|path_times| path_times.len() == solution.rows().len());
    Ok(path_times.map(<[f64]>::to_vec))
}

/// Arm from the base to the tip, and the columns of its joints.
fn arm(
    problem: &ProblemSettings,
    loaded: &LoadedModel,
    bounds: GoalBounds,
) -> Outcome<(Arm, JointColumns)> {
    let Some(robot) = loaded.robot.as_deref() else {
        return Err(usage!("{}: path is for robots", loaded.file));
    };
    let frame = |name| loaded.frame(name, BareName::Tail);
    let (base, tip) = (problem.goal.base.as_deref(), problem.goal.tip.as_deref());
    let base = base.map(frame).transpose()?;
    let tip = match (tip, loaded.tip_links().as_slice()) {
        (Some(tip), _) => frame(tip)?,
        (None, [only]) => frame(only)?,
        (None, tips) => {
            return Err(usage!(
                "--tip is needed, because the robot has several tips: {}",
                tips.join(", ")
            ));
        }
    };
    let tolerance = problem.solve.tolerance.unwrap_or(1e-6);
    let builder = Arm::builder(robot, base.map_or(Base::World, Base::from), tip)
        .with_tool(problem.goal.tool.unwrap_or_else(Placement::identity))
        .with_goal(bounds.goal)
        .with_position_tolerance(tolerance)
        .with_orientation_tolerance(tolerance);
    let builder = held(builder, loaded);
    let joints = builder.joints()?;
    let coordinates = joints.iter().filter_map(|&id| loaded.model.coordinate(id));
    let columns = loaded.columns_of(coordinates.collect());
    let arm = builder.build()?;
    let arm = keep_clear(&problem.collisions, arm, loaded, &loaded.rest())?;
    Ok((arm, columns))
}

/// Path in the base, with points at the middle of their goal bounds.
fn placed(arguments: &Arguments, path: CartesianPath, bounds: GoalBounds) -> CartesianPath {
    let path = match &arguments.at {
        Some(placement) => path.moved(placement),
        None => path,
    };
    path.map_points(|point| bounds.middle(point))
}
