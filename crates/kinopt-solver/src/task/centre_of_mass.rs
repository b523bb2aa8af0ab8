//! Position task for the centre of mass.

use super::goal::Axis;
use super::residual::{check_finite, moved};
use super::{
    Description, DifferentiableTarget, Extensions, Inputs, LocalJacobian, Quantity, Residual,
    RowBlock,
};
use kinopt_kinematics::model::{FrameId, Masses};
use kinopt_kinematics::scalar::Scalar;
use kinopt_kinematics::spatial::{Placement, Vector3};

/// r = c − target, with c = Σ mᵢ pᵢ / Σ mᵢ.
///
/// One row in metres for each constrained axis of the world or of the [base](Self::relative_to).
///
/// ```
/// # use kinopt::model::{Limits, Masses, Model, PointMass};
/// # use kinopt::spatial::{Placement, Vector3};
/// # use kinopt::task::{Axis, CentreOfMass, Point};
/// # use kinopt::{Problem, Solver};
/// # let mut builder = Model::builder("crane");
/// # let (y, still) = (Vector3::UNITS[1], Placement::identity());
/// # let link = Placement::translation([0.0, 0.0, 1.0].into());
/// # let turns = Limits::new(-2.0, 2.0);
/// # let ankle = builder.revolute("ankle", None, still, y, turns);
/// # let hip = builder.revolute("hip", Some(ankle), link, y, turns);
/// # let elbow = builder.revolute("elbow", Some(hip), link, y, turns);
/// # let waist = builder.frame("waist", Some(ankle), link);
/// # let hand = builder.frame("hand", Some(elbow), link);
/// # let model = builder.build()?;
/// let body = [(waist, 3.0), (hand, 1.0)];
/// let body = body.map(|(frame, mass)| PointMass { frame, at: Vector3::zero(), mass });
/// let masses = Masses::new(&model, body)?;
/// let mut tasks = Problem::builder(&model);
/// tasks.add(Point::new(hand, [1.0, 0.0, 1.6]));
/// // Above a point of the floor, at any height.
/// tasks.add(CentreOfMass::new(&masses, [0.17, 0.0, 0.0]).free_along(Axis::Z));
/// let solution = Solver::default().solve_once(&tasks.build()?, &[0.1, 0.2, 0.3])?;
/// assert!(solution.reached, "{}", solution.explain());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct CentreOfMass {
    body: Body,
    target: Vector3<f64>,
    is_constrained: [bool; 3],
    base: Option<FrameId>,
}

/// Frames with their fractions of the total mass.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Body {
    pub(super) frames: Vec<FrameId>,
    /// For each frame, its fraction of the total mass and the position of the mass in the frame, metres.
    mass_fractions: Vec<(f64, Vector3<f64>)>,
}

impl CentreOfMass {
    /// A task that moves the centre of these masses to `target`, metres in the world.
    #[must_use]
    pub fn new(masses: &Masses, target: impl Into<Vector3<f64>>) -> Self {
        Self {
            body: Body::of(masses),
            target: target.into(),
            is_constrained: [true; 3],
            base: None,
        }
    }

    /// Leaves the position along an axis free; with z free, only the point below the centre counts.
    #[must_use]
    pub fn free_along(mut self, axis: Axis) -> Self {
        self.is_constrained[axis as usize] = false;
        self
    }

    /// Gives the target and the axes in the coordinates of `base`, which may move with the joints.
    #[must_use]
    pub fn relative_to(mut self, base: FrameId) -> Self {
        self.base = Some(base);
        self
    }

    /// The target in the world or in the base, metres.
    #[must_use]
    pub fn target(&self) -> Vector3<f64> {
        self.target
    }

    /// The frame of the target's coordinates; `None` for the world.
    #[must_use]
    pub fn base(&self) -> Option<FrameId> {
        self.base
    }

    /// Sets the target.
    pub fn set_target(&mut self, target: impl Into<Vector3<f64>>) {
        self.target = target.into();
    }

    /// The indices of the constrained axes.
    fn axes(&self) -> impl Iterator<Item = usize> + '_ {
        (0..3).filter(|&axis| self.is_constrained[axis])
    }
}

impl Body {
    pub(super) fn of(masses: &Masses) -> Self {
        Self {
            frames: masses.frames(),
            mass_fractions: masses.shares().collect(),
        }
    }

    /// The centre of mass, from the first frames of a list.
    pub(super) fn centre<S: Scalar>(&self, frames: &[Placement<S>]) -> Vector3<S> {
        let parts = frames.iter().zip(&self.mass_fractions);
        parts.fold(Vector3::zero(), |sum, (frame, (fraction, position))| {
            let position = frame.apply(Vector3::constant(*position));
            position.mul_add(S::constant(*fraction), sum)
        })
    }

    /// Writes the derivatives of rows; row k changes by `slopes[k]` · the velocity of the centre.
    pub(super) fn differentiate(
        &self,
        frames: &[Placement<f64>],
        slopes: &[Vector3<f64>],
        jacobian: &mut LocalJacobian,
    ) {
        for (part, (frame, (fraction, position))) in
            frames.iter().zip(&self.mass_fractions).enumerate()
        {
            let lever = frame.rotation * *position;
            for (row, slope) in jacobian.linear_mut(part).iter_mut().zip(slopes) {
                *row = *slope * *fraction;
            }
            // e · (ω × l) = ω · (l × e)
            for (row, slope) in jacobian.angular_mut(part).iter_mut().zip(slopes) {
                *row = lever.cross(*slope) * *fraction;
            }
        }
    }
}

impl Residual for CentreOfMass {
    const EXTENSIONS: Extensions<Self> = Extensions::NONE.with_target();

    fn inputs(&self) -> Inputs {
        let parts = self.body.frames.iter().copied();
        Inputs::frames(parts.chain(self.base))
    }

    fn rows(&self) -> Vec<RowBlock> {
        vec![RowBlock::new(Quantity::Metres, self.axes().count())]
    }

    fn evaluate<S: Scalar>(&self, frames: &[Placement<S>], joints: &[S], residual: &mut [S]) {
        self.evaluate_moved(frames, joints, &[], residual);
    }

    fn differentiate(
        &self,
        frames: &[Placement<f64>],
        _joints: &[f64],
        jacobian: &mut LocalJacobian,
    ) -> bool {
        let base = frames.last().filter(|_| self.base.is_some());
        let axes = match base {
            Some(Placement { rotation, .. }) => [rotation.x, rotation.y, rotation.z],
            None => Vector3::UNITS,
        };
        let mut slopes = [Vector3::zero(); 3];
        let mut count = 0;
        for (slope, axis) in slopes.iter_mut().zip(self.axes()) {
            *slope = axes[axis];
            count += 1;
        }
        let slopes = &slopes[..count];
        self.body.differentiate(frames, slopes, jacobian);
        if let Some(base) = base {
            let offset = self.body.centre(frames) - base.translation;
            let part = self.body.frames.len();
            for (row, slope) in jacobian.linear_mut(part).iter_mut().zip(slopes) {
                *row = -*slope;
            }
            // In a rotating base, fixed points rotate in the opposite direction.
            for (row, slope) in jacobian.angular_mut(part).iter_mut().zip(slopes) {
                *row = slope.cross(offset);
            }
        }
        true
    }

    fn description(&self) -> Description {
        Description::new("center of mass")
            .of_body()
            .with_validity(self.validate())
    }
}

impl CentreOfMass {
    /// Returns the first defect of the parameters.
    fn validate(&self) -> Result<(), String> {
        match self.is_constrained {
            [false, false, false] => Err("all its axes are free".to_owned()),
            _ => check_finite("its target", self.target.to_array()),
        }
    }
}

impl DifferentiableTarget for CentreOfMass {
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
        let centre = self.body.centre(frames);
        let position = match (self.base, frames.last()) {
            (Some(_), Some(base)) => base.rotation.transpose_mul(centre - base.translation),
            _ => centre,
        };
        let error = (position - moved(self.target, step)).to_array();
        for (row, axis) in residual.iter_mut().zip(self.axes()) {
            *row = error[axis];
        }
    }

    fn has_edges(&self) -> bool {
        false
    }
}
