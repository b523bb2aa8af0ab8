//! Promise: skin weights are kept as given, in order. Invalid ones are rejected by name, or repaired and pruned with a
//! report.

use kinopt::skinning::{Influence, Pruning, SkinWeights, SkinningError, WeightRepair};
use nalgebra::dmatrix;
use support::fault_tables::ExpectedError;

#[test]
fn table_is_kept_exactly_and_sparsely() {
    // Slightly negative weights and sums off by rounding occur in real files.
    let table = dmatrix![
        0.25, 0.75 + 7.5e-5, -7.5e-5, 0.0;
        0.0, 0.0, 0.0, 1.0;
        0.1, 0.2, 0.3, 0.4 + 1e-12
    ];
    let weights = SkinWeights::from_table(&table).unwrap();
    assert_eq!((weights.vertex_count(), weights.bone_count()), (3, 4));
    assert_eq!(weights.max_influences(), 4);
    assert_eq!(weights.influences(0).len(), 3);
    assert_eq!(
        weights.influences(0)[2],
        Influence {
            bone: 2,
            weight: -7.5e-5
        }
    );
    assert_eq!(
        weights.influences(1),
        [Influence {
            bone: 3,
            weight: 1.0
        }]
    );
    assert_eq!(weights.influences(3), []);
    assert_eq!(weights.influences(usize::MAX - 1), []);
    assert_eq!(weights.iter().len(), 3);
    assert_eq!(weights.to_table(), table);
}

#[test]
fn triples_in_any_order_give_the_same_weights() {
    let table = dmatrix![0.25, 0.75; 1.0, 0.0];
    let mut builder = SkinWeights::builder(2, 2);
    for (vertex, bone, weight) in [(1, 0, 1.0), (0, 1, 0.75), (1, 1, 0.0), (0, 0, 0.25)] {
        builder.add(vertex, bone, weight).unwrap();
    }
    assert_eq!(
        builder.build().unwrap(),
        SkinWeights::from_table(&table).unwrap()
    );
}

#[test]
fn invalid_weights_are_rejected_by_name() {
    let mut builder = SkinWeights::builder(2, 3);
    assert_eq!(
        builder.add(1, 3, 0.5),
        Err(SkinningError::BoneOutOfRange {
            vertex: 1,
            bone: 3,
            bones: 3
        })
    );
    assert_eq!(
        builder.add(2, 0, 0.5),
        Err(SkinningError::VertexOutOfRange {
            vertex: 2,
            vertices: 2
        })
    );
    assert!(matches!(
        builder.add(0, 0, f64::NAN),
        Err(SkinningError::NonFiniteWeight {
            vertex: 0,
            bone: 0,
            ..
        })
    ));

    builder.add(0, 1, 1.0).unwrap();
    assert_eq!(
        builder.clone().build(),
        Err(SkinningError::WeightSum {
            vertex: 1,
            sum: 0.0
        })
    );
    builder.clone().build().says("sum to 0,");
    builder.add(1, 1, 0.5).unwrap();
    builder.add(1, 1, 0.5).unwrap();
    assert_eq!(
        builder.build(),
        Err(SkinningError::DuplicateWeight { vertex: 1, bone: 1 })
    );

    let overflow = SkinWeights::from_table(&dmatrix![f64::MAX, f64::MAX, -f64::MAX]);
    assert!(matches!(
        overflow,
        Err(SkinningError::WeightSum { vertex: 0, .. })
    ));
}

#[test]
fn huge_vertex_count_allocates_nothing() {
    let mut builder = SkinWeights::builder(usize::MAX, 1);
    builder.add(0, 0, 1.0).unwrap();
    assert_eq!(
        builder.build(),
        Err(SkinningError::WeightSum {
            vertex: 1,
            sum: 0.0
        })
    );
}

#[test]
fn negative_weight_is_rejected_or_repaired() {
    let mut builder = SkinWeights::builder(3, 2);
    builder.add(0, 0, 1.25).unwrap();
    builder.add(0, 1, -0.25).unwrap();
    builder.add(1, 0, 0.5).unwrap();
    builder.add(1, 1, 0.75).unwrap();
    builder.add(2, 1, 1.0).unwrap();
    assert_eq!(
        builder.clone().build(),
        Err(SkinningError::NegativeWeight {
            vertex: 0,
            bone: 1,
            weight: -0.25
        })
    );
    let (weights, repair) = builder.clone().build_repaired().unwrap();
    // Of the equal sums 1.25 the first is reported as worst.
    let expected = WeightRepair {
        negative: 1,
        rescaled: 2,
        worst: Some((0, 1.25)),
    };
    assert_eq!(repair, expected);
    assert!(!repair.is_empty());
    assert_eq!(weights.to_table(), dmatrix![1.0, 0.0; 0.4, 0.6; 0.0, 1.0]);

    let right = SkinWeights::from_table(&weights.to_table()).unwrap();
    assert_eq!(right, weights);
    let mut nothing = SkinWeights::builder(1, 2);
    nothing.add(0, 1, -1.0).unwrap();
    assert_eq!(
        nothing.build_repaired().unwrap_err(),
        SkinningError::WeightSum {
            vertex: 0,
            sum: 0.0
        }
    );
    let mut right = SkinWeights::builder(1, 2);
    right.add(0, 1, 1.0).unwrap();
    assert!(right.build_repaired().unwrap().1.is_empty());
}

/// The largest loss and the worst sum are over all vertices, in any order.
#[test]
fn worst_vertex_is_reported() {
    let weights = SkinWeights::from_table(&dmatrix![0.5, 0.25, 0.25; 0.7, 0.2, 0.1]).unwrap();
    assert!((weights.pruned(1).unwrap().1.largest_lost - 0.5).abs() < 1e-15);
    for sums in [[1.5, 0.2, 0.5], [0.2, 1.5, 0.5]] {
        let mut builder = SkinWeights::builder(3, 1);
        for (vertex, sum) in sums.into_iter().enumerate() {
            builder.add(vertex, 0, sum).unwrap();
        }
        let worst = sums.iter().position(|sum| *sum == 0.2).map(|at| (at, 0.2));
        assert_eq!(builder.build_repaired().unwrap().1.worst, worst);
    }
}

#[test]
fn pruning_keeps_the_largest_and_reports_losses() {
    let table = dmatrix![
        0.1, 0.4, 0.2, 0.3;
        0.0, 0.5, 0.5, 0.0;
        0.25, 0.25, 0.25, 0.25
    ];
    let weights = SkinWeights::from_table(&table).unwrap();
    let (two, pruning) = weights.pruned(2).unwrap();
    let bones =
        |vertex: usize| -> Vec<u32> { two.influences(vertex).iter().map(|i| i.bone).collect() };
    assert_eq!([bones(0), bones(1), bones(2)], [[1, 3], [1, 2], [0, 1]]);
    let kept_weights: Vec<f64> = two.influences(0).iter().map(|i| i.weight).collect();
    assert!(
        (kept_weights[0] - 4.0 / 7.0).abs() < 1e-15 && (kept_weights[1] - 3.0 / 7.0).abs() < 1e-15
    );
    let Pruning {
        vertices,
        largest_lost,
        mean_lost,
    } = pruning;
    assert_eq!(vertices, 2);
    assert!((largest_lost - 0.5).abs() < 1e-15);
    assert!((mean_lost - 0.8 / 3.0).abs() < 1e-15);

    let (all, pruning) = weights.pruned(4).unwrap();
    assert_eq!((all, pruning), (weights, Pruning::default()));
}

/// Weights are pruned by value, not magnitude, and divided by the kept sum: with a negative weight the lost amount is
/// not the missing sum.
#[test]
fn pruning_drops_negative_weights_first() {
    let weights = SkinWeights::from_table(&dmatrix![0.7, -0.008, 0.005, 0.303]).unwrap();
    let (three, pruning) = weights.pruned(3).unwrap();
    let influences = three.influences(0);
    let bones: Vec<u32> = influences.iter().map(|i| i.bone).collect();
    assert_eq!(bones, [0, 2, 3]);
    for (influence, weight) in influences.iter().zip([0.7, 0.005, 0.303]) {
        assert!((influence.weight - weight / 1.008).abs() < 1e-15);
    }
    assert!((pruning.largest_lost - 0.008).abs() < 1e-15);
}
