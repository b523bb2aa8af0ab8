//! Residuals evaluated in `f64` only.

use std::any::TypeId;

use super::{Description, Inputs, LocalJacobian, Residual, Role, RowBlock};
use kinopt_kinematics::scalar::{Scalar, elementary};
use kinopt_kinematics::spatial::{Matrix3, Placement, Vector3, rotation_exp};

/// A residual that cannot be written over a [`Scalar`]: a table, a simulation, a function of another language.
///
/// [`Numeric`] turns it into a [`Residual`], with its own derivatives or central differences.
pub trait NumericResidual: Clone + Send + Sync + 'static {
    /// See [`Residual::ROLE`].
    const ROLE: Role = Role::Goal;

    /// See [`Residual::inputs`].
    fn inputs(&self) -> Inputs;

    /// See [`Residual::rows`].
    fn rows(&self) -> Vec<RowBlock>;

    /// Writes every row of `residual`, as [`Residual::evaluate`] does.
    fn evaluate(&self, frames: &[Placement<f64>], joints: &[f64], residual: &mut [f64]);

    /// Writes the derivatives and returns true, or returns false to use central differences.
    ///
    /// Differences take two evaluations for each joint and twelve for each frame. `jacobian` is zero on entry.
    fn differentiate(
        &self,
        frames: &[Placement<f64>],
        joints: &[f64],
        jacobian: &mut LocalJacobian,
    ) -> bool {
        let _ = (frames, joints, jacobian);
        false
    }

    /// See [`Residual::description`].
    fn description(&self) -> Description {
        Description::default()
    }
}

/// Adapter from a [`NumericResidual`] to a [`Residual`].
///
/// ```
/// use kinopt::model::{FrameId, Limits, Model};
/// use kinopt::spatial::{Placement, Vector3};
/// use kinopt::task::{Inputs, Numeric, NumericResidual, Quantity, RowBlock};
/// use kinopt::{Problem, Solver};
///
/// /// The height above a terrain that is known by samples.
/// #[derive(Clone)]
/// struct OnTerrain { foot: FrameId, heights: [f64; 4] }
///
/// impl NumericResidual for OnTerrain {
///     fn inputs(&self) -> Inputs { Inputs::frames([self.foot]) }
///     fn rows(&self) -> Vec<RowBlock> { vec![RowBlock::new(Quantity::Metres, 1)] }
///     fn evaluate(&self, frames: &[Placement<f64>], _joints: &[f64], residual: &mut [f64]) {
///         let Vector3 { x, z, .. } = frames[0].translation;
///         let at = x.clamp(0.0, 2.99);
///         let (cell, along) = (at as usize, at.fract());
///         let [from, to] = [self.heights[cell], self.heights[cell + 1]];
///         residual[0] = z - (from + along * (to - from));
///     }
/// }
///
/// let mut builder = Model::builder("leg");
/// let y = Vector3::UNITS[1];
/// let (hip, shin) = (Placement::identity(), Placement::translation([1.0, 0.0, 0.0].into()));
/// let hip = builder.revolute("hip", None, hip, y, Limits::new(-2.0, 2.0));
/// let foot = builder.frame("foot", Some(hip), shin);
/// let model = builder.build()?;
///
/// let mut tasks = Problem::builder(&model);
/// tasks.add(Numeric(OnTerrain { foot, heights: [0.0, -0.2, -0.1, 0.3] }));
/// let solution = Solver::default().solve_once(&tasks.build()?, &[0.6])?;
/// assert!(solution.reached, "{}", solution.explain());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Numeric<R>(pub R);

impl<R: NumericResidual> Numeric<R> {
    /// Writes the derivatives, exact or by differences.
    fn derivatives(&self, frames: &[Placement<f64>], joints: &[f64], jacobian: &mut LocalJacobian) {
        if !self.0.differentiate(frames, joints, jacobian) {
            Differences::new(&self.0, frames, joints, jacobian.rows()).write(jacobian);
        }
    }
}

impl<R: NumericResidual> Residual for Numeric<R> {
    const ROLE: Role = R::ROLE;

    fn inputs(&self) -> Inputs {
        self.0.inputs()
    }

    fn rows(&self) -> Vec<RowBlock> {
        self.0.rows()
    }

    /// Evaluates dual numbers to first order. NaN for SIMD lanes, which no problem uses.
    fn evaluate<S: Scalar>(&self, frames: &[Placement<S>], joints: &[S], residual: &mut [S]) {
        let placements: Option<Vec<_>> = frames.iter().map(placement_of).collect();
        let values: Option<Vec<_>> = joints.iter().map(|joint| joint.as_f64()).collect();
        let (Some(placements), Some(values)) = (placements, values) else {
            return residual.fill(S::constant(f64::NAN));
        };
        let mut rows = vec![0.0; residual.len()];
        self.0.evaluate(&placements, &values, &mut rows);
        for (row, &value) in residual.iter_mut().zip(&rows) {
            *row = S::constant(value);
        }
        if TypeId::of::<S>() == TypeId::of::<f64>() {
            return;
        }
        let mut jacobian = LocalJacobian::default();
        jacobian.reset(rows.len(), frames.len(), joints.len());
        self.derivatives(&placements, &values, &mut jacobian);
        for (k, (frame, placement)) in frames.iter().zip(&placements).enumerate() {
            let (velocity, angular_velocity) = motion(frame, placement);
            let (linear, angular) = (jacobian.linear(k), jacobian.angular(k));
            for (row, slope) in residual.iter_mut().zip(linear) {
                *row += Vector3::constant(*slope).dot(velocity);
            }
            for (row, angular_slope) in residual.iter_mut().zip(angular) {
                *row += Vector3::constant(*angular_slope).dot(angular_velocity);
            }
        }
        for (k, (&joint, &value)) in joints.iter().zip(&values).enumerate() {
            let change = joint - S::constant(value);
            for (row, entry) in jacobian.joint(k) {
                residual[row] += S::constant(entry) * change;
            }
        }
    }

    fn differentiate(
        &self,
        frames: &[Placement<f64>],
        joints: &[f64],
        jacobian: &mut LocalJacobian,
    ) -> bool {
        self.derivatives(frames, joints, jacobian);
        true
    }

    fn description(&self) -> Description {
        self.0.description()
    }
}

/// The values of a placement, without derivatives; `None` for SIMD lanes.
fn placement_of<S: Scalar>(frame: &Placement<S>) -> Option<Placement<f64>> {
    let values_of = |v: Vector3<S>| Some(Vector3::new(v.x.as_f64()?, v.y.as_f64()?, v.z.as_f64()?));
    let Matrix3 { x, y, z } = frame.rotation;
    let rotation = Matrix3::from_columns(values_of(x)?, values_of(y)?, values_of(z)?);
    Some(Placement::new(rotation, values_of(frame.translation)?))
}

/// The twist in the derivatives of a frame; the values of the twist are 0.
fn motion<S: Scalar>(frame: &Placement<S>, placement: &Placement<f64>) -> (Vector3<S>, Vector3<S>) {
    let velocity = frame.translation - Vector3::constant(placement.translation);
    let (rotation, start_rotation) = (frame.rotation, placement.rotation);
    // A column c moves by ω × c, and Σ c × (ω × c) = 2 ω.
    let columns = [
        (rotation.x, start_rotation.x),
        (rotation.y, start_rotation.y),
        (rotation.z, start_rotation.z),
    ];
    let angular_terms = columns.map(|(rotation, start_rotation)| {
        let start_rotation = Vector3::constant(start_rotation);
        start_rotation.cross(rotation - start_rotation) * S::constant(0.5)
    });
    (
        velocity,
        angular_terms[0] + angular_terms[1] + angular_terms[2],
    )
}

/// Central differences along every frame's twist and every joint.
struct Differences<'a, R> {
    residual: &'a R,
    frames: Vec<Placement<f64>>,
    joints: Vec<f64>,
    ahead: Vec<f64>,
    behind: Vec<f64>,
}

impl<'a, R: NumericResidual> Differences<'a, R> {
    fn new(residual: &'a R, frames: &[Placement<f64>], joints: &[f64], rows: usize) -> Self {
        Self {
            residual,
            frames: frames.to_vec(),
            joints: joints.to_vec(),
            ahead: vec![0.0; rows],
            behind: vec![0.0; rows],
        }
    }

    fn write(&mut self, jacobian: &mut LocalJacobian) {
        for k in 0..self.frames.len() {
            let start = self.frames[k];
            let distance = start.translation.to_array();
            let distance = distance
                .into_iter()
                .fold(1.0, |max: f64, x| max.max(x.abs()));
            for (axis, unit) in Vector3::UNITS.into_iter().enumerate() {
                let slope = self.slope(step(distance), |differences, step| {
                    differences.frames[k].translation = start.translation + unit * step;
                });
                for (row, &value) in jacobian.linear_mut(k).iter_mut().zip(slope) {
                    *component(row, axis) = value;
                }
                self.frames[k] = start;
                let slope = self.slope(step(1.0), |differences, step| {
                    differences.frames[k].rotation = rotation_exp(unit * step) * start.rotation;
                });
                for (row, &value) in jacobian.angular_mut(k).iter_mut().zip(slope) {
                    *component(row, axis) = value;
                }
                self.frames[k] = start;
            }
        }
        for k in 0..self.joints.len() {
            let start = self.joints[k];
            let slope = self.slope(step(start.abs().max(1.0)), |differences, step| {
                differences.joints[k] = start + step;
            });
            jacobian.joint_mut(k).copy_from_slice(slope);
            self.joints[k] = start;
        }
    }

    /// The derivative of every row along the motion that `apply` applies.
    fn slope(&mut self, step: f64, apply: impl Fn(&mut Self, f64)) -> &[f64] {
        apply(self, step);
        self.residual
            .evaluate(&self.frames, &self.joints, &mut self.ahead);
        apply(self, -step);
        self.residual
            .evaluate(&self.frames, &self.joints, &mut self.behind);
        for (ahead, behind) in self.ahead.iter_mut().zip(&self.behind) {
            *ahead = (*ahead - behind) / (2.0 * step);
        }
        &self.ahead
    }
}

/// ∛ε times a size, rounded to a power of two, so that steps forth and back are exact.
fn step(size: f64) -> f64 {
    let step = elementary::cbrt(f64::EPSILON) * size;
    f64::from_bits(step.to_bits() & !((1 << 52) - 1))
}

fn component(vector: &mut Vector3<f64>, axis: usize) -> &mut f64 {
    match axis {
        0 => &mut vector.x,
        1 => &mut vector.y,
        _ => &mut vector.z,
    }
}
