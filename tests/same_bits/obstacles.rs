//! Promise: so it is for worlds that are edited, scaled, written and read, and for what they refuse.
#![allow(clippy::unwrap_used)]

use kinopt::collision::World;
use kinopt::spatial::{Matrix3, Placement, Vector3};
use support::random::Random;

use crate::arms::turned;
use crate::digest::{Digest, Value, check};
use crate::worlds::vector;

pub(crate) fn obstacle(digest: &mut Digest, world: &World) {
    digest.word(world.len() as u64);
    for obstacle in world.obstacles() {
        digest.text(&obstacle.name);
        let Placement {
            rotation,
            translation,
        } = obstacle.placement;
        digest.doubles(
            [rotation.x, rotation.y, rotation.z, translation]
                .iter()
                .flat_map(|v| v.to_array()),
        );
        digest.bytes(format!(
            "{:?} {:?}",
            obstacle.attached, obstacle.allowed_collisions
        ));
        let ball = obstacle.shape.bounding_sphere();
        digest.doubles(ball.centre.to_array());
        digest.doubles([ball.radius]);
    }
    digest.bytes(world.notes().join("\n"));
}

/// One of each kind, some held, some that may touch.
pub(crate) fn full(random: &mut Random) -> World {
    let mut world = World::new();
    let mut place = || Placement::new(turned(|| random.unit()), vector(random, 0.7));
    let tetrahedron = [
        [0.0, 0.0, 0.0],
        [0.2, 0.0, 0.0],
        [0.0, 0.3, 0.0],
        [0.0, 0.0, 0.25],
    ]
    .map(Vector3::from);
    let faces = vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
    world.add_sphere("ball", 0.08, place()).unwrap();
    world.add_box("box", [0.2, 0.1, 0.3], place()).unwrap();
    world.add_cylinder("can", 0.05, 0.2, place()).unwrap();
    world
        .add_plane("floor", Vector3::new(0.0, 0.0, -0.06))
        .unwrap();
    world.add_capsule("bar", 0.03, 0.4, place()).unwrap();
    world.add_convex("stone", &tetrahedron, place()).unwrap();
    world
        .add_mesh("roof", tetrahedron.to_vec(), faces[1..].to_vec(), place())
        .unwrap();
    world
        .add_mesh("wedge", tetrahedron.to_vec(), faces, place())
        .unwrap();
    world
        .add_points("cloud", tetrahedron.to_vec(), 0.04, place())
        .unwrap();
    let heights = vec![0.0, 0.1, 0.05, 0.0, 0.02, 0.1];
    world
        .add_height_field("hill", heights, 3, [0.1, 0.2], place())
        .unwrap();
    world.add_sphere("cup", 0.03, Vector3::zero()).unwrap();
    world.add_box("lid", [0.02; 3], Vector3::zero()).unwrap();
    world
        .attach("cup", "hand", Vector3::new(0.08, 0.0, 0.02))
        .unwrap();
    world
        .attach("lid", "left", Vector3::new(0.1, 0.0, 0.0))
        .unwrap();
    for (one, other) in [
        ("cup", "left"),
        ("cup", "right"),
        ("base", "floor"),
        ("lid", "cup"),
        ("stone", "hand"),
    ] {
        world.allow_collision(one, other).unwrap();
    }
    world
}

pub(crate) fn told<T, E: ToString>(digest: &mut Digest, found: Result<T, E>) {
    digest.text(found.map_or_else(|error| error.to_string(), |_| "taken".to_owned()));
}

fn edits() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(61));
    let mut world = full(&mut random);
    obstacle(&mut digest, &world);
    obstacle(&mut digest, &world.scaled(0.5).unwrap());
    let [x, y, z] = Vector3::UNITS;
    let bent = Placement::new(Matrix3::from_columns(x, y * 1.1, z), Vector3::zero());
    let far = Vector3::new(0.0, 2e9, 0.0);
    told(&mut digest, world.scaled(0.0));
    told(&mut digest, world.scaled(1e12));
    told(&mut digest, world.add_sphere("ball", 0.1, Vector3::zero()));
    told(&mut digest, world.add_sphere(" ", 0.1, Vector3::zero()));
    told(&mut digest, world.add_sphere("new", -0.1, Vector3::zero()));
    told(&mut digest, world.add_sphere("new", 0.1, bent));
    told(&mut digest, world.add_sphere("new", 0.1, far));
    told(&mut digest, world.move_to("bal", Vector3::zero()));
    told(&mut digest, world.move_to("ball", far));
    told(&mut digest, world.move_to("ball", bent));
    told(&mut digest, world.attach("ball", "hand", bent));
    told(
        &mut digest,
        world.attach("nothing", "hand", Vector3::zero()),
    );
    told(&mut digest, world.detach("ball", Vector3::zero()));
    told(&mut digest, world.detach("cup", far));
    told(&mut digest, world.remove("nothing"));
    told(&mut digest, world.obstacle("nothing"));
    told(&mut digest, world.allow_collision("hand", "base"));
    told(&mut digest, world.allow_collision("ball", " "));
    told(&mut digest, world.allow_collision("cup", "left"));
    told(&mut digest, world.forbid_collision("box", "can"));
    told(&mut digest, world.forbid_collision("hand", "base"));
    told(&mut digest, World::new().remove("nothing"));
    for (one, other) in [
        ("left", "cup"),
        ("cup", "lid"),
        ("hand", "floor"),
        ("stone", "hand"),
    ] {
        digest.word(world.is_collision_allowed(one, other).into());
    }
    digest.word(world.revision());
    let before = world.clone();
    world.forbid_collision("left", "cup").unwrap();
    world.move_to("can", Vector3::new(0.1, 0.2, 0.3)).unwrap();
    world.detach("cup", Vector3::new(0.4, 0.0, 0.0)).unwrap();
    world.remove("stone").unwrap();
    world.remove("cup").unwrap();
    world
        .add_sphere("stone", 0.1, Vector3::new(0.0, 0.5, 0.0))
        .unwrap();
    world
        .attach("box", "wrist", Vector3::new(0.2, 0.0, 0.0))
        .unwrap();
    obstacle(&mut digest, &world);
    digest.word(world.revision());
    // The copy is as it was.
    obstacle(&mut digest, &before);
    digest.value()
}

pub(crate) const SCENE: &str = "name: scene
fixed_frame_transforms:
  - child_frame_id: base
    transform: {translation: [0, 0, 0], rotation: [0, 0, 0, 1]}
  - child_frame_id: base
    header: {frame_id: shelf}
    transform: {translation: {x: 1, y: 0.5, z: 0}, rotation: {x: 0, y: 0, z: 0.6, w: 0.8}}
world:
  collision_objects:
    - id: shelf_1
      header: {frame_id: /shelf}
      pose: {position: [0.1, 0, 0], orientation: [0.6, 0, 0, 0.8]}
      primitives:
        - {type: box, dimensions: [0.1, 0.2, 0.3]}
        - {type: cylinder, dimensions: [0.4, 0.05]}
      primitive_poses:
        - {position: [0, 0, 0.1], orientation: [0, 0, 0, 1]}
        - {position: [0, 0.2, 0], orientation: [0, 0, 1, 0]}
    - id: ball
      primitives: [{type: 2, dimensions: [0.07]}]
      primitive_poses: [{position: [1, 2, 3]}]
robot_state:
  attached_collision_objects:
    - link_name: hand
      object:
        id: cup
        primitives: [{type: sphere, dimensions: [0.02]}]
        primitive_poses: [{position: [0.1, 0, 0]}]
      touch_links: [left, right]
allowed_collision_matrix:
  entry_names: [hand, shelf_1, ball, left]
  entry_values:
    - [true, true, false, true]
    - {enabled: [true, true, true, false]}
    - [false, true, false, 1]
    - [true, false, 1, true]
  default_entry_names: [ball]
  default_entry_values: [true]
";

fn files() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(62));
    let text = full(&mut random).to_json();
    digest.bytes(&text);
    let read = World::from_json(text.as_bytes(), "world.json").unwrap();
    obstacle(&mut digest, &read);
    let scene = World::from_moveit(SCENE.as_bytes(), "scene.yaml").unwrap();
    obstacle(&mut digest, &scene);
    digest.bytes(scene.to_json());
    for (from, to) in [
        ("\"radius\": 0.08", "\"radius\": -0.08"),
        ("\"ball\"", "\"box\""),
        ("\"size\"", "\"sizes\""),
        ("\"may_touch\"", "\"order\""),
        ("\"order\"", "\"orders\""),
        ("\"columns\": 3", "\"columns\": 4"),
        ("\"position\"", "\"quaternion\""),
        ("\"rotation\"", "\"file\""),
        ("{", "["),
    ] {
        let changed = text.replacen(from, to, 1);
        assert_ne!(changed, text, "{from}");
        told(
            &mut digest,
            World::from_json(changed.as_bytes(), "world.json"),
        );
    }
    for more in [
        r#"{"boxes": [{"name": "b", "size": [1, 1, 1], "quaternion": [0.8, 0, 0, 0.6001]}]}"#,
        r#"{"boxes": [{"name": "b", "size": [1, 1, 1], "quaternion": [0.8, 0, 0, 0.7]}]}"#,
        r#"{"boxes": [{"name": "b", "size": [1, 1, 1], "quaternion": [1, 0, 0, 0], "rotation": [[1, 0, 0], [0, 1, 0], [0, 0, 1]]}]}"#,
        r#"{"boxes": [{"name": "b", "size": [1, 1, 1], "rotation": [[1, 0, 0], [0, 1, 0], [0, 0, -1]]}]}"#,
        r#"{"meshes": [{"name": "m", "file": "m.obj"}]}"#,
        r#"{"meshes": [{"name": "m", "file": "m.obj", "vertices": [[0, 0, 0]]}]}"#,
        r#"{"meshes": [{"name": "m", "scale": [1, 2, -3], "vertices": [[0, 0, 0], [1, 0, 0], [0, 1, 0]], "triangles": [[0, 1, 2]]}]}"#,
        r#"{"planes": [{"name": "p"}], "spheres": [{"name": "s", "radius": 1}, {"name": "r", "radius": 2}], "order": ["r", "p"]}"#,
        r#"{"planes": [{"name": "p"}], "order": ["q"]}"#,
        r#"{"spheres": [{"name": "s", "radius": 1, "may_touch": ["x"]}], "may_be_missing": ["x"]}"#,
        r#"{"spheres": [["s", 1]]}"#,
    ] {
        match World::from_json(more.as_bytes(), "more.json") {
            Ok(world) => obstacle(&mut digest, &world),
            Err(error) => digest.text(error.to_string()),
        }
    }
    for (from, to) in [
        ("/shelf}", "table}"),
        ("z: 0.6, w", "z: 0.7, w"),
        (
            "child_frame_id: base\n    header",
            "child_frame_id: world\n    header",
        ),
        ("dimensions: [0.4, 0.05]", "dimensions: [0.4]"),
        ("dimensions: [0.4, 0.05]", "dimensions: [0.4, -0.05]"),
        ("type: cylinder", "type: cone"),
        ("type: cylinder", "type: 3"),
        (
            "        - {position: [0, 0.2, 0], orientation: [0, 0, 1, 0]}\n",
            "",
        ),
        ("id: ball", "id: shelf_1/0"),
        ("id: ball", "name: ball"),
        ("link_name: hand", "link: hand"),
        (
            "primitives: [{type: 2",
            "planes: [{}]\n      primitives: [{type: 2",
        ),
        ("[true, true, false, true]", "[true, true, false]"),
        (
            "entry_names: [hand, shelf_1, ball, left]",
            "entry_names: [hand, shelf_1, ball]",
        ),
        (
            "entry_names: [hand, shelf_1, ball, left]",
            "entry_names: [hand, ball, ball, left]",
        ),
        ("[true, true, false, true]", "[true, maybe, false, true]"),
        ("  default_entry_names: [ball]\n", ""),
        ("[0.1, 0, 0], orientation", "[0.1, 0], orientation"),
        ("[0.1, 0, 0], orientation", "[0.1, 0, x], orientation"),
        ("world:\n", "world:\n  octomap: {octomap: {data: [1]}}\n"),
        ("world:", "worlds:"),
        ("  collision_objects:", "  collision_objects: 1\n  others:"),
    ] {
        let changed = SCENE.replacen(from, to, 1);
        assert_ne!(changed, SCENE, "{from}");
        match World::from_moveit(changed.as_bytes(), "scene.yaml") {
            Ok(world) => obstacle(&mut digest, &world),
            Err(error) => digest.text(error.to_string()),
        }
    }
    digest.value()
}

#[test]
fn of_edited_worlds() {
    check(&[("worlds that are edited", edits())]);
}

#[test]
fn of_files_of_worlds() {
    check(&[("files of worlds", files())]);
}
