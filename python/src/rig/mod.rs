//! Rigs: a skeleton with its mesh, keyframes and pinned tips.

mod posing;

use std::path::PathBuf;
use std::sync::{Arc, OnceLock};

use kinopt::collision::Checker;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyType};

pub(crate) use self::posing::RigPosing;
use crate::animation::EulerClip;
use crate::contents::{parsed, text_or_bytes};
use crate::error::{OrRaise, invalid};
use crate::file_access::access;
use crate::masses::{DENSITY, by_frame, centres};
use crate::mesh::TriangleMesh;
use crate::model::Model;
use crate::pickling;
use crate::skeleton::Skeleton;
use crate::skinning::SkinWeights;

/// A skeleton with its mesh, keyframes and pinned tips, in a length unit of its own.
///
/// A rig of its parts. `weights` have a vertex for each of the mesh's and a bone for each of the skeleton's. `clip` is
/// of this skeleton. `constrained` are the names of bones with pinned tips.
///
/// Raises `InvalidValueError` for parts that do not match, `UnknownNameError` for an unknown bone.
#[pyclass(frozen, module = "kinopt")]
pub(crate) struct Rig {
    pub(crate) inner: Arc<kinopt::io::rig::Rig>,
    skeleton: Py<Skeleton>,
    mesh: Option<Py<TriangleMesh>>,
    weights: Option<Py<SkinWeights>>,
    clip: Py<EulerClip>,
    /// Collision checker of the capsules along its bones, created at the first use.
    checker: OnceLock<Checker>,
}

impl Rig {
    /// Returns the collision checker of the capsules along its bones, in a world without obstacles; created once.
    pub(crate) fn checker(&self) -> PyResult<Checker> {
        if let Some(known) = self.checker.get() {
            return Ok(known.clone());
        }
        let rig = &self.inner;
        let (Some(mesh), Some(weights)) = (&rig.mesh, &rig.weights) else {
            return Err(invalid(
                "world and margin need a rig with a mesh and weights, or a collision_model",
            ));
        };
        let shapes = kinopt::motion::skin_capsules(&rig.skeleton, mesh, weights).or_raise()?;
        Ok((self.checker.get_or_init(|| Checker::covered(shapes))).clone())
    }

    fn of(py: Python<'_>, rig: kinopt::io::rig::Rig) -> PyResult<Self> {
        let skeleton = Arc::new(rig.skeleton.clone());
        let clip = EulerClip {
            inner: Arc::new(rig.clip.clone()),
            skeleton: Arc::clone(&skeleton),
        };
        let mesh = rig.mesh.clone().map(TriangleMesh::from);
        let weights = rig.weights.clone().map(SkinWeights::from);
        Ok(Self {
            inner: Arc::new(rig),
            skeleton: Py::new(py, Skeleton::from(skeleton))?,
            mesh: mesh.map(|mesh| Py::new(py, mesh)).transpose()?,
            weights: weights.map(|weights| Py::new(py, weights)).transpose()?,
            clip: Py::new(py, clip)?,
            checker: OnceLock::new(),
        })
    }
}

#[pymethods]
impl Rig {
    #[new]
    #[pyo3(signature = (skeleton, mesh = None, weights = None, clip = None, constrained = Vec::new()))]
    fn new(
        py: Python<'_>,
        skeleton: &Bound<'_, Skeleton>,
        mesh: Option<&Bound<'_, TriangleMesh>>,
        weights: Option<&Bound<'_, SkinWeights>>,
        clip: Option<&Bound<'_, EulerClip>>,
        constrained: Vec<String>,
    ) -> PyResult<Self> {
        let skeleton = &skeleton.get().inner;
        let bones = skeleton.bones().len();
        if let Some(weights) = weights {
            let weights = &weights.get().inner;
            let vertices = mesh.map_or(0, |mesh| mesh.get().inner.positions().len());
            if weights.bone_count() != bones || mesh.is_some() && weights.vertex_count() != vertices
            {
                return Err(invalid(format!(
                    "weights are of {} vertices and {} bones, but the rig has {vertices} and {bones}",
                    weights.vertex_count(),
                    weights.bone_count()
                )));
            }
        }
        let clip = match clip {
            Some(clip) if clip.get().skeleton.bones().len() != bones => {
                return Err(invalid("clip is of another skeleton"));
            }
            Some(clip) => kinopt::animation::EulerClip::clone(&clip.get().inner),
            None => kinopt::animation::EulerClip::default(),
        };
        let constrained = constrained
            .iter()
            .map(|name| skeleton.bone(name).or_raise());
        let rig = kinopt::io::rig::Rig {
            constrained: constrained.collect::<PyResult<_>>()?,
            skeleton: kinopt::Skeleton::clone(skeleton),
            mesh: mesh.map(|mesh| kinopt::mesh::TriangleMesh::clone(&mesh.get().inner)),
            weights: weights.map(|w| kinopt::skinning::SkinWeights::clone(&w.get().inner)),
            clip,
            notes: Vec::new(),
        };
        Self::of(py, rig)
    }

    /// Reads the JSON file of a rig, with its mesh (PLY) and weights (DMAT).
    ///
    /// Referenced files are opened only below its folder and below `folders`, with symbolic links resolved. Files above
    /// `max_bytes` are not read.
    ///
    /// Raises `FileError` if a file cannot be opened, `InvalidFileError` with the file and the position in it if its
    /// content is invalid.
    #[classmethod]
    #[pyo3(
        signature = (path, *, folders = Vec::new(), max_bytes = 1_073_741_824),
        text_signature = "(path, *, folders=[], max_bytes=1073741824)"
    )]
    fn read(
        class: &Bound<'_, PyType>,
        path: PathBuf,
        folders: Vec<PathBuf>,
        max_bytes: u64,
    ) -> PyResult<Self> {
        let (py, access) = (class.py(), access(folders, max_bytes));
        let read = || kinopt::io::rig::Rig::read_with(&path, &access);
        let rig = py.detach(read).or_raise()?;
        Self::of(py, rig)
    }

    /// Reads a rig from its JSON, a text or bytes; `name` is its name in messages.
    ///
    /// `open` is called with the file names of the mesh and weights in the JSON, and returns their bytes: for example
    /// `dict.__getitem__` of a dictionary. Without `open`, the rig has no such files.
    ///
    /// Raises `InvalidFileError` with the position in the JSON. Exceptions of `open` propagate; its `FileNotFoundError`
    /// or `KeyError` is a missing file.
    #[classmethod]
    #[pyo3(signature = (json, name = "rig.json", open = None))]
    fn parse(
        class: &Bound<'_, PyType>,
        json: &Bound<'_, PyAny>,
        name: &str,
        open: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let json = text_or_bytes(json, "json")?;
        let rig = parsed(open, |open| kinopt::io::rig::Rig::parse(&json, name, open))?;
        Self::of(class.py(), rig)
    }

    /// Writes the rig to `path`, a JSON file, and its mesh and weights next to it under its name with the extensions
    /// ply and dmat. It reads back exactly, except for angles without an exact conversion to degrees.
    ///
    /// Raises `FileError`, and `InvalidValueError` for a name that the format cannot represent.
    fn write(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        py.detach(|| self.inner.write(&path)).or_raise()
    }

    /// The JSON of the rig, with these names of the mesh file and the weights file.
    ///
    /// Raises `InvalidValueError` for a name that the format cannot represent.
    #[pyo3(signature = (model_file = "rig.ply", weights_file = "rig.dmat"))]
    fn to_json(&self, model_file: &str, weights_file: &str) -> String {
        self.inner.to_json(model_file, weights_file)
    }

    /// Bones of the rig.
    #[getter]
    fn skeleton(&self, py: Python<'_>) -> Py<Skeleton> {
        self.skeleton.clone_ref(py)
    }

    /// Compiled model of the bones; problems use it.
    #[getter]
    fn model(&self) -> Model {
        self.skeleton.get().model()
    }

    /// Mesh at rest; None for bones alone.
    #[getter]
    fn mesh(&self, py: Python<'_>) -> Option<Py<TriangleMesh>> {
        self.mesh.as_ref().map(|mesh| mesh.clone_ref(py))
    }

    /// Skin weights; None if the file has none.
    #[getter]
    fn weights(&self, py: Python<'_>) -> Option<Py<SkinWeights>> {
        self.weights.as_ref().map(|weights| weights.clone_ref(py))
    }

    /// Keyframes; empty if the file has none.
    #[getter]
    fn clip(&self, py: Python<'_>) -> Py<EulerClip> {
        self.clip.clone_ref(py)
    }

    /// Names of the bones with pinned tips.
    #[getter]
    fn constrained(&self) -> Vec<&str> {
        let bones = self.inner.skeleton.bones();
        let ids = self.inner.constrained.iter();
        ids.map(|id| bones[id.index()].name.as_str()).collect()
    }

    /// Omissions and repairs of the reader, one text each.
    #[getter]
    fn notes(&self) -> Vec<String> {
        self.inner.notes.iter().map(ToString::to_string).collect()
    }

    /// Workspace for repeated poses of the mesh by `method`: "lbs" (linear blend) or "dqs" (dual quaternions). A mesh
    /// without weights gets automatic weights by distance.
    ///
    /// Raises `InvalidValueError` without a mesh.
    #[pyo3(signature = (method = "lbs"))]
    fn posing(slf: &Bound<'_, Self>, method: &str) -> PyResult<RigPosing> {
        RigPosing::make(slf, crate::skinning::method(method)?)
    }

    /// The mesh in the pose of the stacked angles `q`, shape (3 * bones,), radians. For several poses or an output
    /// array, use `posing`.
    ///
    /// Raises `InvalidValueError` without a mesh, for another size of `q`, and for angles that are not finite.
    #[pyo3(signature = (q, method = "lbs"))]
    fn posed_mesh(
        &self,
        py: Python<'_>,
        q: &Bound<'_, PyAny>,
        method: &str,
    ) -> PyResult<TriangleMesh> {
        let method = crate::skinning::method(method)?;
        let q = crate::arrays::vector_of(q, "q", self.inner.skeleton.angles())?;
        let q: &[f64] = &q;
        py.detach(|| self.inner.posed_mesh(q, method))
            .or_raise()
            .map(TriangleMesh::from)
    }

    /// Mass of each bone by the volume of the mesh, at 1000 kg a cubic metre. The result is {"frame": (kg, (x, y, z))},
    /// with the centre in the frame's coordinates. Tasks of a skeleton of these bones on ball joints can use it:
    /// `masses=rig.masses`.
    ///
    /// Raises `InvalidValueError` as `center_of_mass`.
    #[getter]
    fn masses<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let masses = py.detach(|| self.inner.masses(DENSITY)).or_raise()?;
        by_frame(py, self.inner.skeleton.model(), &masses)
    }

    /// Centre of mass: shape (3,) for a configuration `q` of shape (nq,), (N, 3) for (N, nq); in the rig's unit.
    ///
    /// Each bone has the volume of its part of the mesh, with uniform density. Raises `InvalidValueError` without a
    /// mesh, for a mesh that encloses no volume, and for other shapes.
    fn center_of_mass<'py>(&self, q: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        let masses = q.py().detach(|| self.inner.masses(DENSITY)).or_raise()?;
        centres(q, self.inner.skeleton.model(), &masses)
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let notes = self.inner.notes.iter().map(|note| match note {
            kinopt::io::rig::RigNote::NoWeightsFile { file } => file.as_str(),
            _ => "",
        });
        let notes: Vec<&str> = notes.collect();
        let parts = (
            self.skeleton(py),
            self.mesh(py),
            self.weights(py),
            self.clip(py),
            self.constrained(),
            notes,
        );
        pickling::by_rebuild::<Self>(py, parts)
    }

    #[staticmethod]
    fn _rebuild(
        py: Python<'_>,
        skeleton: &Bound<'_, Skeleton>,
        mesh: Option<&Bound<'_, TriangleMesh>>,
        weights: Option<&Bound<'_, SkinWeights>>,
        clip: Option<&Bound<'_, EulerClip>>,
        constrained: Vec<String>,
        notes: Vec<String>,
    ) -> PyResult<Self> {
        let rig = Self::new(py, skeleton, mesh, weights, clip, constrained)?;
        let mut inner = kinopt::io::rig::Rig::clone(&rig.inner);
        let note = |file| kinopt::io::rig::RigNote::NoWeightsFile { file };
        inner.notes = notes.into_iter().map(note).collect();
        let inner = Arc::new(inner);
        Ok(Self { inner, ..rig })
    }

    fn __repr__(&self) -> String {
        let mesh = self.inner.mesh.as_ref();
        format!(
            "Rig({} bones, {} vertices{})",
            self.inner.skeleton.bones().len(),
            mesh.map_or(0, |mesh| mesh.positions().len()),
            match self.inner.weights {
                Some(_) => "",
                None => ", no weights",
            }
        )
    }
}
