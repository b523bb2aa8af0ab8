//! Models built joint by joint.

use kinopt::model::{BallLimits, FrameId, JointId, JointKind, LengthUnit, Limits};
use kinopt::spatial::Placement;
use pyo3::prelude::*;

use super::Model;
use crate::arrays;
use crate::error::{OrRaise, invalid};
use crate::named_loop::NamedLoop;
use crate::placement;

/// Builds a model joint by joint; joints and frames are identified by name.
///
/// Starts an empty model; `length_unit` is "m", or "units" for lengths of an unknown unit.
///
/// Raises `InvalidValueError` for another unit.
#[pyclass(module = "kinopt")]
pub(crate) struct ModelBuilder {
    inner: kinopt::model::ModelBuilder,
    /// Joints that can be parents, by the names under which they were added.
    joints: Vec<(String, JointId)>,
    /// Frames that loops can connect.
    frames: Vec<(String, FrameId)>,
}

impl ModelBuilder {
    fn parent(&self, name: Option<&str>) -> PyResult<Option<JointId>> {
        let Some(name) = name else { return Ok(None) };
        let entry = self.joints.iter().find(|(joint, _)| joint == name);
        let names = self.joints.iter().map(|(joint, _)| joint.as_str());
        entry
            .map(|&(_, id)| id)
            .ok_or_else(|| kinopt::model::UnknownName::new("joint", name, names))
            .or_raise()
            .map(Some)
    }

    /// Parent of a joint and its placement relative to the parent.
    fn resolve_placement(
        &self,
        parent: Option<&str>,
        parent_from_joint: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<(Option<JointId>, Placement<f64>)> {
        let placement = match parent_from_joint {
            Some(value) => placement::placement(value, "parent_from_joint")?,
            None => Placement::identity(),
        };
        Ok((self.parent(parent)?, placement))
    }
}

/// Converts ranges to limits.
fn to_limits<const N: usize>(ranges: Option<[(f64, f64); N]>) -> [Limits; N] {
    let unbounded = [Limits::UNBOUNDED; N];
    ranges.map_or(unbounded, |ranges| {
        ranges.map(|(lower, upper)| Limits::new(lower, upper))
    })
}

#[pymethods]
impl ModelBuilder {
    #[new]
    #[pyo3(signature = (name, length_unit = "m"))]
    fn new(name: String, length_unit: &str) -> PyResult<Self> {
        let unit = match length_unit {
            "m" => LengthUnit::Metres,
            "units" => LengthUnit::Own,
            _ => {
                return Err(invalid(format!(
                    "length_unit is {length_unit:?}: \"m\" or \"units\""
                )));
            }
        };
        let mut inner = kinopt::Model::builder(name);
        inner.length_unit(unit);
        Ok(Self {
            inner,
            joints: Vec::new(),
            frames: Vec::new(),
        })
    }

    /// Adds a joint.
    ///
    /// `kind` is "revolute", "continuous", "prismatic" or "fixed" (`ball`, `free`, `planar` and `universal` add the
    /// others). `parent` is the name of an existing joint (None: the world). `parent_from_joint` is a 4 x 4 placement,
    /// metres (None: the identity). `axis` has three numbers, in the joint's own frame, of any length. `lower` and
    /// `upper` are radians or metres.
    ///
    /// Raises `UnknownNameError` for an unknown kind or parent, `InvalidValueError` for a placement of another shape.
    /// `build` raises errors of incompatible arguments.
    #[pyo3(signature = (
        name, kind = "revolute", parent = None, parent_from_joint = None, axis = [0.0, 0.0, 1.0],
        lower = f64::NEG_INFINITY, upper = f64::INFINITY
    ))]
    #[allow(clippy::too_many_arguments, reason = "they are keywords")]
    fn joint(
        &mut self,
        name: String,
        kind: &str,
        parent: Option<&str>,
        parent_from_joint: Option<&Bound<'_, PyAny>>,
        #[pyo3(from_py_with = axis)] axis: [f64; 3],
        lower: f64,
        upper: f64,
    ) -> PyResult<()> {
        let kinds = [
            JointKind::Fixed,
            JointKind::Revolute,
            JointKind::Continuous,
            JointKind::Prismatic,
        ];
        let names = kinds.map(JointKind::name);
        let kind = kinds
            .into_iter()
            .find(|known| known.name() == kind)
            .ok_or_else(|| {
                let unknown = kinopt::model::UnknownName::new("joint kind", kind, names);
                unknown.with_note(
                    "others have methods of their own: .ball(), .free(), .planar(), .universal()",
                )
            });
        let (parent, placement) = self.resolve_placement(parent, parent_from_joint)?;
        let joint = kinopt::model::Joint::new(
            name.as_str(),
            parent,
            placement,
            kind.or_raise()?,
            axis,
            Limits::new(lower, upper),
        );
        let id = self.inner.joint(joint);
        self.joints.push((name, id));
        Ok(())
    }

    /// Adds a ball joint, which rotates about one point. Its part of a configuration is its unit quaternion w, x, y, z.
    ///
    /// `swing` (radians, at most pi) limits the tilt of its `axis` to a cone of that half angle. Two half angles make
    /// an elliptic cone, about `about` and about the perpendicular of `about` and the axis. `twist` is the range,
    /// (lower, upper) in radians, of the rotation about its axis. `angle` limits the whole rotation, about any axis, in
    /// radians; pi and more is no limit. `parent` and `parent_from_joint` are as in `joint`.
    ///
    /// Raises `UnknownNameError` for an unknown parent, `InvalidValueError` for a placement of another shape. `build`
    /// raises errors of incompatible arguments.
    #[pyo3(signature = (
        name, parent = None, parent_from_joint = None, axis = [1.0, 0.0, 0.0], *, swing = None,
        twist = None, about = None, angle = None
    ))]
    #[allow(clippy::too_many_arguments, reason = "they are keywords")]
    fn ball(
        &mut self,
        name: String,
        parent: Option<&str>,
        parent_from_joint: Option<&Bound<'_, PyAny>>,
        #[pyo3(from_py_with = axis)] axis: [f64; 3],
        swing: Option<&Bound<'_, PyAny>>,
        #[pyo3(from_py_with = twist)] twist: Option<(f64, f64)>,
        #[pyo3(from_py_with = about)] about: Option<[f64; 3]>,
        #[pyo3(from_py_with = angle)] angle: Option<f64>,
    ) -> PyResult<()> {
        let (parent, placement) = self.resolve_placement(parent, parent_from_joint)?;
        let [twist_range] = to_limits(twist.map(|twist| [twist]));
        let limited = swing.is_some() || twist.is_some() || angle.is_some();
        let swing = match swing {
            None => [std::f64::consts::PI; 2],
            Some(swing) => half_angles(swing)?,
        };
        let mut limits = BallLimits::cone(swing[0], twist_range);
        limits.swing = swing;
        limits.about = about.map(Into::into);
        limits.angle = angle;
        let limits = limited.then_some(limits);
        let id = self
            .inner
            .ball(name.as_str(), parent, placement, axis, limits);
        self.joints.push((name, id));
        Ok(())
    }

    /// Adds a free joint with six degrees of freedom: `NAME/x`, `NAME/y` and `NAME/z`, which translate within `bounds`
    /// ((lower, upper) three times, metres), and the ball `NAME/rotation`. Its part of a configuration is x, y, z, w,
    /// x, y, z. Children refer to it by its name.
    ///
    /// Raises as `ball`.
    #[pyo3(signature = (name, parent = None, parent_from_joint = None, *, bounds = None))]
    fn free(
        &mut self,
        name: String,
        parent: Option<&str>,
        parent_from_joint: Option<&Bound<'_, PyAny>>,
        #[pyo3(from_py_with = bounds_of)] bounds: Option<[(f64, f64); 3]>,
    ) -> PyResult<()> {
        let (parent, placement) = self.resolve_placement(parent, parent_from_joint)?;
        let bounds = to_limits(bounds);
        let id = self.inner.free(name.as_str(), parent, placement, bounds);
        self.joints.push((name, id));
        Ok(())
    }

    /// Adds a planar joint across `normal`: `NAME/x` and `NAME/y`, which translate within `bounds` ((lower, upper)
    /// twice, metres), and `NAME/yaw`, which rotates within `yaw` (radians). Children refer to it by its name.
    ///
    /// Raises as `ball`.
    #[pyo3(signature = (
        name, parent = None, parent_from_joint = None, normal = [0.0, 0.0, 1.0], *, bounds = None, yaw = None
    ))]
    #[allow(clippy::too_many_arguments, reason = "they are keywords")]
    fn planar(
        &mut self,
        name: String,
        parent: Option<&str>,
        parent_from_joint: Option<&Bound<'_, PyAny>>,
        #[pyo3(from_py_with = normal)] normal: [f64; 3],
        #[pyo3(from_py_with = bounds_of)] bounds: Option<[(f64, f64); 2]>,
        #[pyo3(from_py_with = yaw)] yaw: Option<(f64, f64)>,
    ) -> PyResult<()> {
        let (parent, placement) = self.resolve_placement(parent, parent_from_joint)?;
        let (bounds, [yaw]) = (to_limits(bounds), to_limits(yaw.map(|yaw| [yaw])));
        let id = (self.inner).planar(name.as_str(), parent, placement, normal, bounds, yaw);
        self.joints.push((name, id));
        Ok(())
    }

    /// Adds a universal joint. `NAME/first` rotates about the first of two `axes` (each three numbers), `NAME/second`
    /// about the second axis in the frame of the first. Both are within `limits` ((lower, upper) twice, radians).
    /// Children refer to it by its name.
    ///
    /// Raises as `ball`.
    #[pyo3(signature = (
        name, parent = None, parent_from_joint = None, axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], *, limits = None
    ))]
    fn universal(
        &mut self,
        name: String,
        parent: Option<&str>,
        parent_from_joint: Option<&Bound<'_, PyAny>>,
        #[pyo3(from_py_with = axes)] axes: [[f64; 3]; 2],
        #[pyo3(from_py_with = limits)] limits: Option<[(f64, f64); 2]>,
    ) -> PyResult<()> {
        let (parent, placement) = self.resolve_placement(parent, parent_from_joint)?;
        let (axes, limits) = (axes.map(Into::into), to_limits(limits));
        let id = (self.inner).universal(name.as_str(), parent, placement, axes, limits);
        self.joints.push((name, id));
        Ok(())
    }

    /// Adds a frame on `joint` (None: the world) at `joint_from_frame`, 4 x 4, metres.
    ///
    /// Raises `UnknownNameError` for an unknown joint, `InvalidValueError` for a placement of
    /// another shape.
    #[pyo3(signature = (name, joint = None, joint_from_frame = None))]
    fn frame(
        &mut self,
        name: String,
        joint: Option<&str>,
        joint_from_frame: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<()> {
        let placement = match joint_from_frame {
            Some(value) => placement::placement(value, "joint_from_frame")?,
            None => Placement::identity(),
        };
        let joint = self.parent(joint)?;
        let id = self.inner.frame(name.as_str(), joint, placement);
        self.frames.push((name, id));
        Ok(())
    }

    /// Adds a loop: the origins of two existing `frames` coincide ("connect"), or origins and axes ("weld"). `places`,
    /// a pair of 4 x 4 placements, are relative to the frames; default the identity. Every problem on the model closes
    /// it.
    ///
    /// Raises `UnknownNameError` for an unknown kind or frame. `build` raises errors of incompatible arguments, and of
    /// a loop that no configuration closes.
    #[pyo3(signature = (name, frames, kind = "connect", places = None))]
    fn close(
        &mut self,
        name: String,
        #[pyo3(from_py_with = frames)] frames: [String; 2],
        kind: &str,
        places: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<()> {
        let expected = "places must be two 4 x 4 placements";
        let places = places
            .map(|places| read_argument(places, expected))
            .transpose()?;
        let named_loop = NamedLoop::new(name, frames, kind, places)?;
        let id = |name: &String| -> PyResult<FrameId> {
            let entry = self.frames.iter().find(|(frame, _)| frame == name);
            let names = self.frames.iter().map(|(frame, _)| frame.as_str());
            let unknown = || kinopt::model::UnknownName::new("frame", name, names);
            entry.map(|&(_, id)| id).ok_or_else(unknown).or_raise()
        };
        let frames = [id(&named_loop.frames[0])?, id(&named_loop.frames[1])?];
        self.inner.close(named_loop.of(frames));
        Ok(())
    }

    /// Validates all parts and creates the model.
    ///
    /// Raises `InvalidValueError`, which names the joint or frame: duplicate names, empty limits, axes of zero length,
    /// placements that are not rigid.
    fn build(&self) -> PyResult<Model> {
        self.inner.clone().build().or_raise().map(Model::from)
    }

    fn __repr__(&self) -> String {
        format!("ModelBuilder({} joints)", self.joints.len())
    }
}

/// Reads one half angle of a cone, or two of an elliptic one.
fn half_angles(swing: &Bound<'_, PyAny>) -> PyResult<[f64; 2]> {
    let cone = swing.extract().map(|half| [half; 2]);
    cone.or_else(|_| swing.extract()).map_err(|_| {
        invalid(format!(
            "swing must be a half angle in radians, or two of them, not {}",
            arrays::shown(swing)
        ))
    })
}

/// Reads an argument; the error names the expected value instead of pyo3's type error.
fn read_argument<'py, T: FromPyObjectOwned<'py>>(
    value: &Bound<'py, PyAny>,
    expected: &str,
) -> PyResult<T> {
    let extracted = value.extract();
    extracted.map_err(|_| invalid(format!("{expected}, not {}", arrays::shown(value))))
}

fn axis(value: &Bound<'_, PyAny>) -> PyResult<[f64; 3]> {
    read_argument(value, "axis must be three numbers")
}

fn normal(value: &Bound<'_, PyAny>) -> PyResult<[f64; 3]> {
    read_argument(value, "normal must be three numbers")
}

fn axes(value: &Bound<'_, PyAny>) -> PyResult<[[f64; 3]; 2]> {
    read_argument(value, "axes must be two of three numbers")
}

fn about(value: &Bound<'_, PyAny>) -> PyResult<Option<[f64; 3]>> {
    read_argument(value, "about must be three numbers")
}

fn twist(value: &Bound<'_, PyAny>) -> PyResult<Option<(f64, f64)>> {
    read_argument(value, "twist must be (lower, upper)")
}

fn yaw(value: &Bound<'_, PyAny>) -> PyResult<Option<(f64, f64)>> {
    read_argument(value, "yaw must be (lower, upper)")
}

fn bounds_of<const N: usize>(value: &Bound<'_, PyAny>) -> PyResult<Option<[(f64, f64); N]>> {
    read_argument(value, &format!("bounds must be (lower, upper) {N} times"))
}

fn limits(value: &Bound<'_, PyAny>) -> PyResult<Option<[(f64, f64); 2]>> {
    read_argument(value, "limits must be (lower, upper) twice")
}

fn angle(value: &Bound<'_, PyAny>) -> PyResult<Option<f64>> {
    read_argument(value, "angle must be a number")
}

fn frames(value: &Bound<'_, PyAny>) -> PyResult<[String; 2]> {
    read_argument(value, "frames must be the names of two frames")
}
