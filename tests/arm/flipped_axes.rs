//! Promise: an arm with all axes reversed moves its joints by the opposite values, into limits, out of reach and back,
//! with equal reports.

use kinopt::arm::{Arm, ServoStatus};
use kinopt::robot::Robot;
use kinopt::spatial::{Placement, Vector3};
use kinopt::{Solution, solver::Termination};

/// Value of a numeric attribute in a line of XML, if present.
fn number(line: &str, attribute: &str) -> Option<f64> {
    let (_, rest) = line.split_once(&format!("{attribute}=\""))?;
    rest.split('"').next()?.parse().ok()
}

/// Robot file with all axes and limits reversed.
fn flipped(text: &str) -> String {
    let line = |line: &str| {
        if let (Some(lower), Some(upper)) = (number(line, "lower"), number(line, "upper")) {
            let at = |name: &str, value: f64| format!("{name}=\"{value}\"");
            let line = line.replace(&at("lower", lower), &at("lower", -upper));
            return line.replace(&at("upper", upper), &at("upper", -lower));
        }
        let Some((_, rest)) = line.split_once("<axis xyz=\"") else {
            return line.to_owned();
        };
        let values = rest.split('"').next().unwrap();
        let turned = values.split(' ').map(|word| -word.parse::<f64>().unwrap());
        let turned: Vec<String> = turned.map(|value| value.to_string()).collect();
        line.replace(values, &turned.join(" "))
    };
    text.lines().map(line).collect::<Vec<_>>().join("\n")
}

/// Steps of a line of this length, a rest at its end, and the way back.
fn out_and_back(
    from: &Placement<f64>,
    displacement: Vector3<f64>,
    steps: u32,
) -> Vec<Placement<f64>> {
    let order = (0..steps).chain([steps; 8]).chain((0..steps).rev());
    let at = |k: u32| from.translation + displacement * (f64::from(k) / f64::from(steps));
    order
        .map(|k| Placement::new(from.rotation, at(k)))
        .collect()
}

type Outcome = (Vec<f64>, bool, Termination);

fn outcome(solution: &Solution) -> Outcome {
    (solution.q.clone(), solution.reached, solution.termination)
}

fn follow(arm: &Arm, start: &[f64], targets: &[Placement<f64>]) -> Vec<Outcome> {
    let mut follower = arm.follower(start).unwrap();
    let steps = targets.iter().map(|target| {
        let mut solution = Solution::default();
        follower.advance(*target, &mut solution).unwrap();
        outcome(&solution)
    });
    steps.collect()
}

/// Joint values and status of every cycle of a servo that follows the targets.
fn serve(arm: &Arm, start: &[f64], targets: &[Placement<f64>]) -> Vec<(Vec<f64>, ServoStatus)> {
    let mut servo = arm.servo(start, 4e-3).unwrap();
    let ticks = targets.iter().map(|target| {
        let step = servo.step(*target).unwrap();
        (step.q.to_vec(), step.status)
    });
    ticks.collect()
}

/// Largest sum of corresponding joint values of opposite configurations.
fn apart(one: &[f64], other: &[f64]) -> f64 {
    let sums = one.iter().zip(other).map(|(a, b)| (a + b).abs());
    sums.fold(0.0, f64::max)
}

#[test]
fn reversed_axes_give_opposite_joint_values() {
    let (mut missed, mut at_limits) = (0, 0);
    for (name, start, ways) in [
        (
            "kuka_iiwa14",
            &[0.2, 0.5, -0.3, -1.3, 0.2, 0.7, 0.1][..],
            [[0.0, -0.4, 0.7], [-0.3, -0.2, -0.5]],
        ),
        (
            "universal_ur5e",
            &[0.3, -1.2, 1.4, -1.6, -1.5, 0.2],
            [[0.6, 0.3, 0.2], [-0.5, 0.1, 0.1]],
        ),
    ] {
        let text = std::fs::read_to_string(format!("../models/{name}.urdf")).unwrap();
        let [arm, turned] = [text.clone(), flipped(&text)].map(|text| {
            let robot = Robot::parse(&text, "robot.urdf").unwrap();
            let arm = Arm::builder(&robot, "base", "flange");
            arm.with_atlas(false).build().unwrap()
        });
        let back: Vec<f64> = start.iter().map(|value| -value).collect();
        let from = arm.base_from_tool(start).unwrap();
        for line in ways.map(Vector3::from) {
            let line = out_and_back(&from, line, 24);
            let both = follow(&arm, start, &line).into_iter();
            for (one, other) in both.zip(follow(&turned, &back, &line)) {
                assert!(apart(&one.0, &other.0) < 1e-6, "{name}: {one:?} {other:?}");
                assert_eq!((one.1, one.2), (other.1, other.2), "{name}");
                missed += usize::from(!one.1);
                let limits = arm.limits().zip(&one.0);
                let held = limits.filter(|(limits, q)| **q == limits.lower || **q == limits.upper);
                at_limits += held.count();
            }
            let both = serve(&arm, start, &line).into_iter();
            for (one, other) in both.zip(serve(&turned, &back, &line)) {
                assert!(apart(&one.0, &other.0) < 1e-6, "{name}: {one:?} {other:?}");
                assert_eq!(one.1, other.1, "{name}");
            }
        }
    }
    assert!(missed > 40 && at_limits > 4, "{missed} {at_limits}");
}
