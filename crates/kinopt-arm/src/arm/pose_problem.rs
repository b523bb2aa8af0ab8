//! Problem of the general solver for one target within bounds.

use super::options::Options;
use super::serial_chain::Serial;
use kinopt_kinematics::spatial::Placement;
use kinopt_solver::problem::{Problem, ProblemError, ProblemInstance, Targets, TaskId};
use kinopt_solver::task::{FramePose, Quantity, RowBlock, Task};

/// Problem of a chain's tool pose, with the target and the bounds of the current query.
#[derive(Clone, Debug)]
pub(super) struct PoseProblem {
    pub(super) problem: Problem,
    targets: Targets,
    task: TaskId<FramePose>,
    /// Measure of the orientation rows.
    orientation_rows: RowBlock,
    /// Lower bounds of the query.
    pub(super) lower: Vec<f64>,
    /// Upper bounds of the query.
    pub(super) upper: Vec<f64>,
}

impl PoseProblem {
    /// Problem within all limits, whose target is not set yet.
    pub(super) fn new(serial: &Serial, options: &Options) -> Result<Self, ProblemError> {
        let mut builder = Problem::builder(&serial.model);
        builder.parameters(serial.map.clone());
        let pose = FramePose::new(serial.tool, Placement::identity()).with_goal(options.goal);
        let orientation = if options.goal.has_orientation() {
            options.orientation_tolerance
        } else {
            f64::INFINITY
        };
        let [_, orientation_rows] = pose.row_blocks();
        let task = builder.add(
            Task::new(pose)
                .weight(Quantity::Metres, 1.0)
                .weight(Quantity::Radians, options.metres_per_radian)
                .tolerance(Quantity::Metres, options.position_tolerance)
                .tolerance(Quantity::Radians, orientation),
        );
        let problem = builder.build()?;
        Ok(Self {
            targets: problem.targets(),
            task,
            orientation_rows,
            lower: problem.lower().to_vec(),
            upper: problem.upper().to_vec(),
            problem,
        })
    }

    /// Sets the target.
    pub(super) fn set_target(&mut self, target: &Placement<f64>) {
        let pose = self.targets.get_mut(self.task);
        debug_assert!(pose.is_ok(), "the task is the problem's own");
        if let Ok(pose) = pose {
            pose.set_target(*target);
        }
    }

    /// Target of the query.
    pub(super) fn target(&self) -> Placement<f64> {
        let pose = self.targets.get(self.task);
        pose.map_or_else(|_| Placement::identity(), FramePose::target)
    }

    /// Clamps a value of joint i to the bounds.
    pub(super) fn clamp(&self, i: usize, value: f64) -> f64 {
        value.max(self.lower[i]).min(self.upper[i])
    }

    /// Angle of orientation rows whose norm, divided by the weight, is `chord`.
    pub(super) fn angle(&self, chord: f64) -> f64 {
        self.orientation_rows.error_of(chord)
    }

    /// Problem instance for the general solver.
    pub(super) fn instance(&self) -> ProblemInstance<'_> {
        let instance = ProblemInstance::from(&self.problem).with_targets(&self.targets);
        instance.within(&self.lower, &self.upper, &[])
    }
}
