//! Validation of path solver options: ranges, given ends and combinations.

use super::cartesian_path::{CartesianPath, Traversal};
use super::error::PathError;
use super::solver::PathSolver;
use kinopt_kinematics::bad_option::{AT_LEAST_ONE, BadOption, POSITIVE};

impl PathSolver<'_> {
    pub(super) fn check(&self, path: &CartesianPath) -> Result<(), PathError> {
        self.tools.check(&path.tools)?;
        if !path.oriented && self.tools.bound_orientation() {
            return Err(PathError::NoOrientations);
        }
        BadOption::check("max_step", self.max_step, POSITIVE)?;
        BadOption::check("samples", self.samples as f64, AT_LEAST_ONE)?;
        let in_range = (4..=4096).contains(&self.samples);
        if !in_range {
            let allowed = "from 4 to 4096";
            let value = self.samples as f64;
            BadOption::check("samples", value, (|_| false, allowed))?;
        }
        let arm = self.tools.primary();
        for (option, values) in [
            ("joint_weights", &self.weights),
            ("start", &self.start),
            ("end", &self.end),
        ] {
            let Some(values) = values else { continue };
            if values.len() != arm.joint_count() {
                return Err(PathError::JointCount {
                    option,
                    given: values.len(),
                    joints: arm.joints().map(str::to_owned).collect(),
                });
            }
        }
        for &weight in self.weights.iter().flatten() {
            BadOption::check("joint_weights", weight, POSITIVE)?;
        }
        if path.traversal != Traversal::Open && (self.end.is_some() || self.times_count) {
            return Err(PathError::Conflict(
                "a closed path ends at its start: it allows neither an end configuration nor kept times",
            ));
        }
        if path.traversal == Traversal::AnyStart && self.start.is_some() {
            return Err(PathError::Conflict(
                "a path with any start allows no start configuration",
            ));
        }
        if self.times_count && path.times.is_empty() {
            return Err(PathError::Conflict(
                "times cannot be kept: the path has none",
            ));
        }
        self.check_end("start", self.start.as_deref(), path, 0)?;
        self.check_end("end", self.end.as_deref(), path, path.points.len() - 1)
    }

    fn check_end(
        &self,
        which: &'static str,
        q: Option<&[f64]>,
        path: &CartesianPath,
        point: usize,
    ) -> Result<(), PathError> {
        let Some(q) = q else { return Ok(()) };
        let tool = path.tools.get(point).copied().unwrap_or(0);
        let arm = self.tools.arm(tool);
        // Checks that `q` is finite.
        arm.base_from_tool(q)?;
        let (metres, radians, reached) = arm.errors_at(&path.points[point], q)?;
        let mut within = q.iter().zip(arm.limits());
        let within = within.all(|(q, limits)| limits.lower <= *q && *q <= limits.upper);
        #[cfg(feature = "collision")]
        let within = within && arm.touching(q)?.is_empty();
        match reached && within {
            true => Ok(()),
            false => Err(PathError::End {
                which,
                metres,
                radians,
            }),
        }
    }
}
