//! Problems: tasks on a model.

use std::rc::Rc;

use kinopt::model::UnknownName;
use kinopt::problem::Targets;
use kinopt_bindings::task::Aimed;
use kinopt_bindings::{parameters, problem};
use wasm_bindgen::prelude::*;

use crate::arguments::{self, NamedArguments};
use crate::error::{Exception, raise};
use crate::model::Model;
use crate::parameters::parameter_map;
use crate::skeleton::Skeleton;
use crate::task::{self, BoxedTask};
use crate::value::Value;

#[wasm_bindgen(typescript_custom_section)]
const TYPES: &str = r#"
/** Common options of all tasks. */
export interface TaskOptions {
    /**
     * Name in reports, and key of `Targets`. Tasks with moving targets need different names. Default: the kind and
     * frame, with backticks: "point of `tool`".
     */
    name?: string;
    /** Weight of each row; default: 1 per metre, a quarter of the model's reach per radian. */
    weight?: number;
    /** Factor of all weights, given or default; default 1. */
    scale?: number;
    /** Error within which the task counts as reached, metres or radians; default: that of the problem. */
    tolerance?: number;
    /**
     * "goal" is a required task. "preference" is a soft task, solved in the null space of the required ones. Default:
     * "goal", but "preference" for postures and similar tasks.
     */
    role?: "goal" | "preference";
    /** Strict priority level: level 0 comes first. */
    level?: number;
}

/** A task of a problem, as created by `tasks`. */
export type Task = TaskOptions & (
    | { kind: "point"; frame: string; target: Numbers; at?: Numbers; base?: string }
    | { kind: "pose"; frame: string; target: Placement; tool?: Placement; goal?: "pose" | "position" | Numbers; base?: string }
    | { kind: "orientation"; frame: string; target: Placement; base?: string }
    | { kind: "lookAt"; frame: string; axis: Numbers; target: Numbers }
    | { kind: "gaze"; frame: string; axis: Numbers; halfAngle: number; target?: Numbers; direction?: Numbers }
    | { kind: "distance"; a: string; b: string; distance: number }
    | { kind: "plane"; frame: string; point: Numbers; normal: Numbers }
    | { kind: "ray"; frame: string; eye: Numbers; through: Numbers }
    | { kind: "pixel"; frame: string; camera: Numbers; target: Numbers }
    | { kind: "posture"; reference: Numbers | Readonly<Record<string, number>>; jointWeights?: JointWeights | "upright" }
    | { kind: "smoothness"; previous: Numbers; timeStep: number; jointWeights?: JointWeights }
    | { kind: "limitCentring" }
    | { kind: "centerOfMass"; target: Numbers; free?: string; base?: string; masses?: MassesByFrame }
    | {
          kind: "supportPolygon"; points?: readonly Numbers[]; on?: Readonly<Record<string, readonly Numbers[]>>;
          margin?: number; up?: Numbers; masses?: MassesByFrame;
      }
    | { kind: "frameVelocity"; frame: string; previous: Placement; timeStep: number; linear?: Numbers; angular?: Numbers }
    | { kind: "jointCoupling"; coefficients: Readonly<Record<string, number>>; offset?: number }
    | { kind: "manipulability"; frame: string; least: number; base?: string; of?: "pose" | "position" | "orientation" }
    | { kind: "bounded"; task: Task; lower?: number; upper?: number }
);

/**
 * Weights of joints in a task: one number for each, or numbers by name. "by range" weights joints by half of their
 * ranges.
 */
export type JointWeights = Numbers | Readonly<Record<string, number>> | "by range";

/** Kilograms by frame, at its origin, or four numbers: kilograms and a position in the frame's coordinates. */
export type MassesByFrame = Readonly<Record<string, number | Numbers>>;

/**
 * Targets by the tasks' names.
 *
 * - Three numbers for a point, a look-at, a gaze at a position, and a centre of mass.
 * - A placement for a pose, an orientation, and the previous placement of a velocity task.
 * - Two points in one list for a plane and a ray, two numbers for a pixel.
 * - The values of its joints for a posture and a smoothness.
 * - A number for a distance, a coupling and a manipulability.
 */
export type Targets = Readonly<Record<string, Numbers | number>>;

export interface ProblemOptions {
    /** Locked joints with their values: radians, metres, or a quaternion w, x, y, z of a ball joint. */
    locked?: Readonly<Record<string, number | Numbers>>;
    /** Free joints; all others are locked. */
    only?: readonly string[];
    /** Configuration of the joints that `only` omits; default: 0, or the nearest limit. */
    held?: Numbers;
    /** Narrower limits of joints, `[lower, upper]`. */
    bounds?: Readonly<Record<string, readonly [number, number]>>;
    /** Tolerance of tasks that set none, metres and radians. */
    tolerance?: number;
    /** Soft tasks in the null space of the required ones ("within_goals", the default), or weighted against them. */
    preferences?: "within_goals" | "traded";
}
"#;

#[wasm_bindgen]
extern "C" {
    /// Tasks as objects.
    #[wasm_bindgen(typescript_type = "readonly Task[]")]
    pub type Tasks;
    /// Targets by name.
    #[wasm_bindgen(typescript_type = "Targets")]
    pub type TargetsByName;
    /// Options of a problem.
    #[wasm_bindgen(typescript_type = "ProblemOptions")]
    pub type ProblemOptions;
}

/// Tasks on a model, validated and compiled.
#[wasm_bindgen]
#[derive(Clone)]
pub struct Problem {
    pub(crate) inner: kinopt::Problem,
    tasks: Rc<[BoxedTask]>,
}

/// Arguments of a problem.
struct ProblemRequest<'a> {
    model: &'a Model,
    tasks: Tasks,
    options: Option<ProblemOptions>,
    holds: Option<kinopt::model::ParameterMap>,
}

impl ProblemRequest<'_> {
    fn problem(self, keep_clear: Option<&AddAvoidance<'_>>) -> Result<Problem, Exception> {
        // `Problem.holding` chooses the free joints itself.
        let of_joints = match self.holds {
            Some(_) => &[][..],
            None => &parameters::OPTIONS,
        };
        let known = problem::OPTIONS.iter().chain(of_joints).copied();
        let options = NamedArguments::of(self.options, "option of a problem", known)?;
        let mut builder = kinopt::Problem::builder(&self.model.inner);
        let parameters_of_options = parameter_map(self.model, &options)?;
        if let Some(map) = self.holds.or(parameters_of_options) {
            builder.parameters(map);
        }
        let tasks = js_sys::Array::from(&self.tasks);
        let tasks = tasks
            .iter()
            .map(|task| task::add(task, self.model, &mut builder));
        let tasks = tasks.collect::<Result<Vec<_>, _>>()?;
        problem::apply(&mut builder, &self.model.inner, &options)?;
        if let Some(add_avoidance) = keep_clear {
            add_avoidance(&mut builder);
        }
        Ok(Problem {
            inner: builder.build().map_err(raise)?,
            tasks: tasks.into(),
        })
    }
}

/// Adds collision avoidance to a problem.
type AddAvoidance<'a> = dyn Fn(&mut kinopt::problem::ProblemBuilder<'_>) + 'a;

#[wasm_bindgen]
impl Problem {
    /// Creates a problem from tasks on a model.
    #[wasm_bindgen(constructor)]
    pub fn new(
        model: &Model,
        tasks: Tasks,
        options: Option<ProblemOptions>,
    ) -> Result<Self, Exception> {
        let request = ProblemRequest {
            model,
            tasks,
            options,
            holds: None,
        };
        request.problem(None)
    }

    /// Creates a problem of a skeleton without limits, for a drag of the tips of the bones `dragged` from the angles
    /// `q`, radians. The trunk is locked at `q`, and the spine bends by at most 0.7 rad in all.
    #[wasm_bindgen(js_name = holding)]
    pub fn holding(
        skeleton: &Skeleton,
        dragged: Vec<String>,
        tasks: Tasks,
        #[wasm_bindgen(unchecked_param_type = "Numbers")] q: &[f64],
        options: Option<ProblemOptions>,
    ) -> Result<Self, Exception> {
        let inner = &skeleton.inner;
        let holds = inner.holds(&skeleton.bones_named(&dragged)?);
        let request = ProblemRequest {
            model: &skeleton.model(),
            tasks,
            options,
            holds: Some(holds.parameters(inner, q).map_err(raise)?),
        };
        request.problem(None)
    }

    /// Names of the tasks, for targets.
    #[wasm_bindgen(getter, js_name = taskNames)]
    pub fn task_names(&self) -> Vec<String> {
        self.names().map(str::to_owned).collect()
    }

    /// Number of solver variables.
    #[wasm_bindgen(getter)]
    pub fn variables(&self) -> usize {
        self.inner.variables()
    }
}

#[cfg(feature = "collision")]
#[wasm_bindgen]
impl Problem {
    /// Creates a problem that avoids collisions with a world and within the body, with a distance of at least `margin`
    /// metres.
    #[wasm_bindgen(js_name = keepingClear)]
    pub fn keeping_clear(
        model: &Model,
        tasks: Tasks,
        shapes: &crate::world::CollisionModel,
        world: &crate::world::World,
        margin: Option<f64>,
        options: Option<ProblemOptions>,
    ) -> Result<Self, Exception> {
        let checker = shapes.checker(world, margin)?;
        let request = ProblemRequest {
            model,
            tasks,
            options,
            holds: None,
        };
        request.problem(Some(&|builder| {
            builder.keep_clear(&checker);
        }))
    }
}

impl Problem {
    fn names(&self) -> impl Iterator<Item = &str> {
        (0..self.inner.tasks()).filter_map(|task| self.inner.task_name(task))
    }

    /// Moves the given targets.
    pub(crate) fn aim(
        &self,
        aimed: &mut Aimed<'_>,
        targets: Option<TargetsByName>,
    ) -> Result<(), Exception> {
        let targets = targets.map(JsValue::from);
        for (name, value) in arguments::entries(targets.as_ref(), "targets")? {
            let Some(index) = self.names().position(|known| known == name) else {
                return Err(raise(UnknownName::new("task", &name, self.names())));
            };
            if let Some(task) = self.tasks.get(index) {
                let what = format!("the target of {name}");
                task.read(&Value(value), &what)?(aimed)?;
            }
        }
        Ok(())
    }

    /// Targets of the problem with some of them moved.
    pub(crate) fn targets(&self, moved: Option<TargetsByName>) -> Result<Targets, Exception> {
        let mut targets = self.inner.targets();
        self.aim(&mut Aimed::Targets(&mut targets), moved)?;
        Ok(targets)
    }
}
