//! Estimation: least squares with weights that are computed again from the residuals.

use kinopt_kinematics::spatial::{Matrix3, Placement, Vector3, rotation_log};
use kinopt_solver::solver::{
    LeastSquares, LevenbergMarquardt, Silent, SolverState, Stopping, minimise,
};
use nalgebra::DMatrix;

use super::calibrated::{Calibrated, Correction, ParameterEstimate, Rms};
use super::measurements::{Measurements, Noise};
use super::parameters::{Displacement, parameters};
use super::residuals::Residuals;
use super::{Calibration, CalibrationError};

/// Number of estimates of noise and weights.
const ROUNDS: usize = 12;
/// Noise before the first estimate.
const INITIAL_NOISE: Noise = Noise {
    position: 1e-3,
    angle: 1e-3,
};
/// Smallest estimate of the noise, metres and radians: rounding of exact measurements.
const MIN_NOISE: f64 = 1e-9;
/// Ratio of the standard deviation of a normal distribution to its median absolute deviation.
const MEDIAN_RATIO: f64 = 1.4826;
/// Distances of points and of poses, in standard deviations of one row, beyond which a measurement counts half: the 95 %
/// quantiles of the chi distribution with 3 and 6 degrees of freedom.
const HALF_WEIGHT: [f64; 2] = [2.80, 3.55];
/// Distances of points and of poses beyond which a measurement is an outlier: the 99.99 % quantiles.
const OUTLIER: [f64; 2] = [4.59, 5.27];
/// Ratio of a parameter's standard deviation to the prior of its unit above which it counts as not determined. A parameter of
/// the base has no prior; its standard deviation is that of the joint that it sums with.
const UNDETERMINED: f64 = 0.5;
/// Ratio of the residual to the expected deviation above which the measurements are not those of the model.
const IMPLAUSIBLE: f64 = 10.0;

pub(super) fn estimate(
    calibration: &Calibration,
    configurations: &[f64],
    measured: Measurements<'_>,
) -> Result<Calibrated, CalibrationError> {
    let has_rotations = measured.has_rotations();
    let parameters = parameters(&calibration.chain, &calibration.parameters, has_rotations);
    let count = parameters.len();
    let mut residuals = Residuals {
        calibration,
        configurations,
        measured,
        parameters: &parameters,
        noise: calibration.noise.unwrap_or(INITIAL_NOISE),
        weights: vec![1.0; measured.len()],
        unbounded: [vec![f64::NEG_INFINITY; count], vec![f64::INFINITY; count]],
    };
    let model = vec![0.0; count];
    let mut x = match calibration.parameters.base {
        true => aligned(&residuals, &model),
        false => model.clone(),
    };
    let before = rms(&residuals, &model, &[]);
    let mut state = SolverState::default();
    for _ in 0..ROUNDS {
        let (method, stopping) = (LevenbergMarquardt::default(), Stopping::default());
        // Fails only for invalid settings and starts.
        if minimise(
            &mut residuals,
            &method,
            &x,
            &stopping,
            &mut Silent,
            &mut state,
        )
        .is_ok()
        {
            x.copy_from_slice(state.x());
        }
        if calibration.noise.is_none() {
            residuals.noise = noise(&residuals, &x);
        }
        if calibration.is_robust {
            residuals.weights = weights(&residuals, &x);
        }
    }
    let largest = OUTLIER[usize::from(has_rotations)];
    let outliers = distances(&residuals, &x).into_iter().enumerate();
    let outliers = outliers.filter(|(_, distance)| *distance > largest);
    let outliers = outliers.map(|(index, _)| index).collect();
    check_residual(calibration, noise(&residuals, &x))?;
    Ok(finished(&mut residuals, &x, before, outliers))
}

/// Checks the residual of the fit, by its median, against the expected deviation of the arm from its model.
fn check_residual(calibration: &Calibration, residual: Noise) -> Result<(), CalibrationError> {
    let Calibration { prior, noise, .. } = calibration;
    let of_noise = noise.unwrap_or(Noise {
        position: 0.0,
        angle: 0.0,
    });
    let position = prior.position.max(of_noise.position);
    let angle = prior.angle.max(of_noise.angle);
    if residual.position <= IMPLAUSIBLE * position && residual.angle <= IMPLAUSIBLE * angle {
        return Ok(());
    }
    Err(CalibrationError::NoFit {
        residual,
        position,
        angle,
    })
}

/// The model's parameters with the placement of the base that aligns the model's positions with the measured ones: the
/// measuring device may be anywhere.
fn aligned(residuals: &Residuals<'_>, model: &[f64]) -> Vec<f64> {
    let mut x = model.to_vec();
    let measured = (0..residuals.measured.len()).map(|index| residuals.measured.position(index));
    let measured: Vec<Vector3<f64>> = measured.collect();
    let errors = residuals.errors_at(model).into_iter().zip(&measured);
    let model: Vec<Vector3<f64>> = errors
        .map(|((offset, _), position)| offset + *position)
        .collect();
    let mean = |points: &[Vector3<f64>]| {
        let sum = points
            .iter()
            .fold(Vector3::zero(), |sum, point| sum + *point);
        sum * (1.0 / points.len() as f64)
    };
    let (measured_mean, model_mean) = (mean(&measured), mean(&model));
    // Kabsch's rotation from the model to the measurements.
    let mut covariance = nalgebra::Matrix3::zeros();
    for (measured, model) in measured.iter().zip(&model) {
        let row = |vector: Vector3<f64>| nalgebra::Vector3::from(vector.to_array());
        covariance += row(*measured - measured_mean) * row(*model - model_mean).transpose();
    }
    let svd = covariance.svd(true, true);
    let (Some(u), Some(v)) = (svd.u, svd.v_t) else {
        return x;
    };
    let sign = nalgebra::Matrix3::from_diagonal(&nalgebra::Vector3::new(
        1.0,
        1.0,
        (u * v).determinant().signum(),
    ));
    let rotation = Matrix3::from(u * sign * v);
    let translation = measured_mean - rotation * model_mean;
    // The parameters of the base are the first.
    let numbers = [translation.to_array(), rotation_log(&rotation).to_array()];
    for (value, number) in x.iter_mut().zip(numbers.as_flattened()) {
        *value = *number;
    }
    x
}

/// Robust estimate of the noise from the residuals.
fn noise(residuals: &Residuals<'_>, x: &[f64]) -> Noise {
    let errors = residuals.errors_at(x).into_iter();
    let (positions, angles): (Vec<_>, Vec<_>) = errors.unzip();
    let deviation = |errors: &[Vector3<f64>]| {
        let numbers = errors.iter().flat_map(|error| error.to_array());
        let mut numbers: Vec<f64> = numbers.map(f64::abs).collect();
        numbers.sort_by(f64::total_cmp);
        let median = numbers.get(numbers.len() / 2).copied().unwrap_or(0.0);
        (MEDIAN_RATIO * median).max(MIN_NOISE)
    };
    Noise {
        position: deviation(&positions),
        angle: deviation(&angles),
    }
}

/// Distance of each measurement from the fit, in standard deviations.
fn distances(residuals: &Residuals<'_>, x: &[f64]) -> Vec<f64> {
    let distance = |(position, angle): (Vector3<f64>, Vector3<f64>)| {
        let position = position * (1.0 / residuals.noise.position);
        let angle = angle * (1.0 / residuals.noise.angle);
        (position.norm_squared() + angle.norm_squared()).sqrt()
    };
    residuals.errors_at(x).into_iter().map(distance).collect()
}

/// Weights of Cauchy's loss (Huber and Ronchetti 2009, section 7.8).
fn weights(residuals: &Residuals<'_>, x: &[f64]) -> Vec<f64> {
    let half = HALF_WEIGHT[usize::from(residuals.measured.has_rotations())];
    let distances = distances(residuals, x).into_iter();
    distances
        .map(|distance| 1.0 / (1.0 + distance * distance / (half * half)))
        .collect()
}

/// Root mean square of the norms of the errors, without outliers.
fn rms(residuals: &Residuals<'_>, x: &[f64], outliers: &[usize]) -> Rms {
    let errors = residuals.errors_at(x).into_iter().enumerate();
    let inliers = errors.filter(|(index, _)| !outliers.contains(index));
    let errors: Vec<_> = inliers.map(|(_, errors)| errors).collect();
    let mean = |of: fn(&(Vector3<f64>, Vector3<f64>)) -> f64| {
        (errors.iter().map(of).sum::<f64>() / errors.len().max(1) as f64).sqrt()
    };
    Rms {
        position: mean(|(position, _)| position.norm_squared()),
        angle: mean(|(_, angle)| angle.norm_squared()),
    }
}

fn finished(
    residuals: &mut Residuals<'_>,
    x: &[f64],
    before: Rms,
    outliers: Vec<usize>,
) -> Calibrated {
    let mut jacobian = DMatrix::zeros(residuals.rows(), residuals.variables());
    residuals.jacobian(x, &mut jacobian);
    let inverse = jacobian.tr_mul(&jacobian).try_inverse();
    let calibration = residuals.calibration;
    let estimates = residuals
        .parameters
        .iter()
        .enumerate()
        .map(|(k, parameter)| {
            let variance = inverse
                .as_ref()
                .map_or(f64::INFINITY, |inverse| inverse[(k, k)]);
            let standard_deviation = variance.max(0.0).sqrt();
            ParameterEstimate {
                name: parameter.name(&calibration.chain),
                value: x[k],
                standard_deviation,
                is_determined: standard_deviation
                    < UNDETERMINED * parameter.scale(&calibration.prior),
            }
        });
    let estimates = estimates.collect();
    let displacements = residuals.displacements(x);
    let mut placements = displacements.iter().map(Displacement::placement);
    let device_from_base = placements.next().unwrap_or_else(Placement::identity);
    let joints = calibration.chain.joints.iter().zip(placements.by_ref());
    let corrections = joints.map(|(joint, placement)| Correction {
        joint: joint.name.clone(),
        placement,
    });
    let corrections = corrections.collect();
    Calibrated {
        corrections,
        device_from_base,
        tip_from_tool: placements.next().unwrap_or_else(Placement::identity),
        tip_joint: calibration.chain.tip_joint.clone(),
        before,
        after: rms(residuals, x, &outliers),
        noise: residuals.noise,
        outliers,
        parameters: estimates,
    }
}
