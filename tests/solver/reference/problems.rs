//! The problems of `minima.json`, each stated as a [`Problem`].

use std::collections::BTreeMap;
use std::path::Path;

use kinopt::Model;
use kinopt::io::rig::Rig;
use kinopt::model::ParameterMap;
use kinopt::problem::{Preferences, Problem, ProblemBuilder};
use kinopt::robot::Robot;
use kinopt::spatial::{Matrix3, Placement, Vector3};
use kinopt::task::{
    Distance, FramePose, LimitCentring, LookAt, Orientation, Plane, Point, Posture, Quantity, Ray,
    Residual, Task,
};
use serde::Deserialize;

const TOLERANCE: f64 = 1e-9;

#[derive(Deserialize)]
struct Reference {
    models: BTreeMap<String, ReferenceModel>,
    problems: Vec<Statement>,
}

#[derive(Deserialize)]
struct ReferenceModel {
    file: String,
    variables: Vec<String>,
}

#[derive(Deserialize)]
pub(super) struct Statement {
    pub(super) name: String,
    pub(super) kind: String,
    pub(super) model: String,
    tasks: Vec<StatedTask>,
    pub(super) start: Vec<f64>,
    pub(super) answers: BTreeMap<String, Answer>,
    pub(super) minima: Vec<Minimum>,
    pub(super) best: usize,
}

#[derive(Deserialize)]
pub(super) struct Answer {
    pub(super) x: Vec<f64>,
    pub(super) cost: f64,
    pub(super) kkt: f64,
}

#[derive(Deserialize)]
pub(super) struct Minimum {
    pub(super) cost: f64,
}

#[derive(Deserialize)]
struct Weights {
    metres: Option<f64>,
    radians: Option<f64>,
    #[serde(rename = "joint units")]
    joint_units: Option<f64>,
    ratio: Option<f64>,
}

/// One task as the fixture states it, with rotations by rows.
#[derive(Deserialize)]
struct StatedTask {
    weights: Weights,
    #[serde(flatten)]
    residual: StatedResidual,
}

#[derive(Deserialize)]
#[serde(tag = "task", rename_all = "kebab-case")]
enum StatedResidual {
    Point {
        frame: String,
        target: [f64; 3],
    },
    Ray {
        frame: String,
        eye: [f64; 3],
        through: [f64; 3],
    },
    Plane {
        frame: String,
        point: [f64; 3],
        normal: [f64; 3],
    },
    Distance {
        frame: String,
        other: String,
        distance: f64,
    },
    Orientation {
        frame: String,
        rotation: [f64; 9],
    },
    Pose {
        frame: String,
        target: [f64; 3],
        rotation: [f64; 9],
    },
    LookAt {
        frame: String,
        axis: [f64; 3],
        target: [f64; 3],
    },
    Posture {
        reference: Vec<f64>,
    },
    Centring,
}

/// A model with the variables to which the reference's x refers.
pub(super) struct Loaded {
    model: Model,
    map: ParameterMap,
}

fn load(reference: &ReferenceModel) -> Loaded {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("..")
        .join(&reference.file);
    let (model, map) = if reference.file.ends_with(".json") {
        let model = Rig::read(path).unwrap().skeleton.model().clone();
        let map = ParameterMap::free(&model);
        (model, map)
    } else {
        let robot = Robot::read(path).unwrap();
        (robot.model().clone(), robot.map().clone())
    };
    let names: Vec<&str> = map
        .leaders()
        .iter()
        .map(|&c| {
            model.joints()[model.moving_joints()[c].index()]
                .name
                .as_str()
        })
        .collect();
    assert_eq!(names, reference.variables, "{}", reference.file);
    Loaded { model, map }
}

fn rotation(rows: &[f64; 9]) -> Matrix3<f64> {
    let column = |k: usize| Vector3::new(rows[k], rows[3 + k], rows[6 + k]);
    Matrix3::from_columns(column(0), column(1), column(2))
}

fn weighted<R: Residual>(residual: R, weights: &Weights) -> Task<R> {
    let stated = [
        (Quantity::Metres, weights.metres),
        (Quantity::Radians, weights.radians),
        (Quantity::JointUnits, weights.joint_units),
        (Quantity::Ratio, weights.ratio),
    ];
    let stated = stated.into_iter().filter_map(|(q, w)| Some((q, w?)));
    stated.fold(Task::new(residual), |task, (quantity, weight)| {
        task.weight(quantity, weight)
    })
}

fn add(builder: &mut ProblemBuilder<'_>, task: &StatedTask, loaded: &Loaded) {
    let Loaded { model, map } = loaded;
    let frame = |name: &str| model.frame(name).unwrap();
    let weights = &task.weights;
    match &task.residual {
        StatedResidual::Point { frame: at, target } => {
            builder.add(weighted(Point::new(frame(at), *target), weights));
        }
        StatedResidual::Ray {
            frame: at,
            eye,
            through,
        } => {
            builder.add(weighted(Ray::new(frame(at), *eye, *through), weights));
        }
        StatedResidual::Plane {
            frame: at,
            point,
            normal,
        } => {
            builder.add(weighted(Plane::new(frame(at), *point, *normal), weights));
        }
        StatedResidual::Distance {
            frame: at,
            other,
            distance,
        } => {
            let residual = Distance::new(frame(at), frame(other), *distance);
            builder.add(weighted(residual, weights));
        }
        StatedResidual::Orientation {
            frame: at,
            rotation: rows,
        } => {
            builder.add(weighted(
                Orientation::new(frame(at), rotation(rows)),
                weights,
            ));
        }
        StatedResidual::Pose {
            frame: at,
            target,
            rotation: rows,
        } => {
            let placement = Placement::new(rotation(rows), (*target).into());
            builder.add(weighted(FramePose::new(frame(at), placement), weights));
        }
        StatedResidual::LookAt {
            frame: at,
            axis,
            target,
        } => {
            builder.add(weighted(LookAt::new(frame(at), *axis, *target), weights));
        }
        StatedResidual::Posture { reference } => {
            let joints = map.leaders().iter().map(|&c| model.moving_joints()[c]);
            let values = joints.zip(reference.iter().copied());
            builder.add(weighted(Posture::of_joints(values), weights));
        }
        StatedResidual::Centring => {
            builder.add(weighted(LimitCentring::new(model), weights));
        }
    }
}

pub(super) fn problem(statement: &Statement, loaded: &Loaded) -> Problem {
    let mut builder = Problem::builder(&loaded.model);
    builder.parameters(loaded.map.clone());
    for task in &statement.tasks {
        add(&mut builder, task, loaded);
    }
    // The references minimise the weighted sum.
    builder.preferences(Preferences::Traded);
    builder.tolerance(Quantity::Metres, TOLERANCE);
    builder.tolerance(Quantity::Radians, TOLERANCE);
    builder.build().unwrap()
}

pub(super) fn reference() -> (BTreeMap<String, Loaded>, Vec<Statement>) {
    let Reference { models, problems } =
        serde_json::from_str(include_str!("../../reference/minima.json")).unwrap();
    let models = models.iter().map(|(name, m)| (name.clone(), load(m)));
    (models.collect(), problems)
}
