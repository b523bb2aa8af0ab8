//! Promise: distances and depths equal those of Coal if Coal's result is certified (notebooks-ref/distances.py).

use kinopt::collision::{Shape, separation};
use kinopt::spatial::{Matrix3, Placement, Vector3};
use serde::Deserialize;

#[derive(Deserialize)]
struct Fixture {
    pairs: Vec<Pair>,
}

#[derive(Deserialize)]
struct Pair {
    shapes: [Solid; 2],
    /// Row-major.
    rotations: [[f64; 9]; 2],
    translations: [[f64; 3]; 2],
    distance: f64,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "lowercase")]
enum Solid {
    Sphere([f64; 1]),
    Capsule([f64; 2]),
    Cylinder([f64; 2]),
    Box([f64; 3]),
    Convex(Vec<[f64; 3]>),
}

impl Solid {
    fn shape(&self) -> Shape {
        match self {
            Self::Sphere([radius]) => Shape::sphere(*radius),
            Self::Capsule([radius, length]) => Shape::capsule(*radius, *length),
            Self::Cylinder([radius, length]) => Shape::cylinder(*radius, *length),
            Self::Box(size) => Shape::cuboid(*size),
            Self::Convex(points) => {
                let points: Vec<_> = points.iter().map(|&p| Vector3::from(p)).collect();
                Shape::convex(&points)
            }
        }
        .unwrap()
    }
}

#[test]
fn distances_equal_those_of_coal() {
    let text = include_str!("../reference/distances.json");
    let Fixture { pairs } = serde_json::from_str(text).unwrap();
    assert!(pairs.len() > 200);
    for (i, pair) in pairs.iter().enumerate() {
        let placement = |k: usize| {
            let [a, b, c, d, e, f, g, h, j] = pair.rotations[k];
            let columns = [[a, d, g], [b, e, h], [c, f, j]].map(Vector3::from);
            let rotation = Matrix3::from_columns(columns[0], columns[1], columns[2]);
            Placement::new(rotation, pair.translations[k].into())
        };
        let shapes = [pair.shapes[0].shape(), pair.shapes[1].shape()];
        let found = separation(&shapes[0], &placement(0), &shapes[1], &placement(1));
        let deviation = found.distance - pair.distance;
        assert!(
            deviation.abs() < 1e-10,
            "pair {i}, {:?}: {deviation:e} off {}",
            pair.shapes,
            pair.distance
        );
    }
}
