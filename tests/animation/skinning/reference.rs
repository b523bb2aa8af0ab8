//! Promise: skinned vertices of the shipped rigs equal another implementation to 1e-5 of the model's size.
//!
//! The methods are linear blend and dual quaternions; the reference is NumPy and SciPy in double precision.

use std::path::Path;

use glam::{Affine3A, DVec3, Vec3};
use kinopt::io::rig::Rig;
use kinopt::skinning::{
    Deformation, PackedDualQuaternionBlend, PackedLinearBlend, PackedWeights, SkinningMethod,
    single_precision_transform,
};
use serde_json::Value;

fn numbers(value: &Value) -> Vec<f64> {
    let list = value.as_array().unwrap().iter();
    list.map(|number| number.as_f64().unwrap()).collect()
}

fn reference() -> Value {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("reference/skinning.json");
    serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap()
}

fn rig(entry: &Value) -> Rig {
    let file = entry["file"].as_str().unwrap();
    Rig::read(Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(file)).unwrap()
}

fn transforms(rig: &Rig, pose: &Value) -> Vec<Affine3A> {
    let placements = rig.skeleton.pose(&numbers(&pose["q"])).unwrap();
    let transforms = placements.skinning_transforms(&rig.skeleton);
    transforms.map(|t| single_precision_transform(&t)).collect()
}

/// Largest deviation of a listed vertex.
fn largest_deviation(entry: &Value, expected: &Value, posed: &[Vec3]) -> f64 {
    let listed = entry["vertices"].as_array().unwrap().iter();
    let expected = numbers(&expected["positions"]);
    assert_eq!(expected.len(), 3 * listed.len());
    let apart = listed
        .zip(expected.chunks_exact(3))
        .map(|(vertex, expected)| {
            let posed = posed[vertex.as_u64().unwrap() as usize].as_dvec3();
            posed.distance(DVec3::from_slice(expected))
        });
    apart.fold(0.0, f64::max)
}

#[test]
fn posed_vertices_equal_the_reference() {
    for entry in reference()["rigs"].as_array().unwrap() {
        let rig = rig(entry);
        let (mesh, weights) = (rig.mesh.as_ref().unwrap(), rig.weights.as_ref().unwrap());
        for pose in entry["poses"].as_array().unwrap() {
            let transforms = transforms(&rig, pose);
            for method in SkinningMethod::ALL {
                let expected = &pose[method.name()];
                let posed = method.mesh(mesh, weights, &transforms).unwrap();
                let deviation = largest_deviation(entry, expected, posed.positions());
                assert!(
                    deviation < 1e-5 * mesh.size(),
                    "{method} {}: off by {deviation}",
                    entry["file"]
                );

                // The remaining vertices are compared by their mean and their spread about it.
                let all = || posed.positions().iter().map(|p| p.as_dvec3());
                let count = posed.positions().len() as f64;
                let centroid = all().sum::<DVec3>() / count;
                let apart = centroid.distance(DVec3::from_slice(&numbers(&expected["centroid"])));
                assert!(
                    apart < 1e-6 * mesh.size(),
                    "{method}: centroid off by {apart}"
                );
                let squares: f64 = all().map(|p| p.distance_squared(centroid)).sum();
                let spread = (squares / count).sqrt();
                let expected = expected["spread"].as_f64().unwrap();
                assert!((spread - expected).abs() < 1e-6 * mesh.size());
            }
        }
    }
}

/// The arm's vertices have at most four bones each.
#[test]
fn vertices_of_packed_weights_equal_the_reference() {
    let document = reference();
    let entries = document["rigs"].as_array().unwrap();
    let mut compared = 0;
    for entry in entries {
        let rig = rig(entry);
        let (mesh, weights) = (rig.mesh.as_ref().unwrap(), rig.weights.as_ref().unwrap());
        let Ok(packed) = PackedWeights::new(weights) else {
            continue;
        };
        for pose in entry["poses"].as_array().unwrap() {
            let transforms = transforms(&rig, pose);
            let lbs = PackedLinearBlend::new(&packed, &transforms).unwrap();
            let dqs = PackedDualQuaternionBlend::new(&packed, &transforms).unwrap();
            let ways: [(&str, &dyn Deformation); 2] = [("lbs", &lbs), ("dqs", &dqs)];
            for (name, method) in ways {
                let mut posed = mesh.positions().to_vec();
                method.positions(mesh.positions(), &mut posed).unwrap();
                let deviation = largest_deviation(entry, &pose[name], &posed);
                assert!(deviation < 1e-5 * mesh.size(), "{name}: off by {deviation}");
                compared += 1;
            }
        }
    }
    assert!(compared > 0);
}
