//! Rest joints of a body model.

use super::SmplError;
use super::arrays::check_length;

/// Joint regressor, template and shape directions of a body model.
///
/// The rest joints are J = R (T + Σ βₖ Sₖ), with the regressor R, the template T and the shape directions S.
#[derive(Clone, Debug, PartialEq)]
pub struct BodyModel {
    joints: usize,
    components: usize,
    /// Joints of the template, and displacements of each joint by shape component.
    template: Vec<[f64; 3]>,
    displacements: Vec<f64>,
}

impl BodyModel {
    /// Creates a model from a joint regressor of shape (joints, vertices), a template of shape (vertices, 3), and shape
    /// directions of shape (vertices, 3, components).
    ///
    /// # Errors
    /// Returns an error for arrays of other lengths.
    pub fn new(regressor: &[f64], template: &[f64], directions: &[f64]) -> Result<Self, SmplError> {
        let vertices = template.len() / 3;
        let joints = regressor.len() / vertices.max(1);
        let components = directions.len() / (3 * vertices).max(1);
        check_length("v_template", template.len(), 3 * vertices.max(1))?;
        check_length("J_regressor", regressor.len(), joints * vertices)?;
        check_length("shapedirs", directions.len(), 3 * vertices * components)?;
        let mut template_joints = vec![[0.0; 3]; joints];
        let mut displacements = vec![0.0; joints * 3 * components];
        for (joint, weights) in regressor.chunks_exact(vertices.max(1)).enumerate() {
            let weights = weights
                .iter()
                .enumerate()
                .filter(|(_, weight)| **weight != 0.0);
            for (vertex, weight) in weights {
                for axis in 0..3 {
                    template_joints[joint][axis] += weight * template[3 * vertex + axis];
                    let from = (3 * vertex + axis) * components;
                    let to = (3 * joint + axis) * components;
                    let direction = &directions[from..from + components];
                    let displacement = &mut displacements[to..to + components];
                    for (displacement, direction) in displacement.iter_mut().zip(direction) {
                        *displacement += weight * direction;
                    }
                }
            }
        }
        Ok(Self {
            joints,
            components,
            template: template_joints,
            displacements,
        })
    }

    /// Number of joints.
    #[must_use]
    pub fn joints(&self) -> usize {
        self.joints
    }

    /// Number of shape components.
    #[must_use]
    pub fn components(&self) -> usize {
        self.components
    }

    /// Rest joints for shape parameters, metres. Parameters beyond the model's components are ignored.
    pub(super) fn rest(&self, betas: &[f64]) -> Vec<[f64; 3]> {
        let joints = self.template.iter().enumerate().map(|(joint, position)| {
            let mut position = *position;
            for (axis, coordinate) in position.iter_mut().enumerate() {
                let from = (3 * joint + axis) * self.components;
                let displacement = &self.displacements[from..from + self.components];
                let shift = displacement.iter().zip(betas).map(|(d, beta)| d * beta);
                *coordinate += shift.sum::<f64>();
            }
            position
        });
        joints.collect()
    }
}
