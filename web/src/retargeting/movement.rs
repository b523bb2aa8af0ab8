//! Retargeting of a whole motion to a robot.

use js_sys::{Float64Array, Function, Uint8Array, Uint32Array};
use kinopt::motion::{self, retarget::RetargetReport, score::Spread};
use wasm_bindgen::prelude::*;

use super::{ClearRetargetingOptions, FOLLOWER_OPTIONS, Mapped, RetargetingOptions};
use crate::arguments::NamedArguments;
use crate::clip::Clip;
use crate::error::{Exception, raise};
use crate::robot::Robot;
use crate::world::{CollisionModel, World};
use crate::{object, view};

#[wasm_bindgen(typescript_custom_section)]
const TYPES: &str = r#"
/** Mean, 95th percentile and maximum over samples. */
export interface Spread {
    mean: number;
    p95: number;
    max: number;
}

/** Errors, contacts and collisions of a retargeted motion. */
export interface RetargetReport {
    /** Frame rate, in frames a second. */
    fps: number;
    /** Ratio of the step length to that of the subject, metres for each unit of the capture. */
    stride: number;
    /** Angle between each limb of the subject and of the robot, degrees, by the name of the limb. */
    limbs: Record<string, Spread>;
    /** Position error of hands and feet, relative to the length of the limb. */
    ends: Record<string, Spread>;
    /** Horizontal speed of the feet in contact, m/s; null without known feet. */
    slidingSpeed: Spread | null;
    /** Largest drift of a contact from its initial position, metres. */
    slip: number;
    /** Frames in collision in spite of collision avoidance. */
    touching: Uint32Array;
    /** Frames of the robot that are in contact at some time. */
    contactFrames: string[];
    /** Contact point of each, in its coordinates, three numbers, metres. */
    contactPoints: Float64Array;
    /** 1 for each of them in contact, frame after frame. */
    contacts: Uint8Array;
    /** The map in use, as JSON. */
    map: string;
    /** Notes on a guessed map, for review. */
    notes: string[];
}
"#;

/// Configurations over time, with a report.
#[wasm_bindgen]
pub struct Trajectory {
    inner: motion::Trajectory<()>,
    report: JsValue,
}

/// Retargets a clip to a robot with a free base, by a map in JSON from joints of the clip to frames. Without a map it
/// is guessed from names; see the library's page on motions. Position and speed limits hold exactly.
#[wasm_bindgen]
pub fn retarget(
    robot: &Robot,
    clip: &Clip,
    map: Option<String>,
    options: Option<RetargetingOptions>,
) -> Result<Trajectory, JsValue> {
    let options = options.map_or(JsValue::UNDEFINED, JsValue::from);
    solve(robot, clip, None, map, options)
}

/// Retargets a clip with collision avoidance in every frame, with a world and the robot itself, by the exact distances
/// of its shapes. The world is in metres at the scale of the robot: obstacles of the subject scale by `stride`. Feet
/// are in contact with obstacles as with the ground; `touching` of the report lists frames in collision in spite of that.
#[wasm_bindgen(js_name = retargetClear)]
pub fn retarget_clear(
    robot: &Robot,
    clip: &Clip,
    shapes: &CollisionModel,
    world: &World,
    map: Option<String>,
    options: Option<ClearRetargetingOptions>,
) -> Result<Trajectory, JsValue> {
    let options = options.map_or(JsValue::UNDEFINED, JsValue::from);
    solve(robot, clip, Some((shapes, world)), map, options)
}

fn solve(
    robot: &Robot,
    clip: &Clip,
    obstacles: Option<(&CollisionModel, &World)>,
    map: Option<String>,
    options: JsValue,
) -> Result<Trajectory, JsValue> {
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
            let not_a_function = |_| Exception::new("progress must be a function of (done, total)");
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
        None => {
            let (inner, errors) = result.map_err(raise)?.split_report();
            let report = report(&errors, stride, &mapped.map.to_json(), mapped.notes);
            Ok(Trajectory { inner, report })
        }
    }
}

#[wasm_bindgen]
impl Trajectory {
    /// Configurations, one after another, as a view: valid until the next call into the module.
    #[wasm_bindgen(getter, unchecked_return_type = "Float64Array")]
    pub fn q(&self) -> Float64Array {
        view::doubles(&self.inner.q)
    }

    /// Time of each configuration, seconds, starting at 0.
    #[wasm_bindgen(getter)]
    pub fn times(&self) -> Vec<f64> {
        self.inner.times.clone()
    }

    /// Errors, contacts and collisions.
    #[wasm_bindgen(getter, unchecked_return_type = "RetargetReport")]
    pub fn report(&self) -> JsValue {
        self.report.clone()
    }
}

/// Report as an object.
fn report(report: &RetargetReport, stride: f64, map: &str, notes: Vec<String>) -> JsValue {
    let touching = report.touching.iter();
    let touching: Vec<u32> = touching.map(|contact| contact.frame as u32).collect();
    let points = report.contact_points.iter();
    let points: Vec<f64> = points.flat_map(|at| at.to_array()).collect();
    let contacts = report.contacts.iter();
    let contacts: Vec<u8> = contacts.map(|&in_contact| in_contact.into()).collect();
    let sliding = report.score.feet.as_ref().map(|feet| feet.sliding_speed);
    let fields = object::of([
        ("fps", report.frame_rate.into()),
        ("stride", stride.into()),
        (
            "limbs",
            spreads(
                report
                    .score
                    .limbs
                    .iter()
                    .map(|limb| (&*limb.limb, limb.angle)),
            ),
        ),
        (
            "ends",
            spreads(report.score.ends.iter().map(|end| (&*end.end, end.error))),
        ),
        ("slidingSpeed", sliding.map_or(JsValue::NULL, spread)),
        ("slip", report.slip.into()),
        ("touching", Uint32Array::from(&*touching).into()),
        ("contactFrames", report.contact_frames.clone().into()),
        ("contactPoints", Float64Array::from(&*points).into()),
        ("contacts", Uint8Array::from(&*contacts).into()),
        ("map", map.into()),
        ("notes", notes.into()),
    ]);
    fields.into()
}

/// Spread as an object.
fn spread(spread: Spread) -> JsValue {
    let fields = [
        ("mean", spread.mean),
        ("p95", spread.p95),
        ("max", spread.max),
    ];
    object::of(fields.map(|(name, value)| (name, value.into()))).into()
}

/// Spreads by name as an object.
fn spreads<'a>(named: impl Iterator<Item = (&'a str, Spread)>) -> JsValue {
    let object = object::of([]);
    for (name, values) in named {
        object::add(&object, [(name, spread(values))]);
    }
    object.into()
}
