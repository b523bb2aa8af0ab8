//! A person's movement on a robot, live.

use kinopt::motion::retarget::{LiveFollower, UpAxis};
use kinopt::spatial::Vector3;
use wasm_bindgen::prelude::*;

use super::{ClearFollowerOptions, FollowerOptions, Mapped, OF_BOTH};
use crate::clip::Clip;
use crate::given::Given;
use crate::raise;
use crate::robot::Robot;
use crate::world::{CollisionModel, World};

/// Follows a person live: one frame's places in, that frame's configuration out, in a bounded number of steps.
///
/// The clip is some movement of the same person, however short: limbs and the ground are measured in it, and its bones are
/// the joints of the frames to come. Limits of position hold in every frame, those of speed from each to the next. What
/// stands is told by the frames before alone, so a foot is held some frames later than where the whole movement is known.
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
    /// A follower on a robot whose base is free, by a map in JSON or by one that is guessed from names.
    #[wasm_bindgen(constructor)]
    pub fn new(
        robot: &Robot,
        measured: &Clip,
        map: Option<String>,
        options: Option<FollowerOptions>,
    ) -> Result<Self, JsError> {
        let options = options.map_or(JsValue::UNDEFINED, JsValue::from);
        let options = Given::new(options, "option of a follower", &OF_BOTH)?;
        Self::of(robot, Mapped::new(robot, measured, map, &options)?)
    }

    /// One that touches nothing of a world, nor itself, as `retargetClear` has it.
    pub fn clear(
        robot: &Robot,
        measured: &Clip,
        shapes: &CollisionModel,
        world: &World,
        map: Option<String>,
        options: Option<ClearFollowerOptions>,
    ) -> Result<Self, JsError> {
        let options = options.map_or(JsValue::UNDEFINED, JsValue::from);
        let known: Vec<&str> = OF_BOTH.into_iter().chain(["margin"]).collect();
        let options = Given::new(options, "option of a follower", &known)?;
        let mut mapped = Mapped::new(robot, measured, map, &options)?;
        mapped.clear = Some(shapes.checker(world, options.number("margin")?)?);
        Self::of(robot, mapped)
    }

    /// Goes on to the next frame: where the joints are, three numbers each, as `Armature.places` gives them. Returns the
    /// configuration. Where a place is not finite, the body stays.
    pub fn step(
        &mut self,
        #[wasm_bindgen(unchecked_param_type = "Numbers")] places: &[f64],
    ) -> Result<Vec<f64>, JsError> {
        let (count, asked) = (places.len(), 3 * self.inner.joints());
        if count != asked {
            return Err(JsError::new(&format!(
                "places has {count} numbers, expected {asked}"
            )));
        }
        let places = places.chunks_exact(3);
        let places: Vec<_> = places.map(|at| Vector3::new(at[0], at[1], at[2])).collect();
        Ok(self.inner.step(&places).map_err(raise)?.to_vec())
    }

    /// Where the body is.
    #[wasm_bindgen(getter)]
    pub fn q(&self) -> Vec<f64> {
        self.inner.q().to_vec()
    }

    /// The joints of a frame, in order.
    #[wasm_bindgen(getter)]
    pub fn joints(&self) -> Vec<String> {
        self.joints.clone()
    }

    /// Frames a second, at which limits of speed hold.
    #[wasm_bindgen(getter)]
    pub fn fps(&self) -> f64 {
        self.inner.frame_rate()
    }

    /// How many times as large as the person's its steps are, metres a unit of the capture.
    #[wasm_bindgen(getter)]
    pub fn stride(&self) -> f64 {
        self.stride
    }

    /// The axis of the frames that points upward; upright is (x, -z, y) where that is y.
    #[wasm_bindgen(getter, unchecked_return_type = "\"y\" | \"z\"")]
    pub fn up(&self) -> String {
        self.up.name().to_owned()
    }

    /// The map that it goes by, as JSON.
    #[wasm_bindgen(getter)]
    pub fn map(&self) -> String {
        self.map.clone()
    }

    /// What of a guessed map is to be looked at.
    #[wasm_bindgen(getter)]
    pub fn notes(&self) -> Vec<String> {
        self.notes.clone()
    }
}

impl RetargetFollower {
    fn of(robot: &Robot, mapped: Mapped) -> Result<Self, JsError> {
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
