//! Promise: forward kinematics of any tree, under any parameter map, is the product of its
//! transforms, to 1e-12 of the size of the coordinates.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod support;

use kinopt::kinematics::{Tree, TreeState};
use kinopt::model::{FrameId, ParameterMap};
use kinopt::scalar::Dual;
use support::maps::maps_of;
use support::random::Random;
use support::trees::RandomTree;
use support::{apart, placement, rigid};

#[test]
fn full_trees() {
    for seed in 0..40 {
        let tree = RandomTree::new(seed, 1 + seed as usize % 17);
        let mut random = Random::new(seed);
        let map = ParameterMap::identity(&tree.model);
        let compiled = Tree::new(&tree.model, &map, &tree.frames);
        let mut state = TreeState::new(&compiled);
        for _ in 0..5 {
            let q = tree.configuration(&mut random);
            compiled.forward(&q, &mut state);
            for (ours, theirs) in state.frames().iter().zip(&tree.frames_at(&q)) {
                assert!(apart(ours, theirs) < 1e-12, "tree {seed}");
            }
        }
    }
}

#[test]
fn some_frames_of_a_tree_under_every_map() {
    for seed in 0..20 {
        let tree = RandomTree::new(seed, 14);
        let mut random = Random::new(seed);
        // Any choice and order of frames, one of them twice.
        let n = tree.frames.len();
        let chosen: Vec<usize> = [n - 2, 3, random.below(n), n - 1, 3].to_vec();
        let ids: Vec<FrameId> = chosen.iter().map(|&k| tree.frames[k]).collect();
        for expected in maps_of(&tree) {
            let compiled = Tree::new(&tree.model, &expected.map, &ids);
            assert!(compiled.moving_joints() <= tree.model.degrees_of_freedom());
            let mut state = TreeState::new(&compiled);
            let x = expected.variables(&mut random);
            let q = expected.expand(&x);
            let mut own_q = vec![f64::NAN; q.len()];
            expected.map.expand(&x, &mut own_q);
            for (own, right) in own_q.iter().zip(&q) {
                assert!((own - right).abs() < 1e-14, "{}", expected.name);
            }
            compiled.forward(&x, &mut state);
            let at = tree.frames_at(&q);
            for (ours, &k) in state.frames().iter().zip(&chosen) {
                let error = apart(ours, &at[k]);
                assert!(error < 1e-12, "tree {seed}, {}: {error:e}", expected.name);
            }
        }
    }
}

#[test]
fn far_from_the_origin() {
    let mut random = Random::new(3);
    let away = rigid(random.rotation(), random.direction().into_inner() * 1e6);
    for seed in 0..10 {
        let tree = RandomTree::placed(seed, 12, away);
        let map = ParameterMap::identity(&tree.model);
        let compiled = Tree::new(&tree.model, &map, &tree.frames);
        let mut state = TreeState::new(&compiled);
        let q = tree.configuration(&mut random);
        compiled.forward(&q, &mut state);
        for (ours, theirs) in state.frames().iter().zip(&tree.frames_at(&q)) {
            assert!(apart(ours, theirs) < 1e-12 * 1e6, "tree {seed}");
        }
    }
}

#[test]
fn values_on_dual_numbers_are_the_plain_ones() {
    let tree = RandomTree::new(8, 13);
    let map = ParameterMap::identity(&tree.model);
    let compiled = Tree::new(&tree.model, &map, &tree.frames);
    let q = tree.configuration(&mut Random::new(8));
    let duals: Vec<Dual<1>> = q.iter().map(|&v| Dual::variable(v, 0)).collect();
    let mut state = TreeState::new(&compiled);
    compiled.forward(&duals, &mut state);
    for (ours, theirs) in state.frames().iter().zip(&tree.frames_at(&q)) {
        let values = ours.translation.to_array().map(|c| c.value());
        let error = (nalgebra::Vector3::from(values) - theirs.translation.vector).amax();
        assert!(error < 1e-12);
    }
}

#[test]
fn placements_multiply_and_invert_as_isometries() {
    let mut random = Random::new(4);
    for _ in 0..100 {
        let (a, b) = (random.rigid(2.0), random.rigid(2.0));
        assert!(apart(&(placement(&a) * placement(&b)), &(a * b)) < 1e-15 * 10.0);
        assert!(apart(&placement(&a).inverse(), &a.inverse()) < 1e-15 * 10.0);
    }
}
