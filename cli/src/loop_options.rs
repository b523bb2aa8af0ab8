//! `--connect`, `--weld`, `--passive` and `--without-loops`: loops of a robot.

use clap::Args;
use kinopt::model::{FrameId, Loop, LoopKind};
use kinopt::robot::Robot;
use kinopt::spatial::Placement;

use crate::choices::first_given;
use crate::failure::Outcome;
use crate::help_headings::MODEL;
use crate::target::parse_placement;

/// Options of a robot's loops.
#[derive(Args, Debug, Default)]
pub(crate) struct LoopOptions {
    /// Close a loop: two frame origins, or points on frames in metres, coincide. Repeatable.
    #[arg(long, value_name = "FRAME[@x,y,z]=FRAME[@x,y,z]", value_parser = Joined::parse,
          help_heading = MODEL, hide_short_help = true)]
    connect: Vec<Joined>,

    /// Close a loop as --connect does, with equal orientation. Repeatable.
    #[arg(long, value_name = "FRAME[@…]=FRAME[@…]", value_parser = Joined::parse,
          help_heading = MODEL, hide_short_help = true)]
    weld: Vec<Joined>,

    /// Passive joint, moved by `fk` to close loops. Default: MJCF joints without actuators.
    #[arg(long, value_name = "JOINT", help_heading = MODEL, hide_short_help = true)]
    passive: Vec<String>,

    /// Ignore the loops of the robot's file. Default: they are closed.
    #[arg(long, help_heading = MODEL, hide_short_help = true)]
    without_loops: bool,
}

/// Two frames with points or placements on them.
#[derive(Clone, Debug)]
struct Joined {
    typed: String,
    sides: [(String, Placement<f64>); 2],
}

impl Joined {
    fn parse(text: &str) -> Result<Self, String> {
        const SHAPE: &str = "expected FRAME=FRAME, each optionally with @x,y,z or @x,y,z,qw,qx,qy,qz \
                             for a placement on the frame";
        let (first, second) = text.split_once('=').ok_or(SHAPE)?;
        type Side = (String, Placement<f64>);
        let side = |side: &str| -> Result<Side, String> {
            match side.rsplit_once('@') {
                None => Ok((side.trim().to_owned(), Placement::identity())),
                Some((frame, placement)) => {
                    Ok((frame.trim().to_owned(), parse_placement(placement)?))
                }
            }
        };
        let sides: [Side; 2] = [side(first)?, side(second)?];
        match sides.iter().any(|(frame, _)| frame.is_empty()) {
            true => Err(SHAPE.to_owned()),
            false => Ok(Self {
                typed: text.to_owned(),
                sides,
            }),
        }
    }
}

impl LoopOptions {
    /// First given option, if any.
    pub(crate) fn given(&self) -> Option<&'static str> {
        first_given([
            ("--connect", !self.connect.is_empty()),
            ("--weld", !self.weld.is_empty()),
            ("--passive", !self.passive.is_empty()),
            ("--without-loops", self.without_loops),
        ])
    }

    /// Robot with these loops.
    pub(crate) fn close(&self, robot: Robot, file: &str) -> Outcome<Robot> {
        let mut robot = match self.without_loops {
            true => robot.without_loops(),
            false => robot,
        };
        let connected = self
            .connect
            .iter()
            .map(|option| (option, LoopKind::Connect));
        let welded = self.weld.iter().map(|option| (option, LoopKind::Weld));
        for (option, kind) in connected.chain(welded) {
            let [first, second] = option.sides.each_ref().map(|(name, _)| name);
            let frame = |name: &String| -> Outcome<FrameId> {
                let frame_id = robot.model().frame(name);
                frame_id.map_err(|error| failure!("{file}: --{}: {error}", kind.name()))
            };
            let frames = [frame(first)?, frame(second)?];
            let own_loop = match kind {
                LoopKind::Weld => Loop::weld(&option.typed, frames),
                _ => Loop::connect(&option.typed, frames),
            };
            let placements = option.sides.each_ref().map(|(_, placement)| *placement);
            let closed = robot.with_loop(own_loop.at(placements));
            robot = closed.map_err(|error| failure!("{file}: {error}"))?;
        }
        if self.passive.is_empty() {
            return Ok(robot);
        }
        let named = robot.with_passive_joints(&self.passive);
        named.map_err(|error| failure!("{file}: --passive: {error}"))
    }
}
