//! Key times: what is wrong with them, and how they are put right where that is asked for.

use super::Real;

/// What is wrong with the keys of a curve or channel. Keys are counted from 0 in the order given.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum KeyError {
    /// There are no keys.
    #[error("there are no keys")]
    Empty,
    /// Values, tangents or controls are not one for each key.
    #[error("{given} {what} for {keys} keys")]
    Count {
        /// What there are too many or too few of.
        what: &'static str,
        /// How many were given.
        given: usize,
        /// How many key times there are.
        keys: usize,
    },
    /// A time is NaN or infinite.
    #[error("key {key}: the time {time} is not finite")]
    NonFiniteTime {
        /// Which key.
        key: usize,
        /// In seconds.
        time: f64,
    },
    /// A value or tangent is NaN or infinite.
    #[error("key {key}: the {what} is not finite")]
    NonFiniteValue {
        /// Which key.
        key: usize,
        /// Value or tangent.
        what: &'static str,
    },
    /// A key is not later than the one before.
    #[error("key {key}: the time {time} s is not after the key before it, at {previous} s")]
    NotIncreasing {
        /// Which key.
        key: usize,
        /// Its time in seconds.
        time: f64,
        /// The time of the key before it.
        previous: f64,
    },
    /// A point is where the one before it is, so that the distance says nothing about time.
    #[error(
        "point {point} is where the one before it is; knots by distance need points apart, uniform knots do not"
    )]
    SamePlace {
        /// Which point, from 0.
        point: usize,
    },
    /// A Bézier handle that would let the curve run backwards in time.
    #[error(
        "key {key}: the {side} handle is {time} s from its key; it must be within the {room} s to the key on that side"
    )]
    HandleTime {
        /// Which key.
        key: usize,
        /// Arriving or leaving.
        side: &'static str,
        /// From the key to the handle, in seconds.
        time: f64,
        /// From the key to the next one on that side, in seconds.
        room: f64,
    },
    /// A quaternion without direction.
    #[error("key {key}: the quaternion is zero and stands for no rotation")]
    ZeroRotation {
        /// Which key.
        key: usize,
    },
}

/// Checks that times are finite and strictly increase, and that there is one.
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

/// What [`repair_keys`] did.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct KeyRepair {
    /// Keys dropped because the time or the value was not finite.
    pub not_finite: usize,
    /// Whether keys had to be sorted.
    pub sorted: bool,
    /// Keys dropped because a later one in the list has the same time.
    pub duplicates: usize,
}

impl KeyRepair {
    /// Whether nothing had to be done.
    #[must_use]
    pub fn is_clean(&self) -> bool {
        *self == Self::default()
    }
}

/// Puts keys of doubtful origin right and says what it took: drops those with a time that is not
/// finite or a value that is not `usable`, sorts the rest by time, and of keys at one time keeps
/// the last in the list.
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
    // Stable, so that keys at one time stay in the order of the list.
    keys.sort_by(order);
    let finite = keys.len();
    keys.reverse();
    keys.dedup_by(|a, b| a.0 == b.0);
    keys.reverse();
    repair.duplicates = finite - keys.len();
    repair
}
