//! Reach maps: tables of the poses that an arm reaches.

use std::sync::Arc;

use kinopt::arm::{ArmFingerprint, ReachMapData};
use kinopt::spatial::{Placement, Vector3};
use numpy::ndarray::Array2;
use numpy::{PyArray1, PyArray2, ToPyArray};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use super::Arm;
use crate::arrays;
use crate::error::{OrRaise, invalid};
use crate::in_python;
use crate::placement::{placements, targets as targets_of};
use crate::progress::Progress;
use crate::signals::interruptible;
use crate::threads;

/// Parts of a map between two checks for signals.
const PARTS: usize = 40;

/// Reach by pose, shape (N,), and configurations, shape (N, dof).
type Reach<'py> = (Bound<'py, PyArray1<i8>>, Bound<'py, PyArray2<f64>>);

/// Table of the poses that an arm reaches, by cells of positions and orientations: `ReachMap.build`.
///
/// A cell holds a configuration that reaches its centre, or a proof that no configuration reaches any of its poses, or
/// neither. Poses are base_from_tool, metres.
#[pyclass(frozen, module = "kinopt")]
pub(crate) struct ReachMap {
    inner: Arc<kinopt::arm::ReachMap>,
}

/// Placement of a base among candidates, from `ReachMap.place_base`.
#[pyclass(frozen, get_all, module = "kinopt")]
pub(crate) struct BasePlacement {
    /// Index among the candidates.
    candidate: usize,
    /// Number of targets that exact inverse kinematics reaches.
    reached: usize,
    /// Number of targets that the map proves unreachable.
    unreachable: usize,
    /// Configurations of all targets, shape (N, dof), radians or metres; NaN for a target that is not reached.
    q: Py<PyArray2<f64>>,
}

#[pymethods]
impl BasePlacement {
    fn __repr__(&self) -> String {
        format!(
            "BasePlacement(candidate {}, {} reached, {} unreachable)",
            self.candidate, self.reached, self.unreachable
        )
    }
}

fn table<'py>(
    py: Python<'py>,
    q: Vec<f64>,
    rows: usize,
    dof: usize,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let table = Array2::from_shape_vec((rows, dof), q);
    Ok(table
        .map_err(|error| invalid(error.to_string()))?
        .to_pyarray(py))
}

fn code(reached: Option<bool>) -> i8 {
    match reached {
        Some(true) => 1,
        Some(false) => -1,
        None => 0,
    }
}

impl ReachMap {
    fn new(inner: kinopt::arm::ReachMap) -> Self {
        Self {
            inner: Arc::new(inner),
        }
    }

    fn dof(&self) -> usize {
        self.inner.data().arm.joints.len()
    }

    fn poses(&self, poses: &Bound<'_, PyAny>) -> PyResult<Vec<Placement<f64>>> {
        let mut half_widths = [0.0; 6];
        for (half_width, stored) in half_widths.iter_mut().zip(&self.inner.data().arm.goal) {
            *half_width = *stored;
        }
        let goal = kinopt::task::PoseBounds::within(half_widths);
        targets_of(poses, "target", &goal)?.to_vec("target")
    }

    fn counts(&self) -> [usize; 3] {
        let data = self.inner.data();
        let bins = match data.bins_per_face as usize {
            0 => 1,
            n => 24 * n * n * n,
        };
        let cells = data.cubes.len() * bins;
        let reached = data.configurations.len() / self.dof();
        let unknown = data.cells.iter().filter(|&&cell| cell == u32::MAX - 1);
        let absent = data.cubes.iter().filter(|&&cube| cube == u32::MAX - 1);
        let unknown = unknown.count() + absent.count() * bins;
        [reached, cells - reached - unknown, unknown]
    }
}

#[pymethods]
impl ReachMap {
    /// Builds the map of an arm, with its tool, goal, tolerances and obstacles.
    ///
    /// `position_step` is the edge of a cell in metres, by default a tenth of the reach. `orientation_step` is the width
    /// of a cell along each of three angles in radians: 24 n³ bins with n = π/2 / `orientation_step`, rounded up. At each
    /// centre exact inverse kinematics makes up to `attempts` attempts. A proof takes up to `max_boxes` boxes of joint
    /// values. `part` (k, n) builds the k-th of n parts, for several machines; `ReachMap.merged` joins them. The map does
    /// not depend on `threads` (None: all cores). `progress` is called with (done, total) from time to time; True shows
    /// a progress bar if tqdm is installed. Ctrl-C interrupts the computation.
    ///
    /// Raises `InvalidValueError` for options out of range, and for an arm without proofs: more than eight joints, mimic
    /// joints, or a goal that is no pose, position, or pose with a free rotation about an axis.
    #[staticmethod]
    #[pyo3(
        signature = (arm, *, position_step = None, orientation_step = None, attempts = 8, max_boxes = 2, part = (0, 1), threads = 1, progress = None),
        text_signature = "(arm, *, position_step=None, orientation_step=0.7853981633974483, attempts=8, max_boxes=2, part=(0, 1), threads=1, progress=None)"
    )]
    #[allow(clippy::too_many_arguments, reason = "one for each keyword of Python")]
    fn build(
        py: Python<'_>,
        arm: &Arm,
        position_step: Option<f64>,
        orientation_step: Option<f64>,
        #[pyo3(from_py_with = crate::arrays::whole)] attempts: u32,
        #[pyo3(from_py_with = crate::arrays::whole)] max_boxes: usize,
        part: (usize, usize),
        #[pyo3(from_py_with = crate::arrays::whole_or_none)] threads: Option<usize>,
        progress: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let mut builder = kinopt::arm::ReachMap::builder(&arm.inner)
            .with_attempts(attempts)
            .with_max_boxes(max_boxes);
        if let Some(step) = position_step {
            builder = builder.with_position_step(step);
        }
        if let Some(step) = orientation_step {
            builder = builder.with_orientation_step(step);
        }
        let (part, parts) = part;
        if part >= parts {
            builder.with_part(part, parts).build().or_raise()?;
            return Err(invalid("no such part"));
        }
        let pool = threads::pool(threads, usize::MAX)?;
        let progress = Progress::new(py, progress, PARTS)?;
        let mut built = Vec::with_capacity(PARTS);
        for piece in 0..PARTS {
            py.check_signals()?;
            let builder = builder
                .clone()
                .with_part(part + parts * piece, parts * PARTS);
            let map = py.detach(|| match &pool {
                Some(pool) => pool.install(|| builder.build_parallel()),
                None => builder.build(),
            });
            built.push(map.or_raise()?);
            progress.done(piece + 1)?;
        }
        let map = py.detach(|| kinopt::arm::ReachMap::merged(&built));
        Ok(Self::new(map.or_raise()?))
    }

    /// Joins parts of one map.
    ///
    /// Raises `InvalidValueError` for parts of different maps, and for a part that occurs twice.
    #[staticmethod]
    fn merged(py: Python<'_>, parts: Vec<PyRef<'_, Self>>) -> PyResult<Self> {
        let parts: Vec<_> = parts.iter().map(|part| (*part.inner).clone()).collect();
        let map = py.detach(|| kinopt::arm::ReachMap::merged(&parts));
        Ok(Self::new(map.or_raise()?))
    }

    /// Looks up the cells of `targets`, shape (N, 4, 4) or as in `Arm.solve_batch`.
    ///
    /// Returns an int8 array of shape (N,): 1 for a cell whose centre is reached, -1 for a cell that is proven
    /// unreachable, 0 for an unknown one. With it, the configurations of the cells' centres, shape (N, dof), radians or
    /// metres; NaN if there is none.
    ///
    /// Raises `InvalidValueError` for placements that are not rigid motions.
    fn query<'py>(&self, py: Python<'py>, targets: &Bound<'py, PyAny>) -> PyResult<Reach<'py>> {
        let poses = self.poses(targets)?;
        let mut q = vec![0.0; poses.len() * self.dof()];
        let mut reached = vec![None; poses.len()];
        py.detach(|| self.inner.query_into(&poses, &mut q, &mut reached))
            .or_raise()?;
        let reached = PyArray1::from_iter(py, reached.into_iter().map(code));
        Ok((reached, table(py, q, poses.len(), self.dof())?))
    }

    /// Decides whether the map's arm reaches `targets`: by the map, then by exact inverse kinematics from the cell's
    /// configuration, then by a proof of at most `max_boxes` boxes of joint values. `threads` as in `Arm.solve_batch`.
    ///
    /// Returns an int8 array of shape (N,): 1 for reached, -1 for proven unreachable, 0 for undecided. With it, the
    /// configurations that reach the targets, shape (N, dof), radians or metres; NaN if there is none.
    ///
    /// Raises `InvalidValueError` for another arm than the map's, and for placements that are not rigid motions.
    #[pyo3(signature = (arm, targets, *, max_boxes = 0, threads = 1))]
    fn decide<'py>(
        &self,
        py: Python<'py>,
        arm: &Arm,
        targets: &Bound<'py, PyAny>,
        #[pyo3(from_py_with = crate::arrays::whole)] max_boxes: usize,
        #[pyo3(from_py_with = crate::arrays::whole_or_none)] threads: Option<usize>,
    ) -> PyResult<Reach<'py>> {
        let poses = self.poses(targets)?;
        let mut q = vec![0.0; poses.len() * self.dof()];
        let mut reached = vec![None; poses.len()];
        let pool = threads::pool(threads, poses.len())?;
        let (map, arm) = (&self.inner, &arm.inner);
        interruptible(py, || match &pool {
            Some(pool) => pool
                .install(|| map.decide_into_parallel(arm, &poses, max_boxes, &mut q, &mut reached)),
            None => map.decide_into(arm, &poses, max_boxes, &mut q, &mut reached),
        })?
        .or_raise()?;
        let reached = PyArray1::from_iter(py, reached.into_iter().map(code));
        Ok((reached, table(py, q, poses.len(), self.dof())?))
    }

    /// Ranks candidate placements of the arm's base by the number of reached targets: `BasePlacement`s, the best first.
    ///
    /// `targets`, shape (N, 4, 4), are placements of the tool in the world, and `bases`, shape (K, 4, 4), candidates of
    /// the base. The map ranks all candidates. Exact inverse kinematics then solves the targets of the best `exact`
    /// candidates, which are returned.
    ///
    /// Raises `InvalidValueError` for another arm than the map's, and for placements that are not rigid motions.
    #[pyo3(signature = (arm, targets, bases, *, exact = 10))]
    fn place_base(
        &self,
        py: Python<'_>,
        arm: &Arm,
        targets: &Bound<'_, PyAny>,
        bases: &Bound<'_, PyAny>,
        #[pyo3(from_py_with = crate::arrays::whole)] exact: usize,
    ) -> PyResult<Vec<BasePlacement>> {
        let poses = self.poses(targets)?;
        let bases = placements(bases, "bases")?.to_vec("bases")?;
        let found = py.detach(|| self.inner.place_base(&arm.inner, &poses, &bases, exact));
        let found = found.or_raise()?.into_iter().map(|placement| {
            Ok(BasePlacement {
                candidate: placement.candidate,
                reached: placement.reached,
                unreachable: placement.unreachable,
                q: table(py, placement.q, poses.len(), self.dof())?.unbind(),
            })
        });
        found.collect()
    }

    /// Shares of the orientations at `positions`, shape (N, 3), metres, by the bins of their cubes: reached and proven
    /// unreachable, shape (N, 2), from 0 to 1.
    ///
    /// Raises `InvalidValueError` for another shape.
    fn orientation_shares<'py>(
        &self,
        py: Python<'py>,
        positions: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let positions = arrays::rows(positions, "positions", 3)?;
        let shares: Vec<f64> = positions
            .chunks_exact(3)
            .flat_map(|p| {
                let position = Vector3::new(p[0], p[1], p[2]);
                self.inner.orientation_shares(position)
            })
            .collect();
        table(py, shares, positions.len() / 3, 2)
    }

    /// Names of the arm's joints, base to tip.
    #[getter]
    fn joint_names(&self) -> Vec<String> {
        self.inner.data().arm.joints.clone()
    }

    /// Edge of a cell, metres.
    #[getter]
    fn position_step(&self) -> f64 {
        self.inner.data().position_step
    }

    /// Width of a cell along each of three angles, radians; None for a map of positions.
    #[getter]
    fn orientation_step(&self) -> Option<f64> {
        let bins = self.inner.data().bins_per_face;
        (bins > 0).then(|| std::f64::consts::FRAC_PI_2 / f64::from(bins))
    }

    /// Centre of the grid of positions in the base frame, shape (3,), metres.
    #[getter]
    fn centre<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.inner.data().centre.to_pyarray(py)
    }

    /// Number of cubes of positions along each axis.
    #[getter]
    fn cubes_per_axis(&self) -> u32 {
        self.inner.data().cubes_per_axis
    }

    /// Number of cells whose centre is reached.
    #[getter]
    fn reached(&self) -> usize {
        self.counts()[0]
    }

    /// Number of cells that are proven unreachable.
    #[getter]
    fn unreachable(&self) -> usize {
        self.counts()[1]
    }

    /// Number of cells without a configuration and without a proof.
    #[getter]
    fn unknown(&self) -> usize {
        self.counts()[2]
    }

    /// Arrays of the map by name, for storage in other formats; `ReachMap.from_arrays` reads them.
    fn arrays<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let data = self.inner.data();
        let arrays = PyDict::new(py);
        arrays.set_item(
            "joints",
            arrays::numpy(py)?.call_method1("array", (&data.arm.joints,))?,
        )?;
        for (name, values) in [
            ("lower", &data.arm.lower),
            ("upper", &data.arm.upper),
            ("goal", &data.arm.goal),
            ("tolerances", &data.arm.tolerances),
            ("placements", &data.arm.placements),
        ] {
            arrays.set_item(name, values.to_pyarray(py))?;
        }
        arrays.set_item("centre", data.centre.to_pyarray(py))?;
        arrays.set_item("position_step", [data.position_step].to_pyarray(py))?;
        let sizes = [data.cubes_per_axis, data.bins_per_face];
        arrays.set_item("sizes", sizes.to_pyarray(py))?;
        arrays.set_item("cubes", data.cubes.to_pyarray(py))?;
        arrays.set_item("cells", data.cells.to_pyarray(py))?;
        arrays.set_item("configurations", data.configurations.to_pyarray(py))?;
        Ok(arrays)
    }

    /// A map from the arrays of `arrays`.
    ///
    /// Raises `InvalidValueError` for missing arrays, and for arrays that do not fit together.
    #[staticmethod]
    fn from_arrays(arrays: &Bound<'_, PyAny>) -> PyResult<Self> {
        let array = |name: &str| {
            let missing = |_| invalid(format!("the reach map has no array `{name}`"));
            arrays.get_item(name).map_err(missing)
        };
        let floats = |name: &str| -> PyResult<Vec<f64>> {
            Ok(arrays::vector(&array(name)?, name)?.to_vec())
        };
        let [cubes_per_axis, bins_per_face] =
            <[u32; 2]>::try_from(codes(&array("sizes")?, "sizes")?)
                .map_err(|_| invalid("`sizes` must hold two numbers"))?;
        let data = ReachMapData {
            arm: ArmFingerprint {
                joints: array("joints")?.call_method0("tolist")?.extract()?,
                lower: floats("lower")?,
                upper: floats("upper")?,
                goal: floats("goal")?,
                tolerances: floats("tolerances")?,
                placements: floats("placements")?,
            },
            centre: arrays::array(&array("centre")?, "centre")?,
            position_step: arrays::array::<1>(&array("position_step")?, "position_step")?[0],
            cubes_per_axis,
            bins_per_face,
            cubes: codes(&array("cubes")?, "cubes")?,
            cells: codes(&array("cells")?, "cells")?,
            configurations: codes(&array("configurations")?, "configurations")?,
        };
        Ok(Self::new(
            kinopt::arm::ReachMap::from_data(data).or_raise()?,
        ))
    }

    /// Writes the map to a file: `.npz` (NumPy) or `.arrow` (Arrow IPC).
    ///
    /// Raises `InvalidValueError` for another ending, `FileError` if the file cannot be written, and `ImportError` for
    /// `.arrow` without pyarrow, which the extra `tables` installs.
    fn save<'py>(slf: &Bound<'py, Self>, path: &Bound<'py, PyAny>) -> PyResult<()> {
        in_python::call("save", "kinopt.reach", slf, &[("path", Some(path))])?;
        Ok(())
    }

    /// Reads a map from a file of `save`.
    ///
    /// Raises `InvalidValueError` for another ending, `FileError` if the file cannot be read, and `InvalidFileError` for
    /// a file that holds no map.
    #[staticmethod]
    fn load<'py>(py: Python<'py>, path: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        py.import("kinopt.reach")?.call_method1("load_map", (path,))
    }

    /// Draws the share of reached orientations in a plane through the grid: a matplotlib `Figure`.
    ///
    /// `plane` is "xz", "xy" or "yz", and `at` the third coordinate in metres, by default that of the centre. `figure`: a
    /// `Figure` or `SubFigure` to draw into, by default a new one. Raises `UnknownNameError` for another plane, and
    /// `ImportError` without matplotlib, which the extra `plot` installs.
    #[pyo3(signature = (*, plane = None, at = None, figure = None), text_signature = "($self, *, plane='xz', at=None, figure=None)")]
    fn plot<'py>(
        slf: &Bound<'py, Self>,
        plane: Option<&Bound<'py, PyAny>>,
        at: Option<&Bound<'py, PyAny>>,
        figure: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let keywords = [("plane", plane), ("at", at), ("figure", figure)];
        in_python::call("plot_reach", "kinopt.plots.reach", slf, &keywords)
    }

    /// Writes a page to look at the map: one HTML file without dependencies.
    ///
    /// Raises `FileError` if the file cannot be written.
    fn page<'py>(slf: &Bound<'py, Self>, path: &Bound<'py, PyAny>) -> PyResult<()> {
        in_python::call("write_page", "kinopt.reach", slf, &[("path", Some(path))])?;
        Ok(())
    }

    fn __reduce__<'py>(
        slf: &Bound<'py, Self>,
    ) -> PyResult<(Bound<'py, PyAny>, (Bound<'py, PyDict>,))> {
        let from_arrays = slf.getattr("from_arrays")?;
        Ok((from_arrays, (slf.get().arrays(slf.py())?,)))
    }

    fn __eq__(&self, other: &Self) -> bool {
        self.inner == other.inner
    }

    fn __repr__(&self) -> String {
        let [reached, unreachable, unknown] = self.counts();
        format!("ReachMap({reached} cells reached, {unreachable} unreachable, {unknown} unknown)")
    }
}

/// Whole numbers of an array.
fn codes<T: numpy::Element + Copy>(array: &Bound<'_, PyAny>, what: &str) -> PyResult<Vec<T>> {
    let numbers: arrays::Numbers<'_, numpy::ndarray::Ix1, T> =
        arrays::numbers(array, what, "one list of whole numbers")?;
    Ok(numbers.to_vec())
}
