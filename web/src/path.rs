//! Cartesian paths of arms, with the fewest reconfigurations.

use js_sys::{Array, Reflect};
use kinopt::motion::path::{CartesianPath, PathReport};
use kinopt_bindings::names::miss_reason;
use kinopt_bindings::option::{self, names};
use wasm_bindgen::prelude::*;

use crate::arguments::NamedArguments;
use crate::arm::Arm;
use crate::error::{Exception, raise};
use crate::joint_path::JointPath;
use crate::placement::{columns, read, read_all};
use crate::value::Value;
use crate::{arguments, object, solution};

/// Default largest distance of points on a segment, metres.
const DEFAULT_STEP: f64 = 0.01;

#[wasm_bindgen(typescript_custom_section)]
const TYPES: &str = r#"
export interface PathOptions {
    /** From first to last (the default), as a closed path, or as a closed path from the best entry. */
    traversal?: "open" | "cyclic" | "any-start";
    /** Configuration of the first point, or of the last; default: any. */
    start?: Configuration;
    end?: Configuration;
    /** Weight of a radian or metre of each joint in the path length. */
    jointWeights?: PerJoint;
    /** Largest displacement of a joint between two points on the same branch, radians; default: 0.2. */
    maxStep?: number;
    /** Largest number of known configurations of a point; default: 256. */
    samples?: number;
    /** Time of each point, seconds. With `keepTimes` a step that is too fast for a joint is a reconfiguration too. */
    times?: Numbers;
    keepTimes?: boolean;
    /**
     * Further tools of the arm, sixteen numbers each, relative to the tip. `toolOfPoints` has the tool of each point: 0
     * is the arm's own tool, 1 the first of these.
     */
    tools?: Numbers;
    toolOfPoints?: Numbers;
}

/** A point of a path that the tool does not reach. */
export interface MissedPoint {
    index: number;
    /** Error beyond the goal bounds, metres and radians. */
    positionError: number;
    orientationError: number;
    reason: string;
}

/** A step of a path that is not proven collision-free. */
export interface BlockedStep extends Collision {
    index: number;
}

/** Errors of the joint path of a Cartesian path. */
export interface PathReport {
    /** Index of the point of the first row: 0 except for traversal "any-start". */
    entry: number;
    /** Weighted joint length of all steps. */
    length: number;
    /** Upper bounds of the tool's distance and rotation from the path between rows, metres and radians. */
    largestDeviation: number;
    largestTurn: number;
    /** Points that are not reached, in order. */
    missed: MissedPoint[];
    /** Steps that are not proven collision-free, for an arm that avoids collisions. */
    blocked: BlockedStep[];
}
"#;

#[wasm_bindgen]
extern "C" {
    /// Options of a path.
    #[wasm_bindgen(typescript_type = "PathOptions")]
    pub type PathOptions;
}

/// Solves a Cartesian path of the tool: a `CartesianPath`, or sixteen numbers for each point in the arm's base. The
/// result has the fewest reconfigurations, then the shortest. A point that is not reached is no exception: see `missed` of the report.
#[wasm_bindgen(js_name = solvePath, unchecked_return_type = "JointPath & { readonly report: PathReport }")]
pub fn solve_path(
    arm: &Arm,
    #[wasm_bindgen(unchecked_param_type = "Numbers | CartesianPath")] path: &JsValue,
    options: Option<PathOptions>,
) -> Result<JointPath, Exception> {
    let known = names(&option::path::options());
    let arguments = NamedArguments::of(options, "option of a path", known)?;
    let options = option::path::PathOptions {
        tool_of_points: arguments.wholes("toolOfPoints")?,
        ..option::path::PathOptions::of(&arguments, &arm.inner)?
    };
    let path = options.path::<Value>(read_path(path)?)?;
    let others = arguments.numbers("tools")?.unwrap_or_default();
    let others = read_all(&others, "tool")?.into_iter();
    let others = others.map(|tool| arm.inner.with_tool(tool).map_err(raise));
    let others = others.collect::<Result<Vec<_>, _>>()?;
    let inner = options.solve(&arm.inner, &others, &path).map_err(raise)?;
    let reached = inner.reached();
    let (inner, errors) = inner.split_report();
    Ok(JointPath::new(&arm.inner, inner, reached, report(&errors)))
}

/// Path of a tool in the base of an arm: points, and segments that continue from the last point. Points of a segment are
/// at most `step` metres (default 0.01) and 0.05 rad apart. A path is immutable: every method returns a longer one.
#[wasm_bindgen(js_name = CartesianPath)]
pub struct SegmentPath(CartesianPath);

#[wasm_bindgen(js_class = CartesianPath)]
impl SegmentPath {
    /// Creates a path through points, sixteen numbers each.
    #[wasm_bindgen(constructor)]
    pub fn new(
        #[wasm_bindgen(unchecked_param_type = "Numbers")] points: &[f64],
    ) -> Result<Self, Exception> {
        let points = read_all(points, "point")?;
        CartesianPath::new(points).map(Self).map_err(raise)
    }

    /// The path continued on straight lines through `keys`, sixteen numbers each.
    pub fn through(
        &self,
        #[wasm_bindgen(unchecked_param_type = "Numbers")] keys: &[f64],
        step: Option<f64>,
    ) -> Result<Self, Exception> {
        let (path, keys) = (self.0.clone(), read_all(keys, "key")?);
        let path = path.through(&keys, step.unwrap_or(DEFAULT_STEP));
        path.map(Self).map_err(raise)
    }

    /// The path continued on a circular arc through the position `via` to the placement `end`.
    #[wasm_bindgen(js_name = arcThrough)]
    pub fn arc_through(
        &self,
        #[wasm_bindgen(unchecked_param_type = "Numbers")] via: &JsValue,
        #[wasm_bindgen(unchecked_param_type = "Placement")] end: &[f64],
        step: Option<f64>,
    ) -> Result<Self, Exception> {
        let (via, end) = (arguments::vector::<3>(via, "via")?, read(end, "end")?);
        let path = self.0.clone();
        let path = path.arc_through(via, end, step.unwrap_or(DEFAULT_STEP));
        path.map(Self).map_err(raise)
    }

    /// The path continued on a Catmull-Rom spline through `keys`, sixteen numbers each.
    #[wasm_bindgen(js_name = splineThrough)]
    pub fn spline_through(
        &self,
        #[wasm_bindgen(unchecked_param_type = "Numbers")] keys: &[f64],
        step: Option<f64>,
    ) -> Result<Self, Exception> {
        let (path, keys) = (self.0.clone(), read_all(keys, "key")?);
        let path = path.spline_through(&keys, step.unwrap_or(DEFAULT_STEP));
        path.map(Self).map_err(raise)
    }

    /// Points in the base, sixteen numbers each.
    #[wasm_bindgen(getter)]
    pub fn points(&self) -> Vec<f64> {
        self.0.points().iter().flat_map(columns).collect()
    }

    /// Bounds on the distance of the curve from the straight step to each point, metres; empty for straight steps.
    #[wasm_bindgen(getter)]
    pub fn bulges(&self) -> Vec<f64> {
        self.0.bulges().to_vec()
    }
}

/// Reads a list of points, or the points and bulges of a `CartesianPath`.
fn read_path(path: &JsValue) -> Result<CartesianPath, Exception> {
    if arguments::list(path).is_some() {
        let points = arguments::numbers(path, "path")?;
        return CartesianPath::new(read_all(&points, "point")?).map_err(raise);
    }
    let field = |name: &str| {
        let field = Reflect::get(path, &name.into()).unwrap_or(JsValue::UNDEFINED);
        arguments::numbers(&field, &format!("path.{name}"))
    };
    let points = read_all(&field("points")?, "point")?;
    let path = CartesianPath::new(points).map_err(raise)?;
    path.with_bulges(field("bulges")?).map_err(raise)
}

/// Report as an object.
fn report(report: &PathReport) -> JsValue {
    let missed = report.missed.iter().map(|missed| {
        let reason = miss_reason(&missed.reason);
        object::of([
            ("index", missed.index.into()),
            ("positionError", missed.position_error.into()),
            ("orientationError", missed.orientation_error.into()),
            ("reason", reason.into()),
        ])
    });
    let blocked = report.blocked.iter().map(|step| {
        let fields = object::of(solution::fields(&step.by));
        object::add(&fields, [("index", step.index.into())]);
        fields
    });
    let fields = object::of([
        ("entry", report.entry.into()),
        ("length", report.length.into()),
        ("largestDeviation", report.largest_deviation.metres.into()),
        ("largestTurn", report.largest_deviation.radians.into()),
        ("missed", missed.collect::<Array>().into()),
        ("blocked", blocked.collect::<Array>().into()),
    ]);
    fields.into()
}
