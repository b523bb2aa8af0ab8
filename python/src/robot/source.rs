//! Data that rebuild a robot, in another process too.

use std::path::Path;
use std::sync::Arc;

use kinopt::io::FileAccess;
use kinopt::robot::{BaseJoint, Robot};
use kinopt::spatial::Placement;
use kinopt_bindings::ErrorKind;
use kinopt_bindings::option::robot::{BaseSettings, RobotOptions};
use numpy::PyArray2;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arrays;
use crate::error::{OrRaise, invalid, raise};
use crate::named_loop::{LoopParts, NamedLoop};
use crate::object::Object;
use crate::placement;

/// Content of a robot's file, and the later changes.
#[derive(Clone, Default)]
pub(super) struct Source {
    pub(super) text: Arc<str>,
    pub(super) file: String,
    pub(super) options: RobotOptions,
    /// Texts of joint_limits.yaml, with file names.
    pub(super) joint_limits: Vec<(Arc<str>, String)>,
    pub(super) tools: Vec<(String, String, Placement<f64>)>,
    pub(super) loops: Loops,
}

/// Changes to the loops of the file.
#[derive(Clone, Default)]
pub(super) struct Loops {
    pub(super) without: bool,
    pub(super) added: Vec<NamedLoop>,
    pub(super) passive: Option<Vec<String>>,
}

/// Pickled form of soft limits, mimic limits, and texts of joint_limits.yaml with file names.
pub(super) type PickledLimits = (bool, bool, Vec<(String, String)>);

/// Pickled form of [`BaseSettings`].
pub(super) type PickledBase<'py> = (Option<Bound<'py, PyAny>>, Option<Bound<'py, PyDict>>);

/// Pickled form of a tool.
pub(super) type PickledTool<'py> = (String, String, Bound<'py, PyAny>);

/// Pickled form of [`Loops`]: true if the loops of the file are removed, added loops, passive joints.
pub(super) type PickledLoops<'py> = (bool, Vec<PickledLoop<'py>>, Option<Vec<String>>);
type PickledLoop<'py> = (String, String, [String; 2], [Bound<'py, PyAny>; 2]);

impl Source {
    /// Builds the robot.
    pub(super) fn read(&self) -> PyResult<Robot> {
        let robot = self.options.parse::<Object>(&self.text, &self.file)?;
        // Meshes are searched in the folder of the file.
        let robot = robot.with_file(&self.file);
        let mut robot = self.options.limited::<Object>(robot)?;
        for (text, file) in &self.joint_limits {
            robot = robot
                .with_joint_limits_of(text.as_bytes(), file)
                .or_raise()?;
        }
        robot = self.options.base.of::<Object>(robot)?;
        for (name, link, tool) in &self.tools {
            robot = robot.with_tool(name, link, tool).or_raise()?;
        }
        if self.loops.without {
            robot = robot.without_loops();
        }
        for named_loop in &self.loops.added {
            let model = robot.model();
            let [first, second] = named_loop.frames.each_ref().map(|name| model.frame(name));
            let closed = named_loop.of([first.or_raise()?, second.or_raise()?]);
            robot = robot.with_loop(closed).or_raise()?;
        }
        if let Some(names) = &self.loops.passive {
            robot = robot.with_passive_joints(names).or_raise()?;
        }
        Ok(robot)
    }

    /// True if the file is MJCF.
    pub(super) fn is_mjcf(&self) -> bool {
        Robot::is_mjcf(&self.text)
    }

    /// Model of the file without changes.
    pub(super) fn file_model(&self) -> PyResult<kinopt::Model> {
        let robot = self.options.parse::<Object>(&self.text, &self.file)?;
        Ok(robot.model().clone())
    }

    /// Arguments of [`unpickled`](Self::unpickled).
    #[allow(clippy::type_complexity, reason = "it is read once")]
    pub(super) fn pickled<'py>(&self, py: Python<'py>) -> PyResult<impl IntoPyObject<'py>> {
        let tools = self.tools.iter().map(|(name, link, tool)| {
            Ok((name.clone(), link.clone(), placement::to_array(py, tool)?))
        });
        let tools: Vec<(String, String, Bound<'py, PyArray2<f64>>)> =
            tools.collect::<PyResult<_>>()?;
        let added = self
            .loops
            .added
            .iter()
            .map(|named_loop| named_loop.pickled(py));
        let added: Vec<LoopParts<'py>> = added.collect::<PyResult<_>>()?;
        let (options, bounds) = (&self.options, PyDict::new(py));
        for (axis, range) in &options.base.bounds {
            bounds.set_item(axis, *range)?;
        }
        let limits: Vec<_> = (self.joint_limits.iter())
            .map(|(text, file)| (text.to_string(), file.clone()))
            .collect();
        Ok((
            self.text.to_string(),
            self.file.clone(),
            (options.lenient, options.confine),
            (options.soft_limits, options.mimic_limits, limits),
            (options.base.joint.clone(), bounds),
            tools,
            (self.loops.without, added, self.loops.passive.clone()),
        ))
    }

    /// Rebuilds from the data of [`pickled`](Self::pickled).
    pub(super) fn unpickled(
        text: &str,
        file: String,
        (lenient, confine): (bool, bool),
        (soft_limits, mimic_limits, limits): PickledLimits,
        (joint, bounds): PickledBase<'_>,
        tools: Vec<PickledTool<'_>>,
        (without, added, passive): PickledLoops<'_>,
    ) -> PyResult<Self> {
        let added = added.into_iter();
        let added = added
            .map(|(name, kind, frames, places)| NamedLoop::new(name, frames, &kind, Some(places)));
        let tools = tools.into_iter().map(|(name, link, tool)| {
            Ok((name, link, placement::placement(&tool, "link_from_tool")?))
        });
        Ok(Self {
            text: text.into(),
            file,
            options: RobotOptions {
                lenient,
                confine,
                soft_limits,
                mimic_limits,
                base: base_of(joint, bounds)?,
            },
            joint_limits: (limits.into_iter())
                .map(|(text, file)| (text.into(), file))
                .collect(),
            tools: tools.collect::<PyResult<_>>()?,
            loops: Loops {
                without,
                added: added.collect::<PyResult<_>>()?,
                passive,
            },
        })
    }
}

/// Reads the base joint and its bounds.
pub(super) fn base_of(
    joint: Option<Bound<'_, PyAny>>,
    bounds: Option<Bound<'_, PyDict>>,
) -> PyResult<BaseSettings> {
    let joint = joint.map(|joint| arrays::word(&joint, "base_joint", &BaseJoint::KINDS));
    let joint = joint.transpose()?;
    let bounds = bounds.map_or_else(Vec::new, |bounds| bounds.iter().collect());
    let ranges = bounds.into_iter().map(|(axis, range)| {
        let range = range.extract::<(f64, f64)>();
        let axis = arrays::name(&axis, "an axis of base_bounds")?;
        let (lower, upper) =
            range.map_err(|_| invalid("base_bounds must be a dict of (lower, upper) by axis"))?;
        match lower.is_nan() || upper.is_nan() {
            false => Ok((axis, (lower, upper))),
            true => Err(invalid(format!(
                "base_bounds along {axis} is ({lower}, {upper}), which is no range"
            ))),
        }
    });
    Ok(BaseSettings {
        joint,
        bounds: ranges.collect::<PyResult<_>>()?,
    })
}

/// Returns the text of a file, and its name in messages.
pub(crate) fn text_of(path: &Path) -> PyResult<(String, String)> {
    let file = path.display().to_string();
    let bytes = FileAccess::new().read(path).or_raise()?;
    let text = String::from_utf8(bytes)
        .map_err(|_| raise(ErrorKind::InvalidFile, format!("{file}: is not UTF-8 text")))?;
    Ok((text, file))
}
