//! Complete solution sets of a target.
//!
//! Six revolute joints have at most sixteen isolated solutions, up to whole turns. Arms with a spherical wrist or three
//! parallel axes have a closed form by canonical subproblems (A. J. Elias and J. T. Wen, "IK-Geo: Unified robot inverse
//! kinematics using subproblem decomposition", Mechanism and Machine Theory 209, 2025). Other arms have one by an
//! elimination to a polynomial of one joint. Every solution is polished by Newton's method on the chain itself.

mod angle;
mod argument;
mod branches;
mod elimination;
mod linear;
mod polish;
mod position;
mod screw;
mod self_motion;
mod seven_revolute;
mod six_revolute;
mod spherical_wrist;
mod three_parallel;
mod trigonometric;
mod whole_turns;

use super::QueryError;
use super::arm::Arm;
#[cfg(feature = "collision")]
use super::collision_avoidance::sphere_checks::{drop_colliding, is_clear};
use super::distances::weighted_distance;
use super::move_bounds::bound_moves;
use super::multi_solution::{collect_attempts, distinct_ends};
use super::query::Query;
use super::workspace::ArmWorkspace;
use crate::simd_ik::PoseOutcome;
use kinopt_kinematics::model::Limits;
use kinopt_kinematics::spatial::Placement;

pub use argument::Argument;
pub use branches::{ArmBranch, ElbowBranch, ShoulderBranch, WristBranch};
pub(super) use seven_revolute::SevenRevolute;
pub(super) use six_revolute::{SixRevolute, SolutionSet};
use whole_turns::{MAX_CONFIGURATIONS, Turns, nearest_turn};

/// Smallest weighted joint distance of two solutions of a redundant arm.
const REDUNDANT_DISTANCE: f64 = 0.5;
/// Smallest weighted joint distance of two solutions of an arm without redundancy that is solved by attempts.
const ISOLATED_DISTANCE: f64 = 1e-3;

/// Solution of a target in a complete set.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct PoseSolution {
    /// Configuration within the limits, radians or metres, one number per free joint, base to tip.
    pub q: Vec<f64>,
    /// Position error, metres.
    pub position_error: f64,
    /// Orientation error, radians.
    pub orientation_error: f64,
    /// Branches of the shoulder, elbow and wrist.
    pub branch: ArmBranch,
}

/// Solutions of a target, nearest to the start first.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct AllSolutions {
    /// Solutions within the limits, with whole turns, collision-free if the arm has a checker.
    pub solutions: Vec<PoseSolution>,
    /// True if the set has all isolated solutions, and there are no others.
    pub complete: bool,
    /// True if the target has a continuous family of solutions, as at a wrist singularity. The set then has samples of
    /// the family.
    pub has_family: bool,
    /// Argument for the completeness.
    pub argument: Argument,
}

/// A curve of configurations that keep the tool at its target.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct SelfMotion {
    /// Successive configurations, seven numbers each, radians. No joint moves by more than 0.05 rad between two.
    pub q: Vec<f64>,
    /// True if the last configuration is followed by the first, up to whole turns of joints without limits.
    ///
    /// Otherwise the curve ends at joint limits, in collision, or at a singular configuration.
    pub closed: bool,
}

impl Arm {
    /// Samples the self-motions of seven revolute joints: all curves of configurations that keep the tool at a target.
    ///
    /// Each curve is a connected component within the joint limits. A joint with whole turns within its limits gives
    /// further components. With a checker a component ends where it collides, to the spacing of the samples. The curves
    /// are those through 128 equidistant values of two joints, so that a closed curve within less than 0.05 rad of both
    /// can be missing.
    ///
    /// Returns `None` for an arm without seven revolute joints, or with another goal than the full pose.
    ///
    /// ```
    /// # std::env::set_current_dir("../..")?;
    /// # use kinopt::arm::Arm;
    /// # use kinopt::robot::Robot;
    /// let robot = Robot::read("models/kuka_iiwa14.urdf")?;
    /// let arm = Arm::new(&robot, "base", "flange")?;
    /// let target = arm.base_from_tool(&[0.3, 0.4, 0.2, -1.2, 0.1, 0.9, 0.5])?;
    /// let motions = arm.self_motions(target)?.ok_or("seven joints")?;
    /// assert!(motions.len() > 1);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// Returns an error for a target that is not a rigid motion.
    pub fn self_motions(
        &self,
        base_from_tool: impl Into<Placement<f64>>,
    ) -> Result<Option<Vec<SelfMotion>>, QueryError> {
        let target = base_from_tool.into();
        self.check_query(None, &target, self.default_start())?;
        let chain = self.serial.chain.as_ref();
        let chain = chain.filter(|_| self.options.goal.is_full_pose());
        let Some(chain) = chain.and_then(SevenRevolute::new) else {
            return Ok(None);
        };
        let mut limits = [Limits::new(0.0, 0.0); 7];
        for (limit, given) in limits.iter_mut().zip(self.limits()) {
            *limit = given;
        }
        let arcs = self_motion::self_motions(&chain, &target, self.tolerances(), &limits);
        let motions = arcs.into_iter().map(|arc| SelfMotion {
            q: arc.samples.concat(),
            closed: arc.closed,
        });
        #[cfg(feature = "collision")]
        if self.avoids_collisions() {
            let mut free = Vec::new();
            for motion in motions {
                free.extend(collision_free_parts(self, &target, motion)?);
            }
            return Ok(Some(free));
        }
        Ok(Some(motions.collect()))
    }

    /// Finds all solutions of a target, nearest to the [default start](Self::default_start) first.
    ///
    /// For six revolute joints and a full pose the set is [complete](AllSolutions::complete): all isolated solutions
    /// within the limits (inclusive), each with all its whole turns. A joint without a limit on one side has only the
    /// turn nearest to the start. An arm with a checker returns its collision-free solutions. Options of attempts
    /// and postures have no effect. An arm with bounds on motions counts as another arm.
    ///
    /// A configuration at a limit that reaches the target within the tolerances only is not in the set.
    ///
    /// Other arms return what their attempts find, and are never complete. Their solutions are at least 1e-3 rad apart,
    /// those of a redundant arm 0.5 rad (weighted joint distance). [`self_motions`](Self::self_motions) samples the
    /// solutions of seven joints.
    ///
    /// ```
    /// # std::env::set_current_dir("../..")?;
    /// # use kinopt::arm::Arm;
    /// # use kinopt::robot::Robot;
    /// let robot = Robot::read("models/universal_ur5e.urdf")?;
    /// let arm = Arm::new(&robot, "base", "flange")?;
    /// let target = arm.base_from_tool(&[0.4, -1.2, 1.1, -0.8, 1.2, 0.5])?;
    /// let all = arm.solve_all(target)?;
    /// assert!(all.complete);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// Returns an error for a target that is not a rigid motion.
    pub fn solve_all(
        &self,
        base_from_tool: impl Into<Placement<f64>>,
    ) -> Result<AllSolutions, QueryError> {
        self.solve_all_from(base_from_tool, self.default_start())
    }

    /// Finds all solutions of a target as [`solve_all`](Self::solve_all) does, nearest to `start` first.
    ///
    /// # Errors
    /// Returns the errors of [`solve`](Self::solve).
    pub fn solve_all_from(
        &self,
        base_from_tool: impl Into<Placement<f64>>,
        start: &[f64],
    ) -> Result<AllSolutions, QueryError> {
        let target = base_from_tool.into();
        self.check_length("the start", start.len(), self.joint_count())?;
        self.check_query(None, &target, start)?;
        let query = Query::new(self, &target, start);
        self.with_workspace(|workspace| {
            workspace.set_target(&target);
            let solver = self.six_revolute();
            match solver.filter(|_| self.options.max_move.is_none()) {
                Some(solver) => complete_set(self, solver, workspace, &query),
                None => found_set(self, workspace, &query),
            }
        })?
    }

    /// Solver of complete sets, if the arm has six revolute joints and its goal is the full pose.
    pub(super) fn six_revolute(&self) -> Option<&SixRevolute> {
        let compile = || {
            let chain = self.serial.chain.as_ref();
            let chain = chain.filter(|_| self.options.goal.is_full_pose())?;
            SixRevolute::new(chain).map(Box::new)
        };
        self.six_revolute.get_or_init(compile).as_deref()
    }

    fn tolerances(&self) -> (f64, f64) {
        let options = &self.options;
        (options.position_tolerance, options.orientation_tolerance)
    }
}

/// The collision-free parts of a self-motion.
#[cfg(feature = "collision")]
fn collision_free_parts(
    arm: &Arm,
    target: &Placement<f64>,
    motion: SelfMotion,
) -> Result<Vec<SelfMotion>, QueryError> {
    let n = arm.joint_count();
    let query = Query::new(arm, target, arm.default_start());
    let free = arm.with_workspace(|workspace| {
        let configurations = motion.q.chunks_exact(n);
        let free = configurations.map(|q| is_clear(arm, workspace, &query, q));
        free.collect::<Result<Vec<_>, _>>()
    })??;
    let is_free = |index: usize| free[index] == Some(true);
    let Some(first_hit) = (0..free.len()).find(|&index| !is_free(index)) else {
        return Ok(vec![motion]);
    };
    // A closed curve is cut at a collision; an open one begins at its start.
    let (begin, count) = match motion.closed {
        true => (first_hit, free.len()),
        false => (0, free.len()),
    };
    let mut parts: Vec<SelfMotion> = Vec::new();
    let mut continues = false;
    for step in 0..count {
        let index = (begin + step) % free.len();
        if !is_free(index) {
            continues = false;
            continue;
        }
        if !continues {
            parts.push(SelfMotion {
                q: Vec::new(),
                closed: false,
            });
        }
        continues = true;
        if let Some(part) = parts.last_mut() {
            part.q
                .extend_from_slice(&motion.q[index * n..(index + 1) * n]);
        }
    }
    Ok(parts)
}

/// The complete set of six revolute joints.
fn complete_set(
    arm: &Arm,
    solver: &SixRevolute,
    workspace: &mut ArmWorkspace,
    query: &Query<'_>,
) -> Result<AllSolutions, QueryError> {
    // Taken out and put back, so that its buffers are kept.
    let mut set = std::mem::take(&mut workspace.solution_set);
    solver.solve(query.target, arm.tolerances(), &mut set);
    let mut solutions = Vec::new();
    let mut complete = set.complete;
    for member in &set.solutions {
        let Some(mut turns) = Turns::new(arm.limits(), &member.q, query.start) else {
            continue;
        };
        #[cfg(feature = "collision")]
        match is_clear(arm, workspace, query, turns.q())? {
            Some(true) => {}
            Some(false) => continue,
            None => {
                complete = false;
                break;
            }
        }
        if solutions.len() + turns.count() > MAX_CONFIGURATIONS {
            turns.keep_nearest();
            complete = false;
        }
        loop {
            solutions.push(PoseSolution {
                q: turns.q().to_vec(),
                position_error: member.position_error,
                orientation_error: member.orientation_error,
                branch: member.branch,
            });
            if !turns.advance() {
                break;
            }
        }
    }
    let distance = |solution: &PoseSolution| weighted_distance(arm, &solution.q, query.start);
    solutions.sort_by(|a, b| distance(a).total_cmp(&distance(b)));
    let argument = match complete {
        true => solver.argument(&set),
        false => Argument::None,
    };
    let has_family = set.family;
    workspace.solution_set = set;
    Ok(AllSolutions {
        solutions,
        complete,
        has_family,
        argument,
    })
}

/// The solutions that attempts find.
fn found_set(
    arm: &Arm,
    workspace: &mut ArmWorkspace,
    query: &Query<'_>,
) -> Result<AllSolutions, QueryError> {
    bound_moves(arm, workspace, query.start);
    collect_attempts(arm, workspace, query);
    #[cfg(feature = "collision")]
    drop_colliding(arm, workspace, query)?;
    let is_redundant = arm.has_null_space();
    let distance = match is_redundant {
        true => REDUNDANT_DISTANCE,
        false => ISOLATED_DISTANCE,
    };
    let ends = distinct_ends(arm, workspace, usize::MAX, distance);
    let solutions = ends.into_iter().map(|index| PoseSolution {
        q: workspace.attempt_end(index).to_vec(),
        position_error: workspace.outcomes[index].position_error,
        orientation_error: workspace.outcomes[index].orientation_error,
        branch: ArmBranch::default(),
    });
    Ok(AllSolutions {
        solutions: solutions.collect(),
        complete: false,
        has_family: is_redundant,
        argument: Argument::None,
    })
}

/// Writes the complete set to the workspace's attempts, each solution with the turns nearest to the start.
///
/// Returns false if the arm has none, or it is empty or not complete.
pub(super) fn collect_complete_set(
    arm: &Arm,
    workspace: &mut ArmWorkspace,
    query: &Query<'_>,
) -> bool {
    if arm.options.max_move.is_some() {
        return false;
    }
    let Some(solver) = arm.six_revolute() else {
        return false;
    };
    let mut set = std::mem::take(&mut workspace.solution_set);
    solver.solve(query.target, arm.tolerances(), &mut set);
    workspace.attempt_ends.clear();
    workspace.outcomes.clear();
    for member in set.solutions.iter().filter(|_| set.complete) {
        let first = workspace.attempt_ends.len();
        let joints = member.q.iter().zip(arm.limits()).zip(&workspace.start);
        let turned = joints.map_while(|((&q, limits), &start)| nearest_turn(q, start, limits));
        workspace.attempt_ends.extend(turned);
        if workspace.attempt_ends.len() < first + member.q.len() {
            workspace.attempt_ends.truncate(first);
            continue;
        }
        workspace.outcomes.push(PoseOutcome {
            reached: true,
            position_error: member.position_error,
            orientation_error: member.orientation_error,
            iterations: 0,
            attempts: 1,
            winner: Some(workspace.outcomes.len() as u32),
        });
    }
    workspace.solution_set = set;
    !workspace.outcomes.is_empty()
}
