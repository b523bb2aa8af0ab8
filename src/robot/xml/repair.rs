//! What a reader took where a file says nothing, or says what cannot be.

use std::fmt;

use super::error::{Fault, RobotFileError};
use crate::model::Limits;
use crate::robot::LeftToMeshes;

/// One place of a file that was not taken at its word, and what was taken instead.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Repair {
    /// Where the element starts, from 1.
    pub line: u32,
    /// The element, such as ``joint `elbow`, <limit>``.
    pub element: String,
    /// What was done.
    pub mended: Mended,
}

impl Repair {
    /// An element that is wrong and counts for nothing.
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
        let mended = Mended::LeftOut(fault);
        Some(Self {
            line,
            element,
            mended,
        })
    }
}

/// What was done about one place of a file. The first two and [`LeftOut`](Self::LeftOut) of what
/// belongs to a link, [`MassLeftToMeshes`](Self::MassLeftToMeshes), [`StopsNothing`](Self::StopsNothing) and
/// [`MimicBeyondRange`](Self::MimicBeyondRange), [`MacroCallLeftOut`](Self::MacroCallLeftOut) and [`WorldAdded`](Self::WorldAdded)
/// come from strict readers too; the others from lenient ones alone.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Mended {
    /// `lower` or `upper` is not given, and 0 by the standard, which from URDF 1.2 on is no limit.
    /// A joint with neither cannot move (before 1.2).
    BoundByDefault {
        /// lower or upper.
        missing: &'static str,
        /// In radians or metres; infinite for no limit.
        value: f64,
    },
    /// Something is wrong and counts for nothing.
    LeftOut(Fault),
    /// A body states no mass, and what it weighs stands in the files of its meshes, which are not opened. The
    /// robot has no centre of mass if a joint moves it.
    MassLeftToMeshes(LeftToMeshes),
    /// A ball joint's range ends beyond half a turn, which is as far as anything is turned: it is no limit, as in MuJoCo.
    StopsNothing {
        /// Where it ends, in radians.
        angle: f64,
    },
    /// A mimic joint whose source joint moves it out of the range that the file states. The source joint keeps its own limits;
    /// [`Robot::with_mimic_limits`](crate::robot::Robot::with_mimic_limits) restricts it.
    MimicBeyondRange {
        /// The mimic joint.
        joint: String,
        /// The joint that it follows, through others if they follow too.
        source: String,
        /// The range that the file states for the mimic joint, radians or metres.
        range: Limits,
        /// The values that the mimic joint takes within the limits of its source, radians or metres.
        values: Limits,
    },
    /// A revolute or prismatic joint has no `<limit>`: it is held at 0.
    HeldAtZero,
    /// An infinite `lower` or `upper` of a `<limit>`: no limit on that side.
    Unlimited {
        /// lower or upper.
        attribute: &'static str,
    },
    /// A call of a xacro macro that the file does not define, left over when it was expanded: it counts for nothing.
    MacroCallLeftOut,
    /// Joints hang on a link `world` that the file does not declare: it is added, as Drake does.
    WorldAdded,
    /// Limits were out of order and are exchanged; these are the new ones, in radians or metres.
    LimitsExchanged {
        /// The smaller one.
        lower: f64,
        /// The larger one.
        upper: f64,
    },
    /// An element that may stand once stands again; the first counts.
    FirstCounts {
        /// The element.
        child: &'static str,
    },
    /// Commas between numbers count as blanks.
    CommasAreBlanks {
        /// The attribute.
        attribute: &'static str,
    },
    /// The robot has no name and is given this one.
    Named {
        /// The name.
        name: &'static str,
    },
    /// An XML declaration stood where none may and is not looked at.
    DeclarationRemoved,
    /// A namespace prefix that the file uses is declared nowhere; it counts as an extension's.
    PrefixDeclared {
        /// The prefix.
        prefix: String,
    },
}

impl fmt::Display for Mended {
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
            Self::MassLeftToMeshes(LeftToMeshes::Mass) => write!(
                f,
                "its mass is that of a mesh, whose file is not opened, and not known; `inertial` would state it"
            ),
            Self::MassLeftToMeshes(LeftToMeshes::Centre { mass }) => write!(
                f,
                "its {mass} kg are a mesh's, whose file is not opened, so their centre is not known; `inertial` would state it"
            ),
            Self::StopsNothing { angle } => write!(
                f,
                "its range ends at {angle} rad, beyond half a turn, farther than which nothing is turned: no limit"
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
            Self::MacroCallLeftOut => write!(
                f,
                "a call of a macro that the file does not define: left out"
            ),
            Self::WorldAdded => write!(f, "link `world` is not declared: added, as Drake does"),
            Self::HeldAtZero => write!(f, "there is no <limit>: the joint is held at 0"),
            Self::LimitsExchanged { lower, upper } => {
                write!(f, "limits out of order, taken as {lower} to {upper}")
            }
            Self::FirstCounts { child } => {
                write!(f, "<{child}> is given more than once; the first counts")
            }
            Self::CommasAreBlanks { attribute } => {
                write!(f, "commas in `{attribute}` are taken as blanks")
            }
            Self::Named { name } => write!(f, "there is no name; the robot is called `{name}`"),
            Self::DeclarationRemoved => write!(f, "it is not at the start, and is not looked at"),
            Self::PrefixDeclared { prefix } => {
                write!(
                    f,
                    "prefix `{prefix}` is declared nowhere; its elements are extensions"
                )
            }
        }
    }
}

/// `12: joint elbow, <limit>: what was done`, to stand behind the file's name and a colon.
impl fmt::Display for Repair {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}: {}", self.line, self.element, self.mended)
    }
}
