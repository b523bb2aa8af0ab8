//! Calibration of arms.

use kinopt::calibration::{
    Calibrated, Calibration as Fit, Measurements, Noise, ParameterEstimate, ParameterSet, Prior,
};
use kinopt::model::UnknownName;
use kinopt::spatial::Vector3;
use numpy::PyArray2;
use pyo3::prelude::*;

use crate::arrays;
use crate::error::{OrRaise, invalid};
use crate::placement::{placements, to_array};
use crate::robot::Robot;

/// Names of parts of the kinematics.
const PARTS: [&str; 5] = [
    "joint_offsets",
    "link_positions",
    "link_rotations",
    "base",
    "tool",
];

/// Result of `kinopt.calibrate`.
#[pyclass(frozen, module = "kinopt")]
pub(crate) struct Calibration {
    inner: Calibrated,
    /// The calibrated robot.
    #[pyo3(get)]
    robot: Py<Robot>,
    /// Text of the calibrated robot's URDF: that of the robot, with corrected origins of joints.
    #[pyo3(get)]
    urdf: String,
}

#[pymethods]
impl Calibration {
    /// Placement of the base in the frame of the measuring device, shape (4, 4), metres.
    #[getter]
    fn device_from_base<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        to_array(py, &self.inner.device_from_base)
    }

    /// Placement of the measured frame in the tip, shape (4, 4), metres. `urdf` contains it if the tip's link is mounted by
    /// a fixed joint (`urdf_has_tool`); otherwise pass it to `Arm` as `tool`.
    #[getter]
    fn tip_from_tool<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        to_array(py, &self.inner.tip_from_tool)
    }

    /// True if `urdf` contains `tip_from_tool`.
    #[getter]
    fn urdf_has_tool(&self) -> bool {
        self.inner.urdf_has_tool()
    }

    /// Root mean square position error of the model before, metres.
    #[getter]
    fn position_rms_before(&self) -> f64 {
        self.inner.before.position
    }

    /// Root mean square position error of the calibrated model without outliers, metres.
    #[getter]
    fn position_rms(&self) -> f64 {
        self.inner.after.position
    }

    /// Root mean square orientation error of the calibrated model without outliers, radians; 0 for points.
    #[getter]
    fn orientation_rms(&self) -> f64 {
        self.inner.after.angle
    }

    /// Standard deviation of a measurement in each direction, metres and radians, given or estimated.
    #[getter]
    fn noise(&self) -> (f64, f64) {
        (self.inner.noise.position, self.inner.noise.angle)
    }

    /// Indices of measurements that do not fit, in order.
    #[getter]
    fn outliers(&self) -> Vec<usize> {
        self.inner.outliers.clone()
    }

    /// Estimated parameters by name: deviation from the model, standard deviation (both metres or radians), and false for
    /// a parameter that the measurements do not determine alone.
    #[getter]
    fn parameters(&self) -> Vec<(String, f64, f64, bool)> {
        let parameters = self.inner.parameters.iter();
        parameters
            .map(
                |ParameterEstimate {
                     name,
                     value,
                     standard_deviation,
                     is_determined,
                 }| { (name.clone(), *value, *standard_deviation, *is_determined) },
            )
            .collect()
    }

    fn __repr__(&self) -> String {
        let Calibrated { before, after, .. } = &self.inner;
        format!(
            "Calibration(position error {:.3e} m to {:.3e} m, {} outliers)",
            before.position,
            after.position,
            self.inner.outliers.len()
        )
    }
}

/// Parts of the kinematics by name.
fn parts(names: Option<Vec<String>>) -> PyResult<ParameterSet> {
    let Some(names) = names else {
        return Ok(ParameterSet::default());
    };
    if let Some(name) = names.iter().find(|name| !PARTS.contains(&name.as_str())) {
        return Err(UnknownName::new("part of the kinematics", name, PARTS)).or_raise();
    }
    let has = |part: &str| names.iter().any(|name| name == part);
    Ok(ParameterSet {
        joint_offsets: has("joint_offsets"),
        link_positions: has("link_positions"),
        link_rotations: has("link_rotations"),
        base: has("base"),
        tool: has("tool"),
    })
}

/// Estimates joint offsets and link parameters of a robot from measured poses or points of a tip.
///
/// `configurations`, shape (N, dof), are the joint positions from `base` to `tip`, radians or metres. `measured` are poses of
/// the tip, shape (N, 4, 4), or points, shape (N, 3), metres, in the frame of the measuring device. `parameters` lists the
/// estimated parts: "joint_offsets", "link_positions", "link_rotations", "base" (placement of the base in the frame of the
/// device) and "tool" (of the measured frame in the tip); default: all. `noise` is the standard deviation of a measurement in
/// metres and radians; default: estimated. `prior` is the expected deviation of the robot from its model in metres and
/// radians. With `robust`, measurements far from the fit count less.
///
/// Raises `UnknownNameError` for an unknown frame or part. Raises `InvalidValueError` for numbers that do not match, for too
/// few measurements, and for a residual far beyond the prior, as of degrees or millimetres.
#[pyfunction]
#[pyo3(
    signature = (
        robot, configurations, measured, *, base, tip, parameters = None, noise = None, prior = (0.005, 0.02), robust = true
    ),
    text_signature = "(robot, configurations, measured, *, base, tip, parameters=None, noise=None, \
        prior=(0.005, 0.02), robust=True)"
)]
#[expect(clippy::too_many_arguments, reason = "they are keywords")]
pub(crate) fn calibrate(
    py: Python<'_>,
    robot: &Bound<'_, Robot>,
    configurations: &Bound<'_, PyAny>,
    measured: &Bound<'_, PyAny>,
    base: &str,
    tip: &str,
    parameters: Option<Vec<String>>,
    noise: Option<(f64, f64)>,
    prior: (f64, f64),
    robust: bool,
) -> PyResult<Calibration> {
    let robot = robot.get();
    let fit = Fit::new(&robot.inner, base, tip).or_raise()?;
    let fit = fit
        .with_parameters(parts(parameters)?)
        .with_prior(Prior {
            position: prior.0,
            angle: prior.1,
        })
        .with_noise(noise.map(|(position, angle)| Noise { position, angle }))
        .with_robust_loss(robust);
    let q = arrays::rows(configurations, "configurations", fit.joints().len())?.to_vec();
    let inner = match arrays::axes(measured)? {
        2 => {
            let points = arrays::rows(measured, "measured", 3)?;
            let points = points.chunks_exact(3);
            let points: Vec<_> = points.map(|p| Vector3::new(p[0], p[1], p[2])).collect();
            py.detach(|| fit.fit(&q, Measurements::Points(&points)))
        }
        3 => {
            let poses = placements(measured, "measured")?.to_vec("measured")?;
            py.detach(|| fit.fit(&q, Measurements::Poses(&poses)))
        }
        _ => return Err(invalid("measured must have shape (N, 4, 4) or (N, 3)")),
    };
    let inner = inner.or_raise()?;
    let (urdf, calibrated) = robot.with_urdf(|text, file| inner.urdf(text, file).or_raise())?;
    Ok(Calibration {
        inner,
        robot: Py::new(py, calibrated)?,
        urdf,
    })
}
