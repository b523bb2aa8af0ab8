//! FABRIK: forward and backward reaching on points, then the joints that come nearest.

use super::goal::goals;
use super::joint_groups::joint_points;
use super::joints_to_points::JointFit;
use super::linkage::{Linkage, Pin, Span, lay_straight};
use super::sweeps::{self, Limits, Sweep};
use super::{Geometric, GeometricError};
use crate::ik::{Restarts, Solution};
use crate::problem::Question;
use crate::solver::{Observer, Stopping};
use crate::spatial::Vector3;

/// Forward and backward reaching (Aristidou & Lasenby 2011) on the points where joints turn: the
/// tails of a rig's bones, the centres of a robot's shoulder, elbow and wrist. After every pass the
/// joints are set from the base out so that each bone points where its points went, clamped into
/// their limits; where a limit keeps a bone from that, the points beyond it make another pass from
/// where it really ends. The pose is what the next pass starts from, so limits hold throughout.
///
/// Point and pose tasks, any number of them: where limbs meet, a point goes to the centroid of what
/// they ask. A pose is held as three points of its frame. Turning joints only, and tasks must have a
/// place. A single chain whose target is too far away is stretched towards it; one whose target is
/// too near, because one bone is longer than all others together, is folded. A coupled joint follows
/// the one of its joints that is nearest to the base.
///
/// By default it has the optimisers' tolerances; an iteration is a pass forward and backward. Up to 500 of
/// them an attempt, which ends when 60 do not halve the cost, and restarts until 2 000 are spent.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Fabrik {
    limits: Limits,
}

impl Fabrik {
    setters! {
        /// Sets the limits of each attempt; the time limit is for all of them together.
        pub fn with_stopping(mut self, stopping: Stopping) { self.limits.stopping = stopping }
        /// Sets how often to try again. A chain that is stretched towards its target does not start to
        /// bend by itself: [`Restarts::none`] is the bare method.
        pub fn with_restarts(mut self, restarts: Restarts) { self.limits.restarts = restarts }
    }
}

impl Geometric for Fabrik {
    fn name(&self) -> &'static str {
        "fabrik"
    }

    fn solve_question(
        &self,
        question: Question<'_>,
        start: &[f64],
        observer: &mut dyn Observer,
    ) -> Result<Solution, GeometricError> {
        let goals = goals(question, "FABRIK")?;
        let joint_points = joint_points(question, &goals, "FABRIK")?;
        let mut passes = Passes {
            linkage: joint_points.linkage(),
            pins: joint_points.pins().to_vec(),
            points: joint_points.rest().to_vec(),
            fit: JointFit::new(question, joint_points),
        };
        sweeps::solve(question, start, self.limits, &mut passes, observer)
    }
}

struct Passes<'a> {
    linkage: Linkage,
    pins: Vec<Pin>,
    points: Vec<Vector3<f64>>,
    fit: JointFit<'a>,
}

impl Sweep for Passes<'_> {
    fn sweep(&mut self, x: &mut [f64]) {
        self.fit.points_at(x, &mut self.points);
        reach(&mut self.linkage, &mut self.points, &self.pins);
        // What a limit keeps one bone from, the bones beyond it make up for.
        self.fit.follow(&mut self.points, x, |points, fixed| {
            self.linkage.pass_beyond(fixed, points, &self.pins)
        });
    }
}

/// One pass, or the final pose at once where a chain's target is out of reach.
fn reach(linkage: &mut Linkage, points: &mut [Vector3<f64>], pins: &[Pin]) -> Span {
    if let (Some(lengths), [pin], [root, ..]) = (linkage.as_chain(), pins, &*points) {
        let span = Span::of(lengths, (pin.target - *root).norm());
        if span != Span::Within && pin.point == lengths.len() {
            lay_straight(points, lengths, pin.target, span);
            return span;
        }
    }
    linkage.pass(points, pins);
    Span::Within
}

/// How [`fabrik`] ended.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Reaching {
    /// Passes forward and backward; 0 where the tip was there already or the target is out of reach.
    pub passes: usize,
    /// The distance from the tip to the target, in the unit of the points.
    pub miss: f64,
    /// Whether the target was within reach.
    pub span: Span,
}

/// FABRIK on a bare chain of points, the first of which stays and the last of which should come
/// within `tolerance` of `target`; the distances between neighbours are kept. No joints and no
/// limits: that is [`Fabrik`]. Fewer than two points are left alone. A chain stretched exactly
/// towards a target within reach does not bend: give it a bend first.
///
/// The points are all that is kept between passes, so a search may be watched, or cut into frames, by
/// asking for one pass at a time:
///
/// ```
/// use kinopt::geometric::fabrik;
/// use kinopt::spatial::Vector3;
///
/// let mut points: Vec<_> = (0..6).map(|k| Vector3::new(f64::from(k), 0.0, 0.0)).collect();
/// let target = Vector3::new(1.0, 2.0, 3.0);
/// let mut last = f64::INFINITY;
/// for pass in 0..50 {
///     // Draw the points here.
///     let done = fabrik(&mut points, target, 1e-6, 1);
///     assert!(done.miss < last);
///     last = done.miss;
///     if last <= 1e-6 {
///         break;
///     }
/// }
/// assert!(last <= 1e-6);
/// ```
pub fn fabrik(
    points: &mut [Vector3<f64>],
    target: Vector3<f64>,
    tolerance: f64,
    max_passes: usize,
) -> Reaching {
    let miss = |points: &[Vector3<f64>]| points.last().map_or(0.0, |&tip| (tip - target).norm());
    let mut linkage = Linkage::chain(points);
    let mut done = Reaching {
        passes: 0,
        miss: miss(points),
        span: Span::Within,
    };
    let Some(point) = points.len().checked_sub(1).filter(|&last| last > 0) else {
        return done;
    };
    let pins = [Pin { point, target }];
    while done.miss > tolerance && done.passes < max_passes {
        done.span = reach(&mut linkage, points, &pins);
        done.miss = miss(points);
        if done.span != Span::Within {
            break;
        }
        done.passes += 1;
    }
    done
}
