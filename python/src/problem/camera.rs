//! Cameras, for tasks in image coordinates.

use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyType;

use crate::arrays;
use crate::error::invalid;
use crate::pickling;
use crate::placement;

/// A projective camera: homogeneous pixel (u w, v w, w) = P (x, y, z, 1), P of shape (3, 4).
///
/// A camera by its matrix `pixel_from_world`, shape (3, 4), finite numbers.
///
/// Raises `InvalidValueError` for another shape and for numbers that are not finite.
#[pyclass(frozen, module = "kinopt.tasks")]
#[derive(Clone, Copy)]
pub(crate) struct Camera {
    pub(crate) inner: kinopt::task::Camera,
}

#[pymethods]
impl Camera {
    #[new]
    fn new(pixel_from_world: &Bound<'_, PyAny>) -> PyResult<Self> {
        let pixel_from_world: [[f64; 4]; 3] = arrays::table(pixel_from_world, "pixel_from_world")?;
        let mut numbers = pixel_from_world.iter().flatten();
        if let Some(bad) = numbers.find(|number| !number.is_finite()) {
            return Err(invalid(format!(
                "pixel_from_world holds {bad}, which is not a finite number"
            )));
        }
        let inner = kinopt::task::Camera { pixel_from_world };
        Ok(Self { inner })
    }

    /// A pinhole camera at `world_from_camera` (4 x 4), looking along its own +z, x to the right and y down.
    /// `focal_length` and `principal_point` are in pixels, shape (2,) each.
    ///
    /// Raises `InvalidValueError` for other shapes, for a placement that is not rigid and for numbers that are not
    /// finite.
    #[classmethod]
    fn pinhole(
        _class: &Bound<'_, PyType>,
        world_from_camera: &Bound<'_, PyAny>,
        focal_length: &Bound<'_, PyAny>,
        principal_point: &Bound<'_, PyAny>,
    ) -> PyResult<Self> {
        let inner = kinopt::task::Camera::pinhole(
            &placement::placement(world_from_camera, "world_from_camera")?,
            arrays::array(focal_length, "focal_length")?,
            arrays::array(principal_point, "principal_point")?,
        );
        let mut numbers = inner.pixel_from_world.iter().flatten();
        match numbers.all(|number| number.is_finite()) {
            true => Ok(Self { inner }),
            false => Err(invalid("the camera has a number that is not finite")),
        }
    }

    /// Matrix P, shape (3, 4).
    #[getter]
    fn pixel_from_world<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let numbers = self.inner.pixel_from_world;
        arrays::list(py, numbers.as_flattened()).reshape([3, 4])
    }

    /// Projects a point of the world, shape (3,), metres, to its pixel (u, v), shape (2,); not finite in the focal
    /// plane.
    ///
    /// Raises `InvalidValueError` for another shape.
    fn project<'py>(
        &self,
        py: Python<'py>,
        point: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let point: [f64; 3] = arrays::array(point, "point")?;
        Ok(arrays::list(py, &self.inner.project(point.into())))
    }

    /// Viewing ray through a pixel (u, v). It has the camera centre and the pixel unprojected to the point of depth
    /// one, shape (2, 3), metres, as for `tasks.Ray`. None for a camera without a centre.
    ///
    /// Raises `InvalidValueError` for another shape.
    fn viewing_ray<'py>(
        &self,
        py: Python<'py>,
        pixel: &Bound<'py, PyAny>,
    ) -> PyResult<Option<Bound<'py, PyArray2<f64>>>> {
        let Some(ends) = self.inner.viewing_ray(arrays::array(pixel, "pixel")?) else {
            return Ok(None);
        };
        let numbers = ends.map(kinopt::spatial::Vector3::to_array);
        arrays::list(py, numbers.as_flattened())
            .reshape([2, 3])
            .map(Some)
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let arguments = (self.pixel_from_world(py)?,);
        pickling::by_class::<Self>(py, arguments)
    }

    fn __repr__(&self) -> String {
        format!("Camera({:?})", self.inner.pixel_from_world)
    }
}
