//! `--center-of-mass` and `--balance`: tasks for the centre of mass of a whole body.

use clap::Args;
use kinopt::model::{FrameId, Masses};
use kinopt::problem::ProblemBuilder;
use kinopt::spatial::Vector3;
use kinopt::task::{Axis, CentreOfMass, SupportPolygon, Task};

use super::task_name::TaskName;
use crate::choices::{AXES, among};
use crate::failure::Outcome;
use crate::frame_name::BareName;
use crate::help_headings::TARGETS;
use crate::loaded_model::LoadedModel;
use crate::number_list::{not_negative, number, parse_exactly};

/// Density of the bones of skeletons, kilograms per cubic unit; the centre of mass does not depend on it.
const DENSITY: f64 = 1000.0;

/// Options of the centre of mass.
#[derive(Args, Clone, Debug, Default)]
pub(crate) struct BalanceArguments {
    /// Target of the centre of mass in metres; `free` for a free coordinate. Default: none.
    #[arg(long, value_name = "x,y[,z]", allow_hyphen_values = true, value_parser = Centre::parse,
          help_heading = TARGETS)]
    center_of_mass: Option<Centre>,

    /// Keep the centre of mass above a foot link, or above a point of it in metres. Repeatable.
    #[arg(long, value_name = "FRAME[=x,y,z]", value_parser = Foot::parse, help_heading = TARGETS)]
    balance: Vec<Foot>,

    /// With --balance: distance from the edges of the support polygon, in metres. Default: 0.
    #[arg(long, value_name = "M", requires = "balance", value_parser = not_negative, help_heading = TARGETS,
          hide_short_help = true)]
    balance_margin: Option<f64>,

    /// Up axis of the world. Default: y for scenes and captures, else z.
    #[arg(long, value_name = "AXIS", value_parser = among(AXES), help_heading = TARGETS, hide_short_help = true)]
    up: Option<Axis>,
}

/// Target of a centre of mass, as typed.
#[derive(Clone, Debug, PartialEq)]
enum Centre {
    Above([f64; 2]),
    At([Option<f64>; 3]),
}

impl Centre {
    fn parse(text: &str) -> Result<Self, String> {
        let parts: Vec<&str> = text.split(',').map(str::trim).collect();
        let part = |text: &str| match text {
            "free" => Ok(None),
            text => number(text).map(Some),
        };
        match *parts.as_slice() {
            [x, y] => Ok(Self::Above([number(x)?, number(y)?])),
            ["free", "free", "free"] => {
                Err("at least one coordinate must not be `free`".to_owned())
            }
            [x, y, z] => Ok(Self::At([part(x)?, part(y)?, part(z)?])),
            _ => Err(format!(
                "expected x,y or x,y,z, not {} numbers",
                parts.len()
            )),
        }
    }
}

/// Frame in contact with the ground, with a point of the frame.
#[derive(Clone, Debug, PartialEq)]
struct Foot {
    frame: String,
    at: Option<[f64; 3]>,
}

impl Foot {
    fn parse(text: &str) -> Result<Self, String> {
        let (frame, at) = match text.rsplit_once('=') {
            Some((frame, at)) => (frame, Some(parse_exactly(at, "the point")?)),
            None => (text, None),
        };
        match frame.trim() {
            "" => Err("expected FRAME or FRAME=x,y,z".to_owned()),
            frame => Ok(Self {
                frame: frame.to_owned(),
                at,
            }),
        }
    }
}

impl BalanceArguments {
    /// Index of the world axis that points up.
    pub(super) fn up(&self, loaded: &LoadedModel) -> usize {
        match self.up {
            Some(up) => up as usize,
            None if loaded.is_bare_figure() => 1,
            None => 2,
        }
    }

    /// True if there is an option for the centre of mass.
    pub(super) fn given(&self) -> bool {
        self.center_of_mass.is_some() || !self.balance.is_empty()
    }
}

/// Tasks of the centre of mass.
#[derive(Clone, Debug)]
pub(super) struct Balance {
    masses: Masses,
    centre: Option<CentreOfMass>,
    polygon: Option<SupportPolygon>,
}

impl Balance {
    /// Tasks from the options, or `None` without options.
    ///
    /// # Errors
    /// A model without masses, or an unknown frame.
    pub(super) fn of(loaded: &LoadedModel, arguments: &BalanceArguments) -> Outcome<Option<Self>> {
        if !arguments.given() {
            return Ok(None);
        }
        let masses = match (&loaded.robot, &loaded.rig) {
            (Some(robot), _) => robot.masses(),
            (None, Some(rig)) => rig.masses(DENSITY),
            (None, None) => Masses::new(&loaded.model, []),
        };
        let masses = masses.map_err(|error| failure!("{}: {error}", loaded.file))?;
        let up = arguments.up(loaded);
        let centre = arguments.center_of_mass.as_ref();
        let centre = centre.map(|centre| centre.task(&masses, up));
        let polygon = match arguments.balance.as_slice() {
            [] => None,
            feet => {
                let margin = arguments.balance_margin.unwrap_or(0.0);
                let mut polygon = SupportPolygon::new(&masses)
                    .with_up(Vector3::UNITS[up])
                    .with_margin(margin);
                for foot in feet {
                    let frame = loaded.frame(&foot.frame, BareName::Tip)?;
                    polygon = polygon.with_points_on(frame, foot.points(loaded, frame));
                }
                Some(polygon)
            }
        };
        Ok(Some(Self {
            masses,
            centre,
            polygon,
        }))
    }

    /// Frames on which the tasks depend.
    pub(super) fn frames(&self) -> impl Iterator<Item = FrameId> + '_ {
        self.masses.points().iter().map(|point| point.frame)
    }

    /// Names of the tasks, in their order.
    pub(super) fn names(&self) -> impl Iterator<Item = TaskName> {
        let centre = self.centre.iter().map(|_| "center of mass");
        let names = centre.chain(self.polygon.iter().map(|_| "balance"));
        names.map(|name| TaskName {
            frame: name.to_owned(),
            held: false,
        })
    }

    /// Adds the tasks, each with its priority level.
    pub(super) fn add(
        &self,
        builder: &mut ProblemBuilder<'_>,
        mut levels: impl Iterator<Item = usize>,
    ) {
        let mut level = || levels.next().unwrap_or_default();
        if let Some(centre) = &self.centre {
            builder.add(
                Task::new(centre.clone())
                    .named("center of mass")
                    .at_level(level()),
            );
        }
        if let Some(polygon) = &self.polygon {
            builder.add(
                Task::new(polygon.clone())
                    .named("balance")
                    .at_level(level()),
            );
        }
    }
}

impl Centre {
    fn task(&self, masses: &Masses, up: usize) -> CentreOfMass {
        let mut position = [None; 3];
        match *self {
            Self::At(at) => position = at,
            Self::Above(at) => {
                let across = (0..3).filter(|&axis| axis != up);
                for (axis, value) in across.zip(at) {
                    position[axis] = Some(value);
                }
            }
        }
        let task = CentreOfMass::new(masses, position.map(Option::unwrap_or_default));
        let axes = [Axis::X, Axis::Y, Axis::Z].into_iter().zip(position);
        axes.fold(task, |task, (axis, position)| match position {
            None => task.free_along(axis),
            Some(_) => task,
        })
    }
}

impl Foot {
    /// Contact points of the foot, in its frame.
    fn points(&self, loaded: &LoadedModel, frame: FrameId) -> Vec<Vector3<f64>> {
        if let Some(at) = self.at {
            return vec![at.into()];
        }
        let sole = loaded.robot.as_ref().map(|robot| robot.sole(frame));
        sole.unwrap_or_else(|| vec![Vector3::zero()])
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn centres_and_feet_parse() {
        assert_eq!(Centre::parse("1,-2"), Ok(Centre::Above([1.0, -2.0])));
        let at = [Some(0.5), None, Some(2.0)];
        assert_eq!(Centre::parse("0.5, free,2"), Ok(Centre::At(at)));
        for bad in ["1", "1,2,3,4", "free,free,free", "a,b", "free,1"] {
            assert!(Centre::parse(bad).is_err(), "{bad}");
        }
        let foot = |at| Foot {
            frame: "foot".to_owned(),
            at,
        };
        assert_eq!(Foot::parse("foot"), Ok(foot(None)));
        assert_eq!(Foot::parse("foot=1,2,3"), Ok(foot(Some([1.0, 2.0, 3.0]))));
        for bad in ["", "=1,2,3", "foot=1,2"] {
            assert!(Foot::parse(bad).is_err(), "{bad}");
        }
    }
}
