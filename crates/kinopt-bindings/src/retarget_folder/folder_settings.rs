//! Settings of a folder of motions, as a text that identifies them.

use std::collections::BTreeMap;
use std::fmt::Write;

use serde_json::{Value, json};

use kinopt::motion::retarget::{BodyMap, FootShapes, RetargetOptions, UpAxis};
use kinopt::robot::Robot;

/// Settings of a folder of motions: target, map and options.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct FolderSettings<'a> {
    /// Target of the motions.
    pub target: &'a Robot,
    /// Options of retargeting.
    pub options: RetargetOptions,
    /// Map, if one is given.
    pub map: Option<&'a BodyMap>,
    /// Name of the skeleton of the motions, if one is given.
    pub skeleton: Option<&'a str>,
    /// Joints of arrays, if given in addition to the map.
    pub joints: Option<&'a [String]>,
    /// Capture frames per second, if given in addition to the map.
    pub frame_rate: Option<f64>,
    /// Upward axis, if given in addition to the map.
    pub up: Option<UpAxis>,
    /// Name of a clip of a scene.
    pub clip: Option<&'a str>,
    /// True if each motion is solved as a whole trajectory.
    pub whole: bool,
    /// Required distance between links, metres.
    pub keep_clear: Option<f64>,
    /// Obstacles as JSON of `World::to_json`.
    pub world: Option<String>,
    /// Further settings, as text of the caller.
    pub more: Vec<String>,
}

impl<'a> FolderSettings<'a> {
    /// Creates settings for online retargeting to a target with guessed maps.
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

    /// Sets the map.
    #[must_use]
    pub fn with_map(mut self, map: impl Into<Option<&'a BodyMap>>) -> Self {
        self.map = map.into();
        self
    }

    /// Sets the skeleton.
    #[must_use]
    pub fn with_skeleton(mut self, name: impl Into<Option<&'a str>>) -> Self {
        self.skeleton = name.into();
        self
    }

    /// Sets the joints of arrays.
    #[must_use]
    pub fn with_joints(mut self, joints: impl Into<Option<&'a [String]>>) -> Self {
        self.joints = joints.into();
        self
    }

    /// Sets the rate in capture frames per second.
    #[must_use]
    pub fn with_frame_rate(mut self, rate: impl Into<Option<f64>>) -> Self {
        self.frame_rate = rate.into();
        self
    }

    /// Sets the upward axis.
    #[must_use]
    pub fn with_up(mut self, up: impl Into<Option<UpAxis>>) -> Self {
        self.up = up.into();
        self
    }

    /// Sets the clip of a scene.
    #[must_use]
    pub fn with_clip(mut self, clip: impl Into<Option<&'a str>>) -> Self {
        self.clip = clip.into();
        self
    }

    /// Sets whether each motion is solved as a whole trajectory.
    #[must_use]
    pub fn with_whole(mut self, whole: bool) -> Self {
        self.whole = whole;
        self
    }

    /// Sets the required distance between links, metres.
    #[must_use]
    pub fn with_keep_clear(mut self, metres: impl Into<Option<f64>>) -> Self {
        self.keep_clear = metres.into();
        self
    }

    /// Sets the obstacles, as JSON of `World::to_json`.
    #[must_use]
    pub fn with_world(mut self, json: impl Into<Option<String>>) -> Self {
        self.world = json.into();
        self
    }

    /// Returns the text of the settings, equal for equal settings.
    pub(super) fn text(&self) -> String {
        let settings = Value::from_iter(self.fields());
        format!("{settings:#}\n")
    }

    /// Returns the names of the settings that differ from those in a text.
    pub(super) fn differs(&self, text: &[u8]) -> Vec<String> {
        let before: Option<BTreeMap<String, Value>> = serde_json::from_slice(text).ok();
        let Some(before) = before else {
            return Vec::new();
        };
        let settings = BTreeMap::from_iter(self.fields());
        let differing = settings
            .iter()
            .filter(|(key, value)| before.get(*key) != Some(value));
        differing.map(|(key, _)| key.clone()).collect()
    }

    fn fields(&self) -> Vec<(String, Value)> {
        let RetargetOptions {
            contacts, windows, ..
        } = &self.options;
        let map = self.map.map(|map| {
            let mut map: BodyMap = map.clone();
            (map.joints, map.frame_rate, map.up) = (Vec::new(), None, None);
            map
        });
        // Separate values override those of the map.
        let rate = self.frame_rate.or(self.map.and_then(|map| map.frame_rate));
        let up = self.up.or(self.map.and_then(|map| map.up));
        let map_joints = || self.map.map(|map| map.joints.as_slice());
        let joints = self
            .joints
            .or_else(map_joints)
            .filter(|names| !names.is_empty());
        let all = [
            ("kinopt", json!(env!("CARGO_PKG_VERSION"))),
            ("target", json!(self.target_digest())),
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
            ("terrain", json!(self.options.terrain)),
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

    /// Returns a digest of all properties of the target that affect the result.
    fn target_digest(&self) -> String {
        let (model, map) = (self.target.model(), self.target.map());
        let mut digest = Digest(FNV_OFFSET_BASIS);
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
            // Writing to the digest cannot fail.
            let _ = write!(digest, "{part:?}");
        }
        format!("{:016x}", digest.0)
    }
}

fn as_value(map: &BodyMap) -> Value {
    serde_json::from_str(&map.to_json()).unwrap_or_default()
}

/// Converts infinities to null, because JSON cannot represent them.
fn finite(number: f64) -> Option<f64> {
    Some(number).filter(|number| number.is_finite())
}

/// Returns a digest of a text.
fn digest(text: &str) -> String {
    let mut digest = Digest(FNV_OFFSET_BASIS);
    // Writing to the digest cannot fail.
    let _ = digest.write_str(text);
    format!("{:016x}", digest.0)
}

/// Offset basis of FNV-1a.
const FNV_OFFSET_BASIS: u64 = 0xCBF2_9CE4_8422_2325;

/// FNV-1a hash of the text written to it.
struct Digest(u64);

impl Write for Digest {
    fn write_str(&mut self, text: &str) -> std::fmt::Result {
        for byte in text.bytes() {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x100_0000_01B3);
        }
        Ok(())
    }
}
