//! Promise: forward kinematics of any tree, under any parameter map, is the product of its transforms, to 1e-12 of the
//! coordinates' size.

use kinopt::kinematics::{ForwardKinematics, KinematicsError};
use kinopt::model::{FrameId, ParameterMap};
use kinopt::num_dual::DualSVec64;
use kinopt::scalar::Dual;
use support::dual_numbers::DualNumber;
use support::maps::maps_of;
use support::random::Random;
use support::trees::RandomTree;
use support::{apart, placement, rigid};

#[test]
fn full_trees_equal_their_transforms() {
    for seed in 0..40 {
        let tree = RandomTree::new(seed, 1 + seed as usize % 17);
        let mut random = Random::new(seed);
        let mut kinematics = ForwardKinematics::new(&tree.model);
        for _ in 0..5 {
            let q = tree.configuration(&mut random);
            let placed = kinematics.place(&q).unwrap();
            assert_eq!(placed.len(), tree.frames.len());
            for (ours, theirs) in placed.iter().zip(&tree.frames_at(&q)) {
                assert!(apart(ours, theirs) < 1e-12, "tree {seed}");
            }
        }
    }
}

#[test]
fn selected_frames_under_every_map() {
    for seed in 0..20 {
        let tree = RandomTree::new(seed, 14);
        let mut random = Random::new(seed);
        // Any selection and order of frames, one of them twice.
        let n = tree.frames.len();
        let chosen: Vec<usize> = [n - 2, 3, random.below(n), n - 1, 3].to_vec();
        let ids: Vec<FrameId> = chosen.iter().map(|&k| tree.frames[k]).collect();
        for expected in maps_of(&tree) {
            let mut kinematics =
                ForwardKinematics::under(&tree.model, &expected.map, &ids).unwrap();
            assert_eq!(kinematics.variables(), expected.map.variables());
            let x = expected.variables(&mut random);
            let q = expected.expand(&x);
            let mut own_q = vec![f64::NAN; q.len()];
            expected.map.expand(&x, &mut own_q).unwrap();
            for (actual, right) in own_q.iter().zip(&q) {
                assert!((actual - right).abs() < 1e-14, "{}", expected.name);
            }
            let placed = kinematics.place(&x).unwrap();
            let at = tree.frames_at(&q);
            for (ours, &k) in placed.iter().zip(&chosen) {
                let error = apart(ours, &at[k]);
                assert!(error < 1e-12, "tree {seed}, {}: {error:e}", expected.name);
            }
        }
    }
}

#[test]
fn placements_hold_far_from_the_origin() {
    let mut random = Random::new(3);
    let world_from_base = rigid(random.rotation(), random.direction().into_inner() * 1e6);
    for seed in 0..10 {
        let tree = RandomTree::placed(seed, 12, world_from_base);
        let mut kinematics = ForwardKinematics::new(&tree.model);
        let q = tree.configuration(&mut random);
        let placed = kinematics.place(&q).unwrap();
        for (ours, theirs) in placed.iter().zip(&tree.frames_at(&q)) {
            assert!(apart(ours, theirs) < 1e-12 * 1e6, "tree {seed}");
        }
    }
}

fn dual_values_equal_plain_ones<D: DualNumber<1>>() {
    let tree = RandomTree::new(8, 13);
    let q = tree.configuration(&mut Random::new(8));
    let duals: Vec<D> = q.iter().map(|&v| D::variable(v, 0)).collect();
    let mut kinematics = ForwardKinematics::new(&tree.model);
    let placed = kinematics.place(&duals).unwrap();
    for (ours, theirs) in placed.iter().zip(&tree.frames_at(&q)) {
        let values = ours.translation.to_array().map(|c| c.value());
        let error = (nalgebra::Vector3::from(values) - theirs.translation.vector).amax();
        assert!(error < 1e-12);
    }
}

#[test]
fn dual_number_values_equal_plain_ones() {
    dual_values_equal_plain_ones::<Dual<1>>();
    dual_values_equal_plain_ones::<DualSVec64<1>>();
}

#[test]
fn wrong_lengths_and_foreign_ids_are_named() {
    let small = RandomTree::new(1, 3).model;
    let large = RandomTree::new(2, 12);
    let foreign_frame = *large.frames.last().unwrap();
    let map = ParameterMap::identity(&large.model);
    let mut all = ForwardKinematics::<f64>::new(&small);
    let n = small.degrees_of_freedom();
    for length in [0, n - 1, n + 1] {
        let error = all.place(&vec![0.0; length]).unwrap_err();
        assert!(
            matches!(error, KinematicsError::Length { given, expected, .. }
            if given == length && expected == n)
        );
        assert!(error.to_string().contains(small.name()));
    }
    let foreign = ForwardKinematics::<f64>::of_frames(&small, &[foreign_frame]).unwrap_err();
    assert!(
        matches!(foreign, KinematicsError::ForeignFrame { index, .. } if index == foreign_frame.index())
    );
    let foreign = ForwardKinematics::<f64>::under(&small, &map, &[]).unwrap_err();
    assert!(matches!(foreign, KinematicsError::ForeignMap { .. }));
}

#[test]
fn angles_of_any_size_are_exact() {
    let tree = RandomTree::new(5, 9);
    let mut kinematics = ForwardKinematics::new(&tree.model);
    let sizes = [0.0, 1e-300, 1e-9, 1.0, 1e3, 9.9e5, 1.1e6, 1e12, 1e300];
    for size in sizes.into_iter().flat_map(|size| [size, -size]) {
        // The library's own sine and cosine are the reference, through the test trees.
        let q = vec![size; tree.model.degrees_of_freedom()];
        let placed = kinematics.place(&q).unwrap();
        for (ours, theirs) in placed.iter().zip(&tree.frames_at(&q)) {
            assert!(
                apart(ours, theirs) <= 1e-12 * size.abs().max(1.0),
                "{size:e}"
            );
        }
    }
    let nan = vec![f64::NAN; tree.model.degrees_of_freedom()];
    assert!(kinematics.place(&nan).is_err());
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
