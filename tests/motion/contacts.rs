//! Promise: a frame in contact is motionless during the contact, and moves before and after it.

use std::ops::Range;

use kinopt::kinematics::ForwardKinematics;
use kinopt::motion::Trajectory;
use kinopt::motion::trajectory::{Contact, MotionProblem, MotionReport, MotionSolver, Windows};
use kinopt::task::{Point, Task};

use crate::slide::slide;
use crate::walker::{SOLE, Walker};

#[test]
fn foot_in_contact_is_still_while_its_target_moves() {
    let walker = Walker::new();
    let (frames, span) = (40, 12..30);
    let motion = walker.swaying(frames, Some(span.clone()));
    // As a whole, and in windows with seams during the contact.
    let windows = Windows::new(9, 9);
    for windows in [None, Some(windows)] {
        let solver = MotionSolver::default().with_windows(windows);
        let solved = solver.solve(&motion, &walker.stance).unwrap();
        assert!(solved.report.slip() < 1e-6, "{} m", solved.report.slip());
        assert_still(&walker, &solved, span.clone());
        // Measured from the start of the contact, not from frame to frame.
        let slipped = slipped(&walker, &solved, span.clone());
        let deviation = solved.report.slip() - slipped;
        assert!(
            deviation.abs() < 1e-3 * slipped + 1e-14,
            "{} {slipped}",
            solved.report.slip()
        );
    }
}

/// However large the weight of the task is that pulls at it.
#[test]
fn tool_in_contact_is_still_for_any_weight() {
    let (model, tool) = slide();
    for weight in [1.0, 1e2, 1e4] {
        let mut motion = MotionProblem::builder(&model, 12, 0.1);
        let pull = motion.add(Task::new(Point::new(tool, [0.0; 3])).scale(weight));
        motion.follow(pull, |frame, point| {
            point.set_target([0.1 * (frame as f64).sin(), 0.0, 0.0])
        });
        motion.contact(Contact::new(tool, 3..9).at([[0.0; 3]]));
        let motion = motion.build().unwrap();
        let solved = MotionSolver::default().solve(&motion, &[0.0]).unwrap();
        assert!(
            solved.report.slip() < 1e-6,
            "{weight}: {} {:?} m",
            solved.report.slip(),
            solved.report.termination()
        );
    }
}

/// Largest distance of a point of the sole from its position in the first frame of the contact.
fn slipped(walker: &Walker, solved: &Trajectory<MotionReport>, span: Range<usize>) -> f64 {
    let mut kinematics = ForwardKinematics::new(walker.model());
    let mut points = |frame: usize| {
        let placed = kinematics.place(solved.row(frame).unwrap()).unwrap();
        let foot = placed[walker.feet[1].index()];
        SOLE.map(|at| foot.apply(at.into()))
    };
    let first = points(span.start);
    let deviations = span.flat_map(|frame| {
        let now = points(frame);
        [0, 1, 2].map(|k| (now[k] - first[k]).norm())
    });
    deviations.fold(0.0, f64::max)
}

fn assert_still(walker: &Walker, solved: &Trajectory<MotionReport>, span: Range<usize>) {
    let mut kinematics = ForwardKinematics::new(walker.model());
    let mut at = |frame: usize| {
        let placed = kinematics.place(solved.row(frame).unwrap()).unwrap();
        placed[walker.feet[1].index()]
    };
    let first = at(span.start);
    for frame in span.clone() {
        let now = at(frame);
        let slipped = (now.translation - first.translation).norm();
        let turned = (now.rotation.x - first.rotation.x).norm();
        assert!(
            slipped < 1e-6 && turned < 1e-5,
            "{slipped} m, {turned} in frame {frame}"
        );
    }
    let before = (at(0).translation - first.translation).norm();
    assert!(before > 1e-3, "it moves where nothing holds it: {before} m");
}

/// Solver options have their effect. A larger allowed slip needs fewer iterations. Curvature leads to the same minimum
/// by other steps. Progress is reported, and costs of frames add up to the total.
#[test]
fn solver_options_have_an_effect() {
    let walker = Walker::new();
    let frames = 10;
    let motion = walker.swaying(frames, Some(3..8));
    let solver = MotionSolver::default;
    let [loose, tight] = [1e-3, 1e-11].map(|slip| {
        let solver = solver().with_slip(slip);
        solver.solve(&motion, &walker.stance).unwrap()
    });
    assert!(
        loose.report.slip() > 2.0 * tight.report.slip()
            && loose.report.iterations() < tight.report.iterations(),
        "{} in {}, {} in {}",
        loose.report.slip(),
        loose.report.iterations(),
        tight.report.slip(),
        tight.report.iterations()
    );
    let costs: f64 = (0..frames)
        .map(|frame| tight.report.frame_cost(frame).unwrap())
        .sum();
    assert!(
        (costs + tight.report.cost_of_rates() - tight.report.cost()).abs()
            < 1e-12 * tight.report.cost()
    );
    assert!(tight.report.frame_cost(frames).is_none());
    let mut done = Vec::new();
    let windows = solver().with_windows(Some(Windows::new(4, 3)));
    let start = walker.stance.repeat(frames);
    let near = windows
        .solve_near_with_progress(&motion, &start, &mut |frames| done.push(frames))
        .unwrap();
    assert!(
        done.len() > 1 && done.is_sorted() && done.last() == Some(&frames),
        "{done:?}"
    );
    assert!(
        near.report.cost() < 1.2 * tight.report.cost(),
        "{} {}",
        near.report.cost(),
        tight.report.cost()
    );
}

/// With curvature from gradients or with JᵀJ alone, frames reach the same minimum.
#[test]
fn curvature_option_keeps_the_minimum() {
    let walker = Walker::new();
    let motion = walker.swaying(16, None);
    let [bent, straight] = [true, false].map(|curvature| {
        let solver = MotionSolver::default().with_curvature(curvature);
        solver.solve(&motion, &walker.stance).unwrap()
    });
    assert!(bent.report.counts().gradients > 0 && straight.report.counts().gradients == 0);
    assert!((bent.report.cost() - straight.report.cost()).abs() < 1e-4 * bent.report.cost());
}
