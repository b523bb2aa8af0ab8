//! Targets of frames: poses, positions and rays.

use std::str::FromStr;

use kinopt::spatial::{Placement, Quaternion, Vector3};

use super::number_list::{between_commas, parse_exactly};
use super::text::named;

/// Largest deviation of a typed quaternion's length from 1; the quaternion is normalised.
pub const QUATERNION_LENGTH_TOLERANCE: f64 = 0.01;

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
        let (placement, turns) = placement(&between_commas(numbers)?)?;
        Ok(Self {
            frame,
            placement,
            turns,
        })
    }
}

/// Parses `x,y,z` or `x,y,z,qw,qx,qy,qz`.
pub fn parse_placement(text: &str) -> Result<Placement<f64>, String> {
    Ok(placement(&between_commas(text)?)?.0)
}

/// Placement of a position and an optional quaternion, w first. The flag is true if there is a quaternion.
pub fn placement(numbers: &[f64]) -> Result<(Placement<f64>, bool), String> {
    match *numbers {
        [x, y, z] => Ok((Placement::translation(Vector3::new(x, y, z)), false)),
        [x, y, z, qw, qx, qy, qz] => {
            let [w, i, j, k] = normalised([qw, qx, qy, qz])?;
            let v = Vector3::new(i, j, k);
            let rotation = Quaternion { w, v }.to_matrix();
            Ok((Placement::new(rotation, Vector3::new(x, y, z)), true))
        }
        _ => Err(format!(
            "a placement takes 3 numbers (x,y,z) or 7 (x,y,z,qw,qx,qy,qz), not {}",
            numbers.len()
        )),
    }
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

/// Normalised quaternion, w first; an error if its length is not near 1.
fn normalised(quaternion: [f64; 4]) -> Result<[f64; 4], String> {
    let length = quaternion.iter().map(|c| c * c).sum::<f64>().sqrt();
    if (length - 1.0).abs() <= QUATERNION_LENGTH_TOLERANCE {
        return Ok(quaternion.map(|c| c / length));
    }
    Err(format!(
        "the quaternion (w,x,y,z) has length {length:.6}; expected 1"
    ))
}
