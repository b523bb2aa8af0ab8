//! Inverse kinematics over clips.

use std::rc::Rc;

use js_sys::Array;
use kinopt::animation::{Armature as Bones, Clip as Motion};
use kinopt::glam::{DVec3, Vec3};
use kinopt::motion::clip_ik::{ClipIk, EditReport as Report, Reach, ground_speed};
use kinopt::skeleton::BoneId;
use kinopt_bindings::clip_ik::reach_curve;
use wasm_bindgen::prelude::*;

use crate::arguments::{self, NamedArguments};
use crate::clip::Clip;
use crate::error::{Exception, raise};
use crate::object;

#[wasm_bindgen(typescript_custom_section)]
const TYPES: &str = r#"
/** A bone that reaches a point, or follows a curve, over a span of a clip. */
export interface Reach {
    bone: string;
    /** Three numbers, or three for each point of a curve. */
    target: Numbers;
    /** Time of each point of a curve, seconds of the clip; default: uniform over the span. */
    times?: Numbers;
    /** First and last time, seconds of the clip; default: the whole clip. */
    span?: readonly [number, number];
    /** Duration of the blend at either end, seconds; default: 0.2, or half of a shorter span. */
    fade?: number;
}

export interface ClipIkOptions {
    reach?: readonly Reach[];
    /** Bones, such as feet, that are locked in place while they hardly move. */
    plant?: readonly string[];
    /** Bone that moves if limbs are too short; default: the first branching bone from the top above all these bones. */
    root?: string;
    /** Upward axis; default: y. */
    up?: Numbers;
    /** Frames that are solved and keyed per second; default: 60. */
    keysPerSecond?: number;
    /** Velocity of a clip in place, in units a second; "feet" computes it from its feet. */
    rootVelocity?: "feet" | Numbers;
    /** Obstacles that feet are in contact with. */
    ground?: World;
}

/** Foot plant: a contact interval of a foot in a clip. */
export interface FootPlant {
    bone: string;
    /** First and last time, seconds of the clip. */
    span: [number, number];
    /** Contact position in the model. */
    place: [number, number, number];
    /** Largest distance from the contact position at any key. */
    slide: number;
    /** Largest distance from the contact position between keys. */
    stray: number;
}

/** Result of a reaching or planted bone. */
export interface ReachResult {
    bone: string;
    /** Largest distance from the target. */
    miss: number;
    /** Time of that distance, seconds of the clip. */
    at: number;
}

/** Errors of an edited clip, in the armature's unit. */
export interface EditReport {
    /** Foot plants, foot by foot. */
    stances: FootPlant[];
    /** Results of the bones, planted feet first. */
    led: ReachResult[];
    /** Largest displacement of the root from the original clip. */
    rootMoved: number;
}
"#;

#[wasm_bindgen]
extern "C" {
    /// Options of inverse kinematics over a clip.
    #[wasm_bindgen(typescript_type = "ClipIkOptions")]
    pub type ClipIkOptions;
}

#[wasm_bindgen]
impl Clip {
    /// Inverse kinematics over the clip: bones reach targets over spans, and feet are locked in place while they hardly
    /// move. Each sample stays as close to the clip as possible. The root moves only if limbs are too short.
    #[wasm_bindgen(js_name = withIk)]
    pub fn with_ik(&self, options: ClipIkOptions) -> Result<EditedClip, Exception> {
        const KNOWN: [&str; 7] = [
            "reach",
            "plant",
            "root",
            "up",
            "keysPerSecond",
            "rootVelocity",
            "ground",
        ];
        let options = NamedArguments::new(options.into(), "option of withIk", &KNOWN)?;
        let (armature, motion) = (self.armature(), self.inner());
        let up = match options.get("up") {
            None => Vec3::Y,
            Some(axis) => vector(&axis, "up")?.as_vec3(),
        };
        let rate = options.number("keysPerSecond")?.unwrap_or(60.0);
        let mut ik = ClipIk::new(armature).with_up(up).with_keys_per_second(rate);
        let bone = |name: &String| armature.bone(name).map_err(raise);
        let feet = options.texts("plant")?.unwrap_or_default();
        let feet = feet.iter().map(bone).collect::<Result<Vec<_>, _>>()?;
        for &foot in &feet {
            ik = ik.with_planted(foot);
        }
        if let Some(reaches) = options.get("reach") {
            let not_a_list = || Exception::new("reach must be a list");
            for item in arguments::list(&reaches).ok_or_else(not_a_list)? {
                ik = ik.with_reach(reach(item, &bone, motion)?);
            }
        }
        if let Some(root) = options.text("root")? {
            ik = ik.with_root(bone(&root)?);
        }
        if let Some(velocity) = options.get("rootVelocity") {
            ik = ik.with_root_velocity(match velocity.as_string().as_deref() {
                Some("feet") => ground_speed(armature, motion, &feet, up, rate).map_err(raise)?,
                Some(word) => {
                    let message =
                        format!("rootVelocity is \"{word}\", expected \"feet\" or three numbers");
                    return Err(Exception::new(&message));
                }
                None => vector(&velocity, "rootVelocity")?.as_vec3(),
            });
        }
        #[cfg(feature = "collision")]
        if let Some(world) = options.get("ground") {
            let (world, up) = (
                crate::world::copied(&world, "ground")?,
                up.as_dvec3().to_array(),
            );
            ik = ik.with_ground(move |at| {
                let top = world.height_at(at, up.into());
                top.unwrap_or(0.0).max(0.0)
            });
        }
        let edited = ik.solve(motion).map_err(raise)?;
        Ok(EditedClip {
            clip: edited.clip,
            armature: Rc::clone(armature),
            report: report(&edited.report, armature),
        })
    }
}

/// Reads the target of a bone.
fn reach(
    options: JsValue,
    bone: &impl Fn(&String) -> Result<BoneId, Exception>,
    clip: &Motion,
) -> Result<Reach, Exception> {
    const KNOWN: [&str; 5] = ["bone", "target", "times", "span", "fade"];
    let options = NamedArguments::new(options, "part of a reach", &KNOWN)?;
    let bone = bone(&options.name("bone")?)?;
    let span = options
        .get("span")
        .map(|span| arguments::vector::<2>(&span, "span"));
    let span = span.transpose()?;
    let target = arguments::numbers(&options.required("target")?, "target")?;
    let count = target.len();
    if count == 0 || count % 3 != 0 {
        let message = format!("target has {count} numbers, expected three for each point");
        return Err(Exception::new(&message));
    }
    let points: Vec<DVec3> = target.chunks_exact(3).map(DVec3::from_slice).collect();
    let mut reach = match points[..] {
        [point] => Reach::to(bone, point).map_err(raise)?,
        _ => {
            let span = span.unwrap_or_else(|| clip.span().map(f64::from));
            let curve = reach_curve(points, options.numbers("times")?, span);
            Reach::along(bone, curve.map_err(raise)?)
        }
    };
    if let Some([from, to]) = span {
        reach = reach.with_span(from..=to);
    }
    if let Some(fade) = options.number("fade")? {
        reach = reach.with_fade(fade);
    }
    Ok(reach)
}

fn vector(value: &JsValue, what: &str) -> Result<DVec3, Exception> {
    arguments::vector::<3>(value, what).map(DVec3::from)
}

/// Result of `withIk`.
#[wasm_bindgen]
pub struct EditedClip {
    clip: Motion,
    armature: Rc<Bones>,
    report: JsValue,
}

#[wasm_bindgen]
impl EditedClip {
    /// New clip.
    #[wasm_bindgen(getter)]
    pub fn clip(&self) -> Clip {
        Clip::new(self.clip.clone(), &self.armature)
    }

    /// Errors of the clip.
    #[wasm_bindgen(getter, unchecked_return_type = "EditReport")]
    pub fn report(&self) -> JsValue {
        self.report.clone()
    }
}

/// Report as an object.
fn report(report: &Report, armature: &Bones) -> JsValue {
    let name = |bone: BoneId| JsValue::from(armature.names()[bone.index()].as_str());
    let list = |numbers: &[f64]| {
        let numbers = numbers.iter().copied().map(JsValue::from);
        numbers.collect::<Array>()
    };
    let stances = report.stances.iter().map(|plant| {
        object::of([
            ("bone", name(plant.bone)),
            ("span", list(&plant.span).into()),
            ("place", list(&plant.place.to_array()).into()),
            ("slide", plant.slide.into()),
            ("stray", plant.stray.into()),
        ])
    });
    let led = report.led.iter().map(|result| {
        object::of([
            ("bone", name(result.bone)),
            ("miss", result.miss.into()),
            ("at", result.at.into()),
        ])
    });
    let fields = object::of([
        ("stances", stances.collect::<Array>().into()),
        ("led", led.collect::<Array>().into()),
        ("rootMoved", report.root_moved.into()),
    ]);
    fields.into()
}
