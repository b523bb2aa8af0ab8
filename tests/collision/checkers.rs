//! Promise: a checker reports the pairs nearer than the margin with their distances, in cases with known geometry.

use kinopt::collision::WorldError;
use kinopt::collision::{
    BodyKind, Checker, CheckerWorkspace, CollisionModel, CollisionObject, Shape, World,
};
use kinopt::model::{FrameId, Limits, Model};
use kinopt::spatial::{Placement, Vector3};
use support::arms::robot;
use support::random::Random;

/// Three links of 1 m along x that rotate about z, each with a sphere of radius 0.1 at its end.
fn model() -> (Model, Vec<FrameId>) {
    let mut builder = Model::builder("three links");
    let z = Vector3::new(0.0, 0.0, 1.0);
    let link = Placement::translation(Vector3::new(1.0, 0.0, 0.0));
    let (mut parent, mut at, mut ends) = (None, Placement::identity(), Vec::new());
    for name in ["a", "b", "c"] {
        let limits = Limits::new(-3.1, 3.1);
        let joint = builder.revolute(format!("{name}_turn"), parent, at, z, limits);
        ends.push(builder.frame(name, Some(joint), link));
        (parent, at) = (Some(joint), link);
    }
    (builder.build().unwrap(), ends)
}

fn balls() -> CollisionModel {
    let (model, ends) = model();
    let ball = |end: &FrameId| {
        CollisionObject::new(
            "ball",
            *end,
            Placement::identity(),
            Shape::sphere(0.1).unwrap(),
        )
    };
    CollisionModel::new(&model, ends.iter().map(ball).collect()).unwrap()
}

fn wall(at: f64) -> World {
    let mut world = World::new();
    let size = [0.2, 10.0, 10.0];
    world
        .add_box("wall", size, Vector3::new(at, 0.0, 0.0))
        .unwrap();
    world
}

#[test]
fn pairs_are_sorted_by_depth() {
    // Stretched, the ends are at 1, 2 and 3; the wall starts at 1.95.
    let checker = Checker::new(balls()).with_world(&wall(2.05)).unwrap();
    let found = checker.collisions(&[0.0; 3]).unwrap();
    let reported: Vec<_> = found
        .iter()
        .map(|c| (c.first.as_str(), c.second.as_str()))
        .collect();
    assert_eq!(reported, [("b", "wall")]);
    // The shorter exit of a wall of 0.2 about 2.05 is backward, by 0.05 and the sphere's radius.
    assert!((found[0].distance + 0.15).abs() < 1e-9, "{found:?}");
    assert!((found[0].depth() - 0.15).abs() < 1e-9);
    let wide = checker.with_margin(0.9).unwrap();
    let found = wide.collisions(&[0.0; 3]).unwrap();
    let reported: Vec<_> = found.iter().map(|c| c.first.as_str()).collect();
    assert_eq!(reported, ["b", "c", "a"]);
    // The end at 3 is 0.85 from the wall and its sphere 0.75; the end at 1 is 0.95 and its sphere 0.85.
    assert!((found[1].distance - 0.75).abs() < 1e-9);
    assert!((found[2].distance - 0.85).abs() < 1e-9);
}

/// For links and obstacles of several shapes, the nearest pair of shapes is reported, in any order.
#[test]
fn nearest_of_several_shapes_is_reported() {
    let mut random = Random::new(71);
    for _ in 0..200 {
        let (model, ends) = model();
        let mut objects = Vec::new();
        let mut balls: Vec<(usize, Vector3<f64>, f64)> = Vec::new();
        for (link, end) in ends.iter().enumerate() {
            for ball in 0..3 {
                let at = random.vector(0.3);
                let at = Vector3::new(at.x, at.y, at.z);
                let radius = random.within(0.02, 0.1);
                let shape = Shape::sphere(radius).unwrap();
                let placement = Placement::translation(at);
                objects.push(CollisionObject::new(
                    format!("{ball}"),
                    *end,
                    placement,
                    shape,
                ));
                balls.push((link, at, radius));
            }
        }
        let model = CollisionModel::new(&model, objects).unwrap();
        // Stretched, link k is k + 1 m along x; only a and c are an enabled pair, and all with the world.
        let middle = Vector3::new(2.0, 0.5, 0.0);
        let mut world = World::new();
        world.add_sphere("ball", 0.1, middle).unwrap();
        let checker = Checker::new(model).with_world(&world).unwrap();
        let checker = checker.with_margin(5.0).unwrap();
        let found = checker.collisions(&[0.0; 3]).unwrap();
        let at = |(link, at, radius): &(usize, Vector3<f64>, f64)| {
            (*at + Vector3::new(1.0 + *link as f64, 0.0, 0.0), *radius)
        };
        let balls_of = |link: usize| balls.iter().filter(move |ball| ball.0 == link).map(at);
        for pair in &found {
            let link = |name: &str| {
                ["a", "b", "c"]
                    .iter()
                    .position(|link_name| *link_name == name)
            };
            let first: Vec<_> = balls_of(link(&pair.first).unwrap()).collect();
            let second: Vec<_> = match link(&pair.second) {
                Some(link) => balls_of(link).collect(),
                None => vec![(middle, 0.1)],
            };
            let apart = first
                .iter()
                .flat_map(|(a, r)| second.iter().map(move |(b, s)| (*a - *b).norm() - r - s));
            let nearest = apart.fold(f64::INFINITY, f64::min);
            assert!(
                (pair.distance - nearest).abs() < 1e-12,
                "{pair:?} {nearest}"
            );
        }
        assert!(found.len() >= 4, "{found:?}");
    }
}

/// Of several blocking pairs the deepest is reported, in any order.
#[test]
fn motion_reports_the_deepest_pair() {
    for (deep, link) in [(1.0, "a"), (2.0, "b"), (3.0, "c")] {
        let mut world = World::new();
        for at in [1.0, 2.0, 3.0] {
            // Spheres of 0.1 above spheres of 0.1 at less than the sum of their radii.
            let up = if at == deep { 0.12 } else { 0.18 };
            let position = Vector3::new(at, 0.0, up);
            world
                .add_sphere(&format!("above {at}"), 0.1, position)
                .unwrap();
        }
        let checker = Checker::new(balls()).with_world(&world).unwrap();
        let mut workspace = checker.workspace();
        let motion = checker
            .check_motion(&mut workspace, &[0.0; 3], &[0.3; 3])
            .unwrap();
        let blocked = motion.blocked_by.unwrap();
        assert_eq!(blocked.first, link);
        assert!((blocked.distance + 0.08).abs() < 1e-9, "{blocked:?}");
    }
}

/// An obstacle may have a link's name: the pair distinguishes them by kind.
#[test]
fn link_and_obstacle_of_one_name_differ_by_kind() {
    let mut world = wall(2.05);
    // Next to the end at 3; the other is attached to the first link, at the end at 2.
    let side = Vector3::new(3.0, 0.15, 0.0);
    world.add_sphere("b", 0.1, side).unwrap();
    world.add_sphere("c", 0.1, Vector3::UNITS[0]).unwrap();
    world.attach("c", "a", Vector3::UNITS[0]).unwrap();
    let checker = Checker::new(balls()).with_world(&world).unwrap();
    let found = checker.collisions(&[0.0; 3]).unwrap();
    let messages: Vec<_> = found.iter().map(ToString::to_string).collect();
    for pair in [
        "link `b` and obstacle `wall`",
        "link `c` and obstacle `b`",
        "obstacle `c` and obstacle `wall`",
    ] {
        assert!(
            messages.iter().any(|messages| messages == pair),
            "{pair}: {messages:?}"
        );
    }
    let bent = checker.collisions(&[0.0, 0.0, 3.0]).unwrap();
    assert!(
        bent.iter()
            .any(|pair| [pair.first_kind, pair.second_kind] == [BodyKind::Link; 2]),
        "{bent:?}"
    );
}

/// A link's distance is that of its nearest shape, in any order.
#[test]
fn link_distance_is_that_of_its_nearest_shape() {
    let (model, ends) = model();
    // 1.05, 0.75 and 0.65 from a wall at 3.95 to 4.15, with centres at 2.8, 3.1 and 3.2.
    for order in [[-0.2, 0.1, 0.2], [0.2, 0.1, -0.2], [0.1, 0.2, -0.2]] {
        let shapes = order.map(|along| {
            let at = Placement::translation(Vector3::new(along, 0.0, 0.0));
            let shape = Shape::sphere(0.1).unwrap();
            CollisionObject::new(format!("ball {along}"), ends[2], at, shape)
        });
        let bodies = CollisionModel::new(&model, shapes.to_vec()).unwrap();
        let checker = Checker::new(bodies).with_world(&wall(4.05)).unwrap();
        let mut workspace = checker.workspace();
        let nearest = checker.nearest(&mut workspace, &[0.0; 3], 2.0).unwrap();
        assert!((nearest.unwrap().distance - 0.65).abs() < 1e-9, "{order:?}");
        let wide = checker.with_margin(1.5).unwrap();
        let found = wide.collisions(&[0.0; 3]).unwrap();
        assert_eq!(found.len(), 1);
        assert!((found[0].distance - 0.65).abs() < 1e-9, "{order:?}");
    }
}

#[test]
fn links_collide_except_neighbours() {
    let checker = Checker::new(balls());
    // Folded back, the third end is at the first.
    let folded = [0.0, 0.0, 3.1];
    let found = checker.collisions(&folded).unwrap();
    assert_eq!(found.len(), 1, "{found:?}");
    assert_eq!(
        (found[0].first.as_str(), found[0].second.as_str()),
        ("a", "c")
    );
    let apart = 2.0 * (0.5 * (std::f64::consts::PI - 3.1)).sin();
    assert!((found[0].distance - (apart - 0.2)).abs() < 1e-9);
    let mut workspace = checker.workspace();
    assert!(!checker.is_free(&mut workspace, &folded).unwrap());
    assert!(checker.is_free(&mut workspace, &[0.0; 3]).unwrap());
}

#[test]
fn attached_object_may_touch_its_holder() {
    let mut world = wall(4.2);
    let rod = Shape::cuboid([1.4, 0.02, 0.02]).unwrap();
    world.add("rod", rod, Placement::identity()).unwrap();
    let along = Placement::translation(Vector3::new(0.5, 0.0, 0.0));
    world.attach("rod", "c", along).unwrap();
    let checker = Checker::new(balls()).with_world(&world).unwrap();
    // It extends from 2.8 to 4.2, 0.1 m into the wall and through its holder's sphere.
    let found = checker.collisions(&[0.0; 3]).unwrap();
    assert_eq!(found.len(), 1, "{found:?}");
    assert_eq!(
        (found[0].first.as_str(), found[0].second.as_str()),
        ("rod", "wall")
    );
    assert!((found[0].distance + 0.1).abs() < 1e-9);
    // Folded back it overlaps the first link's sphere, which is an enabled pair.
    let found = checker.collisions(&[0.0, 0.0, 3.1]).unwrap();
    assert!(
        found.iter().any(|c| c.first == "a" && c.second == "rod"),
        "{found:?}"
    );
    world.attach("rod", "hand", along).unwrap();
    let error = Checker::new(balls()).with_world(&world).unwrap_err();
    assert!(matches!(error, WorldError::Attached { .. }));
    assert!(
        error.to_string().contains("rod") && error.to_string().contains("`hand`"),
        "{error}"
    );
}

#[test]
fn invalid_margins_and_configurations_fail() {
    let checker = Checker::new(balls());
    for invalid in [-0.1, f64::NAN, f64::INFINITY] {
        assert!(checker.clone().with_margin(invalid).is_err(), "{invalid}");
    }
    assert!(checker.collisions(&[0.0; 2]).is_err());
    assert!(checker.collisions(&[0.0, f64::NAN, 0.0]).is_err());
}

#[test]
fn motion_is_free_up_to_contact() {
    // The arm rotates as one; its outermost sphere, at 3 m, meets the wall above y = 1.
    let mut world = World::new();
    let above = Vector3::new(0.0, 6.0, 0.0);
    world.add_box("wall", [20.0, 10.0, 10.0], above).unwrap();
    let checker = Checker::new(balls()).with_world(&world).unwrap();
    let mut workspace = checker.workspace();
    let touches = (0.9_f64 / 3.0).asin();
    let to = [1.2, 0.0, 0.0];
    let motion = checker
        .check_motion(&mut workspace, &[0.0; 3], &to)
        .unwrap();
    let exact = touches / 1.2;
    assert!(
        motion.free <= exact && motion.free > exact - 1e-4,
        "{} {exact}",
        motion.free
    );
    let pair = motion.blocked_by.unwrap();
    assert_eq!((pair.first.as_str(), pair.second.as_str()), ("c", "wall"));
    // Short of contact the motion is free, in both directions.
    let short = [0.999 * touches, 0.0, 0.0];
    for (from, to) in [([0.0; 3], short), (short, [0.0; 3])] {
        let motion = checker.check_motion(&mut workspace, &from, &to).unwrap();
        assert_eq!((motion.free, motion.blocked_by), (1.0, None));
    }
    // Through a thin wall: free at both ends, not between.
    let mut thin = World::new();
    let at = Vector3::new(0.0, 1.5, 0.0);
    thin.add_box("sheet", [20.0, 0.001, 10.0], at).unwrap();
    let checker = checker.with_world(&thin).unwrap();
    let (from, to) = ([0.0; 3], [3.0, 0.0, 0.0]);
    assert!(checker.collisions(&from).unwrap().is_empty());
    assert!(checker.collisions(&to).unwrap().is_empty());
    let motion = checker.check_motion(&mut workspace, &from, &to).unwrap();
    assert!(
        motion.free < 1.4_f64.atan2(3.0) / 3.0 + 0.02 && motion.blocked_by.is_some(),
        "{motion:?}"
    );
}

/// A prismatic joint retracts while a revolute joint rotates: a far end moves fast at first.
#[test]
fn far_motion_at_either_end_is_stopped() {
    let mut builder = Model::builder("telescope");
    let (x, z) = (Vector3::new(1.0, 0.0, 0.0), Vector3::new(0.0, 0.0, 1.0));
    let origin = Placement::identity();
    let turn = builder.revolute("turn", None, origin, z, Limits::new(-3.1, 3.1));
    let slide = builder.prismatic("slide", Some(turn), origin, x, Limits::new(0.0, 2.0));
    let hand = builder.frame("hand", Some(slide), origin);
    let model = builder.build().unwrap();
    let ball = |radius: f64| Shape::sphere(radius).unwrap();
    let ball_model = CollisionObject::new("ball", hand, origin, ball(0.01));
    let ball_model = CollisionModel::new(&model, vec![ball_model]).unwrap();
    let (out, back) = ([0.0, 2.0], [3.0, 0.1]);
    for (from, to) in [(out, back), (back, out)] {
        for step in 1..40 {
            let share = f64::from(step) / 40.0;
            let q = [0, 1].map(|k| from[k] + share * (to[k] - from[k]));
            let (sin, cos) = q[0].sin_cos();
            let mut world = World::new();
            let at = Vector3::new(q[1] * cos, q[1] * sin, 0.0);
            world.add_sphere("pea", 0.01, at).unwrap();
            let checker = Checker::new(ball_model.clone()).with_world(&world).unwrap();
            let mut workspace = checker.workspace();
            let motion = checker.check_motion(&mut workspace, &from, &to).unwrap();
            assert!(
                motion.free <= share && motion.blocked_by.is_some(),
                "{share}: {motion:?}"
            );
        }
    }
}

/// A straight motion into the margin is stopped, at obstacles and at other links.
#[test]
fn motion_into_the_margin_is_stopped() {
    let mut builder = Model::builder("two slides");
    let (x, identity, limits) = (
        Vector3::UNITS[0],
        Placement::identity(),
        Limits::new(0.0, 9.0),
    );
    let one = builder.prismatic("one", None, identity, x, limits);
    let one = builder.frame("one", Some(one), identity);
    let far = Placement::translation(Vector3::new(2.0, 0.0, 0.0));
    let other = builder.prismatic("other", None, far, -x, limits);
    let other = builder.frame("other", Some(other), identity);
    let model = builder.build().unwrap();
    let ball = |frame| CollisionObject::new("ball", frame, identity, Shape::sphere(0.1).unwrap());
    let pair_model = CollisionModel::new(&model, vec![ball(one), ball(other)]).unwrap();
    // Both end at 1.8; the wall or the other link is 0.1 from their centres, plus a gap.
    for (gap, stops) in [(0.02, true), (0.049, true), (0.051, false)] {
        for (to, wall_at) in [([1.0, 0.8 - gap], 9.0), ([1.0, 0.0], 1.2 + gap)] {
            let checker = Checker::new(pair_model.clone())
                .with_world(&wall(wall_at))
                .unwrap();
            let checker = checker.with_margin(0.05).unwrap();
            let mut workspace = checker.workspace();
            let motion = checker
                .check_motion(&mut workspace, &[0.0; 2], &to)
                .unwrap();
            assert_eq!(
                motion.blocked_by.is_some(),
                stops,
                "{gap} {to:?}: {motion:?}"
            );
            assert_eq!(motion.free < 1.0, stops, "{gap} {to:?}: {motion:?}");
        }
    }
}

/// One workspace serves checkers of a robot alone, with attached objects and of another robot, in any order, with the
/// results of separate workspaces.
#[test]
fn workspace_serves_different_checkers() {
    let mut held = wall(2.6);
    for frame in ["c", "a"] {
        let name = format!("held by {frame}");
        held.add_box(&name, [0.3, 0.1, 0.1], Vector3::zero())
            .unwrap();
        held.attach(&name, frame, Vector3::new(0.4, 0.0, 0.0))
            .unwrap();
    }
    let mut held_elsewhere = held.clone();
    let at = Vector3::new(0.2, 0.0, 0.0);
    held_elsewhere.attach("held by a", "b", at).unwrap();
    let panda = Checker::of(&robot("franka_panda")).unwrap();
    let bare = Checker::new(balls());
    let in_world = |world: &World| bare.clone().with_world(world).unwrap();
    let checkers = [
        bare.clone(),
        in_world(&held),
        in_world(&held_elsewhere),
        in_world(&wall(1.5)),
        panda,
    ];
    let mut found = 0;
    for first in 0..checkers.len() {
        let mut workspace = checkers[first].workspace();
        for checker in &checkers {
            let joints = checker.model().model().configuration_len();
            let (from, to) = (vec![-0.9; joints], vec![0.3; joints]);
            let reported = |workspace: &mut CheckerWorkspace| {
                let collisions = checker.collisions_with(workspace, &to).unwrap();
                let nearest = checker.nearest(workspace, &to, 1.0).unwrap();
                let motion = checker.check_motion(workspace, &from, &to).unwrap();
                let free = checker.is_free(workspace, &from).unwrap();
                (collisions, nearest, motion, free)
            };
            let expected = reported(&mut checker.workspace());
            assert_eq!(reported(&mut workspace), expected);
            found += expected.0.len();
        }
    }
    assert!(found > 0);
}
