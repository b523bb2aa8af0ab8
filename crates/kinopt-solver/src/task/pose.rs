//! Pose task for a frame: position and orientation.

use super::bounded::beyond;
use super::goal::PoseBounds;
use super::orientation::check_rotation;
use super::residual::{
    add_base_derivatives, check_base, check_finite, frame_and_base, in_base, rotated,
};
use super::{
    Description, DifferentiableTarget, Extensions, Inequality, InequalityResidual, Inputs,
    LocalJacobian, Orientation, Quantity, Residual, RowBlock,
};
use kinopt_kinematics::model::FrameId;
use kinopt_kinematics::scalar::Scalar;
use kinopt_kinematics::spatial::{Matrix3, Placement, Quaternion, Vector3, rotation_log_jacobian};

/// r = (x − x_target, log(R R_targetᵀ)): three rows in metres, then three of a rotation vector in radians.
///
/// The rows are in world axes, or in those of the [base](Self::relative_to). With a [`PoseBounds`] they are in the
/// target's axes: r = (R_targetᵀ (x − x_target), log(R_targetᵀ R)), each beyond its bounds. If a component is bounded
/// or free, `2 v` replaces the logarithm. Here v is the vector part of the quaternion, so `2 v = 2 sin(θ/2) n`.
///
/// ```
/// # use kinopt::model::{Limits, Model};
/// # use kinopt::spatial::{Placement, Vector3};
/// # use kinopt::task::{Axis, PoseBounds, FramePose};
/// # use kinopt::{Problem, Solver};
/// # let mut builder = Model::builder("wrist");
/// # let (mut joint, at) = (None, Placement::translation([0.0, 0.0, 0.3].into()));
/// # for (k, axis) in Vector3::UNITS.into_iter().chain(Vector3::UNITS).enumerate() {
/// #     joint = Some(builder.revolute(format!("{k}"), joint, at, axis, Limits::new(-3.0, 3.0)));
/// # }
/// # let flange = builder.frame("flange", joint, at);
/// # let model = builder.build()?;
/// // The tip of a drill, 12 cm in front of the flange, which may spin about its axis.
/// let drill = Placement::translation([0.0, 0.0, 0.12].into());
/// let hole = Placement::translation([0.4, 0.3, 1.4].into());
/// let drilling = FramePose::new(flange, hole)
///     .with_tool(drill)
///     .with_goal(PoseBounds::free_about(Axis::Z));
/// let mut tasks = Problem::builder(&model);
/// tasks.add(drilling);
/// let solution = Solver::default().solve_once(&tasks.build()?, &[0.1; 6])?;
/// assert!(solution.reached, "{}", solution.explain());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FramePose {
    frame: FrameId,
    base: Option<FrameId>,
    frame_from_tool: Option<Placement<f64>>,
    goal: Option<PoseBounds>,
    target: Placement<f64>,
}

impl FramePose {
    /// A task that moves the frame to the pose `target` (world_from_frame).
    #[must_use]
    pub fn new(frame: FrameId, target: impl Into<Placement<f64>>) -> Self {
        Self {
            frame,
            base: None,
            frame_from_tool: None,
            goal: None,
            target: target.into(),
        }
    }

    /// Gives the target in the coordinates of `base`, which may move with the joints (base_from_frame).
    #[must_use]
    pub fn relative_to(mut self, base: FrameId) -> Self {
        self.base = Some(base);
        self
    }

    /// Sets the tool on the frame that the target applies to: `frame_from_tool`, metres. The frame itself by
    /// default.
    #[must_use]
    pub fn with_tool(mut self, frame_from_tool: impl Into<Placement<f64>>) -> Self {
        self.frame_from_tool = Some(frame_from_tool.into());
        self
    }

    /// Sets the bounds on the components of the pose.
    #[must_use]
    pub fn with_goal(mut self, goal: PoseBounds) -> Self {
        self.goal = Some(goal);
        self
    }

    /// The target pose of the frame, or of its tool (world_from_frame or base_from_frame).
    #[must_use]
    pub fn target(&self) -> Placement<f64> {
        self.target
    }

    /// The bounds on the components, if they were set.
    #[must_use]
    pub fn goal(&self) -> Option<PoseBounds> {
        self.goal
    }

    /// The frame of the target's coordinates; `None` for the world.
    #[must_use]
    pub fn base(&self) -> Option<FrameId> {
        self.base
    }

    /// Sets the target.
    pub fn set_target(&mut self, target: impl Into<Placement<f64>>) {
        self.target = target.into();
    }

    /// Placement of the tool on the frame.
    #[must_use]
    pub fn frame_from_tool(&self) -> Placement<f64> {
        self.frame_from_tool.unwrap_or_else(Placement::identity)
    }

    /// The row blocks of this task.
    #[doc(hidden)]
    pub fn row_blocks(&self) -> [RowBlock; 2] {
        let orientation = match self.goal {
            Some(goal) if !goal.is_full_pose() => RowBlock::chords(3),
            _ => RowBlock::new(Quantity::Radians, 3),
        };
        [RowBlock::new(Quantity::Metres, 3), orientation]
    }

    /// Placement of the tool, in the base or the world.
    fn base_from_tool<S: Scalar>(&self, frames: &[Placement<S>]) -> Placement<S> {
        let base_from_frame = in_base(frames);
        match &self.frame_from_tool {
            Some(tool) => base_from_frame * Placement::constant(tool),
            None => base_from_frame,
        }
    }

    /// The rotation from the target's axes to the tool's.
    fn relative_rotation<S: Scalar>(target: &Placement<S>, rotation: Matrix3<S>) -> Quaternion<S> {
        Quaternion::from_matrix(&(target.rotation.transpose() * rotation))
    }

    /// The position of the tool relative to the target, in the target's axes.
    fn offset<S: Scalar>(target: &Placement<S>, placement: &Placement<S>) -> Vector3<S> {
        target.rotation.transpose() * (placement.translation - target.translation)
    }

    /// The target moved along and about its axes by a step of six numbers; unchanged by an empty step.
    fn moved_target<S: Scalar>(&self, step: &[S]) -> Placement<S> {
        let mut target = Placement::constant(&self.target);
        if let [x, y, z, rotation_step @ ..] = step {
            target.translation += target.rotation * Vector3::new(*x, *y, *z);
            target.rotation = rotated(self.target.rotation, rotation_step);
        }
        target
    }

    /// Writes the derivatives with pose bounds, first in the target's axes.
    ///
    /// There the derivative of the rotation vector φ by the angular velocity is J_l⁻¹(φ) (Chirikjian 2012, eq. 10.86,
    /// see [`rotation_log_jacobian`]). That of twice a quaternion's vector part is `w − [v]` (from q' = ½ ω q).
    fn differentiate_goal(
        &self,
        goal: &PoseBounds,
        placement: &Placement<f64>,
        lever: Option<Vector3<f64>>,
        jacobian: &mut LocalJacobian,
    ) {
        let target = &self.target.rotation;
        let quaternion = Self::relative_rotation(&self.target, placement.rotation);
        // Columns, one for each axis of the target.
        let slope_by_rotation = if goal.is_full_pose() {
            rotation_log_jacobian(quaternion.log())
        } else {
            let column = |unit: Vector3<f64>| unit * quaternion.w + unit.cross(quaternion.v);
            let [x, y, z] = Vector3::UNITS.map(column);
            Matrix3::from_columns(x, y, z)
        };
        // The angular velocity ω of the world is targetᵀ ω in the target's axes. The rows of slope_by_rotation ·
        // targetᵀ are the columns of its transpose.
        let rows_in_world = *target * slope_by_rotation.transpose();
        let bands = goal.bands();
        let offset = Self::offset(&self.target, placement).to_array();
        let rotation = (quaternion.v * 2.0).to_array();
        let is_outside = |value: f64, band: f64| band == 0.0 || value.abs() > band;
        for (k, axis) in [target.x, target.y, target.z].into_iter().enumerate() {
            if is_outside(offset[k], bands[k]) {
                jacobian.linear_mut(0)[k] = axis;
                if let Some(lever) = lever {
                    jacobian.angular_mut(0)[k] = lever.cross(axis);
                }
            }
        }
        let rows = [rows_in_world.x, rows_in_world.y, rows_in_world.z];
        for (k, row) in rows.into_iter().enumerate() {
            if is_outside(rotation[k], bands[3 + k]) {
                jacobian.angular_mut(0)[3 + k] = row;
            }
        }
    }
}

impl Residual for FramePose {
    const EXTENSIONS: Extensions<Self> = Extensions::NONE.with_inequalities().with_target();

    fn inputs(&self) -> Inputs {
        Inputs::frames(frame_and_base(self.frame, self.base))
    }

    fn rows(&self) -> Vec<RowBlock> {
        self.row_blocks().to_vec()
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
        let placement = self.base_from_tool(frames);
        let tool = self.frame_from_tool.map(|tool| tool.translation);
        let lever = tool.map(|tool| in_base(frames).rotation * tool);
        if let Some(goal) = &self.goal {
            self.differentiate_goal(goal, &placement, lever, jacobian);
            add_base_derivatives(frames, jacobian);
            return true;
        }
        jacobian.set_point(0, lever, 1.0);
        Orientation::differentiate_error(self.target.rotation, placement.rotation, 3, jacobian);
        add_base_derivatives(frames, jacobian);
        true
    }

    fn description(&self) -> Description {
        Description::new("pose").with_validity(self.validate())
    }
}

impl FramePose {
    /// Returns the first defect of the parameters.
    fn validate(&self) -> Result<(), String> {
        check_base(self.frame, self.base)?;
        check_finite("its target", self.target.translation.to_array())?;
        check_rotation("its target is", &self.target.rotation)?;
        if let Some(tool) = &self.frame_from_tool {
            check_finite("its tool", tool.translation.to_array())?;
            check_rotation("its tool has", &tool.rotation)?;
        }
        let Some(goal) = &self.goal else {
            return Ok(());
        };
        match goal.invalid_half_width() {
            Some((component, value)) => Err(format!(
                "its half width for {component} is {value}, which is no number of at least 0"
            )),
            None if !goal.has_position() && !goal.has_orientation() => {
                Err("its goal leaves every component free".to_owned())
            }
            None => Ok(()),
        }
    }
}

impl InequalityResidual for FramePose {
    /// One inequality for each bounded component.
    fn inequalities(&self) -> Vec<Inequality> {
        let bands = self.goal.map(|goal| goal.bands()).unwrap_or_default();
        let rows = (0..6).filter(|&row| 0.0 < bands[row] && bands[row] < f64::INFINITY);
        rows.map(|row| Inequality::new(row..row + 1, 2)).collect()
    }

    fn slacks<S: Scalar>(&self, frames: &[Placement<S>], _joints: &[S], slacks: &mut [S]) {
        let Some(goal) = &self.goal else { return };
        let placement = self.base_from_tool(frames);
        let target = Placement::constant(&self.target);
        let rotation = Self::relative_rotation(&target, placement.rotation);
        // Of q and −q take the smaller rotation, so that the two bounds do not swap.
        let two = S::constant(2.0);
        let double_sign = S::select(rotation.w.less_than(S::zero()), -two, two);
        let components =
            [Self::offset(&target, &placement), rotation.v * double_sign].map(Vector3::to_array);
        let components = components.into_iter().flatten().zip(goal.bands());
        let bounded = components.filter(|(_, band)| 0.0 < *band && *band < f64::INFINITY);
        for (component_slacks, (value, band)) in slacks.chunks_exact_mut(2).zip(bounded) {
            component_slacks[0] = S::constant(band) + value;
            component_slacks[1] = S::constant(band) - value;
        }
    }
}

impl DifferentiableTarget for FramePose {
    fn target_len(&self) -> usize {
        6
    }

    fn evaluate_moved<S: Scalar>(
        &self,
        frames: &[Placement<S>],
        _joints: &[S],
        step: &[S],
        residual: &mut [S],
    ) {
        let placement = self.base_from_tool(frames);
        let target = self.moved_target(step);
        if let Some(goal) = &self.goal {
            let quaternion = Self::relative_rotation(&target, placement.rotation);
            let rotation = if goal.is_full_pose() {
                quaternion.log()
            } else {
                // Both q and −q are valid: rows of opposite sign cost the same.
                quaternion.v * S::constant(2.0)
            };
            let components = [Self::offset(&target, &placement), rotation].map(Vector3::to_array);
            let components = components.into_iter().flatten().zip(goal.bands());
            for (row, (value, band)) in residual.iter_mut().zip(components) {
                *row = match band {
                    0.0 => value,
                    f64::INFINITY => S::zero(),
                    _ => beyond(value, -band, band),
                };
            }
            return;
        }
        let position_error = placement.translation - target.translation;
        let rotation = Orientation::error_from(target.rotation, placement.rotation);
        let (position, orientation) = residual.split_at_mut(3);
        position.copy_from_slice(&position_error.to_array());
        orientation.copy_from_slice(&rotation);
    }

    fn add_target_slopes(
        &self,
        frames: &[Placement<f64>],
        _joints: &[f64],
        coefficients: &[f64],
        slopes: &mut [f64],
    ) -> bool {
        let (&[x, y, z, rx, ry, rz], None) = (coefficients, &self.goal) else {
            return false;
        };
        let target = self.target.rotation;
        let position_slopes = target.transpose_mul(Vector3::new(x, y, z)).to_array();
        for (slope, position_slope) in slopes.iter_mut().zip(position_slopes) {
            *slope -= position_slope;
        }
        let (rotation, rotation_slopes) = (in_base(frames).rotation, slopes.get_mut(3..));
        let rotation = match &self.frame_from_tool {
            Some(tool) => rotation * tool.rotation,
            None => rotation,
        };
        let rotation_slopes = rotation_slopes.unwrap_or_default();
        Orientation::add_target_rotation_slopes(
            target,
            rotation,
            Vector3::new(rx, ry, rz),
            rotation_slopes,
        );
        true
    }

    fn has_edges(&self) -> bool {
        self.goal
            .is_some_and(|goal| goal.bands().iter().any(|band| *band != 0.0))
    }
}
