//! Promise: errors in a model, map, problem, skeleton or start name the culprit, and for names the valid ones.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::fmt::Display;

use kinopt::model::{FrameId, JointId, Limits, Model, ModelBuilder, ParameterMap};
use kinopt::problem::{Problem, ProblemBuilder};
use kinopt::skeleton::{Bone, Skeleton};
use kinopt::spatial::{Matrix3, Placement, Vector3};
use kinopt::task::{
    Bounded, Camera, Distance, LookAt, Orientation, Pixel, Plane, Point, Pose, PoseBounds, Posture,
    Quantity, Ray, Residual, Smoothness, Task,
};
use kinopt::{Solver, Workspace};

const NAN: f64 = f64::NAN;
const Z: Vector3<f64> = Vector3::<f64>::UNITS[2];

fn names<T, E: Display>(result: Result<T, E>, parts: &[&str]) {
    let message = match result {
        Ok(_) => panic!("was accepted; it should speak of {parts:?}"),
        Err(error) => error.to_string(),
    };
    for part in parts {
        assert!(message.contains(part), "no `{part}` in: {message}");
    }
}

fn identity_placement() -> Placement<f64> {
    Placement::identity()
}

fn stretched() -> Placement<f64> {
    let mut placement = identity_placement();
    placement.rotation.x.x = 1.1;
    placement
}

fn mirror() -> Placement<f64> {
    let mut placement = identity_placement();
    placement.rotation.z.z = -1.0;
    placement
}

/// A model of one joint `elbow` with a frame `hand`, changed by `edit` before it is built.
fn model_with(edit: impl FnOnce(&mut ModelBuilder, JointId)) -> Result<Model, impl Display> {
    let mut builder = Model::builder("arm");
    let elbow = builder.revolute(
        "elbow",
        None,
        identity_placement(),
        Z,
        Limits::new(-1.0, 2.0),
    );
    builder.frame("hand", Some(elbow), identity_placement());
    edit(&mut builder, elbow);
    builder.build()
}

/// An id that is out of range for a model of fewer joints.
fn foreign_joint() -> JointId {
    let mut builder = Model::builder("other");
    (0..50)
        .map(|k| builder.fixed(format!("{k}"), None, identity_placement()))
        .last()
        .unwrap()
}

fn foreign_frame() -> FrameId {
    let mut builder = Model::builder("other");
    (0..50)
        .map(|k| builder.frame(format!("{k}"), None, identity_placement()))
        .last()
        .unwrap()
}

#[test]
fn model_errors_name_the_culprit() {
    names(
        model_with(|b, _| {
            b.fixed("elbow", None, identity_placement());
        }),
        &["joint", "`elbow`", "twice"],
    );
    names(
        model_with(|b, _| {
            b.frame("hand", None, identity_placement());
        }),
        &["frame", "`hand`", "twice"],
    );
    names(
        model_with(|b, _| {
            b.fixed("lost", Some(foreign_joint()), identity_placement());
        }),
        &["joint", "`lost`"],
    );
    names(
        model_with(|b, _| {
            b.frame("lost", Some(foreign_joint()), identity_placement());
        }),
        &["frame", "`lost`"],
    );
    for (lower, upper) in [
        (1.0, -1.0),
        (NAN, 1.0),
        (0.0, NAN),
        (f64::INFINITY, f64::INFINITY),
    ] {
        names(
            model_with(|b, e| {
                b.prismatic(
                    "slide",
                    Some(e),
                    identity_placement(),
                    Z,
                    Limits::new(lower, upper),
                );
            }),
            &["`slide`", "limits", &lower.to_string(), &upper.to_string()],
        );
    }
    for axis in [
        [0.0; 3],
        [NAN, 0.0, 1.0],
        [f64::INFINITY, 0.0, 0.0],
        [1.0, NAN, 0.0],
    ] {
        names(
            model_with(|b, e| {
                b.continuous("wheel", Some(e), identity_placement(), Vector3::from(axis));
            }),
            &["`wheel`", "axis"],
        );
    }
    let nowhere = Placement::translation(Vector3::new(NAN, 0.0, 0.0));
    let wrong = [
        (stretched(), "orthonormal"),
        (mirror(), "reflection"),
        (nowhere, "finite"),
    ];
    for (placement, problem) in wrong {
        names(
            model_with(|b, e| {
                b.fixed("bent", Some(e), placement);
            }),
            &["joint", "`bent`", problem],
        );
        names(
            model_with(|b, e| {
                b.frame("bent", Some(e), placement);
            }),
            &["frame", "`bent`", problem],
        );
    }
    names(
        model_with(|b, e| b.configuration_order(vec![e, e])),
        &["order", "2", "1"],
    );
    let axis = [3e-200, 0.0, 0.0];
    let tiny = model_with(|b, e| {
        b.continuous("wheel", Some(e), identity_placement(), Vector3::from(axis));
    });
    let Ok(tiny) = tiny else {
        panic!("an axis of any length has a direction")
    };
    assert_eq!(tiny.joints()[1].axis.to_array(), [1.0, 0.0, 0.0]);
}

#[test]
fn unknown_names_list_the_valid_ones() {
    let Ok(model) = model_with(|_, _| ()) else {
        panic!()
    };
    names(model.joint("knee"), &["joint", "`knee`", "elbow"]);
    names(model.frame("foot"), &["frame", "`foot`", "hand"]);
    let rig = support::bones::RandomRig::new(1);
    names(
        rig.skeleton.bone("tail"),
        &["bone", "`tail`", "bone/0", "22 names"],
    );
}

/// elbow [−1, 2], wrist [0, 0.5], and a fixed joint.
fn arm() -> (Model, [JointId; 3], FrameId) {
    let mut builder = Model::builder("arm");
    let elbow = builder.revolute(
        "elbow",
        None,
        identity_placement(),
        Z,
        Limits::new(-1.0, 2.0),
    );
    let wrist = builder.revolute(
        "wrist",
        Some(elbow),
        identity_placement(),
        Z,
        Limits::new(0.0, 0.5),
    );
    let weld = builder.fixed("weld", Some(wrist), identity_placement());
    let hand = builder.frame(
        "hand",
        Some(weld),
        Placement::translation(Vector3::UNITS[0]),
    );
    (builder.build().unwrap(), [elbow, wrist, weld], hand)
}

#[test]
fn parameter_map_errors_name_the_joint() {
    let (model, [elbow, wrist, weld], _) = arm();
    let map = || ParameterMap::builder(&model);
    names(
        map().with_locked(weld, 0.0).build(),
        &["`weld`", "fixed", "locked"],
    );
    names(
        map().with_coupled(weld, elbow, 1.0, 0.0).build(),
        &["`weld`", "coupled"],
    );
    names(
        map().with_coupled(elbow, weld, 1.0, 0.0).build(),
        &["`weld`", "followed"],
    );
    names(map().with_only(&[weld], &[]).build(), &["`weld`", "freed"]);
    let twice = map()
        .with_locked(wrist, 0.1)
        .with_locked(wrist, 0.1)
        .build();
    names(twice, &["`wrist`", "locked twice"]);
    let coupled = map().with_coupled(wrist, elbow, 1.0, 0.0);
    let twice = coupled.clone().with_coupled(wrist, elbow, 1.0, 0.0).build();
    names(twice, &["`wrist`", "coupled twice"]);
    // One of each is accepted in order, and joints that `with_only` locked may be locked elsewhere afterwards.
    assert!(coupled.with_locked(wrist, 0.1).build().is_ok());
    assert!(
        map()
            .with_only(&[elbow], &[0.0; 2])
            .with_locked(wrist, 0.1)
            .build()
            .is_ok()
    );
    names(map().with_locked(foreign_joint(), 0.0).build(), &["`arm`"]);
    names(
        map().with_locked(wrist, 0.7).build(),
        &["`wrist`", "0.7", "0.5"],
    );
    names(map().with_locked(wrist, NAN).build(), &["`wrist`", "NaN"]);
    names(
        map().with_coupled(wrist, elbow, NAN, 0.0).build(),
        &["`wrist`", "ratio"],
    );
    names(
        map().with_coupled(wrist, elbow, 1.0, f64::INFINITY).build(),
        &["`wrist`", "offset"],
    );
    names(
        map().with_coupled(elbow, elbow, 1.0, 0.0).build(),
        &["`elbow`", "is its own source"],
    );
    names(
        map()
            .with_coupled(elbow, wrist, 1.0, 0.0)
            .with_coupled(wrist, elbow, 1.0, 0.0)
            .build(),
        &["is its own source"],
    );
    names(
        map().with_coupled(wrist, elbow, 1.0, 9.0).build(),
        &["`elbow`", "no value"],
    );
    names(
        map().with_coupled(wrist, elbow, 0.0, 9.0).build(),
        &["`elbow`", "no value"],
    );
    names(
        map()
            .with_coupled(wrist, elbow, 1.0, 0.0)
            .with_locked(elbow, 1.5)
            .build(),
        &["`wrist`", "1.5"],
    );
}

fn problem<R: Residual>(task: impl Into<Task<R>>) -> Result<Problem, impl Display> {
    let (model, _, _) = arm();
    let mut builder = Problem::builder(&model);
    builder.add(task);
    builder.build()
}

#[test]
fn problem_errors_name_the_culprit() {
    let (model, [elbow, wrist, weld], hand) = arm();
    let with = |edit: &dyn Fn(&mut ProblemBuilder<'_>)| {
        let mut builder = Problem::builder(&model);
        builder.add(Task::new(Point::new(hand, [0.0; 3])).named("reach"));
        edit(&mut builder);
        builder.build()
    };
    names(Problem::builder(&model).build(), &["no task", "`arm`"]);
    let locked = ParameterMap::builder(&model)
        .with_only(&[], &[0.0; 2])
        .build()
        .unwrap();
    names(
        with(&|b| {
            b.parameters(locked.clone());
        }),
        &["no free joint", "`arm`"],
    );
    let other = support::planar_arm(&[1.0; 4], None);
    names(
        with(&|b| {
            b.parameters(ParameterMap::free(&other));
        }),
        &["`arm`", "4", "2"],
    );
    names(
        problem(Point::new(foreign_frame(), [0.0; 3])),
        &["frame", "`arm`"],
    );
    names(
        problem(Posture::of_joints([(weld, 0.0)])),
        &["moving joint", "`arm`"],
    );
    let reach = || Task::new(Point::new(hand, [0.0; 3])).named("reach");
    for weight in [-1.0, NAN, f64::INFINITY] {
        names(
            problem(reach().weight(Quantity::Metres, weight)),
            &["reach", "weight", "metres"],
        );
    }
    // Both are finite, but their product is not.
    names(
        problem(reach().weight(Quantity::Metres, 1e200).scale(1e200)),
        &["reach", "weight", "metres", "inf"],
    );
    for tolerance in [-1.0, NAN] {
        names(
            problem(reach().tolerance(Quantity::Metres, tolerance)),
            &["reach", "tolerance", "metres"],
        );
        names(
            with(&|b| {
                b.tolerance(Quantity::Metres, tolerance);
            }),
            &["reach", "tolerance"],
        );
    }
    names(
        problem(reach().weight(Quantity::Pixels, 1.0)),
        &["reach", "no rows", "pixels"],
    );
    let bad_bounds = [
        (elbow, 3.0, 4.0, "`elbow`"),
        (elbow, NAN, 1.0, "`elbow`"),
        (elbow, 1.0, NAN, "`elbow`"),
        (elbow, 1.0, 0.0, "`elbow`"),
        (wrist, -2.0, -1.0, "`wrist`"),
        (weld, 1.0, 2.0, "`weld`"),
        (foreign_joint(), 0.0, 1.0, "`arm`"),
    ];
    for (joint, lower, upper, name) in bad_bounds {
        names(
            with(&|b| {
                b.bound(joint, Limits::new(lower, upper));
            }),
            &[name, "bounds"],
        );
    }
    // The requested bounds, not their intersection with the joint's limits.
    names(
        with(&|b| {
            b.bound(elbow, Limits::new(-5.0, -7.0));
        }),
        &["`elbow`", "[-5, -7]"],
    );
    let coupled = ParameterMap::builder(&model).with_coupled(wrist, elbow, 0.1, 0.1);
    let coupled = coupled.build().unwrap();
    names(
        with(&|b| {
            b.parameters(coupled.clone());
            b.bound(wrist, Limits::new(0.45, 0.5));
        }),
        &["`wrist`", "bounds"],
    );
}

#[test]
fn task_errors_name_the_task() {
    let (model, [elbow, ..], hand) = arm();
    let origin = [0.0; 3];
    let camera = |entry: f64| Camera {
        pixel_from_world: [[entry; 4]; 3],
    };
    let bent: Matrix3<f64> = stretched().rotation;
    names(
        problem(Point::new(hand, [NAN, 0.0, 0.0])),
        &["point of `hand`", "target", "NaN"],
    );
    let (point, pose) = (
        Point::new(hand, origin),
        Pose::new(hand, identity_placement()),
    );
    let turn = Orientation::new(hand, identity_placement().rotation);
    names(
        problem(point.relative_to(hand)),
        &["point of `hand`", "own base"],
    );
    names(
        problem(pose.relative_to(hand)),
        &["pose of `hand`", "own base"],
    );
    names(
        problem(turn.relative_to(hand)),
        &["orientation of `hand`", "own base"],
    );
    names(
        problem(Distance::new(hand, hand, 0.1)),
        &["distance of `hand`", "itself"],
    );
    names(
        problem(Point::new(hand, origin).at([0.0, NAN, 0.0])),
        &["offset"],
    );
    names(
        problem(Ray::new(hand, origin, origin)),
        &["ray of `hand`", "coincide"],
    );
    names(
        problem(Ray::new(hand, [NAN; 3], origin)),
        &["ray of `hand`", "NaN"],
    );
    names(
        problem(Pixel::new(hand, camera(1.0), [NAN, 0.0])),
        &["pixel"],
    );
    names(
        problem(Pixel::new(hand, camera(NAN), [0.0, 0.0])),
        &["camera"],
    );
    names(
        problem(Orientation::new(hand, bent)),
        &["orientation of `hand`", "orthonormal"],
    );
    names(
        problem(Pose::new(hand, stretched())),
        &["pose of `hand`", "orthonormal"],
    );
    names(problem(Pose::new(hand, mirror())), &["reflection"]);
    names(
        problem(Pose::new(hand, identity_placement()).with_tool(mirror())),
        &["pose of `hand`", "tool", "reflection"],
    );
    for half_width in [-1.0, NAN] {
        let goal = PoseBounds::within([0.0, 0.0, 0.0, 0.1, half_width, 0.0]);
        names(
            problem(Pose::new(hand, identity_placement()).with_goal(goal)),
            &[
                "pose of `hand`",
                "half width for ry",
                &half_width.to_string(),
            ],
        );
    }
    let nothing = PoseBounds::within([f64::INFINITY; 6]);
    names(
        problem(Pose::new(hand, identity_placement()).with_goal(nothing)),
        &["pose of `hand`", "every component free"],
    );
    names(
        problem(Pose::new(hand, identity_placement()).relative_to(foreign_frame())),
        &["pose of `hand`", "frame", "`arm`"],
    );
    for (lower, upper) in [(1.0, 0.0), (NAN, 1.0), (f64::INFINITY, f64::INFINITY)] {
        names(
            problem(Bounded::between(Point::new(hand, origin), lower, upper)),
            &["point of `hand`", "interval", "no number"],
        );
    }
    names(
        problem(Bounded::new(Point::new(hand, [NAN; 3]), 0.1)),
        &["point of `hand`", "target", "NaN"],
    );
    let mut other = Model::builder("balls");
    other.ball("hip", None, identity_placement(), Z, None);
    let foreign = Posture::new(&other.build().unwrap(), &[1.0, 0.0, 0.0, 0.0]);
    let words = ["4 numbers for its joints", "1"];
    names(problem(foreign.clone()), &words);
    names(problem(Bounded::new(foreign, 0.1)), &words);
    names(
        problem(LookAt::new(hand, origin, [1.0; 3])),
        &["look-at", "axis"],
    );
    names(
        problem(LookAt::new(hand, [1.0; 3], [NAN; 3])),
        &["look-at", "target"],
    );
    names(
        problem(Plane::new(hand, origin, origin)),
        &["plane", "normal"],
    );
    names(
        problem(Distance::new(hand, hand, -1.0)),
        &["distance", "negative"],
    );
    names(
        problem(Distance::new(hand, hand, NAN)),
        &["distance", "NaN"],
    );
    names(
        problem(Posture::of_joints([(elbow, NAN)])),
        &["posture", "NaN"],
    );
    for step in [0.0, f64::INFINITY] {
        names(
            problem(Smoothness::new(&model, &[0.0; 2], step)),
            &["smoothness", "time step"],
        );
    }
    names(
        problem(Smoothness::new(&model, &[NAN; 2], 0.1)),
        &["smoothness", "NaN"],
    );
}

#[test]
fn skeleton_errors_name_the_bone() {
    let bone = |name: &str| Bone {
        name: name.to_owned(),
        parent: None,
        length: 1.0,
        model_from_rest: identity_placement(),
        limits: [Limits::new(-1.0, 1.0); 3],
    };
    let build = |bones: Vec<Bone>| Skeleton::new("rig", bones);
    let rig = support::bones::RandomRig::new(1);
    let later = rig.skeleton.bone_at(5);
    names(
        build(vec![
            bone("a"),
            Bone {
                parent: later,
                ..bone("b")
            },
        ]),
        &["`b`", "parent"],
    );
    let first_bone = rig.skeleton.bone_at(0);
    names(
        build(vec![Bone {
            parent: first_bone,
            ..bone("a")
        }]),
        &["`a`", "parent"],
    );
    for length in [-1.0, NAN, f64::INFINITY] {
        names(
            build(vec![Bone {
                length,
                ..bone("a")
            }]),
            &["`a`", "length"],
        );
    }
    for (k, angle) in ["first twist", "bend", "second twist"]
        .into_iter()
        .enumerate()
    {
        let mut wrong = bone("a");
        wrong.limits[k] = Limits::new(1.0, -1.0);
        names(build(vec![wrong]), &["`a`", angle, "[1, -1]"]);
    }
    for (rest, problem) in [(stretched(), "orthonormal"), (mirror(), "reflection")] {
        let wrong = Bone {
            model_from_rest: rest,
            ..bone("a")
        };
        names(build(vec![wrong]), &["`a`", "rest", problem]);
    }
    names(build(vec![bone("a"), bone("a")]), &["`a`", "twice"]);
}

#[test]
fn start_errors_name_the_joint() {
    let (model, _, hand) = arm();
    let mut builder = Problem::builder(&model);
    builder.add(Point::new(hand, [0.0; 3]));
    let problem = builder.build().unwrap();
    let solver = Solver::default();
    let mut workspace = Workspace::new();
    names(
        solver.solve(&problem, &[0.0], &mut workspace),
        &["`arm`", "1", "2"],
    );
    names(
        solver.solve(&problem, &[0.0; 3], &mut workspace),
        &["3", "2"],
    );
    names(
        solver.solve(&problem, &[0.0, NAN], &mut workspace),
        &["`wrist`", "NaN"],
    );
}
