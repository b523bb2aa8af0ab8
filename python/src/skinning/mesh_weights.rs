//! Prepared skin weights, and skinning.

use std::sync::Arc;

use kinopt::glam::{Affine3A, Vec3, Vec4};
use kinopt::skinning::{
    MeshWeights as Ready, PosedVertices, RestVertices, SkinWeights as Weights, SkinningMethod,
};
use numpy::{PyArray2, PyArrayDyn};
use pyo3::prelude::*;

use super::SkinWeights;
use crate::arrays;
use crate::error::{OrRaise, invalid};
use crate::mesh::TriangleMesh;
use crate::pickling;
use crate::transforms;
use crate::vertices::{tangents, to_array, vectors};

/// Skin weights prepared for several poses. If no vertex has more than four influences, they are packed. Both forms
/// give equal vertices up to rounding.
///
/// `packed` True requires the packed form, which is faster, False the other one (None: automatic).
///
/// With `pivots`, shape (bones, 3), the bones' tails at rest, dual quaternions accept transforms with scale: each bone
/// scales about its pivot.
///
/// Raises `InvalidValueError` if packing is required and a vertex has more than four influences.
#[pyclass(frozen, module = "kinopt.skinning")]
pub(crate) struct MeshWeights {
    inner: Ready,
    weights: Arc<Weights>,
    pivots: Option<Vec<Vec3>>,
    packed: bool,
}

impl MeshWeights {
    /// Reads the transforms of poses, with the number of poses; `None` for a single one.
    fn poses(&self, value: &Bound<'_, PyAny>) -> PyResult<(Vec<Affine3A>, Option<usize>)> {
        let (transforms, leading) = transforms::read(value, "transforms")?;
        let bones = self.weights.bone_count();
        match leading.as_slice() {
            [last] if *last == bones => Ok((transforms, None)),
            [count, last] if *last == bones => Ok((transforms, Some(*count))),
            _ => Err(invalid(format!(
                "transforms are of {} before (4, 4), expected ({bones},) or (N, {bones})",
                arrays::shape_text(&leading)
            ))),
        }
    }

    /// Calls `deform` with each pose's transforms and its part of the output.
    fn each_pose<'py>(
        &self,
        py: Python<'py>,
        transforms: &Bound<'py, PyAny>,
        out: Option<&Bound<'py, PyAny>>,
        columns: usize,
        deform: impl Fn(&[Affine3A], &mut [f32]) -> Result<(), kinopt::skinning::SkinningError> + Sync,
    ) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        let (transforms, count) = self.poses(transforms)?;
        let vertices = self.weights.vertex_count();
        let shape: Vec<usize> = count.into_iter().chain([vertices, columns]).collect();
        let array = arrays::output_array::<f32>(py, out, &shape)?;
        let (bones, width) = (self.weights.bone_count(), vertices * columns);
        arrays::fill(&array, |buffer| {
            for i in 0..count.unwrap_or(1) {
                py.check_signals()?;
                let transforms = &transforms[i * bones..(i + 1) * bones];
                let buffer = &mut buffer[i * width..(i + 1) * width];
                py.detach(|| deform(transforms, buffer)).or_raise()?;
            }
            Ok(())
        })?;
        Ok(array)
    }

    /// Deforms one vector of each vertex for each pose; `vertices` selects the vertex attribute.
    fn each_vector<'py>(
        &self,
        py: Python<'py>,
        (method, transforms, rest): (&str, &Bound<'py, PyAny>, &Bound<'py, PyAny>),
        out: Option<&Bound<'py, PyAny>>,
        vertices: impl for<'a> Fn(&'a [Vec3], &'a mut [Vec3]) -> (RestVertices<'a>, PosedVertices<'a>)
        + Sync,
    ) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        let method: SkinningMethod = super::method(method)?;
        let rest = vectors(rest, "rest")?;
        let at_rest: &[Vec3] = &rest;
        self.each_pose(py, transforms, out, 3, |transforms, buffer| {
            let (rest, posed) = vertices(at_rest, bytemuck::cast_slice_mut(buffer));
            self.inner.deform(method, transforms, rest, posed)
        })
    }
}

#[pymethods]
impl MeshWeights {
    #[new]
    #[pyo3(signature = (weights, *, pivots = None, packed = None))]
    fn new(
        weights: &Bound<'_, SkinWeights>,
        pivots: Option<&Bound<'_, PyAny>>,
        packed: Option<bool>,
    ) -> PyResult<Self> {
        let weights = Arc::clone(&weights.get().inner);
        let inner = match packed {
            Some(false) => Ready::unpacked(Weights::clone(&weights)),
            _ => Ready::from(Weights::clone(&weights)),
        };
        if packed == Some(true) {
            // Its error names the vertex with too many influences.
            kinopt::skinning::PackedWeights::new(&weights).or_raise()?;
        }
        let pivots = match pivots {
            Some(pivots) => Some(vectors(pivots, "pivots")?.to_vec()),
            None => None,
        };
        let inner = match &pivots {
            Some(pivots) => inner.with_pivots(pivots.clone()),
            None => inner,
        };
        Ok(Self {
            packed: inner.is_packed(),
            inner,
            weights,
            pivots,
        })
    }

    /// True if the packed form with four influences is used.
    #[getter]
    fn is_packed(&self) -> bool {
        self.packed
    }

    /// Skin weights.
    #[getter]
    fn weights(&self) -> SkinWeights {
        Arc::clone(&self.weights).into()
    }

    /// Tails of the bones at rest, shape (bones, 3), float32; None without pivots.
    #[getter]
    fn pivots<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyArray2<f32>>>> {
        let pivots = self.pivots.as_ref();
        pivots.map(|pivots| to_array(py, pivots, 3)).transpose()
    }

    /// Skins positions at `rest`, shape (V, 3), by the bones' `transforms`, rest -> posed. The result is float32, shape
    /// (V, 3) for transforms of shape (bones, 4, 4), (N, V, 3) for (N, bones, 4, 4). `method` is "lbs" (linear blend)
    /// or "dqs" (dual quaternions); `out` receives the result.
    ///
    /// Raises `InvalidValueError` for other shapes, numbers that are not finite, and transforms that are not rigid with
    /// dual quaternions and without pivots.
    #[pyo3(signature = (method, transforms, rest, *, out = None))]
    fn positions<'py>(
        &self,
        py: Python<'py>,
        method: &str,
        transforms: &Bound<'py, PyAny>,
        rest: &Bound<'py, PyAny>,
        out: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        self.each_vector(py, (method, transforms, rest), out, |positions, moved| {
            let rest = RestVertices {
                positions,
                ..RestVertices::default()
            };
            let posed = PosedVertices {
                positions: moved,
                ..PosedVertices::default()
            };
            (rest, posed)
        })
    }

    /// Skins normals at `rest`, shape (V, 3), with the arguments of `positions`; the results have unit length.
    ///
    /// Raises as `positions`.
    #[pyo3(signature = (method, transforms, rest, *, out = None))]
    fn normals<'py>(
        &self,
        py: Python<'py>,
        method: &str,
        transforms: &Bound<'py, PyAny>,
        rest: &Bound<'py, PyAny>,
        out: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        self.each_vector(py, (method, transforms, rest), out, |normals, moved| {
            let rest = RestVertices {
                normals,
                ..RestVertices::default()
            };
            let posed = PosedVertices {
                normals: moved,
                ..PosedVertices::default()
            };
            (rest, posed)
        })
    }

    /// Skins tangents at `rest`, shape (V, 4), the sign of the bitangent last, with the arguments of `positions`.
    ///
    /// Raises as `positions`.
    #[pyo3(signature = (method, transforms, rest, *, out = None))]
    fn tangents<'py>(
        &self,
        py: Python<'py>,
        method: &str,
        transforms: &Bound<'py, PyAny>,
        rest: &Bound<'py, PyAny>,
        out: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        let method: SkinningMethod = super::method(method)?;
        let at_rest = tangents(rest, "rest")?;
        self.each_pose(py, transforms, out, 4, |transforms, buffer| {
            let mut posed = vec![Vec4::ZERO; at_rest.len()];
            let rest = RestVertices {
                tangents: &at_rest,
                ..RestVertices::default()
            };
            let buffers = PosedVertices {
                tangents: &mut posed,
                ..PosedVertices::default()
            };
            self.inner.deform(method, transforms, rest, buffers)?;
            for (tangent, buffer) in posed.iter().zip(buffer.chunks_exact_mut(4)) {
                buffer.copy_from_slice(&tangent.to_array());
            }
            Ok(())
        })
    }

    /// The posed mesh: positions, and normals if the mesh has them; `transforms` have shape (bones, 4, 4).
    ///
    /// Raises as `positions`.
    fn mesh(
        &self,
        py: Python<'_>,
        method: &str,
        rest: &Bound<'_, TriangleMesh>,
        transforms: &Bound<'_, PyAny>,
    ) -> PyResult<TriangleMesh> {
        let method = super::method(method)?;
        let transforms = transforms::read_list(transforms, "transforms")?;
        let rest = &rest.get().inner;
        let posed = py.detach(|| self.inner.mesh(method, rest, &transforms));
        posed.or_raise().map(TriangleMesh::from)
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let parts = (self.weights(), self.pivots(py)?, self.packed);
        pickling::by_arguments::<Self>(py, parts, &["pivots", "packed"])
    }

    fn __repr__(&self) -> String {
        format!(
            "MeshWeights({} vertices, {} bones{})",
            self.weights.vertex_count(),
            self.weights.bone_count(),
            if self.packed { ", packed" } else { "" }
        )
    }
}
