//! Tasks by kind.

use kinopt::kinematics::ForwardKinematics;
use kinopt::model::Masses;
use kinopt::robot::Robot;
use kinopt::{Problem, Solver};
use kinopt_bindings::json::JsonError;
use kinopt_bindings::task::{
    AddBounded, AddTask, Aimed, BoxedTask, KINDS, TaskModel, TaskOptions, residual,
};
use kinopt_bindings::{Arguments, OrRaise};
use serde_json::{Map, Value, json};
use support::arms;

const IDENTITY: [[f64; 4]; 4] = [
    [1.0, 0.0, 0.0, 0.0],
    [0.0, 1.0, 0.0, 0.0],
    [0.0, 0.0, 1.0, 0.0],
    [0.0, 0.0, 0.0, 1.0],
];

/// A valid task of each kind for a Panda, with every option.
fn tasks(robot: &Robot, tip: &str) -> Vec<(&'static str, Value)> {
    let q = robot.neutral();
    let moving = robot.model().moving_joints()[0];
    let joint = &robot.model().joints()[moving.index()].name;
    let base = &robot.model().frames()[0].name;
    vec![
        (
            "point",
            json!({"frame": tip, "target": [0.4, 0.0, 0.5], "at": [0.0, 0.0, 0.1], "base": base}),
        ),
        (
            "pose",
            json!({"frame": tip, "target": IDENTITY, "tool": IDENTITY, "goal": "position", "base": base}),
        ),
        (
            "orientation",
            json!({"frame": tip, "target": IDENTITY, "base": base}),
        ),
        (
            "look at",
            json!({"frame": tip, "axis": [0.0, 0.0, 1.0], "target": [1.0, 0.0, 0.0]}),
        ),
        (
            "gaze",
            json!({"frame": tip, "axis": [0.0, 0.0, 1.0], "half_angle": 0.2, "target": [1.0, 0.0, 0.0]}),
        ),
        ("distance", json!({"a": base, "b": tip, "distance": 0.6})),
        (
            "plane",
            json!({"frame": tip, "point": [0.0, 0.0, 0.4], "normal": [0.0, 0.0, 1.0]}),
        ),
        (
            "ray",
            json!({"frame": tip, "eye": [0.0, 0.0, 0.4], "through": [1.0, 0.0, 0.4]}),
        ),
        (
            "pixel",
            json!({"frame": tip, "camera": [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 2.0]], "target": [0.1, 0.1]}),
        ),
        (
            "posture",
            json!({"reference": q, "joint_weights": "by range"}),
        ),
        (
            "smoothness",
            json!({"previous": q, "time_step": 0.01, "joint_weights": {joint.as_str(): 2.0}}),
        ),
        ("limit centring", json!({})),
        (
            "center of mass",
            json!({"target": [0.1, 0.0], "free": "x", "base": base, "masses": {tip: [2.0, [0.0, 0.0, 0.1]]}}),
        ),
        (
            "support polygon",
            json!({"points": [[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [0.0, 1.0, 0.0]], "on": {}, "margin": 0.01, "up": [0.0, 0.0, 1.0], "masses": {tip: 1.0}}),
        ),
        (
            "frame velocity",
            json!({"frame": tip, "previous": IDENTITY, "time_step": 0.1, "linear": [0.1, 0.0, 0.0], "angular": [0.0, 0.0, 0.0]}),
        ),
        (
            "joint coupling",
            json!({"coefficients": {joint.as_str(): 1.0}, "offset": 0.1}),
        ),
        (
            "manipulability",
            json!({"frame": tip, "least": 0.01, "base": base, "of": "position"}),
        ),
        ("bounded", json!({"task": {}, "lower": -0.1, "upper": 0.1})),
    ]
}

fn masses() -> Result<Masses, JsonError> {
    Err(JsonError {
        kind: kinopt_bindings::ErrorKind::InvalidValue,
        message: "no masses".to_owned(),
    })
}

/// The problem of one task, with the task; `interval` bounds it.
fn problem(
    robot: &Robot,
    kind: &str,
    arguments: &Map<String, Value>,
    interval: Option<[f64; 2]>,
) -> Result<(Problem, BoxedTask<Value>), JsonError> {
    let mut builder = Problem::builder(robot.model());
    let on = TaskModel {
        model: robot.model(),
        masses: &masses,
    };
    let options = TaskOptions::of(arguments)?;
    let add = AddTask {
        builder: &mut builder,
        options,
    };
    let task = match interval {
        None => residual(arguments, &on, kind, add)?,
        Some([lower, upper]) => residual(arguments, &on, kind, AddBounded { lower, upper, add })?,
    };
    let problem = builder.build().or_raise::<Value>()?;
    Ok((problem, task))
}

fn object(value: &Value) -> Map<String, Value> {
    value.as_object().unwrap().clone()
}

#[test]
fn kinds_of_tasks_have_a_valid_task_each() {
    let (robot, _, tip) = arms::panda();
    let tasks = tasks(&robot, tip);
    assert_eq!(tasks.len(), KINDS.len());
    for ((kind, arguments), (known, options)) in tasks.iter().zip(KINDS) {
        assert_eq!(*kind, known);
        let arguments = object(arguments);
        for name in arguments.keys() {
            assert!(options.contains(&name.as_str()), "{kind}: {name}");
        }
        if *kind == "bounded" {
            continue;
        }
        for interval in [None, Some([-0.1, 0.1])] {
            let built = problem(&robot, kind, &arguments, interval);
            assert!(built.is_ok(), "{kind}: {:?}", built.err());
        }
    }
}

#[test]
fn task_without_a_required_option_is_an_error() {
    let (robot, _, tip) = arms::panda();
    // Each of these kinds needs its first option.
    for (kind, arguments) in tasks(&robot, tip) {
        let optional = ["limit centring", "support polygon", "bounded"];
        if optional.contains(&kind) {
            continue;
        }
        let mut arguments = object(&arguments);
        let (_, options) = KINDS[KINDS
            .iter()
            .position(|(known, _)| *known == kind)
            .unwrap_or(0)];
        arguments.remove(options[0]);
        let error = problem(&robot, kind, &arguments, None).err();
        assert!(
            error.is_some_and(|error| error.message.contains("is missing")),
            "{kind}"
        );
    }
}

#[test]
fn target_moves_the_solution() {
    let (robot, _, tip) = arms::panda();
    let arguments = object(
        &json!({"frame": tip, "target": [0.4, 0.0, 0.5], "name": "hand", "weight": 2.0, "tolerance": {"metres": 1e-4}}),
    );
    let (problem, task) = problem(&robot, "point", &arguments, None).unwrap();
    assert_eq!(problem.task_name(0), Some("hand"));
    let mut targets = problem.targets();
    let wrong = task.read(&json!([0.3]), "hand").err();
    assert!(wrong.is_some_and(|error| error.message.starts_with("hand")));
    let aim = task.read(&json!([0.3, 0.2, 0.5]), "hand").unwrap();
    assert!(aim(&mut Aimed::Targets(&mut targets)).is_ok());
    let mut workspace = kinopt::Workspace::new();
    let instance = problem.with_targets(&targets).unwrap();
    let solution = Solver::default().solve(instance, &robot.neutral(), &mut workspace);
    let solution = solution.unwrap();
    assert!(solution.reached);
    let mut kinematics = ForwardKinematics::new(robot.model());
    let placements = kinematics.place(&solution.q).unwrap();
    let frame = robot.model().frame(tip).unwrap();
    let at = placements[frame.index()].translation;
    assert!((at.x - 0.3).abs() < 2e-4 && (at.y - 0.2).abs() < 2e-4 && (at.z - 0.5).abs() < 2e-4);
}

#[test]
fn limit_centring_has_no_target() {
    let (robot, ..) = arms::panda();
    let (_, task) = problem(&robot, "limit centring", &Map::new(), None).unwrap();
    let error = task.read(&json!(0.0), "the task").err();
    assert!(error.is_some_and(|error| error.message.contains("no target")));
}

#[test]
fn null_argument_is_missing() {
    let arguments = object(&json!({"at": null}));
    assert!(Arguments::get(&arguments, "at").is_ok_and(|value| value.is_none()));
}
