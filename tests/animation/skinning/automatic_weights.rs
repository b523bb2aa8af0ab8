//! Promise: automatic weights follow the nearest bones, sum to 1, are smooth along edges and are reproducible.

use std::collections::BTreeSet;
use support::twisted_tube::TwistedTube;

use glam::DVec3;
use kinopt::io::rig::Rig;
use kinopt::mesh::TriangleMesh;
use kinopt::skinning::{AutomaticWeights, SkinWeights, SkinningError};
use support::skins::steepest;

fn tube() -> (TriangleMesh, [[DVec3; 2]; 2]) {
    let x = |x: f64| DVec3::new(x, 0.0, 0.0);
    let bones = [[x(0.0), x(4.0)], [x(4.0), x(8.0)]];
    (TwistedTube::default().mesh().unwrap(), bones)
}

#[test]
fn unsmoothed_weights_follow_the_formula() {
    let (mesh, bones) = tube();
    let mut plain = AutomaticWeights::default();
    plain.smoothing_steps = 0;
    let weights = plain.for_segments(&mesh, &bones).unwrap();
    let core = mesh.size() / 1000.0;
    for (vertex, p) in mesh.positions().iter().enumerate().step_by(37) {
        let [x, r] = [f64::from(p.x), f64::from(p.y).hypot(f64::from(p.z))];
        let pull = |beyond: f64| (r * r + beyond * beyond + core * core).powi(-2);
        let (left, right) = (pull((x - 4.0).max(0.0)), pull((4.0 - x).max(0.0)));
        let actual = weights.to_table()[(vertex, 1)];
        assert!(
            (actual - right / (left + right)).abs() < 1e-9,
            "vertex {vertex}: {actual}"
        );
    }
}

#[test]
fn smoothing_reduces_steps_and_keeps_sums() {
    let (mesh, bones) = tube();
    let with = |smoothing_steps| {
        let mut options = AutomaticWeights::default();
        options.smoothing_steps = smoothing_steps;
        options.falloff = 30.0;
        options.for_segments(&mesh, &bones).unwrap()
    };
    let steps = [0, 10, 100].map(|smoothing| steepest(&mesh, &with(smoothing)));
    assert!(steps[0] > steps[1] && steps[1] > steps[2], "{steps:?}");
    for influences in with(100).iter() {
        let sum: f64 = influences.iter().map(|i| i.weight).sum();
        assert!((sum - 1.0).abs() < 1e-12 && influences.iter().all(|i| i.weight > 0.0));
    }
    assert_eq!(with(10), with(10));
}

#[test]
fn smoothing_step_is_the_documented_mean() {
    let (mesh, bones) = tube();
    let with = |smoothing_steps| {
        let mut options = AutomaticWeights::default();
        options.smoothing_steps = smoothing_steps;
        options.falloff = 12.0;
        options.for_segments(&mesh, &bones).unwrap().to_table()
    };
    let [before, after] = [with(0), with(1)];
    let mut moved = 0;
    for vertex in (0..mesh.positions().len() as u32).step_by(211) {
        let around = mesh.triangles().iter().filter(|t| t.contains(&vertex));
        let others: BTreeSet<u32> = around.flatten().copied().filter(|v| *v != vertex).collect();
        let sum: f64 = others.iter().map(|v| before[(*v as usize, 1)]).sum();
        let weight = before[(vertex as usize, 1)];
        let expected = 0.5 * weight + 0.5 * sum / others.len() as f64;
        assert!((after[(vertex as usize, 1)] - expected).abs() < 1e-12);
        moved += usize::from((expected - weight).abs() > 1e-6);
    }
    assert!(moved > 5, "{moved}");
}

#[test]
fn limbs_follow_their_own_bones() {
    let rig = Rig::read(concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../models/humanoid/humanoid.json"
    ));
    let rig = rig.unwrap();
    let (mesh, given) = (rig.mesh.unwrap(), rig.weights.unwrap());
    let made = AutomaticWeights::default()
        .for_skeleton(&mesh, &rig.skeleton)
        .unwrap();
    assert_eq!(made.vertex_count(), given.vertex_count());
    assert!(made.max_influences() <= 8);
    let strongest = |weights: &SkinWeights, vertex: usize| {
        let influences = weights.influences(vertex).iter();
        influences
            .max_by(|a, b| a.weight.total_cmp(&b.weight))
            .unwrap()
            .bone as usize
    };
    // Authored weights and distance weights agree on the strongest bone, or on its neighbour in the chain.
    let parent = |bone: usize| rig.skeleton.bones()[bone].parent.map(|p| p.index());
    let agree = (0..given.vertex_count()).filter(|&vertex| {
        let (a, b) = (strongest(&given, vertex), strongest(&made, vertex));
        a == b || parent(a) == Some(b) || parent(b) == Some(a)
    });
    let share = agree.count() as f64 / given.vertex_count() as f64;
    assert!(share > 0.95, "{share}");
}

/// A palm with five finger bones, all near each other.
fn palm() -> (TriangleMesh, Vec<[DVec3; 2]>) {
    let side = 80;
    let coordinate = |k: u32| k as f32 / side as f32;
    let corners = (0..=side).flat_map(|y| (0..=side).map(move |x| (x, y)));
    let positions = corners
        .map(|(x, y)| glam::Vec3::new(coordinate(x), coordinate(y), 0.12))
        .collect();
    let squares = (0..side).flat_map(|y| (0..side).map(move |x| y * (side + 1) + x));
    let triangles = squares
        .flat_map(|k| {
            [
                [k, k + 1, k + side + 1],
                [k + 1, k + side + 2, k + side + 1],
            ]
        })
        .collect();
    let mesh = TriangleMesh::new(positions, vec![], triangles).unwrap();
    let finger = |k: f64| {
        let [x, tip] = [0.3 + 0.1 * k, 0.1 + 0.2 * k];
        [DVec3::new(x, 0.1, 0.0), DVec3::new(tip, 0.9, 0.0)]
    };
    let mut bones: Vec<_> = (0..5).map(|k| finger(f64::from(k))).collect();
    bones.push([DVec3::new(0.5, -1.0, 0.0), DVec3::new(0.5, 0.1, 0.0)]);
    (mesh, bones)
}

/// With plain pruning, the fifth influence loses its whole weight at once where it drops out.
#[test]
fn pruning_to_four_influences_is_smooth() {
    let (mesh, bones) = palm();
    let with = |max_influences: usize| {
        let mut options = AutomaticWeights::default();
        options.most = max_influences;
        options.for_segments(&mesh, &bones).unwrap()
    };
    let all = with(64);
    let (plain, _) = all.pruned(4).unwrap();
    // Increase of steps along edges by pruning.
    let added = |weights: &SkinWeights| {
        let change = weights.to_table() - all.to_table();
        let edges = mesh.triangles().iter();
        let edges = edges.flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a)]);
        let steps = edges.map(|(a, b)| (change.row(a as usize) - change.row(b as usize)).amax());
        steps.fold(0.0, f64::max)
    };
    let four = with(4);
    let from_defaults = AutomaticWeights::default().for_segments(&mesh, &bones);
    let [plain, faded, from_defaults] = [&plain, &four, &from_defaults.unwrap()].map(added);
    // Without smoothing of the pruned weights the ratio would be 0.57.
    assert!(faded < 0.54 * plain, "{plain} {faded}");
    assert!(from_defaults < 1e-6, "{plain} {from_defaults}");
    for influences in four.iter() {
        let sum: f64 = influences.iter().map(|i| i.weight).sum();
        assert!((sum - 1.0).abs() < 1e-12 && influences.iter().all(|i| i.weight > 0.0));
    }
}

/// Of pulls 1, 1/4 and 1/9 the third is dropped: remaining weights are w − t² / w, normalised.
#[test]
fn kept_weights_fade_by_the_dropped_one() {
    let dot = TriangleMesh::new(vec![glam::Vec3::ZERO], vec![], vec![]).unwrap();
    let at = |x: f64| [DVec3::X * x; 2];
    let mut two = AutomaticWeights::default();
    two.falloff = 2.0;
    two.most = 2;
    let kept_weights = |bones: &[[DVec3; 2]]| -> Vec<(u32, f64)> {
        let weights = two.for_segments(&dot, bones).unwrap();
        let influences = weights.influences(0).iter();
        influences
            .map(|influence| (influence.bone, influence.weight))
            .collect()
    };
    let [(0, first), (2, second)] = kept_weights(&[at(1.0), at(3.0), at(-2.0)])[..] else {
        panic!("the nearest two");
    };
    let [a, b] = [36.0 - 16.0 / 36.0, 9.0 - 16.0 / 9.0];
    assert!((first - a / (a + b)).abs() < 1e-12 && (second - b / (a + b)).abs() < 1e-12);
    // Equal weights have nothing to fade to.
    let equal = kept_weights(&[at(1.0), at(-1.0), [DVec3::Y; 2]]);
    assert_eq!(equal, [(0, 0.5), (1, 0.5)]);
}

#[test]
fn invalid_bones_and_falloffs_are_rejected() {
    let (mesh, bones) = tube();
    let options = AutomaticWeights::default();
    assert_eq!(
        options.for_segments(&mesh, &[]).unwrap_err(),
        SkinningError::NoBones
    );
    let mut broken = bones;
    broken[1][0].y = f64::NAN;
    assert_eq!(
        options.for_segments(&mesh, &broken).unwrap_err(),
        SkinningError::NonFiniteBone { bone: 1 }
    );
    for falloff in [0.0, -1.0, f64::INFINITY] {
        let mut options = options;
        options.falloff = falloff;
        let refused = options.for_segments(&mesh, &bones).unwrap_err();
        assert_eq!(refused, SkinningError::Falloff(falloff));
    }
    // Points, and a mesh of one point on a bone, are no special case.
    let points = [[DVec3::ZERO; 2], [DVec3::X; 2]];
    let dot = TriangleMesh::new(vec![glam::Vec3::ZERO], vec![], vec![]).unwrap();
    let weights = options.for_segments(&dot, &points).unwrap();
    assert_eq!(weights.influences(0)[0].bone, 0);
}
