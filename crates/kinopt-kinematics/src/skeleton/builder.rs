//! Builder of skeletons, which assigns bone ids.

use super::{Bone, BoneId, Skeleton};
use crate::model::ModelError;

/// Collects the bones of a skeleton, parents before children.
///
/// ```
/// use kinopt::model::Limits;
/// use kinopt::skeleton::{Bone, Skeleton};
/// use kinopt::spatial::{Placement, Vector3};
///
/// let bone = |name: &str, parent, tail: f64| Bone {
///     name: name.into(),
///     parent,
///     length: 0.3,
///     model_from_rest: Placement::translation(Vector3::new(tail, 0.0, 0.0)),
///     limits: [Limits::new(-1.0, 1.0), Limits::new(0.0, 2.5), Limits::new(-1.0, 1.0)],
/// };
/// let mut builder = Skeleton::builder("arm");
/// let upper = builder.add(bone("upper arm", None, 0.0));
/// let fore = builder.add(bone("forearm", Some(upper), 0.3));
/// let skeleton = builder.build()?;
/// assert_eq!(skeleton.pose(&[0.0; 6])?.tip(&skeleton, fore)?.x, 0.6);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct SkeletonBuilder {
    name: String,
    bones: Vec<Bone>,
}

impl SkeletonBuilder {
    pub(super) fn new(name: String) -> Self {
        Self {
            name,
            bones: Vec::new(),
        }
    }

    /// Adds a bone. The returned id is the `parent` of its children.
    pub fn add(&mut self, bone: Bone) -> BoneId {
        self.bones.push(bone);
        BoneId::new(self.bones.len() - 1)
    }

    /// The bones so far.
    #[must_use]
    pub fn bones(&self) -> &[Bone] {
        &self.bones
    }

    /// Checks the bones and builds the skeleton.
    ///
    /// # Errors
    /// As [`Skeleton::new`].
    pub fn build(self) -> Result<Skeleton, ModelError> {
        Skeleton::new(self.name, self.bones)
    }
}
