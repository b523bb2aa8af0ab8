//! Promise: geometric methods give equal results in any unit of length.

use kinopt::Problem;
use kinopt::geometric::{Fabrik, Geometric};
use kinopt::ik::Restarts;
use kinopt::task::{Point, Quantity};
use support::bones::RandomRig;

/// Positions scale with the unit, so angles are equal.
#[test]
fn geometric_solvers_are_unit_invariant() {
    for seed in 0..6 {
        let solved = [-20, 0, 20].map(|power| {
            let unit = f64::powi(2.0, power);
            let rig = RandomRig::scaled(seed, unit);
            let model = rig.skeleton.model();
            let goal: Vec<f64> = model.random_configuration(seed);
            let goal: Vec<f64> = goal.iter().map(|value| 0.3 * value).collect();
            let placed = rig.skeleton.pose(&goal).unwrap();
            let mut builder = Problem::builder(model);
            for &tip in &rig.tips[..2] {
                let target = placed.tip(&rig.skeleton, tip).unwrap();
                builder.add(Point::new(rig.skeleton.tip(tip), target));
            }
            builder.tolerance(Quantity::Metres, 1e-6 * unit);
            let problem = builder.build().unwrap();
            let fabrik = Fabrik::default().with_restarts(Restarts::none());
            let solution = fabrik.solve(&problem, &vec![0.0; goal.len()]).unwrap();
            (solution.iterations, solution.q)
        });
        for (iterations, q) in &solved {
            assert_eq!(*iterations, solved[1].0, "{seed}");
            let apart = q.iter().zip(&solved[1].1).map(|(a, b)| (a - b).abs());
            assert!(apart.fold(0.0, f64::max) < 1e-9, "{seed}");
        }
    }
}
