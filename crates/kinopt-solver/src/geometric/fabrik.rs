//! FABRIK: forward and backward reaching on points, followed by a fit of the joints.

use super::Geometric;
use super::goal::goals;
use super::joint_groups::joint_points;
use super::joints_to_points::JointFit;
use super::linkage::{Linkage, Pin, Span, straighten};
use super::sweeps::{self, Limits, Sweep};
use crate::ik::{Restarts, Solution};
use crate::problem::ProblemInstance;
use crate::search::SolveError;
use crate::solver::{Observer, Stopping};
use kinopt_kinematics::spatial::Vector3;

/// Forward and backward reaching inverse kinematics (FABRIK, Aristidou & Lasenby 2011) on the centres of joints.
///
/// The points are the tails of a rig's bones, or the centres of a robot's shoulder, elbow and wrist. After each pass
/// the joints are set from the base outwards, so that each bone points towards its point, clamped to the limits. If a
/// limit prevents that, the points beyond the bone make another pass from its actual end. The next pass starts from the
/// resulting pose, so limits hold throughout.
///
/// It accepts any number of point and pose tasks. At a branching point, the target is the centroid of the targets of
/// its children. A pose is represented by three points of its frame. All joints must rotate, and all tasks need a
/// position. A single chain is stretched towards a target that is too far. It is folded if a target is too near,
/// because one bone is longer than all others together. A coupled variable is set by its joint nearest to the base.
///
/// Tolerances are those of the optimisers by default. An iteration is a pass forward and backward. An attempt has at
/// most 500, and ends if 60 do not halve the cost. Attempts restart until 2 000 iterations are spent.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Fabrik {
    limits: Limits,
}

impl Fabrik {
    /// Sets the limits of each attempt; the time limit applies to all attempts together.
    #[must_use]
    pub fn with_stopping(mut self, stopping: Stopping) -> Self {
        self.limits.stopping = stopping;
        self
    }

    /// Sets the number of further attempts.
    ///
    /// [`Restarts::none`] is the bare method, which does not bend a chain that is straight towards its target.
    #[must_use]
    pub fn with_restarts(mut self, restarts: Restarts) -> Self {
        self.limits.restarts = restarts;
        self
    }
}

impl Geometric for Fabrik {
    fn name(&self) -> &'static str {
        "fabrik"
    }

    fn solve_question(
        &self,
        instance: ProblemInstance<'_>,
        start: &[f64],
        observer: &mut dyn Observer,
    ) -> Result<Solution, SolveError> {
        let goals = goals(instance, "FABRIK")?;
        let joint_points = joint_points(instance, &goals, "FABRIK")?;
        let mut passes = Passes {
            linkage: joint_points.linkage(),
            pins: joint_points.pins().to_vec(),
            points: joint_points.rest().to_vec(),
            fit: JointFit::new(instance, joint_points),
        };
        sweeps::solve(instance, start, self.limits, &mut passes, observer)
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
        // Bones beyond a bone at its limit compensate for the error.
        self.fit.move_to(&mut self.points, x, |points, fixed| {
            self.linkage.pass_beyond(fixed, points, &self.pins)
        });
    }
}

/// One pass, or the final pose at once if a chain's target is out of reach.
fn reach(linkage: &mut Linkage, points: &mut [Vector3<f64>], pins: &[Pin]) -> Span {
    if let (Some(lengths), [pin], [root, ..]) = (linkage.as_chain(), pins, &*points) {
        let span = Span::of(lengths, (pin.target - *root).norm());
        if span != Span::Within && pin.point == lengths.len() {
            straighten(points, lengths, pin.target, span);
            return span;
        }
    }
    linkage.pass(points, pins);
    Span::Within
}

/// The result of [`fabrik`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Reaching {
    /// Passes forward and backward; 0 if the tip starts at the target or the target is out of reach.
    pub passes: usize,
    /// Distance from the tip to the target, in the unit of the points.
    pub miss: f64,
    /// Position of the target relative to the reach of the chain.
    pub span: Span,
}

/// FABRIK on a chain of points: the first point stays, the last moves to within `tolerance` of `target`.
///
/// Distances between neighbours stay. There are no joints and no limits; for those use [`Fabrik`]. Fewer than two
/// points stay unchanged. A chain that is straight towards a reachable target does not bend: bend it first.
///
/// No state except the points is kept between passes, so an animation may run one pass at a time:
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
    let mut result = Reaching {
        passes: 0,
        miss: miss(points),
        span: Span::Within,
    };
    let Some(point) = points.len().checked_sub(1).filter(|&last| last > 0) else {
        return result;
    };
    let pins = [Pin { point, target }];
    while result.miss > tolerance && result.passes < max_passes {
        result.span = reach(&mut linkage, points, &pins);
        result.miss = miss(points);
        if result.span != Span::Within {
            break;
        }
        result.passes += 1;
    }
    result
}
