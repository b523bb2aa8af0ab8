//! Inverse kinematics over clips.

use std::ops::RangeInclusive;
use std::sync::{Arc, Mutex, PoisonError};

use kinopt::animation::{Armature as Bones, Clip as Motion};
use kinopt::glam::{DVec3, Vec3};
use kinopt::motion::clip_ik::{ClipIk, EditedClip as Edited, Reach, ground_speed};
use kinopt::skeleton::BoneId;
use kinopt::spatial::Vector3;
use kinopt_bindings::clip_ik::reach_curve;
use pyo3::prelude::*;

use super::clip::Clip;
use crate::arrays;
use crate::error::{OrRaise, invalid};
use crate::skeleton::Skeleton;
use crate::world::World;

/// Foot plant: a contact interval of a foot in a clip.
#[pyclass(frozen, get_all, module = "kinopt.animation")]
#[derive(Clone)]
pub(crate) struct FootPlant {
    /// Name of the bone.
    bone: String,
    /// First and last time, seconds of the clip.
    span: (f64, f64),
    /// Position of the bone during contact, in the model.
    place: (f64, f64, f64),
    /// Largest distance from `place` at any key of the new clip.
    slide: f64,
    /// Largest distance from `place` between keys.
    stray: f64,
}

#[pymethods]
impl FootPlant {
    fn __repr__(&self) -> String {
        let (from, to) = self.span;
        format!("FootPlant({:?}, {from:.3} s to {to:.3} s)", self.bone)
    }
}

/// Result of a reaching or planted bone.
#[pyclass(frozen, get_all, module = "kinopt.animation")]
#[derive(Clone)]
pub(crate) struct ReachResult {
    /// Name of the bone.
    bone: String,
    /// Largest distance of the bone from its target at any key of the new clip.
    miss: f64,
    /// Time of the largest distance, seconds of the clip.
    at: f64,
}

#[pymethods]
impl ReachResult {
    fn __repr__(&self) -> String {
        format!(
            "ReachResult({:?}, misses by {:.2e} at {:.3} s)",
            self.bone, self.miss, self.at
        )
    }
}

/// Errors of an edited clip. Lengths are in the armature's unit.
#[pyclass(frozen, get_all, module = "kinopt.animation")]
pub(crate) struct EditReport {
    /// Foot plants, foot by foot; empty if no foot is in contact.
    stances: Vec<FootPlant>,
    /// Errors of the bones with targets, planted feet first.
    led: Vec<ReachResult>,
    /// Largest displacement of the root from the original clip.
    root_moved: f64,
}

/// Result of `Clip.with_ik`.
#[pyclass(frozen, get_all, module = "kinopt.animation")]
pub(crate) struct EditedClip {
    /// New clip, with the name of the original.
    clip: Py<Clip>,
    /// Errors of the clip.
    report: Py<EditReport>,
}

#[pymethods]
impl EditReport {
    fn __repr__(&self) -> String {
        let stances = self.stances.iter();
        let slides = stances.map(|stance| stance.slide.max(stance.stray));
        format!(
            "EditReport({} foot plants, largest slide {:.2e}, root moved {:.2e})",
            self.stances.len(),
            slides.fold(0.0, f64::max),
            self.root_moved
        )
    }
}

#[pymethods]
impl EditedClip {
    fn __repr__(&self) -> String {
        format!("EditedClip({})", self.report.get().__repr__())
    }
}

/// Options of inverse kinematics over a clip.
pub(super) struct ClipIkRequest<'py> {
    pub(super) reach: Vec<Bound<'py, PyAny>>,
    pub(super) plant: Vec<String>,
    pub(super) root: Option<String>,
    pub(super) up: [f32; 3],
    pub(super) keys_per_second: f64,
    pub(super) ground: Option<Bound<'py, PyAny>>,
    pub(super) root_velocity: Option<Bound<'py, PyAny>>,
    pub(super) skeleton: Option<Bound<'py, PyAny>>,
}

/// Exception raised by a ground function of Python.
type Raised = Arc<Mutex<Option<PyErr>>>;

impl ClipIkRequest<'_> {
    pub(super) fn over(&self, py: Python<'_>, clip: &Clip) -> PyResult<EditedClip> {
        let (armature, motion) = (&clip.armature, &clip.inner);
        let bone = |name: &String| armature.bone(name).or_raise();
        let up = Vec3::from(self.up);
        let skeleton = self
            .skeleton
            .as_ref()
            .map(|skeleton| skeleton_of(skeleton))
            .transpose()?;
        let mut ik = ClipIk::new(armature)
            .with_up(up)
            .with_keys_per_second(self.keys_per_second);
        if let Some(skeleton) = &skeleton {
            ik = ik.with_joints_of(&skeleton.get().inner);
        }
        let feet = self
            .plant
            .iter()
            .map(bone)
            .collect::<PyResult<Vec<BoneId>>>()?;
        for &foot in &feet {
            ik = ik.with_planted(foot);
        }
        for object in &self.reach {
            ik = ik.with_reach(reach(object, armature, motion)?);
        }
        if let Some(root) = &self.root {
            ik = ik.with_root(bone(root)?);
        }
        if let Some(root_velocity) = &self.root_velocity {
            let root_velocity = match root_velocity.extract::<String>().as_deref() {
                Ok("feet") => {
                    let rate = self.keys_per_second;
                    let speed = py.detach(|| ground_speed(armature, motion, &feet, up, rate));
                    speed.or_raise()?
                }
                Ok(word) => {
                    return Err(invalid(format!(
                        "root_velocity is {word:?}, expected \"feet\" or x, y, z per second"
                    )));
                }
                Err(_) => DVec3::from(arrays::array(root_velocity, "root_velocity")?).as_vec3(),
            };
            ik = ik.with_root_velocity(root_velocity);
        }
        let raised = Raised::default();
        if let Some(ground) = &self.ground {
            ik = on_ground(ik, ground, up, &raised)?;
        }
        let edited = py.detach(|| ik.solve(motion));
        let error = raised.lock().unwrap_or_else(PoisonError::into_inner).take();
        error.map_or(Ok(()), Err)?;
        edited_clip(py, edited.or_raise()?, armature)
    }
}

fn on_ground<'a>(
    ik: ClipIk<'a>,
    ground: &Bound<'_, PyAny>,
    up: Vec3,
    raised: &Raised,
) -> PyResult<ClipIk<'a>> {
    if let Ok(world) = ground.cast::<World>() {
        let (world, up) = (world.get().snapshot(), Vector3::from(up));
        return Ok(ik.with_ground(move |at| world.height_at(at, up).unwrap_or(0.0).max(0.0)));
    }
    if !ground.is_callable() {
        return Err(invalid(
            "ground must be a World, or a function of x, y, z that returns a height",
        ));
    }
    let (function, raised) = (ground.clone().unbind(), Arc::clone(raised));
    Ok(ik.with_ground(move |at| {
        Python::attach(|py| {
            let height = function.call1(py, (at.x, at.y, at.z));
            height
                .and_then(|height| height.extract::<f64>(py))
                .unwrap_or_else(|error| {
                    let mut raised = raised.lock().unwrap_or_else(PoisonError::into_inner);
                    raised.get_or_insert(error);
                    0.0
                })
        })
    }))
}

/// Reads a `kinopt.animation.Reach`.
fn reach(object: &Bound<'_, PyAny>, armature: &Bones, clip: &Motion) -> PyResult<Reach> {
    let get = |name: &str| match object.getattr_opt(name)? {
        Some(value) => Ok(value),
        None => Err(invalid(format!(
            "reach contains {}, expected Reach",
            object.repr()?
        ))),
    };
    let name: String = arrays::name(&get("bone")?, "the bone of a reach")?;
    let bone = armature.bone(&name).or_raise()?;
    let span: Option<(f64, f64)> = get("span")?.extract()?;
    let (target, times) = (get("target")?, get("times")?);
    let mut reach = match arrays::axes(&target)? {
        1 => Reach::to(bone, arrays::array(&target, "the target of a reach")?).or_raise()?,
        _ => {
            let rows = arrays::rows(&target, "the target of a reach", 3)?;
            let points: Vec<DVec3> = rows.chunks_exact(3).map(DVec3::from_slice).collect();
            let times = match times.is_none() {
                true => None,
                false => {
                    let times = arrays::vector_of(&times, "the times of a reach", points.len())?;
                    Some(times.to_vec())
                }
            };
            let span = span.map_or_else(|| clip.span().map(f64::from), <[f64; 2]>::from);
            Reach::along(bone, reach_curve(points, times, span).or_raise()?)
        }
    };
    if let Some((from, to)) = span {
        reach = reach.with_span(RangeInclusive::new(from, to));
    }
    if let Some(fade) = get("fade")?.extract::<Option<f64>>()? {
        reach = reach.with_fade(fade);
    }
    Ok(reach)
}

fn skeleton_of<'py>(value: &Bound<'py, PyAny>) -> PyResult<Bound<'py, Skeleton>> {
    match value.cast::<Skeleton>() {
        Ok(skeleton) => Ok(skeleton.clone()),
        Err(_) => Err(invalid("skeleton must be a Skeleton")),
    }
}

fn edited_clip(py: Python<'_>, edited: Edited, armature: &Arc<Bones>) -> PyResult<EditedClip> {
    let name = |bone: BoneId| armature.names()[bone.index()].clone();
    let stances = edited.report.stances.iter().map(|plant| FootPlant {
        bone: name(plant.bone),
        span: plant.span.into(),
        place: plant.place.into(),
        slide: plant.slide,
        stray: plant.stray,
    });
    let led = edited.report.led.iter().map(|result| ReachResult {
        bone: name(result.bone),
        miss: result.miss,
        at: result.at,
    });
    let report = EditReport {
        stances: stances.collect(),
        led: led.collect(),
        root_moved: edited.report.root_moved,
    };
    Ok(EditedClip {
        report: Py::new(py, report)?,
        clip: Py::new(py, Clip::of(armature, Arc::new(edited.clip)))?,
    })
}
