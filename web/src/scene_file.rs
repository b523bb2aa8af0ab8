//! glTF files with lossless editing.

use std::rc::Rc;

use kinopt::io::gltf::{self, WriteOptions};
use wasm_bindgen::prelude::*;

use crate::armature::Armature;
use crate::clip::Clip;
use crate::contents::{self, Open};
use crate::error::{Exception, raise};

/// A glTF file to which clips can be added. All other content, including materials and unknown data, does not change.
#[wasm_bindgen]
pub struct SceneFile {
    inner: gltf::SceneFile,
    armature: Armature,
}

#[wasm_bindgen]
impl SceneFile {
    /// Reads the bytes of a `.glb` or `.gltf` file; `name` is its name in messages. `open` returns its referenced
    /// files.
    #[wasm_bindgen(js_name = fromBytes)]
    pub fn from_bytes(
        data: &[u8],
        name: Option<String>,
        open: Option<Open>,
    ) -> Result<Self, JsValue> {
        let name = name.as_deref().unwrap_or("scene.gltf");
        let inner = contents::parsed(open, |open| gltf::SceneFile::from_bytes(data, name, open))?;
        let armature = Armature {
            inner: Rc::new(inner.scene().armature.clone()),
        };
        Ok(Self { inner, armature })
    }

    /// Armature for clips: every node of the file is a bone.
    #[wasm_bindgen(getter)]
    pub fn armature(&self) -> Armature {
        self.armature.clone()
    }

    /// Names of its clips.
    #[wasm_bindgen(getter, js_name = clipNames)]
    pub fn clip_names(&self) -> Vec<String> {
        let clips = self.inner.scene().clips.iter();
        clips.map(|clip| clip.name().to_owned()).collect()
    }

    /// Appends a clip.
    #[wasm_bindgen(js_name = addClip)]
    pub fn add_clip(&mut self, clip: &Clip) -> Result<(), Exception> {
        let added = self.inner.add_clip(clip.inner(), &WriteOptions::default());
        added.map_err(raise)
    }

    /// Bytes of the file: of a `.glb` if the original is one, else the text of a `.gltf`.
    #[wasm_bindgen(js_name = toBytes)]
    pub fn to_bytes(&self) -> Result<Vec<u8>, Exception> {
        self.inner.to_bytes().map_err(raise)
    }
}
