//! glTF scenes.

use std::borrow::Borrow;
use std::rc::Rc;

use kinopt::glam::Vec3;
use kinopt::io::gltf;
use kinopt::mesh::TriangleMesh;
use kinopt::skinning::{PosedVertices, SkinningMethod};
use wasm_bindgen::prelude::*;

use crate::armature::{Armature, Pose};
use crate::clip::Clip;
use crate::contents::{self, Open};
use crate::error::{Exception, raise};
use crate::figure::Figure;
use crate::view;

/// Bones, meshes and clips of a glTF file.
#[wasm_bindgen]
pub struct Scene {
    pub(crate) inner: Rc<gltf::Scene>,
    armature: Armature,
}

#[wasm_bindgen]
impl Scene {
    /// Reads the bytes of a `.glb` or `.gltf` file; `name` is its name in messages. `open` returns its referenced
    /// files.
    #[wasm_bindgen(js_name = fromBytes)]
    pub fn from_bytes(
        data: &[u8],
        name: Option<String>,
        open: Option<Open>,
    ) -> Result<Self, JsValue> {
        let name = name.as_deref().unwrap_or("scene.gltf");
        let scene = contents::parsed(open, |open| gltf::from_bytes(data, name, open))?;
        let armature = Armature {
            inner: Rc::new(scene.armature.clone()),
        };
        let inner = Rc::new(scene);
        Ok(Self { inner, armature })
    }

    /// Armature: every node of the file is a bone.
    #[wasm_bindgen(getter)]
    pub fn armature(&self) -> Armature {
        self.armature.clone()
    }

    /// Animation clips.
    #[wasm_bindgen(getter)]
    pub fn clips(&self) -> Vec<Clip> {
        let clips = self.inner.clips.iter();
        clips
            .map(|clip| Clip::new(clip.clone(), &self.armature.inner))
            .collect()
    }

    /// Changes and omissions of the reader.
    #[wasm_bindgen(getter)]
    pub fn notes(&self) -> Vec<String> {
        self.inner.notes.iter().map(ToString::to_string).collect()
    }

    /// A skeleton to drag, with the given pose as its rest pose.
    pub fn figure(&self, pose: &Pose) -> Result<Figure, Exception> {
        let turning = self.inner.turning_bones();
        Figure::standing(&self.armature.inner, &turning, pose)
    }

    /// Workspace for poses of the meshes, by "lbs" (linear blend) or "dqs" (dual quaternions).
    pub fn posing(&self, method: Option<String>) -> Result<ScenePosing, Exception> {
        let method = method.as_deref().unwrap_or("lbs");
        let method: SkinningMethod = method.parse().map_err(raise)?;
        let meshes = &self.inner.meshes;
        let count = |count_of: fn(&TriangleMesh) -> usize| {
            meshes.iter().map(|mesh| count_of(&mesh.mesh)).sum()
        };
        let vertices = count(|mesh| mesh.positions().len());
        // Normals of only some meshes would not match the vertices.
        let normals = match count(|mesh| mesh.normals().len()) {
            all if all == vertices => all,
            _ => 0,
        };
        let scene = Shared(Rc::clone(&self.inner));
        Ok(ScenePosing {
            triangles: triangles(&self.inner),
            posing: gltf::ScenePosing::new(scene, method).map_err(raise)?,
            positions: vec![Vec3::ZERO; vertices],
            normals: vec![Vec3::ZERO; normals],
        })
    }
}

/// Triangles of all meshes, over the vertices of all.
fn triangles(scene: &gltf::Scene) -> Vec<[u32; 3]> {
    let (mut all, mut first) = (Vec::new(), 0);
    for mesh in scene.meshes.iter().map(|scene_mesh| &scene_mesh.mesh) {
        let faces = mesh.triangles().iter();
        all.extend(faces.map(|corners| corners.map(|corner| first + corner)));
        first += mesh.positions().len() as u32;
    }
    all
}

/// A shared scene.
struct Shared(Rc<gltf::Scene>);

impl Borrow<gltf::Scene> for Shared {
    fn borrow(&self) -> &gltf::Scene {
        &self.0
    }
}

/// Poses the meshes of a scene repeatedly, into the module's memory, for views.
#[wasm_bindgen]
pub struct ScenePosing {
    posing: gltf::ScenePosing<Shared>,
    triangles: Vec<[u32; 3]>,
    positions: Vec<Vec3>,
    normals: Vec<Vec3>,
}

#[wasm_bindgen]
impl ScenePosing {
    /// Computes the meshes in a pose.
    pub fn deform(&mut self, pose: &Pose) -> Result<(), Exception> {
        let posed = PosedVertices {
            positions: &mut self.positions,
            normals: &mut self.normals,
            tangents: &mut [],
        };
        self.posing.deform(&pose.inner, posed).map_err(raise)
    }

    /// Vertices of all meshes, three numbers each, as a view: valid until the next call into the module.
    #[wasm_bindgen(getter, unchecked_return_type = "Float32Array")]
    pub fn positions(&self) -> js_sys::Float32Array {
        view::floats(&self.positions)
    }

    /// Unit normals of the vertices, if all meshes have normals.
    #[wasm_bindgen(getter, unchecked_return_type = "Float32Array")]
    pub fn normals(&self) -> js_sys::Float32Array {
        view::floats(&self.normals)
    }

    /// Vertex indices of the triangles of all meshes, three each.
    #[wasm_bindgen(getter)]
    pub fn triangles(&self) -> Vec<u32> {
        self.triangles.as_flattened().to_vec()
    }
}
