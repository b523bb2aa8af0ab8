//! What is asked of a folder of movements, as a text by which another question is told.

use std::collections::BTreeMap;
use std::fmt::Write;

use serde_json::{Value, json};

use crate::motion::retarget::{BodyMap, FootShapes, RetargetOptions, UpAxis};
use crate::robot::Robot;

/// What tells the answers of one question from another's: the target, the map and how it is done.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct FolderQuestion<'a> {
    /// What the movements are brought onto.
    pub target: &'a Robot,
    /// How they are.
    pub options: RetargetOptions,
    /// The map, where one is given.
    pub map: Option<&'a BodyMap>,
    /// The skeleton that the movements are said to be of.
    pub skeleton: Option<&'a str>,
    /// The joints of arrays, where they are said, as are the next two, beside the map.
    pub joints: Option<&'a [String]>,
    /// Frames a second.
    pub frame_rate: Option<f64>,
    /// The axis that points upward.
    pub up: Option<UpAxis>,
    /// Which of a scene's clips.
    pub clip: Option<&'a str>,
    /// Whether each movement is solved as one.
    pub whole: bool,
    /// By how many metres links are kept apart.
    pub keep_clear: Option<f64>,
    /// The obstacles that are kept clear of, as `World::to_json` has them.
    pub world: Option<String>,
    /// What else is asked, in words of whoever asks.
    pub more: Vec<String>,
}

impl<'a> FolderQuestion<'a> {
    /// Movements onto a target, frame by frame, by maps that are guessed.
    #[must_use]
    pub fn new(target: &'a Robot, options: RetargetOptions) -> Self {
        Self {
            target,
            options,
            map: None,
            skeleton: None,
            joints: None,
            frame_rate: None,
            up: None,
            clip: None,
            whole: false,
            keep_clear: None,
            world: None,
            more: Vec::new(),
        }
    }

    setters! {
        /// By a map that is given.
        pub fn with_map(mut self, map: impl Into<Option<&'a BodyMap>>) { self.map = map.into() }
        /// Of a skeleton.
        pub fn with_skeleton(mut self, name: impl Into<Option<&'a str>>) { self.skeleton = name.into() }
        /// Of arrays of joints.
        pub fn with_joints(mut self, joints: impl Into<Option<&'a [String]>>) { self.joints = joints.into() }
        /// At so many frames a second.
        pub fn with_frame_rate(mut self, rate: impl Into<Option<f64>>) { self.frame_rate = rate.into() }
        /// With an axis that points upward.
        pub fn with_up(mut self, up: impl Into<Option<UpAxis>>) { self.up = up.into() }
        /// Of one of a scene's clips.
        pub fn with_clip(mut self, clip: impl Into<Option<&'a str>>) { self.clip = clip.into() }
        /// Each movement as one, or frame by frame.
        pub fn with_whole(mut self, whole: bool) { self.whole = whole }
        /// With links kept apart by so many metres.
        pub fn with_keep_clear(mut self, metres: impl Into<Option<f64>>) { self.keep_clear = metres.into() }
        /// Clear of obstacles, as `World::to_json` has them.
        pub fn with_world(mut self, json: impl Into<Option<String>>) { self.world = json.into() }
    }

    /// The same text for the same question.
    pub(super) fn text(&self) -> String {
        let asked = Value::from_iter(self.fields());
        format!("{asked:#}\n")
    }

    /// What of it is another in a text.
    pub(super) fn differs(&self, text: &[u8]) -> Vec<String> {
        let before: Option<BTreeMap<String, Value>> = serde_json::from_slice(text).ok();
        let Some(before) = before else {
            return Vec::new();
        };
        let asked = BTreeMap::from_iter(self.fields());
        let differing = asked
            .iter()
            .filter(|(key, own)| before.get(*key) != Some(own));
        differing.map(|(key, _)| key.clone()).collect()
    }

    fn fields(&self) -> Vec<(String, Value)> {
        let RetargetOptions {
            contacts, windows, ..
        } = &self.options;
        let map = self.map.map(|map| BodyMap {
            joints: Vec::new(),
            frame_rate: None,
            up: None,
            ..map.clone()
        });
        // A map says them too; what is said beside it comes first.
        let rate = self.frame_rate.or(self.map.and_then(|map| map.frame_rate));
        let up = self.up.or(self.map.and_then(|map| map.up));
        let of_map = || self.map.map(|map| map.joints.as_slice());
        let joints = self.joints.or_else(of_map).filter(|own| !own.is_empty());
        let all = [
            ("kinopt", json!(env!("CARGO_PKG_VERSION"))),
            ("target", json!(self.of_target())),
            ("map", json!(map.map(|map| as_value(&map)))),
            ("skeleton", json!(self.skeleton)),
            ("joints", json!(joints)),
            ("fps", json!(rate)),
            ("up", json!(up)),
            ("clip", json!(self.clip)),
            ("whole", json!(self.whole)),
            ("contact_speed", json!(contacts.speed)),
            ("contact_height", json!(finite(contacts.height))),
            (
                "contact_times",
                json!([contacts.shortest_s, contacts.lead_s]),
            ),
            ("landing_weight", json!(self.options.landing_weight)),
            ("acceleration", json!(self.options.acceleration)),
            ("tolerance", json!(self.options.tolerance)),
            ("windows", json!([windows.frames, windows.ahead])),
            ("keep_clear", json!(self.keep_clear)),
            ("world", json!(self.world.as_deref().map(digest))),
            ("more", json!(self.more)),
        ];
        let all = all.into_iter().map(|(key, value)| (key.to_owned(), value));
        all.collect()
    }

    /// A digest of all that makes the target move as it does.
    fn of_target(&self) -> String {
        let (model, map) = (self.target.model(), self.target.map());
        let mut digest = Digest(BEGUN);
        let speeds = model.joint_ids().map(|id| self.target.velocity_limit(id));
        let speeds: Vec<Option<f64>> = speeds.collect();
        let shapes = self.options.shapes.clone();
        let shapes = shapes.unwrap_or_else(|| FootShapes::of(self.target));
        let parts: [&dyn std::fmt::Debug; 7] = [
            &model.joints(),
            &model.frames(),
            &model.loops(),
            &model.moving_joints(),
            map,
            &speeds,
            &shapes,
        ];
        for part in parts {
            // It takes whatever is written.
            let _ = write!(digest, "{part:?}");
        }
        format!("{:016x}", digest.0)
    }
}

fn as_value(map: &BodyMap) -> Value {
    serde_json::from_str(&map.to_json()).unwrap_or_default()
}

/// What JSON has no number for is nothing.
fn finite(number: f64) -> Option<f64> {
    Some(number).filter(|number| number.is_finite())
}

/// What tells a long text from another.
fn digest(text: &str) -> String {
    let mut digest = Digest(BEGUN);
    // It takes whatever is written.
    let _ = digest.write_str(text);
    format!("{:016x}", digest.0)
}

/// Where FNV-1a begins.
const BEGUN: u64 = 0xCBF2_9CE4_8422_2325;

/// FNV-1a over what is written to it.
struct Digest(u64);

impl Write for Digest {
    fn write_str(&mut self, text: &str) -> std::fmt::Result {
        for byte in text.bytes() {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x100_0000_01B3);
        }
        Ok(())
    }
}
