//! A curve as serde writes it: its keys, and what runs between them. One that is read is checked.

use serde::{Deserialize, Serialize};

use super::keyed::Between;
use super::{CurveValue, KeyError, KeyedCurve};

#[derive(Serialize, Deserialize)]
#[serde(bound(
    serialize = "V: Serialize, V::Real: Serialize",
    deserialize = "V: Deserialize<'de>, V::Real: Deserialize<'de>"
))]
pub(super) struct Keys<V: CurveValue> {
    times: Vec<V::Real>,
    values: Vec<V>,
    between: Between<V>,
}

impl<V: CurveValue> From<KeyedCurve<V>> for Keys<V> {
    fn from(curve: KeyedCurve<V>) -> Self {
        let (times, values, between) = curve.into_parts();
        Self {
            times,
            values,
            between,
        }
    }
}

impl<V: CurveValue> TryFrom<Keys<V>> for KeyedCurve<V> {
    type Error = KeyError;

    fn try_from(keys: Keys<V>) -> Result<Self, KeyError> {
        Self::new(keys.times, keys.values, keys.between)
    }
}
