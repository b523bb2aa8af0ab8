//! Promise: skin weights are kept as given, in order, and invalid ones are refused by name.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use kinopt::skinning::{Influence, SkinWeights, WeightsError};
use nalgebra::dmatrix;

#[test]
fn a_table_is_kept_exactly_and_sparsely() {
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
fn invalid_weights_are_refused_by_name() {
    let mut builder = SkinWeights::builder(2, 3);
    assert_eq!(
        builder.add(1, 3, 0.5),
        Err(WeightsError::BoneOutOfRange {
            vertex: 1,
            bone: 3,
            bones: 3
        })
    );
    assert_eq!(
        builder.add(2, 0, 0.5),
        Err(WeightsError::VertexOutOfRange {
            vertex: 2,
            vertices: 2
        })
    );
    assert!(matches!(
        builder.add(0, 0, f64::NAN),
        Err(WeightsError::NonFinite {
            vertex: 0,
            bone: 0,
            ..
        })
    ));

    builder.add(0, 1, 1.0).unwrap();
    assert_eq!(
        builder.clone().build(),
        Err(WeightsError::Sum {
            vertex: 1,
            sum: 0.0
        })
    );
    builder.add(1, 1, 0.5).unwrap();
    builder.add(1, 1, 0.5).unwrap();
    assert_eq!(
        builder.build(),
        Err(WeightsError::Duplicate { vertex: 1, bone: 1 })
    );

    let overflow = SkinWeights::from_table(&dmatrix![f64::MAX, f64::MAX, -f64::MAX]);
    assert!(matches!(overflow, Err(WeightsError::Sum { vertex: 0, .. })));
}

#[test]
fn an_absurd_vertex_count_is_refused_without_allocating_for_it() {
    let mut builder = SkinWeights::builder(usize::MAX, 1);
    builder.add(0, 0, 1.0).unwrap();
    assert_eq!(
        builder.build(),
        Err(WeightsError::Sum {
            vertex: 1,
            sum: 0.0
        })
    );
}
