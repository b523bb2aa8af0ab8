//! Promise: worlds are read from JSON files and MoveIt scenes as written, JSON round trips are exact, and errors name
//! the location.

use kinopt::collision::{Checker, Shape, ShapeKind, World, separation};
use kinopt::spatial::{Placement, Vector3};
use nalgebra as na;
use support::fault_tables::ExpectedError;
use support::fault_tables::faults;
use support::random::Random;

const SCENE: &str = "
name: \"\"
robot_model_name: panda
robot_state:
  attached_collision_objects:
    - link_name: panda_hand
      object:
        id: pen
        primitives:
          - type: cylinder
            dimensions: [0.12, 0.004]
        primitive_poses:
          - position: [0, 0, 0.1]
            orientation: [0, 0.7071067811865476, 0, 0.7071067811865476]
world:
  collision_objects:
    - id: Can1
      primitive_poses:
        - position: [0.5, 0.25, -0.375]
          orientation: [0, 0, 0.6, 0.8]
      primitives:
        - type: cylinder
          dimensions: [0.14, 0.03]
    - primitive_poses:
        - position: {x: 1, y: 2, z: 3}
        - orientation: {x: 0, y: 0, z: 0, w: 1}
      id: shelf
      pose: {position: [0, 0, 10]}
      primitives: [{type: box, dimensions: [1, 2, 3]}, {type: sphere, dimensions: [0.5]}]
";

#[test]
fn planning_scene_is_read() {
    let world = World::from_moveit(SCENE.as_bytes(), "scene.yaml").unwrap();
    let names: Vec<_> = world.obstacles().map(|o| o.name.as_str()).collect();
    assert_eq!(names, ["Can1", "shelf/0", "shelf/1", "pen"]);
    let can = world.obstacle("Can1").unwrap();
    let ShapeKind::Cylinder { radius, length } = *can.shape.kind() else {
        panic!("{can:?}")
    };
    assert_eq!((radius, length), (0.03, 0.14));
    // 2 atan(0.6 / 0.8) about z: cosine 0.28, sine 0.96.
    let x = can.placement.rotation.x.to_array();
    let turned = na::Vector3::from(x) - na::Vector3::new(0.28, 0.96, 0.0);
    assert!(turned.norm() < 1e-15, "{x:?}");
    let position_of = |name: &str| {
        world
            .obstacle(name)
            .unwrap()
            .placement
            .translation
            .to_array()
    };
    assert_eq!(position_of("shelf/0"), [1.0, 2.0, 13.0]);
    assert_eq!(position_of("shelf/1"), [0.0, 0.0, 10.0]);
    let pen = world.obstacle("pen").unwrap();
    assert_eq!(pen.attached.as_deref(), Some("panda_hand"));
    assert_eq!(pen.placement.translation.to_array(), [0.0, 0.0, 0.1]);
}

/// One obstacle of every kind at random placements.
fn any_world(random: &mut Random) -> World {
    let mut world = World::new();
    let tetrahedron: Vec<Vector3<f64>> =
        [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
            .map(Vector3::from)
            .to_vec();
    let faces = vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]];
    let shapes = [
        Shape::points(tetrahedron.clone(), 0.01),
        Shape::sphere(random.within(0.1, 1.0)),
        Shape::cuboid([0.1, random.within(0.1, 1.0), 0.3]),
        Shape::capsule(0.1, 1.0 / 3.0),
        Ok(Shape::half_space()),
        Shape::cylinder(0.1, 0.7),
        Shape::mesh(tetrahedron.clone(), faces),
        Shape::convex(&tetrahedron),
        Shape::height_field(vec![0.1, 0.2, 0.3, 0.4, 0.5, 0.7], 3, [0.5, 0.25]),
    ];
    for (i, shape) in shapes.into_iter().enumerate() {
        let rotation = na::Matrix3::from(random.rotation());
        let at = Placement::new(rotation.into(), random.vector(2.0).into());
        let name = format!("thing {i}");
        world.add(&name, shape.unwrap(), at).unwrap();
        if i == 2 {
            world.attach(&name, "hand", at).unwrap();
        }
    }
    world
}

#[test]
fn json_round_trip_is_exact() {
    let mut random = Random::new(5);
    for _ in 0..20 {
        let world = any_world(&mut random);
        let text = world.to_json();
        let again = World::from_json(text.as_bytes(), "again").unwrap();
        assert_eq!(again.to_json(), text);
        assert_eq!(again.len(), world.len());
        let probe = Shape::sphere(0.25).unwrap();
        for (one, other) in world.obstacles().zip(again.obstacles()) {
            assert_eq!(one.name, other.name);
            assert_eq!(one.attached, other.attached);
            assert_eq!(one.placement, other.placement);
            let at = Placement::translation(random.vector(2.0).into());
            let distance_of = |o: &kinopt::collision::Obstacle| {
                separation(&probe, &at, &o.shape, &o.placement).distance
            };
            assert!(
                (distance_of(one) - distance_of(other)).abs() < 1e-14,
                "{}",
                one.name
            );
        }
    }
}

/// Worlds, the location of their fault, and what is reported.
const JSON_FAULTS: &str = r#"
{"boxs": []} | boxs | unknown field
[] | line 1 | expected an object
{"boxes": [["a", [1, 1, 1]]]} | boxes[0] | expected an object
{"boxes": [{"name": " ", "size": [1, 1, 1]}]} | boxes[0] | needs a name
{"boxes": [{"name": "a", "size": [1, 2]}]} | boxes[0].size | length 2
{"boxes": [{"name": "a", "size": [1, 0, 2]}]} | boxes[0] | along y is 0
{"spheres": [{"name": "a", "radius": -1}]} | spheres[0] | radius of the sphere is -1
{"spheres": [{"name": "a", "radius": 1}], "boxes": [{"name": "a", "size": [1,1,1]}]} | spheres[0] | already
{"planes": [{"name": "a", "quaternion": [0, 0, 0, 0]}]} | planes[0] | length is 0
{"planes": [{"name": "a", "rotation": [[1,0,0],[0,1,0],[0,0,-1]]}]} | planes[0] | reflection
{"planes": [{"name": "a"}], "order": ["b"]} | order[0] | no obstacle "b"
{"planes": [{"name": "a"}], "order": ["a", "a"]} | order[1] | twice
{"planes": [{"name": "a"}, {"name": "b"}], "order": ["a"]} | order | "b" is missing
{"meshes": [{"name": "a", "vertices": [[0,0,0]], "triangles": [[0, 1, 2]]}]} | meshes[0] | vertex 1
{"meshes": [{"name": "a", "file": "b.obj"}]} | meshes[0] | only for a world
{"convex": [{"name": "a", "points": [[0,0,0],[1,0,0],[0,1,0],[1,1,0]]}]} | convex[0] | one plane
"#;

#[test]
fn json_errors_name_the_location() {
    for row in JSON_FAULTS.lines().filter(|row| !row.is_empty()) {
        let mut parts = row.split(" | ");
        let text = parts.next().unwrap();
        let message = World::from_json(text.as_bytes(), "w.json")
            .unwrap_err()
            .to_string();
        let is_named = message.starts_with("w.json: ") && parts.all(|part| message.contains(part));
        assert!(is_named, "{row}: {message}");
    }
}

/// Faults of the scene.
const SCENE_FAULTS: &str = r#"
type: box => type: cone | s.yaml: | "cone" is not box
[0.14, 0.03] => [0.14] | s.yaml: | cylinder does not have 1 dimensions
[0.14, 0.03] => [0.14, no] | s.yaml: | not a number
[0.14, 0.03] => [0.14, -1] | s.yaml: | radius of the cylinder is -1
[0, 0, 0.6, 0.8] => [0, 0, 0.6, 0.9] | s.yaml: | length is 1.08
[0, 0, 0.6, 0.8] => [0, 0, 0.6] | s.yaml: | 3 numbers, not 4
[0, 0, 0.6, 0.8] => [0, 0, 0.6, 0.8, 0] | s.yaml: | 5 numbers, not 4
[0, 0, 10] => [0, 0, 10, 1] | s.yaml: | 4 numbers, not 3
id: pen => id: Can1 | s.yaml: | already
id: Can1 => name: Can1 | s.yaml: | no `id`
"#;

#[test]
fn scene_errors_name_the_line() {
    let read = |text: &str| World::from_moveit(text.as_bytes(), "s.yaml");
    for fault in faults(SCENE_FAULTS) {
        fault.check(read(&SCENE.replacen(&fault.from, &fault.to, 1)));
    }
    for (text, what) in [
        ("a: 1", "no `world`"),
        ("a: [1", "line "),
        ("", "no YAML"),
        ("a: &b [1]\nworld: *b", "line 2: aliases"),
    ] {
        let message = read(text).unwrap_err().to_string();
        assert!(
            message.starts_with("s.yaml: ") && message.contains(what),
            "{message}"
        );
    }
}

/// A primitive's pose is relative to its object.
#[test]
fn primitive_poses_are_relative_to_the_object() {
    let scene = "
world:
  collision_objects:
    - id: table
      pose: {position: [1, 0, 0.5], orientation: [0, 0, 0.7071067811865476, 0.7071067811865476]}
      primitives: [{type: box, dimensions: [0.1, 0.1, 0.1]}]
      primitive_poses: [{position: [0.5, 0.2, 0], orientation: [0.7071067811865476, 0, 0, 0.7071067811865476]}]
";
    let world = World::from_moveit(scene.as_bytes(), "scene.yaml").unwrap();
    let placed = world.obstacle("table").unwrap().placement;
    // A quarter turn about z takes (0.5, 0.2) to (-0.2, 0.5) and x to y; the primitive's rotation takes z to x.
    let offset = placed.translation - Vector3::new(0.8, 0.5, 0.5);
    assert!(offset.norm() < 1e-14, "{placed:?}");
    let [x, y, z] = Vector3::UNITS;
    let turned = placed.rotation;
    assert!((turned.x - y).norm() + (turned.y - z).norm() + (turned.z - x).norm() < 1e-14);
}

/// Objects in other frames.
const FRAMES: &str = "
fixed_frame_transforms:
  - header: {frame_id: world}
    child_frame_id: world
    transform: {translation: [0, 0, 0], rotation: [0, 0, 0, 1]}
  - header: {frame_id: camera}
    child_frame_id: world
    transform: {translation: {x: 1, y: 0, z: 2}, rotation: {x: 0, y: 0, z: 0.6, w: 0.8}}
robot_state:
  joint_state: {header: {frame_id: base}}
  attached_collision_objects:
    - link_name: hand
      object:
        header: {frame_id: hand}
        id: pen
        primitives: [{type: sphere, dimensions: [0.01]}]
        primitive_poses: [{position: [0, 0, 0.1]}]
world:
  octomap: {header: {frame_id: world}, octomap: {id: OcTree, data: []}}
  collision_objects:
    - header: {frame_id: /camera}
      id: ball
      pose: {position: [1, 0, 0]}
      primitives: [{type: sphere, dimensions: [0.1]}]
      primitive_poses: [{position: [0, 0, 1]}]
    - header: {frame_id: base}
      id: stone
      primitives: [{type: sphere, dimensions: [0.1]}]
      primitive_poses: [{position: [0, 0, 1]}]
";

const FRAME_FAULTS: &str = r#"
frame_id: /camera => frame_id: shelf | s.yaml: | "ball" is in frame "shelf"
{frame_id: camera} => {frame_id: other} | s.yaml: | "camera"
{frame_id: hand} => {frame_id: world} | s.yaml: | transform to "hand"
data: [] => data: [0, 1] | s.yaml: | `octomap` contains cells
translation: {x: 1 => translation: {u: 1 | s.yaml: | no `x`
"#;

#[test]
fn scene_objects_are_placed_in_their_frame() {
    let read = |text: &str| World::from_moveit(text.as_bytes(), "s.yaml");
    let world = read(FRAMES).unwrap();
    assert!(world.notes().is_empty());
    let at = |name: &str| world.obstacle(name).unwrap().placement.translation;
    // 2 atan(0.6 / 0.8) about z: cosine 0.28, sine 0.96.
    assert!((at("ball") - Vector3::new(1.28, 0.96, 3.0)).norm() < 1e-14);
    assert_eq!(at("stone").to_array(), [0.0, 0.0, 1.0]);
    assert_eq!(at("pen").to_array(), [0.0, 0.0, 0.1]);
    assert_eq!(
        world.obstacle("pen").unwrap().attached.as_deref(),
        Some("hand")
    );
    for fault in faults(FRAME_FAULTS) {
        fault.check(read(&FRAMES.replacen(&fault.from, &fault.to, 1)));
    }
    // A scene without frames is in world coordinates.
    let plain = SCENE.replacen(
        "- id: Can1",
        "- header: {frame_id: world}\n      id: Can1",
        1,
    );
    assert_eq!(read(&plain).unwrap().len(), 4);
    let changed = SCENE.replacen(
        "- id: Can1",
        "- header: {frame_id: panda_link0}\n      id: Can1",
        1,
    );
    read(&changed).says("panda_link0 | \"world\"");
}

/// Pairs of links belong to the robot: a note says that they are ignored.
#[test]
fn scene_matrix_allows_collisions_of_objects() {
    let read = |matrix: &str| {
        let text = format!("allowed_collision_matrix: {matrix}{SCENE}");
        World::from_moveit(text.as_bytes(), "s.yaml")
    };
    let links = "{entry_names: [a, b], entry_values: [[0, 1], [1, 0]]}";
    let world = read(links).unwrap();
    let message = world.notes().join("\n");
    assert!(
        message.contains("link pairs") && message.contains("allowed_collision_matrix"),
        "{message}"
    );
    assert_eq!(world.scaled(2.0).unwrap().notes(), world.notes());
    // As lists, and as ROS messages.
    let names = "entry_names: [panda_hand, Can1, shelf, gone]";
    let rows = [
        "[false, true, false, false]",
        "[true, false, true, true]",
        "[false, true, false, false]",
        "[false, true, false, false]",
    ];
    let lists = format!("{{{names}, entry_values: [{}]}}", rows.join(", "));
    let messages = rows.map(|row| format!("{{enabled: {row}}}")).join(", ");
    let messages = format!("{{{names}, entry_values: [{messages}]}}");
    for matrix in [lists, messages] {
        let world = read(&matrix).unwrap();
        assert!(world.notes().is_empty(), "{:?}", world.notes());
        let may = |a: &str, b: &str| world.is_collision_allowed(a, b);
        assert!(may("Can1", "panda_hand") && may("shelf/0", "Can1") && may("shelf/1", "Can1"));
        assert!(!may("shelf/0", "panda_hand") && !may("pen", "Can1"));
        // Entries of removed objects and of other robots' links are ignored, also after JSON.
        let again = World::from_json(world.to_json().as_bytes(), "w.json").unwrap();
        for mut world in [world, again] {
            world.remove("pen").unwrap();
            let panda = support::arms::robot("franka_panda");
            let checker = Checker::of(&panda).unwrap();
            checker.clone().with_world(&world).unwrap();
            // Names in other permissions have to exist.
            world.allow_collision("Can1", "hnad").unwrap();
            checker.with_world(&world).says("`hnad` | `hand`");
        }
    }
    let held = SCENE.replace(
        "link_name: panda_hand",
        "link_name: panda_hand\n      touch_links: [a, b]",
    );
    let world = World::from_moveit(held.as_bytes(), "s.yaml").unwrap();
    assert_eq!(
        world.obstacle("pen").unwrap().allowed_collisions,
        ["a", "b"]
    );
    let defaults = read("{default_entry_names: [Can1], default_entry_values: [1]}").unwrap();
    assert!(defaults.notes()[0].contains("default"));
    for wrong in [
        "{entry_names: [a, b], entry_values: [[0, 1]]}",
        "{entry_names: [a, b], entry_values: [[0, 1], [1]]}",
        "{entry_names: [a, b], entry_values: [[0, maybe], [1, 0]]}",
        "{entry_names: [a, a], entry_values: [[0, 1], [1, 0]]}",
    ] {
        let message = read(wrong).unwrap_err().to_string();
        assert!(
            message.contains("line 1") && message.contains("entry_")
                || message.contains("allowed_collision_matrix"),
            "{message}"
        );
    }
}

/// A mesh is scaled per axis.
#[test]
fn mesh_is_scaled_per_axis() {
    let text = r#"{"meshes": [{"name": "roof", "scale": [2.0, 1.0, 0.5],
        "vertices": [[0,0,0],[1,0,0],[0,1,0],[0,0,1]], "triangles": [[0,2,1],[0,1,3],[1,2,3],[0,3,2]]}]}"#;
    let world = World::from_json(text.as_bytes(), "roof.json").unwrap();
    let bounds = world.obstacle("roof").unwrap().shape.bounding_box();
    assert_eq!(bounds.max.to_array(), [2.0, 1.0, 0.5]);
    assert_eq!(bounds.min.to_array(), [0.0; 3]);
}

#[test]
fn written_file_needs_json_extension() {
    let folder = std::env::temp_dir().join(format!("kinopt-worlds-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let world = any_world(&mut Random::new(6));
    for name in ["world.json", "world.JSON"] {
        world.write(folder.join(name)).unwrap();
        let again = World::read(folder.join(name)).unwrap();
        assert_eq!(again.to_json(), world.to_json());
    }
    for name in ["world", "world.yaml"] {
        let message = world.write(folder.join(name)).unwrap_err().to_string();
        assert!(message.contains("must end in .json"), "{name}: {message}");
        assert!(!folder.join(name).exists(), "{name}");
    }
    std::fs::remove_dir_all(folder).unwrap();
}
