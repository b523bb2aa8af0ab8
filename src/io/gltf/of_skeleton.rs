//! A skeleton and its skin as a scene.

use super::{Scene, SceneError, SceneMesh, Skin};
use crate::animation::Armature;
use crate::mesh::TriangleMesh;
use crate::skeleton::Skeleton;
use crate::skinning::{MorphTargets, SkinWeights};

impl Scene {
    /// A skeleton as a scene, and its mesh where there is one, skinned by weights whose columns are the bones. Bones keep their ids; the
    /// mesh hangs on a bone of its own behind them, called `mesh`. Clips are added to [`clips`](Self::clips), made for
    /// [`armature`](Self::armature).
    ///
    /// ```
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
    /// Weights that are not one row for each vertex and one column for each bone.
    pub fn of_skeleton(
        skeleton: &Skeleton,
        skin: Option<(&TriangleMesh, &SkinWeights)>,
    ) -> Result<Self, SceneError> {
        let bare = Armature::of_skeleton(skeleton);
        let Some((mesh, weights)) = skin else {
            return Ok(Self::bare(bare));
        };
        let (joints, joint_from_mesh) =
            (bare.bone_ids().collect(), bare.rest_from_model().to_vec());
        // Apart from the bones, which a node with a skin does not follow (section 3.7.3.3).
        let (armature, bone) = bare.with_root("mesh");
        let vertices = mesh.positions().len();
        let own = SceneMesh {
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
        own.check(&armature)?;
        let mut scene = Self::bare(armature);
        scene.meshes.push(own);
        Ok(scene)
    }

    fn bare(armature: Armature) -> Self {
        Self {
            armature,
            meshes: Vec::new(),
            clips: Vec::new(),
            notes: Vec::new(),
        }
    }
}
