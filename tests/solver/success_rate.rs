//! Promise: the default solver reaches at least 99 % of five-tip targets from rest, to 1e-8 of the size. Targets come
//! from random poses of rigs with 19 to 22 bones over their full limits. A reported success is one.

use kinopt::problem::Problem;
use kinopt::task::{Point, Quantity};
use kinopt::{Solver, Workspace};
use support::bones::RandomRig;
use support::random::{Random, case_count};
use support::trees::configuration_of;

const RIGS: u64 = 50;

#[test]
fn default_solver_reaches_99_percent() {
    let solver = Solver::default();
    let mut workspace = Workspace::new();
    let problems = case_count(1000, 100) as u64;
    let mut reached = 0;
    let mut missed = Vec::new();
    for k in 0..problems {
        let rig = RandomRig::new(1000 + k % RIGS);
        assert!((19..=22).contains(&rig.skeleton.bones().len()));
        let model = rig.skeleton.model();
        let within = 1e-8 * rig.skeleton.size();
        let pose = configuration_of(model, &mut Random::new(50 + k));
        let transforms = rig.transforms(&pose);
        let mut builder = Problem::builder(model);
        builder.tolerance(Quantity::Metres, within);
        let targets: Vec<_> = rig.tips.iter().map(|&t| rig.tip(&transforms, t)).collect();
        for (&tip, &target) in rig.tips.iter().zip(&targets) {
            builder.add(Point::new(rig.skeleton.tip(tip), target));
        }
        let problem = builder.build().unwrap();
        let solution = solver
            .solve(&problem, &model.neutral(), &mut workspace)
            .unwrap();

        let transforms = rig.transforms(&solution.q);
        let errors = rig.tips.iter().zip(&targets);
        let worst = errors.fold(0.0, |largest: f64, (&tip, target)| {
            largest.max((rig.tip(&transforms, tip) - target).norm())
        });
        // The two evaluations differ by rounding, far below the tolerance.
        assert_eq!(
            solution.reached,
            worst <= within,
            "{k}: {worst:e} of {within:e}"
        );
        for (value, limits) in solution.q.iter().zip(model.limits()) {
            assert!(limits.contains(*value));
        }
        reached += u64::from(solution.reached);
        if !solution.reached {
            missed.push((k, worst));
        }
    }
    assert!(
        reached * 100 >= problems * 99,
        "{reached} of {problems}: {missed:?}"
    );
}
