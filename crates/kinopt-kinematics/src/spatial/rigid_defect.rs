//! Defects of a placement that is not a rigid motion.

use super::{Placement, Vector3};

/// Defects of a placement that is not a rigid motion: a rotation of determinant +1 and a finite translation.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RigidDefect {
    /// An entry is NaN or infinite.
    #[error(
        "the entry in row {row}, column {column} of its 4 x 4 matrix is {value}, expected a finite number"
    )]
    NotFinite {
        /// Row in the 4 × 4 matrix, from 0.
        row: usize,
        /// Column in the 4 × 4 matrix, from 0; 3 for the position.
        column: usize,
        /// The entry.
        value: f64,
    },
    /// The columns are not of unit length and at right angles.
    #[error(
        "the rotation is not orthonormal: an entry of R^T R differs by {off:.1e} from the identity, at most \
         {tolerance:.1e} is allowed"
    )]
    NotOrthonormal {
        /// Largest absolute entry of RᵀR − I.
        off: f64,
        /// Largest allowed absolute entry of RᵀR − I.
        tolerance: f64,
    },
    /// The determinant is −1.
    #[error("the rotation is a reflection: its determinant is -1, not +1")]
    Mirrors,
}

impl Placement<f64> {
    /// Checks that this is a rigid motion.
    ///
    /// All entries must be finite, each entry of RᵀR within `tolerance` of the identity, and the determinant +1.
    ///
    /// # Errors
    /// Returns the first defect in the order of [`RigidDefect`].
    pub fn check_rigid(&self, tolerance: f64) -> Result<(), RigidDefect> {
        let [x, y, z] = [self.rotation.x, self.rotation.y, self.rotation.z];
        let unit = [x, y, z].map(|column| (column.norm_squared() - 1.0).abs());
        let off = [unit, [x.dot(y), y.dot(z), z.dot(x)].map(f64::abs)];
        // NaN fails this comparison.
        let orthonormal = off.as_flattened().iter().all(|off| *off <= tolerance);
        let translation = self.translation.to_array();
        if orthonormal
            && translation.iter().all(|entry| entry.is_finite())
            && x.cross(y).dot(z) >= 0.0
        {
            return Ok(());
        }
        Err(self.rigid_defect(off.as_flattened(), tolerance))
    }

    /// The defect of a placement that failed the check; `off` holds the absolute entries of RᵀR − I.
    #[cold]
    fn rigid_defect(&self, off: &[f64], tolerance: f64) -> RigidDefect {
        let Self {
            rotation,
            translation,
        } = self;
        let entries = [rotation.x, rotation.y, rotation.z, *translation].map(Vector3::to_array);
        let off = off.iter().copied().fold(0.0, f64::max);
        let mut numbered = entries.as_flattened().iter().enumerate();
        if let Some((index, &value)) = numbered.find(|(_, entry)| !entry.is_finite()) {
            // Three rows a column.
            let (column, row) = (index / 3, index % 3);
            RigidDefect::NotFinite { row, column, value }
        } else if off > tolerance {
            RigidDefect::NotOrthonormal { off, tolerance }
        } else {
            RigidDefect::Mirrors
        }
    }
}
