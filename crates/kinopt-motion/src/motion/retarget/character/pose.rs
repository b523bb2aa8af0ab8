//! Pose of a character: the world placements of its bones.

use glam::{DQuat, DVec3};

use super::angles::{angles_near, rotation_of};
use super::bones::CharacterBone;

/// World rotations and positions of all bones, with the angles of limited ones.
#[derive(Clone, Debug)]
pub(super) struct BonePose {
    pub(super) rotations: Vec<DQuat>,
    pub(super) positions: Vec<DVec3>,
    /// Angles of each bone from rest, radians.
    pub(super) angles: Vec<[f64; 3]>,
}

impl BonePose {
    pub(super) fn new(bones: usize) -> Self {
        Self {
            rotations: vec![DQuat::IDENTITY; bones],
            positions: vec![DVec3::ZERO; bones],
            angles: vec![[0.0; 3]; bones],
        }
    }

    /// Rotation of a bone at rest relative to its parent: of the base for a root.
    pub(super) fn rest_on_parent(
        &self,
        bones: &[CharacterBone],
        bone: usize,
        base: DQuat,
    ) -> DQuat {
        let above = bones[bone]
            .parent
            .map_or(base, |parent| self.rotations[parent]);
        (above * bones[bone].local).normalize()
    }

    /// Rotates a bone to a rotation in the world, or as near as its limits allow.
    pub(super) fn rotate(
        &mut self,
        bones: &[CharacterBone],
        bone: usize,
        base: DQuat,
        rotation: DQuat,
        previous: Option<[f64; 3]>,
    ) {
        let at_rest = self.rest_on_parent(bones, bone, base);
        if !bones[bone].moves() {
            self.rotations[bone] = at_rest;
            self.angles[bone] = [0.0; 3];
            return;
        }
        let relative = (at_rest.conjugate() * rotation).normalize();
        self.angles[bone] = angles_near(relative, &bones[bone].limits, previous);
        self.rotations[bone] = match bones[bone].is_unlimited() {
            true => rotation,
            false => (at_rest * rotation_of(self.angles[bone])).normalize(),
        };
    }

    /// Places the tails of all bones, roots first, with a base placement.
    pub(super) fn place(&mut self, bones: &[CharacterBone], base: (DQuat, DVec3)) {
        for (index, bone) in bones.iter().enumerate() {
            self.positions[index] = match bone.parent {
                Some(parent) => self.positions[parent] + self.rotations[parent] * bone.offset,
                None => base.1 + base.0 * bone.offset,
            };
        }
    }

    /// Moves all bones.
    pub(super) fn translate(&mut self, offset: DVec3) {
        for position in &mut self.positions {
            *position += offset;
        }
    }
}
