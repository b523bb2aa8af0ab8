//! Retargeting of a whole motion to a robot.

use js_sys::Function;
use kinopt::motion::retarget;
use wasm_bindgen::prelude::*;

use super::{ClearRetargetingOptions, FOLLOWER_OPTIONS, Mapped, RetargetingOptions};
use crate::arguments::NamedArguments;
use crate::clip::Clip;
use crate::raise;
use crate::robot::Robot;
use crate::view;
use crate::world::{CollisionModel, World};

/// Retargeted motion of a robot.
#[wasm_bindgen]
pub struct Retargeted {
    inner: retarget::Retargeted,
    stride: f64,
    map: String,
    notes: Vec<String>,
}

/// Retargets a clip to a robot with a free base, by a map in JSON from joints of the clip to frames. Without a map it
/// is guessed from names; see the library's page on motions. Position and speed limits hold exactly.
#[wasm_bindgen]
pub fn retarget(
    robot: &Robot,
    clip: &Clip,
    map: Option<String>,
    options: Option<RetargetingOptions>,
) -> Result<Retargeted, JsValue> {
    let options = options.map_or(JsValue::UNDEFINED, JsValue::from);
    solve(robot, clip, None, map, options)
}

/// Retargets a clip with collision avoidance in every frame, with a world and the robot itself, by the exact distances
/// of its shapes. The world is in metres at the scale of the robot: obstacles of the subject scale by `stride`. Feet
/// are in contact with obstacles as with the ground; `touching` lists frames in collision in spite of that.
#[wasm_bindgen(js_name = retargetClear)]
pub fn retarget_clear(
    robot: &Robot,
    clip: &Clip,
    shapes: &CollisionModel,
    world: &World,
    map: Option<String>,
    options: Option<ClearRetargetingOptions>,
) -> Result<Retargeted, JsValue> {
    let options = options.map_or(JsValue::UNDEFINED, JsValue::from);
    solve(robot, clip, Some((shapes, world)), map, options)
}

fn solve(
    robot: &Robot,
    clip: &Clip,
    obstacles: Option<(&CollisionModel, &World)>,
    map: Option<String>,
    options: JsValue,
) -> Result<Retargeted, JsValue> {
    let own_options = ["whole", "acceleration", "progress"];
    let clear_options = obstacles.is_some().then_some("margin");
    let known: Vec<&str> = FOLLOWER_OPTIONS
        .into_iter()
        .chain(own_options)
        .chain(clear_options)
        .collect();
    let options = NamedArguments::new(options, "option of a retargeting", &known)?;
    let mut mapped = Mapped::new(robot, clip, map, &options)?;
    if let Some((shapes, world)) = obstacles {
        mapped.clear = Some(shapes.checker(world, options.number("margin")?)?);
    }
    let progress = match options.get("progress") {
        None => None,
        Some(progress) => {
            let not_a_function = |_| JsError::new("progress must be a function of (done, total)");
            Some(progress.dyn_into::<Function>().map_err(not_a_function)?)
        }
    };
    let retargeting = mapped.fitted(robot)?;
    let (total, stride) = (retargeting.frames(), retargeting.stride());
    let mut raised = None;
    let result = match options.switch("whole")?.unwrap_or(false) {
        false => retargeting.per_frame(),
        true => retargeting.whole_with_progress(&mut |done| {
            let Some(progress) = &progress else { return };
            let report = progress.call2(&JsValue::UNDEFINED, &done.into(), &total.into());
            if let Err(error) = report {
                raised.get_or_insert(error);
            }
        }),
    };
    match raised {
        Some(error) => Err(error),
        None => Ok(Retargeted {
            inner: result.map_err(raise)?,
            stride,
            map: mapped.map.to_json(),
            notes: mapped.notes,
        }),
    }
}

#[wasm_bindgen]
impl Retargeted {
    /// Configurations, one after another, as a view: valid until the next call into the module.
    #[wasm_bindgen(getter, unchecked_return_type = "Float64Array")]
    pub fn q(&self) -> js_sys::Float64Array {
        view::doubles(&self.inner.q)
    }

    /// Number of frames.
    #[wasm_bindgen(getter)]
    pub fn frames(&self) -> usize {
        self.inner.frames()
    }

    /// Frame rate, in frames a second.
    #[wasm_bindgen(getter)]
    pub fn fps(&self) -> f64 {
        self.inner.frame_rate
    }

    /// Ratio of the step length to that of the subject, metres for each unit of the capture.
    #[wasm_bindgen(getter)]
    pub fn stride(&self) -> f64 {
        self.stride
    }

    /// Frames in collision in spite of collision avoidance.
    #[wasm_bindgen(getter)]
    pub fn touching(&self) -> Vec<u32> {
        let touching = self.inner.touching.iter();
        touching.map(|contact| contact.frame as u32).collect()
    }

    /// The map in use, as JSON.
    #[wasm_bindgen(getter)]
    pub fn map(&self) -> String {
        self.map.clone()
    }

    /// Notes on a guessed map, for review.
    #[wasm_bindgen(getter)]
    pub fn notes(&self) -> Vec<String> {
        self.notes.clone()
    }

    /// Frames of the robot that are in contact at some time.
    #[wasm_bindgen(getter)]
    pub fn contact_frames(&self) -> Vec<String> {
        self.inner.contact_frames.clone()
    }

    /// Contact point of each, in its coordinates, three numbers, metres.
    #[wasm_bindgen(getter, js_name = contactPoints)]
    pub fn contact_points(&self) -> Vec<f64> {
        let points = self.inner.contact_points.iter();
        points.flat_map(|at| at.to_array()).collect()
    }

    /// 1 for each of them in contact, frame after frame.
    #[wasm_bindgen(getter)]
    pub fn contacts(&self) -> Vec<u8> {
        let contacts = self.inner.contacts.iter();
        contacts
            .map(|&is_in_contact| is_in_contact.into())
            .collect()
    }

    /// Distance of the driven points from their targets, mean over all frames, metres.
    #[wasm_bindgen(getter, js_name = meanError)]
    pub fn mean_error(&self) -> f64 {
        self.inner.mean_error
    }

    /// Largest drift of a contact from its initial position, metres.
    #[wasm_bindgen(getter)]
    pub fn slip(&self) -> f64 {
        self.inner.slip
    }
}
