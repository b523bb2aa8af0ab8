//! Promise: the spheres of a link contain all its shapes and protrude no farther than reported.

use kinopt::collision::{
    CollisionModel, CollisionObject, Resolution, Shape, ShapeKind, SphereModel,
};
use kinopt::model::Model;
use kinopt::spatial::{Placement, Vector3};
use support::arms::robot;
use support::convex_shapes::Solid;
use support::fault_tables::ExpectedError;
use support::random::{Random, case_count, cases, part};

/// Random point on the surface of a shape, independent of the library.
fn on_surface(kind: &ShapeKind, random: &mut Random) -> Vector3<f64> {
    let direction = random.direction();
    let direction = Vector3::new(direction.x, direction.y, direction.z);
    let around = random.within(0.0, std::f64::consts::TAU);
    match kind {
        ShapeKind::Sphere { radius } => direction * *radius,
        ShapeKind::Capsule { radius, length } => {
            let flat = Vector3::new(around.cos() * radius, around.sin() * radius, 0.0);
            match random.below(2) {
                0 => flat + Vector3::new(0.0, 0.0, random.within(-0.5, 0.5) * length),
                _ => {
                    let end = 0.5 * length.copysign(direction.z);
                    direction * *radius + Vector3::new(0.0, 0.0, end)
                }
            }
        }
        ShapeKind::Cylinder { radius, length } => {
            let (share, z) = match random.below(3) {
                0 => (1.0, random.within(-0.5, 0.5)),
                1 => (random.within(0.0, 1.0), 0.5),
                _ => (1.0, -0.5),
            };
            Vector3::new(
                around.cos() * radius * share,
                around.sin() * radius * share,
                z * length,
            )
        }
        ShapeKind::Cuboid { size } => {
            let mut point = size.map(|side| random.within(-0.5, 0.5) * side);
            for _ in 0..=random.below(3) {
                let side = random.below(3);
                point[side] = 0.5 * size[side].copysign(random.within(-1.0, 1.0));
            }
            point.into()
        }
        ShapeKind::Convex(hull) => {
            let [a, b, c] = hull.triangles()[random.below(hull.triangles().len())];
            let [a, b, c] = [a, b, c].map(|k| hull.vertices()[k as usize]);
            let (u, v) = (random.within(0.0, 1.0), random.within(0.0, 1.0));
            let (u, v) = if u + v > 1.0 {
                (1.0 - u, 1.0 - v)
            } else {
                (u, v)
            };
            a + (b - a) * u + (c - a) * v
        }
        kind => panic!("{kind:?}"),
    }
}

/// Checks that points on and between points of shapes are inside spheres, and that points on spheres are near shapes.
fn holds(model: &CollisionModel, spheres: &SphereModel, points: usize, random: &mut Random) {
    for group in spheres.groups() {
        let objects: Vec<_> = model.objects_of(group.link).collect();
        for _ in 0..points / spheres.groups().len() {
            let object = objects[random.below(objects.len())];
            let [a, b] = [0, 1].map(|_| on_surface(object.shape.kind(), random));
            // These shapes are convex.
            let share = if random.below(2) == 0 {
                0.0
            } else {
                random.within(0.0, 1.0)
            };
            let point = object.link_from_shape.apply(a + (b - a) * share);
            let out = |ball: &kinopt::collision::Ball| (point - ball.centre).norm() - ball.radius;
            let smallest = group.spheres.iter().map(out).fold(f64::INFINITY, f64::min);
            assert!(
                smallest <= 1e-12,
                "{}: {point:?} is {smallest:e} outside",
                group.name
            );
            assert!(out(&group.bound) <= 1e-12);

            let ball = &group.spheres[random.below(group.spheres.len())];
            let towards = random.direction();
            let surface = ball.centre + Vector3::new(towards.x, towards.y, towards.z) * ball.radius;
            let from = |object: &&CollisionObject| {
                let local = object.link_from_shape.inverse().apply(surface);
                object.shape.signed_distance(local)
            };
            let nearest = objects.iter().map(from).fold(f64::INFINITY, f64::min);
            assert!(
                nearest <= spheres.max_protrusion() + 1e-9,
                "{}: {nearest}",
                group.name
            );
            assert!(
                (ball.centre - group.bound.centre).norm() + ball.radius
                    <= group.bound.radius + 1e-12
            );
        }
    }
}

#[test]
fn spheres_cover_shipped_robots() {
    let robots = [
        "adept_cobra_s600",
        "aldebaran_nao",
        "franka_panda",
        "kuka_iiwa14",
        "rethink_baxter",
        "universal_ur10e",
        "universal_ur5e",
    ];
    let mut random = Random::new(4);
    for name in part(robots, 2) {
        let model = CollisionModel::of(&robot(name)).unwrap();
        let spheres = SphereModel::of(&model, Resolution::MaxProtrusion(0.03)).unwrap();
        assert!(spheres.max_protrusion() <= 0.03, "{name}");
        assert_eq!(spheres.groups().len(), model.links().len());
        assert_eq!(spheres.pairs().len(), model.pairs().len());
        holds(&model, &spheres, case_count(100_000, 5_000), &mut random);
    }
}

pub(crate) fn one_link(
    objects: impl IntoIterator<Item = (Shape, Placement<f64>)>,
) -> CollisionModel {
    let mut builder = Model::builder("one link");
    let link = builder.frame("link", None, Placement::identity());
    let model = builder.build().unwrap();
    let object = |(shape, placed)| CollisionObject::new("shape", link, placed, shape);
    CollisionModel::new(&model, objects.into_iter().map(object).collect()).unwrap()
}

#[test]
fn spheres_cover_random_shapes() {
    let mut random = Random::new(5);
    for case in cases(60, 4) {
        let count = 1 + random.below(3);
        let shapes = (0..count).map(|_| {
            let shape = Solid::random(&mut random).shape();
            (shape, support::placement(&random.rigid(0.3)))
        });
        let model = one_link(shapes.collect::<Vec<_>>());
        let fineness = match case % 2 {
            0 => Resolution::MaxProtrusion(random.within(0.1, 0.3)),
            _ => Resolution::PerLink(1 + random.below(20)),
        };
        let spheres = SphereModel::of(&model, fineness).unwrap();
        match fineness {
            Resolution::MaxProtrusion(max_protrusion) => {
                assert!(spheres.max_protrusion() <= max_protrusion)
            }
            Resolution::PerLink(max_count) => {
                assert!(
                    spheres.count() <= max_count.max(count),
                    "{}",
                    spheres.count()
                )
            }
            _ => {}
        }
        holds(&model, &spheres, 2000, &mut random);
    }
}

#[test]
fn spheres_cover_large_hulls() {
    let mut random = Random::new(6);
    for round in [1.0, 0.2, 0.01] {
        let corner = |_| {
            let on_ball = random.direction();
            Vector3::new(0.1 * on_ball.x, 0.2 * on_ball.y, 0.1 * round * on_ball.z)
        };
        let corners: Vec<_> = (0..2000).map(corner).collect();
        let placements = [
            Placement::identity(),
            support::placement(&random.rigid(0.1)),
        ];
        let shapes = placements.map(|placed| (Shape::convex(&corners).unwrap(), placed));
        let model = one_link(shapes);
        let spheres = SphereModel::of(&model, Resolution::MaxProtrusion(0.03)).unwrap();
        assert!(spheres.max_protrusion() <= 0.03);
        holds(&model, &spheres, 4000, &mut random);
    }
}

#[test]
fn sphere_shapes_are_kept() {
    let at = Placement::translation(Vector3::new(0.1, 0.2, 0.3));
    let model = one_link([(Shape::sphere(0.25).unwrap(), at)]);
    let spheres = SphereModel::of(&model, Resolution::MaxProtrusion(0.5)).unwrap();
    assert_eq!((spheres.count(), spheres.max_protrusion()), (1, 0.0));
    assert_eq!(spheres.groups()[0].spheres[0].radius, 0.25);
    assert_eq!(SphereModel::of_spheres(&model), Some(spheres));
    let capsule = one_link([(Shape::capsule(0.1, 1.0).unwrap(), at)]);
    assert_eq!(SphereModel::of_spheres(&capsule), None);
}

#[test]
fn capsule_cover_is_minimal() {
    // Neighbours may be 2 √(0.12² − 0.1²) = 0.1327 apart, and the last ones 0.02 from the ends: 0.96 / 0.1327.
    let model = one_link([(Shape::capsule(0.1, 1.0).unwrap(), Placement::identity())]);
    let spheres = SphereModel::of(&model, Resolution::MaxProtrusion(0.02)).unwrap();
    assert_eq!(spheres.count(), 9);
}

/// A sphere of radius 0.1 in the axis of a section of 0.1 × 0.1 covers 0.1414 of the bar's length, so eight suffice. A
/// greedy cover needs up to slightly more than twice as many.
#[test]
fn bar_cover_is_nearly_minimal() {
    let bar = Shape::cuboid([1.0, 0.1, 0.1]).unwrap();
    let model = one_link([(bar, Placement::identity())]);
    let spheres = SphereModel::of(&model, Resolution::MaxProtrusion(0.05)).unwrap();
    assert!((8..=20).contains(&spheres.count()), "{}", spheres.count());
}

/// Nine spheres protrude by e from a capsule of radius 0.1 and length 1, with (0.1 + e)² = 0.1² + ((1 − 2e) / 16)². At
/// its poles they protrude as far as between them. One around a capsule of length 0.01 protrudes by 0.005.
#[test]
fn protrusion_of_capsules_is_the_maximum() {
    let half = 0.5 * (0.2 + 1.0 / 64.0);
    let share: f64 = 63.0 / 64.0;
    let farthest = ((half * half + share * 0.25 / 64.0).sqrt() - half) / share;
    let shifted = Placement::translation(Vector3::new(0.0, 1.0, 0.0));
    let long = (Shape::capsule(0.1, 1.0).unwrap(), Placement::identity());
    let short = (Shape::capsule(0.1, 0.01).unwrap(), shifted);
    for (capsules, expected) in [
        (vec![short.clone()], 0.005),
        (vec![short.clone(), long.clone()], farthest),
        (vec![long, short], farthest),
    ] {
        let model = one_link(capsules);
        let spheres = SphereModel::of(&model, Resolution::MaxProtrusion(0.02)).unwrap();
        let reported = spheres.max_protrusion();
        assert!((reported - expected).abs() < 1e-9, "{reported} {expected}");
    }
}

#[test]
fn invalid_resolution_is_rejected() {
    let model = one_link([(Shape::cuboid([1.0; 3]).unwrap(), Placement::identity())]);
    for invalid in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e-9] {
        SphereModel::of(&model, Resolution::MaxProtrusion(invalid)).says("max_protrusion");
    }
    assert!(SphereModel::of(&model, Resolution::PerLink(0)).is_err());
}

/// For links that are spheres, sphere checks equal exact checks, on chains of revolute and prismatic joints about any
/// axes.
#[test]
fn sphere_links_are_checked_exactly() {
    use kinopt::Arm;
    use kinopt::collision::{Checker, World};
    use kinopt::model::Limits;
    use kinopt::spatial::rotation_exp;
    let mut random = Random::new(83);
    let mut reported = [0; 2];
    for case in cases(60, 24) {
        let three = |random: &mut Random, size: f64| {
            let v = random.vector(size);
            Vector3::new(v.x, v.y, v.z)
        };
        let mut builder = Model::builder("chain");
        let base = builder.frame("base", None, Placement::identity());
        let (mut last, mut objects) = (None, Vec::new());
        let joints = 4 + case % 3;
        for k in 0..joints {
            let placement = Placement::new(
                rotation_exp(three(&mut random, 1.5)),
                three(&mut random, 0.3),
            );
            let axis = three(&mut random, 1.0);
            let (name, limits) = (format!("j{k}"), Limits::new(-1.0, 1.0));
            let joint = match random.below(3) {
                0 => builder.prismatic(name, last, placement, axis, Limits::new(-0.3, 0.3)),
                _ => builder.revolute(name, last, placement, axis, limits),
            };
            let link = builder.frame(format!("l{k}"), Some(joint), Placement::identity());
            let shape = Shape::sphere(0.08).unwrap();
            let at = Placement::translation(three(&mut random, 0.2));
            objects.push(CollisionObject::new("ball", link, at, shape));
            last = Some(joint);
        }
        let tip = builder.frame("tip", last, Placement::identity());
        let model = builder.build().unwrap();
        let mut world = World::new();
        for ball in 0..4 {
            let position = three(&mut random, 0.8);
            world
                .add_sphere(&format!("ball {ball}"), 0.1, position)
                .unwrap();
        }
        if case % 2 == 1 {
            let heights = (0..16).map(|_| random.within(-0.1, 0.1)).collect();
            let hills = Shape::height_field(heights, 4, [0.8; 2]).unwrap();
            let placement = Placement::translation(Vector3::new(0.0, 0.0, -0.3));
            world.add("hills", hills, placement).unwrap();
            // A mesh with more triangles than are checked one by one.
            let corner = |_| Vector3::from(random.direction().into_inner() * 0.3);
            let points: Vec<_> = (0..30).map(corner).collect();
            let hull = Shape::convex(&points).unwrap();
            if let ShapeKind::Convex(hull) = hull.kind() {
                let (corners, triangles) = (hull.vertices(), hull.triangles());
                assert!(triangles.len() > 32);
                let rock = Shape::mesh(corners.to_vec(), triangles.to_vec()).unwrap();
                let placement = Placement::translation(three(&mut random, 0.8));
                world.add("rock", rock, placement).unwrap();
            }
        }
        let bodies = CollisionModel::new(&model, objects).unwrap();
        let spheres = SphereModel::of(&bodies, Resolution::MaxProtrusion(0.01)).unwrap();
        let alone = Checker::new(bodies).with_world(&world).unwrap();
        let checker = alone.clone().with_spheres(spheres);
        let arm = Arm::builder(&model, base, tip).with_atlas(false).build();
        let arm = arm
            .unwrap()
            .with_checker(&checker, &vec![0.0; joints])
            .unwrap();
        for _ in 0..20 {
            let q: Vec<f64> = arm
                .limits()
                .map(|limits| random.within(limits.lower, limits.upper))
                .collect();
            let mut clear = [false];
            arm.clear_by_spheres(&q, &mut clear).unwrap();
            let is_free = alone.collisions(&q).unwrap().is_empty();
            assert_eq!(clear[0], is_free, "{case}: {q:?}");
            reported[usize::from(is_free)] += 1;
        }
    }
    assert!(reported.iter().all(|count| *count > 40), "{reported:?}");
}
