//! Targets of frames: poses, positions and rays.

use std::str::FromStr;

use kinopt::spatial::{Placement, Quaternion, Vector3};

use super::number_list::{between_commas, parse_exactly};
use super::text::named;

/// Largest deviation of a typed quaternion's length from 1; the quaternion is normalised.
pub(crate) const QUATERNION_LENGTH_TOLERANCE: f64 = 0.01;

/// Target `FRAME=x,y,z` or `FRAME=x,y,z,qw,qx,qy,qz`; without `FRAME=` it is of the tip.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Target {
    pub(crate) frame: Option<String>,
    /// Target pose of the frame; the rotation is the identity if only a position is given.
    pub(crate) placement: Placement<f64>,
    /// True if an orientation is given.
    pub(crate) turns: bool,
}

/// Ray `FRAME=ex,ey,ez:mx,my,mz`.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct RayTarget {
    pub(crate) frame: String,
    pub(crate) eye: [f64; 3],
    pub(crate) through: [f64; 3],
}

impl FromStr for Target {
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
pub(crate) fn parse_placement(text: &str) -> Result<Placement<f64>, String> {
    Ok(placement(&between_commas(text)?)?.0)
}

/// Placement of a position and an optional quaternion, w first. The flag is true if there is a quaternion.
pub(crate) fn placement(numbers: &[f64]) -> Result<(Placement<f64>, bool), String> {
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

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn target_points_and_poses_parse() {
        let target = Target::from_str("left=hand=1,-2.5,3e-1").unwrap();
        assert_eq!(target.frame.as_deref(), Some("left=hand"));
        let at = Placement::translation(Vector3::new(1.0, -2.5, 0.3));
        assert_eq!((target.placement, target.turns), (at, false));
        assert_eq!(Target::from_str("1,2,3").unwrap().frame, None);
        let pose = Target::from_str("a=0,0,0,0.7071,0,0.7071,0").unwrap();
        let half = 0.5_f64.sqrt();
        let Quaternion { w, v } = Quaternion::from_matrix(&pose.placement.rotation);
        assert!((w - half).abs() < 1e-12 && (v.y - half).abs() < 1e-12);
        assert!(v.x.abs() < 1e-12 && v.z.abs() < 1e-12 && pose.turns);
    }

    #[test]
    fn target_malformed_text_names_the_cause() {
        for (text, reason) in [
            ("a", "`a` is not a number"),
            ("=1,2,3", "expected FRAME="),
            ("a=1,2", "not 2"),
            ("a=1,2,3,4", "not 4"),
            ("a=1,2,x", "`x` is not a number"),
            ("a=1,2,inf", "not a finite number"),
            ("a=1,2,3,0,0,0,0", "length 0"),
            ("a=1,2,3,1,1,0,0", "length 1.41"),
        ] {
            let error = Target::from_str(text).unwrap_err();
            assert!(error.contains(reason), "{text}: {error}");
        }
    }

    #[test]
    fn rays_parse() {
        let ray = RayTarget::from_str("tip=0,0,5:1,1,0").unwrap();
        assert_eq!((ray.eye, ray.through), ([0.0, 0.0, 5.0], [1.0, 1.0, 0.0]));
        let bad = [
            "tip=0,0,5",
            "tip=0,0,5:1,1",
            "tip=1,1,1:1,1,1",
            "0,0,5:1,1,1",
        ];
        for text in bad {
            assert!(RayTarget::from_str(text).is_err(), "{text}");
        }
    }
}
