//! Promise: so it is for files of worlds with several things changed: JSON and planning scenes, written again, scaled, with meshes
//! in files of their own.
#![allow(clippy::unwrap_used)]

use kinopt::collision::World;
use kinopt::spatial::Placement;
use support::random::Random;
use support::{changed_json, changed_text};

use crate::digest::{Digest, Value, check};
use crate::obstacles::{SCENE, full, obstacle, told};
use crate::robot_texts::{add_error, add_text};

/// The world as it is, as it is written, and so many times as large.
fn add<E: std::fmt::Display>(digest: &mut Digest, found: Result<World, E>, random: &mut Random) {
    let times = [0.5, 2.0, 1.0, 0.0, -1.0, 1e-7, 1e12, f64::NAN][random.below(8)];
    let world = match found {
        Ok(world) => world,
        Err(error) => return add_error(digest, &error),
    };
    obstacle(digest, &world);
    let text = world.to_json();
    add_text(digest, &text);
    match World::from_json(text.as_bytes(), "again.json") {
        Ok(again) => assert_eq!(again.to_json(), text),
        Err(error) => add_error(digest, &error),
    }
    match world.scaled(times) {
        Ok(scaled) => obstacle(digest, &scaled),
        Err(error) => add_error(digest, &error),
    }
}

/// A few obstacles in each list, in an order of their own, with what may touch and what may be missing.
fn small() -> String {
    r#"{"boxes": [{"name": "b", "size": [1, 2, 3], "position": [0.5, 0, 1], "quaternion": [0.8, 0, 0.6, 0]}],
 "cylinders": [{"name": "c", "radius": 0.5, "length": 2, "attached": "hand", "may_touch": ["b", "left", "gone"]}],
 "spheres": [{"name": "s", "radius": 0.25, "rotation": [[0, -1, 0], [1, 0, 0], [0, 0, 1]]}, {"name": "t", "radius": 1}],
 "capsules": [{"name": "k", "radius": 0.1, "length": 0, "may_touch": ["t"]}], "planes": [{"name": "p", "position": [0, 0, -1]}],
 "convex": [{"name": "x", "points": [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [0.1, 0.1, 0.1]]}],
 "meshes": [{"name": "m", "scale": [1, -2, 1], "vertices": [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], "triangles": [[0, 2, 1], [0, 1, 3]]}],
 "height_fields": [{"name": "h", "heights": [0, 1, 0, 1, 2, 1], "columns": 3, "spacing": [1, 0.5]}],
 "points": [{"name": "q", "radius": 0.1, "positions": [[0, 0, 0], [1, 1, 1]]}],
 "order": ["q", "b", "s", "c", "h", "k", "p", "x", "t", "m"], "may_be_missing": ["gone", "hand"]}"#
        .to_owned()
}

fn json() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(911));
    let large = full(&mut random).to_json();
    for (text, count) in [(small(), 120), (large, 12)] {
        add(
            &mut digest,
            World::from_json(text.as_bytes(), "w.json"),
            &mut random,
        );
        for text in changed_json::changed(&text, count, &mut random) {
            add(
                &mut digest,
                World::from_json(text.as_bytes(), "w.json"),
                &mut random,
            );
            told(&mut digest, serde_json::from_str::<World>(&text));
        }
        for text in changed_text::changed(&text, 25, &mut random) {
            add(
                &mut digest,
                World::from_json(text.as_bytes(), "w.json"),
                &mut random,
            );
        }
    }
    add(
        &mut digest,
        World::from_json(
            b"{\"boxes\": [{\"name\": \"\\\\\", \"size\": [1, 1]}]}",
            "w",
        ),
        &mut random,
    );
    digest.value()
}

/// Headers of every kind, frames that are not the scene's own, lists and words for nothing, one name for several primitives.
const MORE: &str = "fixed_frame_transforms:
  - header: {frame_id: /table}
    child_frame_id: /map
    transform: {translation: [0.5, 0, 0.25], rotation: [0, 0.6, 0, 0.8]}
  - header: {frame_id: wall}
    child_frame_id: other
    transform: {translation: [9, 9, 9]}
  - header: {frame_id: odom}
    child_frame_id: map
    transform: {}
robot_state:
  joint_state: {header: {frame_id: pelvis}}
  multi_dof_joint_state: {header: {frame_id: odd}}
  attached_collision_objects:
    - link_name: hand
      object:
        id: tray
        header: {frame_id: hand}
        pose: {position: {x: 0, y: 0, z: 0.1}, orientation: [0, 0, 0.6, 0.8]}
        primitives: [{type: 1, dimensions: [0.1, 0.2, 0.3]}, {type: 3, dimensions: [0.4, 0.1]}]
        primitive_poses: [{position: [1, 0, 0]}, {orientation: [1, 0, 0, 0]}]
        planes: ~
      touch_links: [left, can]
    - {link_name: left, object: {id: tip, primitives: null, primitive_poses: []}, touch_links: [right]}
world:
  octomap: {header: {}, octomap: {data: []}}
  collision_objects:
    - id: can
      header: {frame_id: table}
      pose: {position: [1, 2, 3], orientation: [0.6, 0, 0, 0.8]}
      primitives: [{type: \"cylinder\", dimensions: [0.5, 0.1]}]
      primitive_poses: [{position: [0, 0, 1], orientation: [0, 1, 0, 0]}]
    - {id: lid, header: {frame_id: odd}, meshes: [], primitives: [{type: sphere, dimensions: [0.5]}], primitive_poses: [{}]}
    - {id: cap, header: {frame_id: \"\"}, primitives: [{type: box, dimensions: [1, 2, 3]}, {type: 2, dimensions: [1]}], primitive_poses: [{}, {}]}
allowed_collision_matrix:
  entry_names: [cap, left, right, tray, can]
  entry_values: [[false, true, false, 1, 0], [true, true, True, False, false], [0, 1, 1, 0, 0], [1, 0, 0, 0, 1], [0, 0, 0, 1, 0]]
";

/// The value of a flag or number of each pair, on its own; and words of it changed.
fn scenes() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(912));
    for (text, count) in [(SCENE, 40), (MORE, 160)] {
        add(
            &mut digest,
            World::from_moveit(text.as_bytes(), "s.yaml"),
            &mut random,
        );
        for text in changed_text::changed(text, count, &mut random) {
            add(
                &mut digest,
                World::from_moveit(text.as_bytes(), "s.yaml"),
                &mut random,
            );
        }
    }
    for at in [
        "frame_id: wall",
        "frame_id: odd",
        "frame_id: table",
        "frame_id: hand",
    ] {
        for to in [
            "frame_id: odom",
            "frame_id: wall",
            "frame_id: pelvis",
            "frame_id: map",
            "frame_id: world",
            "frame_id: ~",
        ] {
            let text = MORE.replace(at, to);
            add(
                &mut digest,
                World::from_moveit(text.as_bytes(), "s.yaml"),
                &mut random,
            );
        }
    }
    // Which may touch, by pairs of objects and links.
    for _ in 0..30 {
        let names = ["cap", "left", "can", "right"];
        let mut row = || {
            let values = [(); 4].map(|()| ["true", "false", "1", "0"][random.below(4)]);
            format!("[{}]", values.join(", "))
        };
        let rows = [row(), row(), row(), row()].join(", ");
        let (begin, _) = MORE.split_once("  entry_names").unwrap();
        let defaults = [
            "",
            "  default_entry_names: []\n",
            "  default_entry_names: [cap]\n",
        ];
        let text = format!(
            "{begin}  entry_names: [{}]\n  entry_values: [{rows}]\n{}",
            names.join(", "),
            defaults[random.below(3)]
        );
        add(
            &mut digest,
            World::from_moveit(text.as_bytes(), "s.yaml"),
            &mut random,
        );
    }
    for bytes in [
        &b"\xff"[..],
        b"",
        b"- 1",
        b"a: &x 1\nb: *x",
        b"world: {}",
        b"{world: ~}\n---\nworld: 3",
    ] {
        add(
            &mut digest,
            World::from_moveit(bytes, "s.yaml"),
            &mut random,
        );
    }
    digest.value()
}

/// Hundreds of obstacles, of which most go again, here and there.
fn crowded() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(914));
    let mut world = World::new();
    let mut names: Vec<String> = (0..420).map(|k| format!("s{k}")).collect();
    for name in &names {
        world.add_sphere(name, 0.1, Placement::identity()).unwrap();
    }
    for round in 0..400 {
        let at = match round / 100 {
            0 => random.below(names.len()),
            1 => random.below(names.len().min(60)),
            _ => names.len() - 1 - random.below(names.len().min(90)),
        };
        world.remove(&names.remove(at)).unwrap();
        if round % 20 == 0 {
            let here: Vec<&str> = world.obstacles().map(|own| &*own.name).collect();
            add_text(&mut digest, &here.join(" "));
            digest.word(world.len() as u64);
            told(&mut digest, world.obstacle(&names[names.len() / 2]));
        }
    }
    digest.value()
}

/// Worlds in files, with meshes beside them.
fn in_files() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(913));
    let folder = std::env::temp_dir().join(format!("kinopt-same-worlds-{}", std::process::id()));
    std::fs::create_dir_all(folder.join("sub")).unwrap();
    let write = |name: &str, text: &str| std::fs::write(folder.join(name), text).unwrap();
    write(
        "tent.obj",
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\n",
    );
    write("sub/bad.obj", "v 0 0\n");
    write("none.obj", "v 0 0 0\n");
    for (file, more) in [
        ("tent.obj", ""),
        ("sub/../tent.obj", r#", "scale": [1, 2, -3]"#),
        ("sub/bad.obj", ""),
        ("none.obj", ""),
        ("tent.step", ""),
        ("tent.obj", r#", "triangles": [[0, 1, 2]]"#),
        ("tent.obj", r#", "vertices": [[0, 1, 2]]"#),
        ("tent.obj", r#", "scale": [0, 1, 1]"#),
    ] {
        let text = format!(
            r#"{{"spheres": [{{"name": "s", "radius": 1}}], "meshes": [{{"name": "m", "file": "{file}"{more}}}]}}"#
        );
        write("w.JSON", &text);
        let found = World::read(folder.join("w.JSON"));
        let found = found.map_err(|error| {
            let told = error.to_string().replace(&*folder.to_string_lossy(), "");
            told.split("cannot be read").next().unwrap().to_owned()
        });
        add(&mut digest, found, &mut random);
    }
    let world = full(&mut random);
    world.write(folder.join("o.json")).unwrap();
    let text = std::fs::read_to_string(folder.join("o.json")).unwrap();
    add_text(&mut digest, &text);
    digest.bytes(
        world
            .write(folder.join("o.yaml"))
            .unwrap_err()
            .problem
            .to_string(),
    );
    write("s.yml", SCENE);
    add(&mut digest, World::read(folder.join("s.yml")), &mut random);
    write("s.txt", SCENE);
    digest.bytes(
        World::read(folder.join("s.txt"))
            .unwrap_err()
            .problem
            .to_string(),
    );
    std::fs::remove_dir_all(folder).unwrap();
    digest.value()
}

#[test]
fn of_texts_of_worlds() {
    check(&[
        ("texts of worlds: JSON, changed", json()),
        ("texts of worlds: planning scenes, changed", scenes()),
        ("texts of worlds: in files", in_files()),
        ("worlds of hundreds, of which most go", crowded()),
    ]);
}
