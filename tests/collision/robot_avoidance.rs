//! Promise: a reached solution of a robot with collision avoidance is collision-free by exact distances. A drag is
//! collision-free in and between frames, and slides along obstacles.

use kinopt::collision::{Checker, Clearance, CollisionModel, CollisionObject, Shape, World};
use kinopt::ik::{Drag, Restarts, crouched_configuration};
use kinopt::kinematics::ForwardKinematics;
use kinopt::model::{FrameId, Limits, Loop, Model, ParameterMap};
use kinopt::problem::{Derivatives, Evaluation, TaskId};
use kinopt::robot::Robot;
use kinopt::solver::LeastSquares;
use kinopt::spatial::{Placement, Vector3};
use kinopt::task::{FramePose, Point, Posture, Task};
use kinopt::{Problem, Solver, Workspace};
use support::arms::floating_nao;
use support::bones::humanoid;
use support::fault_tables::ExpectedError;
use support::random::{Random, cases};

/// Small humanoid on its feet.
struct Nao {
    robot: Robot,
    stance: Vec<f64>,
    placed: Vec<Placement<f64>>,
    checker: Checker,
}

impl Nao {
    fn standing() -> Self {
        let robot = floating_nao();
        let model = robot.model();
        let feet = ["left_sole", "right_sole"].map(|foot| model.frame(foot).unwrap());
        let up = Vector3::UNITS[2];
        let stance =
            crouched_configuration(model, robot.map(), &feet, &model.neutral(), up).unwrap();
        let mut kinematics = ForwardKinematics::new(model);
        let placed = kinematics.place(&stance).unwrap().to_vec();
        let bodies = CollisionModel::of(&robot).unwrap();
        let bodies = bodies.with_touching_ignored(&stance).unwrap();
        let bodies = bodies.with_pairs_sampled(300, 1).unwrap();
        Self {
            checker: Checker::new(bodies),
            stance,
            placed,
            robot,
        }
    }

    fn at(&self, frame: &str) -> Placement<f64> {
        self.placed[self.robot.model().frame(frame).unwrap().index()]
    }

    /// Feet pinned, the left hand on a level, the torso upright.
    fn problem(&self, level: usize, checker: Option<&Checker>) -> (Problem, TaskId<Point>) {
        let model = self.robot.model();
        let mut tasks = Problem::builder(model);
        tasks.parameters(self.robot.map().clone());
        let hand = Point::new(
            model.frame("left_hand").unwrap(),
            self.at("left_hand").translation,
        );
        let hand = tasks.add(Task::new(hand).at_level(level));
        for foot in ["left_sole", "right_sole"] {
            let frame = model.frame(foot).unwrap();
            tasks.add(Task::new(FramePose::new(frame, self.at(foot))).scale(10.0));
        }
        tasks.add(Posture::new(model, &self.stance).upright(model));
        if let Some(checker) = checker {
            tasks.keep_clear(checker);
        }
        (tasks.build().unwrap(), hand)
    }
}

/// Optimising soft tasks after success is no additional attempt.
#[test]
fn soft_tasks_take_no_extra_attempt() {
    let mut builder = Model::builder("arm");
    let z = Vector3::UNITS[2];
    let link = Placement::translation(Vector3::UNITS[0]);
    let (mut last, mut objects) = (None, Vec::new());
    for k in 0..4 {
        let limits = Limits::new(-2.0, 2.0);
        let joint = builder.revolute(format!("joint {k}"), last, link, z, limits);
        let end = builder.frame(format!("link {k}"), Some(joint), Placement::identity());
        let ball = Shape::sphere(0.1).unwrap();
        objects.push(CollisionObject::new(
            "ball",
            end,
            Placement::identity(),
            ball,
        ));
        last = Some(joint);
    }
    let hand = builder.frame("hand", last, link);
    let model = builder.build().unwrap();
    let checker = Checker::new(CollisionModel::new(&model, objects).unwrap());
    let mut tasks = Problem::builder(&model);
    tasks.add(Point::new(hand, [2.5, 2.0, 0.0]));
    tasks.add(Posture::new(&model, &[0.3, -0.4, 0.5, 0.6]));
    tasks.keep_clear(&checker);
    let problem = tasks.build().unwrap();
    let once = Solver::default().with_restarts(Restarts::none());
    let solution = once.solve_once(&problem, &[0.2; 4]).unwrap();
    assert!(solution.reached, "{}", solution.explain());
    assert_eq!(solution.attempts, 1);
}

#[test]
fn drag_onto_a_table_slides_along_it() {
    let nao = Nao::standing();
    let hand = nao.at("left_hand").translation;
    let mut world = World::new();
    let position = hand + Vector3::new(0.1, 0.0, -0.07);
    world.add_box("table", [0.3, 0.5, 0.02], position).unwrap();
    for margin in [0.0, 0.005] {
        let checker = nao.checker.clone().with_world(&world).unwrap();
        let checker = checker.with_margin(margin).unwrap();
        let (problem, task) = nao.problem(0, Some(&checker));
        let mut drag = Drag::new(problem, &nao.stance).unwrap();
        let mut workspace = checker.workspace();
        let mut kinematics = ForwardKinematics::new(nao.robot.model());
        let left = nao.robot.model().frame("left_hand").unwrap();
        for step in 1..=60 {
            // 12 cm down, below the table's top, then along it.
            let down = f64::from(step.min(30)) * 0.004;
            let along = f64::from((step - 30).max(0)) * 0.002;
            let target = hand + Vector3::new(along, 0.0, -down);
            drag.target_mut(task).unwrap().set_target(target);
            let before = drag.q().to_vec();
            let solution = drag.advance();
            if step > 30 {
                let pairs = solution.collisions();
                assert!(!solution.reached && pairs[0].second == "table", "{pairs:?}");
                // Without contact the blocking pair is reported as met on the way.
                assert!(pairs[0].on_the_way && pairs[0].distance >= margin - 1e-9);
                let text = solution.explain();
                assert!(text.contains("obstacle `table` block the motion"), "{text}");
                assert!(!text.contains("nearer than"), "{text}");
            }
            let motion = checker
                .check_motion(&mut workspace, &before, drag.q())
                .unwrap();
            assert_eq!(motion.blocked_by, None, "frame {step}");
            let at = kinematics.place(drag.q()).unwrap()[left.index()].translation;
            let offset = at - target;
            assert!(
                offset.x.abs() < 1e-3 && offset.y.abs() < 1e-3,
                "{step} {offset:?}"
            );
            assert!(offset.z > -1e-6);
        }
        // The hand lies on the table, at most 1 mm beyond the margin.
        let nearest = checker
            .nearest(&mut workspace, drag.q(), 0.1)
            .unwrap()
            .unwrap();
        assert!(nearest.distance < margin + 1.1e-3, "{nearest:?}");
        // And leaves it again.
        drag.target_mut(task).unwrap().set_target(hand);
        for _ in 0..20 {
            drag.advance();
        }
        assert!(drag.solution().reached && drag.solution().collisions().is_empty());
    }
}

/// A floor exactly at the soles or slightly below: the robot is in contact with it and moves.
#[test]
fn robot_stands_and_moves_on_a_floor() {
    let nao = Nao::standing();
    let floor_at = |height: f64| {
        let mut world = World::new();
        let floor = Placement::translation(Vector3::new(0.0, 0.0, height));
        world.add_plane("floor", floor).unwrap();
        nao.checker.clone().with_world(&world).unwrap()
    };
    // At the height of the lowest part.
    let lowest = {
        let probe = floor_at(-1.0);
        let pairs = probe.clone().with_margin(2.0).unwrap();
        let pairs = pairs.collisions(&nao.stance).unwrap();
        let pairs = pairs.iter().filter(|pair| pair.second == "floor");
        pairs
            .map(|pair| pair.distance)
            .fold(f64::INFINITY, f64::min)
            - 1.0
    };
    for below in [0.0, 1e-9, 1e-7, 1e-6, 1e-4] {
        let checker = floor_at(lowest - below);
        let (problem, hand) = nao.problem(0, Some(&checker));
        let begin = nao.at("left_hand").translation;
        let mut drag = Drag::new(problem, &nao.stance).unwrap();
        let mut workspace = checker.workspace();
        for frame in 1..=60 {
            let up = Vector3::new(0.0, 0.0, 0.001 * f64::from(frame));
            drag.target_mut(hand).unwrap().set_target(begin + up);
            let solution = drag.advance();
            assert!(
                solution.reached,
                "{below} below, frame {frame}: {}",
                solution.explain()
            );
            let touching = checker
                .collisions_with(&mut workspace, &solution.q)
                .unwrap();
            assert!(
                touching.is_empty(),
                "{below} below, frame {frame}: {touching:?}"
            );
        }
    }
}

#[test]
fn feet_on_the_first_level_stay_while_hand_slides() {
    let nao = Nao::standing();
    let hand = nao.at("left_hand").translation;
    let mut world = World::new();
    let position = hand + Vector3::new(0.1, 0.0, -0.07);
    world.add_box("table", [0.3, 0.5, 0.02], position).unwrap();
    let checker = nao.checker.clone().with_world(&world).unwrap();
    let (problem, task) = nao.problem(1, Some(&checker));
    let mut drag = Drag::new(problem, &nao.stance).unwrap();
    let mut workspace = checker.workspace();
    for step in 1..=40 {
        let down = f64::from(step) * 0.003;
        let target = hand + Vector3::new(0.0, 0.0, -down);
        drag.target_mut(task).unwrap().set_target(target);
        let before = drag.q().to_vec();
        let solution = drag.advance();
        let feet = solution.tasks().filter(|task| task.level == 0);
        let feet: Vec<_> = feet
            .map(|task| task.position_error().unwrap_or(0.0))
            .collect();
        assert!(
            feet.iter().all(|miss| *miss < 1e-5),
            "frame {step}: {feet:?}"
        );
        let motion = checker
            .check_motion(&mut workspace, &before, drag.q())
            .unwrap();
        assert_eq!(motion.blocked_by, None, "frame {step}");
    }
    let nearest = checker
        .nearest(&mut workspace, drag.q(), 0.1)
        .unwrap()
        .unwrap();
    assert!(nearest.distance < 5e-3, "{nearest:?}");
}

#[test]
fn reached_solutions_are_collision_free() {
    let nao = Nao::standing();
    let hand = nao.at("left_hand").translation;
    let mut random = Random::new(14);
    let mut workspace = Workspace::new();
    let (mut count, mut reached, mut guided, mut blocked) = (0, 0, 0, 0);
    for _ in cases(60, 25) {
        let mut world = World::new();
        let at = hand
            + Vector3::new(
                random.within(-0.02, 0.06),
                random.within(-0.08, 0.08),
                random.within(-0.1, 0.1),
            );
        let sides = [(); 3].map(|()| random.within(0.02, 0.06));
        world.add_box("crate", sides, at).unwrap();
        let checker = nao.checker.clone().with_world(&world).unwrap();
        let checker = checker.with_margin(0.002).unwrap();
        let [(plain, _), (problem, task)] = [nao.problem(0, None), nao.problem(0, Some(&checker))];
        for _ in 0..5 {
            let [x, y, z] = [(); 3].map(|()| random.within(-0.05, 0.05));
            let mut targets = problem.targets();
            targets
                .get_mut(task)
                .unwrap()
                .set_target(hand + Vector3::new(x, y, z));
            let question = problem.with_targets(&targets).unwrap();
            let solution = Solver::default()
                .solve(question, &nao.stance, &mut workspace)
                .unwrap()
                .clone();
            let question = plain.with_targets(&targets).unwrap();
            let anyway = Solver::default().solve_once(question, &nao.stance).unwrap();
            if !anyway.reached {
                continue;
            }
            count += 1;
            let touched = checker.collisions(&solution.q).unwrap();
            assert_eq!(solution.collisions(), touched);
            assert_eq!(
                solution.reached,
                touched.is_empty(),
                "{}",
                solution.explain()
            );
            assert!(solution.goals_reached(), "{}", solution.explain());
            reached += usize::from(solution.reached);
            blocked += usize::from(!solution.reached);
            guided +=
                usize::from(solution.reached && !checker.collisions(&anyway.q).unwrap().is_empty());
            // Equal with new memory.
            let question = problem.with_targets(&targets).unwrap();
            let again = Solver::default().solve_once(question, &nao.stance).unwrap();
            assert_eq!(
                (again.q, again.attempts, again.iterations),
                (solution.q.clone(), solution.attempts, solution.iterations)
            );
        }
    }
    // Some targets are inside the crate.
    assert!(
        guided > 0 && blocked > 0 && reached * 2 > count,
        "{count} {reached} {guided} {blocked}"
    );
}

#[test]
fn drag_in_contact_reduces_depth_to_zero() {
    let nao = Nao::standing();
    let hand = nao.at("left_hand").translation;
    let mut world = World::new();
    world
        .add_box("crate", [0.08; 3], hand + Vector3::new(0.0, 0.03, 0.0))
        .unwrap();
    let checker = nao.checker.clone().with_world(&world).unwrap();
    let worst = |q: &[f64]| {
        let pairs = checker.collisions(q).unwrap();
        pairs.first().map_or(0.0, |pair| pair.distance)
    };
    assert!(worst(&nao.stance) < -0.01);
    let (problem, task) = nao.problem(0, Some(&checker));
    let mut drag = Drag::new(problem.clone(), &nao.stance).unwrap();
    let target = hand + Vector3::new(0.0, -0.1, 0.0);
    drag.target_mut(task).unwrap().set_target(target);
    let mut before = worst(drag.q());
    for _ in 0..40 {
        drag.advance();
        let now = worst(drag.q());
        assert!(now >= before, "{before} {now}");
        before = now;
    }
    assert!(
        drag.solution().reached && before == 0.0,
        "{}",
        drag.solution().explain()
    );
    // A solver leaves the contact in one solve.
    let mut targets = problem.targets();
    targets.get_mut(task).unwrap().set_target(target);
    let question = problem.with_targets(&targets).unwrap();
    let solution = Solver::default().solve_once(question, &nao.stance).unwrap();
    assert!(solution.reached && worst(&solution.q) == 0.0);
}

#[test]
fn clearance_derivative_matches_differences() {
    let nao = Nao::standing();
    let hand = nao.at("left_hand").translation;
    let mut world = World::new();
    world
        .add_sphere("ball", 0.03, hand + Vector3::new(0.05, 0.0, 0.0))
        .unwrap();
    world
        .add_cylinder("post", 0.02, 0.3, hand + Vector3::new(0.0, 0.09, 0.0))
        .unwrap();
    world
        .add_box("crate", [0.1; 3], hand + Vector3::new(0.08, -0.05, -0.12))
        .unwrap();
    let checker = nao.checker.clone().with_world(&world).unwrap();
    let mut tasks = Problem::builder(nao.robot.model());
    tasks.parameters(nao.robot.map().clone());
    tasks.add(Clearance::new(&checker, 0.06));
    let problem = tasks.build().unwrap();
    let mut random = Random::new(2);
    let (rows, n) = (problem.rows(), problem.variables());
    let mut checked = 0;
    for _ in cases(50, 10) {
        let mut x = vec![0.0; n];
        problem.parameters().reduce(&nao.stance, &mut x).unwrap();
        for value in &mut x {
            *value += random.within(-0.1, 0.1);
        }
        let jacobian = |route| {
            let problem = problem.clone().with_derivatives(route);
            let mut scratch = problem.scratch();
            let mut jacobian = nalgebra::DMatrix::zeros(rows, n);
            Evaluation::new(&problem, &mut scratch).jacobian(&x, &mut jacobian);
            jacobian
        };
        let [exact, dual, differences] = [
            Derivatives::Analytic,
            Derivatives::Dual,
            Derivatives::CentralDifference,
        ]
        .map(jacobian);
        assert!((&exact - &dual).amax() < 1e-12);
        // Differences straddle a kink if the nearest pair changes: few rows do.
        for row in 0..rows {
            let deviation = (exact.row(row) - differences.row(row)).amax();
            checked += usize::from(exact.row(row).amax() > 0.0 && deviation < 1e-6);
            assert!(
                deviation < 1e-4 || exact.row(row).amax() > 0.0,
                "row {row}: {deviation}"
            );
        }
    }
    assert!(checked > 20, "{checked}");
}

#[test]
fn checker_of_another_model_is_rejected() {
    let nao = Nao::standing();
    let other = Robot::read("../models/universal_ur5e.urdf").unwrap();
    let checker = Checker::new(CollisionModel::of(&other).unwrap());
    let mut tasks = Problem::builder(nao.robot.model());
    let hand = nao.robot.model().frame("left_hand").unwrap();
    tasks.add(Point::new(hand, Vector3::zero()));
    tasks.keep_clear(&checker);
    tasks.build().says("checker | nao");
}

#[test]
fn characters_hand_stops_at_its_belly() {
    let rig = humanoid();
    let (mesh, weights) = (rig.mesh.as_ref().unwrap(), rig.weights.as_ref().unwrap());
    let skeleton = &rig.skeleton;
    let checker = Checker::new(kinopt::motion::skin_capsules(skeleton, mesh, weights).unwrap());
    let rest = skeleton.model().neutral();
    let spine = &skeleton.bones()[skeleton.bone("spine").unwrap().index()];
    let belly = (spine.rest_tail() + spine.rest_tip()) * 0.5;
    let tip = skeleton.tip(skeleton.bone("left_hand").unwrap());
    let drag = |clear: bool| {
        let mut tasks = Problem::builder(skeleton.model());
        let hand = tasks.add(Point::new(tip, belly));
        let arm = ["left_upper_arm", "left_forearm", "left_hand"];
        let joints = arm.map(|bone| skeleton.joints(skeleton.bone(bone).unwrap()));
        let map = ParameterMap::builder(skeleton.model()).with_only(&joints.concat(), &rest);
        tasks.parameters(map.build().unwrap());
        if clear {
            tasks.keep_clear(&checker);
        }
        let mut drag = Drag::new(tasks.build().unwrap(), &rest).unwrap();
        let mut kinematics = ForwardKinematics::new(skeleton.model());
        let from = kinematics.place(&rest).unwrap()[tip.index()].translation;
        let mut workspace = checker.workspace();
        let mut blocked = 0;
        for step in 1..=80 {
            let share = (f64::from(step) / 40.0).min(1.0);
            let target = from + (belly - from) * share;
            drag.target_mut(hand).unwrap().set_target(target);
            let before = drag.q().to_vec();
            drag.advance();
            let motion = checker
                .check_motion(&mut workspace, &before, drag.q())
                .unwrap();
            blocked += usize::from(motion.blocked_by.is_some());
        }
        (drag.solution().clone(), blocked)
    };
    let (through, blocked) = drag(false);
    assert!(through.reached && blocked > 0);
    assert!(!checker.collisions(&through.q).unwrap().is_empty());
    let (stopped, blocked) = drag(true);
    assert_eq!(blocked, 0);
    assert!(!stopped.reached && checker.collisions(&stopped.q).unwrap().is_empty());
    let pairs = stopped.collisions();
    assert!(!pairs.is_empty());
    // As near as the skin allows: within a hand's thickness and half a belly's.
    let miss = stopped.position_error().unwrap();
    assert!(miss > 0.03 && miss < 0.3, "{miss} {pairs:?}");
}

#[test]
fn loop_stays_closed_at_an_obstacle() {
    // Two cranks of 20 cm, a coupler of 50 cm between them, and a pen on it.
    let mut builder = Model::builder("parallelogram");
    let (axis, turn) = (Vector3::UNITS[2], Limits::new(-3.1, 3.1));
    let along = |x: f64| Placement::translation(Vector3::new(x, 0.0, 0.0));
    let left = builder.revolute("left", None, along(0.0), axis, turn);
    let coupler = builder.revolute("coupler", Some(left), along(0.2), axis, turn);
    let right = builder.revolute("right", None, along(0.5), axis, turn);
    let pen = builder.frame("pen", Some(coupler), along(0.25));
    let ends = [
        builder.frame("coupler end", Some(coupler), along(0.5)),
        builder.frame("right end", Some(right), along(0.2)),
    ];
    builder.close(Loop::connect("joint", ends));
    let model = builder.build().unwrap();
    let ball = CollisionObject::new("pen", pen, along(0.0), Shape::sphere(0.02).unwrap());
    let bodies = CollisionModel::new(&model, vec![ball]).unwrap();
    let mut world = World::new();
    let start = [1.2, -1.2, 1.2];
    let mut kinematics = ForwardKinematics::new(&model);
    let from = kinematics.place(&start).unwrap()[pen.index()].translation;
    let goal = kinematics.place(&[0.3, -0.3, 0.3]).unwrap()[pen.index()].translation;
    let middle = kinematics.place(&[0.75, -0.75, 0.75]).unwrap()[pen.index()].translation;
    world.add_sphere("stone", 0.03, middle).unwrap();
    let checker = Checker::new(bodies).with_world(&world).unwrap();
    let mut tasks = Problem::builder(&model);
    let task = tasks.add(Point::new(pen, from));
    tasks.keep_clear(&checker);
    let problem = tasks.build().unwrap();
    // A drag stops before the stone, with its loop closed in every frame.
    let mut drag = Drag::new(problem.clone(), &start).unwrap();
    let mut workspace = checker.workspace();
    for step in 1..=60 {
        let share = (f64::from(step) / 30.0).min(1.0);
        drag.target_mut(task)
            .unwrap()
            .set_target(from + (goal - from) * share);
        let before = drag.q().to_vec();
        let solution = drag.advance();
        let open: Vec<f64> = solution
            .tasks()
            .filter(|task| task.is_loop)
            .filter_map(|task| task.position_error())
            .collect();
        assert!(solution.loops_closed(), "frame {step}: {open:?}");
        let motion = checker
            .check_motion(&mut workspace, &before, drag.q())
            .unwrap();
        assert_eq!(motion.blocked_by, None, "frame {step}");
    }
    assert_eq!(drag.solution().collisions()[0].second, "stone");
    // A solver reaches the other side without contact.
    let mut targets = problem.targets();
    targets.get_mut(task).unwrap().set_target(goal);
    let question = problem.with_targets(&targets).unwrap();
    let solution = Solver::default().solve_once(question, &start).unwrap();
    assert!(
        solution.reached && solution.loops_closed(),
        "{}",
        solution.explain()
    );
    // And reports a target in the stone.
    targets.get_mut(task).unwrap().set_target(middle);
    let question = problem.with_targets(&targets).unwrap();
    let solution = Solver::default().solve_once(question, &start).unwrap();
    assert!(!solution.reached && solution.goals_reached() && solution.loops_closed());
    assert!((solution.collisions()[0].depth() - 0.05).abs() < 1e-5);
}

/// Planar arm of four links next to two spheres, its hand and its checker.
fn arm_beside_balls() -> (Model, FrameId, Checker) {
    let mut builder = Model::builder("arm");
    let z = Vector3::UNITS[2];
    let link = Placement::translation(Vector3::UNITS[0]);
    let (mut last, mut at, mut objects) = (None, Placement::identity(), Vec::new());
    for k in 0..4 {
        let limits = Limits::new(-2.0, 2.0);
        let joint = builder.revolute(format!("joint {k}"), last, at, z, limits);
        let end = builder.frame(format!("link {k}"), Some(joint), link);
        let ball = Shape::sphere(0.2).unwrap();
        let origin = Placement::identity();
        objects.push(CollisionObject::new("ball", end, origin, ball));
        (last, at) = (Some(joint), link);
    }
    let hand = builder.frame("hand", last, link);
    let model = builder.build().unwrap();
    let mut world = World::new();
    for (name, x) in [("near", 1.0), ("far", 2.4)] {
        world
            .add_sphere(name, 0.3, Vector3::new(x, 1.0, 0.0))
            .unwrap();
    }
    let checker = Checker::new(CollisionModel::new(&model, objects).unwrap());
    let checker = checker.with_world(&world).unwrap();
    (model, hand, checker)
}

/// A reused workspace keeps no contacts and no escape of the previous problem.
#[test]
fn earlier_contacts_leave_no_state() {
    let (model, hand, checker) = arm_beside_balls();
    let mut random = Random::new(7);
    let solver = Solver::default().with_restarts(Restarts::default().with_attempts(6));
    let mut tasks = Problem::builder(&model);
    let point = tasks.add(Point::new(hand, [0.0; 3]));
    tasks.keep_clear(&checker);
    let problem = tasks.build().unwrap();
    let target_lists = (0..10).map(|k| {
        let mut targets = problem.targets();
        // The last is out of reach.
        let reach = if k == 9 { 6.0 } else { 2.6 };
        let (sin, cos) = random.within(-0.5, 2.0).sin_cos();
        let target = targets.get_mut(point).unwrap();
        target.set_target([reach * cos, reach * sin, 0.0]);
        targets
    });
    let target_lists: Vec<_> = target_lists.collect();
    let queries = || {
        target_lists
            .iter()
            .map(|targets| problem.with_targets(targets).unwrap())
    };
    let start = [0.6, 0.2, 0.1, 0.1];
    let fresh = queries().map(|question| solver.solve_once(question, &start).unwrap());
    let fresh: Vec<_> = fresh.collect();
    assert!(fresh.iter().filter(|reported| reported.reached).count() > 4);
    assert!(
        fresh
            .iter()
            .any(|reported| !reported.collisions().is_empty())
    );
    for question in queries() {
        for (other, expected) in queries().zip(&fresh) {
            let mut workspace = Workspace::new();
            solver.solve(question, &start, &mut workspace).unwrap();
            let reported = solver.solve(other, &start, &mut workspace).unwrap();
            assert_eq!(format!("{reported:?}"), format!("{expected:?}"));
        }
    }
}

/// If the motion to a search result is not free, the robot does not jump and no jump is reported.
#[test]
fn jump_is_reported_only_if_made() {
    let (model, hand, checker) = arm_beside_balls();
    let mut random = Random::new(8);
    for _ in 0..40 {
        let mut tasks = Problem::builder(&model);
        let (sin, cos) = random.within(-3.0, 3.0).sin_cos();
        let reach = random.within(1.0, 3.9);
        tasks.add(Point::new(hand, [reach * cos, reach * sin, 0.0]));
        tasks.keep_clear(&checker);
        let start = [(); 4].map(|()| random.within(-2.0, 2.0));
        let drag = Drag::new(tasks.build().unwrap(), &start).unwrap();
        let mut drag = drag.with_search(Restarts::default()).unwrap();
        for _ in 0..60 {
            let before = drag.q().to_vec();
            drag.advance();
            let moved = drag.q().iter().zip(&before).map(|(a, b)| (a - b).abs());
            let moved = moved.fold(0.0, f64::max);
            let reported = drag.jump().map_or(0.0, |jump| jump.distance);
            match reported > 0.0 {
                true => assert!((moved - reported).abs() < 1e-12, "{moved} {reported}"),
                false => assert!(moved <= 0.15 + 1e-12, "{moved}"),
            }
        }
    }
}

/// A clearance with a changed distance or checker equals a new one.
#[test]
fn changed_clearance_equals_a_new_one() {
    let robot = Robot::read("../models/franka_panda.urdf").unwrap();
    let bodies = CollisionModel::of(&robot).unwrap();
    let world = |height: f64| {
        let mut world = World::new();
        let at = Vector3::new(0.4, 0.0, height);
        world.add_box("box", [0.3; 3], at).unwrap();
        world
    };
    let checker = |height: f64| {
        Checker::new(bodies.clone())
            .with_world(&world(height))
            .unwrap()
    };
    let [near, other_checker] = [checker(0.5), checker(0.9)];
    let q = [0.0, 0.4, 0.0, -1.6, 0.0, 2.0, 0.7, 0.01, 0.01];
    let residual = |clearance: Clearance| {
        let mut tasks = Problem::builder(robot.model());
        tasks.parameters(robot.map().clone());
        tasks.add(clearance);
        let problem = tasks.build().unwrap();
        let mut x = vec![0.0; problem.variables()];
        problem.parameters().reduce(&q, &mut x).unwrap();
        let mut residual = vec![0.0; problem.rows()];
        let mut scratch = problem.scratch();
        Evaluation::new(&problem, &mut scratch).residual(&x, &mut residual);
        residual
    };
    let mut set = Clearance::new(&near, 0.05);
    set.set_distance(0.3);
    assert_eq!(set.distance(), 0.3);
    let [small, large] = [0.05, 0.3].map(|distance| residual(Clearance::new(&near, distance)));
    assert_eq!(residual(set.clone()), large);
    assert_ne!(small, large);
    set.set_checker(&other_checker);
    let expected = residual(Clearance::new(&other_checker, 0.3));
    assert_eq!(residual(set), expected);
    assert_ne!(expected, large);
}
