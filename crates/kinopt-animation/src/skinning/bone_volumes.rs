//! Volume of a mesh assigned to each bone.

use glam::DVec3;

use super::{Influence, SkinWeights};
use crate::skinning::SkinningError;
use kinopt_kinematics::SizeMismatch;
use kinopt_kinematics::spatial::Vector3;
use kinopt_mesh::mesh::TriangleMesh;

/// Number of columns across the widest side of the mesh.
const COLUMNS: usize = 256;
/// Largest fraction of columns that may end inside the mesh, for meshes with small holes.
const MAX_OPEN_FRACTION: f64 = 0.01;

/// Volume of a mesh that moves with a bone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BoneVolume {
    /// Volume in cubic units of the mesh.
    pub volume: f64,
    /// Centre at rest, in the mesh's coordinates; the origin if the volume is 0.
    pub centre: Vector3<f64>,
}

/// Distributes the volume inside a closed mesh over its bones.
///
/// A grid of columns, 256 across the widest side, passes through the mesh along its narrowest side. Between entry and
/// exit of a column, weights are interpolated linearly. The sum of all volumes is the volume of the mesh up to about
/// 0.1 %. Overlapping parts count once.
///
/// # Errors
/// A different number of weights from vertices, or a mesh in which more than 1 % of the columns are open.
pub fn bone_volumes(
    mesh: &TriangleMesh,
    weights: &SkinWeights,
) -> Result<Vec<BoneVolume>, SkinningError> {
    bone_volumes_within(mesh, weights, MAX_OPEN_FRACTION)
}

/// As [`bone_volumes`], for a mesh with open parts such as clothes: open columns are left out. An error if they are more
/// than a fraction `max_open` of all columns.
pub(crate) fn bone_volumes_within(
    mesh: &TriangleMesh,
    weights: &SkinWeights,
    max_open: f64,
) -> Result<Vec<BoneVolume>, SkinningError> {
    SizeMismatch::check("weights", weights.vertex_count(), mesh.positions().len())?;
    let Some([low, high]) = mesh.bounding_box() else {
        return Err(SkinningError::OpenMesh);
    };
    let (low, high) = (low.as_dvec3(), high.as_dvec3());
    let grid = ColumnGrid::over(low, high - low);
    let mut hits: Vec<Hit> = Vec::new();
    for (triangle, corners) in mesh.triangles().iter().enumerate() {
        grid.add_hits(mesh, (triangle, *corners), &mut hits);
    }
    hits.sort_by(|a, b| a.column.cmp(&b.column).then(a.depth.total_cmp(&b.depth)));

    let mut sums = vec![(0.0, DVec3::ZERO); weights.bone_count()];
    let (mut columns, mut open) = (0_usize, 0_usize);
    for column in hits.chunk_by(|a, b| a.column == b.column) {
        columns += 1;
        if column.iter().map(|hit| i64::from(hit.sign)).sum::<i64>() != 0 {
            open += 1;
            continue;
        }
        let mut inside = 0;
        for pair in column.windows(2) {
            let [from, to] = pair else { continue };
            inside += i64::from(from.sign);
            if inside != 0 {
                grid.distribute((mesh, weights), (from, to), &mut sums);
            }
        }
    }
    let total_volume: f64 = sums.iter().map(|(volume, _)| volume).sum();
    if open as f64 > max_open * columns as f64 || total_volume <= 0.0 {
        return Err(SkinningError::OpenMesh);
    }
    let volumes = sums.into_iter().map(|(volume, moment)| {
        let centre = match volume > 0.0 {
            true => moment / volume,
            false => DVec3::ZERO,
        };
        BoneVolume {
            volume: volume.max(0.0),
            centre: Vector3::new(centre.x, centre.y, centre.z),
        }
    });
    Ok(volumes.collect())
}

/// Intersection of a column with a triangle.
#[derive(Clone, Copy, Debug)]
struct Hit {
    column: usize,
    depth: f64,
    /// 1 or −1, by the side of the triangle from which the column comes.
    sign: i8,
    triangle: usize,
    /// Barycentric coordinates of the intersection.
    barycentric: [f64; 3],
}

/// A grid of columns along one axis.
struct ColumnGrid {
    low: DVec3,
    step: f64,
    /// Two axes across the columns, then the axis along them.
    axes: [usize; 3],
    counts: [usize; 2],
}

impl ColumnGrid {
    fn over(low: DVec3, size: DVec3) -> Self {
        let size = size.to_array();
        let along = (0..3).fold(0, |shortest, axis| {
            if size[axis] < size[shortest] {
                axis
            } else {
                shortest
            }
        });
        let axes = [(along + 1) % 3, (along + 2) % 3, along];
        let widest = size[axes[0]].max(size[axes[1]]);
        let step = widest / COLUMNS as f64;
        let count = |axis: usize| match step > 0.0 {
            true => (size[axis] / step).ceil() as usize + 1,
            false => 0,
        };
        Self {
            low,
            step,
            axes,
            counts: [count(axes[0]), count(axes[1])],
        }
    }

    /// Coordinate of a column across the axis. Irregular offsets avoid vertices at regular coordinates.
    fn column_coordinate(&self, index: usize, side: usize) -> f64 {
        let offset = [0.487_213, 0.513_829][side];
        self.low.to_array()[self.axes[side]] + (index as f64 + offset) * self.step
    }

    /// Range of the columns that may meet the extent of a triangle.
    fn columns(&self, from: f64, to: f64, side: usize) -> std::ops::Range<usize> {
        let low = self.low.to_array()[self.axes[side]];
        let first = ((from - low) / self.step - 1.0).max(0.0) as usize;
        let last = ((to - low) / self.step + 1.0).max(0.0) as usize;
        first..last.min(self.counts[side])
    }

    fn add_hits(
        &self,
        mesh: &TriangleMesh,
        (triangle, corners): (usize, [u32; 3]),
        hits: &mut Vec<Hit>,
    ) {
        let projected = corners.map(|corner| {
            let position = mesh.positions()[corner as usize].as_dvec3().to_array();
            self.axes.map(|axis| position[axis])
        });
        let ends = |side: usize| {
            let extreme = |a: f64, b: &[f64; 3], is_min: bool| match is_min {
                true => a.min(b[side]),
                false => a.max(b[side]),
            };
            let low = projected
                .iter()
                .fold(f64::INFINITY, |a, b| extreme(a, b, true));
            let high = projected
                .iter()
                .fold(f64::NEG_INFINITY, |a, b| extreme(a, b, false));
            self.columns(low, high, side)
        };
        let (rows, columns) = (ends(0), ends(1));
        for i in rows {
            for j in columns.clone() {
                let point = [self.column_coordinate(i, 0), self.column_coordinate(j, 1)];
                // Barycentric coordinates from the areas opposite each corner.
                let areas = [(1, 2), (2, 0), (0, 1)].map(|(a, b)| {
                    side_of_edge(
                        point,
                        (corners[a], projected[a]),
                        (corners[b], projected[b]),
                    )
                });
                let all_positive = areas.iter().all(|area| area.is_sign_positive());
                if !all_positive && areas.iter().any(|area| area.is_sign_positive()) {
                    continue;
                }
                let total_area: f64 = areas.iter().sum();
                if total_area == 0.0 {
                    continue;
                }
                let barycentric = areas.map(|area| area / total_area);
                let depth = barycentric
                    .iter()
                    .zip(&projected)
                    .map(|(coordinate, projected)| coordinate * projected[2])
                    .sum();
                hits.push(Hit {
                    column: i * self.counts[1] + j,
                    depth,
                    sign: if all_positive { 1 } else { -1 },
                    triangle,
                    barycentric,
                });
            }
        }
    }

    /// Adds the volume between two hits of a column to the volumes and moments of their bones.
    fn distribute(
        &self,
        (mesh, weights): (&TriangleMesh, &SkinWeights),
        (from, to): (&Hit, &Hit),
        sums: &mut [(f64, DVec3)],
    ) {
        let length = to.depth - from.depth;
        let (row, column) = (from.column / self.counts[1], from.column % self.counts[1]);
        let across = [
            self.column_coordinate(row, 0),
            self.column_coordinate(column, 1),
        ];
        // A weight that falls linearly to 0 along a segment has half its volume, centred at a third.
        for (hit, depth) in [
            (from, from.depth + length / 3.0),
            (to, to.depth - length / 3.0),
        ] {
            let mut centroid = [0.0; 3];
            for (axis, value) in self.axes.into_iter().zip([across[0], across[1], depth]) {
                centroid[axis] = value;
            }
            let volume = 0.5 * length * self.step * self.step;
            let corners = mesh.triangles()[hit.triangle];
            for (corner, coordinate) in corners.into_iter().zip(hit.barycentric) {
                for &Influence { bone, weight } in weights.influences(corner as usize) {
                    if let Some((sum, moment)) = sums.get_mut(bone as usize) {
                        let part_volume = volume * coordinate * weight;
                        *sum += part_volume;
                        *moment += DVec3::from_array(centroid) * part_volume;
                    }
                }
            }
        }
    }
}

/// Twice the signed area of a point with an edge, positive on its left. The edge is oriented from the lower vertex
/// index, so a point on it lies on one side for both adjacent triangles.
fn side_of_edge(point: [f64; 2], a: (u32, [f64; 3]), b: (u32, [f64; 3])) -> f64 {
    let area = |a: [f64; 3], b: [f64; 3]| {
        let edge = [b[0] - a[0], b[1] - a[1]];
        let to_point = [point[0] - a[0], point[1] - a[1]];
        edge[0] * to_point[1] - edge[1] * to_point[0] + 0.0
    };
    match a.0 < b.0 {
        true => area(a.1, b.1),
        false => -area(b.1, a.1),
    }
}
