//! Promise: so it is for skin by every blend, packed and not, stretched, in parts, of normals and tangents, and for boxes around it.
#![allow(clippy::unwrap_used)]

use glam::{Affine3A, Mat3A, Quat, Vec3, Vec4};
use kinopt::mesh::TriangleMesh;
use kinopt::skinning::{
    BoneBoxes, Deformation, DualQuaternion, DualQuaternionBlend, LinearBlend, MeshWeights,
    PackedDualQuaternionBlend, PackedLinearBlend, PackedWeights, PointHandle, PosedVertices,
    RestVertices, SkinWeights, SkinningMethod, TwistedTube, single_precision_transform,
};
use kinopt::spatial::Placement;
use support::random::Random;
use support::skins::{Vertices, weights};

use crate::animated::{check_single, number, rotation, turn, vector};
use crate::digest::Digest;

const VERTICES: usize = 53;
const BONES: usize = 6;

fn rigid(random: &mut Random) -> Affine3A {
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

struct Skins {
    rest: Vertices,
    few: SkinWeights,
    many: SkinWeights,
    rigid: Vec<Affine3A>,
    stretched: Vec<Affine3A>,
    pivots: Vec<Vec3>,
}

impl Skins {
    fn new(seed: u64) -> Self {
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

fn any() -> u64 {
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

fn packed() -> [u64; 2] {
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
fn meshes() -> u64 {
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
                digest.bytes(moved.map_or_else(|error| error.to_string(), |()| String::new()));
                add(&mut digest, &out);
            }
        }
    }
    digest.json(&SkinningMethod::default());
    digest.debug("dqs".parse::<SkinningMethod>().unwrap());
    digest.refused("lbd".parse::<SkinningMethod>());
    digest.value()
}

fn refused() -> u64 {
    let mut digest = Digest::new();
    let own = Skins::new(145);
    let with = |change: &dyn Fn(&mut Vec<Affine3A>)| {
        let mut changed = own.rigid.clone();
        change(&mut changed);
        changed
    };
    let short = with(&|all| all.truncate(BONES - 1));
    let nan = with(&|all| all[4].matrix3.y_axis.z = f32::NAN);
    let scaled = with(&|all| all[3].matrix3.x_axis *= 1.01);
    let sheared = with(&|all| all[2].matrix3.z_axis = all[2].matrix3.x_axis);
    let mirrored = with(&|all| all[1].matrix3.x_axis *= -1.0);
    let packed = PackedWeights::new(&own.few).unwrap();
    let mut pivots = own.pivots.clone();
    pivots[2].y = f32::NAN;
    for odd in [&short, &nan] {
        digest.refused(LinearBlend::new(&own.many, odd));
        digest.refused(PackedLinearBlend::new(&packed, odd));
    }
    for odd in [&short, &nan, &scaled, &sheared, &mirrored] {
        digest.refused(DualQuaternionBlend::new(&own.many, odd));
        digest.refused(PackedDualQuaternionBlend::new(&packed, odd));
    }
    for odd in [&short, &nan, &sheared, &mirrored] {
        digest.refused(DualQuaternionBlend::stretched(&own.many, odd, &own.pivots));
        digest.refused(PackedDualQuaternionBlend::stretched(
            &packed,
            odd,
            &own.pivots,
        ));
    }
    digest.refused(DualQuaternionBlend::stretched(
        &own.many, &own.rigid, &pivots,
    ));
    digest.refused(DualQuaternionBlend::stretched(
        &own.many,
        &own.rigid,
        &pivots[1..],
    ));
    digest.refused(PackedWeights::new(&own.many));
    digest.refused(PackedWeights::new(
        &SkinWeights::builder(0, 65_537).build().unwrap(),
    ));
    let blend = LinearBlend::new(&own.few, &own.rigid).unwrap();
    let (positions, mut room) = (&own.rest.positions, own.rest.clone());
    digest.refused(blend.positions(positions, &mut room.positions[1..]));
    digest.refused(blend.positions(&positions[1..], &mut room.positions[1..]));
    digest.refused(blend.normals(&[], &mut room.normals));
    digest.refused(blend.tangents(&own.rest.tangents, &mut []));
    let mesh = TriangleMesh::new(positions[1..].to_vec(), vec![], vec![]).unwrap();
    digest.refused(blend.mesh(&mesh));
    let mesh = TriangleMesh::new(positions.clone(), vec![], vec![]).unwrap();
    let huge = with(&|all| all[0].translation.x = f32::MAX);
    let far = with(&|all| all.iter_mut().for_each(|t| t.translation.x = f32::MAX));
    digest.debug(
        LinearBlend::new(&own.few, &huge)
            .unwrap()
            .mesh(&mesh)
            .is_ok(),
    );
    let doubled = with(&|all| all.iter_mut().for_each(|t| t.matrix3 *= f32::MAX));
    digest.debug(
        LinearBlend::new(&own.few, &far)
            .unwrap()
            .mesh(&mesh)
            .is_ok(),
    );
    digest.refused(LinearBlend::new(&own.few, &doubled).unwrap().mesh(&mesh));
    for odd in [Quat::from_xyzw(0.0, 0.0, 0.0, 0.0), Quat::NAN] {
        digest.refused(DualQuaternion::from_rotation_translation(odd, Vec3::ONE));
    }
    digest.refused(BoneBoxes::new(&own.few, &positions[1..]));
    let mut odd = positions.clone();
    odd[7].z = f32::INFINITY;
    digest.refused(BoneBoxes::new(&own.few, &odd));
    let boxes = BoneBoxes::new(&own.few, positions).unwrap();
    digest.refused(boxes.linear_blend(&short));
    digest.refused(boxes.linear_blend(&nan));
    digest.value()
}

fn parts() -> u64 {
    let (mut digest, mut random) = (Digest::new(), Random::new(146));
    let own = Skins::new(147);
    for transforms in [&own.rigid, &own.stretched] {
        let boxes = BoneBoxes::new(&own.many, &own.rest.positions).unwrap();
        digest.debug(boxes.linear_blend(transforms).unwrap());
    }
    // A bone that moves nothing, and weights below 0.
    let mut builder = SkinWeights::builder(2, 3);
    builder.add(0, 0, 1.005).unwrap();
    builder.add(0, 2, -0.005).unwrap();
    builder.add(1, 2, 1.0).unwrap();
    let odd = builder.build().unwrap();
    let boxes = BoneBoxes::new(&odd, &own.rest.positions[..2]).unwrap();
    digest.debug(boxes.linear_blend(&own.rigid[..3]).unwrap());
    let none = SkinWeights::builder(0, 1).build().unwrap();
    digest.debug(
        BoneBoxes::new(&none, &[])
            .unwrap()
            .linear_blend(&own.rigid[..1])
            .unwrap(),
    );
    // Equal weights, where the first bone leads.
    let mut builder = SkinWeights::builder(1, 4);
    (0..4).for_each(|bone| builder.add(0, bone, 0.25).unwrap());
    let equal = builder.build().unwrap();
    let packed = PackedWeights::new(&equal).unwrap();
    for _ in 0..20 {
        let transforms: Vec<Affine3A> = (0..4).map(|_| rigid(&mut random)).collect();
        let any = DualQuaternionBlend::new(&equal, &transforms).unwrap();
        let packed = PackedDualQuaternionBlend::new(&packed, &transforms).unwrap();
        let mut out = [Vec3::ZERO];
        any.positions(&own.rest.positions[..1], &mut out).unwrap();
        digest.vector(out[0]);
        packed
            .positions(&own.rest.positions[..1], &mut out)
            .unwrap();
        digest.vector(out[0]);
    }
    for _ in 0..5 {
        let [p, v, at] = [(); 3].map(|()| Vec3::from(vector(&mut random, 2.0)));
        let turned = rotation(&mut random) * 3.0;
        let one = DualQuaternion::from_rotation_translation(turned, at).unwrap();
        let other = DualQuaternion::from_rotation_translation(rotation(&mut random), v).unwrap();
        let sum = one * 0.3 + other * 0.7;
        for motion in [one, other, sum] {
            digest.debug(motion);
            digest.vector(motion.transform_point(p));
            digest.vector(motion.transform_vector(v));
        }
        let linear = Mat3A::from_quat(turned.normalize()) * 1.5;
        let handle = PointHandle::at(p).moved_to(v).turned_by(linear);
        digest.affines(&PointHandle::transforms(&[handle, PointHandle::at(at)]));
        let placed =
            Placement::translation([0.1, f64::from(number(&mut random, 1.0)), 1e10].into());
        digest.affine(&single_precision_transform(&placed));
    }
    for tube in [
        TwistedTube::default(),
        TwistedTube {
            radius: 0.3,
            length: 2.0,
            blended_share: 0.0,
            sides: 2,
            rings: 1,
        },
        TwistedTube {
            sides: 5,
            rings: 4,
            blended_share: 0.8,
            ..TwistedTube::default()
        },
    ] {
        let (mesh, weights) = (tube.mesh().unwrap(), tube.weights().unwrap());
        let transforms = TwistedTube::transforms(2.0);
        digest.affines(&transforms);
        let posed = SkinningMethod::LinearBlend.mesh(&mesh, &weights, &transforms);
        let posed = posed.unwrap();
        digest.singles(posed.positions().iter().flat_map(|v| v.to_array()));
        digest.singles(posed.normals().iter().flat_map(|v| v.to_array()));
        digest.debug(posed.triangles());
        let radii = tube.ring_radii(&posed);
        digest.doubles(
            radii
                .into_iter()
                .flat_map(|(along, radius)| [along, radius]),
        );
    }
    let endless = TwistedTube {
        length: f64::INFINITY,
        blended_share: f64::NAN,
        ..TwistedTube::default()
    };
    digest.refused(endless.mesh());
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
        ("skin: what is refused", refused()),
        ("skin: what it is made of", parts()),
    ]);
}
