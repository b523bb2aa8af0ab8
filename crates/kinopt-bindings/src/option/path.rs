//! Options of a Cartesian path.

use kinopt::Arm;
use kinopt::arm::JointPath;
use kinopt::motion::path::{CartesianPath, PathReport, PathSolver, Traversal};

use super::{Joints, OptionSpec, Setter};
use crate::names::named;
use crate::value::{Arguments, ErrorOf, OrRaise, Value};

/// Orders in which a path is traversed, by name.
pub const TRAVERSALS: [(&str, Traversal); 3] = [
    ("open", Traversal::Open),
    ("cyclic", Traversal::Cyclic),
    ("any-start", Traversal::AnyStart),
];

/// Options of a path, as given.
#[derive(Clone, Debug)]
pub struct PathOptions {
    /// Time of each point, seconds.
    pub times: Option<Vec<f64>>,
    /// True if a step that is too fast for a joint counts as a reconfiguration.
    pub keep_times: bool,
    /// Order of traversal.
    pub traversal: Traversal,
    /// Configuration of the first row, radians or metres.
    pub start: Option<Vec<f64>>,
    /// Configuration of the last row, radians or metres.
    pub end: Option<Vec<f64>>,
    /// Weight of a radian or metre of each joint in lengths.
    pub joint_weights: Option<Vec<f64>>,
    /// Largest joint displacement from point to point on one branch, radians.
    pub max_step: f64,
    /// Largest number of configurations for each point.
    pub samples: usize,
    /// Index of the tool of each point.
    pub tool_of_points: Option<Vec<usize>>,
}

impl Default for PathOptions {
    fn default() -> Self {
        Self {
            times: None,
            keep_times: false,
            traversal: Traversal::Open,
            start: None,
            end: None,
            joint_weights: None,
            max_step: 0.2,
            samples: 256,
            tool_of_points: None,
        }
    }
}

/// Options of a path, by name. `tools` are objects of the interface.
#[must_use]
pub fn options() -> [OptionSpec<PathOptions>; 10] {
    [
        OptionSpec {
            name: "traversal",
            set: Setter::Named(|options, name| {
                let traversal = named("traversal", name, &TRAVERSALS)?;
                Ok(PathOptions {
                    traversal,
                    ..options
                })
            }),
            doc: "\"open\", \"cyclic\" (repeatedly, ends in its first configuration) or \"any-start\" (once around, \
                  from the best point).",
            default: "\"open\"",
        },
        OptionSpec {
            name: "start",
            set: Setter::Configuration(|options, q| PathOptions {
                start: Some(q),
                ..options
            }),
            doc: "configuration of the first row, radians or metres.",
            default: "any",
        },
        OptionSpec {
            name: "end",
            set: Setter::Configuration(|options, q| PathOptions {
                end: Some(q),
                ..options
            }),
            doc: "configuration of the last row, radians or metres.",
            default: "any",
        },
        OptionSpec {
            name: "joint_weights",
            set: Setter::PerJoint(
                |options, weights| PathOptions {
                    joint_weights: Some(weights),
                    ..options
                },
                Some(1.0),
            ),
            doc: "weight of a radian or metre of each joint in lengths.",
            default: "those of the arm",
        },
        OptionSpec {
            name: "max_step",
            set: Setter::Number(|options, max_step| PathOptions {
                max_step,
                ..options
            }),
            doc: "largest joint displacement from point to point on one branch, radians.",
            default: "0.2",
        },
        OptionSpec {
            name: "samples",
            set: Setter::Whole(|options, samples| PathOptions {
                samples: samples as usize,
                ..options
            }),
            doc: "largest number of configurations for each point.",
            default: "256",
        },
        OptionSpec {
            name: "times",
            set: Setter::Numbers(|options, times| PathOptions {
                times: Some(times),
                ..options
            }),
            doc: "time of each point, seconds.",
            default: "none",
        },
        OptionSpec {
            name: "keep_times",
            set: Setter::Switch(|options, keep_times| PathOptions {
                keep_times,
                ..options
            }),
            doc: "a step that is too fast for a joint also counts as a reconfiguration.",
            default: "False",
        },
        OptionSpec {
            name: "tools",
            set: Setter::Elsewhere,
            doc: "further tools, for `tool_of_points`.",
            default: "none",
        },
        OptionSpec {
            name: "tool_of_points",
            set: Setter::Elsewhere,
            doc: "tool of each point: 0 is that of the arm, 1 and so on are those of `tools`.",
            default: "0 for each point",
        },
    ]
}

impl PathOptions {
    /// Reads the options of a path of an arm, except tools.
    ///
    /// # Errors
    /// If an option has another type, or names an unknown value or joint.
    pub fn of<A: Arguments>(arguments: &A, arm: &Arm) -> Result<Self, ErrorOf<A>> {
        let read = super::apply(arguments, &options(), Self::default())?;
        Joints::of_arm(arm, |joints| joints.apply(arguments, &options(), read))
    }

    /// The path with the times, tools and traversal of the options.
    ///
    /// # Errors
    /// If the path has another number of points, or times do not ascend.
    pub fn path<V: Value>(&self, mut path: CartesianPath) -> Result<CartesianPath, V::Error> {
        if let Some(times) = &self.times {
            path = path.with_times(times.clone()).or_raise::<V>()?;
        }
        if let Some(tools) = &self.tool_of_points {
            path = path.with_tools(tools.clone()).or_raise::<V>()?;
        }
        Ok(path.with_traversal(self.traversal))
    }

    /// Solves a path of [`path`](Self::path) with the tools of further arms.
    ///
    /// # Errors
    /// If an option is out of range.
    pub fn solve<'a>(
        &self,
        arm: &'a Arm,
        tools: impl IntoIterator<Item = &'a Arm>,
        path: &CartesianPath,
    ) -> Result<JointPath<PathReport>, kinopt::motion::path::PathError> {
        let mut solver = PathSolver::new(arm)
            .with_max_step(self.max_step)
            .with_samples(self.samples)
            .with_times_kept(self.keep_times)
            .with_tools(tools);
        if let Some(start) = &self.start {
            solver = solver.with_start(start);
        }
        if let Some(end) = &self.end {
            solver = solver.with_end(end);
        }
        if let Some(weights) = &self.joint_weights {
            solver = solver.with_joint_weights(weights);
        }
        solver.solve(path)
    }
}
