//! Promise: the enabled pairs of an MJCF model are those of MuJoCo. Planes collide with all moving bodies, the world is
//! no neighbour of bodies on it, and contact pairs, excludes and bits apply.

use kinopt::Arm;
use kinopt::collision::{Checker, CollisionModel};
use kinopt::problem::BodyKind;
use kinopt::robot::{BaseJoint, Robot, Srdf};

/// Three links of 0.4, 0.4 and 0.1 m along x that rotate about y, 0.5 m above a floor that `world` may add.
fn robot(world: &str, links: [&str; 3], contact: &str) -> Robot {
    let [a, b, c] = links;
    let text = format!(
        r#"<mujoco><worldbody>{world}
        <body name="a" pos="0 0 .5"><joint axis="0 1 0"/><geom type="capsule" size=".05" fromto="0 0 0 .4 0 0" {a}/>
          <body name="b" pos=".4 0 0"><joint axis="0 1 0"/><geom type="capsule" size=".05" fromto="0 0 0 .4 0 0" {b}/>
            <body name="c" pos=".4 0 0"><joint axis="0 1 0"/><geom type="sphere" size=".05" pos=".1 0 0" {c}/>
              <site name="tip" pos=".1 0 0"/></body></body></body></worldbody>{contact}</mujoco>"#
    );
    Robot::parse_mjcf(&text, "arm.xml").unwrap()
}

fn collisions_of(robot: &Robot, q: &[f64]) -> Vec<(String, String, f64)> {
    let checker = Checker::new(CollisionModel::of(robot).unwrap());
    let found = checker.collisions(q).unwrap();
    let pair = |pair: kinopt::collision::Collision| (pair.first, pair.second, pair.distance);
    found.into_iter().map(pair).collect()
}

const SIN_1: f64 = 0.841_470_984_807_896_5;
const FLOOR: &str = r#"<geom name="floor" type="plane" size="0 0 .1" pos="0 0 .1"/>"#;

#[test]
fn plane_collides_with_all_moving_bodies() {
    let arm = robot(FLOOR, [""; 3], "");
    // The hand and the forearm are 0.9 and 0.8 m down a slope of 1 rad, the upper arm's end 0.4 m.
    let found = collisions_of(&arm, &[1.0, 0.0, 0.0]);
    let below = |length: f64| 0.5 - length * SIN_1 - 0.05 - 0.1;
    assert_eq!(found.len(), 2, "{found:?}");
    for ((first, second, distance), (link, length)) in found.iter().zip([("c", 0.9), ("b", 0.8)]) {
        assert_eq!((&**first, &**second), (link, "world"));
        assert!((distance - below(length)).abs() < 1e-12, "{distance}");
    }
    assert!(collisions_of(&arm, &[0.0; 3]).is_empty());
    // Neither moves relative to the other: the slab is half in the floor.
    let slab = r#"<geom type="box" size=".1 .1 .1" pos="-1 0 .1"/>"#;
    assert!(collisions_of(&robot(&format!("{FLOOR}{slab}"), [""; 3], ""), &[0.0; 3]).is_empty());
    // A plane of a static body counts as well, rotated and translated.
    let stand = r#"<body name="stand" pos="0 0 .1"><body pos="0 0 -1"><geom type="plane" size="1 1 1" pos="0 0 1"/></body></body>"#;
    assert_eq!(
        collisions_of(&robot(stand, [""; 3], ""), &[1.0, 0.0, 0.0]).len(),
        2
    );
    // Its x axis points down, so the plane is 0.2 m below the ground.
    let turned = r#"<body name="stand" pos="0 0 .1" euler="0 90 0"><geom type="plane" size="1 1 1" pos=".3 0 0" zaxis="-1 0 0"/></body>"#;
    let found = collisions_of(&robot(turned, [""; 3], ""), &[1.0, 0.0, 0.0]);
    let depths: Vec<f64> = found.iter().map(|(_, _, distance)| *distance).collect();
    assert_eq!(depths.len(), 2, "{found:?}");
    for (depth, length) in depths.iter().zip([0.9, 0.8]) {
        assert!((depth - (below(length) + 0.3)).abs() < 1e-12, "{found:?}");
    }
}

#[test]
fn arm_stays_above_the_plane() {
    let arm_of = |robot: &Robot| Arm::new(robot, "world", "tip").unwrap();
    let robot = robot(FLOOR, [""; 3], "");
    let checker = Checker::of(&robot).unwrap();
    let rest = robot.model().neutral();
    let plain = arm_of(&robot);
    let arm = arm_of(&robot).with_checker(&checker, &rest).unwrap();
    // The forearm's end at (0.5, 0.18) is reached with an elbow at 0.11 m, in the floor, or high above it.
    let start = [1.31, -1.47, 0.16];
    let target = plain.base_from_tool(&start).unwrap();
    assert!(!checker.collisions(&start).unwrap().is_empty());
    let solution = arm.solve(target, &start).unwrap();
    assert!(solution.reached, "{}", solution.explain());
    assert!(checker.collisions(&solution.q).unwrap().is_empty());
    assert!(plain.solve(target, &start).unwrap().reached);
}

#[test]
fn plane_survives_copies_or_is_noted() {
    let arm = robot(FLOOR, [""; 3], "");
    let model = CollisionModel::of(&arm).unwrap();
    let text = serde_json::to_string(&model).unwrap();
    let again: CollisionModel = serde_json::from_str(&text).unwrap();
    let found = Checker::new(again).collisions(&[1.0, 0.0, 0.0]).unwrap();
    assert_eq!(found.len(), 2);
    assert_eq!(found[0].second_kind, BodyKind::Link);
    // The pair with the floor can be disabled.
    assert!(model.is_checked("world", "c").unwrap());
    let model = model.with_ignored("c", "world").unwrap();
    assert!(!model.is_checked("c", "world").unwrap());
    // Also through an SRDF file, which writes the plane's body.
    let srdf = Srdf::parse(&model.to_srdf(), "arm.srdf", &arm).unwrap();
    let again = CollisionModel::of(&arm).unwrap().with_srdf(&srdf);
    assert!(!again.is_checked("world", "c").unwrap() && again.is_checked("world", "b").unwrap());
    let found = Checker::new(model).collisions(&[1.0, 0.0, 0.0]).unwrap();
    assert_eq!(found.len(), 1);
    // A body with two planes, or with a plane and other shapes, is written once per pair.
    let ramp = r#"<geom name="ramp" type="plane" size="0 0 .1" pos="0 0 -1"/>"#;
    let slab = r#"<geom type="box" size=".1 .1 .1" pos="-1 0 .1"/>"#;
    for neighbour in [ramp, slab] {
        let two = robot(&format!("{FLOOR}{neighbour}"), [""; 3], "");
        let model = CollisionModel::of(&two).unwrap();
        let text = model.with_ignored("c", "world").unwrap().to_srdf();
        let of_c = |line: &&str| line.contains("\"world\"") && line.contains("\"c\"");
        assert_eq!(text.lines().filter(of_c).count(), 1, "{text}");
    }
    // Static bodies are not written.
    let stand = r#"<body name="stand" pos="1 0 .5"><geom type="box" size=".1 .1 .1"/></body>"#;
    let exclude = r#"<contact><exclude body1="world" body2="stand"/></contact>"#;
    let standing = robot(&format!("{FLOOR}{stand}"), [""; 3], exclude);
    let text = CollisionModel::of(&standing).unwrap().to_srdf();
    assert!(!text.contains("stand"), "{text}");
    // A plane on a moving base would be a moving half-space.
    let carried = arm.with_base_joint(BaseJoint::FREE).unwrap();
    let model = CollisionModel::of(&carried).unwrap();
    let notes = model.notes().join("\n");
    assert!(
        notes.contains("plane `floor`") && notes.contains("left out"),
        "{notes}"
    );
    let field = r#"<geom name="hills" type="hfield" hfield="h"/>"#;
    let repairs = robot(field, [""; 3], "").repairs().to_vec();
    let repairs: Vec<String> = repairs.iter().map(ToString::to_string).collect();
    assert!(
        repairs
            .iter()
            .any(|r| r.contains("hills") && r.contains("hfield")),
        "{repairs:?}"
    );
}

/// Names of each enabled pair.
fn pairs(robot: &Robot) -> Vec<String> {
    let model = CollisionModel::of(robot).unwrap();
    let frames = model.model().frames();
    let name = |link: &kinopt::model::FrameId| frames[link.index()].name.as_str();
    let pairs = model.pairs().iter();
    pairs
        .map(|[a, b]| format!("{}-{}", name(a), name(b)))
        .collect()
}

const SLAB: &str = r#"<geom name="slab" type="box" size=".1 .2 .05" pos=".3 0 .425"/>"#;

#[test]
fn world_is_no_neighbour_of_bodies_on_it() {
    // The slab's top is 0.025 m, half the radius, below the upper arm's axis.
    let arm = robot(SLAB, [""; 3], "");
    assert_eq!(pairs(&arm), ["world-a", "world-b", "world-c", "a-c"]);
    let found = collisions_of(&arm, &[0.0; 3]);
    let of_a = found
        .iter()
        .find(|(first, second, _)| first == "world" && second == "a");
    assert!((of_a.unwrap().2 + 0.025).abs() < 1e-12, "{found:?}");
    // Nor is a body that is welded to the world.
    let stand = format!(r#"<body name="stand"><body name="top">{SLAB}</body></body>"#);
    assert!(pairs(&robot(&stand, [""; 3], "")).contains(&"top-a".to_owned()));
    // `filterparent` disables the exclusion of neighbours.
    let all = r#"<option><flag filterparent="disable"/></option>"#;
    let expected = ["world-a", "world-b", "world-c", "a-b", "a-c", "b-c"];
    assert_eq!(pairs(&robot(SLAB, [""; 3], all)), expected);
}

#[test]
fn pairs_follow_contacts_and_bits() {
    let exclude = |a, b| format!(r#"<contact><exclude body1="{a}" body2="{b}"/></contact>"#);
    let excluded = robot(SLAB, [""; 3], &exclude("c", "a"));
    assert_eq!(pairs(&excluded), ["world-a", "world-b", "world-c"]);
    let excluded = robot(SLAB, [""; 3], &exclude("world", "a"));
    assert_eq!(pairs(&excluded), ["world-b", "world-c", "a-c"]);
    let excluded = robot(FLOOR, [""; 3], &exclude("world", "c"));
    assert_eq!(collisions_of(&excluded, &[1.0, 0.0, 0.0]).len(), 1);
    // a collides with bit 2, which c has; c with nothing by itself, and b with nothing of the world.
    let bits = [
        r#"contype="4" conaffinity="2""#,
        r#"contype="8" conaffinity="8""#,
        r#"contype="2" conaffinity="0""#,
    ];
    assert_eq!(pairs(&robot(SLAB, bits, "")), ["a-c"]);
    assert_eq!(collisions_of(&robot(FLOOR, bits, ""), &[1.0, 0.0, 0.0]), []);
    // Named pairs are enabled for any bits, also of neighbours.
    let named = [r#"name="ga" contype="4""#, r#"name="gb""#, ""];
    let pair = |a, b| format!(r#"<contact><pair geom1="{a}" geom2="{b}"/></contact>"#);
    assert!(pairs(&robot(SLAB, named, &pair("gb", "ga"))).contains(&"a-b".to_owned()));
    let through = [
        r#"name="ga""#,
        r#"contype="8" conaffinity="8""#,
        r#"name="gc" contype="8" conaffinity="8""#,
    ];
    assert!(collisions_of(&robot(FLOOR, through, ""), &[1.0, 0.0, 0.0]).is_empty());
    let over = robot(FLOOR, through, &pair("floor", "gc"));
    let found = collisions_of(&over, &[1.0, 0.0, 0.0]);
    assert!(found.len() == 1 && found[0].0 == "c", "{found:?}");
}

#[test]
fn unsupported_contacts_are_noted() {
    let noted = |robot: &Robot| -> String {
        let repairs: Vec<String> = robot.repairs().iter().map(ToString::to_string).collect();
        repairs.join("\n")
    };
    for (contact, what) in [
        (r#"<exclude body1="a" body2="d"/>"#, "no body named `d`"),
        (r#"<exclude body1="a"/>"#, "body2"),
        (
            r#"<pair geom1="slab" geom2="none"/>"#,
            "no geom named `none`",
        ),
        (
            r#"<pair name="p" geom1="seen" geom2="ga"/>"#,
            "pair `p`: left out: the pair is ignored in collision checks",
        ),
        (r#"<pair geom1="slab" geom2="other"/>"#, "rigidly connected"),
    ] {
        let world = format!(r#"{SLAB}<geom name="other" size=".1"/>"#);
        let links = [
            r#"name="ga""#,
            "",
            r#"name="seen" contype="0" conaffinity="0""#,
        ];
        let notes = noted(&robot(
            &world,
            links,
            &format!("<contact>{contact}</contact>"),
        ));
        assert!(notes.contains(what), "{what}: {notes}");
    }
    // Only one of the two geoms of a link could collide.
    let two = r#"/><geom size=".05" contype="0" conaffinity="2" "#;
    let model = CollisionModel::of(&robot(SLAB, [two, "", ""], "")).unwrap();
    // With the slab and with c.
    let [note] = model.notes() else {
        panic!("{:?}", model.notes())
    };
    assert!(
        note.contains("`world` and `a` (and one more pair)") && note.contains("contact bits"),
        "{note}"
    );
}

/// A disabled pair with a plane can be enabled again, and applies to attached objects too.
#[test]
fn attached_object_shares_disabled_plane_pairs() {
    use kinopt::collision::World;
    let arm = robot(FLOOR, [""; 3], "");
    let mut world = World::new();
    let box_at = kinopt::spatial::Vector3::new(0.1, 0.0, 0.0);
    world.add_box("held", [0.1; 3], box_at).unwrap();
    world.attach("held", "c", box_at).unwrap();
    let links_in_contact = |model: CollisionModel| {
        let checker = Checker::new(model).with_world(&world).unwrap();
        let found = checker.collisions(&[1.0, 0.0, 0.0]).unwrap();
        let mut first: Vec<String> = found.into_iter().map(|pair| pair.first).collect();
        first.sort();
        first
    };
    let model = CollisionModel::of(&arm).unwrap();
    assert_eq!(links_in_contact(model.clone()), ["b", "c", "held"]);
    let passing = model.with_ignored("c", "world").unwrap();
    assert_eq!(links_in_contact(passing.clone()), ["b"]);
    let rechecked = passing.with_checked("world", "c").unwrap();
    assert!(rechecked.is_checked("c", "world").unwrap());
    assert_eq!(links_in_contact(rechecked), ["b", "c", "held"]);
}
