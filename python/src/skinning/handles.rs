//! Point handles, cages, and bounding boxes of skinned meshes.

use std::sync::Arc;

use kinopt::glam::{Affine3A, Mat3A, Vec3};
use kinopt::skinning::{BoneBoxes as Boxes, CageBinding as Binding, PointHandle as Handle};
use numpy::ndarray::Ix2;
use numpy::{PyArray2, PyArrayDyn};
use pyo3::prelude::*;

use super::SkinWeights;
use crate::arrays::{self, Numbers, shape_text};
use crate::error::{OrRaise, invalid};
use crate::mesh::TriangleMesh;
use crate::pickling;
use crate::transforms::{self, one_to_array, shaped, vector};
use crate::vertices::{self, to_array, vectors};

/// A point handle that translates and linearly deforms the vertices near it.
///
/// Handles move vertices exactly as bones do: their weights are `SkinWeights` with a handle for each bone, and their
/// `transform` is an argument of `MeshWeights.positions("lbs", ...)`.
///
/// A handle at `rest`, dragged to `posed` (None: at rest), both of shape (3,), with a linear map about itself,
/// shape (3, 3): rotation, scale, shear.
///
/// Raises `InvalidValueError` for numbers that are not finite.
#[pyclass(frozen, module = "kinopt.skinning")]
#[derive(Clone)]
pub(crate) struct PointHandle {
    inner: Handle,
}

#[pymethods]
impl PointHandle {
    #[new]
    #[pyo3(signature = (rest, posed = None, linear = None))]
    fn new(
        rest: &Bound<'_, PyAny>,
        posed: Option<&Bound<'_, PyAny>>,
        linear: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let mut inner = Handle::at(Vec3::from(vector(rest, "rest")?));
        if let Some(posed) = posed {
            inner = inner.moved_to(Vec3::from(vector(posed, "posed")?));
        }
        if let Some(linear) = linear {
            let rows: Numbers<'_, Ix2, f32> = arrays::numbers(linear, "linear", "(3, 3)")?;
            if rows.shape() != [3, 3] {
                return Err(invalid(format!(
                    "linear has shape {}, expected (3, 3)",
                    shape_text(rows.shape())
                )));
            }
            let mut numbers = [0.0; 9];
            numbers.copy_from_slice(&rows);
            inner = inner.turned_by(Mat3A::from_cols_array(&numbers).transpose());
        }
        match inner.transform().is_finite() {
            true => Ok(Self { inner }),
            false => Err(invalid("the handle's numbers are not all finite")),
        }
    }

    /// Position at rest, shape (3,), float32.
    #[getter]
    fn rest<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        shaped(py, self.inner.rest.to_array().to_vec(), &[3])
    }

    /// Current position, shape (3,), float32.
    #[getter]
    fn posed<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        shaped(py, self.inner.posed.to_array().to_vec(), &[3])
    }

    /// Linear map about the handle, shape (3, 3), float32.
    #[getter]
    fn linear<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        let rows = self.inner.linear.transpose().to_cols_array();
        shaped(py, rows.to_vec(), &[3, 3])
    }

    /// v -> linear (v - rest) + posed as a transform, shape (4, 4), float32.
    #[getter]
    fn transform<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        one_to_array(py, &self.inner.transform())
    }

    /// Transforms of several handles, shape (N, 4, 4), float32.
    ///
    /// Raises `TypeError` for other objects.
    #[staticmethod]
    fn transforms<'py>(
        py: Python<'py>,
        handles: Vec<Bound<'py, Self>>,
    ) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        let handles = handles.iter().map(|handle| handle.get().inner.transform());
        transforms::to_array(py, &handles.collect::<Vec<Affine3A>>())
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let parts = (self.rest(py)?, self.posed(py)?, self.linear(py)?);
        pickling::by_class::<Self>(py, parts)
    }

    fn __repr__(&self) -> String {
        format!("PointHandle({} to {})", self.inner.rest, self.inner.posed)
    }
}

/// Points bound to a closed triangle cage by mean-value coordinates, which are exact for affine motions of the whole
/// cage.
///
/// Binds `points`, shape (N, 3), to a cage at rest, both in one unit.
///
/// Raises `InvalidValueError` for a cage that is not closed or has a triangle of zero area, and for a point that is not
/// finite or has no coordinates.
#[pyclass(frozen, module = "kinopt.skinning")]
pub(crate) struct CageBinding {
    inner: Binding,
    cage: Arc<kinopt::mesh::TriangleMesh>,
    points: Vec<Vec3>,
}

#[pymethods]
impl CageBinding {
    #[new]
    fn new(
        py: Python<'_>,
        cage: &Bound<'_, TriangleMesh>,
        points: &Bound<'_, PyAny>,
    ) -> PyResult<Self> {
        let cage = Arc::clone(&cage.get().inner);
        let points = vectors(points, "points")?.to_vec();
        let inner = py.detach(|| Binding::new(&cage, &points)).or_raise()?;
        Ok(Self {
            inner,
            cage,
            points,
        })
    }

    /// Number of bound points.
    #[getter]
    fn point_count(&self) -> usize {
        self.inner.point_count()
    }

    /// Coordinates of one point, a number for each corner of the cage, shape (corners,), float32.
    ///
    /// Raises `IndexError`.
    fn coordinates<'py>(
        &self,
        py: Python<'py>,
        point: isize,
    ) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        let point = arrays::resolve_index(point, self.inner.point_count())?;
        let row = self.inner.coordinates(point).unwrap_or_default();
        shaped(py, row.to_vec(), &[row.len()])
    }

    /// Positions of the points for the cage's corners at `cage`, shape (corners, 3): float32, shape (N, 3). `out`
    /// receives the result.
    ///
    /// Raises `InvalidValueError` for another number of corners.
    #[pyo3(signature = (cage, *, out = None))]
    fn positions<'py>(
        &self,
        py: Python<'py>,
        cage: &Bound<'py, PyAny>,
        out: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        let corners = vectors(cage, "cage")?;
        let corners: &[Vec3] = &corners;
        let array = arrays::output_array::<f32>(py, out, &[self.inner.point_count(), 3])?;
        vertices::fill(&array, |buffer| {
            py.detach(|| self.inner.positions(corners, buffer))
                .or_raise()
        })?;
        Ok(array)
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let cage = TriangleMesh::from(Arc::clone(&self.cage));
        let parts = (cage, to_array(py, &self.points, 3)?);
        pickling::by_class::<Self>(py, parts)
    }

    fn __repr__(&self) -> String {
        format!(
            "CageBinding({} points, {} corners)",
            self.points.len(),
            self.cage.positions().len()
        )
    }
}

/// Bounding boxes at rest of the vertices of each bone, to bound a skinned mesh without skinning it.
///
/// The boxes of a mesh's positions at `rest`, shape (V, 3).
///
/// Raises `InvalidValueError` for another number of vertices and for positions that are not finite.
#[pyclass(frozen, module = "kinopt.skinning")]
pub(crate) struct BoneBoxes {
    inner: Boxes,
    weights: Arc<kinopt::skinning::SkinWeights>,
    rest: Vec<Vec3>,
}

#[pymethods]
impl BoneBoxes {
    #[new]
    fn new(weights: &Bound<'_, SkinWeights>, rest: &Bound<'_, PyAny>) -> PyResult<Self> {
        let weights = Arc::clone(&weights.get().inner);
        let rest = vectors(rest, "rest")?.to_vec();
        let inner = Boxes::new(&weights, &rest).or_raise()?;
        Ok(Self {
            inner,
            weights,
            rest,
        })
    }

    /// A box that contains every vertex skinned by linear blend with these transforms, rest -> posed, shape (bones, 4,
    /// 4). The result is the lowest and the highest corner, shape (2, 3), float32, or None without vertices. Not valid
    /// for dual quaternions.
    ///
    /// Raises `InvalidValueError` for transforms of another shape or another number of bones.
    fn linear_blend<'py>(
        &self,
        py: Python<'py>,
        transforms: &Bound<'py, PyAny>,
    ) -> PyResult<Option<Bound<'py, PyArray2<f32>>>> {
        let transforms = transforms::read_list(transforms, "transforms")?;
        let corners = self.inner.linear_blend(&transforms).or_raise()?;
        corners.map(|corners| to_array(py, &corners, 3)).transpose()
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let weights = SkinWeights::from(Arc::clone(&self.weights));
        let parts = (weights, to_array(py, &self.rest, 3)?);
        pickling::by_class::<Self>(py, parts)
    }

    fn __repr__(&self) -> String {
        format!("BoneBoxes({} bones)", self.weights.bone_count())
    }
}
