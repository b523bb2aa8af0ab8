//! Keyframes of the angles of a skeleton.

use std::sync::Arc;

use kinopt::animation::curve::TensionContinuityBias;
use kinopt::animation::{EulerClip as Clip, EulerInterpolation, EulerKey, EulerTrack};
use kinopt::model::UnknownName;
use kinopt_bindings::names::{PLAYBACKS, named};
use numpy::{PyArray1, PyArray2, PyArrayDyn, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arrays::{self, Queries};
use crate::error::{OrRaise, invalid};
use crate::pickling;
use crate::skeleton::Skeleton;

/// Number of samples between two checks for signals.
const SAMPLES_AT_A_TIME: usize = 1024;

/// Keyframes of a skeleton's bones, as in rig files: three angles for each key.
///
/// A clip of `tracks`, {bone: (times, angles)}: times of shape (K,), seconds, ascending; angles of shape (K, 3),
/// radians: first twist, bend, second twist.
///
/// `interpolation` between keys is one value for all bones or {bone: value}. A value is "linear", "catmull-rom" or an
/// array of shape (K, 3) of tension, continuity and bias at each key (a Kochanek-Bartels spline).
///
/// Raises `UnknownNameError` for an unknown bone, `InvalidValueError` for keys that do not ascend or are not finite.
#[pyclass(frozen, module = "kinopt.animation")]
pub(crate) struct EulerClip {
    pub(crate) inner: Arc<Clip>,
    pub(crate) skeleton: Arc<kinopt::Skeleton>,
}

impl EulerClip {
    fn name(&self, bone: kinopt::skeleton::BoneId) -> &str {
        let bone = self.skeleton.bones().get(bone.index());
        bone.map_or("", |bone| &bone.name)
    }
}

type Arrays<'py> = (Bound<'py, PyArray1<f64>>, Bound<'py, PyArray2<f64>>);

#[pymethods]
impl EulerClip {
    #[new]
    #[pyo3(signature = (skeleton, tracks, interpolation = None))]
    fn new(
        skeleton: &Bound<'_, Skeleton>,
        tracks: &Bound<'_, PyDict>,
        interpolation: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let skeleton = Arc::clone(&skeleton.get().inner);
        let mut read_tracks = Vec::new();
        for (bone, keys) in tracks {
            let name = arrays::name(&bone, "a bone of tracks")?;
            let bone = skeleton.bone(&name).or_raise()?;
            let (times, angles): (Bound<'_, PyAny>, Bound<'_, PyAny>) = keys
                .extract()
                .map_err(|_| invalid(format!("the keys of {name:?} must be (times, angles)")))?;
            let times = arrays::vector(&times, &format!("times of {name:?}"))?;
            let angles = arrays::rows(&angles, &format!("angles of {name:?}"), 3)?;
            if angles.shape()[0] != times.len() {
                return Err(invalid(format!(
                    "{} angles for {} times of {name:?}",
                    angles.shape()[0],
                    times.len()
                )));
            }
            let keys = times.iter().zip(angles.chunks_exact(3));
            let keys = keys.map(|(&time, angles)| EulerKey {
                time,
                angles: [angles[0], angles[1], angles[2]],
            });
            let keys = keys.collect();
            read_tracks.push(EulerTrack { bone, keys });
        }
        let mut clip = Clip::new(read_tracks).or_raise()?;
        if let Some(chosen) = interpolation {
            let mut interpolations = Vec::new();
            for track in clip.tracks() {
                let name = &skeleton.bones()[track.bone.index()].name;
                let of_bone = match chosen.cast::<PyDict>() {
                    Ok(by_bone) => by_bone.get_item(name)?,
                    Err(_) => Some(chosen.clone()),
                };
                let bone_interpolation = of_bone
                    .map(|value| read_interpolation(&value))
                    .transpose()?;
                interpolations.push((track.bone, bone_interpolation.unwrap_or_default()));
            }
            let choose = |track: &EulerTrack| {
                let entry = interpolations.iter().find(|(bone, _)| *bone == track.bone);
                entry
                    .map(|(_, interpolation)| interpolation.clone())
                    .unwrap_or_default()
            };
            clip = clip.interpolated(choose).or_raise()?;
        }
        let inner = Arc::new(clip);
        Ok(Self { inner, skeleton })
    }

    /// Skeleton of the clip.
    #[getter]
    fn skeleton(&self) -> Skeleton {
        Arc::clone(&self.skeleton).into()
    }

    /// Names of the bones with keys, in the skeleton's order.
    #[getter]
    fn bones(&self) -> Vec<&str> {
        let tracks = self.inner.tracks().iter();
        tracks.map(|track| self.name(track.bone)).collect()
    }

    /// Names of the bones with ignored tracks, which had no keys.
    #[getter]
    fn keyless(&self) -> Vec<&str> {
        let bones = self.inner.keyless().iter();
        bones.map(|bone| self.name(*bone)).collect()
    }

    /// True if no bone has keys.
    #[getter]
    fn is_empty(&self) -> bool {
        self.inner.is_empty()
    }

    /// First and last key time in seconds; None without keys.
    #[getter]
    fn time_span(&self) -> Option<(f64, f64)> {
        self.inner.time_span().map(|[start, end]| (start, end))
    }

    /// Keys of a bone: times, shape (K,), seconds, and angles, shape (K, 3), radians; empty without keys.
    ///
    /// Raises `UnknownNameError`.
    fn keys<'py>(&self, py: Python<'py>, bone: &str) -> PyResult<Arrays<'py>> {
        let keys = self.inner.keys(self.skeleton.bone(bone).or_raise()?);
        let times = PyArray1::from_iter(py, keys.iter().map(|key| key.time));
        let angles: Vec<f64> = keys.iter().flat_map(|key| key.angles).collect();
        Ok((times, arrays::list(py, &angles).reshape([keys.len(), 3])?))
    }

    /// Interpolation between a bone's keys: "linear", "catmull-rom", or tension, continuity and bias of each key, shape
    /// (K, 3), for a Kochanek-Bartels spline.
    ///
    /// Raises `UnknownNameError`.
    fn interpolation<'py>(&self, py: Python<'py>, bone: &str) -> PyResult<Bound<'py, PyAny>> {
        let between = self
            .inner
            .interpolation(self.skeleton.bone(bone).or_raise()?);
        match between {
            EulerInterpolation::KochanekBartels(controls) => {
                let numbers: Vec<f64> = controls
                    .iter()
                    .flat_map(|c| [c.tension, c.continuity, c.bias])
                    .map(f64::from)
                    .collect();
                let array = arrays::list(py, &numbers).reshape([controls.len(), 3])?;
                Ok(array.into_any())
            }
            named => Ok(named.name().into_pyobject(py)?.into_any()),
        }
    }

    /// Stacked angles at one time, shape (3 * bones,), or at N, shape (N, 3 * bones), radians; bones without keys are
    /// at 0.
    ///
    /// `times` is seconds, a number or an array of shape (N,); `playback` is "hold", "loop" or "ping_pong"; `out`
    /// receives the result. Limits are not applied.
    ///
    /// Raises `UnknownNameError` for another `playback`, `InvalidValueError` for times that are not finite and for an
    /// `out` of another shape or type.
    #[pyo3(signature = (times, playback = "hold", *, out = None))]
    fn sample<'py>(
        &self,
        py: Python<'py>,
        times: &Bound<'py, PyAny>,
        playback: &str,
        out: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        let playback = named("playback", playback, &PLAYBACKS).or_raise()?;
        let times = Queries::numbers(times, "times")?;
        let shape = [self.skeleton.angles()];
        times.compute((py, out), &shape, SAMPLES_AT_A_TIME, |time, buffer| {
            self.inner.sample(time[0], playback, buffer).or_raise()
        })
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let text = serde_json::to_string(&*self.inner).or_raise()?;
        pickling::by_rebuild::<Self>(py, (self.skeleton(), text))
    }

    #[staticmethod]
    fn _rebuild(skeleton: &Bound<'_, Skeleton>, text: &str) -> PyResult<Self> {
        let inner: Clip = serde_json::from_str(text).or_raise()?;
        let skeleton = Arc::clone(&skeleton.get().inner);
        let last = inner.tracks().last().map(|track| track.bone.index());
        if last.is_some_and(|bone| bone >= skeleton.bones().len()) {
            return Err(invalid(
                "the clip moves bones that the skeleton does not have",
            ));
        }
        let inner = Arc::new(inner);
        Ok(Self { inner, skeleton })
    }

    fn __repr__(&self) -> String {
        match self.inner.time_span() {
            Some([start, end]) => format!(
                "EulerClip({} bones, {start} s to {end} s)",
                self.inner.tracks().len()
            ),
            None => "EulerClip(no keys)".into(),
        }
    }
}

/// Reads the interpolation between the keys of one bone.
fn read_interpolation(value: &Bound<'_, PyAny>) -> PyResult<EulerInterpolation> {
    let named = [EulerInterpolation::Linear, EulerInterpolation::CatmullRom];
    if let Ok(name) = value.extract::<String>() {
        let names: Vec<&str> = named.iter().map(EulerInterpolation::name).collect();
        let entry = named.iter().find(|known| known.name() == name);
        let unknown = || UnknownName::new("interpolation", &name, names.iter().copied());
        return entry.cloned().ok_or_else(unknown).or_raise();
    }
    let rows = arrays::rows(value, "interpolation", 3)?;
    let controls = rows.chunks_exact(3).map(|row| TensionContinuityBias {
        tension: row[0] as f32,
        continuity: row[1] as f32,
        bias: row[2] as f32,
    });
    Ok(EulerInterpolation::KochanekBartels(controls.collect()))
}
