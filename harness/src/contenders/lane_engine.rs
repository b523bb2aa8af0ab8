//! SIMD solver, through the API of arms.

use kinopt::Solution;
use kinopt::arm::{Arm, ArmError, Base, PoseBounds, Search};
use kinopt::model::FrameId;

use crate::{Adapter, Answer, Budget, ProblemInstance, ProblemSet, Trace};

/// [`Arm`] with the search [`Search::First`]: one frame on one chain. It makes no marks.
#[derive(Debug, Default)]
pub struct LaneEngineAdapter {
    arm: Option<Arm>,
    q_arm: Vec<f64>,
    solution: Solution,
}

fn arm(set: &ProblemSet, frame: FrameId, budget: Budget) -> Result<Arm, ArmError> {
    let goal = if set.turns() {
        PoseBounds::pose()
    } else {
        PoseBounds::position()
    };
    Arm::builder(set, Base::World, frame)
        .with_goal(goal)
        .with_search(Search::First)
        .with_seed(set.seed())
        .with_position_tolerance(set.length_tolerance())
        .with_orientation_tolerance(set.tolerance())
        .with_time_limit(budget.time_limit)
        .build()
}

impl Adapter for LaneEngineAdapter {
    fn name(&self) -> &str {
        "SIMD solver"
    }

    fn family(&self) -> &str {
        "kinopt"
    }

    fn setting(&self) -> String {
        "kinopt::Arm, search `first`, its own attempts and atlas".to_owned()
    }

    fn prepare(&mut self, set: &ProblemSet, budget: Budget) -> Result<(), String> {
        self.arm = None;
        let [frame] = *set.frames() else {
            return Err(format!("supports one frame, not {}", set.frames().len()));
        };
        let arm = arm(set, frame, budget).map_err(|error| error.to_string())?;
        self.arm = Some(arm);
        Ok(())
    }

    fn solve(&mut self, instance: &ProblemInstance<'_>, _trace: &Trace) -> Answer {
        let (q_arm, solution) = (&mut self.q_arm, &mut self.solution);
        let mut q = instance.start.to_vec();
        let solved = match (&self.arm, instance.targets) {
            (Some(arm), [target]) => arm
                .joint_values(instance.start, q_arm)
                .and_then(|()| arm.solve_into(*target, q_arm, solution))
                .and_then(|()| arm.configuration(&solution.q, &mut q))
                .is_ok(),
            _ => false,
        };
        if !solved {
            return Answer::at(instance.start.to_vec());
        }
        Answer {
            q: instance.set.within_limits(&q),
            ..Answer::from(&self.solution)
        }
    }
}
