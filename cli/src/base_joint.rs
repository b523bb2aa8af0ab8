//! `--base-joint` and `--base-bounds`: joint between a robot's root and the world.

use clap::{Args, ValueEnum};
use kinopt::model::Limits;
use kinopt::robot::{BaseJoint, Robot};
use kinopt::skeleton::SkeletonRoot;

use crate::failure::Outcome;
use crate::help_headings::MODEL;
use crate::number_list::number;

/// Options of a robot's base.
#[derive(Args, Debug, Default)]
pub(crate) struct BaseJointOptions {
    /// Joint between the root and the world. Default: fixed.
    #[arg(long, value_enum, value_name = "KIND", help_heading = MODEL, hide_short_help = true)]
    base_joint: Option<BaseKind>,

    /// Base bounds in metres along the world axes, such as x=-1..1,z=0.5..1.2. Default: none.
    #[arg(long, value_name = "AXIS=LOW..HIGH,…", value_delimiter = ',', value_parser = AxisBounds::parse,
        requires = "base_joint", help_heading = MODEL, hide_short_help = true)]
    base_bounds: Vec<AxisBounds>,
}

/// Base joint types.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum BaseKind {
    Fixed,
    Free,
    Planar,
    SlideX,
    SlideY,
    SlideZ,
}

const AXES: [&str; 3] = ["x", "y", "z"];

/// Range along one axis of the world.
#[derive(Clone, Copy, Debug, PartialEq)]
struct AxisBounds {
    axis: usize,
    limits: Limits,
}

impl AxisBounds {
    fn parse(text: &str) -> Result<Self, String> {
        const SHAPE: &str = "expected AXIS=LOW..HIGH, the axis one of x, y, z";
        let (axis, range) = text.split_once('=').ok_or(SHAPE)?;
        let axis = AXES.iter().position(|name| *name == axis.trim());
        let (low, high) = range.split_once("..").ok_or(SHAPE)?;
        let limits = Limits::new(number(low.trim())?, number(high.trim())?);
        match axis {
            Some(axis) if limits.is_valid() => Ok(Self { axis, limits }),
            Some(_) => Err(format!("{range}: the lower end is above the upper end")),
            None => Err(SHAPE.to_owned()),
        }
    }
}

impl BaseJointOptions {
    /// The given option, if any.
    pub(crate) fn given(&self) -> Option<&'static str> {
        self.base_joint.map(|_| "--base-joint")
    }

    /// Base bounds along an axis.
    fn along(&self, axis: usize) -> Limits {
        let ranges = self.base_bounds.iter().filter(|range| range.axis == axis);
        let unbounded = Limits::UNBOUNDED;
        ranges.fold(unbounded, |limits, range| {
            limits.intersection(&range.limits)
        })
    }

    /// Root joint of a skeleton; its bounds are relative to the rest pose.
    pub(crate) fn root(&self) -> Outcome<SkeletonRoot> {
        let bounds = [0, 1, 2].map(|axis| self.along(axis));
        match self.base_joint {
            Some(BaseKind::Free) => Ok(SkeletonRoot::Free { bounds }),
            None | Some(BaseKind::Fixed) if self.base_bounds.is_empty() => Ok(SkeletonRoot::Fixed),
            None | Some(BaseKind::Fixed) => Err(usage!("--base-bounds: the root is fixed")),
            Some(_) => Err(usage!(
                "--base-joint of a skeleton is free or fixed; other types are for robots"
            )),
        }
    }

    /// Robot with the base joint.
    pub(crate) fn put_under(&self, robot: Robot, file: &str) -> Outcome<Robot> {
        let kind = self.base_joint.and_then(|kind| kind.to_possible_value());
        let kind = kind.as_ref().map_or("fixed", |kind| kind.get_name());
        let ranges = self.base_bounds.iter();
        let ranges = ranges.map(|bounds| (AXES[bounds.axis], bounds.limits));
        let base = BaseJoint::named(kind, ranges).map_err(|unknown| {
            let axis = unknown.name;
            usage!("--base-bounds {axis}=…: this base does not move along {axis}")
        })?;
        let robot = robot.with_base_joint(base);
        robot.map_err(|error| failure!("{file}: base joint: {error}"))
    }
}
