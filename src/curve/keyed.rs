//! Curves through values at key times, with any spacing.

use super::easing::Easing;
use super::handle::{BezierHandle, BezierSegment, check_handles};
use super::keys::{check_count, check_times};
use super::{CurveValue, Hermite, KeyError, TensionContinuityBias, lerp};

/// Curve through values at key times: step, linear, eased, cubic or Bézier. It is constant before the first and after
/// the last key.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(
    feature = "serde",
    serde(
        bound(
            serialize = "V: serde::Serialize, V::Real: serde::Serialize",
            deserialize = "V: serde::Deserialize<'de>, V::Real: serde::Deserialize<'de>"
        ),
        try_from = "super::serialised::Keys<V>"
    )
)]
pub struct KeyedCurve<V: CurveValue> {
    times: Vec<V::Real>,
    values: Vec<V>,
    between: Between<V>,
}

/// Interpolation between keys.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(
    feature = "serde",
    serde(bound(
        serialize = "V: serde::Serialize, V::Real: serde::Serialize",
        deserialize = "V: serde::Deserialize<'de>, V::Real: serde::Deserialize<'de>"
    ))
)]
pub(crate) enum Between<V: CurveValue> {
    /// Value of the previous key.
    Step,
    /// Linear.
    Linear,
    /// Linear, with an easing for each segment.
    Eased(Vec<Easing>),
    /// Cubic; (arriving, leaving) rates per unit of time at each key.
    Cubic(Vec<[V; 2]>),
    /// Cubic in time and value; (arriving, leaving) handles of each key.
    Bezier(Vec<[BezierHandle<V>; 2]>),
}

impl<V: CurveValue> KeyedCurve<V> {
    pub(super) fn new(
        times: Vec<V::Real>,
        values: Vec<V>,
        between: Between<V>,
    ) -> Result<Self, KeyError> {
        check_times(&times)?;
        check_count("values", values.len(), times.len())?;
        let not_finite = |what| move |key| KeyError::NonFiniteValue { key, what };
        if let Some(key) = values.iter().position(|value| !value.all_finite()) {
            return Err(not_finite("value")(key));
        }
        match &between {
            Between::Cubic(rates) => {
                check_count("tangents", rates.len(), times.len())?;
                let is_invalid = |rates: &[V; 2]| rates.iter().any(|rate| !rate.all_finite());
                if let Some(key) = rates.iter().position(is_invalid) {
                    return Err(not_finite("tangent")(key));
                }
            }
            Between::Eased(easings) => check_count("easings", easings.len(), times.len())?,
            Between::Bezier(handles) => check_handles(&times, handles)?,
            Between::Step | Between::Linear => {}
        }
        Ok(Self {
            times,
            values,
            between,
        })
    }

    /// Curve that holds each key's value until the next key (glTF's `STEP`).
    ///
    /// # Errors
    /// A [`KeyError`]: no keys, differing counts, a number that is not finite, or times that do not strictly increase.
    pub fn step(times: Vec<V::Real>, values: Vec<V>) -> Result<Self, KeyError> {
        Self::new(times, values, Between::Step)
    }

    /// Linear curve between keys (glTF's `LINEAR`).
    ///
    /// # Errors
    /// As [`step`](Self::step).
    pub fn linear(times: Vec<V::Real>, values: Vec<V>) -> Result<Self, KeyError> {
        Self::new(times, values, Between::Linear)
    }

    /// Linear curve with an easing for each segment, stored at the key where the segment starts. The easing of the last
    /// key is unused.
    ///
    /// # Errors
    /// As [`step`](Self::step).
    pub fn eased(
        times: Vec<V::Real>,
        values: Vec<V>,
        easings: Vec<Easing>,
    ) -> Result<Self, KeyError> {
        Self::new(times, values, Between::Eased(easings))
    }

    /// F-curve of animation editors. Each segment is a Bézier curve in the plane of time and value, with the handles
    /// `[arriving, leaving]` of its keys. Its parameter is solved for each time. A vector's components share the times
    /// of the handles.
    ///
    /// ```
    /// use kinopt::animation::curve::{BezierHandle, KeyedCurve};
    ///
    /// // From 0 to 1 in two seconds: a slow start, and a little too far before the end.
    /// let handle = |time, value| BezierHandle { time, value };
    /// let handles = vec![
    ///     [handle(0.0, 0.0), handle(1.0, 0.0)],
    ///     [handle(-0.5, 0.4), handle(0.0, 0.0)],
    /// ];
    /// let curve = KeyedCurve::bezier(vec![0.0, 2.0], vec![0.0, 1.0], handles)?;
    /// assert!(curve.at(0.3) < 0.15 / 2.0);
    /// assert!(curve.at(1.8) > 1.0);
    /// assert_eq!(curve.at(2.0), 1.0);
    /// # Ok::<(), kinopt::animation::curve::KeyError>(())
    /// ```
    ///
    /// # Errors
    /// As [`step`](Self::step), or a handle that points back in time or exceeds the next key.
    pub fn bezier(
        times: Vec<V::Real>,
        values: Vec<V>,
        handles: Vec<[BezierHandle<V>; 2]>,
    ) -> Result<Self, KeyError> {
        Self::new(times, values, Between::Bezier(handles))
    }

    /// Cubic Hermite segments with `[arriving, leaving]` tangents at each key, per unit of time. These are the in- and
    /// out-tangents of glTF's `CUBICSPLINE`.
    ///
    /// # Errors
    /// As [`step`](Self::step).
    pub fn cubic(
        times: Vec<V::Real>,
        values: Vec<V>,
        tangents: Vec<[V; 2]>,
    ) -> Result<Self, KeyError> {
        Self::new(times, values, Between::Cubic(tangents))
    }

    /// Catmull-Rom spline over uneven times. The tangents are (P_{i+1} − P_{i−1}) / (t_{i+1} − t_{i−1}), one-sided at
    /// the ends.
    ///
    /// # Errors
    /// As [`step`](Self::step).
    pub fn catmull_rom(times: Vec<V::Real>, values: Vec<V>) -> Result<Self, KeyError> {
        let controls = vec![TensionContinuityBias::default(); times.len()];
        Self::kochanek_bartels(times, values, &controls)
    }

    /// Kochanek-Bartels spline with a set of controls for each key. At an end, the missing neighbour's rate of change
    /// equals that of the existing one.
    ///
    /// # Errors
    /// As [`step`](Self::step).
    pub fn kochanek_bartels(
        times: Vec<V::Real>,
        values: Vec<V>,
        controls: &[TensionContinuityBias],
    ) -> Result<Self, KeyError> {
        let linear = Self::new(times, values, Between::Linear)?;
        let Self { times, values, .. } = linear;
        check_count("controls", controls.len(), times.len())?;
        let change = |from: Option<usize>, to: usize| {
            let from = from?;
            let (t0, t1) = (*times.get(from)?, *times.get(to)?);
            Some((*values.get(to)? - *values.get(from)?, t1 - t0))
        };
        let rates = controls.iter().zip(&values).enumerate();
        let rates = rates.map(|(key, (control, &value))| {
            let incoming = change(key.checked_sub(1), key);
            let outgoing = change(Some(key), key + 1);
            match (incoming, outgoing) {
                (Some((incoming, t0)), Some((next, t1))) => control.rates(incoming, next, t0 + t1),
                (Some((only, time)), None) | (None, Some((only, time))) => {
                    control.rates(only, only, time + time)
                }
                (None, None) => [value * V::Real::from(0.0); 2],
            }
        });
        let rates = rates.collect();
        Self::new(times, values, Between::Cubic(rates))
    }

    /// Key times, strictly increasing; at least one.
    #[must_use]
    pub fn times(&self) -> &[V::Real] {
        &self.times
    }

    /// Values at the keys.
    #[must_use]
    pub fn values(&self) -> &[V] {
        &self.values
    }

    /// Interpolation between keys.
    #[cfg(feature = "gltf")]
    #[must_use]
    pub(crate) fn between(&self) -> &Between<V> {
        &self.between
    }

    /// True if the curve is linear.
    #[must_use]
    pub(crate) fn is_linear(&self) -> bool {
        matches!(self.between, Between::Linear)
    }

    /// Value at a time; exactly the key's value at a key time. NaN counts as before the first key.
    #[must_use]
    pub fn at(&self, time: V::Real) -> V {
        let (key, u) = self.segment_at(time);
        self.within(key, u)
    }

    /// Value at u in [0, 1] between a key and the next; u counts as 0 after the last key.
    pub(crate) fn within(&self, key: usize, u: V::Real) -> V {
        let start = self.values[key];
        match (&self.between, self.values.get(key + 1)) {
            (Between::Step, Some(&end)) if u >= V::Real::from(1.0) => end,
            (Between::Linear, Some(&end)) => lerp(start, end, u),
            (Between::Eased(easings), Some(&end)) => lerp(start, end, easings[key].at(u)),
            (Between::Cubic(rates), Some(&end)) => self.segment(key, rates, end).position(u),
            (Between::Bezier(handles), Some(&end)) => {
                self.bezier_segment(key, handles, end).position(u)
            }
            _ => start,
        }
    }

    /// Rate of change per unit of time; at a key, that of the following segment. Zero outside the keys and on steps.
    #[must_use]
    pub fn rate(&self, time: V::Real) -> V {
        let (key, u) = self.segment_at(time);
        let start = self.values[key];
        // From the last key on there is no next segment.
        let has_begun = time >= self.times[0];
        let next = self.values.get(key + 1).filter(|_| has_begun);
        let one = V::Real::from(1.0);
        let per_time = |key: usize| one / (self.times[key + 1] - self.times[key]);
        match (&self.between, next) {
            (Between::Linear, Some(&end)) => (end - start) * per_time(key),
            (Between::Cubic(rates), Some(&end)) => {
                self.segment(key, rates, end).tangent(u) * per_time(key)
            }
            (Between::Eased(easings), Some(&end)) => {
                (end - start) * (easings[key].rate(u) * per_time(key))
            }
            (Between::Bezier(handles), Some(&end)) => {
                self.bezier_segment(key, handles, end).tangent(u) * per_time(key)
            }
            _ => start * V::Real::from(0.0),
        }
    }

    /// Segments of a cubic curve with their end times; empty for other curves.
    pub(crate) fn cubics(&self) -> impl Iterator<Item = (Hermite<V>, [V::Real; 2])> {
        let rates = match &self.between {
            Between::Cubic(rates) => rates.as_slice(),
            _ => &[],
        };
        let keys = 0..rates.len().saturating_sub(1);
        keys.map(|key| {
            let times = [self.times[key], self.times[key + 1]];
            (self.segment(key, rates, self.values[key + 1]), times)
        })
    }

    fn segment(&self, key: usize, rates: &[[V; 2]], end: V) -> Hermite<V> {
        let length = self.times[key + 1] - self.times[key];
        Hermite {
            start: self.values[key],
            leaving: rates[key][1] * length,
            end,
            arriving: rates[key + 1][0] * length,
        }
    }

    fn bezier_segment(
        &self,
        key: usize,
        handles: &[[BezierHandle<V>; 2]],
        end: V,
    ) -> BezierSegment<V> {
        let length = self.times[key + 1] - self.times[key];
        let ends = [self.values[key], end];
        BezierSegment::new(length, ends, &handles[key][1], &handles[key + 1][0])
    }

    /// Key at or before a time, and the fraction in [0, 1) towards the next key.
    fn segment_at(&self, time: V::Real) -> (usize, V::Real) {
        let zero = V::Real::from(0.0);
        let after = self.times.partition_point(|&key| key <= time);
        let key = after.saturating_sub(1);
        match (self.times.get(after), after) {
            (Some(&end), 1..) => {
                let start = self.times[key];
                (key, (time - start) / (end - start))
            }
            _ => (key, zero),
        }
    }
}
