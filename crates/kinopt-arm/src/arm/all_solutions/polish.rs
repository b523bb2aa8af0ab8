//! Newton's method on the closure of a six-joint chain, from a candidate.

use super::angle::Angle;
use super::linear::solve_square;
use super::screw::Screw;
use kinopt_kinematics::spatial::{Matrix3, Placement, Vector3, rotation_log};

/// Largest number of steps.
const MAX_STEPS: usize = 40;
/// Error that polishing aims at, lengths of the arm and radians.
const AIM: f64 = 1e-13;
/// Factors on the damping after a step that fails, and after one that succeeds.
const DAMPING_GROWTH: f64 = 10.0;
const DAMPING_DECAY: f64 = 0.01;
/// Smallest damping, so that singular configurations have a step.
const SMALL_DAMPING: f64 = 1e-7;
/// Smallest singular value below which a configuration may have a twin: another solution near to it.
const NEARLY_SINGULAR: f64 = 0.02;
/// Longest step of a joint, radians; a longer one is damped.
const MAX_STEP: f64 = 0.3;

/// Displacement of the last link, and the current axes.
fn forward(axes: &[Screw; 6], q: &[Angle; 6], current: &mut [Screw; 6]) -> Placement<f64> {
    let mut displacement = Placement::identity();
    for ((axis, q), current) in axes.iter().zip(q).zip(current) {
        *current = axis.displaced(&displacement);
        displacement = displacement * axis.displacement(*q);
    }
    displacement
}

/// Twist from a displacement to the goal, about the tool's point: lengths of the arm, then radians.
fn error(displacement: &Placement<f64>, goal: &Placement<f64>, tool: Vector3<f64>) -> [f64; 6] {
    let position = goal.apply(tool) - displacement.apply(tool);
    twist(position, &displacement.rotation, &goal.rotation)
}

/// Twist from a pose to the goal, about the pose's origin.
pub(super) fn pose_error(pose: &Placement<f64>, goal: &Placement<f64>) -> [f64; 6] {
    let position = goal.translation - pose.translation;
    twist(position, &pose.rotation, &goal.rotation)
}

fn twist(position: Vector3<f64>, from: &Matrix3<f64>, to: &Matrix3<f64>) -> [f64; 6] {
    let r = *to * from.transpose();
    let skew = Vector3::new(r.y.z - r.z.y, r.z.x - r.x.z, r.x.y - r.y.x) * 0.5;
    let trace = r.x.x + r.y.y + r.z.z;
    // The sine of small angles; the logarithm elsewhere.
    let rotation = match trace > 2.99 {
        true => skew * (1.0 + skew.norm_squared() / 6.0),
        false => rotation_log(&r),
    };
    [
        position.x, position.y, position.z, rotation.x, rotation.y, rotation.z,
    ]
}

fn norm(v: &[f64; 6]) -> f64 {
    v.iter().map(|v| v * v).sum::<f64>().sqrt()
}

/// Errors of a configuration.
#[derive(Clone, Copy, Debug)]
pub(super) struct ClosureError {
    /// Position error, lengths of the arm.
    pub(super) position: f64,
    /// Orientation error, radians.
    pub(super) orientation: f64,
}

impl ClosureError {
    fn of(residual: &[f64; 6]) -> Self {
        let part = |i: usize| Vector3::new(residual[i], residual[i + 1], residual[i + 2]).norm();
        Self {
            position: part(0),
            orientation: part(3),
        }
    }

    /// True if both errors are at most `size`.
    pub(super) fn is_within(&self, size: f64) -> bool {
        self.position <= size && self.orientation <= size
    }
}

/// Errors of a configuration.
pub(super) fn closure_error(
    axes: &[Screw; 6],
    goal: &Placement<f64>,
    tool: Vector3<f64>,
    q: &[Angle; 6],
) -> ClosureError {
    let mut current = *axes;
    ClosureError::of(&error(&forward(axes, q, &mut current), goal, tool))
}

/// Moves a candidate to a solution, and returns its errors.
pub(super) fn polish(
    axes: &[Screw; 6],
    goal: &Placement<f64>,
    tool: Vector3<f64>,
    q: &mut [Angle; 6],
) -> ClosureError {
    let mut current = *axes;
    let mut residual = error(&forward(axes, q, &mut current), goal, tool);
    let mut size = norm(&residual);
    let mut damping = 0.0;
    for _ in 0..MAX_STEPS {
        if size <= AIM {
            break;
        }
        let end = goal.apply(tool) - Vector3::new(residual[0], residual[1], residual[2]);
        let columns = columns(&current, end);
        let step = match damping > 0.0 {
            false => solve_square(transposed(&columns), residual)
                .filter(|step| largest(step) <= MAX_STEP),
            true => None,
        };
        let step =
            step.unwrap_or_else(|| damped_step(&columns, &residual, f64::max(damping, size)));
        let shrink = (MAX_STEP / largest(&step)).min(1.0);
        let mut trial = *q;
        for (q, step) in trial.iter_mut().zip(&step) {
            // The rational approximation of the rotation is exact on the circle.
            let t = 0.5 * step * shrink;
            let scale = (1.0 + t * t).recip();
            *q = q.plus(Angle {
                cos: (1.0 - t * t) * scale,
                sin: 2.0 * t * scale,
            });
        }
        let mut trial_axes = *axes;
        let trial_residual = error(&forward(axes, &trial, &mut trial_axes), goal, tool);
        let trial_size = norm(&trial_residual);
        if trial_size < size {
            let is_slow = trial_size > 0.5 * size && size < 1e-9;
            (*q, current, residual, size) = (trial, trial_axes, trial_residual, trial_size);
            damping *= DAMPING_DECAY;
            if damping < DAMPING_DECAY * size {
                damping = 0.0;
            }
            if is_slow {
                break;
            }
        } else if size < 1e-11 {
            break;
        } else {
            damping = f64::max(DAMPING_GROWTH * damping, size);
        }
    }
    for q in q.iter_mut() {
        *q = Angle::of_point(q.cos, q.sin);
    }
    ClosureError::of(&residual)
}

fn transposed(columns: &[[f64; 6]; 6]) -> [[f64; 6]; 6] {
    std::array::from_fn(|i| columns.map(|column| column[i]))
}

fn largest(step: &[f64; 6]) -> f64 {
    step.iter()
        .fold(0.0, |largest: f64, v| largest.max(v.abs()))
}

/// Direction in which a nearly singular configuration can move, if its smallest singular value is below
/// [`NEARLY_SINGULAR`].
pub(super) fn null_direction(
    axes: &[Screw; 6],
    tool: Vector3<f64>,
    q: &[Angle; 6],
) -> Option<[f64; 6]> {
    let mut current = *axes;
    let end = forward(axes, q, &mut current).apply(tool);
    let columns = columns(&current, end);
    // Two steps of inverse iteration.
    let mut direction = [0.9, -0.7, 0.8, 0.6, -0.5, 0.4];
    let mut size = 0.0;
    for _ in 0..2 {
        let next = solve_damped(&columns, &direction, SMALL_DAMPING);
        size = norm(&next) / norm(&direction);
        direction = next;
    }
    let length = norm(&direction);
    (size * NEARLY_SINGULAR * NEARLY_SINGULAR > 1.0).then(|| direction.map(|v| v / length))
}

/// Columns of the Jacobian at the point `end`.
fn columns(current: &[Screw; 6], end: Vector3<f64>) -> [[f64; 6]; 6] {
    current.map(|axis| {
        let v = axis.direction.cross(end - axis.point);
        let w = axis.direction;
        [v.x, v.y, v.z, w.x, w.y, w.z]
    })
}

fn dot(a: &[f64; 6], b: &[f64; 6]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Solves (Jᵀ·J + λ²·1)·step = Jᵀ·residual.
fn damped_step(columns: &[[f64; 6]; 6], residual: &[f64; 6], damping: f64) -> [f64; 6] {
    let right = std::array::from_fn(|i| dot(&columns[i], residual));
    solve_damped(columns, &right, damping)
}

/// Solves (Jᵀ·J + λ²·1)·x = right by Cholesky's factorisation.
fn solve_damped(columns: &[[f64; 6]; 6], right: &[f64; 6], damping: f64) -> [f64; 6] {
    let mut factor = [[0.0; 6]; 6];
    let mut step = [0.0; 6];
    for i in 0..6 {
        for j in 0..=i {
            let mut sum = dot(&columns[i], &columns[j]);
            if i == j {
                sum += damping * damping + SMALL_DAMPING * SMALL_DAMPING;
            }
            let (row, other) = (factor[i], factor[j]);
            let products = row.iter().zip(&other).take(j).map(|(a, b)| a * b);
            sum -= products.sum::<f64>();
            factor[i][j] = match i == j {
                true => sum.max(1e-20).sqrt(),
                false => sum / factor[j][j],
            };
        }
        let sum: f64 = (0..i).map(|k| factor[i][k] * step[k]).sum();
        step[i] = (right[i] - sum) / factor[i][i];
    }
    for i in (0..6).rev() {
        let sum: f64 = (i + 1..6).map(|k| factor[k][i] * step[k]).sum();
        step[i] = (step[i] - sum) / factor[i][i];
    }
    step
}
