//! Promise: so it is for paths of arms in a plane whose joints turn a little more than once round, where few configurations of a point are
//! kept, tools change and points are out of reach.
#![allow(clippy::unwrap_used)]

use kinopt::Arm;
use kinopt::model::{Limits, Model};
use kinopt::motion::path::{CartesianPath, PathSolver};
use kinopt::robot::Robot;
use kinopt::spatial::{Placement, Vector3, rotation_exp};

use crate::digest::{Digest, Value, check};
use crate::drawn::{at_times, one_of};
use crate::paths::{add, bare_arm, through};
use support::random::Random;

/// So many links of half a metre.
fn planar(links: usize) -> Arm {
    let mut builder = Model::builder("planar");
    let (here, [x, _, z]) = (Placement::identity(), Vector3::UNITS);
    builder.frame("base", None, here);
    let mut last = None;
    for k in 0..links {
        let at = Placement::translation(if k == 0 { Vector3::zero() } else { x * 0.5 });
        let wide = Limits::new(-3.3, 3.3);
        last = Some(builder.revolute(format!("joint {k}"), last, at, z, wide));
    }
    builder.frame("tool", last, here);
    let robot = Robot::new(builder.build().unwrap(), Vec::new()).unwrap();
    bare_arm(&robot, "base", "tool")
}

fn paths() -> Value {
    let mut digest = Digest::new();
    let arms = [3, 4, 5].map(planar);
    let tool = Placement::new(
        rotation_exp(Vector3::new(0.0, 0.0, 0.3)),
        Vector3::new(0.03, 0.02, 0.0),
    );
    let others = arms.each_ref().map(|arm| arm.with_tool(tool).unwrap());
    // Where the room for what is carried on and back is used up, and where one of two points that are missed is next to a leap.
    for case in [11, 56, 137, 1823] {
        let mut random = Random::new(7000 + case);
        let place = case as usize % 3;
        let arm = &arms[place];
        let mut drawn = Random::split_mix(case + 1);
        let ends = [(); 2].map(|()| drawn.configuration(arm));
        let mut points = through(arm, &ends, 4 + random.below(20));
        let last = points.len() - 1;
        if at_times(&mut random, 0.4) {
            for _ in 0..1 + random.below(2) {
                points[random.below(last)].translation.x += 4.0;
            }
        }
        let mut path = CartesianPath::new(points).unwrap();
        let few = one_of(&mut random, &[4, 6, 8, 12]);
        let mut solver = PathSolver::new(arm).with_samples(few);
        if at_times(&mut random, 0.4) {
            let change = 1 + random.below(last);
            let tools: Vec<usize> = (0..=last).map(|k| usize::from(k >= change)).collect();
            path = path.with_tools(tools).unwrap();
            solver = solver.with_tools([&others[place]]);
        }
        if at_times(&mut random, 0.3) {
            solver = solver.with_start(&ends[0]);
        }
        if at_times(&mut random, 0.5) {
            solver = solver.with_max_step(0.5);
        }
        if let Some(found) = digest.answer(solver.solve(&path)) {
            add(&mut digest, &found);
        }
    }
    digest.value()
}

#[test]
fn of_wide_joints() {
    check(&[("paths of arms whose joints turn more than once", paths())]);
}
