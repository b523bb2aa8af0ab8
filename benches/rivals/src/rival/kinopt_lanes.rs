//! kinopt itself.

use kinopt::lanes::{LaneOptions, PoseSolver, Search};

use super::{Answer, Rival, timed};
use crate::{Failure, Query, Workload};

struct Kinopt {
    name: &'static str,
    search: Search,
    solver: PoseSolver,
}

/// One solver for each kind of search.
pub fn searches(workload: &Workload) -> Result<Vec<Box<dyn Rival>>, Failure> {
    let mut rivals: Vec<Box<dyn Rival>> = Vec::new();
    for (name, search) in [
        ("kinopt, first", Search::First),
        ("kinopt, start", Search::Start),
    ] {
        let solver = PoseSolver::new(&workload.chain, LaneOptions::default())?;
        rivals.push(Box::new(Kinopt {
            name,
            search,
            solver,
        }));
    }
    Ok(rivals)
}

impl Rival for Kinopt {
    fn name(&self) -> String {
        self.name.into()
    }

    fn answer(&mut self, query: &Query) -> Result<Answer, Failure> {
        let mut failure = None;
        let answer = timed(|| {
            let mut q = vec![0.0; query.start.len()];
            let (target, start) = (&query.target, &query.start);
            let outcome = self.solver.solve(target, start, self.search, None, &mut q);
            match outcome {
                Ok(outcome) => outcome.reached.then_some(q),
                Err(wrong) => {
                    failure = Some(wrong);
                    None
                }
            }
        });
        failure.map_or(Ok(answer), |failure| Err(failure.into()))
    }
}
