//! Spheres that cover the shapes of a robot.

use std::path::PathBuf;
use std::sync::Arc;

use kinopt::collision::{self, Ball};
use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyType};

use super::CollisionModel;
use crate::arrays;
use crate::error::OrRaise;
use crate::pickling;

/// Spheres by link, which together cover every shape of a `CollisionModel`, including the interior. Created by
/// `CollisionModel.spheres`, or read from a file of another tool.
#[pyclass(frozen, module = "kinopt")]
pub(crate) struct SphereModel {
    pub(crate) inner: Arc<collision::SphereModel>,
}

impl From<collision::SphereModel> for SphereModel {
    fn from(inner: collision::SphereModel) -> Self {
        let inner = Arc::new(inner);
        Self { inner }
    }
}

fn numbers(Ball { centre, radius }: &Ball) -> [f64; 4] {
    [centre.x, centre.y, centre.z, *radius]
}

#[pymethods]
impl SphereModel {
    /// Reads spheres of other tools: cuRobo's `collision_spheres` (`.yml`, `.yaml`), or the spheres of a spherised URDF
    /// as in foam and VAMP. They are not changed; their protrusion from the model's shapes and the uncovered gap are
    /// measured.
    ///
    /// Raises `FileError` if the file cannot be read, `InvalidFileError` if its content is invalid or names an unknown
    /// link.
    #[classmethod]
    fn read(
        _class: &Bound<'_, PyType>,
        py: Python<'_>,
        path: PathBuf,
        model: &CollisionModel,
    ) -> PyResult<Self> {
        let spheres = py.detach(|| collision::SphereModel::read(path, &model.inner));
        Ok(spheres.or_raise()?.into())
    }

    /// Number of spheres.
    #[getter]
    fn count(&self) -> usize {
        self.inner.count()
    }

    /// Maximum protrusion of a sphere from the shapes of its link, in metres.
    #[getter]
    fn max_protrusion(&self) -> f64 {
        self.inner.max_protrusion()
    }

    /// Largest distance of a point of the shapes from all spheres of its link, in metres: 0 if they cover all shapes.
    #[getter]
    fn gap(&self) -> f64 {
        self.inner.gap()
    }

    /// Parts of the file that the reader ignored, one text each.
    #[getter]
    fn notes(&self) -> Vec<String> {
        self.inner.notes().to_vec()
    }

    /// By link: an array of shape (N, 4), x, y, z and the radius of each sphere in the link's frame, metres.
    #[getter]
    fn spheres<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let links = PyDict::new(py);
        for group in self.inner.groups() {
            let values: Vec<f64> = group.spheres.iter().flat_map(numbers).collect();
            let rows: Bound<'py, PyArray2<f64>> =
                arrays::list(py, &values).reshape([group.spheres.len(), 4])?;
            arrays::freeze(&rows)?;
            links.set_item(&group.name, rows)?;
        }
        Ok(links)
    }

    /// By link: x, y, z and the radius of a bounding sphere of its spheres, shape (4,).
    #[getter]
    fn bounds<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let links = PyDict::new(py);
        for group in self.inner.groups() {
            let bound: Bound<'py, PyArray1<f64>> = arrays::frozen(py, numbers(&group.bound))?;
            links.set_item(&group.name, bound)?;
        }
        Ok(links)
    }

    /// Enabled collision pairs of links.
    #[getter]
    fn pairs(&self) -> Vec<(String, String)> {
        let groups = self.inner.groups();
        let name = |at: usize| groups[at].name.clone();
        self.inner
            .pairs()
            .iter()
            .map(|[a, b]| (name(*a), name(*b)))
            .collect()
    }

    /// The spheres as cuRobo's `collision_spheres`, in YAML.
    fn to_yaml(&self) -> String {
        self.inner.to_yaml()
    }

    /// The URDF of a robot, given as text, with these spheres as its only collision shapes; `name` is its name in
    /// messages.
    ///
    /// Raises `InvalidFileError` for a text that is not URDF.
    #[pyo3(signature = (urdf, name = "robot.urdf"))]
    fn spherised(&self, urdf: &str, name: &str) -> PyResult<String> {
        self.inner.spherised(urdf, name).or_raise()
    }

    #[classmethod]
    fn _rebuild(_class: &Bound<'_, PyType>, json: &str) -> PyResult<Self> {
        let inner: collision::SphereModel = serde_json::from_str(json).or_raise()?;
        Ok(inner.into())
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        pickling::by_json::<Self>(py, &*self.inner)
    }

    fn __len__(&self) -> usize {
        self.inner.count()
    }

    fn __repr__(&self) -> String {
        format!(
            "SphereModel({} on {}, max_protrusion {:.4})",
            kinopt::counted(self.inner.count(), "sphere"),
            kinopt::counted(self.inner.groups().len(), "link"),
            self.inner.max_protrusion()
        )
    }
}
