//! People's movements on robots and rigs: what `kinopt.retargeting` is made of.

mod figure_target;

use std::sync::{Arc, Mutex, PoisonError};

use kinopt::collision::Checker;
use kinopt::motion::clip::MotionBound;
use kinopt::motion::retarget::{
    self, BodyMap, FootShapes, KnownSkeleton, LiveFollower, MapGuess, RetargetError,
    RetargetOptions, UpAxis,
};
use kinopt::robot::Robot;
use kinopt::solver::Side;
use kinopt::spatial::Vector3;
use numpy::ndarray::Ix3;
use numpy::{PyArray1, PyArray2, PyArray3, PyArrayMethods};
use pyo3::prelude::*;

use self::figure_target::FigureTarget;
use crate::animation::Clip;
use crate::arrays::{self, Numbers};
use crate::error::{OrRaise, invalid};
use crate::has_model::model_of;
use crate::model::Model;
use crate::pickling;

/// People's movements on robots and rigs: the compiled part.
#[pymodule(submodule)]
pub(crate) mod retargeting {
    #[pymodule_export]
    use super::{
        Capture, FigureTarget, Live, capture_retargeted, map_guessed, map_of_skeleton,
        skeleton_joints, skeleton_names,
    };
}

/// Places of named joints in frames a fixed time apart, in any unit of length.
///
/// `positions` of shape (T, J, 3) are of the joints that `joints` names in order, `fps` frames a second; `up` is the axis that
/// points upward, "y" or "z". `bones` are pairs of joints' numbers, where they are known; they are for drawing.
///
/// Raises `InvalidValueError` for another shape, a name twice, and numbers that are not finite, whose frame and joint it names.
#[pyclass(frozen, module = "kinopt.retargeting")]
pub(crate) struct Capture {
    inner: Arc<retarget::Capture>,
    up: UpAxis,
    bones: Option<Vec<(usize, usize)>>,
}

fn up_axis(up: &str) -> PyResult<UpAxis> {
    match up {
        "y" => Ok(UpAxis::Y),
        "z" => Ok(UpAxis::Z),
        other => Err(invalid(format!("up is {other:?}: \"y\" or \"z\""))),
    }
}

fn axis_name(axis: UpAxis) -> &'static str {
    match axis {
        UpAxis::Y => "y",
        UpAxis::Z => "z",
    }
}

#[pymethods]
impl Capture {
    #[new]
    #[pyo3(signature = (positions, joints, fps, up = "z", bones = None))]
    fn new(
        py: Python<'_>,
        positions: &Bound<'_, PyAny>,
        joints: Vec<String>,
        fps: f64,
        up: &str,
        bones: Option<Vec<(usize, usize)>>,
    ) -> PyResult<Self> {
        let up = up_axis(up)?;
        let beyond = |&&(from, to): &&(usize, usize)| from.max(to) >= joints.len();
        if let Some((from, to)) = bones.iter().flatten().find(beyond) {
            return Err(invalid(format!(
                "bones has ({from}, {to}), where there are {} joints",
                joints.len()
            )));
        }
        let numbers: Numbers<'_, Ix3> =
            arrays::numbers(positions, "positions", "(frames, joints, 3)")?;
        let shape = numbers.shape();
        if shape[1..] != [joints.len(), 3] {
            return Err(invalid(format!(
                "positions has shape {}, expected (frames, {}, 3)",
                arrays::shape_text(shape),
                joints.len()
            )));
        }
        let numbers = &*numbers;
        let capture = py.detach(|| retarget::Capture::new(joints, numbers, fps));
        Ok(Self {
            inner: Arc::new(capture.or_raise()?),
            up,
            bones,
        })
    }

    /// What a clip's bones do, `fps` frames a second from its beginning to its end.
    ///
    /// Raises `InvalidValueError` for a rate that is not positive.
    #[staticmethod]
    #[pyo3(signature = (clip, fps, up = "y"))]
    fn of_clip(py: Python<'_>, clip: &Bound<'_, Clip>, fps: f64, up: &str) -> PyResult<Self> {
        let up = up_axis(up)?;
        let clip = clip.get();
        let (bones, motion) = (&clip.armature, &clip.inner);
        let capture = py.detach(|| retarget::Capture::of_clip(bones, motion, fps));
        let ids = bones.bone_ids();
        let pairs = ids.filter_map(|bone| Some((bones.parent(bone)?.index(), bone.index())));
        Ok(Self {
            inner: Arc::new(capture.or_raise()?),
            up,
            bones: Some(pairs.collect()),
        })
    }

    /// Names of the joints.
    #[getter]
    fn joints(&self) -> Vec<String> {
        self.inner.names().to_vec()
    }

    /// Frames a second.
    #[getter]
    fn fps(&self) -> f64 {
        self.inner.frame_rate()
    }

    /// The axis that points upward.
    #[getter]
    fn up(&self) -> &'static str {
        axis_name(self.up)
    }

    /// Pairs of joints' numbers that bones join; None where that is not known.
    #[getter]
    fn bones(&self) -> Option<Vec<(usize, usize)>> {
        self.bones.clone()
    }

    /// Where the joints are, shape (T, J, 3).
    #[getter]
    fn positions<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray3<f64>>> {
        let frames = (0..self.inner.frames()).filter_map(|frame| self.inner.frame(frame));
        let numbers = frames.flatten().flat_map(|at| at.to_array());
        let numbers = PyArray1::from_iter(py, numbers);
        numbers.reshape([self.inner.frames(), self.inner.names().len(), 3])
    }

    fn __len__(&self) -> usize {
        self.inner.frames()
    }

    fn __repr__(&self) -> String {
        format!(
            "Capture({} frames of {} joints, {} a second)",
            self.inner.frames(),
            self.inner.names().len(),
            self.inner.frame_rate()
        )
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        let own = slf.get();
        let positions = own.positions(slf.py())?;
        pickling::by_class::<Self>(
            slf.py(),
            (positions, own.joints(), own.fps(), own.up(), own.bones()),
        )
    }
}

/// What a movement is brought onto, as a robot: figures are put on a free base.
fn target_of(target: &Bound<'_, PyAny>) -> PyResult<Arc<Robot>> {
    if let Ok(robot) = target.cast::<crate::robot::Robot>() {
        return Ok(Arc::clone(&robot.get().inner));
    }
    if let Ok(figure) = target.cast::<FigureTarget>() {
        return Ok(Arc::new(figure.get().inner.robot().clone()));
    }
    if let Some(figure) = FigureTarget::of(target, None)? {
        return Ok(Arc::new(figure.inner.robot().clone()));
    }
    let model = model_of(target)?;
    let robot = Robot::new(kinopt::Model::clone(&model), Vec::new()).or_raise()?;
    Ok(Arc::new(robot))
}

/// How it is brought there.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
struct Options {
    contact_speed: Option<f64>,
    contact_height: Option<f64>,
    acceleration: Option<f64>,
    keep_clear: Option<f64>,
}

impl Options {
    fn read(&self, up: UpAxis) -> RetargetOptions {
        let mut options = RetargetOptions {
            up,
            ..RetargetOptions::default()
        };
        let contacts = &mut options.contacts;
        contacts.speed = self.contact_speed.unwrap_or(contacts.speed);
        contacts.height = self.contact_height.unwrap_or(contacts.height);
        options.acceleration = self.acceleration.unwrap_or(options.acceleration);
        options
    }
}

/// What keeps a robot's links apart by so many metres, where they are to be.
fn checker_of(target: &Bound<'_, PyAny>, options: &Options) -> PyResult<Option<Checker>> {
    let Some(margin) = options.keep_clear else {
        return Ok(None);
    };
    let robot = target.cast::<crate::robot::Robot>();
    let robot = robot.map_err(|_| invalid("keep_clear is for a Robot with collision shapes"))?;
    let checker = robot.get().checker()?;
    Ok(Some(checker.with_margin(margin).or_raise()?))
}

/// The shapes of a robot's feet, its meshes among them.
fn foot_shapes_of(target: &Bound<'_, PyAny>) -> Option<FootShapes> {
    let robot = target.cast::<crate::robot::Robot>().ok()?;
    Some(robot.get().foot_shapes())
}

/// A capture fitted to a target, which keeps clear of itself where it is to.
fn fitted<'r>(
    robot: &'r Robot,
    map: &BodyMap,
    capture: &retarget::Capture,
    options: RetargetOptions,
    checker: Option<&Checker>,
) -> Result<retarget::Retargeting<'r>, RetargetError> {
    let fitted = retarget::Retargeting::new(robot, map, capture, options)?;
    Ok(match checker {
        Some(checker) => fitted.keep_clear(checker),
        None => fitted,
    })
}

/// What `kinopt.Retargeted` is made of: numbers and names in the order of its fields.
type Told<'py> = (
    Bound<'py, PyArray2<f64>>,
    Vec<String>,
    Bound<'py, PyAny>,
    Vec<String>,
    Bound<'py, PyArray2<f64>>,
    Vec<String>,
    (f64, f64, f64, f64),
    Vec<(String, &'static str, usize, usize)>,
    Vec<(usize, String, String, f64)>,
    Vec<(usize, String)>,
    Option<&'static str>,
);

/// A capture on a target by a map (JSON).
#[pyfunction]
fn capture_retargeted<'py>(
    py: Python<'py>,
    capture: &Bound<'py, Capture>,
    target: &Bound<'py, PyAny>,
    map: &str,
    whole: bool,
    options: Options,
) -> PyResult<Told<'py>> {
    let robot = target_of(target)?;
    let checker = checker_of(target, &options)?;
    let mut options = options.read(capture.get().up);
    options.shapes = foot_shapes_of(target);
    let map = BodyMap::from_json(map, &file_of(&robot)).or_raise()?;
    let capture = &capture.get().inner;
    let found = py.detach(|| {
        let retargeting = fitted(&robot, &map, capture, options, checker.as_ref())?;
        let found = match whole {
            true => retargeting.whole()?,
            false => retargeting.per_frame()?,
        };
        let errors = retargeting.errors(&found)?;
        let limits = retargeting.limits_met(&found);
        let driving = retargeting.driving();
        let stride = retargeting.stride();
        let up = retargeting.model_stands_along();
        Ok::<_, RetargetError>((found, errors, limits, driving, stride, up))
    });
    let (found, errors, limits, driving, stride, up) = found.or_raise()?;
    let driven = driving.iter().map(|&joint| capture.names()[joint].clone());
    let limits = limits.into_iter().map(|met| {
        let side = match (met.bound, met.side) {
            (MotionBound::Position, Side::Lower) => "lower",
            (MotionBound::Position, Side::Upper) => "upper",
            (MotionBound::Speed, Side::Lower) => "speed down",
            (MotionBound::Speed, Side::Upper) => "speed up",
        };
        (met.joint, side, met.frames.start, met.frames.end)
    });
    let touching = found.touching.into_iter().map(|own| {
        let pair = own.pair;
        (own.frame, pair.first, pair.second, pair.distance)
    });
    let given_up = found.given_up.into_iter();
    let given_up = given_up.map(|own| (own.frame, own.standing));
    let frames = found.q.len() / found.configuration_len.max(1);
    let contacts = PyArray1::from_slice(py, &found.contacts);
    Ok((
        arrays::list(py, &found.q).reshape([frames, found.configuration_len])?,
        names_of(&robot),
        contacts.reshape([frames, found.standing.len()])?.into_any(),
        found.standing,
        arrays::list(py, &errors).reshape([frames, driving.len()])?,
        driven.collect(),
        (found.mean_error, found.slip, found.sunk, stride),
        limits.collect(),
        touching.collect(),
        given_up.collect(),
        up.filter(|up| *up == UpAxis::Y).map(|_| "y"),
    ))
}

/// The name of the robot's file, under which maps of several robots have its drives.
fn file_of(robot: &Robot) -> String {
    let file = robot.file().and_then(std::path::Path::file_name);
    file.map_or_else(String::new, |name| name.to_string_lossy().into_owned())
}

fn names_of(robot: &Robot) -> Vec<String> {
    let inner = Arc::new(robot.model().clone());
    Model { inner }.coordinate_names()
}

/// A guessed map: JSON, the known skeleton, the known body, and notes.
type Guessed = (
    String,
    Option<&'static str>,
    Option<&'static str>,
    Vec<String>,
);

fn told(mut guess: MapGuess, up: UpAxis) -> Guessed {
    if let Some(along) = guess.up.filter(|along| *along != up) {
        let (along, up) = (axis_name(along), axis_name(up));
        let note = format!("the body stands along {along}, but {up} is taken for upward");
        guess.notes.push(note);
    }
    (guess.map.to_json(), guess.skeleton, guess.body, guess.notes)
}

/// The map that names tell of.
#[pyfunction]
fn map_guessed(capture: &Bound<'_, Capture>, target: &Bound<'_, PyAny>) -> PyResult<Guessed> {
    let robot = target_of(target)?;
    let guess = BodyMap::guess(&capture.get().inner, robot.model());
    guess.or_raise().map(|guess| told(guess, capture.get().up))
}

/// The map of a known skeleton.
#[pyfunction]
fn map_of_skeleton(
    skeleton: &str,
    capture: &Bound<'_, Capture>,
    target: &Bound<'_, PyAny>,
) -> PyResult<Guessed> {
    let robot = target_of(target)?;
    let skeleton = KnownSkeleton::named(skeleton).or_raise()?;
    let guess = BodyMap::from_skeleton(&skeleton, &capture.get().inner, robot.model());
    guess.or_raise().map(|guess| told(guess, capture.get().up))
}

/// The names of the known skeletons.
#[pyfunction]
fn skeleton_names() -> Vec<&'static str> {
    KnownSkeleton::names().collect()
}

/// The names of the first joints of a known skeleton; None where an array of so many is not of it.
#[pyfunction]
fn skeleton_joints(skeleton: &str, joints: usize) -> PyResult<Option<Vec<String>>> {
    let known = KnownSkeleton::named(skeleton).or_raise()?;
    Ok(known.joints_of_array(joints).map(<[String]>::to_vec))
}

/// A follower of frames as they come.
#[pyclass(frozen, module = "kinopt.retargeting")]
pub(crate) struct Live {
    follower: Mutex<LiveFollower>,
    /// Names of the numbers of a configuration.
    #[pyo3(get)]
    names: Vec<String>,
}

#[pymethods]
impl Live {
    #[new]
    fn new(
        py: Python<'_>,
        capture: &Bound<'_, Capture>,
        target: &Bound<'_, PyAny>,
        map: &str,
        options: Options,
    ) -> PyResult<Self> {
        let robot = target_of(target)?;
        let checker = checker_of(target, &options)?;
        let mut options = options.read(capture.get().up);
        options.shapes = foot_shapes_of(target);
        let map = BodyMap::from_json(map, &file_of(&robot)).or_raise()?;
        let capture = &capture.get().inner;
        let follower =
            py.detach(|| fitted(&robot, &map, capture, options, checker.as_ref())?.live());
        Ok(Self {
            follower: Mutex::new(follower.or_raise()?),
            names: names_of(&robot),
        })
    }

    /// Where the body is, shape (nq,).
    #[getter]
    fn q<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        let follower = self.follower.lock().unwrap_or_else(PoisonError::into_inner);
        arrays::list(py, follower.q())
    }

    /// Goes on to the next frame, shape (J, 3).
    fn step<'py>(
        &self,
        py: Python<'py>,
        positions: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let rows = arrays::rows(positions, "positions", 3)?;
        let places: Vec<Vector3<f64>> = rows
            .chunks_exact(3)
            .map(|at| Vector3::new(at[0], at[1], at[2]))
            .collect();
        let q = py.detach(|| {
            let mut follower = self.follower.lock().unwrap_or_else(PoisonError::into_inner);
            follower.step(&places).map(<[f64]>::to_vec)
        });
        Ok(arrays::list(py, &q.or_raise()?))
    }
}
