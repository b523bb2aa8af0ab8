//! Pose inverse kinematics of an arm.

mod all_solutions;
mod batch;
mod follower;
mod options;
mod reach;
mod servo;

use std::rc::Rc;

use kinopt_bindings::coordinates;
use kinopt_bindings::per_joint::configuration;
use wasm_bindgen::prelude::*;

use crate::error::{Exception, raise};
use crate::joint_path::JointPath;
use crate::object;
use crate::placement::{columns, read, read_all};
use crate::robot::Robot;
use crate::solution::Solution;
use crate::value::Value;
use batch::Batch;
use follower::Follower;
use servo::{Servo, ServoOptions};

/// An arm of a robot, from a base to a tip, prepared for queries.
#[wasm_bindgen]
pub struct Arm {
    pub(crate) inner: Rc<kinopt::Arm>,
    robot: Rc<kinopt::robot::Robot>,
    base: Option<String>,
    tip: String,
}

impl Arm {
    /// The arm with other options.
    fn with(&self, inner: kinopt::Arm) -> Self {
        Self {
            inner: Rc::new(inner),
            robot: Rc::clone(&self.robot),
            base: self.base.clone(),
            tip: self.tip.clone(),
        }
    }
}

impl Arm {
    /// Reads a start: a list, or positions by joint name; `defaultStart` if it is missing.
    fn start(&self, start: JsValue) -> Result<Vec<f64>, Exception> {
        let default = self.inner.default_start();
        if start.is_undefined() || start.is_null() {
            return Ok(default.to_vec());
        }
        let names: Vec<String> = self.inner.joints().map(str::to_owned).collect();
        configuration(&Value(start), "start", &names, default)
    }
}

#[wasm_bindgen]
impl Arm {
    /// Creates the arm from the frame `base` to the frame `tip` of a robot; base `undefined` is the world.
    #[wasm_bindgen(constructor)]
    pub fn new(
        robot: &Robot,
        base: Option<String>,
        tip: &str,
        options: Option<options::ArmOptions>,
    ) -> Result<Self, Exception> {
        let inner = options::build(robot, base.clone(), tip, options)?;
        Ok(Self {
            inner: Rc::new(inner),
            robot: Rc::clone(&robot.inner),
            base,
            tip: tip.to_owned(),
        })
    }

    /// Frame of the targets; `undefined` for the world.
    #[wasm_bindgen(getter)]
    pub fn base(&self) -> Option<String> {
        self.base.clone()
    }

    /// The frame that carries the tool.
    #[wasm_bindgen(getter)]
    pub fn tip(&self) -> String {
        self.tip.clone()
    }

    /// Name of the robot.
    #[wasm_bindgen(getter, js_name = robotName)]
    pub fn robot_name(&self) -> String {
        self.robot.name().to_owned()
    }

    /// Units of the joint positions, from base to tip: "rad" or "m".
    #[wasm_bindgen(getter, js_name = jointUnits)]
    pub fn joint_units(&self) -> Vec<String> {
        let joints = self.inner.joint_ids().iter();
        let units = joints.map(|&id| coordinates::unit(self.robot.model(), id));
        units.map(str::to_owned).collect()
    }

    /// Names of the joints from base to tip: the order of `q`, `lower` and `upper`.
    #[wasm_bindgen(getter, js_name = jointNames)]
    pub fn joint_names(&self) -> Vec<String> {
        self.inner.joints().map(str::to_owned).collect()
    }

    /// Number of joints, the length of `q`.
    #[wasm_bindgen(getter, js_name = degreesOfFreedom)]
    pub fn degrees_of_freedom(&self) -> usize {
        self.inner.joint_count()
    }

    /// Lower position limits of the joints, from base to tip, radians or metres.
    #[wasm_bindgen(getter)]
    pub fn lower(&self) -> Vec<f64> {
        self.inner.limits().map(|limits| limits.lower).collect()
    }

    /// Upper position limits of the joints, from base to tip, radians or metres.
    #[wasm_bindgen(getter)]
    pub fn upper(&self) -> Vec<f64> {
        self.inner.limits().map(|limits| limits.upper).collect()
    }

    /// Default start of searches, radians and metres: the SRDF state `ready` or `home` (`withSrdf`), else the middle of
    /// each joint's limits. For a joint without limits it is the value closest to 0.
    #[wasm_bindgen(getter, js_name = defaultStart)]
    pub fn default_start(&self) -> Vec<f64> {
        self.inner.default_start().to_vec()
    }

    /// Configuration sampled uniformly within the limits, radians or metres. Equal seeds give equal configurations.
    #[wasm_bindgen(js_name = randomConfiguration)]
    pub fn random_configuration(&self, seed: u32) -> Vec<f64> {
        self.inner.random_configuration(seed.into())
    }

    /// The arm with `defaultStart` at the state `ready` or `home` of an SRDF file.
    #[wasm_bindgen(js_name = withSrdf)]
    pub fn with_srdf(&self, srdf: &crate::srdf::Srdf) -> Self {
        let arm = kinopt::Arm::clone(&self.inner);
        self.with(arm.with_srdf(&srdf.inner))
    }

    /// Pose of the tool in the base frame at the joint positions `q`: a 4 x 4 matrix by columns. The tool is the tip
    /// without the option `tool`.
    #[wasm_bindgen(js_name = baseFromTool)]
    pub fn base_from_tool(
        &self,
        #[wasm_bindgen(unchecked_param_type = "Numbers")] q: &[f64],
    ) -> Result<Vec<f64>, Exception> {
        let placement = self.inner.base_from_tool(q).map_err(raise)?;
        Ok(columns(&placement).to_vec())
    }

    /// Solves for one target pose of the tool in the base frame. The search begins at `start`, numbers or positions by
    /// joint name; joints without a position are at `defaultStart`. A missed target is no exception: see `reached` and `explain()`.
    pub fn solve(
        &self,
        #[wasm_bindgen(unchecked_param_type = "Placement")] target: &[f64],
        #[wasm_bindgen(unchecked_optional_param_type = "Configuration")] start: JsValue,
    ) -> Result<Solution, Exception> {
        let target = read(target, "target")?;
        let start = self.start(start)?;
        Ok(self.inner.solve(target, &start).map_err(raise)?.into())
    }

    /// Solves a batch of targets: their matrices in one list, sixteen numbers each. `starts` is one common
    /// configuration, or the configurations of all targets in one list.
    #[wasm_bindgen(js_name = solveBatch)]
    pub fn solve_batch(
        &self,
        #[wasm_bindgen(unchecked_param_type = "Numbers")] targets: &[f64],
        #[wasm_bindgen(unchecked_optional_param_type = "Configuration")] starts: JsValue,
    ) -> Result<Batch, Exception> {
        let targets = read_all(targets, "target")?;
        let mut starts = self.start(starts)?;
        if starts.len() == self.inner.joint_count() {
            starts = starts.repeat(targets.len());
        }
        let mut batch = Batch::with_room(targets.len(), self.inner.joint_count());
        self.inner
            .solve_batch_into(&targets, &starts, &mut batch.q, &mut batch.outcomes)
            .map_err(raise)?;
        Ok(batch)
    }

    /// Finds all solutions, nearest to the start first. For six revolute joints the set is complete.
    #[wasm_bindgen(js_name = solveAll, unchecked_return_type = "AllSolutions")]
    pub fn solve_all(
        &self,
        #[wasm_bindgen(unchecked_param_type = "Placement")] target: &[f64],
        #[wasm_bindgen(unchecked_optional_param_type = "Configuration")] start: JsValue,
    ) -> Result<JsValue, Exception> {
        let target = read(target, "target")?;
        let start = self.start(start)?;
        let all = self.inner.solve_all_from(target, &start).map_err(raise)?;
        Ok(all_solutions::of(&all))
    }

    /// Follows a path of targets on one branch as far as possible. `targets` has their matrices in one list, sixteen
    /// numbers each.
    #[wasm_bindgen(unchecked_return_type = "JointPath & { readonly report: TrackReport }")]
    pub fn track(
        &self,
        #[wasm_bindgen(unchecked_param_type = "Numbers")] targets: &[f64],
        #[wasm_bindgen(unchecked_optional_param_type = "Configuration")] start: JsValue,
    ) -> Result<JointPath, Exception> {
        let targets = read_all(targets, "target")?;
        let start = self.start(start)?;
        let path = self.inner.track(&targets, &start).map_err(raise)?;
        let reached = path.reached();
        let (path, solutions) = path.split_report();
        let rows: Vec<u8> = solutions.iter().map(|row| row.reached.into()).collect();
        let report = object::of([("reached", js_sys::Uint8Array::from(&*rows).into())]);
        Ok(JointPath::new(&self.inner, path, reached, report.into()))
    }

    /// Creates a follower at the configuration `start`, for targets that come one at a time.
    pub fn follower(
        &self,
        #[wasm_bindgen(unchecked_optional_param_type = "Configuration")] start: JsValue,
    ) -> Result<Follower, Exception> {
        let start = self.start(start)?;
        Follower::new(Rc::clone(&self.inner), &start)
    }

    /// Creates a servo at the configuration `start`. It returns one command each `timeStep` seconds, within limits of
    /// position, velocity, acceleration and jerk.
    pub fn servo(
        &self,
        #[wasm_bindgen(unchecked_param_type = "Numbers")] start: &[f64],
        #[wasm_bindgen(js_name = timeStep)] time_step: f64,
        options: Option<ServoOptions>,
    ) -> Result<Servo, Exception> {
        Servo::new(Rc::clone(&self.inner), start, time_step, options)
    }

    /// The arm with another tool on its tip. Both arms share the seed atlas, which is the slow part of construction.
    #[wasm_bindgen(js_name = withTool)]
    pub fn with_tool(
        &self,
        #[wasm_bindgen(js_name = tipFromTool, unchecked_param_type = "Placement")]
        tip_from_tool: &[f64],
    ) -> Result<Self, Exception> {
        let tool = read(tip_from_tool, "tipFromTool")?;
        Ok(self.with(self.inner.with_tool(tool).map_err(raise)?))
    }

    /// Copy of the whole robot's configuration `qModel`, with the arm's joints at `q`.
    pub fn configuration(
        &self,
        #[wasm_bindgen(unchecked_param_type = "Numbers")] q: &[f64],
        #[wasm_bindgen(js_name = qModel, unchecked_param_type = "Numbers")] q_model: Vec<f64>,
    ) -> Result<Vec<f64>, Exception> {
        let mut whole = q_model;
        self.inner.configuration(q, &mut whole).map_err(raise)?;
        Ok(whole)
    }

    /// Values of the arm's joints in the whole robot's configuration `qModel`.
    #[wasm_bindgen(js_name = jointValues)]
    pub fn joint_values(
        &self,
        #[wasm_bindgen(js_name = qModel, unchecked_param_type = "Numbers")] q_model: &[f64],
    ) -> Result<Vec<f64>, Exception> {
        let mut q = Vec::new();
        self.inner.joint_values(q_model, &mut q).map_err(raise)?;
        Ok(q)
    }
}

#[cfg(feature = "collision")]
#[wasm_bindgen]
impl Arm {
    /// Creates an arm that avoids collisions with a world and the robot itself. The required distance is `margin`
    /// metres. `held` is a configuration of the robot's model, with the values of joints outside the arm.
    #[wasm_bindgen(js_name = keepingClear)]
    #[allow(clippy::too_many_arguments)] // Arguments of the constructor, and the obstacles.
    pub fn keeping_clear(
        robot: &Robot,
        base: Option<String>,
        tip: &str,
        shapes: &crate::world::CollisionModel,
        world: &crate::world::World,
        margin: Option<f64>,
        options: Option<options::ArmOptions>,
        #[wasm_bindgen(unchecked_optional_param_type = "Numbers")] held: Option<Vec<f64>>,
    ) -> Result<Self, Exception> {
        let arm = Self::new(robot, base, tip, options)?;
        let checker = shapes.checker(world, margin)?;
        let held = held.unwrap_or_else(|| checker.model().model().neutral());
        let inner = kinopt::Arm::clone(&arm.inner).with_checker(&checker, &held);
        Ok(arm.with(inner.map_err(raise)?))
    }

    /// The arm with another world.
    #[wasm_bindgen(js_name = withWorld)]
    pub fn with_world(
        &self,
        world: &crate::world::World,
        margin: Option<f64>,
    ) -> Result<Self, Exception> {
        let inner = self.inner.with_world(&world.inner, margin);
        Ok(self.with(inner.map_err(raise)?))
    }

    /// Pairs in collision, or nearer than the margin, at `q`.
    pub fn collisions(
        &self,
        #[wasm_bindgen(unchecked_param_type = "Numbers")] q: &[f64],
    ) -> Result<crate::solution::Collisions, Exception> {
        let collisions = self.inner.collisions(q).map_err(raise)?;
        Ok(crate::solution::collisions(&collisions))
    }
}
