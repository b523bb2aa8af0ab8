//! Robots from URDF and MJCF.

use std::rc::Rc;

use kinopt::spatial::Vector3;
use kinopt_bindings::option::{names, robot};
use kinopt_bindings::shape::{self, Measure};
use wasm_bindgen::prelude::*;

use crate::arguments::NamedArguments;
use crate::error::{Exception, raise};
use crate::model::Model;
use crate::value::Value;
use crate::{object, placement};

#[wasm_bindgen(typescript_custom_section)]
const TYPES: &str = r#"
export interface BaseOptions {
    /** Base joint: "fixed" (the default), "free", "planar", "slide-x", ... */
    baseJoint?: string;
    /** Base bounds, metres: `{ z: [0, 1] }`. */
    baseBounds?: Record<string, readonly [number, number]>;
}

export interface RobotOptions extends BaseOptions {
    /** Repairs defects that have a unique repair, and lists them in `repairs`. */
    lenient?: boolean;
    /**
     * Limits that restrict the source joint of mimic joints: its own ("source", the default), or also theirs ("both").
     */
    mimicLimits?: "source" | "both";
    /** Applies the file's soft limits. */
    softLimits?: boolean;
}

/** A shape of a link, centred on its own origin; metres. */
export interface Shape {
    kind: "box" | "cylinder" | "capsule" | "sphere" | "ellipsoid" | "mesh";
    name?: string;
    /** A 4 x 4 matrix by columns. */
    linkFromShape: Float64Array;
    size?: Float64Array;
    radius?: number;
    length?: number;
    /** Radii of an ellipsoid along x, y and z. */
    radii?: Float64Array;
    file?: string;
    scale?: Float64Array;
}
"#;

#[wasm_bindgen]
extern "C" {
    /// A shape as an object.
    #[wasm_bindgen(typescript_type = "Shape[]")]
    pub type Shapes;
    /// Points of three numbers.
    #[wasm_bindgen(typescript_type = "Float64Array[]")]
    pub type Points;
    /// Options of a robot's base.
    #[wasm_bindgen(typescript_type = "BaseOptions")]
    pub type BaseOptions;
    /// Options of a robot.
    #[wasm_bindgen(typescript_type = "RobotOptions")]
    pub type RobotOptions;
}

/// A robot: joints, links, limits.
#[wasm_bindgen]
pub struct Robot {
    pub(crate) inner: Rc<kinopt::robot::Robot>,
}

#[wasm_bindgen]
impl Robot {
    /// Reads the text of a URDF file, not its path; `name` is the file's name in messages.
    #[wasm_bindgen(js_name = fromUrdf)]
    pub fn from_urdf(
        text: &str,
        name: Option<String>,
        options: Option<RobotOptions>,
    ) -> Result<Self, Exception> {
        // No file is opened here.
        let known = names(&robot::options())
            .into_iter()
            .filter(|name| *name != "confine");
        let options = NamedArguments::of(options, "option of a robot", known)?;
        let options = robot::RobotOptions::of(&options)?;
        let inner = options.parse::<Value>(text, name.as_deref().unwrap_or("robot.urdf"))?;
        let inner = options.limited::<Value>(inner)?;
        on(&options.base, inner)
    }

    /// Creates a robot from the model of a rig, a skeleton or any other model, with an optional base joint.
    #[wasm_bindgen(js_name = ofModel)]
    pub fn of_model(model: &Model, options: Option<BaseOptions>) -> Result<Self, Exception> {
        let inner = kinopt::robot::Robot::new(model.inner.clone(), Vec::new());
        on_base(inner.map_err(raise)?, options)
    }

    /// Joints and frames of the robot.
    #[wasm_bindgen(getter)]
    pub fn model(&self) -> Model {
        Model {
            robot: Some(Rc::clone(&self.inner)),
            ..self.inner.model().clone().into()
        }
    }

    /// Name of the robot.
    #[wasm_bindgen(getter)]
    pub fn name(&self) -> String {
        self.inner.name().to_owned()
    }

    /// Names of the frames at the ends of the robot's chains.
    #[wasm_bindgen(getter)]
    pub fn tips(&self) -> Vec<String> {
        let frames = self.inner.model().frames();
        let tips = self.inner.tips().into_iter();
        tips.map(|tip| frames[tip.index()].name.clone()).collect()
    }

    /// Repairs of a lenient read.
    #[wasm_bindgen(getter)]
    pub fn repairs(&self) -> Vec<String> {
        let repairs = self.inner.repairs().iter();
        repairs.map(ToString::to_string).collect()
    }

    /// Names of the joints from one link to another.
    pub fn chain(&self, base: &str, tip: &str) -> Result<Vec<String>, Exception> {
        let joints = self.inner.chain(base, tip).map_err(raise)?;
        let all = self.inner.model().joints();
        let names = joints.iter().map(|id| all[id.index()].name.clone());
        Ok(names.collect())
    }

    /// The robot with an additional frame on a link.
    #[wasm_bindgen(js_name = withTool)]
    pub fn with_tool(
        &self,
        name: &str,
        link: &str,
        #[wasm_bindgen(js_name = linkFromTool, unchecked_param_type = "Placement")]
        link_from_tool: &[f64],
    ) -> Result<Self, Exception> {
        let placement = placement::read(link_from_tool, "linkFromTool")?;
        let inner_robot = kinopt::robot::Robot::clone(&self.inner);
        let inner = inner_robot
            .with_tool(name, link, placement)
            .map_err(raise)?;
        Ok(inner.into())
    }

    /// Visual shapes of a link, or its collision shapes; empty for frames without shapes.
    pub fn shapes(&self, link: &str, collision: Option<bool>) -> Result<Shapes, Exception> {
        let frame = self.inner.model().frame(link).map_err(raise)?;
        let shapes = match (self.inner.link(frame), collision) {
            (None, _) => &[][..],
            (Some(link), Some(true)) => &link.collisions,
            (Some(link), _) => &link.visuals,
        };
        let list: js_sys::Array = shapes.iter().map(shape_object).collect();
        Ok(list.unchecked_into())
    }

    /// Crouched configuration: `q` with a free base lower by a fifteenth of its height. The frames `feet` are at their
    /// poses, and all other joints near `q`. The slightly bent knees avoid the singularity of straight legs. z is up.
    /// Returns `q` for a robot without a free base, and if the feet cannot stay.
    #[wasm_bindgen(js_name = crouchedConfiguration)]
    pub fn crouched_configuration(
        &self,
        feet: Vec<String>,
        #[wasm_bindgen(unchecked_param_type = "Numbers")] q: &[f64],
    ) -> Result<Vec<f64>, Exception> {
        let model = self.inner.model();
        let feet = feet.iter().map(|foot| model.frame(foot).map_err(raise));
        let feet = feet.collect::<Result<Vec<_>, Exception>>()?;
        let up = Vector3::UNITS[2];
        kinopt::ik::crouched_configuration(model, self.inner.map(), &feet, q, up).map_err(raise)
    }

    /// Contact points of a foot, in its frame, metres. They are the origins of its link and of the links fixed to it,
    /// and the corners of their collision shapes. `tasks.supportPolygon([], { on: { [foot]: robot.sole(foot) } })`
    /// balances over it.
    pub fn sole(&self, foot: &str) -> Result<Points, Exception> {
        let frame = self.inner.model().frame(foot).map_err(raise)?;
        let points = self.inner.sole(frame).into_iter();
        let list = points.map(|point| js_sys::Float64Array::from(&point.to_array()[..]));
        Ok(list.collect::<js_sys::Array>().unchecked_into())
    }
}

impl From<kinopt::robot::Robot> for Robot {
    fn from(inner: kinopt::robot::Robot) -> Self {
        let inner = Rc::new(inner);
        Self { inner }
    }
}

/// Puts a robot on the requested base.
fn on_base(robot: kinopt::robot::Robot, options: Option<BaseOptions>) -> Result<Robot, Exception> {
    let known = ["base_joint", "base_bounds"];
    let options = NamedArguments::of(options, "option of a robot", known)?;
    on(&robot::RobotOptions::of(&options)?.base, robot)
}

/// Puts a robot on a base. Without a base joint its bounds are ignored.
fn on(base: &robot::BaseSettings, robot: kinopt::robot::Robot) -> Result<Robot, Exception> {
    match base.joint {
        None => Ok(robot.into()),
        Some(_) => Ok(base.of::<Value>(robot)?.into()),
    }
}

#[cfg(feature = "mjcf")]
#[wasm_bindgen]
impl Robot {
    /// Reads the text of an MJCF file (MuJoCo); `name` is the file's name in messages. A configuration is MuJoCo's
    /// `qpos`. Included files must already be merged into the text.
    #[wasm_bindgen(js_name = fromMjcf)]
    pub fn from_mjcf(
        text: &str,
        name: Option<String>,
        options: Option<BaseOptions>,
    ) -> Result<Self, Exception> {
        let name = name.as_deref().unwrap_or("robot.xml");
        let inner = kinopt::robot::Robot::parse_mjcf(text, name);
        on_base(inner.map_err(raise)?, options)
    }
}

fn shape_object(shape: &kinopt::robot::GeometryObject) -> JsValue {
    let list = |numbers: &[f64]| JsValue::from(js_sys::Float64Array::from(numbers));
    let measures = shape::measures(&shape.geometry).into_iter();
    let fields = measures.map(|(name, measure)| {
        let value = match measure {
            Measure::Number(number) => number.into(),
            Measure::Numbers(numbers) => list(&numbers),
            Measure::Text(text) => text.into(),
        };
        (name, value)
    });
    let kind = shape::kind(&shape.geometry).into();
    let link_from_shape = list(&placement::columns(&shape.link_from_shape));
    let object = object::of([("linkFromShape", link_from_shape), ("kind", kind)]);
    let name = shape.name.as_deref().map(|name| ("name", name.into()));
    for (field, value) in fields.chain(name) {
        let _ = js_sys::Reflect::set(&object, &field.into(), &value);
    }
    object.into()
}
