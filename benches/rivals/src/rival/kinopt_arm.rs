//! kinopt, through the API of arms.

use kinopt::arm::{Arm, Search};
use kinopt::robot::Robot;

use super::{Answer, Rival, timed};
use crate::{Failure, Query, Workload};

struct Kinopt {
    name: &'static str,
    arm: Arm,
}

/// One arm for each search; ratios are relative to the first one.
pub fn searches(workload: &Workload) -> Result<Vec<Box<dyn Rival>>, Failure> {
    let robot = Robot::read(&workload.urdf)?;
    let mut rivals: Vec<Box<dyn Rival>> = Vec::new();
    for (name, search) in [
        ("kinopt, first", Search::First),
        ("kinopt, start", Search::Start),
    ] {
        let arm = Arm::builder(&robot, &workload.base, &workload.tip);
        let arm = arm.with_search(search).build()?;
        rivals.push(Box::new(Kinopt { name, arm }));
    }
    Ok(rivals)
}

impl Rival for Kinopt {
    fn name(&self) -> String {
        self.name.into()
    }

    fn answer(&mut self, query: &Query) -> Result<Answer, Failure> {
        let mut failure = None;
        let answer = timed(|| match self.arm.solve(query.target, &query.start) {
            Ok(solution) => solution.reached.then_some(solution.q),
            Err(wrong) => {
                failure = Some(wrong);
                None
            }
        });
        failure.map_or(Ok(answer), |failure| Err(failure.into()))
    }
}
