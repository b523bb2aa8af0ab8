//! Promise: models, skeletons, options, solutions and clips survive serde bitwise. Deserialised values are validated
//! like built ones.

use std::fmt::Debug;

use glam::{Quat, Vec3A, Vec4};
use kinopt::animation::curve::{BezierHandle, KeyedCurve, TensionContinuityBias};
use kinopt::animation::rotation::{EulerOrder, RotationCurve};
use kinopt::animation::{
    Armature, Channel, Clip, Cursor, Easing, EulerClip, EulerCurve, EulerInterpolation, EulerKey,
    EulerTrack, KeyTolerance, Playback, Pose,
};
use kinopt::arm::Search;
use kinopt::collision::{Shape, World};
use kinopt::ik::Restarts;
use kinopt::kinematics::ForwardKinematics;
use kinopt::model::{Limits, Loop, Model, ModelBuilder, ParameterMap};
use kinopt::motion::ContactDetection;
use kinopt::motion::Trajectory;
use kinopt::motion::path::{CartesianPath, PathSolver};
use kinopt::motion::retarget::{FootShapes, RetargetOptions, UpAxis};
use kinopt::motion::trajectory::{MotionProblem, MotionReport, MotionSolver};
use kinopt::problem::Preferences;
use kinopt::robot::Robot;
use kinopt::simd_ik::LaneOptions;
use kinopt::skinning::{AutomaticWeights, HeatWeights};
use kinopt::solver::Stopping;
use kinopt::spatial::{Placement, Vector3};
use kinopt::{Arm, Problem, Skeleton, Solution, Solver};
use serde::Serialize;
use serde::de::DeserializeOwned;
use support::bones::RandomRig;
use support::fault_tables::ExpectedError;
use support::planar_arm;
use support::random::Random;
use support::trees::RandomTree;

fn round_trip<T: Serialize + DeserializeOwned>(value: &T) -> T {
    serde_json::from_str(&serde_json::to_string(value).unwrap()).unwrap()
}

fn assert_round_trip<T: Serialize + DeserializeOwned + PartialEq + Debug>(value: &T) {
    assert_eq!(round_trip(value), *value);
}

fn bits(q: &[f64]) -> Vec<u64> {
    q.iter().map(|value| value.to_bits()).collect()
}

fn assert_model_round_trip(model: &Model) {
    let read = round_trip(model);
    assert_eq!(read.joints(), model.joints());
    assert_eq!(read.frames(), model.frames());
    assert_eq!(read.loops(), model.loops());
    assert_eq!(read.moving_joints(), model.moving_joints());
    assert_eq!(
        (read.name(), read.length_unit()),
        (model.name(), model.length_unit())
    );
    let q = model.random_configuration(3);
    let [ours, theirs] = [model, &read].map(|model| {
        let placed = ForwardKinematics::new(model).place(&q).unwrap().to_vec();
        placed
            .iter()
            .flat_map(|p| bits(&p.translation.to_array()))
            .collect::<Vec<_>>()
    });
    assert_eq!(ours, theirs);
}

#[test]
fn models_and_skeletons_survive_serde() {
    for seed in 0..20 {
        assert_model_round_trip(&RandomTree::new(seed, 9).model);
        let skeleton = RandomRig::new(seed).skeleton;
        let read: Skeleton = round_trip(&skeleton);
        assert_eq!(read.bones(), skeleton.bones());
        assert_model_round_trip(skeleton.model());
    }
    assert_model_round_trip(Robot::read("../models/franka_panda.urdf").unwrap().model());
    let held = RandomTree::new(20, 9).model;
    let mut builder = ModelBuilder::from_model(&held);
    let (frame, place) = (
        held.frame_ids().last().unwrap(),
        held.frames()[1].joint_from_frame,
    );
    let own = &held.frames()[frame.index()];
    let beside = builder.frame("beside", own.joint, own.joint_from_frame);
    builder.close(Loop::weld("closed", [frame, beside]).at([place; 2]));
    assert_model_round_trip(&builder.build().unwrap());
    assert_round_trip(&Limits::UNBOUNDED);
    assert_round_trip(&Limits::new(f64::NEG_INFINITY, 0.1 + 0.2));
}

#[test]
fn parameter_maps_survive_serde() {
    let robot = Robot::read("../models/franka_panda.urdf").unwrap();
    assert_round_trip(robot.map());
    for seed in 0..20 {
        let model = RandomTree::new(seed, 9).model;
        assert_round_trip(&ParameterMap::identity(&model));
        assert_round_trip(&ParameterMap::free(&model));
    }
    let text = serde_json::to_string(robot.map()).unwrap();
    for (from, to, what) in [
        ("\"variable\":1,", "\"variable\":99,", "sources"),
        ("\"leaders\":[0,1,", "\"leaders\":[1,0,", "variables"),
        ("\"leaders\":[0,", "\"leaders\":[", "bounds"),
    ] {
        refused::<ParameterMap>(&text, [from, to], what);
    }
}

/// A hinge and a ball joint: variables 0 and 1 to 3, coordinates 0 and 1 to 4.
#[test]
fn parameter_maps_of_ball_joints_survive_serde() {
    let mut builder = Model::builder("ball");
    let (at, z) = (Placement::identity(), Vector3::UNITS[2]);
    builder.revolute("hinge", None, at, z, Limits::UNBOUNDED);
    builder.ball("ball", None, at, z, None);
    let model = builder.build().unwrap();
    assert_round_trip(&ParameterMap::identity(&model));
    let text = serde_json::to_string(&ParameterMap::identity(&model)).unwrap();
    for (from, to, what) in [
        ("\"coordinate\":1,", "\"coordinate\":0,", "balls"),
        ("\"coordinate\":1,", "\"coordinate\":2,", "balls"),
        ("\"coordinate\":1,", "\"coordinate\":9,", "balls"),
    ] {
        refused::<ParameterMap>(&text, [from, to], what);
    }
    // Two variables cannot rotate a ball joint.
    let mut short: serde_json::Value = serde_json::from_str(&text).unwrap();
    for part in ["leaders", "bounds"] {
        short[part].as_array_mut().unwrap().pop();
    }
    serde_json::from_value::<ParameterMap>(short).says("balls");
}

fn refused<T: DeserializeOwned>(text: &str, [from, to]: [&str; 2], what: &str) {
    assert!(text.contains(from), "{text}");
    let read = serde_json::from_str::<T>(&text.replacen(from, to, 1));
    let problem = read.err().expect(to).to_string();
    assert!(problem.contains(what), "{to}: {problem}");
}

#[test]
fn solutions_survive_serde() {
    let tree = RandomTree::new(7, 9);
    for target in [[0.3, 0.2, 0.4], [90.0, 0.0, 0.0]] {
        let mut builder = Problem::builder(&tree.model);
        builder.add(kinopt::task::Point::new(tree.far_frame(), target));
        let problem = builder.build().unwrap();
        let start = tree.configuration(&mut Random::new(1));
        let solution = Solver::default().solve_once(&problem, &start).unwrap();
        let read: Solution = round_trip(&solution);
        assert_eq!(bits(&read.q), bits(&solution.q));
        assert_eq!(read.explain(), solution.explain());
        assert_eq!(format!("{read:?}"), format!("{solution:?}"));
    }
}

#[test]
fn solutions_with_nan_and_infinity_survive_serde() {
    let tree = RandomTree::new(7, 9);
    let mut builder = Problem::builder(&tree.model);
    let hand = builder.add(kinopt::task::Point::new(tree.far_frame(), [0.3, 0.2, 0.4]));
    let problem = builder.build().unwrap();
    let start = tree.configuration(&mut Random::new(1));
    for invalid in [f64::NAN, f64::INFINITY] {
        let mut targets = problem.targets();
        let target = [0.3, invalid, 0.4];
        targets.get_mut(hand).unwrap().set_target(target);
        let question = problem.with_targets(&targets).unwrap();
        let solution = Solver::default().solve_once(question, &start).unwrap();
        assert!(!solution.cost.is_finite());
        let read: Solution = round_trip(&solution);
        assert_eq!(format!("{read:?}"), format!("{solution:?}"));
    }
}

#[test]
fn options_survive_serde() {
    assert_round_trip(&Stopping::default());
    assert_round_trip(&Restarts::default());
    assert_round_trip(&LaneOptions::default());
    assert_round_trip(&AutomaticWeights::default());
    assert_round_trip(&HeatWeights::default());
    assert_round_trip(&Search::First);
    assert_round_trip(&Preferences::Traded);
    assert_round_trip(&ContactDetection::default());
    // Minus infinity is rejected, and must not come back as plus infinity, which is valid.
    assert_round_trip(&ContactDetection::default().with_height(f64::NEG_INFINITY));
    assert_round_trip(&KeyTolerance::EXACT.with_rotation(1e-3));
    let nao = Robot::read("../models/aldebaran_nao.urdf").unwrap();
    let options = RetargetOptions::default().with_up(UpAxis::Y);
    assert_round_trip(&options.with_shapes(FootShapes::of_files(&nao)));
}

#[test]
fn worlds_survive_serde() {
    let mut world = World::new();
    let at = |x: f64| Placement::translation(Vector3::new(x, 0.1 + 0.2, -0.3));
    world
        .add("ball", Shape::sphere(0.1).unwrap(), at(0.4))
        .unwrap();
    world
        .add("box", Shape::cuboid([0.1, 0.2, 0.3]).unwrap(), at(0.7))
        .unwrap();
    world
        .add("other ball", Shape::sphere(0.2).unwrap(), at(1.0))
        .unwrap();
    assert_eq!(round_trip(&world).to_json(), world.to_json());
    let text = serde_json::to_string(&world).unwrap();
    let wrong = text.replace("\"radius\":0.1", "\"radius\":-0.1");
    serde_json::from_str::<World>(&wrong).says("ball");
}

#[test]
fn motions_and_paths_survive_serde() {
    let model = planar_arm(&[0.5, 0.4, 0.3], Some((-1.0, 1.0)));
    let mut motion = MotionProblem::builder(&model, 6, 0.1);
    let tip = motion.add(kinopt::task::Point::new(
        model.frame("tip").unwrap(),
        [9.0, 0.0, 0.0],
    ));
    motion.follow(tip, |frame, task| task.set_target([9.0, frame as f64, 0.0]));
    let solved = MotionSolver::default()
        .solve(&motion.build().unwrap(), &[0.1; 3])
        .unwrap();
    assert!(!solved.report.reached());
    let read: Trajectory<MotionReport> = round_trip(&solved);
    assert_eq!(bits(&read.q), bits(&solved.q));
    assert_eq!(format!("{read:?}"), format!("{solved:?}"));

    let robot = Robot::read("../models/franka_panda.urdf").unwrap();
    let arm = Arm::builder(&robot, "base", "flange")
        .with_atlas(false)
        .build()
        .unwrap();
    let start = [0.0, -0.3, 0.0, -1.8, 0.0, 1.5, 0.7];
    let from = arm.base_from_tool(&start).unwrap();
    let mut to = from;
    to.translation.x += 3.0;
    let path = CartesianPath::new(vec![from, to]).unwrap();
    let solved = PathSolver::new(&arm)
        .with_start(&start)
        .solve(&path)
        .unwrap();
    assert!(!solved.report.missed.is_empty());
    assert_round_trip(&solved);
}

#[test]
fn euler_clips_survive_serde() {
    let skeleton = RandomRig::new(2).skeleton;
    let mut random = Random::new(5);
    let tracks = skeleton.bone_ids().take(4).enumerate().map(|(k, bone)| {
        let key = |i: usize| EulerKey {
            time: i as f64 * 0.1,
            angles: std::array::from_fn(|_| random.within(-1.0, 1.0)),
        };
        // The last track has no keys.
        EulerTrack {
            bone,
            keys: (0..3 - k).map(key).collect(),
        }
    });
    let controls = TensionContinuityBias {
        tension: 0.3,
        continuity: -0.1,
        bias: 0.2,
    };
    let clip = EulerClip::new(tracks.collect()).unwrap();
    assert_round_trip(&clip);
    let first = clip.tracks()[0].bone;
    let drawn = clip.interpolated(|track| match track.bone == first {
        true => EulerInterpolation::kochanek_bartels(track, controls),
        false => EulerInterpolation::Linear,
    });
    assert_round_trip(&drawn.unwrap());
}

#[test]
fn armatures_poses_and_clips_survive_serde() {
    let skeleton = RandomRig::new(4).skeleton;
    let armature = Armature::of_skeleton(&skeleton)
        .with_morph_targets(vec!["smile".into(), "blink".into()])
        .unwrap();
    assert_round_trip(&armature);
    let mut pose = armature.rest().clone();
    pose.morph_weights_mut()[1] = 0.3;
    assert_round_trip(&pose);

    let times = || vec![0.0_f32, 0.4, 1.1];
    let turns = || [0.1_f32, 2.0, -1.0].map(Quat::from_rotation_y).to_vec();
    let rates = || vec![[Vec4::ONE * 0.1; 2]; 3];
    let eased = || vec![Easing::CubicIn; 3];
    let rotations = [
        RotationCurve::step(times(), turns()),
        RotationCurve::slerp(times(), turns()),
        RotationCurve::eased(times(), turns(), eased()),
        RotationCurve::squad(times(), turns()),
        RotationCurve::smooth(times(), turns()),
        RotationCurve::cubic(times(), turns(), rates()),
    ];
    let values = || vec![Vec3A::X, Vec3A::Y * 0.3, Vec3A::Z];
    let handle = |time| BezierHandle {
        time,
        value: Vec3A::ONE * 0.1,
    };
    let vectors = [
        KeyedCurve::step(times(), values()),
        KeyedCurve::linear(times(), values()),
        KeyedCurve::eased(times(), values(), eased()),
        KeyedCurve::catmull_rom(times(), values()),
        KeyedCurve::bezier(times(), values(), vec![[handle(-0.1), handle(0.1)]; 3]),
    ];
    let mut builder = Clip::builder("all", &armature);
    let mut bones = skeleton.bone_ids();
    for curve in rotations {
        let curve = curve.unwrap();
        assert_round_trip(&curve);
        let bone = bones.next().unwrap();
        builder.channel(bone, Channel::Rotation(curve)).unwrap();
    }
    for (curve, bone) in vectors.into_iter().zip(skeleton.bone_ids()) {
        let curve = curve.unwrap();
        assert_round_trip(&curve);
        builder
            .channel(bone, Channel::Translation(curve.clone()))
            .unwrap();
        builder.channel(bone, Channel::Scale(curve)).unwrap();
    }
    let angles = EulerCurve {
        order: EulerOrder::Zxy,
        before: Quat::from_rotation_x(0.2),
        angles: KeyedCurve::linear(times(), values()).unwrap(),
    };
    builder
        .channel(bones.next().unwrap(), Channel::Euler(angles))
        .unwrap();
    builder
        .morph_weight(0, KeyedCurve::linear(times(), vec![0.0, 1.0, 0.5]).unwrap())
        .unwrap();
    builder
        .morph_weight(1, KeyedCurve::step(vec![0.0], vec![0.7]).unwrap())
        .unwrap();
    builder.event(0.5, "there").unwrap();
    builder.span(-0.2, 2.0).unwrap();
    let clip = builder.build();
    let read = round_trip(&clip);
    assert_eq!(read.events(), clip.events());
    assert_eq!((read.name(), read.span()), (clip.name(), clip.span()));
    for step in 0..60 {
        let elapsed = f64::from(step) * 0.07;
        let [ours, theirs] = [&clip, &read].map(|clip| {
            let mut pose = armature.rest().clone();
            clip.sample(elapsed, Playback::Loop, &mut Cursor::new(), &mut pose)
                .unwrap();
            pose
        });
        assert_eq!(ours, theirs);
    }

    let text = serde_json::to_string(&clip).unwrap();
    for (right, wrong) in [
        ("\"span\":[-0.2,2.0]", "\"span\":[3.0,2.0]"),
        ("\"times\":[0.0,0.4,1.1]", "\"times\":[0.0,1.4,1.1]"),
        ("\"time\":0.5", "\"time\":null"),
    ] {
        assert!(text.contains(right), "{right}");
        assert!(serde_json::from_str::<Clip>(&text.replace(right, wrong)).is_err());
    }
    let text = serde_json::to_string(&armature).unwrap();
    let short = text.replacen("\"parents\":[null,", "\"parents\":[", 1);
    serde_json::from_str::<Armature>(&short).says("parents");
}

#[test]
fn invalid_serialised_values_are_rejected() {
    let model = RandomTree::new(1, 4).model;
    let text = serde_json::to_string(&model).unwrap();
    let renamed = text.replace("joint 1", "joint 0");
    serde_json::from_str::<Model>(&renamed).says("used twice");
    let orders = ["\"configuration_order\":[", "\"configuration_order\":[9,"];
    serde_json::from_str::<Model>(&text.replace(orders[0], orders[1])).says("moving joints once");

    let armature = Armature::of_skeleton(&RandomRig::new(4).skeleton);
    let text = serde_json::to_string(armature.rest()).unwrap();
    for bone in 0..2 {
        let mut parts: serde_json::Value = serde_json::from_str(&text).unwrap();
        parts["scales"][bone][1] = 1e39.into();
        let error = serde_json::from_value::<Pose>(parts).unwrap_err();
        let message = format!("bone {bone}:");
        assert!(error.to_string().contains(&message), "{error}");
    }

    let turns = vec![Quat::IDENTITY; 3];
    let curves = [RotationCurve::squad, RotationCurve::smooth];
    for (curve, kind) in curves.into_iter().zip(["Squad", "Hermite"]) {
        let curve = curve(vec![0.0, 1.0, 2.0], turns.clone()).unwrap();
        for key in 0..3 {
            let mut parts = serde_json::to_value(&curve).unwrap();
            parts["between"][kind][key][0] = 1e39.into();
            let error = serde_json::from_value::<RotationCurve>(parts).unwrap_err();
            let message = format!("key {key}: the tangent");
            assert!(error.to_string().contains(&message), "{error}");
        }
    }

    let backwards = r#"[[{"bone":0,"keys":[{"time":1.0,"angles":[0,0,0]},
        {"time":0.5,"angles":[0,0,0]}]},"Linear"]]"#;
    serde_json::from_str::<EulerClip>(backwards).says("not after");
}
