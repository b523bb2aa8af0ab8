//! glTF files with lossless editing.

use std::path::PathBuf;

use kinopt::io::gltf;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyType};

use super::{Scene, options};
use crate::animation::{Clip, Pose};
use crate::contents::{parsed, text_or_bytes};
use crate::error::OrRaise;
use crate::file_access::access;

/// A .glb or .gltf file, with its scene.
///
/// Clips can be added and nodes posed. All other content (materials, textures, images, texture coordinates, colours,
/// cameras, extras, extensions) keeps its text and bytes.
#[pyclass(module = "kinopt")]
pub(crate) struct SceneFile {
    pub(crate) inner: gltf::SceneFile,
}

#[pymethods]
impl SceneFile {
    /// Reads a .glb or .gltf file and its buffers. `write` reads images from these `folders` too.
    ///
    /// Referenced files are opened only below its folder and below `folders`, with symbolic links resolved. Files above
    /// `max_bytes` are not read.
    ///
    /// Raises as `Scene.read`.
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
        let read = || gltf::SceneFile::read_with(&path, &access);
        let inner = class.py().detach(read).or_raise()?;
        Ok(Self { inner })
    }

    /// Reads the bytes of a .glb or .gltf file, or the text of a .gltf; `name` is its name in messages. `open` is
    /// called with the names of buffer files and returns their bytes.
    ///
    /// Raises as `Scene.from_bytes`.
    #[classmethod]
    #[pyo3(signature = (data, name = "scene.gltf", open = None))]
    fn from_bytes(
        _class: &Bound<'_, PyType>,
        data: &Bound<'_, PyAny>,
        name: &str,
        open: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let data = text_or_bytes(data, "data")?;
        let inner = parsed(open, |open| gltf::SceneFile::from_bytes(&data, name, open))?;
        Ok(Self { inner })
    }

    /// Scene of the file, with the added clips.
    #[getter]
    fn scene(&self) -> Scene {
        self.inner.scene().clone().into()
    }

    /// Appends a clip. Curves without a glTF equivalent become `keys_per_second` keys.
    ///
    /// Raises `InvalidValueError` for a clip of another armature and for a name that another clip of the file has.
    #[pyo3(signature = (clip, keys_per_second = 30.0))]
    fn add_clip(&mut self, clip: &Bound<'_, Clip>, keys_per_second: f32) -> PyResult<()> {
        let added = self.inner.add_clip(
            &clip.get().inner,
            &options(keys_per_second, [0.0, 1.0, 0.0]),
        );
        added.or_raise()
    }

    /// Sets the rest pose of the nodes.
    ///
    /// Raises `InvalidValueError` for a pose of another armature.
    fn set_rest(&mut self, pose: &Bound<'_, Pose>) -> PyResult<()> {
        self.inner.set_rest(&pose.get().now()).or_raise()
    }

    /// Writes a .glb or .gltf file. In another folder than that of the original, referenced files (images, buffers) are
    /// embedded; a missing one stays a reference.
    ///
    /// Raises `FileError`.
    fn write(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        py.detach(|| self.inner.write(&path)).or_raise()
    }

    /// Bytes of the file: .glb if the original is, else the text of a .gltf. Other files stay references.
    ///
    /// Raises `InvalidValueError` beyond 4 GiB, the limit of .glb.
    fn to_bytes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let bytes = py.detach(|| self.inner.to_bytes()).or_raise()?;
        Ok(PyBytes::new(py, &bytes))
    }

    fn __repr__(&self) -> String {
        let scene = self.inner.scene();
        format!(
            "SceneFile({} bones, {} clips)",
            scene.armature.bones(),
            scene.clips.len()
        )
    }
}
