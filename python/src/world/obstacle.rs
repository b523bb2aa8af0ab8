//! Obstacles and distances between them.

use kinopt::collision::ShapeKind;
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arrays;
use crate::placement;

/// Copy of an obstacle of a world, from `World[name]`.
#[pyclass(frozen, module = "kinopt")]
pub(crate) struct Obstacle(pub(crate) kinopt::collision::Obstacle);

#[pymethods]
impl Obstacle {
    /// Name in the world.
    #[getter]
    fn name(&self) -> &str {
        &self.0.name
    }

    /// "sphere", "capsule", "cylinder", "box", "plane", "convex", "mesh", "height field" or "points".
    #[getter]
    fn kind(&self) -> &'static str {
        match self.0.shape.kind() {
            ShapeKind::Sphere { .. } => "sphere",
            ShapeKind::Capsule { .. } => "capsule",
            ShapeKind::Cylinder { .. } => "cylinder",
            ShapeKind::Cuboid { .. } => "box",
            ShapeKind::HalfSpace => "plane",
            ShapeKind::Convex(_) => "convex",
            ShapeKind::Mesh(_) => "mesh",
            ShapeKind::HeightField(_) => "height field",
            ShapeKind::Points(_) => "points",
        }
    }

    /// Dimensions by name, as in `World.add_box` and the other methods. They are arrays for convex hulls (whose
    /// "points" are their corners, with "triangles"), meshes, height fields and points.
    #[getter]
    fn measures<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let measures = PyDict::new(py);
        let vectors = |points: &[kinopt::spatial::Vector3<f64>]| {
            let numbers: Vec<f64> = points.iter().flat_map(|p| p.to_array()).collect();
            table(py, &numbers, 3)
        };
        match self.0.shape.kind() {
            ShapeKind::Sphere { radius } => measures.set_item("radius", radius)?,
            ShapeKind::Capsule { radius, length } | ShapeKind::Cylinder { radius, length } => {
                measures.set_item("radius", radius)?;
                measures.set_item("length", length)?;
            }
            ShapeKind::Cuboid { size } => measures.set_item("size", arrays::list(py, size))?,
            ShapeKind::Convex(hull) => {
                measures.set_item("points", vectors(hull.vertices())?)?;
                measures.set_item("triangles", triples(py, hull.triangles())?)?;
            }
            ShapeKind::Mesh(mesh) => {
                measures.set_item("vertices", vectors(mesh.vertices())?)?;
                measures.set_item("triangles", triples(py, mesh.triangles())?)?;
            }
            ShapeKind::HeightField(field) => {
                measures.set_item("heights", table(py, field.heights(), field.columns())?)?;
                measures.set_item("spacing", arrays::list(py, &field.spacing()))?;
            }
            ShapeKind::Points(cloud) => {
                measures.set_item("positions", vectors(cloud.positions())?)?;
                measures.set_item("radius", cloud.radius())?;
            }
            _ => {}
        }
        Ok(measures)
    }

    /// Placement, shape (4, 4), in the world, or in the frame that it is attached to.
    #[getter]
    fn placement<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        placement::to_array(py, &self.0.placement)
    }

    /// Frame of the robot that it is attached to, or None.
    #[getter]
    fn attached(&self) -> Option<&str> {
        self.0.attached.as_deref()
    }

    /// Links and obstacles of its allowed collisions (`World.allow_collision`).
    #[getter]
    fn allowed_collisions(&self) -> Vec<String> {
        self.0.allowed_collisions.clone()
    }

    /// Properties of its accepted shape, such as an open mesh without an interior.
    #[getter]
    fn notes(&self) -> Vec<String> {
        let notes = self.0.shape.notes().iter();
        notes.map(ToString::to_string).collect()
    }

    fn __repr__(&self) -> String {
        let attached = match &self.0.attached {
            Some(frame) => format!(", attached to {frame}"),
            None => String::new(),
        };
        format!("Obstacle({}, {}{attached})", self.0.name, self.kind())
    }
}

fn triples<'py>(py: Python<'py>, triangles: &[[u32; 3]]) -> PyResult<Bound<'py, PyAny>> {
    let corners = PyArray1::from_vec(py, triangles.as_flattened().to_vec());
    corners.call_method1("reshape", (triangles.len(), 3))
}

fn table<'py>(py: Python<'py>, numbers: &[f64], columns: usize) -> PyResult<Bound<'py, PyAny>> {
    let shape = (numbers.len() / columns.max(1), columns);
    arrays::list(py, numbers).call_method1("reshape", shape)
}

/// Distance between two obstacles, in world coordinates.
#[pyclass(frozen, module = "kinopt")]
pub(crate) struct Separation(pub(crate) kinopt::collision::Separation);

#[pymethods]
impl Separation {
    /// Distance in metres: positive if apart, 0 in contact, negative by the penetration depth, along the shortest
    /// separating translation.
    #[getter]
    fn distance(&self) -> f64 {
        self.0.distance
    }

    /// The point of the first that is nearest to the second, or deepest in it, shape (3,).
    #[getter]
    fn on_first<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        arrays::list(py, &self.0.on_first.to_array())
    }

    /// The point of the second that is nearest to the first, or deepest in it, shape (3,).
    #[getter]
    fn on_second<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        arrays::list(py, &self.0.on_second.to_array())
    }

    /// Unit vector from the first to the second, shape (3,): motion of the second along it increases the distance by
    /// its length.
    #[getter]
    fn normal<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        arrays::list(py, &self.0.normal.to_array())
    }

    fn __repr__(&self) -> String {
        format!("Separation(distance={})", self.0.distance)
    }
}
