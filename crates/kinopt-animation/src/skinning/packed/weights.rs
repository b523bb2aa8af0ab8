//! Packed skin weights: four influences per vertex.

use crate::skinning::{Influence, SkinWeights, SkinningError};

/// Number of influences per vertex.
pub(super) const MAX_INFLUENCES: usize = 4;

/// Influences of one vertex by descending weight; unused entries have weight 0.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct FourInfluences {
    pub(super) weights: [f32; MAX_INFLUENCES],
    pub(super) bones: [u16; MAX_INFLUENCES],
}

impl FourInfluences {
    /// The (bone, weight) pairs, including unused entries.
    pub(super) fn iter(&self) -> impl Iterator<Item = (usize, f32)> + Clone {
        let bones = self.bones.map(usize::from);
        bones.into_iter().zip(self.weights)
    }
}

/// Skin weights with at most four influences per vertex, in single precision: 24 bytes per vertex.
#[derive(Clone, Debug, PartialEq)]
pub struct PackedWeights {
    vertices: Vec<FourInfluences>,
    bone_count: usize,
}

impl PackedWeights {
    /// Packs weights. Prune vertices with more influences first, by [`SkinWeights::pruned`], which returns the loss.
    ///
    /// # Errors
    /// A vertex has more than four influences, or there are more than 65 536 bones.
    pub fn new(weights: &SkinWeights) -> Result<Self, SkinningError> {
        let bones = weights.bone_count();
        if bones > 1 << 16 {
            return Err(SkinningError::TooManyBones { bones });
        }
        let pack = |(vertex, influences): (usize, &[Influence])| {
            // Checked again because the unsafe kernel relies on it.
            let is_out_of_range = |i: &&Influence| i.bone as usize >= bones;
            if let Some(influence) = influences.iter().find(is_out_of_range) {
                let bone = influence.bone as usize;
                return Err(SkinningError::BoneOutOfRange {
                    vertex,
                    bone,
                    bones,
                });
            }
            four(influences).ok_or(SkinningError::TooManyInfluences {
                vertex,
                influences: influences.len(),
            })
        };
        let vertices = weights.iter().enumerate().map(pack);
        Ok(Self {
            vertices: vertices.collect::<Result<_, _>>()?,
            bone_count: bones,
        })
    }

    /// Number of vertices.
    #[must_use]
    pub fn vertex_count(&self) -> usize {
        self.vertices.len()
    }

    /// Number of bones.
    #[must_use]
    pub fn bone_count(&self) -> usize {
        self.bone_count
    }

    /// `count` vertices from index `first` on.
    pub(super) fn part(&self, first: usize, count: usize) -> Part<'_> {
        let range = first..first.saturating_add(count);
        Part {
            vertices: self.vertices.get(range).unwrap_or(&[]),
            #[cfg(target_arch = "x86_64")]
            bone_count: self.bone_count,
        }
    }
}

/// Influences of some vertices; all bone indices are below a count.
#[derive(Clone, Copy)]
pub(super) struct Part<'a> {
    vertices: &'a [FourInfluences],
    #[cfg(target_arch = "x86_64")]
    bone_count: usize,
}

impl<'a> Part<'a> {
    #[must_use]
    pub(super) fn vertices(self) -> &'a [FourInfluences] {
        self.vertices
    }

    /// Lower bound of the number of transforms.
    #[cfg(target_arch = "x86_64")]
    #[must_use]
    pub(super) fn bone_count(self) -> usize {
        self.bone_count
    }
}

fn four(influences: &[Influence]) -> Option<FourInfluences> {
    let mut sorted = [Influence {
        bone: 0,
        weight: 0.0,
    }; MAX_INFLUENCES];
    let entries = sorted.get_mut(..influences.len())?;
    entries.copy_from_slice(influences);
    // A stable sort: the lowest bone stays first among equal weights, as the pivot of dual quaternions.
    entries.sort_by(|a, b| b.weight.total_cmp(&a.weight));
    Some(FourInfluences {
        weights: sorted.map(|influence| influence.weight as f32),
        bones: sorted.map(|influence| influence.bone as u16),
    })
}
