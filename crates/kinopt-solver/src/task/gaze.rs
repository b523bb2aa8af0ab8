//! Cone task for an axis of a frame.

use std::f64::consts::PI;

use super::bounded::beyond;
use super::look_at::{line_of_sight, rotation_onto};
use super::residual::{check_direction, check_finite, error_if, moved};
use super::{
    Description, DifferentiableTarget, Extensions, Inequality, InequalityResidual, Inputs,
    Quantity, Residual, RowBlock,
};
use kinopt_kinematics::model::FrameId;
use kinopt_kinematics::scalar::Scalar;
use kinopt_kinematics::spatial::{Placement, Vector3};

/// r = max(0, θ − α): the angle of a frame's axis outside a cone. One row in radians, zero inside the cone.
///
/// The cone has the half angle α about a direction or a line of sight; θ is the angle of the axis from it. A
/// [`LookAt`](super::LookAt) is the same with α = 0.
///
/// ```
/// # use kinopt::model::{Limits, Model};
/// # use kinopt::spatial::{Placement, Vector3};
/// # use kinopt::task::Gaze;
/// # use kinopt::{Problem, Solver};
/// # let mut builder = Model::builder("neck");
/// # let y = Vector3::UNITS[1];
/// # let neck = builder.revolute("neck", None, Placement::identity(), y, Limits::new(-1.0, 1.0));
/// # let cup = builder.frame("cup", Some(neck), Placement::identity());
/// # let model = builder.build()?;
/// // A cup may tip by a tenth of a radian.
/// let up = [0.0, 0.0, 1.0];
/// let mut tasks = Problem::builder(&model);
/// tasks.add(Gaze::along(cup, up, up, 0.1));
/// let solution = Solver::default().solve_once(&tasks.build()?, &[0.7])?;
/// assert!(solution.reached && (solution.q[0] - 0.1).abs() < 1e-5);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gaze {
    frame: FrameId,
    axis: Vector3<f64>,
    cone_axis: ConeAxis,
    half_angle: f64,
}

/// The axis of the cone, in the world.
#[derive(Clone, Copy, Debug, PartialEq)]
enum ConeAxis {
    Along(Vector3<f64>),
    At(Vector3<f64>),
}

impl Gaze {
    /// A task that keeps `axis` within `half_angle` of `direction`.
    ///
    /// `axis` is in frame coordinates, `direction` in world coordinates; both have any length except zero. `half_angle`
    /// is in radians, within (0, π).
    #[must_use]
    pub fn along(
        frame: FrameId,
        axis: impl Into<Vector3<f64>>,
        direction: impl Into<Vector3<f64>>,
        half_angle: f64,
    ) -> Self {
        Self {
            frame,
            axis: axis.into(),
            cone_axis: ConeAxis::Along(direction.into()),
            half_angle,
        }
    }

    /// A task that keeps `axis` within `half_angle` of the line of sight from the frame's origin to `target`.
    ///
    /// It models a camera's field of view. `axis` is in frame coordinates, of any length except zero. `target` is in
    /// the world, metres. `half_angle` is in radians, within (0, π).
    #[must_use]
    pub fn at(
        frame: FrameId,
        axis: impl Into<Vector3<f64>>,
        target: impl Into<Vector3<f64>>,
        half_angle: f64,
    ) -> Self {
        Self {
            frame,
            axis: axis.into(),
            cone_axis: ConeAxis::At(target.into()),
            half_angle,
        }
    }

    /// θ².
    fn squared_angle<S: Scalar>(&self, frames: &[Placement<S>], step: &[S]) -> S {
        let axis = frames[0].rotation * Vector3::constant(self.axis * (1.0 / self.axis.norm()));
        let cone_direction = match self.cone_axis {
            ConeAxis::Along(direction) if step.is_empty() => {
                Vector3::constant(direction * (1.0 / direction.norm()))
            }
            ConeAxis::Along(direction) => {
                let direction = moved(direction, step);
                direction * (S::one() / direction.norm())
            }
            ConeAxis::At(target) => line_of_sight(&frames[0], axis, moved(target, step)),
        };
        rotation_onto(axis, cone_direction).norm_squared()
    }

    /// Sets the target point, or the direction.
    pub fn set_target(&mut self, target: impl Into<Vector3<f64>>) {
        self.cone_axis = match self.cone_axis {
            ConeAxis::Along(_) => ConeAxis::Along(target.into()),
            ConeAxis::At(_) => ConeAxis::At(target.into()),
        };
    }
}

impl Residual for Gaze {
    const EXTENSIONS: Extensions<Self> = Extensions::NONE.with_inequalities().with_target();

    fn inputs(&self) -> Inputs {
        Inputs::frames([self.frame])
    }

    fn rows(&self) -> Vec<RowBlock> {
        vec![RowBlock::new(Quantity::Radians, 1)]
    }

    fn evaluate<S: Scalar>(&self, frames: &[Placement<S>], joints: &[S], residual: &mut [S]) {
        self.evaluate_moved(frames, joints, &[], residual);
    }

    fn description(&self) -> Description {
        Description::new("gaze").with_validity(self.validate())
    }
}

impl Gaze {
    /// Returns the first defect of the parameters.
    fn validate(&self) -> Result<(), String> {
        let (ConeAxis::Along(aim) | ConeAxis::At(aim)) = self.cone_axis;
        check_finite("its target", aim.to_array())?;
        check_direction("its axis", self.axis)?;
        if let ConeAxis::Along(direction) = self.cone_axis {
            error_if(direction.norm() <= 0.0, || {
                "its direction has no length".to_owned()
            })?;
        }
        let half_angle = self.half_angle;
        error_if(!(half_angle > 0.0 && half_angle < PI), || {
            format!("its half angle {half_angle} rad is not within 0 and π")
        })
    }
}

impl InequalityResidual for Gaze {
    fn inequalities(&self) -> Vec<Inequality> {
        vec![Inequality::new(0..1, 1)]
    }

    /// (α² − θ²) / 2α: unlike α − θ, it has a derivative at θ = 0.
    fn slacks<S: Scalar>(&self, frames: &[Placement<S>], _joints: &[S], slacks: &mut [S]) {
        let half_angle = S::constant(self.half_angle);
        let squared = self.squared_angle(frames, &[]);
        slacks[0] = (half_angle * half_angle - squared) / (half_angle + half_angle);
    }
}

impl DifferentiableTarget for Gaze {
    fn target_len(&self) -> usize {
        3
    }

    fn evaluate_moved<S: Scalar>(
        &self,
        frames: &[Placement<S>],
        _joints: &[S],
        step: &[S],
        residual: &mut [S],
    ) {
        let squared = self.squared_angle(frames, step);
        // Well inside the cone, to avoid θ = 0, at which θ has no derivative.
        let is_inside = squared.less_than(S::constant(0.25 * self.half_angle * self.half_angle));
        let angle = S::select(is_inside, S::one(), squared).sqrt();
        let excess = beyond(angle, f64::NEG_INFINITY, self.half_angle);
        residual[0] = S::select(is_inside, S::zero(), excess);
    }
}
