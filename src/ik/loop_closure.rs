//! Joints that loops move: their values from those of the others.

use super::loop_gap::{LoopClosureError, LoopGap};
use super::nearest_closing::NearestClosing;
use super::{Solution, Solver};
use crate::model::{JointId, Model, ModelError, ParameterMap, ParameterMapBuilder};
use crate::problem::{Evaluation, Problem, ProblemError, Share};
use crate::robot::Robot;
use crate::search::check_start;
use crate::solver::LeastSquares;

/// So many random configurations are tried for one that closes.
const DRAWS: u64 = 32;

/// Forward kinematics of a model with loops: the joints that nothing drives follow from those that are given.
///
/// ```
/// use kinopt::ik::LoopClosure;
/// use kinopt::robot::Robot;
///
/// // A crank that is driven, a coupler and a rocker that are not.
/// let text = r#"<mujoco><worldbody>
///   <body name="crank"><joint name="crank" axis="0 0 1"/>
///     <body name="coupler" pos="0.12 0 0"><joint name="coupler" axis="0 0 1"/></body></body>
///   <body name="rocker" pos="0.4 0 0"><joint name="rocker" axis="0 0 1" ref="2"/><site name="end" pos="0.3 0 0"/></body>
/// </worldbody><actuator><motor joint="crank"/></actuator>
/// <equality><connect name="pin" body1="coupler" body2="rocker" anchor="0.35 0 0"/></equality></mujoco>"#;
/// let robot = Robot::parse_mjcf(text, "four-bar.xml")?;
/// let closure = LoopClosure::of_robot(&robot)?;
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
    /// The loops of the model that these parameters are of, closed by the joints in `dependent`. Joints that follow
    /// others go on doing so.
    ///
    /// # Errors
    /// A joint that does not move, or none where the model has loops.
    pub fn new(
        parameters: ParameterMapBuilder<'m>,
        dependent: &[JointId],
    ) -> Result<Self, LoopClosureError> {
        let model = parameters.model();
        if dependent.is_empty() && !model.loops().is_empty() {
            let joints = model.joint_ids().filter(|id| model.moves_a_loop(*id));
            return Err(LoopClosureError::NoPassiveJoints {
                model: model.name().to_owned(),
                joints: names(model, joints),
            });
        }
        let own = Self {
            parameters,
            dependent: dependent.to_vec(),
            solver: Solver::default(),
        };
        own.held_at(&model.neutral()).build()?;
        Ok(own)
    }

    /// The loops of a robot, closed by those of its [passive joints](Robot::passive_joints) that move one.
    ///
    /// # Errors
    /// A robot that has loops, but no passive joints that move them.
    pub fn of_robot(robot: &'m Robot) -> Result<Self, LoopClosureError> {
        let model = robot.model();
        let passive = robot.passive_joints().iter().copied();
        let dependent: Vec<JointId> = passive.filter(|id| model.moves_a_loop(*id)).collect();
        Self::new(robot.parameters(), &dependent)
    }

    getters! {
        /// The joints that close the loops.
        pub fn dependent(&self) -> &[JointId] = &self.dependent;
    }

    /// Moves the dependent joints of a configuration so that all loops are closed, and the joints that follow
    /// others with them; the rest keep their values. Of several ways to close a loop it is the one nearest to the
    /// dependent joints' own values that is found from them and from 32 places about them.
    ///
    /// # Errors
    /// A configuration of the wrong length, with a number that is not finite, or with a joint outside its limits
    /// that should keep its value; loops that do not close there. The configuration is as it was then.
    pub fn close(&self, q: &mut [f64]) -> Result<(), LoopClosureError> {
        let model = self.parameters.model();
        if model.loops().is_empty() {
            return Ok(());
        }
        let free = self.parameters.clone().build()?;
        let held = self.held_at(q).build()?;
        let leads: Vec<JointId> = (free.leaders().iter())
            .map(|leader| model.moving_joints()[*leader])
            .filter(|joint| !self.dependent.contains(joint))
            .collect();
        let keeps = |coordinate: usize| leads.contains(&model.moving_joints()[coordinate]);
        for ((coordinate, limits), value) in model.limits().enumerate().zip(q.iter()) {
            let joint = model.joint_of(coordinate);
            let outside = !joint.kind.is_ball() && !limits.contains(*value);
            if outside && keeps(coordinate) {
                return Err(LoopClosureError::Model(ModelError::LockedOutsideLimits {
                    joint: joint.name.clone(),
                    value: *value,
                    lower: limits.lower,
                    upper: limits.upper,
                }));
            }
        }
        let closed = self.nearest(held, q)?;
        for (coordinate, (own, closed)) in q.iter_mut().zip(closed).enumerate() {
            if !keeps(coordinate) {
                *own = closed;
            }
        }
        Ok(())
    }

    /// A configuration within all limits whose loops are closed, the same for the same seed: from a random one all
    /// joints that move a loop, not the dependent ones alone, go where they close it. Not all such
    /// configurations are as likely.
    ///
    /// # Errors
    /// Loops that stay open from each of 32 random configurations.
    pub fn random_configuration(&self, seed: u64) -> Result<Vec<f64>, LoopClosureError> {
        let model = self.parameters.model();
        let draw = |k| model.random_configuration(seed.wrapping_mul(DRAWS).wrapping_add(k));
        if model.loops().is_empty() {
            return Ok(draw(0));
        }
        let free = self.parameters.clone().build()?;
        let mut found = self.any(free.clone(), &draw(0));
        for k in 1..DRAWS {
            if !matches!(found, Err(LoopClosureError::Open { .. })) {
                break;
            }
            found = self.any(free.clone(), &draw(k));
        }
        found
    }

    /// How far each loop is open in a configuration, whose joints need not be within limits; those that follow
    /// others are where they follow to.
    ///
    /// # Errors
    /// A configuration of the wrong length, or with a number that is not finite.
    pub fn gaps(&self, q: &[f64]) -> Result<Vec<LoopGap>, LoopClosureError> {
        let model = self.parameters.model();
        let loops = model.loops().iter();
        let mut gaps: Vec<LoopGap> = loops.map(|own| LoopGap::of(own, model)).collect();
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
        for rows in problem.errors(Share::All, &residual) {
            gaps[rows.task].take(rows.quantity, rows.error);
        }
        Ok(gaps)
    }

    /// Parameters that hold all but the dependent joints.
    fn held_at(&self, q: &[f64]) -> ParameterMapBuilder<'m> {
        self.parameters.clone().with_only(&self.dependent, q)
    }

    /// The loops alone, closed as near to `start` as can be.
    fn nearest(&self, map: ParameterMap, start: &[f64]) -> Result<Vec<f64>, LoopClosureError> {
        let problem = problem(self.parameters.model(), map)?;
        self.closed(NearestClosing::new(&problem, start)?.close(&self.solver)?)
    }

    /// The loops alone, closed as the search from `start` finds it.
    fn any(&self, map: ParameterMap, start: &[f64]) -> Result<Vec<f64>, LoopClosureError> {
        let problem = problem(self.parameters.model(), map)?;
        self.closed(self.solver.solve_once(&problem, start)?)
    }

    /// The configuration that was found, if it closes the loops.
    fn closed(&self, found: Solution) -> Result<Vec<f64>, LoopClosureError> {
        if found.loops_closed() {
            return Ok(found.q);
        }
        let model = self.parameters.model();
        let open = found.open_loops();
        Err(LoopClosureError::Open {
            open: open.map(|open| LoopGap::open(&open, model)).collect(),
            dependent: names(model, self.dependent.iter().copied()),
        })
    }
}

/// Nothing but the loops.
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
