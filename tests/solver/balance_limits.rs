//! Promise: a robot whose hand target on the last of three levels is unreachable leans until balance limits it. At the
//! result, reactions of feet, polygon edges and joint limits cancel the gradient of the hand task. Each reaction acts
//! in its allowed direction only.

use kinopt::Solver;
use kinopt::ik::{Restarts, crouched_configuration};
use kinopt::kinematics::{ForwardKinematics, centre_of_mass};
use kinopt::model::{FrameId, Masses, PointMass};
use kinopt::problem::{Problem, ProblemBuilder};
use kinopt::robot::Robot;
use kinopt::spatial::{Placement, Vector3};
use kinopt::task::{CentreOfMass, FramePose, Point, SupportPolygon, Task};
use nalgebra::{DMatrix, DVector};
use support::arms::floating_nao;

use crate::soft_task_fixtures::linearised;

const SOLE: [[f64; 3]; 4] = [
    [0.07, 0.03, 0.0],
    [0.07, -0.03, 0.0],
    [-0.03, -0.03, 0.0],
    [-0.03, 0.03, 0.0],
];

/// NAO in a crouched configuration on its soles, with assumed masses.
struct Standing {
    robot: Robot,
    masses: Masses,
    start: Vec<f64>,
    feet: [(FrameId, Placement<f64>); 2],
    hand: (FrameId, Placement<f64>),
}

impl Standing {
    fn new() -> Self {
        let robot = floating_nao();
        let model = robot.model();
        let frame = |name: &str| model.frame(name).unwrap();
        let weighs = [
            ("torso", 2.0),
            ("left_thigh", 0.5),
            ("right_thigh", 0.5),
            ("left_hand", 0.5),
            ("right_hand", 0.5),
        ];
        let parts = weighs.map(|(name, mass)| PointMass {
            frame: frame(name),
            at: Vector3::zero(),
            mass,
        });
        let soles = [frame("left_sole"), frame("right_sole")];
        let up = [0.0, 0.0, 1.0];
        let start =
            crouched_configuration(model, robot.map(), &soles, &model.neutral(), up).unwrap();
        let hand = frame("left_hand");
        let frames = [soles[0], soles[1], hand];
        let mut kinematics = ForwardKinematics::of_frames(model, &frames).unwrap();
        let placed = kinematics.place(&start).unwrap().to_vec();
        Self {
            masses: Masses::new(model, parts).unwrap(),
            start,
            feet: [(soles[0], placed[0]), (soles[1], placed[1])],
            hand: (hand, placed[2]),
            robot,
        }
    }

    fn problem(&self, add: impl Fn(&mut ProblemBuilder<'_>)) -> Problem {
        let mut builder = Problem::builder(self.robot.model());
        builder.parameters(self.robot.map().clone());
        add(&mut builder);
        builder.build().unwrap()
    }

    fn hold_feet(&self, builder: &mut ProblemBuilder<'_>) {
        for (foot, foot_pose) in self.feet {
            builder.add(FramePose::new(foot, foot_pose));
        }
    }

    /// Corners of the soles in the ground plane.
    fn corners(&self) -> Vec<[f64; 2]> {
        let soles = self.feet.iter().flat_map(|(_, foot_pose)| {
            SOLE.map(|corner| {
                let Vector3 { x, y, .. } = foot_pose.apply(corner.into());
                [x, y]
            })
        });
        soles.collect()
    }

    /// Fraction of the hand task's gradient that the best reactions of feet, edges and limits leave. Also the distance
    /// of the centre of mass outside the polygon, in metres, and the number of active edges.
    fn remaining_gradient(&self, q: &[f64], target: [f64; 3], margin: f64) -> (f64, f64, usize) {
        let hand = self.problem(|builder| {
            builder.add(Point::new(self.hand.0, target));
        });
        let mut x = vec![0.0; hand.variables()];
        hand.parameters().reduce(q, &mut x).unwrap();
        let (residual, jacobian) = linearised(&hand, &x);
        let pull = jacobian.transpose() * residual;
        let (_, feet) = linearised(&self.problem(|builder| self.hold_feet(builder)), &x);
        let feet = feet.transpose();
        let (_, centre_rows) = linearised(
            &self.problem(|builder| {
                builder.add(CentreOfMass::new(&self.masses, [0.0; 3]));
            }),
            &x,
        );
        let centre = centre_of_mass(self.robot.model(), &self.masses, q).unwrap();
        let (mut pushes, mut beyond, mut edges) = (Vec::new(), 0.0_f64, 0);
        let corners = self.corners();
        let side = |a: [f64; 2], b: [f64; 2], c: [f64; 2]| {
            (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
        };
        // Two corners span an edge if all others are on its left.
        let pairs = (corners.iter()).flat_map(|&a| corners.iter().map(move |&b| (a, b)));
        for (a, b) in pairs {
            let length = f64::hypot(b[0] - a[0], b[1] - a[1]);
            if length < 1e-3 || corners.iter().any(|&c| side(a, b, c) < -1e-9) {
                continue;
            }
            let depth = side(a, b, [centre.x, centre.y]) / length - margin;
            beyond = beyond.max(-depth);
            if depth < 1e-6 {
                edges += 1;
                let normal = [-(b[1] - a[1]) / length, (b[0] - a[0]) / length];
                let inward = centre_rows.row(0) * normal[0] + centre_rows.row(1) * normal[1];
                pushes.push(-inward.transpose());
            }
        }
        for j in 0..x.len() {
            let outward = match (x[j] <= hand.lower()[j], x[j] >= hand.upper()[j]) {
                (true, _) => -1.0,
                (_, true) => 1.0,
                _ => continue,
            };
            let mut push = DVector::zeros(x.len());
            push[j] = outward;
            pushes.push(push);
        }
        let share = nearest_push(&feet, &pushes, &pull) / pull.norm();
        (share, beyond, edges)
    }
}

/// min ‖g + A y + Σ z_k b_k‖ for z ≥ 0 and free y: Lawson & Hanson (1974, algorithm NNLS).
fn nearest_push(free: &DMatrix<f64>, pushes: &[DVector<f64>], g: &DVector<f64>) -> f64 {
    let mut passive: Vec<usize> = Vec::new();
    for _ in 0..200 {
        let columns = free.column_iter().map(|column| column.into_owned());
        let columns: Vec<_> = columns
            .chain(passive.iter().map(|&k| pushes[k].clone()))
            .collect();
        let a = DMatrix::from_columns(&columns);
        let z = a.clone().svd(true, true).solve(&-g, 1e-11).unwrap();
        let multipliers = passive.iter().zip(z.iter().skip(free.ncols()));
        if let Some((&k, _)) = multipliers.into_iter().find(|(_, z)| **z < -1e-12) {
            passive.retain(|candidate| *candidate != k);
            continue;
        }
        let left = a * z + g;
        let idle = (0..pushes.len()).filter(|k| !passive.contains(k));
        let best = idle
            .map(|k| (k, -pushes[k].dot(&left) / pushes[k].norm()))
            .max_by(|a, b| a.1.total_cmp(&b.1));
        match best.filter(|(_, gain)| *gain > 1e-10 * g.norm()) {
            Some((k, _)) => passive.push(k),
            None => return left.norm(),
        }
    }
    f64::INFINITY
}

#[test]
fn unreachable_hand_leans_to_the_balance_limit() {
    let body = Standing::new();
    let once = Restarts::default().with_attempts(1);
    let solver = Solver::default().with_restarts(once);
    let directions = [
        [1.5, 0.0, 0.2],
        [1.5, 0.3, -0.2],
        [0.0, 1.5, 0.3],
        [-1.0, 0.5, 0.3],
        [0.4, 0.4, -1.5],
    ];
    let mut leaning = 0;
    let corners = body.corners().into_iter().map(|[x, y]| [x, y, 0.0]);
    let still = SupportPolygon::new(&body.masses).with_points(corners);
    let carried = (body.feet.iter()).fold(SupportPolygon::new(&body.masses), |polygon, foot| {
        polygon.with_points_on(foot.0, SOLE)
    });
    for (margin, polygon) in [
        (0.0, &still),
        (0.01, &still),
        (0.0, &carried),
        (0.01, &carried),
    ] {
        for by in directions {
            let from = body.hand.1.translation;
            let target = (from + Vector3::from(by)).to_array();
            let problem = body.problem(|builder| {
                body.hold_feet(builder);
                let polygon = polygon.clone().with_margin(margin);
                builder.add(Task::new(polygon).at_level(1));
                builder.add(Task::new(Point::new(body.hand.0, target)).at_level(2));
            });
            let solution = solver.solve_once(&problem, &body.start).unwrap();
            let reached: Vec<bool> = solution.tasks().map(|task| task.reached).collect();
            assert_eq!(reached, [true, true, true, false], "{}", solution.explain());
            let (left, beyond, edges) = body.remaining_gradient(&solution.q, target, margin);
            assert!(beyond < 1e-6, "{margin} {by:?}: {beyond} m out of balance");
            assert!(
                left < 1e-6,
                "{margin} {by:?}: {left} of the pull is left\n{}",
                solution.explain()
            );
            leaning += usize::from(edges > 0);
        }
    }
    assert!(leaning > 10, "{leaning} of 20 lean");
}
