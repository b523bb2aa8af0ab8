//! Jacobians of frames: six rows for each frame, a column for each degree of freedom.

use nalgebra::{DMatrix, Matrix6xX};

use super::forward_kinematics::ReadConfiguration;
use super::{ForwardKinematics, KinematicsError, Partials};
use crate::model::{FrameId, Model};
use crate::spatial::{Matrix3, Placement, Vector3, rotation_exp, rotation_log_jacobian};

const ZERO: Vector3<f64> = Vector3 {
    x: 0.0,
    y: 0.0,
    z: 0.0,
};

/// The Jacobian of frames of one model, with its own workspace. After construction it allocates nothing.
///
/// Rows 6k to 6k + 5 belong to frame k: the velocity of its origin (m/s), then its angular velocity (rad/s). Both are
/// in world axes, for a unit rate of each degree of freedom. It is Pinocchio's `LOCAL_WORLD_ALIGNED`.
///
/// Column j is (z × (x − p), z) for a revolute joint with world axis z through p and a frame at x. It is (z, 0) for a
/// prismatic joint, and 0 for a joint that does not carry the frame (Siciliano et al. 2009, "Robotics", eq. 3.30). A
/// ball joint has three columns, for rotation about its rotated axes. A free joint has six, for translation along and
/// rotation about its moved axes. These are the velocities of [`Model::integrate`].
#[derive(Clone, Debug)]
pub struct Jacobian {
    kinematics: ForwardKinematics,
    matrix: DMatrix<f64>,
}

impl Jacobian {
    /// A Jacobian of the frames, configurations or variables of compiled kinematics.
    #[must_use]
    pub fn new(kinematics: ForwardKinematics) -> Self {
        let rows = 6 * kinematics.placements().len();
        Self {
            matrix: DMatrix::zeros(rows, kinematics.parts().0.variables()),
            kinematics,
        }
    }

    /// Number of values that [`at`](Self::at) reads.
    #[must_use]
    pub fn variables(&self) -> usize {
        self.kinematics.variables()
    }

    /// Number of columns of J: the degrees of freedom of a model, or the variables of a map.
    #[must_use]
    pub fn columns(&self) -> usize {
        self.matrix.ncols()
    }

    /// The placements of the frames at the last [`at`](Self::at); identities before the first.
    #[must_use]
    pub fn placements(&self) -> &[Placement<f64>] {
        self.kinematics.placements()
    }

    /// J at a configuration (radians and metres), with 6 × frames rows.
    ///
    /// It has a column for each degree of freedom, or for each variable if the kinematics are
    /// [under](ForwardKinematics::under) a parameter map.
    ///
    /// # Errors
    /// Returns the errors of [`ForwardKinematics::place`].
    pub fn at(&mut self, q: &[f64]) -> Result<&DMatrix<f64>, KinematicsError> {
        self.kinematics.place(q)?;
        self.matrix.fill(0.0);
        let (tree, state) = self.kinematics.parts();
        let [x, y, z] = Vector3::UNITS;
        let (linear, angular) = ([x, y, z, ZERO, ZERO, ZERO], [ZERO, ZERO, ZERO, x, y, z]);
        for frame in 0..state.frames().len() {
            let partials = Partials {
                frame,
                first_row: 6 * frame,
                linear: &linear,
                angular: &angular,
            };
            tree.add_geometric_jacobian(state, &partials, &mut self.matrix);
        }
        if let Some(read) = self.kinematics.read() {
            to_velocity_columns(read, &mut self.matrix);
        }
        Ok(&self.matrix)
    }
}

/// Converts columns by rates of rotation vectors and positions to columns by velocities in moved axes.
pub(super) fn to_velocity_columns(read: &ReadConfiguration<f64>, matrix: &mut DMatrix<f64>) {
    for (ball, &is_free) in read.map.balls().iter().zip(&read.is_free) {
        let Some([x, y, z]) = ball.of(&read.x) else {
            continue;
        };
        let rotation_vector = Vector3::new(x, y, z);
        // ω = J_r(x) ẋ in rotated axes, and J_r(x) = J_l(−x).
        multiply(
            matrix,
            ball.variable,
            rotation_log_jacobian(-rotation_vector),
        );
        if is_free {
            multiply(matrix, ball.variable - 3, rotation_exp(rotation_vector));
        }
    }
}

/// Multiplies the three columns from `first` on by a matrix from the right.
fn multiply(matrix: &mut DMatrix<f64>, first: usize, factor: Matrix3<f64>) {
    for mut row in matrix.row_iter_mut() {
        let old_row = Vector3::new(row[first], row[first + 1], row[first + 2]);
        for (k, column) in [factor.x, factor.y, factor.z].into_iter().enumerate() {
            row[first + k] = old_row.dot(column);
        }
    }
}

/// The Jacobian of one frame at a configuration `q` (radians and metres), with a column for each degree of freedom.
///
/// Linear rows come first, then angular rows, in world axes at the frame's origin. [`Jacobian`] avoids compiling and
/// allocating on each call, and takes several frames.
///
/// ```
/// use kinopt::kinematics::frame_jacobian;
/// use kinopt::model::{Limits, Model};
/// use kinopt::nalgebra::{Translation3, Vector3, vector};
///
/// let mut builder = Model::builder("two links");
/// let (base, link) = (Translation3::identity(), Translation3::new(1.0, 0.0, 0.0));
/// let free = Limits::UNBOUNDED;
/// let shoulder = builder.revolute("shoulder", None, base, Vector3::z(), free);
/// let elbow = builder.revolute("elbow", Some(shoulder), link, Vector3::z(), free);
/// let tip = builder.frame("tip", Some(elbow), link);
/// let model = builder.build()?;
///
/// // Stretched along x, the tip moves along y: 2 m/s by the shoulder, 1 m/s by the elbow.
/// let jacobian = frame_jacobian(&model, tip, &[0.0, 0.0])?;
/// assert_eq!(jacobian.column(0), vector![0.0, 2.0, 0.0, 0.0, 0.0, 1.0]);
/// assert_eq!(jacobian.column(1), vector![0.0, 1.0, 0.0, 0.0, 0.0, 1.0]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// Returns an error for a frame id that is not in the model, a wrong number of coordinates, or a coordinate that is not
/// finite.
pub fn frame_jacobian(
    model: &Model,
    frame: FrameId,
    q: &[f64],
) -> Result<Matrix6xX<f64>, KinematicsError> {
    let mut jacobian = Jacobian::new(ForwardKinematics::of_frames(model, &[frame])?);
    Ok(Matrix6xX::from_column_slice(jacobian.at(q)?.as_slice()))
}
