//! Promise: blend shapes give the weighted mean of whole poses. Weights that do not sum to 1 are rejected, and morph
//! targets relative to one of the shapes give the same mesh.

use glam::{DVec3, Vec3, Vec4};
use kinopt::animation::curve::{KeyedCurve, TensionContinuityBias};
use kinopt::mesh::TriangleMesh;
use kinopt::skinning::{BlendShapes, MorphTarget, MorphTargets, SkinningError};
use support::random::Random;

const SHAPES: usize = 4;
const VERTICES: usize = 30;

fn shape(random: &mut Random) -> Vec<Vec3> {
    let position = |_| {
        let [x, y, z] = <[f64; 3]>::from(random.vector(2.0)).map(|v| v as f32);
        Vec3::new(x, y, z)
    };
    (0..VERTICES).map(position).collect()
}

fn named(shapes: &[Vec<Vec3>]) -> BlendShapes {
    let list = shapes.iter().enumerate();
    BlendShapes::new(
        list.map(|(k, s)| (format!("shape {k}"), s.clone()))
            .collect(),
    )
    .unwrap()
}

fn weights(random: &mut Random) -> [f32; SHAPES] {
    let mut shape_weights = [0.0; SHAPES];
    for weight in &mut shape_weights[1..] {
        *weight = random.within(-0.4, 0.9) as f32;
    }
    shape_weights[0] = 1.0 - shape_weights[1..].iter().sum::<f32>();
    shape_weights
}

#[test]
fn mesh_is_the_weighted_mean_of_its_shapes() {
    let mut random = Random::new(1);
    for _ in 0..20 {
        let list: Vec<_> = (0..SHAPES).map(|_| shape(&mut random)).collect();
        let (shapes, w) = (named(&list), weights(&mut random));
        let mut mixed = vec![Vec3::NAN; VERTICES];
        shapes.blend(&w, &mut mixed).unwrap();
        for (vertex, actual) in mixed.iter().enumerate() {
            let exact: DVec3 = (0..SHAPES)
                .map(|j| list[j][vertex].as_dvec3() * f64::from(w[j]))
                .sum();
            assert!((actual.as_dvec3() - exact).length() < 2e-6);
        }
        // A single full weight gives that shape exactly.
        for j in 0..SHAPES {
            let mut full = [0.0; SHAPES];
            full[j] = 1.0;
            shapes.blend(&full, &mut mixed).unwrap();
            assert_eq!(mixed, list[j]);
        }
    }
}

#[test]
fn common_displacement_is_kept() {
    // A common displacement of all shapes displaces the mean equally; a weight sum of 0.9 would scale it.
    let mut random = Random::new(2);
    let list: Vec<_> = (0..SHAPES).map(|_| shape(&mut random)).collect();
    let offset = Vec3::new(10.0, -20.0, 5.0);
    let moved: Vec<Vec<Vec3>> = list
        .iter()
        .map(|shape| shape.iter().map(|p| *p + offset).collect())
        .collect();
    let w = weights(&mut random);
    let (mut positions, mut moved_positions) =
        (vec![Vec3::ZERO; VERTICES], vec![Vec3::ZERO; VERTICES]);
    named(&list).blend(&w, &mut positions).unwrap();
    named(&moved).blend(&w, &mut moved_positions).unwrap();
    for (position, moved_position) in positions.iter().zip(&moved_positions) {
        assert!((*moved_position - *position - offset).length() < 2e-5);
    }
}

#[test]
fn morph_targets_from_the_first_shape_agree() {
    let mut random = Random::new(3);
    let meshes: Vec<TriangleMesh> = (0..SHAPES)
        .map(|_| TriangleMesh::new(shape(&mut random), vec![], vec![[0, 1, 2]]).unwrap())
        .collect();
    let names = ["rest", "a", "b", "c"];
    let shapes = BlendShapes::of_meshes(names.into_iter().zip(&meshes)).unwrap();
    assert_eq!(
        (shapes.names(), shapes.vertex_count()),
        (&names.map(String::from)[..], VERTICES)
    );
    let targets = names.iter().zip(&meshes).skip(1);
    let targets = targets.map(|(name, mesh)| MorphTarget::between(*name, &meshes[0], mesh, 0.0));
    let targets = targets.collect::<Result<_, _>>().unwrap();
    let targets = MorphTargets::new(VERTICES, targets).unwrap();
    for _ in 0..20 {
        let w = weights(&mut random);
        let mut by_targets = meshes[0].positions().to_vec();
        targets
            .apply(&w[1..], &mut by_targets, &mut [], &mut [])
            .unwrap();
        let mut by_shapes = vec![Vec3::ZERO; VERTICES];
        shapes.blend(&w, &mut by_shapes).unwrap();
        for (a, b) in by_targets.iter().zip(&by_shapes) {
            assert!((*a - *b).length() < 5e-6, "{a} {b}");
        }
    }
}

#[test]
fn weight_sums_of_one_hold_between_keys() {
    // Every interpolation is linear in its values and reproduces constants.
    let mut random = Random::new(4);
    let shapes = named(&(0..SHAPES).map(|_| shape(&mut random)).collect::<Vec<_>>());
    let times = vec![0.0, 0.4, 1.9, 2.0, 4.5];
    let keys: Vec<Vec4> = times
        .iter()
        .map(|_| Vec4::from_array(weights(&mut random)))
        .collect();
    let tcb = TensionContinuityBias {
        tension: 0.3,
        continuity: -0.6,
        bias: 0.2,
    };
    for curve in [
        KeyedCurve::step(times.clone(), keys.clone()),
        KeyedCurve::linear(times.clone(), keys.clone()),
        KeyedCurve::catmull_rom(times.clone(), keys.clone()),
        KeyedCurve::kochanek_bartels(times, keys, &[tcb; 5]),
    ] {
        let curve = curve.unwrap();
        for frame in 0..=90 {
            let weights = curve.at(0.05 * frame as f32).to_array();
            let mut mixed = vec![Vec3::ZERO; VERTICES];
            shapes.blend(&weights, &mut mixed).unwrap();
        }
    }
}

#[test]
fn invalid_shapes_are_rejected_by_name() {
    let pair = |first: &str, second: &str, last: Vec3, count: usize| {
        BlendShapes::new(vec![
            (first.into(), vec![Vec3::ZERO; 2]),
            (
                second.into(),
                [vec![Vec3::X; count - 1], vec![last]].concat(),
            ),
        ])
    };
    let says = |error: SkinningError, words: &[&str]| {
        let text = error.to_string();
        assert!(words.iter().all(|word| text.contains(word)), "{text}");
    };
    assert_eq!(BlendShapes::new(vec![]), Err(SkinningError::NoShapes));
    says(pair("a", "a", Vec3::X, 2).unwrap_err(), &["`a`", "twice"]);
    says(pair("a", "b", Vec3::X, 3).unwrap_err(), &["`b`", "3", "2"]);
    says(
        pair("a", "b", Vec3::NAN, 2).unwrap_err(),
        &["`b`", "vertex 1"],
    );

    let shapes = pair("calm", "smile", Vec3::X, 2).unwrap();
    let mut out = [Vec3::ONE; 2];
    for (weights, words) in [
        (&[1.0][..], ["1 weights", "calm, smile"]),
        (&[0.5, f32::NAN], ["`smile`", "not finite"]),
        (&[0.5, 0.4], ["sum to 0.9", "not to 1"]),
        (&[1.0, 1.0], ["sum to 2", "not to 1"]),
    ] {
        says(shapes.blend(weights, &mut out).unwrap_err(), &words);
    }
    says(
        shapes.blend(&[0.5, 0.5], &mut [Vec3::ONE; 3]).unwrap_err(),
        &["3 positions", "expected 2"],
    );
    assert_eq!(out, [Vec3::ONE; 2]);
    // A sum of 1 within rounding is accepted.
    shapes.blend(&[0.3, 1.0 - 0.3 + 5e-7], &mut out).unwrap();
}
