//! Upper bound on the deviation of the tool from the path between two configurations.
//!
//! While all joints move at constant rates, the tool position is a curve x(t). Its second derivative is at most Σₖ |Δₖ|
//! rₖ (|Δₖ| + 2 Σ_{j<k} |Δⱼ|). Here rₖ is the length of the chain from joint k to the tool (Siciliano et al. 2009,
//! "Robotics", eq. 3.30, differentiated once more). The distance of a curve from a chord is at most an eighth of that,
//! times the squared time between its ends. Measurements at a few points therefore bound all points in between, and
//! more points tighten the bound.
//!
//! A parabola through three points bounds the curve more tightly. The distance of the curve from it is at most a factor
//! times the third derivative. The factor is the maximum of |t (t − ½) (t − 1)| / 6 (Davis 1975, "Interpolation and
//! Approximation", ch. 3.1). The third derivative is at most Σₖ rₖ (Sₖ³ − Sₖ₋₁³) with Sₖ = Σ_{j≤k} |Δⱼ|. The Bézier
//! points bound the parabola. Orientations are bounded by the vector part of the relative quaternion. Pose bounds are
//! convex, so both ends within them imply all points within them.

use super::PathError;
use super::cartesian_path::CartesianPath;
use super::linear_segment::interpolate;
use super::path_report::Deviation;
use super::tools::Tools;
use crate::arm::{Arm, ChainMotion};
use kinopt_kinematics::scalar::elementary;
use kinopt_kinematics::spatial::{Placement, Quaternion, Vector3};

/// Maximum number of points at which one step is measured.
const MAX_SAMPLES: usize = 1024;
/// Relative difference between bound and measurement at which refinement stops.
const BOUND_TOLERANCE: f64 = 0.02;
/// Maximum of |t (t − ½) (t − 1)| / 6 on [0, 1]: √3 / 216.
const PARABOLA_ERROR_FACTOR: f64 = 0.008_018_754;

/// Step along the path.
pub(super) struct PathStep<'a> {
    /// Row that the step leads to.
    pub(super) row: usize,
    /// Indices of the path points at both ends.
    pub(super) points: [usize; 2],
    pub(super) q: [&'a [f64]; 2],
}

/// Returns the largest deviation of all steps.
pub(super) fn largest(
    tools: &Tools<'_>,
    path: &CartesianPath,
    steps: &[PathStep<'_>],
) -> Result<Deviation, PathError> {
    let tool_of = |step: &PathStep<'_>| path.tools.get(step.points[1]).copied().unwrap_or(0);
    let mut motions: Vec<Option<Vec<ChainMotion>>> = Vec::new();
    for step in steps {
        let tool = tool_of(step);
        if motions.len() <= tool {
            motions.resize(tool + 1, None);
        }
        if motions[tool].is_none() {
            motions[tool] = Some(tools.arm(tool).chain_motions());
        }
    }
    // Recomputed on refinement, to keep memory low for a million steps.
    let curve = |step| {
        let tool = tool_of(step);
        let motions = motions[tool].as_deref().unwrap_or_default();
        Curve::new(tools.arm(tool), path, step, motions)
    };
    let mut bounds = Vec::with_capacity(steps.len());
    // Most steps begin at the end of the previous step.
    let mut last: Option<(&PathStep<'_>, Placement<f64>)> = None;
    for step in steps {
        // Such steps use the same tool, as steps over a tool change are excluded.
        let continues = |before: &PathStep<'_>| std::ptr::eq(before.q[1], step.q[0]);
        let begin = last
            .filter(|(before, _)| continues(before))
            .map(|(_, tool)| tool);
        let measured = curve(step)?.measure(2, begin)?;
        bounds.push(measured.bounds);
        last = Some((step, measured.end));
    }
    let mut largest = Deviation::default();
    let mut order: Vec<usize> = (0..steps.len()).collect();
    for component in [0, 1] {
        // Sorted by the first bounds, so that most steps need no refinement.
        order.sort_by(|a, b| {
            let (a, b) = ((bounds[*a][component], *a), (bounds[*b][component], *b));
            b.0.total_cmp(&a.0).then(a.1.cmp(&b.1))
        });
        let (mut max, mut max_row) = (0.0, 0);
        for &index in &order {
            if bounds[index][component] <= max {
                break;
            }
            let bound = curve(&steps[index])?.tight_bound(component, max)?;
            if bound > max {
                (max, max_row) = (bound, steps[index].row);
            }
        }
        match component {
            0 => (largest.metres, largest.metres_at) = (max, max_row),
            _ => (largest.radians, largest.radians_at) = (max, max_row),
        }
    }
    Ok(largest)
}

/// Tool motion from one row to the next, with bounds of its derivatives.
struct Curve<'a> {
    arm: &'a Arm,
    targets: [Placement<f64>; 2],
    q: [&'a [f64]; 2],
    /// Bounds of the second derivatives of the position, metres, and of the quaternion vector part.
    second_derivatives: [f64; 2],
    /// Bounds of the third derivatives of both vectors, metres and twice the vector part; `None` with pose bounds.
    third_derivatives: Option<[f64; 2]>,
    /// Bound on the displacement of the vector part.
    max_rotation: f64,
    /// Distance of a curved path from the chord, metres.
    bulge: f64,
}

/// Result of a measurement, metres and radians.
struct MeasuredDeviation {
    /// Largest deviation at the measured points.
    largest: [f64; 2],
    /// Upper bound over the whole step.
    bounds: [f64; 2],
    /// Tool pose at the end.
    end: Placement<f64>,
}

impl<'a> Curve<'a> {
    fn new(
        arm: &'a Arm,
        path: &CartesianPath,
        step: &PathStep<'a>,
        motions: &[ChainMotion],
    ) -> Result<Self, PathError> {
        let targets = step.points.map(|point| path.points[point]);
        let [from, to] = step.q;
        let (mut lever, mut bend, mut speed) = (0.0, 0.0, 0.0);
        let (mut rotation, mut rotation_bend, mut third) = (0.0, 0.0, 0.0);
        let moved = |motion: &ChainMotion| {
            (motion.ratio * (to[motion.variable] - from[motion.variable])).abs()
        };
        for (index, motion) in motions.iter().enumerate().rev() {
            lever += motion.length_after;
            let delta = moved(motion);
            let before = motions[..index].iter().filter(|before| !before.slides);
            let before: f64 = before.map(moved).sum();
            if motion.slides {
                bend += 2.0 * delta * before;
                third += 3.0 * delta * before * before;
                speed += delta;
                let value = |q: &[f64]| (motion.ratio * q[motion.variable] + motion.offset).abs();
                lever += value(from).max(value(to));
            } else {
                bend += delta * lever * (delta + 2.0 * before);
                third += delta * lever * (delta * delta + 3.0 * before * (delta + before));
                speed += delta * lever;
                rotation_bend += delta * before;
                rotation += delta;
            }
        }
        let displacement = targets[1].translation - targets[0].translation;
        let relative = targets[0].rotation.transpose() * targets[1].rotation;
        let path_rotation = Quaternion::from_matrix(&relative).log().norm();
        if arm.goal().has_bounds() {
            // In the rotating axes of the target.
            let reach = arm.base_from_tool(from)?.translation - targets[0].translation;
            let reach = reach.norm() + speed + displacement.norm();
            bend += path_rotation * (2.0 * (speed + displacement.norm()) + path_rotation * reach);
        }
        let total_rotation = rotation + path_rotation;
        let third_derivatives = [
            third,
            0.25 * total_rotation * total_rotation * total_rotation,
        ];
        Ok(Self {
            arm,
            targets,
            third_derivatives: (!arm.goal().has_bounds()).then_some(third_derivatives),
            q: step.q,
            second_derivatives: [
                bend,
                0.5 * rotation_bend + 0.25 * total_rotation * total_rotation,
            ],
            max_rotation: 0.5 * total_rotation,
            bulge: path.bulges.get(step.points[1]).copied().unwrap_or(0.0),
        })
    }

    /// Refines the bound until it is close to the measurement or at most `threshold`.
    fn tight_bound(&self, component: usize, threshold: f64) -> Result<f64, PathError> {
        let mut parts = 2;
        let mut best = f64::INFINITY;
        loop {
            let measured = self.measure(parts, None)?;
            let bound = measured.bounds[component];
            best = best.min(bound);
            let is_tight = bound <= measured.largest[component] * (1.0 + BOUND_TOLERANCE) + 1e-9;
            if is_tight || best <= threshold || parts >= MAX_SAMPLES {
                return Ok(best);
            }
            parts *= 2;
        }
    }

    /// Measures the step at the ends of `parts` parts. `begin` is the initial tool pose, if known.
    fn measure(
        &self,
        parts: usize,
        begin: Option<Placement<f64>>,
    ) -> Result<MeasuredDeviation, PathError> {
        let [from, to] = self.q;
        let bands = self.arm.goal().bands();
        let mut q = vec![0.0; from.len()];
        let mut largest = [0.0_f64; 2];
        let mut parabolas = [Parabola::default(); 2];
        let mut last: Option<Quaternion<f64>> = None;
        let mut sign_known = true;
        let mut end = Placement::identity();
        for index in 0..=parts {
            let fraction = index as f64 / parts as f64;
            for (q, (a, b)) in q.iter_mut().zip(from.iter().zip(to)) {
                *q = a + fraction * (b - a);
            }
            let tool = match begin.filter(|_| index == 0) {
                Some(begin) => begin,
                None => self.arm.base_from_tool(&q)?,
            };
            end = tool;
            let target = interpolate(&self.targets[0], &self.targets[1], fraction);
            let offset = tool.translation - target.translation;
            let metres = match bands[..3] == [0.0; 3] {
                true => offset.norm(),
                false => distance_outside(target.rotation.transpose() * offset, &bands[..3]),
            };
            let relative = target.rotation.transpose() * tool.rotation;
            let relative = Quaternion::from_matrix(&relative);
            let chord = distance_outside(relative.v * 2.0, &bands[3..]);
            largest = [largest[0].max(metres), largest[1].max(chord)];
            parabolas[0].push(index, offset);
            parabolas[1].push(index, relative.v * 2.0);
            if let Some(last) = last {
                // False if the sign of the quaternion is ambiguous over a part.
                sign_known &= self.max_rotation / (parts as f64) < 1.0
                    && last.w * relative.w + last.v.dot(relative.v) > 0.0;
            }
            last = Some(relative);
        }
        let chord_factor = 1.0 / (8.0 * (parts * parts) as f64);
        let angle = |chord: f64| 2.0 * elementary::asin((0.5 * chord).min(1.0));
        let mut bounds = [
            largest[0] + self.second_derivatives[0] * chord_factor,
            largest[1] + 2.0 * self.second_derivatives[1] * chord_factor,
        ];
        if let (Some(third_derivatives), true) = (self.third_derivatives, parts.is_multiple_of(2)) {
            let width = 2.0 / parts as f64;
            let parabola_error = PARABOLA_ERROR_FACTOR * width * width * width;
            for component in [0, 1] {
                bounds[component] = bounds[component].min(
                    parabolas[component].largest + parabola_error * third_derivatives[component],
                );
            }
        }
        let [metres, chord] = bounds;
        let free = bands[3..].iter().all(|band| *band == f64::INFINITY);
        let radians = match sign_known {
            true => angle(chord),
            false => std::f64::consts::PI,
        };
        Ok(MeasuredDeviation {
            largest: [largest[0] + self.bulge, angle(largest[1])],
            bounds: [metres + self.bulge, if free { 0.0 } else { radians }],
            end,
        })
    }
}

/// Largest distance from zero of the parabolas through points 0 to 2, 2 to 4 and so on.
#[derive(Clone, Copy, Default)]
struct Parabola {
    last: [Vector3<f64>; 2],
    largest: f64,
}

impl Parabola {
    /// Adds the next point.
    fn push(&mut self, index: usize, next: Vector3<f64>) {
        let [from, middle] = self.last;
        if index > 0 && index.is_multiple_of(2) {
            // Subdivision at the middle: the inner points are half-way to the Bézier control point.
            let inner = middle * 2.0 - (from + next) * 0.5;
            for point in [
                from,
                (from + inner) * 0.5,
                middle,
                (inner + next) * 0.5,
                next,
            ] {
                self.largest = self.largest.max(point.norm());
            }
        }
        self.last = [middle, next];
    }
}

/// Returns the distance of a vector from a box of half widths `bands`.
fn distance_outside(vector: Vector3<f64>, bands: &[f64]) -> f64 {
    let parts = vector.to_array();
    let squares = parts.iter().zip(bands).map(|(part, band)| {
        let excess = (part.abs() - band).max(0.0);
        excess * excess
    });
    squares.sum::<f64>().sqrt()
}

#[cfg(test)]
mod tests {
    use super::{Curve, PathStep};
    use crate::arm::Arm;
    use crate::path::CartesianPath;
    use kinopt_kinematics::model::{Limits, Model};
    use kinopt_kinematics::spatial::{Placement, Vector3};
    use kinopt_robot::robot::Robot;

    /// Two links, stretched half-way: the bound holds at every refinement and is at most 1 % above the actual
    /// deviation.
    #[test]
    #[allow(clippy::unwrap_used)]
    fn first_bound_of_a_stretched_chain_is_close() {
        let mut builder = Model::builder("two links");
        let z = Vector3::UNITS[2];
        let link = Placement::translation(Vector3::UNITS[0]);
        let joint_limits = Limits::new(-3.0, 3.0);
        let base = builder.frame("base", None, Placement::identity());
        let upper = builder.revolute("upper", None, Placement::identity(), z, joint_limits);
        let lower = builder.revolute("lower", Some(upper), link, z, joint_limits);
        let tip = builder.frame("tip", Some(lower), link);
        let robot = Robot::new(builder.build().unwrap(), Vec::new()).unwrap();
        let arm = Arm::builder(&robot, base, tip).with_atlas(false);
        let arm = arm.build().unwrap();
        for angles in [[0.05, 0.05], [0.1, 0.02], [0.02, 0.1]] {
            let configuration_at = |fraction: f64| angles.map(|angle| angle * (fraction - 0.5));
            let tool = |fraction: f64| arm.base_from_tool(&configuration_at(fraction)).unwrap();
            let path = CartesianPath::new(vec![tool(0.0), tool(1.0)]).unwrap();
            let step = PathStep {
                row: 1,
                points: [0, 1],
                q: [&configuration_at(0.0), &configuration_at(1.0)],
            };
            let motions = arm.chain_motions();
            let curve = Curve::new(&arm, &path, &step, &motions).unwrap();
            let displacement = tool(1.0).translation - tool(0.0).translation;
            let distance = |fraction: f64| {
                let chord_point = tool(0.0).translation + displacement * fraction;
                (tool(fraction).translation - chord_point).norm()
            };
            let max_distance = (0..=100).map(|k| distance(f64::from(k) / 100.0));
            let max_distance = max_distance.fold(0.0, f64::max);
            for parts in [1, 2, 4] {
                let bound = curve.measure(parts, None).unwrap().bounds[0];
                assert!(
                    max_distance <= bound && bound < 1.01 * max_distance,
                    "{max_distance} {bound}"
                );
            }
        }
    }
}
