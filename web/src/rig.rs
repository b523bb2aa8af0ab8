//! Rigs: a skeleton with its mesh, keyframes and pinned tips.

use std::rc::Rc;

use glam::Vec3;
use kinopt::glam;
use kinopt::skinning::{PosedVertices, SkinningMethod};
use wasm_bindgen::prelude::*;

use crate::armature::Pose;
use crate::contents::{self, Open};
use crate::error::{Exception, raise};
use crate::euler_clip::EulerClip;
use crate::model::Model;
use crate::skeleton::Skeleton;
use crate::view;

/// A skeleton with its mesh, keyframes and pinned tips, in a length unit of its own.
#[wasm_bindgen]
pub struct Rig {
    pub(crate) inner: Rc<kinopt::io::rig::Rig>,
    skeleton: Skeleton,
}

#[wasm_bindgen]
impl Rig {
    /// Reads a rig from the bytes of its JSON file; `name` is its name in messages. `open` returns the bytes of the mesh
    /// and weights files that the JSON names. Missing normals are computed.
    pub fn parse(json: &[u8], name: Option<String>, open: Option<Open>) -> Result<Self, JsValue> {
        let name = name.as_deref().unwrap_or("rig.json");
        let read = |open: &mut dyn FnMut(&str) -> _| kinopt::io::rig::Rig::parse(json, name, open);
        let mut rig = contents::parsed(open, read)?;
        rig.mesh = rig.mesh.map(|mesh| match mesh.normals().is_empty() {
            true => mesh.with_computed_normals(),
            false => mesh,
        });
        Ok(Self {
            skeleton: rig.skeleton.clone().into(),
            inner: Rc::new(rig),
        })
    }

    /// Skeleton of the rig.
    #[wasm_bindgen(getter)]
    pub fn skeleton(&self) -> Skeleton {
        self.skeleton.clone()
    }

    /// Model of the skeleton; problems use it.
    #[wasm_bindgen(getter)]
    pub fn model(&self) -> Model {
        Model {
            rig: Some(Rc::clone(&self.inner)),
            ..self.skeleton.model()
        }
    }

    /// Names of the bones with pinned tips.
    #[wasm_bindgen(getter)]
    pub fn constrained(&self) -> Vec<String> {
        let pinned = self.inner.constrained.iter();
        pinned.map(|bone| self.skeleton.name(*bone)).collect()
    }

    /// Omissions and repairs of the reader.
    #[wasm_bindgen(getter)]
    pub fn notes(&self) -> Vec<String> {
        self.inner.notes.iter().map(ToString::to_string).collect()
    }

    /// Keyframes of the rig.
    #[wasm_bindgen(getter)]
    pub fn clip(&self) -> EulerClip {
        EulerClip::of(&self.inner)
    }

    /// Vertex indices of the mesh's triangles, three each; empty without a mesh.
    #[wasm_bindgen(getter)]
    pub fn triangles(&self) -> Vec<u32> {
        let mesh = self.inner.mesh.as_ref();
        mesh.map_or(&[][..], |mesh| mesh.triangles())
            .as_flattened()
            .to_vec()
    }

    /// Creates a workspace for the skinned mesh. `method` is "lbs" (linear blend skinning, the default) or "dqs"
    /// (dual-quaternion skinning).
    pub fn posing(&self, method: Option<String>) -> Result<RigPosing, Exception> {
        let method = method.as_deref().unwrap_or("lbs");
        let method: SkinningMethod = method.parse().map_err(raise)?;
        let rig = Rc::clone(&self.inner);
        let posing = kinopt::io::rig::RigPosing::new(Shared(rig), method).map_err(raise)?;
        let mesh = self.inner.mesh.as_ref();
        let count = |count_of: fn(&kinopt::mesh::TriangleMesh) -> usize| mesh.map_or(0, count_of);
        Ok(RigPosing {
            posing,
            positions: vec![Vec3::ZERO; count(|mesh| mesh.positions().len())],
            normals: vec![Vec3::ZERO; count(|mesh| mesh.normals().len())],
        })
    }
}

/// A shared rig.
struct Shared(Rc<kinopt::io::rig::Rig>);

impl std::borrow::Borrow<kinopt::io::rig::Rig> for Shared {
    fn borrow(&self) -> &kinopt::io::rig::Rig {
        &self.0
    }
}

/// Poses the mesh of a rig repeatedly, into the module's memory, for views.
#[wasm_bindgen]
pub struct RigPosing {
    posing: kinopt::io::rig::RigPosing<Shared>,
    positions: Vec<Vec3>,
    normals: Vec<Vec3>,
}

#[wasm_bindgen]
impl RigPosing {
    /// Computes positions and normals of the skinned mesh at the configuration `q`, radians.
    pub fn deform(
        &mut self,
        #[wasm_bindgen(unchecked_param_type = "Numbers")] q: &[f64],
    ) -> Result<(), Exception> {
        let posed = PosedVertices {
            positions: &mut self.positions,
            normals: &mut self.normals,
            tangents: &mut [],
        };
        self.posing.deform(q, posed).map_err(raise)
    }

    /// Computes the mesh in a pose of the skeleton's armature.
    #[wasm_bindgen(js_name = deformToPose)]
    pub fn deform_to_pose(&mut self, pose: &Pose) -> Result<(), Exception> {
        let posed = PosedVertices {
            positions: &mut self.positions,
            normals: &mut self.normals,
            tangents: &mut [],
        };
        self.posing
            .deform_to_pose(&pose.inner, posed)
            .map_err(raise)
    }

    /// Vertices, three numbers each, as a view: valid until the next call into the module.
    #[wasm_bindgen(getter, unchecked_return_type = "Float32Array")]
    pub fn positions(&self) -> js_sys::Float32Array {
        view::floats(&self.positions)
    }

    /// Unit normals of the vertices, three numbers each, as a view: valid until the next call into the module.
    #[wasm_bindgen(getter, unchecked_return_type = "Float32Array")]
    pub fn normals(&self) -> js_sys::Float32Array {
        view::floats(&self.normals)
    }
}
