//! The arm and its single queries.

use std::sync::{Arc, OnceLock};

use kinopt::arm::{Base, GoalSet};
use kinopt::kinematics::Jacobian;
use kinopt_bindings::option::arm::{apply, options as arm_options};
use kinopt_bindings::option::check_name;
use kinopt_bindings::option::servo::ServoOptions;
use kinopt_bindings::per_joint::{self, per_joint};
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use super::all_solutions::{AllSolutions, SelfMotion};
use super::batch::{self, Batch};
use super::derivative::{self, ArmDerivative};
use super::reachability::Reachability;
use super::{Follower, GoalSetSolution, Servo, goal_set};
use crate::arrays::{self, axes};
use crate::collision::Obstacles;
use crate::coordinates::Coordinates;
use crate::error::{OrRaise, invalid};
use crate::goal::pose_bounds;
use crate::joint_path::JointPath;
use crate::kinematics::jacobians;
use crate::model::{Model, random_configurations};
use crate::named_configuration::by_position;
use crate::object::{Object, Options};
use crate::placement::{
    placement, placements, target as target_of, targets as targets_of, to_array, to_arrays,
};
use crate::pool::Pool;
use crate::robot::Robot;
use crate::signals::interruptible;
use crate::solution::{Collision, Solution};
use crate::solver::Solutions;
use crate::srdf::Srdf;
use crate::world::World;

/// An arm that solves pose queries: joint values from base, tip and target.
///
/// It is immutable and thread-safe. In all its methods a configuration has one number for each free joint between base
/// and tip, in that order (`joint_names`), radians or metres. It is an array, or a dict by joint name whose missing
/// joints are at `default_start`. Targets are base_from_tool, placements in any form of `kinopt.types.PlacementLike`. A
/// position alone requires `goal="position"`.
///
/// `robot` is a `Robot` or a `Model`; `base` and `tip` are frames of it, None for `base` is the world. Options, each
/// None for its default:
///
/// Raises `UnknownNameError` for unknown frames, joints and options, `InvalidValueError` for options out of range, and
/// if no joint between base and tip can move.
#[pyclass(frozen, module = "kinopt")]
pub(crate) struct Arm {
    pub(crate) inner: Arc<kinopt::Arm>,
    /// The `Robot` or `Model` of the arm.
    #[pyo3(get)]
    robot: Py<PyAny>,
    /// Frame of the targets; None for the world.
    #[pyo3(get)]
    base: Option<String>,
    /// The frame that carries the tool.
    #[pyo3(get)]
    tip: String,
    options: Py<PyDict>,
    /// Names, limits and units of the numbers of a configuration.
    #[pyo3(get)]
    pub(crate) coordinates: Py<Coordinates>,
    /// Compiled at the first query.
    jacobian: OnceLock<Pool<Jacobian>>,
}

impl Arm {
    /// The arm `inner` with the new value of one option.
    fn changed(
        &self,
        py: Python<'_>,
        inner: kinopt::Arm,
        option: &str,
        value: &Bound<'_, PyAny>,
    ) -> PyResult<Self> {
        let options = self.options.bind(py).copy()?;
        options.set_item(option, value)?;
        Ok(Self {
            inner: Arc::new(inner),
            robot: self.robot.clone_ref(py),
            base: self.base.clone(),
            tip: self.tip.clone(),
            options: options.unbind(),
            coordinates: self.coordinates.clone_ref(py),
            jacobian: OnceLock::new(),
        })
    }

    /// A solution of the arm.
    pub(super) fn solution(&self, py: Python<'_>, inner: kinopt::Solution) -> Solution {
        Solution::new(inner, self.coordinates.clone_ref(py))
    }

    /// Arms of one arm with each of several tools; the arm itself without tools.
    fn with_tools(&self, tools: Option<&Bound<'_, PyAny>>) -> PyResult<Vec<kinopt::Arm>> {
        let Some(tools) = tools else {
            return Ok(vec![self.inner.as_ref().clone()]);
        };
        let tools = placements(tools, "tools")?.to_vec("tools")?;
        let set = GoalSet::of_tools(&self.inner, &tools).or_raise()?;
        Ok(set.arms().to_vec())
    }

    /// Returns the given start, or the default one.
    pub(super) fn start(&self, start: Option<&Bound<'_, PyAny>>) -> PyResult<Vec<f64>> {
        match start {
            Some(start) => {
                let start = self.by_position(start, "start")?;
                Ok(arrays::vector_of(&start, "start", self.inner.joint_count())?.to_vec())
            }
            None => Ok(self.inner.default_start().to_vec()),
        }
    }

    /// Returns a configuration by joint name as an array; other values as they are.
    pub(crate) fn by_position<'py>(
        &self,
        q: &Bound<'py, PyAny>,
        what: &str,
    ) -> PyResult<Bound<'py, PyAny>> {
        by_position(q, |q| {
            let names: Vec<String> = self.inner.joints().map(str::to_owned).collect();
            per_joint::configuration(q, what, &names, self.inner.default_start())
        })
    }
}

#[pymethods]
impl Arm {
    #[new]
    #[pyo3(
        signature = (robot, base, tip, **options),
        text_signature = "(robot, base, tip, *, goal=None, tool=None, joint_limits=None, world=None, margin=None, \
            collision_model=None, posture=None, position_tolerance=None, orientation_tolerance=None, search=None, max_move=None, \
            joint_weights=None, locked=None, only=None, held=None, srdf=None, attempts=None, \
            iterations=None, time_limit=None, seed=None, global_search_on_miss=None, \
            limit_avoidance=None, metres_per_radian=None, atlas=None)"
    )]
    fn new(
        robot: &Bound<'_, PyAny>,
        base: Option<String>,
        tip: String,
        options: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Self> {
        let py = robot.py();
        let options = match options {
            Some(options) => options.copy()?,
            None => PyDict::new(py),
        };
        let obstacles = Obstacles::of(&options)?;
        let held = options.get_item("held")?.filter(|held| !held.is_none());
        let held = held.map(|held| arrays::copied(&held, "held")).transpose()?;
        // The caller may change arrays in it later.
        let options = py.import("copy")?.call_method1("deepcopy", (options,))?;
        let options = options.cast_into::<PyDict>()?;
        let from = match &base {
            Some(base) => Base::from(base),
            None => Base::World,
        };
        let (builder, model) = if let Ok(robot) = robot.cast::<Robot>() {
            let robot = &*robot.get().inner;
            (kinopt::Arm::builder(robot, from, &tip), robot.model())
        } else if let Ok(model) = robot.cast::<Model>() {
            let model = &*model.get().inner;
            (kinopt::Arm::builder(model, from, &tip), model)
        } else {
            let name = robot.get_type().name()?;
            return Err(invalid(format!(
                "an arm is made of a Robot or a Model, not {name}"
            )));
        };
        for name in options.keys() {
            let name: String = name.extract()?;
            check_name("option of an arm", &name, &arm_options()).or_raise()?;
        }
        let builder = apply(builder, &Options(&options), model)?;
        let inner = py.detach(|| builder.build()).or_raise()?;
        let inner = match options.get_item("srdf")?.filter(|srdf| !srdf.is_none()) {
            Some(srdf) => with_srdf(inner, &srdf)?,
            None => inner,
        };
        let checker = obstacles.checker(robot)?;
        let inner = match &checker {
            Some(checker) => {
                // The neutral configuration by default, for the joints outside the arm.
                let held = held.unwrap_or_else(|| checker.model().model().neutral());
                inner.with_checker(checker, &held).or_raise()?
            }
            None => inner,
        };
        let coordinates = Py::new(py, Coordinates::of_arm(&inner, model))?;
        Ok(Self {
            inner: Arc::new(inner),
            robot: robot.clone().unbind(),
            base,
            tip,
            options: options.unbind(),
            coordinates,
            jacobian: OnceLock::new(),
        })
    }

    /// Names of the free joints, base to tip: the order of a configuration.
    #[getter]
    fn joint_names(&self) -> Vec<&str> {
        self.inner.joints().collect()
    }

    /// Number of free joints: the length of a configuration.
    #[getter]
    fn degrees_of_freedom(&self) -> usize {
        self.inner.joint_count()
    }

    /// Lower limits of the free joints, shape (dof,), radians or metres; -inf for none.
    #[getter]
    fn lower<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        arrays::frozen(py, self.inner.limits().map(|limits| limits.lower))
    }

    /// Upper limits of the free joints, shape (dof,), radians or metres; inf for none.
    #[getter]
    fn upper<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        arrays::frozen(py, self.inner.limits().map(|limits| limits.upper))
    }

    /// Velocity limits of the free joints, shape (dof,), rad/s or m/s; inf for none.
    #[getter]
    fn velocity_limits<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        arrays::frozen(py, self.inner.velocity_limits().iter().copied())
    }

    /// Acceleration limits of the free joints, shape (dof,), rad/s² or m/s²; inf for none. From the URDF or
    /// `Robot.with_joint_limits`.
    #[getter]
    fn acceleration_limits<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        arrays::frozen(py, self.inner.acceleration_limits().iter().copied())
    }

    /// Jerk limits of the free joints, shape (dof,), rad/s³ or m/s³; inf for none. From the URDF or
    /// `Robot.with_joint_limits`.
    #[getter]
    fn jerk_limits<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        arrays::frozen(py, self.inner.jerk_limits().iter().copied())
    }

    /// The start of `solve`, `solve_batch`, `solve_all`, `track` and `follower` without one, shape (dof,), radians or
    /// metres. It is the state "ready" or "home" of `srdf`, else the middle of each joint's limits. For a joint without
    /// a limit on one side it is the value closest to 0.
    #[getter]
    fn default_start<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        arrays::frozen(py, self.inner.default_start().iter().copied())
    }

    /// Configurations sampled uniformly within the limits, shape (n, dof), or (dof,) for `n` None, radians or metres.
    ///
    /// Equal seeds give equal configurations. They may be in collision. `seed` is a whole number or a
    /// `numpy.random.Generator`. Raises `InvalidValueError` for a seed or an `n` that is not a whole number of at least
    /// 0.
    #[pyo3(signature = (n = None, *, seed = None))]
    fn random_configuration<'py>(
        &self,
        py: Python<'py>,
        #[pyo3(from_py_with = crate::arrays::whole_or_none)] n: Option<usize>,
        seed: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        random_configurations(py, seed, n, self.inner.joint_count(), |seed| {
            self.inner.random_configuration(seed)
        })
    }

    /// The arm with another world, copied at this moment, or another margin (metres; None keeps it). Takes tens of
    /// microseconds, because the seed atlas is shared.
    ///
    /// Raises `InvalidValueError` for an arm that was made without `world` and without `margin`, for a margin out of
    /// range, and for an obstacle that is attached to an unknown frame.
    #[pyo3(signature = (world, margin=None))]
    fn with_world(
        &self,
        py: Python<'_>,
        world: &Bound<'_, World>,
        margin: Option<f64>,
    ) -> PyResult<Self> {
        let inner = self
            .inner
            .with_world(&world.get().snapshot(), margin)
            .or_raise()?;
        let changed = self.changed(py, inner, "world", world)?;
        if let Some(margin) = margin {
            changed.options.bind(py).set_item("margin", margin)?;
        }
        Ok(changed)
    }

    /// Pairs nearer to each other than the margin at `q` (shape (dof,)), the deepest first: `Collision`s.
    ///
    /// Raises `InvalidValueError` for an arm that was made without `world` and without `margin`, for another shape and
    /// for numbers that are not finite.
    fn collisions(&self, q: &Bound<'_, PyAny>) -> PyResult<Vec<Collision>> {
        let q = self.by_position(q, "q")?;
        let q = arrays::vector_of(&q, "q", self.inner.joint_count())?;
        let pairs = self.inner.collisions(&q).or_raise()?;
        Ok(pairs.into_iter().map(Collision::from).collect())
    }

    /// True for each configuration, shape (N, dof), that is proven collision-free, shape (N,): the spheres that cover
    /// the links keep the margin. Eight are checked at once, far faster than by `collisions`. False proves nothing,
    /// because the spheres protrude from the shapes.
    ///
    /// Raises `InvalidValueError` for an arm that was made without `world` and without `margin`, for another shape and
    /// for numbers that are not finite.
    fn clear_by_spheres<'py>(&self, q: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyArray1<bool>>> {
        let (py, dof) = (q.py(), self.inner.joint_count());
        let q = arrays::rows(q, "q", dof)?;
        let q: &[f64] = &q;
        let mut clear = vec![false; q.len() / dof];
        py.detach(|| self.inner.clear_by_spheres(q, &mut clear))
            .or_raise()?;
        Ok(PyArray1::from_vec(py, clear))
    }

    /// Jacobian of the tool: shape (6, dof) for `q` of shape (dof,), (N, 6, dof) for (N, dof).
    ///
    /// Rows are the velocity of the tool's origin (m/s), then its angular velocity (rad/s), both in the axes of the
    /// base. Columns are the free joints, with their mimic joints. Raises `InvalidValueError` for another shape and for
    /// numbers that are not finite.
    fn jacobian<'py>(&self, q: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        let pool = match self.jacobian.get() {
            Some(pool) => pool,
            None => {
                let jacobian = self.inner.jacobian().or_raise()?;
                self.jacobian.get_or_init(|| Pool::new(jacobian))
            }
        };
        jacobians(&self.by_position(q, "q")?, pool, 1)
    }

    /// Derivative of the solution `q` (shape (dof,)) with respect to its target. The `by_target` of the
    /// `ArmDerivative` has shape (dof, 6), or (N, dof, 6) for (N, dof) and N targets.
    ///
    /// Computed by the implicit function theorem with the active limits of the solution, reached or not. Check
    /// `differentiability` before use. Raises `InvalidValueError` as `solve` does, and for other shapes.
    fn derivative(
        &self,
        target: &Bound<'_, PyAny>,
        q: &Bound<'_, PyAny>,
    ) -> PyResult<ArmDerivative> {
        derivative::derivative(&self.inner, target, &self.by_position(q, "q")?)
    }

    /// Pose of the tool: base_from_tool, shape (4, 4) for `q` of shape (dof,), (N, 4, 4) for (N, dof).
    ///
    /// Raises `InvalidValueError` for another shape and for numbers that are not finite.
    fn base_from_tool<'py>(&self, q: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        let (py, dof) = (q.py(), self.inner.joint_count());
        let q = &self.by_position(q, "q")?;
        if axes(q)? < 2 {
            let q = arrays::vector_of(q, "q", dof)?;
            let placement = self.inner.base_from_tool(&q).or_raise()?;
            return Ok(to_array(py, &placement)?.into_any());
        }
        let q = arrays::rows(q, "q", dof)?;
        let q: &[f64] = &q;
        let compute = || {
            q.chunks_exact(dof)
                .map(|q| self.inner.base_from_tool(q))
                .collect()
        };
        let placements: Result<Vec<_>, _> = py.detach(compute);
        Ok(to_arrays(py, &placements.or_raise()?)?.into_any())
    }

    /// Solves for one target from one start: a `Solution`, reached or not, whose `q` has shape (dof,), radians or metres.
    ///
    /// `target` is base_from_tool, metres. `start` is a configuration of shape (dof,) or a dict by joint name, inside or
    /// outside the limits; None is `default_start`.
    ///
    /// Raises `InvalidValueError` for a target that is not a rigid motion to 1e-6, and for a start of another length or
    /// one that is not finite. Raises it for a position without orientation unless the goal leaves the orientation free. A target that is not reached is no error: see `Solution.reached` and `Solution.explain`.
    #[pyo3(signature = (target, start = None))]
    fn solve(
        &self,
        py: Python<'_>,
        target: &Bound<'_, PyAny>,
        start: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Solution> {
        let target = target_of(target, "target", &self.inner.goal())?;
        let start = match start {
            Some(start) => arrays::copied(&self.by_position(start, "start")?, "start")?,
            None => self.start(None)?,
        };
        let solution = interruptible(py, || self.inner.solve(target, &start))?;
        Ok(self.solution(py, solution.or_raise()?))
    }

    /// All solutions of one target, nearest to the start first: an `AllSolutions`. `target` and `start`, shape (dof,), are
    /// as in `solve`.
    ///
    /// For six revolute joints and a full pose the set is complete: all isolated solutions within the limits, each with
    /// its whole turns, collision-free if the arm has a world. Other arms return what their attempts find, at least
    /// 1e-3 rad apart, or 0.5 rad for a redundant arm (weighted joint distance).
    ///
    /// Raises `InvalidValueError` as `solve` does.
    #[pyo3(signature = (target, start = None))]
    fn solve_all(
        &self,
        py: Python<'_>,
        target: &Bound<'_, PyAny>,
        start: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<AllSolutions> {
        let target = target_of(target, "target", &self.inner.goal())?;
        let start = self.start(start)?;
        let all = interruptible(py, || self.inner.solve_all_from(target, &start))?.or_raise()?;
        Ok(AllSolutions::new(all, self.inner.joint_count()))
    }

    /// The self-motions of an arm of seven revolute joints: all curves of configurations that keep the tool at a target,
    /// as a list of `SelfMotion`, one for each connected component within the limits.
    ///
    /// Samples are at most 0.05 rad apart in the largest joint. A closed curve within less than 0.05 rad of two of
    /// the joints can be missing. The result is None for other arms, and for other goals than the full pose.
    ///
    /// Raises `InvalidValueError` for a target that is not a rigid motion to 1e-6.
    fn self_motions(
        &self,
        py: Python<'_>,
        target: &Bound<'_, PyAny>,
    ) -> PyResult<Option<Vec<SelfMotion>>> {
        let target = target_of(target, "target", &self.inner.goal())?;
        let motions = interruptible(py, || self.inner.self_motions(target))?.or_raise()?;
        Ok(motions.map(|motions| motions.into_iter().map(SelfMotion::new).collect()))
    }

    /// Decides whether any configuration within the joint limits reaches a target: by a solution, or by a proof that
    /// there is none. `target` and `start` are as in `solve`.
    ///
    /// The proof excludes boxes of joint values by bounds on the motion of the arm, at most `max_boxes` of them. A box
    /// takes some microseconds. Targets near the border of the reachable set need the most, and can remain undecided.
    /// Collisions count for solutions only. Proofs need at most eight joints without mimic joints, and a goal that is a
    /// pose, a position, or a pose with a free rotation about an axis.
    ///
    /// Raises `InvalidValueError` as `solve` does.
    #[pyo3(signature = (target, start = None, *, max_boxes = 100_000))]
    fn reachability(
        &self,
        py: Python<'_>,
        target: &Bound<'_, PyAny>,
        start: Option<&Bound<'_, PyAny>>,
        #[pyo3(from_py_with = crate::arrays::whole)] max_boxes: usize,
    ) -> PyResult<Reachability> {
        let target = target_of(target, "target", &self.inner.goal())?;
        let start = self.start(start)?;
        let answer = interruptible(py, || self.inner.reachability(target, &start, max_boxes))?;
        let answer = answer.or_raise()?;
        Ok(Reachability {
            reachable: answer.is_reachable(),
            boxes: answer.boxes(),
            solution: Py::new(py, self.solution(py, answer.into_solution()))?,
        })
    }

    /// Solves every target with each of several tools, and ranks the reached ones: `kinopt.solve_goals` for one arm.
    /// `tools`, shape (M, 4, 4), are placements of the tool in the tip, None for the arm's own tool.
    ///
    /// Raises the errors of `kinopt.solve_goals`.
    #[pyo3(
        signature = (targets, tools = None, start = None, *, criterion = None, threads = 1),
        text_signature = "($self, targets, tools=None, start=None, *, criterion='distance', threads=1)"
    )]
    fn solve_goals(
        &self,
        py: Python<'_>,
        targets: &Bound<'_, PyAny>,
        tools: Option<&Bound<'_, PyAny>>,
        start: Option<&Bound<'_, PyAny>>,
        criterion: Option<&Bound<'_, PyAny>>,
        #[pyo3(from_py_with = crate::arrays::whole_or_none)] threads: Option<usize>,
    ) -> PyResult<GoalSetSolution> {
        let arms = self.with_tools(tools)?;
        let starts = vec![self.start(start)?; arms.len()];
        goal_set::solve(py, arms, targets, starts, criterion, threads)
    }

    /// Solves a batch of targets: a `Batch` of arrays.
    ///
    /// `targets` has shape (N, 4, 4), (N, 7) or (N, 3), or is a list of placements, or a tuple of N positions and N
    /// rotations. `starts` has shape (N, dof), or (dof,) for a common start, also as a dict by joint name; None is `default_start`. Each result depends only on its target and start: q and errors equal those of
    /// `solve` exactly, on any number of `threads` (None: all cores). With the search "first", the lowest attempt is
    /// selected instead of the fastest. `out` is a float64 array of shape (N, dof) for the configurations. `progress`
    /// is called with (done, total) from time to time; True shows a progress bar if tqdm is installed. Ctrl-C
    /// interrupts the computation.
    ///
    /// Raises `InvalidValueError`, which names the target, as `solve` does; for starts of another shape, and for an
    /// `out` of another shape or type.
    #[pyo3(signature = (targets, starts = None, threads = 1, *, out = None, progress = None))]
    fn solve_batch<'py>(
        slf: &Bound<'py, Self>,
        targets: &Bound<'py, PyAny>,
        starts: Option<&Bound<'py, PyAny>>,
        #[pyo3(from_py_with = crate::arrays::whole_or_none)] threads: Option<usize>,
        out: Option<&Bound<'py, PyAny>>,
        progress: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Batch> {
        let starts = match starts {
            Some(starts) => slf.get().by_position(starts, "starts")?,
            None => arrays::list(targets.py(), &slf.get().start(None)?).into_any(),
        };
        batch::solve(slf, targets, &starts, threads, out, progress)
    }

    /// Follows a path of targets, as in `solve_batch`, from `start`, on one branch. A first target far from the
    /// start is solved as by `solve`, and can be on another branch. The `JointPath` lists every step in which a joint moves
    /// farther than 0.2 rad as a jump. Its report has the `Solutions` of the targets.
    ///
    /// Raises `InvalidValueError`, which names the target, as `solve` does.
    #[pyo3(signature = (targets, start = None))]
    fn track(
        slf: &Bound<'_, Self>,
        targets: &Bound<'_, PyAny>,
        start: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<JointPath> {
        let (py, arm) = (slf.py(), slf.get());
        let targets = targets_of(targets, "target", &arm.inner.goal())?.to_vec("target")?;
        let start = arm.start(start)?;
        let path = py.detach(|| arm.inner.track(&targets, &start)).or_raise()?;
        let reached = path.reached();
        let (path, solutions) = path.split_report();
        let report = Solutions::new(solutions, arm.coordinates.clone_ref(py));
        let report = Py::new(py, report)?.into_any();
        Ok(JointPath::new(slf, path, reached, report))
    }

    /// A `Follower` at `start`, shape (dof,), for a path whose targets come one at a time. It stays on the branch of the
    /// start, unless `global_search_on_miss` is set, and reports jumps.
    ///
    /// Raises `InvalidValueError` for a start of another length or one that is not finite.
    #[pyo3(signature = (start = None))]
    fn follower(&self, py: Python<'_>, start: Option<&Bound<'_, PyAny>>) -> PyResult<Follower> {
        let coordinates = self.coordinates.clone_ref(py);
        Follower::new(Arc::clone(&self.inner), coordinates, &self.start(start)?)
    }

    /// A `Servo` at `start` that takes a target every `time_step` seconds.
    ///
    /// `velocity_limits`, `acceleration_limits`, `jerk_limits`: one number for all joints or shape (dof,), rad/s, rad/s², rad/s³ or m/s, m/s², m/s³,
    /// inf for none. Default: those of the robot's files. They hold in every cycle for the differences of the commanded
    /// positions.
    /// `velocity`, `acceleration`: one number or shape (dof,), the motion at the start; default at rest.
    /// `straight_line`: keeps the tool on the straight line to its target, at reduced speed if necessary. The tool leaves
    /// the line near singular configurations and position limits, and while it brakes for a collision.
    /// `damping`: the tool motion, in radians for each radian of joint motion, that runs at half of its speed; default
    /// 0.01. More damping makes joints slower near singular configurations.
    ///
    /// A target out of reach ends at rest at the closest pose, with status "nearest". A collision ahead ends at rest
    /// before it, with status "blocked".
    ///
    /// Raises `InvalidValueError` for a start of another length or not finite, a time step that is not a positive
    /// number, limits or a damping out of range, and a joint whose motion violates a limit or which cannot brake before
    /// a position limit.
    #[pyo3(signature = (start, time_step, *, velocity_limits = None, acceleration_limits = None, jerk_limits = None, velocity = None, acceleration = None, straight_line = false, damping = None))]
    #[allow(clippy::too_many_arguments)]
    fn servo(
        &self,
        start: &Bound<'_, PyAny>,
        time_step: f64,
        velocity_limits: Option<&Bound<'_, PyAny>>,
        acceleration_limits: Option<&Bound<'_, PyAny>>,
        jerk_limits: Option<&Bound<'_, PyAny>>,
        velocity: Option<&Bound<'_, PyAny>>,
        acceleration: Option<&Bound<'_, PyAny>>,
        straight_line: bool,
        damping: Option<f64>,
    ) -> PyResult<Servo> {
        let start = self.start(Some(start))?;
        let names: Vec<String> = self.inner.joints().map(str::to_owned).collect();
        let numbers = |value: Option<&Bound<'_, PyAny>>, name: &str, default| {
            value
                .map(|value| per_joint(&Object::of(value), name, &names, default))
                .transpose()
        };
        let options = ServoOptions {
            velocity_limits: numbers(velocity_limits, "velocity_limits", None)?,
            acceleration_limits: numbers(acceleration_limits, "acceleration_limits", None)?,
            jerk_limits: numbers(jerk_limits, "jerk_limits", None)?,
            velocity: numbers(velocity, "velocity", Some(0.0))?,
            acceleration: numbers(acceleration, "acceleration", Some(0.0))?,
            straight_line,
            damping,
        };
        Servo::new(Arc::clone(&self.inner), &start, time_step, &options)
    }

    /// The arm with another tool on its tip, a placement in metres. Fast, because the table of seeds is shared.
    ///
    /// Raises `InvalidValueError` for a placement that is not rigid.
    fn with_tool(&self, tip_from_tool: &Bound<'_, PyAny>) -> PyResult<Self> {
        let arm = self
            .inner
            .with_tool(placement(tip_from_tool, "tool")?)
            .or_raise()?;
        self.changed(tip_from_tool.py(), arm, "tool", tip_from_tool)
    }

    /// The arm with another goal, a `PoseBounds`, "pose" or "position". Fast, because the table of seeds is shared.
    ///
    /// Raises `InvalidValueError` for a goal that is incompatible with the arm's other options.
    fn with_goal(&self, goal: &Bound<'_, PyAny>) -> PyResult<Self> {
        let bounds = pose_bounds(goal, "goal")?;
        let arm = self.inner.with_goal(bounds).or_raise()?;
        self.changed(goal.py(), arm, "goal", goal)
    }

    /// Writes the arm's joints `q` (shape (dof,)) and their mimic joints into a configuration of the whole model. The
    /// result is a new array of shape (model's dof,), whose other numbers are those of `q_model`.
    ///
    /// Raises `InvalidValueError` for other lengths.
    fn configuration<'py>(
        &self,
        q: &Bound<'py, PyAny>,
        q_model: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let mut configuration = arrays::vector(q_model, "q_model")?.to_vec();
        let q = self.by_position(q, "q")?;
        let q_arm = arrays::vector(&q, "q")?;
        self.inner
            .configuration(&q_arm, &mut configuration)
            .or_raise()?;
        Ok(arrays::list(q.py(), &configuration))
    }

    /// Reads the arm's joints from a configuration of the whole model: shape (dof,).
    ///
    /// Raises `InvalidValueError` for another length.
    fn joint_values<'py>(
        &self,
        q_model: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let mut q = Vec::new();
        let configuration = arrays::vector(q_model, "q_model")?;
        self.inner.joint_values(&configuration, &mut q).or_raise()?;
        Ok(arrays::list(q_model.py(), &q))
    }

    fn __getnewargs_ex__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let arguments = (self.robot.bind(py), self.base.as_deref(), self.tip.as_str());
        Ok((arguments, self.options.bind(py))
            .into_pyobject(py)?
            .into_any())
    }

    fn __repr__(&self) -> String {
        format!(
            "Arm({} to {:?}, {} joints)",
            self.base
                .as_ref()
                .map_or("world".to_owned(), |base| format!("{base:?}")),
            self.tip,
            self.inner.joint_count()
        )
    }
}

/// Returns the arm whose default start is a group state of an SRDF file.
fn with_srdf(arm: kinopt::Arm, srdf: &Bound<'_, PyAny>) -> PyResult<kinopt::Arm> {
    match srdf.cast::<Srdf>() {
        Ok(srdf) => Ok(arm.with_srdf(srdf.get().inner())),
        Err(_) => Err(invalid(format!("srdf must be a kinopt.Srdf, not {srdf}"))),
    }
}
