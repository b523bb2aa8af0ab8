//! Random skins that are the same in every run.

use glam::{Affine3A, Mat3A, Quat, Vec3, Vec4};
use kinopt::mesh::TriangleMesh;
use kinopt::skinning::{Deformation, PosedVertices, RestVertices, SkinWeights};

use super::random::Random;

/// Positions, normals and tangents.
#[derive(Clone, Debug, PartialEq)]
pub struct Vertices {
    pub positions: Vec<Vec3>,
    pub normals: Vec<Vec3>,
    pub tangents: Vec<Vec4>,
}

pub fn vector(random: &mut Random) -> Vec3 {
    Vec3::from_array(std::array::from_fn(|_| random.within(-1.0, 1.0) as f32))
}

impl Vertices {
    pub fn random(random: &mut Random, count: usize) -> Self {
        let mut some = |_| vector(random);
        Self {
            positions: (0..count).map(&mut some).collect(),
            normals: (0..count).map(&mut some).collect(),
            tangents: (0..count)
                .map(|k| some(k).extend(if k % 3 == 0 { -1.0 } else { 1.0 }))
                .collect(),
        }
    }

    pub fn rest(&self) -> RestVertices<'_> {
        RestVertices {
            positions: &self.positions,
            normals: &self.normals,
            tangents: &self.tangents,
        }
    }

    pub fn posed(&mut self) -> PosedVertices<'_> {
        PosedVertices {
            positions: &mut self.positions,
            normals: &mut self.normals,
            tangents: &mut self.tangents,
        }
    }

    pub fn deformed(&self, deformation: &impl Deformation) -> Self {
        let mut out = self.clone();
        deformation.deform(self.rest(), out.posed()).unwrap();
        out
    }
}

/// Random weights of 1 to `most` influences per vertex that sum to 1.
pub fn weights(random: &mut Random, vertices: usize, bones: usize, most: usize) -> SkinWeights {
    let mut builder = SkinWeights::builder(vertices, bones);
    for vertex in 0..vertices {
        let count = 1 + vertex % most.min(bones);
        for k in 0..count {
            let bone = (vertex * 5 + k) % bones;
            builder.add(vertex, bone, random.within(0.05, 1.0)).unwrap();
        }
    }
    builder.build_repaired().unwrap().0
}

pub fn rigid(random: &mut Random) -> Affine3A {
    let axis = vector(random).normalize_or(Vec3::X);
    let turn = Quat::from_axis_angle(axis, random.within(-3.0, 3.0) as f32);
    Affine3A::from_rotation_translation(turn, vector(random))
}

/// Random transform of a stretch along the axes followed by a rotation; one in four mirrors.
pub fn stretching(random: &mut Random) -> Affine3A {
    let mut scale = vector(random).abs() + 0.3;
    if random.within(0.0, 1.0) < 0.25 {
        scale.y = -scale.y;
    }
    let rigid = rigid(random);
    Affine3A {
        matrix3: rigid.matrix3 * Mat3A::from_diagonal(scale),
        translation: rigid.translation,
    }
}

/// Closed tube about x from 0 to `length`. Consecutive rings are offset by half a step, so that all triangles are acute
/// if the rings are far enough apart.
pub fn closed_tube(length: f32, radius: f32, around: u32, along: u32) -> TriangleMesh {
    let step = std::f32::consts::TAU / around as f32;
    let mut positions = Vec::new();
    for ring in 0..=along {
        for k in 0..around {
            let (sin, cos) = (step * (k as f32 + 0.5 * (ring % 2) as f32)).sin_cos();
            let x = length * ring as f32 / along as f32;
            positions.push(Vec3::new(x, radius * cos, radius * sin));
        }
    }
    let mut triangles = Vec::new();
    for ring in 0..along {
        let (low, high) = (ring * around, (ring + 1) * around);
        for k in 0..around {
            let next = (k + 1) % around;
            if ring % 2 == 0 {
                triangles.push([low + k, low + next, high + k]);
                triangles.push([low + next, high + next, high + k]);
            } else {
                triangles.push([low + k, low + next, high + next]);
                triangles.push([low + k, high + next, high + k]);
            }
        }
    }
    let ends = [0, along * around];
    for (end, first) in ends.into_iter().enumerate() {
        let centre = positions.len() as u32;
        positions.push(Vec3::X * length * end as f32);
        for k in 0..around {
            let [a, b] = [first + k, first + (k + 1) % around];
            triangles.push(if end == 0 {
                [b, a, centre]
            } else {
                [a, b, centre]
            });
        }
    }
    TriangleMesh::new(positions, Vec::new(), triangles).unwrap()
}

/// Largest difference of a bone's weight along an edge.
pub fn steepest(mesh: &TriangleMesh, weights: &SkinWeights) -> f64 {
    let table = weights.to_table();
    let edges = mesh
        .triangles()
        .iter()
        .flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a)]);
    let steps = edges.map(|(a, b)| (table.row(a as usize) - table.row(b as usize)).amax());
    steps.fold(0.0, f64::max)
}
