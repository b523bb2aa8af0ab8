//! Promise: every frame of a drag keeps loops closed, also for unreachable targets.

use kinopt::Problem;
use kinopt::ik::{Drag, LoopClosure};
use kinopt::model::{Loop, ParameterMap};
use kinopt::task::Point;

use crate::loops::mechanisms::FourBar;

#[test]
fn dragged_pen_keeps_its_loop_closed() {
    let linkage = FourBar::CRANK_ROCKER;
    let model = linkage.model();
    let joint = |name| model.joint(name).unwrap();
    let dependent = [joint("coupler"), joint("rocker")];
    let closure = LoopClosure::new(ParameterMap::builder(&model), &dependent).unwrap();
    let mut start = vec![0.5, 0.5, 1.5];
    closure.close(&mut start).unwrap();
    let mut tasks = Problem::builder(&model);
    let pen = tasks.add(Point::new(model.frame("pen").unwrap(), [0.15, 0.2, 0.0]));
    let mut drag = Drag::new(tasks.build().unwrap(), &start).unwrap();
    let mut missed = 0;
    for frame in 0..240 {
        let (sin, cos) = (f64::from(frame) * 0.03).sin_cos();
        let target = [0.15 + 0.25 * cos, 0.1 + 0.25 * sin, 0.0];
        drag.target_mut(pen).unwrap().set_target(target);
        let solution = drag.advance();
        assert!(solution.loops_closed(), "{frame}: {}", solution.explain());
        let deviation = linkage.freudenstein(solution.q[0], solution.q[2]);
        assert!(
            deviation.abs() < Loop::TOLERANCE / linkage.crank.powi(2),
            "{deviation:e}"
        );
        missed += usize::from(!solution.reached);
    }
    // The pen has one curve, which few targets are on.
    assert!(missed > 230, "{missed} of 240");
}
