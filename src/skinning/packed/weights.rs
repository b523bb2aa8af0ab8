//! Skin weights with four places for every vertex.

use crate::skinning::{Influence, SkinWeights, WeightsError};

/// How many influences a vertex has room for.
pub(super) const PLACES: usize = 4;

/// One vertex's influences by falling weight; places that are not needed have weight 0.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct FourInfluences {
    pub(super) weights: [f32; PLACES],
    pub(super) bones: [u16; PLACES],
}

impl FourInfluences {
    /// (bone, weight) of each place.
    pub(super) fn iter(&self) -> impl Iterator<Item = (usize, f32)> + Clone {
        let bones = self.bones.map(usize::from);
        bones.into_iter().zip(self.weights)
    }
}

/// Skin weights of at most four influences a vertex, in single precision, 24 bytes a vertex.
#[derive(Clone, Debug, PartialEq)]
pub struct PackedWeights {
    vertices: Vec<FourInfluences>,
    bone_count: usize,
}

impl PackedWeights {
    /// Packs weights. Those of vertices with more influences are pruned first, by
    /// [`SkinWeights::pruned`], which says what is lost.
    ///
    /// # Errors
    /// A vertex has more than four influences, or there are more than 65 536 bones.
    pub fn new(weights: &SkinWeights) -> Result<Self, WeightsError> {
        let bones = weights.bone_count();
        if bones > 1 << 16 {
            return Err(WeightsError::TooManyBones { bones });
        }
        let pack = |(vertex, influences): (usize, &[Influence])| {
            // Checked when they were built; once more, as the kernel relies on it.
            let beyond = |i: &&Influence| i.bone as usize >= bones;
            if let Some(influence) = influences.iter().find(beyond) {
                let bone = influence.bone as usize;
                return Err(WeightsError::BoneOutOfRange {
                    vertex,
                    bone,
                    bones,
                });
            }
            four(influences).ok_or(WeightsError::TooManyInfluences {
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

    getters! {
        /// How many vertices have weights.
        pub fn vertex_count(&self) -> usize = self.vertices.len();
        /// How many bones the skeleton has.
        pub fn bone_count(&self) -> usize = self.bone_count;
    }

    /// So many vertices from number `first` on.
    pub(super) fn part(&self, first: usize, count: usize) -> Part<'_> {
        let range = first..first.saturating_add(count);
        Part {
            vertices: self.vertices.get(range).unwrap_or(&[]),
            #[cfg(target_arch = "x86_64")]
            bone_count: self.bone_count,
        }
    }
}

/// Some vertices' influences, all of whose bones are below a count.
#[derive(Clone, Copy)]
pub(super) struct Part<'a> {
    vertices: &'a [FourInfluences],
    #[cfg(target_arch = "x86_64")]
    bone_count: usize,
}

impl<'a> Part<'a> {
    getters! {
        pub(super) fn vertices(self) -> &'a [FourInfluences] = self.vertices;
        /// How many transforms there must be.
        #[cfg(target_arch = "x86_64")]
        pub(super) fn bone_count(self) -> usize = self.bone_count;
    }
}

fn four(influences: &[Influence]) -> Option<FourInfluences> {
    let mut sorted = [Influence {
        bone: 0,
        weight: 0.0,
    }; PLACES];
    let places = sorted.get_mut(..influences.len())?;
    places.copy_from_slice(influences);
    // Stable, so that of equal weights the lowest bone stays first: it leads the dual quaternions.
    places.sort_by(|a, b| b.weight.total_cmp(&a.weight));
    Some(FourInfluences {
        weights: sorted.map(|influence| influence.weight as f32),
        bones: sorted.map(|influence| influence.bone as u16),
    })
}
