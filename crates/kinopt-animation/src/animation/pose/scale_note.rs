//! Scales of rest poses that skeletons cannot represent.

use std::fmt;

use glam::Vec3A;

use super::{Armature, Stretch};
use kinopt_kinematics::skeleton::BoneId;

/// Rest scale of a bone with children that a [`Skeleton`](kinopt_kinematics::skeleton::Skeleton) cannot represent.
#[derive(Clone, Debug, PartialEq)]
pub struct ScaleNote {
    /// Name of the bone.
    pub bone: String,
    /// Rest scale along the bone's own axes.
    pub scale: [f32; 3],
    /// The absolute scales of the axes differ: bones that rotate below this one shear.
    pub uneven: bool,
    /// The scale is negative along an axis: bones below this one rotate in reflected axes.
    pub mirrored: bool,
}

impl fmt::Display for ScaleNote {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [x, y, z] = self.scale;
        let effect = match (self.uneven, self.mirrored) {
            (true, true) => "shears and mirrors",
            (true, false) => "shears",
            (false, _) => "mirrors",
        };
        write!(
            f,
            "bone `{}`: its scale ({x}, {y}, {z}) {effect} the bones that rotate below it",
            self.bone
        )
    }
}

impl Armature {
    /// Bones with children whose rest scale is uneven or mirrors, in bone order.
    ///
    /// Scales within 1e-4 of each other, relative to the largest, count as even.
    #[must_use]
    pub fn scale_notes(&self) -> Vec<ScaleNote> {
        self.scale_notes_of(self.bone_ids())
    }

    /// [`scale_notes`](Self::scale_notes) for the ancestors of `turning` bones.
    pub(crate) fn scale_notes_of(
        &self,
        turning: impl IntoIterator<Item = BoneId>,
    ) -> Vec<ScaleNote> {
        let mut is_ancestor = vec![false; self.bones()];
        for bone in turning {
            for ancestor in self.bone_and_ancestors(self.parent(bone)) {
                is_ancestor[ancestor.index()] = true;
            }
        }
        let ancestors = self.bone_ids().filter(|bone| is_ancestor[bone.index()]);
        let notes = ancestors.filter_map(|bone| {
            let scale = self.rest().local_of(bone).scale;
            let note = ScaleNote {
                bone: self.names().get(bone.index())?.clone(),
                scale: scale.to_array(),
                uneven: Stretch::is_noted(scale),
                mirrored: scale.min_element() < 0.0,
            };
            (note.uneven || note.mirrored).then_some(note)
        });
        notes.collect()
    }

    /// The armature with rest scales of 1. Local translations and rotations do not change, so joints below a scaled
    /// bone move in the model.
    #[must_use]
    pub fn without_scale(mut self) -> Self {
        self.rest.scales.fill(Vec3A::ONE);
        self.with_inverses()
    }
}
