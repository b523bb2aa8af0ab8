//! Promise: tasks of a lower level are met as closely as possible at no cost to higher levels, whatever their weights.

use kinopt::ik::{Drag, Restarts};
use kinopt::model::{Limits, Model, ParameterMap};
use kinopt::problem::{Preferences, Problem};
use kinopt::solver::Stopping;
use kinopt::spatial::{Placement, Vector3};
use kinopt::task::{FramePose, Point, Posture, Quantity, Task};
use kinopt::{Solution, Solver, Workspace};
use support::arms::panda;
use support::bodies::traded_on_a_sledge;
use support::planar_arm;
use support::random::{Random, case_count, cases};
use support::trees::configuration_of;

use crate::soft_task_fixtures::{Add, placement_of, problem, remaining_gradient, within_limits};

/// Arm with a tool target and a conflicting elbow target.
struct Conflict {
    model: Model,
    map: ParameterMap,
    start: Vec<f64>,
    tool: Placement<f64>,
    elbow: [f64; 3],
}

const ELBOW: &str = "link4";

impl Conflict {
    fn new(seed: u64) -> Self {
        let (robot, _, tool) = panda();
        let (model, map) = (robot.model().clone(), robot.map().clone());
        let mut random = Random::new(seed);
        let start = configuration_of(&model, &mut random);
        let target_q = configuration_of(&model, &mut random);
        let other_q = configuration_of(&model, &mut random);
        let pose_of = |frame: &str, q: &[f64]| placement_of(&model, frame, q);
        let position = pose_of(ELBOW, &other_q).translation;
        Self {
            tool: pose_of(tool, &target_q),
            elbow: [position.x, position.y, position.z],
            model,
            map,
            start,
        }
    }

    fn tool(&self) -> FramePose {
        FramePose::new(self.model.frame(panda().2).unwrap(), self.tool)
    }

    fn elbow(&self) -> Point {
        Point::new(self.model.frame(ELBOW).unwrap(), self.elbow)
    }

    fn problem(&self, adds: &[Add<'_>]) -> Problem {
        problem(&self.model, &self.map, adds)
    }
}

fn errors(solution: &Solution, task: usize) -> [f64; 2] {
    let task = solution.tasks().nth(task).unwrap();
    [task.position_error(), task.orientation_error()].map(|error| error.unwrap_or(0.0))
}

/// ½ Σ of a point's squared error.
fn cost(solution: &Solution, task: usize) -> f64 {
    0.5 * errors(solution, task)[0].powi(2)
}

#[test]
fn lower_level_is_stationary_within_the_first() {
    let mut conflicts = 0;
    for seed in 0..case_count(100, 6) as u64 {
        let conflict = Conflict::new(seed);
        let first: Add<'_> = &|builder| {
            builder.add(conflict.tool());
        };
        let second: Add<'_> = &|builder| {
            builder.add(Task::new(conflict.elbow()).at_level(1).scale(100.0));
        };
        let alone = conflict.problem(&[first]);
        let both = conflict.problem(&[first, second]);
        let by_itself = Solver::default()
            .solve_once(&alone, &conflict.start)
            .unwrap();
        let solution = Solver::default()
            .solve_once(&both, &conflict.start)
            .unwrap();
        for (with, without) in errors(&solution, 0).iter().zip(errors(&by_itself, 0)) {
            assert!((with - without).abs() < 1e-9, "{seed}: {with} {without}");
        }
        assert!(within_limits(&both, &solution.q));
        if solution.reached {
            continue;
        }
        conflicts += 1;
        assert!(cost(&solution, 1) > 0.0);
        let left = remaining_gradient(&alone, &conflict.problem(&[second]), &solution.q);
        assert!(
            left < 1e-4,
            "{seed}: {left} of the slope is left\n{}",
            solution.explain()
        );
        let explanation = solution.explain();
        assert!(explanation.contains("Level 1 gives way"), "{explanation}");
    }
    assert!(conflicts > 3, "hardly anything conflicts");
}

#[test]
fn lower_level_does_not_increase_a_miss() {
    let mut gained = 0;
    for seed in 0..case_count(40, 3) as u64 {
        let conflict = Conflict::new(seed);
        let add_far_point: Add<'_> = &|builder| {
            let tool = conflict.model.frame(panda().2).unwrap();
            let target = conflict.tool.translation * 4.0;
            builder.add(Point::new(tool, [target.x, target.y, target.z]));
        };
        let second: Add<'_> = &|builder| {
            builder.add(Task::new(conflict.elbow()).at_level(1));
        };
        let alone = conflict.problem(&[add_far_point]);
        let both = conflict.problem(&[add_far_point, second]);
        let by_itself = Solver::default()
            .solve_once(&alone, &conflict.start)
            .unwrap();
        let solution = Solver::default()
            .solve_once(&both, &conflict.start)
            .unwrap();
        if by_itself.reached {
            continue;
        }
        let (with, without) = (cost(&solution, 0), cost(&by_itself, 0));
        assert!(with <= without * (1.0 + 1e-8), "{seed}: {with} {without}");
        let elbow = |q: &[f64]| {
            let position = placement_of(&conflict.model, ELBOW, q).translation;
            (position - Vector3::from(conflict.elbow)).norm()
        };
        gained += usize::from(elbow(&solution.q) < elbow(&by_itself.q) - 1e-6);
        let explanation = solution.explain();
        assert!(
            explanation.contains("Level 0 has the highest priority"),
            "{explanation}"
        );
    }
    assert!(gained > 0, "nothing is ever gained");
}

#[test]
fn three_levels_do_not_disturb_each_other() {
    for seed in 0..case_count(30, 3) as u64 {
        let conflict = Conflict::new(seed);
        let [hand, wrist] = [panda().2, "link6"].map(|name| conflict.model.frame(name).unwrap());
        let target = conflict.tool.translation;
        let first: Add<'_> = &|builder| {
            builder.add(Point::new(hand, [target.x, target.y, target.z]));
        };
        let second: Add<'_> = &|builder| {
            builder.add(Task::new(conflict.elbow()).at_level(1));
        };
        let third: Add<'_> = &|builder| {
            builder.add(
                Task::new(Point::new(wrist, [0.0, 0.0, 2.0]))
                    .at_level(2)
                    .scale(1e3),
            );
        };
        let two = conflict.problem(&[first, second]);
        let three = conflict.problem(&[first, second, third]);
        let above = Solver::default().solve_once(&two, &conflict.start).unwrap();
        let solution = Solver::default()
            .solve_once(&three, &conflict.start)
            .unwrap();
        assert_eq!(
            above.tasks().next().unwrap().reached,
            solution.tasks().next().unwrap().reached
        );
        // Two local minima may differ, but neither leaves a gradient.
        if !solution.tasks().nth(1).unwrap().reached {
            let left = remaining_gradient(
                &conflict.problem(&[first]),
                &conflict.problem(&[second]),
                &solution.q,
            );
            assert!(left < 1e-4, "{seed}: {left}");
        }
        let reached: Vec<bool> = solution.tasks().map(|task| task.reached).collect();
        if reached == [true, false, false] {
            let explanation = solution.explain();
            assert!(
                explanation.contains("Levels 1, 2 give way"),
                "{explanation}"
            );
        }
        let levels: Vec<usize> = solution.tasks().map(|task| task.level).collect();
        assert_eq!(levels, [0, 1, 2]);
    }
}

/// From the minimum of all three levels together, a limit blocks the motion to the first level's target.
#[test]
fn first_level_is_reached_despite_heavier_levels() {
    let model = planar_arm(&[1.0], Some((-3.05, 3.05)));
    let tip = model.frame("tip").unwrap();
    let at = |angle: f64| Point::new(tip, [angle.cos(), angle.sin(), 0.0]);
    let mut tasks = Problem::builder(&model);
    tasks.add(at(2.97));
    for level in [1, 2] {
        tasks.add(Task::new(at(-2.97)).scale(3.0).at_level(level));
    }
    let problem = tasks.build().unwrap();
    let solution = Solver::default().solve_once(&problem, &[0.0]).unwrap();
    let explanation = solution.explain();
    assert!(solution.tasks().next().unwrap().reached, "{explanation}");
    assert!((solution.q[0] - 2.97).abs() < 1e-5, "{:?}", solution.q);
}

#[test]
fn compatible_levels_are_all_reached() {
    for seed in 0..case_count(40, 4) as u64 {
        let conflict = Conflict::new(seed);
        let mut random = Random::new(seed ^ 0xabc);
        let target_q = configuration_of(&conflict.model, &mut random);
        let placement_at = |frame: &str| placement_of(&conflict.model, frame, &target_q);
        let (hand, elbow) = (placement_at(panda().2), placement_at(ELBOW).translation);
        let problem = conflict.problem(&[&|builder| {
            let hand = hand.translation;
            builder.add(Point::new(
                conflict.model.frame(panda().2).unwrap(),
                [hand.x, hand.y, hand.z],
            ));
            let elbow = Point::new(
                conflict.model.frame(ELBOW).unwrap(),
                [elbow.x, elbow.y, elbow.z],
            );
            builder.add(Task::new(elbow).at_level(1));
            builder.add(Posture::new(&conflict.model, &target_q));
        }]);
        let solution = Solver::default()
            .solve_once(&problem, &conflict.start)
            .unwrap();
        assert!(solution.reached, "{seed}: {}", solution.explain());
    }
}

#[test]
fn drag_keeps_first_level_at_unreachable_second() {
    let conflict = Conflict::new(3);
    let at = |frame: &str| placement_of(&conflict.model, frame, &conflict.start).translation;
    let (hand, elbow) = (at(panda().2), at(ELBOW));
    let mut builder = Problem::builder(&conflict.model);
    builder.parameters(conflict.map.clone());
    let [tool, link] = [panda().2, ELBOW].map(|name| conflict.model.frame(name).unwrap());
    builder.add(Point::new(tool, [hand.x, hand.y, hand.z]));
    let dragged = builder.add(Task::new(Point::new(link, [elbow.x, elbow.y, elbow.z])).at_level(1));
    let mut drag = Drag::new(builder.build().unwrap(), &conflict.start).unwrap();
    let mut missed = 0;
    for frame in 0..60 {
        let aside = 0.02 * f64::from(frame);
        let target = [elbow.x + aside, elbow.y - aside, elbow.z];
        drag.target_mut(dragged).unwrap().set_target(target);
        let solution = drag.advance();
        assert!(
            errors(solution, 0)[0] < 1.001e-6,
            "{frame}: {}",
            solution.explain()
        );
        missed += usize::from(!solution.reached);
    }
    assert!(missed > 20);
}

/// A missed first level at rest never gets worse in favour of the second, neither by a perturbation nor by interrupted
/// frames.
#[test]
fn drag_at_rest_keeps_a_missed_first_level() {
    let mut builder = Model::builder("four links");
    let (z, x) = (
        Vector3::UNITS[2],
        Placement::translation([1.0, 0.0, 0.0].into()),
    );
    let turns = Limits::new(-3.0, 3.0);
    let (mut above, mut at, mut ends) = (None, Placement::identity(), Vec::new());
    for k in 0..4 {
        let joint = builder.revolute(format!("joint {k}"), above, at, z, turns);
        ends.push(builder.frame(format!("end {k}"), Some(joint), x));
        (above, at) = (Some(joint), x);
    }
    let model = builder.build().unwrap();
    let mut random = Random::new(17);
    for case in cases(200, 24) {
        let mut random_point = |least: f64| {
            let (angle, reach) = (random.within(-3.0, 3.0), random.within(least, 2.0 * least));
            [reach * angle.cos(), reach * angle.sin(), 0.0]
        };
        let mut builder = Problem::builder(&model);
        // Two links reach 2 m, four links 4 m.
        builder.add(Point::new(ends[1], random_point(2.1)));
        let second = Task::new(Point::new(ends[3], random_point(4.1))).scale(30.0);
        builder.add(second.at_level(1));
        let start = [(); 4].map(|()| random.within(-2.0, 2.0));
        let steps = Stopping::default().with_max_iterations([40, 3, 2][case % 3]);
        let drag = Drag::new(builder.build().unwrap(), &start).unwrap();
        let mut drag = drag.with_solver(Solver::default(), steps).unwrap();
        let mut last = f64::INFINITY;
        for frame in 0..80 {
            let now = errors(drag.advance(), 0)[0];
            assert!(now < last + 1e-8, "{case}, {frame}: {now} after {last}");
            last = now;
        }
    }
}

#[test]
fn soft_tasks_have_levels_of_their_own() {
    let conflict = Conflict::new(8);
    let other = configuration_of(&conflict.model, &mut Random::new(77));
    let solve = |adds: &[Add<'_>], traded: bool| {
        let mut builder = Problem::builder(&conflict.model);
        builder.parameters(conflict.map.clone());
        for add in adds {
            add(&mut builder);
        }
        if traded {
            builder.preferences(Preferences::Traded);
        }
        let problem = builder.build().unwrap();
        Solver::default()
            .solve_once(&problem, &conflict.start)
            .unwrap()
    };
    let goal: Add<'_> = &|builder| {
        builder.add(conflict.tool());
    };
    let elbow: Add<'_> = &|builder| {
        builder.add(Task::new(conflict.elbow()).preference());
    };
    let posture: Add<'_> = &|builder| {
        builder.add(
            Task::new(Posture::new(&conflict.model, &other))
                .at_level(1)
                .scale(1e3),
        );
    };
    // One redundant degree of freedom: the elbow uses all of it.
    let elbow_alone = solve(&[goal, elbow], false);
    let ranked = solve(&[goal, elbow, posture], false);
    assert!(ranked.reached);
    assert!(cost(&ranked, 1) <= cost(&elbow_alone, 1) * (1.0 + 1e-6));
    let second: Add<'_> = &|builder| {
        builder.add(Task::new(conflict.elbow()).at_level(1));
    };
    let traded = solve(&[goal, second, posture], true);
    let strict = solve(&[goal, second, posture], false);
    assert!(errors(&traded, 0)[0] < 1e-6 && errors(&strict, 0)[0] < 1e-6);
    assert!(cost(&traded, 1) > cost(&strict, 1), "nothing was traded");
    let quantities = traded.tasks().flat_map(|task| task.rows);
    assert!(
        quantities
            .into_iter()
            .any(|rows| rows.quantity == Quantity::JointUnits)
    );
}

/// A level with a weighted soft task ends at the common minimum, not at the edge of the required tasks' tolerance.
#[test]
fn weighted_soft_task_acts_within_tolerance() {
    let (problem, _) = traded_on_a_sledge();
    let solution = Solver::default().solve_once(&problem, &[0.7, 0.4]).unwrap();
    // With x = −y, ½ y² + ½ x² + ½ (y − 2)² is minimal at 2/3.
    for (q, best) in solution.q.iter().zip([-2.0, 2.0]) {
        assert!((q - best / 3.0).abs() < 1e-6, "{:?}", solution.q);
    }
}

/// Levels that an earlier problem relaxed have no influence: a reused workspace gives the result of a new one.
#[test]
fn relaxed_levels_leave_no_state() {
    let mut builder = Model::builder("four links");
    let link = Placement::translation([1.0, 0.0, 0.0].into());
    let turns = Limits::new(-2.0, 2.0);
    let (mut above, mut at, mut ends) = (None, Placement::identity(), Vec::new());
    for k in 0..4 {
        let joint = builder.revolute(format!("joint {k}"), above, at, Vector3::UNITS[2], turns);
        ends.push(builder.frame(format!("end {k}"), Some(joint), link));
        (above, at) = (Some(joint), link);
    }
    let model = builder.build().unwrap();
    let mut tasks = Problem::builder(&model);
    let points = [1, 2, 3].map(|k| {
        let point = Point::new(ends[k], [0.0; 3]);
        tasks.add(Task::new(point).at_level(k - 1))
    });
    let problem = tasks.build().unwrap();
    let mut random = Random::new(41);
    // Bits of `case` select the unreachable tasks.
    let target_lists = (0..8).map(|case| {
        let mut targets = problem.targets();
        let q: [f64; 4] = [(); 4].map(|()| random.within(-1.0, 1.0));
        let (mut angle, mut end) = (q[0], Vector3::new(q[0].cos(), q[0].sin(), 0.0));
        for (k, &point) in points.iter().enumerate() {
            angle += q[k + 1];
            end += Vector3::new(angle.cos(), angle.sin(), 0.0);
            let factor = if case >> k & 1 == 1 { 9.0 } else { 1.0 };
            targets.get_mut(point).unwrap().set_target(end * factor);
        }
        targets
    });
    let target_lists: Vec<_> = target_lists.collect();
    let queries = || {
        target_lists
            .iter()
            .map(|targets| problem.with_targets(targets).unwrap())
    };
    let start = [0.2, 0.3, 0.2, 0.1];
    // Interrupted searches miss levels in the descent from the common minimum.
    let cut = (1..7).map(|iterations| {
        let stopping = Stopping::default().with_max_iterations(iterations);
        let once = Solver::default().with_restarts(Restarts::none());
        once.with_stopping(stopping)
    });
    for solver in cut.chain([Solver::default()]) {
        let fresh = queries().map(|question| solver.solve_once(question, &start).unwrap());
        let fresh: Vec<_> = fresh.collect();
        assert!(fresh.iter().filter(|reported| reported.reached).count() <= 1);
        for question in queries() {
            for (other, expected) in queries().zip(&fresh) {
                let mut workspace = Workspace::new();
                solver.solve(question, &start, &mut workspace).unwrap();
                let reported = solver.solve(other, &start, &mut workspace).unwrap();
                assert_eq!(format!("{reported:?}"), format!("{expected:?}"));
            }
        }
    }
}
