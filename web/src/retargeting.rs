//! Captured movements on robots.

use kinopt::motion::retarget::{self, BodyMap, Capture, RetargetOptions, UpAxis};
use wasm_bindgen::prelude::*;

use crate::clip::Clip;
use crate::given::Given;
use crate::raise;
use crate::robot::Robot;
use crate::view;

#[wasm_bindgen(typescript_custom_section)]
const TYPES: &str = r#"
export interface RetargetingOptions {
    /** Frames a second; 30 unless told. */
    fps?: number;
    /** Which way is up in the capture, unless the map says it: "y" (the default) or "z". */
    up?: "y" | "z";
    /** All frames as one problem, smooth and with feet that stand; frame after frame otherwise. */
    whole?: boolean;
}
"#;

#[wasm_bindgen]
extern "C" {
    /// Options of a retargeting.
    #[wasm_bindgen(typescript_type = "RetargetingOptions")]
    pub type RetargetingOptions;
}

/// A movement on a robot.
#[wasm_bindgen]
pub struct Retargeted {
    inner: retarget::Retargeted,
    notes: Vec<String>,
}

/// Brings a clip onto a robot whose base is free, by a map in JSON that says which joint of the clip drives which frame (see
/// the library's page on motions), or by one that is guessed from names. Limits of position and speed hold to the bit.
#[wasm_bindgen]
pub fn retarget(
    robot: &Robot,
    clip: &Clip,
    map: Option<String>,
    options: Option<RetargetingOptions>,
) -> Result<Retargeted, JsError> {
    let options = options.map_or(JsValue::UNDEFINED, JsValue::from);
    let options = Given::new(options, "option of a retargeting", &["fps", "up", "whole"])?;
    let up = match options.text("up")?.as_deref() {
        None | Some("y") => UpAxis::Y,
        Some("z") => UpAxis::Z,
        Some(other) => {
            let unknown = kinopt::model::UnknownName::new("up axis", other, ["y", "z"]);
            return Err(raise(unknown));
        }
    };
    let fps = options.number("fps")?.unwrap_or(30.0);
    let capture = Capture::of_clip(clip.armature(), clip.inner(), fps).map_err(raise)?;
    let (map, notes) = match map {
        Some(map) => {
            let map = BodyMap::from_json(&map, robot.inner.name());
            (map.map_err(raise)?, Vec::new())
        }
        None => {
            let guess = BodyMap::guess(&capture, robot.inner.model()).map_err(raise)?;
            (guess.map, guess.notes)
        }
    };
    let how = RetargetOptions {
        up,
        ..RetargetOptions::default()
    };
    let retargeting = retarget::Retargeting::new(&robot.inner, &map, &capture, how);
    let retargeting = retargeting.map_err(raise)?;
    let found = match options.switch("whole")?.unwrap_or(false) {
        true => retargeting.whole(),
        false => retargeting.per_frame(),
    };
    let inner = found.map_err(raise)?;
    Ok(Retargeted { inner, notes })
}

#[wasm_bindgen]
impl Retargeted {
    /// The configurations, one after another, where they lie: valid until the next call into the module.
    #[wasm_bindgen(getter, unchecked_return_type = "Float64Array")]
    pub fn q(&self) -> js_sys::Float64Array {
        view::doubles(&self.inner.q)
    }

    /// How many frames there are.
    #[wasm_bindgen(getter)]
    pub fn frames(&self) -> usize {
        self.inner.frames()
    }

    /// How many a second.
    #[wasm_bindgen(getter)]
    pub fn fps(&self) -> f64 {
        self.inner.frame_rate
    }

    /// What of a guessed map is to be looked at.
    #[wasm_bindgen(getter)]
    pub fn notes(&self) -> Vec<String> {
        self.notes.clone()
    }

    /// The frames of the robot that stand at times.
    #[wasm_bindgen(getter)]
    pub fn standing(&self) -> Vec<String> {
        self.inner.standing.clone()
    }

    /// 1 where each of them stands, frame after frame.
    #[wasm_bindgen(getter)]
    pub fn contacts(&self) -> Vec<u8> {
        let contacts = self.inner.contacts.iter();
        contacts.map(|&stands| stands.into()).collect()
    }

    /// How far the driven points are from where they should be, in the mean over all frames, metres.
    #[wasm_bindgen(getter, js_name = meanError)]
    pub fn mean_error(&self) -> f64 {
        self.inner.mean_error
    }

    /// How far a point that stands is from where it came to stand, at most, metres.
    #[wasm_bindgen(getter)]
    pub fn slip(&self) -> f64 {
        self.inner.slip
    }
}
