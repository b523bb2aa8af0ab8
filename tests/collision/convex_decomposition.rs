//! Promise: the convex decomposition of a mesh contains the mesh and its interior, and leaves cavities free.

use std::sync::atomic::{AtomicUsize, Ordering};

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

/// The U extruded from y = 0 to 1.
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

fn shapes(mesh: &str, meshes: MeshUse) -> CollisionModel {
    static COUNT: AtomicUsize = AtomicUsize::new(0);
    let (process, count) = (std::process::id(), COUNT.fetch_add(1, Ordering::Relaxed));
    let name = format!("kinopt-pieces-{process}-{count}");
    let folder = std::env::temp_dir().join(name);
    std::fs::create_dir_all(&folder).unwrap();
    std::fs::write(folder.join("u.obj"), mesh).unwrap();
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

fn holds(model: &CollisionModel, p: Vector3<f64>) -> bool {
    let distances = model.objects().iter();
    let distances = distances.map(|object| object.shape.signed_distance(p));
    distances.fold(f64::INFINITY, f64::min) <= 1e-9
}

#[test]
fn channel_stays_open() {
    let [pieces, hull] =
        [MeshUse::Pieces(16), MeshUse::Hull].map(|meshes| shapes(&channel(), meshes));
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
    // A limit of one piece gives the hull.
    assert_eq!(shapes(&channel(), MeshUse::Pieces(1)).objects().len(), 1);
}

/// A block of 4 × 4 × 4 cubes with a pocket of 2 × 2 × 2 in its top.
fn is_die_of_block(die: [i32; 3]) -> bool {
    let [x, y, z] = die;
    let inner = |along: i32| along == 1 || along == 2;
    die.iter().all(|along| (0..4).contains(along)) && !(inner(x) && inner(y) && z >= 2)
}

/// Sheared, so that cuts cross its sides obliquely.
fn leant([x, y, z]: [f64; 3]) -> Vector3<f64> {
    Vector3::new(x + 0.31 * z, y - 0.17 * x, z)
}

/// The surface sides of its cubes.
fn block() -> String {
    let (mut text, mut count) = (String::new(), 0);
    for index in 0..64 {
        let die = [index % 4, index / 4 % 4, index / 16];
        for (axis, side) in (0..3).flat_map(|axis| [(axis, 0), (axis, 1)]) {
            let mut beyond = die;
            beyond[axis] += 2 * side - 1;
            if !is_die_of_block(die) || is_die_of_block(beyond) {
                continue;
            }
            let mut around = [[0, 0], [1, 0], [1, 1], [0, 1]];
            if side == 0 {
                around.reverse();
            }
            for [a, b] in around {
                let mut corner = die;
                corner[axis] += side;
                corner[(axis + 1) % 3] += a;
                corner[(axis + 2) % 3] += b;
                let Vector3 { x, y, z } = leant(corner.map(f64::from));
                text += &format!("v {x} {y} {z}\n");
            }
            let [a, b, c, d] = [1, 2, 3, 4].map(|k| count + k);
            text += &format!("f {a} {b} {c} {d}\n");
            count += 4;
        }
    }
    text
}

/// Most of a solid's cut cross-section is interior, without surface.
#[test]
fn pieces_contain_the_interior() {
    let pieces = shapes(&block(), MeshUse::Pieces(10));
    assert!(pieces.objects().len() > 6);
    let mut random = Random::new(22);
    for _ in 0..600 {
        let p = [(); 3].map(|()| random.within(0.0, 4.0));
        let is_in = is_die_of_block(p.map(|along| along as i32));
        assert!(!is_in || holds(&pieces, leant(p)), "{p:?}");
    }
}

/// A cube of side 2 whose top is dented by `depth`, centred at `about`.
fn dented(depth: f64, about: [f64; 3]) -> String {
    let mut text = String::new();
    let mut corner = |at: [f64; 3]| {
        let [x, y, z] = [0, 1, 2].map(|k| at[k] + about[k]);
        text += &format!("v {x} {y} {z}\n");
    };
    for z in [-1.0, 1.0] {
        for [x, y] in [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]] {
            corner([x, y, z]);
        }
    }
    corner([0.0, 0.0, 1.0 - depth]);
    for [a, b] in [[1, 2], [2, 3], [3, 4], [4, 1]] {
        text += &format!("f {a} {b} {} {}\nf {} {} 9\n", b + 4, a + 4, a + 4, b + 4);
    }
    text + "f 4 3 2 1\n"
}

/// A hundredth of the diagonal of 3.46, at any origin of the mesh.
#[test]
fn nearly_convex_mesh_is_one_piece() {
    for about in [[0.0; 3], [50.0, -20.0, 30.0]] {
        for (depth, is_one) in [(0.03, true), (0.04, false)] {
            let pieces = shapes(&dented(depth, about), MeshUse::Pieces(4));
            let count = pieces.objects().len();
            assert_eq!(count == 1, is_one, "{depth} {about:?}: {count}");
        }
    }
}

/// Six blades from one corner along the axes: every planar cut leaves one flat half.
#[test]
fn uncuttable_mesh_stays_one_piece() {
    let mut blades = String::from("v 0 0 0\n");
    let (mut corners, mut faces) = (1, String::new());
    for axis in 0..3 {
        for coordinate in [-1.0, 1.37] {
            for wide in [-0.03, 0.03] {
                let mut corner = [0.0; 3];
                (corner[axis], corner[(axis + 1) % 3]) = (coordinate, wide);
                let [x, y, z] = corner;
                blades += &format!("v {x} {y} {z}\n");
            }
            faces += &format!("f 1 {} {}\n", corners + 1, corners + 2);
            corners += 2;
        }
    }
    let model = shapes(&(blades + &faces), MeshUse::Pieces(16));
    assert_eq!(model.objects().len(), 1);
    assert!(holds(&model, Vector3::new(0.3, 0.3, 0.3)));
}
