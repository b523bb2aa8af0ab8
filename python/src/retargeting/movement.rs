//! Retargeting of a whole motion.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::time::Duration;

use kinopt::motion::retarget::{RetargetError, UpAxis};
use kinopt::motion::trajectory::MotionBound;
use kinopt::solver::Side;
use kinopt::spatial::{Placement, Quaternion};
use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use super::capture::Capture;
use super::request::{RetargetRequest, raised};
use crate::arrays;
use crate::error::{OrRaise, invalid};

/// Configurations, and fields of `kinopt.RetargetReport` in their order.
type MovementParts<'py> = (
    Bound<'py, PyArray2<f64>>,
    Vec<String>,
    Bound<'py, PyAny>,
    (Vec<String>, Bound<'py, PyArray2<f64>>),
    (Bound<'py, PyArray2<f64>>, Vec<String>),
    (f64, f64, f64),
    String,
    Vec<(String, &'static str, usize, usize)>,
    Vec<(usize, String, String, f64)>,
    Vec<(usize, String)>,
    (Option<&'static str>, bool),
    Bound<'py, PyArray2<f64>>,
);

/// Time between two checks for signals.
const REPORT_INTERVAL: Duration = Duration::from_millis(50);

/// Number of finished frames, and of all frames.
#[derive(Default)]
struct Progress {
    done: AtomicUsize,
    frames: AtomicUsize,
}

/// Computes on another thread; meanwhile calls `progress` with (done, total) and handles Ctrl-C.
fn while_listening<T: Send>(
    py: Python<'_>,
    progress: Option<&Bound<'_, PyAny>>,
    compute: impl FnOnce(Arc<AtomicBool>, &Progress) -> Result<T, RetargetError> + Send,
) -> PyResult<T> {
    let (cancelled, state) = (Arc::new(AtomicBool::new(false)), Progress::default());
    let progress = progress.map(|progress| progress.clone().unbind());
    let mut reported = None;
    let mut report = |py: Python<'_>| {
        let now = (
            state.done.load(Ordering::Relaxed),
            state.frames.load(Ordering::Relaxed),
        );
        py.check_signals()?;
        if let Some(progress) = progress
            .as_ref()
            .filter(|_| now.1 > 0 && reported != Some(now))
        {
            reported = Some(now);
            progress.call1(py, now)?;
        }
        PyResult::Ok(())
    };
    py.detach(|| {
        let (sender, receiver) = mpsc::channel();
        std::thread::scope(|scope| {
            let flag = Arc::clone(&cancelled);
            let state = &state;
            scope.spawn(move || sender.send(compute(flag, state)));
            loop {
                match receiver.recv_timeout(REPORT_INTERVAL) {
                    Ok(result) => {
                        Python::attach(&mut report)?;
                        return result.map_err(raised);
                    }
                    Err(RecvTimeoutError::Timeout) => {
                        if let Err(error) = Python::attach(&mut report) {
                            cancelled.store(true, Ordering::Relaxed);
                            return Err(error);
                        }
                    }
                    Err(RecvTimeoutError::Disconnected) => {
                        return Err(invalid("the computation ended without a result"));
                    }
                }
            }
        })
    })
}

/// Position and quaternion w, x, y, z of a pose.
fn pose_numbers(pose: &Placement<f64>) -> [f64; 7] {
    let [x, y, z] = pose.translation.to_array();
    let rotation = Quaternion::from_matrix(&pose.rotation);
    let [i, j, k] = rotation.v.to_array();
    [x, y, z, rotation.w, i, j, k]
}

/// Retargets a capture to a target by a map (JSON).
#[pyfunction]
pub(super) fn capture_retargeted<'py>(
    py: Python<'py>,
    capture: &Bound<'py, Capture>,
    target: &Bound<'py, PyAny>,
    map: &str,
    whole: bool,
    options: &Bound<'py, PyDict>,
    progress: Option<&Bound<'py, PyAny>>,
) -> PyResult<MovementParts<'py>> {
    let request = RetargetRequest::read(capture, target, map, options)?;
    let retargeted = while_listening(py, progress, |cancelled, done| {
        let retargeting = request.fitted()?.with_cancellation(cancelled);
        let frames = retargeting.frames();
        done.frames.store(frames, Ordering::Relaxed);
        let retargeted = match whole {
            true => retargeting.whole_with_progress(&mut |frames| {
                done.done.fetch_max(frames, Ordering::Relaxed);
            })?,
            false => retargeting.per_frame()?,
        };
        done.done.store(frames, Ordering::Relaxed);
        let has_fixed_base = retargeting.legs_on_fixed_base();
        let angles = retargeting.limb_angles(&retargeted)?;
        let limits = retargeting.active_limits(&retargeted);
        let limbs = retargeting.limbs();
        let stride = retargeting.stride();
        let up = retargeting.model_stands_along();
        let object = retargeting.object_poses().to_vec();
        Ok((
            retargeted,
            angles,
            limits,
            limbs,
            stride,
            up,
            has_fixed_base,
            object,
        ))
    })?;
    let (retargeted, angles, limits, limbs, stride, up, has_fixed_base, object) = retargeted;
    let object_poses: Vec<f64> = object.iter().flat_map(pose_numbers).collect();
    let limits = limits.into_iter().map(|met| {
        let side = match (met.bound, met.side) {
            (MotionBound::Speed, Side::Lower) => "speed down",
            (MotionBound::Speed, Side::Upper) => "speed up",
            (_, Side::Lower) => "lower",
            (_, Side::Upper) => "upper",
        };
        (met.joint, side, met.frames.start, met.frames.end)
    });
    let report = retargeted.report;
    let touching = report.touching.into_iter().map(|contact| {
        let pair = contact.pair;
        (contact.frame, pair.first, pair.second, pair.distance)
    });
    let lost_contacts = report.lost_contacts.into_iter();
    let lost_contacts = lost_contacts.map(|lost| (lost.frame, lost.contact_frame));
    let frames = retargeted.times.len();
    let contacts = PyArray1::from_slice(py, &report.contacts);
    let points = report.contact_points.iter();
    let contact_points: Vec<f64> = points.flat_map(|at| at.to_array()).collect();
    Ok((
        arrays::list(py, &retargeted.q).reshape([frames, retargeted.nq])?,
        request.names(),
        contacts
            .reshape([frames, report.contact_frames.len()])?
            .into_any(),
        (
            report.contact_frames,
            arrays::list(py, &contact_points).reshape([report.contact_points.len(), 3])?,
        ),
        (
            arrays::list(py, &angles).reshape([frames, limbs.len()])?,
            limbs.into_iter().map(str::to_owned).collect(),
        ),
        (report.slip, report.ground_penetration, stride),
        serde_json::to_string(&report.score).or_raise()?,
        limits.collect(),
        touching.collect(),
        lost_contacts.collect(),
        (
            up.filter(|up| *up == UpAxis::Y).map(|_| "y"),
            has_fixed_base,
        ),
        arrays::list(py, &object_poses).reshape([object.len(), 7])?,
    ))
}
