//! Promise: an invalid loop, or one that no joint values close, is named in the error of building the model.

use kinopt::Arm;
use kinopt::Problem;
use kinopt::arm::{ArmError, Base};
use kinopt::geometric::{Ccd, Geometric};
use kinopt::ik::LoopClosure;
use kinopt::ik::SolveError;
use kinopt::model::{
    FrameId, JointId, Limits, Loop, Model, ModelBuilder, ModelError, ParameterMap,
};
use kinopt::robot::{Mimic, Robot};
use kinopt::spatial::{Matrix3, Placement, Vector3};
use support::fault_tables::ExpectedError;

use crate::loops::mechanisms::{FourBar, ROTATION_LIMITS, along_x};

const Z: Vector3<f64> = Vector3 {
    x: 0.0,
    y: 0.0,
    z: 1.0,
};

/// A revolute joint with a tip at 1 m, another at 3 m with an equal tip, and a prismatic joint at the second tip.
fn two_revolutes(travel: f64) -> (ModelBuilder, [FrameId; 2]) {
    let mut builder = Model::builder("two hinges");
    let one = builder.revolute("one", None, along_x(0.0), Z, ROTATION_LIMITS);
    let two = builder.revolute("two", None, along_x(3.0), Z, ROTATION_LIMITS);
    let slide = builder.prismatic(
        "slide",
        Some(two),
        along_x(1.0),
        Z,
        Limits::new(0.0, travel),
    );
    let ends = [
        builder.frame("one's end", Some(one), along_x(1.0)),
        builder.frame("two's end", Some(slide), Placement::identity()),
    ];
    (builder, ends)
}

#[test]
fn unreachable_gap_is_reported() {
    let (mut builder, ends) = two_revolutes(0.5);
    builder.close(Loop::connect("far", ends));
    let error = builder.build().unwrap_err();
    let ModelError::LoopCannotClose { name, gap, unit } = &error else {
        panic!("{error}")
    };
    assert_eq!((name.as_str(), *unit), ("far", "m"));
    assert!((gap - 0.5).abs() < 1e-12, "{gap}");
    assert!(error.to_string().contains("loop `far` cannot close"));
    // A prismatic joint of sufficient range can close it.
    let (mut builder, ends) = two_revolutes(1.5);
    builder.close(Loop::connect("far", ends));
    assert!(builder.build().is_ok());
}

fn built_joint(builder: &ModelBuilder, name: &str) -> JointId {
    builder.clone().build().unwrap().joint(name).unwrap()
}

#[test]
fn frames_without_joints_between_must_coincide() {
    let turned = Placement::new(Matrix3::rotation(Z, (0.6, 0.8)), Vector3::zero());
    type Kind = fn(&'static str, [FrameId; 2]) -> Loop;
    let (connect, weld): (Kind, Kind) = (Loop::connect, Loop::weld);
    for (at, make_loop, fine) in [
        (along_x(0.0), weld, true),
        (along_x(1e-6), connect, false),
        (turned, connect, true),
        (turned, weld, false),
    ] {
        let (mut builder, ends) = two_revolutes(1.0);
        let one = Some(built_joint(&builder, "one"));
        let side_frame = builder.frame("beside one's end", one, along_x(1.0));
        let stiff_loop = make_loop("stiff", [ends[0], side_frame]);
        builder.close(stiff_loop.at([Placement::identity(), at]));
        match builder.build() {
            Ok(_) => assert!(fine),
            Err(ModelError::LoopCannotClose { .. }) => assert!(!fine),
            Err(error) => panic!("{error}"),
        }
    }
}

#[test]
fn invalid_names_frames_and_points_are_named() {
    let built = |loops: &[Loop]| {
        let mut builder = Model::builder("four-bar");
        FourBar::CRANK_ROCKER.add_to(&mut builder, None);
        loops
            .iter()
            .for_each(|closure| builder.close(closure.clone()));
        builder.build().unwrap_err().to_string()
    };
    let frame = |k| FourBar::CRANK_ROCKER.model().frame_ids().nth(k).unwrap();
    let ends = [frame(0), frame(1)];
    assert!(built(&[Loop::connect("pin", ends)]).contains("loop name `pin` is used twice"));
    let itself = Loop::weld("alone", [ends[1]; 2]);
    assert_eq!(
        built(&[itself]),
        "loop `alone` connects frame `rocker end` to itself"
    );
    let (mut foreign, _) = two_revolutes(1.0);
    let beyond = (0..9).map(|k| foreign.frame(format!("{k}"), None, Placement::identity()));
    let beyond = beyond.last().unwrap();
    let foreign_loop = Loop::weld("other", [ends[0], beyond]);
    assert!(
        built(&[foreign_loop]).contains("loop `other` connects a frame that is not in this model")
    );
    for invalid in [f64::NAN, f64::INFINITY] {
        let places = [along_x(0.0), along_x(invalid)];
        let reported = built(&[Loop::connect("nowhere", ends).at(places)]);
        assert!(
            reported.contains("loop `nowhere`") && reported.contains("row 0, column 3"),
            "{reported}"
        );
    }
    let mirrored = Placement::new(
        Matrix3::from_columns(Z * -1.0, Vector3::UNITS[1], Vector3::UNITS[0] * -1.0),
        Vector3::zero(),
    );
    let reported = built(&[Loop::weld("mirror", ends).at([mirrored, along_x(0.0)])]);
    assert!(reported.contains("loop `mirror`"), "{reported}");
}

#[test]
fn arms_and_geometric_solvers_reject_loops() {
    let mut builder = Model::builder("four-bar on an arm");
    let shoulder = builder.revolute("shoulder", None, along_x(0.0), Z, ROTATION_LIMITS);
    let elbow = builder.revolute("elbow", Some(shoulder), along_x(1.0), Z, ROTATION_LIMITS);
    let hand = builder.frame("hand", Some(elbow), along_x(1.0));
    FourBar::CRANK_ROCKER.add_to(&mut builder, Some(elbow));
    let model = builder.build().unwrap();
    // An arm above the loop is valid.
    assert!(Arm::new(&model, Base::World, hand).is_ok());
    let error = Arm::new(&model, Base::World, "pen").unwrap_err();
    assert!(
        matches!(&error, ArmError::InLoop { joint, closed } if joint == "coupler" && closed == "pin")
    );
    let held = Arm::builder(&model, Base::World, "pen")
        .with_locked("crank", 0.3)
        .with_locked("coupler", 0.5);
    assert!(held.build().is_ok());

    let problem = Problem::builder(&model).build().unwrap();
    let error = Ccd::default().solve(&problem, &[0.0; 5]).unwrap_err();
    assert!(matches!(&error, SolveError::UnsupportedTask { task, .. } if task == "loop `pin`"));
}

/// The crank of the loop is a mimic joint of the elbow, which is in no loop.
#[test]
fn arm_that_drives_a_loop_is_rejected() {
    let mut builder = Model::builder("two hinges beside a four-bar");
    let shoulder = builder.revolute("shoulder", None, along_x(0.0), Z, ROTATION_LIMITS);
    let elbow = builder.revolute("elbow", Some(shoulder), along_x(1.0), Z, ROTATION_LIMITS);
    builder.frame("hand", Some(elbow), along_x(1.0));
    let [crank, _, _] = FourBar::CRANK_ROCKER.add_to(&mut builder, None);
    let follows = |master| Mimic {
        joint: crank,
        master,
        ratio: 0.5,
        offset: 0.0,
    };
    let model = builder.build().unwrap();
    let alone = Arm::new(&model, Base::World, "hand");
    assert!(alone.is_ok());
    for (master, name) in [(shoulder, "shoulder"), (elbow, "elbow")] {
        let robot = Robot::new(model.clone(), vec![follows(master)]).unwrap();
        let error = Arm::new(&robot, Base::World, "hand").unwrap_err();
        assert!(
            matches!(&error, ArmError::InLoop { joint, closed } if joint == name && closed == "pin"),
            "{error}"
        );
        let held = Arm::builder(&robot, Base::World, "hand").with_locked(name, 0.3);
        assert!(held.build().is_ok());
    }
}

#[test]
fn robots_accept_additional_loops() {
    let model = FourBar::CRANK_ROCKER.model();
    let ends = model.loops()[0].frames;
    let robot = Robot::new(model, Vec::new()).unwrap();
    let error = robot
        .clone()
        .with_loop(Loop::weld("pin", ends))
        .unwrap_err();
    assert!(error.to_string().contains("`pin` is used twice"));
    let robot = robot.with_loop(Loop::weld("another", ends)).unwrap();
    let based = robot
        .with_base_joint(kinopt::robot::BaseJoint::FREE)
        .unwrap();
    let names: Vec<_> = based
        .model()
        .loops()
        .iter()
        .map(|closure| closure.name.as_str())
        .collect();
    assert_eq!(names, ["pin", "another"]);
}

#[test]
fn unclosable_loops_are_named() {
    let model = FourBar::CRANK_ROCKER.model();
    let joint = |name| model.joint(name).unwrap();
    let parameters = || ParameterMap::builder(&model);
    LoopClosure::new(parameters(), &[]).says("name some of crank, coupler, rocker");

    let dependent = [joint("coupler"), joint("rocker")];
    let closure = LoopClosure::new(parameters(), &dependent).unwrap();
    for (q, reported) in [
        (vec![0.1, f64::NAN, 0.0], "not a finite number"),
        (vec![0.1, 0.0], "has 3 numbers, not 2"),
        (vec![4.1, 0.0, 0.0], "joint `crank` cannot be locked at 4.1"),
    ] {
        let mut given = q.clone();
        closure.close(&mut given).says(reported);
        assert_eq!(format!("{given:?}"), format!("{q:?}"));
    }
    assert!(closure.gaps(&[0.0; 2]).is_err() && closure.gaps(&[f64::NAN; 3]).is_err());

    // The crank alone cannot close a gap of coupler and rocker.
    let crank = LoopClosure::new(parameters(), &[joint("crank")]).unwrap();
    crank
        .close(&mut [0.0; 3])
        .says("loop `pin` is open by 2.300e-1 m: no values of crank");
    // Dependent joints may start anywhere.
    let mut q = [0.3, 90.0, -50.0];
    closure.close(&mut q).unwrap();
    assert!(closure.gaps(&q).unwrap()[0].is_closed() && q[0] == 0.3);
}

/// The length of a prismatic joint is that of its longer side.
#[test]
fn prismatic_joint_bridges_a_gap() {
    for (limits, gap) in [
        (Limits::new(0.0, 4.0), 0.0),
        (Limits::new(-4.0, 0.0), 0.0),
        (Limits::new(-4.0, 1.0), 0.0),
        (Limits::new(-1.0, 2.5), 0.5),
        (Limits::new(-2.5, 1.0), 0.5),
    ] {
        let built = between_hinges(5.0, limits).build();
        match built {
            Ok(_) => assert_eq!(gap, 0.0, "{limits:?}"),
            Err(ModelError::LoopCannotClose { gap: reported, .. }) => {
                assert!((reported - gap).abs() < 1e-12, "{limits:?}: {reported}");
            }
            Err(other) => panic!("{other}"),
        }
    }
}

/// A link of 1 m on a revolute joint; on another at distance `apart`, a prismatic joint of 1 m whose end meets the
/// link's.
fn between_hinges(apart: f64, limits: Limits) -> ModelBuilder {
    let mut builder = Model::builder("two hinges and a rail");
    let one = builder.revolute("one", None, along_x(0.0), Z, ROTATION_LIMITS);
    let two = builder.revolute("two", None, along_x(apart), Z, ROTATION_LIMITS);
    let x = Vector3::new(1.0, 0.0, 0.0);
    let rail = builder.prismatic("rail", Some(two), along_x(1.0), x, limits);
    let far_joint = builder.revolute("far", Some(rail), along_x(0.0), Z, ROTATION_LIMITS);
    let ends = [
        builder.frame("one's end", Some(one), along_x(1.0)),
        builder.frame("far end", Some(far_joint), along_x(0.0)),
    ];
    builder.close(Loop::connect("long", ends));
    builder
}

/// A joint that is always extended, in either direction, is a link of at least that length.
#[test]
fn always_extended_prismatic_joint_is_a_link() {
    for (limits, gap) in [
        (Limits::new(3.25, 4.0), 0.25),
        (Limits::new(-4.0, -3.25), 0.25),
        (Limits::new(2.75, 4.0), 0.0),
        (Limits::new(-4.0, -2.75), 0.0),
        (Limits::new(-4.0, 0.5), 0.0),
    ] {
        match between_hinges(1.0, limits).build() {
            Ok(_) => assert_eq!(gap, 0.0, "{limits:?}"),
            Err(ModelError::LoopCannotClose { gap: reported, .. }) => {
                assert!((reported - gap).abs() < 1e-12, "{limits:?}: {reported}");
            }
            Err(other) => panic!("{other}"),
        }
    }
}

/// Joints of either end may rotate a welded frame, in any order of the ends.
#[test]
fn weld_rotates_by_joints_of_either_end() {
    for hinge_is_first in [true, false] {
        let mut builder = Model::builder("hinge at a wall");
        let hinge = builder.revolute("hinge", None, along_x(0.0), Z, ROTATION_LIMITS);
        let hand = builder.frame("hand", Some(hinge), along_x(1.0));
        let turned = Matrix3::rotation(Z, (0.6, 0.8));
        let at = Placement::new(turned, turned.x);
        let wall = builder.frame("wall", None, at);
        let ends = match hinge_is_first {
            true => [hand, wall],
            false => [wall, hand],
        };
        builder.close(Loop::weld("pin", ends));
        assert!(builder.build().is_ok(), "{hinge_is_first}");
    }
}

/// A weld whose frames coincide but are rotated is open.
#[test]
fn rotated_weld_is_open() {
    let mut builder = Model::builder("hinge in a wall");
    let hinge = builder.revolute("hinge", None, along_x(0.0), Z, ROTATION_LIMITS);
    let hand = builder.frame("hand", Some(hinge), along_x(0.0));
    let wall = builder.frame("wall", None, along_x(0.0));
    builder.close(Loop::weld("pin", [hand, wall]));
    let model = builder.build().unwrap();
    let closure = LoopClosure::new(ParameterMap::builder(&model), &[hinge]).unwrap();
    for (q, closed) in [(0.0, true), (0.3, false)] {
        let gaps = closure.gaps(&[q]).unwrap();
        assert_eq!((gaps[0].is_closed(), gaps[0].gap), (closed, 0.0));
        assert!((gaps[0].angle - q).abs() < 1e-12);
    }
}
