//! Promise: so it is for meshes, morph targets, blend shapes and cages.
#![allow(clippy::unwrap_used)]

use glam::{Vec3, Vec4};
use kinopt::mesh::{TriangleMesh, single_precision};
use kinopt::skinning::{BlendShapes, CageBinding, MorphTarget, MorphTargets};
use support::random::Random;

use crate::animated::{check_single, vector};
use crate::digest::{Digest, Value};

fn points(random: &mut Random, count: usize) -> Vec<Vec3> {
    (0..count).map(|_| vector(random, 1.0).into()).collect()
}

fn add(digest: &mut Digest, vectors: &[Vec3]) {
    digest.singles(vectors.iter().flat_map(|v| v.to_array()));
}

/// A box, or with a dent where its top is.
fn cage(top: f32) -> TriangleMesh {
    let corners = (0..8).map(|k: u32| {
        let side = |bit: u32| if k & bit == 0 { -1.0 } else { 1.0 };
        Vec3::new(side(1), 1.5 * side(2), side(4))
    });
    let mut corners: Vec<Vec3> = corners.collect();
    corners.push(Vec3::Z * top);
    let triangles = vec![
        [0, 2, 3],
        [0, 3, 1],
        [0, 1, 5],
        [0, 5, 4],
        [1, 3, 7],
        [1, 7, 5],
        [3, 2, 6],
        [3, 6, 7],
        [2, 0, 4],
        [2, 4, 6],
        [4, 5, 8],
        [5, 7, 8],
        [7, 6, 8],
        [6, 4, 8],
    ];
    TriangleMesh::new(corners, Vec::new(), triangles).unwrap()
}

fn meshes() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(161));
    let solid = cage(0.2);
    let mut open = solid.triangles().to_vec();
    open.pop();
    let mut twice = solid.triangles().to_vec();
    twice.push([0, 2, 3]);
    let of = |triangles| TriangleMesh::new(solid.positions().to_vec(), vec![], triangles).unwrap();
    let cloud = TriangleMesh::new(
        points(&mut random, 5),
        points(&mut random, 5),
        vec![[0, 1, 1]],
    );
    for mesh in [
        solid.clone(),
        of(open),
        of(twice),
        of(vec![]),
        cloud.unwrap(),
        TriangleMesh::default(),
    ] {
        digest.debug((mesh.bounding_box(), mesh.is_closed()));
        digest.doubles([mesh.size(), mesh.signed_volume()]);
        add(&mut digest, &mesh.vertex_normals());
        let computed = mesh.clone().with_computed_normals();
        add(&mut digest, computed.normals());
        let moved: Vec<Vec3> = mesh.positions().iter().map(|&p| p * 2.0 + 5.0).collect();
        let moved = mesh
            .with_vertices(moved, computed.normals().to_vec())
            .unwrap();
        digest.doubles([moved.size(), moved.signed_volume()]);
    }
    digest.vector(single_precision([1.0 / 3.0, -1e-50, 1e300].into()));
    let (three, nan) = (vec![Vec3::ZERO; 3], vec![Vec3::ZERO, Vec3::NAN, Vec3::ZERO]);
    digest.refused(TriangleMesh::new(nan.clone(), vec![], vec![]));
    digest.refused(TriangleMesh::new(three.clone(), nan, vec![]));
    digest.refused(TriangleMesh::new(three.clone(), vec![Vec3::X], vec![]));
    digest.refused(TriangleMesh::new(
        three.clone(),
        vec![],
        vec![[0, 1, 2], [0, 3, 1]],
    ));
    digest.refused(solid.with_vertices(three, vec![]));
    digest.value()
}

fn morphs() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(162));
    let mut target = |name: &str, vertices: Vec<u32>, normals: bool, tangents: bool| {
        let mut deltas = |given: bool| points(&mut random, if given { vertices.len() } else { 0 });
        let (p, n, t) = (deltas(true), deltas(normals), deltas(tangents));
        MorphTarget::new(name, vertices.clone(), p, n, t).unwrap()
    };
    let targets = vec![
        target("a", vec![0, 2, 5], true, true),
        target("b", vec![2, 3], false, true),
        target("c", vec![], true, false),
        target("d", vec![1, 2, 5], true, false),
    ];
    for own in &targets {
        digest.debug((own.name(), own.vertices()));
        add(&mut digest, own.position_deltas());
        add(&mut digest, own.normal_deltas());
        add(&mut digest, own.tangent_deltas());
    }
    let targets = MorphTargets::new(6, targets).unwrap();
    digest.debug((targets.vertex_count(), targets.targets().len()));
    let [p, n] = [(); 2].map(|()| points(&mut random, 6));
    let t: Vec<Vec4> = n.iter().map(|v| v.extend(-1.0)).collect();
    for weights in [
        [0.0; 4],
        [1.0, 0.0, 0.0, 0.5],
        [-0.5, 2.0, 1.0, 0.3],
        [0.0, 1.0, 0.0, 0.0],
    ] {
        let (mut p, mut n, mut t) = (p.clone(), n.clone(), t.clone());
        targets.apply(&weights, &mut p, &mut n, &mut t).unwrap();
        targets.apply(&weights, &mut [], &mut n, &mut []).unwrap();
        add(&mut digest, &p);
        add(&mut digest, &n);
        digest.singles(t.iter().flat_map(|v| v.to_array()));
    }
    digest.refused(targets.apply(&[0.0; 3], &mut [], &mut [], &mut []));
    digest.refused(targets.apply(&[0.0, f32::NAN, 0.0, 0.0], &mut [], &mut [], &mut []));
    let one = |count| vec![Vec3::ONE; count];
    digest.refused(targets.apply(&[0.0; 4], &mut one(5), &mut [], &mut []));
    digest.refused(targets.apply(&[0.0; 4], &mut [], &mut one(7), &mut []));
    digest.refused(targets.apply(&[0.0; 4], &mut [], &mut [], &mut t.clone()[..2]));
    digest.refused(MorphTargets::new(5, targets.targets().to_vec()));
    digest.debug(MorphTargets::none(3));
    digest.refused(MorphTarget::new("x", vec![1, 2], one(1), vec![], vec![]));
    digest.refused(MorphTarget::new("x", vec![1, 2], one(2), one(1), vec![]));
    digest.refused(MorphTarget::new("x", vec![1, 2], one(2), vec![], one(3)));
    digest.refused(MorphTarget::new("x", vec![2, 2], one(2), vec![], vec![]));
    let nan = vec![Vec3::ONE, Vec3::NAN];
    digest.refused(MorphTarget::new(
        "x",
        vec![1, 4],
        nan.clone(),
        vec![],
        vec![],
    ));
    digest.refused(MorphTarget::new(
        "x",
        vec![1, 4],
        one(2),
        nan.clone(),
        vec![],
    ));
    digest.refused(MorphTarget::new("x", vec![1, 4], one(2), vec![], nan));
    let mesh = |p: &[Vec3], n: &[Vec3]| TriangleMesh::new(p.to_vec(), n.to_vec(), vec![]).unwrap();
    let mut other = p.clone();
    (other[1], other[4]) = (Vec3::ONE, other[4] + 0.01);
    let mut turned = n.clone();
    turned[5] = Vec3::Y;
    for threshold in [0.0, 0.1, 10.0] {
        for [from, to] in [[&n, &turned], [&n, &n], [&Vec::new(), &turned]] {
            let between = MorphTarget::between("b", &mesh(&p, from), &mesh(&other, to), threshold);
            digest.debug(between.unwrap());
        }
    }
    digest.refused(MorphTarget::between(
        "b",
        &mesh(&p, &n),
        &mesh(&p[1..], &[]),
        0.0,
    ));
    digest.value()
}

fn blends() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(163));
    let shapes = ["calm", "smile", "frown"].map(|name| (name.to_owned(), points(&mut random, 4)));
    let shapes = BlendShapes::new(shapes.to_vec()).unwrap();
    digest.debug((shapes.names(), shapes.vertex_count()));
    let mut room = vec![Vec3::ONE; 9];
    for weights in [[1.0, 0.0, 0.0], [0.2, 0.3, 0.5], [1.5, -0.5, 0.0]] {
        shapes.blend(&weights, &mut room).unwrap();
        add(&mut digest, &room);
    }
    let meshes = [cage(0.0), cage(0.5)];
    let named = ["low", "high"].into_iter().zip(&meshes);
    let cages = BlendShapes::of_meshes(named).unwrap();
    cages.blend(&[0.25, 0.75], &mut room).unwrap();
    add(&mut digest, &room);
    digest.refused(shapes.blend(&[1.0, 0.0], &mut room));
    digest.refused(shapes.blend(&[1.0, f32::NAN, 0.0], &mut room));
    digest.refused(shapes.blend(&[0.5, 0.25, 0.0], &mut room));
    digest.refused(shapes.blend(&[1.0, 0.0, 0.0], &mut room[..2]));
    let shape = |name: &str, points: Vec<Vec3>| (name.to_owned(), points);
    digest.refused(BlendShapes::new(vec![]));
    digest.refused(BlendShapes::new(vec![
        shape("a", vec![]),
        shape("a", vec![]),
    ]));
    digest.refused(BlendShapes::new(vec![
        shape("a", vec![]),
        shape("b", vec![Vec3::X]),
    ]));
    digest.refused(BlendShapes::new(vec![shape("a", vec![Vec3::X, Vec3::NAN])]));
    digest.value()
}

fn cages() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(164));
    for top in [1.0, 0.2, 1.8] {
        let cage = cage(top);
        let mut inside = points(&mut random, 12);
        inside.extend([
            cage.positions()[3],
            cage.positions()[8],
            Vec3::new(0.3, 0.2, -1.0),
            Vec3::new(1.0, 0.4, 0.1),
            Vec3::new(0.0, -1.5, -1.0),
            Vec3::new(2.5, 0.4, 0.1),
            Vec3::new(1.4, 0.0, -1.0),
        ]);
        let binding = CageBinding::new(&cage, &inside).unwrap();
        digest.word(binding.point_count() as u64);
        for point in 0..=inside.len() {
            digest.singles(binding.coordinates(point).unwrap_or(&[]).iter().copied());
        }
        let moved: Vec<Vec3> = cage
            .positions()
            .iter()
            .zip(points(&mut random, 9))
            .map(|(&c, by)| c + by)
            .collect();
        let mut posed = Vec::new();
        binding.positions(&moved, &mut posed).unwrap();
        add(&mut digest, &posed);
        digest.refused(binding.positions(&moved[1..], &mut posed));
        digest.refused(binding.positions(&moved, &mut posed[..3]));
    }
    digest.refused(CageBinding::new(&cage(1.0), &[Vec3::ZERO, Vec3::NAN]));
    digest.refused(CageBinding::new(&TriangleMesh::default(), &[]));
    let whole = cage(1.0);
    let open = whole.triangles()[1..].to_vec();
    let open = TriangleMesh::new(whole.positions().to_vec(), vec![], open).unwrap();
    digest.refused(CageBinding::new(&open, &[]));
    let mut flat = whole.positions().to_vec();
    flat[3] = 0.5 * (flat[2] + flat[0]);
    let flat = TriangleMesh::new(flat, vec![], whole.triangles().to_vec()).unwrap();
    digest.refused(CageBinding::new(&flat, &[]));
    digest.value()
}

#[test]
fn of_shapes() {
    check_single(&[
        ("meshes", meshes()),
        ("morph targets", morphs()),
        ("blend shapes", blends()),
        ("cages", cages()),
    ]);
}
