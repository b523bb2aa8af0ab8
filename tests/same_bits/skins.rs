//! Promise: so it is for skin by every blend, packed and not, stretched, in parts, of normals and tangents.
#![allow(clippy::unwrap_used)]

use glam::{Affine3A, Mat3A, Vec3, Vec4};
use kinopt::mesh::TriangleMesh;
use kinopt::skinning::{
    Deformation, DualQuaternionBlend, LinearBlend, MeshWeights, PackedDualQuaternionBlend,
    PackedLinearBlend, PackedWeights, PosedVertices, RestVertices, SkinWeights, SkinningMethod,
};
use support::random::Random;
use support::skins::{Vertices, weights};

use crate::animated::{check_single, rotation, turn, vector};
use crate::digest::{Digest, Value};

const VERTICES: usize = 53;
pub(crate) const BONES: usize = 6;

pub(crate) fn rigid(random: &mut Random) -> Affine3A {
    Affine3A::from_rotation_translation(rotation(random), vector(random, 1.0).into())
}

/// A turn after a stretch along the axes, or across them.
fn stretched(random: &mut Random) -> Affine3A {
    let mut own = rigid(random);
    let scale = Vec3::ONE + Vec3::from(vector(random, 0.5));
    let across = Mat3A::from_quat(turn(random, 0.4));
    own.matrix3 = own.matrix3 * across * Mat3A::from_diagonal(scale) * across.transpose();
    own
}

pub(crate) struct Skins {
    pub(crate) rest: Vertices,
    pub(crate) few: SkinWeights,
    pub(crate) many: SkinWeights,
    pub(crate) rigid: Vec<Affine3A>,
    pub(crate) stretched: Vec<Affine3A>,
    pub(crate) pivots: Vec<Vec3>,
}

impl Skins {
    pub(crate) fn new(seed: u64) -> Self {
        let mut random = Random::new(seed);
        let mut rest = Vertices::random(&mut random, VERTICES);
        rest.normals[3] = Vec3::ZERO;
        rest.normals[4] *= 1e-15;
        rest.tangents[5] = Vec4::new(0.0, 0.0, 0.0, -1.0);
        Self {
            few: weights(&mut random, VERTICES, BONES, 4),
            many: weights(&mut random, VERTICES, BONES, 6),
            rigid: (0..BONES).map(|_| rigid(&mut random)).collect(),
            stretched: (0..BONES).map(|_| stretched(&mut random)).collect(),
            pivots: (0..BONES)
                .map(|_| vector(&mut random, 1.0).into())
                .collect(),
            rest,
        }
    }

    /// All of a deformation: the whole, the parts one by one, and from a vertex in the middle on.
    fn posed(&self, digest: &mut Digest, blend: &dyn Deformation) {
        let (rest, mut out) = (&self.rest, self.rest.clone());
        digest.word(blend.vertex_count() as u64);
        blend.deform(rest.rest(), out.posed()).unwrap();
        add(digest, &out);
        let mut parallel = rest.clone();
        blend
            .deform_parallel(rest.rest(), parallel.posed())
            .unwrap();
        assert_eq!(parallel, out);
        let (mut positions, mut normals, mut tangents) = (Vec::new(), Vec::new(), Vec::new());
        blend
            .positions_into(&rest.positions, &mut positions)
            .unwrap();
        blend.normals_into(&rest.normals, &mut normals).unwrap();
        blend.tangents_into(&rest.tangents, &mut tangents).unwrap();
        let alone = Vertices {
            positions,
            normals,
            tangents,
        };
        assert_eq!(alone, out);
        let first = 11;
        let part = RestVertices {
            positions: &rest.positions[first..first + 21],
            normals: &rest.normals[first..first + 21],
            tangents: &rest.tangents[first..first + 21],
        };
        let mut room = (
            vec![Vec3::ZERO; 21],
            vec![Vec3::ZERO; 21],
            vec![Vec4::ZERO; 21],
        );
        let posed = PosedVertices {
            positions: &mut room.0,
            normals: &mut room.1,
            tangents: &mut room.2,
        };
        blend.deform_range(first, part, posed);
        assert_eq!(room.0, &out.positions[first..first + 21]);
        assert_eq!(room.1, &out.normals[first..first + 21]);
        assert_eq!(room.2, &out.tangents[first..first + 21]);
    }
}

fn add(digest: &mut Digest, vertices: &Vertices) {
    let directions = vertices.positions.iter().chain(&vertices.normals);
    digest.singles(directions.flat_map(|v| v.to_array()));
    digest.singles(vertices.tangents.iter().flat_map(|v| v.to_array()));
}

fn any() -> Value {
    let mut digest = Digest::new();
    for seed in [141, 142] {
        let own = Skins::new(seed);
        let mut mirrored = own.stretched.clone();
        mirrored[2].matrix3.x_axis = -mirrored[2].matrix3.x_axis;
        mirrored[1].matrix3 = Mat3A::ZERO;
        for weights in [&own.few, &own.many] {
            for transforms in [&own.rigid, &own.stretched, &mirrored] {
                let blend = LinearBlend::new(weights, transforms).unwrap();
                own.posed(&mut digest, &blend);
            }
            let blend = DualQuaternionBlend::new(weights, &own.rigid).unwrap();
            own.posed(&mut digest, &blend);
            let blend = DualQuaternionBlend::stretched(weights, &own.stretched, &own.pivots);
            own.posed(&mut digest, &blend.unwrap());
            let blend = DualQuaternionBlend::stretched(weights, &own.rigid, &own.pivots);
            own.posed(&mut digest, &blend.unwrap());
        }
    }
    digest.value()
}

fn packed() -> [Value; 2] {
    let mut both = [Digest::new(), Digest::new()];
    for (portable, digest) in both.iter_mut().enumerate() {
        let own = Skins::new(143);
        let packed = PackedWeights::new(&own.few).unwrap();
        digest.debug((packed.vertex_count(), packed.bone_count()));
        let mut linear = PackedLinearBlend::new(&packed, &own.stretched).unwrap();
        let mut dual = PackedDualQuaternionBlend::new(&packed, &own.rigid).unwrap();
        let mut stretched =
            PackedDualQuaternionBlend::stretched(&packed, &own.stretched, &own.pivots).unwrap();
        if portable == 1 {
            (linear, dual, stretched) = (linear.portable(), dual.portable(), stretched.portable());
        }
        own.posed(digest, &linear);
        own.posed(digest, &dual);
        own.posed(digest, &stretched);
        // The same memory for other poses, and what an error leaves.
        linear.set_transforms(&own.rigid).unwrap();
        own.posed(digest, &linear);
        stretched.set_transforms(&own.rigid).unwrap();
        own.posed(digest, &stretched);
        dual.set_stretched(&own.stretched, &own.pivots).unwrap();
        own.posed(digest, &dual);
        let mut odd = own.stretched.clone();
        odd[3].matrix3 = -odd[3].matrix3;
        digest.refused(dual.set_stretched(&odd, &own.pivots));
        digest.refused(dual.set_transforms(&own.stretched));
        odd[4].translation.x = f32::NAN;
        digest.refused(linear.set_transforms(&odd));
        own.posed(digest, &linear);
        own.posed(digest, &dual);
    }
    both.map(Digest::value)
}

/// A mesh of the vertices, and buffers.
fn meshes() -> Value {
    let mut digest = Digest::new();
    let own = Skins::new(144);
    let triangles = (0..VERTICES as u32 - 2)
        .map(|k| [k, k + 1, k + 2])
        .collect();
    let (positions, normals) = (own.rest.positions.clone(), own.rest.normals.clone());
    let mesh = TriangleMesh::new(positions, normals, triangles).unwrap();
    let bare = TriangleMesh::new(mesh.positions().to_vec(), vec![], mesh.triangles().to_vec());
    let many = || MeshWeights::from(own.many.clone());
    let few = || MeshWeights::from(own.few.clone());
    let all = [
        few(),
        many(),
        MeshWeights::unpacked(own.few.clone()),
        few().with_pivots(own.pivots.clone()),
        many().with_pivots(own.pivots.clone()),
    ];
    for mesh in [&mesh, &bare.unwrap()] {
        for method in SkinningMethod::ALL {
            digest.bytes(format!("{method:>5} {}", method.name()));
            let posed = method.mesh(mesh, &own.many, &own.rigid).unwrap();
            digest.debug(&posed);
            for weights in &all {
                digest.word(weights.is_packed().into());
                let posed = weights.mesh(method, mesh, &own.rigid).unwrap();
                digest.debug(&posed);
                let mut out = own.rest.clone();
                let moved = weights.deform(method, &own.stretched, own.rest.rest(), out.posed());
                digest.text(moved.map_or_else(|error| error.to_string(), |()| String::new()));
                add(&mut digest, &out);
            }
        }
    }
    digest.json(&SkinningMethod::default());
    digest.debug("dqs".parse::<SkinningMethod>().unwrap());
    digest.refused("lbd".parse::<SkinningMethod>());
    digest.value()
}

#[test]
fn of_skins() {
    let [lanes, portable] = packed();
    check_single(&[
        ("skin by any weights", any()),
        ("skin by packed weights", lanes),
        ("skin by packed weights, one vertex at a time", portable),
        ("skin of meshes", meshes()),
    ]);
}
