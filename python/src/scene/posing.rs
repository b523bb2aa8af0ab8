//! Repeated poses of a scene's meshes.

use std::sync::Arc;

use kinopt::io::gltf;
use kinopt::skinning::SkinningMethod;
use numpy::{PyArray2, PyArrayDyn, PyArrayMethods};
use pyo3::prelude::*;

use super::Scene;
use crate::animation::{Pose, poses_of};
use crate::arrays;
use crate::error::OrRaise;
use crate::mesh::TriangleMesh;
use crate::pickling;
use crate::pool::Pool;
use crate::vertices::Part;

/// Poses the meshes of a scene repeatedly, with prepared weights and a workspace.
///
/// Created by `Scene.posing`; usable from any number of threads.
#[pyclass(frozen, module = "kinopt")]
pub(crate) struct ScenePosing {
    /// The scene of the meshes.
    #[pyo3(get)]
    scene: Py<Scene>,
    method: SkinningMethod,
    posings: Pool<gltf::ScenePosing<Arc<gltf::Scene>>>,
}

impl ScenePosing {
    pub(super) fn make(scene: &Bound<'_, Scene>, method: SkinningMethod) -> PyResult<Self> {
        let owned = Arc::clone(&scene.get().inner);
        let posing = scene.py().detach(|| gltf::ScenePosing::new(owned, method));
        Ok(Self {
            posings: Pool::new(posing.or_raise()?),
            scene: scene.clone().unbind(),
            method,
        })
    }

    fn each_pose<'py>(
        &self,
        py: Python<'py>,
        pose: &Bound<'py, PyAny>,
        out: Option<&Bound<'py, PyAny>>,
        part: Part,
    ) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        let (poses, count) = poses_of(pose)?;
        let meshes = self.scene.get().inner.meshes.iter();
        let vertices: usize = meshes.map(|mesh| part.count(&mesh.mesh)).sum();
        let shape: Vec<usize> = count.into_iter().chain([vertices, 3]).collect();
        let array = arrays::output_array::<f32>(py, out, &shape)?;
        self.posings.with(|posing| {
            arrays::fill(&array, |buffer| {
                for (i, pose) in poses.iter().enumerate() {
                    py.check_signals()?;
                    let buffer = &mut buffer[i * vertices * 3..(i + 1) * vertices * 3];
                    py.detach(|| posing.deform(pose, part.of(buffer)))
                        .or_raise()?;
                }
                Ok(())
            })
        })?;
        Ok(array)
    }
}

#[pymethods]
impl ScenePosing {
    /// Skinning method: "lbs" or "dqs".
    #[getter]
    fn method(&self) -> &'static str {
        self.method.name()
    }

    /// Triangles over the vertices of all meshes in their order, shape (F, 3), uint32.
    #[getter]
    fn triangles<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<u32>>> {
        let mut first = 0;
        let mut corners = Vec::new();
        for mesh in &self.scene.get().inner.meshes {
            let triangles = mesh.mesh.triangles().iter().flatten();
            corners.extend(triangles.map(|corner| first + corner));
            first += mesh.mesh.positions().len() as u32;
        }
        let count = corners.len() / 3;
        numpy::PyArray1::from_vec(py, corners).reshape([count, 3])
    }

    /// Positions of the vertices of all meshes in their order, in the scene's coordinates. They are float32, shape (V,
    /// 3) for a `Pose` of the scene's armature, (N, V, 3) for `Poses`. `out`, a float32 array of that shape, receives
    /// the result.
    ///
    /// Raises `InvalidValueError` for a pose of another armature.
    #[pyo3(signature = (pose, *, out = None))]
    fn positions<'py>(
        &self,
        py: Python<'py>,
        pose: &Bound<'py, PyAny>,
        out: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        self.each_pose(py, pose, out, Part::Positions)
    }

    /// Unit normals of the meshes with normals, with the shapes of `positions`.
    ///
    /// Raises `InvalidValueError` for a pose of another armature.
    #[pyo3(signature = (pose, *, out = None))]
    fn normals<'py>(
        &self,
        py: Python<'py>,
        pose: &Bound<'py, PyAny>,
        out: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        self.each_pose(py, pose, out, Part::Normals)
    }

    /// The meshes in a pose, in the scene's coordinates.
    ///
    /// Raises `InvalidValueError` for a pose of another armature.
    fn meshes(&self, py: Python<'_>, pose: &Bound<'_, Pose>) -> PyResult<Vec<TriangleMesh>> {
        let pose = pose.get().now();
        let posed = py.detach(|| self.posings.with(|posing| posing.meshes(&pose)));
        Ok(posed
            .or_raise()?
            .into_iter()
            .map(TriangleMesh::from)
            .collect())
    }

    /// The meshes in a pose, merged into one; it has normals if all of them do.
    ///
    /// Raises `InvalidValueError` for a pose of another armature.
    fn mesh(&self, py: Python<'_>, pose: &Bound<'_, Pose>) -> PyResult<TriangleMesh> {
        let pose = pose.get().now();
        let posed = py.detach(|| self.posings.with(|posing| posing.mesh(&pose)));
        posed.or_raise().map(TriangleMesh::from)
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        pickling::by_method(self.scene.bind(py).as_any(), "posing", (self.method(),))
    }

    fn __repr__(&self) -> String {
        format!("ScenePosing({:?})", self.method.name())
    }
}
