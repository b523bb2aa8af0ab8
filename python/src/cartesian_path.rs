//! Cartesian paths of a tool, extended by segments.

use kinopt::motion::path;
use kinopt::spatial::Placement;
use kinopt_bindings::placement::PoseTarget;
use numpy::PyArray3;
use pyo3::prelude::*;

use crate::arrays;
use crate::error::OrRaise;
use crate::pickling;
use crate::placement::{self, one_or_more};

/// Path of a tool in the base of an arm, for `solve_path`: points, and segments that continue from the last point.
///
/// `points` is one placement, or several as in `Arm.solve_batch`. Between two points the tool moves straight and rotates
/// at a constant rate. A path is immutable: `through`, `arc_through` and `spline_through` return a longer one. The points
/// of a segment are at most `step` metres and 0.05 rad apart. A key that is a position keeps the orientation of the
/// point before it. A path of positions alone requires an arm with `goal="position"`.
///
/// Raises `InvalidValueError` for no points, and for placements that are not rigid to 1e-6.
#[pyclass(frozen, module = "kinopt")]
pub(crate) struct CartesianPath {
    pub(crate) inner: path::CartesianPath,
    oriented: bool,
}

/// Path through placements, or through positions if a placement has no orientation.
pub(crate) fn path_of(
    points: Vec<Placement<f64>>,
    oriented: bool,
) -> PyResult<path::CartesianPath> {
    match oriented {
        true => path::CartesianPath::new(points).or_raise(),
        false => {
            let positions = points.into_iter().map(|point| point.translation);
            path::CartesianPath::of_positions(positions).or_raise()
        }
    }
}

impl CartesianPath {
    fn last(&self) -> Placement<f64> {
        let last = self.inner.points().last();
        last.copied().unwrap_or(Placement::identity())
    }

    /// Reads keys after the last point; positions keep the orientation of the placement before them.
    fn keys(&self, keys: &Bound<'_, PyAny>, what: &str) -> PyResult<Vec<Placement<f64>>> {
        let mut rotation = self.last().rotation;
        let placed = one_or_more(keys, what)?.into_iter().map(|key| {
            if key.has_orientation {
                rotation = key.placement.rotation;
            }
            Placement::new(rotation, key.placement.translation)
        });
        Ok(placed.collect())
    }

    fn extended(
        &self,
        extend: impl FnOnce(path::CartesianPath) -> Result<path::CartesianPath, path::PathError>,
    ) -> PyResult<Self> {
        Ok(Self {
            inner: extend(self.inner.clone()).or_raise()?,
            oriented: self.oriented,
        })
    }
}

#[pymethods]
impl CartesianPath {
    #[new]
    fn new(points: &Bound<'_, PyAny>) -> PyResult<Self> {
        let points = one_or_more(points, "points")?;
        let oriented = points.iter().all(|point| point.has_orientation);
        let points = points.iter().map(|point: &PoseTarget| point.placement);
        Ok(Self {
            inner: path_of(points.collect(), oriented)?,
            oriented,
        })
    }

    /// The path continued on straight lines through `keys`: one placement, or several as in `Arm.solve_batch`.
    ///
    /// Raises `InvalidValueError` for keys that are not rigid, and for a `step` that is not positive or gives more than
    /// a million points.
    #[pyo3(signature = (keys, step = 0.01))]
    fn through(&self, keys: &Bound<'_, PyAny>, step: f64) -> PyResult<Self> {
        let keys = self.keys(keys, "keys")?;
        self.extended(|path| path.through(&keys, step))
    }

    /// The path continued on a circular arc through the position `via`, shape (3,), to the placement `end`. The tool
    /// rotates at a constant rate.
    ///
    /// Raises `InvalidValueError` as `through`, and for three positions on one line.
    #[pyo3(signature = (via, end, step = 0.01))]
    fn arc_through(
        &self,
        via: &Bound<'_, PyAny>,
        end: &Bound<'_, PyAny>,
        step: f64,
    ) -> PyResult<Self> {
        let via: [f64; 3] = arrays::array(via, "via")?;
        let end = placement::pose_target(end, "end")?;
        let end = match end.has_orientation {
            true => end.placement,
            false => Placement::new(self.last().rotation, end.placement.translation),
        };
        self.extended(|path| path.arc_through(via, end, step))
    }

    /// The path continued on a Catmull-Rom spline through `keys`, as in `through`.
    ///
    /// Raises `InvalidValueError` as `through`.
    #[pyo3(signature = (keys, step = 0.01))]
    fn spline_through(&self, keys: &Bound<'_, PyAny>, step: f64) -> PyResult<Self> {
        let keys = self.keys(keys, "keys")?;
        self.extended(|path| path.spline_through(&keys, step))
    }

    /// Points, base_from_tool, shape (N, 4, 4), metres.
    #[getter]
    fn points<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray3<f64>>> {
        placement::to_arrays(py, self.inner.points())
    }

    fn __len__(&self) -> usize {
        self.inner.points().len()
    }

    fn __repr__(&self) -> String {
        format!("CartesianPath({} points)", self.inner.points().len())
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let parts = (self.points(py)?, self.oriented, self.inner.bulges());
        pickling::by_rebuild::<Self>(py, parts)
    }

    #[staticmethod]
    fn _rebuild(points: &Bound<'_, PyAny>, oriented: bool, bulges: Vec<f64>) -> PyResult<Self> {
        let points = placement::placements(points, "points")?.to_vec("point")?;
        let inner = path_of(points, oriented)?;
        Ok(Self {
            inner: inner.with_bulges(bulges).or_raise()?,
            oriented,
        })
    }
}
