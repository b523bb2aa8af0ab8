//! Conversion of a skeleton and its skin to a scene.

use super::{Scene, SceneError, SceneMesh, Skin};
use crate::animation::Armature;
use crate::skinning::{MorphTargets, SkinWeights};
use kinopt_kinematics::skeleton::Skeleton;
use kinopt_mesh::mesh::TriangleMesh;

impl Scene {
    /// Creates a scene from a skeleton and optionally a mesh with weights, whose columns are the bones.
    ///
    /// Bones keep their ids. The mesh is on an additional bone `mesh` after them. Add clips for
    /// [`armature`](Self::armature) to [`clips`](Self::clips).
    ///
    /// ```
    /// # std::env::set_current_dir("../..")?;
    /// use kinopt::animation::Clip;
    /// use kinopt::io::gltf::{self, Scene, WriteOptions};
    /// use kinopt::io::rig::Rig;
    ///
    /// let rig = Rig::read("models/humanoid/humanoid.json")?;
    /// let skin = rig.mesh.as_ref().zip(rig.weights.as_ref());
    /// let mut scene = Scene::of_skeleton(&rig.skeleton, skin)?;
    /// let mut builder = Clip::builder("keys", &scene.armature);
    /// builder.euler_clip(&rig.clip)?;
    /// let clip = builder.build();
    /// scene.clips.push(clip);
    /// assert!(gltf::to_bytes(&scene, &WriteOptions::default())?.starts_with(b"glTF"));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// Weights without one row per vertex and one column per bone.
    pub fn of_skeleton(
        skeleton: &Skeleton,
        skin: Option<(&TriangleMesh, &SkinWeights)>,
    ) -> Result<Self, SceneError> {
        let skeleton_armature = Armature::of_skeleton(skeleton);
        let Some((mesh, weights)) = skin else {
            return Ok(Self::without_meshes(skeleton_armature));
        };
        let (joints, joint_from_mesh) = (
            skeleton_armature.bone_ids().collect(),
            skeleton_armature.rest_from_model().to_vec(),
        );
        // On a root of its own: a skinned node ignores its parents (section 3.7.3.3).
        let (armature, bone) = skeleton_armature.with_root("mesh");
        let vertices = mesh.positions().len();
        let scene_mesh = SceneMesh {
            name: "mesh".into(),
            bone,
            mesh: mesh.clone(),
            tangents: Vec::new(),
            morph_targets: MorphTargets::none(vertices),
            first_morph_weight: 0,
            skin: Some(Skin {
                name: String::new(),
                joints,
                joint_from_mesh,
                weights: weights.clone(),
            }),
        };
        scene_mesh.check(&armature)?;
        let mut scene = Self::without_meshes(armature);
        scene.meshes.push(scene_mesh);
        Ok(scene)
    }

    fn without_meshes(armature: Armature) -> Self {
        Self {
            armature,
            meshes: Vec::new(),
            clips: Vec::new(),
            notes: Vec::new(),
        }
    }
}
