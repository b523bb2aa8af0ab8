//! Common interface of the skinning methods.

use glam::{Vec3, Vec4};

use super::vertices::check;
use super::{PosedVertices, RestVertices, SkinningError};
use kinopt_kinematics::Buffer;
use kinopt_kinematics::SizeMismatch;
use kinopt_mesh::mesh::TriangleMesh;

/// Smallest number of vertices per thread; amortises the cost of a task.
#[cfg(feature = "rayon")]
const MIN_VERTICES_PER_TASK: usize = 4096;

/// Vertex buffers of which only one is given.
macro_rules! only {
    ($vertices:ident, $part:ident: $buffer:expr) => {
        $vertices {
            $part: $buffer,
            ..$vertices::default()
        }
    };
}

/// One pose that deforms vertex buffers.
///
/// Each vertex depends only on itself and on the pose, so any split into ranges gives bitwise equal results. Only
/// [`mesh`](Self::mesh) and growing `Vec`s allocate.
pub trait Deformation: Sync {
    /// Number of vertices of the weights.
    fn vertex_count(&self) -> usize;

    /// Deforms the vertices from index `first` on; the buffers determine their number and must agree in length.
    /// [`deform`](Self::deform) checks the lengths.
    fn deform_range(&self, first: usize, rest: RestVertices<'_>, posed: PosedVertices<'_>);

    /// Deforms all vertices: positions, normals and tangents, as far as the buffers are not empty.
    ///
    /// # Errors
    /// A buffer is neither empty nor has one entry per vertex, or its rest and posed lengths differ.
    fn deform(
        &self,
        rest: RestVertices<'_>,
        posed: PosedVertices<'_>,
    ) -> Result<(), SkinningError> {
        check(rest, &posed, self.vertex_count())?;
        self.deform_range(0, rest, posed);
        Ok(())
    }

    /// As [`deform`](Self::deform), on the threads of the current rayon pool. The results are bitwise equal.
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

    /// Deforms positions only, in the model's unit.
    ///
    /// # Errors
    /// As [`deform`](Self::deform).
    fn positions(&self, rest: &[Vec3], posed: &mut [Vec3]) -> Result<(), SkinningError> {
        let rest = only!(RestVertices, positions: rest);
        self.deform(rest, only!(PosedVertices, positions: posed))
    }

    /// As [`positions`](Self::positions), into a `Vec` that is resized to the number of vertices.
    ///
    /// # Errors
    /// As [`deform`](Self::deform).
    fn positions_into(&self, rest: &[Vec3], posed: &mut Vec<Vec3>) -> Result<(), SkinningError> {
        self.positions(rest, posed.sized(rest.len()))
    }

    /// Transforms normals only, to unit length. A zero normal stays zero, and one without a direction after the blend
    /// becomes zero.
    ///
    /// # Errors
    /// As [`deform`](Self::deform).
    fn normals(&self, rest: &[Vec3], posed: &mut [Vec3]) -> Result<(), SkinningError> {
        let rest = only!(RestVertices, normals: rest);
        self.deform(rest, only!(PosedVertices, normals: posed))
    }

    /// As [`normals`](Self::normals), into a `Vec` that is resized to the number of vertices.
    ///
    /// # Errors
    /// As [`deform`](Self::deform).
    fn normals_into(&self, rest: &[Vec3], posed: &mut Vec<Vec3>) -> Result<(), SkinningError> {
        self.normals(rest, posed.sized(rest.len()))
    }

    /// Transforms tangents only, to unit length. The bitangent sign changes if the blend mirrors.
    ///
    /// # Errors
    /// As [`deform`](Self::deform).
    fn tangents(&self, rest: &[Vec4], posed: &mut [Vec4]) -> Result<(), SkinningError> {
        let rest = only!(RestVertices, tangents: rest);
        self.deform(rest, only!(PosedVertices, tangents: posed))
    }

    /// As [`tangents`](Self::tangents), into a `Vec` that is resized to the number of vertices.
    ///
    /// # Errors
    /// As [`deform`](Self::deform).
    fn tangents_into(&self, rest: &[Vec4], posed: &mut Vec<Vec4>) -> Result<(), SkinningError> {
        self.tangents(rest, posed.sized(rest.len()))
    }

    /// The posed mesh: positions, and normals if the rest mesh has them.
    ///
    /// # Errors
    /// The mesh has a different number of vertices from the weights, or the result is not finite.
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

/// Deforms both halves of a range in parallel, recursively.
#[cfg(feature = "rayon")]
fn halve<D: Deformation + ?Sized>(
    deformation: &D,
    range: std::ops::Range<usize>,
    rest: RestVertices<'_>,
    posed: PosedVertices<'_>,
) {
    let half = range.len() / 2;
    if half < MIN_VERTICES_PER_TASK {
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
