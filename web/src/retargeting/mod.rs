//! Motion capture retargeted to robots: whole motions, and live frames.

mod follower;
mod movement;

use kinopt::collision::Checker;
use kinopt::model::UnknownName;
use kinopt::motion::retarget::{
    BodyMap, Capture, RetargetError, RetargetOptions, Retargeting, UpAxis,
};
use kinopt_bindings::{Classify, option};
use wasm_bindgen::prelude::*;

use crate::arguments::NamedArguments;
use crate::clip::Clip;
use crate::error::{Exception, raise};
use crate::robot::Robot;

#[wasm_bindgen(typescript_custom_section)]
const TYPES: &str = r#"
export interface FollowerOptions {
    /** Frames per second; default: 30. */
    fps?: number;
    /**
     * Upward axis of the capture, "y" or "z", unless the map has it. The default is the axis from the ankles to the
     * pelvis of an upright subject.
     */
    up?: "y" | "z";
    /** Speed below which a foot is in contact, m/s. */
    contactSpeed?: number;
    /** Height over the ground below which a foot is in contact, metres. */
    contactHeight?: number;
}

export interface ClearFollowerOptions extends FollowerOptions {
    /** Smallest distance of all pairs, metres; default: 0. */
    margin?: number;
}

export interface RetargetingOptions extends FollowerOptions {
    /** Solves all frames as one problem, with smooth motion and foot locks; default: frame by frame. */
    whole?: boolean;
    /** With `whole`: cost of an acceleration of 1 rad/s², as a position error in metres. */
    acceleration?: number;
    /** With `whole`: called with the number of finished frames and of all frames. */
    progress?: (done: number, total: number) => void;
}

export interface ClearRetargetingOptions extends RetargetingOptions {
    /** Smallest distance of all pairs, metres; default: 0. */
    margin?: number;
}
"#;

#[wasm_bindgen]
extern "C" {
    /// Options of retargeting.
    #[wasm_bindgen(typescript_type = "RetargetingOptions")]
    pub type RetargetingOptions;
    /// Options of a follower.
    #[wasm_bindgen(typescript_type = "FollowerOptions")]
    pub type FollowerOptions;
    /// Options of retargeting with collision avoidance.
    #[wasm_bindgen(typescript_type = "ClearRetargetingOptions")]
    pub type ClearRetargetingOptions;
    /// Options of a follower with collision avoidance.
    #[wasm_bindgen(typescript_type = "ClearFollowerOptions")]
    pub type ClearFollowerOptions;
}

/// Common options of both.
const FOLLOWER_OPTIONS: [&str; 4] = ["fps", "up", "contactSpeed", "contactHeight"];

/// Capture of a clip, and its map to a robot.
struct Mapped {
    capture: Capture,
    map: BodyMap,
    options: RetargetOptions,
    notes: Vec<String>,
    /// Collision checker.
    clear: Option<Checker>,
}

impl Mapped {
    /// Reads a map in JSON; missing parts are guessed from names.
    fn new(
        robot: &Robot,
        clip: &Clip,
        map: Option<String>,
        options: &NamedArguments,
    ) -> Result<Self, Exception> {
        let given_up_axis = match options.text("up")?.as_deref() {
            None => None,
            Some("y") => Some(UpAxis::Y),
            Some("z") => Some(UpAxis::Z),
            Some(other) => return Err(raise(UnknownName::new("up axis", other, ["y", "z"]))),
        };
        let fps = options.number("fps")?.unwrap_or(30.0);
        let capture = Capture::of_clip(clip.armature(), clip.inner(), fps).map_err(raise)?;
        let model = robot.inner.model();
        let guess = match map {
            Some(map) => {
                let map = BodyMap::from_json(&map, robot.inner.name());
                let map_error = |error: RetargetError| {
                    Exception::of(error.kind(), &format!("the map: {error}"))
                };
                map.map_err(map_error)?.completed(&capture, model)
            }
            None => BodyMap::guess(&capture, model),
        };
        let guess = guess.map_err(raise)?;
        let up = given_up_axis.or(capture.up_axis()).unwrap_or(UpAxis::Y);
        let defaults = RetargetOptions::default().with_up(up);
        let retarget_options = option::apply(options, &option::retarget::options(), defaults)?;
        Ok(Self {
            capture,
            map: guess.map,
            options: retarget_options,
            notes: guess.notes,
            clear: None,
        })
    }

    /// Fits the capture to the robot: lengths of limbs, the ground, contacts, and collision avoidance if enabled.
    fn fitted<'r>(&self, robot: &'r Robot) -> Result<Retargeting<'r>, Exception> {
        let options = self.options.clone();
        let fitted = Retargeting::new(&robot.inner, &self.map, &self.capture, options);
        let fitted = fitted.map_err(raise)?;
        Ok(match &self.clear {
            Some(checker) => fitted.keep_clear(checker),
            None => fitted,
        })
    }
}
