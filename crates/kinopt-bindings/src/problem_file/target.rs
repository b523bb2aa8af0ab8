//! Targets of frames: poses, positions and rays.

use std::str::FromStr;

use kinopt::spatial::Placement;

use super::number_list::{between_commas, parse_exactly};
use super::text::named;
use crate::placement::PoseTarget;

/// Target `FRAME=x,y,z` or `FRAME=x,y,z,qw,qx,qy,qz`; without `FRAME=` it is of the tip.
#[derive(Clone, Debug, PartialEq)]
pub struct FrameTarget {
    /// Name of the frame; in a target `None` for the tip.
    pub frame: Option<String>,
    /// Target pose of the frame; the rotation is the identity if only a position is given.
    pub placement: Placement<f64>,
    /// True if an orientation is given.
    pub turns: bool,
}

/// Ray `FRAME=ex,ey,ez:mx,my,mz`.
#[derive(Clone, Debug, PartialEq)]
pub struct RayTarget {
    /// Name of the frame; in a target `None` for the tip.
    pub frame: String,
    /// Position of the eye, metres.
    pub eye: [f64; 3],
    /// Second point of the ray, metres.
    pub through: [f64; 3],
}

impl FromStr for FrameTarget {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (frame, numbers) = match text.contains('=') {
            true => named(text, "FRAME=x,y,z or FRAME=x,y,z,qw,qx,qy,qz")
                .map(|(frame, numbers)| (Some(frame), numbers))?,
            false => (None, text),
        };
        let target = PoseTarget::of_numbers(&between_commas(numbers)?)?;
        Ok(Self {
            frame,
            placement: target.placement,
            turns: target.has_orientation,
        })
    }
}

/// Parses `x,y,z` or `x,y,z,qw,qx,qy,qz`.
pub fn parse_placement(text: &str) -> Result<Placement<f64>, String> {
    Ok(PoseTarget::of_numbers(&between_commas(text)?)?.placement)
}

impl FromStr for RayTarget {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let shape = "FRAME=ex,ey,ez:mx,my,mz";
        let (frame, numbers) = named(text, shape)?;
        let Some((eye, through)) = numbers.split_once(':') else {
            return Err(format!("expected {shape}: a colon between the two points"));
        };
        let eye = parse_exactly(eye, "the eye")?;
        let through = parse_exactly(through, "the point")?;
        if eye == through {
            return Err("the eye and the point coincide".to_owned());
        }
        Ok(Self {
            frame,
            eye,
            through,
        })
    }
}
