//! Bone heat weighting: bones heat the nearest visible skin, and the heat spreads over the surface to equilibrium.

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
use self::system::HeatSystem;
use super::neighbours::Neighbours;
use super::segments;
use super::smooth_pruning::Strongest;
use crate::skinning::{SkinWeights, SkinningError};
use kinopt_kinematics::skeleton::Skeleton;
use kinopt_mesh::mesh::TriangleMesh;

/// Smallest weight that is kept.
const MIN_WEIGHT: f64 = 1e-4;

/// Bone heat weighting (Baran & Popović 2007, "Automatic rigging and animation of 3D characters"). Weights vary
/// smoothly along the surface and do not cross gaps.
///
/// The weights of bone j are the temperatures w_j in the equilibrium of heat flow over the surface and heat from the
/// bones,
///
/// ```text
/// (L + A H) w_j = A H p_j,   H_i = k_i c / d_i²
/// ```
///
/// L is the cotangent Laplacian, A_i the area of point i, d_i its distance from the nearest bone, and c the heat
/// factor. k_i is the number of bones at that distance (within 1e-4) that are visible from the point, which means
/// without skin in between.
///
/// p_ij is 1/k_i for these bones and 0 for others. Without a visible bone H_i is 0, and heat arrives from neighbours
/// only. A connected piece of skin without any visible bone uses the nearest bones.
///
/// Vertices at one position are one point, so seams stay closed. Cotangents are bounded and conductances positive, so
/// degenerate and obtuse triangles give valid weights within 0 and 1. The largest weights are kept, as by
/// [`AutomaticWeights`](super::AutomaticWeights). Results are bitwise reproducible.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct HeatWeights {
    /// c: heat factor of the bones. Larger values give stiffer skin. Above 0.
    pub heat: f64,
    /// Largest number of influences per vertex, at least 1. Four allow packed weights, but give steeper transitions at
    /// palms and shoulders, which many bones influence.
    pub most: usize,
}

impl Default for HeatWeights {
    /// Heat 1, 8 influences.
    fn default() -> Self {
        Self { heat: 1.0, most: 8 }
    }
}

impl HeatWeights {
    /// Weights for the bones of a skeleton at rest, in the mesh's frame and unit.
    ///
    /// # Errors
    /// The skeleton has no bones, the heat is not above 0, or `most` is 0.
    pub fn for_skeleton(
        &self,
        mesh: &TriangleMesh,
        skeleton: &Skeleton,
    ) -> Result<SkinWeights, SkinningError> {
        self.for_segments(mesh, &segments::of_skeleton(skeleton))
    }

    /// Weights for bones given as [tail, tip]. A bone of length 0 is a point.
    ///
    /// # Errors
    /// There are no bones, an end is not finite, the heat is not above 0, or `most` is 0. Also equations that cannot be
    /// solved in double precision.
    pub fn for_segments(
        &self,
        mesh: &TriangleMesh,
        segments: &[[DVec3; 2]],
    ) -> Result<SkinWeights, SkinningError> {
        segments::check(segments, self.most)?;
        if !(self.heat > 0.0 && self.heat.is_finite()) {
            return Err(SkinningError::Heat(self.heat));
        }
        let surface = Surface::new(mesh);
        let stiffness = Stiffness::new(&surface);
        let segments = segments
            .iter()
            .map(|ends| ends.map(|end| end / surface.unit));
        let segments: Vec<_> = segments.collect();
        let sources = Sources::new(&surface, &stiffness, &segments, self.heat);
        let mut system = HeatSystem::new(&surface, &stiffness, &sources.given)?;
        let mut strongest = Strongest::new(surface.points.len(), self.most);
        for (bone, heated) in sources.of_bones.iter().enumerate() {
            if !heated.is_empty() {
                let weights = system.solve(heated);
                let significant =
                    weights.map(|weight| if weight > MIN_WEIGHT { weight } else { 0.0 });
                strongest.add(bone, significant);
            }
        }
        let corners = surface.triangles.iter();
        let corners = corners.map(|triangle| triangle.map(|point| point as u32));
        let neighbours = Neighbours::new(surface.points.len(), corners);
        strongest.build(segments.len(), &surface.point_of, &neighbours)
    }
}
