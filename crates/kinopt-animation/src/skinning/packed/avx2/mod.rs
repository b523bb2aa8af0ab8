//! Skinning of eight vertices at a time with AVX2 and FMA.
//!
//! The bones' transforms are blended vertex by vertex; a register holds two columns or a dual quaternion. Eight blends
//! are then transposed to one register per matrix entry, and the rest works on eight vertices at once.
//!
//! The code uses intrinsics: equivalent loops over arrays measured at least twice as slow.

mod lanes;
mod matrices;
mod motions;

use bytemuck::Pod;
use glam::{Vec3, Vec4};

use super::weights::{FourInfluences, Part};
use crate::skinning::{PosedVertices, RestVertices};
use lanes::Vec3x8;
pub(super) use matrices::{Columns, columns};
pub(super) use motions::PackedDualQuaternion;

/// Entry of a bone in a palette.
///
/// # Safety
/// The palette has an entry for every bone.
#[inline]
#[target_feature(enable = "avx2,fma")]
#[allow(unsafe_code)]
unsafe fn entry<T: Copy>(palette: &[T], bone: u16) -> T {
    // SAFETY: the caller guarantees an entry for every bone. Bounds checks measured 14 % slower: the compiler then
    // cannot reorder the loads of eight vertices.
    unsafe { *palette.get_unchecked(usize::from(bone)) }
}

/// Number of vertices per block.
const BLOCK: usize = 8;

/// Transform of each bone by index.
#[derive(Clone, Copy)]
pub(super) enum Palette<'a> {
    Matrices(&'a [Columns]),
    Motions(&'a [PackedDualQuaternion]),
    /// Motions, and the stretches that precede them.
    Stretched(&'a [PackedDualQuaternion], &'a [Columns]),
}

/// Blended transforms of eight vertices: columns of each matrix, and the translation.
struct Blended {
    x: Vec3x8,
    y: Vec3x8,
    z: Vec3x8,
    translation: Vec3x8,
}

impl Blended {
    #[inline]
    #[target_feature(enable = "avx2,fma")]
    fn after(&self, first: &Self) -> Self {
        let moved = |v: Vec3x8, shift| v.weighted(self.x, self.y, self.z, shift);
        Self {
            x: moved(first.x, Vec3x8::zero()),
            y: moved(first.y, Vec3x8::zero()),
            z: moved(first.z, Vec3x8::zero()),
            translation: moved(first.translation, self.translation),
        }
    }
}

/// One block of each non-empty buffer.
#[derive(Default)]
struct BufferBlock<'a> {
    positions: Option<(&'a [Vec3; BLOCK], &'a mut [Vec3; BLOCK])>,
    normals: Option<(&'a [Vec3; BLOCK], &'a mut [Vec3; BLOCK])>,
    tangents: Option<(&'a [Vec4; BLOCK], &'a mut [Vec4; BLOCK])>,
}

/// Deforms one vertex per entry of `influences`, whose bones must be in the palette. Non-empty buffers have the length
/// of `influences`.
#[target_feature(enable = "avx2,fma")]
pub(super) fn deform(
    palette: Palette<'_>,
    influences: Part<'_>,
    rest: RestVertices<'_>,
    posed: PosedVertices<'_>,
) {
    // Precondition of `entry`. A vertex without influences refers to bone 0.
    let entries = match palette {
        Palette::Matrices(columns) => columns.len(),
        Palette::Motions(motions) => motions.len(),
        Palette::Stretched(motions, stretches) => motions.len().min(stretches.len()),
    };
    let influences = match entries >= influences.bone_count().max(1) {
        true => influences.vertices(),
        false => &[],
    };
    // One loop per palette type, so that everything is inlined and matrices stay in registers.
    match palette {
        Palette::Matrices(columns) => {
            let blended = |four: &_| matrices::blended::<false>(columns, four);
            deform_by(blended, influences, rest, posed);
        }
        Palette::Motions(motions) => {
            let blended = |four: &_| motions::blended::<false>(motions, four);
            deform_by(blended, influences, rest, posed);
        }
        Palette::Stretched(motions, stretches) => {
            let stretch = |four: &_| matrices::blended::<true>(stretches, four);
            let blended = |four: &_| motions::blended::<true>(motions, four).after(&stretch(four));
            deform_by(blended, influences, rest, posed);
        }
    }
}

#[inline]
#[target_feature(enable = "avx2,fma")]
fn deform_by(
    blended: impl Fn(&[FourInfluences; BLOCK]) -> Blended,
    influences: &[FourInfluences],
    rest: RestVertices<'_>,
    posed: PosedVertices<'_>,
) {
    let (full_blocks, after) = influences.split_at(influences.len() - influences.len() % BLOCK);
    // The remaining vertices form a block that is padded with vertices without influences.
    let mut last_influences = [FourInfluences::default(); BLOCK];
    copy(&mut last_influences, after);
    let mut last = (
        PaddedBlock::default(),
        PaddedBlock::default(),
        PaddedBlock::default(),
    );
    let (positions, last_positions) = blocks(rest.positions, posed.positions, &mut last.0);
    let (normals, last_normals) = blocks(rest.normals, posed.normals, &mut last.1);
    let (tangents, last_tangents) = blocks(rest.tangents, posed.tangents, &mut last.2);
    let last_influences = if after.is_empty() {
        &[][..]
    } else {
        &last_influences[..]
    };
    let parts = [
        (full_blocks, positions, normals, tangents),
        (last_influences, last_positions, last_normals, last_tangents),
    ];
    // One call of the kernel for both parts, so that it is inlined into this loop.
    for (mut influences, mut positions, mut normals, mut tangents) in parts {
        let mut k = 0;
        while let Some((eight, others)) = influences.split_first_chunk() {
            let block = BufferBlock {
                positions: positions.at(k),
                normals: normals.at(k),
                tangents: tangents.at(k),
            };
            move_block(&blended, eight, block);
            influences = others;
            k += 1;
        }
    }
    last.0.copy_to(posed.positions);
    last.1.copy_to(posed.normals);
    last.2.copy_to(posed.tangents);
}

#[inline]
#[target_feature(enable = "avx2,fma")]
fn move_block(
    blended: &impl Fn(&[FourInfluences; BLOCK]) -> Blended,
    influences: &[FourInfluences; BLOCK],
    block: BufferBlock<'_>,
) {
    let Blended {
        x,
        y,
        z,
        translation,
    } = blended(influences);
    if let Some((rest, posed)) = block.positions {
        *posed = Vec3x8::load(rest).weighted(x, y, z, translation).store();
    }
    if block.normals.is_none() && block.tangents.is_none() {
        return;
    }
    // The inverse transpose is the cofactor matrix over the determinant, of which only the sign matters.
    let (a, b, c) = (y.cross(z), z.cross(x), x.cross(y));
    let determinant = x.dot(a);
    if let Some((rest, posed)) = block.normals {
        let transformed = Vec3x8::load(rest).weighted(a, b, c, Vec3x8::zero());
        *posed = transformed.normalised_with_sign_of(determinant).store();
    }
    if let Some((rest, posed)) = block.tangents {
        let (tangents, signs) = Vec3x8::load_with_fourth(rest);
        let transformed = tangents.weighted(x, y, z, Vec3x8::zero());
        let signs = lanes::with_sign_flipped_by(signs, determinant);
        *posed = transformed.normalised().store_with_fourth(signs);
    }
}

/// Blocks of a buffer at rest and of its posed buffer; empty for an empty buffer.
struct Blocks<'a, T> {
    rest: &'a [[T; BLOCK]],
    posed: &'a mut [[T; BLOCK]],
}

/// The whole blocks of a buffer, and the padded last block.
fn blocks<'a, T: Pod>(
    rest: &'a [T],
    posed: &'a mut [T],
    last: &'a mut PaddedBlock<T>,
) -> (Blocks<'a, T>, Blocks<'a, T>) {
    let full = rest.len().min(posed.len()) / BLOCK * BLOCK;
    copy(&mut last.rest[0], &rest[full..]);
    let block_count = usize::from(!rest.is_empty());
    let full = Blocks {
        rest: bytemuck::cast_slice(&rest[..full]),
        posed: bytemuck::cast_slice_mut(&mut posed[..full]),
    };
    let last = Blocks {
        rest: &last.rest[..block_count],
        posed: &mut last.posed[..block_count],
    };
    (full, last)
}

impl<T> Blocks<'_, T> {
    #[inline(always)]
    fn at(&mut self, k: usize) -> Option<(&[T; BLOCK], &mut [T; BLOCK])> {
        self.rest.get(k).zip(self.posed.get_mut(k))
    }
}

/// A padded block for the remaining vertices.
struct PaddedBlock<T> {
    rest: [[T; BLOCK]; 1],
    posed: [[T; BLOCK]; 1],
}

impl<T: Pod> Default for PaddedBlock<T> {
    fn default() -> Self {
        Self {
            rest: [[T::zeroed(); BLOCK]],
            posed: [[T::zeroed(); BLOCK]],
        }
    }
}

impl<T: Pod> PaddedBlock<T> {
    /// Copies the remaining vertices to the end of the buffer.
    fn copy_to(&self, posed: &mut [T]) {
        let full_length = posed.len() / BLOCK * BLOCK;
        copy(&mut posed[full_length..], &self.posed[0]);
    }
}

/// Copies the common length of two slices.
fn copy<T: Copy>(to: &mut [T], from: &[T]) {
    for (to, from) in to.iter_mut().zip(from) {
        *to = *from;
    }
}
