//! Promise: an out-of-reach report names the first moving joint of the chain and the chain's length from there,
//! whatever its fixed base.

use kinopt::model::{Limits, Model};
use kinopt::spatial::{Placement, Vector3};
use kinopt::task::Point;
use kinopt::{Problem, Solver};

/// Arm of 1.4 m on a fixed mast of 3 m.
#[test]
fn fixed_links_are_not_part_of_the_chain() {
    let [_, _, z] = Vector3::UNITS;
    let [mast, upper, fore] = [[0.0, 0.0, 3.0], [1.0, 0.0, 0.0], [0.4, 0.0, 0.0]]
        .map(|at| Placement::translation(at.into()));
    let turns = Limits::new(-2.0, 2.0);
    let mut builder = Model::builder("arm on a mast");
    let foot = builder.fixed("foot", None, Placement::identity());
    let top = builder.fixed("mast", Some(foot), mast);
    let shoulder = builder.revolute("shoulder", Some(top), Placement::identity(), z, turns);
    let elbow = builder.revolute("elbow", Some(shoulder), upper, z, turns);
    let tip = builder.frame("tip", Some(elbow), fore);
    let model = builder.build().unwrap();
    for (distance, beyond) in [(1.3, false), (1.5, true), (4.0, true)] {
        let mut tasks = Problem::builder(&model);
        tasks.add(Point::new(tip, [distance, 0.0, 3.0]));
        let problem = tasks.build().unwrap();
        let solution = Solver::default().solve_once(&problem, &[0.3, 0.2]).unwrap();
        assert_eq!(solution.is_out_of_reach(), beyond, "{distance}");
        let explanation = solution.explain();
        let verdict = format!("should be {distance:.3} m from `shoulder`");
        assert_eq!(explanation.contains(&verdict), beyond, "{explanation}");
        assert_eq!(
            explanation.contains("the chain reaches 1.400 m"),
            beyond,
            "{explanation}"
        );
    }
}
