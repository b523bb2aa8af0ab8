//! Centre of mass and its Jacobian.

use nalgebra::{DMatrix, Matrix3xX};

use super::jacobian::to_velocity_columns;
use super::{ForwardKinematics, KinematicsError, Wrench, Wrenches};
use crate::model::{Masses, Model};
use crate::spatial::Vector3;

/// The centre of mass Σ mᵢ pᵢ / Σ mᵢ at a configuration `q` (radians and metres), in the world, metres.
///
/// # Errors
/// Returns an error for masses on frames that are not in the model, a wrong number of coordinates, or a coordinate that
/// is not finite.
pub fn centre_of_mass(
    model: &Model,
    masses: &Masses,
    q: &[f64],
) -> Result<Vector3<f64>, KinematicsError> {
    let mut kinematics = ForwardKinematics::of_frames(model, &masses.frames())?;
    let placements = kinematics.place(q)?.iter().zip(masses.shares());
    Ok(
        placements.fold(Vector3::zero(), |sum, (placement, (share, position))| {
            sum + placement.apply(position) * share
        }),
    )
}

/// The Jacobian of the centre of mass: its velocity in world axes, m/s, for a unit rate of each degree of freedom.
///
/// It has 3 rows and a column for each degree of freedom, in the velocities of [`Model::integrate`], as in
/// [`Jacobian`](super::Jacobian). Each row takes one sweep from the tips to the root. Source of the columns: Sugihara &
/// Nakamura 2002, "Whole-body cooperative balancing of humanoid robot using COG Jacobian".
///
/// # Errors
/// Returns the errors of [`centre_of_mass`].
pub fn centre_of_mass_jacobian(
    model: &Model,
    masses: &Masses,
    q: &[f64],
) -> Result<Matrix3xX<f64>, KinematicsError> {
    let mut kinematics = ForwardKinematics::of_frames(model, &masses.frames())?;
    kinematics.place(q)?;
    let (tree, state) = kinematics.parts();
    let mut matrix = DMatrix::zeros(3, tree.variables());
    let mut wrenches = Wrenches::new(tree);
    for (row, axis) in Vector3::UNITS.into_iter().enumerate() {
        wrenches.clear();
        for (slot, (share, position)) in masses.shares().enumerate() {
            let force = axis * share;
            let lever = state.frames()[slot].rotation * position;
            let moment = lever.cross(force);
            tree.push(state, slot, Wrench { force, moment }, &mut wrenches);
        }
        tree.sweep_by(state, &mut wrenches, |variable, share| {
            matrix[(row, variable)] += share;
        });
    }
    if let Some(read) = kinematics.read() {
        to_velocity_columns(read, &mut matrix);
    }
    Ok(Matrix3xX::from_column_slice(matrix.as_slice()))
}
