//! Promise: a robot on a free base whose hand is dragged down crouches, stays upright and keeps its feet. Dragged
//! beyond its reach, it keeps its feet. With a balance task, it leans no farther than its support polygon allows.

use kinopt::Problem;
use kinopt::ik::{Drag, crouched_configuration};
use kinopt::kinematics::{ForwardKinematics, centre_of_mass};
use kinopt::model::{FrameId, JointId, Limits, Model, ParameterMap};
use kinopt::robot::BaseJoint;
use kinopt::spatial::{Placement, Vector3};
use kinopt::task::{FramePose, Point, Posture, SupportPolygon, Task};

struct Body {
    model: Model,
    feet: [FrameId; 2],
    hand: FrameId,
    chest: FrameId,
    knees: [JointId; 2],
}

/// Humanoid of revolute joints: hips, knees, ankles, back, shoulders and elbows. Zero is stretched, arms down.
fn person() -> Body {
    let mut builder = Model::builder("person");
    let at = |x: f64, y: f64, z: f64| Placement::translation(Vector3::new(x, y, z));
    let [along_x, along_y, _] = Vector3::UNITS;
    let wide = Limits::new(-2.5, 2.5);
    let pelvis = builder.free("base", None, Placement::identity(), [Limits::UNBOUNDED; 3]);
    builder.frame("pelvis", Some(pelvis), Placement::identity());
    let (mut feet, mut knees) = (Vec::new(), Vec::new());
    for (side, y) in [("left", 0.1), ("right", -0.1)] {
        let mut hinge = |part: &str, parent, z, axis, limits| {
            let placement = if part == "hip roll" {
                at(0.0, y, z)
            } else {
                at(0.0, 0.0, z)
            };
            builder.revolute(
                format!("{side} {part}"),
                Some(parent),
                placement,
                axis,
                limits,
            )
        };
        let roll = hinge("hip roll", pelvis, -0.05, along_x, wide);
        let hip = hinge("hip", roll, 0.0, along_y, wide);
        let knee = hinge("knee", hip, -0.4, along_y, Limits::new(0.0, 2.5));
        let ankle = hinge("ankle", knee, -0.4, along_y, wide);
        let sole = hinge("ankle roll", ankle, 0.0, along_x, wide);
        feet.push(builder.frame(format!("{side} foot"), Some(sole), at(0.0, 0.0, -0.05)));
        knees.push(knee);
    }
    let back = builder.revolute("back", Some(pelvis), at(0.0, 0.0, 0.1), along_y, wide);
    let chest = builder.frame("chest", Some(back), at(0.0, 0.0, 0.3));
    let mut hands = Vec::new();
    for (side, y) in [("left", 0.2), ("right", -0.2)] {
        let name = |part: &str| format!("{side} {part}");
        let swing = builder.revolute(name("shoulder"), Some(back), at(0.0, y, 0.4), along_y, wide);
        let lift = builder.revolute(name("lift"), Some(swing), at(0.0, 0.0, 0.0), along_x, wide);
        let elbow = builder.revolute(name("elbow"), Some(lift), at(0.0, 0.0, -0.3), along_y, wide);
        hands.push(builder.frame(name("hand"), Some(elbow), at(0.0, 0.0, -0.3)));
    }
    Body {
        model: builder.build().unwrap(),
        feet: [feet[0], feet[1]],
        hand: hands[0],
        chest,
        knees: [knees[0], knees[1]],
    }
}

fn placed(model: &Model, frame: FrameId, q: &[f64]) -> Placement<f64> {
    ForwardKinematics::of_frames(model, &[frame])
        .unwrap()
        .place(q)
        .unwrap()[0]
}

/// Drags the hand along a straight line and returns the final configuration.
fn dragged(body: &Body, start: &[f64], displacement: Vector3<f64>, upright: bool) -> Vec<f64> {
    let model = &body.model;
    let mut tasks = Problem::builder(model);
    let from = placed(model, body.hand, start).translation;
    let hand = tasks.add(Point::new(body.hand, from));
    for foot in body.feet {
        tasks.add(Task::new(FramePose::new(foot, placed(model, foot, start))).scale(10.0));
    }
    let posture = Posture::new(model, start);
    tasks.add(match upright {
        true => posture.upright(model),
        false => posture,
    });
    let mut drag = Drag::new(tasks.build().unwrap(), start).unwrap();
    for step in 1..=30 {
        let at = from + displacement * (f64::from(step) / 30.0);
        drag.target_mut(hand).unwrap().set_target(at);
        drag.advance();
    }
    drag.settle(100).q.clone()
}

/// Tilt of the chest, radians.
fn lean(body: &Body, q: &[f64]) -> f64 {
    placed(&body.model, body.chest, q)
        .rotation
        .z
        .z
        .clamp(-1.0, 1.0)
        .acos()
}

fn knee_bend(body: &Body, q: &[f64]) -> f64 {
    let angles = body
        .knees
        .map(|knee| q[body.model.coordinate(knee).unwrap()]);
    angles[0].min(angles[1])
}

#[test]
fn crouch_bends_the_knees_above_the_feet() {
    let body = person();
    let (model, rest) = (&body.model, body.model.neutral());
    let map = ParameterMap::free(model);
    let up = Vector3::UNITS[2];
    let q = crouched_configuration(model, &map, &body.feet, &rest, up).unwrap();
    assert!(model.is_within_limits(&q) && knee_bend(&body, &q) > 0.3);
    for foot in body.feet {
        let (before, after) = (placed(model, foot, &rest), placed(model, foot, &q));
        assert!((before.translation - after.translation).norm() < 1e-6);
    }
    // A fifteenth of the height over the soles, straight down.
    assert!(
        (q[2] + 0.9 / 15.0).abs() < 1e-6 && q[0].abs() < 1e-6,
        "{q:?}"
    );
    assert!(lean(&body, &q) < 1e-6);
    // Without feet the configuration is unchanged.
    assert_eq!(
        crouched_configuration(model, &map, &[], &rest, up).unwrap(),
        rest
    );
}

/// With feet at two heights the lower one defines the height, in any order. Mirrored robots give mirrored
/// configurations.
#[test]
fn crouch_height_is_above_the_lower_foot() {
    let body = person();
    let (model, map, up) = (
        &body.model,
        ParameterMap::free(&body.model),
        Vector3::UNITS[2],
    );
    let at = |name: &str| model.coordinate(model.joint(name).unwrap()).unwrap();
    let stances = ["left", "right"].map(|lifted| {
        let mut start = model.neutral();
        for (part, angle) in [("hip", -0.5), ("knee", 1.0), ("ankle", -0.5)] {
            start[at(&format!("{lifted} {part}"))] = angle;
        }
        let heights = body
            .feet
            .map(|foot| placed(model, foot, &start).translation.z);
        assert!((heights[0] - heights[1]).abs() > 0.09, "{heights:?}");
        let [first, second] = [[0, 1], [1, 0]].map(|order| {
            let feet = order.map(|foot| body.feet[foot]);
            crouched_configuration(model, &map, &feet, &start, up).unwrap()
        });
        for q in [&first, &second] {
            // The sole of the straight leg is 0.9 m below the pelvis.
            assert!((q[2] + 0.9 / 15.0).abs() < 1e-6, "{lifted}: {}", q[2]);
            for foot in body.feet {
                let [before, after] = [&start, q].map(|q| placed(model, foot, q).translation);
                assert!((before - after).norm() < 1e-6);
            }
        }
        let apart = first.iter().zip(&second).map(|(a, b)| (a - b).abs());
        assert!(apart.fold(0.0, f64::max) < 1e-6, "{first:?} {second:?}");
        first
    });
    for part in ["hip roll", "hip", "knee", "ankle", "ankle roll"] {
        let value_of = |q: &[f64], side: &str| q[at(&format!("{side} {part}"))];
        let mirror = if part.ends_with("roll") { -1.0 } else { 1.0 };
        for (side, other) in [("left", "right"), ("right", "left")] {
            let [actual, mirrored] = [value_of(&stances[0], side), value_of(&stances[1], other)];
            assert!(
                (actual - mirror * mirrored).abs() < 1e-5,
                "{side} {part}: {actual} {mirrored}"
            );
        }
    }
}

#[test]
fn hand_dragged_down_bends_the_legs() {
    let body = person();
    let (map, up) = (ParameterMap::free(&body.model), Vector3::UNITS[2]);
    let stance =
        crouched_configuration(&body.model, &map, &body.feet, &body.model.neutral(), up).unwrap();
    let down = Vector3::new(0.2, 0.0, -0.45);
    let q = dragged(&body, &stance, down, true);
    let reached = placed(&body.model, body.hand, &q).translation;
    let expected = placed(&body.model, body.hand, &stance).translation + down;
    assert!((reached - expected).norm() < 1e-5);
    let bowed = dragged(&body, &stance, down, false);
    assert!(
        knee_bend(&body, &q) > 1.2 && lean(&body, &q) < 0.5,
        "{} {}",
        knee_bend(&body, &q),
        lean(&body, &q)
    );
    assert!(
        lean(&body, &bowed) > 1.5 * lean(&body, &q),
        "{}",
        lean(&body, &bowed)
    );
}

#[test]
fn feet_stay_at_an_unreachable_hand_target() {
    let body = person();
    let (model, map) = (&body.model, ParameterMap::free(&body.model));
    let up = Vector3::UNITS[2];
    let stance = crouched_configuration(model, &map, &body.feet, &model.neutral(), up).unwrap();
    let q = dragged(&body, &stance, Vector3::new(3.0, 0.0, 0.5), true);
    for foot in body.feet {
        let (before, after) = (placed(model, foot, &stance), placed(model, foot, &q));
        let apart = (before.translation - after.translation).norm();
        assert!(apart < 0.02, "{apart}");
    }
}

/// The recipe of docs/guide/whole-bodies.md, checked in every frame.
#[test]
fn hand_dragged_forward_keeps_balance() {
    let robot = support::arms::robot("aldebaran_nao");
    let robot = robot.with_base_joint(BaseJoint::FREE).unwrap();
    let (model, masses) = (robot.model(), robot.masses().unwrap());
    let feet = ["left_sole", "right_sole"].map(|name| model.frame(name).unwrap());
    let hand = model.frame("left_hand").unwrap();
    let up = Vector3::UNITS[2];
    let stance = crouched_configuration(model, robot.map(), &feet, &model.neutral(), up).unwrap();
    let start = placed(model, hand, &stance).translation;
    // Largest and final distance of the centre of mass beyond the soles' front edges, metres, and the knees' bend.
    let dragged = |direction: Vector3<f64>, balances: bool| {
        let mut tasks = Problem::builder(model);
        tasks.parameters(robot.map().clone());
        let target = tasks.add(Point::new(hand, start));
        let mut balance = SupportPolygon::new(&masses).with_margin(0.02);
        let mut front = f64::NEG_INFINITY;
        for foot in feet {
            let at = placed(model, foot, &stance);
            tasks.add(Task::new(FramePose::new(foot, at)).scale(10.0));
            let sole = robot.sole(foot);
            front = (sole.iter().map(|corner| at.apply(*corner).x)).fold(front, f64::max);
            balance = balance.with_points_on(foot, sole);
        }
        if balances {
            tasks.add(Task::new(balance).scale(10.0));
        }
        tasks.add(Posture::new(model, &stance).upright(model));
        let mut drag = Drag::new(tasks.build().unwrap(), &stance).unwrap();
        let ahead = |q: &[f64]| centre_of_mass(model, &masses, q).unwrap().x - front;
        let mut farthest = f64::NEG_INFINITY;
        for step in 1..=30 {
            let at = start + direction * (f64::from(step) / 30.0);
            drag.target_mut(target).unwrap().set_target(at);
            farthest = farthest.max(ahead(&drag.advance().q));
        }
        assert!(drag.settle(100).reached, "{direction:?} {balances}");
        let knee = model
            .coordinate(model.joint("left_knee_pitch").unwrap())
            .unwrap();
        (farthest, ahead(drag.q()), drag.q()[knee])
    };
    for [x, y, z] in [[0.15, 0.0, -0.12], [0.1, 0.0, -0.2], [0.05, 0.1, -0.2]] {
        let direction = Vector3::new(x, y, z);
        let (tipped, _, straight) = dragged(direction, false);
        let (farthest, end, bent) = dragged(direction, true);
        assert!(tipped > 0.01, "{direction:?}: {tipped}");
        assert!(
            farthest < -0.02 + 1e-3 && end < -0.02 + 1e-6,
            "{direction:?}: {farthest} {end}"
        );
        assert!(bent > straight + 0.1, "{direction:?}: {bent} {straight}");
    }
}

/// Levels that are relaxed end at the frame's iteration limit. The next frame continues from there and is never worse,
/// so no oscillation occurs.
#[test]
fn conflicting_levels_come_to_rest() {
    let robot = support::arms::robot("aldebaran_nao");
    let robot = robot.with_base_joint(BaseJoint::FREE).unwrap();
    let (model, masses) = (robot.model(), robot.masses().unwrap());
    let [pulled, support_foot] = ["left_sole", "right_sole"].map(|name| model.frame(name).unwrap());
    let mut tasks = Problem::builder(model);
    tasks.parameters(robot.map().clone());
    let at = placed(model, support_foot, &NAO_ON_ONE_FOOT);
    tasks.add(FramePose::new(support_foot, at));
    let balance =
        SupportPolygon::new(&masses).with_points_on(support_foot, robot.sole(support_foot));
    tasks.add(Task::new(balance).at_level(1));
    let mut raised = placed(model, pulled, &NAO_ON_ONE_FOOT);
    raised.rotation = placed(model, pulled, &model.neutral()).rotation;
    raised.translation = Vector3::new(0.244, 0.251, 0.147);
    tasks.add(
        Task::new(FramePose::new(pulled, raised))
            .named("pulled")
            .at_level(2),
    );
    tasks.add(Posture::new(model, &NAO_ON_ONE_FOOT).upright(model));
    let mut drag = Drag::new(tasks.build().unwrap(), &NAO_ON_ONE_FOOT).unwrap();
    let missed = |drag: &Drag| {
        let report = drag
            .solution()
            .tasks()
            .find(|task| task.name == "pulled")
            .unwrap();
        let (position, turn) = (
            report.position_error().unwrap(),
            report.orientation_error().unwrap(),
        );
        position * position + turn * turn
    };
    let mut smallest = f64::INFINITY;
    // The robot weighs metres and radians differently, so one may improve slightly at the other's cost.
    const COST_RATIO_TOLERANCE: f64 = 1.0 + 1e-5;
    for frame in 0..200 {
        drag.advance();
        let now = missed(&drag);
        assert!(
            now < smallest * COST_RATIO_TOLERANCE,
            "frame {frame}: {now} after {smallest}"
        );
        smallest = now;
        if drag.is_at_rest() {
            break;
        }
    }
    assert!(drag.is_at_rest());
}

/// The NAO with its right foot on the ground and its left foot pulled away; it oscillated here.
const NAO_ON_ONE_FOOT: [f64; 31] = [
    0.0904, 0.0017, -0.0125, 0.8376, 0.3212, 0.3597, 0.2567, 0.1427, -0.672, 2.0857, -0.2955,
    1.9239, -0.5255, -0.2252, -2.0857, -1.3265, 1.6382, 1.5068, 1.8145, -0.8447, -0.379472,
    -1.773912, 0.0481, 0.922747, -0.39788, -0.8447, -0.790477, -0.2243, -0.03, -0.1594, 0.2461,
];
