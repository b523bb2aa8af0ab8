//! Clearance of a robot as a residual.

use std::sync::Arc;

use super::Checker;
use super::parts::{Pair, Scene};
use super::workspace_pool::WorkspacePool;
use crate::collision::Separation;
use kinopt_kinematics::scalar::Scalar;
use kinopt_kinematics::spatial::{Placement, Vector3};
use kinopt_solver::task::{
    Description, Extensions, Inequality, InequalityResidual, Inputs, LocalJacobian, Numeric,
    NumericResidual, Quantity, Residual, RowBlock,
};

/// Residual that keeps all checked pairs at least a distance d₀ apart, metres.
///
/// The residual has one row for each part of the robot. The row is r = ‖(d₀ − d)₊‖ over the pairs with that part first,
/// with their exact distances d. It is 0 if all are farther apart than d₀.
///
/// The number of close pairs varies without bound, so the rows are per part. The cost ½ Σ (d₀ − d)₊² equals that of one
/// row for each pair and has a continuous gradient. The derivatives are exact where the closest points are unique. Let
/// n be the direction from the first closest point to the second. A distance grows by n · (velocity of the second
/// closest point − that of the first).
///
/// ```
/// # std::env::set_current_dir("../..")?;
/// use kinopt::collision::{Checker, Clearance, World};
/// use kinopt::robot::Robot;
/// use kinopt::spatial::Vector3;
/// use kinopt::task::{Point, Task};
/// use kinopt::{Problem, Solver};
///
/// let robot = Robot::read("models/franka_panda.urdf")?;
/// let mut world = World::new();
/// world.add_sphere("ball", 0.1, Vector3::new(0.4, 0.0, 0.5))?;
/// let checker = Checker::of(&robot)?.with_world(&world)?;
/// let mut tasks = Problem::builder(robot.model());
/// tasks.parameters(robot.map().clone());
/// tasks.add(Point::new(robot.model().frame("flange")?, Vector3::new(0.5, 0.0, 0.4)));
/// // A soft task: half a metre from everything, as far as the pose task allows.
/// tasks.add(Task::new(Clearance::new(&checker, 0.5)).preference());
/// let solution = Solver::default().solve_once(&tasks.build()?, &robot.model().neutral())?;
/// assert!(solution.reached);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Clearance(Numeric<Distances>);

#[derive(Clone, Debug)]
struct Distances {
    scene: Arc<Scene>,
    distance: f64,
    workspaces: WorkspacePool,
}

impl Clearance {
    /// A residual over all checked pairs of a checker, with the required `distance` in metres. The checker's margin is
    /// ignored.
    #[must_use]
    pub fn new(checker: &Checker, distance: f64) -> Self {
        Self(Numeric(Distances {
            scene: Arc::clone(&checker.scene),
            distance,
            workspaces: WorkspacePool::default(),
        }))
    }

    /// Required distance of all pairs, metres.
    #[must_use]
    pub fn distance(&self) -> f64 {
        self.0.0.distance
    }

    /// Sets the required distance of all pairs, metres.
    pub fn set_distance(&mut self, distance: f64) {
        self.0.0.distance = distance;
    }

    /// Replaces the checker, for instance after a change of the world.
    ///
    /// The new checker must have the same robot and the same attached obstacles.
    pub fn set_checker(&mut self, checker: &Checker) {
        self.0.0.scene = Arc::clone(&checker.scene);
    }
}

impl Distances {
    /// Visits all pairs nearer than the required distance, each with its row and the missing distance.
    fn visit(
        &self,
        frames: &[Placement<f64>],
        mut visitor: impl FnMut(Pair, usize, f64, &Separation),
    ) {
        let mut workspace = self.workspaces.take();
        self.scene
            .visit(frames, self.distance, &mut workspace, |pair, separation| {
                let (Pair::FixedObstacle(row, _) | Pair::Parts(row, _)) = pair;
                visitor(pair, row, self.distance - separation.distance, separation);
                true
            });
        self.workspaces.put_back(workspace);
    }

    /// Writes the derivatives of the rows, multiplied by `sign`.
    fn write_slopes(&self, frames: &[Placement<f64>], sign: f64, jacobian: &mut LocalJacobian) {
        let mut squares = vec![0.0; jacobian.rows()];
        self.visit(frames, |pair, row, shortfall, separation| {
            squares[row] += shortfall * shortfall;
            let mut add = |frame: usize, slope: Vector3<f64>, point: Vector3<f64>| {
                let lever = point - frames[frame].translation;
                let linear = jacobian.linear_mut(frame);
                linear[row] += slope;
                // n · (ω × l) = ω · (l × n)
                let angular = jacobian.angular_mut(frame);
                angular[row] += lever.cross(slope);
            };
            // The missing distance grows as the first body moves along the normal.
            let slope = separation.normal * shortfall;
            let (Pair::FixedObstacle(first, _) | Pair::Parts(first, _)) = pair;
            add(first, slope, separation.on_first);
            if let Pair::Parts(_, second) = pair {
                add(second, -slope, separation.on_second);
            }
        });
        // d‖l‖ = Σ l dl / ‖l‖; 0 if no pair is too near.
        for square in &mut squares {
            *square = if *square > 0.0 {
                sign / square.sqrt()
            } else {
                0.0
            };
        }
        jacobian.scale_rows(&squares);
    }
}

impl NumericResidual for Distances {
    fn inputs(&self) -> Inputs {
        Inputs::frames(self.scene.frames())
    }

    fn rows(&self) -> Vec<RowBlock> {
        vec![RowBlock::new(Quantity::Metres, self.scene.frames().len())]
    }

    fn evaluate(&self, frames: &[Placement<f64>], _joints: &[f64], residual: &mut [f64]) {
        residual.fill(0.0);
        self.visit(frames, |_, row, shortfall, _| {
            residual[row] += shortfall * shortfall
        });
        for row in residual {
            *row = row.sqrt();
        }
    }

    fn differentiate(
        &self,
        frames: &[Placement<f64>],
        _joints: &[f64],
        jacobian: &mut LocalJacobian,
    ) -> bool {
        self.write_slopes(frames, 1.0, jacobian);
        true
    }

    fn description(&self) -> Description {
        Description::new("clearance").with_validity(self.validate())
    }
}

impl Distances {
    /// Returns the first defect of the parameters.
    fn validate(&self) -> Result<(), String> {
        match self.distance.is_finite() {
            true => Ok(()),
            false => Err(format!(
                "its distance {} is not a finite number",
                self.distance
            )),
        }
    }
}

/// Slack that is reported for a row without a missing distance, metres. A smaller missing distance still counts as
/// feasible.
const ACTIVE_SLACK: f64 = 5e-10;

impl Residual for Clearance {
    const EXTENSIONS: Extensions<Self> = Extensions::NONE.with_inequalities();

    fn inputs(&self) -> Inputs {
        self.0.inputs()
    }

    fn rows(&self) -> Vec<RowBlock> {
        self.0.rows()
    }

    fn evaluate<S: Scalar>(&self, frames: &[Placement<S>], joints: &[S], residual: &mut [S]) {
        self.0.evaluate(frames, joints, residual);
    }

    fn differentiate(
        &self,
        frames: &[Placement<f64>],
        joints: &[f64],
        jacobian: &mut LocalJacobian,
    ) -> bool {
        self.0.differentiate(frames, joints, jacobian)
    }

    fn description(&self) -> Description {
        self.0.description().of_body()
    }
}

impl InequalityResidual for Clearance {
    fn inequalities(&self) -> Vec<Inequality> {
        let rows = 0..self.0.0.scene.frames().len();
        rows.map(|row| Inequality::new(row..row + 1, 1)).collect()
    }

    /// The slack of a collision-free pair is not evaluated. It is reported as a small constant, so that a pair at the
    /// boundary counts as active.
    fn slacks<S: Scalar>(&self, frames: &[Placement<S>], joints: &[S], slacks: &mut [S]) {
        self.0.evaluate(frames, joints, slacks);
        for slack in slacks {
            *slack = S::constant(ACTIVE_SLACK) - *slack;
        }
    }

    fn differentiate_slacks(
        &self,
        frames: &[Placement<f64>],
        _joints: &[f64],
        jacobian: &mut LocalJacobian,
    ) -> bool {
        self.0.0.write_slopes(frames, -1.0, jacobian);
        true
    }
}
