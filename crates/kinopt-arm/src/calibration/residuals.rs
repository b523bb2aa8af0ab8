//! Residuals of the measurements and of the prior, with their derivatives.

use kinopt_kinematics::spatial::{
    Matrix3, Placement, Vector3, rotation_exp_jacobian, rotation_log, rotation_log_jacobian,
};
use kinopt_solver::solver::LeastSquares;
use nalgebra::DMatrix;

use super::Calibration;
use super::measurements::{Measurements, Noise};
use super::parameters::{Direction, Displacement, Parameter};

/// Weighted residuals: measurement by measurement, then x over its prior.
pub(super) struct Residuals<'a> {
    pub(super) calibration: &'a Calibration,
    pub(super) configurations: &'a [f64],
    pub(super) measured: Measurements<'a>,
    pub(super) parameters: &'a [Parameter],
    pub(super) noise: Noise,
    /// Weight of each measurement, from 0 to 1.
    pub(super) weights: Vec<f64>,
    pub(super) unbounded: [Vec<f64>; 2],
}

/// Displaced frame of a measurement.
struct DisplacedFrame {
    /// Axes before the displacement.
    axes: Matrix3<f64>,
    /// Origin after the displacement.
    origin: Vector3<f64>,
}

impl Residuals<'_> {
    /// Displacements at x of all places, from base to tool.
    pub(super) fn displacements(&self, x: &[f64]) -> Vec<Displacement> {
        let places = self.calibration.chain.joints.len() + 2;
        Displacement::all(self.parameters, x, places)
    }

    /// Placement of the tip in the frame of the measuring device, and the displaced frames, from base to tool.
    fn tip(
        &self,
        displacements: &[Displacement],
        index: usize,
    ) -> (Placement<f64>, Vec<DisplacedFrame>) {
        let chain = &self.calibration.chain;
        let count = chain.joints.len();
        let mut frames = Vec::with_capacity(displacements.len());
        let mut displace = |placed: Placement<f64>| {
            let after = placed * displacements[frames.len()].placement();
            frames.push(DisplacedFrame {
                axes: placed.rotation,
                origin: after.translation,
            });
            after
        };
        let mut placed = displace(Placement::identity());
        let q = &self.configurations[count * index..count * (index + 1)];
        for (joint, &value) in chain.joints.iter().zip(q) {
            placed = displace(placed * joint.before_from_joint);
            placed = placed * joint.kind.joint_from_moved(joint.axis, value);
        }
        placed = displace(placed * chain.last_from_tip);
        (placed, frames)
    }

    /// Position error, and rotation vector of the orientation error, in the axes of the measurement.
    fn errors(&self, tip: &Placement<f64>, index: usize) -> (Vector3<f64>, Vector3<f64>) {
        let offset = tip.translation - self.measured.position(index);
        match self.measured {
            Measurements::Poses(poses) => {
                let turned = poses[index].rotation.transpose() * tip.rotation;
                (offset, rotation_log(&turned))
            }
            Measurements::Points(_) => (offset, Vector3::zero()),
        }
    }

    /// Errors of all measurements at x: see [`errors`](Self::errors).
    pub(super) fn errors_at(&self, x: &[f64]) -> Vec<(Vector3<f64>, Vector3<f64>)> {
        let displacements = self.displacements(x);
        let tips = (0..self.measured.len()).map(|index| self.tip(&displacements, index).0);
        tips.enumerate()
            .map(|(index, tip)| self.errors(&tip, index))
            .collect()
    }

    fn prior(&self, parameter: usize) -> f64 {
        1.0 / self.parameters[parameter].prior(&self.calibration.prior)
    }
}

impl LeastSquares for Residuals<'_> {
    fn variables(&self) -> usize {
        self.parameters.len()
    }

    fn rows(&self) -> usize {
        self.measured.rows() * self.measured.len() + self.parameters.len()
    }

    fn lower(&self) -> &[f64] {
        &self.unbounded[0]
    }

    fn upper(&self) -> &[f64] {
        &self.unbounded[1]
    }

    fn residual(&mut self, x: &[f64], residual: &mut [f64]) {
        let (of_measurements, of_prior) =
            residual.split_at_mut(self.measured.rows() * self.measured.len());
        let rows = of_measurements.chunks_exact_mut(self.measured.rows());
        let errors = self.errors_at(x);
        for (index, (rows, (position, angle))) in rows.zip(errors).enumerate() {
            let weight = self.weights[index].sqrt();
            let scaled = [
                position * (weight / self.noise.position),
                angle * (weight / self.noise.angle),
            ];
            let numbers = scaled.iter().flat_map(|vector| vector.to_array());
            for (row, number) in rows.iter_mut().zip(numbers) {
                *row = number;
            }
        }
        for (k, row) in of_prior.iter_mut().enumerate() {
            *row = x[k] * self.prior(k);
        }
    }

    fn jacobian(&mut self, x: &[f64], jacobian: &mut DMatrix<f64>) {
        jacobian.fill(0.0);
        let rows = self.measured.rows();
        let displacements = self.displacements(x);
        for index in 0..self.measured.len() {
            let (tip, frames) = self.tip(&displacements, index);
            let weight = self.weights[index].sqrt();
            let of_rotation = match self.measured {
                Measurements::Poses(poses) => {
                    let (_, angle) = self.errors(&tip, index);
                    Some(rotation_log_jacobian(angle) * poses[index].rotation.transpose())
                }
                Measurements::Points(_) => None,
            };
            for (column, parameter) in self.parameters.iter().enumerate() {
                let place = parameter.place.index(frames.len());
                let (frame, displacement) = (&frames[place], &displacements[place]);
                let (linear, angular) = match parameter.direction {
                    Direction::Translation(along) => (frame.axes * along, Vector3::zero()),
                    Direction::Rotation(about) => {
                        let rate = rotation_exp_jacobian(displacement.rotation) * about;
                        let angular = frame.axes * rate;
                        (angular.cross(tip.translation - frame.origin), angular)
                    }
                };
                let linear = (linear * (weight / self.noise.position)).to_array();
                for (k, value) in linear.into_iter().enumerate() {
                    jacobian[(rows * index + k, column)] = value;
                }
                if let Some(of_rotation) = of_rotation {
                    let angular = of_rotation * angular * (weight / self.noise.angle);
                    for (k, value) in angular.to_array().into_iter().enumerate() {
                        jacobian[(rows * index + 3 + k, column)] = value;
                    }
                }
            }
        }
        let first = rows * self.measured.len();
        for k in 0..self.parameters.len() {
            jacobian[(first + k, k)] = self.prior(k);
        }
    }
}
