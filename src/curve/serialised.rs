//! Serde form of a curve: keys and interpolation, checked when read.

use serde::Deserialize;

use super::keyed::Between;
use super::{CurveValue, KeyError, KeyedCurve};

#[derive(Deserialize)]
#[serde(bound = "V: Deserialize<'de>, V::Real: Deserialize<'de>")]
pub(super) struct Keys<V: CurveValue> {
    times: Vec<V::Real>,
    values: Vec<V>,
    between: Between<V>,
}

impl<V: CurveValue> TryFrom<Keys<V>> for KeyedCurve<V> {
    type Error = KeyError;

    fn try_from(keys: Keys<V>) -> Result<Self, KeyError> {
        Self::new(keys.times, keys.values, keys.between)
    }
}
