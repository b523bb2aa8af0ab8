//! SRDF: semantic description of a robot.

use std::rc::Rc;

use kinopt::model::{FrameId, JointId};
use wasm_bindgen::prelude::*;

use crate::arguments::NamedArguments;
use crate::error::{Exception, raise};
use crate::object;
use crate::robot::Robot;

#[wasm_bindgen(typescript_custom_section)]
const TYPES: &str = r#"
/** An end effector: a gripper, a tool or a foot. */
export interface EndEffector {
    name: string;
    group: string;
    /** Link that the end effector is fixed to. */
    parentLink: string;
}

/** Options of reading an SRDF file. */
export interface SrdfOptions {
    /** Omits elements that name unknown joints, links or groups, and lists them in `repairs`; default: false. */
    lenient?: boolean;
}
"#;

#[wasm_bindgen]
extern "C" {
    /// Joints by group.
    #[wasm_bindgen(typescript_type = "Record<string, string[]>")]
    pub type Groups;
    /// End effectors as objects.
    #[wasm_bindgen(typescript_type = "EndEffector[]")]
    pub type EndEffectors;
    /// Pairs of links.
    #[wasm_bindgen(typescript_type = "[string, string][]")]
    pub type Pairs;
    /// Options of reading a file.
    #[wasm_bindgen(typescript_type = "SrdfOptions")]
    pub type SrdfOptions;
}

/// Content of an SRDF file: groups of joints, group states, passive joints, and disabled collision pairs of a robot.
#[wasm_bindgen]
pub struct Srdf {
    pub(crate) inner: kinopt::robot::Srdf,
    robot: Rc<kinopt::robot::Robot>,
}

#[wasm_bindgen]
impl Srdf {
    /// Reads the document of a robot; `name` is its name in messages.
    pub fn parse(
        text: &str,
        robot: &Robot,
        name: Option<String>,
        options: Option<SrdfOptions>,
    ) -> Result<Self, Exception> {
        let options = options.map_or(JsValue::UNDEFINED, JsValue::from);
        let options = NamedArguments::new(options, "option of an SRDF file", &["lenient"])?;
        let mut reader = kinopt::robot::Srdf::reader();
        if options.switch("lenient")?.unwrap_or(false) {
            reader = reader.lenient();
        }
        let name = name.as_deref().unwrap_or("robot.srdf");
        let robot = Rc::clone(&robot.inner);
        let inner = reader.parse(text, name, &robot).map_err(raise)?;
        Ok(Self { inner, robot })
    }

    /// Elements that a lenient read ignored.
    #[wasm_bindgen(getter)]
    pub fn repairs(&self) -> Vec<String> {
        let repairs = self.inner.repairs.iter();
        repairs.map(ToString::to_string).collect()
    }

    /// Moving joints of each group, parents before children, by the name of the group, as for an arm's `only`.
    #[wasm_bindgen(getter)]
    pub fn groups(&self) -> Groups {
        let groups = object::of([]);
        for group in &self.inner.groups {
            let joints: js_sys::Array = self.joints(&group.joints).collect();
            // Fails for frozen objects only.
            let _ = js_sys::Reflect::set(&groups, &group.name.as_str().into(), &joints);
        }
        JsValue::from(groups).unchecked_into()
    }

    /// Names of the group states.
    #[wasm_bindgen(getter)]
    pub fn states(&self) -> Vec<String> {
        let states = self.inner.states.iter();
        states.map(|state| state.name.clone()).collect()
    }

    /// A group state as a whole configuration: its values, and those of `at` (default: neutral) for all other joints. A
    /// name that several groups define merges their states; `group/name` selects one.
    pub fn state(
        &self,
        name: &str,
        #[wasm_bindgen(unchecked_optional_param_type = "Numbers")] at: Option<Vec<f64>>,
    ) -> Result<Vec<f64>, Exception> {
        let model = self.robot.model();
        let at = at.unwrap_or_else(|| model.neutral());
        let (count, expected) = (at.len(), model.configuration_len());
        if count != expected {
            let message = format!("at has {count} numbers, expected {expected}");
            return Err(Exception::new(&message));
        }
        self.inner.state(name, &at).map_err(raise)
    }

    /// Passive joints that move.
    #[wasm_bindgen(getter, js_name = passiveJoints)]
    pub fn passive_joints(&self) -> Vec<String> {
        let joints = self.joints(&self.inner.passive_joints);
        joints.filter_map(|name| name.as_string()).collect()
    }

    /// End effectors.
    #[wasm_bindgen(getter, js_name = endEffectors)]
    pub fn end_effectors(&self) -> EndEffectors {
        let ends = self.inner.end_effectors.iter().map(|end| {
            object::of([
                ("name", end.name.as_str().into()),
                ("group", end.group.as_str().into()),
                ("parentLink", self.frame(end.parent_link).into()),
            ])
        });
        ends.collect::<js_sys::Array>().unchecked_into()
    }

    /// Disabled collision pairs.
    #[wasm_bindgen(getter, js_name = disabledPairs)]
    pub fn disabled_pairs(&self) -> Pairs {
        let pairs = self.inner.disabled_pairs.iter().map(|pair| {
            let links = pair
                .links
                .iter()
                .map(|link| JsValue::from(self.frame(*link)));
            links.collect::<js_sys::Array>()
        });
        pairs.collect::<js_sys::Array>().unchecked_into()
    }
}

impl Srdf {
    fn joints<'a>(&'a self, joints: &'a [JointId]) -> impl Iterator<Item = JsValue> + 'a {
        let all = self.robot.model().joints();
        joints.iter().map(|id| all[id.index()].name.as_str().into())
    }

    fn frame(&self, frame: FrameId) -> &str {
        &self.robot.model().frames()[frame.index()].name
    }
}
