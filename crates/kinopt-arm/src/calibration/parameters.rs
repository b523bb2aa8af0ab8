//! Parameters of a calibration: small displacements of the base, the joints and the tool.

use kinopt_kinematics::spatial::{Placement, Vector3, rotation_exp};

use super::chain::Chain;

/// Parts of the kinematics that are estimated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ParameterSet {
    /// Offset of each joint's zero position.
    pub joint_offsets: bool,
    /// Position of each joint's frame on the link before it.
    pub link_positions: bool,
    /// Orientation of each joint's frame on the link before it. It includes the offset.
    pub link_rotations: bool,
    /// Placement of the base in the frame of the measuring device.
    pub base: bool,
    /// Placement of the measured frame on the last link.
    pub tool: bool,
}

impl Default for ParameterSet {
    fn default() -> Self {
        Self {
            joint_offsets: true,
            link_positions: true,
            link_rotations: true,
            base: true,
            tool: true,
        }
    }
}

impl ParameterSet {
    pub(super) fn is_empty(&self) -> bool {
        !(self.joint_offsets
            || self.link_positions
            || self.link_rotations
            || self.base
            || self.tool)
    }
}

/// Expected deviations of an arm from its model: one standard deviation.
///
/// The placement of the base in the frame of the measuring device has no prior.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Prior {
    /// Deviation of a link's position, metres. Default 0.005.
    pub position: f64,
    /// Deviation of a link's orientation and of a joint offset, radians. Default 0.02.
    pub angle: f64,
}

impl Default for Prior {
    fn default() -> Self {
        Self {
            position: 0.005,
            angle: 0.02,
        }
    }
}

/// Place of a displacement in the chain.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Place {
    Base,
    /// The joint of this index.
    Joint(usize),
    Tool,
}

impl Place {
    /// Index among `count` places, from base to tool.
    pub(super) fn index(self, count: usize) -> usize {
        match self {
            Self::Base => 0,
            Self::Joint(joint) => joint + 1,
            Self::Tool => count - 1,
        }
    }
}

/// Direction of a displacement, in the displaced frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Direction {
    Translation(Vector3<f64>),
    Rotation(Vector3<f64>),
}

/// One parameter: metres or radians.
#[derive(Clone, Copy, Debug)]
pub(super) struct Parameter {
    pub(super) place: Place,
    pub(super) direction: Direction,
    /// True for the offset of a joint alone.
    is_offset: bool,
}

impl Parameter {
    /// Standard deviation of the prior; infinite for none.
    pub(super) fn prior(&self, prior: &Prior) -> f64 {
        match self.place {
            Place::Base => f64::INFINITY,
            _ => self.scale(prior),
        }
    }

    /// Expected deviation of a parameter of this unit, also for one without a prior.
    pub(super) fn scale(&self, prior: &Prior) -> f64 {
        match self.direction {
            Direction::Translation(_) => prior.position,
            Direction::Rotation(_) => prior.angle,
        }
    }

    /// Name: the joint, "base" or "tool", and the direction.
    pub(super) fn name(&self, chain: &Chain) -> String {
        let place = match self.place {
            Place::Base => "base",
            Place::Tool => "tool",
            Place::Joint(index) => chain.joints[index].name.as_str(),
        };
        let (kind, along) = match self.direction {
            Direction::Translation(along) => ("position", along),
            Direction::Rotation(along) => ("rotation", along),
        };
        if self.is_offset {
            return format!("{place} offset");
        }
        let axis = Vector3::UNITS.iter().position(|unit| *unit == along);
        let axis = axis.map_or("", |axis| ["x", "y", "z"][axis]);
        format!("{place} {kind} {axis}")
    }
}

/// Parameters of a set, from base to tool.
pub(super) fn parameters(chain: &Chain, set: &ParameterSet, has_rotations: bool) -> Vec<Parameter> {
    let mut all = Vec::new();
    let mut add = |place, directions: &[Direction], is_offset| {
        all.extend(directions.iter().map(|&direction| Parameter {
            place,
            direction,
            is_offset,
        }));
    };
    let translations = Vector3::UNITS.map(Direction::Translation);
    let rotations = Vector3::UNITS.map(Direction::Rotation);
    if set.base {
        add(Place::Base, &translations, false);
        add(Place::Base, &rotations, false);
    }
    for (index, joint) in chain.joints.iter().enumerate() {
        let slides = joint.kind.slides();
        if set.link_positions {
            add(Place::Joint(index), &translations, false);
        }
        if set.link_rotations {
            add(Place::Joint(index), &rotations, false);
        }
        let is_included = if slides {
            set.link_positions
        } else {
            set.link_rotations
        };
        if set.joint_offsets && !is_included {
            let offset = match slides {
                true => Direction::Translation(joint.axis),
                false => Direction::Rotation(joint.axis),
            };
            add(Place::Joint(index), &[offset], true);
        }
    }
    if set.tool {
        add(Place::Tool, &translations, false);
        // A measured point has no orientation.
        if has_rotations {
            add(Place::Tool, &rotations, false);
        }
    }
    all
}

/// Displacement of a place: a translation, then a rotation by a rotation vector.
#[derive(Clone, Copy, Debug)]
pub(super) struct Displacement {
    pub(super) translation: Vector3<f64>,
    pub(super) rotation: Vector3<f64>,
}

impl Displacement {
    /// Sums of the parameters of each of `count` places, from base to tool.
    pub(super) fn all(parameters: &[Parameter], x: &[f64], count: usize) -> Vec<Self> {
        let zero = Vector3::zero();
        let none = Self {
            translation: zero,
            rotation: zero,
        };
        let mut sums = vec![none; count];
        for (parameter, &value) in parameters.iter().zip(x) {
            let sum = &mut sums[parameter.place.index(count)];
            match parameter.direction {
                Direction::Translation(along) => sum.translation += along * value,
                Direction::Rotation(about) => sum.rotation += about * value,
            }
        }
        sums
    }

    pub(super) fn placement(&self) -> Placement<f64> {
        Placement::new(rotation_exp(self.rotation), self.translation)
    }
}
