//! Promise: the convex pieces of a mesh hold it, inside and all, and leave its hollows free.

use kinopt::collision::{CollisionModel, MeshUse, ShapeKind};
use kinopt::robot::Robot;
use kinopt::spatial::Vector3;
use support::random::Random;

/// Corners of a U in x and z, counter-clockwise seen from -y.
const U: [[f64; 2]; 8] = [
    [0.0, 0.0],
    [3.0, 0.0],
    [3.0, 3.0],
    [2.0, 3.0],
    [2.0, 1.0],
    [1.0, 1.0],
    [1.0, 3.0],
    [0.0, 3.0],
];
const CAP: [[usize; 3]; 6] = [
    [0, 1, 4],
    [0, 4, 5],
    [1, 2, 3],
    [1, 3, 4],
    [0, 5, 6],
    [0, 6, 7],
];

/// The U from y = 0 to 1.
fn channel() -> String {
    let mut text = String::new();
    for y in [0, 1] {
        text.extend(U.map(|[x, z]| format!("v {x} {y} {z}\n")));
    }
    for [a, b, c] in CAP {
        text += &format!(
            "f {} {} {}\nf {} {} {}\n",
            a + 1,
            b + 1,
            c + 1,
            a + 9,
            c + 9,
            b + 9
        );
    }
    for i in 0..8 {
        let j = (i + 1) % 8;
        text += &format!("f {} {} {} {}\n", i + 1, i + 9, j + 9, j + 1);
    }
    text
}

fn is_in_channel(p: Vector3<f64>) -> bool {
    let inside = |x: f64, low: f64, high: f64| (low..=high).contains(&x);
    let hollow = p.x > 1.0 && p.x < 2.0 && p.z > 1.0;
    inside(p.x, 0.0, 3.0) && inside(p.y, 0.0, 1.0) && inside(p.z, 0.0, 3.0) && !hollow
}

fn shapes(meshes: MeshUse) -> CollisionModel {
    let folder =
        std::env::temp_dir().join(format!("kinopt-pieces-{}-{meshes:?}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    std::fs::write(folder.join("u.obj"), channel()).unwrap();
    let mesh = r#"<collision><geometry><mesh filename="u.obj"/></geometry></collision>"#;
    let text = format!(r#"<robot name="u"><link name="u">{mesh}</link></robot>"#);
    let robot = Robot::parse(&text, "u.urdf")
        .unwrap()
        .with_file(folder.join("u.urdf"));
    let model = CollisionModel::builder(&robot)
        .with_meshes(meshes)
        .build()
        .unwrap();
    std::fs::remove_dir_all(folder).unwrap();
    model
}

#[test]
fn a_channel_stays_open() {
    let (pieces, hull) = (shapes(MeshUse::Pieces(16)), shapes(MeshUse::Hull));
    let holds = |model: &CollisionModel, p| {
        let distances = model
            .objects()
            .iter()
            .map(|object| object.shape.signed_distance(p));
        distances.fold(f64::INFINITY, f64::min) <= 1e-9
    };
    assert!(
        (2..=16).contains(&pieces.objects().len()),
        "{}",
        pieces.objects().len()
    );
    assert!(
        pieces
            .objects()
            .iter()
            .all(|object| matches!(object.shape.kind(), ShapeKind::Convex(_)))
    );
    let mut random = Random::new(21);
    let (mut hollow, mut filled) = (0, 0);
    for _ in 0..20_000 {
        let p = Vector3::new(
            random.within(-0.5, 3.5),
            random.within(-0.5, 1.5),
            random.within(-0.5, 3.5),
        );
        if is_in_channel(p) {
            assert!(holds(&pieces, p) && holds(&hull, p), "{p:?}");
        } else if p.x > 1.0 && p.x < 2.0 && p.y > 0.0 && p.y < 1.0 && p.z > 1.0 && p.z < 3.0 {
            assert!(holds(&hull, p));
            hollow += 1;
            filled += usize::from(holds(&pieces, p));
        }
    }
    assert!(20 * filled < hollow, "{filled} of {hollow}");
    // One is the hull.
    assert_eq!(shapes(MeshUse::Pieces(1)).objects().len(), 1);
}
