//! JSON structure of a rig file, before its numbers are checked.

use serde::de::{Deserializer, SeqAccess, Visitor};
use serde::{Deserialize, Serialize};

#[derive(Debug, Deserialize)]
pub(super) struct RigFile {
    #[serde(default, deserialize_with = "present")]
    pub(super) model: Option<PartFile>,
    #[serde(default, deserialize_with = "present")]
    pub(super) weights: Option<PartFile>,
    pub(super) bones: Vec<BoneEntry>,
    #[serde(default)]
    pub(super) fk_animation: Vec<TrackEntry>,
    #[serde(default, deserialize_with = "present")]
    pub(super) ik_constraints: Option<BoneIndices>,
}

#[derive(Debug, Deserialize, Serialize)]
pub(super) struct PartFile {
    pub(super) file: String,
}

#[derive(Debug, Deserialize, Serialize)]
pub(super) struct BoneEntry {
    #[serde(
        default,
        deserialize_with = "present",
        skip_serializing_if = "Option::is_none"
    )]
    pub(super) name: Option<String>,
    pub(super) parent_id: i64,
    pub(super) weight_id: i64,
    pub(super) length: f64,
    /// The length is checked later, for a clearer message than the parser's.
    #[serde(default, deserialize_with = "present")]
    pub(super) xzx_min: Option<Vec<f64>>,
    #[serde(default, deserialize_with = "present")]
    pub(super) xzx_max: Option<Vec<f64>>,
    #[serde(rename = "rest_T")]
    pub(super) rest: Vec<Vec<f64>>,
}

#[derive(Debug, Deserialize, Serialize)]
pub(super) struct TrackEntry {
    pub(super) bone_id: i64,
    #[serde(
        default,
        deserialize_with = "present",
        skip_serializing_if = "Option::is_none"
    )]
    pub(super) interpolation: Option<String>,
    pub(super) keys: Vec<KeyEntry>,
}

#[derive(Debug, Deserialize, Serialize)]
pub(super) struct KeyEntry {
    pub(super) t: f64,
    pub(super) xzx: Vec<f64>,
    #[serde(
        default,
        deserialize_with = "present",
        skip_serializing_if = "Option::is_none"
    )]
    pub(super) tcb: Option<Vec<f32>>,
}

/// One bone index or an array of them.
#[derive(Debug)]
pub(super) enum BoneIndices {
    One(i64),
    Many(Vec<i64>),
}

/// Deserialises an optional key that may be absent but not `null`.
fn present<'de, D: Deserializer<'de>, T: Deserialize<'de>>(
    value: D,
) -> Result<Option<T>, D::Error> {
    T::deserialize(value).map(Some)
}

impl<'de> Deserialize<'de> for BoneIndices {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct OneOrMany;

        impl<'de> Visitor<'de> for OneOrMany {
            type Value = BoneIndices;

            fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str("a bone's number or an array of them")
            }

            fn visit_i64<E>(self, bone: i64) -> Result<BoneIndices, E> {
                Ok(BoneIndices::One(bone))
            }

            fn visit_u64<E: serde::de::Error>(self, bone: u64) -> Result<BoneIndices, E> {
                let bone = i64::try_from(bone).map_err(|_| E::custom("is no bone's number"))?;
                Ok(BoneIndices::One(bone))
            }

            fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<BoneIndices, A::Error> {
                let mut bones = Vec::new();
                while let Some(bone) = seq.next_element()? {
                    bones.push(bone);
                }
                Ok(BoneIndices::Many(bones))
            }
        }
        deserializer.deserialize_any(OneOrMany)
    }
}
