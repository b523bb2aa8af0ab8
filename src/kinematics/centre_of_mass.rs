//! Where the centre of a body's masses is, and how it moves.

use nalgebra::{DMatrix, Matrix3xX};

use super::jacobian::by_velocity;
use super::{ForwardKinematics, KinematicsError, Wrench, Wrenches};
use crate::model::{MassError, Masses, Model};
use crate::spatial::Vector3;

/// Why a body's centre of mass is not known.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CentreOfMassError {
    /// It has no masses, or bad ones.
    #[error(transparent)]
    Mass(#[from] MassError),
    /// The configuration is none of its model's.
    #[error(transparent)]
    Kinematics(#[from] KinematicsError),
}

/// The centre of mass Σ mᵢ pᵢ / Σ mᵢ at a configuration `q` (radians and metres), in the world, metres.
///
/// # Errors
/// Masses on frames that the model does not have, a wrong number of numbers, or one that is not finite.
pub fn centre_of_mass(
    model: &Model,
    masses: &Masses,
    q: &[f64],
) -> Result<Vector3<f64>, KinematicsError> {
    let mut kinematics = ForwardKinematics::of_frames(model, &masses.frames())?;
    let placements = kinematics.place(q)?.iter().zip(masses.shares());
    Ok(
        placements.fold(Vector3::zero(), |sum, (placed, (share, at))| {
            sum + placed.apply(at) * share
        }),
    )
}

/// The Jacobian of the centre of mass: its velocity in world axes, m/s, for a rate of 1 of each degree of
/// freedom; 3 rows, a column a degree of freedom, in the velocities of [`Model::integrate`] as those of
/// [`Jacobian`](super::Jacobian).
///
/// Found by one sweep from the tips to the root for each row (Sugihara & Nakamura 2002, "Whole-body cooperative
/// balancing of humanoid robot using COG Jacobian", has the columns).
///
/// # Errors
/// As [`centre_of_mass`].
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
        for (slot, (share, at)) in masses.shares().enumerate() {
            let force = axis * share;
            let lever = state.frames()[slot].rotation * at;
            let moment = lever.cross(force);
            tree.push(state, slot, Wrench { force, moment }, &mut wrenches);
        }
        tree.sweep_by(state, &mut wrenches, |variable, share| {
            matrix[(row, variable)] += share;
        });
    }
    if let Some(read) = kinematics.read() {
        by_velocity(read, &mut matrix);
    }
    Ok(Matrix3xX::from_column_slice(matrix.as_slice()))
}
