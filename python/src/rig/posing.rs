//! Repeated poses of a rig's mesh.

use std::sync::Arc;

use kinopt::skinning::SkinningMethod;
use numpy::PyArrayDyn;
use pyo3::prelude::*;

use super::Rig;
use crate::arrays::{self, Queries};
use crate::error::OrRaise;
use crate::mesh::TriangleMesh;
use crate::pickling;
use crate::pool::Pool;
use crate::vertices::Part;

/// Number of poses between two checks for signals.
const POSES_AT_A_TIME: usize = 16;

/// Poses the mesh of a rig repeatedly, with prepared weights and a workspace for transforms.
///
/// Created by `Rig.posing`; usable from any number of threads.
#[pyclass(frozen, module = "kinopt")]
pub(crate) struct RigPosing {
    /// The rig of the mesh.
    #[pyo3(get)]
    rig: Py<Rig>,
    method: SkinningMethod,
    posings: Pool<kinopt::io::rig::RigPosing<Arc<kinopt::io::rig::Rig>>>,
}

impl RigPosing {
    pub(super) fn make(rig: &Bound<'_, Rig>, method: SkinningMethod) -> PyResult<Self> {
        let owned = Arc::clone(&rig.get().inner);
        let posing = rig
            .py()
            .detach(|| kinopt::io::rig::RigPosing::new(owned, method));
        Ok(Self {
            posings: Pool::new(posing.or_raise()?),
            rig: rig.clone().unbind(),
            method,
        })
    }

    fn each_pose<'py>(
        &self,
        py: Python<'py>,
        q: &Bound<'py, PyAny>,
        out: Option<&Bound<'py, PyAny>>,
        part: Part,
    ) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        let rig = &self.rig.get().inner;
        let q = Queries::rows(q, "q", rig.skeleton.angles())?;
        let vertices = rig.mesh.as_ref().map_or(0, |mesh| part.count(mesh));
        self.posings.with(|posing| {
            q.compute((py, out), &[vertices, 3], POSES_AT_A_TIME, |q, buffer| {
                posing.deform(q, part.of(buffer)).or_raise()
            })
        })
    }
}

#[pymethods]
impl RigPosing {
    /// Skinning method: "lbs" or "dqs".
    #[getter]
    fn method(&self) -> &'static str {
        self.method.name()
    }

    /// True if the rig has no weights of its own, so automatic weights by distance apply.
    #[getter]
    fn has_automatic_weights(&self) -> bool {
        self.rig.get().inner.weights.is_none()
    }

    /// Positions of the vertices in the unit of the rig, float32. They have shape (V, 3) for `q` of shape (3 * bones,),
    /// radians, and (N, V, 3) for `q` of shape (N, 3 * bones). `out`, a float32 array of that shape, receives the
    /// result.
    ///
    /// Raises `InvalidValueError` for another number of angles or one that is not finite.
    #[pyo3(signature = (q, *, out = None))]
    fn positions<'py>(
        &self,
        py: Python<'py>,
        q: &Bound<'py, PyAny>,
        out: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        self.each_pose(py, q, out, Part::Positions)
    }

    /// Unit normals of the vertices, float32, with the shapes of `positions`; (0, 3) for a mesh without normals.
    ///
    /// Raises as `positions`.
    #[pyo3(signature = (q, *, out = None))]
    fn normals<'py>(
        &self,
        py: Python<'py>,
        q: &Bound<'py, PyAny>,
        out: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        self.each_pose(py, q, out, Part::Normals)
    }

    /// The mesh for `q`, shape (3 * bones,), radians: positions, and normals if the mesh has them.
    ///
    /// Raises `InvalidValueError` for another number of angles or one that is not finite.
    fn mesh(&self, py: Python<'_>, q: &Bound<'_, PyAny>) -> PyResult<TriangleMesh> {
        let angles = self.rig.get().inner.skeleton.angles();
        let q = arrays::vector_of(q, "q", angles)?;
        let q: &[f64] = &q;
        let posed = py.detach(|| self.posings.with(|posing| posing.mesh(q)));
        posed.or_raise().map(TriangleMesh::from)
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        pickling::by_method(self.rig.bind(py).as_any(), "posing", (self.method(),))
    }

    fn __repr__(&self) -> String {
        format!("RigPosing({:?})", self.method.name())
    }
}
