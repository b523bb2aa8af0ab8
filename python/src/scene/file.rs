//! A file of a scene that keeps what it holds.

use std::path::PathBuf;

use kinopt::io::gltf;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyType};

use super::{Scene, options};
use crate::animation::{Clip, Pose};
use crate::contents::{parsed, text_or_bytes};
use crate::error::OrRaise;
use crate::file_access::access;

/// A .glb or .gltf file as it was read, with the scene in it.
///
/// Clips are added to it and its nodes posed; everything else, also what nothing here understands (materials, textures, images, texture
/// coordinates, colours, cameras, extras, extensions), stays the text and the bytes that were read.
#[pyclass(module = "kinopt")]
pub(crate) struct SceneFile {
    inner: gltf::SceneFile,
}

#[pymethods]
impl SceneFile {
    /// Reads a .glb or .gltf file and its buffers. `write` opens images by the same `folders`.
    ///
    /// The files that it names are opened only below its own folder and below `folders`, symbolic links followed. No file above
    /// `max_bytes` is read.
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

    /// Reads the bytes of a .glb or .gltf file, or the text of a .gltf; `name` is what messages call it. `open` is called with the names of
    /// buffers beside the file and gives their bytes.
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

    /// What in it can be posed, with the clips that were added.
    #[getter]
    fn scene(&self) -> Scene {
        self.inner.scene().clone().into()
    }

    /// Adds a clip behind those that are there. Curves that glTF does not have become `keys_per_second` keys.
    ///
    /// Raises `InvalidValueError` for a clip of another armature and for a name that one of the file's clips has.
    #[pyo3(signature = (clip, keys_per_second = 30.0))]
    fn add_clip(&mut self, clip: &Bound<'_, Clip>, keys_per_second: f32) -> PyResult<()> {
        let added = self.inner.add_clip(
            &clip.get().inner,
            &options(keys_per_second, [0.0, 1.0, 0.0]),
        );
        added.or_raise()
    }

    /// Makes a pose the one that the nodes have where no clip moves them.
    ///
    /// Raises `InvalidValueError` for a pose of another armature.
    fn set_rest(&mut self, pose: &Bound<'_, Pose>) -> PyResult<()> {
        self.inner.set_rest(&pose.get().now()).or_raise()
    }

    /// Writes it to a .glb or .gltf file. In another folder than it was read from, the files beside it that it names (images, buffers) are
    /// put into it; one that does not exist stays named.
    ///
    /// Raises `FileError`.
    fn write(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        py.detach(|| self.inner.write(&path)).or_raise()
    }

    /// Its bytes: .glb where that was read, else the text of a .gltf. Other files that it names are still named.
    ///
    /// Raises `InvalidValueError` beyond 4 GiB, which .glb cannot have.
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
