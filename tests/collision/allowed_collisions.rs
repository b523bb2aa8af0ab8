//! Promise: every check ignores allowed collisions and nothing else: by spheres, by shapes and along motions. Unknown
//! names are reported.

use kinopt::arm::Arm;
use kinopt::collision::{
    Checker, Clearance, CollisionModel, Shape, SphereModel, World, WorldError,
};
use kinopt::ik::Drag;
use kinopt::kinematics::ForwardKinematics;
use kinopt::robot::Robot;
use kinopt::spatial::{Placement, Vector3};
use kinopt::task::Point;
use kinopt::{Problem, Solver};
use support::arms::{floating_nao, robot};
use support::fault_tables::ExpectedError;
use support::random::{Random, cases};

/// The Panda's tool is above the table.
const Q: [f64; 7] = [0.0, -0.3, 0.0, -2.0, 0.0, 1.9, 0.8];

fn random_position(random: &mut Random) -> Vector3<f64> {
    loop {
        let at = random.vector(0.8);
        if at.norm() > 0.4 {
            return Vector3::new(at.x, at.y, at.z.abs());
        }
    }
}

fn many(count: usize, random: &mut Random) -> World {
    let mut world = World::new();
    for index in 0..count {
        let size = random.within(0.02, 0.1);
        let shape = match index % 3 {
            0 => Shape::sphere(size),
            1 => Shape::cuboid([size, 0.05, size]),
            _ => {
                let at = |_| {
                    let at = random.vector(0.1);
                    Vector3::new(at.x, at.y, at.z)
                };
                Shape::points((0..60).map(at).collect(), 0.01)
            }
        };
        let name = format!("thing {index}");
        world
            .add(&name, shape.unwrap(), random_position(random))
            .unwrap();
    }
    world
}

/// For few and many obstacles: allowed pairs disappear from the reports, and all others are exactly unchanged.
#[test]
fn only_allowed_collisions_are_ignored() {
    let robot = robot("franka_panda");
    let plain = Checker::of(&robot).unwrap();
    let rest = robot.model().neutral();
    let bare = Arm::new(&robot, "base", "flange").unwrap();
    let links: Vec<String> = ["link3", "link5", "link6", "link7", "hand", "finger_left"]
        .map(str::to_owned)
        .to_vec();
    for (count, seed) in [(12, 1), (300, 2), (900, 3)] {
        let mut random = Random::new(seed);
        let world = many(count, &mut random);
        let mut lenient = world.clone();
        let mut allowed = Vec::new();
        for index in 0..count {
            let name = format!("thing {index}");
            for link in &links {
                if random.below(2) == 0 {
                    match random.below(2) {
                        0 => lenient.allow_collision(&name, link).unwrap(),
                        _ => lenient.allow_collision(link, &name).unwrap(),
                    }
                    allowed.push((link.clone(), name.clone()));
                }
            }
        }
        let strict = plain.clone().with_world(&world).unwrap();
        let lenient = strict.clone().with_world(&lenient).unwrap();
        let arm = bare.clone().with_checker(&lenient, &rest).unwrap();
        let (mut passed, mut clear_where_it_touches) = (0, 0);
        for _ in cases(60, 12) {
            let q = random.configuration(&arm);
            let whole: Vec<f64> = q.iter().copied().chain([0.0, 0.0]).collect();
            let mut expected = strict.collisions(&whole).unwrap();
            let before = expected.len();
            expected.retain(|pair| {
                let pair = (pair.first.clone(), pair.second.clone());
                !allowed.contains(&pair)
            });
            passed += before - expected.len();
            assert_eq!(lenient.collisions(&whole).unwrap(), expected);
            assert_eq!(arm.collisions(&q).unwrap(), expected);
            let mut clear = [false];
            arm.clear_by_spheres(&q, &mut clear).unwrap();
            assert!(!clear[0] || expected.is_empty());
            clear_where_it_touches += usize::from(clear[0] && before > 0);
        }
        assert!(passed > 0, "{count}");
        // Batched sphere checks ignore the pairs as exact checks do.
        assert!(clear_where_it_touches > 0 || count > 12, "{count}");
    }
}

/// With many other obstacles, out of reach, a different code path applies.
#[test]
fn sphere_permissions_hold_among_many_obstacles() {
    let robot = robot("franka_panda");
    let rest = robot.model().neutral();
    let bare = Arm::new(&robot, "base", "flange").unwrap();
    let mut world = World::new();
    let under = bare.base_from_tool(&Q).unwrap().translation - Vector3::new(0.0, 0.0, 0.30);
    world.add_box("table", [0.3, 0.3, 0.15], under).unwrap();
    for name in ["link7", "hand", "finger_left", "finger_right"] {
        world.allow_collision("table", name).unwrap();
    }
    let arm_among = |world: &World| {
        let checker = Checker::of(&robot).unwrap().with_world(world).unwrap();
        bare.clone().with_checker(&checker, &rest).unwrap()
    };
    let few = arm_among(&world);
    for index in 0..560 {
        let at = Vector3::new(5.0 + 0.1 * f64::from(index), 0.0, 0.5);
        let ball = Shape::sphere(0.04).unwrap();
        world.add(&format!("ball {index}"), ball, at).unwrap();
    }
    let many = arm_among(&world);
    let mut random = Random::new(9);
    let mut clear_of = [0; 2];
    for case in 0..100 {
        let q = Q.map(|value| value + random.within(-0.6, 0.6));
        let [of_few, of_many] = [&few, &many].map(|arm| {
            let mut clear = [false];
            arm.clear_by_spheres(&q, &mut clear).unwrap();
            clear[0]
        });
        assert_eq!(of_few, of_many, "{case}");
        clear_of[usize::from(of_few)] += 1;
    }
    assert!(clear_of[0] > 10 && clear_of[1] > 10, "{clear_of:?}");
}

/// The tool presses on a table: an arm reaches it, follows a path to it and leaves it. Without the permission it does
/// not.
#[test]
fn arm_reaches_into_an_allowed_obstacle() {
    let robot = robot("franka_panda");
    let rest = robot.model().neutral();
    let bare = Arm::new(&robot, "base", "flange").unwrap();
    let begin = bare.base_from_tool(&Q).unwrap();
    let mut world = World::new();
    let below = begin.translation - Vector3::new(0.0, 0.0, 0.30);
    world.add_box("table", [0.3, 0.3, 0.2], below).unwrap();
    let strict = Checker::of(&robot).unwrap().with_world(&world).unwrap();
    for name in ["hand", "finger_left", "finger_right"] {
        world.allow_collision("table", name).unwrap();
    }
    let lenient = strict.clone().with_world(&world).unwrap();
    let down = |k: usize| {
        let offset = Vector3::new(0.0, 0.0, 0.1 * k as f64 / 20.0);
        Placement::new(begin.rotation, begin.translation - offset)
    };
    let path: Vec<_> = (0..=20).map(down).collect();
    let with = |checker: &Checker| bare.clone().with_checker(checker, &rest).unwrap();
    let (strict, lenient) = (with(&strict), with(&lenient));
    assert!(!strict.solve(path[20], &Q).unwrap().reached);
    let solution = lenient.solve(path[20], &Q).unwrap();
    assert!(solution.reached, "{}", solution.explain());
    assert!(!strict.collisions(&solution.q).unwrap().is_empty());
    let reached = |arm: &Arm| {
        let track = arm.track(&path, &Q).unwrap();
        track.report.iter().filter(|s| s.reached).count()
    };
    assert_eq!(reached(&lenient), path.len());
    assert!(reached(&strict) < path.len());
    let mut servo = lenient.servo(&Q, 0.01).unwrap();
    for _ in 0..400 {
        servo.step(path[20]).unwrap();
    }
    assert!(lenient.base_from_tool(servo.q()).unwrap().translation.z < path[19].translation.z);
}

/// An attached object may touch the container it is taken from, by both names.
#[test]
fn attached_object_may_touch_its_container() {
    let robot = robot("franka_panda");
    let mut world = World::new();
    let q = [0.0, -0.3, 0.0, -2.0, 0.0, 1.9, 0.8, 0.0, 0.0];
    let hand = robot.model().frame("hand").unwrap();
    let mut kinematics = ForwardKinematics::new(robot.model());
    let hand = kinematics.place(&q).unwrap()[hand.index()];
    let held = Vector3::new(0.0, 0.0, 0.2);
    world.add_sphere("can", 0.04, Vector3::zero()).unwrap();
    world.attach("can", "hand", held).unwrap();
    let bin = Shape::cuboid([0.1, 0.1, 0.02]).unwrap();
    world
        .add("bin", bin, Placement::translation(hand.apply(held)))
        .unwrap();
    world.add_sphere("lid", 0.02, Vector3::zero()).unwrap();
    world.attach("lid", "link3", Vector3::zero()).unwrap();
    let checker = Checker::of(&robot).unwrap().with_world(&world).unwrap();
    let reported = |checker: &Checker| {
        let found = checker.collisions(&q).unwrap();
        found
            .iter()
            .any(|pair| pair.first == "can" && pair.second == "bin")
    };
    assert!(reported(&checker));
    let apart = |world: &World| reported(&checker.clone().with_world(world).unwrap());
    // In either order.
    let mut other = world.clone();
    world.allow_collision("bin", "can").unwrap();
    other.allow_collision("can", "bin").unwrap();
    assert!(!apart(&world) && !apart(&other));
    other.forbid_collision("bin", "can").unwrap();
    assert!(apart(&other));
    // The permission survives moving, detaching and attaching, but not removing and adding.
    world.detach("can", Vector3::zero()).unwrap();
    world.attach("can", "hand", held).unwrap();
    assert!(!apart(&world) && world.is_collision_allowed("can", "bin"));
    let shape = world.obstacle("can").unwrap().shape.clone();
    world.remove("can").unwrap();
    world.add("can", shape, Vector3::zero()).unwrap();
    world.attach("can", "hand", held).unwrap();
    assert!(apart(&world) && !world.is_collision_allowed("can", "bin"));
    // Set before the second object exists.
    for names in [["can", "bin"], ["bin", "can"]] {
        let mut world = World::new();
        for (index, name) in names.into_iter().enumerate() {
            match name {
                "can" => {
                    world.add_sphere("can", 0.04, Vector3::zero()).unwrap();
                    world.attach("can", "hand", held).unwrap();
                }
                _ => world
                    .add_box("bin", [0.2, 0.2, 0.04], hand.apply(held))
                    .unwrap(),
            }
            if index == 0 {
                world.allow_collision(name, names[1]).unwrap();
            }
        }
        assert!(!apart(&world), "{names:?}");
        world.forbid_collision("can", "bin").unwrap();
        assert!(apart(&world), "{names:?}");
    }
}

/// Two copies of a world with objects added in different order: the attached object may touch the object of that name
/// in both.
#[test]
fn permissions_do_not_depend_on_insertion_order() {
    let text = r#"<robot name="r"><link name="base"/>
        <link name="hand"><collision><geometry><sphere radius="0.1"/></geometry></collision></link>
        <joint name="lift" type="prismatic"><parent link="base"/><child link="hand"/><axis xyz="0 0 1"/><limit lower="0" upper="1"/></joint></robot>"#;
    let robot = Robot::parse(text, "r.urdf").unwrap();
    let held = Vector3::new(0.0, 0.0, 0.2);
    let mut world = World::new();
    world.add_sphere("plate", 0.04, held).unwrap();
    world.attach("plate", "hand", held).unwrap();
    world.allow_collision("plate", "can").unwrap();
    let mut checker = Checker::of(&robot).unwrap();
    for (names, near, touched) in [
        (["can", "cup"], "can", None),
        (["cup", "can"], "can", None),
        (["can", "cup"], "cup", Some("cup")),
    ] {
        let mut world = world.clone();
        for name in names {
            let height = if name == near { 0.0 } else { 5.0 };
            let at = held + Vector3::new(0.0, 0.0, height);
            world.add_sphere(name, 0.03, at).unwrap();
        }
        checker = checker.with_world(&world).unwrap();
        let found = checker.collisions(&[0.0]).unwrap();
        let reported = found.iter().find(|pair| pair.first == "plate");
        assert_eq!(
            reported.map(|pair| &*pair.second),
            touched,
            "{names:?} {near}"
        );
    }
}

/// A robot on its feet: its clearance, solver and drag ignore the floor under them.
#[test]
fn robot_stands_in_a_floor_its_feet_may_touch() {
    let robot = floating_nao();
    let model = robot.model();
    let rest = model.neutral();
    let mut kinematics = ForwardKinematics::new(model);
    let placed = kinematics.place(&rest).unwrap().to_vec();
    let sole = placed[model.frame("left_sole").unwrap().index()].translation;
    let mut world = World::new();
    world
        .add_plane("floor", Vector3::new(0.0, 0.0, sole.z + 0.01))
        .unwrap();
    let strict = Checker::of(&robot).unwrap().with_world(&world).unwrap();
    let found = strict.collisions(&rest).unwrap();
    let feet: Vec<&str> = found.iter().map(|pair| &*pair.first).collect();
    assert!(!feet.is_empty() && found.iter().all(|pair| pair.second == "floor"));
    for foot in feet {
        world.allow_collision("floor", foot).unwrap();
    }
    let lenient = strict.clone().with_world(&world).unwrap();
    assert!(lenient.collisions(&rest).unwrap().is_empty());
    let nearest = lenient
        .nearest(&mut lenient.workspace(), &rest, 1.0)
        .unwrap();
    assert!(nearest.is_none_or(|pair| pair.distance > 0.0));
    let hand = model.frame("left_hand").unwrap();
    let at = placed[hand.index()].translation;
    let mut tasks = Problem::builder(model);
    tasks.parameters(robot.map().clone());
    tasks.add(Point::new(hand, at + Vector3::new(0.02, 0.0, 0.0)));
    tasks.add(Point::new(model.frame("left_sole").unwrap(), sole));
    tasks.add(Clearance::new(&lenient, 0.0));
    tasks.keep_clear(&lenient);
    let problem = tasks.build().unwrap();
    let solution = Solver::default().solve_once(&problem, &rest).unwrap();
    assert!(solution.reached, "{}", solution.explain());
    let mut drag = Drag::new(problem, &rest).unwrap();
    for _ in 0..20 {
        drag.advance();
    }
    assert!(drag.solution().reached, "{}", drag.solution().explain());
    assert!(!strict.collisions(drag.q()).unwrap().is_empty());
}

#[test]
fn unknown_names_are_reported() {
    let mut world = World::new();
    world.add_box("table", [0.1; 3], Vector3::zero()).unwrap();
    let message = world
        .allow_collision("hand", "tabel")
        .unwrap_err()
        .to_string();
    assert!(
        ["hand", "tabel", "table"]
            .iter()
            .all(|name| message.contains(name)),
        "{message}"
    );
    assert!(world.forbid_collision("hand", "tabel").is_err());
    let message = world.forbid_collision("hand", "table").unwrap_err();
    assert!(
        matches!(&message, WorldError::KeptApart(names) if names[0] == "hand"),
        "{message}"
    );
    world.allow_collision("haand", "table").unwrap();
    world.allow_collision("table", "haand").unwrap();
    assert_eq!(
        world.obstacle("table").unwrap().allowed_collisions,
        ["haand"]
    );
    world.allow_collision("table", " ").says("\" \"");
    let robot = robot("franka_panda");
    let ignored = CollisionModel::of(&robot)
        .unwrap()
        .with_ignored("hand", "table");
    ignored.says("`table` | allow_collision");
    let checker = Checker::of(&robot).unwrap();
    let error = checker.clone().with_world(&world).unwrap_err();
    let message = error.to_string();
    assert!(matches!(error, WorldError::MayTouch { .. }), "{message}");
    assert!(
        message.contains("`table`") && message.contains("did you mean `hand`?"),
        "{message}"
    );
    world.forbid_collision("table", "haand").unwrap();
    checker.with_world(&world).unwrap();
}

/// Both obstacles list the permission, and drop it if either is removed.
#[test]
fn permission_of_two_obstacles_is_mutual() {
    let mut world = World::new();
    for name in ["can", "table"] {
        world.add_box(name, [0.1; 3], Vector3::zero()).unwrap();
    }
    let allowed_of =
        |world: &World, name: &str| world.obstacle(name).unwrap().allowed_collisions.clone();
    world.allow_collision("can", "table").unwrap();
    world.allow_collision("table", "can").unwrap();
    assert_eq!(
        (allowed_of(&world, "can"), allowed_of(&world, "table")),
        (vec!["table".to_owned()], vec!["can".to_owned()])
    );
    let mut without = world.clone();
    without.remove("table").unwrap();
    assert!(allowed_of(&without, "can").is_empty());
    world.forbid_collision("table", "can").unwrap();
    assert!(allowed_of(&world, "can").is_empty() && allowed_of(&world, "table").is_empty());
}

#[test]
fn files_and_scaled_worlds_keep_permissions() {
    let text = r#"{
        "boxes": [{"name": "table", "size": [1, 1, 0.1], "may_touch": ["hand", "can"]}],
        "cylinders": [{"name": "can", "radius": 0.03, "length": 0.1, "may_touch": ["table"]}]
    }"#;
    let world = World::from_json(text.as_bytes(), "w.json").unwrap();
    assert_eq!(
        world.obstacle("table").unwrap().allowed_collisions,
        ["hand", "can"]
    );
    assert!(
        world.is_collision_allowed("can", "table") && !world.is_collision_allowed("can", "hand")
    );
    let again = World::from_json(world.to_json().as_bytes(), "w.json").unwrap();
    assert_eq!(again.to_json(), world.to_json());
    assert!(again.is_collision_allowed("hand", "table"));
    assert!(
        world
            .scaled(2.0)
            .unwrap()
            .is_collision_allowed("hand", "table")
    );
    // A world without permissions writes none.
    let mut plain = world.clone();
    plain.forbid_collision("hand", "table").unwrap();
    plain.forbid_collision("table", "can").unwrap();
    assert!(!plain.to_json().contains("may_touch"));
}

/// A link with spheres from a file and no shapes may touch as well.
#[test]
fn link_with_spheres_only_may_touch() {
    let robot = robot("franka_panda");
    let rest = robot.model().neutral();
    let bodies = CollisionModel::of(&robot).unwrap();
    let finger = bodies
        .objects()
        .iter()
        .filter(|object| object.name.starts_with("finger"));
    let alone = CollisionModel::new(robot.model(), finger.cloned().collect()).unwrap();
    let spheres = "collision_spheres:\n  link7:\n    - {center: [0, 0, 0], radius: 0.05}\n  finger_left:\n    - {center: [0, 0, 0.03], radius: 0.05}\n  finger_right:\n    - {center: [0, 0, 0.03], radius: 0.05}\n";
    let spheres = SphereModel::parse(spheres.as_bytes(), "s.yml", &alone).unwrap();
    let arm = Arm::new(&robot, "base", "link7").unwrap();
    let mut world = World::new();
    let at = arm.base_from_tool(&Q).unwrap().translation;
    world.add_sphere("ball", 0.02, at).unwrap();
    let checker = Checker::new(alone).with_spheres(spheres);
    let is_clear = |world: &World| {
        let checker = checker.clone().with_world(world).unwrap();
        let arm = arm.clone().with_checker(&checker, &rest).unwrap();
        let mut clear = [false];
        arm.clear_by_spheres(&Q, &mut clear).unwrap();
        clear[0]
    };
    assert!(!is_clear(&world));
    world.allow_collision("ball", "link7").unwrap();
    assert!(is_clear(&world));
}
