//! Meshes and skins of a scene.

use std::sync::Arc;

use kinopt::animation::Armature as Bones;
use kinopt::io::gltf;
use numpy::{PyArray2, PyArrayDyn};
use pyo3::prelude::*;

use crate::animation::Armature;
use crate::error::OrRaise;
use crate::mesh::TriangleMesh;
use crate::pickling;
use crate::skinning::{MorphTargets, SkinWeights};
use crate::transforms;
use crate::vertices::to_array;

/// A mesh on a bone of a scene.
///
/// A mesh on a bone of `armature`: without a skin it moves with the bone, with a skin it follows the skin's joints
/// only. `tangents` has shape (V, 4); the weights of its morph targets are those of the armature from index
/// `first_morph_weight`.
///
/// Raises `UnknownNameError` for a bone. Posing or writing a scene raises errors of parts that do not match.
#[pyclass(frozen, module = "kinopt")]
pub(crate) struct SceneMesh {
    pub(super) inner: gltf::SceneMesh,
    armature: Arc<Bones>,
}

impl SceneMesh {
    pub(super) fn of(armature: &Arc<Bones>, inner: gltf::SceneMesh) -> Self {
        let armature = Arc::clone(armature);
        Self { inner, armature }
    }
}

#[pymethods]
impl SceneMesh {
    #[new]
    #[pyo3(signature = (
        armature, name, bone, mesh, *, tangents = None, morph_targets = None, first_morph_weight = 0,
        skin = None
    ))]
    #[allow(clippy::too_many_arguments, reason = "they are keywords")]
    fn new(
        armature: &Bound<'_, Armature>,
        name: String,
        bone: &str,
        mesh: &Bound<'_, TriangleMesh>,
        tangents: Option<&Bound<'_, PyAny>>,
        morph_targets: Option<&Bound<'_, MorphTargets>>,
        #[pyo3(from_py_with = crate::arrays::whole)] first_morph_weight: usize,
        skin: Option<&Bound<'_, Skin>>,
    ) -> PyResult<Self> {
        let armature = &armature.get().inner;
        let mesh = kinopt::mesh::TriangleMesh::clone(&mesh.get().inner);
        let morph_targets = match morph_targets {
            Some(targets) => kinopt::skinning::MorphTargets::clone(&targets.get().inner),
            None => kinopt::skinning::MorphTargets::new(mesh.positions().len(), Vec::new())
                .or_raise()?,
        };
        let inner = gltf::SceneMesh {
            name,
            bone: armature.bone(bone).or_raise()?,
            mesh,
            tangents: match tangents {
                Some(value) => crate::vertices::tangents(value, "tangents")?,
                None => Vec::new(),
            },
            morph_targets,
            first_morph_weight,
            skin: skin.map(|skin| skin.get().inner.clone()),
        };
        Ok(Self::of(armature, inner))
    }

    /// Name of the mesh, not necessarily unique.
    #[getter]
    fn name(&self) -> &str {
        &self.inner.name
    }

    /// Name of its bone.
    #[getter]
    fn bone(&self) -> &str {
        &self.armature.names()[self.inner.bone.index()]
    }

    /// Mesh at rest.
    #[getter]
    fn mesh(&self) -> TriangleMesh {
        self.inner.mesh.clone().into()
    }

    /// Tangents, x, y, z and the sign of the bitangent, shape (V, 4), float32; None without tangents.
    #[getter]
    fn tangents<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyArray2<f32>>>> {
        let tangents = &self.inner.tangents;
        let array = (!tangents.is_empty()).then(|| to_array(py, tangents, 4));
        array.transpose()
    }

    /// Morph targets; often empty.
    #[getter]
    fn morph_targets(&self) -> MorphTargets {
        self.inner.morph_targets.clone().into()
    }

    /// Index of its first morph target weight in those of the armature.
    #[getter]
    fn first_morph_weight(&self) -> usize {
        self.inner.first_morph_weight
    }

    /// Skin; None for a mesh that moves with its bone.
    #[getter]
    fn skin(&self) -> Option<Skin> {
        let skin = self.inner.skin.as_ref();
        skin.map(|skin| Skin::of(&self.armature, skin.clone()))
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let parts = (
            Armature::from(Arc::clone(&self.armature)),
            self.name(),
            self.bone(),
            self.mesh(),
            self.tangents(py)?,
            self.morph_targets(),
            self.first_morph_weight(),
            self.skin(),
        );
        let keywords = ["tangents", "morph_targets", "first_morph_weight", "skin"];
        pickling::by_arguments::<Self>(py, parts, &keywords)
    }

    fn __repr__(&self) -> String {
        format!(
            "SceneMesh({:?} on {:?}, {} vertices)",
            self.inner.name,
            self.bone(),
            self.inner.mesh.positions().len()
        )
    }
}

/// A skin: the binding of a mesh to joints.
///
/// A skin on bones of `armature`. `joints` are their names in the order of the weights' bones, `joint_from_mesh`, shape
/// (joints, 4, 4), the inverse bind matrices.
///
/// Raises `UnknownNameError` for a bone.
#[pyclass(frozen, module = "kinopt")]
pub(crate) struct Skin {
    inner: gltf::Skin,
    armature: Arc<Bones>,
}

impl Skin {
    fn of(armature: &Arc<Bones>, inner: gltf::Skin) -> Self {
        let armature = Arc::clone(armature);
        Self { inner, armature }
    }
}

#[pymethods]
impl Skin {
    #[new]
    fn new(
        armature: &Bound<'_, Armature>,
        name: String,
        joints: Vec<String>,
        joint_from_mesh: &Bound<'_, PyAny>,
        weights: &Bound<'_, SkinWeights>,
    ) -> PyResult<Self> {
        let armature = &armature.get().inner;
        let joints = joints.iter().map(|joint| armature.bone(joint).or_raise());
        let inner = gltf::Skin {
            name,
            joints: joints.collect::<PyResult<_>>()?,
            joint_from_mesh: transforms::read_list(joint_from_mesh, "joint_from_mesh")?,
            weights: kinopt::skinning::SkinWeights::clone(&weights.get().inner),
        };
        Ok(Self::of(armature, inner))
    }

    /// Name of the skin, possibly empty.
    #[getter]
    fn name(&self) -> &str {
        &self.inner.name
    }

    /// Names of the bones that are its joints, in the order of the weights' bones.
    #[getter]
    fn joints(&self) -> Vec<&str> {
        let names = self.armature.names();
        let joints = self.inner.joints.iter();
        joints.map(|joint| names[joint.index()].as_str()).collect()
    }

    /// Inverse bind matrices of the joints, shape (joints, 4, 4), float32. A vertex is transformed by the sum over
    /// joints of weight * model_from_joint @ joint_from_mesh.
    #[getter]
    fn joint_from_mesh<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        transforms::to_array(py, &self.inner.joint_from_mesh)
    }

    /// Skin weights by joint.
    #[getter]
    fn weights(&self) -> SkinWeights {
        self.inner.weights.clone().into()
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let parts = (
            Armature::from(Arc::clone(&self.armature)),
            self.name(),
            self.joints(),
            self.joint_from_mesh(py)?,
            self.weights(),
        );
        pickling::by_class::<Self>(py, parts)
    }

    fn __repr__(&self) -> String {
        format!(
            "Skin({:?}, {} joints)",
            self.inner.name,
            self.inner.joints.len()
        )
    }
}
