//! Where frames stand, for people and for programs.

use kinopt::spatial::{Placement, Quaternion};
use serde::{Serialize, Serializer};

use crate::number_format::{LengthFormat, six_digits};
use crate::table::{Align, Table};

/// One frame's placement in the world, or in another frame.
#[derive(Debug, Serialize)]
pub(crate) struct FramePlacement {
    position: [f64; 3],
    /// w, x, y, z with w ≥ 0.
    quaternion: [f64; 4],
    /// The bone's ends, for a rig.
    #[serde(skip_serializing_if = "Option::is_none")]
    tail: Option<[f64; 3]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    tip: Option<[f64; 3]>,
}

/// Frames by name, in the order asked for.
#[derive(Debug)]
pub(crate) struct FrameReport(Vec<(String, FramePlacement)>);

impl Serialize for FrameReport {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.0.iter().map(|(name, placement)| (name, placement)))
    }
}

/// Of the two quaternions of a rotation the one with w ≥ 0.
fn quaternion(placement: &Placement<f64>) -> [f64; 4] {
    let Quaternion { w, v } = Quaternion::from_matrix(&placement.rotation);
    let quaternion = [w, v.x, v.y, v.z];
    // Adding zero turns −0 into 0.
    quaternion.map(|c| if w < 0.0 { -c + 0.0 } else { c + 0.0 })
}

impl FramePlacement {
    pub(crate) fn of(placement: &Placement<f64>) -> Self {
        Self {
            position: placement.translation.to_array(),
            quaternion: quaternion(placement),
            tail: None,
            tip: None,
        }
    }

    /// With the tail and the tip of the bone whose frame it is.
    pub(crate) fn with_ends(self, ends: Option<[[f64; 3]; 2]>) -> Self {
        Self {
            tail: ends.map(|[tail, _]| tail),
            tip: ends.map(|[_, tip]| tip),
            ..self
        }
    }
}

impl FrameReport {
    pub(crate) fn new(frames: Vec<(String, FramePlacement)>) -> Self {
        Self(frames)
    }

    /// Frames without ends.
    pub(crate) fn of_placements(frames: Vec<(String, Placement<f64>)>) -> Self {
        let frames = frames.into_iter();
        let placed = frames.map(|(name, placement)| (name, FramePlacement::of(&placement)));
        Self(placed.collect())
    }

    /// An aligned table.
    pub(crate) fn text(&self, format: LengthFormat) -> String {
        let rigs = self.0.iter().any(|(_, placement)| placement.tip.is_some());
        let [x, y, z] = [
            ("x", Align::Right),
            ("y", Align::Right),
            ("z", Align::Right),
        ];
        let rest = ["qw", "qx", "qy", "qz"].map(|name| (name, Align::Right));
        let tip = ["tip x", "tip y", "tip z"].map(|name| (name, Align::Right));
        let [qw, qx, qy, qz] = rest;
        let [tip_x, tip_y, tip_z] = tip;
        let frame = ("frame", Align::Left);
        let mut table = if rigs {
            Table::new([frame, x, y, z, qw, qx, qy, qz, tip_x, tip_y, tip_z])
        } else {
            Table::new([frame, x, y, z, qw, qx, qy, qz])
        };
        for (name, placement) in &self.0 {
            let [x, y, z] = format.vector(placement.position);
            let [qw, qx, qy, qz] = placement.quaternion.map(six_digits);
            let name = name.clone();
            match placement.tip {
                Some(tip) => {
                    let [tip_x, tip_y, tip_z] = format.vector(tip);
                    table.row([name, x, y, z, qw, qx, qy, qz, tip_x, tip_y, tip_z]);
                }
                None => table.row([name, x, y, z, qw, qx, qy, qz]),
            }
        }
        table.text()
    }
}
