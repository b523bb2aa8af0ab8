//! Promise: a body that keeps clear touches nothing where it is said to be reached, by the exact distances of shapes, and what is
//! dragged touches nothing from frame to frame, but slides along what is in its way.

use kinopt::collision::{Checker, Clearance, CollisionModel, World};
use kinopt::ik::{Drag, bent_stance};
use kinopt::kinematics::ForwardKinematics;
use kinopt::problem::{Derivatives, Evaluation, TaskId};
use kinopt::robot::{BaseJoint, Robot};
use kinopt::solver::LeastSquares;
use kinopt::spatial::{Placement, Vector3};
use kinopt::task::{Point, Pose, Posture, Task};
use kinopt::{Problem, Solver, Workspace};
use support::random::Random;
use support::sample::cases;

/// A small humanoid on its feet.
struct Nao {
    robot: Robot,
    stance: Vec<f64>,
    placed: Vec<Placement<f64>>,
    checker: Checker,
}

impl Nao {
    fn standing() -> Self {
        let robot = Robot::read("models/aldebaran_nao.urdf").unwrap();
        let robot = robot.with_base_joint(BaseJoint::FREE).unwrap();
        let model = robot.model();
        let feet = ["left_sole", "right_sole"].map(|foot| model.frame(foot).unwrap());
        let up = Vector3::UNITS[2];
        let stance = bent_stance(model, robot.map(), &feet, &model.neutral(), up).unwrap();
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

    /// Feet held, the left hand on a level, upright.
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
            tasks.add(Task::new(Pose::new(frame, self.at(foot))).times(10.0));
        }
        tasks.add(Posture::new(model, &self.stance).upright(model));
        if let Some(checker) = checker {
            tasks.keep_clear(checker);
        }
        (tasks.build().unwrap(), hand)
    }
}

#[test]
fn what_is_dragged_onto_a_table_slides_along_it() {
    let nao = Nao::standing();
    let hand = nao.at("left_hand").translation;
    let mut world = World::new();
    let place = hand + Vector3::new(0.1, 0.0, -0.07);
    world.add_box("table", [0.3, 0.5, 0.02], place).unwrap();
    for margin in [0.0, 0.005] {
        let checker = nao.checker.clone().with_world(&world).unwrap();
        let checker = checker.with_margin(margin).unwrap();
        let (problem, task) = nao.problem(0, Some(&checker));
        let mut drag = Drag::new(problem, &nao.stance).unwrap();
        let mut workspace = checker.workspace();
        let mut kinematics = ForwardKinematics::new(nao.robot.model());
        let left = nao.robot.model().frame("left_hand").unwrap();
        for step in 1..=60 {
            // Twelve centimetres down, to below the table, and then along it.
            let down = f64::from(step.min(30)) * 0.004;
            let along = f64::from((step - 30).max(0)) * 0.002;
            let target = hand + Vector3::new(along, 0.0, -down);
            drag.target_mut(task).unwrap().set_target(target);
            let before = drag.q().to_vec();
            let solution = drag.advance();
            if step > 30 {
                let pairs = solution.collisions();
                assert!(!solution.reached && pairs[0].second == "table", "{pairs:?}");
                assert!(
                    solution.explain().contains("`table`"),
                    "{}",
                    solution.explain()
                );
            }
            let way = checker.way(&mut workspace, &before, drag.q()).unwrap();
            assert_eq!(way.blocked_by, None, "frame {step}");
            let at = kinematics.place(drag.q()).unwrap()[left.index()].translation;
            let beside = at - target;
            assert!(
                beside.x.abs() < 1e-3 && beside.y.abs() < 1e-3,
                "{step} {beside:?}"
            );
            assert!(beside.z > -1e-6);
        }
        // It lies on the table, a millimetre off at most beyond the margin.
        let nearest = checker
            .nearest(&mut workspace, drag.q(), 0.1)
            .unwrap()
            .unwrap();
        assert!(nearest.distance < margin + 1.1e-3, "{nearest:?}");
        // And comes off again.
        drag.target_mut(task).unwrap().set_target(hand);
        for _ in 0..20 {
            drag.advance();
        }
        assert!(drag.solution().reached && drag.solution().collisions().is_empty());
    }
}

#[test]
fn feet_on_a_level_of_their_own_stay_while_a_hand_slides() {
    let nao = Nao::standing();
    let hand = nao.at("left_hand").translation;
    let mut world = World::new();
    let place = hand + Vector3::new(0.1, 0.0, -0.07);
    world.add_box("table", [0.3, 0.5, 0.02], place).unwrap();
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
        let way = checker.way(&mut workspace, &before, drag.q()).unwrap();
        assert_eq!(way.blocked_by, None, "frame {step}");
    }
    let nearest = checker
        .nearest(&mut workspace, drag.q(), 0.1)
        .unwrap()
        .unwrap();
    assert!(nearest.distance < 5e-3, "{nearest:?}");
}

#[test]
fn what_is_reached_touches_nothing_and_nearly_all_is_reached() {
    let nao = Nao::standing();
    let hand = nao.at("left_hand").translation;
    let mut random = Random::new(14);
    let mut workspace = Workspace::new();
    let (mut asked, mut reached, mut led, mut blocked) = (0, 0, 0, 0);
    for _ in 0..cases(60, 12) {
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
            asked += 1;
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
            led +=
                usize::from(solution.reached && !checker.collisions(&anyway.q).unwrap().is_empty());
            // The same with new memory.
            let question = problem.with_targets(&targets).unwrap();
            let again = Solver::default().solve_once(question, &nao.stance).unwrap();
            assert_eq!(
                (again.q, again.attempts, again.iterations),
                (solution.q.clone(), solution.attempts, solution.iterations)
            );
        }
    }
    // Some targets are in the crate.
    assert!(
        led > 0 && blocked > 0 && reached * 2 > asked,
        "{asked} {reached} {led} {blocked}"
    );
}

#[test]
fn from_a_place_that_touches_the_depth_falls_and_then_nothing_touches() {
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
    // A solver gets out at once.
    let mut targets = problem.targets();
    targets.get_mut(task).unwrap().set_target(target);
    let question = problem.with_targets(&targets).unwrap();
    let solution = Solver::default().solve_once(question, &nao.stance).unwrap();
    assert!(solution.reached && worst(&solution.q) == 0.0);
}

#[test]
fn the_derivative_of_a_clearance_is_that_of_its_differences() {
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
    for _ in 0..cases(50, 10) {
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
        // Where two pairs change places as the nearest, differences straddle a kink: few rows do.
        for row in 0..rows {
            let off = (exact.row(row) - differences.row(row)).amax();
            checked += usize::from(exact.row(row).amax() > 0.0 && off < 1e-6);
            assert!(
                off < 1e-4 || exact.row(row).amax() > 0.0,
                "row {row}: {off}"
            );
        }
    }
    assert!(checked > 20, "{checked}");
}

#[test]
fn a_checker_of_another_model_is_refused() {
    let nao = Nao::standing();
    let other = Robot::read("models/universal_ur5e.urdf").unwrap();
    let checker = Checker::new(CollisionModel::of(&other).unwrap());
    let mut tasks = Problem::builder(nao.robot.model());
    let hand = nao.robot.model().frame("left_hand").unwrap();
    tasks.add(Point::new(hand, Vector3::zero()));
    tasks.keep_clear(&checker);
    let error = tasks.build().unwrap_err().to_string();
    assert!(
        error.contains("checker") && error.contains("nao"),
        "{error}"
    );
}
