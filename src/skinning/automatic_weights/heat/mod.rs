//! Weights by heat: bones heat the skin that is near them and that they see, and heat spreads over the
//! surface until it is at rest.

mod crossings;
mod dissection;
mod sources;
mod stiffness;
mod surface;
mod system;

use glam::DVec3;

use self::sources::Sources;
use self::stiffness::Stiffness;
use self::surface::Surface;
use self::system::System;
use super::AutomaticWeightsError;
use super::neighbours::Neighbours;
use super::segments;
use super::smooth_pruning::Strongest;
use crate::mesh::TriangleMesh;
use crate::skeleton::Skeleton;
use crate::skinning::SkinWeights;

/// Weights below this are of no bone that matters.
const LEAST: f64 = 1e-4;

/// Weights by heat on the surface (Baran & Popović 2007, "Automatic rigging and animation of 3D
/// characters"): they pass smoothly from bone to bone along the skin, and never through the air.
///
/// The weights of bone j are the temperatures w_j at which the heat that flows over the surface and the
/// heat that bones give balance,
///
/// ```text
/// (L + A H) w_j = A H p_j,   H_i = k_i c / d_i²
/// ```
///
/// with L the cotangent Laplacian, A_i the area around point i, d_i its distance from the nearest bone
/// and c the heat. k_i bones are as near as that (within 1e-4) and seen from the point, that is without
/// skin in between; p_ij is 1/k_i for these and 0 for others. Where none is seen, H_i is 0 and heat comes
/// from around. A separate piece of skin that sees no bone takes the nearest ones all the same.
///
/// Vertices at one place are one point, so seams stay closed. Cotangents are bounded and conduction is
/// above 0, so needles and obtuse triangles do no harm; all weights are within 0 and 1. At last the
/// largest few stay, as those of [`AutomaticWeights`](super::AutomaticWeights) do. The same input gives
/// the same bits.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct HeatWeights {
    /// c: how much heat bones give; larger is stiffer. Above 0.
    pub heat: f64,
    /// The most influences a vertex keeps, at least 1. Four take the packed path, and steeper steps
    /// where many bones are near: palms, shoulders.
    pub most: usize,
}

impl Default for HeatWeights {
    /// Heat 1, eight influences.
    fn default() -> Self {
        Self { heat: 1.0, most: 8 }
    }
}

impl HeatWeights {
    /// Weights for a skeleton's bones at rest, in the mesh's own frame and unit.
    ///
    /// # Errors
    /// The skeleton has no bones, the heat is not above 0, or no influence may stay.
    pub fn for_skeleton(
        &self,
        mesh: &TriangleMesh,
        skeleton: &Skeleton,
    ) -> Result<SkinWeights, AutomaticWeightsError> {
        self.for_segments(mesh, &segments::of_skeleton(skeleton))
    }

    /// Weights for bones given as [tail, tip]; a bone without length is a point.
    ///
    /// # Errors
    /// There are no bones, an end is not finite, the heat is not above 0, or the surface's equations
    /// cannot be solved in double precision.
    pub fn for_segments(
        &self,
        mesh: &TriangleMesh,
        segments: &[[DVec3; 2]],
    ) -> Result<SkinWeights, AutomaticWeightsError> {
        segments::check(segments, self.most)?;
        if !(self.heat > 0.0 && self.heat.is_finite()) {
            return Err(AutomaticWeightsError::Heat(self.heat));
        }
        let surface = Surface::of(mesh);
        let stiffness = Stiffness::of(&surface);
        let segments = segments
            .iter()
            .map(|ends| ends.map(|end| end / surface.unit));
        let segments: Vec<_> = segments.collect();
        let sources = Sources::of(&surface, &stiffness, &segments, self.heat);
        let mut system = System::new(&surface, &stiffness, &sources.given)?;
        let mut strongest = Strongest::new(surface.points.len(), self.most);
        for (bone, heated) in sources.of_bones.iter().enumerate() {
            if !heated.is_empty() {
                let weights = system.solve(heated);
                let kept = weights.map(|weight| if weight > LEAST { weight } else { 0.0 });
                strongest.add(bone, kept);
            }
        }
        let corners = surface.triangles.iter();
        let corners = corners.map(|triangle| triangle.map(|point| point as u32));
        let neighbours = Neighbours::of(surface.points.len(), corners);
        Ok(strongest.build(segments.len(), &surface.point_of, &neighbours)?)
    }
}
