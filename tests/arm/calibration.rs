//! Promise: a calibration explains measurements of an arm that differs from its model, and says which parameters they
//! determine.

use kinopt::Arm;
use kinopt::calibration::{Calibration, CalibrationError, Measurements, Noise, ParameterSet};
use kinopt::robot::{Robot, with_origin_corrections};
use kinopt::spatial::{Placement, Vector3};
use nalgebra as na;
use support::random::Random;
use support::{Rigid, placement};

const UR5E: (&str, &str, &str) = ("../models/universal_ur5e.urdf", "base", "flange");
const PANDA: (&str, &str, &str) = ("../models/franka_panda.urdf", "base", "flange");
/// Standard deviation of each direction: metres and radians.
const NOISE: Noise = Noise {
    position: 1e-4,
    angle: 2e-4,
};

/// An arm, its model, and where a measuring device is.
struct Bench {
    text: String,
    model: Robot,
    tip: &'static str,
    arm: Arm,
    device_from_base: Placement<f64>,
    random: Random,
}

/// Number with a standard normal distribution, by Box and Muller.
fn normal(random: &mut Random) -> f64 {
    let (radius, angle) = (
        random.within(1e-12, 1.0),
        random.within(0.0, std::f64::consts::TAU),
    );
    (-2.0 * radius.ln()).sqrt() * angle.cos()
}

fn normals(random: &mut Random, size: f64) -> na::Vector3<f64> {
    na::Vector3::from_fn(|_, _| size * normal(random))
}

fn displacement(random: &mut Random, metres: f64, radians: f64) -> Placement<f64> {
    let shift = na::Vector3::from_fn(|_, _| random.within(-metres, metres));
    let turn = na::Vector3::from_fn(|_, _| random.within(-radians, radians));
    placement(&Rigid::from_parts(
        shift.into(),
        na::UnitQuaternion::from_scaled_axis(turn).to_rotation_matrix(),
    ))
}

impl Bench {
    /// An arm whose joint frames are up to 2 mm and 0.5° per direction away from those of its model.
    fn new((file, base, tip): (&str, &str, &'static str), seed: u64) -> Self {
        let text = std::fs::read_to_string(file).unwrap();
        let model = Robot::parse(&text, file).unwrap();
        let mut random = Random::new(seed);
        let names = model.chain(base, tip).unwrap();
        let names = names
            .iter()
            .map(|id| model.model().joints()[id.index()].name.clone());
        let changes: Vec<_> = names
            .map(|name| (name, displacement(&mut random, 2e-3, 0.5_f64.to_radians())))
            .collect();
        let actual = with_origin_corrections(&text, file, &changes).unwrap();
        let actual = Robot::parse(&actual, file).unwrap();
        Self {
            text,
            model,
            tip,
            arm: Arm::new(&actual, base, tip).unwrap(),
            device_from_base: placement(&random.rigid(1.0)),
            random,
        }
    }

    /// Configurations within the middle of the limits, and noisy poses of the tip.
    fn measure(&mut self, count: usize) -> (Vec<f64>, Vec<Placement<f64>>) {
        let limits: Vec<_> = self.arm.limits().collect();
        let mut configurations = Vec::new();
        let mut poses = Vec::new();
        for _ in 0..count {
            let random = &mut self.random;
            let within = limits.iter().map(|range| {
                let (low, high) = (range.lower.max(-3.0), range.upper.min(3.0));
                random.within(0.9 * low + 0.1 * high, 0.1 * low + 0.9 * high)
            });
            let q: Vec<f64> = within.collect();
            let shift = normals(&mut self.random, NOISE.position);
            let turn = normals(&mut self.random, NOISE.angle);
            let turn = na::UnitQuaternion::from_scaled_axis(turn).to_rotation_matrix();
            let exact = self.device_from_base * self.arm.base_from_tool(&q).unwrap();
            let noisy = placement(&Rigid::from_parts(na::Vector3::zeros().into(), turn));
            poses.push(Placement::new(
                exact.rotation * noisy.rotation,
                exact.translation + Vector3::from(shift),
            ));
            configurations.extend(q);
        }
        (configurations, poses)
    }

    fn calibration(&self) -> Calibration {
        Calibration::new(&self.model, "base", self.tip).unwrap()
    }
}

/// Root mean square distance of measured poses from those of a robot.
fn distance(
    arm: &Arm,
    device: Placement<f64>,
    tool: Placement<f64>,
    q: &[f64],
    poses: &[Placement<f64>],
) -> f64 {
    let rows = q.chunks(arm.joint_count()).zip(poses);
    let squares = rows.map(|(q, pose)| {
        let tip = device * arm.base_from_tool(q).unwrap() * tool;
        (tip.translation - pose.translation).norm_squared()
    });
    (squares.sum::<f64>() / poses.len() as f64).sqrt()
}

/// Held-out error of fifty noisy poses, as a multiple of the noise.
fn held_out(bench: &mut Bench) -> f64 {
    let (q, poses) = bench.measure(50);
    let fit = bench
        .calibration()
        .fit(&q, Measurements::Poses(&poses))
        .unwrap();
    assert!(fit.before.position > 1e-3, "{:?}", fit.before);
    assert!(
        (fit.noise.position / NOISE.position - 1.0).abs() < 0.3,
        "{:?}",
        fit.noise
    );
    assert!(
        (fit.noise.angle / NOISE.angle - 1.0).abs() < 0.3,
        "{:?}",
        fit.noise
    );

    // By the text of the calibrated robot alone.
    let urdf = fit.urdf(&bench.text, "robot.urdf").unwrap();
    let arm = Arm::new(
        &Robot::parse(&urdf, "robot.urdf").unwrap(),
        "base",
        bench.tip,
    )
    .unwrap();
    let tool = match fit.urdf_has_tool() {
        true => Placement::identity(),
        false => fit.tip_from_tool,
    };
    let (q, poses) = bench.measure(400);
    distance(&arm, fit.device_from_base, tool, &q, &poses) / (NOISE.position * 3.0_f64.sqrt())
}

#[test]
fn fifty_noisy_poses_predict_others() {
    for model in [UR5E, PANDA] {
        for seed in 1..4 {
            let ratio = held_out(&mut Bench::new(model, seed));
            #[allow(
                clippy::print_stdout,
                reason = "a figure of docs/reference/benchmarks.md"
            )]
            {
                println!("{} {seed}: {ratio:.3} times the noise", model.0);
            }
            assert!(ratio < 1.1, "{} {seed}: {ratio}", model.0);
        }
    }
}

#[test]
fn points_alone_predict_others() {
    let mut bench = Bench::new(UR5E, 5);
    let (q, poses) = bench.measure(100);
    let points: Vec<_> = poses.iter().map(|pose| pose.translation).collect();
    let fit = bench
        .calibration()
        .fit(&q, Measurements::Points(&points))
        .unwrap();
    let urdf = fit.urdf(&bench.text, "robot.urdf").unwrap();
    let arm = Arm::new(
        &Robot::parse(&urdf, "robot.urdf").unwrap(),
        "base",
        "flange",
    )
    .unwrap();
    let (q, poses) = bench.measure(400);
    let tool = match fit.urdf_has_tool() {
        true => Placement::identity(),
        false => fit.tip_from_tool,
    };
    let error = distance(&arm, fit.device_from_base, tool, &q, &poses);
    assert!(error < 1.15 * NOISE.position * 3.0_f64.sqrt(), "{error}");
}

#[test]
fn exact_joint_offsets_are_recovered() {
    let text = std::fs::read_to_string(UR5E.0).unwrap();
    let model = Robot::parse(&text, UR5E.0).unwrap();
    let arm = Arm::new(&model, "base", "flange").unwrap();
    let offsets = [0.004, -0.006, 0.01, -0.003, 0.005, 0.002];
    let mut random = Random::new(3);
    let q: Vec<f64> = (0..120).map(|_| random.within(-2.5, 2.5)).collect();
    let actual = q
        .iter()
        .zip(offsets.iter().cycle())
        .map(|(q, offset)| q + offset);
    let actual: Vec<f64> = actual.collect();
    let poses: Vec<_> = actual
        .chunks(6)
        .map(|q| arm.base_from_tool(q).unwrap())
        .collect();
    let only_offsets = ParameterSet {
        link_positions: false,
        link_rotations: false,
        base: false,
        tool: false,
        ..ParameterSet::default()
    };
    let calibration = Calibration::new(&model, "base", "flange").unwrap();
    let calibration = calibration.with_parameters(only_offsets);
    let fit = calibration.fit(&q, Measurements::Poses(&poses)).unwrap();
    assert_eq!(fit.parameters.len(), 6);
    for (parameter, offset) in fit.parameters.iter().zip(offsets) {
        assert!(
            (parameter.value - offset).abs() < 1e-9,
            "{parameter:?} is not {offset}"
        );
        assert!(parameter.is_determined && parameter.name.ends_with(" offset"));
    }
}

#[test]
fn outliers_are_named_and_do_not_count() {
    let mut bench = Bench::new(UR5E, 7);
    let (q, mut poses) = bench.measure(60);
    let wrong = [4, 17, 42];
    for index in wrong {
        poses[index].translation.x += 0.02;
    }
    let fit = bench
        .calibration()
        .fit(&q, Measurements::Poses(&poses))
        .unwrap();
    assert_eq!(fit.outliers, wrong);
    assert!(
        fit.after.position < 1.3 * NOISE.position * 3.0_f64.sqrt(),
        "{:?}",
        fit.after
    );
    let all_count = bench.calibration().with_robust_loss(false);
    let plain = all_count.fit(&q, Measurements::Poses(&poses)).unwrap();
    assert!(plain.noise.position > 2.0 * fit.noise.position);
}

/// The second, third and fourth axes of a UR5e are parallel: only the sum of translations along them is determined.
#[test]
fn translations_along_parallel_axes_are_undetermined() {
    let mut bench = Bench::new(UR5E, 9);
    let (q, poses) = bench.measure(80);
    let fit = bench
        .calibration()
        .fit(&q, Measurements::Poses(&poses))
        .unwrap();
    let joints: Vec<String> = bench.calibration().joints().map(str::to_owned).collect();
    let is_determined = |name: &str| {
        let parameter = fit
            .parameters
            .iter()
            .find(|parameter| parameter.name == name);
        parameter.unwrap_or_else(|| panic!("{name}")).is_determined
    };
    let undetermined = joints[1..4].iter().filter(|joint| {
        ["x", "y", "z"]
            .iter()
            .any(|axis| !is_determined(&format!("{joint} position {axis}")))
    });
    assert_eq!(undetermined.count(), 3);
    assert!(
        fit.parameters
            .iter()
            .any(|parameter| parameter.is_determined)
    );
}

/// The base rotates about the axis of the first joint: only the sum of its rotation and the joint's offset is determined.
#[test]
fn base_that_sums_with_a_joint_is_undetermined() {
    let mut bench = Bench::new(UR5E, 9);
    let (q, poses) = bench.measure(80);
    let fit_of = |parameters| {
        let calibration = bench.calibration().with_parameters(parameters);
        let fit = calibration.fit(&q, Measurements::Poses(&poses)).unwrap();
        move |name: &str| {
            let named = |found: &&kinopt::calibration::ParameterEstimate| found.name == name;
            fit.parameters.iter().find(named).unwrap().is_determined
        }
    };
    let all = fit_of(ParameterSet::default());
    for name in [
        "base position x",
        "base position y",
        "base position z",
        "base rotation z",
    ] {
        assert!(!all(name), "{name}");
    }
    let links = ParameterSet {
        joint_offsets: false,
        link_positions: false,
        link_rotations: false,
        ..ParameterSet::default()
    };
    let base_and_tool = fit_of(links);
    assert!(base_and_tool("base position x") && base_and_tool("base rotation z"));
}

#[test]
fn wrong_units_are_an_error() {
    let mut bench = Bench::new(UR5E, 4);
    let (q, poses) = bench.measure(20);
    let calibration = bench.calibration();
    let degrees: Vec<f64> = q.iter().map(|radians| radians.to_degrees()).collect();
    let millimetres = poses.iter().map(|pose| Placement {
        translation: pose.translation * 1e3,
        ..*pose
    });
    let millimetres: Vec<_> = millimetres.collect();
    let points: Vec<_> = millimetres.iter().map(|pose| pose.translation).collect();
    for error in [
        calibration.fit(&degrees, Measurements::Poses(&poses)),
        calibration.fit(&q, Measurements::Poses(&millimetres)),
        calibration.fit(&q, Measurements::Points(&points)),
        calibration
            .clone()
            .with_noise(NOISE)
            .fit(&degrees, Measurements::Poses(&poses)),
    ] {
        let error = error.unwrap_err();
        assert!(matches!(error, CalibrationError::NoFit { .. }), "{error}");
        assert!(error.to_string().contains("units"), "{error}");
    }
}

#[test]
fn urdf_keeps_all_other_text() {
    let mut bench = Bench::new(PANDA, 2);
    let (q, poses) = bench.measure(20);
    let fit = bench
        .calibration()
        .fit(&q, Measurements::Poses(&poses))
        .unwrap();
    let urdf = fit.urdf(&bench.text, "robot.urdf").unwrap();
    let without_origins = |text: &str| {
        let parts = text
            .split("<origin")
            .map(|part| part.split_once("/>").map_or(part, |(_, rest)| rest));
        parts
            .collect::<Vec<_>>()
            .concat()
            .split_whitespace()
            .collect::<Vec<_>>()
            .join(" ")
    };
    assert_eq!(without_origins(&urdf), without_origins(&bench.text));
    assert_ne!(urdf, bench.text);
}

#[test]
fn invalid_input_is_named() {
    let robot = Robot::read(UR5E.0).unwrap();
    let calibration = Calibration::new(&robot, "base", "flange").unwrap();
    let poses = vec![Placement::identity(); 4];
    let fit = |q: &[f64], poses: &[Placement<f64>]| {
        calibration.fit(q, Measurements::Poses(poses)).unwrap_err()
    };
    assert!(matches!(
        fit(&[0.0; 18], &poses),
        CalibrationError::Count { joints: 6, .. }
    ));
    assert!(matches!(
        fit(&[0.0; 12], &poses[..2]),
        CalibrationError::TooFew {
            measurements: 2,
            needed: 9,
            ..
        }
    ));
    let mut q = [0.0; 24];
    q[7] = f64::NAN;
    assert!(matches!(
        fit(&q, &poses),
        CalibrationError::Measurement { index: 1, .. }
    ));
    let mut skewed = poses.clone();
    skewed[2].rotation.x.x = 2.0;
    assert!(matches!(
        fit(&[0.0; 24], &skewed),
        CalibrationError::Measurement { index: 2, .. }
    ));
    assert!(matches!(
        Calibration::new(&robot, "flange", "base"),
        Err(CalibrationError::NotBelow { .. })
    ));
    assert!(
        Calibration::new(&robot, "base", "nothing")
            .unwrap_err()
            .to_string()
            .contains("nothing")
    );
}
