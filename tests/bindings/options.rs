//! Options by name.

use kinopt::Arm;
use kinopt::motion::retarget::RetargetOptions;
use kinopt_bindings::option::arm::{OBJECTS, apply, options};
use kinopt_bindings::option::path::PathOptions;
use kinopt_bindings::option::robot::RobotOptions;
use kinopt_bindings::option::servo::ServoOptions;
use kinopt_bindings::option::solver::SolverOptions;
use kinopt_bindings::option::{
    self, OptionSpec, Setter, check_name, names, path, retarget, robot, servo, solver,
};
use kinopt_bindings::per_joint::{configuration, configuration_of, per_joint};
use serde_json::{Map, Value, json};
use support::arms;

/// Options of a JSON object.
fn object(value: Value) -> Map<String, Value> {
    value.as_object().unwrap().clone()
}

/// A valid value of each option of an arm with seven joints, except objects of an interface.
fn arm_values() -> Map<String, Value> {
    object(json!({
        "attempts": 3, "atlas": false, "global_search_on_miss": true, "goal": "position", "iterations": 50,
        "joint_limits": {"joint1": [-1.0, 1.0]}, "joint_weights": {"joint2": 2.0}, "limit_avoidance": 1.0, "max_move": 1.0,
        "metres_per_radian": 0.2, "orientation_tolerance": 1e-5, "position_tolerance": 1e-5,
        "posture": [0.0, 0.0, 0.0, -1.0, 0.0, 1.0, 0.0], "search": "first", "seed": 4, "time_limit": 10.0,
        "tool": [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.1], [0.0, 0.0, 0.0, 1.0]],
        "locked": {}, "only": ["joint1", "joint2", "joint3", "joint4", "joint5", "joint6", "joint7"],
        "held": arms::panda().0.neutral()
    }))
}

fn arm(values: &Map<String, Value>) -> Result<Arm, String> {
    let (robot, base, tip) = arms::panda();
    let builder = Arm::builder(&robot, base, tip);
    let builder = apply(builder, values, robot.model()).map_err(|error| error.to_string())?;
    builder.build().map_err(|error| error.to_string())
}

fn assert_documented<B>(table: &[OptionSpec<B>]) {
    for option in table {
        assert!(option.doc.ends_with('.'), "{}", option.name);
        assert!(!option.default.is_empty(), "{}", option.name);
    }
}

#[test]
fn arm_options_have_a_valid_value_each() {
    let values = arm_values();
    let given: Vec<&str> = values.keys().map(String::as_str).collect();
    let mut known = names(&options());
    known.retain(|name| !OBJECTS.contains(name));
    known.sort_unstable();
    assert_eq!(given, known);
    let solution = arm(&values).and_then(|arm| {
        let target = arm.base_from_tool(arm.default_start());
        let target = target.map_err(|error| error.to_string())?;
        arm.solve(target, arm.default_start())
            .map_err(|error| error.to_string())
    });
    assert!(
        solution.as_ref().is_ok_and(|solution| solution.reached),
        "{solution:?}"
    );
}

#[test]
fn arm_option_of_another_type_is_named() {
    for option in options() {
        if matches!(option.set, Setter::Elsewhere) {
            continue;
        }
        let mut values = Map::new();
        // No option is a list of a boolean.
        values.insert(option.name.to_owned(), json!([true]));
        let error = arm(&values).err().unwrap_or_default();
        assert!(error.starts_with(option.name), "{}: {error}", option.name);
    }
}

#[test]
fn arm_search_of_unknown_name_lists_searches() {
    let mut values = Map::new();
    values.insert("search".to_owned(), json!("fastest"));
    let error = arm(&values).err().unwrap_or_default();
    assert!(error.contains("nearest"), "{error}");
    assert!(check_name("option", "serach", &options()).is_err());
}

#[test]
fn option_tables_are_documented() {
    assert_documented(&options());
    assert_documented(&path::options());
    assert_documented(&robot::options());
    assert_documented(&servo::options());
    assert_documented(&solver::options());
}

#[test]
fn solver_options_have_a_valid_value_each() {
    let values = object(json!({
        "max_iterations": 7, "gradient_tolerance": 1e-3, "step_tolerance": 1e-4, "time_limit": 2.0, "attempts": 3,
        "seed": 5, "agreeing": 2, "restart_steps": 90
    }));
    let read = SolverOptions::of(&values).unwrap();
    assert_eq!(read.max_iterations, Some(7));
    assert_eq!(read.gradient_tolerance, Some(1e-3));
    assert_eq!(read.step_tolerance, Some(1e-4));
    assert_eq!(read.time_limit.map(|limit| limit.as_secs()), Some(2));
    assert_eq!(
        [read.attempts, read.seed, read.agreeing, read.restart_steps],
        [3, 5, 2, 90].map(Some)
    );
    // `patience` is read by the interface.
    assert_eq!(values.len() + 1, solver::options().len());
}

/// An arm with one joint.
fn slider() -> Arm {
    let (robot, base, _) = arms::panda();
    Arm::new(&robot, base, "link1").unwrap()
}

#[test]
fn numbers_of_joints_have_three_forms() {
    let names = ["a", "b", "c"].map(str::to_owned);
    let read = |value: Value, default| {
        per_joint(&value, "weights", &names, default).map_err(|error| error.to_string())
    };
    assert_eq!(read(json!(2.0), None), Ok(vec![2.0; 3]));
    assert_eq!(read(json!([1.0, 2.0, 3.0]), None), Ok(vec![1.0, 2.0, 3.0]));
    assert_eq!(read(json!({"b": 5.0}), Some(1.0)), Ok(vec![1.0, 5.0, 1.0]));
    let missing = read(json!({"b": 5.0}), None).unwrap_err();
    assert!(
        missing.contains("weights has no number for joint `a`"),
        "{missing}"
    );
    let unknown = read(json!({"d": 5.0}), Some(1.0)).unwrap_err();
    assert!(
        unknown.contains("no joint named `d`; valid names: a, b, c"),
        "{unknown}"
    );
}

#[test]
fn configurations_by_name_keep_the_start() {
    let names = ["a", "b"].map(str::to_owned);
    let q = configuration(&json!({"b": 5.0}), "start", &names, &[0.1, 0.2]);
    assert_eq!(q, Ok(vec![0.1, 5.0]));
    assert!(configuration(&json!(5.0), "start", &names, &[0.1, 0.2]).is_err());
    let (robot, ..) = arms::panda();
    let (model, neutral) = (robot.model(), robot.neutral());
    let q = configuration_of(&json!({"joint2": 0.5}), "q", model, neutral.clone()).unwrap();
    let moved: Vec<usize> = (0..q.len()).filter(|&k| q[k] != neutral[k]).collect();
    assert_eq!((moved, q[1]), (vec![1], 0.5));
    let error = configuration_of(&json!({"joint22": 0.5}), "q", model, neutral).unwrap_err();
    assert!(error.to_string().contains("joint2"), "{error}");
}

#[test]
fn servo_options_have_a_valid_value_each() {
    let values = object(json!({
        "velocity_limits": [1.0], "acceleration_limits": [2.0], "jerk_limits": [3.0], "velocity": [0.1],
        "acceleration": [0.2], "straight_line": true, "damping": 0.02
    }));
    let read = ServoOptions::of(&values, &slider()).unwrap();
    assert_eq!(read.velocity_limits, Some(vec![1.0]));
    assert_eq!(read.acceleration_limits, Some(vec![2.0]));
    assert_eq!(read.jerk_limits, Some(vec![3.0]));
    assert_eq!(read.velocity, Some(vec![0.1]));
    assert_eq!(read.acceleration, Some(vec![0.2]));
    assert!(read.straight_line);
    assert_eq!(read.damping, Some(0.02));
    assert_eq!(values.len(), servo::options().len());
}

#[test]
fn path_options_have_a_valid_value_each() {
    let values = object(json!({
        "traversal": "cyclic", "start": [1.0], "end": [2.0], "joint_weights": [3.0], "max_step": 0.1, "samples": 9,
        "times": [0.0, 1.0], "keep_times": true
    }));
    let read = PathOptions::of(&values, &slider()).unwrap();
    assert_eq!(read.traversal, kinopt::motion::path::Traversal::Cyclic);
    assert_eq!(
        [read.start, read.end, read.joint_weights, read.times],
        [vec![1.0], vec![2.0], vec![3.0], vec![0.0, 1.0]].map(Some)
    );
    assert_eq!(
        (read.max_step, read.samples, read.keep_times),
        (0.1, 9, true)
    );
    // `tools` and `tool_of_points` are objects of the interface.
    assert_eq!(values.len() + 2, path::options().len());
}

#[test]
fn robot_options_have_a_valid_value_each() {
    let values = object(json!({
        "base_joint": "free", "base_bounds": {"x": [-1.0, 1.0]}, "lenient": true, "mimic_limits": "both",
        "soft_limits": true, "confine": true
    }));
    let read = RobotOptions::of(&values).unwrap();
    assert!(read.lenient && read.mimic_limits && read.soft_limits && read.confine);
    assert_eq!(read.base.joint.as_deref(), Some("free"));
    assert_eq!(read.base.bounds, vec![("x".to_owned(), (-1.0, 1.0))]);
    assert_eq!(values.len(), robot::options().len());
    let (robot, ..) = arms::panda();
    let based = read.base.of::<Value>(robot);
    assert!(based.is_ok_and(|robot| robot.model().free_joints().len() == 1));
}

#[test]
fn retarget_options_replace_their_defaults() {
    assert_documented(&retarget::options());
    let defaults = RetargetOptions::default();
    let apply = |values: Value| {
        let defaults = RetargetOptions::default();
        option::apply(&object(values), &retarget::options(), defaults)
    };
    assert_eq!(apply(json!({})), Ok(defaults));
    let given = json!({"contact_speed": 0.3, "contact_height": 0.2, "acceleration": 1e-3});
    let options = apply(given).unwrap();
    assert_eq!(
        (options.contacts.speed, options.contacts.height),
        (0.3, 0.2)
    );
    assert_eq!(options.acceleration, 1e-3);
    let error = apply(json!({"acceleration": "slow"})).unwrap_err();
    assert!(error.message.contains("acceleration"), "{error}");
}
