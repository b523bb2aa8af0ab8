//! Promise: the centre of mass and its Jacobian equal Pinocchio's to 1e-12, and the Jacobian equals finite differences
//! on the manifold. Models without a centre of mass are rejected by name.
//!
//! The numbers are of pin 4.1.0 from PyPI, by `centerOfMass`, `jacobianCenterOfMass` and `computeTotalMass` of
//! `buildModelFromUrdf("leaning.urdf")` at (0.3, -0.7, 1.9, 0.12). The second model has a JointModelFreeFlyer, a
//! JointModelSpherical at 0.9 rad about z and a JointModelRY with the masses below (row-major).

use kinopt::kinematics::KinematicsError;
use kinopt::kinematics::{centre_of_mass, centre_of_mass_jacobian};
use kinopt::model::ModelError;
use kinopt::model::{Limits, Masses, Model, PointMass};
use kinopt::robot::Robot;
use kinopt::spatial::{Placement, Vector3, rotation_exp};
use nalgebra::Matrix3xX;
use support::fault_tables::ExpectedError;
use support::figures::Figure;

struct Expected<const N: usize> {
    total: f64,
    centre: [f64; 3],
    jacobian: [f64; N],
}

const LEANING: Expected<12> = Expected {
    total: 27.8,
    centre: [0.11374155910125018, 0.0678258025247298, 0.6952314836559549],
    jacobian: [
        0.5675655769443422,
        0.2389193886500207,
        0.006839545927028303,
        0.013563571405989388,
        0.24496771749225632,
        -0.051097399361827694,
        0.03821917398379826,
        -0.02226296827849879,
        -0.09211842274294414,
        -0.015319457462656453,
        -0.16244527455118654,
        -0.006944405830140062,
    ],
};

const FLOATING: Expected<30> = Expected {
    total: 11.5,
    centre: [0.5527563715486867, -1.1812339405068768, 0.8611501890328767],
    jacobian: [
        0.4285714285714286,
        -0.5142857142857142,
        -0.7428571428571429,
        -0.027185139841855086,
        0.09723633515655487,
        -0.08300119732483903,
        0.044020129481773126,
        0.00990636326578106,
        -0.010744707091788657,
        -0.009063858157905969,
        0.2857142857142857,
        0.8571428571428572,
        -0.4285714285714285,
        -0.0024160482580728062,
        0.05565562945837398,
        0.10970056007803301,
        -0.028247843335484933,
        0.08042346176762877,
        0.007347356261357441,
        0.019511568375272372,
        0.857142857142857,
        -0.02857142857142858,
        0.5142857142857142,
        0.0143979193402851,
        -0.08058514906676625,
        -0.0284734849597402,
        -0.0649519856883877,
        -0.02839947759800686,
        0.015782026594638388,
        -0.014753795287909495,
    ],
};

const BASE_TURN: [f64; 4] = [
    0.8366600265340755,
    0.11952286093343936,
    -0.47809144373375745,
    0.23904572186687872,
];
const SHOULDER_TURN: [f64; 4] = [
    0.5812381937190965,
    0.6974858324629157,
    0.34874291623145787,
    -0.2324952774876386,
];

impl<const N: usize> Expected<N> {
    fn check(&self, total: f64, centre: Vector3<f64>, jacobian: &Matrix3xX<f64>) {
        assert!((total - self.total).abs() < 1e-12);
        for (ours, theirs) in centre.to_array().iter().zip(self.centre) {
            assert!((ours - theirs).abs() < 1e-12, "{ours} {theirs}");
        }
        let rows = jacobian.transpose();
        assert_eq!(rows.len(), N);
        for (ours, theirs) in rows.iter().zip(self.jacobian) {
            assert!((ours - theirs).abs() < 1e-12, "{ours} {theirs}");
        }
    }
}

/// Includes a plate of 40 kg fixed to the world, which does not count.
#[test]
fn robot_on_a_fixed_base_equals_pinocchio() {
    let text = include_str!("leaning.urdf");
    let robot = Robot::reader().parse(text, "leaning.urdf").unwrap();
    let q = [0.3, -0.7, 1.9, 0.12];
    let centre = robot.centre_of_mass(&q).unwrap();
    let jacobian = robot.centre_of_mass_jacobian(&q).unwrap();
    LEANING.check(robot.masses().unwrap().total(), centre, &jacobian);
    // A motor fixed to its link is one mass with it.
    assert_eq!(robot.masses().unwrap().points().len(), 4);
}

/// Free and ball joints: configurations with quaternions, velocities in local axes.
#[test]
fn robot_on_a_free_base_equals_pinocchio() {
    let still = Placement::identity();
    let mut builder = Model::builder("body");
    let base = builder.free("base", None, still, [Limits::UNBOUNDED; 3]);
    let [x, y, z] = Vector3::UNITS;
    let at = Placement::new(rotation_exp(z * 0.9), Vector3::new(0.1, 0.2, 0.3));
    let shoulder = builder.ball("shoulder", Some(base), at, x, None);
    let at = Placement::translation(z * 0.3);
    let elbow = builder.revolute("elbow", Some(shoulder), at, y, Limits::UNBOUNDED);
    let parts = [
        (base, [0.05, 0.0, -0.1], 8.0),
        (shoulder, [0.01, 0.02, 0.15], 2.0),
        (elbow, [0.0, -0.03, 0.2], 1.5),
    ];
    let parts = parts.map(|(joint, at, mass)| PointMass {
        frame: builder.frame(format!("{joint:?}"), Some(joint), still),
        at: at.into(),
        mass,
    });
    let model = builder.build().unwrap();
    let masses = Masses::new(&model, parts).unwrap();
    let mut q = vec![0.5, -1.25, 0.75];
    q.extend(BASE_TURN);
    q.extend(SHOULDER_TURN);
    q.push(0.8);
    let centre = centre_of_mass(&model, &masses, &q).unwrap();
    let jacobian = centre_of_mass_jacobian(&model, &masses, &q).unwrap();
    FLOATING.check(masses.total(), centre, &jacobian);
}

#[test]
fn jacobian_matches_differences_on_the_manifold() {
    for seed in 0..10 {
        let figure = Figure::new(seed, 8);
        let model = &figure.model;
        let parts = figure
            .frames
            .iter()
            .enumerate()
            .map(|(k, &frame)| PointMass {
                frame,
                at: Vector3::new(0.1, -0.2, 0.05 * k as f64),
                mass: 1.0 + k as f64,
            });
        let masses = Masses::new(model, parts).unwrap();
        let q = model.random_configuration(seed);
        let jacobian = centre_of_mass_jacobian(model, &masses, &q).unwrap();
        let step = 1e-5;
        for k in 0..model.degrees_of_freedom() {
            let along = |step: f64| {
                let mut v = vec![0.0; model.degrees_of_freedom()];
                v[k] = step;
                let mut moved = q.clone();
                model.integrate(&q, &v, &mut moved).unwrap();
                centre_of_mass(model, &masses, &moved).unwrap()
            };
            let slope = (along(step) - along(-step)) * (0.5 / step);
            let error = slope - Vector3::from(jacobian.column(k).into_owned());
            assert!(error.norm() < 1e-8, "seed {seed}, column {k}: {error:?}");
        }
    }
}

#[test]
fn models_without_a_centre_are_rejected_by_name() {
    let text = include_str!("leaning.urdf");
    let parse = |text: &str| Robot::reader().parse(text, "leaning.urdf").unwrap();
    // Only the plate, which is fixed to the world, has mass.
    let light = ["3.2", "1.1", "5.5", "17.25", "0.75"];
    let light = light.iter().fold(text.to_owned(), |text, mass| {
        text.replace(&format!("mass value=\"{mass}\""), "mass value=\"0\"")
    });
    let robot = parse(&light);
    let no_mass = ModelError::NoMass {
        model: "leaning".to_owned(),
    };
    assert_eq!(robot.masses().unwrap_err(), no_mass);
    let error = robot.centre_of_mass(&[0.0; 4]).unwrap_err();
    assert_eq!(error, KinematicsError::Masses(no_mass));
    robot.masses().says("`leaning` | no centre of mass");

    let negative = text.replace("mass value=\"5.5\"", "mass value=\"-5.5\"");
    parse(&negative).masses().says("`thigh` | -5.5");

    let robot = parse(text);
    let model = robot.model();
    let point = |at: [f64; 3], mass| PointMass {
        frame: model.frame("thigh").unwrap(),
        at: at.into(),
        mass,
    };
    assert!(matches!(
        Masses::new(model, [point([0.0; 3], f64::NAN)]),
        Err(ModelError::BadMass { .. })
    ));
    assert!(matches!(
        Masses::new(model, [point([f64::INFINITY; 3], 1.0)]),
        Err(ModelError::BadMassPosition { .. })
    ));
    // No mass, or an overflowing one.
    for none in [vec![], vec![point([0.0; 3], f64::MAX); 2]] {
        let error = Masses::new(model, none).unwrap_err();
        assert!(matches!(error, ModelError::NoMass { .. }), "{error}");
    }
    let figure = Figure::new(1, 20);
    let foreign = PointMass {
        frame: figure.frames[19],
        at: Vector3::zero(),
        mass: 1.0,
    };
    let foreign = Masses::new(model, [foreign]).unwrap_err();
    assert!(
        matches!(foreign, ModelError::ForeignMass { index: 19, .. }),
        "{foreign}"
    );
    let wrong = robot.centre_of_mass(&[0.0; 3]).unwrap_err().to_string();
    assert!(wrong.contains('4') && wrong.contains('3'), "{wrong}");
}
