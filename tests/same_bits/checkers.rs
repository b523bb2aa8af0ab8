//! Promise: so it is for what a checker tells of a robot in worlds that change: what touches, what is nearest, how far a way is
//! free; for the pairs of links that are kept apart; for the spheres that stand for shapes, and their files.
#![allow(clippy::unwrap_used)]

use kinopt::collision::{
    BodyKind, Checker, Collision, CollisionModel, MeshUse, MotionCheck, Resolution, Shape,
    SphereModel, World,
};
use kinopt::kinematics::ForwardKinematics;
use kinopt::robot::{Robot, Srdf};
use kinopt::spatial::Vector3;
use support::random::Random;
use support::trees::configuration_of;

use crate::digest::{Digest, Value, check};
use crate::obstacles::{full, told};
use crate::worlds::vector;

/// An arm with a shape of every kind, several on one link, a slide, a follower, and two fingers.
pub(crate) const ROBOT: &str = r#"<robot name="r">
<link name="base"><collision name="foot"><geometry><box size="0.3 0.4 0.1"/></geometry></collision>
  <collision><origin xyz="0 0 0.1"/><geometry><cylinder radius="0.05" length="0.2"/></geometry></collision></link>
<link name="upper"><collision><origin xyz="0 0 0.2" rpy="0.1 0 0"/><geometry><cylinder radius="0.06" length="0.3"/></geometry></collision>
  <collision><origin xyz="0 0 0.4"/><geometry><sphere radius="0.08"/></geometry></collision></link>
<link name="lower"><collision><origin xyz="0.15 0 0"/><geometry><box size="0.3 0.06 0.04"/></geometry></collision></link>
<link name="wrist"/>
<link name="hand"><collision name="palm"><geometry><box size="0.04 0.12 0.08"/></geometry></collision></link>
<link name="left"><collision><origin xyz="0.05 0 0"/><geometry><capsule radius="0.01" length="0.08"/></geometry></collision></link>
<link name="right"><collision><origin xyz="0.05 0 0"/><geometry><sphere radius="0.015"/></geometry></collision></link>
<joint name="a" type="revolute"><parent link="base"/><child link="upper"/><origin xyz="0 0 0.2"/><axis xyz="0 0 1"/><limit lower="-3" upper="3" effort="1" velocity="2"/></joint>
<joint name="b" type="revolute"><parent link="upper"/><child link="lower"/><origin xyz="0 0 0.4"/><axis xyz="0 1 0"/><limit lower="-2.5" upper="2.5" effort="1" velocity="1"/></joint>
<joint name="c" type="continuous"><parent link="lower"/><child link="wrist"/><origin xyz="0.3 0 0"/><axis xyz="0 1 0"/><limit effort="1" velocity="3"/></joint>
<joint name="d" type="fixed"><parent link="wrist"/><child link="hand"/><origin xyz="0.06 0 0"/></joint>
<joint name="e" type="prismatic"><parent link="hand"/><child link="left"/><origin xyz="0.03 0 0"/><axis xyz="0 1 0"/><limit lower="0" upper="0.05" effort="1" velocity="0.2"/></joint>
<joint name="f" type="prismatic"><parent link="hand"/><child link="right"/><origin xyz="0.03 0 0"/><axis xyz="0 -1 0"/><limit lower="0" upper="0.05" effort="1" velocity="0.2"/><mimic joint="e" multiplier="0.9" offset="0.001"/></joint>
</robot>"#;

fn robot() -> Robot {
    Robot::reader().parse(ROBOT, "r.urdf").unwrap()
}

impl Digest {
    pub(crate) fn collision(&mut self, pair: &Collision) {
        self.bytes(&pair.first);
        self.bytes(&pair.second);
        let of_link = |kind: BodyKind| u64::from(kind == BodyKind::Link);
        self.word(2 * of_link(pair.first_kind) + of_link(pair.second_kind));
        self.doubles([pair.distance]);
    }

    fn way(&mut self, way: &MotionCheck) {
        self.doubles([way.free, way.initial_penetration]);
        way.blocked_by.iter().for_each(|pair| self.collision(pair));
    }
}

/// All that a checker says, with memory that is used again.
fn checked(digest: &mut Digest, checker: &Checker, random: &mut Random, count: usize) {
    let model = checker.model().model().clone();
    let mut workspace = checker.workspace();
    let mut last = model.neutral();
    for _ in 0..count {
        let q = configuration_of(&model, random);
        for pair in checker.collisions_with(&mut workspace, &q).unwrap() {
            digest.collision(&pair);
        }
        digest.word(checker.is_free(&mut workspace, &q).unwrap().into());
        for within in [-0.02, 0.05, f64::INFINITY] {
            match checker.nearest(&mut workspace, &q, within).unwrap() {
                Some(pair) => digest.collision(&pair),
                None => digest.word(7),
            }
        }
        let near: Vec<f64> = last
            .iter()
            .zip(&q)
            .map(|(a, b)| a + 0.1 * (b - a))
            .collect();
        for to in [&near, &q] {
            digest.way(&checker.check_motion(&mut workspace, &last, to).unwrap());
            digest.way(&checker.way_from_contact(&mut workspace, to, &last).unwrap());
        }
        last = q;
    }
}

fn checkers() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(63));
    let bodies = CollisionModel::of(&robot()).unwrap();
    let world = full(&mut random);
    let plain = Checker::new(bodies.clone());
    checked(&mut digest, &plain, &mut random, 4);
    let spheres = SphereModel::of(&bodies, Resolution::PerLink(3)).unwrap();
    for checker in [
        plain.clone(),
        plain.clone().with_spheres(spheres),
        Checker::covered(bodies.clone()),
    ] {
        let checker = checker.with_world(&world).unwrap();
        checked(&mut digest, &checker, &mut random, 6);
        checked(
            &mut digest,
            &checker.clone().with_margin(0.04).unwrap(),
            &mut random,
            4,
        );
        // Changed a little, and a lot.
        let mut other = world.clone();
        other.move_to("can", Vector3::new(0.2, 0.1, 0.3)).unwrap();
        other
            .attach("bar", "lower", Vector3::new(0.2, 0.0, 0.3))
            .unwrap();
        other.remove("cup").unwrap();
        other.allow_collision("lower", "box").unwrap();
        let checker = checker.with_world(&other).unwrap();
        checked(&mut digest, &checker, &mut random, 4);
        for k in 0..20_u32 {
            let place = vector(&mut random, 0.8);
            other
                .add_sphere(&format!("pebble {k}"), 0.02 + 0.001 * f64::from(k), place)
                .unwrap();
        }
        let checker = checker.with_world(&other).unwrap();
        checked(&mut digest, &checker, &mut random, 3);
        checked(
            &mut digest,
            &checker.with_world(&World::new()).unwrap(),
            &mut random,
            2,
        );
    }
    told(&mut digest, plain.clone().with_margin(-1.0));
    told(&mut digest, plain.collisions(&[0.0; 3]));
    told(&mut digest, plain.collisions(&[f64::NAN; 5]));
    let mut wrong = World::new();
    wrong.add_sphere("s", 0.1, Vector3::zero()).unwrap();
    wrong.attach("s", "hands", Vector3::zero()).unwrap();
    told(&mut digest, plain.clone().with_world(&wrong));
    wrong.attach("s", "hand", Vector3::zero()).unwrap();
    wrong.allow_collision("s", "lefts").unwrap();
    told(&mut digest, plain.with_world(&wrong));
    digest.value()
}

fn pairs_of(digest: &mut Digest, bodies: &CollisionModel) {
    digest.bytes(format!(
        "{:?} {:?} {:?}",
        bodies.links(),
        bodies.pairs(),
        bodies.notes()
    ));
    digest.bytes(bodies.to_srdf());
    for object in bodies.objects() {
        digest.bytes(format!(
            "{} {:?}",
            object.name,
            object.shape.bounding_sphere()
        ));
        digest.doubles(object.link_from_shape.translation.to_array());
    }
}

fn bodies() -> Value {
    let (mut digest, robot) = (Digest::new(), robot());
    let plain = CollisionModel::of(&robot).unwrap();
    pairs_of(&mut digest, &plain);
    for (samples, seed) in [(0, 1), (40, 1), (40, 2)] {
        pairs_of(
            &mut digest,
            &plain.clone().with_pairs_sampled(samples, seed).unwrap(),
        );
    }
    let edited = plain.clone().with_ignored("hand", "base").unwrap();
    let edited = edited.with_checked("right", "left").unwrap();
    let edited = edited.with_checked("upper", "base").unwrap();
    pairs_of(&mut digest, &edited);
    let neutral = robot.model().neutral();
    pairs_of(
        &mut digest,
        &edited.clone().with_touching_ignored(&neutral).unwrap(),
    );
    let srdf = r#"<robot name="r"><disable_collisions link1="left" link2="base" reason="Never"/><disable_collisions link1="hand" link2="upper"/></robot>"#;
    let srdf = Srdf::parse(srdf, "r.srdf", &robot);
    pairs_of(&mut digest, &edited.clone().with_srdf(&srdf.unwrap()));
    for (one, other) in [("hand", "wrist"), ("hand", "nothing"), ("left", "left")] {
        digest.bytes(format!(
            "{:?}",
            plain.is_checked(one, other).map_err(|e| e.to_string())
        ));
        told(&mut digest, plain.clone().with_checked(one, other));
        told(&mut digest, plain.clone().with_ignored(one, other));
    }
    for meshes in [MeshUse::Pieces(0), MeshUse::Pieces(2)] {
        told(
            &mut digest,
            CollisionModel::builder(&robot).with_meshes(meshes).build(),
        );
    }
    let text = serde_json::to_string(&edited).unwrap();
    pairs_of(&mut digest, &serde_json::from_str(&text).unwrap());
    let hand = robot.model().frame("hand").unwrap();
    for shape in [Shape::half_space(), Shape::sphere(0.1).unwrap()] {
        let object = kinopt::collision::CollisionObject::new("o", hand, Vector3::zero(), shape);
        told(
            &mut digest,
            CollisionModel::new(robot.model(), vec![object]),
        );
    }
    digest.value()
}

pub(crate) fn spheres_of(digest: &mut Digest, spheres: &SphereModel) {
    for group in spheres.groups() {
        digest.text(&group.name);
        for ball in group.spheres.iter().chain([&group.bound]) {
            digest.doubles(ball.centre.to_array());
            digest.doubles([ball.radius]);
        }
        digest.doubles([group.gap]);
    }
    digest.doubles([spheres.max_protrusion(), spheres.gap()]);
    digest.bytes(format!(
        "{} {:?} {:?}",
        spheres.count(),
        spheres.pairs(),
        spheres.notes()
    ));
}

fn sphere_models() -> Value {
    let mut digest = Digest::new();
    let bodies = CollisionModel::of(&robot()).unwrap();
    for fineness in [
        Resolution::MaxProtrusion(0.06),
        Resolution::PerLink(1),
        Resolution::PerLink(3),
    ] {
        let spheres = SphereModel::of(&bodies, fineness).unwrap();
        spheres_of(&mut digest, &spheres);
        let [yaml, urdf] = [
            spheres.to_yaml(),
            spheres.spherised(ROBOT, "r.urdf").unwrap(),
        ];
        digest.bytes(&yaml);
        digest.bytes(&urdf);
        for (text, file) in [(&yaml, "r.yaml"), (&urdf, "r.urdf")] {
            spheres_of(
                &mut digest,
                &SphereModel::parse(text.as_bytes(), file, &bodies).unwrap(),
            );
        }
        let again = serde_json::to_string(&spheres).unwrap();
        spheres_of(&mut digest, &serde_json::from_str(&again).unwrap());
    }
    for fineness in [Resolution::MaxProtrusion(0.0), Resolution::PerLink(0)] {
        told(&mut digest, SphereModel::of(&bodies, fineness));
    }
    let short = "robot_cfg:\n  collision_spheres:\n    hand:\n      - center: [0, 0.01, 0]\n        radius: 0.05\n      - center: [0, 0, 0]\n        radius: -10\n    wrist:\n      - {center: [0, 0, 0], radius: 0.1}\n    base: []\n";
    for (from, to) in [
        ("", ""),
        ("hand", "hands"),
        ("wrist", "hand"),
        ("0.01", "x"),
        ("radius: 0.05", "r: 1"),
        ("collision_s", "s"),
        ("base: []", "base: 1"),
        ("0.05", ".inf"),
    ] {
        match SphereModel::parse(short.replacen(from, to, 1).as_bytes(), "s.yml", &bodies) {
            Ok(spheres) => spheres_of(&mut digest, &spheres),
            Err(error) => digest.text(error.to_string()),
        }
    }
    for (text, file) in [
        (ROBOT, "r.urdf"),
        (ROBOT, "r.txt"),
        ("<a/>", "r.urdf"),
        ("[", "r.yaml"),
    ] {
        told(
            &mut digest,
            SphereModel::parse(text.as_bytes(), file, &bodies),
        );
    }
    let spheres = SphereModel::of(&bodies, Resolution::PerLink(2)).unwrap();
    told(&mut digest, spheres.spherised("<a/>", "a.urdf"));
    told(&mut digest, spheres.spherised("<robot>", "a.urdf"));
    digest.value()
}

/// What is held is where the hand is.
#[test]
fn what_is_held_goes_along() {
    let robot = robot();
    let mut world = World::new();
    world.add_sphere("cup", 0.03, Vector3::zero()).unwrap();
    world
        .attach("cup", "hand", Vector3::new(0.3, 0.0, 0.0))
        .unwrap();
    let mut q = robot.model().neutral();
    q[1] = -1.0;
    let mut kinematics = ForwardKinematics::new(robot.model());
    let hand = kinematics.place(&q).unwrap()[robot.model().frame("hand").unwrap().index()];
    let at = hand.apply(Vector3::new(0.3, 0.0, 0.0));
    world.add_sphere("there", 0.01, at).unwrap();
    let checker = Checker::new(CollisionModel::of(&robot).unwrap());
    let found = checker.with_world(&world).unwrap().collisions(&q).unwrap();
    let own = found
        .iter()
        .find(|pair| pair.second == "cup" || pair.first == "cup")
        .unwrap();
    assert!((own.distance + 0.04).abs() < 1e-12, "{found:?}");
}

#[test]
fn of_checkers() {
    check(&[("checks of a robot in worlds that change", checkers())]);
}

#[test]
fn of_pairs_that_are_kept_apart() {
    check(&[("pairs of links that are kept apart", bodies())]);
}

#[test]
fn of_files_of_spheres() {
    check(&[("spheres of every fineness and their files", sphere_models())]);
}
