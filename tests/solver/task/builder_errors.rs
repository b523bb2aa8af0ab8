//! Promise: errors in a model, map, problem, skeleton or start name the culprit, and for names the valid ones.

use std::fmt::Display;

use kinopt::model::{FrameId, JointId, Limits, Model, ModelBuilder, ParameterMap};
use kinopt::problem::{Problem, ProblemBuilder};
use kinopt::skeleton::{Bone, Skeleton};
use kinopt::spatial::{Matrix3, Placement, Vector3};
use kinopt::task::{
    Bounded, Camera, Distance, FramePose, LookAt, Orientation, Pixel, Plane, Point, PoseBounds,
    Posture, Quantity, Ray, Residual, Smoothness, Task,
};
use kinopt::{Solver, Workspace};
use support::fault_tables::ExpectedError;

const NAN: f64 = f64::NAN;
const Z: Vector3<f64> = Vector3::<f64>::UNITS[2];

fn identity() -> Placement<f64> {
    Placement::identity()
}

fn stretched() -> Placement<f64> {
    let mut placement = identity();
    placement.rotation.x.x = 1.1;
    placement
}

fn mirror() -> Placement<f64> {
    let mut placement = identity();
    placement.rotation.z.z = -1.0;
    placement
}

/// A model of one joint `elbow` with a frame `hand`, changed by `edit` before it is built.
fn model_with(edit: impl FnOnce(&mut ModelBuilder, JointId)) -> Result<Model, impl Display> {
    let mut builder = Model::builder("arm");
    let elbow = builder.revolute("elbow", None, identity(), Z, Limits::new(-1.0, 2.0));
    builder.frame("hand", Some(elbow), identity());
    edit(&mut builder, elbow);
    builder.build()
}

/// An id that is out of range for a model of fewer joints.
fn foreign_joint() -> JointId {
    let mut builder = Model::builder("other");
    (0..50)
        .map(|k| builder.fixed(format!("{k}"), None, identity()))
        .last()
        .unwrap()
}

fn foreign_frame() -> FrameId {
    let mut builder = Model::builder("other");
    (0..50)
        .map(|k| builder.frame(format!("{k}"), None, identity()))
        .last()
        .unwrap()
}

#[test]
fn model_errors_name_the_culprit() {
    model_with(|b, _| {
        b.fixed("elbow", None, identity());
    })
    .says("joint | `elbow` | twice");
    model_with(|b, _| {
        b.frame("hand", None, identity());
    })
    .says("frame | `hand` | twice");
    model_with(|b, _| {
        b.fixed("lost", Some(foreign_joint()), identity());
    })
    .says("joint | `lost`");
    model_with(|b, _| {
        b.frame("lost", Some(foreign_joint()), identity());
    })
    .says("frame | `lost`");
    for (lower, upper) in [
        (1.0, -1.0),
        (NAN, 1.0),
        (0.0, NAN),
        (f64::INFINITY, f64::INFINITY),
    ] {
        model_with(|b, e| {
            b.prismatic("slide", Some(e), identity(), Z, Limits::new(lower, upper));
        })
        .says(&format!("`slide` | limits | {lower} | {upper}"));
    }
    for axis in [
        [0.0; 3],
        [NAN, 0.0, 1.0],
        [f64::INFINITY, 0.0, 0.0],
        [1.0, NAN, 0.0],
    ] {
        model_with(|b, e| {
            b.continuous("wheel", Some(e), identity(), Vector3::from(axis));
        })
        .says("`wheel` | axis");
    }
    let nowhere = Placement::translation(Vector3::new(NAN, 0.0, 0.0));
    let wrong = [
        (stretched(), "orthonormal"),
        (mirror(), "reflection"),
        (nowhere, "finite"),
    ];
    for (placement, problem) in wrong {
        model_with(|b, e| {
            b.fixed("bent", Some(e), placement);
        })
        .says(&format!("joint | `bent` | {problem}"));
        model_with(|b, e| {
            b.frame("bent", Some(e), placement);
        })
        .says(&format!("frame | `bent` | {problem}"));
    }
    model_with(|b, e| b.configuration_order(vec![e, e])).says("order | 2 | 1");
    let axis = [3e-200, 0.0, 0.0];
    let tiny = model_with(|b, e| {
        b.continuous("wheel", Some(e), identity(), Vector3::from(axis));
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
    model.joint("knee").says("joint | `knee` | elbow");
    model.frame("foot").says("frame | `foot` | hand");
    let rig = support::bones::RandomRig::new(1);
    rig.skeleton
        .bone("tail")
        .says("bone | `tail` | bone/0 | 22 names");
}

/// elbow [−1, 2], wrist [0, 0.5], and a fixed joint.
fn arm() -> (Model, [JointId; 3], FrameId) {
    let mut builder = Model::builder("arm");
    let elbow = builder.revolute("elbow", None, identity(), Z, Limits::new(-1.0, 2.0));
    let wrist = builder.revolute("wrist", Some(elbow), identity(), Z, Limits::new(0.0, 0.5));
    let weld = builder.fixed("weld", Some(wrist), identity());
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
    map()
        .with_locked(weld, 0.0)
        .build()
        .says("`weld` | fixed | locked");
    map()
        .with_coupled(weld, elbow, 1.0, 0.0)
        .build()
        .says("`weld` | coupled");
    map()
        .with_coupled(elbow, weld, 1.0, 0.0)
        .build()
        .says("`weld` | followed");
    map().with_only(&[weld], &[]).build().says("`weld` | freed");
    let twice = map()
        .with_locked(wrist, 0.1)
        .with_locked(wrist, 0.1)
        .build();
    twice.says("`wrist` | locked twice");
    let coupled = map().with_coupled(wrist, elbow, 1.0, 0.0);
    let twice = coupled.clone().with_coupled(wrist, elbow, 1.0, 0.0).build();
    twice.says("`wrist` | coupled twice");
    // One of each is accepted in order, and joints that `with_only` locked may be locked elsewhere afterwards.
    assert!(coupled.with_locked(wrist, 0.1).build().is_ok());
    assert!(
        map()
            .with_only(&[elbow], &[0.0; 2])
            .with_locked(wrist, 0.1)
            .build()
            .is_ok()
    );
    map()
        .with_locked(foreign_joint(), 0.0)
        .build()
        .says("`arm`");
    map()
        .with_locked(wrist, 0.7)
        .build()
        .says("`wrist` | 0.7 | 0.5");
    map().with_locked(wrist, NAN).build().says("`wrist` | NaN");
    map()
        .with_coupled(wrist, elbow, NAN, 0.0)
        .build()
        .says("`wrist` | ratio");
    map()
        .with_coupled(wrist, elbow, 1.0, f64::INFINITY)
        .build()
        .says("`wrist` | offset");
    map()
        .with_coupled(elbow, elbow, 1.0, 0.0)
        .build()
        .says("`elbow` | is its own source");
    map()
        .with_coupled(elbow, wrist, 1.0, 0.0)
        .with_coupled(wrist, elbow, 1.0, 0.0)
        .build()
        .says("is its own source");
    map()
        .with_coupled(wrist, elbow, 1.0, 9.0)
        .build()
        .says("`elbow` | no value");
    map()
        .with_coupled(wrist, elbow, 0.0, 9.0)
        .build()
        .says("`elbow` | no value");
    map()
        .with_coupled(wrist, elbow, 1.0, 0.0)
        .with_locked(elbow, 1.5)
        .build()
        .says("`wrist` | 1.5");
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
    Problem::builder(&model).build().says("no task | `arm`");
    let locked = ParameterMap::builder(&model)
        .with_only(&[], &[0.0; 2])
        .build()
        .unwrap();
    with(&|b| {
        b.parameters(locked.clone());
    })
    .says("no free joint | `arm`");
    let other = support::planar_arm(&[1.0; 4], None);
    with(&|b| {
        b.parameters(ParameterMap::free(&other));
    })
    .says("`arm` | 4 | 2");
    problem(Point::new(foreign_frame(), [0.0; 3])).says("frame | `arm`");
    problem(Posture::of_joints([(weld, 0.0)])).says("moving joint | `arm`");
    let reach = || Task::new(Point::new(hand, [0.0; 3])).named("reach");
    for weight in [-1.0, NAN, f64::INFINITY] {
        problem(reach().weight(Quantity::Metres, weight)).says("reach | weight | metres");
    }
    // Both are finite, but their product is not.
    problem(reach().weight(Quantity::Metres, 1e200).scale(1e200))
        .says("reach | weight | metres | inf");
    for tolerance in [-1.0, NAN] {
        problem(reach().tolerance(Quantity::Metres, tolerance)).says("reach | tolerance | metres");
        with(&|b| {
            b.tolerance(Quantity::Metres, tolerance);
        })
        .says("reach | tolerance");
    }
    problem(reach().weight(Quantity::Pixels, 1.0)).says("reach | no rows | pixels");
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
        with(&|b| {
            b.bound(joint, Limits::new(lower, upper));
        })
        .says(&format!("{name} | bounds"));
    }
    // The requested bounds, not their intersection with the joint's limits.
    with(&|b| {
        b.bound(elbow, Limits::new(-5.0, -7.0));
    })
    .says("`elbow` | [-5, -7]");
    let coupled = ParameterMap::builder(&model).with_coupled(wrist, elbow, 0.1, 0.1);
    let coupled = coupled.build().unwrap();
    with(&|b| {
        b.parameters(coupled.clone());
        b.bound(wrist, Limits::new(0.45, 0.5));
    })
    .says("`wrist` | bounds");
}

#[test]
fn task_errors_name_the_task() {
    let (model, [elbow, ..], hand) = arm();
    let origin = [0.0; 3];
    let camera = |entry: f64| Camera {
        pixel_from_world: [[entry; 4]; 3],
    };
    let bent: Matrix3<f64> = stretched().rotation;
    problem(Point::new(hand, [NAN, 0.0, 0.0])).says("point of `hand` | target | NaN");
    let (point, pose) = (Point::new(hand, origin), FramePose::new(hand, identity()));
    let turn = Orientation::new(hand, identity().rotation);
    problem(point.relative_to(hand)).says("point of `hand` | own base");
    problem(pose.relative_to(hand)).says("pose of `hand` | own base");
    problem(turn.relative_to(hand)).says("orientation of `hand` | own base");
    problem(Distance::new(hand, hand, 0.1)).says("distance of `hand` | itself");
    problem(Point::new(hand, origin).at([0.0, NAN, 0.0])).says("offset");
    problem(Ray::new(hand, origin, origin)).says("ray of `hand` | coincide");
    problem(Ray::new(hand, [NAN; 3], origin)).says("ray of `hand` | NaN");
    problem(Pixel::new(hand, camera(1.0), [NAN, 0.0])).says("pixel");
    problem(Pixel::new(hand, camera(NAN), [0.0, 0.0])).says("camera");
    problem(Orientation::new(hand, bent)).says("orientation of `hand` | orthonormal");
    problem(FramePose::new(hand, stretched())).says("pose of `hand` | orthonormal");
    problem(FramePose::new(hand, mirror())).says("reflection");
    problem(FramePose::new(hand, identity()).with_tool(mirror()))
        .says("pose of `hand` | tool | reflection");
    for half_width in [-1.0, NAN] {
        let goal = PoseBounds::within([0.0, 0.0, 0.0, 0.1, half_width, 0.0]);
        problem(FramePose::new(hand, identity()).with_goal(goal)).says(&format!(
            "pose of `hand` | half width for ry | {half_width}"
        ));
    }
    let nothing = PoseBounds::within([f64::INFINITY; 6]);
    problem(FramePose::new(hand, identity()).with_goal(nothing))
        .says("pose of `hand` | every component free");
    problem(FramePose::new(hand, identity()).relative_to(foreign_frame()))
        .says("pose of `hand` | frame | `arm`");
    for (lower, upper) in [(1.0, 0.0), (NAN, 1.0), (f64::INFINITY, f64::INFINITY)] {
        problem(Bounded::between(Point::new(hand, origin), lower, upper))
            .says("point of `hand` | interval | no number");
    }
    problem(Bounded::new(Point::new(hand, [NAN; 3]), 0.1)).says("point of `hand` | target | NaN");
    let mut other = Model::builder("balls");
    other.ball("hip", None, identity(), Z, None);
    let foreign = Posture::new(&other.build().unwrap(), &[1.0, 0.0, 0.0, 0.0]);
    let words = "4 numbers for its joints | 1";
    problem(foreign.clone()).says(words);
    problem(Bounded::new(foreign, 0.1)).says(words);
    problem(LookAt::new(hand, origin, [1.0; 3])).says("look-at | axis");
    problem(LookAt::new(hand, [1.0; 3], [NAN; 3])).says("look-at | target");
    problem(Plane::new(hand, origin, origin)).says("plane | normal");
    problem(Distance::new(hand, hand, -1.0)).says("distance | negative");
    problem(Distance::new(hand, hand, NAN)).says("distance | NaN");
    problem(Posture::of_joints([(elbow, NAN)])).says("posture | NaN");
    for step in [0.0, f64::INFINITY] {
        problem(Smoothness::new(&model, &[0.0; 2], step)).says("smoothness | time step");
    }
    problem(Smoothness::new(&model, &[NAN; 2], 0.1)).says("smoothness | NaN");
}

#[test]
fn skeleton_errors_name_the_bone() {
    let bone = |name: &str| Bone {
        name: name.to_owned(),
        parent: None,
        length: 1.0,
        model_from_rest: identity(),
        limits: [Limits::new(-1.0, 1.0); 3],
    };
    let build = |bones: Vec<Bone>| Skeleton::new("rig", bones);
    let rig = support::bones::RandomRig::new(1);
    let later = rig.skeleton.bone_at(5);
    build(vec![
        bone("a"),
        Bone {
            parent: later,
            ..bone("b")
        },
    ])
    .says("`b` | parent");
    let first_bone = rig.skeleton.bone_at(0);
    build(vec![Bone {
        parent: first_bone,
        ..bone("a")
    }])
    .says("`a` | parent");
    for length in [-1.0, NAN, f64::INFINITY] {
        build(vec![Bone {
            length,
            ..bone("a")
        }])
        .says("`a` | length");
    }
    for (k, angle) in ["first twist", "bend", "second twist"]
        .into_iter()
        .enumerate()
    {
        let mut wrong = bone("a");
        wrong.limits[k] = Limits::new(1.0, -1.0);
        build(vec![wrong]).says(&format!("`a` | {angle} | [1, -1]"));
    }
    for (rest, problem) in [(stretched(), "orthonormal"), (mirror(), "reflection")] {
        let wrong = Bone {
            model_from_rest: rest,
            ..bone("a")
        };
        build(vec![wrong]).says(&format!("`a` | rest | {problem}"));
    }
    build(vec![bone("a"), bone("a")]).says("`a` | twice");
}

#[test]
fn start_errors_name_the_joint() {
    let (model, _, hand) = arm();
    let mut builder = Problem::builder(&model);
    builder.add(Point::new(hand, [0.0; 3]));
    let problem = builder.build().unwrap();
    let solver = Solver::default();
    let mut workspace = Workspace::new();
    solver
        .solve(&problem, &[0.0], &mut workspace)
        .says("`arm` | 1 | 2");
    solver
        .solve(&problem, &[0.0; 3], &mut workspace)
        .says("3 | 2");
    solver
        .solve(&problem, &[0.0, NAN], &mut workspace)
        .says("`wrist` | NaN");
}
