//! Bézier handles at keys, as in the f-curves of animation editors.

use super::keys::{KeyError, check_count};
use super::{CubicBezier, CurveValue, Real};

/// Handle of a key: a control point relative to the key. An arriving handle has a time of at most 0, a leaving one of
/// at least 0. Neither exceeds the adjacent key, so the curve has one value at each time. The curve is smooth at a key
/// whose two handles are collinear with it.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(
    feature = "serde",
    serde(bound(
        serialize = "V: serde::Serialize, V::Real: serde::Serialize",
        deserialize = "V: serde::Deserialize<'de>, V::Real: serde::Deserialize<'de>"
    ))
)]
pub struct BezierHandle<V: CurveValue> {
    /// Time from the key, seconds.
    pub time: V::Real,
    /// Value relative to the key.
    pub value: V,
}

/// Checks the `[arriving, leaving]` handles of keys at `times`. The outer handles of the first and the last key are
/// unused and only need to be finite.
pub(super) fn check_handles<V: CurveValue>(
    times: &[V::Real],
    handles: &[[BezierHandle<V>; 2]],
) -> Result<(), KeyError> {
    check_count("pairs of handles", handles.len(), times.len())?;
    let gap = |from: Option<usize>| {
        let from = from?;
        Some(*times.get(from + 1)? - *times.get(from)?)
    };
    for (key, [arriving, leaving]) in handles.iter().enumerate() {
        let zero = V::Real::from(0.0);
        let sides = [
            (
                "arriving",
                arriving,
                zero - arriving.time,
                gap(key.checked_sub(1)),
            ),
            ("leaving", leaving, leaving.time, gap(Some(key))),
        ];
        for (side, handle, away, interval) in sides {
            if !(handle.time.is_finite() && handle.value.all_finite()) {
                let what = "handle";
                return Err(KeyError::NonFiniteValue { key, what });
            }
            if let Some(interval) = interval.filter(|&interval| away < zero || away > interval) {
                let (time, interval) = (handle.time.as_f64(), interval.as_f64());
                return Err(KeyError::HandleTime {
                    key,
                    side,
                    time,
                    interval,
                });
            }
        }
    }
    Ok(())
}

/// Bézier segment between two keys: times as fractions of its duration, and values.
pub(super) struct BezierSegment<V> {
    times: CubicBezier<f64>,
    values: CubicBezier<V>,
}

impl<V: CurveValue> BezierSegment<V> {
    pub(super) fn new(
        length: V::Real,
        [start, end]: [V; 2],
        leaving: &BezierHandle<V>,
        arriving: &BezierHandle<V>,
    ) -> Self {
        let fraction = |handle: &BezierHandle<V>| handle.time.as_f64() / length.as_f64();
        let times = [0.0, fraction(leaving), 1.0 + fraction(arriving), 1.0];
        let values = [start, start + leaving.value, end + arriving.value, end];
        Self {
            times: CubicBezier::new(times),
            values: CubicBezier::new(values),
        }
    }

    /// Value at a fraction of the time.
    pub(super) fn position(&self, fraction: V::Real) -> V {
        let u = self.times.parameter_at(fraction.as_f64());
        self.values.position(V::Real::from_f64(u))
    }

    /// Derivative by the fraction of the time.
    pub(super) fn tangent(&self, fraction: V::Real) -> V {
        let u = self.times.parameter_at(fraction.as_f64());
        self.times.slope_of(&self.values, u)
    }
}
