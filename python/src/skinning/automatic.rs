//! Automatic skin weights: by distance, and by bone heat.

use kinopt::glam::DVec3;
use kinopt::skinning::{AutomaticWeights as ByDistance, HeatWeights as ByHeat, SkinningError};
use numpy::ndarray::Ix3;
use pyo3::prelude::*;

use super::SkinWeights;
use crate::arrays::{self, Numbers, shape_text};
use crate::error::{OrRaise, invalid};
use crate::mesh::TriangleMesh;
use crate::pickling;
use crate::skeleton::Skeleton;

/// Weights by distance: the influence of a bone decreases with distance and is smoothed over the surface. Distances are
/// straight lines, also across gaps; `HeatWeights` follow the surface.
///
/// `falloff` is the exponent of the decrease with distance, above 0. `smoothing_steps` is the number of smoothing steps
/// over the mesh's edges, `most` the largest number of influences of a vertex, at least 1.
///
/// Raises `InvalidValueError` for counts below 0; other options out of range raise when weights are computed.
#[pyclass(frozen, module = "kinopt.skinning")]
pub(crate) struct AutomaticWeights {
    inner: ByDistance,
}

/// Bone heat weights: they blend smoothly from bone to bone along the surface, never across gaps.
///
/// `heat` is the heat of bones, above 0; larger values are stiffer. `most` is the largest number of influences of a
/// vertex, at least 1.
///
/// Raises `InvalidValueError` for a `most` below 0; other options out of range raise when weights are computed.
#[pyclass(frozen, module = "kinopt.skinning")]
pub(crate) struct HeatWeights {
    inner: ByHeat,
}

/// Reads bones as [tail, tip].
fn segments(value: &Bound<'_, PyAny>) -> PyResult<Vec<[DVec3; 2]>> {
    let numbers: Numbers<'_, Ix3> = arrays::numbers(value, "segments", "(bones, 2, 3)")?;
    if numbers.shape()[1..] != [2, 3] {
        return Err(invalid(format!(
            "segments has shape {}, expected (bones, 2, 3)",
            shape_text(numbers.shape())
        )));
    }
    let bones = numbers.chunks_exact(6);
    Ok(bones
        .map(|bone| [DVec3::from_slice(&bone[..3]), DVec3::from_slice(&bone[3..])])
        .collect())
}

/// Computes weights without the GIL.
fn compute_weights(
    py: Python<'_>,
    make: impl FnOnce() -> Result<kinopt::skinning::SkinWeights, SkinningError> + Send,
) -> PyResult<SkinWeights> {
    py.detach(make).or_raise().map(SkinWeights::from)
}

#[pymethods]
impl AutomaticWeights {
    #[new]
    #[pyo3(signature = (*, falloff = 4.0, smoothing_steps = 10, most = 8))]
    fn new(
        falloff: f64,
        #[pyo3(from_py_with = crate::arrays::whole)] smoothing_steps: u32,
        #[pyo3(from_py_with = crate::arrays::whole)] most: usize,
    ) -> Self {
        let mut inner = ByDistance::default();
        inner.falloff = falloff;
        inner.smoothing_steps = smoothing_steps;
        inner.most = most;
        Self { inner }
    }

    /// Computes weights of a mesh for the bones of a skeleton at rest, in one frame and unit.
    ///
    /// Raises `InvalidValueError` for a skeleton without bones and for options out of range.
    fn for_skeleton(
        &self,
        py: Python<'_>,
        mesh: &Bound<'_, TriangleMesh>,
        skeleton: &Bound<'_, Skeleton>,
    ) -> PyResult<SkinWeights> {
        let (mesh, skeleton) = (&mesh.get().inner, &skeleton.get().inner);
        compute_weights(py, || self.inner.for_skeleton(mesh, skeleton))
    }

    /// Computes weights of a mesh for bones given as tail and tip, shape (bones, 2, 3).
    ///
    /// Raises `InvalidValueError` without bones, for an end that is not finite, and for options out of range.
    fn for_segments(
        &self,
        py: Python<'_>,
        mesh: &Bound<'_, TriangleMesh>,
        segments: &Bound<'_, PyAny>,
    ) -> PyResult<SkinWeights> {
        let (mesh, segments) = (&mesh.get().inner, self::segments(segments)?);
        compute_weights(py, || self.inner.for_segments(mesh, &segments))
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let ByDistance {
            falloff,
            smoothing_steps,
            most,
            ..
        } = self.inner;
        let parts = (falloff, smoothing_steps, most);
        pickling::by_arguments::<Self>(py, parts, &["falloff", "smoothing_steps", "most"])
    }

    fn __repr__(&self) -> String {
        format!(
            "AutomaticWeights(falloff={}, smoothing_steps={}, most={})",
            self.inner.falloff, self.inner.smoothing_steps, self.inner.most
        )
    }
}

#[pymethods]
impl HeatWeights {
    #[new]
    #[pyo3(signature = (*, heat = 1.0, most = 8))]
    fn new(heat: f64, #[pyo3(from_py_with = crate::arrays::whole)] most: usize) -> Self {
        let mut inner = ByHeat::default();
        inner.heat = heat;
        inner.most = most;
        Self { inner }
    }

    /// Computes weights of a mesh for the bones of a skeleton at rest, in one frame and unit.
    ///
    /// Raises `InvalidValueError` for a skeleton without bones and for options out of range.
    fn for_skeleton(
        &self,
        py: Python<'_>,
        mesh: &Bound<'_, TriangleMesh>,
        skeleton: &Bound<'_, Skeleton>,
    ) -> PyResult<SkinWeights> {
        let (mesh, skeleton) = (&mesh.get().inner, &skeleton.get().inner);
        compute_weights(py, || self.inner.for_skeleton(mesh, skeleton))
    }

    /// Computes weights of a mesh for bones given as tail and tip, shape (bones, 2, 3).
    ///
    /// Raises `InvalidValueError` without bones, for an end that is not finite, for options out of range, or if the
    /// heat equations cannot be solved in double precision.
    fn for_segments(
        &self,
        py: Python<'_>,
        mesh: &Bound<'_, TriangleMesh>,
        segments: &Bound<'_, PyAny>,
    ) -> PyResult<SkinWeights> {
        let (mesh, segments) = (&mesh.get().inner, self::segments(segments)?);
        compute_weights(py, || self.inner.for_segments(mesh, &segments))
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let parts = (self.inner.heat, self.inner.most);
        pickling::by_arguments::<Self>(py, parts, &["heat", "most"])
    }

    fn __repr__(&self) -> String {
        format!(
            "HeatWeights(heat={}, most={})",
            self.inner.heat, self.inner.most
        )
    }
}
