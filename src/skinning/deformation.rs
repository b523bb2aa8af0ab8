//! What every way to move skin has in common.

use glam::{Vec3, Vec4};

use super::vertices::check;
use super::{PosedVertices, RestVertices, SkinningError};
use crate::mesh::TriangleMesh;
use crate::{Buffer, SizeMismatch};

/// Vertices that one thread takes at a time: enough to hide what handing them over costs.
#[cfg(feature = "rayon")]
const VERTICES_AT_A_TIME: usize = 4096;

/// Buffers of vertices of which one is there.
macro_rules! only {
    ($vertices:ident, $part:ident: $buffer:expr) => {
        $vertices {
            $part: $buffer,
            ..$vertices::default()
        }
    };
}

/// One pose, ready to move any buffers of vertices.
///
/// Each vertex depends on nothing but itself and the pose, so any cut into ranges gives the same
/// bits. Nothing allocates except [`mesh`](Self::mesh).
pub trait Deformation: Sync {
    /// How many vertices the weights know.
    fn vertex_count(&self) -> usize;

    /// Moves the vertices from number `first` on, as many as there are in the buffers, whose sizes
    /// agree. [`deform`](Self::deform) is the checked way to call it.
    fn deform_range(&self, first: usize, rest: RestVertices<'_>, posed: PosedVertices<'_>);

    /// Moves all vertices: whichever of positions, normals and tangents are there.
    ///
    /// # Errors
    /// A buffer has neither one entry per vertex nor none, or differs between rest and pose.
    fn deform(
        &self,
        rest: RestVertices<'_>,
        posed: PosedVertices<'_>,
    ) -> Result<(), SkinningError> {
        check(rest, &posed, self.vertex_count())?;
        self.deform_range(0, rest, posed);
        Ok(())
    }

    /// As [`deform`](Self::deform), over the threads of the current rayon pool, with the same bits.
    ///
    /// # Errors
    /// As [`deform`](Self::deform).
    #[cfg(feature = "rayon")]
    fn deform_parallel(
        &self,
        rest: RestVertices<'_>,
        posed: PosedVertices<'_>,
    ) -> Result<(), SkinningError> {
        let vertices = self.vertex_count();
        check(rest, &posed, vertices)?;
        halve(self, 0..vertices, rest, posed);
        Ok(())
    }

    /// Moves positions alone, in the model's own unit.
    ///
    /// # Errors
    /// As [`deform`](Self::deform).
    fn positions(&self, rest: &[Vec3], posed: &mut [Vec3]) -> Result<(), SkinningError> {
        let rest = only!(RestVertices, positions: rest);
        self.deform(rest, only!(PosedVertices, positions: posed))
    }

    /// As [`positions`](Self::positions), into a `Vec` that is made as long as the mesh has vertices.
    ///
    /// # Errors
    /// As [`deform`](Self::deform).
    fn positions_into(&self, rest: &[Vec3], posed: &mut Vec<Vec3>) -> Result<(), SkinningError> {
        self.positions(rest, posed.sized(rest.len()))
    }

    /// Turns normals alone; they come out with unit length. A normal that is zero stays zero, and
    /// one that the blend leaves without direction becomes zero.
    ///
    /// # Errors
    /// As [`deform`](Self::deform).
    fn normals(&self, rest: &[Vec3], posed: &mut [Vec3]) -> Result<(), SkinningError> {
        let rest = only!(RestVertices, normals: rest);
        self.deform(rest, only!(PosedVertices, normals: posed))
    }

    /// As [`normals`](Self::normals), into a `Vec` that is made as long as the mesh has vertices.
    ///
    /// # Errors
    /// As [`deform`](Self::deform).
    fn normals_into(&self, rest: &[Vec3], posed: &mut Vec<Vec3>) -> Result<(), SkinningError> {
        self.normals(rest, posed.sized(rest.len()))
    }

    /// Turns tangents alone; they come out with unit length, and the bitangent's sign changes where
    /// the blend mirrors.
    ///
    /// # Errors
    /// As [`deform`](Self::deform).
    fn tangents(&self, rest: &[Vec4], posed: &mut [Vec4]) -> Result<(), SkinningError> {
        let rest = only!(RestVertices, tangents: rest);
        self.deform(rest, only!(PosedVertices, tangents: posed))
    }

    /// As [`tangents`](Self::tangents), into a `Vec` that is made as long as the mesh has vertices.
    ///
    /// # Errors
    /// As [`deform`](Self::deform).
    fn tangents_into(&self, rest: &[Vec4], posed: &mut Vec<Vec4>) -> Result<(), SkinningError> {
        self.tangents(rest, posed.sized(rest.len()))
    }

    /// The posed mesh: positions, and normals where the rest mesh has them.
    ///
    /// # Errors
    /// The mesh has another number of vertices than the weights, or the result is not finite.
    fn mesh(&self, rest: &TriangleMesh) -> Result<TriangleMesh, SkinningError> {
        let vertices = self.vertex_count();
        SizeMismatch::check("rest positions", rest.positions().len(), vertices)?;
        let mut positions = vec![Vec3::ZERO; rest.positions().len()];
        let mut normals = vec![Vec3::ZERO; rest.normals().len()];
        let at_rest = RestVertices {
            positions: rest.positions(),
            normals: rest.normals(),
            tangents: &[],
        };
        let posed = PosedVertices {
            positions: &mut positions,
            normals: &mut normals,
            tangents: &mut [],
        };
        self.deform(at_rest, posed)?;
        Ok(rest.with_vertices(positions, normals)?)
    }
}

/// Both halves at once, until they are small.
#[cfg(feature = "rayon")]
fn halve<D: Deformation + ?Sized>(
    deformation: &D,
    range: std::ops::Range<usize>,
    rest: RestVertices<'_>,
    posed: PosedVertices<'_>,
) {
    let half = range.len() / 2;
    if half < VERTICES_AT_A_TIME {
        return deformation.deform_range(range.start, rest, posed);
    }
    let (rest, rest_after) = rest.split(half);
    let (posed, posed_after) = posed.split(half);
    let middle = range.start + half;
    rayon::join(
        || halve(deformation, range.start..middle, rest, posed),
        || halve(deformation, middle..range.end, rest_after, posed_after),
    );
}
