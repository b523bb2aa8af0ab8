//! Kinematic loop closure: dependent joint values from independent ones.

use super::nearest_closure::NearestClosure;
use super::{LoopGap, Solution, Solver};
use crate::problem::{Evaluation, Problem, ProblemError, TaskSubset};
use crate::search::check_start;
use crate::solver::LeastSquares;
use kinopt_kinematics::model::{JointId, Model, ModelError, ParameterMap, ParameterMapBuilder};

/// Number of random configurations from which closure is attempted.
const MAX_SAMPLES: u64 = 32;

/// Forward kinematics of a model with loops: solves for the dependent joints from the values of the independent ones.
///
/// ```
/// use kinopt::robot::Robot;
///
/// // The crank is driven, the coupler and the rocker are passive.
/// let text = r#"<mujoco><worldbody>
///   <body name="crank"><joint name="crank" axis="0 0 1"/>
///     <body name="coupler" pos="0.12 0 0"><joint name="coupler" axis="0 0 1"/></body></body>
///   <body name="rocker" pos="0.4 0 0"><joint name="rocker" axis="0 0 1" ref="2"/><site name="end" pos="0.3 0 0"/></body>
/// </worldbody><actuator><motor joint="crank"/></actuator>
/// <equality><connect name="pin" body1="coupler" body2="rocker" anchor="0.35 0 0"/></equality></mujoco>"#;
/// let robot = Robot::parse_mjcf(text, "four-bar.xml")?;
/// let closure = robot.loop_closure()?;
/// let mut q = vec![0.7, 0.5, 2.0];
/// closure.close(&mut q)?;
/// assert_eq!(q[0], 0.7);
/// assert!(closure.gaps(&q)?[0].is_closed());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct LoopClosure<'m> {
    parameters: ParameterMapBuilder<'m>,
    dependent: Vec<JointId>,
    solver: Solver,
}

impl<'m> LoopClosure<'m> {
    /// Creates the closure of all loops of the model of `parameters` by the joints in `dependent`.
    ///
    /// Mimic joints keep following their source joints.
    ///
    /// # Errors
    /// Returns an error for a joint that does not move, or if `dependent` is empty although the model has loops.
    pub fn new(
        parameters: ParameterMapBuilder<'m>,
        dependent: &[JointId],
    ) -> Result<Self, ProblemError> {
        let model = parameters.model();
        if dependent.is_empty() && !model.loops().is_empty() {
            let joints = model.joint_ids().filter(|id| model.moves_a_loop(*id));
            return Err(ProblemError::NoPassiveJoints {
                model: model.name().to_owned(),
                joints: names(model, joints),
            });
        }
        let closure = Self {
            parameters,
            dependent: dependent.to_vec(),
            solver: Solver::default(),
        };
        closure.locked_at(&model.neutral()).build()?;
        Ok(closure)
    }

    /// Joints that close the loops.
    #[must_use]
    pub fn dependent(&self) -> &[JointId] {
        &self.dependent
    }

    /// Moves the dependent joints of a configuration, and their mimic joints, so that all loops are closed.
    ///
    /// The other joints keep their values. If several closures exist, this finds the one nearest to the current values
    /// of the dependent joints. The search starts from these values and from 32 configurations about them.
    ///
    /// # Errors
    /// Returns an error if `q` has the wrong length or a number that is not finite, or if an independent joint is
    /// outside its limits. Returns an error if the loops do not close. `q` is then unchanged.
    pub fn close(&self, q: &mut [f64]) -> Result<(), ProblemError> {
        let model = self.parameters.model();
        if model.loops().is_empty() {
            return Ok(());
        }
        let map = self.parameters.clone().build()?;
        let locked_map = self.locked_at(q).build()?;
        let independent_joints: Vec<JointId> = (map.leaders().iter())
            .map(|leader| model.moving_joints()[*leader])
            .filter(|joint| !self.dependent.contains(joint))
            .collect();
        let is_independent =
            |coordinate: usize| independent_joints.contains(&model.moving_joints()[coordinate]);
        for ((coordinate, limits), value) in model.limits().enumerate().zip(q.iter()) {
            let joint = model.joint_of(coordinate);
            let outside = !joint.kind.is_ball() && !limits.contains(*value);
            if outside && is_independent(coordinate) {
                return Err(ProblemError::Model(ModelError::LockedOutsideLimits {
                    joint: joint.name.clone(),
                    value: *value,
                    lower: limits.lower,
                    upper: limits.upper,
                }));
            }
        }
        let closed_q = self.nearest(locked_map, q)?;
        for (coordinate, (q_value, closed_value)) in q.iter_mut().zip(closed_q).enumerate() {
            if !is_independent(coordinate) {
                *q_value = closed_value;
            }
        }
        Ok(())
    }

    /// Returns a configuration within all limits with closed loops. Equal seeds return equal configurations.
    ///
    /// From a random configuration, all joints that move a loop move to close it, not only the dependent ones. The
    /// distribution is not uniform.
    ///
    /// # Errors
    /// Returns an error if the loops stay open from each of 32 random configurations.
    pub fn random_configuration(&self, seed: u64) -> Result<Vec<f64>, ProblemError> {
        let model = self.parameters.model();
        let sample = |k| model.random_configuration(seed.wrapping_mul(MAX_SAMPLES).wrapping_add(k));
        if model.loops().is_empty() {
            return Ok(sample(0));
        }
        let map = self.parameters.clone().build()?;
        let mut result = self.close_from(map.clone(), &sample(0));
        for k in 1..MAX_SAMPLES {
            if !matches!(result, Err(ProblemError::OpenLoops { .. })) {
                break;
            }
            result = self.close_from(map.clone(), &sample(k));
        }
        result
    }

    /// Returns the closure error of each loop at a configuration.
    ///
    /// Joints may be outside their limits. Mimic joints take the values that follow from their source joints.
    ///
    /// # Errors
    /// Returns an error if `q` has the wrong length or a number that is not finite.
    pub fn gaps(&self, q: &[f64]) -> Result<Vec<LoopGap>, ProblemError> {
        let model = self.parameters.model();
        let loops = model.loops().iter();
        let mut gaps: Vec<LoopGap> = loops
            .map(|model_loop| LoopGap::of(model_loop, model))
            .collect();
        if gaps.is_empty() {
            return Ok(gaps);
        }
        let problem = problem(model, self.parameters.clone().build()?)?;
        check_start(&problem, q)?;
        let mut x = vec![0.0; problem.variables()];
        problem.parameters().gather(q, &mut x);
        let mut residual = vec![0.0; problem.rows()];
        let mut scratch = problem.scratch();
        Evaluation::new(&problem, &mut scratch).residual(&x, &mut residual);
        for row_block in problem.errors(TaskSubset::All, &residual) {
            gaps[row_block.task].set_error(row_block.quantity, row_block.error);
        }
        Ok(gaps)
    }

    /// Returns parameters with all but the dependent joints locked at `q`.
    fn locked_at(&self, q: &[f64]) -> ParameterMapBuilder<'m> {
        self.parameters.clone().with_only(&self.dependent, q)
    }

    /// Closes the loops as near to `start` as the search finds.
    fn nearest(&self, map: ParameterMap, start: &[f64]) -> Result<Vec<f64>, ProblemError> {
        let problem = problem(self.parameters.model(), map)?;
        self.closed(NearestClosure::new(&problem, start)?.close(&self.solver)?)
    }

    /// Closes the loops by one search from `start`.
    fn close_from(&self, map: ParameterMap, start: &[f64]) -> Result<Vec<f64>, ProblemError> {
        let problem = problem(self.parameters.model(), map)?;
        self.closed(self.solver.solve_once(&problem, start)?)
    }

    /// Returns the configuration of a solution if it closes the loops.
    fn closed(&self, solution: Solution) -> Result<Vec<f64>, ProblemError> {
        if solution.loops_closed() {
            return Ok(solution.q);
        }
        let model = self.parameters.model();
        let open = solution.open_loops();
        Err(ProblemError::OpenLoops {
            open: open
                .map(|open| LoopGap::new(open.name, (open.gap, open.angle), model))
                .collect(),
            dependent: names(model, self.dependent.iter().copied()),
        })
    }
}

/// Builds a problem with the loops as its only tasks.
fn problem(model: &Model, map: ParameterMap) -> Result<Problem, ProblemError> {
    let mut problem = Problem::builder(model);
    problem.parameters(map);
    problem.build()
}

fn names(model: &Model, joints: impl Iterator<Item = JointId>) -> Vec<String> {
    joints
        .map(|id| model.joints()[id.index()].name.clone())
        .collect()
}
