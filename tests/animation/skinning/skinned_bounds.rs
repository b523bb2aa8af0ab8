//! Promise: the bounding box from bone boxes contains every vertex of linear blend skinning.

use glam::{Affine3A, Vec3};
use kinopt::skinning::{BoneBoxes, Deformation, LinearBlend, SkinWeights, SkinningError};
use support::random::Random;
use support::skins::{Vertices, rigid, stretching, weights};

/// Some weights are slightly negative, as smooth ones may be.
fn undershooting(random: &mut Random, vertices: usize, bones: usize) -> SkinWeights {
    let mut builder = SkinWeights::builder(vertices, bones);
    for vertex in 0..vertices {
        let below = random.within(-0.0099, 0.0);
        let share = random.within(0.0, 1.0) * (1.0 - below);
        for (k, weight) in [below, share, 1.0 - below - share].into_iter().enumerate() {
            builder.add(vertex, (vertex + k) % bones, weight).unwrap();
        }
    }
    builder.build().unwrap()
}

fn inside(posed: &[Vec3], [low, high]: [Vec3; 2]) {
    for p in posed {
        assert!(
            p.cmpge(low).all() && p.cmple(high).all(),
            "{p} outside {low} {high}"
        );
    }
}

#[test]
fn bounds_contain_every_vertex() {
    let mut random = Random::new(5);
    for round in 0..60 {
        let bones = 3 + round % 9;
        let weights = match round % 2 {
            0 => weights(&mut random, 200, bones, 6),
            _ => undershooting(&mut random, 200, bones),
        };
        let rest = Vertices::random(&mut random, 200).positions;
        let transform = [rigid, stretching][round % 3 / 2];
        let transforms: Vec<Affine3A> = (0..bones).map(|_| transform(&mut random)).collect();
        let boxes = BoneBoxes::new(&weights, &rest).unwrap();
        let bounds = boxes.linear_blend(&transforms).unwrap().unwrap();
        let mut posed = rest.clone();
        let blend = LinearBlend::new(&weights, &transforms).unwrap();
        blend.positions(&rest, &mut posed).unwrap();
        inside(&posed, bounds);
    }
}

/// With weights −0.009 and 1.009 a vertex moves beyond both bones; the box contains it and is only slightly larger.
#[test]
fn bounds_contain_vertices_beyond_their_bones() {
    let mut builder = SkinWeights::builder(1, 2);
    builder.add(0, 0, -0.009).unwrap();
    builder.add(0, 1, 1.009).unwrap();
    let weights = builder.build().unwrap();
    let rest = [Vec3::new(1.0, 2.0, 3.0)];
    let boxes = BoneBoxes::new(&weights, &rest).unwrap();
    for distance in [10.0, -10.0] {
        let transforms = [
            Affine3A::IDENTITY,
            Affine3A::from_translation(Vec3::X * distance),
        ];
        let mut posed = rest;
        let blend = LinearBlend::new(&weights, &transforms).unwrap();
        blend.positions(&rest, &mut posed).unwrap();
        assert!((posed[0].x - (1.0 + 1.009 * distance)).abs() < 1e-5);
        let bounds = boxes.linear_blend(&transforms).unwrap().unwrap();
        inside(&posed, bounds);
        let [low, high] = bounds;
        assert!((high - low).x < 1.05 * 10.0 && (high - low).y < 0.01);
    }
}

#[test]
fn bounds_of_one_resting_bone_are_exact() {
    let mut random = Random::new(6);
    let weights = weights(&mut random, 100, 1, 1);
    let rest = Vertices::random(&mut random, 100).positions;
    let boxes = BoneBoxes::new(&weights, &rest).unwrap();
    let [low, high] = boxes.linear_blend(&[Affine3A::IDENTITY]).unwrap().unwrap();
    let fold = |start: Vec3, pick: fn(Vec3, Vec3) -> Vec3| rest.iter().copied().fold(start, pick);
    assert!((low - fold(Vec3::MAX, Vec3::min)).length() < 1e-4);
    assert!((high - fold(Vec3::MIN, Vec3::max)).length() < 1e-4);
}

#[test]
fn empty_mesh_has_no_bounds() {
    let empty = SkinWeights::builder(0, 2).build().unwrap();
    let boxes = BoneBoxes::new(&empty, &[]).unwrap();
    assert_eq!(boxes.linear_blend(&[Affine3A::IDENTITY; 2]), Ok(None));
    assert!(matches!(
        boxes.linear_blend(&[]),
        Err(SkinningError::Size(size)) if (size.given, size.expected) == (0, 2)
    ));
    assert!(matches!(
        BoneBoxes::new(&empty, &[Vec3::ONE]),
        Err(SkinningError::Size(size)) if size.given == 1
    ));
    // A NaN box would contain nothing and hide the fault.
    let weights = weights(&mut Random::new(7), 2, 1, 1);
    let broken = BoneBoxes::new(&weights, &[Vec3::ONE, Vec3::NAN]).unwrap_err();
    assert_eq!(broken, SkinningError::NonFinitePosition { vertex: 1 });
}
