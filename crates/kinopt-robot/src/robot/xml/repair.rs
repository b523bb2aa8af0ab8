//! Defaults and corrections that a reader applied to a robot file.

use std::fmt;

use super::error::{ParseIssue, RobotFileError};
use crate::robot::MissingInertia;
use kinopt_kinematics::model::Limits;

/// A default or a correction at one position of a file.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Repair {
    /// Line of the element, from 1.
    pub line: u32,
    /// The element, such as ``joint `elbow`, <limit>``.
    pub element: String,
    /// The default or the correction.
    pub mended: RepairKind,
}

impl Repair {
    /// The repair that leaves out a faulty element; `None` for other errors.
    pub(crate) fn left_out(error: RobotFileError) -> Option<Self> {
        let RobotFileError::Element {
            line,
            element,
            fault,
            ..
        } = error
        else {
            return None;
        };
        let mended = RepairKind::LeftOut(fault);
        Some(Self {
            line,
            element,
            mended,
        })
    }
}

/// A default or a correction that a reader applied.
///
/// Strict readers apply [`BoundByDefault`](Self::BoundByDefault), [`LeftOut`](Self::LeftOut) for elements of a link,
/// [`MassLeftToMeshes`](Self::MassLeftToMeshes), [`StopsNothing`](Self::StopsNothing),
/// [`MimicBeyondRange`](Self::MimicBeyondRange), [`MacroCallLeftOut`](Self::MacroCallLeftOut) and
/// [`WorldAdded`](Self::WorldAdded). Lenient readers apply all.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum RepairKind {
    /// `lower` or `upper` is missing and gets the default of the standard: 0, or no limit from URDF 1.2 on. A joint
    /// without both cannot move before URDF 1.2.
    BoundByDefault {
        /// `lower` or `upper`.
        missing: &'static str,
        /// Default in radians or metres; infinite for no limit.
        value: f64,
    },
    /// A faulty element is left out.
    LeftOut(ParseIssue),
    /// The inertia of a body depends on mesh files, which the reader does not open. The robot has no centre of mass if
    /// a joint moves the body.
    MassLeftToMeshes(MissingInertia),
    /// The range of a ball joint ends beyond π, the largest rotation angle: it is no limit, as in MuJoCo.
    StopsNothing {
        /// End of the range, radians.
        angle: f64,
    },
    /// A source joint moves a mimic joint out of the range that the file states. The source joint keeps its own limits;
    /// [`Robot::with_mimic_limits`](crate::robot::Robot::with_mimic_limits) restricts it.
    MimicBeyondRange {
        /// The mimic joint.
        joint: String,
        /// The source joint at the end of the chain of mimic joints.
        source: String,
        /// Range of the mimic joint in the file, radians or metres.
        range: Limits,
        /// Values of the mimic joint within the limits of its source joint, radians or metres.
        values: Limits,
    },
    /// A revolute or prismatic joint without `<limit>` is locked at 0.
    HeldAtZero,
    /// An infinite `lower` or `upper` of a `<limit>` is no limit.
    Unlimited {
        /// `lower` or `upper`.
        attribute: &'static str,
    },
    /// A call of a xacro macro that the file does not define is left out. It is a remnant of an earlier expansion.
    MacroCallLeftOut,
    /// The link `world` that joints refer to is added, as Drake does.
    WorldAdded,
    /// Limits out of order are exchanged; radians or metres.
    LimitsExchanged {
        /// Lower limit after the exchange.
        lower: f64,
        /// Upper limit after the exchange.
        upper: f64,
    },
    /// The first of repeated elements is used.
    FirstCounts {
        /// Name of the element.
        child: &'static str,
    },
    /// Commas between numbers count as spaces.
    CommasAreBlanks {
        /// Name of the attribute.
        attribute: &'static str,
    },
    /// The robot has no name and gets this one.
    Named {
        /// Name that the robot gets.
        name: &'static str,
    },
    /// A misplaced XML declaration is ignored.
    DeclarationRemoved,
    /// An undeclared namespace prefix counts as that of an extension.
    PrefixDeclared {
        /// The prefix.
        prefix: String,
    },
}

impl fmt::Display for RepairKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::BoundByDefault { missing, value } if value.is_infinite() => {
                write!(f, "`{missing}` is not given: no limit")
            }
            Self::BoundByDefault { missing, value } => {
                write!(
                    f,
                    "`{missing}` is not given and taken as {value}, the default"
                )
            }
            Self::LeftOut(fault) => write!(f, "left out: {fault}"),
            Self::MassLeftToMeshes(MissingInertia::Mass) => write!(
                f,
                "the mass depends on a mesh file, which is not opened: unknown without `inertial`"
            ),
            Self::MassLeftToMeshes(MissingInertia::Centre { mass }) => write!(
                f,
                "the centre of its {mass} kg depends on a mesh file, which is not opened: unknown without `inertial`"
            ),
            Self::StopsNothing { angle } => write!(
                f,
                "the range ends at {angle} rad, beyond half a turn, the largest rotation: no limit"
            ),
            Self::MimicBeyondRange {
                joint,
                source,
                range,
                values,
            } => write!(
                f,
                "`{source}` moves `{joint}` through [{}, {}], beyond its own range [{}, {}]; `{source}` keeps its limits",
                values.lower, values.upper, range.lower, range.upper
            ),
            Self::Unlimited { attribute } => write!(f, "`{attribute}` is infinite: no limit"),
            Self::MacroCallLeftOut => write!(f, "call of an undefined macro: left out"),
            Self::WorldAdded => write!(f, "link `world` is not declared: added, as Drake does"),
            Self::HeldAtZero => write!(f, "there is no <limit>: the joint is locked at 0"),
            Self::LimitsExchanged { lower, upper } => {
                write!(f, "limits out of order, taken as {lower} to {upper}")
            }
            Self::FirstCounts { child } => {
                write!(f, "<{child}> is given more than once; the first counts")
            }
            Self::CommasAreBlanks { attribute } => {
                write!(f, "commas in `{attribute}` are read as spaces")
            }
            Self::Named { name } => write!(f, "there is no name; the robot is called `{name}`"),
            Self::DeclarationRemoved => write!(f, "it is not at the start of the file: ignored"),
            Self::PrefixDeclared { prefix } => {
                write!(
                    f,
                    "prefix `{prefix}` is not declared; its elements are extensions"
                )
            }
        }
    }
}

/// `12: joint elbow, <limit>: message`. Callers put the file name and a colon in front.
impl fmt::Display for Repair {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}: {}", self.line, self.element, self.mended)
    }
}
