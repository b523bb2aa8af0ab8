//! Online retargeting to a robot.

use kinopt::motion::retarget::{LiveFollower, UpAxis};
use kinopt::spatial::Vector3;
use wasm_bindgen::prelude::*;

use super::{ClearFollowerOptions, FOLLOWER_OPTIONS, FollowerOptions, Mapped};
use crate::arguments::NamedArguments;
use crate::clip::Clip;
use crate::error::{Exception, raise};
use crate::robot::Robot;
use crate::world::{CollisionModel, World};

/// Retargets a live motion capture: from one frame's joint positions to its configuration, in a bounded number of
/// steps.
///
/// The clip is a motion of the subject, of any length. Limbs and the ground are measured in it, and its bones are the
/// joints of later frames. Position limits hold in every frame, speed limits between successive frames. Contacts are
/// detected from past frames only, so a foot lock starts some frames later than in `retarget`.
#[wasm_bindgen]
pub struct RetargetFollower {
    inner: LiveFollower,
    joints: Vec<String>,
    map: String,
    stride: f64,
    up: UpAxis,
    notes: Vec<String>,
}

#[wasm_bindgen]
impl RetargetFollower {
    /// Creates an online retargeter for a robot with a free base, by a map in JSON or one guessed from names.
    #[wasm_bindgen(constructor)]
    pub fn new(
        robot: &Robot,
        measured: &Clip,
        map: Option<String>,
        options: Option<FollowerOptions>,
    ) -> Result<Self, Exception> {
        let options = options.map_or(JsValue::UNDEFINED, JsValue::from);
        let options = NamedArguments::new(options, "option of a follower", &FOLLOWER_OPTIONS)?;
        Self::of(robot, Mapped::new(robot, measured, map, &options)?)
    }

    /// Creates one that avoids collisions with a world and the robot itself, as `retargetClear`.
    pub fn clear(
        robot: &Robot,
        measured: &Clip,
        shapes: &CollisionModel,
        world: &World,
        map: Option<String>,
        options: Option<ClearFollowerOptions>,
    ) -> Result<Self, Exception> {
        let options = options.map_or(JsValue::UNDEFINED, JsValue::from);
        let known: Vec<&str> = FOLLOWER_OPTIONS.into_iter().chain(["margin"]).collect();
        let options = NamedArguments::new(options, "option of a follower", &known)?;
        let mut mapped = Mapped::new(robot, measured, map, &options)?;
        mapped.clear = Some(shapes.checker(world, options.number("margin")?)?);
        Self::of(robot, mapped)
    }

    /// Processes the next frame: positions of the joints, three numbers each, as from `Armature.places`. Returns the
    /// configuration. A frame with a position that is not finite keeps it.
    pub fn step(
        &mut self,
        #[wasm_bindgen(unchecked_param_type = "Numbers")] places: &[f64],
    ) -> Result<Vec<f64>, Exception> {
        let (count, expected) = (places.len(), 3 * self.inner.joints());
        if count != expected {
            return Err(Exception::new(&format!(
                "places has {count} numbers, expected {expected}"
            )));
        }
        let places = places.chunks_exact(3);
        let places: Vec<_> = places.map(|at| Vector3::new(at[0], at[1], at[2])).collect();
        Ok(self.inner.step(&places).map_err(raise)?.to_vec())
    }

    /// Current configuration.
    #[wasm_bindgen(getter)]
    pub fn q(&self) -> Vec<f64> {
        self.inner.q().to_vec()
    }

    /// Names of the joints of a frame, in order.
    #[wasm_bindgen(getter)]
    pub fn joints(&self) -> Vec<String> {
        self.joints.clone()
    }

    /// Frame rate, in frames a second; the speed limits use it.
    #[wasm_bindgen(getter)]
    pub fn fps(&self) -> f64 {
        self.inner.frame_rate()
    }

    /// Ratio of the step length to that of the subject, metres for each unit of the capture.
    #[wasm_bindgen(getter)]
    pub fn stride(&self) -> f64 {
        self.stride
    }

    /// Upward axis of the frames; for y, the upright position is (x, -z, y).
    #[wasm_bindgen(getter, unchecked_return_type = "\"y\" | \"z\"")]
    pub fn up(&self) -> String {
        self.up.name().to_owned()
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
}

impl RetargetFollower {
    fn of(robot: &Robot, mapped: Mapped) -> Result<Self, Exception> {
        let retargeting = mapped.fitted(robot)?;
        Ok(Self {
            inner: retargeting.live().map_err(raise)?,
            stride: retargeting.stride(),
            joints: mapped.capture.names().to_vec(),
            map: mapped.map.to_json(),
            up: mapped.map.up.unwrap_or(mapped.options.up),
            notes: mapped.notes,
        })
    }
}
