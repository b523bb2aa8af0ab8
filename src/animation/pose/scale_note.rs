//! Scales at rest that no joint has, and an armature without any.

use std::fmt;

use glam::Vec3A;

use super::{Armature, Stretch};
use crate::skeleton::BoneId;

/// A scale at rest of a bone with children that a [`Skeleton`](crate::skeleton::Skeleton) does not have.
#[derive(Clone, Debug, PartialEq)]
pub struct ScaleNote {
    /// The bone's name.
    pub bone: String,
    /// Its scale at rest, along its own axes.
    pub scale: [f32; 3],
    /// The scale differs along the axes, signs aside: bones that turn below this one shear.
    pub uneven: bool,
    /// The scale is negative along an axis: bones below this one turn in reflected axes.
    pub mirrored: bool,
}

impl fmt::Display for ScaleNote {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [x, y, z] = self.scale;
        let does = match (self.uneven, self.mirrored) {
            (true, true) => "shears and mirrors",
            (true, false) => "shears",
            (false, _) => "mirrors",
        };
        write!(
            f,
            "bone `{}`: its scale ({x}, {y}, {z}) {does} the bones that turn below it",
            self.bone
        )
    }
}

impl Armature {
    /// The bones with children whose scale at rest is uneven or mirrors, in their order.
    ///
    /// Scales within 1e-6 of each other are even.
    #[must_use]
    pub fn scale_notes(&self) -> Vec<ScaleNote> {
        self.scale_notes_of(self.bone_ids())
    }

    /// The same of the bones that carry `turning` ones.
    pub(crate) fn scale_notes_of(
        &self,
        turning: impl IntoIterator<Item = BoneId>,
    ) -> Vec<ScaleNote> {
        let mut carries = vec![false; self.bones()];
        for bone in turning {
            for above in self.upwards(self.parent(bone)) {
                carries[above.index()] = true;
            }
        }
        let carriers = self.bone_ids().filter(|bone| carries[bone.index()]);
        let noted = carriers.filter_map(|bone| {
            let scale = self.rest().local_of(bone).scale;
            let note = ScaleNote {
                bone: self.names().get(bone.index())?.clone(),
                scale: scale.to_array(),
                uneven: !Stretch::is_even_scale(scale),
                mirrored: scale.min_element() < 0.0,
            };
            (note.uneven || note.mirrored).then_some(note)
        });
        noted.collect()
    }

    /// The same bones with scales of 1 at rest. Translations and rotations in the parents stay, so that joints below a
    /// scaled bone move in the model.
    #[must_use]
    pub fn without_scale(mut self) -> Self {
        self.rest.scales.fill(Vec3A::ONE);
        self.with_inverses()
    }
}
