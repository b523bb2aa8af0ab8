//! glTF scenes: an armature with its meshes and clips.

mod file;
mod mesh;
mod posing;

use std::path::PathBuf;
use std::sync::Arc;

use kinopt::animation::Armature as Bones;
use kinopt::io::gltf::{self, Note, WriteOptions};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict, PyType};

pub(crate) use self::file::SceneFile;
pub(crate) use self::mesh::{SceneMesh, Skin};
pub(crate) use self::posing::ScenePosing;
use crate::animation::{Armature, Clip};
use crate::contents::{parsed, text_or_bytes};
use crate::error::{OrRaise, invalid};
use crate::file_access::access;
use crate::masses::{DENSITY, by_frame};
use crate::mesh::TriangleMesh;
use crate::pickling;
use crate::skeleton::Skeleton;
use crate::skinning::SkinWeights;

/// Scene of a glTF file: an armature, its meshes and its clips.
///
/// Every node of the file is a bone. Lengths are in the file's unit, metres according to glTF. Tasks need a skeleton:
/// `scene.armature.skeleton()`. `SceneFile` adds clips to a file and keeps its materials.
///
/// A scene of an armature, of meshes on its bones and of clips for it.
///
/// Parts that do not match raise `InvalidValueError` when the scene is posed or written.
#[pyclass(frozen, module = "kinopt")]
pub(crate) struct Scene {
    pub(crate) inner: Arc<gltf::Scene>,
    armature: Arc<Bones>,
    notes: Vec<String>,
}

impl From<gltf::Scene> for Scene {
    fn from(scene: gltf::Scene) -> Self {
        Self {
            armature: Arc::new(scene.armature.clone()),
            notes: scene.notes.iter().map(Note::to_string).collect(),
            inner: Arc::new(scene),
        }
    }
}

fn options(keys_per_second: f32, up: [f32; 3]) -> WriteOptions {
    let mut options = WriteOptions::default();
    options.keys_per_second = keys_per_second;
    options.up = up.into();
    options
}

#[pymethods]
impl Scene {
    #[new]
    #[pyo3(signature = (armature, meshes = Vec::new(), clips = Vec::new()))]
    fn new(
        armature: &Bound<'_, Armature>,
        meshes: Vec<Bound<'_, SceneMesh>>,
        clips: Vec<Bound<'_, Clip>>,
    ) -> Self {
        let scene = gltf::Scene {
            armature: Bones::clone(&armature.get().inner),
            meshes: meshes.iter().map(|mesh| mesh.get().inner.clone()).collect(),
            clips: clips
                .iter()
                .map(|clip| kinopt::animation::Clip::clone(&clip.get().inner))
                .collect(),
            notes: Vec::new(),
        };
        scene.into()
    }

    /// Reads a .glb or .gltf file and its buffers.
    ///
    /// Referenced files are opened only below its folder and below `folders`, with symbolic links resolved. Files above
    /// `max_bytes` are not read.
    ///
    /// Raises `FileError` if a file cannot be opened, `InvalidFileError` with the file, a path in it such as
    /// `animations[1].samplers[0]`, and the node, mesh or animation.
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
        let access = access(folders, max_bytes);
        let scene = class.py().detach(|| gltf::read_with(&path, &access));
        scene.or_raise().map(Self::from)
    }

    /// Reads a scene from the bytes of a .glb or .gltf file, or from the text of a .gltf; `name` is its name in
    /// messages.
    ///
    /// `open` is called with the names of buffers below the file's folder and returns their bytes: for example
    /// `dict.__getitem__` of a dictionary. Names outside that folder raise `InvalidFileError`.
    ///
    /// Raises `InvalidFileError`. Exceptions of `open` propagate; its `FileNotFoundError` or `KeyError` is a missing
    /// file.
    #[classmethod]
    #[pyo3(signature = (data, name = "scene.gltf", open = None))]
    fn from_bytes(
        _class: &Bound<'_, PyType>,
        data: &Bound<'_, PyAny>,
        name: &str,
        open: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let data = text_or_bytes(data, "data")?;
        let scene = parsed(open, |open| gltf::from_bytes(&data, name, open))?;
        Ok(scene.into())
    }

    /// Mass of each bone by the volume of all meshes, at 1000 kg a cubic metre, as `Rig.masses`. Overlapping meshes count
    /// once, and open parts such as clothes do not count. Balance tasks use it: `masses=scene.masses`.
    ///
    /// Raises `InvalidValueError` without a mesh, and for meshes that are mostly open.
    #[getter]
    fn masses<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let scene = &self.inner;
        let skeleton = scene
            .armature
            .turning_skeleton("scene", &scene.turning_bones());
        let skeleton = skeleton.or_raise()?;
        let masses = py.detach(|| scene.masses(&skeleton, DENSITY)).or_raise()?;
        by_frame(py, skeleton.model(), &masses)
    }

    /// A scene of a skeleton, optionally with a `mesh` skinned by `weights`, whose columns are the bones. Bones keep
    /// their names and order; the mesh is on an additional bone after them. `clips` are for an armature of these bones.
    ///
    /// Raises `InvalidValueError` for a mesh without weights or weights that do not match.
    #[staticmethod]
    #[pyo3(signature = (skeleton, mesh = None, weights = None))]
    fn of_skeleton(
        skeleton: &Bound<'_, Skeleton>,
        mesh: Option<&Bound<'_, TriangleMesh>>,
        weights: Option<&Bound<'_, SkinWeights>>,
    ) -> PyResult<Self> {
        let skin = match (mesh, weights) {
            (Some(mesh), Some(weights)) => Some((&*mesh.get().inner, &*weights.get().inner)),
            (None, None) => None,
            _ => return Err(invalid("a mesh and its weights must be given together")),
        };
        let scene = gltf::Scene::of_skeleton(&skeleton.get().inner, skin);
        scene.or_raise().map(Self::from)
    }

    /// Writes the scene to a file, which should end in .glb. Curves without a glTF equivalent become `keys_per_second`
    /// keys.
    ///
    /// `up` is the upward axis of the scene. If it is not glTF's y, an additional root node rotates the scene.
    ///
    /// Raises `FileError`, and `InvalidValueError` for parts that do not match and for an `up` of zero length.
    #[pyo3(signature = (path, keys_per_second = 30.0, *, up = [0.0, 1.0, 0.0]))]
    fn write(
        &self,
        py: Python<'_>,
        path: PathBuf,
        keys_per_second: f32,
        up: [f32; 3],
    ) -> PyResult<()> {
        let options = options(keys_per_second, up);
        py.detach(|| gltf::write(&self.inner, &options, &path))
            .or_raise()
    }

    /// The bytes of a .glb file of the scene, with the arguments of `write`.
    ///
    /// Raises `InvalidValueError` for parts that do not match.
    #[pyo3(signature = (keys_per_second = 30.0, *, up = [0.0, 1.0, 0.0]))]
    fn to_bytes<'py>(
        &self,
        py: Python<'py>,
        keys_per_second: f32,
        up: [f32; 3],
    ) -> PyResult<Bound<'py, PyBytes>> {
        let options = options(keys_per_second, up);
        let bytes = py
            .detach(|| gltf::to_bytes(&self.inner, &options))
            .or_raise()?;
        Ok(PyBytes::new(py, &bytes))
    }

    /// Armature: every node of the file is a bone; with the morph targets of all meshes.
    #[getter]
    fn armature(&self) -> Armature {
        Arc::clone(&self.armature).into()
    }

    /// Meshes, with their bones.
    #[getter]
    fn meshes(&self) -> Vec<SceneMesh> {
        let scene_mesh = |mesh: &gltf::SceneMesh| SceneMesh::of(&self.armature, mesh.clone());
        self.inner.meshes.iter().map(scene_mesh).collect()
    }

    /// Animation clips.
    #[getter]
    fn clips(&self) -> Vec<Clip> {
        let clips = self.inner.clips.iter();
        clips
            .map(|clip| Clip::of(&self.armature, Arc::new(clip.clone())))
            .collect()
    }

    /// Returns a clip by its name, or by the end of its name: "Walk" finds "Armature|Walk".
    ///
    /// Raises `UnknownNameError`, and `InvalidValueError` if several clips match.
    fn clip(&self, name: &str) -> PyResult<Clip> {
        let clip = self.inner.clip(name).or_raise()?;
        Ok(Clip::of(&self.armature, Arc::new(clip.clone())))
    }

    /// Changes and omissions of the reader, one text each. `SceneFile` keeps the omitted content in the file.
    #[getter]
    fn notes(&self) -> Vec<String> {
        self.notes.clone()
    }

    /// Workspace for repeated poses of the meshes, with the skinning `method` "lbs" or "dqs".
    ///
    /// Raises `InvalidValueError` for parts of a mesh that do not match.
    #[pyo3(signature = (method = "lbs"))]
    fn posing(slf: &Bound<'_, Self>, method: &str) -> PyResult<ScenePosing> {
        ScenePosing::make(slf, crate::skinning::method(method)?)
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let parts = (self.armature(), self.meshes(), self.clips(), self.notes());
        pickling::by_rebuild::<Self>(py, parts)
    }

    #[staticmethod]
    fn _rebuild(
        armature: &Bound<'_, Armature>,
        meshes: Vec<Bound<'_, SceneMesh>>,
        clips: Vec<Bound<'_, Clip>>,
        notes: Vec<String>,
    ) -> Self {
        let scene = Self::new(armature, meshes, clips);
        Self { notes, ..scene }
    }

    fn __repr__(&self) -> String {
        format!(
            "Scene({} bones, {} meshes, {} clips)",
            self.armature.bones(),
            self.inner.meshes.len(),
            self.inner.clips.len()
        )
    }
}
