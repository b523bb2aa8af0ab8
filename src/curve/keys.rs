//! Validation and repair of keys.

use super::Real;

/// Error of the keys of a curve or channel. Keys are counted from 0 in the given order.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum KeyError {
    /// There are no keys.
    #[error("no keys; at least one is needed")]
    Empty,
    /// The number of values, tangents or controls is not the number of keys.
    #[error("{given} {what} for {keys} keys; there must be one for each key")]
    Count {
        /// Kind of the items counted.
        what: &'static str,
        /// Number of items given.
        given: usize,
        /// Number of key times.
        keys: usize,
    },
    /// A time is NaN or infinite.
    #[error("key {key}: the time {time} is not finite")]
    NonFiniteTime {
        /// Index of the key.
        key: usize,
        /// Time, seconds.
        time: f64,
    },
    /// A value or tangent is NaN or infinite.
    #[error("key {key}: the {what} is not finite")]
    NonFiniteValue {
        /// Index of the key.
        key: usize,
        /// `value` or `tangent`.
        what: &'static str,
    },
    /// A key time is not after the previous one.
    #[error("key {key}: the time {time} s is not after the key before it, at {previous} s")]
    NotIncreasing {
        /// Index of the key.
        key: usize,
        /// Time, seconds.
        time: f64,
        /// Time of the previous key, seconds.
        previous: f64,
    },
    /// Two neighbouring points coincide, so their distance gives no knot interval.
    #[error(
        "point {point} coincides with the previous point; centripetal and chordal knots need distinct points"
    )]
    SamePlace {
        /// Index of the point.
        point: usize,
    },
    /// A Bézier handle that makes the curve run backwards in time.
    #[error(
        "key {key}: the {side} handle is {time} s from its key; it must be within the {interval} s to the key on that side"
    )]
    HandleTime {
        /// Index of the key.
        key: usize,
        /// `arriving` or `leaving`.
        side: &'static str,
        /// Time from the key to the handle, seconds.
        time: f64,
        /// Time from the key to the adjacent key on that side, seconds.
        interval: f64,
    },
    /// Quaternion of zero length.
    #[error("key {key}: the quaternion is zero; a rotation needs a non-zero quaternion")]
    ZeroRotation {
        /// Index of the key.
        key: usize,
    },
}

/// Checks that there is at least one time and that times are finite and strictly increase.
pub(crate) fn check_times<R: Real>(times: &[R]) -> Result<(), KeyError> {
    let mut previous: Option<R> = None;
    for (key, &time) in times.iter().enumerate() {
        if !time.is_finite() {
            let time = time.as_f64();
            return Err(KeyError::NonFiniteTime { key, time });
        }
        if let Some(before) = previous.filter(|&before| time <= before) {
            let (time, previous) = (time.as_f64(), before.as_f64());
            return Err(KeyError::NotIncreasing {
                key,
                time,
                previous,
            });
        }
        previous = Some(time);
    }
    previous.map(|_| ()).ok_or(KeyError::Empty)
}

/// Checks that there is one of `what` for each key.
pub(crate) fn check_count(what: &'static str, given: usize, keys: usize) -> Result<(), KeyError> {
    if given == keys {
        return Ok(());
    }
    Err(KeyError::Count { what, given, keys })
}

/// Report of [`repair_keys`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct KeyRepair {
    /// Keys dropped because the time or the value was not finite.
    pub not_finite: usize,
    /// True if keys had to be sorted.
    pub sorted: bool,
    /// Keys dropped because a later one in the list has an equal time.
    pub duplicates: usize,
}

impl KeyRepair {
    /// True if no repair was needed.
    #[must_use]
    pub fn is_clean(&self) -> bool {
        *self == Self::default()
    }
}

/// Repairs keys in place. Drops keys with a time that is not finite or a value that is not `usable`, and sorts by time.
/// Of several keys at one time it keeps the last in the list.
pub fn repair_keys<R: Real, V>(
    keys: &mut Vec<(R, V)>,
    mut usable: impl FnMut(&V) -> bool,
) -> KeyRepair {
    let mut repair = KeyRepair::default();
    let given = keys.len();
    keys.retain(|(time, value)| time.is_finite() && usable(value));
    repair.not_finite = given - keys.len();
    let order = |a: &(R, V), b: &(R, V)| a.0.partial_cmp(&b.0).unwrap_or(std::cmp::Ordering::Equal);
    repair.sorted = !keys.is_sorted_by(|a, b| order(a, b).is_le());
    // A stable sort keeps keys at one time in list order.
    keys.sort_by(order);
    let finite = keys.len();
    keys.reverse();
    keys.dedup_by(|a, b| a.0 == b.0);
    keys.reverse();
    repair.duplicates = finite - keys.len();
    repair
}
